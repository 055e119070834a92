/* tests/unit/theta/test_name_fault.c - an error names what contradicts, not what has the same index in the
 * rows solved.
 *
 * Those are differential ones first, then sums.  What must be named follows from Kirchhoff's laws. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "theta/name_fault.h"

static const ns_switch ideal = {0.5, 0, 0, INFINITY};

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
} bench;

static void source(bench *b, const char *name, ns_output kind, int p, int n, double value) {
    const ns_signal s = {.kind = NS_DC, .u.dc = value};
    assert_int_equal(ns_circuit_source(b->c, name, kind, p, n, &s, NULL), NS_OK);
}

static void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static bench open_bench(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

/* What an operating point and a step from nothing are refused for begins with this. */
static void assert_blames(bench *b, int blamed_for, const char *names) {
    static const double nothing[16];
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7};
    double reached;
    char line[256];
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= 16);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    for (int step = 0; step < 2; step++) {
        int status =
            step ? ns_march_start(b->m, 0, nothing) : ns_march_start_dc(b->m, 0, 0, NULL, NULL, NULL);
        if (step && status == NS_OK)
            status = ns_march_try(b->m, 1e-6, NS_TO_TIME, &reached);
        assert_int_equal(status, blamed_for);
        ns_circuit_explain(b->c, ns_march_fault(b->m), line, sizeof line);
        print_message("%s\n", line);
        assert_memory_equal(line, names, strlen(names));
    }
}

/* Closed switches from a source of 12 V to one of 5 V; the inductor and the capacitor have no part in it.
 * Each element of the loop carries the same weight: the order is that of their numbers. */
static void a_loop_of_sources_and_switches(void **state) {
    (void)state;
    bench b = open_bench();
    source(&b, "v1", NS_VOLTAGE, 1, 0, 12);
    source(&b, "vg", NS_VOLTAGE, 2, 0, 1);
    source(&b, "vu", NS_VOLTAGE, 3, 0, 1);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 4, 2, 0, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 4, 0, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s2", 4, 5, 2, 0, &ideal, NULL), NS_OK);
    source(&b, "v2", NS_VOLTAGE, 5, 0, 5);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", 4, 6, 1e-4, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 6, 0, 1e-5, NAN, NULL), NS_OK);
    assert_blames(&b, NS_E_INFEASIBLE, "s1, s2, v1, v2: ");
    close_bench(&b);
}

/* A control node that nothing drives (a misspelt name), and what an amplifier makes of it: 7 and 8. */
static void a_node_that_is_only_read(void **state) {
    (void)state;
    bench b = open_bench();
    source(&b, "v1", NS_VOLTAGE, 1, 0, 12);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 4, 7, 0, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 4, 0, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(b.c, "e1", NS_VOLTAGE, 8, 0, 7, 0, 1, NULL), NS_OK);
    assert_blames(&b, NS_E_SINGULAR, "node 7, node 8: ");
    close_bench(&b);
}

/* The same for one source shorted. */
static void a_source_shorted(void **state) {
    (void)state;
    bench b = open_bench();
    source(&b, "v1", NS_VOLTAGE, 1, 0, 12);
    source(&b, "v2", NS_VOLTAGE, 2, 0, 1);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 0, 2, 0, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", 1, 3, 1e-3, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 3, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 3, 0, 5, NULL), NS_OK);
    assert_blames(&b, NS_E_INFEASIBLE, "s1, v1: ");
    close_bench(&b);
}

/* 1 A into an island of nodes 1 and 2, which a capacitor joins: the sum of their KCL, 1 A = 0, contradicts.
 */
static void an_island_of_two_nodes(void **state) {
    static const double nothing[4];
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7};
    bench b = open_bench();
    double reached;
    (void)state;
    source(&b, "i1", NS_CURRENT, 0, 1, 1);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 2, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", 3, 0, 1e-3, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 3, 0, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(b.s->n, 4);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    int status = ns_march_start(b.m, 0, nothing);
    status = status == NS_OK ? ns_march_try(b.m, 1e-6, NS_TO_TIME, &reached) : status;
    assert_int_equal(status, NS_E_INFEASIBLE);
    const ns_fault *f = ns_march_fault(b.m);
    assert_int_equal(f->npairs, 0);
    assert_int_equal(f->nunknowns, 2);
    assert_int_equal(f->unknown[0] + f->unknown[1], 1);
    close_bench(&b);
}

/* 0 = u - 1, w' = -w, y = u - 2 = 0; x = (u, an unknown that no row has, w): W is singular, and w's row comes
 * first. */
static void newton_names_rows_too(void **state) {
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    const double x[3] = {0};
    ns_system *s;
    ns_model model;
    ns_newton *step;
    (void)state;
    assert_int_equal(ns_system_create(3, 1, 0, 0, &s), NS_OK);
    s->M[8] = 1;
    s->A[8] = -1;
    s->A[0] = s->C[0] = 1;
    s->b[0] = -1;
    s->e[0] = -2;
    s->l[0] = -INFINITY;
    s->u[0] = INFINITY;
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    assert_int_equal(ns_newton_create(&model, &o, &step, NULL), NS_OK);
    assert_int_equal(ns_newton_start(step, 0, x, NULL), NS_OK);
    assert_int_equal(ns_newton_try(step, 1), NS_E_INFEASIBLE);
    const ns_fault *f = ns_newton_fault(step);
    assert_int_equal(f->npairs, 1);
    assert_int_equal(f->nunknowns, 1);
    assert_int_equal(f->unknown[0], 0);
    ns_newton_free(step);
    ns_system_free(s);
}

/* Without a proof: row 0 of the split system is row 2 of the system, which is differential, row 1 is row 0,
 * and row 2 is row 1 plus the differential one; 3 and 4 are pairs, 5 is neither. */
static void rows_are_those_of_the_system(void **state) {
    (void)state;
    const double T[9] = {0, 1, 0, 0, 0, 1, 1, 0, -1};
    const ns_fault from = {.npairs = 6, .pair = {0, 1, 2, 3, 4, 5}};
    ns_fault to = {0};
    ns_theta_name_fault(&(ns_fault_context){3, 2, 1, T, 0.5}, NULL, NULL, &from, NULL, &to);
    assert_int_equal(to.nunknowns, 3);
    assert_true(to.unknown[0] == 2 && to.unknown[1] == 0 && to.unknown[2] == 1);
    assert_int_equal(to.npairs, 2);
    assert_true(to.pair[0] == 0 && to.pair[1] == 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_of_sources_and_switches), cmocka_unit_test(a_source_shorted),
        cmocka_unit_test(a_node_that_is_only_read),       cmocka_unit_test(an_island_of_two_nodes),
        cmocka_unit_test(newton_names_rows_too),          cmocka_unit_test(rows_are_those_of_the_system),
    };
    return cmocka_run_group_tests_name("blame", tests, NULL, NULL);
}
