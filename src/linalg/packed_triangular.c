/* src/linalg/packed_triangular.c - packed triangular factors, swept. */
#include "packed_triangular_internal.h"

#include <stdlib.h>
#include <string.h>

/* Marks rows that others than their own diagonal enter. */
static void mark(int n, const int *start, const int *row, const double *value, int *place) {
    for (int k = 0; k < n; k++)
        for (int p = start[k]; p < start[k + 1]; p++)
            if (row[p] != k && value[p] != 0)
                place[row[p]] = 1;
}

/* place: of each unknown among those that stay, -1: left out. */
static void choose(const ns_triangles *t, ns_packed_triangular *s, int *place) {
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

/* Of U, reciprocal. */
static void take_pivots(const ns_triangles *t, const int *place, double *pivot) {
    for (int k = 0; k < t->n; k++)
        for (int p = t->Up[k]; p < t->Up[k + 1]; p++)
            if (t->Ui[p] == k && place[k] >= 0)
                pivot[place[k]] = 1 / t->Ux[p];
}

typedef struct rows {
    int *start, *column;
    double *value, *beside; /* what is in the column next to the diagonal on this side, */
    int side;               /* which is so far from it; 0: nothing is */
    const double *scale;    /* of rows, or NULL */
} rows;

/* The columns of a triangle, without diagonals, zeros and what is left out, by rows: counted, and filled in
 * at start[row], which then is where the next row starts. */
static void by_rows(int n, const int *start, const int *row, const double *value, const int *place, int count,
                    const rows *to) {
    for (int k = 0; k < n; k++)
        for (int p = start[k]; p < start[k + 1]; p++) {
            const int i = place[row[p]];
            if (row[p] == k || value[p] == 0 || i < 0 || place[k] < 0)
                continue;
            const double x = to->scale ? value[p] * to->scale[i] : value[p];
            if (to->side && place[k] - i == to->side) {
                to->beside[i] = x;
            } else if (count) {
                to->start[i + 1]++;
            } else {
                to->column[to->start[i]] = place[k];
                to->value[to->start[i]++] = x;
            }
        }
}

static void fill(const ns_triangles *t, ns_packed_triangular *s, const int *place) {
    const rows l = {s->l, s->li, s->lx, s->below, -1, NULL}, f = {s->l, s->li, s->lx, NULL, 0, NULL},
               u = {s->u, s->ui, s->ux, s->above, 1, s->pivot};
    take_pivots(t, place, s->pivot);
    for (int count = 1; count >= 0; count--) {
        by_rows(t->n, t->Lp, t->Li, t->Lx, place, count, &l);
        by_rows(t->n, t->Fp, t->Fi, t->Fx, place, count, &f);
        by_rows(t->n, t->Up, t->Ui, t->Ux, place, count, &u);
        for (int k = 0; k < s->n && count; k++) {
            s->l[k + 1] += s->l[k];
            s->u[k + 1] += s->u[k];
        }
    }
    for (int k = s->n; k > 0; k--) {
        s->l[k] = s->l[k - 1];
        s->u[k] = s->u[k - 1];
    }
    s->l[0] = s->u[0] = 0;
}

ns_packed_triangular *ns_linalg_packed_create(const ns_triangles *t) {
    const int n = t->n, lnz = t->Lp[n] + t->Fp[n], unz = t->Up[n];
    const size_t all = (size_t)lnz + (size_t)unz;
    ns_packed_triangular *s = calloc(1, sizeof *s);
    int *ints = malloc((6 * (size_t)n + 3 + (size_t)t->blocks + all) * sizeof(int));
    double *doubles = malloc((4 * (size_t)n + 1 + all) * sizeof(double));
    int *place = calloc((size_t)n + 1, sizeof(int));
    if (s && ints && doubles && place) {
        s->begin = ns_packed_next(&ints, t->blocks + 1);
        s->row = ns_packed_next(&ints, n);
        s->to = ns_packed_next(&ints, n);
        s->out_row = ns_packed_next(&ints, n);
        s->out_to = ns_packed_next(&ints, n);
        s->l = ns_packed_next(&ints, n + 1);
        s->u = ns_packed_next(&ints, n + 1);
        s->li = ns_packed_next(&ints, lnz);
        s->ui = ns_packed_next(&ints, unz);
        s->scale = doubles;
        s->pivot = s->scale + n;
        s->below = s->pivot + n;
        s->above = s->below + n;
        s->lx = s->above + n;
        s->ux = s->lx + lnz;
        memset(s->l, 0, 2 * ((size_t)n + 1) * sizeof(int));  /* and u */
        memset(s->below, 0, 2 * (size_t)n * sizeof(double)); /* and above */
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

void ns_linalg_packed_free(ns_packed_triangular *s) {
    if (!s)
        return;
    if (!s->of)
        free(s->begin);
    free(s->scale);
    free(s);
}

/* What is left of sum after a row's entries times x. */
static inline double without(double sum, const int *column, const double *value, int from, int end,
                             const double *x) {
    for (int p = from; p < end; p++)
        sum -= value[p] * x[column[p]];
    return sum;
}

int ns_linalg_packed_solve(const ns_packed_triangular *s, double *b, double *x) {
    for (int k = 0; k < s->out; k++)
        if (b[s->out_row[k]] != 0)
            return 0;
    for (int c = s->blocks - 1; c >= 0; c--) {
        double last = 0;
        for (int k = s->begin[c]; k < s->begin[c + 1]; k++) {
            const double right = b[s->row[k]] * s->scale[k];
            x[k] = last = without(right, s->li, s->lx, s->l[k], s->l[k + 1], x) - s->below[k] * last;
        }
        last = 0;
        for (int k = s->begin[c + 1] - 1; k >= s->begin[c]; k--) {
            const double right = x[k] * s->pivot[k];
            x[k] = last = without(right, s->ui, s->ux, s->u[k], s->u[k + 1], x) - s->above[k] * last;
        }
    }
    for (int k = 0; k < s->out; k++)
        b[s->out_to[k]] = 0;
    for (int k = 0; k < s->n; k++)
        b[s->to[k]] = x[k];
    return 1;
}
