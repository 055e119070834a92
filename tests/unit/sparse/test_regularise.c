/* tests/unit/sparse/test_regularise.c - what a solution of (P2) leaves over, relative to the terms of each
 * row. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/regularise.h"

/* M x' = 2 x + 4 lambda, y = x, and what (P2) leaves over of r at x = 1000, lambda = 0.001, if row 0 is kept.
 */
static double left(double M, double g, ns_mode mode) {
    ns_system *s;
    ns_form *f;
    const double v[] = {1000, 1e-3};
    double r[] = {0, 0}, rest[2];
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = M;
    s->A[0] = 2;
    s->B[0] = 4;
    s->C[0] = 1;
    s->u[0] = INFINITY;
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    ns_sparse_form_subtract(f, g, &mode, v, r);
    r[0] = -r[0];
    r[1] = 0;
    const double left = ns_sparse_leaks_left(f, g, &mode, NULL, r, v, NULL, rest);
    assert_true(rest[0] == 0);
    assert_true(rest[1] == (mode == NS_INSIDE ? -v[0] : -v[1]));
    ns_sparse_form_free(f);
    ns_system_free(s);
    return left;
}

static void assert_close(double is, double should) {
    if (!(fabs(is - should) <= 1e-12 * should))
        fail_msg("%.17g is not %.17g", is, should);
}

/* lambda that should be zero is what is left of the row it enters: its terms are |M x| + g (|2 x| + |4
 * lambda|), of which 4 g lambda is a part.  Of y that should be zero the only term is x. */
static void what_is_left_of_a_law(void **state) {
    (void)state;
    const double flows = 2 * 1000 + 4 * 1e-3;
    assert_close(left(0, 0.5, NS_LOWER), 1e-3 / (1e-3 + flows / 4));
    assert_close(left(3, 0.5, NS_LOWER), 1e-3 / (1e-3 + (3 * 1000 + 0.5 * flows) / (0.5 * 4)));
    assert_close(left(0, 0.5, NS_INSIDE), 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_left_of_a_law)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
