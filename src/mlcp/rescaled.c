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
static int is_exact(double v, int e) {
    return isinf(v) || ldexp(ldexp(v, e), -e) == v;
}

/* All exponents, with the open factors from s->q. */
static void choose_exponents(ns_mlcp_solver *s) {
    double *top = s->g;
    int *r = s->rescaled.row, *c = s->rescaled.col, f;
    ns_linalg_equilibrate(s->m, s->own.W, s->m, r, c, s->elim.e);
    for (int i = 0; i < s->m; i++)
        top[i] = 0.0;
    for (int i = 0; i < s->m; i++)
        top[s->units.part[i]] = fmax(top[s->units.part[i]], fabs(ldexp(s->q[i], r[i])));
    for (int i = 0; i < s->m; i++) {
        (void)frexp(top[s->units.part[i]], &f);
        r[i] -= f;
        (void)frexp(top[ns_mlcp_part_of(s, i)], &f);
        c[i] += f;
    }
}

static int all_exact(const ns_mlcp_solver *s) {
    const double *w = s->own.W;
    const int *r = s->rescaled.row, *c = s->rescaled.col;
    int rounded = 0;
    for (int j = 0; j < s->m; j++) {
        rounded +=
            !is_exact(s->given.q[j], r[j]) || !is_exact(s->own.l[j], -c[j]) || !is_exact(s->own.u[j], -c[j]);
        for (int i = 0; i < s->m; i++, w++)
            rounded += !is_exact(*w, r[i] + c[j]);
    }
    return rounded == 0;
}

/* way: 1 into these units, -1 back. */
static void multiply_problem(ns_mlcp_solver *s, int way) {
    double *w = s->own.W;
    for (int j = 0; j < s->m; j++) {
        s->own.l[j] = ldexp(s->own.l[j], -way * s->rescaled.col[j]);
        s->own.u[j] = ldexp(s->own.u[j], -way * s->rescaled.col[j]);
        for (int i = 0; i < s->m; i++, w++)
            *w = ldexp(*w, way * (s->rescaled.row[i] + s->rescaled.col[j]));
    }
    s->units.valid = s->scale.valid = s->factored.valid = s->transform.valid = 0;
}

int ns_mlcp_rescale(ns_mlcp_solver *s) {
    ns_mlcp_units(s); /* for the parts */
    ns_mlcp_take_given(s);
    choose_exponents(s);
    if (!all_exact(s))
        return 0;
    s->rescaled.given_q = s->given.q;
    for (int i = 0; i < s->m; i++)
        s->rescaled.q[i] = ldexp(s->rescaled.given_q[i], s->rescaled.row[i]);
    s->given.q = s->rescaled.q;
    multiply_problem(s, 1);
    return 1;
}

void ns_mlcp_scale_back(ns_mlcp_solver *s) {
    multiply_problem(s, -1);
    s->given.q = s->rescaled.given_q;
    ns_mlcp_take_given(s);
    for (int i = 0; i < s->m; i++)
        s->lambda[i] = ldexp(s->lambda[i], s->rescaled.col[i]);
}
