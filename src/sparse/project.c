/* src/sparse/project.c - what is not of finite rate goes at once: charges and fluxes made consistent with
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
#include "linalg/simd.h"
#include "regularise.h"
#include "sparse_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { ROUNDS = 4, SOON = 5, AGAIN = 8 };
/* Shares of the largest charge or flux: what is nothing; what is a jump; what a correction that is the last
 * moves by; and by more than what it says that digits are lost. */
static const double nothing = 64 * DBL_EPSILON, a_jump = 1e-11, fine_enough = 1e-14, lost = 1e-8,
                    rounding = 1e-11, dust = 1e-10;
/* Share of the error allowed that a transient is not worth its steps below. */
static const double lasting = 1e-3;

double ns_sparse_project_size(const ns_sparse *m) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = ns_higher(ns_higher(fabs(m->w[i]), m->largest.w[i]) / m->unit[i], most);
    return most;
}

int ns_sparse_project_is_rounding(const ns_sparse *m, double g, const double *v, double size) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = fmax(most, ns_linalg_csc_size(&m->f->At, i, v) / m->unit[i]);
    return size <= dust * g * most;
}

static double largest(const ns_sparse *m, const double *of) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = ns_higher(fabs(of[i]) / m->unit[i], most);
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
        rest[i] = (double)(m->r[i] - held + (long double)ns_sparse_form_rate(f, g, i) * dot(&f->At, i, x));
    }
    for (int j = 0; j < f->m; j++) {
        const long double law = ns_mode_slides(m->mode[j]) ? dot(&f->gx, f->command[j], x)
                                : m->mode[j] == NS_INSIDE  ? dot(&f->Ct, j, x)
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
static int contradicts(const ns_sparse *m, double g, const ns_cached_factors *k) {
    for (int i = 0; i < m->f->size; i++)
        m->work.v[i] = (double)m->work.exact[i];
    return !(ns_sparse_leaks_left(m->f, g, m->mode, k->scale, m->r, m->work.v, NULL, m->work.residual) <=
             rounding);
}

/* by: D of the last ns_sparse_step_solve(), to the last digit of what is of this size.  *fine: 0 if it was,
 * without.
 */
static int correct(ns_sparse *m, double g, const ns_cached_factors *k, double size, const double *v,
                   double *by, int *fine) {
    const int all = m->f->size;
    double moved = INFINITY;
    int status = NS_OK;
    for (int i = 0; i < all; i++)
        m->work.exact[i] = v[i];
    for (int round = 0; round < ROUNDS && moved > fine_enough * size; round++) {
        residual(m, g, m->work.exact, m->work.residual);
        status = ns_sparse_factors_solve(m->q, k, m->work.residual, m->work.v);
        if (status == NS_E_SINGULAR && contradicts(m, g, k))
            return status;
        if (status == NS_E_SINGULAR) /* only rounding does */
            return NS_OK;
        if (status != NS_OK)
            return status;
        for (int i = 0; i < all; i++)
            m->work.exact[i] += m->work.v[i];
        moved = rates(m, g, m->work.exact, by);
        *fine = *fine && (round > 0 || moved > fine_enough * size);
    }
    return moved <= lost * size || ns_sparse_project_is_rounding(m, g, v, size) ? NS_OK : NS_E_RESIDUAL;
}

/* What is left after another step: NOTHING; nothing but what has no time of its own, which all later ones
 * only turn over (ALL_OF_IT); else SOME. */
typedef enum left { SOME, NOTHING, ALL_OF_IT } left;

static left compare(const ns_sparse *m, double size, const double *before, const double *by) {
    double most = 0;
    if (largest(m, by) <= nothing * size)
        return NOTHING;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = fmax(most, fabs(before[i] + by[i]) / m->unit[i]);
    return most <= nothing * size ? ALL_OF_IT : SOME;
}

/* D^N w, in m->work.w, from the first D^count w that tell.  fine: with corrections, until one moves nothing.
 * first: D w, NULL: not known yet. */
static int powers(ns_sparse *m, double t, double g, int count, int fine, const double *first, left *what) {
    const ns_cached_factors *k;
    const int n = m->f->n;
    double size = ns_sparse_project_size(m), *by = m->work.rates;
    memcpy(m->work.w, m->w, sizeof(double) * (size_t)n);
    int status = ns_sparse_factors_factor(m->q, g, m->mode, 1, &k);
    *what = SOME;
    for (int i = 0; i < count && status == NS_OK && *what == SOME; i++) {
        if (i == 0 && first)
            memcpy(by, first, sizeof(double) * (size_t)n);
        else
            status = ns_sparse_step_solve(m, k, t, g, i, m->work.w, m->z, m->work.projected, by);
        if (status == NS_E_SINGULAR && i > 0 && largest(m, m->work.w) <= a_jump * size) {
            *what = NOTHING; /* rounding contradicts itself */
            return NS_OK;
        }
        size = i == 0 ? fmax(size, largest(m, by)) : size; /* at a start there is nothing yet */
        if (status == NS_OK && fine)
            status = correct(m, g, k, size, m->work.projected, by, &fine);
        if (status == NS_OK)
            *what = compare(m, size, m->work.w, by);
        for (int r = 0; r < n; r++)
            m->work.w[r] = *what == ALL_OF_IT && i % 2 == 0 ? -by[r] : by[r];
    }
    return status;
}

/* m->w loses D^N w, and that again while it leaves much less; gone (n): all that went.  *what: of the first
 * time. */
static int take_away(ns_sparse *m, double t, double g, const double *first, double *gone, left *what) {
    const int n = m->f->n;
    const double size = ns_sparse_project_size(m);
    double before = INFINITY, most = INFINITY;
    memset(gone, 0, sizeof(double) * (size_t)n);
    for (int round = 0; round < AGAIN && most > a_jump * size && 2 * most <= before; round++) {
        left now;
        int status = powers(m, t, g, SOON, 0, round == 0 ? first : NULL, &now);
        if (status == NS_OK && now == SOME)
            status = powers(m, t, g, NS_ORDER, 1, NULL, &now);
        *what = round == 0 ? now : *what;
        if (status != NS_OK || now == NOTHING)
            return status;
        for (int i = 0; i < n; i++) {
            m->w[i] -= m->work.w[i];
            gone[i] += m->work.w[i];
        }
        before = round == 0 ? INFINITY : most;
        most = now == ALL_OF_IT ? 0 : largest(m, m->work.w);
    }
    return NS_OK;
}

/* 1 if some of what steps of length g take for gone, m->work.removed, is still there after steps that are far
 * shorter: it has a time of its own. */
static int lasts(ns_sparse *m, double t, double g) {
    const double little = (a_jump + lasting * m->o.reltol) * ns_sparse_project_size(m);
    const double finer = fmax(ldexp(g, -NS_FINER), ns_sparse_finest(m));
    left what;
    if (take_away(m, t, finer, NULL, m->work.finer_removed, &what) != NS_OK)
        return 0;
    for (int i = 0; i < m->f->n; i++)
        m->work.finer_removed[i] -= m->work.removed[i];
    return largest(m, m->work.finer_removed) > little;
}

int ns_sparse_project_consistent(ns_sparse *m, double t, double g, const double *first, ns_jump_kind *jump) {
    const size_t bytes = sizeof(double) * (size_t)m->f->n;
    const double size = ns_sparse_project_size(m);
    left what = NOTHING;
    *jump = NS_NO_JUMP;
    memcpy(m->work.before_w, m->w, bytes);
    const int status = take_away(m, t, g, first, m->work.removed, &what);
    if (status != NS_OK || what == NOTHING || !(largest(m, m->work.removed) > a_jump * size))
        return status;
    *jump = NS_JUMPS;
    if (what != SOME || g <= ns_sparse_finest(m))
        return NS_OK;
    memcpy(m->work.right_w, m->w, bytes);
    memcpy(m->w, m->work.before_w, bytes);
    if (lasts(m, t, g))
        *jump = NS_LASTS;
    memcpy(m->w, *jump == NS_LASTS ? m->work.before_w : m->work.right_w, bytes);
    return NS_OK;
}
