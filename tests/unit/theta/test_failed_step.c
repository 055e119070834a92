/* tests/unit/theta/test_failed_step.c - the problem of a failed step is handed out, fails alone, and has
 * names. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "wrap_alloc.h"

static const ns_diode plain = {0, 0, INFINITY, INFINITY, 0};

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
} bench;

/* A source across a diode, v = v0 at 0, v1 at 1 s: x = (v, i of the source), one pair (diode's).
 *   0 = i + lambda       (KCL, sign free)     0 = source - v      y = -v >= 0,  lambda >= 0
 * There is a solution while source <= 0. */
static bench across(double v0, double v1) {
    const double t[2] = {0, 1}, v[2] = {v0, v1};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 0.125};
    ns_signal s = {.kind = NS_PWL};
    bench b = {0};
    s.u.pwl.n = 2;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "v1", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d1", 1, 0, &plain, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    return b;
}

static void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static void start(bench *b) {
    const double w0[2] = {0, 0};
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
}

/* Alone, from nothing, the problem has no solution, and the proof stands. */
static void assert_infeasible(const ns_mlcp *p) {
    ns_mlcp_solver *solver = NULL;
    ns_mlcp_info info;
    ns_mode mode[8] = {0};
    double lambda[8], y[8];
    assert_true(p->m <= 8);
    assert_int_equal(ns_mlcp_create(p->m, &solver), NS_OK);
    assert_int_equal(ns_mlcp_solve(solver, p, mode, lambda, y, &info), NS_E_INFEASIBLE);
    if (info.certified)
        assert_true(ns_mlcp_certify(p, ns_mlcp_certificate(solver)) > 0);
    ns_mlcp_free(solver);
}

/* Rows and bounds as above; the two equalities may come combined, so they are looked at where only
 * v = source, i = -lambda makes both zero. */
static void assert_diode_across(const ns_mlcp *p, double source) {
    const double x[3] = {source, -1, 1};
    assert_int_equal(p->m, 3);
    for (int i = 0; i < 2; i++) {
        double y = p->q[i];
        for (int j = 0; j < 3; j++)
            y += p->W[i + 3 * j] * x[j];
        assert_true(fabs(y) < 1e-12); /* a few roundings of terms near 1 */
        assert_true(p->l[i] == -INFINITY && p->u[i] == INFINITY);
    }
    assert_true(p->W[2] == -1 && p->W[5] == 0 && p->W[8] == 0 && p->q[2] == 0);
    assert_true(p->l[2] == 0 && p->u[2] == INFINITY);
    assert_infeasible(p);
}

/* The source passes 0 at t = 1/2; the marcher locates that and fails in a step of its shortest length, over
 * which the source grows by 2 h: within some of them it is at most 1e-6. */
static void a_step_is_handed_out(void **state) {
    bench b = across(-1, 1);
    ns_mlcp p;
    double reached, h = NAN;
    (void)state;
    start(&b);
    assert_int_equal(ns_march_problem(b.m, &p, &h), NS_E_STATE);
    assert_int_equal(ns_march_try(b.m, 0.25, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_problem(b.m, &p, &h), NS_E_STATE);
    assert_int_equal(ns_march_try(b.m, 1, NS_TO_TIME, &reached), NS_E_INFEASIBLE);
    fail_alloc_at(0);
    assert_int_equal(ns_march_problem(b.m, &p, &h), NS_OK);
    assert_int_equal(allocs_made(), 0); /* nothing that could fail */
    fail_alloc_off();
    assert_true(h > 0 && h < 0.125 / 1024);
    assert_true(fabs(ns_march_fault(b.m)->t - 0.5) < 1e-6);
    assert_diode_across(&p, 2 * (ns_march_fault(b.m)->t + h - 0.5));
    assert_int_equal(ns_march_problem(b.m, &p, NULL), NS_OK);
    close_bench(&b);
}

/* What was handed out is not taken for that of a later call. */
static void later_calls_forget_it(void **state) {
    bench b = across(-1, 1);
    const double bad[2] = {NAN, NAN};
    ns_mlcp p;
    double reached;
    (void)state;
    start(&b);
    assert_int_equal(ns_march_try(b.m, 1, NS_TO_TIME, &reached), NS_E_INFEASIBLE);
    assert_int_equal(ns_march_try(b.m, -1, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_problem(b.m, &p, NULL), NS_E_STATE);
    assert_int_equal(ns_march_try(b.m, 1, NS_TO_TIME, &reached), NS_E_INFEASIBLE);
    assert_int_equal(ns_march_try(b.m, 0.25, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_problem(b.m, &p, NULL), NS_E_STATE);
    assert_int_equal(ns_march_try(b.m, 1, NS_TO_TIME, &reached), NS_E_INFEASIBLE);
    assert_int_equal(ns_march_start(b.m, 0, bad), NS_E_NUMBER);
    assert_int_equal(ns_march_problem(b.m, &p, NULL), NS_E_STATE);
    close_bench(&b);
}

/* 5 V forward at the operating point; with and without the node held at 3 V, which adds a row. */
static void an_operating_point_is_handed_out(void **state) {
    bench b = across(5, 5);
    const int hold[1] = {0};
    const double at[1] = {3};
    ns_mlcp p;
    double h = NAN;
    (void)state;
    assert_int_equal(ns_march_start_dc(b.m, 0, 0, NULL, NULL, NULL), NS_E_INFEASIBLE);
    assert_int_equal(ns_march_problem(b.m, &p, &h), NS_OK);
    assert_true(h == 0);
    assert_diode_across(&p, 5);
    assert_int_equal(ns_march_start_dc(b.m, 0, 1, hold, at, NULL), NS_E_INFEASIBLE);
    assert_int_equal(ns_march_problem(b.m, &p, &h), NS_OK);
    assert_int_equal(p.m, 4);
    assert_true(h == 0 && p.W[3] == 1 && p.q[3] == -3); /* 0 = v - 3 */
    assert_infeasible(&p);
    close_bench(&b);
}

/* Written and read, it is the same problem to the last bit. */
static void it_goes_through_a_text(void **state) {
    bench b = across(5, 5);
    ns_mlcp p, *back = NULL;
    char text[4096];
    size_t length = 0;
    (void)state;
    assert_int_equal(ns_march_start_dc(b.m, 0, 0, NULL, NULL, NULL), NS_E_INFEASIBLE);
    assert_int_equal(ns_march_problem(b.m, &p, NULL), NS_OK);
    assert_int_equal(ns_mlcp_write(&p, text, sizeof text, &length), NS_OK);
    assert_true(length < sizeof text);
    assert_int_equal(ns_mlcp_read(text, length, &back, NULL), NS_OK);
    assert_int_equal(back->m, p.m);
    assert_memory_equal(back->W, p.W, 9 * sizeof(double));
    assert_memory_equal(back->q, p.q, 3 * sizeof(double));
    assert_infeasible(back);
    ns_mlcp_discard(back);
    close_bench(&b);
}

static void the_stepper_hands_it_out_too(void **state) {
    bench b = across(-1, 1);
    const ns_theta_options o = {1, 1, 0};
    const double w0[2] = {0, 0}, good[1] = {-1}, bad[1] = {2};
    ns_theta *step = NULL;
    ns_mlcp p;
    double h = NAN;
    (void)state;
    assert_int_equal(ns_theta_create(b.s, &o, &step, NULL), NS_OK);
    assert_int_equal(ns_theta_start(step, w0, NULL), NS_OK);
    assert_int_equal(ns_theta_problem(step, &p, &h), NS_E_STATE);
    assert_int_equal(ns_theta_try(step, 0.5, bad, 0, NS_RESOLVE), NS_E_INFEASIBLE);
    assert_int_equal(ns_theta_problem(step, &p, &h), NS_OK);
    assert_true(h == 0.5);
    assert_diode_across(&p, 2);
    assert_int_equal(ns_theta_try(step, 0.5, good, 0, NS_RESOLVE), NS_OK);
    assert_int_equal(ns_theta_problem(step, &p, &h), NS_E_STATE);
    assert_int_equal(ns_theta_try(step, 0.5, bad, 0, NS_RESOLVE), NS_E_INFEASIBLE);
    assert_int_equal(ns_theta_try(step, -1, bad, 0, NS_RESOLVE), NS_E_RANGE);
    assert_int_equal(ns_theta_problem(step, &p, &h), NS_E_STATE);
    assert_int_equal(ns_theta_problem(NULL, &p, &h), NS_E_NULL);
    assert_int_equal(ns_theta_problem(step, NULL, &h), NS_E_NULL);
    assert_int_equal(ns_march_problem(NULL, &p, &h), NS_E_NULL);
    assert_int_equal(ns_march_problem(b.m, NULL, &h), NS_E_NULL);
    ns_theta_free(step);
    close_bench(&b);
}

/* 1 V and 2 V at one node, which no leaks of the diode behind a resistor help: the problem is without them,
 * y = v(2) and lambda enters the rows of x alone. */
static void leaks_are_not_handed_out(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const ns_signal dc = {.kind = NS_DC, .u.dc = 1};
    const double w0[4] = {0}, z[2] = {1, 2};
    bench b = {0};
    ns_theta *step = NULL;
    ns_mlcp p;
    (void)state;
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "v1", NS_VOLTAGE, 1, 0, &dc, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "v2", NS_VOLTAGE, 1, 0, &dc, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d1", 0, 2, &plain, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_theta_create(b.s, &o, &step, NULL), NS_OK);
    assert_int_equal(ns_theta_start(step, w0, NULL), NS_OK);
    assert_int_equal(ns_theta_try(step, 0.5, z, 0, NS_RESOLVE), NS_E_SINGULAR); /* their currents */
    assert_int_equal(ns_theta_problem(step, &p, NULL), NS_OK);
    assert_int_equal(p.m, 5);
    for (int j = 0; j < 5; j++)
        assert_true(p.W[4 + 5 * j] == (j == ns_circuit_node_unknown(b.c, 2)));
    assert_true(p.q[4] == 0);
    ns_theta_free(step);
    close_bench(&b);
}

static void assert_name(int (*name)(const ns_circuit *, int, char *, size_t), const ns_circuit *c, int index,
                        const char *want) {
    char line[64];
    assert_int_equal(name(c, index, line, sizeof line), strlen(want));
    assert_string_equal(line, want);
    assert_int_equal(name(c, index, line, 6), strlen(want));
    assert_int_equal(strlen(line), strlen(want) < 5 ? strlen(want) : 5);
    assert_int_equal(name(c, index, NULL, 0), strlen(want));
}

static void unknowns_and_pairs_have_names(void **state) {
    const ns_diode zener = {0.6, 1, 1e6, 3, 2};
    const ns_switch sw = {0.5, 0, 0, 1e6};
    ns_circuit *c = NULL;
    (void)state;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 1, 0, &zener, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 1, 2, 1, 0, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 2, 0, 1e-3, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_name_node(c, 2, "o\nut"), NS_OK);
    assert_name(ns_circuit_name_unknown, c, 0, "voltage of node 1");
    assert_name(ns_circuit_name_unknown, c, 1, "voltage of node o?ut");
    assert_name(ns_circuit_name_unknown, c, 2, "current of l1");
    assert_name(ns_circuit_name_unknown, c, 3, "unknown 3");
    assert_name(ns_circuit_name_unknown, c, -1, "unknown -1");
    assert_name(ns_circuit_name_unknown, NULL, 0, "unknown 0");
    assert_name(ns_circuit_name_pair, c, 0, "ideal diode d1");
    assert_name(ns_circuit_name_pair, c, 1, "breakdown of ideal diode d1");
    assert_name(ns_circuit_name_pair, c, 2, "ideal switch s1");
    assert_name(ns_circuit_name_pair, c, 3, "pair 3");
    assert_name(ns_circuit_name_pair, NULL, 0, "pair 0");
    assert_name(ns_circuit_name_element, c, 1, "s1");
    assert_name(ns_circuit_name_element, c, 3, "element 3");
    assert_name(ns_circuit_name_element, c, -1, "element -1");
    assert_name(ns_circuit_name_element, NULL, 0, "element 0");
    assert_int_equal(ns_circuit_count(c), 3);
    assert_int_equal(ns_circuit_count(NULL), 0);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_is_handed_out),
        cmocka_unit_test(later_calls_forget_it),
        cmocka_unit_test(an_operating_point_is_handed_out),
        cmocka_unit_test(it_goes_through_a_text),
        cmocka_unit_test(the_stepper_hands_it_out_too),
        cmocka_unit_test(leaks_are_not_handed_out),
        cmocka_unit_test(unknowns_and_pairs_have_names),
    };
    return cmocka_run_group_tests_name("failed step", tests, NULL, NULL);
}
