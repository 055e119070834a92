/* tests/unit/exact/test_fast_parts.c - a ring that nothing near zero depends on is stepped over, and followed
 * where a guard comes near: against closed forms.
 *
 * 11 V, a diode, 1 mohm, L = 1 nH, and C = 100 pF that begins at 9.99 V beside a current source of 10 A.  Its
 * current rings by 0.32 A at 503 MHz and loses half of that in 1.4 us.  The source falls by s A/s: then, with
 * a = R / 2L, i = 10 - s t + s R C + e^(-a t) (A cos w t + B sin w t),   A = -s R C,   B = (1/L + s + a A) /
 * w
 */
#include "exact_bench.h"

static const double henries = 1e-9, farads = 1e-10, ohms = 1e-3, end_t = 8e-6;

typedef struct ring {
    bench b;
    int l;        /* the inductor */
    double slope; /* A/s */
} ring;

static ring open_ring(double slope) {
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    const double t[] = {0, end_t}, amperes[] = {10, 10 - slope * end_t};
    const ns_signal load = {.kind = NS_PWL, .u.pwl = {2, t, amperes, NAN, 0}};
    ring r = {open_bench(), 0, slope};
    source(&r.b, "v", 1, 0, dc(11));
    assert_int_equal(ns_circuit_diode(r.b.c, "d", 1, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.b.c, "r", 2, 3, ohms, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(r.b.c, "l", 3, 4, henries, 10, &r.l), NS_OK);
    assert_int_equal(ns_circuit_capacitor(r.b.c, "c", 4, 0, farads, 9.99, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(r.b.c, "i", NS_CURRENT, 4, 0, &load, NULL), NS_OK);
    start(&r.b, 1e-7);
    return r;
}

static double amperes_at(const ring *r, double t) {
    const double s = r->slope, a = ohms / (2 * henries), w = sqrt(1 / (henries * farads) - a * a);
    const double A = -s * ohms * farads, B = (1 / henries + s + a * A) / w;
    return 10 - s * t - A + exp(-a * t) * (A * cos(w * t) + B * sin(w * t));
}

/* 4000 periods of the ring, which take 16 steps each where their guards are looked at. */
static void far_from_zero(void **state) {
    (void)state;
    ring r = open_ring(0);
    go(&r.b, end_t, NS_TO_TIME);
    near(i_of(&r.b, r.l), amperes_at(&r, end_t), 1e-10);
    assert_true(ns_march_counts(r.b.m)->steps < 2000);
    close_bench(&r.b);
}

/* The first instant at which the current is zero: twenty looks a period, then halving. */
static double first_zero(const ring *r) {
    double a = 0, b = 0;
    for (long i = 1; amperes_at(r, b) > 0; i++) {
        a = b;
        b = (double)i * 1e-10;
    }
    for (int i = 0; i < 100; i++) {
        const double mid = a + (b - a) / 2;
        *(amperes_at(r, mid) > 0 ? &a : &b) = mid;
    }
    return a;
}

/* The mean is zero after 5 us; the diode ends when the ring, 0.026 A then, first takes its current there. */
static void down_to_zero(void **state) {
    (void)state;
    ring r = open_ring(2e6);
    const double expected = first_zero(&r);
    assert_true(expected > 4.97e-6 && expected < 4.999e-6);
    near(go(&r.b, end_t, NS_TO_EVENT), expected, 1e-17);
    assert_true(ns_march_at_event(r.b.m));
    assert_true(ns_march_counts(r.b.m)->steps < 4000);
    close_bench(&r.b);
}

/* Three such rings behind one diode, which lose nothing to speak of, each with eight times the L and the C of
 * the one before: the last one's periods are no reason for 80 steps with the steps of the first. */
static void slower_ones_beside_it(void **state) {
    enum { RINGS = 3 };
    const double t = 2.5e-3, r = 1e-6;
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    bench b = open_bench();
    int l[RINGS];
    (void)state;
    source(&b, "v", 1, 0, dc(11));
    assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &d, NULL), NS_OK);
    for (int k = 0; k < RINGS; k++) {
        const char *const name[][4] = {
            {"r0", "l0", "c0", "i0"}, {"r1", "l1", "c1", "i1"}, {"r2", "l2", "c2", "i2"}};
        const int a = 3 + 2 * k;
        assert_int_equal(ns_circuit_resistor(b.c, name[k][0], 2, a, r, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(b.c, name[k][1], a, a + 1, ldexp(henries, 3 * k), 10, &l[k]),
                         NS_OK);
        assert_int_equal(
            ns_circuit_capacitor(b.c, name[k][2], a + 1, 0, ldexp(farads, 3 * k), 10 - 10 * r, NULL), NS_OK);
        const ns_signal load = dc(10);
        assert_int_equal(ns_circuit_source(b.c, name[k][3], NS_CURRENT, a + 1, 0, &load, NULL), NS_OK);
    }
    start(&b, 1e-5);
    go(&b, t, NS_TO_TIME);
    for (int k = 0; k < RINGS; k++) {
        const double L = ldexp(henries, 3 * k), a = r / (2 * L),
                     w = sqrt(1 / (L * ldexp(farads, 3 * k)) - a * a);
        near(i_of(&b, l[k]), 10 + exp(-a * t) / (L * w) * sin(w * t), 1e-6);
    }
    assert_true(ns_march_counts(b.m)->steps < 1000);
    close_bench(&b);
}

/* 10 V of 10 kHz drive 0.1 mH, a diode with a leak of 1e9 ohm, and 10 ohm.  From where the sine rises,
 *     i = V/Z (sin(w t - phi) + sin(phi) exp(-R t/L)),  phi = atan(w L/R),  Z^2 = R^2 + (w L)^2,
 * but for the leak, 1e-8 A.  After the diode has opened that takes 0.1 mH/1e9 ohm = 1e-13 s to flow; until it
 * has died out, in 40 times that, steps with samples are 1.6 times as long, and the others as long as all of
 * it. */
static void what_dies_out(void **state) {
    const double w = 2 * pi * 1e4, t = 3e-5, phi = atan(w * 1e-4 / 10), z = hypot(10, w * 1e-4);
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {0, 10, 1e4, 0, 0, 0}};
    const ns_diode d = {.roff = 1e9, .vz = INFINITY};
    enum { PERIODS = 200 };
    bench b = open_bench();
    int l;
    (void)state;
    source(&b, "v", 1, 0, sine);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 1, 2, 1e-4, 0, &l), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 2, 3, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 3, 0, 10, NULL), NS_OK);
    start(&b, 1e-4 / 1024);
    for (int k = 0; k <= PERIODS; k++)
        (void)go(&b, k * 1e-4 + t, NS_TO_TIME);
    near(i_of(&b, l), 10 / z * (sin(w * t - phi) + sin(phi) * exp(-10 * t / 1e-4)), 2e-8);
    assert_true(ns_march_counts(b.m)->steps < 30 * PERIODS); /* 59 a period by steps with samples */
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(far_from_zero), cmocka_unit_test(down_to_zero),
                                       cmocka_unit_test(slower_ones_beside_it),
                                       cmocka_unit_test(what_dies_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
