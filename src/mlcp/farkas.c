/* src/mlcp/farkas.c - the proof that no lambda satisfies the linear constraints of a problem.
 *
 * Phase 1 ends with rows outside by side_r = +-1 and reduced costs d_c that allow no progress:
 *     sum_r side_r basic_r - sum_c d_c nonbasic_c = const     for all y = W lambda + q
 * and within the bounds the left side stays below const.  Its multipliers of the y are, with the sign
 * turned, the v of certificate.c: v_i = -side (y_i basic), d (nonbasic), such that
 *     (W' v)_j = side_j                                       for the lambda_j that are basic.
 * They are refined on W itself and judged by ns_mlcp_certify(), so that what is proved rests on no tableau.
 * If W is copositive-plus (monotone, say) a problem whose constraints can be met has a solution: then
 * every problem without one has such a proof.
 */
#include "phase1.h"

#include <math.h>
#include <string.h>

static const double MARGIN = 1e-9;  /* of the terms, by which a proof must prove */
static const double CANCEL = 1e-14; /* sums that cancel this far are 0 (certificate.c) */
static const double FLOOR =
    1e-6; /* a value's terms count as at least this part of the largest (residual.c) */
static const double ROUNDING = 1e-10; /* of the largest multiplier, in the units of phase 1 */
enum { REFINEMENTS = 2, ROUNDS = 3 };

/* s_j = sum_i v_i W_ij less `to`; *size: its terms. */
static double combine(const ns_mlcp_solver *s, const double *v, int j, double to, double *size) {
    const double *col = s->p->W + (size_t)j * (size_t)s->m;
    long double sum = -to;
    *size = fabs(to);
    for (int i = 0; i < s->m; i++) {
        sum += (long double)v[i] * col[i];
        *size += fabs(v[i] * col[i]);
    }
    return (double)sum;
}

static void multipliers(const ns_phase1 *z, double *v) {
    const ns_mlcp_solver *s = z->s;
    memset(v, 0, (size_t)s->m * sizeof *v);
    for (int r = 0; r < z->rows; r++)
        if (s->rowvar[r] % 2 == 1)
            v[s->rowvar[r] / 2] = ldexp(-z->side[r], s->r[s->rowvar[r] / 2]);
    for (int c = 0; c < z->cols; c++)
        if (s->colvar[c] % 2 == 1)
            v[s->colvar[c] / 2] = ldexp(z->cost[c], s->r[s->colvar[c] / 2]);
}

/* One refinement: the block of the tableau of basic lambda and nonbasic y is the inverse of that of W. */
static void refine(const ns_phase1 *z, double *v, double *error) {
    const ns_mlcp_solver *s = z->s;
    for (int r = 0; r < z->rows; r++) {
        int j = s->rowvar[r] / 2;
        double size, to = ldexp(z->side[r], -s->c[j]);
        error[r] = s->rowvar[r] % 2 == 0 ? ldexp(combine(s, v, j, to, &size), s->c[j]) : 0.0;
    }
    for (int c = 0; c < z->cols; c++) {
        const double *a = s->A + (size_t)c * (size_t)s->m;
        double sum = 0.0;
        if (s->colvar[c] % 2 == 0 || z->cost[c] == 0.0)
            continue;
        for (int r = 0; r < z->rows; r++)
            sum += a[r] * error[r];
        v[s->colvar[c] / 2] -= ldexp(sum, s->r[s->colvar[c] / 2]);
    }
}

/* Any v will do: what has a sign that y_i does not allow is left out. */
static void mend(const ns_mlcp *p, double *v) {
    for (int i = 0; i < p->m; i++)
        if ((v[i] < 0.0 && isfinite(p->l[i])) || (v[i] > 0.0 && isfinite(p->u[i])))
            v[i] = 0.0;
}

/* Multipliers that are 0 but for rounding are no help in refining: it would give half of them a sign that y_i
 * does not allow. */
static void drop_rounding(const ns_phase1 *z, double *v) {
    const ns_mlcp_solver *s = z->s;
    double top = 1.0; /* the sides */
    for (int c = 0; c < z->cols; c++)
        top = fmax(top,
                   s->colvar[c] % 2 == 1 ? ldexp(fabs(v[s->colvar[c] / 2]), -s->r[s->colvar[c] / 2]) : 0.0);
    for (int c = 0; c < z->cols; c++) {
        const int i = s->colvar[c] / 2;
        if (s->colvar[c] % 2 == 1 && ldexp(fabs(v[i]), -s->r[i]) <= ROUNDING * top)
            v[i] = z->cost[c] = 0.0;
    }
}

/* What the proof rests on: the pairs whose sign or bound it uses; where there is none, the equalities. */
static void name(ns_mlcp_solver *s, const double *v) {
    for (int a = 0; a < s->np; a++) {
        int i = s->pair[a];
        double size, sum = combine(s, v, i, 0.0, &size);
        s->ray[a] =
            fmax(ldexp(fabs(v[i]), -s->r[i]), fabs(sum) > CANCEL * size ? ldexp(fabs(sum), s->c[i]) : 0.0);
    }
    ns_mlcp_name(s, s->ray, s->np, s->pair);
    if (s->fault.npairs > 0)
        return;
    for (int f = 0; f < s->nf; f++)
        s->ray[f] = ldexp(fabs(v[s->free[f]]), -s->r[s->free[f]]);
    ns_mlcp_name(s, s->ray, s->nf, s->free);
}

static int proves(ns_mlcp_solver *s, double floor, double *v) {
    ns_phase1 z;
    if (!ns_phase1_run(&z, s, floor))
        return 0;
    multipliers(&z, v);
    for (int round = 0; round < ROUNDS; round++) {
        for (int k = 0; k < REFINEMENTS; k++)
            refine(&z, v, s->g);
        mend(s->p, v);
        if (ns_mlcp_certify(s->p, v) > MARGIN)
            return 1;
        drop_rounding(&z, v);
    }
    return 0;
}

int ns_farkas(ns_mlcp_solver *s, int effort) {
    ns_mlcp now = s->now;
    ns_mlcp_given(s);
    int proved = proves(s, effort == NS_CAREFUL ? FLOOR : 0.0, s->proof);
    if (proved)
        name(s, s->proof);
    s->now = now;
    ns_mlcp_fold(s);
    return proved;
}
