/* src/sparse/project.c - charges and fluxes made consistent with a mode: those that the algebraic equations
 * contradict jump.
 *
 * With D of (E2), for a short step g, D^N w vanishes for all that lasts longer than some g, and is w for what
 * has no finite rate: a shorted capacitor, an interrupted inductor.  So
 *
 *     w+ = w - D^N w,   N = 8
 *
 * An interrupted inductor drives a floating part to very large voltages, of which resistors take differences.
 * So unknowns are kept, and residuals of (P2) are formed, in long double.  The last correction is the error
 * left.
 */
#include "guards.h"
#include "largest.h"
#include "linalg/simd.h"
#include "regularise.h"
#include "step.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Corrections of a solution; powers of D that decide whether more are needed; repetitions. */
enum { CORRECTIONS = 4, FIRST_POWERS = 5, REPETITIONS = 8 };
/* Fractions of the largest charge or flux: D^N w below `zero` is rounding; above `a_jump` w jumps; a
 * correction below `corrected` is the last; above `lost` digits are lost. */
static const double zero = 64 * DBL_EPSILON, a_jump = 1e-11, corrected = 1e-14, lost = 1e-8;
/* A residual below this fraction of its terms is rounding; w below this fraction of its rates in a step, too.
 */
static const double residual_rounding = 1e-11, rate_rounding = 1e-10;
/* Where the matrix of the finer steps is singular to rounding, steps much_longer times as long are tried in
 * their place, and so on, up to 2^-SHORTER of the length that they are compared with. */
static const double much_longer = 16;
enum { SHORTER = 3 };
/* A transient below this fraction of the error allowed is not resolved. */
static const double lasting = 1e-3;
/* A step of length g takes this fraction of what lasts g/2. */
static const double taken = 2.0 / 3;

int ns_sparse_project_is_rounding(const ns_sparse *m, double g, const double *v, double size) {
    double max = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            max = fmax(max, ns_linalg_csc_size(&m->f->At, i, v) / m->unit[i]);
    return size <= rate_rounding * g * max;
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

/* by = g (A x + B lambda + f); the largest change of it, in units. */
static double update_rates(const ns_sparse *m, double g, const long double *x, double *by) {
    const ns_form *f = m->f;
    double max = 0;
    for (int i = 0; i < f->n; i++) {
        const double old = by[i];
        by[i] = f->algebraic[i] ? 0 : (double)(g * (dot(&f->At, i, x) + m->rate[i]));
        if (!f->algebraic[i])
            max = fmax(max, fabs(by[i] - old) / m->unit[i]);
    }
    return max;
}

/* 1 if the solution so far leaves more of (P2) than rounding. */
static int contradicts(const ns_sparse *m, double g, const ns_cached_factors *k) {
    for (int i = 0; i < m->f->size; i++)
        m->work.v[i] = (double)m->work.exact[i];
    return !(ns_sparse_leaks_left(m->f, g, m->mode, k->scale, m->r, m->work.v, NULL, m->work.residual) <=
             residual_rounding);
}

/* by: D w of the last ns_sparse_step_solve(), corrected to the last digit of what is of this size.  *needed:
 * 0 if no correction changed it. */
static int correct(ns_sparse *m, double g, const ns_cached_factors *k, double size, const double *v,
                   double *by, int *needed) {
    const int all = m->f->size;
    double moved = INFINITY;
    int status = NS_OK;
    for (int i = 0; i < all; i++)
        m->work.exact[i] = v[i];
    for (int round = 0; round < CORRECTIONS && moved > corrected * size; round++) {
        residual(m, g, m->work.exact, m->work.residual);
        status = ns_sparse_factors_correct(m->q, k, m->work.residual, m->work.v);
        if (status == NS_E_SINGULAR && contradicts(m, g, k))
            return status;
        if (status == NS_E_SINGULAR) /* only rounding contradicts */
            return NS_OK;
        if (status != NS_OK)
            return status;
        for (int i = 0; i < all; i++)
            m->work.exact[i] += m->work.v[i];
        moved = update_rates(m, g, m->work.exact, by);
        *needed = *needed && (round > 0 || moved > corrected * size);
    }
    return moved <= fmax(lost * size, ns_sparse_largest_rounding(m)) ||
                   ns_sparse_project_is_rounding(m, g, v, size)
               ? NS_OK
               : NS_E_RESIDUAL;
}

/* What is left after another step: nothing; ALL: only what has no finite rate, each later step reverses its
 * sign and no more; else SOME. */
typedef enum left { SOME, NOTHING, ALL } left;

static left compare(const ns_sparse *m, double size, const double *before, const double *by) {
    double max = 0;
    if (ns_sparse_largest_of(m, by) <= zero * size)
        return NOTHING;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            max = fmax(max, fabs(before[i] + by[i]) / m->unit[i]);
    return max <= zero * size ? ALL : SOME;
}

/* D^N w to m->work.w, from the first powers that decide it, at max count.  fine: solutions are corrected,
 * until one needs none.  first: D w, NULL: not known yet. */
static int find_powers(ns_sparse *m, double t, double g, int count, int fine, const double *first,
                       left *what) {
    const ns_cached_factors *k;
    const int n = m->f->n;
    double size = ns_sparse_largest_size(m), *by = m->work.rates;
    memcpy(m->work.w, m->w, sizeof(double) * (size_t)n);
    int status = ns_sparse_factors_factor(m->q, g, m->mode, 1, &k);
    *what = SOME;
    for (int i = 0; i < count && status == NS_OK && *what == SOME; i++) {
        if (i == 0 && first)
            memcpy(by, first, sizeof(double) * (size_t)n);
        else
            status = ns_sparse_step_solve(m, k, t, g, i, m->work.w, m->z, m->work.projected, by);
        if (status == NS_E_SINGULAR && i > 0 && ns_sparse_largest_of(m, m->work.w) <= a_jump * size) {
            *what = NOTHING; /* what is left is rounding, and contradicts the equations */
            return NS_OK;
        }
        size = i == 0 ? fmax(size, ns_sparse_largest_of(m, by)) : size; /* at a start w may be zero */
        if (status == NS_OK && fine)
            status = correct(m, g, k, size, m->work.projected, by, &fine);
        if (status == NS_OK)
            *what = compare(m, size, m->work.w, by);
        for (int r = 0; r < n; r++)
            m->work.w[r] = *what == ALL && i % 2 == 0 ? -by[r] : by[r];
    }
    return status;
}

/* Subtracts D^N w from m->w, repeatedly while that gets much less; removed (n): all that was subtracted.
 * *what: of the first time. */
static int remove_powers(ns_sparse *m, double t, double g, const double *first, double *removed, left *what) {
    const int n = m->f->n;
    const double size = ns_sparse_largest_size(m);
    double before = INFINITY, max = INFINITY;
    memset(removed, 0, sizeof(double) * (size_t)n);
    for (int round = 0; round < REPETITIONS && max > a_jump * size && 2 * max <= before; round++) {
        left now;
        int status = find_powers(m, t, g, FIRST_POWERS, 0, round == 0 ? first : NULL, &now);
        if (status == NS_OK && now == SOME)
            status = find_powers(m, t, g, NS_ORDER, 1, NULL, &now);
        *what = round == 0 ? now : *what;
        if (status != NS_OK || now == NOTHING)
            return status;
        for (int i = 0; i < n; i++) {
            m->w[i] -= m->work.w[i];
            removed[i] += m->work.w[i];
        }
        before = round == 0 ? INFINITY : max;
        max = now == ALL ? 0 : ns_sparse_largest_of(m, m->work.w);
    }
    return NS_OK;
}

/* 1 if some of what steps of length g removed, m->work.removed, is not removed by far shorter steps: it has a
 * finite rate. */
static int lasts(ns_sparse *m, double t, double g) {
    const double little = (a_jump + lasting * m->o.reltol) * ns_sparse_largest_size(m);
    double finer = fmax(ldexp(g, -NS_FINER), ns_sparse_finest(m));
    left what;
    int status;
    do {
        status = remove_powers(m, t, finer, NULL, m->work.finer_removed, &what);
        finer *= much_longer;
    } while (status == NS_E_SINGULAR && finer <= ldexp(g, -SHORTER));
    if (status != NS_OK)
        return 0;
    for (int i = 0; i < m->f->n; i++)
        m->work.finer_removed[i] -= m->work.removed[i];
    return ns_sparse_largest_of(m, m->work.finer_removed) > little;
}

int ns_sparse_project_breaks(ns_sparse *m, double t, double g, const double *w) {
    return ns_sparse_step_euler(m, t, g, w, 1, m->work.projected, NULL) == NS_OK &&
           ns_sparse_guard_broken(m, m->work.projected, w, g, 1) > 0;
}

/* 1 if the mode does not hold where what jumps in no time has jumped, and what steps of the length g take to
 * its end has not: a switch without resistance makes a node jump that an R brings back, and diodes follow the
 * jump.  From there the shortest steps are as short as they get. */
static int breaks_on_the_way(ns_sparse *m, double t, double g) {
    const double finest = ldexp(m->o.h, -NS_FINEST - NS_MOST_FINER);
    left what;
    if (!(finest < g) || remove_powers(m, t, finest, NULL, m->work.finer_removed, &what) != NS_OK)
        return 0;
    if (!ns_sparse_project_breaks(m, t, finest, m->w))
        return 0;
    ns_sparse_be_finest(m, t);
    return 1;
}

/* 1 if one more step of the finest length takes less of what was removed than it takes of what jumps: it has
 * a finite rate, and shorter steps resolve it. */
static int decays(ns_sparse *m, double g) {
    const ns_cached_factors *k;
    double *const v = m->work.v, *const by = m->work.w;
    if (ns_sparse_factors_factor(m->q, g, m->mode, 1, &k) != NS_OK)
        return 0;
    ns_sparse_step_rhs(m, g, m->work.removed, m->work.no_inputs, 0, 0);
    if (ns_sparse_factors_solve(m->q, k, m->r, v) != NS_OK)
        return 0;
    for (int i = 0; i < m->f->n; i++)
        by[i] = m->f->algebraic[i] ? 0 : m->work.removed[i] - ns_linalg_csc_dot(&m->f->Mt, i, v);
    return ns_sparse_largest_of(m, by) <= taken * ns_sparse_largest_of(m, m->work.removed);
}

int ns_sparse_project_consistent(ns_sparse *m, double t, double g, const double *first, ns_jump_kind *jump) {
    const size_t bytes = sizeof(double) * (size_t)m->f->n;
    const double size = ns_sparse_largest_size(m);
    left what = NOTHING;
    *jump = NS_NO_JUMP;
    memcpy(m->work.before_w, m->w, bytes);
    const int status = remove_powers(m, t, g, first, m->work.removed, &what);
    if (status != NS_OK || what == NOTHING || !(ns_sparse_largest_of(m, m->work.removed) > a_jump * size)) {
        if (what == SOME) /* rounding, of which a finite rate would make a transient */
            memcpy(m->w, m->work.before_w, bytes);
        return status;
    }
    *jump = NS_JUMPS;
    if (what != SOME)
        return NS_OK;
    memcpy(m->work.right_w, m->w, bytes);
    memcpy(m->w, m->work.before_w, bytes);
    if (g > ns_sparse_finest(m) ? lasts(m, t, g) : decays(m, g))
        *jump = NS_LASTS;
    memcpy(m->w, m->work.before_w, bytes);
    if (*jump == NS_JUMPS && breaks_on_the_way(m, t, g))
        *jump = NS_LASTS;
    memcpy(m->w, *jump == NS_LASTS ? m->work.before_w : m->work.right_w, bytes);
    return NS_OK;
}
