/* bridge/pure/piecewise_internal.h - what a value is. */
#ifndef BRIDGE_PIECEWISE_INTERNAL_H
#define BRIDGE_PIECEWISE_INTERNAL_H

#include "piecewise.h"

enum { PIECEWISE_NAME = 160, PIECEWISE_TABLE = 1 << PIECEWISE_CONDITIONS };

/* How many times as large as a value the terms of its sum may be: rounding of them is an error of it.  Above
 * the first another sum is looked for, above the second the value is refused. */
#define PIECEWISE_SPREAD_KEPT 1e8
#define PIECEWISE_SPREAD_MAX 1e9

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
    int is_negated; /* it holds where that is 0 */
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
/* The number of the condition that holds where this one does not; -1: kept. */
int ns_bridge_piecewise_negated(ns_piecewise *p, int condition);
/* How large the terms of a are: volts and amperes count as 1, times by their scale. */
double ns_bridge_piecewise_size(const ns_piecewise *p, const ns_piecewise_value *a);

/* piecewise_table.c: a discrete value v as a sum: of each set of its conditions what is added where all of
 * them hold.  Returns v, or where values would be lost in its sum the same with some conditions negated;
 * size: of what it is multiplied by. */
const ns_piecewise_value *ns_bridge_piecewise_table_sum(ns_piecewise *p, const ns_piecewise_value *v,
                                                        double size, double *sum);
/* How many times as large as the smallest of `other` the largest of `base` is; zeros are not counted. */
double ns_bridge_piecewise_beside(const ns_piecewise *p, const ns_piecewise_value *base,
                                  const ns_piecewise_value *other);
ns_piecewise_value *ns_bridge_piecewise_fail_spread(ns_piecewise *p);

#endif
