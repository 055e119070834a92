/* src/verify/passive.c - whether the energy that a system stores is x' S M x / 2, which only sources add to.
 *
 * So it is where M is symmetric but for signs S of its rows, and where every entry of A, B, C has a
 * counterpart of the same size: networks of R, L, C, ideal devices, transformers and sources.  A controlled
 * source has no counterpart.
 */
#include "verify_internal.h"

#include <math.h>

/* The entry of row i in a column. */
static double entry(const ns_verify_rows *r, int i, int column) {
    double sum = 0;
    for (int k = r->start[i]; k < r->start[i + 1]; k++)
        sum += r->column[k] == column ? r->value[k] : 0;
    return sum;
}

static int same(double a, double b) {
    return fabs(a - b) <= 1e-9 * ns_verify_larger(fabs(a), fabs(b));
}

static int find_signs(const ns_verify *v) {
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        const double own = entry(&v->charge, i, i);
        v->sign[i] = own > 0 ? 1 : -1;
        if (own == 0)
            return 0;
    }
    return 1;
}

static int charges_are_symmetric(const ns_verify *v) {
    const ns_verify_rows *r = &v->charge;
    for (int i = 0; i < v->s->n; i++)
        for (int k = r->start[i]; k < r->start[i + 1]; k++) {
            const int j = r->column[k];
            if (!same(v->sign[i] * r->value[k], v->sign[j] * entry(r, j, i)))
                return 0;
        }
    return 1;
}

/* Every entry of (S1) in x, lambda has its counterpart in (S1), (S3). */
static int laws_are_reciprocal(const ns_verify *v) {
    const ns_verify_rows *r = &v->law;
    const int n = v->s->n, m = v->s->m;
    for (int i = 0; i < n; i++)
        for (int k = r->start[i]; k < r->start[i + 1]; k++) {
            const int j = r->column[k];
            const double other = j < n       ? entry(r, j, i)
                                 : j < n + m ? entry(&v->output, j - n, i)
                                             : r->value[k];
            if (!same(fabs(r->value[k]), fabs(other)))
                return 0;
        }
    return 1;
}

int ns_verify_passive_find(const ns_verify *v) {
    return find_signs(v) && charges_are_symmetric(v) && laws_are_reciprocal(v);
}
