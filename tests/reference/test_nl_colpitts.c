/* tests/reference/test_nl_colpitts.c - a Colpitts oscillator with an exponential (Ebers-Moll) transistor.
 *
 * The circuit in which M. P. Kennedy described chaos (Chaos in the Colpitts oscillator, 1994), with the
 * values that a public model of it gives: L = 98.5 uH with 35 ohm, C1 = C2 = 54 nF, RE = 400 ohm, +-5 V, beta
 * = 200. (The paper itself was not at hand.  Its transistor is piecewise linear, 100 ohm from 0.75 V on; this
 * one is Ebers and Moll's, and Is, VT, aR and the clamp are chosen here.)  x = (v_CE, v_BE, i_L):
 *
 *     C1 v_CE' = i_L - i_C
 *     C2 v_BE' = (5 V - v_BE)/RE - i_L - i_B        (the emitter is pulled down from -v_BE to -5 V)
 *     L  i_L'  = 5 V - v_CE + v_BE - 35 i_L
 *     i_F = Is (exp(v_BE/VT) - 1),  i_R = Is (exp((v_BE - v_CE)/VT) - 1)
 *     i_C = aF i_F - i_R,  i_B = (1 - aF) i_F + (1 - aR) i_R,   Is = 1e-14 A, aF = 200/201, aR = 1/2
 *
 * and a clamp across C2, an ideal diode behind 10 ohm that lets v_BE fall no further than some -0.5 V:
 *     0 <= lambda _|_ v_BE + 0.5 V + 10 lambda >= 0,   C2 v_BE' += lambda,   lambda = max(0, -(v_BE + 0.5
 * V)/10) which makes it an explicit equation for the comparison: classical Runge-Kutta at a hundredth of the
 * step.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double L = 98.5e-6, RL = 35, C1 = 54e-9, C2 = 54e-9, RE = 400, V = 5;
static const double Is = 1e-14, VT = 0.02585, aF = 200.0 / 201, aR = 0.5, clamp = 0.5, RC = 10;

static int f(const ns_point *p, void *data, double *out) {
    const double *x = p->x, vbc = x[1] - x[0];
    (void)data;
    if (x[1] > 40 * VT || vbc > 40 * VT) /* kiloamperes: too far from anything */
        return 1;
    const double forward = Is * expm1(x[1] / VT), reverse = Is * expm1(vbc / VT);
    out[0] = x[2] - (aF * forward - reverse);
    out[1] = (V - x[1]) / RE - x[2] - (1 - aF) * forward - (1 - aR) * reverse;
    out[2] = V - x[0] + x[1] - RL * x[2];
    return 0;
}

static int A(const ns_point *p, void *data, double *out) {
    (void)data;
    const double gf = Is / VT * exp(p->x[1] / VT), gr = Is / VT * exp((p->x[1] - p->x[0]) / VT);
    const double columns[9] = {-gr,
                               (1 - aR) * gr,
                               -1, /* d/dv_CE */
                               -aF * gf + gr,
                               -1 / RE - (1 - aF) * gf - (1 - aR) * gr,
                               1,
                               1,
                               -1,
                               -RL};
    for (int i = 0; i < 9; i++)
        out[i] = columns[i];
    return 0;
}

static int g(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = out[2] = 0;
    out[1] = p->lambda[0];
    return 0;
}

static int B(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    out[0] = out[2] = 0;
    out[1] = 1;
    return 0;
}

static int h(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = p->x[1] + clamp + RC * p->lambda[0];
    return 0;
}

static int C(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    out[0] = out[2] = 0;
    out[1] = 1;
    return 0;
}

static int D(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    out[0] = RC;
    return 0;
}

static const double M[9] = {54e-9, 0, 0, 0, 54e-9, 0, 0, 0, 98.5e-6}, zero = 0, none = INFINITY;
static const double start[3] = {5, 0.6, 0};

static ns_model oscillator(int m) {
    ns_model model = {.n = 3, .m = m, .M = M, .f = f, .A = A};
    if (m) {
        model.l = &zero;
        model.u = &none;
        model.g = g;
        model.B = B;
        model.h = h;
        model.C = C;
        model.D = D;
    }
    return model;
}

static void slope(int m, const double *x, double *out) {
    const ns_point p = {0, x, NULL, NULL};
    assert_int_equal(f(&p, NULL, out), 0);
    if (m)
        out[1] += fmax(0, -(x[1] + clamp) / RC);
    out[0] /= C1;
    out[1] /= C2;
    out[2] /= L;
}

/* Classical Runge-Kutta, one step. */
static void runge_kutta(int m, double step, double *x) {
    static const double at[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
    double k[3] = {0}, y[3], sum[3] = {0};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 3; i++)
            y[i] = x[i] + step * at[stage] * k[i];
        slope(m, y, k);
        for (int i = 0; i < 3; i++)
            sum[i] += weight[stage] * k[i] / 6;
    }
    for (int i = 0; i < 3; i++)
        x[i] += step * sum[i];
}

/* The largest difference of v_CE and v_BE at 5, 10, ... 40 us, four periods, relative to 10 V.  (Not at all
 * times: where the transistor turns on, v_CE falls within some steps, and how high the error's peak is found
 * depends on the grid.) */
static double difference(int m, double theta, double gamma, ns_relation relation, double step) {
    const ns_model model = oscillator(m);
    const ns_newton_options o = {.theta = theta, .gamma = gamma, .relation = relation};
    ns_newton *s;
    double x[3], y[3] = {start[0], start[1], start[2]}, worst = 0, deepest = 0;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, start, NULL), NS_OK);
    const int steps = (int)lround(40e-6 / step), every = (int)lround(5e-6 / step);
    for (int k = 1; k <= steps; k++) {
        assert_int_equal(ns_newton_try(s, step), NS_OK);
        assert_int_equal(ns_newton_accept(s), NS_OK);
        assert_int_equal(ns_newton_read(s, NULL, x, NULL, NULL, NULL), NS_OK);
        for (int r = 0; r < 100; r++)
            runge_kutta(m, step / 100, y);
        for (int i = 0; i < 2 && k % every == 0; i++)
            worst = fmax(worst, fabs(x[i] - y[i]) / 10);
        deepest = fmin(deepest, x[1]);
    }
    const ns_newton_counts *c = ns_newton_counts_of(s);
    print_message("    %-5s   %-5g   %-6g   %.2e    %.3f          %.2f\n", m ? "yes" : "no", theta,
                  step * 1e9, worst, deepest, (double)c->iterations / (double)c->steps);
    assert_true(deepest < -0.5); /* it oscillates, and the clamp has something to do */
    ns_newton_free(s);
    return worst;
}

static void jacobians(void **state) {
    (void)state;
    const double points[3][3] = {{5, 0.6, 0.01}, {0.1, 0.65, 0.02}, {8, -0.7, -0.01}}, lambda = 0.01;
    for (int m = 0; m < 2; m++)
        for (int k = 0; k < 3; k++) {
            const ns_model model = oscillator(m);
            ns_jacobian_error worst;
            assert_int_equal(ns_model_check_jacobians(&model, 0, points[k], &lambda, &worst), NS_OK);
            assert_true(worst.error < 1e-6);
        }
}

static void heading(void) {
    print_message("Colpitts oscillator, v_CE and v_BE in 40 us against Runge and Kutta's steps of h/100:\n"
                  "    clamp   theta   h / ns   off, /10 V  least v_BE / V   Newton iterations a step\n");
}

/* Without the clamp everything is smooth: first and second order. */
static void smooth(void **state) {
    (void)state;
    heading();
    const double a = difference(0, 1, 1, NS_RELATION_END, 4e-9),
                 b = difference(0, 1, 1, NS_RELATION_END, 2e-9);
    assert_true(a / b > 1.8 && a / b < 2.2);
    const double c = difference(0, 0.5, 0.5, NS_RELATION_END, 20e-9);
    const double d = difference(0, 0.5, 0.5, NS_RELATION_END, 10e-9);
    assert_true(c / d > 3.6 && c / d < 4.4);
    assert_true(d < 1e-4);
}

/* With it the right side has corners; it stays continuous, so that a corner inside a step costs h^2 once. */
static void clamped(void **state) {
    (void)state;
    heading();
    const double a = difference(1, 1, 1, NS_RELATION_END, 4e-9),
                 b = difference(1, 1, 1, NS_RELATION_END, 2e-9);
    assert_true(a / b > 1.8 && a / b < 2.2);
    const double c = difference(1, 0.5, 0.5, NS_RELATION_END, 20e-9);
    const double d = difference(1, 0.5, 0.5, NS_RELATION_END, 10e-9);
    assert_true(c / d > 3.2 && c / d < 4.8);
    assert_true(d < 1e-4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jacobians),
        cmocka_unit_test(smooth),
        cmocka_unit_test(clamped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
