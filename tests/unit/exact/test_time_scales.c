/* tests/unit/exact/test_time_scales.c - what is fast beside h, and yet not over at once.
 *
 * A switch charges a capacitor through an inductor, a resistor and a diode: to 10 V (1 + e^(-pi/(2 Q))) in
 * half a period, for large Q.  What it rings in dies within 80 Q/omega, which is 8e-5 h where omega h is 1e8:
 * far more than the millionth of h that exact takes for no time.  Looked for by a stage of 256 h, which a
 * mode before may have been made with, the rate could not be told from an infinite one, and 10 V was the
 * answer.
 */
#include "rig.h"
#include "signals.h"

static const double h = 1e-3, farads = 1e-6, quality = 100;

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static ns_circuit *build(double omega) {
    const ns_signal supply = dc(10), gate = pulse(0, 1, 3.3 * h, 0, 0, 20 * h, 40 * h);
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_diode diode = {.vf = 0, .ron = 0, .roff = INFINITY, .vz = INFINITY};
    const double inductance = 1 / (omega * omega * farads);
    ns_circuit *c = NULL;
    ok(ns_circuit_create(&c));
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &supply, NULL));
    ok(ns_circuit_source(c, "g", NS_VOLTAGE, 9, 0, &gate, NULL));
    ok(ns_circuit_switch(c, "s", 1, 2, 9, 0, &contact, NULL));
    ok(ns_circuit_inductor(c, "l", 2, 3, inductance, NAN, NULL));
    ok(ns_circuit_resistor(c, "r1", 3, 4, sqrt(inductance / farads) / quality, NULL));
    ok(ns_circuit_diode(c, "d", 4, 5, &diode, NULL));
    ok(ns_circuit_capacitor(c, "c", 5, 0, farads, NAN, NULL));
    ok(ns_circuit_resistor(c, "r2", 5, 0, 1e10, NULL));
    return c;
}

static void charges(void **state) {
    const double pi = 3.14159265358979323846, volts = 10 * (1 + exp(-pi / (2 * quality)));
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = NS_EXACT, .whole = 1};
    (void)state;
    for (int exponent = 2; exponent <= 8; exponent++) {
        const double by = pow(10, exponent);
        rig k = {.c = build(by / h)};
        make_by(&k, &o);
        start_at_rest(&k);
        go(&k, 10 * h);
        /* Q is not quite large: (1 - 1/(4 Q^2))^(1/2) of the exponent */
        assert_true(fabs(k.x[ns_circuit_node_unknown(k.c, 5)] - volts) < 1e-4 * volts);
        end(&k);
    }
}

/* A switch of 1 mohm closes across 80 pF: 8e-14 s.  10 V drive a current through 1 mH, 1 mohm, 1 mH and 5 nF:
 * i = 10 V / (L omega) e^(-alpha t) sin(omega t) with L = 2 mH, alpha = R / 2 L, omega^2 = 1 / L C - alpha^2.
 * The two nodes between the coils are held by nothing but these. */
enum { COIL_NODE = 3, OTHER_COIL_NODE = 4 };
static const double henries = 2e-3, ohms = 1e-3, last = 5e-6;

static ns_circuit *build_resonance(int *coil) {
    const ns_signal supply = dc(10), gate = pulse(0, 1, 0.1e-6, 0, 0, 1, 2);
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 1e-3, .roff = INFINITY};
    ns_circuit *c = NULL;
    ok(ns_circuit_create(&c));
    ok(ns_circuit_source(c, "g", NS_VOLTAGE, 9, 0, &gate, NULL));
    ok(ns_circuit_capacitor(c, "c1", 1, 0, 80e-12, 25, NULL));
    ok(ns_circuit_switch(c, "s", 1, 0, 9, 0, &contact, NULL));
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, 2, 0, &supply, NULL));
    ok(ns_circuit_inductor(c, "l1", 2, COIL_NODE, henries / 2, 0, coil));
    ok(ns_circuit_resistor(c, "r", COIL_NODE, OTHER_COIL_NODE, ohms, NULL));
    ok(ns_circuit_inductor(c, "l2", OTHER_COIL_NODE, 5, henries / 2, 0, NULL));
    ok(ns_circuit_capacitor(c, "c2", 5, 0, 5e-9, 0, NULL));
    return c;
}

/* resistance: in series, from the first instant on. */
static void judge_resonance(rig *k, int coil, double resistance, double off) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 4e-9, .method = NS_EXACT, .whole = 1};
    const double alpha = resistance / (2 * henries), omega = sqrt(1 / (henries * 5e-9) - alpha * alpha);
    const double amperes = 10 / (henries * omega) * exp(-alpha * last) * sin(omega * last);
    make_by(k, &o);
    start_at_rest(k);
    go(k, last);
    assert_true(fabs(k->x[ns_circuit_current_unknown(k->c, coil)] - amperes) < off * amperes);
}

/* In a step of 1e-15 s the matrix has a condition of some 1e15; it is regular all the same.  Up to issue 20
 * it was called singular, and steps of first order went on for as long as the switch was closed: the current
 * was 1e-3 too small. */
static void a_mode_of_a_bad_condition_is_exact(void **state) {
    int coil;
    rig k = {.c = build_resonance(&coil)};
    (void)state;
    judge_resonance(&k, coil, ohms, 1e-9);
    assert_int_equal(ns_march_engine(k.m), NS_EXACT);
    end(&k);
}

/* Another switch with 1 nohm closes across the resistor: no double tells that matrix from a singular one. The
 * sparse engine goes on, not steps of first order. */
static void a_mode_without_matrices_is_left_to_the_sparse_engine(void **state) {
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 1e-9, .roff = INFINITY};
    int coil;
    rig k = {.c = build_resonance(&coil)};
    (void)state;
    ok(ns_circuit_switch(k.c, "s2", COIL_NODE, OTHER_COIL_NODE, 9, 0, &contact, NULL));
    /* what may draw a current there: else inductor_cuts.c makes the mode regular */
    ok(ns_circuit_source(k.c, "none", NS_CURRENT, COIL_NODE, 0, &(ns_signal){.kind = NS_DC}, NULL));
    judge_resonance(&k, coil, 0, 1e-8); /* 1 mohm for 0.1 us matters less than that */
    assert_int_equal(ns_march_engine(k.m), NS_SPARSE);
    end(&k);
}

/* Pulses of 5 ps, 82 ms apart, into a boost stage whose ring of 0.4 ns dies within 0.1 us.  What was left of
 * a time scale, by the rounding of t (1e-16 s), was taken for a step of length zero that had been kept: exact
 * took it 12 million times.  Steps beside the 29 events: some 800 as of now. */
static void no_step_has_no_length(void **state) {
    const ns_signal supply = dc(5.961),
                    gate = pulse(0, 1, 0.0646103, 4.696e-14, 4.696e-14, 4.696e-12, 0.0820345);
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_diode diode = {.vf = 0.9633, .ron = 0.0005688, .roff = 1.101e8, .vz = INFINITY};
    enum { IN = 1, FED, X, OUT, GATE };
    const double stop = 0.583511;
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = stop / 65536, .method = NS_EXACT, .whole = 1};
    rig k = begin();
    (void)state;
    ok(ns_circuit_source(k.c, "v1", NS_VOLTAGE, IN, 0, &supply, NULL));
    ok(ns_circuit_source(k.c, "v2", NS_VOLTAGE, GATE, 0, &gate, NULL));
    ok(ns_circuit_resistor(k.c, "r4", IN, FED, 3.595e-12, NULL));
    ok(ns_circuit_inductor(k.c, "l5", FED, X, 7.543e-12, 0, NULL));
    ok(ns_circuit_switch(k.c, "s6", X, 0, GATE, 0, &contact, NULL));
    ok(ns_circuit_diode(k.c, "d7", X, OUT, &diode, NULL));
    ok(ns_circuit_capacitor(k.c, "c8", OUT, 0, 2.406e-08, 5.961, NULL));
    ok(ns_circuit_resistor(k.c, "r9", OUT, 0, 4.301e+05, NULL));
    make_by(&k, &o);
    start_at_rest(&k);
    for (int i = 1; i <= 160; i++)
        ok(go_on(&k, stop * i / 160));

    if (ns_march_counts(k.m)->steps >= 5000)
        fail_msg("%ld steps", ns_march_counts(k.m)->steps);
    end(&k);
}

/* 1 V, 10 uH, 20 uH and 10/11 ohm in a row, 1 Gohm from between the coils to ground: that ends within 1e-14 s
 * what the currents of the coils differ by.  i = 1.1 A (1 - e^(-t/33 us)), and the node is at
 * 1 V - 10 uH di/dt = 1 V - 1/3 V e^(-t/33 us).  Points of one distance, whatever that is: of some 0.7 to 0.9
 * of the kernel's step a step (E2) made rounding 1.28 times as large (8e9 V after 500 us). */
static void points_of_any_distance(void **state) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT, .whole = 1};
    const ns_signal supply = dc(1);
    (void)state;
    for (int step = 0; step < 39; step++) {
        const double apart = 1e-7 * pow(1.1, step);
        rig k = {0};
        ok(ns_circuit_create(&k.c));
        ok(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &supply, NULL));
        ok(ns_circuit_inductor(k.c, "l1", 1, 2, 10e-6, NAN, NULL));
        ok(ns_circuit_inductor(k.c, "l2", 2, 3, 20e-6, NAN, NULL));
        ok(ns_circuit_resistor(k.c, "r1", 2, 0, 1e9, NULL));
        ok(ns_circuit_resistor(k.c, "r2", 3, 0, 10. / 11, NULL));
        make_by(&k, &o);
        start_at_rest(&k);
        for (int point = 1; point * apart < 500e-6; point++) {
            const double t = point * apart;
            go(&k, t);
            const double coils = exp(-t * (10. / 11) / 30e-6);
            assert_true(fabs(k.x[ns_circuit_node_unknown(k.c, 2)] - (1 - coils / 3)) < 1e-6);
        }
        end(&k);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(points_of_any_distance), cmocka_unit_test(charges),
                                       cmocka_unit_test(a_mode_of_a_bad_condition_is_exact),
                                       cmocka_unit_test(a_mode_without_matrices_is_left_to_the_sparse_engine),
                                       cmocka_unit_test(no_step_has_no_length)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
