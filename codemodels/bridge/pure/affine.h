/* bridge/pure/affine.h - whether an expression is a constant plus a linear combination of its variables, and
 * which. */
#ifndef BRIDGE_AFFINE_H
#define BRIDGE_AFFINE_H

/* How an expression depends on its variables. */
typedef enum ns_degree { DEGREE_CONSTANT, DEGREE_LINEAR, DEGREE_OTHER } ns_degree;

typedef enum ns_operation {
    OPERATION_SUM,
    OPERATION_PRODUCT,
    OPERATION_QUOTIENT,
    OPERATION_OTHER
} ns_operation;

/* The degree of `left operation right`.  A difference is a sum. */
ns_degree ns_bridge_affine_degree(ns_operation operation, ns_degree left, ns_degree right);

/* An expression of n variables that can be evaluated: returns its value at values (n), and in slopes (n) the
 * derivatives; NAN if it has none there. */
typedef struct ns_expression {
    int n;
    double (*evaluate)(void *context, const double *values, double *slopes);
    void *context;
} ns_expression;

/* constant and slopes (n) of an expression whose degree is at most linear, checked at two points; work: 2n.
 * 0 if it is not linear at these, or has no value. */
int ns_bridge_affine_fit(const ns_expression *e, double *constant, double *slopes, double *work);

#endif
