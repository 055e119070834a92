/* tests/unit/march/test_ruled_out.c - a trial in which no threshold can be crossed is not searched: two
 * samples and how far unknowns are from straight lines rule it out. */
#include "march_bench.h"

#include "march/march_internal.h"

/* 1 V and a sine of 1 V, 1 MHz, through 1 kohm on 1 nF; two gates: a triangle, and a sine. */
static bench two_gates(void) {
    static const double t[3] = {0, 1e-6, 3e-6}, v[3] = {0, 4, 0};
    const ns_march_options o = {.h = 1e-7, .method = NS_SPARSE, .reltol = 1e-9, .whole = 1};
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {1, 1, 1e6, 0, 0, 0}};
    ns_signal triangle = {.kind = NS_PWL};
    bench b = open_bench();
    triangle.u.pwl.n = 3;
    triangle.u.pwl.t = t;
    triangle.u.pwl.v = v;
    triangle.u.pwl.repeat = 0;
    assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 1, 0, &sine, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "g", NS_VOLTAGE, 3, 0, &triangle, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "h", NS_VOLTAGE, 4, 0, &sine, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    start_at_rest(&b);
    return b;
}

/* The samples that the engine is asked for. */
static ns_engine_table counting;
static int (*counted)(ns_engine *e, double t, double *x, double *lambda);
static int samples;
static int count_sample(ns_engine *e, double t, double *x, double *lambda) {
    samples++;
    return counted(e, t, x, lambda);
}
static void count_samples(const bench *b) {
    ns_engine *e = NS_ENGINE_FOR(b->m->engine, sample);
    counting = *e->table;
    counted = counting.sample;
    counting.sample = count_sample;
    e->table = &counting;
    samples = 0;
}

/* The largest distance from the line between the ends of the trial, of 200 points. */
static double distance(const bench *b, int i, double from, double to) {
    double a[16], z[16], x[16], most = 0;
    assert_int_equal(ns_march_sample(b->m, from, a, NULL), NS_OK);
    assert_int_equal(ns_march_sample(b->m, to, z, NULL), NS_OK);
    for (int k = 1; k < 200; k++) {
        const double part = k / 200.0;
        assert_int_equal(ns_march_sample(b->m, from + part * (to - from), x, NULL), NS_OK);
        most = fmax(most, fabs(x[i] - ((1 - part) * a[i] + part * z[i])));
    }
    return most;
}

static double bend_of(const bench *b, int i) {
    return ns_engine_bend(NS_ENGINE_FOR(b->m->engine, bend), i);
}

/* No point is farther from the line than that; of a parabola, which a short step is, the middle is as far. */
static void of_each_step(void **state) {
    (void)state;
    bench b = two_gates();
    const int v2 = ns_circuit_node_unknown(b.c, 2), gate = ns_circuit_node_unknown(b.c, 3),
              sine = ns_circuit_node_unknown(b.c, 4);
    double t = 0, to, closest = INFINITY;
    int steps = 0;
    while (t < 2.9e-6) {
        /* steps of the engine, and parts of them */
        assert_int_equal(ns_march_try(b.m, steps % 2 ? t + 1e-8 : 3e-6, NS_TO_STEP, &to), NS_OK);
        const double most = distance(&b, v2, t, to), bend = bend_of(&b, v2);
        if (to > t && bend < INFINITY) {
            assert_true(most <= bend * (1 + 1e-9) + 1e-15);
            assert_true(bend_of(&b, gate) == 0 && distance(&b, gate, t, to) < 1e-14);
            assert_true(isinf(bend_of(&b, sine)));
            closest = fmin(closest, bend / most);
            steps++;
        }
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        t = to;
    }
    assert_true(steps > 20);
    assert_true(closest < 1.1);
    close_bench(&b);
}

static void run_watched(bench *b, const ns_threshold *at) {
    double t = 0;
    assert_int_equal(ns_march_watch(b->m, 2, at), NS_OK);
    for (int k = 0; k < 40 && t < 2.9e-6; k++) {
        samples = 0;
        assert_int_equal(ns_march_try(b->m, 2.9e-6, NS_TO_STEP, &t), NS_OK);
        if (ns_march_crossed(b->m))
            break;
        assert_int_equal(ns_march_accept(b->m), NS_OK);
    }
}

/* Far from what is watched two samples do; where one may be crossed there are as many as ever; of what bends
 * by nobody knows how much, too. */
static void of_samples(void **state) {
    (void)state;
    bench b = two_gates();
    const int v2 = ns_circuit_node_unknown(b.c, 2), gate = ns_circuit_node_unknown(b.c, 3),
              sine = ns_circuit_node_unknown(b.c, 4);
    count_samples(&b);
    const ns_threshold far[2] = {{v2, -1, 9, 0, 0}, {gate, -1, 4.1, 0, 0}};
    run_watched(&b, far);
    assert_int_equal(samples, 2);
    start_at_rest(&b);
    const ns_threshold unknown_bend[2] = {{v2, -1, 9, 0, 0}, {sine, -1, 9, 0, 0}};
    run_watched(&b, unknown_bend);
    assert_true(samples > 10);
    start_at_rest(&b);
    const ns_threshold near[2] = {{v2, -1, 9, 0, 0}, {gate, -1, 2, 0, 0}};
    run_watched(&b, near);
    assert_non_null(ns_march_crossed(b.m));
    assert_true(ns_march_crossed(b.m)[1] && !ns_march_crossed(b.m)[0]);
    close_bench(&b);
}

/* Where nothing is watched nothing is looked at, and a circuit without kinks has the pairs of its devices
 * alone: one of the diode, one of the switch. */
static void of_nothing_watched(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    (void)state;
    for (int k = 0; k < 2; k++) {
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = methods[k], .whole = 1};
        const ns_switch sw = {0.5, 0, 0, INFINITY};
        const ns_threshold never = {0, -1, 99, 0, 0};
        bench b = open_bench();
        double t = 0;
        add_dc(&b, "v", 1, 0, 12, NULL);
        add_step(&b, "g", 2, 0, 0, 1, 1e-6);
        assert_int_equal(ns_circuit_switch(b.c, "s", 1, 3, 2, 0, &sw, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 0, 3, &ideal_diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(b.c, "l", 3, 4, 1e-5, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 4, 0, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(b.s->m, 2);
        assert_int_equal(b.s->nc, 1);
        assert_int_equal(b.s->nz, 1); /* a constant is none */
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        start_at_rest(&b);
        count_samples(&b);
        for (int i = 0; i < 1000 && t < 5e-6; i++) {
            assert_int_equal(ns_march_try(b.m, 5e-6, NS_TO_STEP, &t), NS_OK);
            assert_int_equal(ns_march_accept(b.m), NS_OK);
        }
        assert_true(t == 5e-6);
        assert_int_equal(samples, 0);
        assert_null(b.m->watched);
        assert_int_equal(ns_march_counts(b.m)->looks, 0);
        assert_int_equal(ns_march_watch(b.m, 1, &never), NS_OK);
        assert_int_equal(ns_march_try(b.m, 6e-6, NS_TO_STEP, &t), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        assert_true(samples > 0 && ns_march_counts(b.m)->looks == samples);
        close_bench(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(of_each_step), cmocka_unit_test(of_samples),
                                       cmocka_unit_test(of_nothing_watched)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
