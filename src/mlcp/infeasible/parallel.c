/* src/mlcp/infeasible/parallel.c - the proof by two rows that are one: y_i = a + q_i and y_k = r a + q_k
 * contradict.
 *
 * Phase 1 works on the whole problem; where its entries span fifty decades, rounding elsewhere may hide from
 * it what two rows say by themselves (unequal sources in parallel).
 */
#include <math.h>

#include "mlcp/mlcp_internal.h"

static const double CANCEL = 1e-14; /* of an entry: rows are the same (certificate.c lets sums cancel so) */

/* Rows that are multiples of row first, and what they ask of its sum of lambda, a: lo <= a <= hi. */
typedef struct family {
    int first, column; /* its first column that is not 0 */
    int below, above;  /* the rows that lo and hi are of; -1: none */
    double lo, hi;
} family;

static double entry(const ns_mlcp_solver *s, int i, int j) {
    return s->p->W[(size_t)i + (size_t)j * (size_t)s->m];
}

static int first_column(const ns_mlcp_solver *s, int i) {
    int j = 0;
    while (j < s->m && entry(s, i, j) == 0.0)
        j++;
    return j;
}

static double ratio(const ns_mlcp_solver *s, const family *f, int i) {
    return entry(s, i, f->column) / entry(s, f->first, f->column);
}

static int is_multiple(const ns_mlcp_solver *s, const family *f, int i) {
    const double r = ratio(s, f, i);
    if (!isnormal(r))
        return 0;
    for (int j = f->column; j < s->m; j++)
        if (!(fabs(entry(s, i, j) - r * entry(s, f->first, j)) <= CANCEL * fabs(entry(s, i, j))))
            return 0;
    return 1;
}

/* y = r a + q of row i has the sign that its bounds ask for: a >= -q/r, a <= -q/r or both. */
static void narrow_range(const ns_mlcp_solver *s, family *f, int i) {
    const int lower = isfinite(s->p->l[i]), upper = isfinite(s->p->u[i]);
    const double r = ratio(s, f, i), at = -s->p->q[i] / r, sign = lower - upper;
    if ((lower && upper) || !isfinite(at)) /* any sign */
        return;
    if (sign * r >= 0.0 && at > f->lo) {
        f->lo = at;
        f->below = i;
    }
    if (sign * r <= 0.0 && at < f->hi) {
        f->hi = at;
        f->above = i;
    }
}

/* s->queue: first columns; s->elim.rowdone: rows seen in a family. */
static family gather_family(const ns_mlcp_solver *s, int first) {
    family f = {first, s->queue[first], -1, -1, -INFINITY, INFINITY};
    for (int i = first; f.column < s->m && i < s->m; i++)
        if (s->queue[i] == f.column && is_multiple(s, &f, i)) {
            s->elim.rowdone[i] = 1;
            narrow_range(s, &f, i);
        }
    return f;
}

int ns_mlcp_parallel(ns_mlcp_solver *s, double *v) {
    for (int i = 0; i < s->m; i++) {
        s->queue[i] = first_column(s, i);
        s->elim.rowdone[i] = 0;
        v[i] = 0.0;
        s->elim.row_exp[i] = s->elim.col_exp[i] = 0;
    }
    for (int first = 0; first < s->m; first++) {
        if (s->elim.rowdone[first])
            continue;
        const family f = gather_family(s, first);
        if (f.below < 0 || f.above < 0 || !(f.lo > f.hi))
            continue;
        v[f.below] = 1.0 / ratio(s, &f, f.below);
        v[f.above] = -1.0 / ratio(s, &f, f.above);
        s->elim.row_exp[f.below] = ilogb(v[f.below]); /* either weighs the same */
        s->elim.row_exp[f.above] = ilogb(v[f.above]);
        return 1;
    }
    return 0;
}
