/* tests/unit/march/test_sliding_devices.c - a switch without hysteresis at its threshold while another device
 * changes with each switching: refused by a line that names both, or right; and where no device does, it
 * slides.
 */
#include "rig.h"

#include "nonsmooth/march.h"

#include <string.h>

static const ns_switch no_hysteresis = {0, 0, 0.02, 1e6};
static const ns_diode ideal_diode = {0, 0, INFINITY, INFINITY, 0};

static void dc(rig *k, const char *name, int node, double volts) {
    ns_signal s = {.kind = NS_DC};
    s.u.dc = volts;
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, node, 0, &s, NULL), NS_OK);
}

static void add_resistor(rig *k, const char *name, int p, int n, double ohm) {
    assert_int_equal(ns_circuit_resistor(k->c, name, p, n, ohm, NULL), NS_OK);
}

static void add_diode(rig *k, const char *name, int p, int n) {
    assert_int_equal(ns_circuit_diode(k->c, name, p, n, &ideal_diode, NULL), NS_OK);
}

/* Closed while v(cp) > v(cn). */
static void add_switch(rig *k, const char *name, int p, int n, int cp, int cn) {
    assert_int_equal(ns_circuit_switch(k->c, name, p, n, cp, cn, &no_hysteresis, NULL), NS_OK);
}

/* v(sense) = 0.1 ohm times the current of a coil from p through a source of 0 V to n. */
static void sensed_coil(rig *k, int p, int middle, int n, double henry, int sense) {
    ns_signal zero = {.kind = NS_DC};
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, "l1", p, middle, henry, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k->c, "vm", NS_VOLTAGE, middle, n, &zero, &id), NS_OK);
    assert_int_equal(ns_circuit_icontrolled(k->c, "h1", NS_VOLTAGE, sense, 0, id, 0.1, NULL), NS_OK);
}

static const double vin = 24, henry = 100e-6, farad = 10e-6, ohm = 50, amperes = 3;
enum { IN = 1, X, M, OUT, SENSE, REF, NEGATIVE };

/* All hold the coil's current at 3 A. */
static void boost(rig *k) {
    dc(k, "v1", IN, vin);
    dc(k, "vref", REF, 0.1 * amperes);
    sensed_coil(k, IN, M, X, henry, SENSE);
    add_switch(k, "s1", X, 0, REF, SENSE);
    add_diode(k, "d1", X, OUT);
    assert_int_equal(ns_circuit_capacitor(k->c, "c1", OUT, 0, farad, vin, NULL), NS_OK);
    add_resistor(k, "r1", OUT, 0, ohm);
}

static void buck(rig *k) {
    dc(k, "v1", IN, vin);
    dc(k, "vref", REF, 0.1 * amperes);
    add_switch(k, "s1", IN, X, REF, SENSE);
    add_diode(k, "d1", 0, X);
    sensed_coil(k, X, M, OUT, henry, SENSE);
    add_resistor(k, "r1", OUT, 0, 4);
}

static void buck_boost(rig *k) {
    dc(k, "v1", IN, vin);
    dc(k, "vref", REF, 0.1 * amperes);
    add_switch(k, "s1", IN, X, REF, SENSE);
    sensed_coil(k, X, M, 0, henry, SENSE);
    add_diode(k, "d1", OUT, X);
    assert_int_equal(ns_circuit_capacitor(k->c, "c1", OUT, 0, farad, 0, NULL), NS_OK);
    add_resistor(k, "r1", OUT, 0, ohm);
}

/* Two switches, each closed while the other is open. */
static void leg(rig *k) {
    dc(k, "v1", IN, vin);
    dc(k, "v2", NEGATIVE, -vin);
    dc(k, "vref", REF, 0.1 * amperes);
    add_switch(k, "s1", IN, X, REF, SENSE);
    add_switch(k, "d1", X, NEGATIVE, SENSE, REF);
    sensed_coil(k, X, M, OUT, henry, SENSE);
    add_resistor(k, "r1", OUT, 0, 4);
}

typedef void build(rig *k);

static rig started(build *circuit, ns_method method, double h) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = method, .whole = 1};
    rig k = begin();
    circuit(&k);
    make_by(&k, &o);
    start_at_rest(&k);
    return k;
}

/* To t in steps of `by`; the first error. */
static int walk_to(rig *k, double t, double by) {
    double now = 0;
    for (int i = 1; now < t; i++) {
        int status = ns_march_try(k->m, fmin(t, i * by), NS_TO_TIME, &now);
        if (status == NS_OK)
            status = ns_march_accept(k->m);
        if (status != NS_OK)
            return status;
    }
    return NS_OK;
}

static void says(const rig *k, const char *what) {
    char line[400];
    (void)ns_circuit_explain(k->c, ns_march_fault(k->m), line, sizeof line);
    if (!strstr(line, what))
        fail_msg("no \"%s\" in \"%s\"", what, line);
}

/* The sliding mode is not the limit of vanishing hysteresis: a switch would carry the current at half the
 * voltage.  It begins where the coil has 3 A: after 3 A 100 uH / 24 V = 12.5 us (buck: L/R ln 2, 17.3 us). */
static void is_refused(build *circuit, ns_method method) {
    rig k = started(circuit, method, 100e-9);
    const int status = walk_to(&k, 100e-6, 1e-6);
    if (status != NS_E_CHATTER)
        fail_msg("method %d: %s", (int)method, ns_status_text(status));
    const double t = ns_march_fault(k.m)->t;
    assert_true(t > 12.4e-6 && t < 20e-6);
    assert_int_equal(ns_march_fault(k.m)->npairs, 2);
    says(&k, "s1, d1: at t = 1");
    says(&k, "(ideal diode d1 changes with each switching of ideal switch s1; give its model a vh above 0; "
             "the gate of an M: "
             "drive it against its source)");
    double reached; /* what was accepted stays, and is refused again */
    assert_int_equal(ns_march_try(k.m, 100e-6, NS_TO_TIME, &reached), NS_E_CHATTER);
    end(&k);
}

static void converters_are_refused(void **state) {
    static build *const circuits[] = {boost, buck, buck_boost};
    static const ns_method methods[] = {NS_AUTO, NS_EXACT, NS_SPARSE};
    (void)state;
    for (size_t i = 0; i < sizeof circuits / sizeof *circuits; i++)
        for (size_t q = 0; q < sizeof methods / sizeof *methods; q++)
            is_refused(circuits[i], methods[q]);
}

/* One of two switches would slide while the other one stays as it is: refused; or both are followed by steps.
 * Then 3 A flow in the coil, of which each switch carries a part, and none both at once. */
static void a_leg_is_right_or_refused(void **state) {
    static const ns_method methods[] = {NS_AUTO, NS_EXACT, NS_SPARSE, NS_THETA};
    (void)state;
    for (size_t q = 0; q < sizeof methods / sizeof *methods; q++) {
        rig k = started(leg, methods[q], 100e-9);
        const int status = walk_to(&k, 100e-6, 1e-6);
        if (status == NS_OK) {
            double x[32], lambda[2];
            assert_int_equal(ns_march_read(k.m, NULL, x, lambda, NULL), NS_OK);
            assert_true(fabs(x[ns_circuit_node_unknown(k.c, SENSE)] - 0.1 * amperes) < 0.02 * amperes);
            assert_true(fmin(fabs(lambda[0]), fabs(lambda[1])) < 1e-3);
        } else {
            says(&k, "s1");
        }
        end(&k);
    }
}

/* The scheme chatters: 3 A 24 V flow into C and R, so u = v^2 obeys C u'/2 = 72 W - u/R from 12.5 us on.
 * Steps of 20 ns let the current go up by 1.2 mA; ron takes 0.18 W, a quarter of a percent. */
static void the_scheme_is_right(void **state) {
    (void)state;
    rig k = started(boost, NS_THETA, 20e-9);
    const double from = henry * amperes / vin, watts = vin * amperes, tau = ohm * farad,
                 u0 = vin * vin * exp(-2 * from / tau);
    double x[32], lambda[2], y[2], t, worst = 0;
    for (int i = 2; i <= 20; i++) {
        assert_int_equal(walk_to(&k, i * 20e-6, 1), NS_OK);
        assert_int_equal(ns_march_read(k.m, &t, x, lambda, y), NS_OK);
        const double u = watts * ohm + (u0 - watts * ohm) * exp(-2 * (t - from) / tau),
                     v = x[ns_circuit_node_unknown(k.c, OUT)];
        worst = fmax(worst, fabs(v / sqrt(u) - 1));
        assert_true(lambda[0] == 0 || lambda[1] == 0); /* one of both carries the current */
        assert_true(fabs(lambda[0] + lambda[1] - amperes) < 0.01);
    }
    print_message("boost by the scheme: %.1e from the limit\n", worst);
    assert_true(worst < 5e-3);
    end(&k);
}

/* --- no other device changes with the switch, or none at first --- */

/* 10 V through a switch to 1; 1 kohm from there to 1 uF, 1 kohm across that: v(2) is held at 2 V, so v(1) is
 * 4 V, of 0 V with the switch open and 10 V with it closed.  A diode goes from 1 through 1 kohm to a source
 * that falls from 15 V at 0 to 5 V at 10 ms; from there a diode of 1 V goes to 1 kohm.
 */
static void heater(rig *k) {
    static const ns_diode drop = {1, 0, INFINITY, INFINITY, 0};
    static const double t[] = {0, 10e-3}, v[] = {15, 5};
    const ns_signal ramp = {.kind = NS_PWL, .u.pwl = {2, t, v, NAN, 0}};
    dc(k, "v1", 3, 10);
    dc(k, "vref", 4, 2);
    add_switch(k, "s1", 3, 1, 4, 2);
    add_resistor(k, "r1", 1, 2, 1e3);
    add_resistor(k, "rh", 1, 0, 1e3);
    add_resistor(k, "r2", 2, 0, 1e3);
    assert_int_equal(ns_circuit_capacitor(k->c, "c1", 2, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k->c, "v2", NS_VOLTAGE, 5, 0, &ramp, NULL), NS_OK);
    add_diode(k, "d1", 1, 6);
    add_resistor(k, "rd", 6, 5, 1e3);
    assert_int_equal(ns_circuit_diode(k->c, "d2", 5, 7, &drop, NULL), NS_OK);
    add_resistor(k, "r7", 7, 0, 1e3);
}

/* While the source is above 10 V the diode blocks whatever the switch does, and v(1) = 4 V.  At 5 ms it comes
 * to 10 V: from then on the closed switch has the diode conduct, the open one has not. */
static void it_slides_until_a_device_changes_too(void **state) {
    static const ns_method methods[] = {NS_AUTO, NS_EXACT, NS_SPARSE};
    (void)state;
    for (size_t q = 0; q < sizeof methods / sizeof *methods; q++) {
        rig k = started(heater, methods[q], 1e-6);
        double x[32], lambda[3];
        assert_int_equal(walk_to(&k, 4.9e-3, 1e-4), NS_OK);
        assert_int_equal(ns_march_read(k.m, NULL, x, lambda, NULL), NS_OK);
        assert_true(fabs(lambda[2] - (15 - 1e3 * 4.9e-3 - 1) / 1e3) < 1e-9);
        assert_true(fabs(x[ns_circuit_node_unknown(k.c, 2)] - 2) < 1e-6);
        assert_true(fabs(x[ns_circuit_node_unknown(k.c, 1)] - 4) < 1e-6);
        double reached = 0;
        int status = NS_OK;
        for (int i = 1; i < 30 && status == NS_OK; i++) {
            status = ns_march_try(k.m, 4.9e-3 + i * 1e-5, NS_TO_TIME, &reached);
            if (status == NS_OK)
                status = ns_march_accept(k.m);
        }
        assert_int_equal(status, NS_E_CHATTER);
        says(&k, "s1, d1: at t = 0.005");
        assert_true(reached > 4.995e-3 && reached < 5.1e-3);
        end(&k);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(converters_are_refused),
        cmocka_unit_test(a_leg_is_right_or_refused),
        cmocka_unit_test(the_scheme_is_right),
        cmocka_unit_test(it_slides_until_a_device_changes_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
