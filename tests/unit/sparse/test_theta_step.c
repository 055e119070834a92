/* tests/unit/sparse/test_theta_step.c - steps of the scheme in which nothing is located, by sparse factors.
 */
#include "rig.h"

static void ready(rig *k, double theta, double h) {
    const ns_march_options o = {.theta = theta, .gamma = theta, .h = h, .method = NS_THETA, .capture = 1};
    make_by(k, &o);
    assert_int_equal(ns_march_engine(k->m), NS_THETA);
    start_at_rest(k);
}

/* Nothing is located. */
static void step_to(rig *k, double t) {
    go(k, t);
    assert_int_equal(ns_march_at_event(k->m), 0);
}

static void near(double got, double expected, double off) {
    if (!(fabs(got - expected) <= off))
        fail_msg("%.17g, expected %.17g", got, expected);
}

static void resistor(rig *k, int p, int n, double ohm) {
    assert_int_equal(ns_circuit_resistor(k->c, "r", p, n, ohm, NULL), NS_OK);
}

static void capacitor(rig *k, int p, int n, double farad, double v) {
    assert_int_equal(ns_circuit_capacitor(k->c, "c", p, n, farad, v, NULL), NS_OK);
}

static int inductor(rig *k, int p, int n, double henry) {
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, "l", p, n, henry, 0, &id), NS_OK);
    return id;
}

static void diode(rig *k, int p, int n) {
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    assert_int_equal(ns_circuit_diode(k->c, "d", p, n, &d, NULL), NS_OK);
}

static void constant(rig *k, const char *name, int p, double v) {
    const ns_signal s = {.kind = NS_DC, .u.dc = v};
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, p, 0, &s, NULL), NS_OK);
}

static void pulse(rig *k, const char *name, int p, double delay, double on, double period) {
    ns_signal s = {.kind = NS_PULSE};
    s.u.pulse.v2 = 1;
    s.u.pulse.td = delay;
    s.u.pulse.pw = on;
    s.u.pulse.per = period;
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, p, 0, &s, NULL), NS_OK);
}

static void contact(rig *k, int p, int n, int control, double vt, double vh) {
    const ns_switch sw = {vt, vh, 0, INFINITY};
    assert_int_equal(ns_circuit_switch(k->c, "s", p, n, control, 0, &sw, NULL), NS_OK);
}

static double voltage(const rig *k, int node) {
    return k->x[ns_circuit_node_unknown(k->c, node)];
}

/* RC = 1 ms from 1 V: n steps of h are (1 + h/RC)^-n, or ((1 - h/2RC)/(1 + h/2RC))^n, to rounding. */
static void test_steps(void **state) {
    (void)state;
    rig k = begin();
    capacitor(&k, 1, 0, 1e-6, 1);
    resistor(&k, 1, 0, 1e3);
    ready(&k, 1, 1e-5);
    step_to(&k, 50e-5);
    near(voltage(&k, 1), pow(1 + 1e-2, -50), 1e-13);
    assert_int_equal(ns_march_counts(k.m)->factors, 2); /* the start's, and that of all steps */
    assert_in_range(ns_march_counts(k.m)->steps, 50, 51);
    ready(&k, 0.5, 1e-5);
    step_to(&k, 50e-5);
    near(voltage(&k, 1), pow((1 - 0.5e-2) / (1 + 0.5e-2), 50), 1e-6); /* x from w: h^3/8 RC^3 e^-0.5 */
    end(&k);
}

/* 10 V through 1 kohm into 1 uF, from 1/3 ms on: 10 (1 - exp(-(t - 1/3)/1)) at 3 ms. */
static double closing_error(double theta, double h) {
    rig k = begin();
    constant(&k, "vin", 1, 10);
    pulse(&k, "vg", 2, 1e-3 / 3, 1, 2);
    contact(&k, 1, 3, 2, 0.5, 0);
    resistor(&k, 3, 4, 1e3);
    capacitor(&k, 4, 0, 1e-6, 0);
    ready(&k, theta, h);
    step_to(&k, 3e-3);
    const double error = fabs(voltage(&k, 4) - 10 * (1 - exp(-(3 - 1 / 3.0))));
    assert_int_equal(ns_march_counts(k.m)->events, 1);
    end(&k);
    return error;
}

/* A command within a step counts by its share: with theta = 1/2 a quarter of the step leaves a 16th.  (It
 * comes after 1/3 or 2/3 of a step, of a quarter of that too.) */
static void test_order(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        const double h = 0.1e-3 / (1 << i);
        const double half = closing_error(0.5, h) / closing_error(0.5, h / 4);
        const double one = closing_error(1, h) / closing_error(1, h / 4);
        if (!(half > 14 && half < 18 && one > 3.5 && one < 4.5))
            fail_msg("h %g: errors fall by %g and %g", h, half, one);
    }
    assert_true(closing_error(0.5, 0.05e-3) < 5e-3);
}

/* RC = 1 us in steps of 1 ms: what a switch connects to 10 V is there at the next step, and does not ring,
 * whichever unknown it is,
 * and whatever flux 100 H take on beside its charge. */
static void test_rings_not(void **state) {
    (void)state;
    for (int node = 1; node <= 4; node += 3) {
        const int supply = 5 - node;
        rig k = begin();
        constant(&k, "vin", supply, 10);
        pulse(&k, "vg", 2, 3.3e-3, 1, 2);
        contact(&k, supply, 3, 2, 0.5, 0);
        resistor(&k, 3, node, 1);
        capacitor(&k, node, 0, 1e-6, 0);
        assert_int_equal(ns_circuit_resistor(k.c, "r2", supply, 6, 1, NULL), NS_OK);
        inductor(&k, 6, 0, 100);
        assert_int_equal(ns_circuit_resistor(k.c, "r3", node, 6, 1e12, NULL), NS_OK); /* one island */
        ready(&k, 0.5, 1e-3);
        for (int i = 1; i <= 40; i++) {
            step_to(&k, 0.25e-3 * i);
            if (i < 12)
                near(voltage(&k, node), 0, 1e-7); /* of r3 */
            if (i > 20)
                near(voltage(&k, node), 10, 1e-3);
        }
        end(&k);
    }
}

/* 10 V, switched on for 2 of 10 us, through 10 uH into 6 V: up at 0.4 A/us to 0.8 A, down at 0.6 A/us; zero
 * from 10/3 us on.  Steps are 0.1 us; flips count by their share of one. */
static void test_discontinuous(void **state) {
    const double theta = *(double *)*state;
    rig k = begin();
    constant(&k, "vin", 1, 10);
    pulse(&k, "vg", 2, 0, 2e-6, 1e-5);
    contact(&k, 1, 3, 2, 0.5, 0);
    diode(&k, 0, 3);
    const int l = inductor(&k, 3, 4, 1e-5);
    constant(&k, "vout", 4, 6);
    ready(&k, theta, 1e-7);
    for (int i = 1; i < 100; i++) {
        const double t = 0.377e-6 * i, phase = fmod(t, 1e-5);
        step_to(&k, t);
        near(k.x[ns_circuit_current_unknown(k.c, l)],
             phase < 2e-6 ? 0.4e6 * phase : fmax(0, 0.8 - 0.6e6 * (phase - 2e-6)), 0.08);
    }
    end(&k);
}

/* A relay at 0.6 and 0.4 V that charges from 1 V and discharges RC = 1 ms: 2 ln 1.5 ms from flip to flip and
 * back.  In 20 ms 49 flips; each comes at most a step late. */
static void test_relay(void **state) {
    const double theta = *(double *)*state;
    rig k = begin();
    constant(&k, "vin", 1, 1);
    constant(&k, "vmid", 2, 1); /* less the capacitor's is the control: closed above 0.6, open below 0.4 */
    resistor(&k, 3, 4, 1e3);
    capacitor(&k, 4, 0, 1e-6, 0.3);
    assert_int_equal(ns_circuit_vcontrolled(k.c, "e", NS_VOLTAGE, 5, 0, 2, 4, 1, NULL), NS_OK);
    contact(&k, 1, 3, 5, 0.5, 0.1);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", 3, 0, 1e3, NULL), NS_OK);
    ready(&k, theta, 2e-6);
    double low = 1, high = 0;
    for (int i = 1; i <= 400; i++) {
        step_to(&k, 0.5e-4 * i);
        if (i > 100) {
            low = fmin(low, voltage(&k, 4));
            high = fmax(high, voltage(&k, 4));
        }
    }
    near(low, 0.4, 0.01 + 2e-3); /* in between what 0.05 ms change; a step changes 1e-3 */
    near(high, 0.6, 0.02 + 2e-3);
    assert_true(low > 0.4 - 2e-3 && high < 0.6 + 2e-3);
    end(&k);
}

/* RC = 1 ms from 1 V passes 0.5 V, which closes a switch from 10 V to 1 kohm: in the same step. */
static void test_command_of_a_step(void **state) {
    const double theta = *(double *)*state;
    rig k = begin();
    int closed = 0;
    constant(&k, "vin", 1, 1);
    constant(&k, "v10", 2, 10);
    resistor(&k, 1, 3, 1e3);
    capacitor(&k, 3, 0, 1e-6, 0);
    contact(&k, 2, 4, 3, 0.5, 0);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", 4, 0, 1e3, NULL), NS_OK);
    ready(&k, theta, 1e-5);
    for (int i = 1; i <= 200; i++) {
        step_to(&k, 1e-5 * i);
        closed += voltage(&k, 4) > 5;
        if (fabs(voltage(&k, 3) - 0.5) > 1e-9)
            near(voltage(&k, 4), voltage(&k, 3) > 0.5 ? 10 : 0, 1e-9);
    }
    assert_true(closed > 100 && closed < 140);
    assert_int_equal(ns_march_counts(k.m)->events, 1); /* in no other step a law breaks */
    end(&k);
}

/* 10 V sine of 1 kHz across a diode and RC = 10 ms: at the crest of each period the capacitor is at 10 V. */
static void test_peak(void **state) {
    const double theta = *(double *)*state;
    rig k = begin();
    ns_signal sine = {.kind = NS_SIN};
    sine.u.sin.va = 10;
    sine.u.sin.freq = 1000;
    assert_int_equal(ns_circuit_source(k.c, "vin", NS_VOLTAGE, 1, 0, &sine, NULL), NS_OK);
    diode(&k, 1, 2);
    capacitor(&k, 2, 0, 1e-6, 0);
    resistor(&k, 2, 0, 1e4);
    ready(&k, theta, 1e-6);
    for (int i = 0; i < 5; i++) {
        step_to(&k, 1e-3 * i + 0.25e-3);
        near(voltage(&k, 2), 10, 1e-3);
        step_to(&k, 1e-3 * i + 0.75e-3); /* half a period of discharge, from a little after the crest */
        near(voltage(&k, 2), 10 * exp(-0.05), 0.01);
    }
    end(&k);
}

/* What is tried leaves the accepted point alone, and the way in two parts is the way in one. */
static void test_tries(void **state) {
    (void)state;
    rig k = begin();
    double reached, x[8];
    constant(&k, "vin", 1, 10);
    pulse(&k, "vg", 2, 0, 3e-6, 1e-5);
    contact(&k, 1, 3, 2, 0.5, 0);
    diode(&k, 0, 3);
    inductor(&k, 3, 4, 1e-4);
    resistor(&k, 4, 0, 10);
    ready(&k, 0.5, 3e-7);
    step_to(&k, 2.1e-6);
    assert_int_equal(ns_march_try(k.m, 3.5e-5, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_try(k.m, 9.13e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(k.m, NULL, x, NULL, NULL), NS_OK);
    step_to(&k, 4e-6);
    step_to(&k, 4.03e-6);
    step_to(&k, 9.13e-6);
    for (int i = 0; i < k.s->n; i++)
        near(k.x[i], x[i], 1e-12);
    end(&k);
}

/* At rest from the operating point it stays there. */
static void test_rest(void **state) {
    const double theta = *(double *)*state;
    rig k = begin();
    constant(&k, "vin", 1, 10);
    resistor(&k, 1, 2, 1e3);
    capacitor(&k, 2, 0, 1e-6, NAN);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", 2, 0, 1e3, NULL), NS_OK);
    ready(&k, theta, 1e-4);
    assert_int_equal(ns_march_start_dc(k.m, 1, 0, NULL, NULL, NULL), NS_OK);
    step_to(&k, 1.01234);
    near(voltage(&k, 2), 5, 1e-12);
    end(&k);
}

/* x' = -lambda, 0 = x + cos wt - lambda: (e^-t - cos wt - w sin wt)/(1 + w^2).  The input acts on lambda
 * alone, so steps add what it moved since the right-hand side was made. */
static void test_sine_of_a_law(void **state) {
    const double theta = *(double *)*state, w = 6, h = 1e-3, off = theta < 1 ? 2e-4 : 1e-2;
    const ns_march_options o = {.theta = theta, .gamma = theta, .h = h, .method = NS_THETA, .capture = 1};
    const double w0 = 0;
    double reached, x;
    ns_system *s;
    ns_march *m;
    ns_signal sine = {.kind = NS_SIN};
    sine.u.sin.va = 1;
    sine.u.sin.freq = w / (2 * 3.14159265358979323846);
    sine.u.sin.phase = 90;
    assert_int_equal(ns_system_create(1, 1, 1, 0, &s), NS_OK);
    s->M[0] = s->C[0] = s->F[0] = 1;
    s->B[0] = s->D[0] = -1;
    s->l[0] = -INFINITY;
    s->u[0] = INFINITY;
    assert_int_equal(ns_system_set_input(s, 0, &sine), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, &w0), NS_OK);
    for (int i = 1; i <= 30; i++) {
        const double t = 0.1 * i;
        assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        assert_int_equal(ns_march_read(m, NULL, &x, NULL, NULL), NS_OK);
        near(x, (exp(-t) - cos(w * t) - w * sin(w * t)) / (1 + w * w), off);
    }
    ns_march_free(m);
    ns_system_free(s);
}

static void test_refused(void **state) {
    (void)state;
    rig k = begin();
    ns_march *m;
    double reached;
    capacitor(&k, 1, 0, 1e-6, 1);
    resistor(&k, 1, 0, 1e3);
    ready(&k, 1, 1e-3);
    const ns_march_options two = {.theta = 1, .gamma = 0.5, .h = 1, .method = NS_THETA, .capture = 1};
    assert_int_equal(ns_march_create(k.s, &two, &m, NULL), NS_OK); /* by the dense steps */
    ns_march_free(m);
    assert_int_equal(ns_march_try(k.m, 0, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_start(k.m, 1e300, k.x), NS_E_NUMBER); /* no step moves it */
    end(&k);
}

/* A diode straight across a source has no answer. */
static void test_without_answer(void **state) {
    (void)state;
    rig k = begin();
    double reached;
    ns_signal ramp = {.kind = NS_PULSE};
    ramp.u.pulse.v1 = -1;
    ramp.u.pulse.v2 = 1;
    ramp.u.pulse.tr = ramp.u.pulse.tf = 1e-3;
    ramp.u.pulse.pw = 1;
    ramp.u.pulse.per = 2;
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &ramp, NULL), NS_OK);
    diode(&k, 1, 0);
    ready(&k, 1, 1e-5);
    const int status = ns_march_try(k.m, 1e-3, NS_TO_TIME, &reached);
    assert_true(status == NS_E_INFEASIBLE || status == NS_E_SINGULAR);
    assert_int_equal(ns_march_fault(k.m)->status, status);
    end(&k);
}

int main(void) {
    static double one = 1, half = 0.5;
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_steps),
                                       cmocka_unit_test(test_order),
                                       cmocka_unit_test(test_rings_not),
                                       cmocka_unit_test_prestate(test_discontinuous, &one),
                                       cmocka_unit_test_prestate(test_discontinuous, &half),
                                       cmocka_unit_test_prestate(test_relay, &one),
                                       cmocka_unit_test_prestate(test_relay, &half),
                                       cmocka_unit_test_prestate(test_command_of_a_step, &one),
                                       cmocka_unit_test_prestate(test_command_of_a_step, &half),
                                       cmocka_unit_test_prestate(test_peak, &one),
                                       cmocka_unit_test_prestate(test_peak, &half),
                                       cmocka_unit_test(test_tries),
                                       cmocka_unit_test_prestate(test_rest, &one),
                                       cmocka_unit_test_prestate(test_rest, &half),
                                       cmocka_unit_test_prestate(test_sine_of_a_law, &one),
                                       cmocka_unit_test_prestate(test_sine_of_a_law, &half),
                                       cmocka_unit_test(test_refused),
                                       cmocka_unit_test(test_without_answer)};
    return cmocka_run_group_tests_name("sparse_scheme", tests, NULL, NULL);
}
