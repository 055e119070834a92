/* tests/unit/newton/test_jump.c - the impulse problem of a model: charge and flux conserved, what is
 * consistent left alone, the linear engine's answer met. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "callbacks.h"
#include "linalg/dense.h"
#include "newton_bench.h"
#include "nonsmooth/impulse.h"
#include "systems.h"

/* Two capacitors with a leak each, a diode from the first to the second:
 *   C1 v1' = -v1/R - lambda,   C2 v2' = -v2/R + lambda,   y = v2 - v1
 * v1 > v2: both go to (C1 v1 + C2 v2) / (C1 + C2), no charge is lost, energy is.  Then both stay together:
 *   (C1 + C2) v' = -2 v/R,  lambda = C2 v' + v/R = v/R (C1 - C2) / (C1 + C2) > 0. */
static ns_system *two_capacitors(double C1, double R1, double C2, double R2) {
    ns_system *s;
    assert_int_equal(ns_system_create(2, 1, 0, 0, &s), NS_OK);
    s->M[0] = C1;
    s->M[3] = C2;
    s->A[0] = -1 / R1;
    s->A[3] = -1 / R2;
    s->B[0] = s->C[0] = -1;
    s->B[1] = s->C[1] = 1;
    return s;
}

static void charge_is_shared(void **state) {
    (void)state;
    const double C1 = 2e-6, C2 = 1e-6, R = 1e3, first[] = {5, 5, 1e4, 1e-3}, second[] = {1, -3, 0, 0};
    for (int k = 0; k < 4; k++) {
        ns_system *s = two_capacitors(C1, R, C2, R);
        ns_model model;
        double x[2], lambda, y;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        const double x0[2] = {first[k], second[k]}, v = (C1 * first[k] + C2 * second[k]) / (C1 + C2);
        ns_newton *t = start(&model, x0);
        jump(t, x, &lambda, &y);
        assert_true(fabs(x[0] - v) < 1e-13 * first[k] && fabs(x[1] - v) < 1e-13 * first[k]);
        assert_true(fabs(C1 * x[0] + C2 * x[1] - (C1 + C2) * v) < 1e-12 * C1 * first[k]);
        if (v > 0) /* sharing on needs lambda > 0: 1e-16 of C v over h = RC 2^-24 */
            assert_true(fabs(lambda - v / R * (C1 - C2) / (C1 + C2)) < 1e-6 * first[k] / R && y == 0);
        ns_newton_free(t);
        ns_system_free(s);
    }
}

/* 1 F that a source of 1 A charges has no time constant: it keeps its charge. */
static void without_a_time_constant(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    double x, lambda, y;
    const ns_signal ampere = {.kind = NS_DC, .u.dc = 1};
    assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
    assert_int_equal(ns_system_set_input(s, 0, &ampere), NS_OK);
    s->M[0] = s->E[0] = 1;
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = start(&model, &(double){5});
    jump(t, &x, &lambda, &y);
    assert_true(fabs(x - 5) < 1e-13);
    ns_newton_free(t);
    ns_system_free(s);
}

/* Where t has no digits for the time constant RC: as at t = 0.  From (5,1) both go to 3, (1,2) stays. */
static void late_jumps_are_no_others(void **state) {
    (void)state;
    const double RCs[] = {1, 1e-6, 1e-9, 1e-9, 1e-8, 1e-12}, t0s[] = {1, 1, 1, 0.01, 1e3, 1e9};
    for (int k = 0; k < 12; k++) {
        const double R = RCs[k / 2], first[2][2] = {{5, 1}, {1, 2}}, end[2][2] = {{3, 3}, {1, 2}};
        const double *x0 = first[k % 2], *right = end[k % 2];
        ns_system *s = two_capacitors(1, R, 1, R);
        ns_model model;
        double x[2], lambda, y;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        ns_newton *t = start_at(&model, t0s[k / 2], x0);
        jump(t, x, &lambda, &y);
        assert_true(fabs(x[0] - right[0]) < 5e-13 && fabs(x[1] - right[1]) < 5e-13);
        assert_true(fabs(lambda) < 1e-6 * 5 / R); /* none: both go down alike, or the diode blocks */
        ns_newton_free(t);
        ns_system_free(s);
    }
}

/* Other units of unknowns, rows and time, by powers of two: the same jump.  As above, with R C = 1 s / rate.
 */
static void units_change_nothing(void **state) {
    (void)state;
    static const int unit[][4] = {/* exponents: unknowns, rows */
                                  {0, 0, 0, 0},    {30, -30, 0, 0},   {-30, 30, 0, 0}, {0, 0, 30, -30},
                                  {0, 0, -30, 30}, {20, 20, -40, 10}, {40, 5, 5, 40},  {-40, -5, -5, -40}};
    for (size_t k = 0; k < sizeof unit / sizeof *unit; k++)
        for (int rate = -40; rate <= 40; rate += 20) {
            const double R = ldexp(1, -rate), v = (2 * 5.0 + 1) / 3;
            ns_system *s = two_capacitors(2, R, 1, R);
            ns_model model;
            double x[2], lambda, y;
            for (int j = 0; j < 2; j++) {
                for (int i = 0; i < 2; i++) {
                    s->M[i + 2 * j] = ldexp(s->M[i + 2 * j], unit[k][j] + unit[k][2 + i]);
                    s->A[i + 2 * j] = ldexp(s->A[i + 2 * j], unit[k][j] + unit[k][2 + i]);
                }
                s->B[j] = ldexp(s->B[j], unit[k][2 + j]);
                s->C[j] = ldexp(s->C[j], unit[k][j]);
            }
            assert_int_equal(ns_model_of_system(s, &model), NS_OK);
            const double x0[2] = {ldexp(5, -unit[k][0]), ldexp(1, -unit[k][1])};
            ns_newton *t = start(&model, x0);
            jump(t, x, &lambda, &y);
            for (int j = 0; j < 2; j++)
                assert_true(fabs(ldexp(x[j], unit[k][j]) - v) < 1e-13 * v);
            assert_true(fabs(lambda * R - v / 3) < 1e-6 * v && y == 0); /* as above */
            ns_newton_free(t);
            ns_system_free(s);
        }
}

/* R1 C1 = R2 C2: both go down alike whether the diode conducts 0 or blocks, and it is rounding that says
 * which, of each length by itself. */
static void a_diode_that_may_or_may_not(void **state) {
    (void)state;
    for (int k = 0; k < 24; k++) {
        const int power = k / 3;
        const double C2 = pow(10, -power), C1 = 1, v = (C1 * 5 + C2) / (C1 + C2), x0[2] = {5, 1};
        ns_system *s = two_capacitors(C1, 1e-3, C2, 1e-3 / C2 * (1 + (k % 3 - 1) * 1e-15));
        ns_model model;
        double x[2], lambda, y;
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        ns_newton *t = start(&model, x0);
        jump(t, x, &lambda, &y);
        assert_true(fabs(x[0] - v) < 5e-13 && fabs(x[1] - v) < 5e-13);
        assert_true(lambda >= 0 && y >= 0 && lambda * y == 0 && y < 1e-12 && lambda < 1e-6 * v / 1e-3);
        ns_newton_free(t);
        ns_system_free(s);
    }
}

/* The same with v1 < v2: the diode blocks, nothing moves. */
static void what_is_consistent_stays(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    ns_model model;
    double x[2], lambda[4], y[4];
    const double x0[2] = {10, 0.02};
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = start(&model, x0);
    jump(t, x, lambda, y);
    assert_true(fabs(x[0] - 10) < 1e-13 && fabs(x[1] - 0.02) < 1e-14);
    assert_true(fabs(y[0] - 0.01) < 1e-9 ||
                fabs(lambda[2] - 0.01) < 1e-9); /* 10 V over 1 kohm through one diode */
    for (int k = 0; k < 4; k++)
        assert_true(lambda[k] >= 0 && y[k] >= 0 && lambda[k] * y[k] == 0);
    ns_newton_free(t);
    ns_system_free(s);
}

/* A source across a capacitor: C v' = i, v = V, index 2; with a slope k of the source, i = C k at t+. */
static void a_capacitor_on_a_source(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    const double C = 1e-6, times[2] = {0, 1}, values[2] = {5, 2005}, x0[2] = {1, 0};
    ns_signal ramp = {.kind = NS_PWL};
    double x[2];
    ramp.u.pwl.n = 2;
    ramp.u.pwl.t = times;
    ramp.u.pwl.v = values;
    ramp.u.pwl.repeat = NAN;
    assert_int_equal(ns_system_create(2, 0, 1, 0, &s), NS_OK);
    assert_int_equal(ns_system_set_input(s, 0, &ramp), NS_OK);
    s->M[0] = C;
    s->A[0 + 2] = 1; /* C v' = i */
    s->A[1] = -1;
    s->E[1] = 1; /* 0 = z - v */
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = start(&model, x0);
    jump(t, x, NULL, NULL);
    assert_true(fabs(x[0] - 5) < 1e-13 * 5);
    assert_true(fabs(x[1] - C * 2000) < 1e-6 * C * 2000);
    ns_newton_free(t);
    ns_system_free(s);
}

/* The same with a leak of R, RC = 1 ns, at 1000 s, whose last bit is 1e-13 s: i = C k + V/R at t+ all the
 * same. */
static void a_slope_late(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    const double C = 1e-6, R = 1e-3, times[2] = {1000, 1000 + 1e-6}, values[2] = {5, 1005}, x0[2] = {1, 0};
    const double slope = (values[1] - values[0]) / (times[1] - times[0]);
    ns_signal ramp = {.kind = NS_PWL};
    double x[2];
    ramp.u.pwl.n = 2;
    ramp.u.pwl.t = times;
    ramp.u.pwl.v = values;
    ramp.u.pwl.repeat = NAN;
    assert_int_equal(ns_system_create(2, 0, 1, 0, &s), NS_OK);
    assert_int_equal(ns_system_set_input(s, 0, &ramp), NS_OK);
    s->M[0] = C;
    s->A[0] = -1 / R;
    s->A[0 + 2] = 1; /* C v' = i - v/R */
    s->A[1] = -1;
    s->E[1] = 1; /* 0 = z - v */
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = start_at(&model, times[0], x0);
    jump(t, x, NULL, NULL);
    assert_true(fabs(x[0] - 5) < 1e-13 * 5);
    assert_true(fabs(x[1] - (C * slope + 5 / R)) < 1e-6 * C * slope);
    ns_newton_free(t);
    ns_system_free(s);
}

/* Random capacitive networks with diodes: the impulse problem of ns_theta_impulse(). */
static unsigned seed;
static double random_unit(void) {
    seed = seed * 1664525u + 1013904223u;
    return (double)seed / 2147483648.0 - 1;
}

enum { N = 5, P = 4 };

static void the_linear_impulse_agrees(void **state) {
    (void)state;
    double worst_x = 0, worst_l = 0;
    int jumps = 0;
    for (int run = 0; run < 100; run++) {
        ns_system *s;
        ns_model model;
        ns_theta *a;
        const ns_theta_options o = {1, 1, 0};
        double x0[N], w0[N], xa[N], la[P], xb[N], lb[P], yb[P];
        seed = 400u + (unsigned)run;
        assert_int_equal(ns_system_create(N, P, 0, 0, &s), NS_OK);
        for (int i = 0; i < N; i++) {
            x0[i] = 3 * random_unit();
            s->M[i * (N + 1)] = exp(3 * random_unit());
            for (int j = 0; j < N; j++)
                s->A[i + j * N] = random_unit() - (i == j ? 2 : 0);
        }
        for (int j = 0; j < P; j++) { /* a diode from node j to j + 1 or back, C = B' */
            const double sign = random_unit() > 0 ? 1 : -1;
            s->B[j + j * N] = s->C[j + j * P] = -sign;
            s->B[j + 1 + j * N] = s->C[j + (j + 1) * P] = sign;
        }
        assert_int_equal(ns_model_of_system(s, &model), NS_OK);
        assert_int_equal(ns_theta_create(s, &o, &a, NULL), NS_OK);
        ns_linalg_matvec(N, N, s->M, x0, w0);
        assert_int_equal(ns_theta_start(a, w0, NULL), NS_OK);
        const ns_impulse out = {.x = xa, .lambda = la};
        assert_int_equal(ns_theta_impulse(a, NULL, NULL, &out), NS_OK);
        ns_newton *b = start(&model, x0);
        jump(b, xb, lb, yb);
        double charge = 0, before = 0, stored = 0, had = 0;
        for (int i = 0; i < N; i++) {
            worst_x = fmax(worst_x, fabs(xa[i] - xb[i]));
            charge += s->M[i * (N + 1)] * xb[i];
            before += w0[i];
            stored += s->M[i * (N + 1)] * xb[i] * xb[i];
            had += w0[i] * x0[i];
            jumps += fabs(xa[i] - x0[i]) > 1e-6;
        }
        for (int i = 0; i < P; i++) {
            assert_true(lb[i] >= 0 && yb[i] >= 0 && lb[i] * yb[i] == 0);
            assert_true(la[i] >= -1e-12); /* rounding of rates of some units */
            worst_l = fmax(worst_l, fabs(la[i] - lb[i]));
        }
        assert_true(fabs(charge - before) < 1e-12 * 100); /* sum of |C v| is some tens */
        assert_true(stored <= had * (1 + 1e-13));
        ns_newton_free(b);
        ns_theta_free(a);
        ns_system_free(s);
    }
    print_message("%d jumps: x %.1e, lambda %.1e\n", jumps, worst_x, worst_l);
    assert_true(jumps > 100);
    assert_true(worst_x < 1e-12); /* of some units */
    assert_true(worst_l <
                1e-5); /* eps C v over h, which is 2^-24 of the fastest time constant, times three */
}

/* x' = -x + lambda, y = lambda - z, z from 0 to 1 at t = 1: x(2) = e^-2 + 1 - e^-1.  The state has no jump, r
 * and lambda do: of second order by a call at 1 s, of first without. */
static double error_at_2(const ns_model *model, double h, int call) {
    const double x0 = 1;
    double x;
    ns_newton *t = start(model, &x0);
    assert_int_equal(ns_newton_advance(t, 1, h), NS_OK);
    if (call) {
        assert_int_equal(ns_newton_jump(t), NS_OK);
        assert_int_equal(ns_newton_accept(t), NS_OK);
    }
    assert_int_equal(ns_newton_advance(t, 2, h), NS_OK);
    assert_int_equal(ns_newton_read(t, NULL, &x, NULL, NULL, NULL), NS_OK);
    ns_newton_free(t);
    return fabs(x - (exp(-2) + 1 - exp(-1)));
}

static void inputs_that_jump_keep_the_order(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    const double times[4] = {0, 1, 1, 9}, values[4] = {0, 0, 1, 1};
    ns_signal z = {.kind = NS_PWL};
    z.u.pwl.n = 4;
    z.u.pwl.t = times;
    z.u.pwl.v = values;
    z.u.pwl.repeat = NAN;
    assert_int_equal(ns_system_create(1, 1, 1, 0, &s), NS_OK);
    assert_int_equal(ns_system_set_input(s, 0, &z), NS_OK);
    s->M[0] = s->B[0] = s->D[0] = 1;
    s->A[0] = s->F[0] = -1;
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    for (int call = 0; call < 2; call++) {
        const double ratio = error_at_2(&model, 0.05, call) / error_at_2(&model, 0.025, call);
        assert_true(fabs(ratio - (call ? 4 : 2)) < 0.05); /* 2^order (1 + a few h) */
    }
    ns_system_free(s);
}

static void a_jump_that_fails_leaves_the_past(void **state) {
    (void)state;
    ns_system *s;
    ns_model model;
    const double x0 = 3;
    double x;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = 1;
    s->e[0] = -1; /* y = -1 whatever lambda does */
    assert_int_equal(ns_model_of_system(s, &model), NS_OK);
    ns_newton *t = start(&model, &x0);
    assert_int_equal(ns_newton_jump(t), NS_E_INFEASIBLE);
    assert_int_equal(ns_newton_accept(t), NS_E_STATE);
    assert_int_equal(ns_newton_read(t, NULL, &x, NULL, NULL, NULL), NS_OK);
    assert_true(x == 3);
    ns_newton_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charge_is_shared),
        cmocka_unit_test(without_a_time_constant),
        cmocka_unit_test(units_change_nothing),
        cmocka_unit_test(what_is_consistent_stays),
        cmocka_unit_test(a_capacitor_on_a_source),
        cmocka_unit_test(late_jumps_are_no_others),
        cmocka_unit_test(a_diode_that_may_or_may_not),
        cmocka_unit_test(a_slope_late),
        cmocka_unit_test(inputs_that_jump_keep_the_order),
        cmocka_unit_test(the_linear_impulse_agrees),
        cmocka_unit_test(a_jump_that_fails_leaves_the_past),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
