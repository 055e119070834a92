/* src/mlcp/mlcp_internal.h - the workspace and the parts of ns_mlcp_solve().
 *
 * The m indices of a problem are sorted into
 *   free   l = -inf, u = inf: y = 0, lambda always basic
 *   fixed  l = u: lambda given, y never asked; folded into q
 *   pairs  everything else, numbered a = 0..np-1; each has at least one finite bound
 * A basis says which lambda are solved for: all free ones, and of the pairs those that are inside.  The
 * other pairs have lambda at a bound and y solved for.
 */
#ifndef NS_MLCP_INTERNAL_H
#define NS_MLCP_INTERNAL_H

#include <math.h>
#include <stddef.h>

#include "linalg/dense.h"
#include "linalg/equilibrate.h"
#include "mlcp/verify/residual_bound.h"
#include "nonsmooth/mlcp.h"

/* Guards hold if no y or lambda is outside by more than NS_MLCP_GUARD of its size: the terms of a sum leave
 * 1e-16 of it each, a solve with some dozen unknowns 1e-14; two decades are for the condition. */
static const double NS_MLCP_GUARD = 1e-12;
static const double NS_MLCP_ACCEPT = 1e-10; /* natural residual of an answer, at most */
static const double NS_MLCP_GOOD = 1e-13;   /* an answer of this residual is not refined further */

/* Variables of the pairs: lambda_a is 2a, y_a is 2a+1, the covering variable t is 2 np. */
enum { PIVOTS_FLAT = 50, PIVOTS_PER_PAIR = 20 };

/* An answer, or a point that may become one. */
typedef struct ns_mlcp_point {
    double *lambda, *y; /* m */
    ns_mode *mode;      /* m */
    int method;         /* what found it */
    double residual;
} ns_mlcp_point;

/* The canonical tableau: basic = beta + T nonbasic, in units of ysize and lsize (tableau.c, lemke.c). */
typedef struct ns_mlcp_tableau {
    int ncol;               /* np, or np+1 with t */
    double *T;              /* np*(np+1), leading dimension np */
    double *beta;           /* np: values */
    int *rowvar, *colvar;   /* np, np+1 */
    int *where;             /* 2np+1: row, or -1-column, of a variable */
    double *unit;           /* 2np+1 */
    double *lo, *hi;        /* np: bounds of lambda_a in its unit */
    signed char *at_upper;  /* np: nonbasic lambda_a is at u */
    double *cover;          /* m: column of t in y = W lambda + q + cover t; as work phase1.c */
    unsigned char *first_y; /* np: at the start y_a was basic (lexicographic order) */
} ns_mlcp_tableau;

/* The principal pivot transform of own.W, of the pairs whose lambda is basic (transform.c). */
typedef struct ns_mlcp_transform {
    int valid;
    int count, *pair, *place; /* m: which pairs P is of, and the place of each among them, or -1 */
    double *P;                /* m columns, of m rounded up to a multiple of four */
    double *largest;          /* m: the largest term that each diagonal entry of P was summed from */
    unsigned char *basic;     /* m: lambda_i is basic */
    double *yterms, *lterms;  /* m: sizes of the terms that y, and a basic lambda, was summed from */
    double slack;             /* guards are read to this part of them */
    int carried; /* lambda and y are those of mode, but for rounding; yterms and lterms as well */
    int settled; /* mode is that of the answer that pivot.c found last; P is of it */
} ns_mlcp_transform;

/* Gaussian elimination (reveal.c, phase1.c). */
typedef struct ns_mlcp_elimination {
    double *A, *mag;                  /* m*m: scaled W, and the largest term that an entry was summed from */
    int *row_exp, *col_exp;           /* m: exponents of the scaling */
    short *e;                         /* m*m: work of ns_linalg_equilibrate() */
    unsigned char *rowdone, *coldone; /* m */
    int *parent;                      /* m: the path to a row */
    int nstuck, *stuck_row, *stuck_col; /* m: what no pivot was found for */
} ns_mlcp_elimination;

struct ns_mlcp_solver {
    /* --- what the caller asked for --- */
    int cap;            /* room for this many pairs */
    ns_mlcp_method use; /* ns_mlcp_use() */
    int same;           /* ns_mlcp_same() */
    int alike;          /* ns_mlcp_alike() */
    double most;        /* ns_mlcp_limit() */

    /* --- the problem (problem.c) --- */
    const ns_mlcp *p; /* &given */
    ns_mlcp given;    /* as given, but for own.W, own.l and own.u in place of the caller's */
    struct {
        double *W;            /* m*m: columns not asked for yet are zero (on demand) */
        double *l, *u;        /* m */
        double *q;            /* m: that of a problem with subnormal numbers, without these */
        ns_nonzeros nonzeros; /* of W; none on demand */
        int known;            /* these are the last problem's */
        int on_demand;        /* its W was NULL */
        int missing;          /* columns not asked for yet */
        unsigned char *have;  /* m: columns that are there */
    } own;
    int m, nf, np, nx;        /* indices: all, free, pairs, fixed */
    int *free, *pair, *fixed; /* nf, np, nx: which */
    int at_zero;              /* every finite bound is 0 */
    ns_mode *lowest;          /* m: all at their lower bounds, as far as they have one */

    /* --- what is being solved: *p, or a regularised copy --- */
    ns_mlcp now;
    const double *W; /* now.W */
    double *q;       /* m: now.q with the fixed lambda folded in */

    /* --- units in which sizes are compared (ns_mlcp_units()) --- */
    struct {
        int valid;      /* they are those of own.W */
        int *part;      /* m: of row i, some number that the rows it is joined with share */
        double *rowmax; /* m: largest |W_ij| of a row */
        double *column; /* m: unit of lambda_j in which it makes terms of that size */
    } units;

    /* --- the point at hand --- */
    ns_mode *mode;      /* m */
    double *lambda, *y; /* m */
    double *ysize;      /* m: sizes of the terms summed in y_i */
    double *lsize;      /* m: the change of lambda_i that some y_j notices in full; pairs only */
    int method;         /* what found it */
    int agrees;         /* y and mode are known to be those of lambda */

    /* --- the equations of a mode (basis.c) --- */
    int k;     /* their number */
    int *rows; /* k: indices i whose y_i is nonbasic */
    int *cols; /* k: indices j whose lambda_j is basic; -1 stands for t */
    double *G; /* (m+1)^2: W at these */
    ns_lu *lu; /* of G */
    struct {   /* block.c: what lu holds, if it is that of own.W */
        int valid;
        int ridge;             /* 2^this on its diagonal; 0: none */
        unsigned char *inside; /* m: which lambda are basic */
        double *centre;        /* m: what the ridge draws lambda to */
    } factored;
    struct { /* block.c: 2^(row_i + col_j) own.W_ij are about 1 */
        int valid, *row, *col;
    } scale;

    /* --- what the methods work on --- */
    ns_mlcp_transform transform;
    ns_mlcp_tableau tab;
    ns_mlcp_elimination elim;
    struct {           /* proximal.c: W + eps E, q, and the entries of eps E */
        double *W, *q; /* m*m, m */
        int *row, *col;
        double *value; /* m */
    } regularised;

    /* --- points remembered --- */
    ns_mlcp_point kept;  /* by one method, the best so far */
    ns_mlcp_point noted; /* by zeros.c, the best that was refused; residual: infinite if there is none */

    /* --- what is said of the solve --- */
    struct {
        double *v;  /* m: the certificate */
        int found;  /* v is one */
        int effort; /* how this solve has looked for one */
    } proof;
    int nodes_alike; /* nodes of branch_and_bound.c since the last answer */
    long pivots, factors;
    double searched; /* instructions of phase1.c, */
    int cut_off;     /* which for branch_and_bound.c were to be more than `most` */
    ns_fault fault;

    /* --- work: of whoever runs, for as long as it runs --- */
    double *rhs;     /* (m+1)*(m+2) + NS_MEASURE_WORK*m */
    double *xs;      /* (m+1)*(m+2) */
    double *g, *ray; /* m */
    int *queue;      /* m */

    /* --- memory, which all of the above lies in --- */
    double *doubles;
    int *ints;
    unsigned char *bytes;
};

int ns_mlcp_check_bounds(const ns_mlcp *p); /* problem.c: of lambda.  NUMBER, BOUNDS */

/* problem.c: makes s->given, and sorts the indices where it is not known already.  NULL, SIZE, NUMBER,
 * BOUNDS. */
int ns_mlcp_load(ns_mlcp_solver *s, const ns_mlcp *p);
int ns_mlcp_fetch_all(ns_mlcp_solver *s);                        /* Wown, if on demand.  NUMBER */
void ns_mlcp_units(ns_mlcp_solver *s);                           /* rowmax, colunit */
void ns_mlcp_take_given(ns_mlcp_solver *s);                      /* now = *p */
void ns_mlcp_fold(ns_mlcp_solver *s);                            /* W, q of now */
void ns_mlcp_start_from(ns_mlcp_solver *s, const ns_mode *mode); /* s->mode = mode mended; NULL: all lower */

/* The lambda of a pair not inside. */
static inline double ns_mlcp_bound(const ns_mlcp_solver *s, int i, ns_mode mode) {
    return mode == NS_UPPER ? s->p->u[i] : s->p->l[i];
}

static inline ns_mode ns_mlcp_fit_mode(const ns_mlcp_solver *s, int i, ns_mode mode) {
    const double l = s->p->l[i], u = s->p->u[i];
    if (l == u)
        return NS_LOWER;
    if (mode == NS_INSIDE || (isinf(l) && isinf(u)))
        return NS_INSIDE;
    return isinf(l) || (mode == NS_UPPER && !isinf(u)) ? NS_UPPER : NS_LOWER;
}

/* workspace.c: lambda, y, mode and method put aside, and taken back. */
void ns_mlcp_save(const ns_mlcp_solver *s, ns_mlcp_point *to);
void ns_mlcp_restore(ns_mlcp_solver *s, const ns_mlcp_point *from);

/* basis.c */
void ns_mlcp_basis_pick(ns_mlcp_solver *s);   /* rows, cols, k of s->mode */
void ns_mlcp_basis_gather(ns_mlcp_solver *s); /* G of them */
/* Factors A (n*n) into s->lu. */
int ns_mlcp_basis_factor_of(ns_mlcp_solver *s, int n, const double *A, double *rcond);
int ns_mlcp_basis_factor(ns_mlcp_solver *s, double *rcond);    /* all that, and its factors */
void ns_mlcp_basis_values(ns_mlcp_solver *s, int refinements); /* lambda, y, from the factors */
void ns_mlcp_basis_correct(ns_mlcp_solver *s); /* one refinement by the residual of W, q as they are now */
void ns_mlcp_basis_sizes(ns_mlcp_solver *s);   /* ysize, lsize, at lambda */
void ns_mlcp_basis_floor_sizes(
    ns_mlcp_solver *s); /* ysize, from the sums of its terms; its reciprocals to g */
double ns_mlcp_basis_lambda_size(const ns_mlcp_solver *s, int i); /* lsize of a pair, from g */
double ns_mlcp_basis_violation(const ns_mlcp_solver *s);          /* worst guard, in units of the sizes */
ns_mode ns_mlcp_basis_wanted(const ns_mlcp_solver *s, int i);     /* that the guard of pair i asks for */
int ns_mlcp_part_of(const ns_mlcp_solver *s, int j);              /* the part that column j is in */
void ns_mlcp_basis_clamp(ns_mlcp_solver *s);                      /* lambda into its bounds, signs of y */
void ns_mlcp_basis_zero_undriven(
    ns_mlcp_solver *s); /* lambda and y are 0, not rounding, in parts of W that nothing drives */

/* tableau.c */
void ns_mlcp_tableau_start(ns_mlcp_solver *s); /* of s->mode, whose G is factored and whose sizes are known */
int ns_mlcp_tableau_refresh(ns_mlcp_solver *s); /* from W and q anew, t included.  SINGULAR */
void ns_mlcp_tableau_exchange(ns_mlcp_solver *s, int row, int col);

static inline int ns_is_t(const ns_mlcp_solver *s, int var) {
    return var == 2 * s->np;
}

static inline int ns_is_y(const ns_mlcp_solver *s, int var) {
    return (var & 1) && !ns_is_t(s, var);
}

/* Bounds of a basic variable, in its unit. */
static inline double ns_mlcp_tableau_lower(const ns_mlcp_solver *s, int var) {
    if (ns_is_t(s, var))
        return 0.0;
    if (ns_is_y(s, var))
        return s->tab.at_upper[var / 2] ? -INFINITY : 0.0;
    return s->tab.lo[var / 2];
}

static inline double ns_mlcp_tableau_upper(const ns_mlcp_solver *s, int var) {
    if (ns_is_t(s, var))
        return INFINITY;
    if (ns_is_y(s, var))
        return s->tab.at_upper[var / 2] ? 0.0 : INFINITY;
    return s->tab.hi[var / 2];
}

/* lemke.c: from s->mode to the mode of a solution.  all: the covering vector acts on every guard, not on
 * the broken ones only; which one.  limit_factor: how many times the pivots that most problems need may be
 * made. OK; INFEASIBLE: a ray, in s->fault; LIMIT; SINGULAR: the tableau got lost. */
int ns_mlcp_lemke(ns_mlcp_solver *s, int all, int limit_factor);

/* farkas.c: 1 if the bounds of lambda and y alone, without complementarity, contradict: s->proof, s->fault.
 * CAREFUL: by more than rounding of the largest numbers of the problem may have left.  AGAINST: that the
 * answer in s->lambda is none, by as much as an answer may be wrong by at least. Each effort is made once a
 * solve.  Uses elim, tab, ysize, lsize, kept, xs, ray, g, queue. */
enum { NS_CAREFUL = 1, NS_AGAINST };
int ns_mlcp_prove(ns_mlcp_solver *s, int effort);

/* parallel.c: v (m) of two rows of W that are multiples of each other and ask the opposite; 0: there are
 * none. v is not judged.  Uses r, c (exponents of units of the rows and columns), queue, rowdone. */
int ns_mlcp_parallel(ns_mlcp_solver *s, double *v);

/* zeros.c: s->lambda, which was refused, is remembered with zeros for rounding, if that makes it an answer
 * and the best so far.  Uses g, ysize, rhs.  Back into s->lambda and s->mode; 0 if there is none. */
void ns_mlcp_zeros_note(ns_mlcp_solver *s);
int ns_mlcp_zeros_recall(ns_mlcp_solver *s);

/* huge_multipliers.c: whether lambda is so large against q and the bounds, in units of W, that it may hide in
 * its rounding what q says; whether it does.  The latter uses g, ysize, rhs, and what ns_mlcp_basis_factor()
 * does. */
int ns_mlcp_huge_multipliers(ns_mlcp_solver *s, double doubt);
int ns_mlcp_huge_multipliers_fail(ns_mlcp_solver *s, double doubt);

/* Whether a row is broken by as much as its own q, or not much less, or may be by rounding: then lambda
 * satisfies the row whatever q says.  Uses g, ysize. */
int ns_mlcp_breaks_a_datum(ns_mlcp_solver *s);

/* consistent_answer.c: makes s->y and s->mode those of s->lambda, which goes from bound to bound of boxes
 * that are next to nothing; then *residual is that of the new one.  0: they cannot be had, or not with a
 * residual <= NS_MLCP_ACCEPT. Uses g, ray, rhs, ysize, queue. */
int ns_mlcp_make_consistent(ns_mlcp_solver *s, double *residual);

/* Whether s->y is not the y of lambda, whose terms are of the size given; equalities are left aside. */
int ns_mlcp_is_inconsistent(const ns_mlcp_solver *s, const double *y, const double *size);

/* fault.c: fault.pair gets index[k] of the largest weights, largest first. */
void ns_mlcp_name(ns_mlcp_solver *s, const double *weight, int n, const int *index);

/* ... gets index[0..n-1]. */
void ns_mlcp_list(ns_mlcp_solver *s, int n, const int *index);

/* reveal.c: makes s->mode a nonsingular basis close to it.  SINGULAR: s->elim.stuck_row, s->elim.stuck_col.
 */
int ns_mlcp_reveal(ns_mlcp_solver *s);

/* proximal.c: after ns_mlcp_reveal() was stuck.  INFEASIBLE: the equations contradict; SINGULAR. */
int ns_mlcp_proximal(ns_mlcp_solver *s, const ns_mode *mode, double *residual);

/* The other methods, one a file.  Each starts from s->mode (mended) and works on s->now, whose fixed lambda
 * are folded into s->q; each may use A, mag, G, rhs, xs, T, Wreg and the vectors named as work in its file.
 * OK: s->lambda is an answer of natural residual <= NS_MLCP_ACCEPT, and s->mode the mode it suggests: the
 * driver computes the answer of that mode and takes the better of the two.  LIMIT, SINGULAR: gave up. */
int ns_mlcp_pivot(ns_mlcp_solver *s); /* pivot.c */
/* The same in one, from mode, without units, sorting and scaling: what most problems need.  OK: s->lambda,
 * s->y, s->mode are an answer; else LIMIT, SINGULAR, RESIDUAL. */
int ns_mlcp_pivot_from(ns_mlcp_solver *s, const ns_mode *mode, double *residual);
/* block.c: for more; s->y as well; patient: though proximal points lead nowhere at first.  OK, LIMIT,
 * SINGULAR, RESIDUAL. */
int ns_mlcp_block(ns_mlcp_solver *s, int patient, double *residual);
/* mode_answer.c: the answer in s->mode, whose G is factored: clamped, refined, measured.  RESIDUAL: not
 * accepted. */
int ns_mlcp_mode_answer(ns_mlcp_solver *s, double *residual);

/* lemke_starts.c: different starts, until s->now is solved or one of them proves that it cannot be. */
int ns_mlcp_lemke_starts(ns_mlcp_solver *s, const ns_mode *mode, double *residual);

#endif
