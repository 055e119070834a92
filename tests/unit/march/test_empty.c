/* tests/unit/march/test_empty.c - sizes that are 0: arrays may be NULL then, and nothing is done with them
 * (the sanitizers watch). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

static ns_system *sized(int n, int m) {
    ns_system *s;
    assert_int_equal(ns_system_create(n, m, 0, 0, &s), NS_OK);
    for (int i = 0; i < n; i++) /* x' = -1 */
        s->M[i + i * n] = 1, s->b[i] = -1;
    for (int i = 0; i < m; i++) /* y = lambda - 2 */
        s->D[i + i * m] = 1, s->e[i] = -2;
    return s;
}

/* x(0.25) = 1 - 0.25 of x' = -1, exact at every theta; lambda = 2, y = 0 where there is a pair. */
static void check(int n, int m, const double *x, const double *lambda, const double *y) {
    for (int i = 0; i < n; i++)
        assert_true(fabs(x[i] - 0.75) < 1e-15); /* a few roundings */
    for (int i = 0; i < m; i++)
        assert_true(fabs(lambda[i] - 2) < 1e-15 && fabs(y[i]) < 1e-15);
}

/* Every engine, with no unknowns, no pairs, or neither. */
static void for_sizes(void (*engine)(int n, int m, const ns_system *s)) {
    for (int n = 0; n < 2; n++)
        for (int m = 0; m < 2; m++) {
            ns_system *s = sized(n, m);
            engine(n, m, s);
            ns_system_free(s);
        }
}

static void by_theta(int n, int m, const ns_system *s) {
    const ns_theta_options o = {0.5, 0.5, 0};
    const double w0 = 1;
    double x, lambda, y, past[16];
    ns_theta *t;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    ns_impulse at = {.x = &x, .lambda = &lambda, .y = &y};
    assert_int_equal(ns_theta_impulse(t, NULL, NULL, &at), NS_OK);
    for (int k = 0; k < 2; k++) { /* the first finds the slope */
        assert_int_equal(ns_theta_try(t, k ? 0.25 : 1e-18, NULL, !k, NS_RESOLVE), NS_OK);
        assert_int_equal(ns_theta_accept(t), NS_OK);
        assert_true(ns_theta_past_size(t) <= 16);
        ns_theta_save(t, past);
        ns_theta_restore(t, past);
    }
    assert_int_equal(ns_theta_read(t, &x, &lambda, &y), NS_OK);
    check(n, m, &x, &lambda, &y);
    ns_theta_free(t);
}

static void by_march(int n, int m, const ns_system *s) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 0.125};
    const double w0 = 1;
    double t, x, lambda, y;
    ns_march *a;
    assert_int_equal(ns_march_create(s, &o, &a, NULL), NS_OK);
    assert_int_equal(ns_march_start(a, 0, &w0), NS_OK);
    assert_int_equal(ns_march_try(a, 0.25, NS_TO_TIME, &t), NS_OK);
    assert_int_equal(ns_march_accept(a), NS_OK);
    assert_int_equal(ns_march_read(a, &t, &x, &lambda, &y), NS_OK);
    assert_true(t == 0.25);
    check(n, m, &x, &lambda, &y);
    ns_march_free(a);
}

static void by_newton(int n, int m, const ns_system *s) {
    const ns_newton_options o = {.theta = 0.5, .gamma = 1};
    const double x0 = 1, lambda0 = 2;
    double t, x, lambda, y;
    ns_model model;
    ns_jacobian_error worst;
    ns_newton *a;
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    assert_int_equal(ns_model_check_jacobians(&model, 0, &x0, &lambda0, &worst), NS_OK);
    assert_int_equal(ns_newton_create(&model, &o, &a, NULL), NS_OK);
    assert_int_equal(ns_newton_start(a, 0, n ? &x0 : NULL, NULL), NS_OK);
    assert_int_equal(ns_newton_jump(a), NS_OK);
    assert_int_equal(ns_newton_accept(a), NS_OK);
    assert_int_equal(ns_newton_advance(a, 0.25, 0.125), NS_OK);
    assert_int_equal(ns_newton_read(a, &t, &x, &lambda, &y, NULL), NS_OK);
    check(n, m, &x, &lambda, &y);
    ns_newton_free(a);
}

static void theta_steps(void **state) {
    (void)state;
    for_sizes(by_theta);
}

static void marches(void **state) {
    (void)state;
    for_sizes(by_march);
}

static void newton_steps(void **state) {
    (void)state;
    for_sizes(by_newton);
}

/* No pair, and not one array: the answer is nothing, the residual 0. */
static void problems(void **state) {
    (void)state;
    const ns_mlcp p = {.m = 0};
    ns_mlcp_solver *s;
    ns_mlcp_info info;
    assert_int_equal(ns_mlcp_create(0, &s), NS_OK);
    for (int method = 0; method < NS_MLCP_METHODS; method++) {
        assert_int_equal(ns_mlcp_use(s, (ns_mlcp_method)method), NS_OK);
        assert_int_equal(ns_mlcp_solve(s, &p, NULL, NULL, NULL, &info), NS_OK);
        assert_true(info.residual == 0);
    }
    ns_mlcp_free(s);
}

static void texts(void **state) {
    (void)state;
    ns_mlcp *p;
    assert_int_equal(ns_mlcp_read("0\n", 2, &p, NULL), NS_OK);
    assert_int_equal(p->m, 0);
    size_t length = 0;
    assert_int_equal(ns_mlcp_write(p, NULL, 0, &length), NS_OK);
    assert_true(length > 0);
    ns_mlcp_discard(p);
}

/* Two inputs that drive nothing: a matrix of no rows has columns all the same. */
static void inputs_alone(void **state) {
    (void)state;
    const ns_theta_options o = {0.5, 0.5, 0};
    const double z[] = {1, 2};
    ns_system *s;
    ns_theta *t;
    assert_int_equal(ns_system_create(0, 0, 2, 0, &s), NS_OK);
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, NULL, NULL), NS_OK);
    assert_int_equal(ns_theta_try(t, 0.25, z, 1, NS_RESOLVE), NS_OK);
    assert_int_equal(ns_theta_accept(t), NS_OK);
    ns_theta_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inputs_alone), cmocka_unit_test(theta_steps), cmocka_unit_test(marches),
        cmocka_unit_test(newton_steps), cmocka_unit_test(problems),    cmocka_unit_test(texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
