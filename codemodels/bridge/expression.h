/* bridge/expression.h - the expression of a B source, read as a piecewise linear one. */
#ifndef BRIDGE_EXPRESSION_H
#define BRIDGE_EXPRESSION_H

#include "extract_walk.h"
#include "pure/piecewise.h"

#include "spicelib/devices/asrc/asrcdefs.h"

/* Adds the source with all the kinks and choices that it takes.  Statuses of a reader; factor: on all of it.
 */
int ns_bridge_expression_add(ns_extract_walk *w, GENinstance *inst, double factor);

/* expression_text.c: the expression below a node as a user would write it, cut to size. */
struct INPparseNode;
void ns_bridge_expression_text(const IFparseTree *tree, const struct INPparseNode *node, char *text,
                               size_t size);

/* expression_numbers.c: of ngspice on the expression of a B: temperature and multiplicity. */
double ns_bridge_expression_factor(const GENinstance *inst);
/* expression_numbers.c: its numbers as they are now. */
void ns_bridge_expression_mix(ns_extract_walk *w, const struct INPparseNode *node, int depth);

/* expression_curve.c: f, tanh or atan, of a signal as straight lines; the first one is kept in w->ex. */
ns_piecewise_value *ns_bridge_expression_curve(ns_extract_walk *w, ns_piecewise *p, double (*f)(double),
                                               const ns_piecewise_value *a);
/* one + more exp(exponent), both above 0. */
typedef struct ns_expression_sigmoid {
    double one, more;
    const struct INPparseNode *exponent;
} ns_expression_sigmoid;
int ns_bridge_expression_is_sigmoid(const struct INPparseNode *node, ns_expression_sigmoid *of);

/* expression_steps.c: 1 if the function of this node takes a few values only: u, sgn, a comparison with 0. */
int ns_bridge_expression_is_step(const struct INPparseNode *node);

/* expression_sources.c: the V between this node and ground, if constant of DC alone; *sign: 1: its positive
 * end is the node, else -1.  NULL: there is none. */
const GENinstance *ns_bridge_expression_holder(const ns_extract_walk *w, int node, int constant, int *sign);

/* expression_sources.c: 1 if a V between this node and ground holds it at so many volts all the time, of .op
 * and .dc in a point. */
int ns_bridge_expression_supply(const ns_extract_walk *w, int node, double *volts);

/* expression_sources.c: a node whose voltage is the time, s (made when it is asked for first), that of z
 * (kind: what to call it), or slope t + offset less the integer below it (slope: not 0, 1/s).  Statuses. */
int ns_bridge_expression_time(ns_extract_walk *w, int *node);
int ns_bridge_expression_wave(ns_extract_walk *w, const char *kind, const ns_signal *z, int *node);
/* late: a step at t = 0 is one just after it. */
int ns_bridge_expression_sawtooth(ns_extract_walk *w, double slope, double offset, int late, int *node);
/* The broken line through n points (x, y in turns, x ascending), x = slope t + offset. */
int ns_bridge_expression_line(ns_extract_walk *w, double slope, double offset, int n, const double *xy,
                              int *node);

#endif
