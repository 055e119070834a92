/* nonsmooth/csc.h - a sparse matrix, as a system or a model holds it. */
#ifndef NONSMOOTH_CSC_H
#define NONSMOOTH_CSC_H

/* Column by column: entries start[j] to start[j+1]-1 are those of column j. */
typedef struct ns_csc {
    int rows, columns;
    int *start; /* columns+1 */
    int *row;   /* ascending in each column */
    double *value;
} ns_csc;

#endif
