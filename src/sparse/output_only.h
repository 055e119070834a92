/* src/sparse/output_only.h - unknowns that are only shown: parts of the circuit that hold no charge, no flux
 * and no pair, and on which nothing else depends, as the sources of gates.
 *
 * They are left out of (P2), corners of their inputs end no step, and they are solved for when they are read.
 */
#ifndef NS_SPARSE_OUTPUT_ONLY_H
#define NS_SPARSE_OUTPUT_ONLY_H

#include "linalg/sparse_lu.h"
#include "nonsmooth/system.h"

typedef struct ns_output_only {
    const ns_system *whole;
    ns_system rest; /* what stays; all but its matrices and b are those of the whole */
    ns_large large;
    int count;              /* unknowns that are left out */
    int *unknown, *stays;   /* count; rest.n: which of the whole's these are */
    int *place;             /* n: the index in rest; of one that is left out -1 - its index in unknown */
    unsigned char *balance; /* rest.n */
    double *ground;         /* rest.n */
    double *b, *r;          /* rest.n; count: those left out at the inputs z */
    double *z;              /* nz */
    int *follows;           /* nfollows: which these are */
    int nfollows;
    unsigned char *bent; /* count, and room: 1: it follows one that is no straight line between corners */
    long solves;
    ns_csc A, Et; /* count*count, nz*count */
    ns_klu *klu;
    ns_factors *factors;
} ns_output_only;

/* Errors: MEMORY. */
int ns_sparse_output_create(const ns_system *s, ns_output_only **out);
void ns_sparse_output_free(ns_output_only *a); /* NULL is allowed */

/* x (n) of the whole from what stays, and from inputs z (nz): solved where one that matters has changed. */
void ns_sparse_output_join(ns_output_only *a, const double *rest, const double *z, double *x);

#endif
