/* tests/unit/circuit/test_explain.c - devices read out of a solution, and faults told in names. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/circuit.h"

/* Node 2 named out.  d1 (2 -> 3: pairs 0 and 1), s1 (3 -> 0: pair 2), l1, v1: x = (v1 v2 v3 il iv). */
static ns_circuit *make(void) {
    ns_circuit *c = NULL;
    ns_diode d = {0.6, 1, 5, 3, 2};
    ns_switch sw = {0.5, 0, 0, 100};
    ns_signal s = {.kind = NS_DC, .u.dc = 1};
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 2, 3, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 3, 0, 1, 0, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 2, 1, 1e-3, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_name_node(c, 2, "first"), NS_OK);
    assert_int_equal(ns_circuit_name_node(c, 2, "out"), NS_OK);
    assert_int_equal(ns_circuit_name_node(c, 0, "gnd"), NS_OK);
    return c;
}

static void assert_device(const ns_circuit *c, int id, const double *x, const double *lambda,
                          const ns_mode *mode, double i, double v, int on) {
    double got_i = NAN, got_v = NAN;
    int got_on = 99;
    assert_int_equal(ns_circuit_device(c, id, x, lambda, mode, &got_i, &got_v, &got_on), NS_OK);
    assert_true(fabs(got_i - i) < 1e-14 && fabs(got_v - v) < 1e-14); /* a few roundings of numbers near 1 */
    assert_int_equal(got_on, on);
    assert_int_equal(ns_circuit_device(c, id, x, lambda, mode, NULL, NULL, NULL), NS_OK);
}

/* Conducting 2 A: v = 0.6 + 2, lambda = 2 - 2.6/5.  Blocking -1 V: i = -1/5.  Breakdown at -0.9 A... all on
 * the lines v = vf + ron i, v = roff i, v = -vz + rz i; at i = -3: v = -9, lambda_z = -9/5 + 3. */
static void diode_on_each_branch(void **state) {
    ns_circuit *c = make();
    const double forward[] = {0, 3.6, 1, 0, 0}, reverse[] = {0, 0, 1, 0, 0}, broken[] = {0, -8, 1, 0, 0};
    const double l_forward[] = {2 - 2.6 / 5, 0, 0}, l_reverse[] = {0, 0, 0}, l_broken[] = {0, 3 - 9. / 5, 0};
    const ns_mode m_forward[] = {NS_INSIDE, NS_LOWER, NS_LOWER}, m_reverse[] = {NS_LOWER, NS_LOWER, NS_LOWER};
    const ns_mode m_broken[] = {NS_LOWER, NS_INSIDE, NS_LOWER};
    (void)state;
    assert_device(c, 0, forward, l_forward, m_forward, 2, 2.6, 1);
    assert_device(c, 0, reverse, l_reverse, m_reverse, -0.2, -1, 0);
    assert_device(c, 0, broken, l_broken, m_broken, -3, -9, -1);
    ns_circuit_free(c);
}

/* Closed without resistance: v = 0, i = lambda of either sign.  Open: i = v/roff. */
static void switch_in_both_states(void **state) {
    ns_circuit *c = make();
    const double closed[] = {0, 0, 0, 0, 0}, open[] = {0, 0, 50, 0, 0};
    const double l_closed[] = {0, 0, -7}, l_open[] = {0, 0, 0};
    const ns_mode m_closed[] = {NS_LOWER, NS_LOWER, NS_INSIDE}, m_open[] = {NS_LOWER, NS_LOWER, NS_UPPER};
    (void)state;
    assert_device(c, 1, closed, l_closed, m_closed, -7, 0, 1);
    assert_device(c, 1, open, l_open, m_open, 0.5, 50, 0);
    ns_circuit_free(c);
}

static void only_devices_are_read(void **state) {
    ns_circuit *c = make();
    const double x[5] = {0}, lambda[3] = {0};
    const ns_mode mode[3] = {0};
    (void)state;
    assert_int_equal(ns_circuit_device(NULL, 0, x, lambda, mode, NULL, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_device(c, 2, x, lambda, mode, NULL, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_device(c, 4, x, lambda, mode, NULL, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_device(c, -1, x, lambda, mode, NULL, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_device(c, 0, NULL, lambda, mode, NULL, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_device(c, 0, x, NULL, mode, NULL, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_device(c, 0, x, lambda, NULL, NULL, NULL, NULL), NS_E_NULL);
    ns_circuit_free(c);
}

static void assert_line(const ns_circuit *c, const ns_fault *f, const char *want) {
    char line[400];
    int length = ns_circuit_explain(c, f, line, sizeof line);
    assert_string_equal(line, want);
    assert_int_equal(length, strlen(want));
}

static void faults_have_names(void **state) {
    ns_circuit *c = make();
    ns_fault f = {.status = NS_E_INFEASIBLE, .t = 0.00125, .npairs = 3, .pair = {1, 0, 2}};
    (void)state;
    assert_line(
        c, &f,
        "d1, s1: at t = 0.00125 s: no solution exists (ideal diode d1, ideal switch s1: conflict with "
        "sources or an .ic; look for a loop without resistance or a current without a closed path)");
    f = (ns_fault){.status = NS_E_SINGULAR, .t = NAN, .nunknowns = 4, .unknown = {1, 2, 3, 4}};
    assert_line(c, &f,
                "node out, node 3, l1, v1: the equations do not determine the answer (voltage of node out, "
                "voltage of node 3, current of l1, current of v1: not determined; look for a node without a "
                "path to ground or a loop without resistance)");
    f = (ns_fault){.status = NS_E_LIMIT, .t = 2, .npairs = 1, .pair = {2}, .nunknowns = 1, .unknown = {0}};
    assert_line(c, &f, "s1, node 1: at t = 2 s: gave up: the iteration bound was met");
    f = (ns_fault){.status = NS_E_MEMORY, .t = NAN};
    assert_line(c, &f, "out of memory");
    ns_circuit_free(c);
}

/* Faults that no system of this circuit could have had still give a line, and read nothing beyond. */
static void strange_faults(void **state) {
    ns_circuit *c = make();
    char line[8] = "abc";
    ns_fault f = {.status = NS_E_LIMIT, .t = NAN, .npairs = 2, .pair = {3, -1}, .nunknowns = 2};
    f.unknown[0] = 5;
    f.unknown[1] = -2;
    (void)state;
    assert_line(c, &f, "pair 3, pair -1, unknown 5, unknown -2: gave up: the iteration bound was met");
    assert_line(NULL, &f, "pair 3, pair -1, unknown 5, unknown -2: gave up: the iteration bound was met");
    f = (ns_fault){.status = NS_E_LIMIT, .t = NAN, .npairs = 1000, .nunknowns = -3};
    assert_line(c, &f, "d1: gave up: the iteration bound was met");
    assert_int_equal(ns_circuit_explain(c, NULL, line, sizeof line), 0);
    assert_string_equal(line, "");
    ns_circuit_free(c);
}

static void long_lines_are_cut(void **state) {
    ns_circuit *c = make();
    ns_fault f = {.status = NS_E_LIMIT, .t = NAN, .npairs = 1, .pair = {2}};
    const char *whole = "s1: gave up: the iteration bound was met";
    char line[64];
    (void)state;
    for (size_t size = 0; size <= strlen(whole) + 2; size++) {
        memset(line, '#', sizeof line);
        assert_int_equal(ns_circuit_explain(c, &f, line, size), strlen(whole));
        assert_int_equal(line[size], '#');
        if (size == 0) {
            continue;
        }
        assert_int_equal(strlen(line), size > strlen(whole) ? strlen(whole) : size - 1);
        if (size > strlen(whole)) {
            assert_string_equal(line, whole);
        } else if (size >= 4) {
            assert_string_equal(line + size - 4, "...");
        }
    }
    assert_int_equal(ns_circuit_explain(c, &f, NULL, 10), strlen(whole));
    ns_circuit_free(c);
}

static void names_cannot_break_the_line(void **state) {
    ns_circuit *c = make();
    ns_fault f = {.status = NS_E_LIMIT, .t = NAN, .nunknowns = 1, .unknown = {0}};
    (void)state;
    assert_int_equal(ns_circuit_name_node(c, 1, "a\nb\t%s"), NS_OK);
    assert_line(c, &f, "node a?b?%s: gave up: the iteration bound was met");
    ns_circuit_free(c);
}

/* A source of current at a node that has no voltage: the switch there opened.  A switch with hysteresis. */
static void causes_have_names(void **state) {
    const ns_switch plain = {0.5, 0, 0, INFINITY}, band = {0.5, 0.1, 0, INFINITY};
    const ns_signal one = {.kind = NS_DC, .u.dc = 1};
    ns_circuit *c;
    ns_fault f = {.status = NS_E_INFEASIBLE, .t = NAN, .nunknowns = 1, .unknown = {1}};
    (void)state;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "i1", NS_CURRENT, 0, 2, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 2, 0, 1, 0, &plain, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s2", 1, 0, 1, 0, &band, NULL), NS_OK);
    assert_line(c, &f,
                "i1, s1, node 2: no solution exists (current of i1, ideal switch s1, voltage of node 2: "
                "conflict with sources or an .ic; look for a loop without resistance or a current without a "
                "closed path)");
    f.status = NS_E_SINGULAR; /* a current without a path is one that has no solution */
    assert_line(c, &f,
                "node 2: the equations do not determine the answer (voltage of node 2: not determined; look "
                "for a node without a path to ground or a loop without resistance)");
    f.status = NS_E_INFEASIBLE;
    f.unknown[0] = 0;
    assert_line(c, &f,
                "node 1: no solution exists (voltage of node 1: conflict with sources or an .ic; look for a "
                "loop without resistance or a current without a closed path)");
    f = (ns_fault){.status = NS_E_LIMIT, .t = NAN, .npairs = 1, .pair = {1}};
    assert_line(c, &f,
                "s2: gave up: the iteration bound was met (ideal switch s2: if it moves its own control past "
                "both thresholds at once, it can be neither open nor closed; give it a larger vh, or delay "
                "its control by R and C)");
    ns_circuit_free(c);
}

/* The current of the element that came first. */
static void the_first_element_has_a_name(void **state) {
    ns_circuit *c = NULL;
    ns_signal s = {.kind = NS_DC, .u.dc = 1};
    ns_fault f = {.status = NS_E_MEMORY, .t = NAN, .nunknowns = 2, .unknown = {0, 1}};
    (void)state;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 7, 0, &s, NULL), NS_OK);
    assert_line(c, &f, "node 7, v1: out of memory");
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(diode_on_each_branch),
        cmocka_unit_test(switch_in_both_states),
        cmocka_unit_test(only_devices_are_read),
        cmocka_unit_test(faults_have_names),
        cmocka_unit_test(causes_have_names),
        cmocka_unit_test(the_first_element_has_a_name),
        cmocka_unit_test(strange_faults),
        cmocka_unit_test(long_lines_are_cut),
        cmocka_unit_test(names_cannot_break_the_line),
    };
    return cmocka_run_group_tests_name("circuit read", tests, NULL, NULL);
}
