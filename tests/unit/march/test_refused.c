/* tests/unit/march/test_refused.c - calls of the linear engines that cannot be answered: bad input, wrong
 * order, points beyond double; each by its status. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "systems.h"

static ns_march *march_of(const ns_system *s) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 0.1};
    ns_march *m;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    return m;
}

static void marchers_are_not_made(void **state) {
    (void)state;
    ns_system *s = system_decay();
    ns_march *m = NULL;
    ns_march_options o = {.theta = 1, .gamma = 1, .h = 0.1};
    assert_int_equal(ns_march_create(s, &o, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_create(NULL, &o, &m, NULL), NS_E_NULL);
    assert_int_equal(ns_march_create(s, NULL, &m, NULL), NS_E_NULL);
    const double bad[] = {0, -1, INFINITY, NAN};
    for (int k = 0; k < 4; k++) {
        ns_fault fault = {.npairs = 2, .nunknowns = 2, .why = "what a call before left"};
        o.h = bad[k];
        assert_int_equal(ns_march_create(s, &o, &m, &fault), NS_E_RANGE);
        assert_null(m);
        assert_true(fault.status == NS_E_RANGE && isnan(fault.t) && !fault.why);
        assert_true(fault.npairs == 0 && fault.nunknowns == 0);
    }
    ns_march_free(NULL);
    ns_system_free(s);
}

static void marches_are_not_started(void **state) {
    (void)state;
    ns_system *s = system_decay();
    ns_march *m = march_of(s);
    const double w0 = 1, no_number = NAN;
    const int hold = 0, outside = 1;
    assert_int_equal(ns_march_start(NULL, 0, &w0), NS_E_NULL);
    assert_int_equal(ns_march_start(m, 0, NULL), NS_E_NULL);
    assert_int_equal(ns_march_start(m, NAN, &w0), NS_E_NUMBER);
    assert_int_equal(ns_march_start(m, 1e300, &w0), NS_E_NUMBER); /* where h is nothing */
    assert_int_equal(ns_march_start(m, 0, &no_number), NS_E_NUMBER);
    assert_int_equal(ns_march_fault(m)->status, NS_E_NUMBER);
    assert_int_equal(ns_march_start_dc(NULL, 0, 0, NULL, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_start_dc(m, 0, 1, NULL, &w0, NULL), NS_E_NULL);
    assert_int_equal(ns_march_start_dc(m, 0, 1, &hold, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_start_dc(m, INFINITY, 0, NULL, NULL, NULL), NS_E_NUMBER);
    assert_int_equal(ns_march_start_dc(m, 0, -1, &hold, &w0, NULL), NS_E_SIZE);
    assert_int_equal(ns_march_start_dc(m, 0, 2, &hold, &w0, NULL), NS_E_SIZE);
    assert_int_equal(ns_march_start_dc(m, 0, 1, &outside, &w0, NULL), NS_E_SIZE);
    ns_march_free(m);
    ns_system_free(s);
}

static void marches_do_not_go_on(void **state) {
    (void)state;
    ns_system *s = system_decay();
    ns_march *m = march_of(s);
    const double w0 = 1;
    double reached, x;
    ns_mlcp p;
    assert_int_equal(ns_march_try(m, 1, NS_TO_TIME, &reached), NS_E_STATE);
    assert_int_equal(ns_march_read(m, NULL, &x, NULL, NULL), NS_E_STATE);
    assert_int_equal(ns_march_start(m, 0, &w0), NS_OK);
    assert_int_equal(ns_march_try(NULL, 1, NS_TO_TIME, &reached), NS_E_NULL);
    assert_int_equal(ns_march_try(m, 1, NS_TO_TIME, NULL), NS_E_NULL);
    assert_int_equal(ns_march_try(m, 0, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_try(m, INFINITY, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_accept(NULL), NS_E_NULL);
    assert_int_equal(ns_march_accept(m), NS_E_STATE);
    assert_int_equal(ns_march_read(NULL, NULL, &x, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_problem(NULL, &p, NULL), NS_E_NULL);
    assert_int_equal(ns_march_problem(m, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_read(m, NULL, &x, NULL, NULL), NS_OK); /* and nothing is lost */
    assert_true(fabs(x - 1) < 1e-6);                                 /* two steps of h/2^20 */
    ns_march_free(m);
    ns_system_free(s);
}

static void theta_calls(void **state) {
    (void)state;
    ns_system *s = system_decay();
    const ns_theta_options o = {1, 1, 0};
    ns_theta *t;
    double past[8] = {0};
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(NULL, past, NULL), NS_E_NULL);
    assert_int_equal(ns_theta_command(NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_theta_accept(NULL), NS_E_NULL);
    assert_int_equal(ns_theta_read(NULL, past, NULL, NULL), NS_E_NULL);
    assert_true(ns_theta_past_size(NULL) == 0);
    ns_theta_save(NULL, past); /* nothing happens, */
    ns_theta_save(t, NULL);
    ns_theta_restore(NULL, past);
    ns_theta_restore(t, NULL);
    assert_int_equal(ns_theta_read(t, past, NULL, NULL), NS_E_STATE); /* not even here */
    ns_theta_free(t);
    ns_system_free(s);
}

/* x' = 0 and algebraic: 0 = 1e150 x - u, 0 = 1e150 u - v: v = 1e300 x, where x itself is 1e9.  y of a pair
 * that only looks at u: 1e150 u. */
static void a_value_beyond_double_is_named(void **state) {
    (void)state;
    for (int pairs = 0; pairs < 2; pairs++) {
        ns_system *s;
        const double w0[] = {1e9, 0, 0};
        double x[3], y[1] = {0};
        const int n = pairs ? 2 : 3;
        assert_int_equal(ns_system_create(n, pairs, 0, 0, &s), NS_OK);
        s->M[0] = 1;
        for (int i = 1; i < n; i++) {
            s->A[i + (i - 1) * n] = 1e150;
            s->A[i + i * n] = -1;
        }
        if (pairs)
            s->C[1] = 1e150;
        ns_march *m = march_of(s);
        assert_int_equal(ns_march_start(m, 2, w0), NS_OK);
        assert_int_equal(ns_march_read(m, NULL, x, NULL, y), NS_E_OVERFLOW);
        assert_true(fabs(x[0] - 1e9) < 1e-6 && isinf(pairs ? y[0] : x[2]));
        const ns_fault *f = ns_march_fault(m);
        assert_int_equal(f->status, NS_E_OVERFLOW);
        assert_true(fabs(f->t - 2) < 1e-6);
        assert_int_equal(f->nunknowns, pairs ? 0 : 1);
        assert_int_equal(f->npairs, pairs ? 1 : 0);
        assert_int_equal(pairs ? f->pair[0] : f->unknown[0], pairs ? 0 : 2);
        ns_march_free(m);
        ns_system_free(s);
    }
}

static void methods_by_name(void **state) {
    (void)state;
    ns_mlcp_solver *s;
    assert_int_equal(ns_mlcp_create(1, &s), NS_OK);
    for (int k = 0; k < NS_MLCP_METHODS; k++) {
        assert_int_equal(ns_mlcp_method_of(ns_mlcp_method_name(k)), k);
        assert_int_equal(ns_mlcp_use(s, (ns_mlcp_method)k), NS_OK);
    }
    assert_int_equal(ns_mlcp_method_of("simplex"), -1);
    assert_int_equal(ns_mlcp_method_of(NULL), -1);
    assert_string_equal(ns_mlcp_method_name(NS_MLCP_METHODS), "?");
    assert_string_equal(ns_mlcp_method_name(-1), "?");
    assert_int_equal(ns_mlcp_use(NULL, NS_MLCP_AUTO), NS_E_NULL);
    assert_int_equal(ns_mlcp_use(s, NS_MLCP_METHODS), NS_E_RANGE);
    assert_int_equal(ns_mlcp_same(NULL, 1), NS_E_NULL);
    assert_int_equal(ns_mlcp_alike(NULL, 1), NS_E_NULL);
    ns_mlcp_free(s);
}

/* y = lambda - 1, then promised to be the same: W is not looked at again, whatever it holds by then. */
static void a_promise_is_taken(void **state) {
    (void)state;
    double W = 1, q = -1, lambda, y;
    const double l = 0, u = INFINITY;
    ns_mode mode = NS_LOWER;
    const ns_mlcp p = {.m = 1, .W = &W, .q = &q, .l = &l, .u = &u};
    ns_mlcp_solver *s;
    assert_int_equal(ns_mlcp_create(1, &s), NS_OK);
    for (int k = 1; k <= 3; k++) {
        q = -k;
        assert_int_equal(ns_mlcp_solve(s, &p, &mode, &lambda, &y, NULL), NS_OK);
        assert_true(lambda == k);
        assert_int_equal(ns_mlcp_same(s, 1), NS_OK);
        W = NAN;
    }
    assert_int_equal(ns_mlcp_same(s, 0), NS_OK); /* taken back */
    assert_int_equal(ns_mlcp_solve(s, &p, &mode, &lambda, &y, NULL), NS_E_NUMBER);
    ns_mlcp_free(s);
}

static void systems_without_their_arrays(void **state) {
    (void)state;
    ns_fault fault;
    assert_int_equal(ns_system_check(NULL, &fault), NS_E_NULL);
    ns_system *s;
    assert_int_equal(ns_system_create(1, 1, 1, 1, &s), NS_OK);
    void *const arrays[] = {&s->M, &s->A, &s->B, &s->C, &s->D, &s->b,      &s->E,
                            &s->e, &s->F, &s->l, &s->u, &s->z, &s->command};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) {
        void *kept;
        memcpy(&kept, arrays[k], sizeof kept);
        memset(arrays[k], 0, sizeof kept);
        assert_int_equal(ns_system_check(s, &fault), NS_E_NULL);
        assert_int_equal(fault.status, NS_E_NULL);
        memcpy(arrays[k], &kept, sizeof kept);
    }
    int *const sizes[] = {&s->n, &s->m, &s->nz, &s->nc};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        *sizes[k] = -1;
        assert_int_equal(ns_system_check(s, &fault), NS_E_SIZE);
        *sizes[k] = 1;
    }
    assert_int_equal(ns_system_check(s, &fault), NS_OK);
    ns_system_free(s);
}

static void signals_that_are_none(void **state) {
    (void)state;
    const double t[] = {0, INFINITY}, v[] = {1, 2};
    ns_signal s = {.kind = NS_PULSE, .u.pulse = {.per = INFINITY, .pw = NAN}};
    assert_int_equal(ns_signal_check(&s), NS_E_NUMBER);
    s.u.pulse.pw = 1;
    s.u.pulse.cycles = -1;
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE);
    s.u.pulse.cycles = 0;
    assert_int_equal(ns_signal_check(&s), NS_OK);
    const ns_signal points = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = v, .repeat = NAN}};
    assert_int_equal(ns_signal_check(&points), NS_E_NUMBER);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marchers_are_not_made),
        cmocka_unit_test(marches_are_not_started),
        cmocka_unit_test(marches_do_not_go_on),
        cmocka_unit_test(theta_calls),
        cmocka_unit_test(a_value_beyond_double_is_named),
        cmocka_unit_test(methods_by_name),
        cmocka_unit_test(a_promise_is_taken),
        cmocka_unit_test(systems_without_their_arrays),
        cmocka_unit_test(signals_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
