/* src/theta/name_fault.c - what a failed problem names: unknowns and pairs of the system.
 *
 * Row k of the split system is no matter of unknown k: differential rows come first, each a row of the system
 * plus other differential ones (cut_sets.c), and an algebraic one is a row of the system plus multiples of
 * differential ones (row_split.c).  A proof v of the split rows is T' v of those of the system.
 */
#include "name_fault.h"

#include "linalg/simd.h"

#include <math.h>

static const double negligible = 1e-9; /* of the largest weight: rounding */

static double split_entry(const ns_fault_context *b, int k, int i) {
    return b->T[k + i * b->n];
}

/* Row i of the system is a differential row. */
static int is_differential(const ns_fault_context *b, int i) {
    int found = 0;
    for (int k = 0; k < b->rank; k++)
        found |= split_entry(b, k, i) != 0;
    return found;
}

/* The row of the system that row k is, but for differential ones: both kinds stand in the order of the
 * system.
 */
static int row_of(const ns_fault_context *b, int k) {
    int before = k < b->rank ? k : k - b->rank;
    for (int i = 0; i < b->n; i++)
        if (is_differential(b, i) == (k < b->rank) && before-- == 0)
            return i;
    return k;
}

/* The weight of row i of the system in the proof v: the largest among the rows it is in, less what cancels.
 */
static double weight_of_row(const ns_fault_context *b, const double *v, const double *scale, int i) {
    double sum = 0, size = 0, largest = 0;
    for (int k = 0; k < b->n; k++) {
        const double part = split_entry(b, k, i) * v[k] * (k < b->rank ? b->h : 1);
        sum += part;
        size += fabs(part);
        largest = part != 0 ? fmax(largest, fabs(v[k]) / scale[k]) : largest;
    }
    return size > 0 ? largest * fabs(sum) / size : 0;
}

static int is_named(const ns_fault *f, int i) {
    int found = 0;
    for (int k = 0; k < f->nunknowns; k++)
        found |= f->unknown[k] == i;
    return found;
}

/* Names the rows of the system with the largest weights in v, the largest first. */
static void name_rows(const ns_fault_context *b, const double *v, const double *scale, ns_fault *to) {
    double top = 0;
    for (int k = 0; k < b->n + b->m; k++)
        top = fmax(top, fabs(v[k]) / scale[k]);
    while (to->nunknowns < NS_FAULT_MAX) {
        double largest = negligible * top;
        int best = -1;
        for (int i = 0; i < b->n; i++) {
            const double w = is_named(to, i) ? 0 : weight_of_row(b, v, scale, i);
            if (w > largest) {
                largest = w;
                best = i;
            }
        }
        if (best < 0)
            return;
        to->unknown[to->nunknowns++] = best;
    }
}

void ns_theta_name_fault(const ns_fault_context *b, const ns_mlcp *p, const ns_mlcp_solver *solver,
                         const ns_fault *from, ns_lu *lu, ns_fault *to) {
    const double *v = ns_mlcp_certificate(solver);
    int rows = 0;
    to->npairs = to->nunknowns = 0;
    for (int k = 0; k < from->npairs; k++) {
        const int i = from->pair[k];
        if (i >= b->n && i < b->n + b->m)
            to->pair[to->npairs++] = i - b->n;
        else if (i < b->n && !v)
            to->unknown[to->nunknowns++] = row_of(b, i);
        rows += i < b->n;
    }
    if (!v || rows == 0)
        return;
    (void)ns_linalg_lu_scale(lu, p->m, p->W);
    name_rows(b, v, ns_linalg_lu_rows(lu), to);
}

int ns_theta_name_infinite(int n, const double *v, int *index) {
    int count = 0;
    if (!v || ns_sums_finite(n, v))
        return 0;
    for (int i = 0; i < n && count < NS_FAULT_MAX; i++)
        if (!isfinite(v[i]))
            index[count++] = i;
    return count;
}
