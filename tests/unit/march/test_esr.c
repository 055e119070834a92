/* tests/unit/march/test_esr.c - next to no resistance in series with a capacitor that switches leave
 * floating.
 *
 * A doubler, whose flying capacitor is charged to V, and then shares its charge with the other one and V in
 * series with it: after the n-th time that one has
 *
 *     v = 2 V (1 - (C2/(C1 + C2))^n)
 *
 * as each phase takes hundreds of time constants.  In between all switches are open, for a tenth of the
 * period: what the flying capacitor then floats at is held by their roff alone, or by nothing.  Up to issue 3
 * exact and auto took that mode for one without an answer, the scheme stood in with steps up to h, and v
 * came out 0.1 % to 20 % off; sparse did not start.
 *
 * And a capacitor that is sampled and let go, discharging through roff as e^(-t/(roff C)).
 */
#include <float.h>

#include "rig.h"
#include "signals.h"

static const int methods[] = {NS_AUTO, NS_EXACT, NS_SPARSE};
enum { METHODS = sizeof methods / sizeof *methods };
static const double period = 30e-6, volts = 5, c1 = 1e-6, c2 = 28e-6;

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static void contact(rig *k, const char *name, int p, int n, int gate, double roff) {
    const ns_switch s = {.vt = 0.5, .vh = 0, .ron = 0.017, .roff = roff};
    ok(ns_circuit_switch(k->c, name, p, n, gate, 0, &s, NULL));
}

static void gate(rig *k, const char *name, int node, double from, double width, double every) {
    const ns_signal s = pulse(0, 1, from, 1e-9, 1e-9, width, every);
    ok(ns_circuit_source(k->c, name, NS_VOLTAGE, node, 0, &s, NULL));
}

/* inner: node amid esr, of which half lies on either side; 3: none. */
static double doubled(int method, double esr, int inner, double roff, int n) {
    const ns_signal supply = dc(volts);
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .h = period / 9, .method = (ns_method)method, .whole = 1, .reltol = 1e-9};
    rig k = begin();
    ok(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &supply, NULL));
    gate(&k, "g1", 9, 0, 0.45 * period, period);
    gate(&k, "g2", 10, 0.5 * period, 0.45 * period, period);
    contact(&k, "s1", 1, 2, 9, roff);
    contact(&k, "s2", 4, 0, 9, roff);
    contact(&k, "s3", 2, 5, 10, roff);
    contact(&k, "s4", 1, 4, 10, roff);
    ok(ns_circuit_resistor(k.c, "esr", 2, inner, inner == 3 ? esr : esr / 2, NULL));
    if (inner != 3)
        ok(ns_circuit_resistor(k.c, "more", inner, 3, esr / 2, NULL));
    ok(ns_circuit_capacitor(k.c, "c1", 3, 4, c1, NAN, NULL));
    ok(ns_circuit_capacitor(k.c, "c2", 5, 0, c2, NAN, NULL));
    make_by(&k, &o);
    start_at_rest(&k);
    ok(go_on(&k, n * period));
    const double v = k.x[ns_circuit_node_unknown(k.c, 5)];
    end(&k);
    return v;
}

/* In all that time a leak of 2 V takes 2 V / roff * time, 30 uV of c1 at 100 Mohm, and the rounding of a
 * voltage, which drives a current through esr, eps 2 V / esr * time, 7 uV at 100 nohm. */
static void doubles(void **state) {
    static const double esr[] = {1e-7, 1e-6, 5.46e-6, 1e-5, 1e-4, 1e-3, 1e-2};
    static const double roff[] = {1e8, 1e9, 3.4e9, 1e10, 1e11, 1e12, 1e14, INFINITY};
    enum { CYCLES = 10 };
    const double v = 2 * volts * (1 - pow(c2 / (c1 + c2), CYCLES));
    (void)state;
    for (int i = 0; i < METHODS; i++)
        for (size_t e = 0; e < sizeof esr / sizeof *esr; e++)
            for (size_t r = 0; r < sizeof roff / sizeof *roff; r++) {
                const double out = doubled(methods[i], esr[e], 3, roff[r], CYCLES);
                const double time = CYCLES * period, leak = 1 / roff[r] + DBL_EPSILON / esr[e];
                const double tol = 1e-8 + leak * 2 * volts * time / c1;
                if (!(fabs(out - v) < tol))
                    print_message("method %d, esr %g, roff %g: %.9g, not %.9g\n", methods[i], esr[e], roff[r],
                                  out, v);
                assert_true(fabs(out - v) < tol);
            }
}

/* Less than a millionth of ron: no sum of conductances rounds what drives a current through it.  Two of 5e-14
 * ohm in series are too little for sparse, which is 3e-6 V off. */
static void doubles_exactly(void **state) {
    enum { CYCLES = 10 };
    const double v = 2 * volts * (1 - pow(c2 / (c1 + c2), CYCLES));
    (void)state;
    for (int i = 0; i < METHODS; i++)
        for (int inner = 3; inner <= 6; inner += 3)
            for (int exponent = -8; exponent >= -12; exponent--)
                assert_true(fabs(doubled(methods[i], pow(10, exponent), inner, INFINITY, CYCLES) - v) < 1e-8);
}

/* 1e15 of esr: a sum of conductances does not tell the leak. */
static void held(int method, double esr, double roff) {
    const double farads = 1e-3 / roff;
    const ns_signal in = pulse(1, 0, 2e-3, 1e-9, 1e-9, 1, 2);
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .h = 1e-4, .method = (ns_method)method, .whole = 1, .reltol = 1e-9};
    rig k = begin();
    ok(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &in, NULL));
    gate(&k, "g", 9, 0, 1e-3, 1);
    contact(&k, "s", 1, 2, 9, roff);
    ok(ns_circuit_resistor(k.c, "esr", 2, 3, esr, NULL));
    ok(ns_circuit_capacitor(k.c, "c", 3, 0, farads, NAN, NULL));
    make_by(&k, &o);
    start_at_rest(&k);
    ok(go_on(&k, 2e-3));
    const double sampled = k.x[ns_circuit_node_unknown(k.c, 3)];
    ok(go_on(&k, 3e-3));
    const double after = k.x[ns_circuit_node_unknown(k.c, 3)];
    end(&k);
    assert_true(fabs(sampled - 1) < 1e-9);
    assert_true(fabs(after - exp(-1)) < 2e-6); /* the ramp of 1 ns is half of that */
}

static void holds(void **state) {
    (void)state;
    for (int i = 0; i < METHODS; i++)
        for (int exponent = 6; exponent <= 9; exponent++)
            held(methods[i], pow(10, exponent - 15), pow(10, exponent));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(doubles), cmocka_unit_test(doubles_exactly),
                                       cmocka_unit_test(holds)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
