/* src/mlcp/verify/huge_multipliers.c - answers whose lambda is so large that they may say nothing of the
 * problem.
 *
 * Equations that contradict each other but for the last digits of W have an answer as good as any by its
 * residual: t v + lambda_0 with W v = 0 to rounding, t = 1/eps.  Large lambda alone prove nothing, where
 * entries of W span 30 decades; two things do:
 *   - a row of which the residual thinks nothing, as lambda of other rows may have rounded there
 *     (residual.c), is broken in full by its own terms, and by as much as the data are;
 *   - the equations of the mode leave of the largest lambda no digit (Bauer and Skeel: |A^-1| (|A| |lambda| +
 *     |q|) eps is a bound, and nearly always the size, of what rounding of A and q comes to; units of rows
 *     and columns do not matter, so that 1e-15 lambda = 1 is no doubt at all).
 */
#include "mlcp/mlcp_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "residual_bound.h"

static const double DATA = 1e-6;   /* of the largest datum, in units of rows and columns: not noise */
static const double BROKEN = 1e-3; /* of a row's own terms, or of its q */
static const double DIGIT = 0.1;

/* Sizes in units of W: the largest lambda that is solved for, and its index; the largest datum. */
static double measure_sizes(ns_mlcp_solver *s, double *data, int *largest) {
    double answer = 0.0;
    *data = 0.0;
    *largest = -1;
    ns_mlcp_units(s);
    for (int i = 0; i < s->m; i++) {
        const double size = fabs(s->lambda[i]) / s->units.column[i];
        *data = fmax(*data, s->units.rowmax[i] > 0.0 ? fabs(s->given.q[i]) / s->units.rowmax[i] : 0.0);
        if (s->mode[i] != NS_INSIDE)
            *data = fmax(*data, size);
        else if (size > answer) {
            answer = size;
            *largest = i;
        }
    }
    return answer;
}

int ns_mlcp_huge_multipliers(ns_mlcp_solver *s, double doubt) {
    int largest;
    double data;
    return measure_sizes(s, &data, &largest) > doubt * data;
}

/* What is wrong with y in row i. */
static double row_violation(const ns_mlcp_solver *s, int i, double y, double near) {
    const double l = s->p->l[i], u = s->p->u[i], v = s->lambda[i];
    const int lower = v - l <= near * s->units.column[i], upper = u - v <= near * s->units.column[i];
    return lower && upper ? 0.0 : lower ? fmax(-y, 0.0) : upper ? fmax(y, 0.0) : fabs(y);
}

/* y in s->g, its terms in s->ysize.  A row is not noise if its q is among the largest, in units of W and in
 * those of the problem. */
static int breaks_a_row(const ns_mlcp_solver *s, double data) {
    double q = 0.0;
    int n = 0;
    for (int i = 0; i < s->m; i++)
        q = fmax(q, fabs(s->given.q[i]));
    for (int i = 0; i < s->m; i++) {
        const double by = row_violation(s, i, s->g[i], DATA * data);
        n += by > BROKEN * s->ysize[i] && by > DATA * data * s->units.rowmax[i] &&
             fabs(s->given.q[i]) > DATA * q;
    }
    return n > 0;
}

int ns_mlcp_breaks_a_datum(ns_mlcp_solver *s) {
    ns_mlcp_sum_terms(s->p, NULL, s->lambda, s->g, s->ysize);
    for (int i = 0; i < s->m; i++) {
        const double q = fabs(s->given.q[i]), rounding = DBL_EPSILON * s->ysize[i];
        if (q != 0.0 && row_violation(s, i, s->g[i], 0.0) + rounding > BROKEN * q)
            return 1;
    }
    return 0;
}

/* Row i of A^-1 against the terms of the equations. */
static int has_no_digit(ns_mlcp_solver *s, int i) {
    double sum = 0.0, *row = s->rhs;
    ns_mlcp_take_given(s);
    if (ns_mlcp_basis_factor(s, NULL) != NS_OK)
        return 0; /* what is redundant need not have to do with i */
    for (int k = 0; k < s->k; k++)
        row[k] = s->cols[k] == i ? 1.0 : 0.0;
    ns_linalg_lu_solve_transposed(s->lu, 1, row);
    for (int k = 0; k < s->k; k++)
        sum += fabs(row[k]) * s->ysize[s->rows[k]];
    return !(DBL_EPSILON * sum < DIGIT * fabs(s->lambda[i]));
}

int ns_mlcp_huge_multipliers_fail(ns_mlcp_solver *s, double doubt) {
    double data;
    int largest;
    if (!(measure_sizes(s, &data, &largest) > doubt * data))
        return 0;
    ns_mlcp_sum_terms(s->p, NULL, s->lambda, s->g, s->ysize);
    return breaks_a_row(s, data) || has_no_digit(s, largest);
}
