/* tests/unit/test_newton.c - the Newton step on linear models: one iteration, and the results of (T6), (T7).
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "linalg/dense.h"
#include "systems.h"

static unsigned seed;
static double random_unit(void) { /* in (-1, 1); Numerical Recipes' quick generator */
    seed = seed * 1664525u + 1013904223u;
    return (double)seed / 2147483648.0 - 1;
}

enum { N = 4, P = 3, Z = 2 };

/* Regular M, W_mlcp a P matrix: C = B', D = I. */
static ns_system *random_system(void) {
    ns_system *s;
    assert_int_equal(ns_system_create(N, P, Z, 0, &s), NS_OK);
    double *const parts[] = {s->A, s->B, s->b, s->E, s->e, s->F};
    const int sizes[] = {N * N, N * P, N, N * Z, P, P * Z};
    for (int k = 0; k < 6; k++)
        for (int i = 0; i < sizes[k]; i++)
            parts[k][i] = random_unit();
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            s->M[i + j * N] = 0.2 * random_unit() + (i == j ? 1 : 0);
    for (int i = 0; i < P; i++) {
        s->D[i + i * P] = 1;
        for (int j = 0; j < N; j++)
            s->C[i + j * P] = s->B[j + i * N];
    }
    for (int k = 0; k < Z; k++) {
        ns_signal sine = {.kind = NS_SIN};
        sine.u.sin.va = 2;
        sine.u.sin.freq = 0.3 + k;
        assert_int_equal(ns_system_set_input(s, k, &sine), NS_OK);
    }
    return s;
}

static ns_newton *stepper(const ns_model *model, double theta, double gamma, ns_relation relation) {
    const ns_newton_options o = {.theta = theta, .gamma = gamma, .relation = relation};
    ns_newton *s;
    assert_int_equal(ns_newton_create(model, &o, &s, NULL), NS_OK);
    return s;
}

static void solve(const double *W, int columns, double *b) {
    ns_lu *f;
    assert_int_equal(ns_lu_create(N, &f), NS_OK);
    assert_int_equal(ns_lu_factor(f, N, W, NULL, NULL), NS_OK);
    ns_lu_solve(f, columns, b);
    ns_lu_free(f);
}

/* lambda of y = Wm lambda + q, 0 <= y _|_ lambda >= 0: projected Gauss-Seidel to rounding. */
static void complementary(const double *Wm, const double *q, double *lambda) {
    for (int i = 0; i < P; i++)
        lambda[i] = 0;
    for (int sweep = 0; sweep < 3000; sweep++)
        for (int i = 0; i < P; i++) {
            double y = q[i];
            for (int c = 0; c < P; c++)
                y += Wm[i + c * P] * lambda[c];
            lambda[i] = fmax(0, lambda[i] - y / Wm[i + i * P]);
        }
}

typedef struct point {
    double t, x[N], lambda[P];
} point;

/* The step of FirstOrderLinearR from k, literally; x_free may be NULL. */
static point by_formula(const ns_system *s, const point *k, double h, double th, double ga, ns_relation rel,
                        double *x_free) {
    point p = {.t = k->t + h};
    const int inside = rel == NS_RELATION_GAMMA;
    const double hr = inside ? h : h * ga, cx = inside ? ga : 1;
    double W[N * N], V[N * P], v[N], q[P], Wm[P * P], z0[Z], z1[Z], zr[Z];
    ns_system_inputs(s, k->t, NS_RIGHT, z0);
    ns_system_inputs(s, p.t, NS_LEFT, z1);
    ns_system_inputs(s, k->t + cx * h, NS_LEFT, zr);
    for (int i = 0; i < N * N; i++)
        W[i] = s->M[i] - h * th * s->A[i]; /* (T1) */
    for (int i = 0; i < N; i++) {
        double m = 0, a = 0, r = 0, b0 = s->b[i], b1 = s->b[i];
        for (int j = 0; j < N; j++) {
            m += s->M[i + j * N] * k->x[j];
            a += s->A[i + j * N] * k->x[j];
        }
        for (int j = 0; j < P; j++)
            r += s->B[i + j * N] * k->lambda[j];
        for (int j = 0; j < Z; j++) {
            b0 += s->E[i + j * N] * z0[j];
            b1 += s->E[i + j * N] * z1[j];
        }
        v[i] =
            m + h * (1 - th) * a + h * (th * b1 + (1 - th) * b0) + (inside ? 0 : h * (1 - ga) * r); /* (T6) */
    }
    solve(W, 1, v);
    if (x_free)
        memcpy(x_free, v, sizeof v);
    memcpy(V, s->B, sizeof V);
    solve(W, P, V);
    for (int i = 0; i < P; i++) {
        q[i] = s->e[i];
        for (int j = 0; j < N; j++)
            q[i] += s->C[i + j * P] * (cx * v[j] + (1 - cx) * k->x[j]);
        for (int j = 0; j < Z; j++)
            q[i] += s->F[i + j * P] * zr[j]; /* (T7), (T8) */
        for (int c = 0; c < P; c++) {
            Wm[i + c * P] = s->D[i + c * P];
            for (int j = 0; j < N; j++)
                Wm[i + c * P] += cx * hr * s->C[i + j * P] * V[j + c * N]; /* (P1) */
        }
    }
    complementary(Wm, q, p.lambda);
    for (int i = 0; i < N; i++) {
        p.x[i] = v[i];
        for (int c = 0; c < P; c++)
            p.x[i] += hr * V[i + c * N] * p.lambda[c];
    }
    return p;
}

static const double thetas[] = {0, 0.3, 0.5, 1}, gammas[] = {0.2, 0.5, 1};

static void linear_step_is_one_iteration(void **state) {
    (void)state;
    double worst = 0;
    for (int run = 0; run < 96; run++) {
        seed = 77u + (unsigned)run;
        ns_system *s = random_system();
        ns_model model;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        const double th = thetas[run % 4], ga = gammas[run / 4 % 3], h = 0.1;
        const ns_relation rel = run / 12 % 2 ? NS_RELATION_GAMMA : NS_RELATION_END;
        ns_newton *t = stepper(&model, th, ga, rel);
        point p = {.t = 0};
        for (int i = 0; i < N; i++)
            p.x[i] = random_unit();
        for (int i = 0; i < P; i++)
            p.lambda[i] = fmax(0, random_unit());
        assert_int_equal(ns_newton_start(t, 0, p.x, p.lambda), NS_OK);
        for (int k = 1; k <= 20; k++) {
            double x[N], lambda[P], y[P];
            p = by_formula(s, &p, h, th, ga, rel, NULL);
            assert_int_equal(ns_newton_try(t, h), NS_OK);
            assert_int_equal(ns_newton_accept(t), NS_OK);
            assert_int_equal(ns_newton_counts_of(t)->iterations, k);
            assert_int_equal(ns_newton_counts_of(t)->problems, k);
            assert_int_equal(ns_newton_read(t, NULL, x, lambda, y, NULL), NS_OK);
            for (int i = 0; i < N; i++)
                worst = fmax(worst, fabs(x[i] - p.x[i]) / (1 + fabs(p.x[i])));
            for (int i = 0; i < P; i++) {
                worst = fmax(worst, fabs(lambda[i] - p.lambda[i]) / (1 + fabs(p.lambda[i])));
                assert_true(lambda[i] >= 0 && y[i] >= 0 && lambda[i] * y[i] == 0); /* (S4) to the bit */
            }
        }
        ns_newton_free(t);
        ns_system_free(s);
    }
    print_message("against (T6), (T7): %.1e\n", worst);
    assert_true(worst < 1e-12); /* 20 steps of some ten operations each, growth of the unstable ones */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_step_is_one_iteration),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
