/* tests/unit/sparse/test_short_room.c - a long step that soon ends at a corner of another source: what is
 * read in it has the digits of a whole step.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double t0 = 1e-5, fall = 1e-9, high = 15, ohm = 222.5, farad = 5.624e-10; /* s, s, V, ohm, F */

/* The voltage of the capacitor, t s after its source begins to fall: the circuit's own differential equation
 * solved by hand. */
static double expected(double t) {
    const double rc = ohm * farad, ramp = fmin(fmax(t, 0), fall), slope = high / fall;
    const double v = high - slope * (ramp + rc * expm1(-ramp / rc));
    return v * exp(-(fmax(t, 0) - ramp) / rc);
}

static void add_gate(ns_circuit *c, int node, double falls, const char *v, const char *r, const char *cap) {
    const ns_signal from = {.kind = NS_PULSE, .u.pulse = {high, 0, falls, fall, fall, 1, 2, 0}};
    assert_int_equal(ns_circuit_source(c, v, NS_VOLTAGE, node, 0, &from, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, r, node, node + 1, ohm, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, cap, node + 1, 0, farad, high, NULL), NS_OK);
}

/* The second gate falls `later` s after the first. */
static void follow(double later, ns_until until) {
    enum { MOST = 16, D = 1, G, E, H };
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE};
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[MOST], t = 0;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    add_gate(c, D, t0, "v1", "r1", "c1");
    add_gate(c, E, t0 + later, "v2", "r2", "c2");
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= MOST);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(c, x), NS_OK);
    assert_int_equal(ns_march_start(m, 0, x), NS_OK);
    while (t < 1.1e-5) {
        assert_int_equal(ns_march_try(m, 1.1e-5, until, &t), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        assert_int_equal(ns_march_read(m, &t, x, NULL, NULL), NS_OK);
        assert_true(fabs(x[ns_circuit_node_unknown(c, G)] - expected(t - t0)) < 1e-3 * high);
        assert_true(fabs(x[ns_circuit_node_unknown(c, H)] - expected(t - t0 - later)) < 1e-3 * high);
    }
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* Between the two corners a step of some 2e-7 s is made: the first gate read 25.6 V in place of 15 V there
 * (four-switch 72001000016), and a run that went on from what was read carried that on. */
static void gates_that_fall_together(void **state) {
    static const double later[] = {2e-21, 1e-18, 1e-15, 1e-12, 1e-10, 4e-10};
    (void)state;
    for (size_t i = 0; i < sizeof later / sizeof *later; i++) {
        follow(later[i], NS_TO_STEP);
        follow(later[i], NS_TO_EVENT);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gates_that_fall_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
