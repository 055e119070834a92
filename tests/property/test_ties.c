/* tests/property/test_ties.c - two switches, with hysteresis and without, that the same control commands,
 * mirrored: both thresholds are met in one instant, and both change, in whatever order they stand.
 *
 *     +V --S1-- x --L-- R -- 0      h = r - i;  S1: on above vh, off below -vh, by h; S2: the same by -h
 *     -V --S2-- x
 *
 * i rises from r-vh to r+vh while S1 is closed, and falls back while S2 is: closed forms of exponentials.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double V = 100, R = 2, L = 5e-3, end = 5e-3;

typedef struct bridge {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
} bridge;

enum { P = 1, N, X, Y, O, H, I, REF, MINUS };

static void add_switch(ns_circuit *c, int upper, int through, double vh) {
    const ns_switch law = {.vt = 0, .vh = vh, .ron = 0, .roff = INFINITY};
    const int from = upper ? P : X, to = upper ? X : N;
    if (upper)
        assert_int_equal(ns_circuit_switch(c, "s1", from, to, H, 0, &law, NULL), NS_OK);
    else
        assert_int_equal(
            ns_circuit_switch(c, "s2", from, to, through ? MINUS : 0, through ? 0 : H, &law, NULL), NS_OK);
}

/* first: which switch stands first; through: the lower one by a source of -h. */
static bridge make(ns_method method, int first, int through, double r, double vh) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-5, .method = method};
    const ns_signal up = {.kind = NS_DC, .u.dc = V}, down = {.kind = NS_DC, .u.dc = -V},
                    ref = {.kind = NS_DC, .u.dc = r}, none = {.kind = NS_DC};
    bridge b;
    double w0[20];
    int by;
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vp", NS_VOLTAGE, P, 0, &up, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vn", NS_VOLTAGE, N, 0, &down, NULL), NS_OK);
    add_switch(b.c, first, through, vh);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", X, Y, L, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vi", NS_VOLTAGE, Y, O, &none, &by), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", O, 0, R, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vr", NS_VOLTAGE, REF, 0, &ref, NULL), NS_OK);
    assert_int_equal(ns_circuit_icontrolled(b.c, "h1", NS_VOLTAGE, I, 0, by, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(b.c, "e1", NS_VOLTAGE, H, 0, REF, I, 1, NULL), NS_OK);
    if (through)
        assert_int_equal(ns_circuit_vcontrolled(b.c, "e2", NS_VOLTAGE, MINUS, 0, 0, H, 1, NULL), NS_OK);
    add_switch(b.c, !first, through, vh);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_circuit_rest(b.c, w0), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(b.m, 0, w0), NS_OK);
    return b;
}

static void drop(bridge b) {
    ns_march_free(b.m);
    ns_system_free(b.s);
    ns_circuit_free(b.c);
}

/* Goes through all events, each at its instant: exactly one switch is closed, the other one after each. */
static void check(ns_method method, int first, int through, double r, double vh) {
    bridge b = make(method, first, through, r, vh);
    const double tau = L / R, most = V / R;
    double t = 0, expected = 0, from = 0;
    for (int up = 1; t < end; up = !up) {
        const double to = up ? r + vh : r - vh, limit = up ? most : -most;
        const ns_mode *mode = ns_march_mode(b.m);
        assert_int_equal(mode[0] == NS_INSIDE, up == first);
        assert_int_equal(mode[1] == NS_INSIDE, up != first);
        expected += tau * log((limit - from) / (limit - to));
        from = to;
        if (expected > end)
            break;
        assert_int_equal(ns_march_try(b.m, end, NS_TO_EVENT, &t), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        if (fabs(t - expected) > 1e-9 * end)
            fail_msg("method %d, order %d, control %d: at %.12g s, expected %.12g s", method, first, through,
                     t, expected);
        assert_int_equal(ns_march_try(b.m, end, NS_TO_EVENT, &t), NS_OK); /* its right side */
        assert_int_equal(ns_march_accept(b.m), NS_OK);
    }
    drop(b);
}

static void both_change(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_AUTO};
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int variant = 0; variant < 4; variant++)
            for (int i = 0; i < 25; i++)
                check(methods[k], variant & 1, variant >> 1, 1.5 + 0.25 * i, 0.11 + 0.0371 * i);
}

/* The same two switches without hysteresis, commanded by +- the voltage of a capacitor that 1 A charges from
 * -1 V on: S1 closes where S2 opens, at `crossing`.  The current of L: exponentials to -V/R, then to V/R. */
static void add_mirrored(ns_circuit *c, int upper, int through, double vt) {
    const ns_switch law = {.vt = upper ? vt : -vt, .roff = INFINITY};
    const int from = upper ? P : X, to = upper ? X : N;
    const int cp = upper ? H : through ? MINUS : 0, cn = upper || through ? 0 : H;
    assert_int_equal(ns_circuit_switch(c, upper ? "s1" : "s2", from, to, cp, cn, &law, NULL), NS_OK);
}

static void check_without_hysteresis(ns_method method, int first, int through, double vt) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-3, .method = method};
    const ns_signal up = {.kind = NS_DC, .u.dc = V}, down = {.kind = NS_DC, .u.dc = -V},
                    one = {.kind = NS_DC, .u.dc = 1};
    bridge b;
    double w0[20], x[20], t = 0;
    int coil;
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vp", NS_VOLTAGE, P, 0, &up, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vn", NS_VOLTAGE, N, 0, &down, NULL), NS_OK);
    add_mirrored(b.c, first, through, vt);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", X, Y, 1, 0, &coil), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", Y, 0, R, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "i1", NS_CURRENT, 0, H, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", H, 0, 1, -1, NULL), NS_OK);
    if (through)
        assert_int_equal(ns_circuit_vcontrolled(b.c, "e2", NS_VOLTAGE, MINUS, 0, 0, H, 1, NULL), NS_OK);
    add_mirrored(b.c, !first, through, vt);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_circuit_rest(b.c, w0), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(b.m, 0, w0), NS_OK);
    while (t < 2) {
        assert_int_equal(ns_march_try(b.m, 2, NS_TO_TIME, &t), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
    }
    assert_int_equal(ns_march_read(b.m, &t, x, NULL, NULL), NS_OK);
    const double crossing = 1 + vt, there = -V / R * (1 - exp(-R * crossing));
    const double right = V / R + (there - V / R) * exp(-R * (2 - crossing));
    const double got = x[ns_circuit_current_unknown(b.c, coil)];
    if (!(fabs(got - right) < 1e-6 * V / R))
        fail_msg("method %d, order %d, control %d, vt %g: %.9g A, expected %.9g A", method, first, through,
                 vt, got, right);
    drop(b);
}

static void both_change_without_hysteresis(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_AUTO};
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int variant = 0; variant < 4; variant++)
            for (int i = 0; i < 9; i++)
                check_without_hysteresis(methods[k], variant & 1, variant >> 1, -0.8 + 0.2 * i);
}

/* S2 by -gain times the control of S1, which starts on its threshold and leaves it by `slope`: the coil gets
 * +-V from the first instant on.  Nobody retries: the control that is zero but for a rounding of V is no
 * contradiction. */
static void check_start_on_threshold(ns_method method, double gain, double vt, double slope, double coil) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1.5e-8, .method = method};
    const ns_signal up = {.kind = NS_DC, .u.dc = V}, down = {.kind = NS_DC, .u.dc = -V},
                    by = {.kind = NS_DC, .u.dc = slope};
    const ns_switch s1 = {.vt = vt, .roff = INFINITY}, s2 = {.vt = -vt * gain, .roff = INFINITY};
    const double first = 1e-9;
    bridge b;
    double x[20], t = 0;
    int l;
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vp", NS_VOLTAGE, P, 0, &up, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vn", NS_VOLTAGE, N, 0, &down, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "i1", NS_CURRENT, 0, H, &by, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", H, 0, 1e-3, vt, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(b.c, "e1", NS_VOLTAGE, MINUS, 0, 0, H, gain, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", P, X, H, 0, &s1, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s2", X, N, MINUS, 0, &s2, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", X, Y, coil, 0, &l), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", Y, 0, R, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_circuit_rest(b.c, x), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(b.m, 0, x), NS_OK);
    while (t < first) {
        assert_int_equal(ns_march_try(b.m, first, NS_TO_TIME, &t), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
    }
    assert_int_equal(ns_march_read(b.m, &t, x, NULL, NULL), NS_OK);
    const double right = copysign(V, slope) / R * -expm1(-first * R / coil);
    const double got = x[ns_circuit_current_unknown(b.c, l)];
    if (!(fabs(got - right) < 1e-8 * fabs(right)) || ns_march_counts(b.m)->retries > 0)
        fail_msg("method %d, gain %g, vt %g, slope %g, L %g: %.12g A, expected %.12g A, %ld retries", method,
                 gain, vt, slope, coil, got, right, ns_march_counts(b.m)->retries);
    drop(b);
}

static void controls_start_on_their_thresholds(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_AUTO};
    static const double gains[] = {0.05, 0.2, 0.3, 1, 3, 7}, thresholds[] = {0, 0.1, 1, -0.3},
                        slopes[] = {1, -1, 0.03}, coils[] = {1e-6, 1e-4, 1e-2};
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 6 * 4 * 3 * 3; i++)
            check_start_on_threshold(methods[k], gains[i % 6], thresholds[i / 6 % 4], slopes[i / 24 % 3],
                                     coils[i / 72]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(both_change),
                                       cmocka_unit_test(both_change_without_hysteresis),
                                       cmocka_unit_test(controls_start_on_their_thresholds)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
