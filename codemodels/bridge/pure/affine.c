/* bridge/pure/affine.c - whether an expression is a constant plus a linear combination of its variables, and
 * which. */
#include "affine.h"

#include <math.h>
#include <string.h>

ns_degree ns_bridge_affine_degree(ns_operation operation, ns_degree left, ns_degree right) {
    if (left == DEGREE_CONSTANT && right == DEGREE_CONSTANT)
        return DEGREE_CONSTANT;
    if (operation == OPERATION_SUM ||
        (operation == OPERATION_PRODUCT && (left == DEGREE_CONSTANT || right == DEGREE_CONSTANT)))
        return left > right ? left : right;
    return operation == OPERATION_QUOTIENT && right == DEGREE_CONSTANT ? left : DEGREE_OTHER;
}

/* Is constant + sum slopes*v what the expression gives at v = first, first ratio, first ratio^2 ...? */
static int agrees(const ns_expression *e, double constant, const double *slopes, double first, double ratio,
                  double *work) {
    double expected = constant;
    double size = fabs(constant);
    double v = first;
    double found;
    for (int i = 0; i < e->n; i++, v *= ratio) {
        work[i] = v;
        expected += slopes[i] * v;
        size += fabs(slopes[i] * v);
    }
    found = e->evaluate(e->context, work, work + e->n);
    return fabs(found - expected) <= 1e-9 * size; /* rounding of some 1e6 operations */
}

int ns_bridge_affine_fit(const ns_expression *e, double *constant, double *slopes, double *work) {
    memset(work, 0, (size_t)e->n * sizeof *work);
    *constant = e->evaluate(e->context, work, slopes);
    return isfinite(*constant) && agrees(e, *constant, slopes, 1.0, -1.7, work) &&
           agrees(e, *constant, slopes, -3.1e3, 0.61, work);
}
