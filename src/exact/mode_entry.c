/* src/exact/mode_entry.c - what jumps where a mode is entered: charges and fluxes that its constraints do not
 * allow.
 */
#include "mode_selection.h"

#include "guards.h"
#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* A charge or flux that moves by less, relative to the largest it ever was, does not jump. */
static const double min_jump = 1e-12;
/* Where w is slow, |D^8 w| is far below this part of |D w|. */
static const double slow_ratio = 1e-6;
/* A voltage so many times as large as what a resistance drops may be the sum of several of these. */
static const double drops = 16;
/* Rounding of an impulse relative to the largest. */
static const double impulse_tol = 1e-9;
/* An impulse that adds less than this part to its guard over the Euler step counts as zero. */
static const double min_impulse = 1e-6;

/* D^8 X_next from work.jump_powers, as the last of eight implicit steps has it: by the impulses of that
 * step, each in its own element, so that the sum of charges and fluxes stays. */
static void apply_impulses(ns_exact *f, const ns_mode_kernel *k, double *by) {
    const ns_theta *s = f->s;
    const int n = s->s->n, m = s->s->m, r = k->r;
    ns_linalg_matvec(n + m, r, k->step_x_lambda, f->work.jump_powers + (NS_ORDER - 2) * r,
                     f->work.jump_x_lambda); /* inputs do not jump */
    for (int i = 0; i < r; i++) {
        double sum = 0;
        for (int j = 0; j < n; j++)
            sum += s->A[i + j * n] * f->work.jump_x_lambda[j];
        for (int j = 0; j < m; j++)
            sum += s->B[i + j * n] * f->work.jump_x_lambda[n + j];
        by[i] = k->g * sum;
    }
}

/* The smallest jump: relative to the largest charges so far and to what a step adds (at a start from zero
 * there are none yet).  The largest of all rows, because the charge of one row may be only rounding. */
static double smallest_jump(const ns_exact *f, const ns_mode_kernel *k) {
    double most = 0;
    for (int i = 0; i < k->r; i++) {
        const double *row = k->laguerre_powers + i;
        double step = 0;
        for (int j = 0; j < k->q; j++)
            step += row[j * NS_ORDER * k->r] * f->X_next[j];
        most = ns_higher(most, ns_higher(f->max_abs[i], fabs(step)) / f->s->unit[i]);
    }
    return min_jump * most;
}

/* 1 if D^8 takes anything away from X_next, beyond rounding. */
static int moves_any(const ns_exact *f, const ns_mode_kernel *k) {
    double least = -1;
    ns_linalg_matvec(k->r, k->q, k->D8, f->X_next, f->work.gone);
    for (int i = 0; i < k->r; i++) {
        if (!(fabs(f->work.gone[i]) > min_jump * f->max_abs[i]))
            continue;
        least = least < 0 ? smallest_jump(f, k) : least;
        if (fabs(f->work.gone[i]) / f->s->unit[i] > least)
            return 1;
    }
    return 0;
}

/* X_next = X after the jump that the mode requires: (1 - D^8) X, repeated while D^8 still finds a fast part
 * that is not instantaneous.  A steep input makes D^8 X of what is slow too: only D^8 of that, inputs being
 * constant, violates the constraints.  work.gone (r): all that was taken away.  1: it is a jump. */
static int take_jump(ns_exact *f, const ns_mode_kernel *k) {
    enum { MAX_ROUNDS = 8 };
    const int r = k->r;
    int moves = 0, more = 1;
    memcpy(f->X_next, f->X, sizeof(double) * (size_t)k->q);
    if (!moves_any(f, k)) {
        ns_linalg_matvec(r, r, k->D8, f->work.gone, f->work.jump_powers);
        for (int i = 0; i < r; i++)
            f->X_next[i] -= f->work.jump_powers[i];
        return 0;
    }
    memset(f->work.gone, 0, sizeof(double) * (size_t)r);
    for (int round = 0; round < MAX_ROUNDS && more; round++) {
        double *by = f->work.jump_powers + (NS_ORDER - 1) * r; /* D^8 */
        ns_linalg_matvec(NS_ORDER * r, k->q, k->laguerre_powers, f->X_next, f->work.jump_powers);
        memcpy(f->work.by, by, sizeof *by * (size_t)r);
        ns_linalg_matvec(NS_ORDER * r, r, k->laguerre_powers, f->work.by, f->work.jump_powers);
        more = 0;
        for (int i = 0; i < r; i++)
            more |= fabs(by[i]) > min_jump * f->max_abs[i] &&
                    fabs(by[i]) > slow_ratio * fabs(f->work.jump_powers[i]);
        if (more)
            apply_impulses(f, k, by);
        for (int i = 0; i < r; i++) {
            f->X_next[i] -= by[i];
            f->work.gone[i] += by[i];
        }
        moves |= more;
    }
    return moves;
}

void ns_exact_enter_less(ns_exact *f, const ns_mode_kernel *k, double *change) {
    const double *by = f->work.jump_powers + (NS_ORDER - 1) * k->r; /* D^8 */
    ns_linalg_matvec(NS_ORDER * k->r, k->q, k->laguerre_powers, change, f->work.jump_powers);
    for (int i = 0; i < k->r; i++)
        change[i] -= by[i];
}

int ns_exact_enter(ns_exact *f, const ns_exact_mode *k) {
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    f->entered = k->has_instant && take_jump(f, kernel) ? kernel : NULL;
    if (!k->has_instant)
        memcpy(f->X_next, f->X, sizeof(double) * (size_t)kernel->q);
    return f->entered != NULL;
}

/* left (r) += D left: what an Euler step leaves of it; the largest of it, in units. */
static double step_on(const ns_exact *f, const ns_mode_kernel *k, double *left, double *change) {
    double most = 0;
    ns_linalg_matvec(NS_ORDER * k->r, k->r, k->laguerre_powers, left, change);
    for (int i = 0; i < k->r; i++) {
        left[i] += change[i];
        most = ns_higher(most, fabs(left[i]) / f->s->unit[i]);
    }
    return most;
}

/* Euler steps of length g that take work.gone away: their x and lambda, times g.  One is enough for what has
 * no finite rate. */
void ns_exact_enter_count(ns_exact *f) {
    enum { MAX_STEPS = 8 };
    const ns_mode_kernel *k = f->entered;
    ns_instant *to = f->point->instant;
    const int all = f->system->n + f->system->m;
    double *left = f->work.by, most = INFINITY, least = 0;
    memcpy(left, f->work.gone, sizeof *left * (size_t)k->r);
    for (int i = 0; i < k->r; i++)
        least = ns_higher(least, DBL_EPSILON * fabs(left[i]) / f->s->unit[i]);
    for (int step = 0; step < MAX_STEPS && most > least; step++) {
        ns_linalg_matvec(all, k->r, k->step_x_lambda, left, f->work.jump_x_lambda);
        ns_instant_add(to, 0, all, k->g, f->work.jump_x_lambda);
        most = step_on(f, k, left, f->work.jump_powers);
    }
}

void ns_exact_enter_consistent(ns_exact *f) {
    double until;
    if (!f->state.mode->has_instant)
        return;
    (void)take_jump(f, ns_exact_mode_time_scale(f, &until)->kernel);
    ns_exact_take_next(f);
}

void ns_exact_enter_remove_drift(ns_exact *f) {
    double until;
    if (f->state.mode->has_instant && !take_jump(f, ns_exact_mode_time_scale(f, &until)->kernel))
        ns_exact_take_next(f);
}

/* What the resistances of pairs drop at most, as what jumps flows through them in the Euler step. */
static double largest_drop(const ns_exact *f, const ns_mode_kernel *k) {
    const size_t n = (size_t)f->system->n, m = (size_t)f->system->m;
    double most = 0;
    for (size_t j = 0; j < m; j++) {
        const double ohm = f->ohm[j];
        double lambda = 0;
        for (size_t i = 0; i < (size_t)k->r && ohm != 0; i++)
            lambda += k->step_x_lambda[n + j + i * (n + m)] * f->work.gone[i];
        most = ns_higher(most, fabs(ohm * lambda));
    }
    return most;
}

/* 1 if guard g is that of a pair that blocks, and its impulse is no more than such a drop: so it is none of
 * y, which would be more than anything else. */
static int blocks(const ns_exact *f, const ns_mode_kernel *k, int g) {
    return k->row[g].to == NS_INSIDE && f->work.impulse[g] >= -drops * largest_drop(f, k);
}

/* 1 if guard g is that of the pair whose guard broke just now, and its impulse is no more than the guard adds
 * in the time that counts as an instant: the pair was at its corner, from where a leak takes up its current,
 * or a resistance its drop. */
static int leaves_corner(const ns_exact *f, const ns_mode_kernel *k, int g) {
    const double instant = ldexp(f->h, -NS_EVENT_EXPONENT);
    return f->event_pair == k->row[g].pair &&
           -f->work.impulse[g] * k->g <= ns_exact_guard_of(k, k->value, g, f->X_next) * instant;
}

/* What the impulse of guard g may be off by.  The rate is that after the jump: before it, in a kernel of
 * 1e-17 s, the rounding of the time alone would allow any impulse. */
static double impulse_rounding(const ns_exact *f, const ns_mode_kernel *k, int g) {
    const double rate = ns_exact_guard_of(k, k->rate, g, f->X_next);
    return ns_exact_guard_rounding_at(f, k, g, f->X_next, 0) +
           ns_exact_guard_time_rounding(f, k, g, f->X_next, rate) * fabs(rate);
}

/* The largest impulse of the guards of pairs that block (V s), or of those that conduct (A s), as g is one:
 * beside roff of 1e15 ohm a flux of 1 V s drives 1e-15 A s, which is no rounding of it. */
static double largest_alike(const ns_exact *f, const ns_mode_kernel *k, int g) {
    double most = 0;
    for (int i = 0; i < k->pair_rows; i++)
        if ((k->row[i].to == NS_INSIDE) == (k->row[g].to == NS_INSIDE))
            most = ns_higher(most, fabs(f->work.impulse[i]));
    return most;
}

/* An impulse of guard g below this is none. */
static double least_impulse(const ns_exact *f, const ns_mode_kernel *k, int g) {
    return impulse_tol * largest_alike(f, k, g) +
           min_impulse * fabs(ns_exact_guard_of(k, k->value, g, f->X_next)) + impulse_rounding(f, k, g);
}

/* 1 if the impulse of guard g, of the wrong sign, is none: it is outweighed by what flows besides in the same
 * Euler step, and its pair was at its corner, or blocks beside resistances that drop as much. */
static int is_no_impulse(const ns_exact *f, const ns_mode_kernel *k, int g) {
    return ns_exact_guard_term(k, g, 0, k->q, f->X) >= 0 && (leaves_corner(f, k, g) || blocks(f, k, g));
}

int ns_exact_enter_fits(ns_exact *f, const ns_mode_kernel *k) {
    int fits = 1;
    for (int g = 0; g < k->pair_rows; g++)
        f->work.impulse[g] = ns_exact_guard_term(k, g, 0, k->r, f->work.gone);
    for (int g = 0; g < k->pair_rows && fits; g++)
        if (f->work.impulse[g] < 0 && f->work.impulse[g] < -least_impulse(f, k, g))
            fits = is_no_impulse(f, k, g);
    return fits;
}

int ns_exact_enter_carries(const ns_exact *f, const ns_mode_kernel *k, int g) {
    return f->work.impulse[g] > impulse_tol * largest_alike(f, k, g) + impulse_rounding(f, k, g);
}

int ns_exact_enter_worst(const ns_exact *f, const ns_mode_kernel *k) {
    int worst = 0;
    for (int g = 1; g < k->pair_rows; g++)
        if (f->work.impulse[g] < f->work.impulse[worst])
            worst = g;
    return worst;
}
