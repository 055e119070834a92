/* src/theta/refine.c - solutions of (P2) made as good as their digits allow. */
#include "regularise.h"

#include "linalg/residual.h"

#include <math.h>
#include <string.h>

/* With pivots that differ by less the factors have nearly all digits; or if the first refinement moves less.
 * What the last one moves where the next would move rounding. */
static const double pivots_alike = 1e-2, no_digits_lost = 1e-12, moved_enough = 1e-12;

int ns_theta_refine_nonzeros(int count, const double *from, int step, int *list) {
    int found = 0;
    for (int i = 0; i < count; i++)
        if (from[(size_t)i * (size_t)step] != 0)
            list[found++] = i;
    return found;
}

void ns_theta_refine_residual(ns_theta *s, int size, int exactly, double *residual) {
    for (int i = 0; i < size; i++) {
        const double *row = s->K + i;
        const int count = ns_theta_refine_nonzeros(size, row, size, s->list);
        for (int k = 0; k < s->q; k++) {
            const double *x = s->X + (size_t)k * (size_t)size;
            double *r = residual + (size_t)i + (size_t)k * (size_t)size;
            if (exactly) {
                *r = ns_linalg_residual(*r, count, s->list, row, (size_t)size, x);
                continue;
            }
            long double sum = *r;
            for (int j = 0; j < count; j++)
                sum -= (long double)row[(size_t)s->list[j] * (size_t)size] * x[s->list[j]];
            *r = (double)sum;
        }
    }
}

/* move (size*q) = -(rhs - K X), in doubles. */
static void negative_residual(const ns_theta *s, int size, double *move) {
    for (size_t i = 0; i < (size_t)size * (size_t)s->q; i++)
        move[i] = -s->R[i];
    for (int k = 0; k < s->q; k++)
        ns_linalg_matvec_add(size, size, s->K, s->X + (size_t)k * (size_t)size,
                             move + (size_t)k * (size_t)size);
}

/* What a step of refinement moved, relative to X: the most of all columns. */
static double relative_move(const ns_theta *s, int size) {
    const double *move = s->R + (size_t)size * (size_t)s->q;
    double most = 0;
    for (int k = 0; k < s->q; k++) {
        const double of = ns_linalg_lu_largest(s->lu, s->X + (size_t)k * (size_t)size);
        const double by = ns_linalg_lu_largest(s->lu, move + (size_t)k * (size_t)size);
        if (!(by <= most * of))
            most = by / of;
    }
    return most;
}

static void refine_once(ns_theta *s, int size, int exactly) {
    const size_t count = (size_t)size * (size_t)s->q;
    double *move = s->R + count;
    if (exactly) {
        memcpy(move, s->R, sizeof *move * count);
        ns_theta_refine_residual(s, size, 1, move);
    } else {
        negative_residual(s, size, move);
    }
    ns_linalg_lu_solve(s->lu, s->q, move);
    for (size_t i = 0; i < count; i++)
        s->X[i] += exactly ? move[i] : -move[i];
}

double ns_theta_refine_exactly(ns_theta *s, int size) {
    enum { MOST_ROUNDS = 10 };
    double before = INFINITY, moved = INFINITY;
    for (int round = 0; round < MOST_ROUNDS; round++) {
        refine_once(s, size, 1);
        before = moved;
        moved = relative_move(s, size);
        if (moved <= moved_enough || !(moved < before / 2))
            break;
    }
    return moved;
}

double ns_theta_refine(ns_theta *s, int size, int *exactly) {
    refine_once(s, size, 0);
    *exactly = ns_linalg_lu_pivots(s->lu) < pivots_alike && !(relative_move(s, size) <= no_digits_lost);
    if (*exactly)
        return ns_theta_refine_exactly(s, size);
    refine_once(s, size, 0);
    return relative_move(s, size);
}
