/* src/mlcp/infeasible/certificate.c - a proof that no solution exists, checked from the problem alone.
 *
 * Every solution satisfies  y = W lambda + q,  l <= lambda <= u  and, complementarity left aside,
 *     y_i = 0 (l = -inf, u = inf),  y_i >= 0 (only u = inf),  y_i <= 0 (only l = -inf),  else y_i free.
 * Hence for any v        0 = sum_i v_i (y_i - q_i) - sum_j s_j lambda_j,      s = W' v
 * and v proves that there is none if the right side is positive wherever it is looked at.
 */
#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "certificate.h"
#include "mlcp/verify/residual.h"

/* An s_j this small against its terms is rounding, of the terms and of a v that was rounded too.  No more
 * than that: equations that depend on each other but for 1e-12 may well have a solution. */
static const double CANCEL = 1e-14;

/* Least value of a x over lo <= x <= hi. */
static double least_product(double a, double lo, double hi) {
    if (a == 0.0)
        return 0.0;
    return a > 0.0 ? a * lo : a * hi;
}

/* ... of -s_j lambda_j, column j of W being w. */
static double least_of_column(const ns_mlcp *p, int mode, const double *v, int j, const double *w) {
    const double lo = mode == NS_UPPER ? p->u[j] : p->l[j], hi = mode == NS_LOWER ? p->l[j] : p->u[j];
    double s = 0.0, size = 0.0;
    int terms = 0;
    for (int i = 0; i < p->m; i++) {
        s += v[i] * w[i];
        size += fabs(v[i] * w[i]);
        terms += v[i] != 0.0 && w[i] != 0.0;
    }
    if (terms > 0 && size < DBL_MIN / CANCEL && (isinf(lo) || isinf(hi)))
        return -INFINITY; /* what underflowed is not 0 */
    double part = least_product(-s, lo, hi);
    return isinf(part) && fabs(s) <= CANCEL * size ? 0.0 : part;
}

static double margin_of_proof(const ns_mlcp *p, const ns_mode *mode, const double *v, double *room) {
    double sum = 0.0, size = 0.0;
    for (int i = 0; i < p->m; i++) {
        const int at = mode ? mode[i] : NS_OPEN;
        double part =
            least_product(v[i], ns_mlcp_least_y(p, i, at), ns_mlcp_most_y(p, i, at)) - v[i] * p->q[i];
        sum += part;
        size += fabs(part);
    }
    for (int j = 0; j < p->m; j++) {
        if (!p->W && p->column(p->data, j, room) != 0)
            return NAN;
        double part =
            least_of_column(p, mode ? mode[j] : NS_OPEN, v, j, p->W ? p->W + (size_t)j * (size_t)p->m : room);
        sum += part;
        size += fabs(part);
    }
    if (isnan(sum))
        return NAN;
    return isfinite(size) && sum > 0.0 ? sum / size : -1.0;
}

double ns_mlcp_certify_modes(const ns_mlcp *p, const ns_mode *mode, const double *v) {
    enum { SMALL = 128 };
    double few[SMALL], *room = few;
    if (ns_mlcp_unsound(p, v))
        return NAN;
    if (!p->W && p->m > SMALL && !(room = malloc((size_t)p->m * sizeof *room)))
        return NAN;
    double margin = margin_of_proof(p, mode, v, room);
    if (room != few)
        free(room);
    return margin;
}

double ns_mlcp_certify(const ns_mlcp *p, const double *v) {
    return ns_mlcp_certify_modes(p, NULL, v);
}
