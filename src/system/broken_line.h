/* src/system/broken_line.h - a broken line (DC, PULSE, PWL) piece by piece, and walking along it.
 *
 * Piece i of repetition k begins at origin + (k period + t), with the value v, and runs with its slope to the
 * value `end` where the next one begins.  Computed from k, nothing drifts.
 */
#ifndef NS_SYSTEM_BROKEN_LINE_H
#define NS_SYSTEM_BROKEN_LINE_H

#include "signal_internal.h"

#include <float.h>

typedef struct ns_line_piece {
    double t, v, slope, end;
} ns_line_piece;

typedef struct ns_broken_line {
    int n;    /* pieces 1..n; 0 is what holds before them, n+1 what holds after the last repetition */
    int from; /* the first that repeats, with the rest of them */
    ns_line_piece *piece; /* n+2; the first and the last are level */
    double origin;
    double period; /* 0: once; piece n holds for ever then */
    double cycles; /* INFINITY: no limit */
} ns_broken_line;

/* The pieces of a signal; constant where it is no broken line.  Errors: MEMORY (nothing to free then). */
int ns_system_line_create(const ns_signal *s, ns_broken_line *p);
void ns_system_line_free(ns_broken_line *p); /* zeroed is allowed */
/* The shortest piece of those signals that are such lines, s, but jumps; INFINITY: none. */
double ns_system_lines_shortest(int count, const ns_signal *s);

/* A place on the line. */
typedef struct ns_line_cursor {
    const ns_broken_line *line;
    double k;
    int i;
    double t;    /* where the piece begins; that of the first one where i is 0 */
    double next; /* where it ends; INFINITY: never */
} ns_line_cursor;

/* To the piece that holds right of t: the last that begins at or before. */
void ns_system_line_seek(ns_line_cursor *r, double t);

/* Past all that begin at or before t. */
void ns_system_line_pass(ns_line_cursor *r, double t);

/* On by whole repetitions, of a line that repeats for ever. */
void ns_system_line_skip(ns_line_cursor *r, double repetitions);

/* The piece after the present one, the repetition it is in; -1: none. */
int ns_system_line_following(const ns_line_cursor *r, double *k);

static inline const ns_line_piece *ns_system_line_piece(const ns_line_cursor *r) {
    return &r->line->piece[r->i];
}

/* It stands where the line repeats, for ever. */
static inline int ns_system_line_repeats(const ns_line_cursor *r) {
    const ns_broken_line *p = r->line;
    return p->period > 0 && p->cycles > DBL_MAX && r->i >= p->from && r->i <= p->n;
}

static inline double ns_system_line_value(const ns_line_cursor *r, double t) {
    const ns_line_piece *p = ns_system_line_piece(r);
    return t > r->t ? p->v + p->slope * (t - r->t) : p->v;
}

#endif
