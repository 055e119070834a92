/* nonsmooth/signal.h - sources as functions of time, with SPICE's meaning of their parameters. */
#ifndef NONSMOOTH_SIGNAL_H
#define NONSMOOTH_SIGNAL_H

#include "nonsmooth/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ns_signal_kind { NS_DC, NS_PULSE, NS_SIN, NS_EXP, NS_PWL } ns_signal_kind;

/* A signal; plain data.  PWL's arrays belong to the caller of the function that takes the signal,
 * which copies them.  Times in s, values in V or A. */
typedef struct ns_signal {
    ns_signal_kind kind;
    union {
        double dc;
        struct {
            double v1, v2, td, tr, tf, pw, per;
            int cycles;
        } pulse; /* tr, tf >= 0 (0: a jump); per = inf: once; cycles 0: no limit */
        struct {
            double vo, va, freq, td, theta, phase;
        } sin; /* phase in degrees; value before td: vo + va sin(phase) */
        struct {
            double v1, v2, td1, tau1, td2, tau2;
        } exp;
        struct {
            int n;
            const double *t, *v;
            double repeat, td;
        } pwl; /* n points; t non-decreasing (twice the same: a jump); repeat: time of the point at which the
                  repetition starts, NAN: no repetition */
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
