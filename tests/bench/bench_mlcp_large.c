/* tests/bench/bench_mlcp_large.c - what large passive networks cost.
 *
 * Kinds of tests/unit/grids.h and random networks of networks.c, m = 200, 500, 1000, several of each:
 *   cold        W new to the solver, every pair at its lower bound
 *   warm        from the right mode, W known; W promised (ns_mlcp_same) or compared
 * beside floors of the same size: one product W lambda (dgemv), one ns_mlcp_residual() of the answer, one
 * dgetrf of W.  CPU time of this thread; medians; the repetitions of all that is timed take turns.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <lapacke.h>

#include "generators.h"
#include "grids.h"
#include "linalg/dense.h"

enum { REPEATS = 3, INSTANCES = 5, MAX = 1000, SAMPLES = REPEATS * INSTANCES };
enum { RANDOM_REDUCED = GRID_KINDS, RANDOM_WHOLE, KINDS };
enum { PRODUCT, RESIDUAL, FACTOR, COLD, WARM, COMPARED, TIMED };

static sample s;
static ns_mlcp_solver *solver;
static double lambda[MAX], y[MAX], *copy;
static int piv[MAX];
static ns_mode mode[MAX];

typedef struct tally {
    double time[TIMED][SAMPLES];
    int n, failed;
    long pivots, factors, method[NS_MLCP_METHODS];
    double residual;
} tally;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void make(int kind, int m, int number) {
    if (kind < GRID_KINDS) {
        grid_make(&s, kind, m, (unsigned long long)number);
        return;
    }
    s.dice = dice_make(98, (unsigned long long)number + 1000ULL * (unsigned)kind);
    if (kind == RANDOM_REDUCED)
        generate_reduced(&s, m);
    else
        generate_whole(&s, m);
}

static double floor_of(int which, const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    memcpy(copy, p->W, m * m * sizeof *copy);
    const double start = now();
    if (which == PRODUCT)
        ns_linalg_matvec(p->m, p->m, p->W, lambda, y);
    else if (which == RESIDUAL)
        (void)ns_mlcp_residual(p, lambda, NULL);
    else
        (void)LAPACKE_dgetrf(LAPACK_COL_MAJOR, p->m, p->m, copy, p->m, piv);
    return now() - start;
}

/* Counts are those of the cold solves. */
static double solve(tally *t, int which, const ns_mlcp *p) {
    ns_mlcp_info info;
    if (which == COLD) {
        memset(mode, NS_LOWER, (size_t)p->m);
        s.W[0] = nextafter(s.W[0], INFINITY);
    }
    (void)ns_mlcp_same(solver, which == WARM);
    const double start = now();
    const int status = ns_mlcp_solve(solver, p, mode, lambda, y, &info);
    const double took = now() - start;
    (void)ns_mlcp_same(solver, 0);
    t->failed += status != NS_OK;
    if (status == NS_OK)
        t->residual = fmax(t->residual, ns_mlcp_residual(p, lambda, NULL));
    if (which != COLD)
        return took;
    t->pivots += info.pivots;
    t->factors += info.factors;
    t->method[info.method]++;
    return took;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, z = *(const double *)b;
    return (x > z) - (x < z);
}

static double median(tally *t, int which) {
    qsort(t->time[which], (size_t)t->n, sizeof(double), ascending);
    return 1e3 * t->time[which][t->n / 2];
}

static void print(const char *name, int m, tally *t) {
    double ms[TIMED];
    for (int k = 0; k < TIMED; k++)
        ms[k] = median(t, k);
    printf("%-16s %5d %8.3f %8.3f %8.2f | %8.1f %8.1f  %8.3f %8.3f %6.2f |", name, m, ms[PRODUCT],
           ms[RESIDUAL], ms[FACTOR], ms[COLD], 1e3 * t->time[COLD][t->n - 1], ms[WARM], ms[COMPARED],
           ms[WARM] / ms[RESIDUAL]);
    printf(" %7.1f %7.1f  ", (double)t->pivots / t->n, (double)t->factors / t->n);
    for (int k = 0; k < NS_MLCP_METHODS; k++)
        if (t->method[k] > 0)
            printf("%s ", ns_mlcp_method_name(k));
    printf("%.0e%s\n", t->residual, t->failed ? "  FAILED" : "");
    fflush(stdout);
}

static void bench(const char *name, int kind, int m, int instances, int repeats) {
    tally t = {.n = 0};
    for (int i = 0; i < instances; i++) {
        make(kind, m, i);
        const ns_mlcp p = sample_problem(&s);
        for (int r = 0; r < repeats; r++, t.n++) {
            t.time[COLD][t.n] = solve(&t, COLD, &p);
            t.time[WARM][t.n] = solve(&t, WARM, &p);
            t.time[COMPARED][t.n] = solve(&t, COMPARED, &p);
            for (int k = PRODUCT; k <= FACTOR; k++)
                t.time[k][t.n] = floor_of(k, &p);
        }
    }
    print(name, m, &t);
}

/* [m [kind [instances [repeats]]]] */
int main(int argc, char **argv) {
    static const int sizes[] = {200, 500, 1000};
    const int only = argc > 1 ? atoi(argv[1]) : 0, one = argc > 2 ? atoi(argv[2]) : -1;
    const int instances = argc > 3 ? atoi(argv[3]) : INSTANCES, repeats = argc > 4 ? atoi(argv[4]) : REPEATS;
    copy = malloc((size_t)MAX * MAX * sizeof *copy);
    if (!copy || sample_create(MAX, &s) || ns_mlcp_create(MAX, &solver) != NS_OK ||
        instances * repeats > SAMPLES)
        return 2;
    printf("%-16s %5s %8s %8s %8s | %8s %8s  %8s %8s %6s | %7s %7s %6s\n", "medians in ms", "m", "W x",
           "residual", "dgetrf", "cold", "worst", "warm", "compared", "/resid", "pivots", "factors", "its");
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
        for (int kind = 0; kind < KINDS; kind++)
            if ((only == 0 || only == sizes[k]) && (one < 0 || one == kind))
                bench(kind < GRID_KINDS        ? grid_name(kind)
                      : kind == RANDOM_REDUCED ? "random reduced"
                                               : "random whole",
                      kind, sizes[k], instances, repeats);
    ns_mlcp_free(solver);
    sample_free(&s);
    free(copy);
    return 0;
}
