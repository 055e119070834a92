/* tests/unit/march/test_short_pulses.c - pulses far shorter than their period: what each carries is the
 * integral of its source, whatever its length. */
#include "march_bench.h"
#include "signals.h"

/* Lengths in s: a period, and the top of a pulse; its edges are a tenth of that. */
typedef struct lengths {
    double period, top;
} lengths;

static const lengths all[] = {{1e-5, 1e-9},  {1e-5, 1e-12}, {1e-3, 1e-6}, {1e-3, 1e-9},
                              {1e-3, 1e-12}, {0.1, 1e-9},   {0.1, 1e-10}, {1, 1e-9}};
enum { ALL = sizeof all / sizeof *all, PULSES = 12 };

/* For charges and fluxes; for what a resistor limits, which the scheme makes 1 % less of.  (Exact: what
 * begins within h/2^20 of a blocking diode's zero is found wrong and computed again; beside a diode across
 * the source a flux is 2 % less where edges last less than that.) */
static const ns_method of_charge[] = {NS_SPARSE, NS_THETA}, of_voltage[] = {NS_SPARSE, NS_EXACT, NS_AUTO};

static ns_signal pulses(const lengths *of, double height) {
    return pulse(0, height, 0.25 * of->period, 0.1 * of->top, 0.1 * of->top, of->top, of->period);
}

/* The integral of one pulse of height 1. */
static double area(const lengths *of) {
    return 1.1 * of->top;
}

static void add_source(bench *b, ns_output kind, int p, ns_signal s) {
    assert_int_equal(ns_circuit_source(b->c, "source", kind, p, 0, &s, NULL), NS_OK);
}

/* From rest over all pulses, by h as in ngspice: 1/1024 of a period, at most 1/65536 of the run. */
static void run(bench *b, const lengths *of, ns_method method) {
    const double end = (PULSES - 0.25) * of->period;
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .method = method, .h = fmin(of->period / 1024, end / 65536)};
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    start_at_rest(b);
    go(b->m, end);
}

static void expect(double value, double right, const lengths *of, ns_method method, const char *what) {
    if (!(fabs(value - right) <= 1e-5 * right))
        fail_msg("%s, %g s every %g s, method %d: %.9g, not %.9g", what, of->top, of->period, method, value,
                 right);
}

/* A current into capacitors, of which one is behind a diode: nothing takes charge away. */
static void capacitors_get_all_charge(void **state) {
    (void)state;
    for (int k = 0; k < ALL * (int)(sizeof of_charge / sizeof *of_charge); k++) {
        const lengths *of = &all[k % ALL];
        bench b = open_bench();
        add_source(&b, NS_CURRENT, 1, pulses(of, -1)); /* from ground to node 1 */
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-6, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1e3, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c2", 2, 0, 1e-6, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 1, 3, &ideal_diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c3", 3, 0, 1e-6, NAN, NULL), NS_OK);
        run(&b, of, of_charge[k / ALL]);
        expect(1e-6 * (v_of(&b, 1) + v_of(&b, 2) + v_of(&b, 3)), PULSES * area(of), of, of_charge[k / ALL],
               "charge");
        close_bench(&b);
    }
}

/* A voltage across an inductor beside a resistor and a blocking diode: the flux is its integral. */
static void inductor_gets_all_flux(void **state) {
    (void)state;
    for (int k = 0; k < ALL * (int)(sizeof of_charge / sizeof *of_charge); k++) {
        const lengths *of = &all[k % ALL];
        int id;
        bench b = open_bench();
        add_source(&b, NS_VOLTAGE, 1, pulses(of, 1));
        assert_int_equal(ns_circuit_inductor(b.c, "l", 1, 0, 1e-3, NAN, &id), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 50, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 0, 1, &ideal_diode, NULL), NS_OK);
        run(&b, of, of_charge[k / ALL]);
        expect(1e-3 * i_of(&b, id), PULSES * area(of), of, of_charge[k / ALL], "flux");
        close_bench(&b);
    }
}

/* The voltage of a capacitor at v0 after a trapezoid of 1 V through a resistor and an ideal diode, with the
 * time constant T: v' = (V - v) / T while V > v, piece by piece. */
static long double charged(long double v0, const lengths *of, long double T) {
    const long double edge = 0.1L * of->top, s = 1 / edge, rise = edge - v0 / s;
    long double v = 1 - s * T * (1 - expl(-rise / T)); /* from V = v0 on */
    v = 1 - (1 - v) * expl(-of->top / T);
    return 1 - s * T * log1pl((1 - v) / (s * T)); /* V is v again: 1 - s tau */
}

static void peak_detector_charges(void **state) {
    (void)state;
    for (int k = 0; k < ALL * (int)(sizeof of_voltage / sizeof *of_voltage); k++) {
        const lengths *of = &all[k % ALL];
        const double T = 20 * of->top, r = 10;
        long double right = 0;
        bench b = open_bench();
        add_source(&b, NS_VOLTAGE, 1, pulses(of, 1));
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, r, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 2, 3, &ideal_diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 3, 0, T / r, NAN, NULL), NS_OK);
        run(&b, of, of_voltage[k / ALL]);
        for (int i = 0; i < PULSES; i++)
            right = charged(right, of, T);
        expect(v_of(&b, 3), (double)right, of, of_voltage[k / ALL], "voltage");
        close_bench(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(capacitors_get_all_charge),
        cmocka_unit_test(inductor_gets_all_flux),
        cmocka_unit_test(peak_detector_charges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
