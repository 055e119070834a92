/* bridge/expression_branch.c - what the condition of a choice says of the values that its branches count for.
 *
 * A capacitor that saturates is written as v < 5 ? c : 0.99 c exp(-10 v) + 0.01 c: its exp is never more than
 * e^-50. */
#include "expression_reader.h"

#include <math.h>

int ns_bridge_expression_side(const INPparseNode *condition) {
    if (condition->type != PT_FUNCTION)
        return 0;
    switch (condition->funcnum) {
    case PTF_GT0:
    case PTF_GE0:
        return 1;
    case PTF_LT0:
    case PTF_LE0:
        return -1;
    default:
        return 0;
    }
}

/* u = ratio with + a number; NAN: it is not of that form. */
static double ratio_of(const ns_affine *u, const ns_affine *with) {
    double ratio = NAN;
    if (u->nterms != with->nterms)
        return NAN;
    for (int k = 0; k < u->nterms; k++) {
        const ns_term *a = &u->terms[k], *b = &with->terms[k];
        const double here = a->gain / b->gain;
        if (a->is_current != b->is_current || a->of != b->of || (k > 0 && here != ratio))
            return NAN;
        ratio = here;
    }
    return ratio;
}

double ns_bridge_expression_most(const ns_affine *u, const ns_affine *with, int side) {
    const double ratio = ratio_of(u, with);
    return ratio * side < 0.0 ? u->constant - ratio * with->constant : INFINITY;
}

/* Log of what a number below this node may multiply by: at least 0. */
static double log_of(double number) {
    return number > 1.0 ? log(number) : 0.0;
}

double ns_bridge_expression_log_gain(const INPparseNode *node, int divides) {
    if (!node || (node->type == PT_FUNCTION && node->funcnum == PTF_EXP))
        return 0.0;
    switch (node->type) {
    case PT_CONSTANT:
        return node->constant == 0.0 ? 0.0
                                     : log_of(divides ? 1.0 / fabs(node->constant) : fabs(node->constant));
    case PT_FUNCTION:
        return ns_bridge_expression_log_gain(node->left, divides);
    case PT_VAR:
    case PT_TIME:
    case PT_TEMPERATURE:
    case PT_FREQUENCY:
        return 0.0;
    default:
        return ns_bridge_expression_log_gain(node->left, divides) +
               ns_bridge_expression_log_gain(node->right, node->type == PT_DIVIDE ? !divides : divides);
    }
}
