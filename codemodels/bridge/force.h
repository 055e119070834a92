/* bridge/force.h - makes ngspice's next solve return a given solution exactly. */
#ifndef BRIDGE_FORCE_H
#define BRIDGE_FORCE_H

#include "matrix_columns.h"

typedef struct ns_force_entry {
    double *element; /* of the matrix */
    int row, column; /* ngspice's equation numbers */
} ns_force_entry;

/* One element in each row and each column of a matrix. */
typedef struct ns_force {
    ns_matrix_columns columns;
    ns_force_entry *entry; /* columns.n; NULL: not prepared */
    double *value;         /* by equation number: the solution to be returned */
} ns_force;

/* Chooses the elements; neq: equations of ngspice, whose values are 0 at first.  Returns OK, E_NOMEM, or
 * E_SINGULAR (there is no such choice: *unserved is the equation number of an unknown without a row). */
int ns_bridge_force_prepare(ns_force *f, const SMPmatrix *matrix, int neq, int *unserved);
void ns_bridge_force_clear(ns_force *f);

/* Makes the matrix a permutation, and rhs such that the solution is f->value; all by equation number. */
void ns_bridge_force_apply(const ns_force *f, double *rhs);

#endif
