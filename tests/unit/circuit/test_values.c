/* tests/unit/circuit/test_values.c - kinks and choices: elements that are a value, in every engine. */
#include "march_bench.h"

static void sine(bench *b, int node, double offset, double amplitude, double freq) {
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.vo = offset;
    s.u.sin.va = amplitude;
    s.u.sin.freq = freq;
    assert_int_equal(ns_circuit_source(b->c, node == 1 ? "va" : "vb", NS_VOLTAGE, node, 0, &s, NULL), NS_OK);
}

static void begin(bench *b, ns_method method) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-5, .method = method};
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    start_at_rest(b);
}

static int value(bench *b, const char *name, double constant, int n, const ns_term *terms) {
    const ns_affine u = {constant, n, terms};
    int id = -1;
    assert_int_equal(ns_circuit_kink(b->c, name, &u, &id), NS_OK);
    return id;
}

static void output(bench *b, const char *name, int node, double constant, int n, const ns_term *terms) {
    assert_int_equal(ns_circuit_linear(b->c, name, NS_VOLTAGE, node, 0, constant, n, terms, NULL), NS_OK);
}

/* v(1) = 2 sin, v(2) = 1 + sin at another frequency.
 *   3: abs(v1) = 2 max(v1,0) - v1        4: min(v1, v2) = v1 - max(v1 - v2, 0)
 *   5: limit(v1, -1, 0.5), two kinks, the second of the first     6: v1 > 0.3 ? v2 : 2 v1
 *   7: (v1 > 0.3) and (v2 > 1.2), a choice of a choice */
static bench formulas(ns_method method) {
    bench b = open_bench();
    sine(&b, 1, 0, 2, 1000);
    sine(&b, 2, 1, 1, 370);
    const int positive = value(&b, "k1", 0, 1, (ns_term[]){{0, 1, 1}});
    output(&b, "abs", 3, 0, 2, (ns_term[]){{2, positive, 2}, {0, 1, -1}});
    const int above = value(&b, "k2", 0, 2, (ns_term[]){{0, 1, 1}, {0, 2, -1}});
    output(&b, "min", 4, 0, 2, (ns_term[]){{0, 1, 1}, {2, above, -1}});
    const int low = value(&b, "k3", 1, 1, (ns_term[]){{0, 1, 1}});       /* v1 >= -1: low - 1 */
    const int high = value(&b, "k4", -1.5, 1, (ns_term[]){{2, low, 1}}); /* beyond 0.5 */
    output(&b, "limit", 5, -1, 2, (ns_term[]){{2, low, 1}, {2, high, -1}});
    const ns_affine v1 = {0, 1, (ns_term[]){{0, 1, 1}}}, v2 = {0, 1, (ns_term[]){{0, 2, 1}}},
                    difference = {0, 2, (ns_term[]){{0, 2, 1}, {0, 1, -2}}}, one = {1, 0, NULL};
    int either, first, both;
    assert_int_equal(ns_circuit_choice(b.c, "c1", &v1, 0.3, &difference, &either), NS_OK);
    output(&b, "either", 6, 0, 2, (ns_term[]){{0, 1, 2}, {2, either, 1}});
    assert_int_equal(ns_circuit_choice(b.c, "c2", &v1, 0.3, &one, &first), NS_OK);
    const ns_affine of_first = {0, 1, (ns_term[]){{2, first, 1}}};
    assert_int_equal(ns_circuit_choice(b.c, "c3", &v2, 1.2, &of_first, &both), NS_OK);
    output(&b, "both", 7, 0, 1, (ns_term[]){{2, both, 1}});
    begin(&b, method);
    assert_int_equal(b.s->n, 7 + 7); /* nodes and their sources: values have no unknown */
    assert_int_equal(b.s->m, 7);
    return b;
}

static void follow_formulas(ns_method method, double tolerance) {
    bench b = formulas(method);
    for (int k = 1; k <= 300; k++) {
        const double t = k * 1.37e-5, v1 = 2 * sin(2 * pi * 1000 * t), v2 = 1 + sin(2 * pi * 370 * t);
        go(b.m, t);
        assert_true(fabs(v_of(&b, 3) - fabs(v1)) < tolerance);
        assert_true(fabs(v_of(&b, 4) - fmin(v1, v2)) < tolerance);
        assert_true(fabs(v_of(&b, 5) - fmax(-1, fmin(0.5, v1))) < tolerance);
        assert_true(fabs(v_of(&b, 6) - (v1 > 0.3 ? v2 : 2 * v1)) < tolerance);
        assert_true(fabs(v_of(&b, 7) - (v1 > 0.3 && v2 > 1.2)) < tolerance);
    }
    close_bench(&b);
}

static void formulas_in_every_engine(void **state) {
    (void)state;
    follow_formulas(NS_EXACT, 1e-12);
    follow_formulas(NS_AUTO, 1e-12);
    follow_formulas(NS_SPARSE, 1e-8); /* reltol 1e-9 */
    follow_formulas(NS_THETA, 1e-9);  /* no charge: each step is right */
}

/* 1 V through 1 kohm into 1 uF, from 0; what is above 0.5 V draws 1 mA/V more: v = 1 - exp(-t/ms) until
 * ln 2 ms, then 2 v + dv/d(t/ms) = 1.5: v = 0.75 - 0.25 exp(-2 (t/ms - ln 2)). */
static void corner_is_an_event(void **state) {
    (void)state;
    for (int method = NS_AUTO; method <= NS_SPARSE; method++) {
        if (method == NS_THETA)
            continue;
        bench b = open_bench();
        add_dc(&b, "v", 1, 0, 1, NULL);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e3, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-6, 0, NULL), NS_OK);
        const int above = value(&b, "k", -0.5, 1, (ns_term[]){{0, 2, 1}});
        assert_int_equal(
            ns_circuit_linear(b.c, "g", NS_CURRENT, 2, 0, 0, 1, (ns_term[]){{2, above, 1e-3}}, NULL), NS_OK);
        begin(&b, (ns_method)method);
        double reached;
        assert_int_equal(ns_march_try(b.m, 1e-2, NS_TO_EVENT, &reached), NS_OK);
        assert_true(fabs(reached - 1e-3 * log(2)) < (method == NS_SPARSE ? 1e-11 : 1e-17));
        go(b.m, 2e-3);
        const double v = 0.75 - 0.25 * exp(-2 * (2 - log(2)));
        assert_true(fabs(v_of(&b, 2) - v) < (method == NS_SPARSE ? 1e-8 : 1e-13));
        close_bench(&b);
    }
}

/* A choice by a source is a command of time, hit exactly; by the state, one of the state. */
static void commands(void **state) {
    (void)state;
    bench b = open_bench();
    sine(&b, 1, 0, 2, 1000);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "s", 2, 0, 1, NULL), NS_OK);
    const ns_affine known = {0.5, 1, (ns_term[]){{0, 1, 3}}}, unknown = {0.5, 1, (ns_term[]){{0, 2, 3}}},
                    one = {1, 0, NULL};
    assert_int_equal(ns_circuit_choice(b.c, "c", &known, 2, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_choice(b.c, "d", &unknown, 2, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_null(b.s->command[0].gx);
    assert_true(b.s->command[0].gz[0] == 3 && b.s->command[0].g0 == 0.5 && b.s->command[0].on == 2);
    assert_non_null(b.s->command[1].gx);
    assert_true(b.s->command[1].gx[1] == 3 && b.s->command[1].g0 == 0.5);
    ns_system_free(b.s);
    ns_circuit_free(b.c);
}

/* 1 uF that a current of -2 to 1 uA drives towards a triangle of 3 V/s up and down: it follows at 1 V/s up,
 * 2 V/s down, and on it where that is slower.  v' = 1 from 0, against 3 t up to 1 s: at 1 s 1 V; then the
 * triangle falls from 3 V at 3 V/s and is met at 1 + t = 3 - 3 t, t = 0.5 s, 1.5 V; from there -2 V/s. */
static void box_limits_a_rate(void **state) {
    (void)state;
    for (int method = NS_AUTO; method <= NS_SPARSE; method++) {
        if (method == NS_THETA)
            continue;
        bench b = open_bench();
        const double t[3] = {0, 1, 2}, v[3] = {0, 3, 0};
        ns_signal s = {.kind = NS_PWL};
        int id;
        s.u.pwl.n = 3;
        s.u.pwl.t = t;
        s.u.pwl.v = v;
        s.u.pwl.repeat = NAN;
        assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-6, 0, NULL), NS_OK);
        const ns_affine y = {0, 2, (ns_term[]){{0, 2, 1}, {0, 1, -1}}};
        assert_int_equal(ns_circuit_box(b.c, "box", -2e-6, 1e-6, &y, &id), NS_OK);
        assert_int_equal(ns_circuit_linear(b.c, "i", NS_CURRENT, 0, 2, 0, 1, (ns_term[]){{2, id, 1}}, NULL),
                         NS_OK);
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-2, .method = (ns_method)method};
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        start_at_rest(&b);
        go(b.m, 1);
        assert_true(fabs(v_of(&b, 2) - 1) < 1e-8);
        go(b.m, 1.75);
        assert_true(fabs(v_of(&b, 2) - (1.5 - 2 * 0.25)) < 1e-8);
        go(b.m, 2.25);
        assert_true(fabs(v_of(&b, 2)) < 1e-8); /* at 2 s 0.5 V above, met at 2.25 s */
        go(b.m, 3);
        assert_true(fabs(v_of(&b, 2)) < 1e-8); /* on it */
        close_bench(&b);
    }
}

static void bad_calls(void **state) {
    (void)state;
    bench b = open_bench();
    int r, k, c;
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 1, &r), NS_OK);
    const ns_affine one = {1, 0, NULL}, none = {1, 1, NULL}, less = {1, -1, NULL}, bad = {NAN, 0, NULL};
    assert_int_equal(ns_circuit_kink(NULL, "k", &one, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_kink(b.c, "k", NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_kink(b.c, "k", &none, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_kink(b.c, "k", &less, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_kink(b.c, "k", &bad, NULL), NS_E_NUMBER);
    assert_int_equal(ns_circuit_kink(b.c, "r", &one, NULL), NS_E_NAME);
    assert_int_equal(ns_circuit_kink(b.c, "k", &one, &k), NS_OK);
    assert_int_equal(ns_circuit_choice(b.c, "c", &one, NAN, &one, NULL), NS_E_NUMBER);
    assert_int_equal(ns_circuit_choice(b.c, "c", &one, 0, &bad, NULL), NS_E_NUMBER);
    const ns_affine of_k = {0, 1, (ns_term[]){{2, k, 1}}}, of_r = {0, 1, (ns_term[]){{2, r, 1}}},
                    of_99 = {0, 1, (ns_term[]){{2, 99, 1}}}, kind_3 = {0, 1, (ns_term[]){{3, k, 1}}};
    assert_int_equal(ns_circuit_choice(b.c, "c", &of_k, 0, &one, NULL), NS_E_RANGE);
    assert_int_equal(ns_circuit_choice(b.c, "c", &one, 0, &of_r, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_choice(b.c, "c", &one, 0, &of_99, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_kink(b.c, "c", &kind_3, NULL), NS_E_RANGE);
    assert_int_equal(ns_circuit_choice(b.c, "c", &one, 0, &of_k, &c), NS_OK);
    assert_int_equal(ns_circuit_box(b.c, "x", 1, 1, &one, NULL), NS_E_RANGE);
    assert_int_equal(ns_circuit_box(b.c, "x", NAN, 1, &one, NULL), NS_E_NUMBER);
    assert_int_equal(ns_circuit_box(b.c, "x", 0, 1, NULL, NULL), NS_E_NULL);
    char line[80];
    assert_int_equal(ns_circuit_name_pair(b.c, 0, line, sizeof line), strlen("corner of k"));
    assert_string_equal(line, "corner of k");
    (void)ns_circuit_name_pair(b.c, 1, line, sizeof line);
    assert_string_equal(line, "choice of c");
    assert_int_equal(ns_circuit_device(b.c, k, NULL, NULL, NULL, NULL, NULL, NULL), NS_E_SIZE);
    ns_circuit_free(b.c);
}

/* A diode that breaks down has two pairs, the first of which is named; an element that is no device has none.
 */
static void pairs_are_numbered(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_diode breaks = {.roff = INFINITY, .vz = 5};
    const ns_switch s = {.vt = 0.5, .roff = INFINITY};
    int r, d, closes;
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 1, &r), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &breaks, &d), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s", 1, 2, 1, 0, &s, &closes), NS_OK);
    assert_int_equal(ns_circuit_pair(b.c, r), -1);
    assert_int_equal(ns_circuit_pair(b.c, d), 0);
    assert_int_equal(ns_circuit_pair(b.c, closes), 2);
    assert_int_equal(ns_circuit_pair(b.c, -1), -1);
    ns_circuit_free(b.c);
}

/* Sources that are not DC are inputs, in their order; the first element is number 0. */
static void inputs_are_numbered(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_signal dc = {.kind = NS_DC, .u.dc = 1};
    int fixed = -1;
    sine(&b, 1, 0, 2, 1000);
    assert_int_equal(ns_circuit_source(b.c, "vd", NS_VOLTAGE, 3, 0, &dc, &fixed), NS_OK);
    sine(&b, 2, 1, 1, 370);
    assert_int_equal(ns_circuit_input(b.c, 0), 0);
    assert_int_equal(ns_circuit_input(b.c, fixed), -1);
    assert_int_equal(ns_circuit_input(b.c, 2), 1);
    assert_int_equal(ns_circuit_input(b.c, 3), -1);
    assert_int_equal(ns_circuit_input(b.c, -1), -1);
    assert_int_equal(ns_circuit_input(NULL, 0), -1);
    ns_circuit_free(b.c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formulas_in_every_engine),
        cmocka_unit_test(corner_is_an_event),
        cmocka_unit_test(commands),
        cmocka_unit_test(box_limits_a_rate),
        cmocka_unit_test(bad_calls),
        cmocka_unit_test(inputs_are_numbered),
        cmocka_unit_test(pairs_are_numbered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
