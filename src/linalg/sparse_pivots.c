/* src/linalg/sparse_pivots.c - whether pivots of KLU's factors are but rounding, or too small beside their
 * column.
 *
 * Pivot j is a_jj less the sum over k < j of l_jk u_kj.  It says nothing where it is some eps of the sum of
 * the sizes of these terms, which scales with it as rows and columns are scaled.  Only where a pivot is far
 * smaller than the entries of its column are the terms looked at.
 */
#include "sparse_pivots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What of its column makes a pivot suspect; what of its terms is rounding; what of its column is the product
 * of two such, which their own size does not tell. */
static const double suspect = 1e-10, rounding = 1e-13, nothing = 1e-28;

double ns_linalg_pivots_error(int n, const int *start, const int *row, const double *value,
                              klu_symbolic *symbolic, klu_numeric *numeric, klu_common *common,
                              double *work) {
    double *x = work, *rest = x + n, *terms = rest + n, worst = 0;
    unsigned long long random = 88172645463325252U;
    memset(terms, 0, sizeof *terms * (size_t)n);
    for (int k = 0; k < start[n]; k++)
        terms[row[k]] += fabs(value[k]);
    for (int i = 0; i < n; i++) {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        x[i] = rest[i] = random & 1024 ? terms[i] : -terms[i];
    }
    int known = klu_solve(symbolic, numeric, n, 1, x, common);
    for (int j = 0; j < n; j++)
        for (int k = start[j]; k < start[j + 1]; k++) {
            rest[row[k]] -= value[k] * x[j];
            terms[row[k]] += fabs(value[k] * x[j]);
        }
    for (int i = 0; i < n; i++) {
        worst = fmax(worst, terms[i] > 0 ? fabs(rest[i]) / terms[i] : 0);
        known &= isfinite(x[i]) != 0;
    }
    return known ? worst : INFINITY;
}

/* The smallest pivot, of the entries of its column. */
static double smallest(int n, const int *start, const int *row, const double *value, const klu_symbolic *s,
                       const klu_numeric *f) {
    const double *diagonal = f->Udiag;
    double least = INFINITY;
    for (int j = 0; j < n; j++) {
        const int column = s->Q[j];
        double most = 0;
        for (int k = start[column]; k < start[column + 1]; k++)
            most = fmax(most, fabs(value[k]) / f->Rs[f->Pinv[row[k]]]);
        least = fmin(least, fabs(diagonal[j]) / most);
    }
    return least;
}

typedef struct triangles {
    int *Lp, *Li, *Up, *Ui;
    double *Lx, *Ux;
    int *first, *column; /* L by rows */
    double *entry, *of;
} triangles;

/* L, row by row, without its diagonal. */
static void by_rows(int n, triangles *t) {
    for (int k = 0; k < t->Lp[n]; k++)
        t->first[t->Li[k] + 1]++;
    for (int i = 0; i < n; i++)
        t->first[i + 1] += t->first[i];
    for (int j = 0; j < n; j++)
        for (int k = t->Lp[j]; k < t->Lp[j + 1]; k++) {
            const int to = t->first[t->Li[k]]++;
            t->column[to] = j;
            t->entry[to] = t->Lx[k];
        }
    for (int i = n; i > 0; i--)
        t->first[i] = t->first[i - 1];
    t->first[0] = 0;
}

static int any_rounding(int n, const triangles *t) {
    int any = 0;
    for (int j = 0; j < n && !any; j++) {
        double sum = 0, pivot = 0;
        for (int k = t->Up[j]; k < t->Up[j + 1]; k++) {
            t->of[t->Ui[k]] = t->Ux[k];
            pivot = t->Ui[k] == j ? t->Ux[k] : pivot;
        }
        for (int k = t->first[j]; k < t->first[j + 1]; k++)
            sum += fabs(t->entry[k] * t->of[t->column[k]]);
        any = fabs(pivot) <= rounding * sum;
        for (int k = t->Up[j]; k < t->Up[j + 1]; k++)
            t->of[t->Ui[k]] = 0;
    }
    return any;
}

int ns_linalg_pivots_vanish(int n, const int *start, const int *row, const double *value,
                            klu_symbolic *symbolic, klu_numeric *numeric, klu_common *common) {
    const size_t l = (size_t)numeric->lnz, u = (size_t)numeric->unz, all = (size_t)n;
    int any = 0;
    const double least = smallest(n, start, row, value, symbolic, numeric);
    if (!(least < suspect) || least < nothing)
        return least < nothing;
    int *ints = calloc(2 * l + u + 3 * (all + 1) + 1, sizeof *ints);
    double *doubles = calloc(2 * l + u + all + 1, sizeof *doubles);
    if (ints && doubles) {
        triangles t = {.Lp = ints, .Lx = doubles};
        t.Up = t.Lp + all + 1;
        t.first = t.Up + all + 1;
        t.Li = t.first + all + 1;
        t.column = t.Li + l;
        t.Ui = t.column + l;
        t.entry = t.Lx + l;
        t.Ux = t.entry + l;
        t.of = t.Ux + u;
        if (klu_extract(numeric, symbolic, t.Lp, t.Li, t.Lx, t.Up, t.Ui, t.Ux, NULL, NULL, NULL, NULL, NULL,
                        NULL, NULL, common)) {
            by_rows(n, &t);
            any = any_rounding(n, &t);
        }
    }
    free(ints);
    free(doubles);
    return any;
}
