/* tests/unit/waveform/test_continue.c - a waveform in the place of another one: largest values and integrals
 * until then still count. */
#include "points_rig.h"

static double decay(double t) {
    return exp(-t);
}

static void make_decay(rig *r) {
    assert_int_equal(ns_circuit_capacitor(r->c, "c", 1, 0, 1, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r->c, "r", 1, 0, 1, NULL), NS_OK);
    r->unknown = ns_circuit_node_unknown(r->c, 1);
}

/* Points after t. */
static int points_after(const rig *r, double t) {
    int n = 0;
    for (int i = 0; i < r->count; i++)
        n += r->t[i] > t;
    return n;
}

/* The rest of `first` from t on by a waveform of its own, which continues (or not) that of `first`. */
static rig go_on(const rig *first, double t, double stop, const ns_waveform_options *o, int continues) {
    rig r = rig_begin();
    const double w0[] = {decay(t)};
    ns_waveform_point p;
    make_decay(&r);
    assert_int_equal(rig_prepare(&r, NS_EXACT, 1e-2, o), NS_OK);
    assert_int_equal(ns_march_start(r.m, t, w0), NS_OK);
    assert_int_equal(ns_waveform_continue(r.w, continues ? first->w : NULL, &p), NS_OK);
    rig_keep(&r, &p);
    assert_int_equal(rig_run(&r, stop), NS_OK);
    assert_true(rig_off(&r, decay) < (continues ? 1.05e-4 : 1.05e-4 * decay(t)));
    return r;
}

/* 1 F at 1 V and 1 ohm: from 6 s on lines within 1e-4 V take a dozen points, and within 1e-4 e^-6 V, of what
 * is left there, 2 / sqrt(8e-4) = 70 or more. */
static void a_decay(void **state) {
    (void)state;
    const unsigned char kinds[] = {1, 1, 1, 1}, other[] = {2, 2, 2, 2};
    const double squares[] = {0, 1e-3};
    for (int k = 0; k < 2; k++) {
        const ns_waveform_options o = {.closest = 1e-12, .kind = kinds, .squares = squares[k]};
        ns_waveform_options differs = o;
        differs.kind = other;
        rig whole = rig_begin();
        make_decay(&whole);
        assert_int_equal(rig_prepare(&whole, NS_EXACT, 1e-2, &o), NS_OK);
        assert_true(whole.s->n + whole.s->m <= 4);
        assert_int_equal(rig_run(&whole, 6), NS_OK);
        const int before = whole.count;
        rig rest = go_on(&whole, 6, 20, &o, 1), anew = go_on(&whole, 6, 20, &o, 0);
        assert_int_equal(rig_run(&whole, 20), NS_OK);
        rig unlike = rig_begin();
        ns_waveform_point p;
        make_decay(&unlike);
        assert_int_equal(rig_prepare(&unlike, NS_EXACT, 1e-2, &differs), NS_OK);
        assert_int_equal(ns_waveform_continue(unlike.w, whole.w, &p), NS_OK);
        rig_keep(&unlike, &p);
        assert_int_equal(rig_run(&unlike, 6), NS_OK);
        print_message("%d points after 6 s; continued %d, anew %d\n", points_after(&whole, 6),
                      points_after(&rest, 6), points_after(&anew, 6));
        assert_true(points_after(&whole, 6) <= (squares[k] > 0 ? 60 : 30)); /* old squares fade */
        assert_true(abs(points_after(&rest, 6) - points_after(&whole, 6)) <= 4);
        assert_true(points_after(&anew, 6) >= 70);
        assert_true(abs(unlike.count - before) <= 1);
        rig_end(&whole);
        rig_end(&rest);
        rig_end(&anew);
        rig_end(&unlike);
    }
}

static void refusals(void **state) {
    (void)state;
    ns_waveform_point p;
    assert_int_equal(ns_waveform_continue(NULL, NULL, &p), NS_E_NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_decay), cmocka_unit_test(refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
