/* tests/unit/reinit/test_impulse.c - the impulse problem of a few unknowns: modes, inputs, what is refused.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reinit/order_expansion.h"

/* x' = lambda >= 0, 0 <= y = x - z_0 + 2 z_1: with z = (5, 1) x jumps from 0 to 3 by an impulse of 3, with z
 * = (5, 4) y is 3 and nothing jumps. */
static void inputs_of_a_law(void **state) {
    const ns_theta_options o = {1, 1, 0};
    ns_system *s;
    ns_theta *t;
    const double w0 = 0;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 2, 0, &s), NS_OK);
    s->M[0] = s->B[0] = s->C[0] = 1;
    s->F[0] = -1;
    s->F[1] = 2;
    s->u[0] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    for (int jumps = 0; jumps < 2; jumps++) {
        const double z[] = {5, jumps ? 1 : 4};
        double w, x, lambda, y, X, Lambda, Y, h;
        ns_mode mode;
        const ns_impulse out = {.w = &w,
                                .x = &x,
                                .lambda = &lambda,
                                .y = &y,
                                .X = &X,
                                .Lambda = &Lambda,
                                .Y = &Y,
                                .mode = &mode,
                                .h = &h};
        assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
        assert_int_equal(ns_theta_impulse(t, z, NULL, &out), NS_OK);
        assert_true(fabs(x - (jumps ? 3 : 0)) < 1e-14 && fabs(Lambda - (jumps ? 3 : 0)) < 1e-14);
        assert_true(fabs(y - (jumps ? 0 : 3)) < 1e-14);
        assert_int_equal(mode, jumps ? NS_INSIDE : NS_LOWER);
    }
    ns_theta_free(t);
    ns_system_free(s);
}

/* A jump found from another mode takes (P1) and expansions: of their work nothing is kept, and the matrices
 * that are kept are none of it. */
static void work_is_counted(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double w0 = 0, z = -3;
    double x;
    ns_system *s;
    ns_theta *t;
    const ns_impulse out = {.x = &x};
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 1, 0, &s), NS_OK);
    s->M[0] = s->B[0] = s->C[0] = s->F[0] = 1;
    s->u[0] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    const double kept = ns_theta_matrix_work(t, ns_theta_counts(t));
    double before = ns_theta_problem_work(t);
    assert_true(before == 0);
    for (int again = 0; again < 3; again++) {
        assert_int_equal(ns_theta_impulse(t, &z, NULL, &out), NS_OK);
        assert_true(fabs(x - 3) < 1e-14);
        const double passing = ns_theta_problem_work(t);
        assert_true(passing >= before + 2 * (2800 + 32)); /* blocking; conducting: one unknown at least */
        before = passing;
    }
    assert_true(ns_theta_counts(t)->factors > 0);
    assert_true(ns_theta_matrix_work(t, ns_theta_counts(t)) == kept);
    ns_theta_free(t);
    ns_system_free(s);
}

/* y1 = lambda1 - 2 and y2 = 3 + x + 5 lambda1 + lambda2 with x = 7: lambda = (2, 0), y = (0, 20).  An input,
 * or its slope, that is no number is refused. */
static void laws_of_other_pairs(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double w0 = 7, z = 0, none = NAN;
    double w, x, lambda[2], y[2], X, Lambda[2], Y[2], h;
    ns_mode mode[2];
    const ns_impulse out = {&w, &x, lambda, y, &X, Lambda, Y, mode, &h};
    ns_theta *t;
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(1, 2, 1, 0, &s), NS_OK);
    s->M[0] = 1;
    s->D[0] = s->D[3] = 1, s->D[1] = 5;
    s->C[1] = 1;
    s->e[0] = -2, s->e[1] = 3;
    s->u[0] = s->u[1] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    assert_int_equal(ns_theta_impulse(t, &z, NULL, &out), NS_OK);
    assert_true(x == 7 && fabs(lambda[0] - 2) < 1e-14 && lambda[1] == 0);
    assert_true(fabs(y[0]) < 1e-14 && fabs(y[1] - 20) < 1e-13);
    assert_int_equal(mode[0], NS_INSIDE);
    assert_int_equal(mode[1], NS_LOWER);
    assert_int_equal(ns_theta_impulse(t, &none, NULL, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(t, &none, &z, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(t, &z, &none, &out), NS_E_NUMBER);
    ns_theta_free(t);
    ns_system_free(s);
}

/* x' = -1 - lambda, y = x, both at least 0: from x = 2 in the mode y = 0 an impulse of 2 takes x to 0, where
 * no mode goes on: lambda = -1 keeps x there, lambda = 0 lets it fall.  So the mode and values of the jump
 * stay. */
static void no_mode_after_a_jump(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double w0 = 2;
    const ns_mode inside = NS_INSIDE;
    double w, x, lambda, y, X, Lambda, Y, h;
    ns_mode mode;
    const ns_impulse out = {&w, &x, &lambda, &y, &X, &Lambda, &Y, &mode, &h};
    ns_theta *t;
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->C[0] = 1;
    s->B[0] = s->b[0] = -1;
    s->u[0] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    ns_theta_set_mode(t, &inside);
    assert_int_equal(ns_theta_impulse(t, NULL, NULL, &out), NS_OK);
    assert_true(fabs(x) < 1e-15 && fabs(w) < 1e-15 && fabs(Lambda - 2) < 1e-15);
    assert_true(fabs(lambda + 1) < 1e-15);
    assert_int_equal(mode, NS_INSIDE);
    ns_theta_free(t);
    ns_system_free(s);
}

/* x1' = -x1 - lambda, x2' = lambda, y = x2 - x1: two capacitors and a diode, the first one with a resistor.
 * From (2, 0) an impulse of 1 takes both to 1, then the diode blocks, as x1 falls.  So it is beside another
 * pair, whose y is 1. */
static void blocks_after_its_impulse(int diode) {
    const ns_theta_options o = {1, 1, 0};
    const double w0[2] = {2, 0};
    const int other = !diode;
    double w[2], x[2], lambda[2], y[2], X[2], Lambda[2], Y[2], h;
    ns_mode mode[2];
    const ns_impulse out = {w, x, lambda, y, X, Lambda, Y, mode, &h};
    ns_theta *t;
    ns_system *s;
    assert_int_equal(ns_system_create(2, 2, 0, 0, &s), NS_OK);
    s->M[0] = s->M[3] = 1;
    s->A[0] = -1;
    s->B[2 * diode] = -1, s->B[2 * diode + 1] = 1;
    s->C[diode] = -1, s->C[diode + 2] = 1;
    s->D[3 * other] = s->e[other] = 1;
    s->u[0] = s->u[1] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_theta_impulse(t, NULL, NULL, &out), NS_OK);
    for (int i = 0; i < 2; i++)
        assert_true(fabs(x[i] - 1) < 1e-14 && fabs(w[i] - 1) < 1e-14);
    assert_true(fabs(Lambda[diode] - 1) < 1e-14 && Y[diode] == 0 && Lambda[other] == 0 && Y[other] == 0);
    assert_true(lambda[diode] == 0 && fabs(y[diode]) < 1e-14);
    assert_true(lambda[other] == 0 && fabs(y[other] - 1) < 1e-14);
    assert_true(mode[diode] == NS_LOWER && mode[other] == NS_LOWER);
    ns_theta_free(t);
    ns_system_free(s);
}

static void a_diode_blocks_after_its_impulse(void **state) {
    (void)state;
    for (int diode = 0; diode < 2; diode++)
        blocks_after_its_impulse(diode);
}

/* The same diode beside a pair y = x3 - lambda + lambda_0, where x3 = -1 rises at 1e15 a second.  The impulse
 * of 1 is in y too, and decides for the jump.  After it that pair has no mode, but has one for steps in which
 * x3 becomes positive, and in these the diode blocks: mode and values of the jump stay, with the diode's -1/2
 * that keeps both capacitors at one voltage. */
static void no_mode_but_that_of_a_step(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double w0[3] = {2, 0, -1};
    double w[3], x[3], lambda[2], y[2], X[3], Lambda[2], Y[2], h;
    ns_mode mode[2];
    const ns_impulse out = {w, x, lambda, y, X, Lambda, Y, mode, &h};
    ns_theta *t;
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(3, 2, 0, 0, &s), NS_OK);
    s->M[0] = s->M[4] = s->M[8] = 1;
    s->A[0] = -1;
    s->B[0] = -1, s->B[1] = 1;
    s->b[2] = 1e15;
    s->C[0] = -1, s->C[0 + 2] = 1, s->C[1 + 4] = 1;
    s->D[1] = 1, s->D[1 + 2] = -1;
    s->u[0] = s->u[1] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_theta_impulse(t, NULL, NULL, &out), NS_OK);
    assert_true(fabs(x[0] - 1) < 1e-14 && fabs(x[1] - 1) < 1e-14 && x[2] == -1);
    assert_true(fabs(Lambda[0] - 1) < 1e-14 && fabs(Y[1] - 1) < 1e-14);
    assert_true(fabs(lambda[0] + 0.5) < 1e-14 && lambda[1] == 0 && fabs(y[1] + 1.5) < 1e-14);
    assert_true(mode[0] == NS_INSIDE && mode[1] == NS_LOWER);
    ns_theta_free(t);
    ns_system_free(s);
}

/* x1' = -x1 - v, x2' = v, 0 = x1 - x2 + lambda, y = v: two inductors in series, the first one with a
 * resistor, and a diode that takes what the second one has more.  From (2, 0) an impulse of 1 of v, which it
 * blocks, takes both to 1; then it conducts, as x1 falls. */
static void a_diode_conducts_after_an_impulse_of_its_voltage(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double w0[3] = {2, 0, 0};
    double w[3], x[3], lambda, y, X[3], Lambda, Y, h;
    ns_mode mode;
    const ns_impulse out = {w, x, &lambda, &y, X, &Lambda, &Y, &mode, &h};
    ns_theta *t;
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(3, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->M[1 + 3] = 1;
    s->A[0] = -1, s->A[0 + 3 * 2] = -1;
    s->A[1 + 3 * 2] = 1;
    s->A[2] = 1, s->A[2 + 3] = -1;
    s->B[2] = 1;
    s->C[2] = 1;
    s->u[0] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_theta_impulse(t, NULL, NULL, &out), NS_OK);
    assert_true(fabs(x[0] - 1) < 1e-14 && fabs(x[1] - 1) < 1e-14 && fabs(x[2]) < 1e-14);
    assert_true(fabs(X[2] - 1) < 1e-14 && fabs(Y - 1) < 1e-14 && Lambda == 0);
    assert_true(fabs(lambda) < 1e-14);
    assert_int_equal(mode, NS_INSIDE);
    ns_theta_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(inputs_of_a_law),
                                       cmocka_unit_test(work_is_counted),
                                       cmocka_unit_test(laws_of_other_pairs),
                                       cmocka_unit_test(no_mode_after_a_jump),
                                       cmocka_unit_test(a_diode_blocks_after_its_impulse),
                                       cmocka_unit_test(no_mode_but_that_of_a_step),
                                       cmocka_unit_test(a_diode_conducts_after_an_impulse_of_its_voltage)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
