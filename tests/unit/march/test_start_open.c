/* tests/unit/march/test_start_open.c - the operating point of a node that only a capacitor and a diode hold.
 *
 * The laws leave it open from vf below the source on upwards; a leak of the diode, which is one of its
 * voltage (i = v/roff), puts it at the source: 0 V across the diode, as with any roff.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

/* v(2) of the operating point: volts at node 1, diode 1-2, 1 uF from there. */
static double rests_at(ns_method method, double volts, double vf, double roff) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    const ns_diode d = {vf, 0, roff, INFINITY, 0};
    ns_signal s = {.kind = NS_DC};
    ns_circuit *c;
    ns_system *system;
    ns_march *m;
    double x[8];
    s.u.dc = volts;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 1, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 2, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(c, &system), NS_OK);
    assert_true(system->n <= 8);
    assert_int_equal(ns_march_create(system, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start_dc(m, 0, 0, NULL, NULL, x), NS_OK);
    const double v = x[ns_circuit_node_unknown(c, 2)];
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    assert_true(fabs(x[ns_circuit_node_unknown(c, 2)] - v) < 1e-12); /* and begins there */
    ns_march_free(m);
    ns_system_free(system);
    ns_circuit_free(c);
    return v;
}

static void at_the_source(void **unused) {
    (void)unused;
    const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA};
    const double volts[] = {0, 5, -3}, roff[] = {INFINITY, 1e6}, vf[] = {0, 0.7};
    for (int k = 0; k < 3 * 3 * 2 * 2; k++) {
        const double at = volts[k / 3 % 3];
        const double v = rests_at(methods[k % 3], at, vf[k / 18], roff[k / 9 % 2]);
        print_message("method %d, %g V, vf %g V, roff %g: %.15g V\n", (int)methods[k % 3], at, vf[k / 18],
                      roff[k / 9 % 2], v);
        assert_true(fabs(v - at) < 1e-12);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(at_the_source)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
