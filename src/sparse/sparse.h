/* src/sparse/sparse.h - the engine for large circuits, for its callers. */
#ifndef NS_SPARSE_H
#define NS_SPARSE_H

#include "engine/engine.h"
#include "engine/kernel.h"

typedef struct ns_sparse_options {
    double h;      /* longest step, s, > 0 */
    double reltol; /* error of a step, relative to the largest charges and fluxes so far; 0: 1e-9 */
    size_t bytes;  /* bound on the memory of kept factors; 0: 64 MiB */
    int finer;     /* lengths of events and transients count from h 2^-finer, not from h */
    double theta;  /* in (0,1]: steps of the theta scheme, all of length h (theta_step.c); 0: of high order */
} ns_sparse_options;

/* The engine, for systems that may be large.  Errors: NULL, RANGE, those of ns_system_check(), MEMORY. */
int ns_sparse_create(const ns_system *s, const ns_sparse_options *o, ns_engine **out, ns_fault *fault);

/* kernel.c: the engine's steps as a kernel.  Errors: those of ns_sparse_create(). */
int ns_sparse_kernel_create(const ns_system *s, const ns_sparse_options *o, ns_kernel **out);

#endif
