/* tests/reference/test_nl_chopper.c - the sliding chopper of the literature: a switch and a diode as
 * resistances that take 1 mohm, 1 kohm, or anything between exactly at their threshold.
 *
 * 20 V, switch to node 3 (closed where v5 > v4), diode 0 -> 3, 200 uH to node 4, 1 ohm; v5 a sawtooth that
 * falls from 7.5 V to -2.5 V in 20 us.  With x = i_L and the unknowns (v3, i_s, i_d, r_s, r_d; p_s, n_s, p_d,
 * n_d):
 *
 *     L x' = v3 - R x
 *     0 = 20 - v3 - r_s i_s,   0 = -v3 - r_d i_d,   0 = i_s + i_d - x                (products of unknowns)
 *     0 = (v5 - R x) - p_s + n_s,   0 = -v3 - p_d + n_d
 *     0 <= p _|_ r - 1 mohm >= 0,   0 <= n _|_ 1 kohm - r >= 0                       (for each of the two)
 *
 * five equalities and four pairs.  Between switchings it is a line:  L x' = v_th - (r_th + R) x, with v_th,
 * r_th those of the two resistances in parallel (1 mohm to 20 V, 1 kohm to 0; or the reverse), an
 * exponential.  When v5 jumps up it closes; where v5 falls through v4 it opens: v4 moves by at most 0.1 V/us,
 * v5 by 0.5 V/us, so that it crosses once.  The reference finds these instants by bisection.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double vin = 20, L = 200e-6, R = 1, period = 20e-6, low = 1e-3, high = 1e3;
enum { V3, IS, ID, RS, RD, PS, NS, PD, ND, COUNT };

static int f(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = -R * p->x[0];
    return 0;
}

static int A(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    out[0] = -R;
    return 0;
}

static int g(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = p->lambda[V3];
    return 0;
}

static int B(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    for (int j = 0; j < COUNT; j++)
        out[j] = j == V3;
    return 0;
}

static int h(const ns_point *p, void *data, double *out) {
    const double *v = p->lambda;
    (void)data;
    out[0] = vin - v[V3] - v[RS] * v[IS];
    out[1] = -v[V3] - v[RD] * v[ID];
    out[2] = v[IS] + v[ID] - p->x[0];
    out[3] = p->z[0] - R * p->x[0] - v[PS] + v[NS];
    out[4] = -v[V3] - v[PD] + v[ND];
    out[PS] = v[RS] - low;
    out[NS] = high - v[RS];
    out[PD] = v[RD] - low;
    out[ND] = high - v[RD];
    return 0;
}

static int C(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    for (int i = 0; i < COUNT; i++)
        out[i] = i == 2 ? -1 : i == 3 ? -R : 0;
    return 0;
}

static int D(const ns_point *p, void *data, double *out) {
    const double *v = p->lambda;
    (void)data;
    for (int i = 0; i < COUNT * COUNT; i++)
        out[i] = 0;
    out[0 + V3 * COUNT] = out[1 + V3 * COUNT] = out[4 + V3 * COUNT] = -1;
    out[0 + RS * COUNT] = -v[IS];
    out[0 + IS * COUNT] = -v[RS];
    out[1 + RD * COUNT] = -v[ID];
    out[1 + ID * COUNT] = -v[RD];
    out[2 + IS * COUNT] = out[2 + ID * COUNT] = 1;
    out[3 + PS * COUNT] = out[4 + PD * COUNT] = -1;
    out[3 + NS * COUNT] = out[4 + ND * COUNT] = 1;
    out[PS + RS * COUNT] = out[PD + RD * COUNT] = 1;
    out[NS + RS * COUNT] = out[ND + RD * COUNT] = -1;
    return 0;
}

static double ramp(double t) {
    return 7.5 - 10 * (t / period - floor(t / period));
}

static ns_signal sawtooth(void) {
    static const double at[2] = {0, 20e-6}, volts[2] = {7.5, -2.5};
    ns_signal s = {.kind = NS_PWL};
    s.u.pwl.n = 2;
    s.u.pwl.t = at;
    s.u.pwl.v = volts;
    s.u.pwl.repeat = 0;
    return s;
}

static const double l[COUNT] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY, -INFINITY, 0, 0, 0, 0};
static const double u[COUNT] = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY,
                                INFINITY, INFINITY, INFINITY, INFINITY};

static ns_model chopper(const ns_signal *z) {
    const ns_model model = {.n = 1,
                            .m = COUNT,
                            .nz = 1,
                            .M = &L,
                            .l = l,
                            .u = u,
                            .z = z,
                            .f = f,
                            .A = A,
                            .g = g,
                            .B = B,
                            .h = h,
                            .C = C,
                            .D = D};
    return model;
}

/* i after dt with the switch closed or open. */
static double flow(double i, int closed, double dt) {
    const double gs = closed ? 1 / low : 1 / high, gd = closed ? 1 / high : 1 / low;
    const double vth = vin * gs / (gs + gd), r = 1 / (gs + gd) + R, rest = vth / r;
    return rest + (i - rest) * exp(-dt * r / L);
}

/* i at t (a whole number of periods and something), from 0 A at 0. */
static double exact(double t) {
    double i = 0;
    for (int p = 0; p * period < t; p++) {
        const double start = p * period;
        double a = 0, b = period;
        for (int k = 0; k < 60; k++) { /* closed until v5 = v4 */
            const double mid = (a + b) / 2;
            *(7.5 - 10 * mid / period > R * flow(i, 1, mid) ? &a : &b) = mid;
        }
        const double end = fmin(period, t - start);
        i = end <= a ? flow(i, 1, end) : flow(flow(i, 1, a), 0, end - a);
    }
    return i;
}

static void jacobians(void **state) {
    (void)state;
    const ns_signal z = sawtooth();
    const ns_model model = chopper(&z);
    ns_jacobian_error worst;
    const double x = 3, lambda[COUNT] = {5, 2, 1, 0.5, 7, 1, 2, 3, 4};
    assert_int_equal(ns_model_check_jacobians(&model, 1e-6, &x, lambda, &worst), NS_OK);
    assert_true(worst.error < 1e-6);
}

/* The largest error of i in 200 us; *iterations: of Newton, a step. */
static double error(double step, double *iterations) {
    const ns_signal z = sawtooth();
    const ns_model model = chopper(&z);
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    const double x0 = 0, closed[COUNT] = {20, 0.02, -0.02, 1e-3, 1e3, 7.5, 0, 0, 20};
    ns_newton *s;
    double worst = 0, x, v[COUNT];
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, &x0, closed), NS_OK);
    const int steps = (int)lround(200e-6 / step);
    for (int k = 1; k <= steps; k++) {
        const double t = k * step;
        const int status = ns_newton_advance(s, t, step);
        if (status != NS_OK)
            print_message("t = %g: %s\n", t, ns_status_name(status));
        assert_int_equal(status, NS_OK);
        assert_int_equal(ns_newton_read(s, NULL, &x, v, NULL, NULL), NS_OK);
        assert_true(v[RS] >= low * (1 - 1e-9) && v[RS] <= high * (1 + 1e-9));
        assert_true(v[RD] >= low * (1 - 1e-9) && v[RD] <= high * (1 + 1e-9));
        assert_true(fabs(vin - v[V3] - v[RS] * v[IS]) < 1e-9 * vin);
        if (fabs(ramp(t) - R * x) > 0.2 && ramp(t) < 7) /* away from thresholds: low or high */
            assert_true(ramp(t) > R * x ? v[RS] < 2 * low : v[RS] > high / 2);
        worst = fmax(worst, fabs(x - exact(t)));
    }
    const ns_newton_counts *c = ns_newton_counts_of(s);
    *iterations = (double)c->iterations / (double)c->steps;
    ns_newton_free(s);
    return worst;
}

/* Two instants a period, the jump of v5 and its way down through v4, are missed by up to h each: 20 V / 200
 * uH makes 0.01 A of 0.1 us, 0.02 A of both. */
static void as_the_lines_say(void **state) {
    (void)state;
    double n1 = 0, n2 = 0;
    const double a = error(0.1e-6, &n1), b = error(0.0125e-6, &n2);
    print_message("h = 0.1 us: %.2e A off, %.2f iterations a step; an eighth: %.2e A, %.2f\n", a, n1, b, n2);
    assert_true(a < 0.02);
    assert_true(b < a / 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jacobians),
        cmocka_unit_test(as_the_lines_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
