/* src/sparse/low_rank_update.h - (P2) of one mode from the factors of another that differs in a few pairs.
 *
 * Pairs whose law changed are rows of K that changed.  With V the solutions of K V = E, unit vectors in these
 * rows, v = K^-1 r + V mu keeps the equations of all other rows, and mu makes it keep those: one small
 * system.
 */
#ifndef NS_SPARSE_LOW_RANK_UPDATE_H
#define NS_SPARSE_LOW_RANK_UPDATE_H

#include "assemble.h"
#include "linalg/sparse_lu.h"

enum { NS_UPDATE_MOST = 16 }; /* pairs that differ, at most */

typedef struct ns_low_rank {
    const ns_form *f;
    int count;                /* pairs that differ now: 0: the factors are those of the mode */
    int pair[NS_UPDATE_MOST]; /* which, */
    int of[NS_UPDATE_MOST];   /* their columns of V, */
    double c[NS_UPDATE_MOST * NS_UPDATE_MOST]; /* their laws applied to these: its triangles, row by row, */
    int order[NS_UPDATE_MOST];                 /* of its rows */
    int columns, known[NS_UPDATE_MOST];        /* columns of V there are, and of which pairs */
    /* Laws of these pairs applied to these columns, the sizes of their terms, and which laws (0: none yet).
     */
    double law[NS_UPDATE_MOST][NS_UPDATE_MOST], terms[NS_UPDATE_MOST][NS_UPDATE_MOST];
    unsigned char kind[NS_UPDATE_MOST][NS_UPDATE_MOST];
    double *v;     /* NS_UPDATE_MOST + 1 times size; NULL: not needed yet */
    ns_mode *mode; /* m: that it serves */
    int checked;   /* a solution left no more than rounding */
    int served;    /* how often it was asked for in this mode */
} ns_low_rank;

int ns_sparse_update_create(const ns_form *f, ns_low_rank *u); /* Errors: MEMORY */
void ns_sparse_update_free(ns_low_rank *u);

/* New factors, of this mode: nothing differs. */
void ns_sparse_update_reset(ns_low_rank *u, const ns_mode *mode);

/* From factors of the mode `base` to `mode`.  0: it needs factors of its own, as too many pairs differ, or as
 * large terms cancel. */
int ns_sparse_update_to(ns_low_rank *u, ns_klu *klu, ns_factors *factors, double g, const ns_mode *base,
                        const ns_mode *mode);

/* v = K^-1 r in the mode it serves.  seen (size), or NULL: how large unknowns were of late; then 0 is
 * returned if terms far larger than that cancel. */
int ns_sparse_update_solve(const ns_low_rank *u, ns_klu *klu, ns_factors *factors, const ns_mode *base,
                           const double *r, double *v, double *seen);

#endif
