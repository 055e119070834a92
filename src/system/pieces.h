/* src/system/pieces.h - a broken line (DC, PULSE, PWL) piece by piece, and walking along it.
 *
 * Piece i of repetition k begins at origin + (k period + t), with the value v, and runs with its slope to the
 * value `end` where the next one begins.  Computed from k, nothing drifts.
 */
#ifndef NS_PIECES_H
#define NS_PIECES_H

#include "system/signal_internal.h"

#include <float.h>

typedef struct ns_piece {
    double t, v, slope, end;
} ns_piece;

typedef struct ns_pieces {
    int n;           /* pieces 1..n; 0 is what holds before them, n+1 what holds after the last repetition */
    int from;        /* the first that repeats, with the rest of them */
    ns_piece *piece; /* n+2; the first and the last are level */
    double origin;
    double period; /* 0: once; piece n holds for ever then */
    double cycles; /* INFINITY: no limit */
} ns_pieces;

/* The pieces of a signal; constant where it is no broken line.  Errors: MEMORY (nothing to free then). */
int ns_pieces_create(const ns_signal *s, ns_pieces *p);
void ns_pieces_free(ns_pieces *p); /* zeroed is allowed */

/* A place on the line. */
typedef struct ns_run {
    const ns_pieces *line;
    double k;
    int i;
    double t;    /* where the piece begins; that of the first one where i is 0 */
    double next; /* where it ends; INFINITY: never */
} ns_run;

/* To the piece that holds right of t: the last that begins at or before. */
void ns_run_seek(ns_run *r, double t);

/* Past all that begin at or before t. */
void ns_run_pass(ns_run *r, double t);

/* On by whole repetitions, of a line that repeats for ever. */
void ns_run_skip(ns_run *r, double repetitions);

/* The piece after the present one, the repetition it is in; -1: none. */
int ns_run_following(const ns_run *r, double *k);

static inline const ns_piece *ns_run_piece(const ns_run *r) {
    return &r->line->piece[r->i];
}

/* It stands where the line repeats, for ever. */
static inline int ns_run_repeats(const ns_run *r) {
    const ns_pieces *p = r->line;
    return p->period > 0 && p->cycles > DBL_MAX && r->i >= p->from && r->i <= p->n;
}

static inline double ns_run_value(const ns_run *r, double t) {
    const ns_piece *p = ns_run_piece(r);
    return t > r->t ? p->v + p->slope * (t - r->t) : p->v;
}

#endif
