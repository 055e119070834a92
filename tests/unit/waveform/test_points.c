/* tests/unit/waveform/test_points.c - which points there are: multiples of `every`, none further apart than
 * `longest`, peaks and valleys, none before a time that is skipped to; with every engine, and in parts. */
#include "points_rig.h"

static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA};

static double noise_of(ns_method method) {
    return method == NS_EXACT ? 0 : 1e-9;
}

static int has_point(const rig *r, double t) {
    for (int i = 0; i < r->count; i++)
        if (fabs(r->t[i] - t) <= 1e-15 * t)
            return 1;
    return 0;
}

static void multiples_are_points(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const ns_waveform_options o = {.every = 0.37, .closest = 1e-12, .noise = noise_of(methods[k])};
        rig r = rig_begin();
        rig_make_rc(&r);
        assert_int_equal(rig_prepare(&r, methods[k], 1e-2, &o), NS_OK);
        assert_int_equal(rig_run(&r, 30), NS_OK);
        for (int i = 1; i * 0.37 < 30; i++)
            assert_true(has_point(&r, i * 0.37));
        assert_true(has_point(&r, 30));
        assert_true(rig_off(&r, rig_rc) < 1.05e-4); /* the scheme's own error is (h/T)^2/12 at most */
        rig_end(&r);
    }
}

/* Tenths are what decimals are read as: 0.3, not 3 times 0.1, which is a bit more. */
static void tenths_are_exact(void **state) {
    static const double tenths[] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
    const ns_waveform_options o = {.every = 0.1, .closest = 1e-12};
    rig r = rig_begin();
    int exact = 0;
    (void)state;
    rig_make_rc(&r);
    assert_int_equal(rig_prepare(&r, NS_EXACT, 1e-2, &o), NS_OK);
    assert_int_equal(rig_run(&r, 1), NS_OK);
    for (int i = 0; i < r.count; i++)
        for (int k = 0; k < 9; k++)
            exact += r.t[i] == tenths[k];
    assert_int_equal(exact, 9);
    rig_end(&r);
}

static void no_two_points_are_further_apart_than_longest(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const ns_waveform_options o = {.longest = 0.1, .closest = 1e-12, .noise = noise_of(methods[k])};
        rig r = rig_begin();
        rig_make_rc(&r);
        assert_int_equal(rig_prepare(&r, methods[k], 1e-2, &o), NS_OK);
        assert_int_equal(rig_run(&r, 100), NS_OK);
        for (int i = 1; i < r.count; i++)
            assert_true(r.t[i] - r.t[i - 1] <= 0.1 * (1 + 1e-9));
        /* as many as are needed for that, and those of the decay: some 4 / sqrt(lines) at most */
        assert_true(r.count >= 1000 && r.count < 1000 + 400);
        rig_end(&r);
    }
}

/* 1 F at 1 V, 1 H and 10 ohm in parallel: v = e^(-at) cos(wt + p) / cos p, a = 1/20, w^2 = 1 - a^2, tan p =
 * a/w, with extremes (-1)^k e^(-a t_k) at t_k = (k pi - 2 p)/w. */
static const double damping = 0.05, pi = 3.14159265358979323846;

static double ring(double t) {
    const double w = sqrt(1 - damping * damping), p = atan(damping / w);
    return exp(-damping * t) * cos(w * t + p) / cos(p);
}

static void peaks_and_valleys_are_points(void **state) {
    const double w = sqrt(1 - damping * damping), p = atan(damping / w);
    (void)state;
    for (int k = 0; k < 2; k++) {
        const ns_waveform_options o = {.closest = 1e-11, .noise = noise_of(methods[k])};
        rig r = rig_begin();
        double worst = 0;
        assert_int_equal(ns_circuit_capacitor(r.c, "c", 1, 0, 1, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 0, 1, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(r.c, "r", 1, 0, 10, NULL), NS_OK);
        r.unknown = ns_circuit_node_unknown(r.c, 1);
        assert_int_equal(rig_prepare(&r, methods[k], 1e-2, &o), NS_OK);
        assert_int_equal(rig_run(&r, 100), NS_OK);
        for (int i = 1; (i * pi - 2 * p) / w < 100; i++) {
            const double t = (i * pi - 2 * p) / w, value = (i % 2 ? -1 : 1) * exp(-damping * t);
            double nearest = INFINITY;
            for (int j = 0; j < r.count; j++)
                nearest = fabs(r.t[j] - t) < 0.5 ? fmin(nearest, fabs(r.v[j] - value)) : nearest;
            worst = fmax(worst, nearest);
        }
        print_message("%d: %d points, extremes off by %.2g, lines by %.2g\n", k, r.count, worst,
                      rig_off(&r, ring));
        assert_true(worst < 1e-4 / 50); /* a peak that comes out by less needs no point */
        assert_true(rig_off(&r, ring) < 1.01e-4);
        rig_end(&r);
    }
}

/* After the time that was skipped to, the waveform is as without that. */
static void skipped_time_has_no_points(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const ns_waveform_options o = {.closest = 1e-12, .noise = noise_of(methods[k])};
        ns_waveform_point p;
        rig r = rig_begin();
        rig_make_rc(&r);
        assert_int_equal(rig_prepare(&r, methods[k], 1e-2, &o), NS_OK);
        assert_int_equal(ns_waveform_start(r.w, &p), NS_OK);
        assert_int_equal(ns_waveform_skip(r.w, 1.5, &p), NS_OK);
        assert_true(fabs(p.t - 1.5) < 1e-7);
        assert_int_equal(p.after_jump, 0);
        rig_keep(&r, &p);
        assert_int_equal(rig_run(&r, 4), NS_OK);
        assert_true(rig_off(&r, rig_rc) < 1.05e-4);
        assert_int_equal(ns_waveform_skip(r.w, 3, &p), NS_E_RANGE); /* it is there already */
        assert_int_equal(ns_waveform_skip(r.w, 6, &p), NS_OK);
        assert_true(fabs(p.t - 6) < 1e-7);
        assert_true(fabs(p.x[r.unknown] - rig_rc(6)) < 1e-5);
        rig_end(&r);
    }
}

static double slow(double t) {
    return 1 - exp(-t / 5);
}

/* v through a diode that conducts and 1 ohm onto a capacitor. */
static void add_part(rig *r, const char *const names[3], int at, double farads) {
    const ns_diode diode = {.roff = INFINITY, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(r->c, names[0], 1, at + 1, &diode, NULL), NS_OK);
    rig_add_rc(r, names + 1, at + 1, at, farads);
}

/* Three parts at one source, one a thousand times as fast as another: each is within its lines, whoever asks
 * for points. */
static void parts_share_their_points(void **state) {
    static const char *const names[][3] = {{"d1", "r1", "c1"}, {"d2", "r2", "c2"}, {"d3", "r3", "c3"}};
    (void)state;
    for (int k = 0; k < 4; k++) {
        const ns_waveform_options o = {.closest = 1e-12, .noise = noise_of(methods[k / 2])};
        const ns_signal one = dc(1);
        rig r = rig_begin();
        assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &one, NULL), NS_OK);
        add_part(&r, names[0], 10, 1);
        add_part(&r, names[1], 20, 5);
        add_part(&r, names[2], 30, 5e-3);
        r.unknown = ns_circuit_node_unknown(r.c, k % 2 ? 20 : 10);
        assert_int_equal(rig_prepare(&r, methods[k / 2], 1e-2, &o), NS_OK);
        assert_int_equal(rig_run(&r, 10), NS_OK);
        assert_int_equal(ns_march_counts(r.m)->islands, 3);
        assert_true(rig_off(&r, k % 2 ? slow : rig_rc) < 1.01e-4);
        assert_true(r.count < 3 * 400); /* three decays of some 4 / sqrt(lines) points at most */
        rig_end(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(multiples_are_points),
        cmocka_unit_test(tenths_are_exact),
        cmocka_unit_test(no_two_points_are_further_apart_than_longest),
        cmocka_unit_test(peaks_and_valleys_are_points),
        cmocka_unit_test(skipped_time_has_no_points),
        cmocka_unit_test(parts_share_their_points),
    };
    return cmocka_run_group_tests_name("points", tests, NULL, NULL);
}
