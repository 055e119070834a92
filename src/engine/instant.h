/* src/engine/instant.h - the integrals of x and lambda over the instants of jumps in a trial: X and Lambda of
 * (J1).
 */
#ifndef NS_ENGINE_INSTANT_H
#define NS_ENGINE_INSTANT_H

#include <string.h>

typedef struct ns_instant {
    int size;    /* of sum: unknowns and pairs */
    long any;    /* 0: sum is zero; else it grows with each jump */
    double *sum; /* x, then lambda: V s, A s */
} ns_instant;

static inline void ns_instant_clear(ns_instant *i) {
    if (i->any)
        memset(i->sum, 0, sizeof *i->sum * (size_t)i->size);
    i->any = 0;
}

/* sum += scale v, from entry `first` on. */
static inline void ns_instant_add(ns_instant *i, int first, int count, double scale, const double *v) {
    for (int k = 0; k < count; k++)
        i->sum[first + k] += scale * v[k];
    i->any++;
}

#endif
