/* tests/unit/bridge/test_affine.c - which expressions are a constant plus a linear combination. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "affine.h"

static void degrees(void **state) {
    enum { C = DEGREE_CONSTANT, L = DEGREE_LINEAR, X = DEGREE_OTHER };
    static const int wanted[][3][3] = {/* [operation][left][right] */
                                       [OPERATION_SUM] = {{C, L, X}, {L, L, X}, {X, X, X}},
                                       [OPERATION_PRODUCT] = {{C, L, X}, {L, X, X}, {X, X, X}},
                                       [OPERATION_QUOTIENT] = {{C, X, X}, {L, X, X}, {X, X, X}},
                                       [OPERATION_OTHER] = {{C, X, X}, {X, X, X}, {X, X, X}}};
    (void)state;
    for (int operation = OPERATION_SUM; operation <= OPERATION_OTHER; operation++) {
        for (int left = C; left <= X; left++) {
            for (int right = C; right <= X; right++) {
                assert_int_equal(
                    ns_bridge_affine_degree((ns_operation)operation, (ns_degree)left, (ns_degree)right),
                    wanted[operation][left][right]);
            }
        }
    }
}

/* 3 - 2 v0 + 0.5 v1, plus `square` v1^2, NAN above `end`. */
typedef struct polynomial {
    double square, end;
} polynomial;

static double evaluate(void *context, const double *v, double *slopes) {
    const polynomial *p = context;
    slopes[0] = -2.0;
    slopes[1] = 0.5 + 2.0 * p->square * v[1];
    return v[0] > p->end ? NAN : 3.0 - 2.0 * v[0] + 0.5 * v[1] + p->square * v[1] * v[1];
}

static int fit(double square, double end, double *constant, double *slopes) {
    polynomial p = {square, end};
    const ns_expression e = {2, evaluate, &p};
    double work[4];
    return ns_bridge_affine_fit(&e, constant, slopes, work);
}

static void coefficients_of_a_line(void **state) {
    double constant, slopes[2];
    (void)state;
    assert_int_equal(fit(0.0, INFINITY, &constant, slopes), 1);
    assert_true(constant == 3.0 && slopes[0] == -2.0 && slopes[1] == 0.5);
}

static void rounding_is_allowed_and_no_more(void **state) {
    double constant, slopes[2];
    (void)state;
    assert_int_equal(fit(1e-15, INFINITY, &constant, slopes), 1);
    assert_int_equal(fit(1e-11, INFINITY, &constant, slopes), 0);
    assert_int_equal(fit(-1.0, INFINITY, &constant, slopes), 0);
}

static void what_has_no_value_is_no_line(void **state) {
    double constant, slopes[2];
    (void)state;
    assert_int_equal(fit(0.0, -1.0, &constant, slopes), 0); /* not at 0 */
    assert_int_equal(fit(0.0, 0.5, &constant, slopes), 0);  /* not at the first point of the check */
}

static double constant_value(void *context, const double *v, double *slopes) {
    (void)v;
    *slopes = 0.0; /* of no variable: room for one is there */
    return *(double *)context;
}

static void a_constant_has_no_variables(void **state) {
    double value = -4.0;
    const ns_expression e = {0, constant_value, &value};
    double constant, none[1];
    (void)state;
    assert_int_equal(ns_bridge_affine_fit(&e, &constant, none, none), 1);
    assert_true(constant == -4.0);
    value = INFINITY;
    assert_int_equal(ns_bridge_affine_fit(&e, &constant, none, none), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(degrees),
        cmocka_unit_test(coefficients_of_a_line),
        cmocka_unit_test(rounding_is_allowed_and_no_more),
        cmocka_unit_test(what_has_no_value_is_no_line),
        cmocka_unit_test(a_constant_has_no_variables),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
