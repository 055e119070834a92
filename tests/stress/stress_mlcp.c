/* tests/stress/stress_mlcp.c - solves thousands of random problems of each class and judges every answer.
 *
 *     stress_mlcp [COUNT [CLASS [FIRST]]]     COUNT problems of each class, or of one, from number FIRST on
 *     stress_mlcp dump CLASS NUMBER           writes a problem in the text form of nsc-mlcp
 *
 * Judged: the verdict; the library's residual; the one of sample.c, which shares nothing with it; where there
 * is one answer only, that it came; where there is none, that it is proved.  A line a failure, then a line a
 * class. (gave up: of the failed those without a verdict; m is spread evenly in its logarithm.)
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "generators.h"

enum { MAX = 200, COUNT = 2000 };
static const double RESIDUAL = 1e-10;

typedef struct tally {
    long done, failed, gave_up, pairs, pivots;
    double residual, own, error, seconds, slowest; /* the worst of each */
} tally;

static sample s;
static ns_mlcp_solver *solver;
static ns_mode mode[MAX];
static double lambda[MAX], y[MAX];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void say(int class, unsigned long long number, const char *why, double what) {
    printf("FAIL  %s %llu  m = %d, %s%s: %s %.3g\n", generator_name(class), number, s.m, s.kind,
           s.exact ? ", short" : "", why, what);
}

static void start_mode(void) {
    int how = dice_below(&s.dice, 3);
    for (int i = 0; i < s.m; i++)
        mode[i] = how == 0 ? NS_LOWER : how == 1 ? NS_INSIDE : (ns_mode)(dice_below(&s.dice, 3) - 1);
}

static void larger(double *most, double v) {
    if (!(v <= *most))
        *most = v;
}

/* What was made to have no solution must be called so, with a proof. */
static const char *judge_verdict(const ns_mlcp *p, int status, double *what) {
    const double *v = ns_mlcp_certificate(solver);
    *what = status;
    if (status == NS_OK)
        return "solved, but has no solution";
    if (status != NS_E_INFEASIBLE)
        return ns_status_name(status);
    if (!v)
        return "no certificate";
    if (!((*what = ns_mlcp_certify(p, v)) > 0))
        return "certificate proves nothing";
    return (*what = sample_margin(&s, v)) > 0 ? NULL : "certificate proves nothing, by sample.c";
}

/* NULL, or what is wrong; the number that says it goes to *what. */
static const char *judge(tally *t, const ns_mlcp *p, int status, double *what) {
    t->gave_up += status != NS_OK && status != NS_E_INFEASIBLE;
    if (s.none)
        return judge_verdict(p, status, what);
    *what = status;
    if (status != NS_OK)
        return ns_status_name(status);
    double residual = ns_mlcp_residual(p, lambda, NULL), own = sample_residual(&s, lambda);
    larger(&t->residual, residual);
    larger(&t->own, own);
    if (!((*what = residual) < RESIDUAL))
        return "residual";
    if (!((*what = own) < RESIDUAL))
        return "own residual";
    if (!s.unique)
        return NULL;
    /* rounding of the data and of m sums, or what the residual leaves, times the condition */
    double condition, error = sample_error(&s, lambda, mode, &condition);
    double allowed = condition * fmax(1e-15 * s.m, residual);
    *what = error > 0 ? error / allowed : 0;
    larger(&t->error, *what);
    return *what <= 10 ? NULL : "not the known lambda: error over allowed";
}

static void solve(tally *t, int class, unsigned long long number) {
    generate(&s, class, number, MAX);
    start_mode();
    ns_mlcp p = sample_problem(&s);
    ns_mlcp_info info;
    double what, start = now();
    int status = ns_mlcp_solve(solver, &p, mode, lambda, y, &info);
    double took = now() - start;
    const char *why = judge(t, &p, status, &what);
    if (why) {
        t->failed++;
        say(class, number, why, what);
    }
    t->done++;
    t->pairs += s.m;
    t->pivots += info.pivots;
    t->seconds += took;
    larger(&t->slowest, took);
}

static long run(int class, unsigned long long first, long count) {
    tally t = {0};
    for (long k = 0; k < count; k++)
        solve(&t, class, first + (unsigned long long)k);
    printf("%-11s %8ld %6ld %7ld %7.1f %7.1f %10.1e %10.1e %8.2g %9.1f %9.2f\n", generator_name(class),
           t.done, t.failed, t.gave_up, (double)t.pairs / (double)count, (double)t.pivots / (double)count,
           t.residual, t.own, t.error, t.seconds, 1e3 * t.slowest);
    fflush(stdout);
    return t.failed;
}

static void dump_vector(const double *v) {
    for (int i = 0; i < s.m; i++)
        printf("%.17g%c", v[i], i < s.m - 1 ? ' ' : '\n');
}

static int dump(int class, unsigned long long number) {
    generate(&s, class, number, MAX);
    printf("# %s %llu: %s\n%d\n", generator_name(class), number, s.kind, s.m);
    for (int i = 0; i < s.m; i++)
        for (int j = 0; j < s.m; j++)
            printf("%.17g%c", s.W[i + j * s.m], j < s.m - 1 ? ' ' : '\n');
    dump_vector(s.q);
    dump_vector(s.l);
    dump_vector(s.u);
    return 0;
}

int main(int argc, char **argv) {
    if (sample_create(MAX, &s) || ns_mlcp_create(MAX, &solver) != NS_OK)
        return 2;
    int dumping = argc == 4 && strcmp(argv[1], "dump") == 0, class = argc > 2 ? generator_of(argv[2]) : -1;
    if ((argc > 2 && class < 0) || argc > 4)
        return fprintf(stderr, "usage: see the head of tests/stress/stress_mlcp.c\n"), 2;
    unsigned long long first = argc > 3 ? strtoull(argv[3], NULL, 10) : 0;
    if (dumping)
        return dump(class, first);
    long count = argc > 1 ? strtol(argv[1], NULL, 10) : COUNT, failed = 0;
    printf("%-11s %8s %6s %7s %7s %7s %10s %10s %8s %9s %9s\n", "class", "problems", "failed", "gave up",
           "pairs", "pivots", "residual", "own", "error", "s", "most ms");
    for (int k = 0; k < ALL_CLASSES; k++)
        if (class < 0 || k == class)
            failed += run(k, first, count);
    printf("%ld failed\n", failed);
    ns_mlcp_free(solver);
    sample_free(&s);
    return failed > 0;
}
