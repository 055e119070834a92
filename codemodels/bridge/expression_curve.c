/* bridge/expression_curve.c - tanh, atan and 1/(1 + exp(u)), which comparators and limiters are written with:
 * they end level, so a few straight lines are near them everywhere. */
#include "expression.h"

#include <math.h>
#include <stdio.h>

#include "ngspice/inpptree.h"

/* Of half the way between their ends. */
static const double within = 5e-3;

/* From where on the rest of the way to the end is less than that. */
static const double far_of_tanh = 3.0, far_of_atan = 128.0;

ns_piecewise_value *ns_bridge_expression_curve(ns_extract_walk *w, ns_piecewise *p, double (*f)(double),
                                               const ns_piecewise_value *a) {
    const int is_tanh = f == tanh;
    if (!a)
        return NULL;
    if (!*w->ex->curved)
        snprintf(w->ex->curved, sizeof w->ex->curved, "%.79s", p->name);
    return ns_bridge_piecewise_curve(p, f, is_tanh ? far_of_tanh : far_of_atan,
                                     is_tanh ? within : within * atan((double)INFINITY), a);
}

static int is_exp(const INPparseNode *node) {
    return node && node->type == PT_FUNCTION && node->funcnum == PTF_EXP;
}

/* more exp(u); *more is 1 without a factor. */
static int is_multiple_of_exp(const INPparseNode *node, ns_expression_sigmoid *of) {
    of->more = 1.0;
    if (node && node->type == PT_TIMES) {
        const int first = node->left->type == PT_CONSTANT;
        const INPparseNode *number = first ? node->left : node->right;
        if (number->type != PT_CONSTANT)
            return 0;
        of->more = number->constant;
        node = first ? node->right : node->left;
    }
    of->exponent = is_exp(node) ? node->left : NULL;
    return is_exp(node) && of->more > 0.0;
}

int ns_bridge_expression_is_sigmoid(const INPparseNode *node, ns_expression_sigmoid *of) {
    if (!node || node->type != PT_PLUS)
        return 0;
    const int first = node->left->type == PT_CONSTANT;
    const INPparseNode *one = first ? node->left : node->right;
    if (one->type != PT_CONSTANT || !(one->constant > 0.0))
        return 0;
    of->one = one->constant;
    return is_multiple_of_exp(first ? node->right : node->left, of);
}
