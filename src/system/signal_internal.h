/* src/system/signal_internal.h - what the rooms share about signals: deep copies and reasons of refusal. */
#ifndef NS_SYSTEM_SIGNAL_INTERNAL_H
#define NS_SYSTEM_SIGNAL_INTERNAL_H

#include <float.h>
#include <math.h>

#include "nonsmooth/signal.h"

/* PULSE and PWL as broken lines: points (t[i], v[i]), those from `from` on repeated, point i of repetition k
 * at origin + (k period + t[i]). */
typedef struct ns_line {
    int n;
    const double *t, *v; /* n; t non-decreasing, INFINITY allowed */
    double origin;
    double period; /* INFINITY: once */
    int from;      /* first point that repeats */
    double cycles; /* how often, INFINITY: no limit */
    double first;  /* t[from], */
    double last;   /* and a point this much later or more is the first of the next repetition; NAN: none */
} ns_line;

typedef struct ns_pulse_points {
    double t[5], v[5];
} ns_pulse_points;

/* 1 and the line of a PULSE (whose points go to p) or PWL; 0 if s is neither.  It points into s and p. */
int ns_system_signal_line(const ns_signal *s, ns_pulse_points *p, ns_line *g);

/* Times nearer to each other than this, a few roundings, are the same. */
static inline double ns_system_signal_time_error(double t, double origin) {
    const double a = fabs(t), b = fabs(origin);
    return 8 * DBL_EPSILON * (a > b ? a : b);
}

/* Why a parameter was refused: "<parameter> = <value> <must>[ = <than>]". */
typedef struct ns_refusal {
    const char *parameter; /* constant string, NULL if nothing was refused */
    double value;
    const char *must; /* constant string */
    double than;      /* NAN: none */
} ns_refusal;

/* A parameter, refused with this status if broken. */
typedef struct ns_rule {
    int broken;
    int status;
    ns_refusal why;
} ns_rule;

/* The status of the first rule that is broken, and why; NS_OK: none is, and why is left alone. */
int ns_system_signal_check_rules(int count, const ns_rule *rule, ns_refusal *why);

/* ns_signal_check() that also says why; why is left alone on NS_OK. */
int ns_system_signal_check_why(const ns_signal *s, ns_refusal *why);

/* to becomes a copy of from with PWL arrays of its own.  Errors: MEMORY (to is left alone). */
int ns_system_signal_copy(const ns_signal *from, ns_signal *to);

/* Frees the arrays of a copy and makes it a DC signal of 0. */
void ns_system_signal_release(ns_signal *s);

#endif
