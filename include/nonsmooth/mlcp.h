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
    NS_MLCP_AUTO,      /* "auto" */
    NS_MLCP_PIVOT,     /* "pivot"      principal pivoting: the pair broken worst is flipped */
    NS_MLCP_LEMKE,     /* "lemke"      Lemke's method, lexicographic ties */
    NS_MLCP_ENUMERATE, /* "enumerate"  modes by branch and bound, at most 16 pairs: the oracle */
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
    int method;      /* ns_mlcp_method that gave the answer or the proof */
    int certified;   /* INFEASIBLE: ns_mlcp_certificate() holds a proof */
    double searched; /* instructions of proofs and of branch and bound, about: counted, the same on every
                        machine */
    int cut_off;     /* that was ended by the bound of ns_mlcp_limit() */
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

/* Bounds what branch and bound may take in each of the solves to come, in instructions as info->searched
 * counts them; INFINITY, as until then: it has its own bound of nodes alone.  Errors: NULL, RANGE (NAN). */
int ns_mlcp_limit(ns_mlcp_solver *s, double most);

/* Solves p.  mode (m): the mode to start from (entries that do not fit their bounds are corrected); on
 * success the mode of the solution.  lambda (m), y (m): written on success.  info may be NULL.  Allocates no
 * memory.
 *
 * Order of NS_MLCP_AUTO: up to 64 pairs, principal pivoting from the given mode, on a transform of W that is
 * kept for the next solve with the same W; of more pairs, by blocks, with the factors of the last mode kept,
 * and by proximal points where blocks are singular.  Where that fails, pairs are exchanged until the starting
 * mode is a nonsingular basis; if its guards hold, no pivot is made, else Lemke's method starts there, with
 * lexicographic ties; then branch and bound over few pairs, and all once more in units of
 * the problem's own. The solution is computed anew from W and q in its mode, refined, and its natural
 * residual is checked.
 *
 * Where equalities are redundant (two closed switches in parallel), what they do not determine gets least
 * norm, in units of the scaling of W: equal shares for equal switches.
 *
 * OK: every y and lambda satisfies its law but for 1e-10 of the terms it is summed from, among them the
 * rounding of the largest lambda of its part (a problem whose q lacks no more than that may count as solved).
 * INFEASIBLE: no solution exists, proved by a certificate (info->certified) or, for few pairs, mode by
 * mode.  LIMIT: gave up, or the only lambda found has no digit that rounding of W leaves (nearly
 * singular). SINGULAR: no basis holds all equalities, and no solution of least norm was found.  OVERFLOW: a
 * solution has numbers that no double holds.  Also RESIDUAL, NULL, SIZE (p->m larger than the workspace),
 * NUMBER, BOUNDS (l > u, or both the same infinity).
 *
 * info->fault.pair, at most NS_FAULT_MAX: of INFEASIBLE the pairs that the certificate rests on, or whose
 * equations stay unsatisfied, the largest first; of SINGULAR the equalities that fit into no basis; else
 * empty. */
int ns_mlcp_solve(ns_mlcp_solver *s, const ns_mlcp *p, ns_mode *mode, double *lambda, double *y,
                  ns_mlcp_info *info);

/* The proof of a solve that returned INFEASIBLE with info->certified: v (m), owned by the solver until its
 * next solve, such that (Farkas)  0 = sum_i v_i (y_i - q_i) - sum_j (W' v)_j lambda_j  holds for no y and
 * lambda of the signs and bounds of the problem.  NULL otherwise. */
const double *ns_mlcp_certificate(const ns_mlcp_solver *s);

/* Checks such a v from the problem alone.  Returns by how much the least value of the right side of the line
 * above exceeds 0, relative to the terms it is summed from: > 0 proves, up to rounding, that no solution
 * exists; -1: v proves nothing; NAN: bad input.  Each column on demand is asked for once; NAN if one cannot
 * be had, or if memory for one is short (m > 128). */
double ns_mlcp_certify(const ns_mlcp *p, const double *v);

/* Returns the natural residual  max_i |lambda_i - proj_[l,u](lambda_i - y_i)|  for y = W lambda + q, computed
 * here from the problem; row i is scaled by the terms it is summed from (1e-16: as good as rounding allows).
 * *worst (may be NULL) gets the row.  Shares no code with the solver.  NAN for bad input.  Each column on
 * demand is asked for once and all are kept meanwhile; NAN if one cannot be had, or if memory is short (m >
 * 128, or W on demand). */
double ns_mlcp_residual(const ns_mlcp *p, const double *lambda, int *worst);

#ifdef __cplusplus
}
#endif
#endif
