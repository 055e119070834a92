/* tests/unit/sparse/test_step_control.c - a step that begins with charges which its mode contradicts: they
 * jump at its beginning, or the pair that cannot carry the impulse breaks there. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/guards.h"
#include "sparse/step.h"

static const double h = 1e-6;
enum { MOST = 32 };

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_sparse *m;
    ns_dense_step *step;
} bench;

/* Two capacitors, 1 nF at `first` V and 2 nF at 0 V, and a diode from one to the other. */
static bench open_bench(double first) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const ns_sparse_options o = {.h = h};
    double w[MOST];
    bench b = {0};
    ns_engine *e;
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-9, first, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", 2, 0, 2e-9, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_true(b.s->n <= MOST);
    assert_int_equal(ns_sparse_create(b.s, &o, &e, NULL), NS_OK);
    b.m = ns_sparse_of(e);
    b.step = &b.m->steps[1];
    memset(w, 0, sizeof w);
    assert_int_equal(ns_sparse_start(e, 0, w, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(b.c, w), NS_OK);
    memcpy(b.m->w, w, sizeof(double) * (size_t)b.s->n); /* not consistent with a diode that conducts */
    return b;
}

static void close_bench(bench *b) {
    ns_sparse_free(&b->m->engine);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

/* The step from there with the diode conducting. */
static void conduct(bench *b) {
    const ns_mode inside[1] = {NS_INSIDE};
    ns_sparse_guard_set_mode(b->m, inside);
    b->step->length_exponent = 0;
    b->step->time_lost = 0;
    b->step->after_event = 0;
    assert_int_equal(ns_sparse_control_step(b->m, b->step, 0, h), NS_OK);
}

/* Charge of node k, in C. */
static double charge_of(const bench *b, const double *w, int k) {
    return w[ns_circuit_node_unknown(b->c, k)];
}

/* 3 nC of 3 V on 1 nF spread over 3 nF: 1 V on each, 1 nC and 2 nC (charges of nodes; the rows of a node and
 * its unknown have the same number).  The step begins with these, and so does what it is read by. */
static void charges_jump_at_the_beginning(void **state) {
    (void)state;
    bench b = open_bench(3);
    double w[MOST];
    assert_true(fabs(charge_of(&b, b.m->w, 1) - 3e-9) < 1e-20 && charge_of(&b, b.m->w, 2) == 0);
    conduct(&b);
    assert_int_equal(b.step->at_event, 0);
    assert_int_equal(b.step->pair, -1);
    assert_true(b.step->length > 0);
    assert_true(fabs(charge_of(&b, b.step->powers, 1) - 1e-9) < 1e-20);
    assert_true(fabs(charge_of(&b, b.step->powers, 2) - 2e-9) < 1e-20);
    ns_sparse_step_state(b.m, b.step, 0, w);
    assert_memory_equal(w, b.m->w, sizeof(double) * (size_t)b.s->n);
    assert_true(fabs(charge_of(&b, w, 1) - 1e-9) < 1e-20 && fabs(charge_of(&b, w, 2) - 2e-9) < 1e-20);
    close_bench(&b);
}

/* The first capacitor's share of the charge went through the diode: 2 nC of the impulse (J1). */
static void the_impulse_is_kept(void **state) {
    (void)state;
    bench b = open_bench(3);
    conduct(&b);
    assert_true(fabs(b.m->instant.sum[b.s->n] - 2e-9) < 1e-18);
    close_bench(&b);
}

/* From -3 V the charge would have to flow backwards through the diode: it breaks where the step begins,
 * nothing has moved. */
static void a_pair_that_cannot_carry_it_breaks(void **state) {
    (void)state;
    bench b = open_bench(-3);
    conduct(&b);
    assert_int_equal(b.step->at_event, 1);
    assert_int_equal(b.step->pair, 0);
    assert_int_equal(b.step->guard, 0);
    assert_true(b.step->length == 0 && b.step->end_t == 0);
    assert_true(fabs(charge_of(&b, b.m->w, 1) + 3e-9) < 1e-20 && charge_of(&b, b.m->w, 2) == 0);
    assert_true(fabs(charge_of(&b, b.step->powers, 1) + 3e-9) < 1e-20);
    close_bench(&b);
}

/* After so many steps that ended where they began an Euler step follows, as short as steps get: once it was
 * h 2^-50 after the shortest steps, in which no digit of a rate is left: resistors of 300 ohm moved 2 nC in
 * no time (rectifier-inverter 24003000005). */
static void euler_steps_have_digits(void **state) {
    (void)state;
    bench b = open_bench(3);
    ns_dense_step *before = &b.m->steps[0];
    before->at_event = 1;
    before->length = 0;
    before->failures = 6;
    before->next_exponent = NS_LEAST_EXPONENT;
    assert_int_equal(ns_sparse_next_step(b.m, 0, before, b.step), NS_OK);
    assert_int_equal(b.step->is_euler, 1);
    assert_true(b.step->length >= ns_sparse_finest(b.m));
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charges_jump_at_the_beginning),
        cmocka_unit_test(the_impulse_is_kept),
        cmocka_unit_test(a_pair_that_cannot_carry_it_breaks),
        cmocka_unit_test(euler_steps_have_digits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
