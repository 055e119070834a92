/* tests/unit/theta/test_regularise.c - what a mode leaves open, as the limit of leaks. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "net.h"
#include "theta/regularise.h"
#include "theta/theta_internal.h"

enum { MOST = 3 * NET_MOST };
static const double h = 1e-3;

/* (P2) of the net's mode at rest: size unknowns. */
static int prepare(net *k, ns_leaks *leaks) {
    *leaks = (ns_leaks){k->step->past.mode, h, k->step->leak};
    return ns_theta_map_matrix(k->step, h, 1, leaks->mode);
}

/* out = K x. */
static void times(const net *k, int size, const double *x, double *out) {
    for (int i = 0; i < size; i++) {
        out[i] = 0;
        for (int j = 0; j < size; j++)
            out[i] += k->step->K[i + j * size] * x[j];
    }
}

/* X: the solution that leaks choose of those that x, which is one, belongs to. */
static void solve(net *k, const ns_leaks *leaks, int nj, const double *x, double *X) {
    const int size = k->s->n + nj;
    double again[MOST], rhs[MOST];
    times(k, size, x, rhs);
    memcpy(k->step->X, rhs, sizeof *rhs * (size_t)size);
    assert_int_equal(ns_theta_leak_solve(k->step, leaks, nj, 1), NS_OK);
    memcpy(X, k->step->X, sizeof *X * (size_t)size);
    times(k, size, X, again);
    for (int i = 0; i < size; i++)
        assert_true(fabs(again[i] - rhs[i]) < 1e-12 * fmax(1, fabs(rhs[i])));
}

/* Switches a, b, c in parallel, of which a and b are closed, carry 1 A from node 1 to 2; nodes 3 and 4,
 * joined by a resistor, hang between open switches to 1 (at 1 V) and to ground; nodes 5 and 6, joined by a
 * capacitor of `farads`, likewise; 7 joins 2 by a closed switch and carries nothing. */
static net three_open_questions(double farads) {
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 1);
    net_contact(&k, "a", 1, 2, 1);
    net_contact(&k, "b", 1, 2, 1);
    net_contact(&k, "c", 1, 2, 0);
    net_resistor(&k, "r", 2, 0, 1);
    net_contact(&k, "d", 1, 3, 0);
    net_resistor(&k, "s", 3, 4, 1);
    net_contact(&k, "e", 4, 0, 0);
    net_contact(&k, "f", 1, 5, 0);
    net_capacitor(&k, "q", 5, 6, farads, 0);
    net_contact(&k, "g", 6, 0, 0);
    net_contact(&k, "i", 2, 7, 1);
    net_resistor(&k, "t", 7, 8, 1);
    net_prepare(&k);
    return k;
}

/* Equal leaks: the currents are halves, and what hangs between 1 V and ground is at 1/2 V.  A leak of 1e-10
 * leaves of rounding 1e-16/1e-10 in what it alone decides. */
static void equal_leaks_share_alike(void **state) {
    (void)state;
    ns_leaks leaks;
    net k = three_open_questions(1e-3);
    double x[MOST] = {0}, X[MOST];
    const int n = k.s->n, nj = prepare(&k, &leaks);
    assert_int_equal(nj, 3);
    const int v3 = ns_circuit_node_unknown(k.c, 3), v4 = ns_circuit_node_unknown(k.c, 4);
    for (int node = 1; node <= 8; node++)
        if (ns_circuit_node_unknown(k.c, node) >= 0)
            x[ns_circuit_node_unknown(k.c, node)] = node < 3 || node > 6 ? 1 : 0.7;
    x[n] = 0.9;
    x[n + 1] = 0.1;
    solve(&k, &leaks, nj, x, X);
    assert_true(fabs(X[n] - 0.5) < 1e-6 && fabs(X[n + 1] - 0.5) < 1e-6);
    assert_true(fabs(X[n + 2]) < 1e-12); /* determined */
    assert_true(fabs(X[v3] - 0.5) < 1e-6 && fabs(X[v4] - 0.5) < 1e-6);
    net_end(&k);
}

/* Three switches in parallel beside a resistor of `ohm` across the source, in whose units the source's row
 * is: a third each. */
static void other_units_change_no_shares(void **state) {
    (void)state;
    static const double ohm[] = {1, 1e-6, 1e6};
    for (int r = 0; r < 3; r++) {
        ns_leaks leaks;
        net k = net_begin();
        net_voltage(&k, "v", 1, 0, 1);
        net_resistor(&k, "u", 1, 0, ohm[r]);
        net_contact(&k, "a", 1, 2, 1);
        net_contact(&k, "b", 1, 2, 1);
        net_contact(&k, "c", 1, 2, 1);
        net_resistor(&k, "r", 2, 0, 1);
        net_prepare(&k);
        double x[MOST] = {0}, X[MOST];
        const int n = k.s->n, nj = prepare(&k, &leaks);
        assert_int_equal(nj, 3);
        x[ns_circuit_node_unknown(k.c, 1)] = x[ns_circuit_node_unknown(k.c, 2)] = x[n] = 1;
        solve(&k, &leaks, nj, x, X);
        for (int j = 0; j < 3; j++)
            assert_true(fabs(X[n + j] - 1. / 3) < 1e-6);
        net_end(&k);
    }
}

/* Two open switches in series between 1 V and a resistor of `ohm` to ground, in whose units the rows of nodes
 * are: half of 1 V each. */
static void other_units_change_no_voltages(void **state) {
    (void)state;
    static const double ohm[] = {1e-4, 3e4, 5e4, 1e5};
    for (int r = 0; r < 4; r++) {
        ns_leaks leaks;
        net k = net_begin();
        net_voltage(&k, "v", 1, 0, 1);
        net_contact(&k, "a", 1, 2, 0);
        net_contact(&k, "b", 2, 3, 0);
        net_resistor(&k, "r", 3, 0, ohm[r]);
        net_prepare(&k);
        double x[MOST] = {0}, X[MOST];
        const int v2 = ns_circuit_node_unknown(k.c, 2), nj = prepare(&k, &leaks);
        assert_int_equal(nj, 0);
        x[ns_circuit_node_unknown(k.c, 1)] = 1;
        solve(&k, &leaks, nj, x, X);
        assert_true(fabs(X[v2] - 0.5) < 1e-3);
        net_end(&k);
    }
}

/* The factors are those of K + G: (K + G)^-1 (K x + G x) = x.  In the directions that K leaves open that is
 * G's doing alone, to the digits that a leak of 1e-10 leaves. */
static void the_product_is_that_of_the_factors(void **state) {
    (void)state;
    static const double farads[] = {1e-3, 1e-9, 1};
    for (int run = 0; run < 60; run++) {
        dice d = dice_make(71, (unsigned)run);
        ns_leaks leaks;
        net k = three_open_questions(farads[run % 3]);
        double zero[MOST] = {0}, x[MOST], X[MOST], sum[MOST], by[MOST];
        const int nj = prepare(&k, &leaks), size = k.s->n + nj;
        solve(&k, &leaks, nj, zero, X); /* leaks and factors */
        for (int i = 0; i < size; i++)
            x[i] = dice_either(&d);
        times(&k, size, x, sum);
        ns_theta_leak_times(k.step, &leaks, x, by);
        for (int i = 0; i < size; i++)
            sum[i] += by[i];
        ns_linalg_lu_solve(k.step->lu, 1, sum);
        for (int i = 0; i < size; i++)
            assert_true(fabs(sum[i] - x[i]) < 1e-3);
        net_end(&k);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_leaks_share_alike),
        cmocka_unit_test(other_units_change_no_shares),
        cmocka_unit_test(other_units_change_no_voltages),
        cmocka_unit_test(the_product_is_that_of_the_factors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
