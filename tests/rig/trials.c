/* tests/rig/trials.c - one method of (P1) tried on problems whose answers are known. */
#include "trials.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define INF INFINITY
enum { CLASS_MAX = 200, ORACLE_MAX = 8 };

void trial_complementary(trial *t) {
    for (int i = 0; i < t->m; i++) {
        t->l[i] = 0;
        t->u[i] = INF;
        t->mode[i] = NS_LOWER;
    }
}

int trial_run(trial *t, ns_mlcp_method method) {
    double W[TRIAL_MAX * TRIAL_MAX];
    ns_mlcp p = {.m = t->m, .W = W, .q = t->q, .l = t->l, .u = t->u};
    ns_mlcp_solver *s;
    for (int i = 0; i < t->m; i++)
        for (int j = 0; j < t->m; j++)
            W[i + j * t->m] = t->rows[i * t->m + j];
    assert_int_equal(ns_mlcp_create(t->m, &s), NS_OK);
    assert_int_equal(ns_mlcp_use(s, method), NS_OK);
    int status = ns_mlcp_solve(s, &p, t->mode, t->lambda, t->y, &t->info);
    t->residual = status == NS_OK ? ns_mlcp_residual(&p, t->lambda, NULL) : NAN;
    if (status == NS_OK)
        assert_true(t->residual <= 1e-10); /* what the driver accepts */
    if (status == NS_E_INFEASIBLE && t->info.certified)
        assert_true(ns_mlcp_certify(&p, ns_mlcp_certificate(s)) > 0);
    ns_mlcp_free(s);
    return status;
}

void trial_close(double got, double expected) {
    if (!(fabs(got - expected) <= 1e-13 * fmax(1.0, fabs(expected))))
        fail_msg("%.17g is not %.17g", got, expected);
}

void trial_pairs(const trial_pair *c, int count, ns_mlcp_method method) {
    for (int k = 0; k < count; k++)
        for (int start = -1; start <= 1; start++) {
            trial t = {.m = 1, .rows = {c[k].w}, .q = {c[k].q}, .l = {c[k].l}, .u = {c[k].u}};
            t.mode[0] = (ns_mode)start;
            assert_int_equal(trial_run(&t, method), NS_OK);
            assert_true(fabs(t.lambda[0] - c[k].lambda) <= 1e-15 * fabs(c[k].lambda));
            assert_true(fabs(t.y[0] - c[k].y) <= 1e-15 * fabs(c[k].y));
            assert_int_equal(t.mode[0], c[k].mode);
        }
}

static void one_pair(ns_mlcp_method method) {
    static const trial_pair c[] = {
        {2, 3, 0, INF, 0, 3, NS_LOWER},          /* blocks */
        {2, -3, 0, INF, 1.5, 0, NS_INSIDE},      /* conducts */
        {2, -3, -INF, INF, 1.5, 0, NS_INSIDE},   /* equality */
        {-2, -3, -INF, INF, -1.5, 0, NS_INSIDE}, /* of either sign */
        {2, 3, 4, 4, 4, 11, NS_LOWER},           /* given */
        {2, 3, -1, 1, -1, 1, NS_LOWER},          /* relay */
        {2, 1, -1, 1, -0.5, 0, NS_INSIDE},
        {2, -3, -1, 1, 1, -1, NS_UPPER},
        {2, 3, -INF, 0, -1.5, 0, NS_INSIDE}, /* the other way round */
        {2, -3, -INF, 0, 0, -3, NS_UPPER},
        {1, -1e-30, 0, INF, 1e-30, 0, NS_INSIDE}, /* no absolute tolerance */
        {1e-12, -1, 0, INF, 1e12, 0, NS_INSIDE},
    };
    trial_pairs(c, (int)(sizeof c / sizeof *c), method);
}

/* Triangular, so that it is solved from the top: equality 2 a + 4 = 0 -> a = -2; given b = 3; box c in
 * [-1,1]: y = c + a + b - 4 = c - 3 -> c = 1, y = -2; pair d: y = d - c - 1 -> d = 2; pair e: y = e + d -> e
 * = 0, y = 2. */
static void all_laws_together(ns_mlcp_method method) {
    for (int start = -1; start <= 1; start++) {
        trial t = {.m = 5,
                   .rows = {2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, -1, 1, 0, 0, 0, 0, 1, 1},
                   .q = {4, 0, -4, -1, 0},
                   .l = {-INF, 3, -1, 0, 0},
                   .u = {INF, 3, 1, INF, INF}};
        const double lambda[5] = {-2, 3, 1, 2, 0}, y[5] = {0, 3, -2, 0, 2};
        memset(t.mode, start, sizeof t.mode);
        assert_int_equal(trial_run(&t, method), NS_OK);
        for (int i = 0; i < 5; i++) {
            trial_close(t.lambda[i], lambda[i]);
            trial_close(t.y[i], y[i]);
        }
    }
}

void trial_closed_forms(ns_mlcp_method method) {
    one_pair(method);
    all_laws_together(method);
    trial none = {.m = 0};
    assert_int_equal(trial_run(&none, method), NS_OK);
}

static ns_mode mode[CLASS_MAX];
static double lambda[CLASS_MAX], y[CLASS_MAX];

static int solve(ns_mlcp_solver *z, const sample *s) {
    ns_mlcp p = sample_problem(s);
    memset(mode, NS_LOWER, (size_t)s->m);
    int status = ns_mlcp_solve(z, &p, mode, lambda, y, NULL);
    if (status == NS_E_INFEASIBLE)
        fail_msg("%s, m = %d: has a solution", s->kind, s->m);
    if (status != NS_OK)
        return status;
    assert_true(ns_mlcp_residual(&p, lambda, NULL) <= 1e-10);
    for (int i = 0; i < s->m; i++)
        assert_true(lambda[i] >= s->l[i] && lambda[i] <= s->u[i]);
    return NS_OK;
}

int trial_class(ns_mlcp_method method, int class, int n, int max) {
    sample s;
    ns_mlcp_solver *z;
    int solved = 0;
    assert_int_equal(sample_create(CLASS_MAX, &s), 0);
    assert_int_equal(ns_mlcp_create(CLASS_MAX, &z), NS_OK);
    assert_int_equal(ns_mlcp_use(z, method), NS_OK);
    for (int k = 0; k < n; k++) {
        double condition;
        generate(&s, class, (unsigned long long)k, max);
        if (solve(z, &s) != NS_OK)
            continue;
        solved++;
        if (s.unique) { /* 1e-13: some hundred roundings, each carried on by the condition */
            double error = sample_error(&s, lambda, mode, &condition);
            assert_true(error <= 1e-13 * condition);
        }
    }
    ns_mlcp_free(z);
    sample_free(&s);
    return solved;
}

void trial_agrees_with_the_oracle(ns_mlcp_method method, int class, int n) {
    sample s;
    ns_mlcp_solver *z;
    double condition;
    int both = 0;
    assert_int_equal(sample_create(CLASS_MAX, &s), 0);
    assert_int_equal(ns_mlcp_create(CLASS_MAX, &z), NS_OK);
    for (int k = 0; k < n; k++) {
        generate(&s, class, (unsigned long long)k + 5000, ORACLE_MAX);
        assert_int_equal(ns_mlcp_use(z, NS_MLCP_ENUMERATE), NS_OK);
        if (!s.unique || solve(z, &s) != NS_OK)
            continue;
        memcpy(s.lambda, lambda, (size_t)s.m * sizeof *lambda);
        assert_int_equal(ns_mlcp_use(z, method), NS_OK);
        if (solve(z, &s) != NS_OK)
            continue;
        double error = sample_error(&s, lambda, mode, &condition);
        assert_true(error <= 1e-13 * condition); /* as above */
        both++;
    }
    assert_true(both >= n / 8); /* not every problem of a class has only one answer, or suits the method */
    ns_mlcp_free(z);
    sample_free(&s);
}

void trial_infeasible(ns_mlcp_method method, int must_say_so) {
    static const trial none[] = {
        /* y = 0 lambda - 1 >= 0 */
        {.m = 1, .rows = {0}, .q = {-1}, .l = {0}, .u = {INF}},
        /* y = -lambda - 1 >= 0, lambda >= 0 */
        {.m = 1, .rows = {-1}, .q = {-1}, .l = {0}, .u = {INF}},
        /* the equality 0 lambda + 1 = 0 */
        {.m = 1, .rows = {0}, .q = {1}, .l = {-INF}, .u = {INF}},
        /* a + b = 1 and a + b = 2 */
        {.m = 2, .rows = {1, 1, 1, 1}, .q = {-1, -2}, .l = {-INF, -INF}, .u = {INF, INF}},
        /* 0.1 a + 0.2 b = 1 and 0.3 a + 0.6 b = 2, singular but for rounding */
        {.m = 2, .rows = {0.1, 0.2, 0.3, 0.6}, .q = {-1, -2}, .l = {-INF, -INF}, .u = {INF, INF}},
        /* the equality asks b = 5 of a box [0,1] */
        {.m = 2, .rows = {0, 1, 0, 1}, .q = {-5, 0}, .l = {-INF, 0}, .u = {INF, 1}},
        /* feasible (l2 = 1), yet y2 = l1 + 1 >= 1 asks l2 = 0, which makes y1 = l2 - 1 = -1 */
        {.m = 2, .rows = {0, 1, 1, 0}, .q = {-1, 1}, .l = {0, 0}, .u = {INF, INF}},
    };
    for (size_t k = 0; k < sizeof none / sizeof *none; k++)
        for (int start = -1; start <= 0; start++) {
            trial t = none[k];
            memset(t.mode, start, sizeof t.mode);
            int status = trial_run(&t, method);
            assert_int_not_equal(status, NS_OK);
            if (must_say_so)
                assert_int_equal(status, NS_E_INFEASIBLE);
        }
}
