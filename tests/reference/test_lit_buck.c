/* tests/reference/test_lit_buck.c - the buck converter of the literature against an explicit integrator.
 *
 * The reference (tests/unit/lit_buck_exact.c) knows no complementarity: v(D) is the root of a scalar
 * equation, and an explicit Runge-Kutta pair does the rest.  12 pairs (two hinges) and 24 (five), standard
 * and sliding sets.  Errors are relative to the sizes of the states.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lit_buck_exact.h"
#include "lit_run.h"

enum { SAMPLES = 12, N = LIT_BUCK_N };
static const double every = 1e-6;
static const double size[N] = {0.5, 1.8, 0.01, 0.2, 2};
static const double w0[N] = {0};

static const struct variant {
    int hinges;
    lit_set set;
    const char *name;
} variants[] = {{2, LIT_STANDARD, "12 pairs, standard"},
                {2, LIT_SLIDING, "12 pairs, sliding"},
                {5, LIT_STANDARD, "24 pairs, standard"},
                {5, LIT_SLIDING, "24 pairs, sliding"}};

/* The largest and the root mean square difference of two sets of samples. */
static double compare(const double *a, const double *b, double *rms) {
    double worst = 0, sum = 0;
    for (int i = 0; i < SAMPLES * N; i++) {
        const double d = fabs(a[i] - b[i]) / size[i % N];
        worst = d <= worst ? worst : d;
        sum += d * d / (SAMPLES * N);
    }
    *rms = sqrt(sum);
    return worst;
}

/* A tenth of the tolerance moves the reference by about ten times the error it is left with. */
static void reference_of(const struct variant *v, double *exact) {
    static double rough[SAMPLES * N];
    double rms;
    lit_buck_exact(v->hinges, v->set, 15, 1e-9, every, SAMPLES, rough);
    lit_buck_exact(v->hinges, v->set, 15, 1e-10, every, SAMPLES, exact);
    const double moved = compare(rough, exact, &rms);
    print_message("%s: the reference moves by %.1e\n", v->name, moved);
    assert_true(moved < 3e-5);
}

/* Second order between events that are located; the sliding set, whose comparator's edges pass a sample,
 * multiplies the same error in time by the slope of an edge. */
static void located_events_give_the_right_waveforms(const struct variant *v, const double *exact) {
    static double X[SAMPLES * N];
    ns_system *s = lit_buck(v->hinges, v->set, LIT_GAIN_15);
    double rms, error[2];
    ns_counts counts;
    for (int k = 0; k < 2; k++) {
        const lit_plan plan = {0.5, 0.5, k ? 0.5e-9 : 4e-9, every, SAMPLES};
        assert_int_equal(lit_march(s, w0, &plan, X, &counts), NS_OK);
        error[k] = compare(X, exact, &rms);
    }
    print_message("%s: located, theta = gamma = 1/2: error %.1e at 4 ns, %.1e at 0.5 ns, %ld events\n",
                  v->name, error[0], error[1], counts.events);
    assert_true(error[1] < 5e-5);
    assert_true(log2(error[0] / error[1]) / 3 > 1.7);
    ns_system_free(s);
}

/* First order where events are captured at the ends of steps: over a factor of eight in h, root mean square,
 * for single events fall anywhere in a step. */
static void captured_events_cost_the_order(const struct variant *v, const double *exact) {
    static double X[SAMPLES * N];
    ns_system *s = lit_buck(v->hinges, v->set, LIT_GAIN_15);
    double rms[2];
    ns_counts counts;
    for (int k = 0; k < 2; k++) {
        const lit_plan plan = {1, 1, k ? 0.125e-9 : 1e-9, every, SAMPLES};
        assert_int_equal(lit_capture(s, w0, &plan, X, &counts), NS_OK);
        compare(X, exact, &rms[k]);
    }
    const double order = log2(rms[0] / rms[1]) / 3;
    print_message("%s: captured, theta = 1: rms error %.1e at 0.125 ns, order %.2f, %ld events\n", v->name,
                  rms[1], order, counts.events);
    assert_true(order > 0.7); /* rms of few samples: +- 0.3 */
    ns_system_free(s);
}

static void waveforms_agree(void **state) {
    (void)state;
    static double exact[SAMPLES * N];
    for (size_t k = 0; k < sizeof variants / sizeof *variants; k++) {
        reference_of(&variants[k], exact);
        located_events_give_the_right_waveforms(&variants[k], exact);
        captured_events_cost_the_order(&variants[k], exact);
    }
}

/* The problems of the steps, reduced to lambda and solved one by one, are what the stepper solves: after 20
 * us of 1 ns the same state, up to what the loop makes of rounding (1e-16 grows tenfold in 11 us). */
static void reduced_problems_are_those_of_the_steps(void **state) {
    (void)state;
    for (size_t v = 0; v < sizeof variants / sizeof *variants; v++) {
        ns_system *s = lit_buck(variants[v].hinges, variants[v].set, LIT_GAIN_15);
        const double h = 1e-9;
        double W[24 * 24], q[24], lambda[24], y[24], x[N] = {0}, next[N], z[2], stepped[N];
        ns_mode mode[24] = {0};
        ns_mlcp_solver *solver;
        ns_mlcp_info info;
        ns_counts counts;
        assert_true(s->m == (variants[v].hinges == 2 ? 12 : 24));
        assert_int_equal(ns_mlcp_create(s->m, &solver), NS_OK);
        lit_reduced_matrix(s, h, W);
        for (int k = 1; k <= 5000; k++) {
            ns_system_inputs(s, k * h, NS_LEFT, z);
            lit_reduced_vector(s, h, x, z, q);
            const ns_mlcp p = {.m = s->m, .W = W, .q = q, .l = s->l, .u = s->u};
            assert_int_equal(ns_mlcp_solve(solver, &p, mode, lambda, y, &info), NS_OK);
            assert_true(ns_mlcp_residual(&p, lambda, NULL) < 1e-13);
            lit_reduced_state(s, h, x, z, lambda, next);
            memcpy(x, next, sizeof x);
        }
        const lit_plan plan = {1, 1, h, 5e-6, 1};
        assert_int_equal(lit_capture(s, w0, &plan, stepped, &counts), NS_OK);
        for (int i = 0; i < N; i++)
            assert_true(fabs(x[i] - stepped[i]) < 1e-10 * size[i]);
        ns_mlcp_free(solver);
        ns_system_free(s);
    }
}

/* Located, the flow does not part what is close: two starts 1e-7 V apart in v_C21, 5e-8 of its size, are no
 * further apart after 100 us, in any state.  (40 such starts came out within 1.6e-8 of each other, whoever
 * rounds: that much the steps differ.  Captured, they part, to some h times the slopes: the instants of
 * switching stay on the grid.) */
static void neighbours_stay_neighbours(void **state) {
    (void)state;
    ns_system *s = lit_buck(2, LIT_STANDARD, LIT_GAIN_15);
    const lit_plan plan = {0.5, 0.5, 4e-9, 100e-6, 1};
    double a[N], b[N], w1[N] = {0, 0, 0, 1e-7 * 1.9e-12, 0};
    ns_counts counts;
    assert_int_equal(lit_march(s, w0, &plan, a, &counts), NS_OK);
    assert_int_equal(lit_march(s, w1, &plan, b, &counts), NS_OK);
    for (int i = 0; i < N; i++)
        assert_true(fabs(a[i] - b[i]) < 5e-8 * size[i]);
    ns_system_free(s);
}

/* The whole start-up: the loop's integrator makes the mean of v_out 1.8 V, that of i_L 1.8 V / 10 ohm; the
 * ripple of i_L is (3 - v_out) v_out / (3 L f) = 0.12 A, but for the drops across the transistors. */
static void it_regulates(void **state) {
    (void)state;
    enum { FINE = 6000 };
    static double X[FINE * N];
    ns_system *s = lit_buck(2, LIT_STANDARD, LIT_GAIN_15);
    const double period = 1.6667e-6;
    const lit_plan plan = {0.5, 0.5, 4e-9, period / 50, FINE};
    double vout = 0, il = 0, low = INFINITY, high = -INFINITY;
    ns_counts counts;
    assert_int_equal(lit_march(s, w0, &plan, X, &counts), NS_OK);
    for (int k = FINE - 500; k < FINE; k++) { /* the last ten periods before 200 us */
        vout += X[k * N + LIT_BUCK_VOUT] / 500;
        il += X[k * N + LIT_BUCK_IL] / 500;
        low = fmin(low, X[k * N + LIT_BUCK_IL]);
        high = fmax(high, X[k * N + LIT_BUCK_IL]);
    }
    print_message("12 pairs, standard, 200 us, means of the last ten periods:\n"
                  "    what              expected   ours\n"
                  "    v_out / V         1.8        %.5f\n    i_L / A           0.18       %.5f\n"
                  "    ripple of i_L     0.12       %.4f\n",
                  vout, il, high - low);
    assert_true(fabs(vout - 1.8) <
                2e-4); /* the compensator's slow time constant, 10 us, has had ten times that */
    assert_true(fabs(il - vout / 10) < 2e-4);
    assert_true(fabs(high - low - 0.12) < 0.006); /* drops: 3 % of 1.2 V */
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waveforms_agree),
        cmocka_unit_test(reduced_problems_are_those_of_the_steps),
        cmocka_unit_test(neighbours_stay_neighbours),
        cmocka_unit_test(it_regulates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
