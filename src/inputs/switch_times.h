/* src/inputs/switch_times.h - a command that depends on time only: when its switch flips.
 *
 *     g(t) = g0 + sum gz z(t)    closes above on, opens below off
 *
 * If g is one broken line, the crossings of its pieces are computed beforehand and the next one is read from
 * a table.  Sums of lines are searched piece by piece; sums with waves by steps that cannot contain a
 * crossing (switch_time_search.c).  Where g passes a threshold by rounding only, nothing flips.
 */
#ifndef NS_INPUTS_SWITCH_TIMES_H
#define NS_INPUTS_SWITCH_TIMES_H

#include "nonsmooth/system.h"
#include "system/broken_line.h"
#include "waves.h"

/* A control beyond its threshold by less than this, relative to its terms, has not crossed it: rounding. */
#define NS_CONTROL_TOL 1e-12

typedef struct ns_switch_line {
    double gain;
    ns_line_cursor run;
} ns_switch_line;

typedef struct ns_switch_term {
    ns_wave_term term; /* times the gain */
    ns_wave wave;
    double size; /* |(cc, cs)| */
} ns_switch_term;

/* What piece i of a line does to a switch in one state. */
typedef struct ns_switch_flip {
    double t;      /* s: when it flips, from the start of the repetition; NAN: not in this piece */
    double window; /* s: how long before it g is within rounding of its threshold */
    int later;     /* the next piece of the same repetition that flips this state, 0: none */
} ns_switch_flip;

typedef struct ns_switch_times {
    /* the command */
    double on, off;       /* closes above, opens below */
    double g0;            /* the constant part of g */
    double least, most;   /* bounds of g */
    int lines, terms;     /* how many broken lines and terms of waves g has */
    ns_switch_line *line; /* lines */
    ns_switch_term *term; /* terms */
    /* of a single line and no wave: a table */
    ns_switch_flip *flip[2]; /* n+2 pieces each, for the switch open and closed; else NULL */
    /* where it is */
    int closed; /* the state of the switch from t on */
    int fresh;  /* at t it has just got the state that g wants, up to rounding */
    double t;   /* s: searched up to here */
    /* what comes next */
    double next;   /* s: where the switch flips, or up to where it does not; INFINITY: never */
    int flips;     /* 1: it flips at next */
    double window; /* s: how long before next g is within rounding of its threshold */
} ns_switch_times;

/* g at a time. */
typedef struct ns_switch_control {
    double g;
    double size;        /* the sum of |terms| of g */
    double slope;       /* g' */
    double second_rate; /* a bound of |g''| up to a later time */
} ns_switch_control;

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

/* line: nz, those of the inputs that are lines; they must outlive the command.  Errors: MEMORY. */
int ns_inputs_switch_create(const ns_system *s, int command, const ns_broken_line *line, ns_switch_times *c);
void ns_inputs_switch_free(ns_switch_times *c); /* zeroed and half-built are allowed */

/* The search begins at one side of t, with the switch in a state: if it contradicts g there, it flips at t.
 * closed < 0: the state that g wants there; open between off and on. */
void ns_inputs_switch_seek(ns_switch_times *c, double t, ns_side side, int closed);

/* To the right side of c->next: the switch has flipped if c->flips, and the search continues. */
void ns_inputs_switch_pass(ns_switch_times *c);

/* The line that alone decides all flips from c->next on, by repeating for ever; NULL: none does. */
const ns_line_cursor *ns_inputs_switch_repeats(const ns_switch_times *c);

/* On by whole repetitions of that line. */
void ns_inputs_switch_skip(ns_switch_times *c, double repetitions);

/* switch_time_search.c: g at t >= c->t, by the pieces and terms that hold at c->t; its second rate is bounded
 * up to `later`. */
ns_switch_control ns_inputs_switch_control(const ns_switch_times *c, double t, double later);

/* switch_time_search.c: the next flip after c->t where there is no table; cursors are at c->t. */
void ns_inputs_switch_search(ns_switch_times *c);

/* By how much g is beyond the threshold that flips the switch. */
static inline double ns_inputs_switch_excess(const ns_switch_times *c, double g, int closed) {
    return closed ? c->off - g : g - c->on;
}

#endif
