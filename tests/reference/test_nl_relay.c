/* tests/reference/test_nl_relay.c - a relay on a nonlinear plant: its sliding mode is reached in finite time.
 *
 *   x' = (1 + x^2) (a - lambda),   lambda in sgn(x)        0 < a < 1
 *
 * While x > 0, lambda = 1 and  d/dt atan x = a - 1:   x(t) = tan(atan x0 - (1-a) t),  zero at
 * t* = atan(x0)/(1-a);  from then on x = 0 and lambda = a.  f, g and all of their Jacobians are nonlinear.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double a = 0.4, x0 = 2;

static int f(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = a * (1 + p->x[0] * p->x[0]);
    return 0;
}

static int A(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = 2 * a * p->x[0];
    return 0;
}

static int g(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = -(1 + p->x[0] * p->x[0]) * p->lambda[0];
    return 0;
}

static int K(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = -2 * p->x[0] * p->lambda[0];
    return 0;
}

static int B(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = -(1 + p->x[0] * p->x[0]);
    return 0;
}

/* -y in N_[-1,1](lambda): lambda = 1 where y < 0 */
static int h(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = -p->x[0];
    return 0;
}

static int C(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    out[0] = -1;
    return 0;
}

static const double one = 1, low = -1, high = 1;
static const ns_model relay = {
    .n = 1, .m = 1, .M = &one, .l = &low, .u = &high, .f = f, .A = A, .g = g, .B = B, .h = h, .C = C, .K = K};

static ns_newton *begin(double theta, double gamma, ns_relation relation) {
    const ns_newton_options o = {.theta = theta, .gamma = gamma, .relation = relation};
    ns_newton *s;
    assert_int_equal(ns_newton_create(&relay, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, &x0, &one), NS_OK);
    return s;
}

static double x_at(ns_newton *s, double t, double step, double *lambda) {
    double x;
    assert_int_equal(ns_newton_advance(s, t, step), NS_OK);
    assert_int_equal(ns_newton_read(s, NULL, &x, lambda, NULL, NULL), NS_OK);
    return x;
}

static void jacobians(void **state) {
    (void)state;
    ns_jacobian_error worst;
    const double x = 0.7, lambda = 0.3;
    assert_int_equal(ns_model_check_jacobians(&relay, 0, &x, &lambda, &worst), NS_OK);
    assert_true(worst.error < 1e-6);
}

static double error_at_1(double theta, double gamma, ns_relation relation, double step) {
    ns_newton *s = begin(theta, gamma, relation);
    const double e = x_at(s, 1, step, NULL) - tan(atan(x0) - (1 - a));
    ns_newton_free(s);
    return fabs(e);
}

/* t = 1 lies before t* = 1.845: a smooth arc. */
static void orders_on_the_arc(void **state) {
    (void)state;
    const double first = error_at_1(1, 1, NS_RELATION_END, 0.01) / error_at_1(1, 1, NS_RELATION_END, 0.005);
    const double second =
        error_at_1(0.5, 0.5, NS_RELATION_END, 0.02) / error_at_1(0.5, 0.5, NS_RELATION_END, 0.01);
    print_message("errors fall by %.3f (theta 1), %.3f (theta 1/2)\n", first, second);
    assert_true(first > 1.9 && first < 2.1);
    assert_true(second > 3.8 && second < 4.2);
}

/* Steps of h reach zero within h (and the first order error) of t*, and stay there: no chatter. */
static void slides(void **state) {
    (void)state;
    const double arrival = atan(x0) / (1 - a), lengths[4] = {1e-2, 2.5e-3, 6.25e-4, 1.5625e-4};
    double last = 0;
    print_message("x' = (1 + x^2)(0.4 - sgn x), x(0) = 2; arrives at %.5f (exact)\n"
                  "    h         arrives at   x off, before   |x|, sliding   lambda off   changes, sliding\n",
                  arrival);
    for (int i = 0; i < 4; i++) {
        const double h = lengths[i];
        ns_newton *s = begin(1, 1, NS_RELATION_END);
        double reached = NAN, off = 0, most = 0, law = 0, lambda;
        int changes = 0;
        for (int k = 1; k * h <= 2.5; k++) {
            const double x = x_at(s, k * h, h, &lambda);
            if (isnan(reached) && fabs(lambda) < 1)
                reached = k * h; /* in a step that takes what is left to take */
            else if (isnan(reached))
                off = fmax(off, fabs(x - tan(fmax(0, atan(x0) - (1 - a) * k * h))));
            else {
                most = fmax(most, fabs(x));
                law = fmax(law, fabs(lambda - a));
                changes += fabs(lambda) == 1;
            }
        }
        print_message("    %-7.2g   %-10.5f   %-13.2e   %-12.1e   %-10.1e   %d\n", h, reached, off, most, law,
                      changes);
        assert_true(fabs(reached - arrival) < 3 * h);
        assert_true(most < 1e-13 && law < 1e-13 / h && changes == 0);
        assert_true(i == 0 || (last / off > 3.6 && last / off < 4.4)); /* first order: 4 */
        last = off;
        ns_newton_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jacobians),
        cmocka_unit_test(orders_on_the_arc),
        cmocka_unit_test(slides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
