/* tests/bench/timing.h - the clock of the benchmarks: CPU time of this thread.  Include it first. */
#ifndef NONSMOOTH_TESTS_TIMING_H
#define NONSMOOTH_TESTS_TIMING_H

#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 200809L
#endif
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "nonsmooth/status.h"

/* s */
static inline double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static inline void must(int status) {
    if (status == NS_OK)
        return;
    fprintf(stderr, "benchmark: %s\n", ns_status_text(status));
    exit(1);
}

/* Zeroed, never NULL. */
static inline void *room(size_t bytes) {
    void *p = calloc(1, bytes);
    if (!p)
        must(NS_E_MEMORY);
    return p;
}

static inline int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of n numbers, which get sorted; 0 of none. */
static inline double median(int n, double *a) {
    qsort(a, (size_t)n, sizeof *a, by_value);
    return n > 0 ? a[n / 2] : 0.0;
}

#endif
