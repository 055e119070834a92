/* bridge/analysis.h - what is made for one analysis: ngspice's circuit as read, its system, the marcher, and
 * the point last read from that. */
#ifndef BRIDGE_ANALYSIS_H
#define BRIDGE_ANALYSIS_H

#include "extract.h"
#include "nonsmooth/energy.h"
#include "nonsmooth/waveform.h"
#include "pure/ring.h"

typedef struct ns_taken ns_taken;

typedef struct ns_analysis {
    /* --- made once --- */
    ns_extract ex;
    ns_system *system;
    ns_march *march;       /* NULL: nothing is made */
    ns_waveform *waveform; /* chooses the timepoints; NULL: they are those of a grid, or there are none */
    int edges_are_shown;   /* the plot has a point where each edge of a PULSE ends */
    double h;              /* the longest step of the scheme, s */
    int *unknown;          /* ex.neq: the unknown that an equation stands for, -1: none */
    struct {
        int n;
        int *unknown;  /* n: of the nodes with an .ic */
        double *value; /* n, V */
    } held;

    /* --- the point last read --- */
    size_t count;       /* of x and lambda together */
    double *buffers;    /* 3 count: before, x with lambda, max_abs */
    double *x, *lambda; /* of the system, one after the other */
    double *before;     /* count: both as they were read the time before */
    double *max_abs;    /* count: their largest sizes so far */

    /* --- what the devices show of it (show.c) --- */
    ns_mode *mode;                 /* of the accepted point */
    int changed;                   /* 1 + the pair whose mode changed last; 0: none did */
    ns_taken *taken;               /* charge and energy (taken.c); NULL: nobody asks */
    struct {                       /* many_points.c: of the waveform */
        long points, looked;       /* so far; when they were looked at last */
        double looked_t, expected; /* s, then; points of the whole run */
        double tmax;               /* s: of .tran; 0: none */
        int signal;                /* that asked for most: x or (from n on) lambda */
        ns_ring *ring;             /* follows it; NULL: not wanted */
        int said;
    } many;
    struct {           /* chattering.c: while the scheme is at work */
        ns_mode *mode; /* at the last point; NULL: there was none */
        int *changes;  /* of each pair, */
        int all;       /* of all, */
        double since;  /* since that time, s */
        int said;
    } chatter;
    struct {                  /* own_ring.c: the D whose current came to zero last */
        int own;              /* 1 + its index; 0: none, or that is long ago */
        double until, slope;  /* s; A/s, how fast its current fell */
        double volts, farads; /* by which the voltage across it jumped; what rings by that, as it sees it */
        double amperes;       /* of that ring */
    } ring;
    struct {
        double until, length; /* s: the next point of the waveform; how far the one before it is from that */
    } display;                /* display.c */
    int devices_stale;        /* the devices' static variables are of an earlier point */
} ns_analysis;

/* The mode of the point that is accepted. */
void ns_bridge_analysis_take_mode(ns_analysis *a, const ns_mode *mode);

/* OK, or a code after one line. */
int ns_bridge_analysis_make(CKTcircuit *ckt, ns_extract_sources sources, const ns_own_found *found,
                            ns_analysis *a);
void ns_bridge_analysis_clear(ns_analysis *a);

/* The point of the marcher's last trial, or the accepted one, into x and lambda; *t (may be NULL) gets its
 * time.  A status; after an error all is as it was. */
int ns_bridge_analysis_read(ns_analysis *a, double *t);
void ns_bridge_analysis_unread(ns_analysis *a); /* once: the point read before that */

/* A point of the waveform in place of one of the marcher's, at part (0 to 1) of the way from the point read
 * last; its mode is that of the devices. */
int ns_bridge_analysis_take(ns_analysis *a, const ns_waveform_point *p, double part);

/* 1 if the last two points read differ somewhere by more than `fraction` of the largest size there. */
int ns_bridge_analysis_moved(const ns_analysis *a, double fraction);

/* Why a call of the library failed, in one line. */
void ns_bridge_analysis_explain(const ns_analysis *a, const ns_fault *fault, int status, char *line,
                                size_t size);

#endif
