/* src/waveform/waveform_internal.h - the points of a waveform from inside.
 *
 *   waveform.c   made, started; the next point          stretch.c   the marcher's trials: what is smooth
 *   segment.c    how far one straight line reaches      rows.c      values at one instant
 *   deviation.c  how far the waveform is from it        rounding.c  what rounding makes of a signal
 *   sizes.c      the largest values so far
 *
 * A stretch is one trial of the marcher with NS_TO_STEP: a smooth piece of waveform that may be sampled
 * anywhere.  A segment is a straight line between two points with the samples that were looked at on its way
 * (probes).  The segment before the one that is being chosen is pending: where a stretch ended without a
 * bend, both become one.
 */
#ifndef NS_WAVEFORM_INTERNAL_H
#define NS_WAVEFORM_INTERNAL_H

#include "linalg/simd.h"
#include "nonsmooth/waveform.h"

/* NS_WIDE numbers of an array, from the i-th on. */
#define WIDE(p, i) (*(ns_simd_wide *)((p) + (i)))
#define CONST_WIDE(p, i) (*(const ns_simd_wide *)((p) + (i)))

enum {
    NS_PROBES = 42,              /* of a segment, at most, with its two ends */
    NS_ROWS = 3 * NS_PROBES + 5, /* values at one instant, of all segments together */
    NS_CLOSE_EVENTS = 1000000    /* events closer together than points may be, in a row */
};

/* Values at one instant. */
typedef struct ns_probe {
    double t;  /* s */
    double *v; /* n+m: x, lambda; a row of w->rows */
} ns_probe;

typedef struct ns_segment {
    int last;       /* at[0] is where it begins, at[last] where it ends; 0: there is none */
    int jumps;      /* 1: it is a jump: it begins on the left side of it and ends on the right */
    int smooth;     /* 1: a stretch begins with it, and nothing jumps there: it may be one with that before */
    int from_event; /* 1: it begins at an event, or has one on its way */
    ns_probe at[NS_PROBES]; /* ascending */
} ns_segment;

struct ns_waveform {
    const ns_system *s;
    ns_march *march;
    double lines, squares, longest, every, closest, noise; /* options, defaults filled in */

    /* rows */
    size_t count;    /* n + m */
    size_t row_size; /* of a row: x, lambda, one more, integrals, where a segment ends, and what is seen: */
    size_t seen_at;  /* where in it the values that are looked at lie, one after another */
    double *rows;    /* NS_ROWS row_size */
    ns_mode *modes;  /* NS_ROWS m: of the same instants */
    double *unused[NS_ROWS]; /* rows that nobody has */
    int unused_count;        /* how many */

    /* what is looked at */
    int looked;                             /* signals */
    int *signal;                            /* looked: which x or lambda */
    unsigned char *kind;                    /* looked: ascending */
    int kind_end[NS_WAVEFORM_KINDS];        /* signals of this kind and those before: how many */
    double *largest;                        /* looked: absolute value so far */
    double floor[NS_WAVEFORM_KINDS];        /* less does not matter */
    double kind_largest[NS_WAVEFORM_KINDS]; /* of all of a kind */
    double *per_tolerance;                  /* looked: 1 / distance allowed */
    int stale;                              /* 1: a largest value has grown since, or rounding */
    double *rounding;                       /* looked: what it was measured to be off by; 0: not measured */
    int rounding_known;                     /* 1: it was looked for */

    /* integrals of each signal looked at, s times its unit */
    double *since_event, *total; /* of its absolute value: since the last event, since the start */
    double *error;               /* between trapezoids and waveform since the last event, summed up */
    double *own, *own_error;     /* of the segment integrated last: both */
    int integrated;              /* its probes, but for the first; 0: another one was filled since */
    const double *integrated_row[NS_PROBES];
    double integrated_t[NS_PROBES];
    double event_t, start_t; /* s: of the last event, of the start */

    ns_waveform_integrals taken; /* of others; size 0: none */

    /* squares of each signal looked at, s times the square of its unit (unless option squares is 0) */
    double *square, *square_error; /* integral, of which what was before fades; of the trapezoids, beyond what
                                      segments are allowed */
    double square_time;            /* s: the integral of 1, likewise */

    /* the stretch */
    const ns_mode *mode; /* m: that of all of it */
    double *at_end;      /* count: values at its end */
    double *end_values;  /* looked: the same; with squares: the size there or on its way: */
    ns_probe amid;       /* on its way, until it is a probe of a segment; v NULL: none */
    int started, in_stretch;
    int fresh;         /* 1: no segment in it was chosen */
    int is_first;      /* 1: it begins at the last event */
    int after_event;   /* 1: the one before ended at an event */
    double until;      /* s: the last point */
    double end;        /* s: where it ends */
    double before;     /* s: length of the one before; 0: there was none */
    double accepted_t; /* s: the marcher's accepted point */
    double chosen;     /* s: length of the segment that was chosen last */
    double proposal;   /* s: for the next segment */
    int failed;        /* the marcher's error, told after what was computed before */

    /* segments */
    ns_segment made, pending;

    /* counts */
    long points, samples, by_squares;
    long *limits;       /* looked: so often it was what ended a segment */
    long *turned;       /* looked: so often it turned between two segments of a stretch */
    double *slope;      /* looked: of the segment before, its unit / s; 0: none */
    int worst;          /* looked: the signal that was furthest off in the last look; -1: none */
    int squares_decide; /* in that look squares were furthest off */
};

/* A look on the way to a proposed length; not its middle, where an S would not be seen. */
static const double ns_waveform_first_part = 0.45;

/* rows.c: a row that nobody has; given back; all of them. */
double *ns_waveform_take_row(ns_waveform *w);
void ns_waveform_return_row(ns_waveform *w, double *row);
void ns_waveform_return_all_rows(ns_waveform *w);
/* The mode that belongs to a row (m). */
ns_mode *ns_waveform_mode_of(const ns_waveform *w, const double *row);

/* x, lambda and mode at t into a new row.  Errors: those of ns_march_sample(). */
int ns_waveform_sample(ns_waveform *w, double t, double **row);

/* w->amid is of no segment: it is given back. */
void ns_waveform_drop_amid(ns_waveform *w);

/* The same at the end of the stretch, which is known. */
int ns_waveform_sample_end(ns_waveform *w, double **row);

/* The integrals of others: the last trial up to t is taken in; they are as at the end of that, at a row. */
int ns_waveform_take_integrals(ns_waveform *w, double t);
void ns_waveform_put_integrals(ns_waveform *w, double *row);

/* The values of a row that are looked at (looked, and zeros to a multiple of NS_WIDE). */
static inline const double *ns_waveform_seen(const ns_waveform *w, const double *row) {
    return row + w->seen_at;
}

/* sizes.c: what is seen of a row that was filled is put together; takes in the size of a row. */
void ns_waveform_note_row(ns_waveform *w, double *row);
void ns_waveform_note_size(ns_waveform *w, const double *row);
/* deviation.c: how far the waveform is from the line of g: 1: as far as allowed. */
double ns_waveform_distance(ns_waveform *w, const ns_segment *g);
/* The same, and its integral from the trapezoid: 1: as far as allowed. */
double ns_waveform_deviation(ns_waveform *w, const ns_segment *g);
/* The first time at which a signal turns on the way of g: has a peak or a valley that no line shows;
 * INFINITY: none. */
double ns_waveform_first_turn(ns_waveform *w, const ns_segment *g);
/* 1 if two rows differ by more than a tenth of what is allowed. */
int ns_waveform_differ(ns_waveform *w, const double *a, const double *b);
/* An event: integrals begin anew.  A segment is taken in (sign 1) or out (-1). */
void ns_waveform_begin_integrals(ns_waveform *w, double t);
void ns_waveform_add_integrals(ns_waveform *w, const ns_segment *g, double sign);
/* A segment is given out: its slopes, and the integrals since the start. */
void ns_waveform_note_given(ns_waveform *w, const ns_segment *g);

/* rounding.c: samples on the way of the stretch from t to t + most at most, so close together that nothing
 * but rounding tells them from a parabola: what they differ by is allowed too, until it is forgotten. Errors:
 * those of ns_march_sample(). */
int ns_waveform_measure_rounding(ns_waveform *w, double t, double most, int *matters);
void ns_waveform_forget_rounding(ns_waveform *w);

/* segment.c: the longest segment from w->made.at[0], to the end of the stretch at most.  Errors: those of
 * ns_march_sample(). */
int ns_waveform_choose(ns_waveform *w);
/* The pending segment and the one after it become one, if a line is near both: 1. */
int ns_waveform_merge(ns_waveform *w);
/* All rows but the last one are given back. */
void ns_waveform_drop_segment(ns_waveform *w, ns_segment *g);

/* stretch.c: the next stretch, to until at the latest; w->made becomes a jump if something jumps where it
 * begins. Errors: those of ns_march_try(), ns_march_sample(); LIMIT. */
int ns_waveform_enter_stretch(ns_waveform *w, double until);
/* At its end: the marcher accepts it. */
int ns_waveform_leave_stretch(ns_waveform *w);

#endif
