/* tests/unit/linalg/test_sparse_pattern.c - patterns of sparse matrices: the same one for the same places, as
 * long as it is kept or in use; and without memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "linalg/sparse_pattern.h"
#include "wrap_alloc.h"

/* A full matrix of N columns. */
enum { N = 4, ALL = N * N };
static const int start[N + 1] = {0, 4, 8, 12, 16},
                           row[ALL] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};

/* The diagonal, and the places off it whose bits are set. */
static void fill(unsigned places, double by, double *value) {
    unsigned bit = 1;
    for (int k = 0; k < ALL; k++) {
        const int on_diagonal = k % N == k / N;
        value[k] = on_diagonal ? by : places & bit ? 0.1 * by : 0;
        bit <<= !on_diagonal;
    }
}

static ns_pattern *pattern_of(ns_patterns *all, unsigned places, double by, klu_common *c) {
    double value[ALL];
    fill(places, by, value);
    return ns_linalg_pattern_of(all, N, start, row, value, c);
}

static void equal_places_share_a_pattern(void **state) {
    (void)state;
    ns_patterns all = {.next = 0};
    klu_common c;
    (void)klu_defaults(&c);
    ns_pattern *p = pattern_of(&all, 5, 1, &c), *same = pattern_of(&all, 5, 3, &c),
               *fewer = pattern_of(&all, 1, 1, &c), *more = pattern_of(&all, 7, 1, &c);
    assert_non_null(p);
    assert_ptr_equal(p, same);
    assert_int_equal(p->uses, 3); /* and one while it is kept */
    assert_ptr_not_equal(p, fewer);
    assert_ptr_not_equal(p, more);
    static const int columns[N + 1] = {0, 3, 4, 5, 6}; /* bits 0 and 2: rows 1 and 3 of column 0 */
    assert_memory_equal(p->start, columns, sizeof columns);
    for (int k = 0; k < p->start[N]; k++)
        assert_int_equal(p->row[k], row[p->from[k]]);
    ns_linalg_pattern_free(p, &c);
    ns_linalg_pattern_free(same, &c);
    ns_linalg_pattern_free(fewer, &c);
    ns_linalg_pattern_free(more, &c);
    ns_linalg_patterns_free(&all, &c);
}

/* One in use outlives those that took its place. */
static void patterns_in_use_remain(void **state) {
    (void)state;
    ns_patterns all = {.next = 0};
    klu_common c;
    (void)klu_defaults(&c);
    ns_pattern *p = pattern_of(&all, 1, 1, &c);
    for (unsigned places = 2; places < 2 + NS_PATTERNS; places++)
        ns_linalg_pattern_free(pattern_of(&all, places, 1, &c), &c);
    assert_int_equal(p->uses, 1);
    assert_int_equal(p->start[N], N + 1);
    ns_pattern *again = pattern_of(&all, 1, 1, &c);
    assert_ptr_not_equal(p, again);
    ns_linalg_pattern_free(again, &c);
    ns_linalg_pattern_free(p, &c);
    ns_linalg_patterns_free(&all, &c);
}

static void singular_places_have_none(void **state) {
    (void)state;
    ns_patterns all = {.next = 0};
    double value[ALL] = {1, 0, 0, 0, 1}; /* two columns in one row, two without entries */
    klu_common c;
    (void)klu_defaults(&c);
    assert_null(ns_linalg_pattern_of(&all, N, start, row, value, &c));
    assert_int_not_equal(c.status, KLU_OUT_OF_MEMORY);
    assert_null(all.kept[0]);
}

static void no_memory_is_told(void **state) {
    (void)state;
    for (long fail = 1; fail <= 2; fail++) {
        ns_patterns all = {.next = 0};
        klu_common c;
        (void)klu_defaults(&c);
        fail_alloc_at(fail);
        ns_pattern *p = pattern_of(&all, 5, 1, &c);
        fail_alloc_off();
        assert_null(p);
        assert_int_equal(c.status, KLU_OUT_OF_MEMORY);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_places_share_a_pattern), cmocka_unit_test(patterns_in_use_remain),
        cmocka_unit_test(singular_places_have_none), cmocka_unit_test(no_memory_is_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
