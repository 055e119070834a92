/* tests/stress/judge.c - who is wrong. */
#include "judge_internal.h"

#include <math.h>
#include <string.h>

static const double SENSITIVE = 1e-8; /* of all values */

const char *judge_name(judge_verdict v) {
    static const char *const names[JUDGE_VERDICTS] = {
        "right", "WRONG", "WRONG-kernel", "REFUSED", "refused-kernel", "undecided", "SLOW", "CRASHED"};
    return names[v];
}

static void say(judge_finding *f, judge_verdict v, int who, const char *kind) {
    f->verdict = v;
    f->culprit = who;
    snprintf(f->kind, sizeof f->kind, "%s", kind);
}

static void say_difference(judge_finding *f, int who, int from) {
    char name[80];
    const difference there = judge_between(who, from), back = judge_between(from, who);
    const difference d = there.most > back.most ? there : back;
    plan_probe_name(&judge_of.p, d.probe, name, sizeof name);
    snprintf(f->line, sizeof f->line,
             "%s: %s at %.9g s is %.6g, by %s %.6g (off by %.2g of the largest, %.6g)",
             judge_settings[who].name, name, run_time(&judge_of.p, d.k), *judge_value(who, d.k, 1, d.probe),
             judge_settings[from].name, *judge_value(from, d.k, 1, d.probe), d.most, judge_of.scale[d.probe]);
}

/* Would a change of all values by 1e-8 move it as far? */
static int is_sensitive(int run_of, const judge_options *o) {
    run_setting s = judge_settings[run_of];
    s.vary = SENSITIVE;
    s.limit = 4 * o->limit;
    run(&judge_of.p, &s, judge_of.result[J_VARIED]);
    return !judge_done(J_VARIED) || judge_between(J_VARIED, run_of).most > 0.3 * JUDGE_WRONG;
}

/* The run that two methods say is right, or nobody. */
static int find_right(const judge_options *o) {
    judge_start_run(J_TIGHT, o);
    const int theta = judge_run_theta(o);
    if (judge_agree(J_EXACT, J_TIGHT))
        return J_EXACT;
    if (!theta)
        return NOBODY;
    if (judge_done(J_EXACT) && judge_done(J_TIGHT))
        return judge_theta_votes(J_EXACT, J_TIGHT);
    const int one = judge_done(J_EXACT) ? J_EXACT : judge_done(J_TIGHT) ? J_TIGHT : NOBODY;
    for (int run = 0; run < J_CANDIDATES && one != NOBODY; run++)
        if (judge_done(run) && !judge_agree(run, one))
            return judge_theta_votes(one, run) == one ? one : NOBODY;
    return NOBODY;
}

static void judge_differing(judge_finding *f, const judge_options *o) {
    const int right = find_right(o);
    say(f, JUDGE_UNDECIDED, NOBODY, "undecided");
    if (right == NOBODY || is_sensitive(right, o)) {
        snprintf(f->kind, sizeof f->kind, right == NOBODY ? "undecided" : "sensitive");
        for (int run = 1; run < J_CANDIDATES; run++)
            if (judge_done(J_AUTO) && judge_done(run) && !judge_agree(J_AUTO, run))
                say_difference(f, run, J_AUTO);
        return;
    }
    for (int run = J_CANDIDATES - 1; run >= 0; run--)
        if (judge_done(run) && !judge_agree(run, right)) {
            say_difference(f, run, right);
            say(f, run <= J_SPICE ? JUDGE_WRONG_AUTO : JUDGE_WRONG_KERNEL, run, "");
            snprintf(f->kind, sizeof f->kind, "%s wrong", judge_settings[run].name);
        }
}

/* Signs of what is shown. */
static int judge_signs(judge_finding *f) {
    for (int run = 0; run < J_CANDIDATES; run++) {
        const run_result *r = judge_of.result[run];
        if (!judge_done(run) || r->wrong_sign <= JUDGE_WRONG)
            continue;
        say(f, run <= J_SPICE ? JUDGE_WRONG_AUTO : JUDGE_WRONG_KERNEL, run, "");
        snprintf(f->kind, sizeof f->kind, "%s breaks (S4)", judge_settings[run].name);
        snprintf(f->line, sizeof f->line, "%s: %s breaks its law at %.9g s by %.2g of the largest",
                 judge_settings[run].name, judge_of.p.part[r->wrong_part].name, r->wrong_t, r->wrong_sign);
        return 1;
    }
    return 0;
}

/* What the theta scheme says to a circuit that "auto" refused. */
static const char *ask_theta(const judge_options *o) {
    judge_start_run(J_THETA, o);
    return judge_done(J_THETA)                            ? ", theta goes on"
           : judge_of.result[J_THETA]->end == RUN_REFUSED ? ", theta too"
                                                          : "";
}

static void say_end(judge_finding *f, int run, const judge_options *o) {
    const run_result *r = judge_of.result[run];
    const int by_default = run <= J_SPICE;
    if (r->end == RUN_REFUSED) {
        say(f, by_default ? JUDGE_REFUSED : JUDGE_REFUSED_KERNEL, run, "");
        snprintf(f->kind, sizeof f->kind, "%s %s%s%s", judge_settings[run].name, ns_status_name(r->status),
                 r->t > 0 ? "" : " at the start", by_default ? ask_theta(o) : "");
    } else {
        say(f, r->end == RUN_SLOW ? JUDGE_SLOW : JUDGE_CRASHED, run, "");
        snprintf(f->kind, sizeof f->kind, "%s %s", judge_settings[run].name,
                 r->end == RUN_SLOW ? "slow" : "crashed");
    }
    snprintf(f->line, sizeof f->line, "%s: %s (at %.6g s)", judge_settings[run].name, r->line, r->t);
}

/* Those that did not arrive.  Only "auto" counts as slow: the kernels are for some sizes only. */
static int judge_ends(judge_finding *f, const judge_options *o) {
    static const run_end order[] = {RUN_CRASHED, RUN_REFUSED, RUN_SLOW};
    for (int e = 0; e < 3; e++)
        for (int run = 0; run < J_CANDIDATES; run++)
            if (judge_of.result[run]->end == order[e] && (order[e] != RUN_SLOW || run <= J_SPICE)) {
                say_end(f, run, o);
                return 1;
            }
    return 0;
}

static int all_agree(void) {
    for (int a = 0; a < J_CANDIDATES; a++)
        for (int b = a + 1; b < J_CANDIDATES; b++)
            if (judge_done(a) && judge_done(b) && !judge_agree(a, b))
                return 0;
    return 1;
}

/* All agree: the scheme is asked, and where it doubts, asked again with shorter steps. */
static void judge_by_theta(judge_finding *f, const judge_options *o) {
    difference d;
    char name[80];
    int one = NOBODY;
    for (int run = J_CANDIDATES - 1; run >= 0; run--)
        one = judge_done(run) ? run : one;
    if (one == NOBODY || !judge_run_theta(o) || !judge_theta_doubts(one, &d))
        return;
    run_setting rough = judge_settings[J_THETA], fine = judge_settings[J_THETA2];
    rough.h /= 8;
    fine.h /= 8;
    rough.limit = fine.limit = 8 * o->limit;
    run(&judge_of.p, &rough, judge_of.result[J_THETA]);
    run(&judge_of.p, &fine, judge_of.result[J_THETA2]);
    if (!judge_done(J_THETA) || !judge_done(J_THETA2) || !judge_theta_doubts(one, &d))
        return;
    plan_probe_name(&judge_of.p, d.probe, name, sizeof name);
    snprintf(f->line, sizeof f->line, "all engines agree, theta is off by %.2g in %s", d.most, name);
    if (judge_theta_is_too_coarse(one) || !judge_second_order_agrees(one, d.probe, o))
        say(f, JUDGE_UNDECIDED, one, "theta differs");
    else if (is_sensitive(one, o))
        say(f, JUDGE_UNDECIDED, one, "theta differs, sensitive");
    else
        say(f, JUDGE_WRONG_AUTO, one, "all engines wrong by theta");
}

judge_finding judge(const netlist *n, const judge_options *o) {
    judge_finding f = {.verdict = JUDGE_RIGHT, .culprit = NOBODY};
    const char *bad = judge_begin(n);
    if (bad) {
        say(&f, JUDGE_CRASHED, NOBODY, "not read");
        snprintf(f.line, sizeof f.line, "the harness does not understand: %s", bad);
        return f;
    }
    for (int run = 0; run < J_CANDIDATES; run++)
        if ((!o->runs || o->runs >> run & 1) && (run != J_SPICE || o->spice.models))
            judge_start_run(run, o);
    f.seconds = judge_of.result[J_AUTO]->seconds;
    judge_find_scales();
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
    if (judge_begin(n))
        return 0;
    for (int i = 0; i < JUDGE_ENGINES; i++) {
        run_setting s = judge_settings[runs[i]];
        s.limit = i == 0 ? 4 * limit : limit;
        s.longer = runs[i] == J_SPARSE ? 64 : 1;
        run(&judge_of.p, &s, judge_of.result[runs[i]]);
    }
    judge_find_scales();
    for (int i = 0; i < JUDGE_ENGINES; i++) {
        const run_result *r = judge_of.result[runs[i]];
        first = first == NOBODY && judge_done(runs[i]) ? runs[i] : first;
        cost[i] = (judge_cost){judge_settings[runs[i]].name, r->end,
                               judge_done(runs[i]) && judge_agree(first, runs[i]), r->seconds, r->effort};
    }
    return 1;
}
