/* src/inputs/waves.h - sines and exponentials as multiples of waves that several of them share.
 *
 * A wave is  c + i s = exp((-theta + i 2 pi freq)(t - td)),  and a SIN or EXP
 *     base + sum of its terms,  a term:  before,  and from `from` on  after + cc c + cs s.
 */
#ifndef NS_INPUTS_WAVES_H
#define NS_INPUTS_WAVES_H

#include "system/signal_internal.h"

typedef struct ns_wave {
    double freq, theta, td; /* freq 0: an exponential, s = 0 */
} ns_wave;

typedef struct ns_wave_term {
    int input;   /* whose term it is */
    int wave;    /* which wave */
    double from; /* when it begins: no earlier than td */
    double before, after, cc, cs;
    int jump; /* its value jumps where it begins */
} ns_wave_term;

enum { NS_TERMS = 2 }; /* of one signal, at most */

/* The terms of a signal (input and wave not set), with the wave of each; their number, 0 where it is straight
 * or constant but for *base. */
int ns_inputs_wave_terms(const ns_signal *s, ns_wave_term *term, ns_wave *wave, double *base);

/* The largest rate at which the waves of a signal change, 1/s; 0: it has none. */
double ns_inputs_wave_rate(const ns_signal *s);

/* c and s of a wave at t >= td. */
void ns_inputs_wave_at(const ns_wave *w, double t, double *c, double *s);

#endif
