/* tests/unit/newton/test_parts.c - parts of a system that nothing joins, in units far apart: each is solved
 * by its own. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

#include "newton/newton_internal.h"

static ns_newton *start(const ns_model *model, const double *x) {
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    ns_newton *s;
    assert_int_equal(ns_newton_create(model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, x, NULL), NS_OK);
    return s;
}

/* x_0' = 0, x_1' = -unit (x_1/unit)^3 */
static int cubic_f(const ns_point *at, void *data, double *out) {
    const double unit = *(const double *)data, u = at->x[1] / unit;
    out[0] = 0;
    out[1] = -unit * u * u * u;
    return 0;
}

static int cubic_A(const ns_point *at, void *data, double *out) {
    const double u = at->x[1] / *(const double *)data;
    out[0] = out[1] = out[2] = 0;
    out[3] = -3 * u * u;
    return 0;
}

static const double identity[4] = {1, 0, 0, 1};

/* Of what is 0 there are defaults; the least bounds are as they were given. */
static void options_have_defaults(void **state) {
    const ns_newton_options given[] = {{.theta = 1, .gamma = 1},
                                       {.theta = 1, .gamma = 1, .iterations = 1, .halvings = 1}};
    const ns_model model = {.n = 2, .M = identity, .f = cubic_f, .A = cubic_A};
    (void)state;
    for (int k = 0; k < 2; k++) {
        ns_newton *s;
        assert_int_equal(ns_newton_create(&model, &given[k], &s, NULL), NS_OK);
        assert_true(s->o.tolerance == 1e-12);
        assert_int_equal(s->o.iterations, k == 0 ? 50 : 1);
        assert_int_equal(s->o.halvings, k == 0 ? 10 : 1);
        ns_newton_free(s);
    }
}

/* From 10 units by h = 1: u + u^3 = 10, u = 2. */
static void each_part_has_its_units(void **state) {
    (void)state;
    for (int k = -25; k <= 12; k++) {
        double unit = pow(10, k);
        const ns_model model = {.n = 2, .M = identity, .data = &unit, .f = cubic_f, .A = cubic_A};
        double x[2] = {1, 10 * unit};
        ns_newton *s = start(&model, x);
        assert_int_equal(ns_newton_try(s, 1), NS_OK);
        assert_int_equal(ns_newton_accept(s), NS_OK);
        assert_int_equal(ns_newton_read(s, NULL, x, NULL, NULL, NULL), NS_OK);
        assert_true(x[0] == 1);
        assert_true(fabs(x[1] / unit - 2) < 4e-12); /* 1e-12 of terms up to 10 + 8 + 13*2, a slope of 13 */
        ns_newton_free(s);
    }
}

/* x_0' = 1 - e^x_0 + a x_1, x_1' = -x_1 + a x_2, x_2' = 0 */
static int relax_f(const ns_point *at, void *data, double *out) {
    const double a = *(const double *)data;
    out[0] = 1 - exp(at->x[0]) + a * at->x[1];
    out[1] = -at->x[1] + a * at->x[2];
    out[2] = 0;
    return 0;
}

static int relax_A(const ns_point *at, void *data, double *out) {
    const double a = *(const double *)data, A[9] = {-exp(at->x[0]), 0, 0, a, -1, 0, 0, a, 0};
    memcpy(out, A, sizeof A);
    return 0;
}

/* x_0 halves in each step until e^x_0 is rounded: no x_0 solves the step any more, by x_0 alone.  Beside
 * x_2 = 1 it does, at once where entries lead there, however small, and where none do after all has been
 * tried. */
static void what_rounds_beside_the_system_is_solved(void **state) {
    (void)state;
    for (int joined = 0; joined < 2; joined++) {
        double a = joined * 1e-30;
        const double M[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        const ns_model model = {.n = 3, .M = M, .data = &a, .f = relax_f, .A = relax_A};
        double x[3] = {1, 0, 1};
        ns_newton *s = start(&model, x);
        assert_int_equal(ns_newton_advance(s, 200, 1), NS_OK);
        assert_int_equal(ns_newton_read(s, NULL, x, NULL, NULL, NULL), NS_OK);
        const ns_newton_counts *c = ns_newton_counts_of(s);
        print_message("%g: %ld steps, %ld trials, %ld iterations\n", x[0], c->steps, c->trials,
                      c->iterations);
        assert_true(fabs(x[0]) < 1e-15 && x[2] == 1);
        assert_true(c->steps == 200 && c->trials == 200);
        assert_true(!joined || c->iterations <= 300);
        ns_newton_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(options_have_defaults),
        cmocka_unit_test(each_part_has_its_units),
        cmocka_unit_test(what_rounds_beside_the_system_is_solved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
