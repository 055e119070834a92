/* tests/stress/judge_runs.c - the runs of the circuit that is judged, and how far they are apart. */
#include "judge_internal.h"

#include <math.h>
#include <string.h>

enum { SHUFFLE = 12345 };
static const double LEAST = 1e-9; /* V, A */
/* Of the largest value of its kind: signals below it are not compared finely.  With JUDGE_WRONG that is 1e-8
 * of the largest, ten times what a step of `sparse` may be off by; what its guards and those of the scheme
 * take for rounding of a current adds up to 4e-9 in circuit random-wide 403000000, where `exact` is right by
 * a closed form (tests/unit/exact/test_small_beside_large.c). */
static const double FLOOR = 1e-5;
static const double LINES = 1e-4; /* the option `lines`, by default */

const run_setting judge_settings[J_RUNS] = {
    [J_AUTO] = {.name = "auto", .method = NS_AUTO},
    [J_SHUFFLED] = {.name = "auto-shuffled", .method = NS_AUTO, .on_grid = 1, .shuffle = SHUFFLE},
    [J_SPICE] = {.name = "ngspice"},
    [J_EXACT] = {.name = "exact", .method = NS_EXACT},
    [J_SPARSE] = {.name = "sparse", .method = NS_SPARSE},
    [J_TIGHT] = {.name = "sparse-1e-12", .method = NS_SPARSE, .reltol = 1e-12},
    [J_THETA] = {.name = "theta", .method = NS_THETA, .h = 0.25},
    [J_THETA2] = {.name = "theta-half", .method = NS_THETA, .h = 0.125},
    [J_VARIED] = {.name = "varied"},
};

judged judge_of;

unsigned judge_runs(const char *names) {
    unsigned runs = 0;
    for (int run = 0; names && run < J_CANDIDATES; run++) {
        const char *at = strstr(names, judge_settings[run].name);
        const size_t length = strlen(judge_settings[run].name);
        if (at && (at[length] == ' ' || at[length] == 0))
            runs |= 1U << run;
    }
    return runs;
}

const char *judge_begin(const netlist *n) {
    judge_of.text = n;
    for (int run = 0; run < J_RUNS; run++) {
        if (!judge_of.result[run])
            judge_of.result[run] = run_room();
        judge_of.result[run]->end = RUN_NOT;
    }
    return plan_read(n, &judge_of.p);
}

double *judge_value(int run, int k, int band, int probe) {
    return &judge_of.result[run]->value[(k * RUN_BAND + band) * judge_of.p.probes + probe];
}

int judge_done(int run) {
    return judge_of.result[run]->end == RUN_DONE;
}

static int is_voltage(int probe) {
    return judge_of.p.probe[probe].part < 0;
}

/* The largest value of each signal, which may lie between the instants that are compared: a ring that decays
 * between two of them is not to be right to 1e-3 of what is left of it.  The median of the runs, so that one
 * that is out by decades does not hide.
 */
void judge_find_scales(void) {
    double largest[2] = {0, 0};
    for (int i = 0; i < judge_of.p.probes; i++) {
        double of[J_CANDIDATES];
        int count = 0;
        for (int run = 0; run < J_CANDIDATES; run++) {
            double most = judge_of.result[run]->most[i];
            for (int k = 0; k < RUN_TIMES && judge_done(run); k++)
                most = fmax(most, fabs(*judge_value(run, k, 1, i)));
            int at = judge_done(run) ? count++ : -1;
            for (; at > 0 && of[at - 1] > most; at--)
                of[at] = of[at - 1];
            if (at >= 0)
                of[at] = most;
        }
        judge_of.scale[i] = count > 0 ? of[(count - 1) / 2] : 0;
        largest[is_voltage(i)] = fmax(largest[is_voltage(i)], judge_of.scale[i]);
    }
    for (int i = 0; i < judge_of.p.probes; i++)
        judge_of.scale[i] = fmax(fmax(judge_of.scale[i], FLOOR * largest[is_voltage(i)]), LEAST);
}

/* How far v is outside what run b has around time k. */
double judge_outside(int b, int k, int i, double v) {
    const double at[RUN_BAND] = {*judge_value(b, k, 0, i), *judge_value(b, k, 1, i),
                                 *judge_value(b, k, 2, i)};
    const double low = fmin(at[0], fmin(at[1], at[2])), high = fmax(at[0], fmax(at[1], at[2]));
    const double out = fmax(low - v, v - high);
    return isnan(v) || isnan(low) || isnan(high) ? INFINITY : fmax(0, out);
}

/* ngspice's straight lines between points are within `lines` of the largest value that it shows, which may
 * lie between the instants that are compared; of a voltage between two nodes, both lines are off by so much.
 */
static double size_of(int a, int b, int i) {
    const run_shown *s = &judge_of.result[J_SPICE]->shown[i];
    if (a != J_SPICE && b != J_SPICE)
        return judge_of.scale[i];
    return fmax(fmax(judge_of.scale[i], LINES / JUDGE_WRONG * s->nodes), fmax(fabs(s->low), fabs(s->high)));
}

difference judge_between(int a, int b) {
    difference d = {0, 0, 0};
    for (int k = 0; k < RUN_TIMES; k++)
        for (int i = 0; i < judge_of.p.probes; i++) {
            const double far = judge_outside(b, k, i, *judge_value(a, k, 1, i)) / size_of(a, b, i);
            if (far > d.most)
                d = (difference){far, i, k};
        }
    return d;
}

int judge_agree(int a, int b) {
    return judge_done(a) && judge_done(b) && judge_between(a, b).most < JUDGE_WRONG &&
           judge_between(b, a).most < JUDGE_WRONG;
}

void judge_start_run(int which, const judge_options *o) {
    run_setting s = judge_settings[which];
    s.limit = which >= J_CANDIDATES ? 4 * o->limit : o->limit;
    if (which == J_SPICE)
        spice_run(judge_of.text, &judge_of.p, &o->spice, s.limit, judge_of.result[which]);
    else
        run(&judge_of.p, &s, judge_of.result[which]);
    if (o->verbose)
        printf("  %-14s %s %.3f s, %ld steps, %ld events, %ld pivots, %ld checks, %ld retries; %s\n", s.name,
               (const char *[]){"not", "done", "refused", "slow", "crashed"}[judge_of.result[which]->end],
               judge_of.result[which]->seconds, judge_of.result[which]->counts.steps,
               judge_of.result[which]->counts.events, judge_of.result[which]->counts.pivots,
               judge_of.result[which]->counts.checks, judge_of.result[which]->counts.retries,
               judge_of.result[which]->line);
}
