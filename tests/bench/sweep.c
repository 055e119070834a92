/* tests/bench/sweep.c - all the ways to run a case, in turns.
 *
 * ngspice's devices, from its closest to the ideal ones: `sidiode` and S with 1 mohm and 1 Mohm (its
 * tolerances opened as that needs, `set xtrtol=7`), the same with 1 uohm and 1 Gohm, D with n = 0.01 and n =
 * 1 beside S; times trap and gear, reltol, and the longest step.  The times that are compared are corners of
 * an idle source, so that it has points there. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "adapter.h"
#include "rival.h"
#include "siconos_run.h"
#include "sweep.h"

enum { MOST_ROWS = 800, IDLES = 5, MOST_RUNS = 20, MANY_STEPS = 50000 };
/* Runs of ngspice are repeated in one process up to so much, s of CPU. */
static const double resolved = 30e-3;
static const char *const siconos = "build/bench/siconos";

typedef struct todo { /* what a row is to run */
    bench_engine engine;
    double setting;
    rival_setting rival;
    siconos_setting siconos;
    int coarser; /* a row that must not have failed to end in time, -1: none */
    char options[48];
} todo;

typedef struct list {
    int count;
    int idles[ROW_RIVAL + 1];                   /* how often, by kind of row, */
    double idle[ROW_RIVAL + 1][IDLES * ROUNDS]; /* s of CPU that ngspice takes to read the netlist and end */
    double spent[4]; /* s of CPU: by the library, by ours in ngspice, by its own models, by Siconos */
    double fastest;  /* of the others, s */
    row *row;
    todo *todo;
} list;

/* --- what there is to run --- */

static int put(list *l, row_kind kind, const char *series, todo t) {
    if (l->count == MOST_ROWS)
        must(NS_E_SIZE);
    row *r = &l->row[l->count];
    r->kind = kind;
    r->accumulation = NAN;
    snprintf(r->series, sizeof r->series, "%.39s", series);
    l->todo[l->count] = t;
    return l->count++;
}

/* The cheapest first, for the time that all may take. */
static void put_library(list *l, const plan *p, const bench_case *c) {
    static const bench_engine order[BENCH_ENGINES] = {
        BENCH_AUTO, BENCH_CAPTURE_HALF, BENCH_CAPTURE, BENCH_EXACT, BENCH_SPARSE, BENCH_HALF, BENCH_THETA};
    for (int i = 0; i < BENCH_ENGINES; i++) {
        const bench_engine e = order[i];
        int before = -1;
        for (int k = 0; bench_has(e, c) && k < bench_settings(e, c->large, p->quick); k++) {
            const double setting = bench_setting(e, k);
            before = put(l, ROW_LIBRARY, bench_engine_name(e),
                         (todo){.engine = e, .setting = setting, .coarser = before});
            snprintf(l->row[before].setting, sizeof l->row->setting,
                     bench_steps(e) ? "unit/%.0f" : "reltol %.0e", bench_steps(e) ? 1 / setting : setting);
        }
    }
}

/* The widest grid of at most a unit that has every time that is compared, s; 0: none with 20000 points. */
static double grid_of(const bench_case *c) {
    for (int n = (int)ceil(c->end / c->unit * (1 - 1e-9)); n <= 20000; n++) {
        const double g = c->end / n;
        int fits = 1;
        for (int k = 0; k < c->times && fits; k++)
            fits = fabs(c->time[k] / g - round(c->time[k] / g)) < 1e-6;
        if (fits)
            return g;
    }
    return 0;
}

/* Through ngspice: on grids, and with points chosen by lines. */
static void put_ours(list *l, const plan *p, const bench_case *c) {
    static const double steps[] = {1, 1 / 20.0, 1 / 200.0};
    static const char *const lines[] = {"lines=1e-2", "lines=1e-3", "lines=1e-4"};
    const double grid = grid_of(c);
    int before = -1;
    todo t = {.rival = {.name = "nonsmooth.cm", .models = {.diode = DECK_IDEAL}, .reltol = 1e-3},
              .coarser = -1};
    t.rival.step = grid / c->unit;
    snprintf(t.options, sizeof t.options, "points=\"grid\" corners=0");
    if (grid > 0) {
        const int at = put(l, ROW_OURS, "nonsmooth.cm grid alone", t);
        snprintf(l->row[at].setting, sizeof l->row->setting, "corners=0 unit/%.3g", 1 / t.rival.step);
    }
    snprintf(t.options, sizeof t.options, "points=\"grid\"");
    for (int k = 0; k < (p->quick ? 2 : 3); k++) {
        t.rival.step = steps[k];
        t.coarser = before;
        before = put(l, ROW_OURS, "nonsmooth.cm grid", t);
        snprintf(l->row[before].setting, sizeof l->row->setting, "grid unit/%.0f", 1 / t.rival.step);
    }
    t.rival.step = 1;
    t.coarser = -1;
    for (int k = 0; k < 3; k++) {
        snprintf(t.options, sizeof t.options, "%s", lines[k]);
        snprintf(l->row[put(l, ROW_OURS, "nonsmooth.cm", t)].setting, sizeof l->row->setting, "%s", lines[k]);
    }
}

static int put_setting(list *l, rival_setting s, int before) {
    char series[64];
    snprintf(series, sizeof series, s.gear ? "%s gear" : "%s trap", s.name);
    if (s.models.vh > 0)
        snprintf(series, sizeof series, "%s %s vh=%g", s.name, s.gear ? "gear" : "trap", s.models.vh);
    const int at = put(l, ROW_RIVAL, series, (todo){.rival = s, .coarser = before});
    snprintf(l->row[at].setting, sizeof l->row->setting, "reltol %.0e unit/%.0f", s.reltol, 1 / s.step);
    return at;
}

/* Those with long steps first, for the time that all may take; where circuits chatter, those with the widest
 * hysteresis, which alone come to an end. */
static void put_ngspice(list *l, const plan *p, const bench_case *c) {
    static const rival_setting kinds[] = {{.name = "sidiode 1m", .models = {DECK_SIDIODE, 0, 1e-3, 1e6, 0}},
                                          {.name = "D n=0.01", .models = {DECK_D, 0.01, 1e-3, 1e6, 0}},
                                          {.name = "D n=1", .models = {DECK_D, 1, 1e-3, 1e6, 0}},
                                          {.name = "sidiode 1u", .models = {DECK_SIDIODE, 0, 1e-6, 1e9, 0}}};
    static const double steps[] = {5, 20, 200, 2000}, hysteresis[] = {100e-3, 10e-3, 0};
    int before[4][4][2][3]; /* kind, reltol, gear, hysteresis */
    memset(before, -1, sizeof before);
    for (int step = 0; step < (p->quick ? 3 : 4); step++)
        for (int r = 0; r < 4; r += p->quick ? 2 : 1)
            for (int k = 0; k < 4; k++)
                for (int way = 0; way < 6; way++) {
                    rival_setting s = kinds[k];
                    const int gear = way % 2, wide = way / 2;
                    if ((gear && p->quick) || (hysteresis[wide] > 0 && !c->feeds_back))
                        continue;
                    s.gear = gear;
                    s.reltol = pow(10, -3 - r);
                    s.step = 1 / steps[step];
                    s.models.vh = hysteresis[wide];
                    before[k][r][gear][wide] = put_setting(l, s, before[k][r][gear][wide]);
                }
}

static void put_siconos(list *l, const plan *p, const bench_case *c) {
    static const siconos_setting kinds[] = {
        {"Lemke", 200, 0, 0}, {"pivoting", 215, 0, 0}, {"Murty", 217, 0, 0}};
    for (int k = 0; k < 3 && siconos_has(c, siconos); k++)
        for (int half = 0; half < 2; half++) {
            int before = -1;
            char series[40];
            snprintf(series, sizeof series, "Siconos %s theta %s", kinds[k].name, half ? "1/2" : "1");
            for (int n = 500; n <= (p->quick ? 2000 : 32000); n *= 4) {
                siconos_setting s = kinds[k];
                s.theta = half ? 0.5 : 1;
                s.h = c->time[0] / n;
                before = put(l, ROW_RIVAL, series, (todo){.siconos = s, .coarser = before});
                snprintf(l->row[before].setting, sizeof l->row->setting, "h %.3g us", s.h * 1e6);
            }
        }
}

/* --- one run --- */

/* The library in a process of its own, under a limit; what it needs is in memory that both share.  Short runs
 * are repeated for as long as those of ngspice are, the median counts, as the mean does of theirs. */
static row_end run_apart(const bench_case *c, const todo *t, double limit, bench_result *shared) {
    enum { MOST = 400 };
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        const struct rlimit cpu = {(rlim_t)ceil(limit), (rlim_t)ceil(limit) + 1};
        double all[MOST], create[MOST], spent = 0;
        int count = 0;
        setrlimit(RLIMIT_CPU, &cpu);
        while (count < MOST && (count == 0 || spent < resolved)) {
            bench_run(c, t->engine, t->setting, shared);
            create[count] = shared->create;
            spent += all[count++] = shared->run + shared->create;
        }
        shared->create = median(count, create);
        shared->run = median(count, all) - shared->create;
        _exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0)
        must(NS_E_MEMORY);
    if (WIFSIGNALED(status))
        return WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL ? ROW_TIMEOUT : ROW_ABORTED;
    return shared->status == NS_OK ? ROW_DONE : ROW_ABORTED;
}

static double run_library(const bench_case *c, const todo *t, double limit, row *r) {
    static const char *const engines[] = {"", "theta", "exact", "sparse"};
    bench_result *got = mmap(NULL, sizeof *got, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (got == MAP_FAILED)
        must(NS_E_MEMORY);
    r->end = run_apart(c, t, limit, got);
    const double spent = r->end == ROW_TIMEOUT ? limit : got->create + got->run;
    r->time[r->rounds] = got->create + got->run;
    r->other[r->rounds] = got->create;
    if (r->end == ROW_ABORTED)
        snprintf(r->why, sizeof r->why, "(%s)",
                 got->status == NS_OK ? "it crashed" : ns_status_text(got->status));
    else if (t->engine == BENCH_AUTO)
        snprintf(r->why, sizeof r->why, "%s", engines[got->engine]);
    r->error = case_error(c, got->values);
    r->counts = got->counts;
    r->steps = got->counts.steps;
    r->bytes = got->bytes;
    r->accumulation = fabs(got->last_event - c->accumulates);
    munmap(got, sizeof *got);
    return spent;
}

static double idle_of(const list *l, row_kind kind) {
    double sorted[IDLES * ROUNDS];
    memcpy(sorted, l->idle[kind], sizeof sorted);
    return median(l->idles[kind], sorted);
}

/* How often a run, of which one process took so long, is to be repeated in another: for `resolved` beyond
 * its start, or MOST_RUNS times. */
static int repeats(const list *l, const row *r, double process) {
    const double run = fmax(process - idle_of(l, r->kind), resolved / MOST_RUNS);
    return run < resolved / 2 ? (int)ceil(resolved / run) : 1;
}

static double run_ngspice(const bench_case *c, const list *l, const todo *t, double limit, row *r) {
    static const row_end ends[] = {ROW_DONE, ROW_ABORTED, ROW_TIMEOUT};
    rival_result got, again;
    rival_setting s = t->rival;
    s.options = t->options[0] ? t->options : NULL;
    rival_run(c, &s, 1, limit, &got);
    r->end = ends[got.end];
    r->other[r->rounds] = r->whole[r->rounds] = got.process;
    r->runs[r->rounds] = 1;
    r->error = case_error(c, got.values);
    r->steps = got.points;
    r->grid = lround(c->end / (s.step * c->unit)) + 1;
    r->rejected = got.rejected;
    const int runs = repeats(l, r, got.process);
    if (r->end != ROW_DONE || runs == 1)
        return got.process;
    rival_run(c, &s, runs, limit + 1, &again);
    if (again.end == RIVAL_DONE) {
        r->whole[r->rounds] = again.process;
        r->runs[r->rounds] = runs;
    }
    return got.process;
}

static double run_siconos(const bench_case *c, const todo *t, double limit, row *r) {
    siconos_result got;
    siconos_run(c, &t->siconos, siconos, limit, &got);
    r->direct = 1;
    r->end = got.done ? ROW_DONE : got.timeout ? ROW_TIMEOUT : ROW_ABORTED;
    r->time[r->rounds] = got.create + got.run;
    r->other[r->rounds] = got.create;
    r->error = case_error(c, got.values);
    r->steps = got.steps;
    return got.timeout ? limit : got.create + got.run;
}

/* --- turns --- */

/* A coarser one did not come to its end; or, of the library with steps of one length, took so many that more
 * would be of no interest. */
static int is_hopeless(const plan *p, const list *l, int i) {
    const int coarser = l->todo[i].coarser;
    if (coarser < 0)
        return 0;
    const row *r = &l->row[coarser];
    return r->end == ROW_TIMEOUT || r->end == ROW_SKIPPED ||
           (r->kind == ROW_LIBRARY && bench_captures(l->todo[i].engine) &&
            (r->steps > MANY_STEPS || 4 * r->time[0] > p->limit));
}

/* Ten times the fastest of the others is long enough for any other, if that is half a second.  Before one of
 * them has come to an end, a third of the limit: else the first could use up the time of all.  Where circuits
 * chatter, those that end take long. */
static double limit_of(const bench_case *c, const plan *p, const list *l, const row *r) {
    if (r->kind != ROW_RIVAL)
        return p->limit;
    if (c->feeds_back)
        return 4 * p->limit;
    return l->fastest > 0 ? fmin(p->limit, fmax(0.5, 10 * l->fastest)) : p->limit / 3;
}

static void run_row(const bench_case *c, const plan *p, list *l, int i) {
    row *r = &l->row[i];
    const todo *t = &l->todo[i];
    double *spent = &l->spent[t->siconos.solver ? ROW_RIVAL + 1 : (int)r->kind], took;
    const int first = r->rounds == 0;
    const double budget = p->budget * (r->kind == ROW_LIBRARY ? 2 : 1);
    if (first && (is_hopeless(p, l, i) || *spent > budget)) {
        snprintf(r->why, sizeof r->why,
                 is_hopeless(p, l, i) && *spent <= budget ? "a coarser one took long enough" : "time is up");
        r->end = ROW_SKIPPED;
        return;
    }
    const double limit = limit_of(c, p, l, r);
    if (r->kind == ROW_LIBRARY)
        took = run_library(c, t, limit, r);
    else if (t->siconos.solver)
        took = run_siconos(c, t, limit, r);
    else
        took = run_ngspice(c, l, t, limit, r);
    r->rounds += r->end == ROW_DONE;
    *spent += first ? took : 0;
    if (r->kind == ROW_RIVAL && r->end == ROW_DONE && (!(l->fastest > 0) || took < l->fastest))
        l->fastest = took;
}

/* No other of its kind is better in both; times of whole processes, a tenth more. */
static int matters(const list *l, int i) {
    const row *r = &l->row[i];
    if (r->end != ROW_DONE)
        return 0;
    if (r->kind != ROW_RIVAL)
        return r->other[0] + r->time[0] < 0.3;
    if (r->other[0] > 3) /* noise is far less */
        return 0;
    for (int k = 0; k < l->count; k++) {
        const row *o = &l->row[k];
        if (o->kind == r->kind && o->end == ROW_DONE && o->error < r->error &&
            1.1 * fmax(o->other[0], o->time[0]) < fmax(r->other[0], r->time[0]))
            return 0;
    }
    return 1;
}

/* ngspice's start, with and without our code models. */
static void run_idle(const bench_case *c, const plan *p, list *l) {
    for (int kind = ROW_OURS; kind <= ROW_RIVAL; kind++) {
        rival_setting s = {.name = "", .reltol = 1e-3, .step = 0.05};
        s.models.diode = kind == ROW_OURS ? DECK_IDEAL : DECK_SIDIODE;
        s.models.ron = 1e-3;
        s.models.roff = 1e6;
        for (int k = 0; k < IDLES; k++) {
            rival_result got;
            rival_run(c, &s, 0, p->limit, &got);
            l->idle[kind][l->idles[kind]++] = got.process;
        }
    }
}

/* What ngspice's runs took beyond that.  What is less than the scatter of starts (between their quartiles),
 * shared by the runs of a process, counts as that much. */
static void subtract_idle(list *l) {
    double idle[ROW_RIVAL + 1] = {0}, scatter[ROW_RIVAL + 1] = {0};
    for (int kind = ROW_OURS; kind <= ROW_RIVAL; kind++) {
        const int count = l->idles[kind];
        idle[kind] = median(count, l->idle[kind]); /* sorts them */
        scatter[kind] = l->idle[kind][3 * count / 4] - l->idle[kind][count / 4];
    }
    for (int i = 0; i < l->count; i++) {
        row *r = &l->row[i];
        for (int k = 0; k < r->rounds && r->kind != ROW_LIBRARY && !r->direct; k++)
            r->time[k] = fmax(scatter[r->kind], r->whole[k] - idle[r->kind]) / r->runs[k];
    }
}

row *sweep_run(const bench_case *c, const plan *p, int *count) {
    list l = {.row = room(MOST_ROWS * sizeof(row)), .todo = room(MOST_ROWS * sizeof(todo))};
    if (!c->file && !p->netlists)
        put_library(&l, p, c);
    if ((c->net || c->file) && !p->library)
        put_ours(&l, p, c);
    if (!p->library) {
        put_ngspice(&l, p, c);
        if (!p->netlists)
            put_siconos(&l, p, c);
    }
    for (int round = 0; round < p->rounds; round++) {
        if (!p->library)
            run_idle(c, p, &l);
        for (int i = 0; i < l.count; i++)
            if (round == 0 || matters(&l, i))
                run_row(c, p, &l, i);
    }
    if (!p->library)
        subtract_idle(&l);
    free(l.todo);
    *count = l.count;
    return l.row;
}
