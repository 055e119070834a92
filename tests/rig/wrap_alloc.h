/* tests/rig/wrap_alloc.h - makes the k-th allocation of the code under test fail.
 *
 * Test programs are linked with -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc, so the calls in
 * libnonsmooth.a and in the tests themselves come here; those inside shared libraries do not.
 *
 *     for (long k = 1;; ++k) {
 *         fail_alloc_at(k);
 *         int status = make_something(&it);
 *         long made = allocs_made();
 *         fail_alloc_off();
 *         if (made < k) break;             // succeeded without meeting the k-th allocation
 *         assert_int_equal(status, NS_E_MEMORY);
 *     }
 */
#ifndef NONSMOOTH_TESTS_WRAP_ALLOC_H
#define NONSMOOTH_TESTS_WRAP_ALLOC_H

/* Starts a count: from here on allocation k (1, 2, ...) fails and all others succeed; k <= 0: none fails. */
void fail_alloc_at(long k);

/* Allocations tried since the last fail_alloc_at(), the failed one included. */
long allocs_made(void);

/* Stops counting and failing. */
void fail_alloc_off(void);

/* 1: allocations of SuiteSparse count too; 0: no longer. */
void fail_alloc_in_suitesparse(int yes);

#endif
