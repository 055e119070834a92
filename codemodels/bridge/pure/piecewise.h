/* bridge/pure/piecewise.h - piecewise linear expressions of voltages and currents, made of kinks and choices.
 *
 * A value is affine (a constant and terms), or discrete: a table over conditions, each an affine expression
 * that is above zero or not.  Any function of discrete values is discrete; a discrete value times an affine
 * one is a sum of choices.  What is not piecewise linear is refused: NULL, with `why`. */
#ifndef BRIDGE_PIECEWISE_H
#define BRIDGE_PIECEWISE_H

#include "nonsmooth/circuit.h"

enum { PIECEWISE_CONDITIONS = 10 }; /* that one discrete value depends on, at most */

typedef struct ns_piecewise_value ns_piecewise_value;
typedef struct ns_piecewise_condition ns_piecewise_condition;

/* Of one expression; zeroed but for the first fields.  Values belong to it. */
typedef struct ns_piecewise {
    ns_circuit *circuit; /* gets the elements */
    const char *name;    /* of the expression: theirs begin with it */
    int *next_node;      /* the first node number that nobody uses */
    int time_node;       /* node whose voltage is the time; 0: there is none */
    double time_scale;   /* s: how large times are */
    /* --- kept --- */
    int status;          /* of the library, when a function returned NULL: */
    const char *why;     /* NULL: it is status; else what was asked for is not piecewise linear */
    const char *instead; /* what to do then; NULL: the usual */
    int elements;        /* made so far */
    int group;           /* of its choices; 0: there is none yet */
    int nconditions;
    ns_piecewise_condition *condition;
    ns_piecewise_value *values; /* all that were made */
} ns_piecewise;

void ns_bridge_piecewise_free(ns_piecewise *p);

/* Each returns NULL if an argument is NULL. */
ns_piecewise_value *ns_bridge_piecewise_constant(ns_piecewise *p, double value);
/* term: not of a kink or choice. */
ns_piecewise_value *ns_bridge_piecewise_term(ns_piecewise *p, ns_term term);
/* ca a + cb b. */
ns_piecewise_value *ns_bridge_piecewise_sum(ns_piecewise *p, double ca, const ns_piecewise_value *a,
                                            double cb, const ns_piecewise_value *b);
ns_piecewise_value *ns_bridge_piecewise_product(ns_piecewise *p, const ns_piecewise_value *a,
                                                const ns_piecewise_value *b);
ns_piecewise_value *ns_bridge_piecewise_quotient(ns_piecewise *p, const ns_piecewise_value *a,
                                                 const ns_piecewise_value *b);
/* max(a, 0). */
ns_piecewise_value *ns_bridge_piecewise_positive(ns_piecewise *p, const ns_piecewise_value *a);
/* 1 where a > 0, else 0; a within rounding of 0 counts as 0. */
ns_piecewise_value *ns_bridge_piecewise_above(ns_piecewise *p, const ns_piecewise_value *a);
/* a where condition is not 0, else b. */
ns_piecewise_value *ns_bridge_piecewise_choose(ns_piecewise *p, const ns_piecewise_value *condition,
                                               const ns_piecewise_value *a, const ns_piecewise_value *b);
/* f of discrete values. */
ns_piecewise_value *ns_bridge_piecewise_map(ns_piecewise *p, double (*f)(double),
                                            const ns_piecewise_value *a);
ns_piecewise_value *ns_bridge_piecewise_map2(ns_piecewise *p, double (*f)(double, double),
                                             const ns_piecewise_value *a, const ns_piecewise_value *b);
/* The broken line through points (n >= 2) with ascending x, v: x, y in turns; the first and the last piece go
 * on for ever, or (ends_level) are level. */
ns_piecewise_value *ns_bridge_piecewise_line(ns_piecewise *p, const ns_piecewise_value *a, int n,
                                             const double *v, int ends_level);
/* piecewise_curve.c: an odd f that bends one way from 0 to `far` and is nearly level beyond, as chords that
 * are within so much of it; level from there on. */
ns_piecewise_value *ns_bridge_piecewise_curve(ns_piecewise *p, double (*f)(double), double far, double within,
                                              const ns_piecewise_value *a);
/* Their points: x, y in turns, ascending.  xy: room for PIECEWISE_CURVE; returns how many points. */
enum { PIECEWISE_CURVE = 160 };
int ns_bridge_piecewise_chords(double (*f)(double), double far, double within, double *xy);

int ns_bridge_piecewise_is_discrete(const ns_piecewise_value *v);
/* 1 if it is one number, *value. */
int ns_bridge_piecewise_is_constant(const ns_piecewise_value *v, double *value);
/* The value as an affine expression, valid as long as p; 0: p->status. */
int ns_bridge_piecewise_affine(ns_piecewise *p, const ns_piecewise_value *v, ns_affine *out);

#endif
