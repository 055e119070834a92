/* tests/unit/system/test_jacobian.c - the checker of Jacobians: right ones pass at any scale, each wrong one
 * is found and named. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "wrap_alloc.h"

enum { N = 3, P = 2 };

/* What is made wrong, and the sizes of the unknowns. */
typedef struct spoiled {
    double sx[N], sl[P]; /* x_i and lambda_i are about this large */
    double out;          /* f, g, h are about this large */
    int which, row, column;
    double factor; /* of that entry */
    int transpose; /* of A */
} spoiled;

/* With u = x / sx, v = lambda / sl:
 *   f = out (exp(u0) + u1 u2, sin(u1) + u0, u2^3 + 2 u0 + t)
 *   g = out (v0 u0, v1 + u1^2, v0 v1)      h = out (u0 + v0^3, u1 v1 - u2) */
static int f(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    const double u[N] = {at->x[0] / p->sx[0], at->x[1] / p->sx[1], at->x[2] / p->sx[2]};
    out[0] = p->out * (exp(u[0]) + u[1] * u[2]);
    out[1] = p->out * (sin(u[1]) + u[0]);
    out[2] = p->out * (pow(u[2], 3) + 2 * u[0] + at->t);
    return 0;
}

static int g(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    const double v0 = at->lambda[0] / p->sl[0], v1 = at->lambda[1] / p->sl[1];
    out[0] = p->out * v0 * at->x[0] / p->sx[0];
    out[1] = p->out * (v1 + pow(at->x[1] / p->sx[1], 2));
    out[2] = p->out * v0 * v1;
    return 0;
}

static int h(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    const double v0 = at->lambda[0] / p->sl[0], v1 = at->lambda[1] / p->sl[1];
    out[0] = p->out * (at->x[0] / p->sx[0] + pow(v0, 3));
    out[1] = p->out * (at->x[1] / p->sx[1] * v1 - at->x[2] / p->sx[2]);
    return 0;
}

/* Entries in u and v to entries in x and lambda, one of them spoiled. */
static void finish(const spoiled *p, int which, int rows, int columns, const double *scale, double *out) {
    for (int j = 0; j < columns; j++)
        for (int i = 0; i < rows; i++) {
            out[i + j * rows] *= p->out / scale[j];
            if (p->which == which && p->row == i && p->column == j)
                out[i + j * rows] *= p->factor;
        }
}

static int A(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    const double u[N] = {at->x[0] / p->sx[0], at->x[1] / p->sx[1], at->x[2] / p->sx[2]};
    const double a[N * N] = {exp(u[0]), 1, 2, u[2], cos(u[1]), 0, u[1], 0, 3 * u[2] * u[2]};
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            out[i + j * N] = p->transpose ? a[j + i * N] : a[i + j * N];
    finish(p, NS_JACOBIAN_A, N, N, p->sx, out);
    return 0;
}

static int K(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    for (int i = 0; i < N * N; i++)
        out[i] = 0;
    out[0] = at->lambda[0] / p->sl[0];
    out[1 + N] = 2 * at->x[1] / p->sx[1];
    finish(p, NS_JACOBIAN_K, N, N, p->sx, out);
    return 0;
}

static int B(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    const double v0 = at->lambda[0] / p->sl[0], v1 = at->lambda[1] / p->sl[1];
    const double b[N * P] = {at->x[0] / p->sx[0], 0, v1, 0, 1, v0};
    for (int i = 0; i < N * P; i++)
        out[i] = b[i];
    finish(p, NS_JACOBIAN_B, N, P, p->sl, out);
    return 0;
}

static int C(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    const double c[P * N] = {1, 0, 0, at->lambda[1] / p->sl[1], 0, -1};
    for (int i = 0; i < P * N; i++)
        out[i] = c[i];
    finish(p, NS_JACOBIAN_C, P, N, p->sx, out);
    return 0;
}

static int D(const ns_point *at, void *data, double *out) {
    const spoiled *p = data;
    const double v0 = at->lambda[0] / p->sl[0];
    const double d[P * P] = {3 * v0 * v0, 0, 0, at->x[1] / p->sx[1]};
    for (int i = 0; i < P * P; i++)
        out[i] = d[i];
    finish(p, NS_JACOBIAN_D, P, P, p->sl, out);
    return 0;
}

static const double M[N * N] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, low[P], high[P] = {INFINITY, INFINITY};

static ns_model model_of(spoiled *p) {
    return (ns_model){.n = N,
                      .m = P,
                      .M = M,
                      .l = low,
                      .u = high,
                      .data = p,
                      .f = f,
                      .A = A,
                      .g = g,
                      .B = B,
                      .h = h,
                      .C = C,
                      .K = K,
                      .D = D};
}

static ns_jacobian_error check(const ns_model *model, const spoiled *p, double u, double v) {
    const double x[N] = {0.3 * u * p->sx[0], -0.7 * u * p->sx[1], 0.9 * u * p->sx[2]};
    const double lambda[P] = {0.6 * v * p->sl[0], 1.1 * v * p->sl[1]};
    ns_jacobian_error e;
    assert_int_equal(ns_model_check_jacobians(model, 0.5, x, lambda, &e), NS_OK);
    return e;
}

static const spoiled right = {{1, 1, 1}, {1, 1}, 1, -1, 0, 0, 1, 0};

static void right_ones_pass_at_any_scale(void **state) {
    (void)state;
    const double scale[] = {1e-12, 1e-6, 1, 1e6, 1e12};
    double worst = 0;
    for (int k = 0; k < 125; k++) {
        spoiled p = right;
        p.sx[0] = scale[k % 5];
        p.sx[1] = scale[k / 5 % 5];
        p.sl[0] = scale[k / 25];
        p.sl[1] = p.sx[2] = scale[(k + 2) % 5];
        p.out = scale[(k / 5 + 3) % 5];
        const ns_model model = model_of(&p);
        worst = fmax(worst, check(&model, &p, 1, 1).error);
        worst = fmax(worst, check(&model, &p, 0, 0).error); /* where nothing says how large x is */
        worst = fmax(worst, check(&model, &p, 1, 0).error);
    }
    print_message("right at all scales: %.1e\n", worst);
    assert_true(worst < 1e-8); /* eps^(2/3) of a second-order difference, extrapolated: better than that */
}

/* Every entry that is not zero, with its sign turned, ten percent off, and missing. */
static void every_wrong_entry_is_found(void **state) {
    (void)state;
    const int rows[] = {N, N, N, P, P}, columns[] = {N, N, P, N, P};
    const double factors[] = {-1, 1.1, 0, 1.000001}, error[] = {2, 1 - 1 / 1.1, 1, 1e-6};
    int found = 0;
    for (int which = 0; which < 5; which++)
        for (int e = 0; e < rows[which] * columns[which]; e++)
            for (int k = 0; k < 4; k++) {
                spoiled p = right;
                p.sx[1] = 1e-9;
                p.sl[0] = 1e6;
                p.which = which;
                p.row = e % rows[which];
                p.column = e / rows[which];
                p.factor = factors[k];
                const ns_model model = model_of(&p);
                const ns_jacobian_error got = check(&model, &p, 1, 1);
                if (got.error < 1e-8)
                    continue; /* the entry is zero */
                found++;
                assert_true(fabs(got.error / error[k] - 1) < 1e-2);
                assert_int_equal(got.which, which);
                assert_int_equal(got.row, p.row);
                assert_int_equal(got.column, p.column);
            }
    assert_int_equal(found, 4 * (7 + 2 + 4 + 3 + 2)); /* entries of A, K, B, C, D that are not zero */
}

static void a_transposed_or_missing_one_is_found(void **state) {
    (void)state;
    spoiled p = right;
    p.transpose = 1;
    ns_model model = model_of(&p);
    assert_int_equal(check(&model, &p, 1, 1).which, NS_JACOBIAN_A);
    assert_true(check(&model, &p, 1, 1).error > 0.1);
    p = right;
    model.K = NULL;
    ns_jacobian_error e = check(&model, &p, 1, 1);
    assert_int_equal(e.which, NS_JACOBIAN_K);
    assert_true(fabs(e.error - 1) < 1e-8);
    model = model_of(&p);
    model.D = NULL;
    e = check(&model, &p, 1, 1);
    assert_int_equal(e.which, NS_JACOBIAN_D);
    assert_true(fabs(e.error - 1) < 1e-8);
    assert_true(e.given == 0 && fabs(e.expected) > 0.1);
}

static int saturated(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = tanh(at->x[0]) + 1e3;
    return 0;
}

static int saturated_A(const ns_point *at, void *data, double *out) {
    out[0] = *(const double *)data * (1 - pow(tanh(at->x[0]), 2));
    return 0;
}

/* log(x) is refused for x <= 0: steps that leave the domain are left out. */
static int logarithm(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->x[0] > 0 ? log(at->x[0]) : 0;
    return at->x[0] > 0 ? 0 : 1;
}

static int logarithm_A(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = 1 / at->x[0];
    return 0;
}

static int wild(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = NAN;
    return 0;
}

static void flat_far_out_and_domains(void **state) {
    (void)state;
    double factor = 1, x = 0;
    ns_jacobian_error e;
    ns_model model = {.n = 1, .M = M, .data = &factor, .f = saturated, .A = saturated_A};
    assert_int_equal(ns_model_check_jacobians(&model, 0, &x, NULL, &e), NS_OK);
    assert_true(e.error < 1e-8);
    factor = 1.01;
    assert_int_equal(ns_model_check_jacobians(&model, 0, &x, NULL, &e), NS_OK);
    assert_true(fabs(e.error - 0.01 / 1.01) < 1e-6);
    model.f = logarithm;
    model.A = logarithm_A;
    x = 1e-3;
    assert_int_equal(ns_model_check_jacobians(&model, 0, &x, NULL, &e), NS_OK);
    assert_true(e.error < 1e-8);
    x = -1;
    assert_int_equal(ns_model_check_jacobians(&model, 0, &x, NULL, &e), NS_E_NUMBER);
    model.A = wild;
    x = 1;
    assert_int_equal(ns_model_check_jacobians(&model, 0, &x, NULL, &e), NS_E_NUMBER);
}

static void bad_input_is_refused(void **state) {
    (void)state;
    spoiled p = right;
    ns_model model = model_of(&p);
    const double x[N] = {0}, bad[N] = {0, NAN, 0}, lambda[P] = {0};
    ns_jacobian_error e;
    assert_int_equal(ns_model_check_jacobians(NULL, 0, x, lambda, &e), NS_E_NULL);
    assert_int_equal(ns_model_check_jacobians(&model, 0, NULL, lambda, &e), NS_E_NULL);
    assert_int_equal(ns_model_check_jacobians(&model, 0, x, NULL, &e), NS_E_NULL);
    assert_int_equal(ns_model_check_jacobians(&model, 0, x, lambda, NULL), NS_E_NULL);
    assert_int_equal(ns_model_check_jacobians(&model, NAN, x, lambda, &e), NS_E_NUMBER);
    assert_int_equal(ns_model_check_jacobians(&model, 0, bad, lambda, &e), NS_E_NUMBER);
    fail_alloc_at(1);
    const int status = ns_model_check_jacobians(&model, 0, x, lambda, &e);
    fail_alloc_off();
    assert_int_equal(status, NS_E_MEMORY);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(right_ones_pass_at_any_scale),
        cmocka_unit_test(every_wrong_entry_is_found),
        cmocka_unit_test(a_transposed_or_missing_one_is_found),
        cmocka_unit_test(flat_far_out_and_domains),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
