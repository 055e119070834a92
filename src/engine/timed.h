/* src/engine/timed.h - a command that is a function of time only: when its switch flips.
 *
 *     g(t) = g0 + sum gz z(t)    closes above on, opens below off
 *
 * Of one broken line the crossings are known piece by piece beforehand, so that the next one is a look into a
 * table.  Of sums of lines they are found piece by piece; where waves are in the sum, by steps that no
 * crossing can be inside of (timed_search.c).  A threshold that is passed by no more than rounding was
 * touched: nothing flips.
 */
#ifndef NS_TIMED_H
#define NS_TIMED_H

#include "nonsmooth/system.h"
#include "system/pieces.h"
#include "system/waves.h"

/* A control beyond its threshold by less than this, relative to its terms, has not crossed it: rounding. */
#define NS_CONTROL_TOL 1e-12

typedef struct ns_timed_line {
    double factor;
    ns_run run;
} ns_timed_line;

typedef struct ns_timed_term {
    ns_wave_term term; /* times its factor */
    ns_wave wave;
    double size; /* |(cc, cs)| */
} ns_timed_term;

/* What piece i does to a switch in one state. */
typedef struct ns_timed_flip {
    double t;      /* when it flips, from the start of the repetition; NAN: not in this piece */
    double window; /* how long before it is within rounding of its threshold */
    int later;     /* the next piece of the same repetition that flips this state, 0 if there is none */
} ns_timed_flip;

typedef struct ns_timed {
    double on, off, g0;
    double least, most; /* bounds of g */
    int lines, terms;
    ns_timed_line *line;
    ns_timed_term *term;
    ns_timed_flip *flip[2]; /* n+2 each, of the only line, for the switch open and closed; NULL if there is
                               more than one line or a wave */
    int closed;
    int fresh;     /* at t it is in the state that g wants, up to rounding */
    double t;      /* searched up to here, */
    double next;   /* where the switch flips, or up to where it does not; INFINITY: never */
    int flips;     /* which of the two */
    double window; /* how long before next g is within rounding of its threshold */
} ns_timed;

/* g and the sizes of its terms, added up; its slope; a bound on its curvature up to a later time. */
typedef struct ns_timed_value {
    double g, size, slope, bend;
} ns_timed_value;

/* pieces: nz, those of the lines that act on commands; they must outlive the command.  Errors: MEMORY. */
int ns_timed_create(const ns_system *s, int command, const ns_pieces *pieces, ns_timed *c);
void ns_timed_free(ns_timed *c); /* zeroed and half-built are allowed */

/* The search begins at one side of t, with the switch in a state: if it contradicts g there, it flips at t.
 * closed < 0: as g says there; open between off and on. */
void ns_timed_seek(ns_timed *c, double t, ns_side side, int closed);

/* On from c->next, through the flip if it is one. */
void ns_timed_on(ns_timed *c);

/* The line that decides it alone, from c->next on for ever, again and again; NULL: none does. */
const ns_run *ns_timed_repeats(const ns_timed *c);

/* On by whole repetitions of that line. */
void ns_timed_skip(ns_timed *c, double repetitions);

/* timed_search.c: g at t >= c->t, on the pieces that hold at c->t; the curvature up to a later time. */
ns_timed_value ns_timed_at(const ns_timed *c, double t, double later);

/* timed_search.c: the smallest tau with  f + rate tau + bend tau^2 / 2 = 0, f <= 0; INFINITY: there is none.
 */
double ns_timed_step(double f, double rate, double bend);

/* timed_search.c: the next flip where there is no table.  c->t is where to go on from, the runs' pieces hold
 * there.
 */
void ns_timed_search(ns_timed *c);

/* By how much g is beyond the threshold that flips the switch. */
static inline double ns_timed_excess(const ns_timed *c, double g, int closed) {
    return closed ? c->off - g : g - c->on;
}

#endif
