/* src/inputs/switch_times.h - a command that is a function of time only: when its switch flips.
 *
 *     g(t) = g0 + sum gz z(t)    closes above on, opens below off
 *
 * Of one broken line the crossings are known piece by piece beforehand, so that the next one is a look into a
 * table.  Of sums of lines they are found piece by piece; where waves are in the sum, by steps that no
 * crossing can be inside of (switch_time_search.c).  A threshold that is passed by no more than rounding was
 * touched: nothing flips.
 */
#ifndef NS_INPUTS_SWITCH_TIMES_H
#define NS_INPUTS_SWITCH_TIMES_H

#include "nonsmooth/system.h"
#include "system/broken_line.h"
#include "waves.h"

/* A control beyond its threshold by less than this, relative to its terms, has not crossed it: rounding. */
#define NS_CONTROL_TOL 1e-12

typedef struct ns_switch_line {
    double factor;
    ns_line_cursor run;
} ns_switch_line;

typedef struct ns_switch_term {
    ns_wave_term term; /* times its factor */
    ns_wave wave;
    double size; /* |(cc, cs)| */
} ns_switch_term;

/* What piece i does to a switch in one state. */
typedef struct ns_switch_flip {
    double t;      /* when it flips, from the start of the repetition; NAN: not in this piece */
    double window; /* how long before it is within rounding of its threshold */
    int later;     /* the next piece of the same repetition that flips this state, 0 if there is none */
} ns_switch_flip;

typedef struct ns_switch_times {
    double on, off, g0;
    double least, most; /* bounds of g */
    int lines, terms;
    ns_switch_line *line;
    ns_switch_term *term;
    ns_switch_flip *flip[2]; /* n+2 each, of the only line, for the switch open and closed; NULL if there is
                               more than one line or a wave */
    int closed;
    int fresh;     /* at t it is in the state that g wants, up to rounding */
    double t;      /* searched up to here, */
    double next;   /* where the switch flips, or up to where it does not; INFINITY: never */
    int flips;     /* which of the two */
    double window; /* how long before next g is within rounding of its threshold */
} ns_switch_times;

/* g and the sizes of its terms, added up; its slope; a bound on its curvature up to a later time. */
typedef struct ns_switch_value {
    double g, size, slope, bend;
} ns_switch_value;

/* The control of command c does not depend on the state. */
static inline int ns_inputs_is_time_only(const ns_system *s, int c) {
    return s->large ? s->large->gx.start[c + 1] == s->large->gx.start[c] : !s->command[c].gx;
}

/* The gains by which inputs enter the control of command c, some of them zero: their number; the q-th. */
static inline int ns_inputs_gains(const ns_system *s, int c) {
    return s->large ? s->large->gz.start[c + 1] - s->large->gz.start[c] : s->command[c].gz ? s->nz : 0;
}

static inline double ns_inputs_gain(const ns_system *s, int c, int q, int *input) {
    const int at = s->large ? s->large->gz.start[c] + q : q;
    *input = s->large ? s->large->gz.row[at] : q;
    return s->large ? s->large->gz.value[at] : s->command[c].gz[q];
}

/* pieces: nz, those of the lines that act on commands; they must outlive the command.  Errors: MEMORY. */
int ns_inputs_switch_create(const ns_system *s, int command, const ns_broken_line *pieces,
                            ns_switch_times *c);
void ns_inputs_switch_free(ns_switch_times *c); /* zeroed and half-built are allowed */

/* The search begins at one side of t, with the switch in a state: if it contradicts g there, it flips at t.
 * closed < 0: as g says there; open between off and on. */
void ns_inputs_switch_seek(ns_switch_times *c, double t, ns_side side, int closed);

/* On from c->next, through the flip if it is one. */
void ns_inputs_switch_on(ns_switch_times *c);

/* The line that decides it alone, from c->next on for ever, again and again; NULL: none does. */
const ns_line_cursor *ns_inputs_switch_repeats(const ns_switch_times *c);

/* On by whole repetitions of that line. */
void ns_inputs_switch_skip(ns_switch_times *c, double repetitions);

/* switch_time_search.c: g at t >= c->t, on the pieces that hold at c->t; the curvature up to a later time. */
ns_switch_value ns_inputs_term_at(const ns_switch_times *c, double t, double later);

/* switch_time_search.c: the smallest tau with  f + rate tau + bend tau^2 / 2 = 0, f <= 0; INFINITY: there is
 * none.
 */
double ns_inputs_switch_step(double f, double rate, double bend);

/* switch_time_search.c: the next flip where there is no table.  c->t is where to go on from, the runs' pieces
 * hold there.
 */
void ns_inputs_switch_search(ns_switch_times *c);

/* By how much g is beyond the threshold that flips the switch. */
static inline double ns_inputs_switch_excess(const ns_switch_times *c, double g, int closed) {
    return closed ? c->off - g : g - c->on;
}

#endif
