/* bridge/expression_reader.h - reading the parse tree of a B source. */
#ifndef BRIDGE_EXPRESSION_READER_H
#define BRIDGE_EXPRESSION_READER_H

#include "expression.h"

#include "ngspice/inpptree.h"

/* A branch of a choice, where a comparison with 0 has one answer. */
typedef struct expression_branch {
    const INPparseNode *compared;
    int side; /* 1: it is not below 0, -1: it is not above 0 */
    const struct expression_branch *outer;
} expression_branch;

typedef struct expression_reader {
    ns_piecewise_value *(*read)(struct expression_reader *r,
                                const INPparseNode *root); /* a whole expression */
    ns_extract_walk *w;
    const ASRCinstance *b;
    ns_piecewise p;
    const INPparseNode *root;
    const INPparseNode *at; /* the innermost node that failed; NULL: none did */
    int depth;
    int is_inside;                   /* it is the expression of another B, whose node is a factor */
    const expression_branch *branch; /* the innermost one that is being read; NULL: none */
} expression_reader;

/* The value of a node; NULL: p says why. */
ns_piecewise_value *ns_bridge_expression_read(expression_reader *r, const INPparseNode *root);

/* expression_steps.c: a, or, where V that jump between two values, or B that choose between numbers, alone
 * make it, comparisons in its place. */
const ns_piecewise_value *ns_bridge_expression_steps(expression_reader *r, const ns_piecewise_value *a);

/* 1 if a node that b reads is held by a B of which a current, of a V, is not known yet. */
int ns_bridge_expression_steps_wait(const ns_extract_walk *w, const ASRCinstance *b);

/* expression_branch.c: 1 where the condition says that what it compares with 0 is not below that, -1: not
 * above, 0: it says neither. */
int ns_bridge_expression_side(const INPparseNode *condition);
/* The largest value of u where `with` is on that side of 0; INFINITY: any. */
double ns_bridge_expression_most(const ns_affine *u, const ns_affine *with, int side);
/* exp of less is nothing, less the log of what the numbers of the expression may multiply it by: 1e-20. */
static const double ns_bridge_expression_no_exp = -46.0;
/* That log: of the product of all numbers outside of exp that would make it larger; divides: below a
 * division. */
double ns_bridge_expression_log_gain(const INPparseNode *node, int divides);

#endif
