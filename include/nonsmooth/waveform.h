/* nonsmooth/waveform.h - the points that a waveform needs: straight lines between them are the waveform.
 *
 * Between two points next to each other every x and lambda that is looked at stays within `lines` of the
 * straight line, relative to its largest value so far, and from one event to the next the trapezoids below
 * the lines add up to its integral within `lines` of the integral of its absolute value.  A waveform drives a
 * marcher (nonsmooth/march.h): where nothing bends it has no points, however long that takes.
 */
#ifndef NONSMOOTH_WAVEFORM_H
#define NONSMOOTH_WAVEFORM_H

#include "nonsmooth/march.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ns_waveform ns_waveform;

enum { NS_WAVEFORM_KINDS = 4 };

/* Integrals along the waveform that somebody else takes (energy.h): numbers that every point has. */
typedef struct ns_waveform_integrals {
    int size;   /* numbers */
    void *data; /* for the functions, which return a status */
    /* All begin at the marcher's accepted point; starts: it was just started. */
    int (*begin)(void *data, ns_march *m, int starts);
    /* The trial that m made last, up to t, s; to its end before it is accepted. */
    int (*take)(void *data, ns_march *m, double t);
    void (*read)(void *data, double *sums); /* size: as they are there */
} ns_waveform_integrals;

typedef struct ns_waveform_options {
    double lines;   /* distance from the lines, relative to the largest value so far, in (0,1); 0: 1e-4 */
    double squares; /* the same for the integrals of squares, which trapezoids below straight lines get wrong;
                       0: no matter */
    double longest; /* s between two points, at most; 0: no limit */
    double every;   /* s: points at all multiples of it; 0: none */
    double closest; /* s between two points, at least; the right side of a jump is shown so long after the
                       left */
    double noise;   /* relative to the largest value of its kind: values may be off by that; 0: 1e-12 */
    double floor[NS_WAVEFORM_KINDS]; /* in the unit of each kind (V, A): values may be off by that; 0: none */
    /* n+m: x, then lambda: 0: not looked at; else its kind, 1 to NS_WAVEFORM_KINDS-1: values of one kind have
     * the same unit.  NULL: all are looked at, as one kind. */
    const unsigned char *kind;
    const ns_waveform_integrals *integrals; /* NULL: none */
} ns_waveform_options;

typedef struct ns_waveform_point {
    double t;             /* s */
    int after_jump;       /* 1: the right side of a jump */
    const double *x;      /* n; these three are valid until the next call */
    const double *lambda; /* m */
    const ns_mode *mode;  /* m: on the way to this point */
    const double *sums;   /* integrals up to this point; NULL: none */
} ns_waveform_point;

/* What was given out so far. */
typedef struct ns_waveform_counts {
    long points;     /* all of them */
    long samples;    /* looks at the exact waveform */
    int busiest;     /* the x or (from n on) lambda that asked for most points; -1: none did */
    long by_squares; /* points: squares asked for them */
    double turns;    /* 1/s: how often that one turned between events, over the time between these */
} ns_waveform_counts;

/* Makes a waveform of the marcher m of s; both must outlive it, and so must integrals->data; the rest of the
 * options is copied.  On failure *out is NULL.  Errors: NULL, RANGE (lines, longest, closest, noise, kind),
 * MEMORY. */
int ns_waveform_create(const ns_system *s, ns_march *m, const ns_waveform_options *o, ns_waveform **out);
void ns_waveform_free(ns_waveform *w); /* NULL is allowed */

/* After the marcher was started: its accepted point is the first point.  Errors: NULL, those of
 * ns_march_read() and of integrals->begin(). */
int ns_waveform_start(ns_waveform *w, ns_waveform_point *first);

/* The same in the place of `from`, which ends at that point: values and integrals that it has seen still
 * count as such.  Of systems whose sizes or kinds differ they do not.  `from` may be freed afterwards.
 * Errors: as ns_waveform_start(). */
int ns_waveform_continue(ns_waveform *w, const ns_waveform *from, ns_waveform_point *first);

/* Integrates to t (s) without points; what is there is the next first point.  Errors: those of
 * ns_march_try(). */
int ns_waveform_skip(ns_waveform *w, double t, ns_waveform_point *first);

/* The next point, at until (s) at the latest; the last one is there.  The marcher's accepted point is at most
 * two events ahead.  Errors: STATE (not started), RANGE (until is not later than the last point), those of
 * ns_march_try() and ns_march_sample(): what was computed before is given out first. */
int ns_waveform_next(ns_waveform *w, double until, ns_waveform_point *next);

/* After the marcher refused to go on at a threshold that it watches, or an input of it was replaced at the
 * end of the last point asked for: the next points go on from there.  Errors: NULL, STATE (not started). */
int ns_waveform_resume(ns_waveform *w);

/* From now on no integrals are taken, and points have none (sums is NULL). */
void ns_waveform_drop_integrals(ns_waveform *w);

ns_waveform_counts ns_waveform_read_counts(const ns_waveform *w);

#ifdef __cplusplus
}
#endif
#endif
