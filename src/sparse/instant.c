/* src/sparse/instant.c - the integrals of x and lambda over an instant: those of the implicit steps of
 * negligible length that take away what jumps.
 */
#include "guards.h"
#include "largest.h"
#include "linalg/simd.h"
#include "step.h"

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

/* What jumps, taken away by an Euler step of length g. */
typedef struct impulses {
    const double *v; /* n+m: x, lambda at its end */
    double g, largest_y, largest_lambda;
} impulses;

/* Guard i of pair j there, relative to the largest of its kind, if no impulse can have its sign and it is
 * more than rounding; else 0. */
static double misfit_of(const ns_sparse *m, const impulses *of, int j, int i) {
    const int inside = m->mode[j] == NS_INSIDE;
    const double most = inside ? of->largest_lambda : of->largest_y,
                 usual = inside ? m->largest.lambda : m->largest.y,
                 value = guard(m, j, i, of->v, m->work.no_inputs, 0) +
                         ns_sparse_guard_rounding(m, j, of->v, m->work.removed, of->g);
    return value < -(of_largest * most + of_usual * usual) ? value / most : 0;
}

/* 1 if guard i of pair j, which blocks, holds in the whole step, with what does not jump: what jumps then is
 * no impulse of y, which would be more than anything else, but the drop over a small resistance that the jump
 * flows through.  *known: work.projected is that step. */
static int blocks(ns_sparse *m, double t, double g, int j, int i, int *known) {
    if (!*known && ns_sparse_step_euler(m, t, g, m->work.before_w, 1, m->work.projected, NULL) != NS_OK)
        return 0;
    *known = 1;
    return guard(m, j, i, m->work.projected, m->z, 1) >= 0;
}

int ns_sparse_instant_misfit(ns_sparse *m, double t, double g, int *pair, int *broken) {
    const ns_cached_factors *k;
    impulses of = {.v = m->work.v, .g = g};
    double worst = 0;
    const int is_finest = g <= ns_sparse_finest(m);
    int known = 0;
    *pair = -1;
    int status = ns_sparse_factors_factor(m->q, g, m->mode, 1, &k);
    if (status != NS_OK)
        return status;
    ns_sparse_step_rhs(m, g, m->work.removed, m->work.no_inputs, 0, 0);
    status = ns_sparse_factors_solve(m->q, k, m->r, m->work.v);
    if (status != NS_OK)
        return status == NS_E_SINGULAR ? NS_OK : status;
    ns_sparse_guard_largest(m, of.v, &of.largest_y, &of.largest_lambda);
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        for (int i = 0; i < guards && !ns_mode_slides(m->mode[j]); i++) {
            const double by = misfit_of(m, &of, j, i);
            if (by < worst && (m->mode[j] == NS_INSIDE || !is_finest || !blocks(m, t, g, j, i, &known))) {
                worst = by;
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
