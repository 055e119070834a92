/* src/sparse/largest.c - the largest charges, fluxes, lambda and y so far. */
#include "largest.h"

#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A step may have a mode that its first guard ends at once, and currents there that no device carries: 1e18 A
 * around a closed switch and a diode that drops 10 nV.  They count up to so many times the largest. */
static const double most_growth = 1e3;

void ns_sparse_largest_reset(ns_sparse *m) {
    double *const w = m->largest.w;
    memset(w, 0, sizeof(double) * (size_t)m->f->n);
    m->largest = (ns_sparse_largest){.w = w};
}

double ns_sparse_largest_w(ns_sparse *m, const ns_dense_step *step) {
    const int n = m->f->n;
    double *w = m->largest.w, largest = 0;
    for (int i = 0; i < n; i++)
        if (!m->f->algebraic[i]) {
            w[i] = ns_higher(fabs(step->powers[n + i]), ns_higher(fabs(step->powers[i]), w[i]));
            largest = ns_higher(w[i] / m->unit[i], largest);
        }
    return largest;
}

/* Of steps as long as this one, or longer: volts and amperes of a shorter one may be those of a transient. */
static double largest_up_to(const double *of, int exponent) {
    double largest = 0;
    for (int k = 0; k <= exponent; k++)
        largest = ns_higher(of[k], largest);
    return largest;
}

/* Of x, lambda = v - of next. */
static void take_guards(ns_sparse *m, const double *v, const double *next, double of, int exponent) {
    double lambda = largest_up_to(m->largest.lambda_of, exponent),
           y = largest_up_to(m->largest.y_of, exponent);
    for (int j = 0; j < m->f->m; j++) {
        double lambda_j = v[m->f->n + j], y_j = ns_linalg_csc_dot(&m->f->Ct, j, v);
        if (of != 0) {
            lambda_j -= of * next[m->f->n + j];
            y_j -= of * ns_linalg_csc_dot(&m->f->Ct, j, next);
        }
        lambda = ns_higher(fabs(lambda_j), lambda);
        y = ns_higher(fabs(y_j), y);
    }
    m->largest.lambda = lambda;
    m->largest.y = y;
}

void ns_sparse_largest_guards(ns_sparse *m, const double *v, int exponent) {
    take_guards(m, v, NULL, 0, exponent);
}

double ns_sparse_largest_part(ns_sparse *m, const ns_dense_step *step, double tau) {
    const int n = m->f->n;
    const double s = tau / step->g, *by = step->powers + n, *next = by + n;
    double *w = m->largest.w, largest = 0;
    for (int i = 0; i < n; i++)
        if (!m->f->algebraic[i]) { /* (E2) */
            const double end = step->powers[i] + s * by[i] + s * (0.5 * s - 1) * next[i];
            w[i] = ns_higher(fabs(end), ns_higher(fabs(step->powers[i]), w[i]));
            largest = ns_higher(w[i] / m->unit[i], largest);
        }
    take_guards(m, step->images, step->images + m->f->size, 1 - s, step->length_exponent); /* (E1) */
    return largest;
}

/* What the largest may become by a step that lasts no time; if there was none, anything. */
static double bounded(double now, const double *of, int exponent) {
    const double before = largest_up_to(of, exponent);
    return before > 0 ? ns_lower(now, most_growth * before) : now;
}

void ns_sparse_largest_accept(ns_sparse *m, int exponent, int lasts) {
    ns_sparse_largest *l = &m->largest;
    l->lambda_of[exponent] = lasts ? l->lambda : bounded(l->lambda, l->lambda_of, exponent);
    l->y_of[exponent] = lasts ? l->y : bounded(l->y, l->y_of, exponent);
}

static void copy_largest(const ns_sparse *m, const ns_sparse_largest *from, ns_sparse_largest *to) {
    double *const w = to->w;
    memcpy(w, from->w, sizeof(double) * (size_t)m->f->n);
    *to = *from;
    to->w = w;
}

void ns_sparse_largest_save(ns_sparse *m, ns_sparse_largest *to) {
    copy_largest(m, &m->largest, to);
}

void ns_sparse_largest_restore(ns_sparse *m, const ns_sparse_largest *from) {
    copy_largest(m, from, &m->largest);
}

double ns_sparse_largest_size(const ns_sparse *m) {
    double max = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            max = ns_higher(ns_higher(fabs(m->w[i]), m->largest.w[i]) / m->unit[i], max);
    return max;
}

double ns_sparse_largest_of(const ns_sparse *m, const double *of) {
    double max = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            max = ns_higher(fabs(of[i]) / m->unit[i], max);
    return max;
}

double ns_sparse_largest_rounding(const ns_sparse *m) {
    static const double rounding = 64 * DBL_EPSILON;
    const ns_input_stages *in = m->in;
    double volts = 0, unit = 0;
    for (int j = 0; j < m->f->m; j++)
        volts = fmax(volts, fabs(m->f->e[j]));
    for (int i = 0; i < m->f->n; i++)
        volts = m->f->algebraic[i] ? fmax(volts, fabs(m->f->b[i])) : volts;
    for (int k = 0; k < m->f->nz; k++)
        volts = in->enters[k] ? fmax(volts, fmax(in->max_abs[k], fabs(in->sum[k].value))) : volts;
    for (int i = 0; i < m->f->n; i++)
        unit = m->f->algebraic[i] ? unit : fmax(unit, m->unit[i]);
    return rounding * volts * unit;
}
