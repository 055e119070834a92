/* tests/unit/sparse/test_engine.c - the sparse marcher against closed forms: linear circuits, starts. */
#include "parts.h"
#include "systems.h"

/* --- linear --- */

/* v = e^-t */
static void test_decay(void **state) {
    (void)state;
    rig k = {.s = system_decay()};
    const ns_march_options o = {.h = 0.5, .method = NS_SPARSE, .reltol = 1e-11};
    const double w0[] = {1};
    double x, reached;
    assert_int_equal(ns_march_create(k.s, &o, &k.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(k.m, 0, w0), NS_OK);
    for (int i = 1; i < 40; i++) {
        assert_int_equal(ns_march_try(k.m, 0.13 * i, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        assert_int_equal(ns_march_read(k.m, NULL, &x, NULL, NULL), NS_OK);
        near(x, exp(-0.13 * i), 1);
    }
    end(&k);
}

/* After a run of 1e9 V one of 1 V is as exact as if it were the first: sizes of the run before are forgotten.
 */
static void a_start_forgets_the_run_before(void **state) {
    (void)state;
    rig k = {.s = system_decay()};
    const ns_march_options o = {.h = 0.5, .method = NS_SPARSE, .reltol = 1e-11};
    const double large = 1e9, one = 1;
    double x, reached;
    assert_int_equal(ns_march_create(k.s, &o, &k.m, NULL), NS_OK);
    for (int run = 0; run < 2; run++) {
        assert_int_equal(ns_march_start(k.m, 0, run ? &one : &large), NS_OK);
        assert_int_equal(ns_march_try(k.m, 3, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
    }
    assert_int_equal(ns_march_read(k.m, NULL, &x, NULL, NULL), NS_OK);
    near(x, exp(-3), 1);
    end(&k);
}

/* RC = 1 ms behind a source.  Ramp of slope a from 0:  v = a (t - tau + tau e^(-t/tau)).  Sine sin(wt):
 *     v = (sin wt - w tau cos wt + w tau e^(-t/tau)) / (1 + (w tau)^2).
 * 1 - e^(-t/T):  v = 1 - (T e^(-t/T) - tau e^(-t/tau)) / (T - tau). */
static void test_inputs(void **state) {
    (void)state;
    const double tau = 1e-3, w = 2 * acos(-1.0) * 500, T = 3e-3;
    rig k = begin();
    ns_signal ramp = {.kind = NS_PWL}, sine = {.kind = NS_SIN}, rise = {.kind = NS_EXP};
    const double at[] = {0, 1}, volts[] = {0, 2000};
    ramp.u.pwl.n = 2;
    ramp.u.pwl.t = at;
    ramp.u.pwl.v = volts;
    ramp.u.pwl.repeat = NAN;
    sine.u.sin.va = 1;
    sine.u.sin.freq = 500;
    rise.u.exp.v2 = 1;
    rise.u.exp.tau1 = T;
    rise.u.exp.td2 = 1;
    rise.u.exp.tau2 = 1;
    const ns_signal *const all[] = {&ramp, &sine, &rise};
    for (int i = 0; i < 3; i++) {
        char name[] = "v0", r[] = "r0", c[] = "c0";
        name[1] = r[1] = c[1] = (char)('1' + i);
        source(&k, name, 1 + 2 * i, all[i]);
        resistor(&k, r, 1 + 2 * i, 2 + 2 * i, 1e3);
        capacitor(&k, c, 2 + 2 * i, 0, 1e-6, 0);
    }
    ready(&k, 1e-3);
    for (int i = 1; i <= 50; i++) {
        const double t = 1.37e-4 * i, left = exp(-t / tau);
        go(&k, t);
        near(voltage(&k, 2), 2000 * (t - tau + tau * left), 10);
        near(voltage(&k, 4), (sin(w * t) - w * tau * (cos(w * t) - left)) / (1 + w * w * tau * tau), 1);
        near(voltage(&k, 6), 1 - (T * exp(-t / T) - tau * left) / (T - tau), 1);
    }
    end(&k);
}

/* A stiff part (1 ns) that follows a slow one: damped, not resolved; few steps. */
static void test_stiff(void **state) {
    (void)state;
    rig k = begin();
    capacitor(&k, "c1", 1, 0, 1e-6, 1);
    resistor(&k, "r1", 1, 0, 1e3);
    resistor(&k, "r2", 1, 2, 1);
    capacitor(&k, "c2", 2, 0, 1e-9, 1);
    ready(&k, 1e-3);
    go(&k, 5e-3);
    /* slow eigenvalue of the two: a (1-e) with a = 1/(R1 (C1+C2)); the correction R2 C2/(R1 C1) is 1e-6 */
    const double g1 = 1e-3, g2 = 1, c1 = 1e-6, c2 = 1e-9, b = (g1 + g2) / c1 + g2 / c2;
    const double slow = 2 * (g1 * g2 / (c1 * c2)) / (b + sqrt(b * b - 4 * g1 * g2 / (c1 * c2)));
    const double fast = b - slow;
    /* v1(0) = v2(0) = 1: v1 = A e^(-slow t) + ..., with A from v1'(0) = -g1/c1 */
    near(voltage(&k, 1), (fast - g1 / c1) / (fast - slow) * exp(-slow * 5e-3), 1);
    assert_true(ns_march_counts(k.m)->steps < 250);
    end(&k);
}

static void test_bridge(void **state) {
    (void)state;
    rig k = {.s = system_lc_bridge()};
    const ns_march_options o = {.h = 50e-6, .method = NS_SPARSE, .reltol = 1e-11};
    const double w0[] = {10e-6, 0};
    double x[2], reached;
    assert_int_equal(ns_march_create(k.s, &o, &k.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(k.m, 0, w0), NS_OK);
    for (int i = 1; i <= 500; i++) {
        assert_int_equal(ns_march_try(k.m, 1e-5 * i, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        assert_int_equal(ns_march_read(k.m, NULL, x, NULL, NULL), NS_OK);
        near(x[0], lc_bridge_v(10, 1e-5 * i), 10);
    }
    assert_int_equal(ns_march_counts(k.m)->events, 16); /* w/pi zeros in 5 ms */
    end(&k);
}

/* --- starts, tries --- */

/* 10 V over 1 kohm onto a diode and 1 kohm: 5 V.  Held at 3 V it starts from there and goes to 5 V with
 * 500 ohm times 1 uF. */
static void test_dc(void **state) {
    (void)state;
    rig k = begin();
    constant(&k, "vin", 1, 10);
    resistor(&k, "r1", 1, 2, 1e3);
    diode(&k, "d", 2, 3);
    resistor(&k, "r2", 3, 0, 1e3);
    capacitor(&k, "c", 3, 0, 1e-6, NAN);
    make(&k, 1e-4);
    assert_int_equal(ns_march_start_dc(k.m, 0, 0, NULL, NULL, k.x), NS_OK);
    near(voltage(&k, 3), 5, 10);
    go(&k, 1e-3);
    near(voltage(&k, 3), 5, 10);
    const int hold = ns_circuit_node_unknown(k.c, 3);
    const double at = 3;
    assert_int_equal(ns_march_start_dc(k.m, 0, 1, &hold, &at, k.x), NS_OK);
    near(voltage(&k, 3), 3, 10);
    go(&k, 1e-3);
    near(voltage(&k, 3), 5 - 2 * exp(-2), 10);
    end(&k);
}

/* Times inside a long step: what is added to its begin again, t - begin, is not t for some of them. */
static void test_odd_times(void **state) {
    (void)state;
    rig k = begin();
    capacitor(&k, "c", 1, 0, 1e-6, 1);
    resistor(&k, "r", 1, 0, 1e6);
    make(&k, 1e-3);
    for (int j = 0; j < 16; j++) {
        const double from = 1e-4 / (3 + 0.01 * j);
        assert_int_equal(ns_circuit_rest(k.c, k.x), NS_OK);
        assert_int_equal(ns_march_start(k.m, from, k.x), NS_OK);
        for (int i = 0; i < 20; i++)
            go(&k, 1.7e-4 + i * 1e-6 / 7);
        near(voltage(&k, 1), exp(-(1.7e-4 + 19e-6 / 7 - from)), 1);
    }
    end(&k);
}

static void test_refused(void **state) {
    (void)state;
    rig k = begin();
    ns_march *m;
    double reached;
    const ns_march_options good = {.h = 1e-3, .method = NS_SPARSE}, zero = {.method = NS_SPARSE},
                           negative = {.h = 1, .reltol = -1, .method = NS_SPARSE};
    capacitor(&k, "c", 1, 0, 1e-6, 1);
    resistor(&k, "r", 1, 0, 1e3);
    make(&k, 1e-3);
    assert_int_equal(ns_march_create(k.s, &zero, &m, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_create(k.s, &negative, &m, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_create(NULL, &good, &m, NULL), NS_E_NULL);
    assert_null(m);
    assert_int_equal(ns_march_create(k.s, &good, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_try(k.m, 1, NS_TO_TIME, &reached), NS_E_STATE);
    assert_int_equal(ns_march_accept(k.m), NS_E_STATE);
    assert_int_equal(ns_march_read(k.m, NULL, NULL, NULL, NULL), NS_E_STATE);
    assert_int_equal(ns_march_start(k.m, NAN, k.x), NS_E_NUMBER);
    assert_int_equal(ns_march_start(k.m, 0, (const double[]){NAN}), NS_E_NUMBER);
    assert_int_equal(ns_march_start_dc(k.m, 0, 2, (const int[]){0, 1}, (const double[]){0, 0}, NULL),
                     NS_E_SIZE);
    assert_int_equal(ns_march_start_dc(k.m, 0, 1, (const int[]){1}, (const double[]){0}, NULL), NS_E_SIZE);
    assert_int_equal(ns_march_start(k.m, 0, k.x), NS_OK);
    assert_int_equal(ns_march_try(k.m, 0, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_fault(k.m)->status, NS_E_RANGE);
    ns_march_free(NULL);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decay),     cmocka_unit_test(a_start_forgets_the_run_before),
        cmocka_unit_test(test_inputs),    cmocka_unit_test(test_stiff),
        cmocka_unit_test(test_bridge),    cmocka_unit_test(test_dc),
        cmocka_unit_test(test_odd_times), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
