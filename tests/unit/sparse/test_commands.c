/* tests/unit/sparse/test_commands.c - a switch commanded by sources alone, past its threshold for a short
 * while.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double pi = 3.14159265358979323846, far = 1e-3;

static ns_signal sine(double va, double freq, double theta) {
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.va = va;
    s.u.sin.freq = freq;
    s.u.sin.theta = theta;
    return s;
}

/* When a switch that closes at the sum of two sources above vt, and never opens, closes; far: not before. */
static double closes(ns_method method, const ns_signal *a, const ns_signal *b, double vt) {
    const ns_switch latch = {vt - 5, 5, 1, INFINITY};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double w0[8], t = 0;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "va", NS_VOLTAGE, 1, 0, a, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "vb", NS_VOLTAGE, 2, 1, b, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 3, 0, 2, 0, &latch, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 3, 0, 1e-6, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    while (t < far && ns_march_mode(m)[0] != NS_INSIDE) {
        assert_int_equal(ns_march_try(m, far, NS_TO_EVENT, &t), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
    }
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    return t;
}

/* Just above the most that the sum ever is it stays open; just below, it closes where the sum, which rises
 * until then, comes to vt: halved down to that.  t is known to rounding over a slope of sqrt(2 below bend).
 */
static void check(const char *name, const ns_signal *a, const ns_signal *b, double at_most) {
    const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    const double top = ns_signal_value(a, at_most, NS_LEFT) + ns_signal_value(b, at_most, NS_LEFT);
    for (int k = 0; k < 2; k++)
        for (int p = 2; p <= 8; p += 2) {
            const double vt = top - pow(10, -p);
            double low = 0, high = at_most;
            for (int i = 0; i < 100; i++) {
                const double mid = (low + high) / 2;
                *(ns_signal_value(a, mid, NS_LEFT) + ns_signal_value(b, mid, NS_LEFT) > vt ? &high : &low) =
                    mid;
            }
            const double t = closes(methods[k], a, b, vt);
            print_message("%s, %s: %g V below closes at %.12g s, expected %.12g s\n", name,
                          k ? "sparse" : "exact", pow(10, -p), t, high);
            assert_true(fabs(t - high) < 1e-13);
            assert_true(closes(methods[k], a, b, top + pow(10, -p)) >= far);
        }
}

/* Most where d/dt sin wt = 5000/s, far from the crest of the sine, at which the sum is below 0. */
static void sine_less_ramp(void **unused) {
    (void)unused;
    const double w = 2 * pi * 1e3, t[] = {0, far}, v[] = {0, -5};
    const ns_signal a = sine(1, 1e3, 0);
    ns_signal b = {.kind = NS_PWL};
    b.u.pwl.n = 2;
    b.u.pwl.t = t;
    b.u.pwl.v = v;
    b.u.pwl.repeat = NAN;
    check("sine less ramp", &a, &b, acos(5000 / w) / w);
}

/* exp(-theta t) sin wt is most at tan wt = w/theta, before its crest. */
static void damped_sine(void **unused) {
    (void)unused;
    const double w = 2 * pi * 1e3;
    const ns_signal a = sine(1, 1e3, 1e4), none = {.kind = NS_DC};
    check("damped sine", &a, &none, atan2(w, 1e4) / w);
}

/* 5 (exp(-t/tau) - exp(-t/tau')): up by 1/tau', down by 1/tau; no sine and no corner tells where it turns. */
static void exponentials(void **unused) {
    (void)unused;
    const double slow = 5e-5, fast = 1e-5;
    ns_signal a = {.kind = NS_EXP}, b = {.kind = NS_EXP};
    a.u.exp.v2 = 5;
    a.u.exp.tau1 = fast;
    b.u.exp.v2 = -5;
    b.u.exp.tau1 = slow;
    a.u.exp.td2 = b.u.exp.td2 = 1;
    a.u.exp.tau2 = b.u.exp.tau2 = 1;
    check("exponentials", &a, &b, log(slow / fast) / (1 / fast - 1 / slow));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(sine_less_ramp), cmocka_unit_test(damped_sine),
                                       cmocka_unit_test(exponentials)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
