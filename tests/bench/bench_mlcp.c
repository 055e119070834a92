/* tests/bench/bench_mlcp.c - what a solve of (P1) costs.
 *
 * buck        the literature's buck converter, its steps of 10 ns reduced to 12 and 24 pairs:
 *               floor   ns_mlcp_residual() of the answer alone
 *               warm    from the mode of the step before, W known (and promised to be the same)
 *               cold    W changed before each solve (first looked at, copied, factored), all at the lower
 * bound Times are CPU time of this thread, one thread, the best of several repetitions; every answer is
 * checked by ns_mlcp_residual().
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "generators.h"
#include "literature.h"

enum { REPEATS = 7 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(int status, const char *what) {
    if (status == NS_OK)
        return;
    fprintf(stderr, "bench_mlcp: %s: %s\n", what, ns_status_text(status));
    exit(1);
}

static double *room(size_t n) {
    double *a = calloc(n, sizeof *a);
    if (!a)
        must(NS_E_MEMORY, "room");
    return a;
}

/* --- steps of the buck --- */

enum { STEPS = 5000 };

typedef struct steps {
    int m;
    double *W, *q, *l, *u, *lambda, *y; /* q: STEPS of them, one after the other */
    ns_mode *mode;
    ns_mlcp_solver *solver;
    long pivots, quick;
} steps;

static ns_mlcp problem_of(const steps *b, int k) {
    return (ns_mlcp){.m = b->m, .W = b->W, .q = b->q + (size_t)k * (size_t)b->m, .l = b->l, .u = b->u};
}

static void make_steps(steps *b, int hinges, lit_comparator comparator, double h) {
    ns_system *s = lit_buck(hinges, LIT_STANDARD, comparator);
    const size_t m = (size_t)s->m;
    *b = (steps){.m = s->m, .W = room(m * m), .q = room(m * STEPS), .l = room(m), .u = room(m)};
    b->lambda = room(m);
    b->y = room(m);
    b->mode = calloc(m, 1);
    must(b->mode ? ns_mlcp_create(s->m, &b->solver) : NS_E_MEMORY, "create");
    memcpy(b->l, s->l, m * sizeof *b->l);
    memcpy(b->u, s->u, m * sizeof *b->u);
    lit_reduced_matrix(s, h, b->W);
    double x[LIT_BUCK_N] = {0}, next[LIT_BUCK_N], z[2];
    memset(b->mode, NS_LOWER, m);
    for (int k = 0; k < STEPS; k++) {
        const double t = h * (k + 1);
        ns_system_inputs(s, t, NS_LEFT, z);
        lit_reduced_vector(s, h, x, z, b->q + (size_t)k * m);
        ns_mlcp p = problem_of(b, k);
        must(ns_mlcp_solve(b->solver, &p, b->mode, b->lambda, b->y, NULL), "buck");
        lit_reduced_state(s, h, x, z, b->lambda, next);
        memcpy(x, next, sizeof x);
    }
    ns_system_free(s);
}

static void free_steps(steps *b) {
    double *all[] = {b->W, b->q, b->l, b->u, b->lambda, b->y};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
    free(b->mode);
    ns_mlcp_free(b->solver);
}

enum { FLOOR, SAME, WARM, COLD, KINDS };

static double run_steps(steps *b, int kind, double *worst) {
    const size_t m = (size_t)b->m;
    double elapsed = 0;
    ns_mlcp_info info;
    b->pivots = b->quick = 0;
    memset(b->mode, NS_LOWER, m);
    must(ns_mlcp_same(b->solver, kind == SAME), "same");
    double start = now();
    for (int k = 0; k < STEPS; k++) {
        ns_mlcp p = problem_of(b, k);
        if (kind == FLOOR) {
            if (ns_mlcp_residual(&p, b->lambda, NULL) > 1e300)
                exit(1);
            continue;
        }
        if (kind == COLD) {
            b->W[m * m - 1] *= k % 2 ? 1 - 1e-15 : 1 + 1e-15;
            memset(b->mode, NS_LOWER, m);
        }
        must(ns_mlcp_solve(b->solver, &p, b->mode, b->lambda, b->y, &info), "buck");
        b->pivots += info.pivots;
        b->quick += info.method == NS_MLCP_PIVOT;
    }
    elapsed = now() - start;
    must(ns_mlcp_same(b->solver, 0), "same");
    for (int k = 0; kind != FLOOR && k < STEPS; k++) { /* again, judged */
        ns_mlcp p = problem_of(b, k);
        must(ns_mlcp_solve(b->solver, &p, b->mode, b->lambda, b->y, NULL), "buck");
        *worst = fmax(*worst, ns_mlcp_residual(&p, b->lambda, NULL));
    }
    return elapsed / STEPS;
}

static void bench_buck(void) {
    static const char *const names[KINDS] = {"residual check alone", "warm, same W promised",
                                             "warm, W compared", "cold"};
    printf("buck, %d steps of 10 ns  pairs      us  pivots a step  by pivoting  worst residual\n", STEPS);
    for (int c = 0; c < 4; c++) {
        steps b;
        make_steps(&b, c < 2 ? 2 : 5, c % 2 ? LIT_RELAY : LIT_GAIN_15, 1e-8);
        for (int kind = 0; kind < KINDS; kind++) {
            double best = INFINITY, worst = 0;
            for (int r = 0; r < REPEATS; r++)
                best = fmin(best, run_steps(&b, kind, &worst));
            printf("%-24s %5d  %6.2f %14.3f %11.1f%% %15.1e\n", names[kind], b.m, best * 1e6,
                   (double)b.pivots / STEPS, 100.0 * (double)b.quick / STEPS, worst);
        }
        free_steps(&b);
    }
}

int main(void) {
    bench_buck();
    return 0;
}
