/* src/reinit/order_expansion.h - a mode's step as h -> 0: impulses Z1 = (X, Lambda_J), finite values Z0 = (x,
 * lambda_J).
 */
#ifndef NS_REINIT_ORDER_EXPANSION_H
#define NS_REINIT_ORDER_EXPANSION_H

#include "linalg/rank_revealing.h"
#include "theta/theta_internal.h"

enum { NS_IMPULSE, NS_VALUE, NS_RATE };

typedef struct ns_order_expansion {
    ns_theta *s;
    int size, nj;          /* of (P2); pairs inside */
    double *K0, *K1, *S0;  /* size^2; sizes of the terms of K0 */
    double *R0, *R1;       /* size */
    double *terms;         /* size: those of R0 */
    double *terms_w;       /* r: those of w */
    double *guess;         /* n: where x at Z0 is looked for; zero at first */
    const double *open;    /* n+m: what the equations leave open of x, lambda is near this; NULL: zero */
    double *Z1, *Z0, *Z2;  /* size: impulses, values, rates */
    double *E1, *E0, *E2;  /* size: bounds on their rounding */
    int orders;            /* of these that decide: 3, or 2 without rates */
    double *at[3];         /* n+m each: impulses, values and rates of (x, lambda) */
    double *off[3];        /* n+m each: bounds on their rounding */
    double *G, *SG;        /* gap^2, gap: what K0's rank lacks; sizes of its terms */
    double *V, *H;         /* size^2, work */
    double *v, *rest;      /* n+m each, work */
    double *few, *work;    /* 3 (n+m), 5 (n+m), work */
    long double *w;        /* r: M x before the jump; ns_reinit_orders_create() takes it from s->w */
    long double *fine;     /* 5 (n+m), work */
    ns_ranked *zero, *gap; /* K0, G */
} ns_order_expansion;

int ns_reinit_orders_create(ns_theta *s, ns_order_expansion *k);
void ns_reinit_orders_free(ns_order_expansion *k);

/* The fastest rate (1/s) at which K1 moves what K0 holds with all pairs inside, 0 if nothing. */
double ns_reinit_orders_rate(ns_order_expansion *k);

/* All levels in s->trial_mode for the past s->w; z: inputs, slope: theirs (NULL: none moves).  Errors:
 * SINGULAR (the equations of the mode do not determine or contradict the answer), MEMORY. */
int ns_reinit_orders_expand(ns_order_expansion *k, const double *z, const double *slope);

/* order_solve.c: Z1, Z0, Z2, E1, E0, E2 from the rest.  Errors: those of ns_reinit_orders_expand(). */
int ns_reinit_orders_solve(ns_order_expansion *k);

#endif
