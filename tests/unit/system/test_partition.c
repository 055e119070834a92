/* tests/unit/system/test_partition.c - systems taken apart into islands, entry by entry; and their copies
 * with arrays (dense_copy.h). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "large_copy.h"
#include "system/dense_copy.h"
#include "system/partition.h"
#include "wrap_alloc.h"

enum { SUPPLY, CURRENT, FIRST }; /* unknowns; those of the islands follow */

static double *at(double *a, int rows, int i, int j) {
    return &a[i + j * rows];
}

/* `count` times a capacitor C x' = (v - x) - x + lambda at a supply v = z(t), whose current i is
 * 0 = -i - sum (v - x) - v/2.  Switch k is closed by z of its own, above k. */
static ns_system *at_one_supply(int count) {
    ns_system *s;
    const int n = FIRST + count;
    assert_int_equal(ns_system_create(n, count, 1 + count, count, &s), NS_OK);
    *at(s->A, n, CURRENT, SUPPLY) = -1; /* the law of the supply */
    s->E[CURRENT] = 1;
    *at(s->A, n, SUPPLY, CURRENT) = -1;
    *at(s->A, n, SUPPLY, SUPPLY) = -0.5 - count;
    s->b[SUPPLY] = 7;
    for (int k = 0; k < count; k++) {
        const int x = FIRST + k;
        const ns_signal z = {.kind = NS_DC, .u.dc = k};
        *at(s->M, n, x, x) = k + 1;
        *at(s->A, n, x, x) = -2;
        *at(s->A, n, x, SUPPLY) = *at(s->A, n, SUPPLY, x) = 1;
        *at(s->B, n, x, k) = 1;
        *at(s->C, count, k, x) = 1;
        *at(s->D, count, k, k) = 3 + k;
        *at(s->F, count, k, 0) = 0.25;
        s->b[x] = 10 + k;
        s->e[k] = 20 + k;
        s->u[k] = 30 + k;
        assert_int_equal(ns_system_set_input(s, 1 + k, &z), NS_OK);
        s->command[k] = (ns_command){.pair = k, .on = k, .off = k};
        s->command[k].gz = calloc((size_t)s->nz, sizeof(double));
        assert_non_null(s->command[k].gz);
        s->command[k].gz[1 + k] = 5 + k;
    }
    return s;
}

/* Island k of at_one_supply(): v, its share of i, x_k. */
static void check_island(const ns_island *a, int k) {
    ns_system *s = a->s;
    const int home = k == 0;
    assert_int_equal(s->n, 3);
    assert_int_equal(s->m, 1);
    assert_int_equal(s->nz, 2);
    assert_int_equal(s->nc, 1);
    assert_null(s->large);
    assert_true(a->unknown[0] == SUPPLY && a->unknown[1] == CURRENT && a->unknown[2] == FIRST + k);
    assert_int_equal(a->pair[0], k);
    assert_true(*at(s->M, 3, 2, 2) == k + 1 && s->M[0] == 0);
    assert_true(*at(s->A, 3, CURRENT, SUPPLY) == -1 && *at(s->A, 3, SUPPLY, CURRENT) == -1);
    assert_true(*at(s->A, 3, SUPPLY, SUPPLY) ==
                (home ? -2.5 : 0)); /* what is the supply's own counts at home */
    assert_true(*at(s->A, 3, 2, SUPPLY) == 1 && *at(s->A, 3, SUPPLY, 2) == 1 && *at(s->A, 3, 2, 2) == -2);
    assert_true(s->B[2] == 1 && s->B[0] == 0 && s->B[1] == 0 && s->C[2] == 1 && s->D[0] == 3 + k);
    assert_true(s->E[CURRENT] == 1 && s->F[0] == 0.25 && s->F[1] == 0);
    assert_true(s->b[SUPPLY] == (home ? 7 : 0) && s->b[2] == 10 + k);
    assert_true(s->e[0] == 20 + k && s->l[0] == 0 && s->u[0] == 30 + k);
    assert_true(s->z[1].kind == NS_DC && s->z[1].u.dc == k);
    assert_true(s->command[0].pair == 0 && s->command[0].on == k && !s->command[0].gx);
    assert_true(s->command[0].gz[0] == 0 && s->command[0].gz[1] == 5 + k);
    assert_int_equal(ns_system_check(s, NULL), NS_OK);
}

static ns_islands parts_of(const ns_system *s) {
    ns_islands out;
    assert_int_equal(ns_system_check(s, NULL), NS_OK);
    assert_int_equal(ns_system_partition(s, &out), NS_OK);
    return out;
}

static void expect_islands(ns_system *s, int count) {
    ns_islands a = parts_of(s);
    assert_int_equal(a.count, count);
    ns_system_partition_free(&a);
    ns_system_free(s);
}

static void two_at_one_supply(void **state) {
    (void)state;
    for (int large = 0; large < 2; large++) {
        ns_system *s = at_one_supply(2), *same = large_copy(s);
        ns_islands a = parts_of(large ? same : s);
        assert_int_equal(a.count, 2);
        for (int k = 0; k < 2; k++)
            check_island(&a.island[k], k);
        for (int i = 0; i < s->n; i++)
            assert_int_equal(a.shared[i], i == CURRENT);
        ns_system_partition_free(&a);
        ns_system_free(same);
        ns_system_free(s);
    }
}

static void as_many_as_are_worth_it(void **state) {
    (void)state;
    expect_islands(at_one_supply(1), 0);
    expect_islands(at_one_supply(NS_MOST_ISLANDS), NS_MOST_ISLANDS);
    expect_islands(at_one_supply(NS_MOST_ISLANDS + 1), 0);
}

/* What has no pair is one island more, the last. */
static void what_has_no_pair(void **state) {
    ns_system *s = at_one_supply(3);
    const int n = s->n, last = n - 1;
    (void)state;
    *at(s->B, n, last, 2) = *at(s->C, 3, 2, last) = 0; /* its pair is left alone */
    ns_islands a = parts_of(s);
    assert_int_equal(a.count, 4);
    assert_true(a.island[2].s->n == 0 && a.island[2].s->m == 1);
    assert_true(a.island[3].s->m == 0 && a.island[3].s->nc == 0);
    assert_int_equal(a.island[3].unknown[a.island[3].s->n - 1], last);
    ns_system_partition_free(&a);
    ns_system_free(s);
}

/* Each of these ties the two together. */
static void what_ties_islands_together(void **state) {
    (void)state;
    const int x = FIRST, other = FIRST + 1, n = FIRST + 2;
    ns_system *s = at_one_supply(2);
    *at(s->A, n, x, other) = 1;
    expect_islands(s, 0);
    s = at_one_supply(2);
    *at(s->M, n, other, x) = 1;
    expect_islands(s, 0);
    s = at_one_supply(2);
    *at(s->B, n, x, 1) = 1;
    expect_islands(s, 0);
    s = at_one_supply(2);
    *at(s->C, 2, 1, x) = 1;
    expect_islands(s, 0);
    s = at_one_supply(2);
    *at(s->D, 2, 0, 1) = 1;
    expect_islands(s, 0);
    s = at_one_supply(2); /* a capacitor from the supply: its charge in the supply's balance */
    *at(s->M, n, SUPPLY, x) = -1;
    expect_islands(s, 0);
    s = at_one_supply(2); /* the supply's current is seen by a guard, */
    *at(s->C, 2, 0, CURRENT) = 1;
    expect_islands(s, 0);
    s = at_one_supply(2); /* by another unknown, */
    *at(s->A, n, x, CURRENT) = 1;
    expect_islands(s, 0);
    s = at_one_supply(2); /* by a command; */
    s->command[0].gx = calloc((size_t)n, sizeof(double));
    assert_non_null(s->command[0].gx);
    s->command[0].gx[CURRENT] = 1;
    expect_islands(s, 0);
    s = at_one_supply(2); /* a command looks at the other island */
    s->command[0].gx = calloc((size_t)n, sizeof(double));
    assert_non_null(s->command[0].gx);
    s->command[0].gx[other] = 1;
    expect_islands(s, 0);
}

/* The supply's voltage may be seen: by guards, by commands, by balances of others. */
static void what_only_sees_the_supply(void **state) {
    (void)state;
    ns_system *s = at_one_supply(2);
    *at(s->C, 2, 0, SUPPLY) = 1;
    expect_islands(s, 2);
    s = at_one_supply(2);
    s->command[1].gx = calloc((size_t)s->n, sizeof(double));
    assert_non_null(s->command[1].gx);
    s->command[1].gx[SUPPLY] = 2;
    ns_islands a = parts_of(s);
    assert_int_equal(a.count, 2);
    assert_true(a.island[1].s->command[0].gx[0] == 2 && a.island[1].s->command[0].gx[2] == 0);
    ns_system_partition_free(&a);
    ns_system_free(s);
}

/* A chain of 70 states, and a single one: the first stays large. */
static void a_large_island(void **state) {
    enum { LONG = 70 };
    ns_system *s;
    const int n = LONG + 1;
    (void)state;
    assert_int_equal(ns_system_create(n, 2, 1, 1, &s), NS_OK);
    for (int i = 0; i < n; i++) {
        *at(s->M, n, i, i) = *at(s->A, n, i, i) = 1 + i;
        if (i > 0 && i < LONG)
            *at(s->A, n, i, i - 1) = -1;
    }
    *at(s->B, n, LONG - 1, 0) = *at(s->B, n, LONG, 1) = 1;
    s->command[0] = (ns_command){.pair = 0, .on = 1, .off = 1};
    s->command[0].gx = calloc((size_t)n, sizeof(double));
    s->command[0].gz = calloc(1, sizeof(double));
    assert_true(s->command[0].gx && s->command[0].gz);
    s->command[0].gx[3] = 4;
    s->command[0].gz[0] = 9;
    ns_system *same = large_copy(s), *back;
    ns_islands a = parts_of(same);
    assert_int_equal(a.count, 2);
    const ns_large *l = a.island[0].s->large;
    assert_non_null(l);
    assert_null(a.island[1].s->large);
    assert_int_equal(l->A.start[LONG], 2 * LONG - 1);
    assert_true(l->gx.row[0] == 3 && l->gx.value[0] == 4 && l->gz.value[0] == 9);
    assert_null(a.island[0].s->command[0].gx);
    assert_int_equal(ns_system_check(a.island[0].s, NULL), NS_OK);
    assert_int_equal(ns_system_dense_copy(a.island[0].s, &back), NS_OK);
    assert_true(*at(back->A, LONG, 5, 4) == -1 && *at(back->A, LONG, 5, 5) == 6 && back->B[LONG - 1] == 1);
    ns_system_free(back);
    ns_system_partition_free(&a);
    ns_system_free(same);
    ns_system_free(s);
}

static void assert_same(int count, const double *a, const double *b) {
    for (int i = 0; i < count; i++)
        assert_true(a[i] == b[i]);
}

static void a_dense_copy(void **state) {
    ns_system *s = at_one_supply(3), *same, *back;
    const int n = s->n, m = s->m, nz = s->nz;
    (void)state;
    s->command[1].gx = calloc((size_t)n, sizeof(double));
    assert_non_null(s->command[1].gx);
    s->command[1].gx[2] = 6;
    same = large_copy(s);
    assert_int_equal(ns_system_dense_copy(same, &back), NS_OK);
    assert_null(back->large);
    assert_same(n * n, back->M, s->M);
    assert_same(n * n, back->A, s->A);
    assert_same(n * m, back->B, s->B);
    assert_same(n * m, back->C, s->C);
    assert_same(m * m, back->D, s->D);
    assert_same(n * nz, back->E, s->E);
    assert_same(m * nz, back->F, s->F);
    assert_same(n, back->b, s->b);
    assert_same(m, back->e, s->e);
    assert_same(m, back->l, s->l);
    assert_same(m, back->u, s->u);
    for (int c = 0; c < s->nc; c++) {
        assert_true((back->command[c].gx != NULL) == (c == 1));
        assert_same(nz, back->command[c].gz, s->command[c].gz);
        assert_int_equal(back->command[c].pair, c);
    }
    assert_same(n, back->command[1].gx, s->command[1].gx);
    assert_true(back->z[3].u.dc == 2);
    ns_system_free(back);
    ns_system_free(same);
    ns_system_free(s);
}

static void no_memory(void **state) {
    (void)state;
    for (int dense = 0; dense < 2; dense++) {
        ns_system *s = at_one_supply(2), *same = large_copy(s), *back;
        ns_islands a;
        for (long k = 1;; k++) {
            fail_alloc_at(k);
            const int status = dense ? ns_system_dense_copy(same, &back) : ns_system_partition(same, &a);
            const long made = allocs_made();
            fail_alloc_off();
            if (made < k)
                break;
            assert_int_equal(status, NS_E_MEMORY);
            assert_true(dense || !a.island);
        }
        if (dense)
            ns_system_free(back);
        else
            ns_system_partition_free(&a);
        ns_system_free(same);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_at_one_supply),
        cmocka_unit_test(as_many_as_are_worth_it),
        cmocka_unit_test(what_has_no_pair),
        cmocka_unit_test(what_ties_islands_together),
        cmocka_unit_test(what_only_sees_the_supply),
        cmocka_unit_test(a_large_island),
        cmocka_unit_test(a_dense_copy),
        cmocka_unit_test(no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
