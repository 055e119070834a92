/* src/mlcp/pivoting/reveal.c - a nonsingular basis where the starting mode has none.
 *
 * Gaussian elimination of the scaled W, row i for y_i, column j for lambda_j, in this order:
 *   1. free rows and free columns, complete pivoting.  A free row then left over has only rounding in the
 *      free columns left over: these equations leave a free lambda open (a node that floats).
 *   2. such a row r is joined to such a column c by pairs a, b, ... whose lambda come into the basis:
 *      pivots (r,lambda_a), (y_a,lambda_b), ..., (y_z,c).  Mostly one pair does: its current enters
 *      the node's equation and its voltage depends on the node.  The path is found breadth first.
 *   3. pairs that are inside, by pivots on the diagonal or on a two by two block, as long as they are sound.
 * With each entry goes the largest term it was ever summed from: cancellation to rounding is told from
 * an entry that is small in its own right.
 */
#include "mlcp/mlcp_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double SOUND = 1e-10;             /* of the terms: ten of sixteen digits may be lost */
static const double BARELY = 16 * DBL_EPSILON; /* last resort before calling it singular */

static double *entry(ns_mlcp_solver *s, int i, int j) {
    return s->elim.A + (size_t)i + (size_t)j * (size_t)s->m;
}

static int is_significant(const ns_mlcp_solver *s, int i, int j, double tol) {
    size_t k = (size_t)i + (size_t)j * (size_t)s->m;
    return fabs(s->elim.A[k]) > tol * s->elim.mag[k];
}

static void load_scaled(ns_mlcp_solver *s) {
    int m = s->m;
    ns_linalg_equilibrate(m, s->W, m, s->elim.row_exp, s->elim.col_exp, s->elim.e);
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++) {
            size_t k = (size_t)i + (size_t)j * (size_t)m;
            s->elim.A[k] = ldexp(s->W[k], s->elim.row_exp[i] + s->elim.col_exp[j]);
            s->elim.mag[k] = fabs(s->elim.A[k]);
        }
    memset(s->elim.rowdone, 0, (size_t)m);
    memset(s->elim.coldone, 0, (size_t)m);
    for (int k = 0; k < s->nx; k++)
        s->elim.rowdone[s->fixed[k]] = s->elim.coldone[s->fixed[k]] = 1;
}

/* y_i leaves, lambda_j enters: both are settled. */
static void eliminate(ns_mlcp_solver *s, int i, int j) {
    double pivot = *entry(s, i, j);
    size_t m = (size_t)s->m;
    const double *e = s->elim.A + (size_t)j * m, *emag = s->elim.mag + (size_t)j * m;
    s->elim.rowdone[i] = s->elim.coldone[j] = 1;
    for (int c = 0; c < s->m; c++) {
        double *a = s->elim.A + (size_t)c * m, *mag = s->elim.mag + (size_t)c * m, f = a[i] / pivot;
        if (s->elim.coldone[c] || f == 0.0)
            continue;
        double fmag = mag[i] / fabs(pivot);
        for (int r = 0; r < s->m; r++) {
            if (s->elim.rowdone[r] || e[r] == 0.0)
                continue;
            a[r] -= e[r] * f;
            mag[r] = fmax(mag[r], fmax(emag[r] * fabs(f), fabs(e[r]) * fmag));
            if (fabs(a[r]) <= 4 * DBL_EPSILON * mag[r])
                a[r] = 0.0;
        }
    }
}

/* 1. */
static void eliminate_free(ns_mlcp_solver *s) {
    for (int step = 0; step < s->nf; step++) {
        int bi = -1, bj = -1;
        double best = 0.0;
        for (int b = 0; b < s->nf; b++)
            for (int a = 0; a < s->nf && !s->elim.coldone[s->free[b]]; a++) {
                int i = s->free[a], j = s->free[b];
                if (s->elim.rowdone[i] || fabs(*entry(s, i, j)) <= best || !is_significant(s, i, j, SOUND))
                    continue;
                best = fabs(*entry(s, i, j));
                bi = i;
                bj = j;
            }
        if (bi < 0)
            return;
        eliminate(s, bi, bj);
    }
}

/* Largest entry of row i in the free columns left over; -1 if there is none. */
static int largest_free_column(ns_mlcp_solver *s, int i) {
    int best = -1;
    for (int f = 0; f < s->nf; f++) {
        int j = s->free[f];
        if (!s->elim.coldone[j] && is_significant(s, i, j, SOUND) &&
            (best < 0 || fabs(*entry(s, i, j)) > fabs(*entry(s, i, best))))
            best = j;
    }
    return best;
}

/* Breadth first from row r over pairs that are out.  Returns the last row of the path and its column;
 * s->elim.parent leads back.  -1: no path. */
static int find_path(ns_mlcp_solver *s, int r, int *column) {
    int head = 0, level = 0, tail = 0, found = largest_free_column(s, r);
    s->queue[tail++] = r;
    if (found >= 0) {
        *column = found;
        return r;
    }
    for (int i = 0; i < s->m; i++)
        s->elim.parent[i] = -1;
    while (head < tail) {
        int best = -1;
        double most = 0.0;
        for (level = tail; head < level; head++)
            for (int a = 0; a < s->np; a++) {
                int i = s->queue[head], j = s->pair[a];
                if (s->elim.rowdone[j] || s->elim.coldone[j] || s->elim.parent[j] >= 0 || j == r ||
                    !is_significant(s, i, j, SOUND))
                    continue;
                s->elim.parent[j] = i;
                s->queue[tail++] = j;
                int c = largest_free_column(s, j);
                double v = c < 0 ? 0.0 : fmin(fabs(*entry(s, i, j)), fabs(*entry(s, j, c)));
                if (v > most) {
                    most = v;
                    best = j;
                    *column = c;
                }
            }
        if (best >= 0)
            return best;
    }
    return -1;
}

/* 2.  Pivots along paths until row r is settled; 0 if it cannot be.  *left: the row that is open then. */
static int join_row(ns_mlcp_solver *s, int r, int *left) {
    for (int tries = 0; tries <= s->np; tries++) {
        int col = -1, end = find_path(s, r, &col), n = 0;
        *left = r;
        if (end < 0)
            return 0;
        s->queue[n++] = col; /* the columns to pivot on, last first */
        for (int i = end; i != r; i = s->elim.parent[i])
            s->queue[n++] = i;
        int row = r;
        while (n > 0 && is_significant(s, row, s->queue[n - 1], BARELY)) {
            int j = s->queue[--n];
            eliminate(s, row, j);
            row = j;
        }
        if (n == 0)
            return 1;
        r = row; /* an entry further on has cancelled: look again from here */
    }
    *left = r;
    return 0;
}

/* 3.  The best pivot among pairs a <= b that are inside and not settled: 0 if none is sound. */
static int best_block(ns_mlcp_solver *s, int *ia, int *ib) {
    double best = 0.0;
    for (int b = 0; b < s->np; b++)
        for (int a = 0; a <= b; a++) {
            int i = s->pair[a], j = s->pair[b];
            if (s->mode[i] != NS_INSIDE || s->mode[j] != NS_INSIDE || s->elim.rowdone[i] ||
                s->elim.rowdone[j] || s->elim.coldone[i] || s->elim.coldone[j])
                continue;
            double v =
                a == b ? 2.0 * fabs(*entry(s, i, i)) : fmin(fabs(*entry(s, i, j)), fabs(*entry(s, j, i)));
            if (v <= best || !is_significant(s, i, j, SOUND) || !is_significant(s, j, i, SOUND))
                continue;
            if (a != b &&
                fabs(*entry(s, i, i) * *entry(s, j, j)) > 0.5 * fabs(*entry(s, i, j) * *entry(s, j, i)))
                continue; /* nearly singular as a block, or better done one by one */
            best = v;
            *ia = i;
            *ib = j;
        }
    return best > SOUND;
}

static void eliminate_pairs(ns_mlcp_solver *s) {
    int a = 0, b = 0;
    for (int step = 0; step < s->np && best_block(s, &a, &b); step++) {
        eliminate(s, a, b);
        if (a != b)
            eliminate(s, b, a);
    }
}

int ns_mlcp_reveal(ns_mlcp_solver *s) {
    load_scaled(s);
    s->elim.nstuck = 0;
    eliminate_free(s);
    for (int f = 0; f < s->nf; f++) {
        int row = s->free[f], left = row;
        if (s->elim.rowdone[row] || join_row(s, row, &left))
            continue;
        s->elim.stuck_row[s->elim.nstuck++] = left;
    }
    for (int f = 0, k = 0; f < s->nf; f++)
        if (!s->elim.coldone[s->free[f]])
            s->elim.stuck_col[k++] = s->free[f];
    if (s->elim.nstuck > 0)
        return NS_E_SINGULAR;
    eliminate_pairs(s);
    for (int a = 0; a < s->np; a++) {
        int i = s->pair[a];
        if (s->elim.coldone[i])
            s->mode[i] = NS_INSIDE;
        else if (s->mode[i] == NS_INSIDE)
            s->mode[i] = isinf(s->p->l[i]) ? NS_UPPER : NS_LOWER;
    }
    return NS_OK;
}
