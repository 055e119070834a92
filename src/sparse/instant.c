/* src/sparse/instant.c - the integrals of x and lambda over an instant: those of the implicit steps of
 * negligible length that take away what jumps.
 */
#include "guards.h"
#include "largest.h"
#include "linalg/simd.h"

#include <string.h>

/* Steps: one is enough for what has no finite rate; what is left of it, in errors of a step, that counts as
 * nothing: w has parts that no step takes away. */
enum { MOST_STEPS = 4 };
static const double nothing = 4;
/* An impulse is none below these fractions of the largest one, and of the largest lambda or y so far. */
static const double of_largest = 1e-6, of_usual = 1e-3;

int ns_sparse_instant_add(ns_sparse *m, double g, ns_instant *to) {
    const ns_cached_factors *k;
    const int n = m->f->n;
    double *left = m->work.w, *v = m->work.v;
    memcpy(left, m->work.removed, sizeof *left * (size_t)n);
    const double least = nothing * m->o.reltol * ns_sparse_largest_of(m, left);
    int status = ns_sparse_factors_factor(m->q, g, m->mode, 1, &k);
    for (int step = 0; step < MOST_STEPS && status == NS_OK && ns_sparse_largest_of(m, left) > least;
         step++) {
        ns_sparse_step_rhs(m, g, left, m->work.no_inputs, 0, 0);
        status = ns_sparse_factors_solve(m->q, k, m->r, v);
        if (status != NS_OK && status != NS_E_SINGULAR) /* only rounding contradicts: it did not before */
            return status;
        ns_instant_add(to, 0, m->f->size, g, v);
        for (int i = 0; i < n; i++)
            left[i] = m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Mt, i, v);
    }
    return status == NS_E_SINGULAR ? NS_OK : status;
}

int ns_sparse_instant_misfit(ns_sparse *m, double g, int *pair, int *broken) {
    const ns_cached_factors *k;
    double *v = m->work.v, largest_y, largest_lambda, worst = 0;
    *pair = -1;
    int status = ns_sparse_factors_factor(m->q, g, m->mode, 1, &k);
    if (status != NS_OK)
        return status;
    ns_sparse_step_rhs(m, g, m->work.removed, m->work.no_inputs, 0, 0);
    status = ns_sparse_factors_solve(m->q, k, m->r, v);
    if (status != NS_OK)
        return status == NS_E_SINGULAR ? NS_OK : status;
    ns_sparse_guard_largest(m, v, &largest_y, &largest_lambda);
    for (int j = 0; j < m->f->m; j++) {
        const int inside = m->mode[j] == NS_INSIDE, guards = guards_of(m, j);
        const double most = inside ? largest_lambda : largest_y,
                     usual = inside ? m->largest.lambda : m->largest.y,
                     rounding = ns_sparse_guard_rounding(m, j, v, m->work.removed, g);
        for (int i = 0; i < guards && !ns_mode_slides(m->mode[j]); i++) {
            const double of = guard(m, j, i, v, m->work.no_inputs, 0) + rounding;
            if (of < -(of_largest * most + of_usual * usual) && of / most < worst) {
                worst = of / most;
                *pair = j;
                *broken = i;
            }
        }
    }
    return NS_OK;
}

void ns_sparse_instant_save(ns_sparse *m) {
    m->before_event.instant.any = m->instant.any;
    if (m->instant.any)
        memcpy(m->before_event.instant.sum, m->instant.sum, sizeof(double) * (size_t)m->instant.size);
}

void ns_sparse_instant_restore(ns_sparse *m) {
    ns_instant_clear(&m->instant);
    if (m->before_event.instant.any)
        ns_instant_add(&m->instant, 0, m->instant.size, 1, m->before_event.instant.sum);
}

int ns_sparse_impulse(ns_engine *e, double *x, double *lambda) {
    const ns_sparse *m = ns_sparse_of(e);
    const ns_output_only *o = m->output_only;
    for (int i = 0; x && i < o->whole->n; i++)
        x[i] = 0; /* those left out hold nothing */
    for (int i = 0; x && i < m->f->n; i++)
        x[o->stays[i]] = m->instant.sum[i];
    if (lambda)
        memcpy(lambda, m->instant.sum + m->f->n, sizeof(double) * (size_t)m->f->m);
    return m->started ? NS_OK : NS_E_STATE;
}
