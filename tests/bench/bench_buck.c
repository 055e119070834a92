/* tests/bench/bench_buck.c - the published run of the buck converter of the literature: 4,000,000 steps of 50
 * ps, theta = gamma = 1, events captured at the ends of steps; what a step costs beyond its matrix-vector
 * product.
 *
 *   product   the bare products of maps of the same size (p*q), nothing else
 *   inputs    ns_system_inputs, nothing else
 *   step      ns_theta_try + ns_theta_accept, events included; inputs apart
 *   run       inputs and steps: the whole run
 *
 * All four in turn, STEPS of each at a time; the medians of the turns, and the whole run.  CPU time of this
 * thread, one thread.
 */
#include "timing.h"

#include "facts.h"
#include "literature.h"
#include "theta/theta_internal.h"

enum { N = LIT_BUCK_N, STEPS = 20000, TURNS = 100, PARTS = 3, Z = 2 };
static const double h = 50e-12;

static volatile double sink;

static double inputs(const ns_system *s, long from, double *z) {
    const double start = now();
    for (long k = 0; k < STEPS; k++)
        ns_system_inputs(s, h * (double)(from + k + 1), NS_LEFT, z + Z * k);
    return now() - start;
}

static double steps(ns_theta *t, const double *z) {
    const double start = now();
    for (long k = 0; k < STEPS; k++) {
        must(ns_theta_try(t, h, z + Z * k, 0, NS_RESOLVE));
        must(ns_theta_accept(t));
    }
    return now() - start;
}

/* As the steps do, each from what the one before gave. */
static double products(const ns_theta *t) {
    static double in[64], out[256], a[64 * 256];
    const ns_map *map = t->trial.map;
    const int p = map->p, q = t->q;
    for (int i = 0; i < p * q; i++)
        a[i] = map->step[i];
    for (int k = 0; k < q; k++)
        in[k] = t->past.in[k];
    const double start = now();
    for (long k = 0; k < STEPS; k++) {
        ns_linalg_matvec(p, q, a, in, out);
        in[0] = out[0];
    }
    sink = out[1];
    return now() - start;
}

int main(void) {
    static double z[Z * STEPS], part[PARTS][2 * TURNS], whole[2 * TURNS], ratio[2 * TURNS];
    static const double w0[N];
    static const char *const names[PARTS] = {"product", "inputs", "step"};
    ns_system *s = lit_buck(2, LIT_STANDARD, LIT_GAIN_15);
    const ns_theta_options o = {1, 1, 0};
    ns_theta *t;
    double total = 0, x[N];
    must(ns_theta_create(s, &o, &t, NULL));
    must(ns_theta_start(t, w0, NULL));
    ns_system_inputs(s, 0, NS_RIGHT, z);
    for (int k = 0; k < 2; k++) {
        must(ns_theta_try(t, h * 1e-9, z, 1, NS_RESOLVE));
        must(ns_theta_accept(t));
    }
    for (int k = 0; k < 2 * TURNS; k++) {
        part[1][k] = inputs(s, (long)STEPS * k, z);
        part[2][k] = steps(t, z);
        part[0][k] = products(t);
        whole[k] = part[1][k] + part[2][k];
        ratio[k] = part[2][k] / part[0][k];
        total += whole[k];
    }
    must(ns_theta_read(t, x, NULL, NULL));
    const ns_counts *c = ns_theta_counts(t);
    const int p = t->trial.map->p;
    printf("buck, %d states, %d pairs, map %d x %d; %ld steps of 50 ps, v(200 us) = %.9f V\n", s->n, s->m, p,
           t->q, c->steps, x[LIT_BUCK_VOUT]);
    for (int i = 0; i < PARTS; i++)
        printf("%-8s %8.4f us\n", names[i], 1e6 * median(2 * TURNS, part[i]) / STEPS);
    printf("%-8s %8.4f us, in all %.3f s, %.4f us a step\n", "run", 1e6 * median(2 * TURNS, whole) / STEPS,
           total, 1e6 * total / (double)c->steps);
    printf("step / product %.2f\n", median(2 * TURNS, ratio));
    fact_put("buck of the literature step", total / (double)c->steps);
    fact_put("buck of the literature step over product", median(2 * TURNS, ratio));
    printf("%ld trials, %ld events, %ld problems, %ld pivots, %ld factors, %ld maps, %ld evicted\n",
           c->trials, c->events, c->problems, c->pivots, c->factors, c->maps, c->evicted);
    ns_theta_free(t);
    ns_system_free(s);
    return 0;
}
