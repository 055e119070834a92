/* bridge/matrix_columns.h - the elements of ngspice's matrix by columns, whichever solver holds them. */
#ifndef BRIDGE_MATRIX_COLUMNS_H
#define BRIDGE_MATRIX_COLUMNS_H

#include "ngspice.h"

typedef struct ns_matrix_element {
    double *value; /* in ngspice's matrix */
    int row;       /* index from 0 */
} ns_matrix_element;

typedef struct ns_matrix_columns {
    int n;
    int *begin; /* n + 1: where a column begins in element */
    ns_matrix_element *element;
    int *row_number, *column_number; /* n: ngspice's equation of a row and of a column */
} ns_matrix_columns;

/* OK or E_NOMEM. */
int ns_bridge_matrix_columns_read(ns_matrix_columns *c, const SMPmatrix *matrix);
void ns_bridge_matrix_columns_clear(ns_matrix_columns *c);

#endif
