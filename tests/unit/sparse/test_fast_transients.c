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

static ns_signal sine(double amplitude, double hertz, double degrees) {
    return (ns_signal){.kind = NS_SIN, .u.sin = {.va = amplitude, .freq = hertz, .phase = degrees}};
}

/* A diode beside coils and RC snubbers, made small from a rectifier with 18 diodes.  FLOAT leads to ground by
 * R alone: its voltage is R times the sum of the coils' currents, which is zero at the start, and rises by
 * 15 V in the 3e-11 s of a transient that is passed. */
static double floating_start(double h) {
    enum { N302 = 1, N2, N320, FLOAT, N76, N286, N252, N304, N172, N338, N283, N109, N250 };
    const ns_diode diode = {0, 2e-4, INFINITY, INFINITY, 0};
    const ns_signal v1 = sine(632, 60, -120), v2 = sine(144, 28, 100), v3 = sine(381, 61, -100);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = NS_SPARSE};
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double w[40] = {0}, x[40];
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    ns_circuit_resistor(c, "r1", N302, N2, 6.4, NULL);
    ns_circuit_source(c, "v1", NS_VOLTAGE, N320, 0, &v1, NULL);
    ns_circuit_inductor(c, "l1", N2, FLOAT, 2.64e-3, 0, NULL);
    ns_circuit_inductor(c, "l2", N320, N76, 1.26e-3, 0, NULL);
    ns_circuit_capacitor(c, "c1", N286, FLOAT, 45e-9, 0, NULL);
    ns_circuit_inductor(c, "l3", N252, N302, 1.27e-3, 0, NULL);
    ns_circuit_resistor(c, "r2", N76, N286, 46.8, NULL);
    ns_circuit_inductor(c, "l4", N304, N172, 0.79e-3, 0, NULL);
    ns_circuit_resistor(c, "r3", FLOAT, 0, 662e3, NULL);
    ns_circuit_resistor(c, "r4", N172, N338, 57, NULL);
    ns_circuit_resistor(c, "r5", N283, N109, 286, NULL);
    ns_circuit_diode(c, "d1", N283, N252, &diode, NULL);
    ns_circuit_source(c, "v2", NS_VOLTAGE, N250, 0, &v2, NULL);
    ns_circuit_source(c, "v3", NS_VOLTAGE, N304, 0, &v3, NULL);
    ns_circuit_capacitor(c, "c2", N338, FLOAT, 15e-9, 0, NULL);
    ns_circuit_inductor(c, "l5", N250, N283, 0.94e-3, 0, NULL);
    ns_circuit_capacitor(c, "c3", N109, FLOAT, 42e-9, 0, NULL);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 40);
    assert_int_equal(ns_circuit_rest(c, w), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w), NS_OK);
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    const double v = x[ns_circuit_node_unknown(c, FLOAT)];
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    return v;
}

/* Of sources of 632 V. */
static void a_start_is_shown_where_it_begins(void **state) {
    (void)state;
    for (int k = 0; k < 5; k++)
        assert_true(fabs(floating_start(9e-6 + 1e-6 * k)) < 1e-4 * 632);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(quick_is_not_at_once),
                                       cmocka_unit_test(a_start_is_shown_where_it_begins)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
