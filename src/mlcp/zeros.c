/* src/mlcp/zeros.c - points refused for lambda that are 0 but for rounding, remembered with zeros in place.
 *
 * Where few lambda are held by many equations and the answer is 0 (A lambda = 0 of more rows than columns,
 * other rows of A with a q), what a method finds is 1e-17 of that q.  Rows in which nothing else enters
 * compare that with itself and find every digit wrong.  No floor of residual.c helps: it is taken from
 * lambda, and these are all of their part.
 */
#include "mlcp_internal.h"

#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"

static const double NOISE =
    1e-12; /* of what q and the other lambda of the part make: NS_MLCP_GUARD of solve.c */

/* s->ysize: by part, the largest lambda, in the unit of its column, that is there or that q asks for. */
static void sizes(ns_mlcp_solver *s) {
    double *size = s->ysize;
    memset(size, 0, (size_t)s->m * sizeof *size);
    for (int i = 0; i < s->m; i++) {
        double *of_row = &size[s->units.part[i]], *of_column = &size[ns_mlcp_part_of(s, i)];
        if (s->units.rowmax[i] > 0.0)
            *of_row = fmax(*of_row, fabs(s->p->q[i]) / s->units.rowmax[i]);
        *of_column = fmax(*of_column, fabs(s->lambda[i]) / s->units.column[i]);
    }
}

/* lambda_i, or the 0 or the bound that it stands for. */
static double mended(const ns_mlcp_solver *s, int i) {
    const double size = s->ysize[ns_mlcp_part_of(s, i)], v = s->lambda[i];
    return fmin(fmax(fabs(v) / s->units.column[i] <= NOISE * size ? 0.0 : v, s->p->l[i]), s->p->u[i]);
}

void ns_mlcp_zeros_note(ns_mlcp_solver *s) {
    double *lambda = s->g;
    if (!ns_linalg_finite((size_t)s->m, s->lambda))
        return;
    sizes(s);
    for (int i = 0; i < s->m; i++)
        lambda[i] = mended(s, i);
    const double r = ns_mlcp_measure(s->p, lambda, s->alike, s->rhs, NULL);
    if (!(r <= NS_MLCP_ACCEPT && r < s->noted.residual))
        return;
    s->noted.residual = r;
    s->noted.method = s->method;
    memcpy(s->noted.lambda, lambda, (size_t)s->m * sizeof *lambda);
    for (int i = 0; i < s->m; i++)
        s->noted.mode[i] = ns_mlcp_fit_mode(s, i,
                                            lambda[i] == s->p->l[i]   ? NS_LOWER
                                            : lambda[i] == s->p->u[i] ? NS_UPPER
                                                                      : NS_INSIDE);
}

int ns_mlcp_zeros_recall(ns_mlcp_solver *s) {
    if (isinf(s->noted.residual))
        return 0;
    ns_mlcp_take_given(s);
    memcpy(s->lambda, s->noted.lambda, (size_t)s->m * sizeof *s->lambda);
    memcpy(s->mode, s->noted.mode, (size_t)s->m * sizeof *s->mode);
    s->method = s->noted.method;
    return 1;
}
