/* tests/bench/bench_literature.c - the buck converter of the literature: its whole start-up, 200 us, and the
 * complementarity problems of its steps.
 *
 * The published run is 4,000,000 steps of 50 ps with theta = 1, events captured at the ends of steps.
 *   capture   ns_theta, NS_RESOLVE
 *   march     ns_march, events located: at the published h and theta, and at h = 4 ns, theta = gamma = 1/2
 *   problem   ns_mlcp_solve on (P1) reduced to lambda, of 200,000 successive steps of 50 ps, the median and
 *             the least of some passes: warm from the mode before, W compared or promised to stay; cold from
 *             all pairs at their lower bounds, on every hundredth, W known or another one each time.
 * Errors: the largest over samples a microsecond apart, relative to the sizes of the states, against the
 * marcher at 0.25 ns, theta = gamma = 1/2, whose own shows in how far it is from that at 0.5 ns (the unit
 * tests hold it against an integrator of another kind).  CPU time of this thread, one thread.
 */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "lit_run.h"
#include "literature.h"

enum { SAMPLES = 200, N = LIT_BUCK_N, PROBLEMS = 200000, PASSES = 5, APART = 100 };
static const double every = 1e-6;
static const double size_of[N] = {0.5, 1.8, 0.01, 0.2, 2};

/* --- the start-up --- */

typedef int (*runner)(const ns_system *, const double *, const lit_plan *, double *, ns_counts *);

static double compare(const double *a, const double *b) {
    double worst = 0;
    for (int i = 0; i < SAMPLES * N; i++)
        worst = fmax(worst, fabs(a[i] - b[i]) / size_of[i % N]);
    return worst;
}

static void show(const ns_system *s, const char *name, runner run, double theta, double h,
                 const double *reference) {
    static double X[SAMPLES * N];
    static const double w0[N];
    const lit_plan plan = {theta, theta, h, every, SAMPLES};
    ns_counts c;
    const double start = now();
    must(run(s, w0, &plan, X, &c));
    const double time = now() - start;
    printf("%-8s %5.2f %6g %8.3f %8.4f %9ld %9.2e %7ld %8ld %8ld %8ld %6ld\n", name, theta, h * 1e12, time,
           time * 1e6 / (double)c.steps, c.steps, compare(X, reference), c.events, c.problems, c.pivots,
           c.factors, c.maps);
}

static void startup(int hinges, lit_set set, lit_comparator comparator) {
    static double reference[SAMPLES * N];
    static const double w0[N];
    ns_system *s = lit_buck(hinges, set, comparator);
    const lit_plan plan = {0.5, 0.5, 0.25e-9, every, SAMPLES};
    ns_counts c;
    must(lit_march(s, w0, &plan, reference, &c));
    printf("%d pairs, %s set%s; 200 us\n", s->m, set == LIT_STANDARD ? "standard" : "sliding",
           comparator == LIT_RELAY ? ", comparator of zero width" : "");
    printf("%-8s %5s %6s %8s %8s %9s %9s %7s %8s %8s %8s %6s\n", "run", "theta", "h ps", "s", "us/step",
           "steps", "error", "events", "problems", "pivots", "factors", "maps");
    show(s, "march", lit_march, 0.5, 0.5e-9, reference);
    show(s, "march", lit_march, 0.5, 4e-9, reference);
    if (set == LIT_STANDARD && comparator == LIT_GAIN_15) {
        show(s, "capture", lit_capture, 1, 50e-12, reference);
        show(s, "march", lit_march, 1, 50e-12, reference);
    } else
        show(s, "capture", lit_capture, 1, 500e-12, reference);
    ns_system_free(s);
}

/* --- the problems --- */

/* q of successive steps, from rest on. */
static double *problems_of(const ns_system *s, double h, const double *W) {
    const size_t m = (size_t)s->m;
    double *q = room(sizeof(double) * m * PROBLEMS), x[N] = {0}, next[N], z[2], lambda[24], y[24];
    ns_mode mode[24] = {0};
    ns_mlcp_solver *solver;
    must(ns_mlcp_create(s->m, &solver));
    for (int k = 0; k < PROBLEMS; k++) {
        const ns_mlcp p = {.m = s->m, .W = W, .q = q + (size_t)k * m, .l = s->l, .u = s->u};
        ns_system_inputs(s, h * (k + 1), NS_LEFT, z);
        lit_reduced_vector(s, h, x, z, q + (size_t)k * m);
        must(ns_mlcp_solve(solver, &p, mode, lambda, y, NULL));
        lit_reduced_state(s, h, x, z, lambda, next);
        memcpy(x, next, sizeof x);
    }
    ns_mlcp_free(solver);
    return q;
}

enum { WARM, WARM_SAME, COLD, COLD_NEW, KINDS };
static const char *const kinds[KINDS] = {"warm", "warm, W promised", "cold, W known", "cold, W new"};

typedef struct pass {
    double time; /* s a solve */
    double worst;
    long solves, changes, pivots, factors, others; /* others: not by pivoting */
} pass;

/* W: two of them, a rounding apart.  q: of the problems of this kind, one after the other: who solves a
 * problem has just made its q. */
static pass solve_all(const ns_system *s, const double *W, const double *q, int kind) {
    const size_t m = (size_t)s->m;
    const int count = kind >= COLD ? PROBLEMS / APART : PROBLEMS;
    double lambda[24], y[24];
    ns_mode mode[24] = {0}, before[24];
    ns_mlcp_solver *solver;
    pass r = {0};
    must(ns_mlcp_create(s->m, &solver));
    const double start = now();
    for (int k = 0; k < count; k++) {
        const int other = kind == COLD_NEW && r.solves % 2;
        const ns_mlcp p = {
            .m = s->m, .W = W + (other ? m * m : 0), .q = q + (size_t)k * m, .l = s->l, .u = s->u};
        ns_mlcp_info info;
        if (kind >= COLD)
            memset(mode, NS_LOWER, m);
        memcpy(before, mode, m);
        must(ns_mlcp_solve(solver, &p, mode, lambda, y, &info));
        if (k == 0 && kind == WARM_SAME)
            must(ns_mlcp_same(solver, 1));
        r.solves++;
        r.changes += memcmp(before, mode, m) != 0;
        r.pivots += info.pivots;
        r.factors += info.factors;
        r.others += info.method != NS_MLCP_PIVOT;
        r.worst = fmax(r.worst, info.residual);
    }
    r.time = (now() - start) / (double)r.solves;
    ns_mlcp_free(solver);
    return r;
}

static int by_time(const void *a, const void *b) {
    const double x = ((const pass *)a)->time, y = ((const pass *)b)->time;
    return (x > y) - (x < y);
}

static void problems(int hinges, lit_set set, lit_comparator comparator) {
    const double h = 50e-12;
    ns_system *s = lit_buck(hinges, set, comparator);
    const size_t n = (size_t)s->m * (size_t)s->m;
    double *W = room(2 * n * sizeof *W);
    lit_reduced_matrix(s, h, W);
    memcpy(W + n, W, n * sizeof *W);
    W[2 * n - 1] *= 1 + 1e-15;
    double *q = problems_of(s, h, W), *apart = room(sizeof *q * (size_t)s->m * (PROBLEMS / APART));
    for (size_t k = 0; k < PROBLEMS / APART; k++)
        memcpy(apart + k * (size_t)s->m, q + k * APART * (size_t)s->m, (size_t)s->m * sizeof *q);
    printf("%d pairs, %s set%s\n", s->m, set == LIT_STANDARD ? "standard" : "sliding",
           comparator == LIT_RELAY ? ", comparator of zero width" : "");
    for (int kind = 0; kind < KINDS; kind++) {
        pass r[PASSES];
        for (int k = 0; k < PASSES; k++)
            r[k] = solve_all(s, W, kind >= COLD ? apart : q, kind);
        qsort(r, PASSES, sizeof *r, by_time);
        const pass *p = &r[PASSES / 2];
        printf("  %-16s %8.3f %8.3f %8ld %8ld %8ld %8ld %8ld %9.1e\n", kinds[kind], p->time * 1e6,
               r[0].time * 1e6, p->solves, p->changes, p->pivots, p->factors, p->others, p->worst);
    }
    free(apart);
    free(q);
    free(W);
    ns_system_free(s);
}

static void all_problems(void) {
    printf("\n(P1) of the steps of 50 ps; warm: from the mode of the step before; cold: no mode known (all "
           "pairs "
           "at their\nlower bounds) and nothing kept but the solver's memory and a copy of W, or not even "
           "that\n");
    printf("  %-16s %8s %8s %8s %8s %8s %8s %8s %9s\n", "start", "us", "least us", "solves", "changes",
           "pivots", "factors", "others", "residual");
    for (int k = 0; k < 8; k++)
        problems(k < 4 ? 2 : 5, k % 4 < 2 ? LIT_STANDARD : LIT_SLIDING, k % 2 ? LIT_RELAY : LIT_GAIN_15);
}

int main(void) {
    startup(2, LIT_STANDARD, LIT_GAIN_15);
    startup(5, LIT_STANDARD, LIT_GAIN_15);
    startup(2, LIT_SLIDING, LIT_GAIN_15);
    startup(2, LIT_SLIDING, LIT_RELAY);
    all_problems();
    return 0;
}
