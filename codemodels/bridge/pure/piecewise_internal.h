/* bridge/pure/piecewise_internal.h - what a value is. */
#ifndef BRIDGE_PIECEWISE_INTERNAL_H
#define BRIDGE_PIECEWISE_INTERNAL_H

#include "piecewise.h"

enum { PIECEWISE_NAME = 160 };

struct ns_piecewise_value {
    ns_piecewise_value *next; /* made before it */
    int is_discrete;
    /* discrete */
    int nconditions; /* affine: -1 */
    int condition[PIECEWISE_CONDITIONS];
    double *table; /* 2^nconditions, by the set that holds; affine: the constant */
    /* affine */
    int nterms;
    ns_term *term; /* nterms */
};

/* constant + terms > 0, as a control with its threshold. */
struct ns_piecewise_condition {
    double constant;
    int nterms;
    ns_term *term; /* nterms */
    double threshold;
};

/* A value over conditions (-1: an affine one with room for terms), all zero; keeps the failure, NULL. */
ns_piecewise_value *ns_bridge_piecewise_make(ns_piecewise *p, int nconditions, int nterms);
ns_piecewise_value *ns_bridge_piecewise_fail(ns_piecewise *p, int status, const char *why);

/* piecewise_elements.c: max(u, 0); u where a condition holds, else 0; a as the voltage of a node.  NULL:
 * kept. */
ns_piecewise_value *ns_bridge_piecewise_add_kink(ns_piecewise *p, const ns_piecewise_value *u);
ns_piecewise_value *ns_bridge_piecewise_add_choice(ns_piecewise *p, int condition,
                                                   const ns_piecewise_value *u);
ns_piecewise_value *ns_bridge_piecewise_at_a_node(ns_piecewise *p, const ns_piecewise_value *a);
/* The number of the condition a > 0, which may be there already; -1: kept. */
int ns_bridge_piecewise_find_condition(ns_piecewise *p, const ns_piecewise_value *a);

#endif
