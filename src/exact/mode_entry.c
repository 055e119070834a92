/* src/exact/mode_entry.c - what jumps where a mode is entered: charges and fluxes that its constraints do not
 * allow.
 */
#include "mode_selection.h"

#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* What a charge or flux may move by without being called a jump, of the largest it ever was. */
static const double still = 1e-12;
/* D^8 beside D, of what is slow: far less. */
static const double slow = 1e-6;
/* An impulse of the wrong sign beside the largest. */
static const double impulse_tol = 1e-9;
/* One that adds less than this over the stage is none. */
static const double matters = 1e-6;

/* D^8 of f->next from f->series, as the last of eight implicit steps has it: by the impulses of that step,
 * each where its element is, so that charges and fluxes go from one place to another and nowhere else. */
static void impulses_of(ns_exact *f, const ns_mode_kernel *k, double *by) {
    const ns_theta *s = f->s;
    const int n = s->s->n, m = s->s->m, r = k->r;
    ns_linalg_matvec(n + m, r, k->xi, f->series + (NS_ORDER - 2) * r,
                     f->to.x); /* and lambda; inputs do not jump */
    for (int i = 0; i < r; i++) {
        double sum = 0;
        for (int j = 0; j < n; j++)
            sum += s->A[i + j * n] * f->to.x[j];
        for (int j = 0; j < m; j++)
            sum += s->B[i + j * n] * f->to.lambda[j];
        by[i] = k->g * sum;
    }
}

/* What is next to nothing: of all that there ever was, and of what a step brings (at the start from rest
 * there was nothing).  A row of M may be what charges differ by, which was never more than rounding. */
static double nothing(const ns_exact *f, const ns_mode_kernel *k) {
    double most = 0;
    for (int i = 0; i < k->r; i++) {
        const double *row = k->series + i;
        double step = 0;
        for (int j = 0; j < k->q; j++)
            step += row[j * NS_ORDER * k->r] * f->next[j];
        most = ns_higher(most, ns_higher(f->most[i], fabs(step)) / f->s->unit[i]);
    }
    return still * most;
}

/* 1 if D^8 moves any of f->next by more than rounding. */
static int moves_any(const ns_exact *f, const ns_mode_kernel *k) {
    double least = -1;
    ns_linalg_matvec(k->r, k->q, k->last, f->next, f->gone);
    for (int i = 0; i < k->r; i++) {
        if (!(fabs(f->gone[i]) > still * f->most[i]))
            continue;
        least = least < 0 ? nothing(f, k) : least;
        if (fabs(f->gone[i]) / f->s->unit[i] > least)
            return 1;
    }
    return 0;
}

/* f->next = X after the jump that the mode asks for: what its constraints leave, 1 - D^8, and that again
 * while it leaves anything of what is fast, not instantaneous.  A steep input moves by D^8 what is slow too:
 * only D^8 of that, as inputs stay, is against the constraints.  f->gone (r): the sum of what went.  1 if it
 * is one. */
static int jump(ns_exact *f, const ns_mode_kernel *k) {
    enum { AGAIN = 8 };
    const int r = k->r;
    int moves = 0, more = 1;
    memcpy(f->next, f->X, sizeof(double) * (size_t)k->q);
    if (!moves_any(f, k)) {
        ns_linalg_matvec(r, r, k->last, f->gone, f->series);
        for (int i = 0; i < r; i++)
            f->next[i] -= f->series[i];
        return 0;
    }
    memset(f->gone, 0, sizeof(double) * (size_t)r);
    for (int round = 0; round < AGAIN && more; round++) {
        double *by = f->series + (NS_ORDER - 1) * r;
        ns_linalg_matvec(NS_ORDER * r, k->q, k->series, f->next, f->series);
        memcpy(f->ahead, by, sizeof *by * (size_t)r);
        ns_linalg_matvec(NS_ORDER * r, r, k->series, f->ahead, f->series);
        more = 0;
        for (int i = 0; i < r; i++)
            more |= fabs(by[i]) > still * f->most[i] && fabs(by[i]) > slow * fabs(f->series[i]);
        if (more)
            impulses_of(f, k, by);
        for (int i = 0; i < r; i++) {
            f->next[i] -= by[i];
            f->gone[i] += by[i];
        }
        moves |= more;
    }
    return moves;
}

int ns_exact_enter(ns_exact *f, const ns_exact_mode *k) {
    if (k->instant)
        return jump(f, k->level[0].stage);
    memcpy(f->next, f->X, sizeof(double) * (size_t)k->level[0].stage->q);
    return 0;
}

void ns_exact_enter_consistent(ns_exact *f) {
    double *X = f->X, until;
    if (!f->at->instant)
        return;
    (void)jump(f, ns_exact_mode_time_scale(f, &until)->stage);
    f->X = f->next;
    f->next = X;
}

/* The impulse of guard g over the stage: what it makes of the part that jumps. */
static double impulse_of(const ns_exact *f, const ns_mode_kernel *k, int g) {
    double sum = 0;
    for (int i = 0; i < k->r; i++)
        sum += k->coef[(size_t)g + (size_t)i * (size_t)(NS_ORDER * k->rows)] * f->gone[i];
    return sum;
}

int ns_exact_enter_fits(ns_exact *f, const ns_mode_kernel *k) {
    double most = 0;
    for (int g = 0; g < k->pair_rows; g++) {
        f->rate[g] = impulse_of(f, k, g);
        most = ns_higher(most, fabs(f->rate[g]));
    }
    for (int g = 0; g < k->pair_rows; g++)
        if (f->rate[g] < -impulse_tol * most &&
            f->rate[g] < -(impulse_tol * most + matters * fabs(ns_exact_guard_of(k, k->value, g, f->next)) +
                           ns_exact_guard_rounding(f, k, g)))
            return 0;
    return 1;
}

int ns_exact_enter_worst(const ns_exact *f, const ns_mode_kernel *k) {
    int worst = 0;
    for (int g = 1; g < k->pair_rows; g++)
        if (f->rate[g] < f->rate[worst])
            worst = g;
    return worst;
}
