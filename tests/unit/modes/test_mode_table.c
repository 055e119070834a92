/* tests/unit/modes/test_mode_table.c - the table by mode and length: what is found, what is dropped. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "modes/mode_table.h"

enum { M = 3, BYTES = 100 };

static int freed;

static void free_entry(void *owner, ns_mode_entry *e) {
    ++*(int *)owner;
    free(e);
}

static ns_mode_entry *insert(ns_mode_table *t, double h, const ns_mode *mode) {
    ns_mode_entry *e = calloc(1, sizeof *e + M);
    assert_non_null(e);
    *e = (ns_mode_entry){.h = h, .mode = (ns_mode *)(e + 1), .bytes = BYTES};
    e->key = ns_modes_table_key(M, h, mode);
    memcpy(e->mode, mode, M);
    ns_modes_table_insert(t, e);
    return e;
}

static ns_mode_entry *find(ns_mode_table *t, double h, const ns_mode *mode) {
    return ns_modes_table_find(t, ns_modes_table_key(M, h, mode), h, mode);
}

static ns_mode_table *empty_table(size_t entries) {
    ns_mode_table *t = calloc(1, sizeof *t);
    assert_non_null(t);
    t->m = M;
    t->limit = entries * BYTES;
    t->free_entry = free_entry;
    t->owner = &freed;
    freed = 0;
    return t;
}

static const ns_mode lower[M] = {NS_LOWER, NS_LOWER, NS_LOWER}, inside[M] = {NS_LOWER, NS_LOWER, NS_INSIDE};

static void length_and_mode_are_the_key(void **state) {
    (void)state;
    ns_mode_table *t = empty_table(100);
    ns_mode_entry *const made[] = {insert(t, 1e-6, lower), insert(t, -1e-6, lower), insert(t, 1e-6, inside),
                                   insert(t, 5e-7, lower)};
    assert_true(find(t, 1e-6, lower) == made[0]);
    assert_true(find(t, -1e-6, lower) == made[1]);
    assert_true(find(t, 1e-6, inside) == made[2]);
    assert_true(find(t, 5e-7, lower) == made[3]);
    assert_null(find(t, -5e-7, lower));
    assert_null(find(t, 5e-7, inside));
    assert_null(find(t, 2e-6, lower));
    /* one key of two lengths, or of two modes, is no match */
    assert_null(ns_modes_table_find(t, made[0]->key, 2e-6, lower));
    assert_null(ns_modes_table_find(t, made[0]->key, 1e-6, inside));
    assert_int_equal(t->bytes, 4 * BYTES);
    ns_modes_table_clear(t);
    assert_int_equal(freed, 4);
    assert_int_equal(t->bytes, 0);
    assert_null(find(t, 1e-6, lower));
    free(t);
}

/* 5 entries where 3 fit: the two that were asked for least recently go, not the oldest. */
static void the_least_recently_used_is_dropped(void **state) {
    (void)state;
    ns_mode_table *t = empty_table(3);
    for (int i = 0; i < 5; i++)
        (void)insert(t, i + 1, lower);
    (void)find(t, 1, lower);
    (void)find(t, 3, lower);
    assert_int_equal(ns_modes_table_trim(t, NULL), 2); /* 2 and 4 */
    assert_int_equal(freed, 2);
    assert_int_equal(t->bytes, 3 * BYTES);
    for (int i = 0; i < 5; i++)
        assert_true((find(t, i + 1, lower) == NULL) == (i == 1 || i == 3));
    assert_int_equal(ns_modes_table_trim(t, NULL), 0);
    ns_modes_table_clear(t);
    free(t);
}

/* Not even where it alone is too large. */
static void one_is_kept_whatever_the_limit(void **state) {
    (void)state;
    ns_mode_table *t = empty_table(0);
    ns_mode_entry *kept = insert(t, 1, lower);
    (void)insert(t, 2, lower);
    assert_int_equal(ns_modes_table_trim(t, kept), 1);
    assert_true(find(t, 1, lower) == kept);
    assert_null(find(t, 2, lower));
    ns_modes_table_clear(t);
    free(t);
}

/* More entries than buckets: chains, from which entries are taken out in the middle. */
static void chains_stay_whole(void **state) {
    (void)state;
    enum { ENTRIES = 8 * NS_MODE_BUCKETS };
    ns_mode_table *t = empty_table(ENTRIES / 2);
    for (int i = 0; i < ENTRIES; i++)
        (void)insert(t, i + 1, lower);
    for (int i = 0; i < ENTRIES; i += 2)
        (void)find(t, i + 1, lower);
    assert_int_equal(ns_modes_table_trim(t, NULL), ENTRIES / 2);
    for (int i = 0; i < ENTRIES; i++) {
        const ns_mode_entry *e = find(t, i + 1, lower);
        assert_true(i % 2 ? !e : e && e->h == i + 1);
    }
    ns_modes_table_clear(t);
    free(t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(length_and_mode_are_the_key),
        cmocka_unit_test(the_least_recently_used_is_dropped),
        cmocka_unit_test(one_is_kept_whatever_the_limit),
        cmocka_unit_test(chains_stay_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
