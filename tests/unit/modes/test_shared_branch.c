/* tests/unit/modes/test_shared_branch.c - a diode across an ideal switch: while that is closed it is idle, by
 * every engine.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "modes/shared_branch.h"
#include "nonsmooth.h"
#include "sparse/assemble.h"

/* 10 V, 1 kohm, 100 uH, and from there to ground a switch without resistance, with a diode across it each
 * way of drawing it: pair 0 the switch, pair 1 the diode.  The gate closes the switch from 2 us to 6 us of 10
 * us. */
static ns_circuit *half_bridge(int diode_up, double vf, double roff) {
    ns_circuit *c;
    ns_signal ten = {.kind = NS_DC}, gate = {.kind = NS_PULSE};
    const ns_switch contact = {0.5, 0, 0, roff};
    const ns_diode ideal = {vf, 0, roff, INFINITY, 0};
    ten.u.dc = 10;
    gate.u.pulse.v2 = 1;
    gate.u.pulse.td = 2e-6;
    gate.u.pulse.tr = gate.u.pulse.tf = 1e-9;
    gate.u.pulse.pw = 4e-6;
    gate.u.pulse.per = 1e-5;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &ten, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "g", NS_VOLTAGE, 4, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "load", 3, 0, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l", 2, 3, 1e-4, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s", 3, 0, 4, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d", diode_up ? 0 : 3, diode_up ? 3 : 0, &ideal, NULL), NS_OK);
    return c;
}

/* After the switch is closed i = 10 mA - 5 mA exp(-(t - 2 us)/0.1 us); at 5 us that is 10 mA to 1e-12 mA: the
 * switch has all of it (up to what roff leaks), the diode none, to the bit.  The diode that would conduct
 * from node 3 down to ground has no say before either: it shorts the load, with 10 mA (less 10 pA where it
 * drops 10 nV). */
static void the_switch_has_it_all(ns_method method, int diode_up, double vf, double roff) {
    ns_circuit *c = half_bridge(diode_up, vf, roff);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-8, .method = method};
    ns_system *s;
    ns_march *m;
    double w0[12] = {0}, lambda[2], reached;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 12 && s->m == 2);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    for (int period = 0; period < 3; period++) {
        const double t[] = {1.9e-6, 5e-6, 9.9e-6}, down = diode_up ? 0 : 1e-2;
        const double in_switch[] = {0, 1e-2, 0}, in_diode[] = {down, 0, down};
        for (int k = 0; k < 3; k++) {
            assert_int_equal(ns_march_try(m, 1e-5 * period + t[k], NS_TO_TIME, &reached), NS_OK);
            assert_int_equal(ns_march_accept(m), NS_OK);
            assert_int_equal(ns_march_read(m, NULL, NULL, lambda, NULL), NS_OK);
            assert_true(fabs(lambda[0] - in_switch[k]) < 1e-9);
            assert_true(k == 1 ? lambda[1] == 0 : fabs(lambda[1] - in_diode[k]) < 1e-9);
        }
    }
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

static void by_every_engine(void **state) {
    (void)state;
    static const ns_method methods[] = {NS_THETA, NS_EXACT, NS_SPARSE};
    for (int k = 0; k < 3; k++)
        for (int up = 0; up < 2; up++) {
            the_switch_has_it_all(methods[k], up, 0, INFINITY);
            the_switch_has_it_all(methods[k], up, 0, 1e12);
            the_switch_has_it_all(methods[k], up, 1e-8, INFINITY);
        }
}

/* Pair 1 is commanded, pair 0 across it the other way round; pair 2 elsewhere. */
static ns_system *twins(void) {
    ns_system *s;
    assert_int_equal(ns_system_create(3, 3, 1, 1, &s), NS_OK);
    for (int i = 0; i < 3; i++) {
        s->M[i + 3 * i] = 1;
        s->A[i + 3 * i] = -1;
    }
    s->B[0 + 3] = 1, s->B[1 + 3] = -1;
    s->B[0] = -1, s->B[1] = 1;
    s->C[1] = 2, s->C[1 + 3] = 3;
    s->C[0] = -2, s->C[0 + 3] = -3;
    s->B[2 + 6] = s->C[2 + 6] = 1;
    s->D[2 + 6] = 1;
    s->command[0].pair = 1;
    return s;
}

/* In dense and in sparse matrices: how many pairs are across a switch; that one is pair 0. */
static int found(const ns_system *s) {
    ns_system sparse = *s;
    ns_large large;
    int counts[2];
    assert_int_equal(ns_sparse_form_commit_dense(s, &large), NS_OK);
    sparse.large = &large;
    sparse.M = sparse.A = sparse.B = sparse.C = sparse.D = sparse.E = sparse.F = NULL;
    for (int k = 0; k < 2; k++) {
        ns_shared_branch *list;
        assert_int_equal(ns_modes_shared_find(k ? &sparse : s, &list, &counts[k]), NS_OK);
        for (int i = 0; i < counts[k]; i++) {
            assert_true(list[i].pair == 0 && list[i].of == 1);
            assert_int_equal(list[i].idle, s->l[0] == 0 ? NS_LOWER : NS_UPPER);
        }
        free(list);
    }
    ns_sparse_form_let_go(&large);
    assert_int_equal(counts[0], counts[1]);
    return counts[0];
}

/* Pairs of no unknown have no branch (sanitizers: nor arrays of coefficients). */
static void without_unknowns(void **state) {
    ns_system *s;
    ns_shared_branch *list;
    int count;
    (void)state;
    assert_int_equal(ns_system_create(0, 2, 0, 1, &s), NS_OK);
    assert_int_equal(ns_modes_shared_find(s, &list, &count), NS_OK);
    assert_int_equal(count, 0);
    ns_system_free(s);
}

/* One number of the system changed at a time: what makes the two no twins, and what does not. */
static void what_makes_a_twin(void **state) {
    (void)state;
    ns_system *s = twins();
    assert_int_equal(found(s), 1);
    const struct {
        double *at, value;
        int twins;
    } change[] = {
        {&s->l[0], -INFINITY, 0}, /* a bound of it must be 0 */
        {&s->D[0], 1, 1},         /* a resistance of its own: then it is idle beside a switch without any */
        {&s->D[1 + 3], 1, 0},     /* not one of the switch */
        {&s->D[0 + 3], 1, 0},     /* nor one that both see */
        {&s->D[1], 1, 0},         {&s->D[0 + 6], 1, 0}, {&s->D[2], 1, 0},     {&s->D[1 + 6], 1, 0},
        {&s->D[2 + 3], 1, 0},     {&s->F[0], 1, 0},     {&s->F[1], 1, 0},     {&s->F[2], 1, 1},
        {&s->e[0], -1, 0},        {&s->e[0], 1, 1}, /* a drop keeps it idle, a voltage that drives it does not
                                                     */
        {&s->e[1], 1, 0},         {&s->e[1], -1, 0},    {&s->e[2], 1, 1},     {&s->B[0], 1, 0},
        {&s->B[0], -2, 0},        {&s->B[2], 1, 0},     {&s->B[2 + 3], 1, 0}, {&s->C[0], 2, 0},
        {&s->C[0 + 3], -4, 0},    {&s->C[0 + 6], 1, 0}, {&s->C[1 + 6], 1, 0}, {&s->C[2], 1, 1},
        {&s->B[0], 0, 0},         {&s->C[0], 0, 0},
    };
    for (size_t k = 0; k < sizeof change / sizeof *change; k++) {
        const double was = *change[k].at;
        *change[k].at = change[k].value;
        if (found(s) != change[k].twins)
            fail_msg("change %zu", k);
        *change[k].at = was;
    }
    s->l[0] = -INFINITY, s->u[0] = 0; /* the other way round */
    assert_int_equal(found(s), 1);
    s->e[0] = 1;
    assert_int_equal(found(s), 0);
    s->e[0] = -1;
    assert_int_equal(found(s), 1);
    s->command[0].pair = 2; /* of a pair elsewhere */
    assert_int_equal(found(s), 0);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_makes_a_twin),
                                       cmocka_unit_test(without_unknowns), cmocka_unit_test(by_every_engine)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
