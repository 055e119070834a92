/* src/mlcp/pivoting/block.c - principal pivoting by blocks, for many pairs.
 *
 * Every round factors W_JJ of the mode (J: the equalities and the pairs inside) and flips all pairs whose
 * guard is broken, as long as that lets their number fall every few rounds (Judice and Pires).
 * Where W_JJ is singular (loops of ideal diodes, redundant equalities), proximal points take over:
 *
 *     y = W lambda + q + ridge (lambda - x),     ridge_i = eps in units in which the entries of W are about 1
 *
 * W of a passive network is positive semidefinite, so all principal blocks of W + ridge are nonsingular,
 * whatever the units.  x is 0 at first, then the answer so far, while eps gets smaller: what the equations
 * leave open comes out shortest.  In a mode whose guards hold, correcting lambda by the true residual is the
 * iteration for x; so it ends with an answer of the problem as given, or not at all.
 * The factors of the last mode are kept: a solve from there factors nothing.
 */
#include <math.h>
#include <string.h>

#include "mlcp/mlcp_internal.h"
#include "mlcp/verify/residual.h"
#include "mlcp/verify/residual_bound.h"

enum { ROUNDS = 100, IDLE = 15, REFINEMENTS = 8 };
enum { FIRST = -20, LAST = -50, STEP = -6 }; /* exponents of eps */
static const double RCOND = 1e-13;           /* a basis must keep three digits */

typedef struct state {
    ns_mlcp_solver *s;
    int eps; /* exponent of the ridge; 0: none */
} state;

static double ridge(const state *b, int i) {
    return b->eps ? ldexp(1.0, b->eps - b->s->scale.row[i] - b->s->scale.col[i]) : 0.0;
}

/* --- the equations of a mode --- */

static int factors_are_of_mode(const state *b) {
    const ns_mlcp_solver *s = b->s;
    int same = s->factored.valid && s->factored.ridge == b->eps;
    for (int i = 0; i < s->m && same; i++)
        same = s->factored.inside[i] == (s->mode[i] == NS_INSIDE);
    return same;
}

/* W_JJ + ridge and its factors, or those of the last time. */
static int factor_mode(state *b) {
    ns_mlcp_solver *s = b->s;
    double rcond;
    ns_mlcp_basis_pick(s);
    if (factors_are_of_mode(b))
        return NS_OK;
    if (!s->scale.valid)
        ns_linalg_equilibrate(s->m, s->W, s->m, s->scale.row, s->scale.col, s->elim.e);
    s->scale.valid = 1;
    s->factored.valid = 0;
    ns_mlcp_basis_gather(s);
    for (int j = 0; j < s->k; j++) {
        s->queue[j] = s->scale.col[s->cols[j]];
        s->G[(size_t)j * (size_t)(s->k + 1)] += ridge(b, s->cols[j]);
    }
    s->factors++;
    const int status = ns_linalg_lu_factor_quickly(s->lu, s->k, s->G, s->queue, &rcond);
    if (status != NS_OK || (!b->eps && rcond < RCOND))
        return NS_E_SINGULAR;
    for (int i = 0; i < s->m; i++)
        s->factored.inside[i] = s->mode[i] == NS_INSIDE;
    s->factored.ridge = b->eps;
    s->factored.valid = 1;
    return NS_OK;
}

/* y, with the ridge, and the sizes of its terms. */
static void evaluate_y(const state *b) {
    ns_mlcp_solver *s = b->s;
    (void)ns_mlcp_residual_bound(&s->now, s->lambda, s->y, s->ysize);
    for (int i = 0; i < s->m && b->eps; i++)
        s->y[i] += ridge(b, i) * (s->lambda[i] - s->factored.centre[i]);
}

/* Takes y of the equations to 0. */
static void correct_lambda(ns_mlcp_solver *s) {
    for (int k = 0; k < s->k; k++)
        s->rhs[k] = -s->y[s->rows[k]];
    ns_linalg_lu_solve(s->lu, 1, s->rhs);
    for (int k = 0; k < s->k; k++)
        s->lambda[s->cols[k]] += s->rhs[k];
}

static int all_finite(const ns_mlcp_solver *s) {
    double sum = 0.0;
    for (int i = 0; i < s->m; i++)
        sum += 0.0 * s->lambda[i] + 0.0 * s->y[i];
    return sum == 0.0;
}

/* lambda of the mode, from its factors. */
static void set_lambda(const state *b) {
    ns_mlcp_solver *s = b->s;
    for (int i = 0; i < s->m; i++)
        s->lambda[i] = s->mode[i] != NS_INSIDE ? ns_mlcp_bound(s, i, s->mode[i])
                       : b->eps                ? s->factored.centre[i]
                                               : 0.0;
    evaluate_y(b);
    correct_lambda(s);
}

/* The same and y. */
static int solve_mode(const state *b) {
    set_lambda(b);
    evaluate_y(b);
    return all_finite(b->s) ? NS_OK : NS_E_SINGULAR;
}

/* --- guards --- */

/* The mode that the guard of pair i asks for; sizes of lambda are found where they are needed. */
static ns_mode mode_wanted(ns_mlcp_solver *s, int i) {
    if (s->mode[i] == NS_INSIDE) {
        if (s->lambda[i] >= s->p->l[i] && s->lambda[i] <= s->p->u[i])
            return NS_INSIDE;
        s->lsize[i] = ns_mlcp_basis_lambda_size(s, i);
    }
    return ns_mlcp_basis_wanted(s, i);
}

/* Flips all whose guards are broken; returns how many. */
static int flip_violated(state *b) {
    ns_mlcp_solver *s = b->s;
    int n = 0;
    ns_mlcp_basis_floor_sizes(s);
    for (int a = s->np - 1; a >= 0; a--) {
        const int i = s->pair[a];
        const ns_mode to = mode_wanted(s, i);
        if (to == s->mode[i])
            continue;
        s->mode[i] = to;
        s->pivots++;
        n++;
    }
    return n;
}

/* One number for a mode: that of another one is another, but for one in 1e19. */
static unsigned long long number_of_mode(const ns_mlcp_solver *s) {
    unsigned long long number = 14695981039346656037U;
    for (int i = 0; i < s->m; i++)
        number = (number ^ (unsigned long long)s->mode[i]) * 1099511628211U;
    return number;
}

/* 1 if the mode is one of those met before, count of them: from there on they come in turn. */
static int was_met(const ns_mlcp_solver *s, unsigned long long *met, int count) {
    met[count] = number_of_mode(s);
    for (int k = 0; k < count; k++)
        if (met[k] == met[count])
            return 1;
    return 0;
}

/* From s->mode to one whose guards hold.  LIMIT: to one whose guards nearly do, or not. */
static int find_mode(state *b) {
    unsigned long long met[ROUNDS];
    int best = b->s->np + 1, idle = 0;
    for (int round = 0; round < ROUNDS && idle < IDLE && !was_met(b->s, met, round); round++) {
        if (factor_mode(b) != NS_OK || solve_mode(b) != NS_OK)
            return NS_E_SINGULAR;
        const int n = flip_violated(b);
        if (n == 0)
            return NS_OK;
        idle = n < best ? 0 : idle + 1;
        best = n < best ? n : best;
    }
    return factor_mode(b) == NS_OK && solve_mode(b) == NS_OK ? NS_E_LIMIT : NS_E_SINGULAR;
}

/* --- the answer of a mode --- */

/* A bound of the residual of lambda, put into its bounds. */
static double clamp_and_bound(ns_mlcp_solver *s) {
    for (int i = 0; i < s->m; i++)
        s->lambda[i] = fmin(fmax(s->lambda[i], s->p->l[i]), s->p->u[i]);
    return ns_mlcp_residual_bound(&s->now, s->lambda, s->y, s->ysize);
}

/* Corrections by the true residual, as long as they help; the best stays.  Returns its residual. */
static double refine_answer(state *b) {
    ns_mlcp_solver *s = b->s;
    double best = clamp_and_bound(s), last = best;
    ns_mlcp_save(s, &s->kept);
    for (int k = 0; k < REFINEMENTS && best > NS_MLCP_GOOD; k++) {
        correct_lambda(s);
        const double r = clamp_and_bound(s);
        if (r < best)
            ns_mlcp_save(s, &s->kept);
        best = fmin(best, r);
        if (!(r <= 0.5 * last))
            break;
        last = r;
    }
    ns_mlcp_restore(s, &s->kept);
    if (best <= NS_MLCP_GOOD)
        return best;
    const double full = ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL);
    return isnan(full) ? full : fmin(best, full);
}

/* The answer of the mode at hand if its factors are: no guard is asked where there is no residual. */
static double answer_of_kept_factors(state *b) {
    b->eps = b->s->factored.ridge;
    if (!factors_are_of_mode(b))
        return INFINITY;
    ns_mlcp_basis_pick(b->s);
    set_lambda(b);
    return refine_answer(b);
}

/* From s->mode without a ridge. */
static double solve_without_ridge(state *b, int *status) {
    b->eps = 0;
    *status = find_mode(b);
    return *status != NS_E_SINGULAR ? refine_answer(b) : INFINITY;
}

/* --- proximal points --- */

/* One point: *r gets its residual.  1: nothing better is to be expected. */
static int solve_point(state *b, int patient, double *r) {
    const int status = find_mode(b);
    if (status == NS_E_SINGULAR || (status == NS_E_LIMIT && !patient)) {
        *r = INFINITY;
        return 1;
    }
    *r = refine_answer(b);
    return *r <= NS_MLCP_GOOD;
}

/* Ever smaller ridges, from the answer of the one before.  Not patient: it is given up where no mode is found
 * for one of them. */
static double solve_proximal_points(state *b, int patient) {
    ns_mlcp_solver *s = b->s;
    double r = INFINITY;
    memset(s->factored.centre, 0, (size_t)s->m * sizeof *s->factored.centre);
    for (int eps = FIRST; eps >= LAST; eps += STEP) {
        b->eps = eps;
        const int done = solve_point(b, patient, &r);
        if (done)
            return r;
        memcpy(s->factored.centre, s->lambda, (size_t)s->m * sizeof *s->lambda);
    }
    return r;
}

int ns_mlcp_block(ns_mlcp_solver *s, int patient, double *residual) {
    state b = {.s = s};
    int status = NS_OK;
    *residual = answer_of_kept_factors(&b);
    if (!(*residual <= NS_MLCP_ACCEPT))
        *residual = solve_without_ridge(&b, &status);
    if (!(*residual <= NS_MLCP_ACCEPT) && status == NS_E_SINGULAR)
        *residual = solve_proximal_points(&b, patient);
    if (!(*residual <= NS_MLCP_ACCEPT))
        return status == NS_E_LIMIT ? status : NS_E_RESIDUAL;
    memcpy(s->ray, s->y, (size_t)s->m * sizeof *s->y);
    ns_mlcp_basis_clamp(s);
    s->agrees = !ns_mlcp_is_inconsistent(s, s->ray, s->ysize);
    return NS_OK;
}
