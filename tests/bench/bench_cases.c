/* tests/bench/bench_cases.c - work against precision: circuits run by the library's engines, by ngspice with
 * its own models at many settings, by ngspice with ours, and by Siconos where it was built.
 *
 *     bench_cases [NAME...]       cases by part of their name; none: all
 *
 * Environment: BENCH=quick for fewer settings and no large circuit, BENCH=library for nothing but the
 * library; NONSMOOTH_CM (build/bench/nonsmooth.cm); NGSPICE.  Tables go to stdout; CSV and gnuplot scripts to
 * build/bench/, the last netlist to build/bench/run.
 *
 * All runs of a case take turns, round by round; times are medians of CPU time, on one thread: of the library
 * and of Siconos from the elements to the last value (creation said apart), of ngspice that of its process
 * less that of one which reads the same netlist and ends (the whole process said apart).  What fails, or
 * takes longer than it may, is counted.
 *
 * ngspice's devices, from its closest to the ideal ones: `sidiode` and S with 1 mohm and 1 Mohm (its
 * tolerances opened as that needs, `set xtrtol=7`), the same with 1 uohm and 1 Gohm, D with n = 0.01 and n =
 * 1 beside S; times trap and gear, reltol, and the longest step.  The times that are compared are corners of
 * an idle source, so that it has points there. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "adapter.h"
#include "report.h"
#include "rival.h"
#include "scaling.h"
#include "siconos_run.h"

enum { MOST_ROWS = 240, MOST_CASES = 32, IDLES = 5 };
static const char *const folder = "build/bench", *const siconos = "build/bench/siconos";

typedef struct plan {
    int quick, library; /* library: nothing else */
    int rounds;
    double limit; /* s of CPU a run may take */
    char cm[1024];
} plan;

typedef struct todo { /* what a row is to run */
    bench_engine engine;
    double setting;
    rival_setting rival;
    siconos_setting siconos;
    int coarser; /* the row before in the same sweep, -1: none */
} todo;

/* --- what there is to run --- */

typedef struct list {
    int count;
    int idles[ROW_RIVAL + 1];                   /* how often, by kind of row, */
    double idle[ROW_RIVAL + 1][IDLES * ROUNDS]; /* s of CPU that ngspice takes to read the netlist and end */
    row *row;
    todo *todo;
} list;

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

static void put_library(list *l, const plan *p, const bench_case *c) {
    for (int e = 0; e < BENCH_ENGINES; e++) {
        int before = -1;
        if (!bench_has((bench_engine)e, c))
            continue;
        const int steps = bench_steps((bench_engine)e), count = e == BENCH_FLIGHT ? 1 : p->quick ? 3 : 5;
        for (int k = 0; k < count; k++) {
            const double setting = steps ? pow(0.25, k + (e == BENCH_FLIGHT ? 3 : 2)) : pow(10, -4 - 2 * k);
            before = put(l, ROW_LIBRARY, bench_engine_name((bench_engine)e),
                         (todo){.engine = (bench_engine)e, .setting = setting, .coarser = before});
            snprintf(l->row[before].setting, sizeof l->row->setting, steps ? "unit/%.0f" : "reltol %.0e",
                     steps ? 1 / setting : setting);
        }
    }
}

static void put_sweep(list *l, const plan *p, rival_setting s, row_kind kind) {
    static const double steps[] = {1 / 20.0, 1 / 200.0, 1 / 2000.0};
    int before = -1;
    char series[64];
    snprintf(series, sizeof series, kind == ROW_OURS ? "%s" : s.gear ? "%s gear" : "%s trap", s.name);
    if (s.models.vh > 0)
        snprintf(series, sizeof series, "%s %s vh=%g", s.name, s.gear ? "gear" : "trap", s.models.vh);
    for (int k = 0; k < (p->quick ? 2 : 3); k++) {
        s.step = steps[k];
        before = put(l, kind, series, (todo){.rival = s, .coarser = before});
        if (kind == ROW_OURS)
            snprintf(l->row[before].setting, sizeof l->row->setting, "step unit/%.0f", 1 / s.step);
        else
            snprintf(l->row[before].setting, sizeof l->row->setting, "reltol %.0e unit/%.0f", s.reltol,
                     1 / s.step);
    }
}

static void put_ngspice(list *l, const plan *p, const bench_case *c) {
    static const rival_setting kinds[] = {{.name = "sidiode 1m", .models = {DECK_SIDIODE, 0, 1e-3, 1e6, 0}},
                                          {.name = "sidiode 1u", .models = {DECK_SIDIODE, 0, 1e-6, 1e9, 0}},
                                          {.name = "D n=0.01", .models = {DECK_D, 0.01, 1e-3, 1e6, 0}},
                                          {.name = "D n=1", .models = {DECK_D, 1, 1e-3, 1e6, 0}}};
    const rival_setting ours = {.name = "nonsmooth.cm", .models = {DECK_IDEAL, 0, 0, 0, 0}, .reltol = 1e-3};
    if (c->net)
        put_sweep(l, p, ours, ROW_OURS);
    const int few = p->quick || c->slow;
    for (int k = 0; k < (few ? 3 : 4); k++)
        for (int gear = 0; gear < (few ? 1 : 2); gear++)
            for (int r = 3; r < (few ? 6 : 7); r += few ? 2 : 1) {
                rival_setting s = kinds[k];
                s.gear = gear;
                s.reltol = pow(10, -r);
                put_sweep(l, p, s, ROW_RIVAL);
                s.models.vh = c->feeds_back ? 10e-3 : 0;
                if (c->feeds_back)
                    put_sweep(l, p, s, ROW_RIVAL);
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

/* The library in a process of its own, under a limit; what it needs is in memory that both share. */
static row_end run_apart(const bench_case *c, const todo *t, double limit, bench_result *shared) {
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        const struct rlimit cpu = {(rlim_t)ceil(limit), (rlim_t)ceil(limit) + 1};
        setrlimit(RLIMIT_CPU, &cpu);
        bench_result best;
        for (int k = 0; k < 15 && (k == 0 || (best.run + best.create) * k < 20e-3); k++) {
            bench_run(c, t->engine, t->setting, shared);
            if (k == 0 || shared->run + shared->create < best.run + best.create)
                best = *shared;
        }
        *shared = best;
        _exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0)
        must(NS_E_MEMORY);
    if (WIFSIGNALED(status))
        return WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL ? ROW_TIMEOUT : ROW_ABORTED;
    return shared->status == NS_OK ? ROW_DONE : ROW_ABORTED;
}

static void run_library(const bench_case *c, const plan *p, const todo *t, row *r) {
    bench_result *got = mmap(NULL, sizeof *got, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (got == MAP_FAILED)
        must(NS_E_MEMORY);
    r->end = run_apart(c, t, p->limit, got);
    r->time[r->rounds] = got->create + got->run;
    r->other[r->rounds] = got->create;
    if (r->end == ROW_ABORTED)
        snprintf(r->why, sizeof r->why, "(%s)", ns_status_text(got->status));
    r->error = case_error(c, got->values);
    r->steps = got->counts.steps;
    r->events = got->counts.events;
    r->problems = got->counts.problems;
    r->pivots = got->counts.pivots;
    r->factors = got->counts.factors;
    r->maps = got->counts.maps;
    r->bytes = got->bytes;
    r->accumulation = fabs(got->last_event - c->accumulates);
    munmap(got, sizeof *got);
}

static void run_ngspice(const bench_case *c, const plan *p, const todo *t, row *r) {
    static const row_end ends[] = {ROW_DONE, ROW_ABORTED, ROW_TIMEOUT};
    char path[256];
    rival_result got;
    snprintf(path, sizeof path, "%s/run", folder);
    (void)mkdir(path, 0777);
    rival_run(c, &t->rival, 0, path, p->cm, p->limit, &got);
    r->end = ends[got.end];
    r->other[r->rounds] = got.process;
    r->error = case_error(c, got.values);
    r->steps = got.points;
    r->rejected = got.rejected;
}

static void run_siconos(const bench_case *c, const plan *p, const todo *t, row *r) {
    siconos_result got;
    siconos_run(c, &t->siconos, siconos, p->limit, &got);
    r->direct = 1;
    r->end = got.done ? ROW_DONE : got.timeout ? ROW_TIMEOUT : ROW_ABORTED;
    r->time[r->rounds] = got.create + got.run;
    r->other[r->rounds] = got.create;
    r->error = case_error(c, got.values);
    r->steps = got.steps;
}

/* A row that failed once is not tried again. */
static void run_row(const bench_case *c, const plan *p, list *l, int i) {
    row *r = &l->row[i];
    const todo *t = &l->todo[i];
    if (r->end != ROW_DONE)
        return;
    if (t->coarser >= 0 && l->row[t->coarser].end != ROW_DONE && l->row[t->coarser].end != ROW_ABORTED) {
        r->end = ROW_SKIPPED;
        return;
    }
    if (r->kind == ROW_LIBRARY)
        run_library(c, p, t, r);
    else if (t->siconos.solver)
        run_siconos(c, p, t, r);
    else
        run_ngspice(c, p, t, r);
    r->rounds += r->end == ROW_DONE;
}

/* ngspice's start, with and without our code models. */
static void run_idle(const bench_case *c, const plan *p, list *l) {
    char path[256];
    snprintf(path, sizeof path, "%s/run", folder);
    (void)mkdir(path, 0777);
    for (int i = 0, last = -1; i < l->count; i++) {
        const row_kind kind = l->row[i].kind;
        rival_result got;
        for (int k = 0; k < IDLES && kind != ROW_LIBRARY && (int)kind != last; k++) {
            rival_run(c, &l->todo[i].rival, 1, path, p->cm, p->limit, &got);
            l->idle[kind][l->idles[kind]++] = got.process;
        }
        last = (int)kind;
    }
}

/* What ngspice's runs took beyond that; half a millisecond is what noise leaves of nothing. */
static void subtract_idle(list *l) {
    double idle[ROW_RIVAL + 1];
    for (int kind = 0; kind <= ROW_RIVAL; kind++)
        idle[kind] = median(l->idles[kind], l->idle[kind]);
    for (int i = 0; i < l->count; i++)
        for (int k = 0; k < l->row[i].rounds && l->row[i].kind != ROW_LIBRARY && !l->row[i].direct; k++)
            l->row[i].time[k] = fmax(0.5e-3, l->row[i].other[k] - idle[l->row[i].kind]);
}

static void run_case(bench_case *c, const plan *p, duel *d, scaling *s) {
    list l = {.row = room(MOST_ROWS * sizeof(row)), .todo = room(MOST_ROWS * sizeof(todo))};
    case_prepare(c);
    put_library(&l, p, c);
    if (!p->library) {
        put_ngspice(&l, p, c);
        put_siconos(&l, p, c);
    }
    for (int round = 0; round < p->rounds; round++) {
        run_idle(c, p, &l);
        for (int i = 0; i < l.count; i++)
            run_row(c, p, &l, i);
    }
    subtract_idle(&l);
    report_table(c, l.count, l.row);
    report_duel(c, l.count, l.row, d);
    report_files(c, folder, l.count, l.row);
    if (strncmp(c->name, "ladder", 6) == 0)
        scaling_add(s, c, l.count, l.row);
    fflush(stdout);
    free(l.row);
    free(l.todo);
}

/* --- all --- */

static int asked(const bench_case *c, const plan *p, int count, char **names) {
    for (int i = 0; i < count; i++)
        if (strstr(c->name, names[i]))
            return 1;
    return count == 0 && !(p->quick && c->slow);
}

int main(int argc, char **argv) {
    const char *bench = getenv("BENCH"), *cm = getenv("NONSMOOTH_CM");
    plan p = {.quick = bench && strcmp(bench, "quick") == 0,
              .library = bench && strcmp(bench, "library") == 0};
    bench_case c;
    duel duels[MOST_CASES];
    static scaling ladders;
    int count = 0;
    p.rounds = p.quick ? 1 : 3;
    p.limit = p.quick ? 1 : 10;
    if (!realpath(cm ? cm : "build/bench/nonsmooth.cm", p.cm)) {
        perror("nonsmooth.cm");
        return 1;
    }
    printf(
        "errors: the largest over some instants and unknowns, relative to the largest right value of each\n");
    for (int i = 0; case_make(i, p.quick, &c); i++) {
        if (asked(&c, &p, argc - 1, argv + 1))
            run_case(&c, &p, &duels[count++], &ladders);
        case_free(&c);
    }
    if (ladders.count > 0)
        scaling_report(&ladders, folder);
    report_summary(count, duels);
    return 0;
}
