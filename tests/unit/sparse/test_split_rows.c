/* tests/unit/sparse/test_split_rows.c - more nodes joined by capacitors than one part may have for its rows
 * to be split as a dense matrix: a chain that floats, and one with a capacitor to ground; against the exact
 * engine. */
#include <stdio.h>

#include "parts.h"
#include "sparse/assemble.h"

enum { FIRST = 2, NODES = 60, POINTS = 20 };

static void build(rig *k, int grounded) {
    char name[16];
    *k = begin();
    source(k, "vin", 1, &(ns_signal){.kind = NS_SIN, .u.sin = {.va = 10, .freq = 1e3}});
    resistor(k, "rin", 1, FIRST, 100);
    for (int i = 0; i < NODES; i++) {
        (void)snprintf(name, sizeof name, "r%d", i);
        resistor(k, name, FIRST + i, 0, 1e3 * (1 + i % 7));
        (void)snprintf(name, sizeof name, "c%d", i);
        if (i > 0)
            capacitor(k, name, FIRST + i - 1, FIRST + i, 1e-6 * (1 + i % 3), 0);
    }
    if (grounded)
        capacitor(k, "cg", FIRST + NODES / 2, 0, 1e-7, 0);
    diode(k, "d", FIRST + 3, 0);
}

static void same_by_both(int grounded) {
    rig exact, sparse;
    double most = 0;
    build(&exact, grounded);
    build(&sparse, grounded);
    make_by(&exact, &(ns_march_options){.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_EXACT});
    start_at_rest(&exact);
    ready(&sparse, 1e-5);
    for (int p = 1; p <= POINTS; p++) {
        go(&exact, p * 1e-4);
        go(&sparse, p * 1e-4);
        for (int i = 0; i < NODES; i++) {
            near(voltage(&sparse, FIRST + i), voltage(&exact, FIRST + i), 10);
            most = fmax(most, fabs(voltage(&sparse, FIRST + i)));
        }
    }
    assert_true(most > 1 && ns_march_counts(sparse.m)->events > 2);
    end(&exact);
    end(&sparse);
}

static void a_long_chain_that_floats(void **state) {
    (void)state;
    same_by_both(0);
}

static void a_long_chain_with_ground(void **state) {
    (void)state;
    same_by_both(1);
}

/* T M of a chain of capacitors (1 uF each), of which the first row is their sum: zero without a capacitor to
 * ground, that capacitor, however small beside the others, with one. */
static void rows_of_a_chain(int nodes, double ground) {
    ns_entries e = {0};
    ns_csc M, Tt;
    unsigned char algebraic[NODES] = {0};
    double sum[NODES] = {0};
    for (int i = 0; i + 1 < nodes; i++)
        for (int k = 0; k < 4; k++)
            ns_linalg_entries_add(&e, i + k % 2, i + k / 2, k == 0 || k == 3 ? 1e-6 : -1e-6);
    ns_linalg_entries_add(&e, nodes / 2, nodes / 2, ground);
    assert_int_equal(ns_linalg_csc_of_entries(nodes, nodes, &e, &M), NS_OK);
    assert_int_equal(ns_sparse_split(&M, &Tt, algebraic), NS_OK);
    int count = 0;
    for (int i = 0; i < nodes; i++) { /* row i of T M */
        double most = 0;
        for (int j = 0; j < nodes; j++) {
            double v = 0;
            for (int k = Tt.start[i]; k < Tt.start[i + 1]; k++)
                for (int l = M.start[j]; l < M.start[j + 1]; l++)
                    v += Tt.row[k] == M.row[l] ? Tt.value[k] * M.value[l] : 0;
            most = fmax(most, fabs(v));
        }
        count += algebraic[i];
        assert_true(algebraic[i] ? most < 1e-20 : most > 1e-13);
        for (int k = Tt.start[i]; k < Tt.start[i + 1]; k++)
            sum[Tt.row[k]] += algebraic[i] ? Tt.value[k] : 0;
    }
    assert_int_equal(count, ground == 0);
    for (int i = 0; i < nodes; i++) /* the sum of all rows, or nothing */
        assert_true(fabs(sum[i] - (ground == 0) * sum[0]) < 1e-15 && (ground != 0 || sum[0] != 0));
    ns_linalg_entries_free(&e);
    ns_linalg_csc_free(&M);
    ns_linalg_csc_free(&Tt);
}

static void one_row_of_a_chain_is_algebraic(void **state) {
    (void)state;
    for (int nodes = 2; nodes <= NODES; nodes += 29) { /* 2, 31: as dense ones; 60: as a network */
        rows_of_a_chain(nodes, 0);
        rows_of_a_chain(nodes, 1e-6);
        rows_of_a_chain(nodes, 1e-12);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_row_of_a_chain_is_algebraic),
                                       cmocka_unit_test(a_long_chain_that_floats),
                                       cmocka_unit_test(a_long_chain_with_ground)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
