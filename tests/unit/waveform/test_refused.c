/* tests/unit/waveform/test_refused.c - what a waveform refuses, and what it gives out before its marcher
 * fails. */
#include "points_rig.h"

#include "march/march_internal.h"
#include "wrap_alloc.h"

static void wrong_options(void **state) {
    const ns_waveform_options wrong[] = {
        {.lines = -1e-4},  {.lines = 1},   {.lines = NAN},      {.longest = -1},  {.longest = NAN},
        {.every = -1},     {.every = NAN}, {.closest = -1e-15}, {.closest = NAN}, {.closest = INFINITY},
        {.noise = -1e-12}, {.noise = 1},   {.noise = NAN},
    };
    rig r = rig_begin();
    const ns_waveform_options none = {0};
    const ns_waveform_options widest = {.lines = 0.99, .longest = INFINITY, .every = INFINITY, .noise = 0.99};
    unsigned char kind[3] = {0, NS_WAVEFORM_KINDS - 1, 1};
    ns_waveform *w = NULL;
    (void)state;
    rig_make_rc(&r);
    assert_int_equal(rig_prepare(&r, NS_EXACT, 1e-2, &none), NS_OK);
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        w = r.w;
        assert_int_equal(ns_waveform_create(r.s, r.m, &wrong[k], &w), NS_E_RANGE);
        assert_null(w);
    }
    assert_int_equal(r.s->n + r.s->m, 3);
    for (int k = 0; k < 2; k++) {
        const ns_waveform_options kinds = {.kind = kind};
        kind[2] = (unsigned char)(k == 0 ? NS_WAVEFORM_KINDS : 0);
        assert_int_equal(ns_waveform_create(r.s, r.m, &kinds, &w), k == 0 ? NS_E_RANGE : NS_OK);
        ns_waveform_free(w);
    }
    assert_int_equal(ns_waveform_create(r.s, r.m, &widest, &w), NS_OK);
    ns_waveform_free(w);
    assert_int_equal(ns_waveform_create(NULL, r.m, &none, &w), NS_E_NULL);
    assert_int_equal(ns_waveform_create(r.s, NULL, &none, &w), NS_E_NULL);
    assert_int_equal(ns_waveform_create(r.s, r.m, NULL, &w), NS_E_NULL);
    assert_int_equal(ns_waveform_create(r.s, r.m, &none, NULL), NS_E_NULL);
    ns_waveform_free(NULL);
    rig_end(&r);
}

static void wrong_calls(void **state) {
    const ns_waveform_options none = {0};
    ns_waveform_point p;
    rig r = rig_begin();
    (void)state;
    rig_make_rc(&r);
    assert_int_equal(rig_prepare(&r, NS_EXACT, 1e-2, &none), NS_OK);
    assert_int_equal(ns_waveform_next(r.w, 1, &p), NS_E_STATE);
    assert_int_equal(ns_waveform_skip(r.w, 1, &p), NS_E_STATE);
    assert_int_equal(ns_waveform_start(r.w, &p), NS_OK);
    assert_true(p.t == 0 && p.after_jump == 0 && p.sums == NULL);
    assert_int_equal(ns_waveform_next(r.w, 0, &p), NS_E_RANGE);
    assert_int_equal(ns_waveform_next(r.w, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_waveform_next(NULL, 1, &p), NS_E_NULL);
    assert_int_equal(ns_waveform_start(NULL, &p), NS_E_NULL);
    assert_int_equal(ns_waveform_skip(NULL, 1, &p), NS_E_NULL);
    rig_keep(&r, &p);
    assert_int_equal(rig_run(&r, 1), NS_OK);
    assert_true(r.t[r.count - 1] == 1);
    assert_int_equal(ns_waveform_next(r.w, 1, &p), NS_E_RANGE);
    assert_int_equal(ns_waveform_next(r.w, 0.5, &p), NS_E_RANGE);
    assert_int_equal(rig_run(&r, 2), NS_OK); /* and goes on */
    assert_true(r.t[r.count - 1] == 2);
    assert_int_equal(ns_waveform_read_counts(r.w).points, r.count);
    rig_end(&r);
}

/* An engine that does not get beyond t = 0: events there without an end. */
static int go_nowhere(ns_engine *e, double t, ns_until until, double *reached) {
    (void)e, (void)t, (void)until;
    *reached = 0;
    return NS_OK;
}

static int accept_it(ns_engine *e) {
    (void)e;
    return NS_OK;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the type is that of the table */
static int read_start(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    (void)e, (void)x, (void)lambda, (void)y;
    *t = 0;
    return NS_OK;
}

static void events_without_an_end(void **state) {
    static const ns_engine_table table = {.try_to = go_nowhere, .accept = accept_it, .read = read_start};
    const ns_waveform_options none = {0};
    ns_engine stuck = {.table = &table};
    ns_waveform_point p;
    rig r = rig_begin();
    (void)state;
    rig_make_rc(&r);
    assert_int_equal(rig_prepare(&r, NS_EXACT, 1e-2, &none), NS_OK);
    assert_int_equal(ns_waveform_start(r.w, &p), NS_OK);
    ns_engine *const own = r.m->engine;
    r.m->engine = &stuck;
    assert_int_equal(ns_waveform_next(r.w, 1, &p), NS_E_LIMIT);
    r.m->engine = own;
    rig_end(&r);
}

/* At t = 2 a switch without resistance closes onto the source.  Up to there the RC circuit is shown. */
static void what_came_before_a_failure_is_shown(void **state) {
    static const ns_method method[] = {NS_EXACT, NS_SPARSE, NS_THETA};
    (void)state;
    for (int k = 0; k < 3; k++) {
        const ns_signal gate = pulse(0, 1, 2, 0, 0, 9, INFINITY);
        const ns_switch contact = {0.5, 0, 0, INFINITY};
        const ns_waveform_options o = {.closest = 1e-12, .noise = 1e-9};
        ns_waveform_point p;
        rig r = rig_begin();
        rig_make_rc(&r);
        assert_int_equal(ns_circuit_source(r.c, "vg", NS_VOLTAGE, 9, 0, &gate, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(r.c, "s", 1, 0, 9, 0, &contact, NULL), NS_OK);
        assert_int_equal(rig_prepare(&r, method[k], 1e-2, &o), NS_OK);
        const int status = rig_run(&r, 3);
        assert_int_not_equal(status, NS_OK);
        assert_int_not_equal(status, NS_E_RANGE);
        assert_true(fabs(r.t[r.count - 1] - 2) < 1e-7); /* the scheme: some steps of h/2^20 */
        assert_true(rig_off(&r, rig_rc) < 1.05e-4);     /* the scheme's own error is (h/T)^2/12 at most */
        for (int again = 0; again < 3; again++)
            assert_int_equal(ns_waveform_next(r.w, 3, &p), status);
        assert_int_equal(ns_waveform_next(r.w, 2, &p), status);
        rig_end(&r);
    }
}

/* RC passes a threshold that is watched, and is refused to go on there; then nothing is watched, and the
 * points go on from there on the same curve. */
static void points_go_on_behind_a_threshold(void **state) {
    static const ns_method method[] = {NS_EXACT, NS_SPARSE};
    const ns_waveform_options o = {.closest = 1e-12, .noise = 1e-9};
    (void)state;
    for (int k = 0; k < 2; k++) {
        for (int i = 1; i < 18; i++) {
            const double volts = 0.05 * i;
            rig r = rig_begin();
            rig_make_rc(&r);
            assert_int_equal(rig_prepare(&r, method[k], 1e-2, &o), NS_OK);
            assert_int_equal(rig_run(&r, 0.01), NS_OK);
            const ns_threshold threshold = {r.unknown, -1, volts, 0, 1};
            assert_int_equal(ns_march_watch(r.m, 1, &threshold), NS_OK);
            assert_int_equal(rig_run(&r, 3), NS_E_STATE);
            assert_true(fabs(r.v[r.count - 1] - volts) < 1e-6);
            assert_int_equal(ns_march_watch(r.m, 0, NULL), NS_OK);
            assert_int_equal(ns_waveform_resume(r.w), NS_OK);
            assert_int_equal(rig_run(&r, 3), NS_OK);
            assert_true(r.t[r.count - 1] == 3);
            assert_true(rig_off(&r, rig_rc) < 1.05e-4);
            rig_end(&r);
        }
    }
}

/* One allocation fails, each in turn: the points before it are those of a run in which none does, but for the
 * last one, which ends a line before it is as long as it may be.  The scheme's steps are the same up to their
 * rounding: it does without a map that found no room. */
static void memory_fails(void **state) {
    static const ns_method method[] = {NS_EXACT, NS_SPARSE, NS_THETA};
    (void)state;
    for (int k = 0; k < 3; k++) {
        const ns_signal square = pulse(0, 1, 0.5, 0, 0, 1, 2);
        const ns_waveform_options o = {.closest = 1e-12, .noise = 1e-9};
        rig whole = {0};
        long fails = 0;
        for (long at = 0;; at++) {
            rig r = rig_begin();
            const ns_diode diode = {.roff = INFINITY, .vz = INFINITY};
            assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &square, NULL), NS_OK);
            assert_int_equal(ns_circuit_diode(r.c, "d", 1, 3, &diode, NULL), NS_OK);
            rig_add_rc(&r, (const char *const[]){"r", "c"}, 3, 2, 1);
            r.unknown = ns_circuit_node_unknown(r.c, 2);
            fail_alloc_at(at);
            int status = rig_prepare(&r, method[k], 1e-2, &o);
            status = status ? status : rig_run(&r, 3);
            const long made = allocs_made();
            fail_alloc_off();
            if (at == 0) {
                assert_int_equal(status, NS_OK);
                whole = r;
                continue;
            }
            const double rounding = method[k] == NS_THETA ? 1e-11 : 0;
            for (int i = 0; i < r.count - (status != NS_OK); i++)
                assert_true(r.t[i] == whole.t[i] && fabs(r.v[i] - whole.v[i]) <= rounding);
            const int ends = made < at;
            fails += status != NS_OK;
            assert_true(status == NS_OK || status == NS_E_MEMORY);
            assert_int_equal(r.count > 0 && r.t[r.count - 1] == 3, status == NS_OK);
            if (status != NS_OK && r.count > 0) {
                assert_int_equal(ns_waveform_resume(r.w), NS_OK);
                assert_int_equal(rig_run(&r, 3), NS_OK);
                assert_true(fabs(r.v[r.count - 1] - whole.v[whole.count - 1]) <= 1.05e-4);
            }
            rig_end(&r);
            if (ends)
                break;
            assert_true(at < 5000);
        }
        print_message("%d: %d points, %ld allocations failed\n", k, whole.count, fails);
        assert_true(fails > 6); /* those of ns_waveform_create() alone are seven */
        rig_end(&whole);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_options),
        cmocka_unit_test(wrong_calls),
        cmocka_unit_test(events_without_an_end),
        cmocka_unit_test(what_came_before_a_failure_is_shown),
        cmocka_unit_test(points_go_on_behind_a_threshold),
        cmocka_unit_test(memory_fails),
    };
    return cmocka_run_group_tests_name("refused", tests, NULL, NULL);
}
