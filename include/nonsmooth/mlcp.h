/* nonsmooth/mlcp.h - (P1): find lambda with  y = W lambda + q,  -y in N_[l,u](lambda).
 *
 * Pair i is at its lower bound (lambda = l, y >= 0), inside (l <= lambda <= u, y = 0) or at its
 * upper bound (lambda = u, y <= 0).  l = 0, u = inf: complementarity.  l = -inf, u = inf: an equality
 * y = 0.  l = u: lambda is given, y free.  Any l <= u is allowed but l = u = -inf and l = u = inf.
 */
#ifndef NONSMOOTH_MLCP_H
#define NONSMOOTH_MLCP_H

#include "nonsmooth/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef signed char ns_mode; /* of one pair */
enum { NS_LOWER = -1, NS_INSIDE = 0, NS_UPPER = 1 };

/* A problem; the arrays belong to the caller. */
typedef struct ns_mlcp {
    int m;           /* pairs, >= 0 */
    const double *W; /* m*m, column by column, finite; NULL: columns on demand */
    const double *q; /* m, finite */
    const double *l; /* m, -inf allowed */
    const double *u; /* m, +inf allowed, l <= u */
    /* Where W is NULL: writes column j of it (m numbers), from a factor, say.  Called at most once a solve
     * for each j, and only for columns that are needed.  Returns 0; anything else ends the solve with NUMBER.
     */
    int (*column)(void *data, int j, double *w);
    void *data;
} ns_mlcp;

/* The method.  AUTO tries several of the others, in the order that `make bench` shows to be fastest. */
typedef enum ns_mlcp_method {
    NS_MLCP_AUTO,     /* "auto" */
    NS_MLCP_PIVOT,    /* "pivot"      principal pivoting: block flips, least-index flips as the finite rule */
    NS_MLCP_LEMKE,    /* "lemke"      Lemke's method, lexicographic ties */
    NS_MLCP_NEWTON,   /* "newton"     semismooth Newton on the Fischer-Burmeister function, line search */
    NS_MLCP_INTERIOR, /* "interior"   primal-dual interior point */
    NS_MLCP_PROJECTED, /* "projected"  projected Gauss-Seidel, successive overrelaxation */
    NS_MLCP_ENUMERATE, /* "enumerate"  every mode in turn, at most 16 pairs: the oracle */
    NS_MLCP_METHODS
} ns_mlcp_method;

/* The name of a method, a constant string ("?" for a value outside the list); the method of a name, -1 if
 * there is none. */
const char *ns_mlcp_method_name(int method);
int ns_mlcp_method_of(const char *name);

/* What a solve did. */
typedef struct ns_mlcp_info {
    long pivots;     /* exchanges of one pair */
    long factors;    /* m*m factorisations */
    long iterations; /* of the iterative methods, summed */
    int method;      /* ns_mlcp_method that gave the answer or the proof */
    int certified;   /* INFEASIBLE: ns_mlcp_certificate() holds a proof */
    double residual; /* of the answer: ns_mlcp_residual(), or an upper bound of it that is below 1e-13 */
    ns_fault fault;  /* pair[]: see ns_mlcp_solve(); t is NAN, unknown[] empty */
} ns_mlcp_info;

typedef struct ns_mlcp_solver ns_mlcp_solver; /* workspace for problems of up to m pairs */

/* Makes a workspace.  On failure *out is NULL.  Errors: NULL, SIZE (m < 0), MEMORY. */
int ns_mlcp_create(int m, ns_mlcp_solver **out);

/* Frees a workspace; NULL is allowed. */
void ns_mlcp_free(ns_mlcp_solver *s);

/* Chooses the method of the solves to come; AUTO until then.  One method alone may fail where AUTO does not.
 * Errors: NULL, RANGE. */
int ns_mlcp_use(ns_mlcp_solver *s, ns_mlcp_method method);

/* Promises that W, l and u of the next problems have the very content of the last one solved, until the
 * promise is withdrawn: only q is read, and what was computed from W (scaling, factors of the last mode) is
 * used again.  Without it the solver compares W with its copy.  Errors: NULL. */
int ns_mlcp_same(ns_mlcp_solver *s, int same);

/* Declares that all entries of lambda have comparable units (V and A of a circuit): whether a number is
 * rounding beside another one is then decided in these units, otherwise in units found from W.
 * Errors: NULL. */
int ns_mlcp_alike(ns_mlcp_solver *s, int alike);

/* Solves p.  mode (m) is read as the mode to start from (any content is allowed: entries that do not
 * fit their bounds are mended) and holds the mode of the answer on success.  lambda (m) and y (m) are
 * written on success.  info may be NULL.  No memory is taken.
 * Method (auto): up to 64 pairs, principal pivoting from the mode on a transform of W that is kept for the
 * next solve with the same W; of more pairs, by blocks, with the factors of the last mode kept, and by
 * proximal points where blocks are singular.  Where that fails, the starting mode is made a nonsingular basis
 * (where its equations are singular, pairs are exchanged until they are not), its guards are read, and if
 * they hold, no pivot is made; otherwise Lemke's method from that basis with lexicographic ties; then
 * interior point, Newton, enumeration of few pairs, and once more in units of the problem's own.  The answer
 * is computed anew from W and q in its mode, refined, and its natural residual is checked before NS_OK. Where
 * equalities are redundant (two closed switches in parallel) the answer is, in what they leave open, the one
 * of least norm, in units of the scaling of W: equal shares for equal switches. info->fault.pair, at most
 * NS_FAULT_MAX: INFEASIBLE: the pairs that the certificate rests on, or whose equations are left unsatisfied,
 * the heaviest first; SINGULAR: the equalities that no basis takes beside the others.  Of other errors it
 * says nothing, of NS_OK it is empty. Verdicts: OK, solved: every y and lambda is what its laws ask for but
 * for 1e-10 of the terms that make it up, rounding of the largest lambda of its part among them (a problem
 * whose q lacks no more than that may be called solved);
 * INFEASIBLE, no solution exists: proved by a certificate (info->certified), or, for few pairs, by having
 * tried every mode; LIMIT, gave up, or all that was found is lambda of which rounding of W leaves no digit
 * (nearly singular equations). Errors: NULL, SIZE (p->m larger than the workspace), NUMBER, BOUNDS (l > u, or
 * both the same infinity); SINGULAR (no basis holds all equalities, and no answer of least norm was found),
 * INFEASIBLE, LIMIT, RESIDUAL, OVERFLOW (an answer has numbers that no double holds). */
int ns_mlcp_solve(ns_mlcp_solver *s, const ns_mlcp *p, ns_mode *mode, double *lambda, double *y,
                  ns_mlcp_info *info);

/* After a solve that answered INFEASIBLE with info->certified: v (m), owned by the solver until its next
 * solve, such that (Farkas)  0 = sum_i v_i (y_i - q_i) - sum_j (W' v)_j lambda_j  holds for no y and lambda
 * of the signs and bounds of the problem.  NULL otherwise. */
const double *ns_mlcp_certificate(const ns_mlcp_solver *s);

/* Checks such a v from the problem alone.  By how much the least value that the right side of the line above
 * can take lies above 0, relative to the terms it is summed from; > 0 proves that no solution exists, up to
 * rounding.  -1 where v proves nothing; NAN for bad input.  Each column on demand is asked for once; NAN
 * where one cannot be had, or where memory for one is short (m > 128). */
double ns_mlcp_certify(const ns_mlcp *p, const double *v);

/* The natural residual  max_i |lambda_i - proj_[l,u](lambda_i - y_i)|  with row i scaled so that it is
 * relative to the sizes of the terms that make it up (1e-16: as good as rounding allows), for
 * y = W lambda + q computed here from the problem.  *worst (may be NULL) gets the row.
 * Shares nothing with the solver.  Returns NAN for bad input.  Each column on demand is asked for once and
 * all are kept meanwhile; NAN where one cannot be had, or where memory is short (m > 128, or W on demand). */
double ns_mlcp_residual(const ns_mlcp *p, const double *lambda, int *worst);

#ifdef __cplusplus
}
#endif
#endif
