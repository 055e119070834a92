/* tests/unit/sparse/test_start_at_rest.c - a start at which nothing flows: all that the fluxes have is
 * rounding.
 *
 * Two legs at 26.39 V between M and N, each a node X with a diode to A, which one from M clamps, and a diode
 * from B, which has one from N and one to M; R and L join X of both in one point.  The diodes leak alike: A
 * is at M, B at (X + M + N)/3, and (M - X) + (B - X) = 0 is X = (4 M + N)/5 for both, so that no current
 * flows.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { M = 1, N, STAR, LEG, LEG_NODES = 5, ALL = 40 };

static const double volts = 26.39, roff = 2.853e7;

/* A name of its own for each element: by kind and nodes. */
static const char *name_of(char kind, int p, int n) {
    static char name[8];
    snprintf(name, sizeof name, "%c%d_%d", kind, p % 100, n % 100);
    return name;
}

static void diode(ns_circuit *c, int anode, int cathode) {
    const ns_diode d = {.vf = 0, .ron = 0, .roff = roff, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(c, name_of('d', anode, cathode), anode, cathode, &d, NULL), NS_OK);
}

static void add_leg(ns_circuit *c, int x, double ohm, double henry, int *coil) {
    const int a = x + 1, b = x + 2, w = x + 3, o = x + 4;
    diode(c, x, a);
    diode(c, b, x);
    diode(c, N, b);
    diode(c, M, a);
    diode(c, b, M);
    assert_int_equal(ns_circuit_resistor(c, name_of('r', x, w), x, w, ohm, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, name_of('l', w, o), w, o, henry, 0, coil), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, name_of('r', o, STAR), o, STAR, 3.007, NULL), NS_OK);
}

static void nothing_flows(void **state) {
    const ns_signal dc = {.kind = NS_DC, .u.dc = volts};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1.435e-8, .method = NS_SPARSE};
    static const double ohm[] = {0.03877, 0.06319}, henry[] = {0.0001258, 0.0001627};
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[ALL];
    int coil[2];
    (void)state;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, M, N, &dc, NULL), NS_OK);
    for (int k = 0; k < 2; k++)
        add_leg(c, LEG + k * LEG_NODES, ohm[k], henry[k], &coil[k]);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= ALL);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(c, x), NS_OK);
    assert_int_equal(ns_march_start(m, 0, x), NS_OK);
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    for (int k = 0; k < 2; k++) {
        const double at = x[ns_circuit_node_unknown(c, LEG + k * LEG_NODES)],
                     n = x[ns_circuit_node_unknown(c, N)];
        assert_true(fabs(at - n - 0.8 * volts) <= 1e-8 * volts);
        assert_true(fabs(x[ns_circuit_current_unknown(c, coil[k])]) <= 1e-7 * volts / roff);
    }
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_flows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
