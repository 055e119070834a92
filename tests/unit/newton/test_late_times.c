/* tests/unit/newton/test_late_times.c - Newton's steps where t has few digits left for them: what is
 * integrated is what t moves by, and t does move. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "callbacks.h"
#include "nonsmooth.h"

/* x' = -x from 1; refuse: never a point but the start. */
typedef struct decay {
    double start;
    int refuse;
} decay;

static int decay_f(const ns_point *at, void *data, double *out) {
    const decay *d = data;
    out[0] = -at->x[0];
    return d->refuse && at->t > d->start;
}

static const double one[1] = {1};

static ns_newton *start(decay *d, double theta, double t0) {
    static ns_model model;
    const ns_newton_options o = {.theta = theta, .gamma = 1};
    ns_newton *s;
    model = (ns_model){.n = 1, .M = one, .data = d, .f = decay_f, .A = give_minus_1};
    d->start = t0;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, t0, one, NULL), NS_OK);
    return s;
}

static double read_x(const ns_newton *s, double *t) {
    double x;
    assert_int_equal(ns_newton_read(s, t, &x, NULL, NULL, NULL), NS_OK);
    return x;
}

/* theta = 1/2: x+ = x (1 - h/2) / (1 + h/2), ln x+ = ln x - h - h^3/12 - ...: -ln x is the time that went by,
 * but for one rounding of x in (1/2,1) a step.  At t = 1e6 s the last bit of t is 1.2e-10. */
static void what_t_moves_by_is_integrated(void **state) {
    (void)state;
    const double t0s[] = {0, 1, 1e3, 1e6}, lengths[] = {1e-6, 1e-8, 1e-9, 1.3e-9};
    for (int k = 0; k < 16; k++) {
        decay d = {0, 0};
        const double t0 = t0s[k % 4], h = lengths[k / 4];
        double t;
        ns_newton *s = start(&d, 0.5, t0);
        assert_int_equal(ns_newton_advance(s, t0 + 1e4 * h, h), NS_OK);
        const double x = read_x(s, &t);
        assert_true(t == t0 + 1e4 * h);
        const long steps = ns_newton_counts_of(s)->steps;
        assert_true(steps >= 9000 && steps <= 11000);
        assert_true(fabs(-log(x) - (t - t0)) < (double)steps * DBL_EPSILON);
        ns_newton_free(s);
    }
    decay d = {0, 0};
    double t;
    ns_newton *s = start(&d, 1, 1e6); /* x+ = 1/(1 + h) */
    assert_int_equal(ns_newton_try(s, 1.3e-9), NS_OK);
    assert_int_equal(ns_newton_accept(s), NS_OK);
    const double x = read_x(s, &t);
    assert_true(t == 1e6 + 1.3e-9 && fabs(1 - x - (t - 1e6)) < 2 * DBL_EPSILON);
    ns_newton_free(s);
}

/* Steps that t does not show: refused one by one, and on the way to a time made as long as t's last bit. */
static void t_moves(void **state) {
    (void)state;
    const double t0s[] = {1, 1e6, -1e6}, lengths[] = {1e-17, 1e-11, DBL_MIN};
    for (int k = 0; k < 3; k++) {
        decay d = {0, 0};
        const double t0 = t0s[k], bit = nextafter(t0, INFINITY) - t0;
        double t;
        ns_newton *s = start(&d, 1, t0);
        assert_int_equal(ns_newton_try(s, lengths[k]), NS_E_RANGE);
        assert_int_equal(ns_newton_accept(s), NS_E_STATE);
        assert_int_equal(ns_newton_advance(s, t0 + 100 * bit, lengths[k]), NS_OK);
        const double x = read_x(s, &t);
        assert_true(t == t0 + 100 * bit && ns_newton_counts_of(s)->steps == 100);
        assert_true(fabs(-log(x) - 100 * bit) < 100 * DBL_EPSILON);
        d.refuse = 1; /* and when no step of any length can be had, that is told */
        d.start = t;
        assert_int_equal(ns_newton_advance(s, t + 64 * bit, 64 * bit), NS_DIVERGED);
        assert_true(ns_newton_counts_of(s)->trials == 100 + 7); /* 64 bits, 32, ..., 1 */
        ns_newton_free(s);
    }
    decay d = {0, 0};
    ns_newton *s = start(&d, 1, -DBL_MAX);
    assert_int_equal(ns_newton_advance(s, DBL_MAX, 1), NS_E_RANGE);
    ns_newton_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_t_moves_by_is_integrated),
        cmocka_unit_test(t_moves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
