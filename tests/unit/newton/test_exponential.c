/* tests/unit/newton/test_exponential.c - Newton's loop down an exponential: a source that moves by many Vt in
 * one step, in one step and in a rectifier with few steps a period; terms and residuals beyond all numbers.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "callbacks.h"
#include "nonsmooth.h"

/* C x' = -x/R + lambda, y = lambda - Is (exp((z - x - Rs lambda)/Vt) - 1): a source, Shockley's diode with a
 * resistor in series, a capacitor and a load. */
typedef struct diode {
    double C, R, Rs;
} diode;

static const double Is = 1e-12, Vt = 0.025;

static double exponent(const ns_point *at, const diode *d) {
    return (at->z[0] - at->x[0] - d->Rs * at->lambda[0]) / Vt;
}

static int load(const ns_point *at, void *data, double *out) {
    out[0] = -at->x[0] / ((const diode *)data)->R;
    return 0;
}

static int load_A(const ns_point *at, void *data, double *out) {
    (void)at;
    out[0] = -1 / ((const diode *)data)->R;
    return 0;
}

static int current(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->lambda[0];
    return 0;
}

static int shockley(const ns_point *at, void *data, double *out) {
    out[0] = at->lambda[0] - Is * expm1(exponent(at, data));
    return !isfinite(out[0]);
}

static int shockley_C(const ns_point *at, void *data, double *out) {
    out[0] = Is / Vt * exp(exponent(at, data));
    return 0;
}

static int shockley_D(const ns_point *at, void *data, double *out) {
    const diode *d = data;
    out[0] = 1 + d->Rs * Is / Vt * exp(exponent(at, data));
    return 0;
}

static ns_newton *start(diode *d, const ns_signal *z, const double *l) {
    static ns_model model;
    model = (ns_model){.n = 1, .m = 1, .nz = 1, .M = &d->C, .l = l, .u = all_infinite, .z = z, .data = d};
    model.f = load;
    model.A = load_A;
    model.g = current;
    model.B = give_1;
    model.h = shockley;
    model.C = shockley_C;
    model.D = shockley_D;
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    ns_newton *s;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, all_0, NULL), NS_OK);
    return s;
}

/* lambda of the implicit step of h from x to a source of z, by bisection: x+ = (C x + h lambda) / (C + h/R),
 * and what the diode would carry falls with lambda. */
static double implicit(const diode *d, double x, double h, double z) {
    long double low = -Is, high = 1000;
    for (int k = 0; k < 200; k++) {
        const long double mid = (low + high) / 2, end = (d->C * (long double)x + h * mid) / (d->C + h / d->R);
        *(mid < Is * expm1l((z - end - d->Rs * mid) / Vt) ? &low : &high) = mid;
    }
    return (double)low;
}

/* From rest to V in one step: 28 to 680 Vt. */
static void a_source_jumps_by_many_Vt(void **state) {
    (void)state;
    const double to[] = {0.7, 1.4, 1.6, 1.8, 2.4, 10, 17}, below[] = {-INFINITY, 0}, times[2] = {0, 0.1};
    double worst = 0;
    for (int k = 0; k < 14; k++) {
        diode d = {1, 1, 0};
        const double V = to[k / 2], values[2] = {0, V}, h = times[1];
        ns_signal z = {.kind = NS_PWL};
        double x, lambda, y;
        z.u.pwl.n = 2;
        z.u.pwl.t = times;
        z.u.pwl.v = values;
        z.u.pwl.repeat = NAN;
        ns_newton *s = start(&d, &z, &below[k % 2]);
        assert_int_equal(ns_newton_try(s, h), NS_OK);
        assert_int_equal(ns_newton_accept(s), NS_OK);
        assert_int_equal(ns_newton_read(s, NULL, &x, &lambda, &y, NULL), NS_OK);
        const double right = implicit(&d, 0, h, V);
        worst = fmax(worst, fabs(lambda / right - 1));
        assert_true(fabs(x - h * lambda / (1 + h)) < 1e-14 * V && y == 0);
        assert_true((double)ns_newton_counts_of(s)->iterations < 10 + V / Vt); /* one Vt an iteration */
        ns_newton_free(s);
    }
    print_message("lambda %.1e\n", worst);
    assert_true(worst < 1e-11); /* 1e-12 of terms like lambda x/Vt, over a slope of lambda/Vt */
}

/* A half-wave rectifier, 12 V and 50 Hz, 20 and 50 steps a period: every step taken solves its equations. */
static void a_rectifier_at_few_steps(void **state) {
    (void)state;
    double worst = 0;
    for (int steps = 20; steps <= 50; steps += 30) {
        diode d = {1e-3, 100, 0.1};
        ns_signal z = {.kind = NS_SIN};
        double t = 0, x = 0, lambda;
        z.u.sin.va = 12;
        z.u.sin.freq = 50;
        const double none = -INFINITY;
        ns_newton *s = start(&d, &z, &none);
        for (int k = 1; k <= 3 * steps; k++) {
            const double before = x, h = k * 0.02 / steps - t;
            assert_int_equal(ns_newton_try(s, h), NS_OK);
            assert_int_equal(ns_newton_accept(s), NS_OK);
            assert_int_equal(ns_newton_read(s, &t, &x, &lambda, NULL, NULL), NS_OK);
            const double right = implicit(&d, before, h, ns_signal_value(&z, t, NS_LEFT));
            worst = fmax(worst, fabs(lambda - right) / (1 + right));
        }
        ns_newton_free(s);
    }
    print_message("lambda %.1e\n", worst);
    assert_true(worst < 1e-10); /* 1e-12 of terms like lambda x/Vt = 100 lambda */
}

/* M x' = 1 - e^x and M x' = -73361.9 - sinh(x/10)/10, x_j' = -x_j beside it. */
typedef struct steep {
    double (*f)(double x), (*slope)(double x);
    long double (*precise)(long double x);
    int n;
} steep;

static double exp_f(double x) {
    return 1 - exp(x);
}

static double exp_slope(double x) {
    return -exp(x);
}

static long double exp_precise(long double x) {
    return -expm1l(x);
}

static double sinh_f(double x) {
    return -73361.9 - 0.1 * sinh(x / 10);
}

static double sinh_slope(double x) {
    return -0.01 * cosh(x / 10);
}

static long double sinh_precise(long double x) {
    return -73361.9 - 0.1L * sinhl(x / 10);
}

static int steep_f(const ns_point *at, void *data, double *out) {
    const steep *e = data;
    out[0] = e->f(at->x[0]);
    for (int j = 1; j < e->n; j++)
        out[j] = -at->x[j];
    return !isfinite(out[0]);
}

static int steep_A(const ns_point *at, void *data, double *out) {
    const steep *e = data;
    for (int k = 0; k < e->n * e->n; k++)
        out[k] = k % (e->n + 1) == 0 ? -1 : 0;
    out[0] = e->slope(at->x[0]);
    return !isfinite(out[0]);
}

/* M (x - x0) = h f(x), f falling, by bisection. */
static double steep_end(const steep *e, double M, double x0, double h) {
    long double low = -1e4, high = 1e4;
    for (int k = 0; k < 200; k++) {
        const long double mid = (low + high) / 2;
        *(M * (mid - x0) < h * e->precise(mid) ? &low : &high) = mid;
    }
    return (double)low;
}

/* One step of h; its error against the larger of |x| and 1. */
static double steep_error(steep *e, double M, double x0, double h) {
    const double Ms[9] = {M, 0, 0, 0, 1, 0, 0, 0, 1}, right = steep_end(e, M, x0, h);
    const ns_model model = {.n = e->n, .M = Ms, .f = steep_f, .A = steep_A, .data = e};
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    double x[3] = {x0, 0, 1};
    ns_newton *s;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, x, NULL), NS_OK);
    assert_int_equal(ns_newton_try(s, h), NS_OK);
    assert_int_equal(ns_newton_accept(s), NS_OK);
    assert_int_equal(ns_newton_read(s, NULL, x, NULL, NULL, NULL), NS_OK);
    print_message("x0 %g: %.15g, right %.15g\n", x0, x[0], right);
    if (e->n == 3)
        assert_true(x[1] == 0 && fabs(x[2] * (1 + h) - 1) < 1e-12);
    ns_newton_free(s);
    return fabs(x[0] - right) / fmax(fabs(right), 1);
}

/* Beyond 703 the terms e^x x of the residual overflow, e^x does not; the sinh is met at x = -7098.8 on the
 * way, e^709.9. */
static void terms_overflow(void **state) {
    (void)state;
    const double x0s[] = {703, 704, 706, 709}, Ms[] = {0, 1e-3};
    steep e = {exp_f, exp_slope, exp_precise, 1}, to_sinh = {sinh_f, sinh_slope, sinh_precise, 1};
    for (int k = 0; k < 8; k++)
        assert_true(steep_error(&e, Ms[k / 4], x0s[k % 4], 1) < 2e-12); /* 1e-12 of terms up to 2.6 */
    assert_true(steep_error(&to_sinh, 0, 62.377, 1) < 2e-12);           /* 1e-12 of terms like x */
}

/* The first full correction lands between -7095 and -7023: h f overflows there and f does not, and rows
 * without trouble come after. */
static void residuals_overflow(void **state) {
    (void)state;
    const double x0s[] = {76.25, 76.3, 76.35};
    steep e = {sinh_f, sinh_slope, sinh_precise, 3};
    for (int k = 0; k < 3; k++)
        assert_true(steep_error(&e, 1, x0s[k], 1e6) < 2e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_source_jumps_by_many_Vt),
        cmocka_unit_test(a_rectifier_at_few_steps),
        cmocka_unit_test(terms_overflow),
        cmocka_unit_test(residuals_overflow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
