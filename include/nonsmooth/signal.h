/* nonsmooth/signal.h - sources as functions of time, with SPICE's meaning of their parameters. */
#ifndef NONSMOOTH_SIGNAL_H
#define NONSMOOTH_SIGNAL_H

#include "nonsmooth/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ns_signal_kind { NS_DC, NS_PULSE, NS_SIN, NS_EXP, NS_PWL } ns_signal_kind;

/* A signal; plain data, with the parameters of SPICE.  Values in V or A, times in s.  A function that takes a
 * signal copies the arrays of PWL, which stay the caller's. */
typedef struct ns_signal {
    ns_signal_kind kind;
    union {
        double dc;
        struct {
            double v1, v2;              /* initial and pulsed value */
            double td, tr, tf, pw, per; /* delay, rise, fall (0: a jump), width, period (inf: once) */
            int cycles;                 /* 0: no limit */
        } pulse;
        struct {
            double vo, va;                 /* offset, amplitude; before td: vo + va sin(phase) */
            double freq, td, theta, phase; /* Hz, s, damping in 1/s, degrees */
        } sin;
        struct {
            double v1, v2, td1, tau1, td2, tau2;
        } exp;
        struct {
            int n;               /* points */
            const double *t, *v; /* n; t not decreasing (twice the same: a jump) */
            double repeat;       /* time of the point at which the repetition starts; NAN: no repetition */
            double td;           /* delay */
        } pwl;
    } u;
} ns_signal;

/* The side of a jump. */
typedef enum ns_side { NS_LEFT, NS_RIGHT } ns_side;

/* Checks the parameters.  Errors: NULL, SIZE, NUMBER, RANGE. */
int ns_signal_check(const ns_signal *s);

/* The value at t, from the left or from the right of t. */
double ns_signal_value(const ns_signal *s, double t, ns_side side);

/* The first corner (jump of value or slope) strictly after t; INFINITY if there is none. */
double ns_signal_next_corner(const ns_signal *s, double t);

/* 1 if the signal is a straight line between its corners (DC, PULSE, PWL), 0 if it is curved. */
int ns_signal_is_linear(const ns_signal *s);

#ifdef __cplusplus
}
#endif
#endif
