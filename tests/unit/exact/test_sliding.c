/* tests/unit/exact/test_sliding.c - switches without hysteresis that hold their control at its threshold; and
 * events that accumulate. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "exact/sliding.h"
#include "theta/theta_internal.h"

#include "nonsmooth.h"

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[24], lambda[16];
} bench;

static const ns_switch ideal = {0, 0, 0, INFINITY};
static const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};

static void open_bench(bench *b) {
    *b = (bench){0};
    assert_int_equal(ns_circuit_create(&b->c), NS_OK);
}

static void start(bench *b, double h) {
    double w0[24];
    const ns_march_options o = {.theta = 0.5, .gamma = 0.5, .h = h};
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= 24 && b->s->m <= 16);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
}

static void go(bench *b, double t) {
    double reached;
    assert_int_equal(ns_march_try(b->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, b->x, b->lambda, NULL), NS_OK);
}

static double v(const bench *b, int node) {
    return b->x[ns_circuit_node_unknown(b->c, node)];
}

static void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static void source(bench *b, const char *name, int p, const ns_signal *s) {
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, 0, s, NULL), NS_OK);
}

/* 20 V at 1, a switch to 2 while v(4) > v(3), 2.5 ohm from 2 to ground (with a diode there it would
 * not slide: march/run_sliding.c), 100 uH to 3, 10 ohm. */
static void chopper(bench *b, const ns_signal *ref, double h) {
    const ns_signal dc = {.kind = NS_DC, .u.dc = 20};
    open_bench(b);
    source(b, "v1", 1, &dc);
    source(b, "vr", 4, ref);
    assert_int_equal(ns_circuit_switch(b->c, "s1", 1, 2, 4, 3, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b->c, "rf", 2, 0, 2.5, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b->c, "l1", 2, 3, 100e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b->c, "r1", 3, 0, 10, NULL), NS_OK);
    start(b, h);
}

/* From rest v(3) = 20 (1 - exp(-t/10us)) meets the reference before 5 us (at 4.7 us it is at 7.5 V).  From
 * then on v(3) = ref, i = ref/10, and v(2) = ref + L i'. */
static void a_chopper_follows_a_sine(void **state) {
    const double pi = 3.14159265358979323846, w = 2 * pi * 1e3;
    ns_signal ref = {.kind = NS_SIN};
    (void)state;
    ref.u.sin.vo = 7.5;
    ref.u.sin.va = 2;
    ref.u.sin.freq = 1e3;
    for (int k = 0; k < 2; k++) {
        bench b;
        chopper(&b, &ref, k ? 1e-5 : 1e-6);
        go(&b, 4e-6);
        assert_true(fabs(v(&b, 3) + 20 * expm1(-0.4)) < 1e-12);
        for (int n = 1; n <= 300; n++) {
            const double t = n * 7e-6, r = 7.5 + 2 * sin(w * t);
            go(&b, t);
            assert_true(fabs(v(&b, 3) - r) < 1e-9);
            assert_true(fabs(v(&b, 2) - (r + 1e-5 * 2 * w * cos(w * t))) < 1e-9);
        }
        assert_true(ns_march_engine(b.m) == NS_EXACT && ns_march_counts(b.m)->events < 4);
        close_bench(&b);
    }
}

/* The reference falls from 5 V to 1 V faster than the resistors let v(3) follow: at 50 us the switch opens
 * for good, v(3) = 5 exp(-(t - 50us)/8us), until that is at 1 V, at 50us + 8us ln 5 = 62.88us; there it
 * slides on. */
static void it_lets_go_and_comes_back(void **state) {
    const double t[] = {0, 50e-6, 50.001e-6, 1}, r[] = {5, 5, 1, 1};
    const ns_signal ref = {.kind = NS_PWL, .u.pwl = {4, t, r, NAN, 0}};
    bench b;
    (void)state;
    chopper(&b, &ref, 1e-6);
    go(&b, 49e-6);
    assert_true(fabs(v(&b, 3) - 5) < 1e-9);
    go(&b, 58e-6);
    assert_true(fabs(v(&b, 3) - 5 * exp(-1)) < 1e-9);
    assert_true(fabs(v(&b, 2) + 0.25 * v(&b, 3)) < 1e-12);
    go(&b, 62e-6);
    assert_true(fabs(v(&b, 3) - 5 * exp(-1.5)) < 1e-9);
    go(&b, 64e-6);
    assert_true(fabs(v(&b, 3) - 1) < 1e-9 && fabs(v(&b, 2) - 1) < 1e-9);
    go(&b, 500e-6);
    assert_true(fabs(v(&b, 3) - 1) < 1e-9);
    close_bench(&b);
}

/* 1 V behind 1 kohm charges 1 uF; a switch discharges it into 100 ohm while it is above 0.5 V.  There it
 * stays: the switch takes the 0.5 mA that come, of the 5 mA that it could. */
static void a_clamp_takes_what_comes(void **state) {
    const ns_signal dc = {.kind = NS_DC, .u.dc = 1};
    const ns_switch half = {0.5, 0, 0, INFINITY};
    double i;
    int s;
    bench b;
    (void)state;
    open_bench(&b);
    source(&b, "v1", 1, &dc);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 2, 3, 2, 0, &half, &s), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 3, 0, 100, NULL), NS_OK);
    start(&b, 1e-6);
    go(&b, 0.69e-3); /* ln 2 ms = 0.6931 ms */
    assert_true(fabs(v(&b, 2) + expm1(-0.69)) < 1e-12);
    for (int n = 1; n <= 40; n++) {
        go(&b, 0.7e-3 + n * 1e-4);
        assert_true(fabs(v(&b, 2) - 0.5) < 1e-12 && fabs(v(&b, 3) - 0.05) < 1e-12);
    }
    assert_int_equal(ns_circuit_device(b.c, s, b.x, b.lambda, ns_march_mode(b.m), &i, NULL, NULL), NS_OK);
    assert_true(fabs(i - 0.5e-3) < 1e-12);
    close_bench(&b);
}

/* A bridge from node a to ground that takes i Sgn(v(a)), any current in [-i, i] at 0 V. */
static void relay(bench *b, const char *const *names, int a, int p, int n, double i) {
    const int from[] = {a, 0, n, n}, to[] = {p, p, a, 0};
    const ns_signal dc = {.kind = NS_DC, .u.dc = i};
    for (int k = 0; k < 4; k++)
        assert_int_equal(ns_circuit_diode(b->c, names[k], from[k], to[k], &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b->c, names[4], NS_CURRENT, p, n, &dc, NULL), NS_OK);
}

/* T v1' = v2, T v2' = -5 Sgn(v1) - 4 Sgn(v2), T = 1 ms, from v1 = 0, v2 = p = 3 ("twisting").  v2 falls at a
 * rate of 9 to 0 in p/9, at v1 = p^2/18; then at a rate of 1 until v1 = 0 at v2 = -p/3: each half turn takes
 * 4p/9 and leaves a third of p.  They accumulate at (4p/9)/(1 - 1/3) = 2p/3 = 2 (ms), and all rests from then
 * on. */
static void relays_come_to_rest(void **state) {
    static const char *const one[] = {"d1", "d2", "d3", "d4", "i1"}, *const two[] = {"d5", "d6", "d7", "d8",
                                                                                     "i2"};
    bench b;
    int e;
    double reached = 0, last = 0;
    (void)state;
    open_bench(&b);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", 2, 0, 1e-6, 3, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(b.c, "g1", NS_CURRENT, 0, 1, 2, 0, 1e-3, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(b.c, "e1", NS_VOLTAGE, 3, 0, 1, 0, 1, &e), NS_OK);
    relay(&b, one, 3, 4, 5, 5e-3);
    relay(&b, two, 2, 6, 7, 4e-3);
    assert_int_equal(ns_circuit_icontrolled(b.c, "f1", NS_CURRENT, 0, 2, e, 1, NULL), NS_OK);
    start(&b, 1e-5);
    for (int k = 0; k < 200 && reached < 3e-3; k++) {
        assert_int_equal(ns_march_try(b.m, 3e-3, NS_TO_EVENT, &reached), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        last = reached < 3e-3 ? reached : last;
    }
    assert_true(reached >= 3e-3 && fabs(last - 2e-3) < 1e-9);
    assert_int_equal(ns_march_read(b.m, NULL, b.x, b.lambda, NULL), NS_OK);
    assert_true(fabs(v(&b, 1)) < 1e-12 && fabs(v(&b, 2)) < 1e-12);
    close_bench(&b);
}

/* One unknown, one charge, no input; y1 = 5 x + 2 lambda0 - 3 lambda1 + 7, where pair 1 slides.  By the
 * charge x, lambda = 1/2, -4, 6, and by 1 they are 1/4, 3, -2: its guards, and the sizes of what they are
 * sums of. */
static void guards_of_what_slides(void **state) {
    double C[] = {9, 5}, D[] = {9, 2, 9, -3}, e[] = {9, 7}, full[] = {0.5, -4, 6, 0.25, 3, -2};
    const ns_system system = {.n = 1, .m = 2, .C = C, .D = D, .e = e};
    const ns_theta s = {.s = &system, .r = 1, .q = 2};
    const ns_map map = {.full = full};
    const ns_mode mode[] = {NS_INSIDE, NS_SLIDES_UP};
    double row[4], noise[4];
    (void)state;
    ns_exact_sliding_fill(&s, &map, mode, 2, row, noise);
    const double y[] = {2.5 - 8 - 18, 1.25 + 6 + 6 + 7}, terms[] = {2.5 + 8 + 18, 1.25 + 6 + 6 + 7};
    for (int k = 0; k < 2; k++) {
        assert_true(row[2 * k] == full[3 * k + 2] && row[2 * k + 1] == -y[k]);
        assert_true(noise[2 * k] == fabs(full[3 * k + 2]) && noise[2 * k + 1] == terms[k]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chopper_follows_a_sine), cmocka_unit_test(it_lets_go_and_comes_back),
        cmocka_unit_test(a_clamp_takes_what_comes), cmocka_unit_test(relays_come_to_rest),
        cmocka_unit_test(guards_of_what_slides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
