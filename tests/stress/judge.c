/* tests/stress/judge.c - who differs from whom, and who is right. */
#include "judge.h"

#include <math.h>
#include <string.h>

enum { SHUFFLE = 12345, NOBODY = -1 };
static const double SENSITIVE = 1e-8; /* of all values */
static const double LEAST = 1e-9;     /* V, A */
/* Of the largest value of its kind: signals below it are not compared finely.  With JUDGE_WRONG that is 1e-8
 * of the largest, ten times what a step of `sparse` may be off by; what its guards and those of the scheme
 * take for rounding of a current adds up to 4e-9 in circuit random-wide 403000000, where `exact` is right by
 * a closed form (tests/unit/exact/test_small_beside_large.c). */
static const double FLOOR = 1e-5;
static const double LINES = 1e-4; /* the option `lines`, by default */

static const run_setting settings[J_RUNS] = {
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

static plan p;
static const netlist *text;
static run_result *result[J_RUNS];
static double scale[PLAN_PROBES];

typedef struct difference {
    double most; /* relative to the signal's largest value */
    int probe, k;
} difference;

const char *judge_name(judge_verdict v) {
    static const char *const names[JUDGE_VERDICTS] = {
        "right", "WRONG", "WRONG-kernel", "REFUSED", "refused-kernel", "undecided", "SLOW", "CRASHED"};
    return names[v];
}

unsigned judge_runs(const char *names) {
    unsigned runs = 0;
    for (int run = 0; names && run < J_CANDIDATES; run++) {
        const char *at = strstr(names, settings[run].name);
        const size_t length = strlen(settings[run].name);
        if (at && (at[length] == ' ' || at[length] == 0))
            runs |= 1U << run;
    }
    return runs;
}

static double *value_of(int run, int k, int band, int probe) {
    return &result[run]->value[(k * RUN_BAND + band) * p.probes + probe];
}

static int done(int run) {
    return result[run]->end == RUN_DONE;
}

static int is_voltage(int probe) {
    return p.probe[probe].part < 0;
}

/* The largest value of each signal, which may lie between the instants that are compared: a ring that decays
 * between two of them is not to be right to 1e-3 of what is left of it.  The median of the runs, so that one
 * that is out by decades does not hide.
 */
static void find_scales(void) {
    double largest[2] = {0, 0};
    for (int i = 0; i < p.probes; i++) {
        double of[J_CANDIDATES];
        int count = 0;
        for (int run = 0; run < J_CANDIDATES; run++) {
            double most = result[run]->most[i];
            for (int k = 0; k < RUN_TIMES && done(run); k++)
                most = fmax(most, fabs(*value_of(run, k, 1, i)));
            int at = done(run) ? count++ : -1;
            for (; at > 0 && of[at - 1] > most; at--)
                of[at] = of[at - 1];
            if (at >= 0)
                of[at] = most;
        }
        scale[i] = count > 0 ? of[(count - 1) / 2] : 0;
        largest[is_voltage(i)] = fmax(largest[is_voltage(i)], scale[i]);
    }
    for (int i = 0; i < p.probes; i++)
        scale[i] = fmax(fmax(scale[i], FLOOR * largest[is_voltage(i)]), LEAST);
}

/* How far v is outside what run b has around time k. */
static double outside(int b, int k, int i, double v) {
    const double at[RUN_BAND] = {*value_of(b, k, 0, i), *value_of(b, k, 1, i), *value_of(b, k, 2, i)};
    const double low = fmin(at[0], fmin(at[1], at[2])), high = fmax(at[0], fmax(at[1], at[2]));
    const double out = fmax(low - v, v - high);
    return isnan(v) || isnan(low) || isnan(high) ? INFINITY : fmax(0, out);
}

/* ngspice's straight lines between points are within `lines` of the largest value that it shows, which may
 * lie between the instants that are compared; of a voltage between two nodes, both lines are off by so much.
 */
static double size_of(int a, int b, int i) {
    const run_shown *s = &result[J_SPICE]->shown[i];
    if (a != J_SPICE && b != J_SPICE)
        return scale[i];
    return fmax(fmax(scale[i], LINES / JUDGE_WRONG * s->nodes), fmax(fabs(s->low), fabs(s->high)));
}

static difference between(int a, int b) {
    difference d = {0, 0, 0};
    for (int k = 0; k < RUN_TIMES; k++)
        for (int i = 0; i < p.probes; i++) {
            const double far = outside(b, k, i, *value_of(a, k, 1, i)) / size_of(a, b, i);
            if (far > d.most)
                d = (difference){far, i, k};
        }
    return d;
}

static int agree(int a, int b) {
    return done(a) && done(b) && between(a, b).most < JUDGE_WRONG && between(b, a).most < JUDGE_WRONG;
}

static void start_run(int which, const judge_options *o) {
    run_setting s = settings[which];
    s.limit = which >= J_CANDIDATES ? 4 * o->limit : o->limit;
    if (which == J_SPICE)
        spice_run(text, &p, &o->spice, s.limit, result[which]);
    else
        run(&p, &s, result[which]);
    if (o->verbose)
        printf("  %-14s %s %.3f s, %ld steps, %ld events, %ld pivots, %ld checks, %ld retries; %s\n", s.name,
               (const char *[]){"not", "done", "refused", "slow", "crashed"}[result[which]->end],
               result[which]->seconds, result[which]->counts.steps, result[which]->counts.events,
               result[which]->counts.pivots, result[which]->counts.checks, result[which]->counts.retries,
               result[which]->line);
}

/* --- the theta scheme --- */

static int run_theta(const judge_options *o) {
    start_run(J_THETA, o);
    if (done(J_THETA))
        start_run(J_THETA2, o);
    return done(J_THETA) && done(J_THETA2);
}

/* How much run has of signal i around time k. */
static double spread(int run, int k, int i) {
    const double at[RUN_BAND] = {*value_of(run, k, 0, i), *value_of(run, k, 1, i), *value_of(run, k, 2, i)};
    return fmax(at[0], fmax(at[1], at[2])) - fmin(at[0], fmin(at[1], at[2]));
}

/* Of one signal: how far the scheme's two lengths of step are from each other, and from a run; what rings too
 * fast for the scheme, which damps it, does not count. */
static void theta_distances(int run, int i, double *own, double *other) {
    *own = *other = 0;
    for (int k = 0; k < RUN_TIMES; k++) {
        const double rough = *value_of(J_THETA, k, 1, i), fine = *value_of(J_THETA2, k, 1, i);
        const double far = outside(run, k, i, 2 * fine - rough);
        *own = fmax(*own, fabs(fine - rough) / scale[i]);
        *other = fmax(*other, spread(run, k, i) < 0.1 * far ? far / scale[i] : 0);
    }
}

/* 1: in some signal the scheme is so sure of itself, and so far away, that the run is doubtful. */
static int theta_doubts(int run, difference *d) {
    for (int i = 0; i < p.probes; i++) {
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
static int theta_votes(int a, int b) {
    const int i = between(a, b).probe;
    double own, to_a, to_b;
    theta_distances(a, i, &own, &to_a);
    theta_distances(b, i, &own, &to_b);
    return 3 * to_a < to_b ? a : 3 * to_b < to_a ? b : NOBODY;
}

/* --- the verdict --- */

static void say(judge_finding *f, judge_verdict v, int who, const char *kind) {
    f->verdict = v;
    f->culprit = who;
    snprintf(f->kind, sizeof f->kind, "%s", kind);
}

static void say_difference(judge_finding *f, int who, int from) {
    char name[80];
    const difference there = between(who, from), back = between(from, who);
    const difference d = there.most > back.most ? there : back;
    plan_probe_name(&p, d.probe, name, sizeof name);
    snprintf(f->line, sizeof f->line,
             "%s: %s at %.9g s is %.6g, by %s %.6g (off by %.2g of the largest, %.6g)", settings[who].name,
             name, run_time(&p, d.k), *value_of(who, d.k, 1, d.probe), settings[from].name,
             *value_of(from, d.k, 1, d.probe), d.most, scale[d.probe]);
}

/* Would a change of all values by 1e-8 move it as far? */
static int is_sensitive(int run_of, const judge_options *o) {
    run_setting s = settings[run_of];
    s.vary = SENSITIVE;
    s.limit = 4 * o->limit;
    run(&p, &s, result[J_VARIED]);
    return !done(J_VARIED) || between(J_VARIED, run_of).most > 0.3 * JUDGE_WRONG;
}

/* The run that two methods say is right, or nobody. */
static int find_right(const judge_options *o) {
    start_run(J_TIGHT, o);
    const int theta = run_theta(o);
    if (agree(J_EXACT, J_TIGHT))
        return J_EXACT;
    if (!theta)
        return NOBODY;
    if (done(J_EXACT) && done(J_TIGHT))
        return theta_votes(J_EXACT, J_TIGHT);
    const int one = done(J_EXACT) ? J_EXACT : done(J_TIGHT) ? J_TIGHT : NOBODY;
    for (int run = 0; run < J_CANDIDATES && one != NOBODY; run++)
        if (done(run) && !agree(run, one))
            return theta_votes(one, run) == one ? one : NOBODY;
    return NOBODY;
}

static void judge_differing(judge_finding *f, const judge_options *o) {
    const int right = find_right(o);
    say(f, JUDGE_UNDECIDED, NOBODY, "undecided");
    if (right == NOBODY || is_sensitive(right, o)) {
        snprintf(f->kind, sizeof f->kind, right == NOBODY ? "undecided" : "sensitive");
        for (int run = 1; run < J_CANDIDATES; run++)
            if (done(J_AUTO) && done(run) && !agree(J_AUTO, run))
                say_difference(f, run, J_AUTO);
        return;
    }
    for (int run = J_CANDIDATES - 1; run >= 0; run--)
        if (done(run) && !agree(run, right)) {
            say_difference(f, run, right);
            say(f, run <= J_SPICE ? JUDGE_WRONG_AUTO : JUDGE_WRONG_KERNEL, run, "");
            snprintf(f->kind, sizeof f->kind, "%s wrong", settings[run].name);
        }
}

/* Signs of what is shown. */
static int judge_signs(judge_finding *f) {
    for (int run = 0; run < J_CANDIDATES; run++) {
        const run_result *r = result[run];
        if (!done(run) || r->wrong_sign <= JUDGE_WRONG)
            continue;
        say(f, run <= J_SPICE ? JUDGE_WRONG_AUTO : JUDGE_WRONG_KERNEL, run, "");
        snprintf(f->kind, sizeof f->kind, "%s breaks (S4)", settings[run].name);
        snprintf(f->line, sizeof f->line, "%s: %s breaks its law at %.9g s by %.2g of the largest",
                 settings[run].name, p.part[r->wrong_part].name, r->wrong_t, r->wrong_sign);
        return 1;
    }
    return 0;
}

/* What the theta scheme says to a circuit that "auto" refused. */
static const char *ask_theta(const judge_options *o) {
    start_run(J_THETA, o);
    return done(J_THETA) ? ", theta goes on" : result[J_THETA]->end == RUN_REFUSED ? ", theta too" : "";
}

static void say_end(judge_finding *f, int run, const judge_options *o) {
    const run_result *r = result[run];
    const int by_default = run <= J_SPICE;
    if (r->end == RUN_REFUSED) {
        say(f, by_default ? JUDGE_REFUSED : JUDGE_REFUSED_KERNEL, run, "");
        snprintf(f->kind, sizeof f->kind, "%s %s%s%s", settings[run].name, ns_status_name(r->status),
                 r->t > 0 ? "" : " at the start", by_default ? ask_theta(o) : "");
    } else {
        say(f, r->end == RUN_SLOW ? JUDGE_SLOW : JUDGE_CRASHED, run, "");
        snprintf(f->kind, sizeof f->kind, "%s %s", settings[run].name,
                 r->end == RUN_SLOW ? "slow" : "crashed");
    }
    snprintf(f->line, sizeof f->line, "%s: %s (at %.6g s)", settings[run].name, r->line, r->t);
}

/* Those that did not arrive.  Only "auto" counts as slow: the kernels are for some sizes only. */
static int judge_ends(judge_finding *f, const judge_options *o) {
    static const run_end order[] = {RUN_CRASHED, RUN_REFUSED, RUN_SLOW};
    for (int e = 0; e < 3; e++)
        for (int run = 0; run < J_CANDIDATES; run++)
            if (result[run]->end == order[e] && (order[e] != RUN_SLOW || run <= J_SPICE)) {
                say_end(f, run, o);
                return 1;
            }
    return 0;
}

static int all_agree(void) {
    for (int a = 0; a < J_CANDIDATES; a++)
        for (int b = a + 1; b < J_CANDIDATES; b++)
            if (done(a) && done(b) && !agree(a, b))
                return 0;
    return 1;
}

/* The scheme of second order, which damps nothing, by steps so many times shorter: it is with that of first
 * order, and not with the run. */
static int second_order_agrees(int run_of, int i, double shorter, const judge_options *o) {
    run_setting s = settings[J_THETA2];
    double from_run = 0, from_theta = 0;
    s.h /= shorter;
    s.theta = s.gamma = 0.5;
    s.limit = 8 * o->limit;
    run(&p, &s, result[J_VARIED]);
    for (int k = 0; k < RUN_TIMES && done(J_VARIED); k++) {
        const double v = *value_of(J_VARIED, k, 1, i);
        from_run = fmax(from_run, outside(run_of, k, i, v));
        from_theta = fmax(from_theta, outside(J_THETA2, k, i, v));
    }
    return done(J_VARIED) && 3 * from_theta < from_run;
}

/* The same at each of three lengths: where a ring is too fast for a step, its phase may agree by chance. */
static int second_order_agrees_always(int run_of, int i, const judge_options *o) {
    return second_order_agrees(run_of, i, 8, o) && second_order_agrees(run_of, i, 64, o) &&
           second_order_agrees(run_of, i, 512, o);
}

/* 1 if the scheme took fewer than four steps for each event of the run: it damps a ring that makes such
 * events, and is no witness. */
static int is_too_coarse(int run_of) {
    return 4 * result[run_of]->counts.events > result[J_THETA2]->counts.steps;
}

/* All agree: the scheme is asked, and where it doubts, asked again with shorter steps. */
static void judge_by_theta(judge_finding *f, const judge_options *o) {
    difference d;
    char name[80];
    int one = NOBODY;
    for (int run = J_CANDIDATES - 1; run >= 0; run--)
        one = done(run) ? run : one;
    if (one == NOBODY || !run_theta(o) || !theta_doubts(one, &d))
        return;
    run_setting rough = settings[J_THETA], fine = settings[J_THETA2];
    rough.h /= 8;
    fine.h /= 8;
    rough.limit = fine.limit = 8 * o->limit;
    run(&p, &rough, result[J_THETA]);
    run(&p, &fine, result[J_THETA2]);
    if (!done(J_THETA) || !done(J_THETA2) || !theta_doubts(one, &d))
        return;
    plan_probe_name(&p, d.probe, name, sizeof name);
    snprintf(f->line, sizeof f->line, "all engines agree, theta is off by %.2g in %s", d.most, name);
    if (is_too_coarse(one) || !second_order_agrees_always(one, d.probe, o))
        say(f, JUDGE_UNDECIDED, one, "theta differs");
    else if (is_sensitive(one, o))
        say(f, JUDGE_UNDECIDED, one, "theta differs, sensitive");
    else
        say(f, JUDGE_WRONG_AUTO, one, "all engines wrong by theta");
}

judge_finding judge(const netlist *n, const judge_options *o) {
    judge_finding f = {.verdict = JUDGE_RIGHT, .culprit = NOBODY};
    const char *bad = plan_read(n, &p);
    text = n;
    if (bad) {
        say(&f, JUDGE_CRASHED, NOBODY, "not read");
        snprintf(f.line, sizeof f.line, "the harness does not understand: %s", bad);
        return f;
    }
    for (int run = 0; run < J_RUNS; run++) {
        if (!result[run])
            result[run] = run_room();
        result[run]->end = RUN_NOT;
    }
    for (int run = 0; run < J_CANDIDATES; run++)
        if ((!o->runs || o->runs >> run & 1) && (run != J_SPICE || o->spice.models))
            start_run(run, o);
    f.seconds = result[J_AUTO]->seconds;
    find_scales();
    if (judge_signs(&f))
        return f;
    if (!all_agree()) {
        judge_differing(&f, o);
        if (f.verdict != JUDGE_UNDECIDED)
            return f;
    }
    const judge_finding differing = f;
    if (judge_ends(&f, o) || differing.verdict == JUDGE_UNDECIDED)
        return f;
    if (o->theta)
        judge_by_theta(&f, o);
    return f;
}

int judge_engines(const netlist *n, double limit, judge_cost cost[JUDGE_ENGINES]) {
    static const int runs[JUDGE_ENGINES] = {J_AUTO, J_EXACT, J_SPARSE};
    int first = NOBODY;
    if (plan_read(n, &p))
        return 0;
    for (int run = 0; run < J_RUNS; run++) {
        if (!result[run])
            result[run] = run_room();
        result[run]->end = RUN_NOT;
    }
    for (int i = 0; i < JUDGE_ENGINES; i++) {
        run_setting s = settings[runs[i]];
        s.limit = i == 0 ? 4 * limit : limit;
        s.longer = runs[i] == J_SPARSE ? 64 : 1;
        run(&p, &s, result[runs[i]]);
    }
    find_scales();
    for (int i = 0; i < JUDGE_ENGINES; i++) {
        const run_result *r = result[runs[i]];
        first = first == NOBODY && done(runs[i]) ? runs[i] : first;
        cost[i] = (judge_cost){settings[runs[i]].name, r->end, done(runs[i]) && agree(first, runs[i]),
                               r->seconds, r->effort};
    }
    return 1;
}
