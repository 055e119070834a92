/* src/mlcp/infeasible/farkas.c - the proof that no lambda satisfies the linear constraints of a problem.
 *
 * Phase 1 ends with rows outside by side_r = +-1 and reduced costs d_c that allow no progress:
 *     sum_r side_r basic_r - sum_c d_c nonbasic_c = const     for all y = W lambda + q
 * and within the bounds the left side stays below const.  Its multipliers of the y are, with the sign
 * turned, the v of certificate.c: v_i = -side (y_i basic), d (nonbasic), such that
 *     (W' v)_j = side_j                                       for the lambda_j that are basic.
 * They are refined on W itself, in twice the digits, and judged by ns_mlcp_certify(), so that what is proved
 * rests on no tableau. If W is copositive-plus (monotone, say) a problem whose constraints can be met has a
 * solution: then every problem without one has such a proof.
 */
#include "phase1.h"

#include <math.h>
#include <string.h>

static const double MARGIN = 1e-9;  /* of the terms, by which a proof must prove */
static const double CANCEL = 1e-14; /* sums that cancel this far are 0 (certificate.c) */
static const double FLOOR =
    1e-6; /* a value's terms count as at least this part of the largest (residual.c) */
static const double ROUNDING = 1e-24; /* of the largest multiplier: what twice the digits of a double leave */

/* s_j = sum_i (v_i + rest_i) W_ij less `to`, as if in twice the digits (Ogita, Rump and Oishi's Dot2). */
static double dot_in_twice_the_digits(const ns_mlcp_solver *s, const double *v, const double *rest, int j,
                                      double to) {
    const double *col = s->p->W + (size_t)j * (size_t)s->m;
    double sum = -to, lost = 0.0;
    for (int i = 0; i < s->m; i++) {
        if (v[i] == 0.0 || col[i] == 0.0)
            continue;
        double term = v[i] * col[i], next = sum + term, part = next - sum;
        lost += (sum - (next - part)) + (term - part) + fma(v[i], col[i], -term) + rest[i] * col[i];
        sum = next;
    }
    return sum + lost;
}

/* (W' v)_j; *size: its terms. */
static double column_sum(const ns_mlcp_solver *s, const double *v, int j, double *size) {
    const double *col = s->p->W + (size_t)j * (size_t)s->m;
    double sum = *size = 0.0;
    for (int i = 0; i < s->m; i++) {
        sum += v[i] * col[i];
        *size += fabs(v[i] * col[i]);
    }
    return sum;
}

static void read_multipliers(const ns_phase1 *z, double *v) {
    const ns_mlcp_solver *s = z->s;
    memset(v, 0, (size_t)s->m * sizeof *v);
    for (int r = 0; r < z->rows; r++)
        if (s->tab.rowvar[r] % 2 == 1)
            v[s->tab.rowvar[r] / 2] = ldexp(-z->side[r], s->elim.row_exp[s->tab.rowvar[r] / 2]);
    for (int c = 0; c < z->cols; c++)
        if (s->tab.colvar[c] % 2 == 1)
            v[s->tab.colvar[c] / 2] = ldexp(z->cost[c], s->elim.row_exp[s->tab.colvar[c] / 2]);
}

/* One refinement: the block of the tableau of basic lambda and nonbasic y is the inverse of that of W.  v is
 * v + rest: the rounding of v in one equation would be handed on to others, in which it is large. */
static void refine_multipliers(const ns_phase1 *z, double *v, double *rest, double *error) {
    const ns_mlcp_solver *s = z->s;
    for (int r = 0; r < z->rows; r++) {
        int j = s->tab.rowvar[r] / 2;
        double to = ldexp(z->side[r], -s->elim.col_exp[j]);
        error[r] = s->tab.rowvar[r] % 2 == 0
                       ? ldexp(dot_in_twice_the_digits(s, v, rest, j, to), s->elim.col_exp[j])
                       : 0.0;
    }
    for (int c = 0; c < z->cols; c++) {
        const double *a = s->elim.A + (size_t)c * (size_t)s->m;
        const int i = s->tab.colvar[c] / 2;
        double sum = 0.0;
        if (s->tab.colvar[c] % 2 == 0)
            continue;
        for (int r = 0; r < z->rows; r++)
            sum += a[r] * error[r];
        double by = rest[i] - ldexp(sum, s->elim.row_exp[i]), whole = v[i] + by;
        rest[i] = fabs(v[i]) > fabs(by) ? by - (whole - v[i]) : v[i] - (whole - by);
        v[i] = whole;
    }
}

/* The largest multiplier, in the units of phase 1. */
static double largest_multiplier(const ns_phase1 *z, const double *v) {
    const ns_mlcp_solver *s = z->s;
    double top = 1.0; /* the sides */
    for (int c = 0; c < z->cols; c++)
        if (s->tab.colvar[c] % 2 == 1)
            top = fmax(top, ldexp(fabs(v[s->tab.colvar[c] / 2]), -s->elim.row_exp[s->tab.colvar[c] / 2]));
    return top;
}

/* Multipliers that are 0 but for the rounding of rest. */
static void drop_rounding(const ns_phase1 *z, double *v, double *rest) {
    const ns_mlcp_solver *s = z->s;
    const double top = largest_multiplier(z, v);
    for (int c = 0; c < z->cols; c++) {
        const int i = s->tab.colvar[c] / 2;
        if (s->tab.colvar[c] % 2 == 1 && ldexp(fabs(v[i]), -s->elim.row_exp[i]) <= ROUNDING * top)
            v[i] = rest[i] = 0.0;
    }
}

/* What the proof rests on: the pairs whose sign or bound it uses; where there is none, the equalities. */
static void name_pairs(ns_mlcp_solver *s, const double *v) {
    for (int a = 0; a < s->np; a++) {
        int i = s->pair[a];
        double size, sum = column_sum(s, v, i, &size);
        s->ray[a] = fmax(ldexp(fabs(v[i]), -s->elim.row_exp[i]),
                         fabs(sum) > CANCEL * size ? ldexp(fabs(sum), s->elim.col_exp[i]) : 0.0);
    }
    ns_mlcp_name(s, s->ray, s->np, s->pair);
    if (s->fault.npairs > 0)
        return;
    for (int f = 0; f < s->nf; f++)
        s->ray[f] = ldexp(fabs(v[s->free[f]]), -s->elim.row_exp[s->free[f]]);
    ns_mlcp_name(s, s->ray, s->nf, s->free);
}

/* Whether v, which leaves sum_i v_i y_i >= 0 to every solution, finds that of the answer negative by more
 * than an answer may be wrong by.  Where its lambda are large, W' v must cancel further than certify() asks.
 */
static int refutes_answer(const ns_mlcp_solver *s, const double *v, double *rest) {
    double sum = 0.0, size = 0.0;
    memset(rest, 0, (size_t)s->m * sizeof *rest);
    for (int i = 0; i < s->m; i++) {
        const double from_q = v[i] * s->p->q[i],
                     from_lambda = dot_in_twice_the_digits(s, v, rest, i, 0.0) * s->lambda[i];
        sum += from_q + from_lambda;
        size += fabs(from_q) + fabs(from_lambda);
    }
    return sum < -NS_MLCP_ACCEPT * size;
}

/* Multipliers v (m) of the point where phase 1 ended. */
static void read_refined(const ns_phase1 *z, double *v) {
    ns_mlcp_solver *s = z->s;
    double *rest = s->ray;
    read_multipliers(z, v);
    memset(rest, 0, (size_t)s->m * sizeof *rest);
    refine_multipliers(z, v, rest, s->g);
    drop_rounding(z, v, rest);
}

int ns_mlcp_farkas_proves(const ns_phase1 *z, double *v) {
    read_refined(z, v);
    return ns_mlcp_certify_modes(z->s->p, z->mode, v) > NS_MLCP_ACCEPT;
}

static int phase1_ends_outside(ns_mlcp_solver *s, ns_phase1 *z) {
    ns_mlcp_phase1_start(z, s, 0, FLOOR);
    return ns_mlcp_phase1_run(z) == NS_E_INFEASIBLE;
}

static int is_proof(const ns_mlcp_solver *s, int effort, const double *v) {
    const double margin = ns_mlcp_certify(s->p, v);
    return effort == NS_AGAINST ? margin > NS_MLCP_ACCEPT && refutes_answer(s, v, s->ray) : margin > MARGIN;
}

static int search_proof(ns_mlcp_solver *s, int effort) {
    ns_phase1 z;
    double *v = s->proof.v;
    const ns_mlcp now = s->now;
    ns_mlcp_take_given(s);
    int found = ns_mlcp_parallel(s, v) && is_proof(s, effort, v);
    if (!found && phase1_ends_outside(s, &z)) {
        read_refined(&z, v);
        found = is_proof(s, effort, v);
    }
    if (found)
        name_pairs(s, v);
    s->now = now;
    ns_mlcp_fold(s);
    return found;
}

int ns_mlcp_prove(ns_mlcp_solver *s, int effort) {
    if (s->proof.effort < effort) {
        s->proof.effort = effort;
        s->proof.found = search_proof(s, effort);
    }
    return s->proof.found;
}
