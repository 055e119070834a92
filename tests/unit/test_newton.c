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

#include "engine/newton.h"
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

/* The documents' coherence chain: y_p = C x_free + F z + e, x_p with lambda taken out, and the iterate of r
 * and y as they name it.  Read off the step's (P1) before it is solved: q of (P1) is y_p. */
static void the_chain_of_the_documents_holds(void **state) {
    (void)state;
    for (int run = 0; run < 12; run++) {
        seed = 991u + (unsigned)run;
        ns_system *s = random_system();
        ns_model model;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        const double th = thetas[run % 4], ga = gammas[run / 4], h = 0.1;
        ns_newton *t = stepper(&model, th, ga, NS_RELATION_END);
        point p = {.t = 0};
        double x_free[N], z1[Z];
        for (int i = 0; i < N; i++)
            p.x[i] = random_unit();
        for (int i = 0; i < P; i++)
            p.lambda[i] = fmax(0, random_unit());
        assert_int_equal(ns_newton_start(t, 0, p.x, p.lambda), NS_OK);
        assert_int_equal(ns_newton_try(t, h), NS_OK);
        by_formula(s, &p, h, th, ga, NS_RELATION_END, x_free);
        ns_system_inputs(s, h, NS_LEFT, z1);
        for (int i = 0; i < P; i++) {
            double y_p = s->e[i];
            for (int j = 0; j < N; j++)
                y_p += s->C[i + j * P] * x_free[j];
            for (int j = 0; j < Z; j++)
                y_p += s->F[i + j * P] * z1[j];
            assert_true(t->reduced && fabs(t->q[i] - y_p) < 1e-13 * (1 + fabs(y_p)));
        }
        ns_newton_free(t);
        ns_system_free(s);
    }
}

/* x' = -x + lambda, y = x - 1, from x = 1, lambda = 1, h = 1/2, by hand.
 *   theta = 0, gamma = 1/4: x+ = x - h x + h (lambda+ + 3 lambda) / 4, x+ = 1:  lambda+ = 4 - 3 lambda
 * so lambda = 1 stays, and what is put in wrong is tripled: from 1.25, 0.25, then 3.25, then lambda = 0 and
 *   x = 1/2 + (3 * 3.25) / 8 = 1.71875, y = 0.71875. */
static void theta_0_and_gamma_below_1_by_hand(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->B[0] = s->C[0] = 1;
    s->A[0] = s->e[0] = -1;
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = stepper(&model, 0, 0.25, NS_RELATION_END);
    const double x0 = 1, starts[] = {1, 1.25}, lambda[2][3] = {{1, 1, 1}, {0.25, 3.25, 0}};
    for (int k = 0; k < 2; k++) {
        double x, l, y, r;
        assert_int_equal(ns_newton_start(t, 0, &x0, &starts[k]), NS_OK);
        for (int i = 0; i < 3; i++) {
            assert_int_equal(ns_newton_try(t, 0.5), NS_OK);
            assert_int_equal(ns_newton_accept(t), NS_OK);
            assert_int_equal(ns_newton_read(t, NULL, &x, &l, &y, &r), NS_OK);
            assert_true(fabs(l - lambda[k][i]) < 1e-14 && fabs(r - l) == 0);
        }
        assert_true(fabs(x - (k ? 1.71875 : 1)) < 1e-14 && fabs(y - (k ? 0.71875 : 0)) < 1e-14);
    }
    ns_newton_free(t);
    ns_system_free(s);
}

/* ns_theta, which skips Newton, and Newton, side by side; x0 consistent up to one implicit step of h0. */
static double side_by_side(const ns_system *s, double theta, double gamma, const double *x0, double h,
                           int steps) {
    const ns_theta_options o = {theta, gamma, 0};
    double w0[8], x[8], lambda[8], y[8], z[8], worst = 0;
    ns_model model;
    ns_theta *a;
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    assert_int_equal(ns_theta_create(s, &o, &a, NULL), NS_OK);
    ns_newton *b = stepper(&model, theta, gamma, NS_RELATION_END);
    ns_matvec(s->n, s->n, s->M, x0, w0);
    assert_int_equal(ns_theta_start(a, w0, NULL), NS_OK);
    ns_system_inputs(s, 0, NS_RIGHT, z);
    assert_int_equal(ns_theta_try(a, h, z, 1, NS_RESOLVE), NS_OK); /* x and lambda that go together */
    assert_int_equal(ns_theta_accept(a), NS_OK);
    assert_int_equal(ns_theta_read(a, x, lambda, NULL), NS_OK);
    assert_int_equal(ns_newton_start(b, 0, x, lambda), NS_OK);
    for (int k = 1; k <= steps; k++) {
        double xb[8], lb[8], t;
        assert_int_equal(ns_newton_try(b, h), NS_OK);
        assert_int_equal(ns_newton_accept(b), NS_OK);
        assert_int_equal(ns_newton_read(b, &t, xb, lb, NULL, NULL), NS_OK);
        ns_system_inputs(s, t, NS_LEFT, z);
        assert_int_equal(ns_theta_try(a, h, z, 0, NS_RESOLVE), NS_OK);
        assert_int_equal(ns_theta_accept(a), NS_OK);
        assert_int_equal(ns_theta_read(a, x, lambda, y), NS_OK);
        assert_int_equal(ns_newton_counts_of(b)->iterations, k);
        for (int i = 0; i < s->n; i++)
            worst = fmax(worst, fabs(x[i] - xb[i]) / (1 + fabs(x[i])));
        for (int i = 0; i < s->m; i++)
            worst = fmax(worst, fabs(lambda[i] - lb[i]) / (1 + fabs(lambda[i])));
    }
    const ns_counts *work = ns_theta_counts(a); /* the linear engine: nothing a step but the product */
    assert_true(work->problems <= 2 * work->events + 1);
    ns_newton_free(b);
    ns_theta_free(a);
    return worst;
}

static void the_linear_engine_agrees(void **state) {
    (void)state;
    double regular = 0, bridge = 0, rectifier = 0;
    for (int k = 0; k < 12; k++) {
        const double th = thetas[k % 4], ga = gammas[k / 4], x0[4] = {0.5, -0.3, 0.8, 0.1},
                     v0[3] = {10, 0, 0};
        seed = 31u + (unsigned)k;
        ns_system *s = random_system();
        regular = fmax(regular, side_by_side(s, th, ga, x0, 0.05, 60));
        ns_system_free(s);
        s = system_lc_bridge();
        if (ga > 0.4 && th > 0.4) /* gamma below 1/2 rings without damping: nothing to compare */
            bridge = fmax(bridge, side_by_side(s, th, ga, v0, 1e-6, 1000));
        ns_system_free(s);
        s = system_half_wave(10, 50, 100); /* W is singular: v2 hangs on the diode and R alone */
        rectifier = fmax(rectifier, side_by_side(s, th, ga, v0, 1e-4, 400));
        ns_system_free(s);
    }
    print_message("regular M %.1e, bridge %.1e, rectifier %.1e\n", regular, bridge, rectifier);
    assert_true(regular < 1e-12 && rectifier < 1e-12); /* 60 steps; no memory */
    assert_true(bridge < 1e-10);                       /* 1000 steps of some 10 eps each, 10 V */
}

/* The literal reduced form and the unreduced problem give one answer. */
static void reduced_and_whole_agree(void **state) {
    (void)state;
    for (int run = 0; run < 40; run++) {
        double x[N], lambda[P], y[P], x0[N];
        seed = 5u + (unsigned)run;
        ns_system *s = random_system();
        ns_model model;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        ns_newton *t = stepper(&model, 0.7, 0.6, run % 2 ? NS_RELATION_GAMMA : NS_RELATION_END);
        for (int i = 0; i < N; i++)
            x0[i] = 3 * random_unit();
        assert_int_equal(ns_newton_start(t, 0, x0, NULL), NS_OK);
        assert_int_equal(ns_newton_try(t, 0.2), NS_OK);
        assert_true(t->reduced);
        memcpy(x, t->at.x, sizeof x);
        memcpy(lambda, t->at.lambda, sizeof lambda);
        memcpy(y, t->at.y, sizeof y);
        for (int i = 0; i < N; i++)
            t->at.x[i] = x0[i];
        for (int i = 0; i < P; i++)
            t->at.lambda[i] = t->at.y[i] = 0;
        t->reduced = 0;
        assert_int_equal(ns_newton_values(t, &t->at), NS_OK);
        ns_newton_residuals(t, &t->at);
        assert_int_equal(ns_newton_solve(t, 1, t->next_mode), NS_OK);
        for (int i = 0; i < N; i++)
            assert_true(fabs(t->next.x[i] - x[i]) < 1e-13 * (1 + fabs(x[i])));
        for (int i = 0; i < P; i++) {
            assert_true(fabs(t->next.lambda[i] - lambda[i]) < 1e-13 * (1 + lambda[i]));
            assert_true(fabs(t->next.y[i] - y[i]) < 1e-13 * (1 + y[i]));
        }
        ns_newton_free(t);
        ns_system_free(s);
    }
}

/* A sine source at v1, diodes v1 -> v2 -> v3, R at v3: nothing but diodes at v2, so that its row of A, and
 * with it W, is zero.  v3 is the positive half of the sine; while both diodes block, v2 is anywhere between.
 */
static void a_singular_W_is_solved_whole(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    ns_signal sine = {.kind = NS_SIN};
    const double R = 100, x0[4] = {0};
    sine.u.sin.va = 10;
    sine.u.sin.freq = 50;
    assert_int_equal(ns_system_create(4, 2, 1, 0, &s), NS_OK); /* x = v1, v2, v3, current of the source */
    assert_int_equal(ns_system_set_input(s, 0, &sine), NS_OK);
    s->A[0 + 3 * 4] = s->B[0] = -1; /* 0 = -i - lambda1 */
    s->B[1] = 1;
    s->B[1 + 4] = -1; /* 0 = lambda1 - lambda2 */
    s->A[2 + 2 * 4] = -1 / R;
    s->B[2 + 4] = 1; /* 0 = lambda2 - v3 / R */
    s->A[3] = -1;
    s->E[3] = 1; /* 0 = z - v1 */
    s->C[0] = s->C[1 + 2] = -1;
    s->C[0 + 2] = s->C[1 + 4] = 1; /* y1 = v2 - v1, y2 = v3 - v2 */
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = stepper(&model, 1, 1, NS_RELATION_END);
    assert_int_equal(ns_newton_start(t, 0, x0, NULL), NS_OK);
    for (int k = 1; k <= 100; k++) {
        double x[4], lambda[2], now;
        assert_int_equal(ns_newton_try(t, 0.37e-3), NS_OK);
        assert_false(t->reduced);
        assert_int_equal(ns_newton_accept(t), NS_OK);
        assert_int_equal(ns_newton_read(t, &now, x, lambda, NULL, NULL), NS_OK);
        const double v = 10 * sin(2 * acos(-1) * 50 * now);
        assert_true(fabs(x[2] - fmax(v, 0)) < 1e-12 * 10);
        assert_true(fabs(lambda[0] - fmax(v, 0) / R) < 1e-12 && fabs(lambda[1] - lambda[0]) < 1e-14);
        assert_true(x[1] >= fmin(v, 0) - 1e-12 && x[1] <= fmax(v, 0) + 1e-12);
    }
    assert_int_equal(ns_newton_counts_of(t)->iterations, 100);
    ns_newton_free(t);
    ns_system_free(s);
}

/* v' = i, 0 = -v - i, with (T8) at theta = gamma = 1/2: the algebraic row holds half way, so v_g = (v+ + v) /
 * 2 = -i_g and v+ = v (1 - h/2) / (1 + h/2), of second order.  A pair that stays open rides along. */
static void algebraic_rows_hold_where_the_relation_is(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    const double h = 0.1;
    double x[2] = {1, -1}, before[2], factor = 1;
    assert_int_equal(ns_system_create(2, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->A[0 + 2] = s->D[0] = s->e[0] = s->B[0] = 1;
    s->A[1] = s->A[1 + 2] = -1;
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = stepper(&model, 0.5, 0.5, NS_RELATION_GAMMA);
    assert_int_equal(ns_newton_start(t, 0, x, NULL), NS_OK);
    for (int k = 0; k < 20; k++) {
        memcpy(before, x, sizeof x);
        assert_int_equal(ns_newton_try(t, h), NS_OK);
        assert_int_equal(ns_newton_accept(t), NS_OK);
        assert_int_equal(ns_newton_read(t, NULL, x, NULL, NULL, NULL), NS_OK);
        factor *= (1 - h / 2) / (1 + h / 2);
        assert_true(fabs(x[0] - factor) < 1e-14);
        assert_true(fabs(x[0] + before[0] + x[1] + before[1]) < 1e-14);
    }
    ns_newton_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_step_is_one_iteration),
        cmocka_unit_test(the_chain_of_the_documents_holds),
        cmocka_unit_test(theta_0_and_gamma_below_1_by_hand),
        cmocka_unit_test(the_linear_engine_agrees),
        cmocka_unit_test(reduced_and_whole_agree),
        cmocka_unit_test(algebraic_rows_hold_where_the_relation_is),
        cmocka_unit_test(a_singular_W_is_solved_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
