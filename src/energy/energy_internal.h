/* src/energy/energy_internal.h - what is known of the elements that are watched.
 *
 *   accumulate.c  sums of charge and energy      run.c  along a marcher      before.c  the point before a
 * start
 */
#ifndef NS_ENERGY_INTERNAL_H
#define NS_ENERGY_INTERNAL_H

#include "circuit/branch.h"
#include "nonsmooth/energy.h"

/* A sum, and what rounding took from it. */
typedef struct ns_sum {
    double sum, lost;
} ns_sum;

/* One element. */
typedef struct ns_watched {
    ns_branch branch;
    int first, terms; /* of its current */
    ns_sum q, joule;  /* C, J; of a capacitor not used */
    double v0, v, i;  /* V, V, A: at the first point; at the last */
} ns_watched;

typedef struct ns_current_term {
    int index; /* of x, or, from `unknowns` on, of lambda */
    double gain;
} ns_current_term;

/* The integrals of i and v i over a part, by the rule of 15 nodes; less those by that of 7. */
typedef struct ns_part_sum {
    double q, joule, q_off, joule_off;
} ns_part_sum;

/* x[found] = x[known] + sign v, v: across element id; -1: the first node of a part. */
typedef struct ns_path_step {
    int id, known, found; /* known: -1: ground */
    double sign;
} ns_path_step;

struct ns_energy {
    const ns_circuit *c;
    int count, unknowns, pairs;
    ns_watched *of;        /* count */
    ns_current_term *term; /* of all */
    long nodes;
    /* path.c */
    int steps;
    ns_path_step *step; /* nodes: of the tree, from ground on */
    double *begin;      /* n: where a jump begins */
    /* run.c */
    double *block;        /* all arrays of numbers below */
    double *point[2];     /* n+m each: x, lambda of the last point; of the next */
    double *between;      /* n+m: between them; the integrals over an instant */
    ns_part_sum *part;    /* count */
    double t;             /* s: of the last point, or how far the way of the trial was taken */
    int at_event;         /* the last point is the left side of an event */
    double joule, charge; /* of all absolute values so far */
};

/* accumulate.c: voltage and current of an element at a point; of a capacitor without rates 0. */
void ns_energy_branch(const ns_energy *e, const ns_watched *w, const ns_solution *at, double *v, double *i);
void ns_energy_sum(ns_sum *to, double value);

/* path.c: the tree, and e->begin.  Errors: MEMORY. */
int ns_energy_path_create(ns_energy *e);
/* x (n) where a jump at t from x0 (n) begins; where the first one begins, by initial conditions. */
void ns_energy_path_begin(ns_energy *e, double t, const double *x0, double *x);
void ns_energy_path_initial(const ns_energy *e, double t, double *x);

#endif
