/* src/newton/newton_internal.h - the Newton stepper from inside. */
#ifndef NS_NEWTON_INTERNAL_H
#define NS_NEWTON_INTERNAL_H

#include "linalg/dense.h"
#include "nonsmooth/newton.h"

/* An iterate.  (y, lambda) always obey (S4); what Newton brings to zero are R and Ry. */
typedef struct ns_iterate {
    double *x, *lambda, *y; /* n, m, m */
    double *f, *g;          /* n: rows combined by T; algebraic rows of f where the relation is taken */
    double *r;              /* n: g as the model gives it */
    double *h;              /* m */
    double *R, *Ry;         /* n, m: residuals of (S1) over the step, of (S3) */
    double *block;          /* where all of them lie */
} ns_iterate;

struct ns_newton {
    /* the model */
    const ns_model *model;
    ns_newton_options o;
    int n, m, rank; /* unknowns, pairs, differential rows */
    double *T, *M;  /* n*n: combines rows, ns_system_split(); T M */

    /* the accepted point: written by state.c alone */
    int started;     /* 1: there is one */
    double t;        /* its time, s */
    double *xk, *rk; /* n: x, r */
    double *lk, *yk; /* m: lambda, y */
    ns_mode *mode;   /* m */

    /* f at t_k, for theta < 1 */
    double *fk; /* n, rows combined */
    int has_fk; /* 1: it is known */

    /* the step at hand */
    double t1, tr;       /* where f and where the relation is taken, s */
    double ht, hk, hg;   /* s: factors of f, of g's x and of g itself on differential rows */
    double cx;           /* the relation is taken at x_k + cx (x - x_k) */
    double *z1, *zr;     /* nz: inputs at t1, tr */
    const double *from;  /* n: x whose charges and fluxes M x the step begins with: x_k but for jumps */
    const double *guess; /* n: where Newton starts, x_k */
    double *past;        /* n: h(1-theta) f_k + h(1-gamma) r_k on differential rows */

    /* Newton's loop */
    ns_iterate at, next;             /* the iterate; the one that a correction leads to */
    ns_mode *trial_mode, *next_mode; /* m: theirs */
    double *A, *K, *B, *C, *D;       /* Jacobians at `at`, rows combined */
    double *G;                       /* (n+m)^2: [ W, -h gamma B; C, D ] */
    double *size;                    /* n+m: sizes of the terms of the residuals, with a floor */
    double *ext;                     /* n+m: of the terms that do not belong to unknowns */
    int reduced;                     /* 1: W is regular, and V, Wm are known */
    double *W, *V;                   /* n*n: W;  n*m: W^-1 h gamma B */
    double *Wm, *q;                  /* m*m, m: (P1) reduced */

    /* the trial: at, trial_mode */
    int has_trial; /* 1: it may be accepted */
    ns_newton_counts counts;
    ns_fault fault; /* of the last call that failed */

    /* work */
    ns_lu *lu;
    ns_mlcp_solver *mlcp;
    double *xr, *work;             /* n: x where the relation is taken;  n*max(n,m)+n+m */
    double *bl, *bu, *sol, *other; /* n+m */
    ns_mode *all_mode;             /* n+m */
    double *spare;                 /* 3n+5m: jump.c's */
};

/* Keeps the status in the fault and returns it. */
static inline int ns_newton_fail(ns_newton *s, int status) {
    s->fault.status = (ns_status)status;
    return status;
}

/* A start, a step or a jump at t begins: there is no trial, and nothing is at fault. */
static inline void ns_newton_begin_trial(ns_newton *s, double t) {
    s->has_trial = 0;
    s->fault.t = t;
    s->fault.npairs = s->fault.nunknowns = 0;
}

/* --- point.c.  Errors: DIVERGED (the point is outside a domain), NUMBER. --- */

/* f, g, r, h of an iterate; the Jacobians there; fk; R and Ry from x, y and the values. */
int ns_newton_values(ns_newton *s, ns_iterate *at);
int ns_newton_jacobians(ns_newton *s, const ns_iterate *at);
int ns_newton_slope(ns_newton *s);
void ns_newton_residuals(ns_newton *s, ns_iterate *at);

/* --- linearised_lcp.c --- */

/* G of the Jacobians. */
void ns_newton_form(ns_newton *s);

/* The sizes of the terms of both residuals at an iterate.  No unknown counts as smaller than a fraction
 * (of_start) of what it was at the step's start; no row's size is negligible beside what the largest unknown
 * of its part of the system contributes to it, or (whole) of the whole system. */
void ns_newton_sizes(ns_newton *s, const ns_iterate *at, double of_start, int whole);

/* W factored and (P1) reduced to the pairs, where W is regular enough. */
int ns_newton_reduce(ns_newton *s);

/* x, lambda, y of s->next: the linearised problem with this fraction of the residuals of s->at taken away.
 * mode (m) goes in and out.  Errors: those of ns_mlcp_solve(); indices in s->fault. */
int ns_newton_solve(ns_newton *s, double fraction, ns_mode *mode);

/* --- step_setup.c --- */

/* Sets up a step of length h to t1 with inputs seen from side; needs fk where theta < 1. */
void ns_newton_set(ns_newton *s, double h, double t1, const ns_newton_options *o, ns_side side);

/* --- loop.c --- */

/* Newton's loop for the step that is set up, from (guess, lambda_k) and s->trial_mode.  The answer is in
 * s->at and s->trial_mode.  Errors: DIVERGED, those of ns_mlcp_solve(). */
int ns_newton_loop(ns_newton *s);

#endif
