/* tests/unit/waveform/test_lines.c - how far lines are from sines of any delay and length, whose value is the
 * source's own formula; and how many points a circuit takes in which nothing but rounding moves. */
#include "points_rig.h"
#include "runs.h"

static const double pi = 3.14159265358979323846;
static double sine_delay, sine_freq;

static double sine(double t) {
    return t < sine_delay ? 0 : sin(2 * pi * sine_freq * (t - sine_delay));
}

/* 1 V sin from `delay` on over a resistor, to stop = 1 s. */
static void lines_of_sine(ns_method method, double freq, double delay) {
    const ns_signal source = {.kind = NS_SIN, .u.sin = {0, 1, freq, delay, 0, 0}};
    const ns_waveform_options o = {.closest = 4e-15, .noise = method == NS_EXACT ? 0 : 1e-9};
    rig r = rig_begin();
    assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &source, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.c, "r", 1, 0, 1, NULL), NS_OK);
    r.unknown = ns_circuit_node_unknown(r.c, 1);
    sine_delay = delay;
    sine_freq = freq;
    assert_int_equal(rig_prepare(&r, method, 1.0 / 65536, &o), NS_OK);
    assert_int_equal(rig_run(&r, 1), NS_OK);
    const double off = rig_off(&r, sine) / 1e-4, a_period = r.count / ((1 - delay) * freq + 1);
    print_message("%d %g Hz from %g s: off by %.3g of lines, %.4g points a period\n", (int)method, freq,
                  delay, off, a_period);
    assert_true(off < 1.02); /* 2 in 100 for the parabola that a part of a sine is taken for */
    assert_true(a_period < 260);
    rig_end(&r);
}

static void sines_are_as_near_as_lines_say(void **state) {
    static const double freq[] = {0.1, 0.5, 1, 3, 17, 200}, delay[] = {0, 0.1, 0.3333, 0.99};
    (void)state;
    for (int i = 0; i < FEWER_IF_SANITIZED(24); i++) {
        lines_of_sine(NS_EXACT, freq[i % 6], delay[i / 6]);
        lines_of_sine(NS_SPARSE, freq[i % 6], delay[i / 6]);
    }
}

/* A source, C and diode from it to ground, L and R to ground: at rest from the operating point on. */
static int points_at_rest(double volts, double farads, double henries) {
    const ns_signal source = dc(volts);
    const ns_diode diode = {.roff = INFINITY, .vz = INFINITY};
    const ns_waveform_options o = {.closest = 4e-15, .every = 0.02, .floor = {0, 1e-12, 1e-15}};
    rig r = rig_begin();
    assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &source, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(r.c, "c", 1, 2, farads, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.c, "r", 2, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(r.c, "d", 2, 0, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 3, henries, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.c, "r3", 3, 0, 1e3, NULL), NS_OK);
    r.unknown = ns_circuit_node_unknown(r.c, 2);
    assert_int_equal(rig_prepare(&r, NS_EXACT, 1.0 / 1024, &o), NS_OK);
    assert_int_equal(ns_march_start_dc(r.m, 0, 0, NULL, NULL, NULL), NS_OK);
    assert_int_equal(rig_run(&r, 1), NS_OK);
    const int count = r.count;
    rig_end(&r);
    return count;
}

static void rounding_takes_few_points(void **state) {
    static const double volts[] = {1, 12, 230, 1e4}, farads[] = {1e-12, 1e-9, 1e-6, 1e-3},
                        henries[] = {1e-9, 1e-6, 1e-3};
    int most = 0;
    (void)state;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++) {
                const int count = points_at_rest(volts[i], farads[k], henries[l]);
                most = count > most ? count : most;
            }
    print_message("at most %d points where nothing but rounding moves\n", most);
    assert_true(most < 1000); /* 51 are asked for */
}

/* --- gates --- */

/* 1 V, a switch that is closed for 0.25 <= t - k < 0.75 (its gate crosses 0.5 V amid edges of 0.1 s), 1 H. */
static double current(double t) {
    const double k = floor(t), rest = t - k;
    return 0.5 * k + fmin(fmax(rest - 0.25, 0), 0.5);
}

static int points_with_gate(ns_method method, int gate_too, long *samples) {
    const ns_signal supply = dc(1), gate = pulse(0, 1, 0.2, 0.1, 0.1, 0.4, 1);
    const ns_switch contact = {.vt = 0.5, .roff = INFINITY};
    const ns_diode freewheel = {.roff = INFINITY, .vz = INFINITY};
    unsigned char kind[16] = {0};
    const ns_waveform_options o = {.closest = 1e-13, .kind = kind};
    rig r = rig_begin();
    int id;
    assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(r.c, "vg", NS_VOLTAGE, 3, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(r.c, "s", 1, 2, 3, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(r.c, "d", 0, 2, &freewheel, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(r.c, "l", 2, 0, 1, 0, &id), NS_OK);
    r.unknown = ns_circuit_current_unknown(r.c, id);
    kind[r.unknown] = 1;
    if (gate_too)
        kind[ns_circuit_node_unknown(r.c, 3)] = 2;
    assert_int_equal(rig_prepare(&r, method, 1.0 / 1024, &o), NS_OK);
    assert_int_equal(rig_run(&r, 20), NS_OK);
    assert_true(rig_off(&r, current) < 1e-4 * 10);
    *samples = ns_waveform_read_counts(r.w).samples;
    const int count = r.count;
    rig_end(&r);
    return count;
}

/* A gate that nobody looks at costs nothing: its four corners a period are neither points nor sampled. */
static void gates_ask_for_points_where_they_are_shown(void **state) {
    (void)state;
    for (int sparse = 0; sparse < 2; sparse++) {
        long alone, both;
        const ns_method method = sparse ? NS_SPARSE : NS_EXACT;
        const int points = points_with_gate(method, 0, &alone), more = points_with_gate(method, 1, &both);
        print_message("%s: %d points, %ld samples; with the gate %d, %ld\n", sparse ? "sparse" : "exact",
                      points, alone, more, both);
        assert_true(points <= 2 * 20 + 2); /* where the current turns, and the ends */
        assert_true(more >= 6 * 20);       /* and the gate's corners */
        assert_true(sparse || (double)alone < 0.6 * (double)both);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sines_are_as_near_as_lines_say),
        cmocka_unit_test(rounding_takes_few_points),
        cmocka_unit_test(gates_ask_for_points_where_they_are_shown),
    };
    return cmocka_run_group_tests_name("lines", tests, NULL, NULL);
}
