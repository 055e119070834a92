/* src/linalg/sweep.c - packed triangular factors, swept. */
#include "sweep.h"

#include <stdlib.h>

struct ns_sweep {
    int n, out, blocks;
    int *begin;            /* blocks+1: of the unknowns of a block */
    int *row, *to;         /* n: where unknown k takes its right-hand side, and leaves its value */
    int *out_row, *out_to; /* out: the same of those left out */
    int *l, *u;            /* n+1: column k of L (below the diagonal), of U (above it, other blocks too) */
    int *li, *ui;          /* their rows, */
    double *lx, *ux;       /* and values */
    double *scale, *pivot; /* n: the right-hand side is multiplied by; of U, reciprocal */
};

/* Marks rows that others than their own diagonal enter. */
static void mark(int n, const int *start, const int *row, const double *value, int *place) {
    for (int k = 0; k < n; k++)
        for (int p = start[k]; p < start[k + 1]; p++)
            if (row[p] != k && value[p] != 0)
                place[row[p]] = 1;
}

/* place: of each unknown among those that stay, -1: left out. */
static void choose(const ns_triangles *t, ns_sweep *s, int *place) {
    mark(t->n, t->Lp, t->Li, t->Lx, place);
    mark(t->n, t->Up, t->Ui, t->Ux, place);
    mark(t->n, t->Fp, t->Fi, t->Fx, place);
    for (int b = 0; b < t->blocks; b++) {
        s->begin[s->blocks] = s->n;
        for (int k = t->R[b]; k < t->R[b + 1]; k++)
            if (place[k] || t->P[k] < t->often_zero) {
                s->row[s->n] = t->P[k];
                s->to[s->n] = t->Q[k];
                s->scale[s->n] = 1 / t->Rs[k];
                place[k] = s->n++;
            } else {
                s->out_row[s->out] = t->P[k];
                s->out_to[s->out++] = t->Q[k];
                place[k] = -1;
            }
        s->blocks += s->n > s->begin[s->blocks];
    }
    s->begin[s->blocks] = s->n;
}

/* Column k without its diagonal, zeros and what is left out; returns where the next one begins. */
static int append(const int *start, const int *row, const double *value, int k, const int *place, int at,
                  int *to, double *x) {
    for (int p = start[k]; p < start[k + 1]; p++)
        if (row[p] != k && value[p] != 0 && place[row[p]] >= 0) {
            to[at] = place[row[p]];
            x[at++] = value[p];
        }
    return at;
}

static void fill(const ns_triangles *t, ns_sweep *s, const int *place) {
    int l = 0, u = 0;
    for (int k = 0; k < t->n; k++) {
        const int i = place[k];
        if (i < 0)
            continue;
        for (int p = t->Up[k]; p < t->Up[k + 1]; p++)
            if (t->Ui[p] == k)
                s->pivot[i] = 1 / t->Ux[p];
        l = append(t->Lp, t->Li, t->Lx, k, place, l, s->li, s->lx);
        u = append(t->Up, t->Ui, t->Ux, k, place, u, s->ui, s->ux);
        u = append(t->Fp, t->Fi, t->Fx, k, place, u, s->ui, s->ux);
        s->l[i + 1] = l;
        s->u[i + 1] = u;
    }
}

static int *take(int **from, int count) {
    int *first = *from;
    *from += count;
    return first;
}

ns_sweep *ns_sweep_create(const ns_triangles *t) {
    const int n = t->n, lnz = t->Lp[n], unz = t->Up[n] + t->Fp[n];
    const size_t all = (size_t)lnz + (size_t)unz;
    ns_sweep *s = calloc(1, sizeof *s);
    int *ints = calloc(6 * (size_t)n + 3 + (size_t)t->blocks + all, sizeof(int));
    double *doubles = calloc(2 * (size_t)n + 1 + all, sizeof(double));
    int *place = calloc((size_t)n + 1, sizeof(int));
    if (s && ints && doubles && place) {
        s->begin = take(&ints, t->blocks + 1);
        s->row = take(&ints, n);
        s->to = take(&ints, n);
        s->out_row = take(&ints, n);
        s->out_to = take(&ints, n);
        s->l = take(&ints, n + 1);
        s->u = take(&ints, n + 1);
        s->li = take(&ints, lnz);
        s->ui = take(&ints, unz);
        s->scale = doubles;
        s->pivot = s->scale + n;
        s->lx = s->pivot + n;
        s->ux = s->lx + lnz;
        choose(t, s, place);
        fill(t, s, place);
    } else {
        free(s);
        free(ints);
        free(doubles);
        s = NULL;
    }
    free(place);
    return s;
}

void ns_sweep_free(ns_sweep *s) {
    if (!s)
        return;
    free(s->begin);
    free(s->scale);
    free(s);
}

/* x -= x_k times column k. */
static inline void subtract(const int *start, const int *row, const double *value, int k, double *x) {
    const double by = x[k];
    for (int p = start[k]; p < start[k + 1]; p++)
        x[row[p]] -= value[p] * by;
}

int ns_sweep_solve(const ns_sweep *s, double *b, double *x) {
    for (int k = 0; k < s->out; k++)
        if (b[s->out_row[k]] != 0)
            return 0;
    for (int k = 0; k < s->n; k++)
        x[k] = b[s->row[k]] * s->scale[k];
    for (int c = s->blocks - 1; c >= 0; c--) {
        const int first = s->begin[c], last = s->begin[c + 1] - 1;
        for (int k = first; k < last; k++)
            subtract(s->l, s->li, s->lx, k, x);
        for (int k = last; k >= first; k--) {
            x[k] *= s->pivot[k];
            subtract(s->u, s->ui, s->ux, k, x);
        }
    }
    for (int k = 0; k < s->out; k++)
        b[s->out_to[k]] = 0;
    for (int k = 0; k < s->n; k++)
        b[s->to[k]] = x[k];
    return 1;
}
