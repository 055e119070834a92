/* bridge/expression_numbers.c - the numbers of an expression as they are now: what alter changed. */
#include "expression.h"

#include "ngspice/inpptree.h"

enum { DEPTH_MAX = 1000 };

void ns_bridge_expression_mix(ns_extract_walk *w, const INPparseNode *node, int depth) {
    if (!node || depth > DEPTH_MAX)
        return;
    ns_bridge_extract_mix(w, &node->type, sizeof node->type);
    if (node->type == PT_CONSTANT)
        ns_bridge_extract_mix(w, &node->constant, sizeof node->constant);
    if (node->type == PT_CONSTANT || node->type == PT_VAR)
        return;
    ns_bridge_expression_mix(w, node->left, depth + 1);
    ns_bridge_expression_mix(w, node->right, depth + 1);
}

double ns_bridge_expression_factor(const GENinstance *inst) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    const double difference = b->ASRCtemp + b->ASRCdtemp - 300.15;
    double factor = 1.0 + b->ASRCtc1 * difference + b->ASRCtc2 * difference * difference;
    factor = b->ASRCreciproctc == 1 ? 1.0 / factor : factor;
    return b->ASRCreciprocm == 1 ? factor / b->ASRCm : factor * b->ASRCm;
}
