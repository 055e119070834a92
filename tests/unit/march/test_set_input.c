/* tests/unit/march/test_set_input.c - inputs replaced while a marcher runs (ns_march_set_input()): as if they
 * had been known from the beginning, in every engine. */
#include "march_bench.h"

#include <stdio.h>

enum { CHANGES = 24 };

/* A gate and a source that ramp, or jump, to another level at instants known only when they come. */
typedef struct plan {
    double t[CHANGES], ramp;                       /* s */
    double gate[CHANGES + 1], source[CHANGES + 1]; /* V: levels, before the first change and after each */
} plan;

static plan make_plan(double ramp) {
    plan p = {.ramp = ramp};
    for (int k = 0; k < CHANGES; k++) {
        p.t[k] = 1e-6 * (k + 1) + 1e-7 * ((k * 7) % 5);
        p.gate[k + 1] = (k + 1) % 2;
        p.source[k + 1] = 0.5 * ((k * 5) % 7) - 1;
    }
    return p;
}

enum { MOST_POINTS = 2 * CHANGES + 2 };

/* Changes from `first` on, `count` of them; a ramp long past, so that every engine knows there may be some.
 */
static ns_signal signal_of(const plan *p, const double *level, int first, int count, double *t, double *v) {
    ns_signal s = {.kind = NS_PWL};
    int n = 0;
    if (first == 0) {
        t[n] = -2;
        v[n++] = level[0] + 1;
        t[n] = -1;
        v[n++] = level[0];
    }
    for (int k = first; k < first + count; k++) {
        t[n] = p->t[k];
        v[n++] = level[k];
        t[n] = p->t[k] + p->ramp;
        v[n++] = level[k + 1];
    }
    s.u.pwl.n = n;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    return s;
}

/* Two bucks, the second with its gate inverted by its threshold; each with an input that enters it. */
static bench two_converters(const plan *p, int changes) {
    bench b = open_bench();
    double t[MOST_POINTS], v[MOST_POINTS];
    ns_switch inverted = ideal_switch;
    inverted.vt = -0.5;
    for (int k = 0, at = 1; k < 2; k++, at += 6) { /* nodes: supply, switched, out, gate, extra, its end */
        char name[8][8];
        for (int i = 0; i < 8; i++)
            snprintf(name[i], sizeof name[i], "e%d_%d", k, i);
        add_dc(&b, name[0], at, 0, 12, NULL);
        ns_signal s = signal_of(p, p->gate, 0, changes, t, v);
        assert_int_equal(
            ns_circuit_source(b.c, name[1], NS_VOLTAGE, k ? 0 : at + 3, k ? at + 3 : 0, &s, NULL), NS_OK);
        s = signal_of(p, p->source, 0, changes, t, v);
        assert_int_equal(ns_circuit_source(b.c, name[2], NS_VOLTAGE, at + 4, 0, &s, NULL), NS_OK);
        assert_int_equal(
            ns_circuit_switch(b.c, name[3], at, at + 1, at + 3, 0, k ? &inverted : &ideal_switch, NULL),
            NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, name[4], 0, at + 1, &ideal_diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(b.c, name[5], at + 1, at + 2, 10e-6, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, name[6], at + 2, at + 4, 1e-6, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, name[7], at + 2, 0, 5, NULL), NS_OK);
    }
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(b.s->nz, 4);
    return b;
}

static void start_with(bench *b, ns_method method, int whole) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-8, .method = method, .whole = whole};
    double w0[64];
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
}

static void go_by(ns_march *m, double t, ns_until until) {
    double reached = 0;
    while (reached < t) {
        assert_int_equal(ns_march_try(m, t, until, &reached), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
    }
}

static void set_levels(ns_march *m, const plan *p, int k) {
    double t[MOST_POINTS], v[MOST_POINTS];
    for (int z = 0; z < 4; z++) { /* in the order in which they were added */
        const ns_signal s = signal_of(p, z % 2 ? p->source : p->gate, k, 1, t, v);
        assert_int_equal(ns_march_set_input(m, z, &s), NS_OK);
    }
}

static void compare(bench *a, bench *b, double tolerance) {
    double x[2][64];
    assert_int_equal(ns_march_read(a->m, NULL, x[0], NULL, NULL), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, x[1], NULL, NULL), NS_OK);
    for (int i = 0; i < a->s->n; i++)
        assert_true(fabs(x[0][i] - x[1][i]) <= tolerance * 12); /* V; A */
}

static void as_if_known(ns_method method, int whole, ns_until until, double ramp, double tolerance) {
    const plan p = make_plan(ramp);
    bench known = two_converters(&p, CHANGES), told = two_converters(&p, 0);
    start_with(&known, method, whole);
    start_with(&told, method, whole);
    for (int k = 0; k < CHANGES; k++) {
        go_by(told.m, p.t[k], until);
        set_levels(told.m, &p, k);
        go_by(known.m, p.t[k], NS_TO_TIME);
        for (int part = 1; part <= 3; part++) {
            const double to = p.t[k] + 0.2e-6 * part;
            go_by(known.m, to, NS_TO_TIME);
            go_by(told.m, to, until);
            compare(&told, &known, tolerance);
        }
    }
    assert_true(ns_march_counts(told.m)->events >= CHANGES); /* the switches did switch */
    close_bench(&known);
    close_bench(&told);
}

static void in_every_way(ns_method method, double tolerance) {
    for (int until = NS_TO_TIME; until <= NS_TO_STEP; until++) {
        as_if_known(method, 1, (ns_until)until, 1e-8, tolerance);
        as_if_known(method, 1, (ns_until)until, 0, tolerance);
        as_if_known(method, 0, (ns_until)until, 1e-8, tolerance);
    }
}

static void by_exact(void **state) {
    (void)state;
    in_every_way(NS_EXACT, 1e-12);
}

static void by_sparse(void **state) {
    (void)state;
    in_every_way(NS_SPARSE, 1e-8); /* reltol 1e-9 a step */
}

static void by_theta(void **state) {
    (void)state;
    in_every_way(NS_THETA, 2e-3); /* of first order, other steps */
}

static void by_auto(void **state) {
    (void)state;
    in_every_way(NS_AUTO, 1e-12);
}

static void bad_calls(void **state) {
    (void)state;
    const plan p = make_plan(1e-8);
    double t[MOST_POINTS], v[MOST_POINTS];
    bench b = two_converters(&p, 0);
    ns_signal s = signal_of(&p, p.gate, 0, 1, t, v), dc = {.kind = NS_DC};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-8};
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    assert_int_equal(ns_march_set_input(b.m, 0, &s), NS_E_STATE);
    ns_march_free(b.m);
    start_with(&b, NS_EXACT, 0);
    assert_int_equal(ns_march_set_input(NULL, 0, &s), NS_E_NULL);
    assert_int_equal(ns_march_set_input(b.m, 0, NULL), NS_E_NULL);
    assert_int_equal(ns_march_set_input(b.m, -1, &s), NS_E_SIZE);
    assert_int_equal(ns_march_set_input(b.m, 4, &s), NS_E_SIZE);
    assert_int_equal(ns_march_set_input(b.m, 0, &dc), NS_E_RANGE);
    s = signal_of(&p, p.gate, 1, 1, t, v); /* 1 V before, where there is 0 V */
    assert_int_equal(ns_march_set_input(b.m, 0, &s), NS_E_RANGE);
    v[0] = NAN;
    assert_int_equal(ns_march_set_input(b.m, 0, &s), NS_E_NUMBER);
    close_bench(&b);
}

/* Without a ramp at first, the exact engine has no state for its slope. */
static void ramps_without_a_slope(void **state) {
    (void)state;
    const double us = 1e-6, t[2] = {us, 2 * us}, v[2] = {0, 1}, jump[2] = {us, us};
    ns_signal s = {.kind = NS_PWL};
    bench b = open_bench();
    s.u.pwl.n = 2;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    add_step(&b, "v", 1, 0, 0, 0, -1);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    start_with(&b, NS_EXACT, 0);
    go(b.m, us);
    assert_int_equal(ns_march_set_input(b.m, 0, &s), NS_E_RANGE);
    close_bench(&b);
    b = open_bench();
    add_step(&b, "v", 1, 0, 0, 0, -1);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    start_with(&b, NS_EXACT, 0);
    s.u.pwl.t = jump;
    go(b.m, us);
    assert_int_equal(ns_march_set_input(b.m, 0, &s), NS_OK);
    go(b.m, 2 * us);
    assert_true(fabs(v_of(&b, 2) - (1 - exp(-1))) < 1e-12); /* RC = 1 us */
    close_bench(&b);
}

/* An input that jumps where it is set makes that an event, which is resolved before time goes on: the source
 * at 1 V, the capacitor still at 0. */
static void a_jump_is_an_event(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA};
    const double us = 1e-6, t[2] = {us, us}, v[2] = {0, 1};
    const ns_signal s = {.kind = NS_PWL, .u.pwl = {2, t, v, NAN, 0}};
    (void)state;
    for (int k = 0; k < 3; k++) {
        double reached;
        bench b = open_bench();
        add_step(&b, "v", 1, 0, 0, 0, -1);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e3, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-9, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        start_with(&b, methods[k], 0);
        go(b.m, us);
        assert_false(ns_march_at_event(b.m));
        assert_int_equal(ns_march_set_input(b.m, 0, &s), NS_OK);
        assert_true(ns_march_at_event(b.m));
        assert_int_equal(ns_march_try(b.m, 2 * us, NS_TO_EVENT, &reached), NS_OK);
        assert_true(reached - us < 2e-14); /* theta: h/2^19, in which C takes 2e-8 V */
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        assert_true(v_of(&b, 1) == 1 && fabs(v_of(&b, 2)) <= 2e-8);
        close_bench(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_exact),           cmocka_unit_test(by_sparse),
        cmocka_unit_test(by_theta),           cmocka_unit_test(by_auto),
        cmocka_unit_test(bad_calls),          cmocka_unit_test(ramps_without_a_slope),
        cmocka_unit_test(a_jump_is_an_event),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
