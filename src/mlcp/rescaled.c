/* src/mlcp/rescaled.c - the problem in units of its own, where those it is written in leave a method lost.
 *
 * Powers of two for rows and columns bring the entries of W to about 1 (equilibrate.h), but leave a factor
 * open for each set of rows and columns that entries join: the KCL of nodes that nothing but devices hold
 * has the currents as columns, the KVL of these devices the voltages, and no entry says how the two compare.
 * What regularises such equations acts on lambda_i and y_i at once and depends on that; so q settles it:
 * every set has a largest q, fixed lambda folded in, of about 1.
 */
#include "mlcp_internal.h"

#include <math.h>

/* Whether v times 2^e is exact. */
static int exact(double v, int e) {
    return isinf(v) || ldexp(ldexp(v, e), -e) == v;
}

/* All exponents, with the open factors from s->q. */
static void choose(ns_mlcp_solver *s) {
    double *top = s->g;
    int *r = s->own_row, *c = s->own_col, f;
    ns_linalg_equilibrate(s->m, s->Wown, s->m, r, c, s->e);
    for (int i = 0; i < s->m; i++)
        top[i] = 0.0;
    for (int i = 0; i < s->m; i++)
        top[s->part[i]] = fmax(top[s->part[i]], fabs(ldexp(s->q[i], r[i])));
    for (int i = 0; i < s->m; i++) {
        (void)frexp(top[s->part[i]], &f);
        r[i] -= f;
        (void)frexp(top[ns_mlcp_part_of(s, i)], &f);
        c[i] += f;
    }
}

static int all_exact(const ns_mlcp_solver *s) {
    const double *w = s->Wown;
    const int *r = s->own_row, *c = s->own_col;
    int rounded = 0;
    for (int j = 0; j < s->m; j++) {
        rounded += !exact(s->given.q[j], r[j]) || !exact(s->lown[j], -c[j]) || !exact(s->uown[j], -c[j]);
        for (int i = 0; i < s->m; i++, w++)
            rounded += !exact(*w, r[i] + c[j]);
    }
    return rounded == 0;
}

/* way: 1 into these units, -1 back. */
static void multiply(ns_mlcp_solver *s, int way) {
    double *w = s->Wown;
    for (int j = 0; j < s->m; j++) {
        s->lown[j] = ldexp(s->lown[j], -way * s->own_col[j]);
        s->uown[j] = ldexp(s->uown[j], -way * s->own_col[j]);
        for (int i = 0; i < s->m; i++, w++)
            *w = ldexp(*w, way * (s->own_row[i] + s->own_col[j]));
    }
    s->have_units = s->have_scale = s->have_factors = s->have_transform = 0;
}

int ns_mlcp_rescale(ns_mlcp_solver *s) {
    ns_mlcp_units(s); /* for the parts */
    ns_mlcp_given(s);
    choose(s);
    if (!all_exact(s))
        return 0;
    s->written = s->given.q;
    for (int i = 0; i < s->m; i++)
        s->qown[i] = ldexp(s->written[i], s->own_row[i]);
    s->given.q = s->qown;
    multiply(s, 1);
    return 1;
}

void ns_mlcp_scale_back(ns_mlcp_solver *s) {
    multiply(s, -1);
    s->given.q = s->written;
    ns_mlcp_given(s);
    for (int i = 0; i < s->m; i++)
        s->lambda[i] = ldexp(s->lambda[i], s->own_col[i]);
}
