/* src/sparse/sparse.h - the engine for large circuits, for its callers. */
#ifndef NS_SPARSE_H
#define NS_SPARSE_H

#include "engine/engine.h"
#include "engine/kernel.h"

typedef struct ns_sparse ns_sparse; /* begins with an ns_engine */

typedef struct ns_sparse_options {
    double h;      /* longest step, s, > 0 */
    double reltol; /* error of a step, relative to the largest charges and fluxes so far; 0: 1e-9 */
    size_t bytes;  /* bound on the memory of kept factors; 0: 64 MiB */
    int finer;     /* lengths of events and transients count from h 2^-finer, not from h */
    double theta;  /* in (0,1]: steps of the theta scheme, all of length h (theta_step.c); 0: of high order */
} ns_sparse_options;

/* As the calls of nonsmooth/march.h of the same names; systems may be large. */
int ns_sparse_create(const ns_system *s, const ns_sparse_options *o, ns_sparse **out, ns_fault *fault);
void ns_sparse_free(ns_sparse *m);
int ns_sparse_start(ns_sparse *m, double t0, const double *w0);
/* With switches as in closed (nc; NULL: open) where their controls allow it. */
int ns_sparse_start_as(ns_sparse *m, double t0, const double *w0, const unsigned char *closed);
int ns_sparse_start_dc(ns_sparse *m, double t0, int nhold, const int *hold, const double *hold_x, double *x);
int ns_sparse_try(ns_sparse *m, double t, ns_until until, double *reached);
void ns_sparse_drop(ns_sparse *m); /* the trial */
int ns_sparse_accept(ns_sparse *m);
/* An input of the system was replaced at the accepted point.  Errors: MEMORY, STATE (steps of the scheme). */
int ns_sparse_set_input(ns_sparse *m);
int ns_sparse_read(ns_sparse *m, double *t, double *x, double *lambda, double *y);
int ns_sparse_impulse(ns_sparse *m, double *x, double *lambda); /* arrays may be NULL */
int ns_sparse_sample(ns_sparse *m, double t, double *x, double *lambda);
double ns_sparse_shortest(ns_sparse *m, double t, double *until); /* until is not NULL */
const ns_mode *ns_sparse_mode(const ns_sparse *m);
int ns_sparse_at_event(const ns_sparse *m);
const ns_counts *ns_sparse_counts(ns_sparse *m);
const ns_fault *ns_sparse_fault(const ns_sparse *m);

/* table.c: as ns_sparse_create(), as an engine. */
int ns_sparse_table_create(const ns_system *s, const ns_sparse_options *o, ns_engine **out, ns_fault *fault);

/* kernel.c: the engine's steps as a kernel.  Errors: those of ns_sparse_create(). */
int ns_sparse_kernel_create(const ns_system *s, const ns_sparse_options *o, ns_kernel **out);

#endif
