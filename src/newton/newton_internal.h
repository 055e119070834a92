/* src/newton/newton_internal.h - the Newton stepper from inside: shared by newton.c, point.c,
 * linearised_lcp.c, loop.c, newton/step.c, newton/jump.c. */
#ifndef NS_NEWTON_INTERNAL_H
#define NS_NEWTON_INTERNAL_H

#include "linalg/dense.h"
#include "nonsmooth/newton.h"

/* An iterate.  (y, lambda) always obey (S4); what Newton brings to zero are R and Ry. */
typedef struct ns_iterate {
    double *x, *lambda, *y;
    double *f, *g;  /* n: rows combined by T; algebraic rows of f where the relation is taken */
    double *r;      /* n: g as the model gives it */
    double *h;      /* m */
    double *R, *Ry; /* n, m: residuals of (S1) over the step, of (S3) */
    double *block;  /* where all of them lie */
} ns_iterate;

struct ns_newton {
    const ns_model *model;
    ns_newton_options o;
    int n, m, rank; /* rank: differential rows */
    double *T, *M;  /* n*n: ns_linalg_row_split(), T M */
    /* the past: accepted point */
    int started;
    double t;
    double *xk, *lk, *yk, *rk; /* n, m, m, n */
    ns_mode *mode;             /* m */
    double *fk;                /* n: f at t_k, rows combined, */
    int has_fk;                /* if it is there */
    /* the step at hand: factors of f, of g's x and of g itself on differential rows, x_relation = x_k + cx (x
     * - x_k), and where f and the relation are taken */
    double t1, tr, ht, hk, hg, cx;
    double *z1, *zr;     /* nz */
    const double *guess; /* n: where Newton starts, x_k as a rule */
    double *past;        /* n: h(1-theta) f_k + h(1-gamma) r_k on differential rows */
    /* Newton's loop */
    ns_iterate at, next;
    double *A, *K, *B, *C, *D;     /* at `at`, rows combined */
    double *G;                     /* (n+m)^2: [ W, -h gamma B; C, D ] */
    double *size;                  /* n+m: terms that the residuals are summed from, with a floor */
    double *ext;                   /* n+m: those of them that do not belong to unknowns */
    double *V, *W;                 /* n*m: W^-1 h gamma B;  n*n: W */
    double *Wm, *q;                /* m*m, m: (P1) reduced */
    double *xr, *work;             /* n: x_relation; n*max(n,m)+n+m */
    double *bl, *bu, *sol, *other; /* n+m */
    ns_mode *all_mode;             /* n+m */
    double *spare;                 /* 3n+5m: of the impulse problem */
    int reduced;                   /* W is regular: V, Wm are there */
    ns_lu *lu;
    ns_mlcp_solver *mlcp;
    /* the trial */
    int has_trial;
    ns_mode *trial_mode, *next_mode; /* m */
    ns_newton_counts counts;
    ns_fault fault;
};

/* newton.c: keeps the status in the fault and returns it. */
int ns_newton_fail(ns_newton *s, int status);

/* point.c.  Errors: DIVERGED (the point is outside a domain), NUMBER. */
int ns_newton_values(ns_newton *s, ns_iterate *at); /* f, g, r, h */
int ns_newton_jacobians(ns_newton *s, const ns_iterate *at);
int ns_newton_slope(ns_newton *s);                      /* fk */
void ns_newton_residuals(ns_newton *s, ns_iterate *at); /* R, Ry, from x, y and the values */

/* linearised_lcp.c: G of the Jacobians; the sizes of the terms of both residuals at an iterate, an unknown
 * being no smaller than a share of what it was at the step's start, and no row's size next to nothing beside
 * what the largest unknown of its part of the system makes of it, or of the whole system. */
void ns_newton_form(ns_newton *s);
void ns_newton_sizes(ns_newton *s, const ns_iterate *at, double of_start, int whole);
/* W factored and (P1) reduced to the pairs, where W is regular enough. */
int ns_newton_reduce(ns_newton *s);
/* x, lambda, y of s->next: the linearised problem with all but the part 1-share of the residuals of s->at
 * taken away.  mode (m) goes in and out.  Errors: those of ns_mlcp_solve(); indices in s->fault. */
int ns_newton_solve(ns_newton *s, double share, ns_mode *mode);

/* newton/step.c: sets up a step of length h to t1 with inputs seen from side; needs fk where theta < 1. */
void ns_newton_set(ns_newton *s, double h, double t1, const ns_newton_options *o, ns_side side);

/* loop.c: Newton's loop for the step that is set up, from (x_k, lambda_k) and s->trial_mode.  The
 * answer is in s->at and s->trial_mode.  Errors: DIVERGED, those of ns_mlcp_solve(). */
int ns_newton_loop(ns_newton *s);

#endif
