/* tests/unit/sparse/test_race_at_start.c - a start at which a switch charges a node until a diode conducts,
 * in far less than the steps that tell what jumps.
 */
#include "sparse_bench.h"

enum { N0 = 1, N1, N2, X, GATE };

static double v_of(const bench *b, int node) {
    double x[BENCH_MOST];
    assert_int_equal(ns_sparse_read(&b->m->engine, NULL, x, NULL, NULL), NS_OK);
    return x[ns_circuit_node_unknown(b->c, node)];
}

/* The switch of 11 uohm between N1, 3.9 pF to ground, and N0, from which 0.132 uF at 9.8 V lead to N2, 376 pF
 * to ground, is closed.  N1 rises by 0.7 V within 4e-18 s, where the diode and 8.5 uohm to N2 begin to
 * conduct what discharges the 0.132 uF to 0.5 V.  The charge of N0, N1 and N2 together stays:
 *
 *     (C0 + C1) v(N2) + 0.5 V C0 = C1 0.2229 V.
 *
 * The mode in which the diode blocks holds in the shortest steps alone; by longer ones, of which it broke the
 * law, N1 jumped to 9.9 V.  From a random race of capacitors: the start was found wrong, and the run was
 * refused. */
static void a_diode_ends_what_seems_to_jump(void **state) {
    const double C0 = 3.8985e-12, C1 = 3.76069e-10, v1 = 0.222868;
    const ns_switch closed = {.vt = 0.5, .ron = 1.1414e-5, .roff = INFINITY};
    const ns_diode d = {.vf = 0.5, .roff = INFINITY, .vz = INFINITY};
    const ns_signal on = {.kind = NS_DC, .u.dc = 1};
    const ns_sparse_options o = {.h = 4.56e-6, .finer = 6};
    const unsigned char is_closed = 1;
    bench b = open_bench();
    ns_engine *e;
    double w[BENCH_MOST], reached;
    int s;
    (void)state;
    assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, GATE, 0, &on, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "as", N1, N0, GATE, 0, &closed, &s), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", X, N2, 8.4816e-6, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "ad", N1, X, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c0", N1, 0, C0, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", N2, 0, C1, v1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", N2, N0, 1.323292e-7, -9.777132, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_sparse_create(b.s, &o, &e, NULL), NS_OK);
    b.m = ns_sparse_of(e);
    assert_int_equal(ns_circuit_rest(b.c, w), NS_OK);
    assert_int_equal(ns_sparse_start(e, 1.4e-3, w, &is_closed), NS_OK);
    assert_true(v_of(&b, N1) < v_of(&b, N2) + d.vf + 1e-3);
    assert_int_equal(ns_sparse_try(e, 1.401e-3, NS_TO_TIME, &reached), NS_OK);
    assert_true(fabs(v_of(&b, N2) - (C1 * v1 - d.vf * C0) / (C0 + C1)) < 1e-4);
    assert_true(fabs(v_of(&b, N1) - v_of(&b, N2) - d.vf) < 1e-4);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_diode_ends_what_seems_to_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
