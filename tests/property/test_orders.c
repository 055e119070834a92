/* tests/property/test_orders.c - observed orders of Newton's theta-gamma step: errors at h, h/2, h/4, h/8 and
 * the slopes between them, as a table.
 *
 * Closed forms:
 *   logistic   x' = x (1 - x),  x(0) = 1/10:  x(t) = 1 / (1 + 9 e^-t)
 *   law        x' = -lambda,  y = lambda + lambda^3 - x,  0 <= y _|_ lambda >= 0, x > 0:
 *              lambda + lambda^3 = x, so (1 + 3 lambda^2) lambda' = -lambda:
 *              ln lambda + 3/2 lambda^2 = const - t
 *   drop       x' = -x^2 + r,  r = x lambda,  y = x - 1/2,  0 <= y _|_ lambda >= 0, x(0) = 2:
 *              x = 1 / (1/2 + t) until it meets 1/2 at t = 3/2, where lambda = 1/2 holds it (K = lambda)
 *   bridge     the LC bridge (systems.h): the diodes commutate at every zero of v and of the current
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "callbacks.h"
#include "systems.h"

typedef struct scene {
    const char *name;
    ns_model model;
    double x0[2], lambda0[4], end;
    int jump; /* starts with ns_newton_jump(), which finds lambda */
    double (*error)(double end, const double *x, const double *lambda);
} scene;

static const double one[4] = {1, 0, 0, 1};

static int logistic_f(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->x[0] * (1 - at->x[0]);
    return 0;
}

static int logistic_A(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = 1 - 2 * at->x[0];
    return 0;
}

static double logistic_error(double end, const double *x, const double *lambda) {
    (void)lambda;
    return fabs(x[0] - 1 / (1 + 9 * exp(-end)));
}

static int law_h(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->lambda[0] + pow(at->lambda[0], 3) - at->x[0];
    return 0;
}

static int law_D(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = 1 + 3 * at->lambda[0] * at->lambda[0];
    return 0;
}

/* lambda from ln lambda + 3/2 lambda^2 = c - t by bisection; x = 2 at t = 0, where lambda = 1. */
static double law_error(double end, const double *x, const double *lambda) {
    double low = 1e-6, high = 1;
    (void)lambda;
    for (int k = 0; k < 200; k++) {
        const double mid = (low + high) / 2;
        *(log(mid) + 1.5 * mid * mid > 1.5 - end ? &high : &low) = mid;
    }
    return fabs(x[0] - (low + low * low * low));
}

static int drop_f(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = -at->x[0] * at->x[0];
    return 0;
}

static int drop_A(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = -2 * at->x[0];
    return 0;
}

static int drop_g(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->x[0] * at->lambda[0];
    return 0;
}

static int drop_K(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->lambda[0];
    return 0;
}

static int drop_B(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->x[0];
    return 0;
}

static int drop_h(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->x[0] - 0.5;
    return 0;
}

static double drop_error(double end, const double *x, const double *lambda) {
    (void)lambda;
    return fabs(x[0] - 1 / (0.5 + end));
}

static double bridge_error(double end, const double *x, const double *lambda) {
    (void)lambda;
    return fabs(x[0] - lc_bridge_v(10, end));
}

static double error_of(const scene *p, const ns_newton_options *o, int steps) {
    ns_newton *s;
    double x[2], lambda[4];
    assert_int_equal(ns_newton_create(&p->model, o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, p->x0, p->lambda0), NS_OK);
    if (p->jump) {
        assert_int_equal(ns_newton_jump(s), NS_OK);
        assert_int_equal(ns_newton_accept(s), NS_OK);
    }
    assert_int_equal(ns_newton_advance(s, p->end, p->end / steps), NS_OK);
    assert_int_equal(ns_newton_read(s, NULL, x, lambda, NULL, NULL), NS_OK);
    ns_newton_free(s);
    return p->error(p->end, x, lambda);
}

/* The slope over the two last halvings; the table's row. */
static double slope(const scene *p, double theta, double gamma, ns_relation relation, int steps) {
    const ns_newton_options o = {.theta = theta, .gamma = gamma, .relation = relation};
    double e[4];
    for (int k = 0; k < 4; k++)
        e[k] = error_of(p, &o, steps << k);
    const double order = log2(e[1] / e[3]) / 2;
    print_message("%-9s %5.2f %5.2f %-6s %9.2e %9.2e %9.2e %9.2e   %5.2f\n", p->name, theta, gamma,
                  relation == NS_RELATION_END ? "end" : "gamma", e[0], e[1], e[2], e[3], order);
    return order;
}

static scene make_logistic(void) {
    return (scene){.name = "logistic",
                   .model = {.n = 1, .M = one, .f = logistic_f, .A = logistic_A},
                   .x0 = {0.1},
                   .end = 3,
                   .error = logistic_error};
}

static scene make_law(void) {
    return (scene){.name = "law",
                   .model = {.n = 1,
                             .m = 1,
                             .M = one,
                             .l = all_0,
                             .u = all_infinite,
                             .f = give_0,
                             .A = give_0,
                             .g = give_minus_lambda,
                             .B = give_minus_1,
                             .h = law_h,
                             .C = give_minus_1,
                             .D = law_D},
                   .x0 = {2},
                   .lambda0 = {1},
                   .end = 2,
                   .error = law_error};
}

static scene make_drop(void) {
    return (scene){.name = "drop",
                   .model = {.n = 1,
                             .m = 1,
                             .M = one,
                             .l = all_0,
                             .u = all_infinite,
                             .f = drop_f,
                             .A = drop_A,
                             .g = drop_g,
                             .K = drop_K,
                             .B = drop_B,
                             .h = drop_h,
                             .C = give_1},
                   .x0 = {2},
                   .end = 1,
                   .error = drop_error};
}

/* v (10 V, i = 0) over somewhat more than three half periods: diodes commutate six times. */
static scene make_bridge(ns_system *s) {
    scene p = {.name = "bridge", .x0 = {10, 0}, .end = 1e-3, .jump = 1, .error = bridge_error};
    assert_int_equal(ns_model_of_system(s, &p.model), NS_OK);
    return p;
}

static void heading(void) {
    print_message("scene     theta gamma relation  h         h/2       h/4       h/8     order\n");
}

static void smooth_arcs(void **state) {
    (void)state;
    const scene all[] = {make_logistic(), make_law(), make_drop()};
    heading();
    for (int k = 0; k < 3; k++) { /* the next term of the error is h/end = 1/80 of it, times a few */
        assert_in_range((int)(100 * slope(&all[k], 1, 1, NS_RELATION_END, 40)), 92, 108);
        assert_in_range((int)(100 * slope(&all[k], 0, 1, NS_RELATION_END, 40)), 92, 108);
        assert_in_range((int)(100 * slope(&all[k], 0.5, 0.5, NS_RELATION_END, 40)), 190, 210);
        assert_in_range((int)(100 * slope(&all[k], 0.5, 0.5, NS_RELATION_GAMMA, 40)), 190, 210);
    }
}

static void bridge(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    const scene p = make_bridge(s);
    heading(); /* r is continuous where the diodes commutate: the order is that of the arcs */
    assert_in_range((int)(100 * slope(&p, 1, 1, NS_RELATION_END, 1000)), 95, 105);
    assert_in_range((int)(100 * slope(&p, 0.5, 1, NS_RELATION_END, 1000)), 95, 105);
    assert_in_range((int)(100 * slope(&p, 0.5, 1, NS_RELATION_GAMMA, 1000)), 95, 105);
    assert_in_range((int)(100 * slope(&p, 0.5, 0.5, NS_RELATION_END, 1000)), 195, 205);
    assert_in_range((int)(100 * slope(&p, 0.5, 0.5, NS_RELATION_GAMMA, 1000)), 195, 205);
    ns_system_free(s);
}

static int relay_f(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->x[0];
    out[1] = 0;
    return 0;
}

static int relay_A(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = 1;
    out[1] = out[2] = out[3] = 0;
    return 0;
}

static int relay_g(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = 0;
    out[1] = at->lambda[0];
    return 0;
}

static int relay_B(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = 0;
    out[1] = 1;
    return 0;
}

static int relay_h(const ns_point *at, void *data, double *out) {
    out[0] = *(const double *)data - at->x[0];
    return 0;
}

static int relay_C(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = -1;
    out[1] = 0;
    return 0;
}

static double relay_at; /* the threshold of the relay at hand */

static double relay_error(double end, const double *x, const double *lambda) {
    (void)lambda;
    return fabs(x[1] - (end - 2 * log(relay_at)));
}

/* x1' = x1 from 1, x2' = lambda, a relay in [-1,1] that x1 throws at c: x2 = t - 2 ln c afterwards.  What an
 * event costs depends on where in a step it falls, so the worst of 32 places is taken. */
static void across_an_event(void **state) {
    (void)state;
    static const double low[1] = {-1}, high[1] = {1};
    const struct {
        double theta, gamma;
        ns_relation relation;
    } all[] = {{1, 1, NS_RELATION_END}, {0.5, 0.5, NS_RELATION_END}, {0.5, 0.5, NS_RELATION_GAMMA}};
    heading();
    for (int k = 0; k < 3; k++) {
        double worst[2] = {0, 0};
        for (int place = 0; place < 32; place++) {
            relay_at = 1.5 + place * 1.37e-3;
            const scene p = {.model = {.n = 2,
                                       .m = 1,
                                       .M = one,
                                       .l = low,
                                       .u = high,
                                       .data = &relay_at,
                                       .f = relay_f,
                                       .A = relay_A,
                                       .g = relay_g,
                                       .B = relay_B,
                                       .h = relay_h,
                                       .C = relay_C},
                             .x0 = {1, 0},
                             .lambda0 = {-1},
                             .end = 1,
                             .error = relay_error};
            const ns_newton_options o = {
                .theta = all[k].theta, .gamma = all[k].gamma, .relation = all[k].relation};
            worst[0] = fmax(worst[0], error_of(&p, &o, 40));
            worst[1] = fmax(worst[1], error_of(&p, &o, 320));
        }
        const double order = log2(worst[0] / worst[1]) / 3;
        print_message("%-9s %5.2f %5.2f %-6s %9.2e %29.2e   %5.2f\n", "relay", all[k].theta, all[k].gamma,
                      all[k].relation == NS_RELATION_END ? "end" : "gamma", worst[0], worst[1], order);
        assert_in_range((int)(100 * order), 85, 115); /* 32 places miss the worst by some percent */
    }
}

/* The linear engine with theta = 0 is explicit: x' = -x to t = 1. */
static double explicit_error(double h) {
    ns_system *s = system_decay();
    const ns_march_options o = {.theta = 0, .gamma = 1, .h = h, .method = NS_THETA};
    const double w0 = 1;
    double reached, x;
    ns_march *m;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, &w0), NS_OK);
    assert_int_equal(ns_march_try(m, 1, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, &x, NULL, NULL), NS_OK);
    ns_march_free(m);
    ns_system_free(s);
    return exp(-1) - x; /* Euler's is too small */
}

static void the_marcher_takes_theta_0(void **state) {
    (void)state;
    const double order = log2(explicit_error(1. / 64) / explicit_error(1. / 128));
    print_message("march, theta 0: order %.3f\n", order);
    assert_true(fabs(order - 1) < 0.02); /* the next term is h = 1/64 of it */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_arcs),
        cmocka_unit_test(bridge),
        cmocka_unit_test(across_an_event),
        cmocka_unit_test(the_marcher_takes_theta_0),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
