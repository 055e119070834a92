/* tests/unit/march/test_cut_off.c - a question ends where branch and bound would look for a mode for long.
 *
 * Three transformers without leakage between primary and core, a wye and a delta secondary, twelve diodes of
 * 10 mohm: as the dense engine came back from a question, neither pivoting nor Lemke's method solved (P1) of
 * its start, and branch and bound looked at 1000 nodes in vain: half of the run's work, and 10 s of 11 in
 * another of the kind, where a node takes 10 ms.
 */
#include "rig.h"

#include "march/dense_internal.h"
#include "march/run_internal.h"
#include "signals.h"

#include <stdio.h>

enum { NODE_S = 8, NODE_STAR = 30, NODE_PLUS, NODE_MIDDLE, NODE_MINUS, INNER = 40 };

/* One that no element has yet. */
static const char *name(void) {
    static char text[16];
    static int count;
    snprintf(text, sizeof text, "e%d", count++);
    return text;
}

static int winding(rig *k, int p, int n, double henries) {
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, name(), p, n, henries, 0, &id), NS_OK);
    return id;
}

/* With copper and leakage between it and node n. */
static int secondary(rig *k, int number, int p, int n, double henries, double ohms, double leakage) {
    const int inner = INNER + 2 * number, id = winding(k, p, inner, henries);
    assert_int_equal(ns_circuit_resistor(k->c, name(), inner, inner + 1, ohms, NULL), NS_OK);
    winding(k, inner + 1, n, leakage);
    return id;
}

static void couple(rig *k, int a, int b) {
    assert_int_equal(ns_circuit_coupling(k->c, name(), a, b, 1, NULL), NS_OK);
}

static void bridge(rig *k, int first, int plus, int minus) {
    const ns_diode d = {0, 10e-3, INFINITY, INFINITY, 0};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(ns_circuit_diode(k->c, name(), first + i, plus, &d, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(k->c, name(), minus, first + i, &d, NULL), NS_OK);
    }
}

static rig rectifier(ns_method method) {
    static const double copper[] = {0.4766, 0.3446, 0.4874},
                        ohms[] = {0.01908, 0.06349, 0.01815, 0.06205, 0.05712, 0.0704},
                        leakage[] = {0.567e-3, 0.284e-3, 0.7761e-3, 0.1855e-3, 0.6931e-3, 0.8237e-3};
    rig k = begin();
    for (int i = 0; i < 3; i++) {
        const ns_signal v = {.kind = NS_SIN, .u.sin = {.va = 248.41, .freq = 60, .phase = -120 * i}};
        const int wye = NODE_S + i, delta = NODE_S + 3 + i, next = NODE_S + 3 + (i + 1) % 3;
        assert_int_equal(ns_circuit_source(k.c, name(), NS_VOLTAGE, 1 + i, 0, &v, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(k.c, name(), 1 + i, 4 + i, copper[i], NULL), NS_OK);
        const int primary = winding(&k, 4 + i, 0, 3.6546);
        const int a = secondary(&k, i, wye, NODE_STAR, 10.02, ohms[i], leakage[i]);
        const int b = secondary(&k, 3 + i, delta, next, 30.061, ohms[3 + i], leakage[3 + i]);
        couple(&k, a, primary);
        couple(&k, b, primary);
        couple(&k, b, a);
    }
    bridge(&k, NODE_S, NODE_PLUS, NODE_MIDDLE);
    bridge(&k, NODE_S + 3, NODE_MIDDLE, NODE_MINUS);
    assert_int_equal(ns_circuit_capacitor(k.c, name(), NODE_PLUS, NODE_MINUS, 4.628e-3, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, name(), NODE_PLUS, NODE_MINUS, 57.09, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, name(), NODE_MINUS, 0, 1e6, NULL), NS_OK);
    make_by(&k, &(ns_march_options){.theta = 1, .gamma = 1, .h = 0.05 / 65536, .method = method, .whole = 1});
    start_at_rest(&k);
    return k;
}

/* Of the dense engine, if there is one. */
static double searched(const rig *k) {
    const ns_run *r = (const ns_run *)(const void *)k->m->engine;
    const ns_engine *e = r->kind == NS_RUN_DENSE                     ? r->at_work
                         : r->aside && r->aside_kind == NS_RUN_DENSE ? r->aside
                                                                     : NULL;
    return e ? ns_theta_searched(((const ns_dense_run *)(const void *)e)->step) : 0;
}

/* From step to step; the volts across the capacitor at the end, *most: what branch and bound took. */
static double run(ns_method method, double stop, double *most) {
    rig k = rectifier(method);
    double t = 0;
    *most = 0;
    for (int i = 0; i < 100000 && t < stop; i++) {
        assert_int_equal(ns_march_try(k.m, stop, NS_TO_STEP, &t), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        *most = fmax(*most, searched(&k));
    }
    assert_int_equal(ns_march_read(k.m, NULL, k.x, NULL, NULL), NS_OK);
    const double v =
        k.x[ns_circuit_node_unknown(k.c, NODE_PLUS)] - k.x[ns_circuit_node_unknown(k.c, NODE_MINUS)];
    end(&k);
    return v;
}

static void a_question_ends_a_search(void **state) {
    double most, none;
    (void)state;
    const double v = run(NS_AUTO, 0.05, &most), by_sparse = run(NS_SPARSE, 0.05, &none);
    printf("%.4g V, %.4g V by sparse; %.3g million instructions of searches\n", v, by_sparse, most / 1e6);
    assert_true(fabs(v - by_sparse) < 1e-4 * by_sparse);
    assert_true(most < 1.5e8);
}

/* So does the first start, which looked at 1000 nodes in vain as well, where rounding made pivoting fail:
 * then sparse starts. */
static void a_start_ends_a_search(void **state) {
    rig k = rectifier(NS_AUTO);
    ns_run *r = (ns_run *)(void *)k.m->engine;
    (void)state;
    assert_true(ns_march_run_work(r).all < 4 * ns_march_first_question(r->s, 1));
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_question_ends_a_search),
                                       cmocka_unit_test(a_start_ends_a_search)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
