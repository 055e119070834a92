/* tests/rig/flow.c - an event-driven integrator that shares nothing with the library: matrix exponentials.
 */
#include "flow.h"

#include <stdlib.h>
#include <string.h>

/* E = exp(A t) by its series; A t must be small enough for 40 terms (spectral radius up to some 3). */
static void exponential(int n, const double *A, double t, double *E) {
    double term[FLOW_N * FLOW_N] = {0}, next[FLOW_N * FLOW_N];
    for (int i = 0; i < n; i++)
        term[i * n + i] = 1;
    memcpy(E, term, sizeof term);
    for (int k = 1; k <= 40; k++) {
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double sum = 0;
                for (int l = 0; l < n; l++)
                    sum += A[i * n + l] * term[l * n + j];
                next[i * n + j] = sum * t / k;
            }
        memcpy(term, next, sizeof term);
        for (int i = 0; i < n * n; i++)
            E[i] += term[i];
    }
}

void flow_prepare(flow *f) {
    for (int mode = 0; mode < f->modes; mode++) {
        double t = f->dt;
        for (int k = 0; k <= FLOW_LEVELS; k++, t /= 2)
            exponential(f->n, f->A[mode], t, f->E[mode][k]);
    }
}

static void apply(int n, const double *E, const double *x, double *out) {
    for (int i = 0; i < n; i++) {
        out[i] = 0;
        for (int j = 0; j < n; j++)
            out[i] += E[i * n + j] * x[j];
    }
}

/* One dt, cut where modes end. */
static long one(const flow *f, int *mode, double *x) {
    long rest = 1L << FLOW_LEVELS, changes = 0;
    int level = 0;
    while (rest > 0) {
        double out[FLOW_N];
        while (rest < 1L << (FLOW_LEVELS - level))
            level++;
        apply(f->n, f->E[*mode][level], x, out);
        const int next = f->next(*mode, out);
        if (next != *mode && level < FLOW_LEVELS) {
            level++;
            continue;
        }
        rest -= 1L << (FLOW_LEVELS - level);
        memcpy(x, out, sizeof(double) * (size_t)f->n);
        if (next != *mode) {
            if (++changes > 1000)
                abort();
            *mode = next;
            if (f->land)
                f->land(next, x);
            level = 0;
        }
    }
    return changes;
}

long flow_run(const flow *f, long steps, int *mode, double *x) {
    long changes = 0;
    for (long k = 0; k < steps; k++)
        changes += one(f, mode, x);
    return changes;
}
