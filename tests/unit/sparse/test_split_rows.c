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
    const double flow[NODES] = {0};
    double sum[NODES] = {0};
    for (int i = 0; i + 1 < nodes; i++)
        for (int k = 0; k < 4; k++)
            ns_linalg_entries_add(&e, i + k % 2, i + k / 2, k == 0 || k == 3 ? 1e-6 : -1e-6);
    ns_linalg_entries_add(&e, nodes / 2, nodes / 2, ground);
    assert_int_equal(ns_linalg_csc_of_entries(nodes, nodes, &e, &M), NS_OK);
    assert_int_equal(ns_sparse_split(&M, flow, &Tt, algebraic), NS_OK);
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

/* Of a chain the row in which much flows is the one that becomes the sum. */
static void much_flows_in_the_sum(int nodes, int busy) {
    ns_entries e = {0};
    ns_csc M, Tt;
    unsigned char algebraic[NODES] = {0};
    double flow[NODES];
    for (int i = 0; i < nodes; i++)
        flow[i] = i == busy ? 1 : 1e-5;
    for (int i = 0; i + 1 < nodes; i++)
        for (int k = 0; k < 4; k++)
            ns_linalg_entries_add(&e, i + k % 2, i + k / 2, k == 0 || k == 3 ? 1e-6 : -1e-6);
    assert_int_equal(ns_linalg_csc_of_entries(nodes, nodes, &e, &M), NS_OK);
    assert_int_equal(ns_sparse_split(&M, flow, &Tt, algebraic), NS_OK);
    for (int i = 0; i < nodes; i++) {
        assert_int_equal(Tt.start[i + 1] - Tt.start[i], algebraic[i] ? nodes : 1);
        assert_true(algebraic[i] || Tt.row[Tt.start[i]] != busy);
    }
    ns_linalg_entries_free(&e);
    ns_linalg_csc_free(&M);
    ns_linalg_csc_free(&Tt);
}

static void the_busiest_row_of_a_chain_is_the_sum(void **state) {
    (void)state;
    much_flows_in_the_sum(2, 0);
    much_flows_in_the_sum(2, 1);
    much_flows_in_the_sum(3, 1);
    much_flows_in_the_sum(NODES, 0);
    much_flows_in_the_sum(NODES, NODES / 2);
    much_flows_in_the_sum(NODES, NODES - 1);
}

/* Two coils of 1 H, fully coupled: the difference of their fluxes is zero. */
static void coupled_coils_of_one_henry(void **state) {
    ns_entries e = {0};
    ns_csc M, Tt;
    unsigned char algebraic[2] = {0};
    const double flow[2] = {0};
    (void)state;
    for (int k = 0; k < 4; k++)
        ns_linalg_entries_add(&e, k % 2, k / 2, 1);
    assert_int_equal(ns_linalg_csc_of_entries(2, 2, &e, &M), NS_OK);
    assert_int_equal(ns_sparse_split(&M, flow, &Tt, algebraic), NS_OK);
    assert_int_equal(algebraic[0] + algebraic[1], 1);
    ns_linalg_entries_free(&e);
    ns_linalg_csc_free(&M);
    ns_linalg_csc_free(&Tt);
}

/* Three coils into a star of resistors: in the sum of the rows of its nodes nothing is left but the coils'
 * currents; with 1 Gohm from the star point to ground no row is a sum. */
static void a_star_is_summed(void **state) {
    enum { STAR = 5 };
    (void)state;
    for (int grounded = 0; grounded < 2; grounded++) {
        rig k = begin();
        ns_form *f;
        const int coil[] = {inductor(&k, "l1", 1, 2, 17e-3), inductor(&k, "l2", 0, 3, 54e-3),
                            inductor(&k, "l3", 0, 4, 147e-3)};
        source(&k, "v1", 1, &(ns_signal){.kind = NS_DC, .u.dc = 1});
        resistor(&k, "r1", 2, STAR, 102.4);
        resistor(&k, "r2", 3, STAR, 11.43);
        resistor(&k, "r3", 4, STAR, 0.3);
        if (grounded)
            resistor(&k, "rg", STAR, 0, 1e9);
        diode(&k, "d", 0, 1);
        assert_int_equal(ns_circuit_system(k.c, &k.s), NS_OK);
        assert_int_equal(ns_sparse_form_create(k.s, 0, &f), NS_OK);
        int sums = 0;
        for (int i = 0; i < f->n; i++) {
            int currents = 0;
            for (int e = f->At.start[i]; e < f->At.start[i + 1]; e++)
                for (int c = 0; c < 3; c++)
                    currents += f->At.row[e] == ns_circuit_current_unknown(k.c, coil[c]);
            sums += f->algebraic[i] && currents == 3 && f->At.start[i + 1] - f->At.start[i] == 3;
        }
        assert_int_equal(sums, !grounded);
        ns_sparse_form_free(f);
        end(&k);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_row_of_a_chain_is_algebraic),
                                       cmocka_unit_test(the_busiest_row_of_a_chain_is_the_sum),
                                       cmocka_unit_test(coupled_coils_of_one_henry),
                                       cmocka_unit_test(a_star_is_summed),
                                       cmocka_unit_test(a_long_chain_that_floats),
                                       cmocka_unit_test(a_long_chain_with_ground)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
