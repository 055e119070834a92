/* tests/unit/modes/test_mode.c - the mode of a system and what follows from it; what is kept by mode. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "modes/mode_table.h"

/* Pairs 0 and 3 are switches, 1 is a diode across switch 0, 2 one that lambda bounds from both sides. */
static void bounds_follow_from_the_mode(void **state) {
    ns_command command[2] = {{.pair = 0}, {.pair = 3}};
    double l0[] = {0, 0, -1, 0}, u0[] = {0, INFINITY, 2, 0};
    const ns_system s = {.m = 4, .nc = 2, .command = command, .l = l0, .u = u0};
    const ns_shared_branch shared = {.pair = 1, .of = 0, .idle = NS_LOWER};
    const ns_mode to[] = {NS_INSIDE, NS_INSIDE, NS_UPPER, NS_SLIDES_UP};
    ns_mode mode[4] = {NS_LOWER, NS_LOWER, NS_LOWER, NS_LOWER};
    double l[] = {7, 7, 7, 7}, u[] = {8, 8, 8, 8};
    (void)state;
    ns_modes_set(&s, &shared, 1, to, mode, l, u);
    assert_int_equal(mode[0], NS_INSIDE);
    assert_int_equal(mode[1], NS_LOWER); /* idle: the switch across it is closed */
    assert_int_equal(mode[2], NS_UPPER);
    assert_true(l[0] == -INFINITY && u[0] == INFINITY);
    assert_true(l[1] == 0 && u[1] == 0);
    assert_true(l[2] == 7 && u[2] == 8); /* not commanded: as they were */
    assert_true(l[3] == 0 && u[3] == 0); /* a switch that slides is not closed */
    mode[0] = NS_LOWER;
    mode[1] = NS_INSIDE;
    ns_modes_set(&s, &shared, 1, mode, mode, l, u);
    assert_int_equal(mode[1], NS_INSIDE);
    assert_true(l[0] == 0 && u[0] == 0 && l[1] == 0 && u[1] == INFINITY);
}

/* What follows where lambda reaches a bound, where y does, and where either ends sliding. */
static void guards_of_a_pair(void **state) {
    ns_mode to[2];
    (void)state;
    assert_int_equal(ns_mode_guards(NS_INSIDE, -1, 2, to), 2);
    assert_true(to[0] == NS_LOWER && to[1] == NS_UPPER);
    assert_int_equal(ns_mode_guards(NS_INSIDE, 0, INFINITY, to), 1);
    assert_int_equal(to[0], NS_LOWER);
    assert_int_equal(ns_mode_guards(NS_INSIDE, -INFINITY, 0, to), 1);
    assert_int_equal(to[0], NS_UPPER);
    assert_int_equal(ns_mode_guards(NS_INSIDE, -INFINITY, INFINITY, to), 0); /* a closed switch */
    assert_int_equal(ns_mode_guards(NS_UPPER, -1, 2, to), 1);
    assert_int_equal(to[0], NS_INSIDE);
    assert_int_equal(ns_mode_guards(NS_LOWER, 0, 0, to), 0); /* an open one */
    assert_int_equal(ns_mode_guards(NS_SLIDES_DOWN, 0, 0, to), 2);
    assert_true(to[0] == NS_LOWER && to[1] == NS_INSIDE);
}

static void values_of_modes(void **state) {
    (void)state;
    assert_true(ns_mode_slides(NS_SLIDES_UP) && ns_mode_slides(NS_SLIDES_DOWN));
    assert_false(ns_mode_slides(NS_UPPER) || ns_mode_slides(NS_INSIDE) || ns_mode_slides(NS_TARGET_TOGGLE));
    assert_int_equal(ns_mode_toggled(NS_INSIDE), NS_LOWER);
    assert_int_equal(ns_mode_toggled(NS_LOWER), NS_INSIDE);
    assert_int_equal(ns_mode_toggled(NS_SLIDES_UP), NS_INSIDE);
}

enum { ENTRIES = 6, PAIRS = 3 };

static void mark_freed(void *owner, ns_mode_entry *e) {
    ((int *)owner)[(int)e->h]++;
}

/* Entries of length k and mode (k mod 3, 0, 1), each 10 bytes. */
static void insert(ns_mode_table *t, ns_mode_entry *e, ns_mode (*mode)[PAIRS], int k) {
    memcpy(mode[k], ((ns_mode[]){(ns_mode)(k % 3), 0, 1}), PAIRS);
    e[k] =
        (ns_mode_entry){.h = k, .mode = mode[k], .bytes = 10, .key = ns_modes_table_key(PAIRS, k, mode[k])};
    ns_modes_table_insert(t, &e[k]);
}

/* The ones asked for least recently are dropped first, until the rest fits exactly; one may be kept though it
 * is the oldest. */
static void the_oldest_are_dropped(void **state) {
    int freed[ENTRIES] = {0};
    ns_mode_entry e[ENTRIES];
    ns_mode mode[ENTRIES][PAIRS];
    ns_mode_table t = {.m = PAIRS, .limit = 30, .free_entry = mark_freed, .owner = freed};
    (void)state;
    for (int k = 0; k < ENTRIES; k++)
        insert(&t, e, mode, k);
    assert_true(t.bytes == 60);
    assert_ptr_equal(ns_modes_table_find(&t, e[1].key, 1, mode[1]), &e[1]);
    assert_null(ns_modes_table_find(&t, e[1].key, 1, mode[2]));
    assert_null(ns_modes_table_find(&t, e[1].key, 2, mode[1]));
    assert_int_equal(ns_modes_table_trim(&t, &e[0]), 3); /* of 0 2 3 4 5 1 */
    for (int k = 0; k < ENTRIES; k++) {
        const int dropped = k == 2 || k == 3 || k == 4;
        assert_int_equal(freed[k], dropped);
        assert_ptr_equal(ns_modes_table_find(&t, e[k].key, k, mode[k]), dropped ? NULL : &e[k]);
    }
    assert_true(t.bytes == 30);
    assert_int_equal(ns_modes_table_trim(&t, NULL), 0);
    ns_modes_table_clear(&t);
    for (int k = 0; k < ENTRIES; k++)
        assert_int_equal(freed[k], 1);
    assert_true(t.bytes == 0 && !t.oldest && !t.newest);
}

/* Two entries of one bucket are found and dropped apart. */
static void one_bucket_holds_several(void **state) {
    int freed[ENTRIES] = {0};
    ns_mode mode[2][PAIRS] = {{0, 0, 0}, {0, 0, 1}};
    ns_mode_entry e[2] = {{.h = 1, .mode = mode[0], .bytes = 1, .key = 5},
                          {.h = 1, .mode = mode[1], .bytes = 1, .key = 5 + NS_MODE_BUCKETS}};
    ns_mode_table t = {.m = PAIRS, .limit = 1, .free_entry = mark_freed, .owner = freed};
    (void)state;
    ns_modes_table_insert(&t, &e[0]);
    ns_modes_table_insert(&t, &e[1]);
    assert_ptr_equal(ns_modes_table_find(&t, e[0].key, 1, mode[0]), &e[0]);
    assert_ptr_equal(ns_modes_table_find(&t, e[1].key, 1, mode[1]), &e[1]);
    assert_int_equal(ns_modes_table_trim(&t, NULL), 1);
    assert_null(ns_modes_table_find(&t, e[0].key, 1, mode[0]));
    assert_ptr_equal(ns_modes_table_find(&t, e[1].key, 1, mode[1]), &e[1]);
}

/* Lengths h 2^-k, whose low bits are all zero, fall into different buckets: at least half as many as there
 * are. */
static void lengths_are_spread(void **state) {
    enum { LENGTHS = 40 };
    const ns_mode mode[PAIRS] = {0, 1, -1};
    unsigned char used[NS_MODE_BUCKETS] = {0};
    int buckets = 0;
    (void)state;
    for (int k = 0; k < LENGTHS; k++)
        used[ns_modes_table_key(PAIRS, ldexp(1e-6, -k), mode) % NS_MODE_BUCKETS] = 1;
    for (int b = 0; b < NS_MODE_BUCKETS; b++)
        buckets += used[b];
    assert_true(buckets > LENGTHS / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_follow_from_the_mode),
        cmocka_unit_test(guards_of_a_pair),
        cmocka_unit_test(values_of_modes),
        cmocka_unit_test(the_oldest_are_dropped),
        cmocka_unit_test(one_bucket_holds_several),
        cmocka_unit_test(lengths_are_spread),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
