/* tests/unit/theta/test_map_cache.c - kept maps: found by length, kind and mode; dropped by last use. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "theta/theta_internal.h"

enum { M = 3, BYTES = 100 };

static ns_map *insert(ns_cache *c, double h, int implicit, const ns_mode *mode) {
    ns_map *map = calloc(1, sizeof *map + M);
    assert_non_null(map);
    map->h = h;
    map->implicit = implicit;
    map->mode = (ns_mode *)(map + 1);
    map->bytes = BYTES;
    memcpy(map->mode, mode, M);
    ns_theta_cache_insert(c, map, M);
    return map;
}

static ns_cache *empty_cache(size_t maps) {
    ns_cache *c = calloc(1, sizeof *c);
    assert_non_null(c);
    c->limit = maps * BYTES;
    return c;
}

static const ns_mode lower[M] = {NS_LOWER, NS_LOWER, NS_LOWER}, inside[M] = {NS_LOWER, NS_LOWER, NS_INSIDE};

static void length_kind_and_mode_are_the_key(void **state) {
    (void)state;
    ns_cache *c = empty_cache(100);
    ns_map *const made[] = {insert(c, 1e-6, 0, lower), insert(c, 1e-6, 1, lower), insert(c, 1e-6, 0, inside),
                            insert(c, 5e-7, 0, lower)};
    assert_true(ns_theta_cache_find(c, 1e-6, 0, lower, M) == made[0]);
    assert_true(ns_theta_cache_find(c, 1e-6, 1, lower, M) == made[1]);
    assert_true(ns_theta_cache_find(c, 1e-6, 0, inside, M) == made[2]);
    assert_true(ns_theta_cache_find(c, 5e-7, 0, lower, M) == made[3]);
    assert_null(ns_theta_cache_find(c, 5e-7, 1, lower, M));
    assert_null(ns_theta_cache_find(c, 5e-7, 0, inside, M));
    assert_null(ns_theta_cache_find(c, 2e-6, 0, lower, M));
    assert_int_equal(c->bytes, 4 * BYTES);
    ns_theta_cache_clear(c);
    assert_int_equal(c->bytes, 0);
    assert_null(ns_theta_cache_find(c, 1e-6, 0, lower, M));
    free(c);
}

/* 5 maps where 3 fit: the two that were used least recently go, not the oldest. */
static void the_least_recently_used_is_dropped(void **state) {
    (void)state;
    ns_cache *c = empty_cache(3);
    for (int i = 0; i < 5; i++)
        (void)insert(c, i + 1, 0, lower);
    (void)ns_theta_cache_find(c, 1, 0, lower, M);
    (void)ns_theta_cache_find(c, 3, 0, lower, M);
    assert_int_equal(ns_theta_cache_trim(c, M, NULL), 2); /* 2 and 4 */
    assert_int_equal(c->bytes, 3 * BYTES);
    for (int i = 0; i < 5; i++)
        assert_true((ns_theta_cache_find(c, i + 1, 0, lower, M) == NULL) == (i == 1 || i == 3));
    assert_int_equal(ns_theta_cache_trim(c, M, NULL), 0);
    ns_theta_cache_clear(c);
    free(c);
}

/* Not even where it alone is too large. */
static void one_is_kept_whatever_the_limit(void **state) {
    (void)state;
    ns_cache *c = empty_cache(0);
    ns_map *kept = insert(c, 1, 0, lower);
    (void)insert(c, 2, 0, lower);
    assert_int_equal(ns_theta_cache_trim(c, M, kept), 1);
    assert_true(ns_theta_cache_find(c, 1, 0, lower, M) == kept);
    assert_null(ns_theta_cache_find(c, 2, 0, lower, M));
    ns_theta_cache_clear(c);
    free(c);
}

/* More maps than buckets: chains, from which maps are taken out in the middle. */
static void chains_stay_whole(void **state) {
    (void)state;
    enum { MAPS = 4 * NS_BUCKETS };
    ns_cache *c = empty_cache(MAPS / 2);
    for (int i = 0; i < MAPS; i++)
        (void)insert(c, i + 1, i % 2, lower);
    for (int i = 0; i < MAPS; i += 2)
        (void)ns_theta_cache_find(c, i + 1, 0, lower, M);
    assert_int_equal(ns_theta_cache_trim(c, M, NULL), MAPS / 2);
    for (int i = 0; i < MAPS; i++) {
        const ns_map *map = ns_theta_cache_find(c, i + 1, i % 2, lower, M);
        assert_true(i % 2 ? !map : map && map->h == i + 1);
    }
    ns_theta_cache_clear(c);
    free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(length_kind_and_mode_are_the_key),
        cmocka_unit_test(the_least_recently_used_is_dropped),
        cmocka_unit_test(one_is_kept_whatever_the_limit),
        cmocka_unit_test(chains_stay_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
