/* src/linalg/sweep.c - packed triangular factors, swept. */
#include "sweep.h"

/* x -= x_k times column k. */
static inline void take(const int *start, const int *row, const double *value, int k, double *x) {
    const double by = x[k];
    for (int p = start[k]; p < start[k + 1]; p++)
        x[row[p]] -= value[p] * by;
}

static inline void finish(const ns_sweep *s, int k, double *x) {
    if (x[k] == 0) /* as the current of what is open */
        return;
    x[k] *= s->pivot[k];
    take(s->u, s->ui, s->ux, k, x);
}

void ns_sweep_solve(const ns_sweep *s, double *b, double *x) {
    for (int k = 0; k < s->n; k++)
        x[k] = b[s->row[k]] * s->scale[k];
    for (int c = s->blocks - 1; c >= 0; c--) {
        const int first = s->begin[c], last = s->begin[c + 1] - 1;
        for (int k = first; k < last; k++)
            take(s->l, s->li, s->lx, k, x);
        for (int k = last; k >= first; k--)
            finish(s, k, x);
    }
    for (int k = 0; k < s->n; k++)
        b[s->to[k]] = x[k];
}
