/* tests/unit/newton/test_linearised_lcp.c - the linearised problem of one Newton iteration: reduced to the
 * pairs or whole, in part or in full, K x in g or in f.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "formula.h"
#include "newton/newton_internal.h"

enum { N = FORMULA_N, P = FORMULA_P };

static ns_newton *stepper(const ns_model *model, double theta, double gamma, ns_relation relation) {
    const ns_newton_options o = {.theta = theta, .gamma = gamma, .relation = relation};
    ns_newton *s;
    assert_int_equal(ns_newton_create(model, &o, &s, NULL), NS_OK);
    return s;
}

static void step(ns_newton *t, double h) {
    assert_int_equal(ns_newton_try(t, h), NS_OK);
    assert_int_equal(ns_newton_accept(t), NS_OK);
}

/* As the loop begins, at (x_k, lambda_k), with y = 0. */
static void linearise_again(ns_newton *t, const double *x, int reduced) {
    memcpy(t->at.x, x, sizeof(double) * N);
    for (int i = 0; i < P; i++)
        t->at.lambda[i] = t->at.y[i] = 0;
    t->reduced = reduced;
    assert_int_equal(ns_newton_values(t, &t->at), NS_OK);
    ns_newton_residuals(t, &t->at);
}

/* The sizes of the residuals' terms, literally: of (T2) less g, of (S3); x_k and the past count too. */
static void sizes_are_those_of_all_terms(void **state) {
    (void)state;
    for (int run = 0; run < 40; run++) {
        double x[N], x0[N];
        dice d = dice_make(7, (unsigned)run);
        ns_system *s = formula_system(&d);
        ns_model model;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        ns_newton *t = stepper(&model, 0.7, 0.6, NS_RELATION_END);
        for (int i = 0; i < N; i++) {
            x0[i] = 30 * dice_either(&d);
            x[i] = 0.1 * dice_either(&d);
        }
        assert_int_equal(ns_newton_start(t, 0, x0, NULL), NS_OK);
        assert_int_equal(ns_newton_try(t, 0.2), NS_OK);
        linearise_again(t, x, 1);
        ns_newton_form(t);
        ns_newton_sizes(t, &t->at, 0, 0);
        for (int i = 0; i < N; i++) {
            double sum = t->ht * fabs(t->at.f[i]) + t->hg * fabs(t->at.g[i]) + fabs(t->past[i]);
            for (int j = 0; j < N; j++)
                sum += fabs(t->M[i + j * N] * x0[j]) + fabs(t->G[i + j * (N + P)] * x[j]);
            assert_true(fabs(t->size[i] - sum) <= 1e-14 * sum);
        }
        for (int i = 0; i < P; i++) {
            double sum = fabs(t->at.y[i]) + fabs(t->at.h[i]);
            for (int j = 0; j < N; j++)
                sum += fabs(s->C[i + j * P] * x[j]);
            assert_true(fabs(t->size[N + i] - sum) <= 1e-14 * sum);
        }
        ns_newton_free(t);
        ns_system_free(s);
    }
}

/* The literal reduced form and the unreduced problem give one answer, and of either a share leaves exactly
 * the rest of the residuals, for all is linear: R+ = (1 - share) R, Ry+ = (1 - share) Ry. */
static void reduced_and_whole_agree(void **state) {
    (void)state;
    for (int run = 0; run < 40; run++) {
        double x[N], lambda[P], y[P], x0[N];
        dice d = dice_make(5, (unsigned)run);
        ns_system *s = formula_system(&d);
        ns_model model;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        ns_newton *t = stepper(&model, 0.7, 0.6, run % 2 ? NS_RELATION_GAMMA : NS_RELATION_END);
        for (int i = 0; i < N; i++)
            x0[i] = 3 * dice_either(&d);
        assert_int_equal(ns_newton_start(t, 0, x0, NULL), NS_OK);
        assert_int_equal(ns_newton_try(t, 0.2), NS_OK);
        assert_true(t->reduced);
        memcpy(x, t->at.x, sizeof x);
        memcpy(lambda, t->at.lambda, sizeof lambda);
        memcpy(y, t->at.y, sizeof y);
        for (int k = 0; k < 6; k++) {
            const double share = k / 2 == 0 ? 1 : k / 2 == 1 ? 0.5 : 0.125;
            linearise_again(t, x0, k % 2);
            assert_int_equal(ns_newton_solve(t, share, t->next_mode), NS_OK);
            assert_int_equal(ns_newton_values(t, &t->next), NS_OK);
            ns_newton_residuals(t, &t->next);
            for (int i = 0; i < N; i++)
                assert_true(fabs(t->next.R[i] - (1 - share) * t->at.R[i]) < 1e-13 * (1 + fabs(t->next.x[i])));
            for (int i = 0; i < P; i++) {
                assert_true(fabs(t->next.Ry[i] - (1 - share) * t->at.Ry[i]) <
                            1e-13 * (1 + fabs(t->next.h[i])));
                assert_true(t->next.y[i] >= 0 && t->next.lambda[i] >= 0); /* (S4) */
                assert_true(t->next.y[i] * t->next.lambda[i] == 0);
            }
            for (int i = 0; i < N && share == 1; i++)
                assert_true(fabs(t->next.x[i] - x[i]) < 1e-13 * (1 + fabs(x[i])));
            for (int i = 0; i < P && share == 1; i++) {
                assert_true(fabs(t->next.lambda[i] - lambda[i]) < 1e-13 * (1 + lambda[i]));
                assert_true(fabs(t->next.y[i] - y[i]) < 1e-13 * (1 + y[i]));
            }
        }
        ns_newton_free(t);
        ns_system_free(s);
    }
}

/* --- K --- */

/* A linear model, part of whose f stands in g: f - K x, g + K x. */
typedef struct moved {
    const ns_model *from;
    double K[N * N];
} moved;

static void add_K(const moved *k, double factor, const double *x, double *out) {
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            out[i] += factor * k->K[i + j * N] * x[j];
}

static int moved_f(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    const int status = k->from->f(at, k->from->data, out);
    add_K(k, -1, at->x, out);
    return status;
}

static int moved_A(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    const int status = k->from->A(at, k->from->data, out);
    for (int i = 0; i < N * N; i++)
        out[i] -= k->K[i];
    return status;
}

static int moved_g(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    const int status = k->from->g(at, k->from->data, out);
    add_K(k, 1, at->x, out);
    return status;
}

static int moved_K(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    (void)at;
    memcpy(out, k->K, sizeof k->K);
    return 0;
}

static int moved_B(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    return k->from->B(at, k->from->data, out);
}

static int moved_h(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    return k->from->h(at, k->from->data, out);
}

static int moved_C(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    return k->from->C(at, k->from->data, out);
}

static int moved_D(const ns_point *at, void *data, double *out) {
    const moved *k = data;
    return k->from->D(at, k->from->data, out);
}

/* With theta = gamma both take f and g with the same weights, so it does not matter which of them K x stands
 * in: one answer.  And one iteration whatever theta and gamma are, for W holds both; in every third system a
 * row of M is zero, so that K stands in an algebraic row too. */
static void K_x_may_stand_in_g(void **state) {
    (void)state;
    static const double values[] = {1, 0.5, 0.8, 0.3};
    double worst = 0;
    for (int run = 0; run < 96; run++) {
        dice d = dice_make(6, (unsigned)run);
        ns_system *s = formula_system(&d);
        ns_model plain, other;
        moved k = {.from = &plain};
        double x[N], xk[N], lambda[P], lk[P], x0[N];
        for (int i = 0; i < N; i++) {
            x0[i] = 3 * dice_either(&d);
            for (int j = 0; j < N; j++)
                k.K[i + j * N] = 2 * dice_either(&d);
            s->M[N - 1 + i * N] *= run % 3 > 0;
        }
        s->A[N * N - 1] -= run % 3 > 0 ? 0 : 4; /* solvable for the last x */
        assert_int_equal(ns_model_of_system(s, &plain), NS_OK);
        other = plain;
        other.data = &k;
        other.f = moved_f;
        other.A = moved_A;
        other.g = moved_g;
        other.K = moved_K;
        other.B = moved_B;
        other.h = moved_h;
        other.C = moved_C;
        other.D = moved_D;
        const ns_relation relation = run / 3 % 2 ? NS_RELATION_GAMMA : NS_RELATION_END;
        const double theta = values[run / 6 % 4], gamma = values[run / 24 % 4];
        ns_newton *a = stepper(&plain, theta, gamma, relation), *b = stepper(&other, theta, gamma, relation);
        assert_int_equal(ns_newton_start(a, 0, x0, NULL), NS_OK);
        assert_int_equal(ns_newton_start(b, 0, x0, NULL), NS_OK);
        for (int n = 1; n <= 5; n++) {
            step(a, 0.1);
            step(b, 0.1);
            assert_int_equal(ns_newton_counts_of(b)->iterations, n);
            assert_int_equal(ns_newton_read(a, NULL, x, lambda, NULL, NULL), NS_OK);
            assert_int_equal(ns_newton_read(b, NULL, xk, lk, NULL, NULL), NS_OK);
            for (int i = 0; i < N && theta == gamma; i++)
                worst = fmax(worst, fabs(x[i] - xk[i]) / (1 + fabs(x[i])));
            for (int i = 0; i < P && theta == gamma; i++)
                worst = fmax(worst, fabs(lambda[i] - lk[i]) / (1 + fabs(lambda[i])));
        }
        ns_newton_free(a);
        ns_newton_free(b);
        ns_system_free(s);
    }
    print_message("K x in g or in f: %.1e apart\n", worst);
    assert_true(worst < 1e-12); /* 5 steps of some ten eps, conditions of some hundred */
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
        cmocka_unit_test(sizes_are_those_of_all_terms),
        cmocka_unit_test(reduced_and_whole_agree),
        cmocka_unit_test(K_x_may_stand_in_g),
        cmocka_unit_test(a_singular_W_is_solved_whole),
        cmocka_unit_test(algebraic_rows_hold_where_the_relation_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
