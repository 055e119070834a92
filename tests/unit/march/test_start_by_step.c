/* tests/unit/march/test_start_by_step.c - a start that the exact engine leaves to a step of the scheme: what
 * is fast after it is resolved. */
#include "rig.h"

/* Charges and fluxes of the pump below at 142.51164 us, where a clock has risen, all of its diodes turn off,
 * and its snubbers (19 ns, 20 ns, 155 ns, 103 ns) begin to decay: as the sparse engine had them.  Several
 * modes hold there up to their rounding, so that the exact engine has no start. */
static const double begin_t = 0.00014251164, end_t = 0.000142617573;
static const double charges[] = {0,
                                 -9.1019540595969923e-08,
                                 -3.3448209314164745e-08,
                                 4.0629480802240052e-08,
                                 -5.5937974977362121e-09,
                                 4.6915533784326166e-08,
                                 -1.3467324470161415e-08,
                                 5.6069921700500697e-08,
                                 -8.6064409034590073e-11,
                                 3.7590176206810082e-07,
                                 -1.8829561198094821e-10};

/* A snubber across a diode: R from its anode, C to its cathode. */
static void stage(rig *k, const char *const name[3], int anode, int cathode, int middle, double ohm,
                  double farad) {
    const ns_diode d = {0.4395, 0, INFINITY, INFINITY, 0};
    assert_int_equal(ns_circuit_diode(k->c, name[0], anode, cathode, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k->c, name[1], anode, middle, ohm, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k->c, name[2], middle, cathode, farad, 0, NULL), NS_OK);
}

/* A Dickson pump of three stages, dickson 24002000001 of tests/stress. */
static rig pump(void) {
    rig k = begin();
    const ns_signal supply = {.kind = NS_DC, .u.dc = 7.198};
    const ns_signal clock[] = {
        {.kind = NS_PULSE, .u.pulse = {0, 7.198, 0, 2.2e-9, 2.2e-9, 1.73572e-6, 3.47584e-6, 0}},
        {.kind = NS_PULSE, .u.pulse = {7.198, 0, 1.08133e-7, 2.2e-9, 2.2e-9, 1.73572e-6, 3.47584e-6, 0}}};
    assert_int_equal(ns_circuit_source(k.c, "vdd", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "v1", NS_VOLTAGE, 2, 0, &clock[0], NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "v2", NS_VOLTAGE, 3, 0, &clock[1], NULL), NS_OK);
    stage(&k, (const char *const[]){"ad3", "r5", "c6"}, 1, 4, 5, 45.99, 1.762e-9);
    assert_int_equal(ns_circuit_capacitor(k.c, "c7", 2, 4, 3.612e-9, 0, NULL), NS_OK);
    stage(&k, (const char *const[]){"ad8", "r10", "c11"}, 4, 6, 7, 7.441, 2.558e-9);
    assert_int_equal(ns_circuit_capacitor(k.c, "c12", 3, 6, 3.612e-9, 0, NULL), NS_OK);
    stage(&k, (const char *const[]){"ad13", "r15", "c16"}, 6, 8, 9, 343, 5.874e-11);
    assert_int_equal(ns_circuit_capacitor(k.c, "c17", 2, 8, 3.612e-9, 0, NULL), NS_OK);
    stage(&k, (const char *const[]){"ad18", "r20", "c21"}, 8, 10, 11, 2637, 3.9e-11);
    assert_int_equal(ns_circuit_capacitor(k.c, "c22", 10, 0, 1.688e-8, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r23", 10, 0, 1.749e4, NULL), NS_OK);
    return k;
}

/* v(4) at the next corner, by one engine that was at work before, from these charges on. */
static double voltage(ns_method method) {
    rig k = pump();
    double w[32] = {0};
    const ns_march_options o = {.theta = 1,
                                .gamma = 1,
                                .h = 3.394375e-9,
                                .method = method,
                                .reltol = method == NS_SPARSE ? 1e-11 : 0};
    make_by(&k, &o);
    assert_true(k.s->n < 32);
    for (int i = 0; i < (int)(sizeof charges / sizeof *charges); i++)
        w[i] = charges[i];
    start_at_rest(&k);
    go(&k, 3.15e-5);
    assert_int_equal(ns_march_start(k.m, begin_t, w), NS_OK);
    go(&k, end_t);
    const double v = k.x[ns_circuit_node_unknown(k.c, 4)];
    end(&k);
    return v;
}

/* Nothing happens on the way: the sparse engine's series tells what comes. */
static void what_is_fast_after_it_is_resolved(void **state) {
    (void)state;
    const double v = voltage(NS_EXACT), other = voltage(NS_SPARSE);
    if (!(fabs(v - other) < 2e-5))
        fail_msg("v(4) = %.9g V by exact, %.9g V by sparse", v, other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_fast_after_it_is_resolved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
