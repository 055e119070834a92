/* src/reinit/order_expansion.h - a mode's step as h -> 0: impulses Z1 = (X, Lambda_J), finite values Z0 = (x,
 * lambda_J), rates Z2; all with bounds on their rounding.
 */
#ifndef NS_REINIT_ORDER_EXPANSION_H
#define NS_REINIT_ORDER_EXPANSION_H

#include "linalg/rank_revealing.h"
#include "theta/theta_internal.h"

enum { NS_IMPULSE, NS_VALUE, NS_RATE };

typedef struct ns_order_expansion {
    ns_theta *s; /* the system, and its lu for work */

    /* the left side of the jump */
    long double *w;     /* r: M x */
    double *terms_w;    /* r: sizes of the terms of w */
    ns_mode *left_mode; /* m */
    double *guess;      /* n: where x at Z0 is looked for; zero at first */
    const double
        *near; /* n+m: what the equations do not determine of (x, lambda) is nearest to this; NULL: zero */

    /* (P2) of the mode to be judged, by powers of h */
    ns_mode *mode;        /* m */
    int size, nj;         /* of (P2): n + nj; pairs inside */
    int *inside;          /* nj: these pairs */
    double *K0, *K1, *S0; /* size^2; sizes of the terms of K0 */
    double *R0, *R1;      /* size */
    double *terms;        /* size: sizes of the terms of R0 */

    /* the null spaces of K0 */
    ns_ranked *zero; /* K0 factored */
    double *G, *SG;  /* gap^2, gap: what K0's rank lacks; sizes of the terms of G */
    ns_ranked *gap;  /* G factored */

    /* the answer */
    double *Z1, *Z0, *Z2; /* size: impulses, values, rates */
    double *E1, *E0, *E2; /* size: bounds on their rounding */
    double *at[3];        /* n+m: impulses, values and rates of (x, lambda) */
    double *error[3];     /* n+m: bounds on their rounding */
    int orders;           /* of these that judge a mode: 3, or 2 without rates */
    double *jump[2];      /* n+m: impulses and values of the jump while the mode after it is looked for */

    /* work */
    double *V, *H;      /* size^2 */
    double *v, *rest;   /* n+m */
    double *few, *work; /* 3 (n+m), 5 (n+m) */
    long double *fine;  /* 5 (n+m) */
} ns_order_expansion;

/* For jumps from charges and fluxes w (r) and the accepted mode of s.  Errors: MEMORY (to be freed all the
 * same). */
int ns_reinit_orders_create(ns_theta *s, const double *w, ns_order_expansion *k);
void ns_reinit_orders_free(ns_order_expansion *k);

/* The fastest rate (1/s) at which K1 moves what K0 holds with all pairs inside, 0 if nothing.  Overwrites
 * mode. */
double ns_reinit_orders_rate(ns_order_expansion *k);

/* The answer of the mode; z: inputs, slope: theirs (NULL: none moves).  Errors: SINGULAR (the equations of
 * the mode do not determine or contradict the answer), MEMORY. */
int ns_reinit_orders_expand(ns_order_expansion *k, const double *z, const double *slope);

/* order_solve.c: Z1, Z0, Z2, E1, E0, E2 from (P2).  Errors: those of ns_reinit_orders_expand(). */
int ns_reinit_orders_solve(ns_order_expansion *k);

#endif
