/* tests/unit/march/test_shared_charge.c - capacitors that share their charge through a diode of a small
 * resistance, in a time that no step resolves, while others go on slowly: by charge conservation.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

typedef struct values {
    double R, ohm;                 /* of the source, of the diodes */
    double upper, lower, held, at; /* F, F, F; V of the held one */
} values;

/* 300 V behind R at node P, from there two capacitors in series to ground, without charge, the middle M of
 * which one diode clamps; a diode from A, a capacitor with charge. */
static ns_circuit *divider(const values *v, int clamps_low, int *a) {
    enum { E = 1, P, M, A };
    const ns_signal dc = {.kind = NS_DC, .u.dc = 300};
    const ns_diode d = {.vf = 0, .ron = v->ohm, .roff = INFINITY, .vz = INFINITY};
    ns_circuit *c;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, E, 0, &dc, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r", E, P, v->R, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c3", A, 0, v->held, v->at, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", A, P, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", P, M, v->upper, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", M, 0, v->lower, 0, NULL), NS_OK);
    assert_int_equal(clamps_low ? ns_circuit_diode(c, "d2", 0, M, &d, NULL)
                                : ns_circuit_diode(c, "d2", M, P, &d, NULL),
                     NS_OK);
    *a = A;
    return c;
}

/* The diode charges P from A in 1e-17 s or so; then R does in 1e-12 to 1e-10 s, and the diode blocks: A keeps
 * what it had then. */
static void share(ns_method method, const values *v, int clamps_low) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 4.85e-8, .method = method};
    const double series = 1 / (1 / v->upper + 1 / v->lower), expected = v->at * v->held / (v->held + series);
    ns_system *s;
    ns_march *m;
    double x[16], reached;
    int a;
    ns_circuit *c = divider(v, clamps_low, &a);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 16);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(c, x), NS_OK);
    assert_int_equal(ns_march_start(m, 0, x), NS_OK);
    assert_int_equal(ns_march_try(m, 1e-7, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    const double got = x[ns_circuit_node_unknown(c, a)];
    if (!(fabs(got - expected) <= 1e-4 * v->at))
        fail_msg("%.9g V, expected %.9g V", got, expected);
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

static void share_in_no_time(void **state) {
    static const values of[] = {{0.0188386322, 4.83119258e-8, 16.9905e-12, 589.0066e-12, 12.0239e-12, 184.5},
                                {1.0254552178, 2.2699121e-7, 40.4331e-12, 149.6791e-12, 582.0469e-12, 264.65},
                                {0.3445, 2.305e-7, 90.5e-12, 90.5e-12, 81.66e-12, 200}};
    for (int i = 0; i < 6; i++)
        share(*(const ns_method *)*state, &of[i / 2], i % 2);
}

int main(void) {
    static ns_method exact = NS_EXACT, sparse = NS_SPARSE;
    const struct CMUnitTest tests[] = {{"share in no time, exact", share_in_no_time, NULL, NULL, &exact},
                                       {"share in no time, sparse", share_in_no_time, NULL, NULL, &sparse}};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
