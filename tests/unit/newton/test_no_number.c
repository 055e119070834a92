/* tests/unit/newton/test_no_number.c - functions and Jacobians of a model that give NaN. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "callbacks.h"
#include "newton/newton_internal.h"
#include "nonsmooth.h"

/* Two unknowns, two pairs: x' = -x + B lambda with g = x/8 + lambda, y = lambda + x.  The function named by
 * `bad` gives NaN as its last entry, all others are finite. */
enum { OF_F, OF_A, OF_G, OF_B, OF_K, OF_H, OF_C, OF_D, NONE_BAD };

static int give_two(const ns_point *at, const int *bad, int which, double own, double lambda, double *out) {
    for (int i = 0; i < 2; i++)
        out[i] = own * at->x[i] + lambda * at->lambda[i];
    if (*bad == which)
        out[1] = NAN;
    return 0;
}

static int give_diagonal(const int *bad, int which, double entry, double *out) {
    out[0] = out[3] = entry;
    out[1] = out[2] = 0;
    if (*bad == which)
        out[3] = NAN;
    return 0;
}

#define OF_TWO(name, which, own, lambda)                                                                     \
    static int name(const ns_point *at, void *data, double *out) {                                           \
        return give_two(at, data, which, own, lambda, out);                                                  \
    }
#define DIAGONAL(name, which, entry)                                                                         \
    static int name(const ns_point *at, void *data, double *out) {                                           \
        (void)at;                                                                                            \
        return give_diagonal(data, which, entry, out);                                                       \
    }
OF_TWO(two_f, OF_F, -1, 0)
OF_TWO(two_g, OF_G, 0.125, 1)
OF_TWO(two_h, OF_H, 1, 1)
DIAGONAL(two_A, OF_A, -1)
DIAGONAL(two_K, OF_K, 0.125)
DIAGONAL(two_B, OF_B, 1)
DIAGONAL(two_C, OF_C, 1)
DIAGONAL(two_D, OF_D, 1)

/* NaN in the last entry of any function or Jacobian ends the step, and the point stays. */
static void no_number_is_told(void **state) {
    (void)state;
    for (int bad = 0; bad <= NONE_BAD; bad++) {
        const double M[4] = {1, 0, 0, 1}, x0[2] = {-1, -2};
        double x[2], t;
        int which = NONE_BAD;
        const ns_model model = {.n = 2,
                                .m = 2,
                                .M = M,
                                .l = all_0,
                                .u = all_infinite,
                                .data = &which,
                                .f = two_f,
                                .A = two_A,
                                .g = two_g,
                                .B = two_B,
                                .K = two_K,
                                .h = two_h,
                                .C = two_C,
                                .D = two_D};
        const ns_newton_options o = {.theta = 1, .gamma = 1};
        ns_newton *s;
        assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
        assert_int_equal(ns_newton_start(s, 0, x0, NULL), NS_OK);
        which = bad;
        const int status = ns_newton_try(s, 0.1);
        assert_int_equal(status, bad == NONE_BAD ? NS_OK : NS_DIVERGED);
        assert_int_equal(ns_newton_read(s, &t, x, NULL, NULL, NULL), NS_OK);
        assert_true(t == 0 && x[0] == -1 && x[1] == -2);
        ns_newton_set(s, 0.1, 0.1, &o, NS_LEFT);
        memcpy(s->at.x, x0, sizeof x0);
        memset(s->at.lambda, 0, sizeof x0);
        const int in_values = bad == OF_F || bad == OF_G || bad == OF_H;
        assert_int_equal(ns_newton_values(s, &s->at), in_values ? NS_E_NUMBER : NS_OK);
        assert_int_equal(ns_newton_jacobians(s, &s->at), in_values || bad == NONE_BAD ? NS_OK : NS_E_NUMBER);
        ns_newton_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_number_is_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
