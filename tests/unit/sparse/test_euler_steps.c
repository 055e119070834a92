/* tests/unit/sparse/test_euler_steps.c - Euler steps past an event are long enough for the signs of currents
 * not to be rounding.
 *
 * From circuit mmc 2101000000 of the stress set, devices of 0.1 ohm and 1 Mohm: past events by Euler steps of
 * 4e-14 s, in which 1 C is rounded by 6e-3 A, diodes that conduct were shown with -0.26 A beside 937 A.  That
 * was found wrong, and other engines took 7 times as long as the whole run should.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/guards.h"

static const double h = 1e-6;
enum { MOST = 32 };

static ns_circuit *two_capacitors(void) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    ns_circuit *c;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 1, 0, 3e-3, 1000, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", 2, 0, 3e-3, 1000, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d", 1, 2, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r", 2, 0, 1e12, NULL), NS_OK);
    return c;
}

/* 3 C on each but for 16 roundings of 4.4e-16 C on the one: 3.6e-15 C would flow back through the diode, in h
 * 2^-22 = 2.4e-13 s by 0.015 A.  Beside 1 A that is shown elsewhere 1e-5 A are allowed: h 2^-10 has 3.6e-6 A.
 */
static void signs_are_not_rounding(void **state) {
    const ns_sparse_options o = {.h = h};
    const ns_mode inside[1] = {NS_INSIDE};
    ns_circuit *c = two_capacitors();
    ns_system *s;
    ns_engine *e;
    double w[MOST] = {0};
    (void)state;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= MOST && s->m == 1);
    assert_int_equal(ns_sparse_create(s, &o, &e, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(c, w), NS_OK);
    assert_int_equal(ns_sparse_start(e, 0, w, NULL), NS_OK);
    ns_sparse *m = ns_sparse_of(e);
    memcpy(m->w, w, sizeof(double) * (size_t)s->n);
    m->w[ns_circuit_node_unknown(c, 1)] -= 16 * 0x1p-51;
    m->largest.lambda = 1;
    ns_sparse_guard_set_mode(m, inside);
    ns_dense_step *before = &m->steps[0], *step = &m->steps[1];
    before->at_event = 1;
    before->failures = 7;
    before->length = 0;
    before->next_exponent = 0;
    assert_int_equal(ns_sparse_next_step(m, 0, before, step), NS_OK);
    assert_true(step->is_euler && step->stages == 1);
    assert_int_equal(step->mode[0], NS_INSIDE);
    assert_true(step->images[m->f->n] >= -1e-5);
    assert_true(step->length <= ldexp(h, -10) * (1 + 1e-9));
    ns_sparse_free(e);
    ns_system_free(s);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(signs_are_not_rounding)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
