/* tests/unit/waveform/test_looks.c - how often a waveform is sampled for a point. */
#include "points_rig.h"

static rig begin(const ns_signal *wave) {
    rig r = rig_begin();
    assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, wave, NULL), NS_OK);
    return r;
}

/* How many samples 20 s of the node take, with squares. */
static long samples_of(rig *r, int node) {
    const ns_waveform_options o = {.closest = 1e-13, .lines = 2e-3, .squares = 1e-2};
    r->unknown = ns_circuit_node_unknown(r->c, node);
    assert_int_equal(rig_prepare(r, NS_EXACT, 1e-4, &o), NS_OK);
    assert_int_equal(rig_run(r, 20), NS_OK);
    const long samples = ns_waveform_read_counts(r->w).samples;
    print_message("%d points, %ld samples\n", r->count, samples);
    return samples;
}

/* A square wave of 1 V through R and C.  Lines become longer and longer along each decay: by how much the
 * last one did is how much the next one will, so that two samples a line are mostly enough, and some for the
 * first lines after each of the 40 edges. */
static void decays_take_few_looks(void **state) {
    const ns_signal wave = pulse(0, 1, 0, 0, 0, 0.5, 1);
    rig r = begin(&wave);
    (void)state;
    rig_add_rc(&r, (const char *const[]){"r", "c"}, 1, 2, 0.04);
    const long samples = samples_of(&r, 2);
    assert_true(r.count > 1000);
    assert_true((double)samples < 2.45 * r.count);
    rig_end(&r);
}

/* Between two corners a line is all there is: it is sampled at both ends and once on its way, which is where
 * squares are looked at, too. */
static void lines_between_corners_take_three(void **state) {
    const ns_signal wave = pulse(1, 1.1, 0, 0.5, 0.5, 0, 1);
    rig r = begin(&wave);
    (void)state;
    assert_int_equal(ns_circuit_resistor(r.c, "r", 1, 0, 1, NULL), NS_OK);
    const long samples = samples_of(&r, 1);
    assert_int_equal(r.count, 41);
    assert_true(samples <= 3 * 40);
    rig_end(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decays_take_few_looks),
        cmocka_unit_test(lines_between_corners_take_three),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
