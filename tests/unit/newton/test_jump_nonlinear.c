/* tests/unit/newton/test_jump_nonlinear.c - the impulse problem where r and y are no linear functions. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "callbacks.h"
#include "newton_bench.h"

/* Nonlinear: a box lambda in [-1,1] with r = lambda^3 + 2 lambda pushes v off y = v - 1 no further than it
 * can: an impulse needs lambda without bound, so v stays; with l = -inf it goes. */
static int cubic_g(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = 2 * at->lambda[0] + at->x[0] * at->lambda[0];
    return 0;
}

static int cubic_B(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = 2 + at->x[0];
    return 0;
}

static int cubic_K(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->lambda[0];
    return 0;
}

static int square_h(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->x[0] * at->x[0] - 1;
    return 0;
}

static int square_C(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = 2 * at->x[0];
    return 0;
}

static void nonlinear_relations_jump(void **state) {
    (void)state;
    static const double one[1] = {1};
    const double low[2] = {-1, -INFINITY}, high[2] = {1, INFINITY}, end[2] = {3, 1}, x0 = 3;
    for (int k = 0; k < 2; k++) {
        double x, lambda, y;
        const ns_model model = {.n = 1,
                                .m = 1,
                                .M = one,
                                .l = &low[k],
                                .u = &high[k],
                                .f = give_0,
                                .A = give_0,
                                .g = cubic_g,
                                .B = cubic_B,
                                .K = cubic_K,
                                .h = square_h,
                                .C = square_C};
        ns_newton *t = start(&model, &x0);
        jump(t, &x, &lambda, &y);
        assert_true(fabs(x - end[k]) < 1e-11);
        assert_true(k ? fabs(lambda) < 1e-6 && y == 0 : lambda == -1 && fabs(y - 8) < 1e-6);
        ns_newton_free(t);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nonlinear_relations_jump)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
