/* tests/stress/judge_theta.c - what the theta scheme says to the runs of the circuit that is judged. */
#include "judge_internal.h"

#include <math.h>

int judge_run_theta(const judge_options *o) {
    judge_start_run(J_THETA, o);
    if (judge_done(J_THETA))
        judge_start_run(J_THETA2, o);
    return judge_done(J_THETA) && judge_done(J_THETA2);
}

/* How much run has of signal i around time k. */
static double spread(int run, int k, int i) {
    const double at[RUN_BAND] = {*judge_value(run, k, 0, i), *judge_value(run, k, 1, i),
                                 *judge_value(run, k, 2, i)};
    return fmax(at[0], fmax(at[1], at[2])) - fmin(at[0], fmin(at[1], at[2]));
}

/* Of one signal: how far the scheme's two lengths of step are from each other, and from a run; what rings too
 * fast for the scheme, which damps it, does not count. */
static void theta_distances(int run, int i, double *own, double *other) {
    *own = *other = 0;
    for (int k = 0; k < RUN_TIMES; k++) {
        const double rough = *judge_value(J_THETA, k, 1, i), fine = *judge_value(J_THETA2, k, 1, i);
        const double far = judge_outside(run, k, i, 2 * fine - rough);
        *own = fmax(*own, fabs(fine - rough) / judge_of.scale[i]);
        *other = fmax(*other, spread(run, k, i) < 0.1 * far ? far / judge_of.scale[i] : 0);
    }
}

/* 1: in some signal the scheme is so sure of itself, and so far away, that the run is doubtful. */
int judge_theta_doubts(int run, difference *d) {
    for (int i = 0; i < judge_of.p.probes; i++) {
        double own, other;
        theta_distances(run, i, &own, &other);
        if (own < 0.05 && other > 3 * own + 5e-3) {
            *d = (difference){other, i, 0};
            return 1;
        }
    }
    return 0;
}

/* The one of two runs that the scheme is nearer to by a factor of 3, in the signal in which they differ most.
 */
int judge_theta_votes(int a, int b) {
    const int i = judge_between(a, b).probe;
    double own, to_a, to_b;
    theta_distances(a, i, &own, &to_a);
    theta_distances(b, i, &own, &to_b);
    return 3 * to_a < to_b ? a : 3 * to_b < to_a ? b : NOBODY;
}

/* The scheme of second order, which damps nothing, by steps so many times shorter: it is with that of first
 * order, and not with the run. */
static int second_order_agrees(int run_of, int i, double shorter, const judge_options *o) {
    run_setting s = judge_settings[J_THETA2];
    double from_run = 0, from_theta = 0;
    s.h /= shorter;
    s.theta = s.gamma = 0.5;
    s.limit = 8 * o->limit;
    run(&judge_of.p, &s, judge_of.result[J_VARIED]);
    for (int k = 0; k < RUN_TIMES && judge_done(J_VARIED); k++) {
        const double v = *judge_value(J_VARIED, k, 1, i);
        from_run = fmax(from_run, judge_outside(run_of, k, i, v));
        from_theta = fmax(from_theta, judge_outside(J_THETA2, k, i, v));
    }
    return judge_done(J_VARIED) && 3 * from_theta < from_run;
}

/* The same at each of three lengths: where a ring is too fast for a step, its phase may agree by chance. */
int judge_second_order_agrees(int run_of, int i, const judge_options *o) {
    return second_order_agrees(run_of, i, 8, o) && second_order_agrees(run_of, i, 64, o) &&
           second_order_agrees(run_of, i, 512, o);
}

/* 1 if the scheme took fewer than four steps for each event of the run: it damps a ring that makes such
 * events, and is no witness. */
int judge_theta_is_too_coarse(int run_of) {
    return 4 * judge_of.result[run_of]->counts.events > judge_of.result[J_THETA2]->counts.steps;
}
