/* tests/stress/shown.c - averages, peaks and counts of points in ngspice. */
#include "shown.h"

#include <math.h>
#include <string.h>
#include <strings.h>

enum { S_AUTO, S_EXACT, S_SPARSE, S_FINE, S_RUNS, MORE_POINTS = 4, FEW = 1000 };
static const char *const names[S_RUNS] = {"auto", "exact", "sparse", "fine"};
static const char *const options[S_RUNS] = {"", "method=\"exact\"", "method=\"sparse\"", "lines=1e-5"};
static const double SHORTER = 64;

static plan p;
static run_result *result[S_RUNS];

static void put_tran(netlist *to, double shorter) {
    netlist_put(to, ".tran %g %g 0 %g%s", p.step, p.stop, p.step / shorter, p.uic ? " uic" : "");
}

static void start_run(const netlist *n, int run, const judge_options *o) {
    netlist c = netlist_copy(n);
    for (int i = c.count - 1; i > 0; i--)
        if (strncasecmp(c.line[i], ".tran", 5) == 0)
            netlist_drop(&c, i);
    put_tran(&c, run == S_FINE ? SHORTER : 1);
    if (options[run][0])
        netlist_put(&c, "AOPT 0 nsopt\n.model nsopt nonsmooth(%s)", options[run]);
    spice_run(&c, &p, &o->spice, (run == S_FINE ? 8 : 1) * o->limit, result[run]);
    if (o->verbose)
        printf("  %-8s %s %.3f s, %ld points; %s\n", names[run],
               (const char *[]){"not", "done", "refused", "slow", "crashed"}[result[run]->end],
               result[run]->seconds, result[run]->counts.steps, result[run]->line);
    netlist_free(&c);
}

/* Nodes and inductors. */
static void probe_all(void) {
    p.probes = 0;
    for (int i = 1; i < p.nodes && p.probes < PLAN_PROBES; i++)
        p.probe[p.probes++] = (plan_probe){-1, {i, 0}};
    for (int i = 0; i < p.parts && p.probes < PLAN_PROBES; i++)
        if (p.part[i].kind == 'l')
            p.probe[p.probes++] = (plan_probe){i, {0, 0}};
}

static int is_coupled(int part) {
    for (int i = 0; i < p.parts; i++)
        if (p.part[i].kind == 'k' && (p.part[i].by[0] == part || p.part[i].by[1] == part))
            return 1;
    return 0;
}

static const run_shown *node_of(const run_result *r, int node) {
    static const run_shown ground;
    return node > 0 ? &r->shown[node - 1] : &ground;
}

/* The first one counts: of auto, if that is wrong. */
static void say(judge_finding *f, int run, const char *what, int probe, double is, double should) {
    char name[80];
    if (f->verdict != JUDGE_RIGHT)
        return;
    plan_probe_name(&p, probe, name, sizeof name);
    f->verdict = run == S_AUTO ? JUDGE_WRONG_AUTO : JUDGE_WRONG_KERNEL;
    f->culprit = run;
    snprintf(f->kind, sizeof f->kind, "%s in ngspice: %s", names[run], what);
    snprintf(f->line, sizeof f->line, "%s: %s of %s is %.7g, should be %.7g", names[run], what, name, is,
             should);
}

/* A coil whose current has no other path loses it where a switch opens: the spike is not shown. */
static void judge_averages(judge_finding *f, int run) {
    const run_result *r = result[run];
    for (int i = p.nodes - 1; i < p.probes; i++) {
        const plan_part *l = &p.part[p.probe[i].part];
        const run_shown *a = node_of(r, l->node[0]), *b = node_of(r, l->node[1]);
        const double is = a->integral - b->integral,
                     should = l->value * (r->shown[i].last - r->shown[i].first - r->shown[i].jumped),
                     size = a->of_abs + b->of_abs +
                            l->value * fmax(fabs(r->shown[i].high), fabs(r->shown[i].low));
        if (!is_coupled(p.probe[i].part) && fabs(is - should) > JUDGE_WRONG * size)
            say(f, run, "volt-seconds", i, is, should);
    }
}

static void judge_peaks(judge_finding *f, int run) {
    for (int i = 0; i < p.probes; i++) {
        const run_shown *a = &result[run]->shown[i], *b = &result[S_FINE]->shown[i];
        const double size = fmax(fabs(b->high), fabs(b->low)) + 1e-9;
        if (fabs(a->high - b->high) > JUDGE_WRONG * size)
            say(f, run, "peak", i, a->high, b->high);
        if (fabs(a->low - b->low) > JUDGE_WRONG * size)
            say(f, run, "valley", i, a->low, b->low);
    }
}

static void judge_points(judge_finding *f) {
    const long few = result[S_EXACT]->counts.steps, many = result[S_SPARSE]->counts.steps;
    if (many > MORE_POINTS * few + FEW) {
        f->verdict = JUDGE_SLOW;
        snprintf(f->kind, sizeof f->kind, "sparse in ngspice: points");
        snprintf(f->line, sizeof f->line, "%ld points, %ld by exact", many, few);
    }
}

judge_finding shown(const netlist *n, const judge_options *o) {
    judge_finding f = {.verdict = JUDGE_RIGHT, .culprit = -1};
    if (plan_read(n, &p) || p.nodes + 8 > PLAN_PROBES)
        return f;
    probe_all();
    for (int run = 0; run < S_RUNS; run++) {
        if (!result[run])
            result[run] = run_room();
        start_run(n, run, o);
    }
    for (int run = 0; run < S_FINE; run++)
        if (result[run]->end == RUN_DONE) {
            judge_averages(&f, run);
            if (result[S_FINE]->end == RUN_DONE)
                judge_peaks(&f, run);
        }
    if (f.verdict == JUDGE_RIGHT && result[S_EXACT]->end == RUN_DONE && result[S_SPARSE]->end == RUN_DONE)
        judge_points(&f);
    return f;
}
