/* tests/unit/sparse/test_packed_laws.c - laws of a pair, packed, against its guards as they are defined. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/packed_laws.h"

/* Of y = 2 lambda - x in a mode: whether the law holds at (x, lambda). */
static int holds(ns_mode mode, double l, double u, double x, double lambda) {
    ns_system *s;
    ns_form *f;
    ns_packed_laws k;
    const double v[] = {x, lambda};
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->B[0] = 1;
    s->C[0] = -1;
    s->D[0] = 2;
    s->l[0] = l;
    s->u[0] = u;
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    assert_int_equal(ns_sparse_laws_create(1, &k), NS_OK);
    ns_sparse_laws_set(&k, f, &mode, &l, &u);
    assert_int_equal(k.others, 0);
    const int hold = ns_sparse_laws_hold(&k, v);
    ns_sparse_laws_free(&k);
    ns_sparse_form_free(f);
    ns_system_free(s);
    return hold;
}

/* At its lower bound y must not be negative, lambda being that bound whatever v says; at its upper one not
 * positive. */
static void outside(void **state) {
    (void)state;
    assert_true(holds(NS_LOWER, 0, INFINITY, -1e-9, 7) && !holds(NS_LOWER, 0, INFINITY, 1e-9, 7));
    assert_true(holds(NS_LOWER, -3, 5, -6.001, 7) && !holds(NS_LOWER, -3, 5, -5.999, 7)); /* 2 l = -6 */
    assert_true(holds(NS_UPPER, -3, 5, 10.001, 7) && !holds(NS_UPPER, -3, 5, 9.999, 7));  /* 2 u = 10 */
}

/* Inside lambda must not be beyond the one bound. */
static void inside(void **state) {
    (void)state;
    assert_true(holds(NS_INSIDE, -3, INFINITY, 0, -2.999) && !holds(NS_INSIDE, -3, INFINITY, 0, -3.001));
    assert_true(holds(NS_INSIDE, -INFINITY, 5, 0, 4.999) && !holds(NS_INSIDE, -INFINITY, 5, 0, 5.001));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(outside), cmocka_unit_test(inside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
