/* tests/reference/test_lit_relays.c - relays: sliding modes reached in finite time, and the buck converter
 * with a comparator of zero width as the limit of steep ones.
 *
 * y = -s, l = -1, u = 1:  lambda = 1 where s > 0, -1 where s < 0, anything between where s = 0.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "lit_buck_exact.h"
#include "lit_run.h"

static ns_system *make(int n, int m) {
    ns_system *s;
    assert_int_equal(ns_system_create(n, m, 0, 0, &s), NS_OK);
    for (int i = 0; i < n; i++)
        s->M[i * (n + 1)] = 1;
    for (int j = 0; j < m; j++) {
        s->l[j] = -1;
        s->u[j] = 1;
    }
    return s;
}

/* --- x' = 1/2 - lambda,  lambda = sign x --- */

static ns_system *one_relay(void) {
    ns_system *s = make(1, 1);
    s->b[0] = 0.5;
    s->B[0] = -1;
    s->C[0] = -1;
    return s;
}

/* From x(0) = 1: x = 1 - t/2 until t = 2, then x = 0 with lambda = 1/2: one change of mode, whatever h, and
 * an implicit step is exact on both lines. */
static void a_relay_is_caught_once(void **state) {
    (void)state;
    ns_system *s = one_relay();
    const double w0[1] = {1};
    static const double lengths[] = {0.3, 0.043, 0.0061, 0.00087};
    print_message("x' = 1/2 - sgn x, x(0) = 1; arrives at 2 (exact)\n"
                  "    h         arrives at   x off      lambda off, sliding   mode changes, sliding\n");
    for (int i = 0; i < 4; i++) {
        const double h = lengths[i];
        const ns_theta_options o = {1, 1, 0};
        double arrives = 0, off = 0, law = 0;
        long arrived_with = 0;
        ns_theta *t;
        assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
        assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
        for (int k = 1; k * h < 4; k++) {
            double x, lambda;
            assert_int_equal(ns_theta_try(t, h, NULL, 0, NS_RESOLVE), NS_OK);
            assert_int_equal(ns_theta_accept(t), NS_OK);
            assert_int_equal(ns_theta_read(t, &x, &lambda, NULL), NS_OK);
            off = fmax(off, fabs(x - fmax(0, 1 - k * h / 2)));
            if (arrives == 0 && ns_theta_mode(t)[0] == NS_INSIDE) {
                arrives = k * h; /* in a step that takes what is left to take: lambda = 1/2 + x/h */
                arrived_with = ns_theta_counts(t)->events;
            } else if (arrives > 0)
                law = fmax(law, fabs(lambda - 0.5));
        }
        const long more = ns_theta_counts(t)->events - arrived_with;
        print_message("    %-7g   %-10.4f   %-8.1e   %-19.1e   %ld\n", h, arrives, off, law, more);
        assert_true(arrives >= 2 - 1e-12 && arrives < 2 + h);
        assert_true(off < 1e-13 && law < 1e-15 / h); /* lambda = (what rounding leaves of x) / h */
        assert_true(more == 0 && arrived_with <= 2); /* off the start's mode, into sliding */
        ns_theta_free(t);
    }
    ns_system_free(s);
}

static void its_instant_is_located(void **state) {
    (void)state;
    ns_system *s = one_relay();
    const double w0[1] = {1};
    const ns_march_options o = {.theta = 0.5, .gamma = 0.5, .h = 0.3};
    ns_march *m;
    double t, x, lambda;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    assert_int_equal(ns_march_try(m, 9, NS_TO_EVENT, &t), NS_OK);
    assert_true(ns_march_at_event(m) && fabs(t - 2) < 0.3 / (1 << 19));
    assert_int_equal(ns_march_accept(m), NS_OK);
    assert_int_equal(ns_march_try(m, 9, NS_TO_TIME, &t), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, &x, &lambda, NULL), NS_OK);
    assert_true(fabs(x) < 1e-13 && fabs(lambda - 0.5) < 1e-13);
    ns_march_free(m);
    ns_system_free(s);
}

/* --- twisting: x1' = x2, x2' = -2 lambda1 - lambda2, lambda_i = sign x_i --- */

static ns_system *twisting(void) {
    ns_system *s = make(2, 2);
    s->A[2] = 1;  /* x1' = x2 */
    s->B[1] = -2; /* lambda1 into x2 */
    s->B[3] = -1; /* lambda2 */
    s->C[0] = -1;
    s->C[3] = -1;
    return s;
}

/* From (0, 1): outward against 3 for 1/3, up to x1 = 1/6; back under 1 for sqrt(2/6), where
 * |x2| = sqrt(1/3).  So half turns last T = 1/3 + sqrt(1/3) times a power of rho = sqrt(1/3): switchings
 * accumulate at T / (1 - rho) = 2.1547, and the rest is rest. */
static const double half_turn = 0.910683602522959, rho = 0.577350269189626;

static double twisting_end(void) {
    return half_turn / (1 - rho);
}

/* At rest 2 lambda1 + lambda2 = 0; how they share is open, x is not.  An implicit step takes some h from x2
 * in each of the log(1/h) / log(1/rho) half turns it can see, so the instant is good to h log(1/h).  A half
 * turn switches each relay once, and a step may end inside: 4 events, for 4.2 more half turns a decade of h.
 * Then there is rest, not chatter. */
static void an_accumulation_is_passed_by_fixed_steps(void **state) {
    (void)state;
    ns_system *s = twisting();
    const double w0[2] = {0, 1};
    long last_events = 0;
    static const double lengths[] = {1e-2, 1e-3, 1e-4};
    print_message("twisting: at rest after %.4f (exact)\n    h         after    mode changes\n",
                  twisting_end());
    for (int i = 0; i < 3; i++) {
        const double h = lengths[i];
        const ns_theta_options o = {1, 1, 0};
        ns_theta *t;
        double reached = 0, x[2] = {1, 1}, lambda[2], worst = 0;
        assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
        assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
        for (int k = 1; k * h < 4; k++) {
            assert_int_equal(ns_theta_try(t, h, NULL, 0, NS_RESOLVE), NS_OK);
            assert_int_equal(ns_theta_accept(t), NS_OK);
            assert_int_equal(ns_theta_read(t, x, lambda, NULL), NS_OK);
            const double size = fmax(fabs(x[0]), fabs(x[1]));
            if (size > 1e-9)
                reached = k * h;
            else if (k * h > reached + 1.5 * h) /* the step that arrives takes what is left */
                worst = fmax(worst, fabs(2 * lambda[0] + lambda[1]));
        }
        print_message("    %-7g   %.4f   %ld\n", h, reached, ns_theta_counts(t)->events);
        assert_true(fabs(reached - twisting_end()) < 15 * h * log(1 / h));
        assert_true(fabs(x[0]) < 1e-12 && fabs(x[1]) < 1e-12);
        assert_true(worst < 1e-6); /* what is left of 1e-9 in x, over the least h */
        assert_true(last_events == 0 || ns_theta_counts(t)->events < last_events + 18);
        last_events = ns_theta_counts(t)->events;
        ns_theta_free(t);
    }
    ns_system_free(s);
}

/* The marcher locates the first of them, then hands over. */
static void an_accumulation_is_passed_by_the_marcher(void **state) {
    (void)state;
    ns_system *s = twisting();
    const double w0[2] = {0, 1};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-3};
    ns_march *m;
    double t, x[2];
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    assert_int_equal(ns_march_try(m, 2, NS_TO_TIME, &t), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
    assert_int_equal(ns_march_try(m, 4, NS_TO_TIME, &t), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    print_message("marched: %ld events, %ld steps; x = %.1e, %.1e\n", ns_march_counts(m)->events,
                  ns_march_counts(m)->steps, x[0], x[1]);
    assert_true(fabs(x[0]) < 1e-9 && fabs(x[1]) < 1e-9);
    assert_true(ns_march_counts(m)->steps < 20000); /* 4000 of h, and what the events take */
    ns_march_free(m);
    ns_system_free(s);
}

/* --- the buck converter with a comparator of zero width --- */

enum { SAMPLES = 70, N = LIT_BUCK_N };
static const double every = 1e-6;
static const double size_of[N] = {0.5, 1.8, 0.01, 0.2, 2};
static const double at_rest[N] = {0};

static double compare(const double *a, const double *b, double *rms) {
    double worst = 0, sum = 0;
    for (int i = 0; i < SAMPLES * N; i++) {
        const double d = fabs(a[i] - b[i]) / size_of[i % N];
        worst = d <= worst ? worst : d;
        sum += d * d / (SAMPLES * N);
    }
    *rms = sqrt(sum);
    return worst;
}

/* Comparators of gain 1.5e3, 1.5e4, 1.5e5 (a band of 2 mV to 20 uV), integrated explicitly, tend to it as
 * 1/gain; captured steps as h. */
static void the_relay_is_the_limit_of_steep_comparators(void **state) {
    (void)state;
    static double relay[SAMPLES * N], X[SAMPLES * N];
    static const char *const names[] = {"standard", "sliding"};
    for (int set = LIT_STANDARD; set <= LIT_SLIDING; set++) {
        ns_system *s = lit_buck(2, (lit_set)set, LIT_RELAY);
        const lit_plan located = {0.5, 0.5, 0.25e-9, every, SAMPLES};
        double rms[2], error[2];
        ns_counts counts;
        assert_int_equal(lit_march(s, at_rest, &located, relay, &counts), NS_OK);
        for (int k = 0; k < 2; k++) {
            lit_buck_exact(2, (lit_set)set, k ? 150e3 : 15e3, 1e-9, every, SAMPLES, X);
            error[k] = compare(X, relay, &rms[k]);
        }
        print_message("buck, %s set, zero width, against explicit steps with a gain of 1.5e4, 1.5e5: "
                      "%.1e, %.1e apart\n",
                      names[set], error[0], error[1]);
        assert_true(error[0] / error[1] > 7 && error[1] < 5e-5);
        for (int k = 0; k < 2; k++) {
            const lit_plan captured = {1, 1, k ? 0.125e-9 : 1e-9, every, SAMPLES};
            assert_int_equal(lit_capture(s, at_rest, &captured, X, &counts), NS_OK);
            compare(X, relay, &rms[k]);
        }
        print_message("    captured, theta = 1: rms error %.1e at 1 ns, %.1e at 0.125 ns, order %.2f\n",
                      rms[0], rms[1], log2(rms[0] / rms[1]) / 3);
        assert_true(log2(rms[0] / rms[1]) / 3 > 0.6); /* rms over few edges: +- 0.3 */
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_relay_is_caught_once),
        cmocka_unit_test(its_instant_is_located),
        cmocka_unit_test(an_accumulation_is_passed_by_fixed_steps),
        cmocka_unit_test(an_accumulation_is_passed_by_the_marcher),
        cmocka_unit_test(the_relay_is_the_limit_of_steep_comparators),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
