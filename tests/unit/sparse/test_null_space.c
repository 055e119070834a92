/* tests/unit/sparse/test_null_space.c - what (P2) leaves open in a mode is found, and is as the leaks make
 * it, not as rounding does. */
#include "parts.h"

#include <stdio.h>
#include <string.h>

#include "retries.h"
#include "sparse/null_space.h"
#include "sparse/regularise.h"
#include "wrap_alloc.h"

/* --- the null spaces themselves --- */

typedef struct bridge {
    rig k;
    ns_form *f;
    ns_mode mode[8];
    double scale[64], unit[64], leak[8], value[256];
    ns_klu *klu;
    ns_factors *factors;
    ns_sparse_leaks with;
    ns_null_search *search;
    ns_null_space *z;
} bridge;

enum { L1 = 1, B, A, R, S };

/* A source, a resistor and an inductor in a loop that floats between the four diodes of a bridge; `second`:
 * and a node between two more diodes. */
static void make_bridge(bridge *b, int second) {
    const double g = 1e-8;
    b->k = begin();
    assert_int_equal(
        ns_circuit_source(b->k.c, "v", NS_VOLTAGE, L1, B, &(ns_signal){.kind = NS_DC, .u.dc = 21}, NULL),
        NS_OK);
    resistor(&b->k, "r", L1, S, 0.4);
    (void)inductor(&b->k, "l", S, A, 4.5e-5);
    diode(&b->k, "d1", A, R);
    diode(&b->k, "d2", B, R);
    diode(&b->k, "d3", 0, A);
    diode(&b->k, "d4", 0, B);
    capacitor(&b->k, "c", R, 0, 1.4e-6, 0);
    if (second) {
        diode(&b->k, "d5", S + 1, R);
        diode(&b->k, "d6", 0, S + 1);
    }
    assert_int_equal(ns_circuit_system(b->k.c, &b->k.s), NS_OK);
    assert_int_equal(ns_sparse_form_create(b->k.s, 0, &b->f), NS_OK);
    assert_true(b->f->size < 64 && b->f->m <= 8 && b->f->K.start[b->f->size] < 256);
    for (int j = 0; j < b->f->m; j++)
        b->mode[j] = NS_LOWER;
    ns_sparse_form_values(b->f, g, b->mode, NULL, b->value);
    assert_int_equal(ns_sparse_leaks_find(b->f, b->mode, b->value, b->leak, b->scale, b->unit), NS_OK);
    assert_int_equal(ns_linalg_klu_create(b->f->size, b->f->K.start, b->f->K.row, &b->klu), NS_OK);
    ns_sparse_form_values(b->f, g, b->mode, b->leak, b->value);
    assert_int_equal(ns_linalg_klu_factor(b->klu, b->value, &b->factors), NS_OK);
    b->with = (ns_sparse_leaks){b->f, g, b->mode, b->scale, b->unit, b->leak, b->klu, b->factors};
    assert_int_equal(ns_sparse_null_search_create(b->f, &b->search), NS_OK);
    assert_int_equal(ns_sparse_null_find(b->search, &b->with, &b->z), NS_OK);
}

static void drop_bridge(bridge *b) {
    ns_sparse_null_free(b->z);
    ns_sparse_null_search_free(b->search);
    ns_linalg_factors_free(b->klu, b->factors);
    ns_linalg_klu_free(b->klu);
    ns_sparse_form_free(b->f);
    end(&b->k);
}

static double of_node(const bridge *b, const double *v, int node) {
    return v[ns_circuit_node_unknown(b->k.c, node)];
}

/* Each allocation fails once: none is missing in the end, and what there was is freed. */
static void memory_for_it_may_be_short(void **state) {
    bridge b = {0};
    (void)state;
    make_bridge(&b, 0);
    for (long at = 1;; at++) {
        ns_null_search *s;
        fail_alloc_at(at);
        const int status = ns_sparse_null_search_create(b.f, &s);
        const long made = allocs_made();
        fail_alloc_off();
        ns_sparse_null_search_free(s);
        if (made < at) {
            assert_int_equal(status, NS_OK);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(s);
    }
    drop_bridge(&b);
}

/* All diodes block: the loop may be at any voltage, and nothing else is open. */
static void the_voltage_of_a_loop_is_open(void **state) {
    bridge b = {0};
    double v[64];
    (void)state;
    make_bridge(&b, 0);
    assert_int_equal(b.z->count, 1);
    for (int i = 0; i < b.f->size; i++)
        v[i] = b.z->right[i] / b.unit[i];
    const double all = of_node(&b, v, L1);
    assert_true(fabs(all) > 0);
    for (int node = L1; node <= S; node++)
        near(of_node(&b, v, node), node == R ? 0 : all, fabs(all));
    drop_bridge(&b);
}

/* Vectors of a null space are of length 1 and at right angles. */
static void are_orthonormal(const bridge *b, const double *v) {
    const int size = b->f->size;
    for (int i = 0; i < b->z->count; i++)
        for (int j = 0; j < b->z->count; j++) {
            double sum = 0;
            for (int k = 0; k < size; k++)
                sum += v[i * size + k] * v[j * size + k];
            near(sum, i == j, 1);
        }
}

static void each_floating_part_is_open_by_itself(void **state) {
    bridge b = {0};
    (void)state;
    make_bridge(&b, 1);
    assert_int_equal(b.z->count, 2);
    are_orthonormal(&b, b.z->right);
    are_orthonormal(&b, b.z->left);
    drop_bridge(&b);
}

/* A current into the loop of 1 A has no solution: what is left when it is made solvable has one, and is what
 * was solvable before. */
static void what_has_no_solution_is_taken_out(void **state) {
    bridge b = {0};
    double r[64] = {0}, again[64];
    (void)state;
    make_bridge(&b, 0);
    for (int i = 0; i < b.f->size; i++)
        r[i] = b.z->left[i] / b.scale[i];
    ns_sparse_null_make_solvable(&b.with, b.z, r);
    for (int i = 0; i < b.f->size; i++)
        near(r[i] * b.scale[i], 0, 1);
    for (int i = 0; i < b.f->size; i++)
        r[i] = cos(i) / b.scale[i];
    ns_sparse_null_make_solvable(&b.with, b.z, r);
    memcpy(again, r, sizeof r);
    ns_sparse_null_make_solvable(&b.with, b.z, again);
    for (int i = 0; i < b.f->size; i++)
        near(again[i] * b.scale[i], r[i] * b.scale[i], 1);
    drop_bridge(&b);
}

/* Settled, the loop is where the leaks of the two diodes to R, at 2 V, carry what those of the two to ground
 * do. */
static void leaks_settle_it(void **state) {
    bridge b = {0};
    double v[64] = {0};
    (void)state;
    make_bridge(&b, 0);
    const double far = 1e3;
    assert_true(b.leak[0] > 0 && b.leak[2] > 0);
    for (int node = L1; node <= S; node++)
        if (node != R)
            v[ns_circuit_node_unknown(b.k.c, node)] = far;
    v[ns_circuit_node_unknown(b.k.c, R)] = 2;
    ns_sparse_null_settle(&b.with, b.z, v);
    const double expected = 2 * (b.leak[0] + b.leak[1]) / (b.leak[0] + b.leak[1] + b.leak[2] + b.leak[3]);
    near(of_node(&b, v, A), expected, far);
    near(of_node(&b, v, B), expected, far);
    drop_bridge(&b);
}

/* --- circuits --- */

/* A string of capacitors between diodes that all block, of a converter with many cells at rest: it starts,
 * the capacitors keep their voltage, and nothing flows. */
static void a_string_of_cells_starts(void **state) {
    enum { U5 = 1, X, W, U6, C5, E1, E2, U7, U8, C6, U9, U10, U11, V, O };
    const ns_diode d = {.vf = 1.279, .ron = 0.02196, .roff = INFINITY, .vz = INFINITY};
    rig k = begin();
    (void)state;
    allow_retries(1);
    constant(&k, "v", U11, -82.8);
    assert_int_equal(ns_circuit_diode(k.c, "d1", U6, C5, &d, NULL), NS_OK);
    resistor(&k, "r1", C5, E1, 0.03082);
    const int esl = inductor(&k, "l1", E1, E2, 7.898e-09);
    capacitor(&k, "c1", E2, U7, 0.0002821, 33.12);
    assert_int_equal(ns_circuit_diode(k.c, "d2", U8, U7, &d, NULL), NS_OK);
    capacitor(&k, "c2", C6, U8, 0.0002876, 33.12);
    assert_int_equal(ns_circuit_diode(k.c, "d3", U9, U8, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d4", U10, U9, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d5", U11, U10, &d, NULL), NS_OK);
    (void)inductor(&k, "l2", U5, X, 0.000483);
    resistor(&k, "r2", X, W, 0.01993);
    (void)inductor(&k, "l3", W, U6, 0.001356);
    resistor(&k, "r3", X, V, 0.3795);
    (void)inductor(&k, "l4", V, O, 0.005392);
    resistor(&k, "r4", O, 0, 17.31);
    ready(&k, 2.46191e-08);
    go(&k, 1e-5);
    near(voltage(&k, E2) - voltage(&k, U7), 33.12, 33.12);
    near(voltage(&k, C6) - voltage(&k, U8), 33.12, 33.12);
    near(k.x[ns_circuit_current_unknown(k.c, esl)], 0, 1);
    end(&k);
}

/* Half of an eighteen-pulse rectifier at rest: a load of 0.36 H, 54 ohm and 1.6 H, which a step of 1e-15 s
 * does not hold with its digits, beside snubbers of 1e-10 F.  It starts, and at first no current flows. */
static void a_stiff_string_of_inductors_starts(void **state) {
    enum { LA = 1, LA2, B0, LB, B1, LC, B2, P0, N, S1, S2, MA, C0, MB, C1, MC, C2, P2, S3, S4, P, Y, Q };
    static const struct {
        char kind;
        int p, n;
        double value;
    } parts[] = {
        {'v', LA, 0, -20},        {'r', LA, LA2, 0.1791},   {'l', LA2, B0, 0.0002022},
        {'v', LB, 0, -140},       {'l', LB, B1, 0.0002022}, {'v', LC, 0, -260},
        {'l', LC, B2, 0.0002022}, {'d', N, B0, 0},          {'r', B1, S1, 1.949e+05},
        {'c', S1, P0, 5.38e-10},  {'r', N, S2, 3.487e+04},  {'c', S2, B1, 6.991e-09},
        {'d', B2, P0, 0},         {'v', MA, 0, 20},         {'l', MA, C0, 0.0002022},
        {'v', MB, 0, -100},       {'l', MB, C1, 0.0002022}, {'v', MC, 0, -220},
        {'l', MC, C2, 0.0002022}, {'d', C0, P2, 0},         {'d', N, C1, 0},
        {'r', C2, S3, 1.192e+04}, {'c', S3, P2, 3.957e-09}, {'r', N, S4, 2.335e+05},
        {'c', S4, C2, 3.715e-10}, {'l', P2, P, 0.0006066},  {'l', P, Y, 0.3564},
        {'r', Y, Q, 53.69},       {'l', Q, N, 1.58},        {'r', N, 0, 8.709e+07},
    };
    const ns_diode d = {.ron = 0.01674, .roff = INFINITY, .vz = INFINITY};
    rig k = begin();
    int last = 0;
    (void)state;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        char name[8];
        (void)snprintf(name, sizeof name, "%c%zu", parts[i].kind, i);
        const int p = parts[i].p, n = parts[i].n;
        if (parts[i].kind == 'v')
            source(&k, name, p,
                   &(ns_signal){.kind = NS_SIN, .u.sin = {.va = 19.88, .freq = 50, .phase = parts[i].value}});
        else if (parts[i].kind == 'r')
            resistor(&k, name, p, n, parts[i].value);
        else if (parts[i].kind == 'c')
            capacitor(&k, name, p, n, parts[i].value, 0);
        else if (parts[i].kind == 'l')
            last = inductor(&k, name, p, n, parts[i].value);
        else
            assert_int_equal(ns_circuit_diode(k.c, name, p, n, &d, NULL), NS_OK);
    }
    make_by(&k, &(ns_march_options){.h = 6.738e-07, .method = NS_SPARSE});
    start_at_rest(&k);
    go(&k, 1e-9);
    near(k.x[ns_circuit_current_unknown(k.c, last)], 0, 2 * 19.88 * 1e-9 / 1.58 / close_enough);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_for_it_may_be_short),
        cmocka_unit_test(the_voltage_of_a_loop_is_open),
        cmocka_unit_test(each_floating_part_is_open_by_itself),
        cmocka_unit_test(what_has_no_solution_is_taken_out),
        cmocka_unit_test(leaks_settle_it),
        cmocka_unit_test(a_stiff_string_of_inductors_starts),
        cmocka_unit_test(a_string_of_cells_starts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
