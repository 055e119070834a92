/* src/mlcp/pivoting/block.c - principal pivoting by blocks, for many pairs.
 *
 * Every round factors W_JJ of the mode (J: the equalities and the pairs inside) and flips all pairs whose
 * guard is broken, as long as that lets their number fall every few rounds; after that one at a time
 * (Judice and Pires; Murty's rule).
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

enum { ROUNDS = 100, PATIENCE = 3, IDLE = 15, REFINEMENTS = 8 };
/* Exponents of eps; from CLEAR on it is small beside what is not singular. */
enum { FIRST = -20, LAST = -50, STEP = -6, CLEAR = -30 };
static const double FINE = 1e-11;   /* the same where rows are compared with their own noise */
static const double SMALL = 1e-14;  /* of the terms of an equation: it holds */
static const double RCOND = 1e-13;  /* a basis must keep three digits */
static const double RUNAWAY = 1e-2; /* part of lambda by which one more correction may change it */

typedef struct state {
    ns_mlcp_solver *s;
    int eps;      /* exponent of the ridge; 0: none */
    double bound; /* of the last residual: with no row compared with more than its own terms */
    int alone;    /* the pair that the last round flipped, if it was one; -1 */
} state;

static double ridge(const state *b, int i) {
    return b->eps ? ldexp(1.0, b->eps - b->s->scale.row[i] - b->s->scale.col[i]) : 0.0;
}

/* --- the equations of a mode --- */

static int factors_fit(const state *b) {
    const ns_mlcp_solver *s = b->s;
    int same = s->factored.valid && s->factored.ridge == b->eps;
    for (int i = 0; i < s->m && same; i++)
        same = s->factored.inside[i] == (s->mode[i] == NS_INSIDE);
    return same;
}

/* W_JJ + ridge and its factors, or those of the last time. */
static int factor(state *b) {
    ns_mlcp_solver *s = b->s;
    double rcond;
    ns_mlcp_basis_pick(s);
    if (factors_fit(b))
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

/* y and the sizes of its terms; the worst of the equations, relative to them. */
static double look(const state *b) {
    ns_mlcp_solver *s = b->s;
    double worst = 0.0;
    (void)ns_mlcp_quick_residual(&s->now, s->lambda, s->y, s->ysize);
    for (int i = 0; i < s->m && b->eps; i++)
        s->y[i] += ridge(b, i) * (s->lambda[i] - s->factored.centre[i]);
    for (int k = 0; k < s->k; k++) {
        const int i = s->rows[k];
        if (!(fabs(s->y[i]) <= worst * s->ysize[i]))
            worst = fabs(s->y[i]) / s->ysize[i];
    }
    return worst;
}

/* s->rhs (k): the change of lambda that takes y of the equations to 0. */
static void change(ns_mlcp_solver *s) {
    for (int k = 0; k < s->k; k++)
        s->rhs[k] = -s->y[s->rows[k]];
    ns_linalg_lu_solve(s->lu, 1, s->rhs);
}

static void correct(ns_mlcp_solver *s) {
    change(s);
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
static void start(const state *b) {
    ns_mlcp_solver *s = b->s;
    for (int i = 0; i < s->m; i++)
        s->lambda[i] = s->mode[i] != NS_INSIDE ? ns_mlcp_bound(s, i, s->mode[i])
                       : b->eps                ? s->factored.centre[i]
                                               : 0.0;
    (void)look(b);
    correct(s);
}

/* The same and y, refined once if that is needed. */
static int values(const state *b) {
    start(b);
    if (look(b) > SMALL) {
        correct(b->s);
        (void)look(b);
    }
    return all_finite(b->s) ? NS_OK : NS_E_SINGULAR;
}

/* --- guards --- */

/* The mode that the guard of pair i asks for; sizes of lambda are found where they are needed. */
static ns_mode wanted(ns_mlcp_solver *s, int i) {
    if (s->mode[i] == NS_INSIDE) {
        if (s->lambda[i] >= s->p->l[i] && s->lambda[i] <= s->p->u[i])
            return NS_INSIDE;
        s->lsize[i] = ns_mlcp_basis_lambda_size(s, i);
    }
    return ns_mlcp_basis_wanted(s, i);
}

/* Flips all whose guards are broken, or only the last of them; returns how many are broken.  A pair flipped
 * alone in the round before stays: its guard holds but for rounding. */
static int flip(state *b, int all) {
    ns_mlcp_solver *s = b->s;
    int n = 0, flipped = -1;
    ns_mlcp_basis_raise(s);
    for (int a = s->np - 1; a >= 0; a--) {
        const int i = s->pair[a];
        const ns_mode to = wanted(s, i);
        if (to == s->mode[i] || i == b->alone)
            continue;
        if (all || n == 0) {
            s->mode[i] = to;
            s->pivots++;
            flipped = i;
        }
        n++;
    }
    b->alone = all && n > 1 ? -1 : flipped;
    return n;
}

/* From s->mode to one whose guards hold.  LIMIT: to one whose guards nearly do, or not. */
static int search(state *b) {
    int best = b->s->np + 1, idle = 0;
    b->alone = -1;
    for (int round = 0; round < ROUNDS && idle < IDLE; round++) {
        if (factor(b) != NS_OK || values(b) != NS_OK)
            return NS_E_SINGULAR;
        const int n = flip(b, idle < PATIENCE);
        if (n == 0)
            return NS_OK;
        idle = n < best ? 0 : idle + 1;
        best = n < best ? n : best;
    }
    return factor(b) == NS_OK && values(b) == NS_OK ? NS_E_LIMIT : NS_E_SINGULAR;
}

/* --- the answer of a mode --- */

/* A bound of the residual of lambda, put into its bounds. */
static double check(ns_mlcp_solver *s) {
    for (int i = 0; i < s->m; i++)
        s->lambda[i] = fmin(fmax(s->lambda[i], s->p->l[i]), s->p->u[i]);
    return ns_mlcp_quick_residual(&s->now, s->lambda, s->y, s->ysize);
}

/* Whether one more correction hardly changes lambda: where equations contradict each other, it runs away, and
 * in the end hides that by its size. */
static int settled(ns_mlcp_solver *s) {
    double norm = 0.0, most = 0.0;
    change(s);
    for (int i = 0; i < s->m; i++)
        norm = fmax(norm, fabs(s->lambda[i]) / s->units.column[i]);
    for (int k = 0; k < s->k; k++)
        most = fmax(most, fabs(s->rhs[k]) / s->units.column[s->cols[k]]);
    return most <= RUNAWAY * norm;
}

/* Corrections by the true residual, as long as they help; the best stays.  Returns its residual. */
static double polish(state *b) {
    ns_mlcp_solver *s = b->s;
    double best = check(s), last = best;
    ns_mlcp_keep(s);
    for (int k = 0; k < REFINEMENTS && best > NS_MLCP_GOOD; k++) {
        correct(s);
        const double r = check(s);
        if (r < best)
            ns_mlcp_keep(s);
        best = fmin(best, r);
        if (!(r <= 0.5 * last))
            break;
        last = r;
    }
    ns_mlcp_give_back(s);
    b->bound = best;
    if (b->eps && !settled(s))
        return INFINITY;
    if (best <= NS_MLCP_GOOD)
        return best;
    ns_mlcp_basis_rest(s);
    const double full = ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL);
    return isnan(full) ? full : fmin(best, full);
}

/* The answer of the mode at hand if its factors are: no guard is asked where there is no residual. */
static double again(state *b) {
    b->eps = b->s->factored.ridge;
    if (!factors_fit(b))
        return INFINITY;
    ns_mlcp_basis_pick(b->s);
    start(b);
    return polish(b);
}

/* From s->mode without a ridge. */
static double exactly(state *b, int *status) {
    b->eps = 0;
    *status = search(b);
    return *status != NS_E_SINGULAR ? polish(b) : INFINITY;
}

/* --- proximal points --- */

static void put(const ns_mlcp_solver *s, double *lambda, ns_mode *mode) {
    memcpy(lambda, s->lambda, (size_t)s->m * sizeof *lambda);
    memcpy(mode, s->mode, (size_t)s->m * sizeof *mode);
}

/* One point: *r gets its residual.  1: nothing better is to be expected. */
static int point(state *b, double best, double *r) {
    if (search(b) == NS_E_SINGULAR) {
        *r = INFINITY;
        return 1;
    }
    *r = polish(b);
    return (*r <= NS_MLCP_GOOD && (b->bound <= FINE || best <= NS_MLCP_GOOD));
}

/* Ever smaller ridges, from the answer of the one before; between, from there without one. */
static double approach(state *b) {
    ns_mlcp_solver *s = b->s;
    ns_mode *mode = s->tab.at_upper, *best_mode = (ns_mode *)s->tab.first_y;
    double best = INFINITY, *best_lambda = s->tab.cover, r;
    int status;
    memset(s->factored.centre, 0, (size_t)s->m * sizeof *s->factored.centre);
    for (int eps = FIRST; eps >= LAST; eps += STEP) {
        b->eps = eps;
        const int done = point(b, best, &r);
        if (done && r < INFINITY)
            return r;
        if (done)
            break;
        put(s, s->factored.centre, mode);
        if (r < best) {
            put(s, best_lambda, best_mode);
            best = r;
        }
        if (eps <= CLEAR && best > NS_MLCP_GOOD && (r = exactly(b, &status)) < best)
            return r;
        memcpy(s->mode, mode, (size_t)s->m * sizeof *mode);
    }
    if (isinf(best))
        return best;
    memcpy(s->lambda, best_lambda, (size_t)s->m * sizeof *best_lambda);
    memcpy(s->mode, best_mode, (size_t)s->m * sizeof *best_mode);
    (void)check(s);
    return best;
}

int ns_mlcp_block(ns_mlcp_solver *s, double *residual) {
    state b = {.s = s};
    int status = NS_OK;
    *residual = again(&b);
    if (!(*residual <= NS_MLCP_ACCEPT))
        *residual = exactly(&b, &status);
    if (!(*residual <= NS_MLCP_ACCEPT) && status == NS_E_SINGULAR)
        *residual = approach(&b);
    if (!(*residual <= NS_MLCP_ACCEPT))
        return status == NS_E_LIMIT ? status : NS_E_RESIDUAL;
    memcpy(s->ray, s->y, (size_t)s->m * sizeof *s->y);
    ns_mlcp_basis_clamp(s);
    s->agrees = !ns_mlcp_differs(s, s->ray, s->ysize);
    return NS_OK;
}
