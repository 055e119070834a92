/* src/verify/verify_internal.h - the equations of a system as rows, and the sizes that errors are measured
 * by.
 *
 *   quick.c   a point in a hurry      inputs.c  of the system
 *   rows.c    matrices row by row     create.c   the object       sizes.c   what may be off by how much
 *   passive.c whether energy can be judged     aside.c  what is not looked at in a hurry
 *   point.c   (S1) to (S4)            event.c    (J1), (J2), (J4), energy   flow.c   integrals between events
 *   step.c    a step of the theta scheme          memory.c   switches with hysteresis   finding.c  the worst
 * so far
 */
#ifndef NS_VERIFY_INTERNAL_H
#define NS_VERIFY_INTERNAL_H

#include <stddef.h>

#include "verify.h"

/* A matrix row by row.  Its columns are the entries of u: x (n), lambda (m), z (nz), 1. */
typedef struct ns_verify_rows {
    int count;
    int *start; /* count+1 */
    int *column;
    double *value;
    double *size; /* count: the sum of the sizes of the entries of a row, but for its constant */
} ns_verify_rows;

/* A sum, and the sum of the sizes of what it was summed from. */
typedef struct ns_verify_sum {
    double sum, size;
} ns_verify_sum;

/* A piece of an input that is a straight line, after `from` and before `to` (s). */
typedef struct ns_verify_piece {
    double from, to, value, slope;
} ns_verify_piece;

/* Inputs at the time that was looked at last. */
typedef struct ns_verify_inputs {
    ns_verify_piece *piece; /* nz */
    int *moving, movings;   /* nz: which are not constant on their piece */
    double from, to;        /* s: where those that are, are */
} ns_verify_inputs;

/* Most rows of (S3) and most controls: u[plus] - u[minus] + own lambda + constant. */
typedef struct ns_verify_difference {
    int is_one; /* 0: the row is not of this kind */
    int plus, minus;
    double own, constant;
} ns_verify_difference;

/* A pair in a hurry: what it may be off by, by what was learnt when that was prepared. */
typedef struct ns_verify_quick_pair {
    ns_verify_difference y, control;
    double y_off, lambda_off;
    double on, off; /* above, below: the switch is closed, open */
} ns_verify_quick_pair;

typedef struct ns_verify_quick {
    int *plain, plains;         /* m: pairs of 0 <= lambda, y a difference, */
    int *other, others;         /* m: and of other kinds */
    double *row;                /* columns: all algebraic rows that are looked at, weighted and added up */
    double *charge;             /* columns: the same of all charges and fluxes */
    ns_verify_quick_pair *pair; /* m */
    int is_old;                 /* more was learnt since */
    int is_ready;               /* it is prepared, by no larger sizes than those that are right */
} ns_verify_quick;

/* Whether a switch with hysteresis is closed at t, which sources alone control. */
typedef struct ns_verify_memory {
    int is_known_by_sources;
    int closed;       /* -1: it is not known */
    double t, corner; /* s; the next corner of these sources */
} ns_verify_memory;

struct ns_verify {
    const ns_system *s;
    ns_verify_options o;
    /* the equations: A, B, E, b; C, D, F, e; M; gx, gz, g0 */
    ns_verify_rows law, output, charge, control;
    int *command;    /* m: that of a pair; -1: it has none */
    int *algebraic;  /* n: which rows of M are zero, */
    int algebraics;  /* and how many */
    int *is_aside;   /* n: row and unknown of that index depend on inputs alone, and no device on them */
    int *stored;     /* n: which are not */
    int storeds;     /* and how many */
    int is_passive;  /* x' S M x / 2 is an energy that only b, E, e and F add to, */
    double *sign;    /* n: with these signs S */
    double *unit;    /* n: the square root of the largest entry of row i of M: w_i / unit_i is that of an
                        energy; 0: the row has none */
    double *numbers; /* all arrays of numbers */
    /* the largest so far, of points that were right */
    double *most_law;                  /* n: terms of rows of (S1) */
    double *most_w;                    /* n: terms of charges and fluxes */
    double *most_lambda, *most_y;      /* m: of the values; of the terms */
    double *most_control;              /* nc: of the terms */
    double *most_any;                  /* NS_VERIFY_ANY: */
    double *kept;                      /* all of these after the last point that was right */
    int grew;                          /* they are not those that are kept */
    int *is_loose_row, *is_loose_pair; /* n, m: had errors that may be rounding */
    unsigned char *slides;             /* m: of the point judged last: the switch slides; */
    int slidings;                      /* how many do */
    double excused_t;                  /* s, ns_verify_excuse(); NaN: never */
    int *is_excused;                   /* m: at that time */
    double times;                      /* all may be off by so many times as much, */
    double *times_row, *times_pair;    /* n, m: rows of (S1), pairs may be off by so many times as much */
    ns_verify_quick quick;
    ns_verify_inputs inputs;
    ns_verify_memory *memory; /* nc */
    int *by_state, by_states; /* commands of switches with hysteresis that sources alone do not control */
    double t, t_left;         /* s: of u, u_left */
    double most_left;         /* the largest number up to u_left */
    /* work, n+m+nz+1 each */
    double *u, *u_left; /* points; one more number, which is 0 */
    double *w_left;     /* n: charges and fluxes, */
    int has_w_left;     /* where they are known in place of u_left */
    double *spread;     /* 0; by how much inputs differ around the time of u */
    int spreads;        /* they do */
    double *v;          /* NS_VERIFY_NODES: points; or an impulse */
};

/* The largest of all: lambda, y (terms); x, lambda or z, whatever its units; most_w_i / unit_i. */
enum { NS_VERIFY_ANY_LAMBDA, NS_VERIFY_ANY_Y, NS_VERIFY_ANY_NUMBER, NS_VERIFY_ANY_ENERGY, NS_VERIFY_ANY };

static inline size_t ns_verify_columns(const ns_system *s) {
    return (size_t)s->n + (size_t)s->m + (size_t)s->nz + 1;
}

static inline size_t ns_verify_sizes(const ns_system *s) {
    return 2 * (size_t)s->n + 2 * (size_t)s->m + (size_t)s->nc + NS_VERIFY_ANY;
}

/* Nothing found so far at t. */
static inline ns_verify_finding ns_verify_nothing(double t) {
    return (ns_verify_finding){NS_VERIFY_RIGHT, -1, -1, t, 1};
}

/* A quarter more, so that what grows slowly is not kept again each time. */
static inline void ns_verify_grow(ns_verify *v, double *most, double size) {
    if (size > *most) {
        *most = 1.25 * size;
        v->grew = 1;
    }
}

static inline double ns_verify_larger(double a, double b) {
    return a > b ? a : b;
}

/* rows.c: of dense arrays or, if large, sparse matrices.  Errors: MEMORY. */
int ns_verify_rows_create(ns_verify *v);
void ns_verify_rows_free(ns_verify *v);

/* Row i times u. */
static inline ns_verify_sum ns_verify_row(const ns_verify_rows *r, int i, const double *u) {
    ns_verify_sum s = {0, 0};
    for (int k = r->start[i]; k < r->start[i + 1]; k++) {
        const double term = r->value[k] * u[r->column[k]];
        s.sum += term;
        s.size += term < 0 ? -term : term;
    }
    return s;
}

/* passive.c: v->sign, and whether energy can be judged. */
int ns_verify_passive_find(const ns_verify *v);

/* sizes.c: the largest numbers so far, u being a point; the largest terms of a charge. */
void ns_verify_sizes_numbers(ns_verify *v, const double *u);
void ns_verify_sizes_charge(ns_verify *v, int i, double size);
/* What was judged is right, or not: the sizes are kept, or those that are kept are in force again.  An error
 * that may be rounding is none: where it was, what is looked at in a hurry may be off by more from now on.
 * Returns 1: right.
 */
int ns_verify_sizes_end(ns_verify *v, ns_verify_finding *worst);
/* What may be off by how much: the charge of row i; row i of (S1); y of pair j, lambda of it, the latter also
 * by what the rows around it may be off by. */
double ns_verify_sizes_charge_off(const ns_verify *v, int i);
/* The same, where `most` is the largest. */
double ns_verify_sizes_charge_off_of(const ns_verify *v, int i, double most);
double ns_verify_sizes_law_off(const ns_verify *v, int i);
double ns_verify_sizes_held_off(const ns_verify *v, double value); /* an unknown that is held */
double ns_verify_sizes_y_off(const ns_verify *v, int j);
double ns_verify_sizes_lambda_off(const ns_verify *v, int j);
double ns_verify_sizes_control_off(const ns_verify *v, int c);
double ns_verify_sizes_rounding_around(const ns_verify *v, int j);
/* What rounding of the largest numbers, and leaks that engines put where something floats, make of row i. */
double ns_verify_sizes_leak(const ns_verify *v, const ns_verify_rows *r, int i);

/* inputs.c: z (nz), which keeps what it was at the last call. */
void ns_verify_inputs_at(ns_verify *v, double t, ns_side side, double *z);
/* v->spread: by how much they differ around t, which is rounded; 0: not at all. */
int ns_verify_inputs_spread(ns_verify *v, double t);

/* quick.c: the shape of pairs. */
void ns_verify_quick_find(ns_verify *v);
/* aside.c: v->is_aside.  Errors: MEMORY. */
int ns_verify_aside_find(ns_verify *v);

/* event.c: the energy of u is at most that of u_left and what sources may put in in so many seconds. */
void ns_verify_energy_over(ns_verify *v, double seconds, ns_verify_finding *worst);

/* memory.c: nothing is known; 1: closed, 0: open, -1: either, at v->t where its control is g; a switch that
 * changed in an event had to. */
void ns_verify_memory_reset(ns_verify *v);
int ns_verify_memory_at(ns_verify *v, int c, double g);
void ns_verify_memory_event(ns_verify *v, ns_verify_finding *worst);
/* In a hurry: 0: a switch with hysteresis that the state controls may have changed short of its threshold. */
int ns_verify_memory_stays(const ns_verify *v);

/* finding.c: an error becomes the finding, if it is larger than 1 and than that of the one there. */
void ns_verify_note(ns_verify_finding *worst, ns_verify_cause cause, int pair, int unknown, double error);

/* point.c: v->u is this point. */
void ns_verify_fill(ns_verify *v, const ns_verify_state *at);
/* How far (S4) with these bounds is from lambda, y, of what either may be off by. */
double ns_verify_law_error(double l, double u, double lambda, double y, double lambda_off, double y_off);

#endif
