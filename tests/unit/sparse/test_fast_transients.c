/* tests/unit/sparse/test_fast_transients.c - transients far shorter than h, which a diode remembers.
 *
 * C1 = C, at 1 V, discharges by 2 R, and by R and a diode into C2 = C.  In units of RC
 *
 *     v1' = -(v1 - v2) - v1/2,   v2' = v1 - v2      until v1 = v2, where the diode blocks:
 *
 * rates a, b = 5/4 -+ sqrt(17)/4;  v2 = (e^(-a s) - e^(-b s))/(b - a) from v2(0) = 0, v2'(0) = 1.  v2 keeps
 * its largest value, whatever RC is: v2' = 0 at s = ln(b/a)/(b - a).
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"

static double peak(void) {
    const double a = 1.25 - sqrt(17) / 4, b = 1.25 + sqrt(17) / 4, s = log(b / a) / (b - a);
    return (exp(-a * s) - exp(-b * s)) / (b - a);
}

/* v(C2) 10 h later, h = 1 us; besides it so many resistors, which make a circuit large. */
static double kept(ns_method method, double RC, int besides) {
    enum { N1 = 1, N2, N3, PADS };
    const double h = 1e-6, C = 1e-9, R = RC / C;
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = method};
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double w[200] = {0}, x[200], reached;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", N1, 0, C, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", N3, 0, C, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", N1, 0, 2 * R, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", N1, N2, R, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d", N2, N3, &ideal, NULL), NS_OK);
    for (int k = 0; k < besides; k++) {
        char name[8];
        snprintf(name, sizeof name, "r%d", 10 + k);
        assert_int_equal(ns_circuit_resistor(c, name, PADS + k, k ? PADS + k - 1 : 0, 1, NULL), NS_OK);
    }
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 200);
    assert_int_equal(ns_circuit_rest(c, w), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w), NS_OK);
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    assert_int_equal(ns_march_try(m, 10 * h, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    const double v = x[ns_circuit_node_unknown(c, N3)];
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    return v;
}

/* Down to h 2^-20: README says that what is closer counts as simultaneous; reltol is 1e-9, for some legs. */
static void quick_is_not_at_once(void **state) {
    (void)state;
    for (int k = 2; k <= 20; k += 3) {
        assert_true(fabs(kept(NS_SPARSE, ldexp(1e-6, -k), 0) - peak()) < 1e-8);
        assert_true(fabs(kept(NS_AUTO, ldexp(1e-6, -k), 70) - peak()) < 1e-8);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(quick_is_not_at_once)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
