/* tests/unit/newton/test_step.c - the Newton step on linear models: one iteration, and the results of (T6),
 * (T7).
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formula.h"
#include "linalg/dense.h"
#include "newton/newton_internal.h"
#include "systems.h"

enum { N = FORMULA_N, P = FORMULA_P, Z = FORMULA_Z };
static dice d;

static ns_system *random_system(unsigned number) {
    d = dice_make(77, number);
    ns_system *s = formula_system(&d);
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

/* Random x and lambda >= 0. */
static formula_point random_point(void) {
    formula_point p;
    for (int i = 0; i < N; i++)
        p.x[i] = dice_either(&d);
    for (int i = 0; i < P; i++)
        p.lambda[i] = fmax(0, dice_either(&d));
    return p;
}

/* The step of FirstOrderLinearR from t, literally; x_free may be NULL. */
static void by_formula(const ns_system *s, double t, const formula_scheme *o, formula_point *p,
                       double *x_free) {
    formula_inputs z;
    const int inside = o->relation == NS_RELATION_GAMMA;
    ns_system_inputs(s, t, NS_RIGHT, z.before);
    ns_system_inputs(s, t + o->h, NS_LEFT, z.end);
    ns_system_inputs(s, t + (inside ? o->gamma : 1) * o->h, NS_LEFT, z.relation);
    formula_step(s, o, p, &z, p, x_free);
}

static const double thetas[] = {0, 0.3, 0.5, 1}, gammas[] = {0.2, 0.5, 1};

static void linear_step_is_one_iteration(void **state) {
    (void)state;
    double worst = 0;
    for (int run = 0; run < 96; run++) {
        ns_system *s = random_system((unsigned)run);
        ns_model model;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        const double th = thetas[run % 4], ga = gammas[run / 4 % 3], h = 0.1;
        const ns_relation rel = run / 12 % 2 ? NS_RELATION_GAMMA : NS_RELATION_END;
        ns_newton *t = stepper(&model, th, ga, rel);
        const formula_scheme scheme = {h, th, ga, rel};
        formula_point p = random_point();
        assert_int_equal(ns_newton_start(t, 0, p.x, p.lambda), NS_OK);
        for (int k = 1; k <= 20; k++) {
            double x[N], lambda[P], y[P];
            by_formula(s, (k - 1) * h, &scheme, &p, NULL);
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
        ns_system *s = random_system(991u + (unsigned)run);
        ns_model model;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        const double th = thetas[run % 4], ga = gammas[run / 4], h = 0.1;
        ns_newton *t = stepper(&model, th, ga, NS_RELATION_END);
        const formula_scheme scheme = {h, th, ga, NS_RELATION_END};
        formula_point p = random_point();
        double x_free[N], z1[Z];
        assert_int_equal(ns_newton_start(t, 0, p.x, p.lambda), NS_OK);
        assert_int_equal(ns_newton_try(t, h), NS_OK);
        by_formula(s, 0, &scheme, &p, x_free);
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
    ns_linalg_matvec(s->n, s->n, s->M, x0, w0);
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
        ns_system *s = random_system(31u + (unsigned)k);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_step_is_one_iteration),
        cmocka_unit_test(the_chain_of_the_documents_holds),
        cmocka_unit_test(theta_0_and_gamma_below_1_by_hand),
        cmocka_unit_test(the_linear_engine_agrees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
