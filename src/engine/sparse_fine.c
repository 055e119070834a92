/* src/engine/sparse_fine.c - what is not of finite rate goes at once: charges and fluxes made consistent with
 * a mode.
 *
 * With D of (E1), of a short step g: D^N w vanishes for all that takes longer than some g, and is w for what
 * has no time of its own, a capacitor shorted or an inductor interrupted.  So
 *
 *     w+ = w - D^N w,   N = 8
 *
 * What a step takes for too short a time anyhow is damped by it.
 *
 * An inductor that is interrupted drives what floats to volts beyond count, and resistors there take
 * differences of these.  So unknowns are kept, and residuals of (P2) are formed, in long double.  The last
 * correction tells how good the answer is.
 */
#include "sparse_leaky.h"
#include "sparse_march.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { ROUNDS = 4, SOON = 5 };
/* Shares of the largest charge or flux: what is nothing; what is a jump; what a correction that is the last
 * moves by; and by more than what it says that digits are lost. */
static const double nothing = 64 * DBL_EPSILON, a_jump = 1e-11, fine_enough = 1e-14, lost = 1e-8,
                    rounding = 1e-11;
/* g a of what D^8 leaves nothing of. */
static const double slow = 0.05;
/* Of shortened steps this share will do. */
static const double enough = 1e-6;

double ns_fine_size(const ns_sparse *m) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = fmax(most, fmax(fabs(m->w[i]), m->scale[i]) / m->unit[i]);
    return most;
}

static double largest(const ns_sparse *m, const double *of) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = fmax(most, fabs(of[i]) / m->unit[i]);
    return most;
}

static long double dot(const ns_csc *a, int j, const long double *x) {
    long double sum = 0;
    for (int k = a->start[j]; k < a->start[j + 1]; k++)
        sum += (long double)a->value[k] * x[a->row[k]];
    return sum;
}

/* rest = r - K x */
static void residual(const ns_sparse *m, double g, const long double *x, double *rest) {
    const ns_form *f = m->f;
    for (int i = 0; i < f->n; i++) {
        const long double held = f->algebraic[i] ? 0 : dot(&f->Mt, i, x);
        rest[i] = (double)(m->r[i] - held + (long double)ns_form_rate(f, g, i) * dot(&f->At, i, x));
    }
    for (int j = 0; j < f->m; j++) {
        const long double law = ns_slides(m->mode[j])     ? dot(&f->gx, f->command[j], x)
                                : m->mode[j] == NS_INSIDE ? dot(&f->Ct, j, x)
                                                          : x[f->n + j];
        rest[f->n + j] = (double)(m->r[f->n + j] - law);
    }
}

/* by = g (A x + B lambda + f); by how much that changed, at most. */
static double rates(const ns_sparse *m, double g, const long double *x, double *by) {
    const ns_form *f = m->f;
    double most = 0;
    for (int i = 0; i < f->n; i++) {
        const double old = by[i];
        by[i] = f->algebraic[i] ? 0 : (double)(g * (dot(&f->At, i, x) + m->rate[i]));
        if (!f->algebraic[i])
            most = fmax(most, fabs(by[i] - old) / m->unit[i]);
    }
    return most;
}

/* 1 if the answer so far leaves of (P2) more than rounding. */
static int contradicts(const ns_sparse *m, double g, const ns_kept *k) {
    for (int i = 0; i < m->f->size; i++)
        m->next_v[i] = (double)m->fine[i];
    return !(ns_leaky_left(m->f, g, m->mode, k->scale, m->r, m->next_v, NULL, m->rest) <= rounding);
}

/* by: D of the last ns_leg_solve(), to the last digit of what is of this size.  *fine: 0 if it was, without.
 */
static int correct(ns_sparse *m, double g, const ns_kept *k, double size, const double *v, double *by,
                   int *fine) {
    const int all = m->f->size;
    double moved = INFINITY;
    int status = NS_OK;
    for (int i = 0; i < all; i++)
        m->fine[i] = v[i];
    for (int round = 0; round < ROUNDS && moved > fine_enough * size; round++) {
        residual(m, g, m->fine, m->rest);
        status = ns_modal_solve(m->q, k, m->rest, m->next_v);
        if (status == NS_E_SINGULAR && contradicts(m, g, k))
            return status;
        if (status == NS_E_SINGULAR) /* only rounding does */
            return NS_OK;
        if (status != NS_OK)
            return status;
        for (int i = 0; i < all; i++)
            m->fine[i] += m->next_v[i];
        moved = rates(m, g, m->fine, by);
        *fine = *fine && (round > 0 || moved > fine_enough * size);
    }
    return moved <= lost * size ? NS_OK : NS_E_RESIDUAL;
}

/* What is left after another step: NOTHING; nothing but what has no time of its own, which all later ones
 * only turn over (ALL_OF_IT); else SOME. */
typedef enum left { SOME, NOTHING, ALL_OF_IT } left;

static left compare(const ns_sparse *m, double size, const double *before, const double *by, double *turned) {
    double most = 0;
    *turned = 0;
    if (largest(m, by) <= nothing * size)
        return NOTHING;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = fmax(most, fabs(before[i] + by[i]) / m->unit[i]);
    *turned = most;
    return most <= nothing * size ? ALL_OF_IT : SOME;
}

/* D^N w, in m->next_w, from the first D^count w that tell.  fine: with corrections, until one moves nothing.
 * first: D w, NULL: not known yet.  *turned: the largest of D^N w + D^(N-1) w, which is nothing of what has
 * no time of its own. */
static int powers(ns_sparse *m, double t, double g, int count, int fine, const double *first, left *what,
                  double *turned) {
    const ns_kept *k;
    const int n = m->f->n;
    double size = ns_fine_size(m), *by = m->scale + n;
    memcpy(m->next_w, m->w, sizeof(double) * (size_t)n);
    int status = ns_modal_factor(m->q, g, m->mode, 1, &k);
    *what = SOME;
    for (int i = 0; i < count && status == NS_OK && *what == SOME; i++) {
        if (i == 0 && first)
            memcpy(by, first, sizeof(double) * (size_t)n);
        else
            status = ns_leg_solve(m, k, t, g, i, m->next_w, m->z, m->v, by);
        if (status == NS_E_SINGULAR && i > 0 && largest(m, m->next_w) <= a_jump * size) {
            *what = NOTHING; /* rounding contradicts itself */
            return NS_OK;
        }
        size = i == 0 ? fmax(size, largest(m, by)) : size; /* at a start there is nothing yet */
        if (status == NS_OK && fine)
            status = correct(m, g, k, size, m->v, by, &fine);
        if (status == NS_OK)
            *what = compare(m, size, m->next_w, by, turned);
        for (int r = 0; r < n; r++)
            m->next_w[r] = *what == ALL_OF_IT && i % 2 == 0 ? -by[r] : by[r];
    }
    return status;
}

/* A step that leaves next to nothing of D^8 w, if there is one between least and g; else the longest. */
static double better(double g, double least, double longest, double goes, double turned) {
    const double wanted = g * turned / goes * slow; /* D = -g a/(1 + g a) of a rate a: goes/turned = g a */
    return g > least && wanted >= least / 4 ? fmax(least, fmin(wanted, g / 2)) : longest;
}

int ns_fine_consistent(ns_sparse *m, double t, ns_short *g, const double *first, int *jumped) {
    const double size = ns_fine_size(m);
    double turned;
    left what;
    *jumped = 0;
    g->next = g->now;
    int status = powers(m, t, g->now, SOON, 0, first, &what, &turned);
    if (status == NS_OK && what == SOME)
        status = powers(m, t, g->now, NS_ORDER, 1, NULL, &what, &turned);
    if (status != NS_OK || what == NOTHING)
        return status;
    const double goes = largest(m, m->next_w);
    if (what == SOME && turned > (g->now < g->longest ? enough : fmax(a_jump, m->o.reltol)) * size)
        g->next = better(g->now, g->least, g->longest, goes, turned);
    if (g->next != g->now)
        return NS_OK;
    *jumped = goes > a_jump * size;
    for (int i = 0; i < m->f->n; i++)
        m->w[i] -= m->next_w[i];
    return NS_OK;
}
