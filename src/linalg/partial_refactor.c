/* src/linalg/partial_refactor.c - factors with pivots chosen once, row by row. */
#include "partial_refactor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/status.h"
#include "packed_triangular_internal.h"
#include "simd.h"

struct ns_partial_lu {
    int n, blocks;
    int *begin;         /* blocks+1 */
    int *row, *to;      /* n: of the matrix, as in the sweep */
    int *l, *u;         /* n+1: row k of L and F, of U, without what is right beside the diagonal */
    int *li, *ui;       /* their columns: of L ascending, and then of F */
    int *f;             /* n: where F begins in row k of L */
    int *below;         /* n: 1 if row k of L has an entry right beside the diagonal; */
    int *above;         /* n: the same of U */
    int *a;             /* n+1: row k of the matrix: */
    int *from;          /* places in its values, */
    int *column;        /* and columns here */
    int *reach;         /* n+1: column k of L: */
    int *reached;       /* its rows */
    int *place;         /* n: where a row of the matrix is here */
    double *x;          /* n: a row */
    unsigned char *due; /* n: rows to be gone through */
};

/* A multiplier no larger than KLU's own pivots allow; what is left of a row whose entries are no larger
 * than 1. */
static const double most_multiplier = 1e3, least_pivot = 1e-9;

/* Numbers of entries, by row in start[row+1], become where each row goes; then, filled, where it begins. */
static void sum_up(int n, int *start) {
    for (int k = 0; k < n; k++)
        start[k + 1] += start[k];
}

static void step_back(int n, int *start) {
    for (int k = n; k > 0; k--)
        start[k] = start[k - 1];
    start[0] = 0;
}

/* The columns of a triangle to rows; side: of the column beside the diagonal, which beside (n) marks. */
static void rows_of(int n, const int *start, const int *row, int side, int count, int *to, int *column,
                    int *beside) {
    for (int k = 0; k < n; k++)
        for (int p = start[k]; p < start[k + 1]; p++) {
            const int i = row[p];
            if (i == k && side)
                continue;
            if (side && k - i == side)
                beside[i] = 1;
            else if (count)
                to[i + 1]++;
            else
                column[to[i]++] = k;
        }
}

static void take_triangles(const ns_triangles *t, ns_partial_lu *s) {
    const int n = s->n;
    for (int count = 1; count >= 0; count--) {
        rows_of(n, t->Lp, t->Li, -1, count, s->l, s->li, s->below);
        for (int k = 0; k < n && !count; k++)
            s->f[k] = s->l[k];
        rows_of(n, t->Fp, t->Fi, 0, count, s->l, s->li, NULL);
        rows_of(n, t->Up, t->Ui, 1, count, s->u, s->ui, s->above);
        if (count) {
            sum_up(n, s->l);
            sum_up(n, s->u);
        }
    }
    step_back(n, s->l);
    step_back(n, s->u);
    for (int k = 0, at = 0; k < n; k++) {
        for (int p = t->Lp[k]; p < t->Lp[k + 1]; p++)
            if (t->Li[p] != k)
                s->reached[at++] = t->Li[p];
        s->reach[k + 1] = at;
    }
}

/* The matrix by rows, in the order of pivots. */
static void take_places(const int *start, const int *row, ns_partial_lu *s) {
    const int n = s->n;
    for (int k = 0; k < n; k++)
        s->place[s->row[k]] = k;
    for (int p = 0; p < start[n]; p++)
        s->a[s->place[row[p]] + 1]++;
    sum_up(n, s->a);
    for (int k = 0; k < n; k++)
        for (int p = start[s->to[k]]; p < start[s->to[k] + 1]; p++) {
            const int at = s->a[s->place[row[p]]]++;
            s->from[at] = p;
            s->column[at] = k;
        }
    step_back(n, s->a);
}

ns_partial_lu *ns_linalg_partial_create(const ns_triangles *t, const int *start, const int *row) {
    const int n = t->n, l = t->Lp[n] + t->Fp[n], u = t->Up[n], all = start[n];
    ns_partial_lu *s = calloc(1, sizeof *s);
    int *ints = calloc((size_t)t->blocks + 10 * (size_t)n + 5 + 2 * (size_t)l + (size_t)u + 2 * (size_t)all,
                       sizeof(int));
    double *x = calloc((size_t)n + 1, sizeof(double));
    unsigned char *due = calloc((size_t)n + 1, 1);
    if (!s || !ints || !x || !due) {
        free(s);
        free(ints);
        free(x);
        free(due);
        return NULL;
    }
    *s = (ns_partial_lu){.n = n, .blocks = t->blocks, .x = x, .due = due};
    s->begin = ns_packed_next(&ints, t->blocks + 1);
    s->row = ns_packed_next(&ints, n);
    s->to = ns_packed_next(&ints, n);
    s->l = ns_packed_next(&ints, n + 1);
    s->u = ns_packed_next(&ints, n + 1);
    s->a = ns_packed_next(&ints, n + 1);
    s->f = ns_packed_next(&ints, n);
    s->below = ns_packed_next(&ints, n);
    s->above = ns_packed_next(&ints, n);
    s->reach = ns_packed_next(&ints, n + 1);
    s->place = ns_packed_next(&ints, n);
    s->reached = ns_packed_next(&ints, l);
    s->li = ns_packed_next(&ints, l);
    s->ui = ns_packed_next(&ints, u);
    s->from = ns_packed_next(&ints, all);
    s->column = ns_packed_next(&ints, all);
    memcpy(s->begin, t->R, sizeof(int) * ((size_t)t->blocks + 1));
    memcpy(s->row, t->P, sizeof(int) * (size_t)n);
    memcpy(s->to, t->Q, sizeof(int) * (size_t)n);
    take_triangles(t, s);
    take_places(start, row, s);
    return s;
}

void ns_linalg_partial_free(ns_partial_lu *s) {
    if (!s)
        return;
    free(s->begin);
    free(s->x);
    free(s->due);
    free(s);
}

size_t ns_linalg_partial_bytes(const ns_partial_lu *s) {
    const size_t n = (size_t)s->n;
    return sizeof(ns_packed_triangular) +
           sizeof(double) * (4 * n + 1 + (size_t)s->l[n] + (size_t)s->u[n] + (size_t)s->a[n]);
}

static ns_packed_triangular *new_sweep(const ns_partial_lu *s) {
    const size_t n = (size_t)s->n;
    ns_packed_triangular *w = calloc(1, sizeof *w);
    double *doubles = calloc(ns_linalg_partial_bytes(s) / sizeof(double), sizeof(double));
    if (!w || !doubles) {
        free(w);
        free(doubles);
        return NULL;
    }
    *w =
        (ns_packed_triangular){.n = s->n, .blocks = s->blocks, .begin = s->begin, .row = s->row, .to = s->to};
    w->l = s->l;
    w->u = s->u;
    w->li = s->li;
    w->ui = s->ui;
    w->scale = doubles;
    w->pivot = w->scale + n;
    w->below = w->pivot + n;
    w->above = w->below + n;
    w->lx = w->above + n;
    w->ux = w->lx + s->l[n];
    w->of = w->ux + s->u[n];
    return w;
}

/* Row k of the matrix is to be gone through if it is not what it was; its scale.  0: it has none. */
static int take_row(const ns_partial_lu *s, const double *value, int k, ns_packed_triangular *w) {
    int differs = 0;
    double sum = 0;
    for (int p = s->a[k]; p < s->a[k + 1]; p++) {
        const double x = value[s->from[p]];
        differs |= w->of[p] != x;
        w->of[p] = x;
        sum += fabs(x);
    }
    w->scale[k] = 1 / sum;
    s->due[k] |= (unsigned char)differs;
    return sum > 0 && sum < INFINITY;
}

static void scatter(const ns_partial_lu *s, const ns_packed_triangular *w, int k) {
    double *x = s->x;
    for (int p = s->l[k]; p < s->l[k + 1]; p++)
        x[s->li[p]] = 0;
    for (int p = s->u[k]; p < s->u[k + 1]; p++)
        x[s->ui[p]] = 0;
    if (s->below[k])
        x[k - 1] = 0;
    if (s->above[k])
        x[k + 1] = 0;
    x[k] = 0;
    for (int p = s->a[k]; p < s->a[k + 1]; p++)
        x[s->column[p]] = w->of[p] * w->scale[k];
}

/* Column c of a row goes, by row c of U; its multiplier. */
static double eliminate(const ns_partial_lu *s, const ns_packed_triangular *w, int c) {
    double *x = s->x;
    const double by = x[c];
    if (by == 0)
        return 0;
    for (int p = s->u[c]; p < s->u[c + 1]; p++)
        x[s->ui[p]] -= by * w->ux[p];
    if (s->above[c])
        x[c + 1] -= by * w->above[c];
    return by * w->pivot[c];
}

/* Whether it is another one from now on. */
static int set(double *to, double x) {
    const int differs = *to != x;
    *to = x;
    return differs;
}

/* Row k anew, and those that it reaches are to be if it is not what it was; 0: its pivot, or a multiplier, is
 * not good enough. */
static int factor_row(ns_partial_lu *s, ns_packed_triangular *w, int k) {
    double *x = s->x, most = 0;
    scatter(s, w, k);
    for (int p = s->l[k]; p < s->f[k]; p++) {
        w->lx[p] = eliminate(s, w, s->li[p]);
        most = ns_higher(fabs(w->lx[p]), most);
    }
    if (s->below[k]) {
        w->below[k] = eliminate(s, w, k - 1);
        most = ns_higher(fabs(w->below[k]), most);
    }
    for (int p = s->f[k]; p < s->l[k + 1]; p++)
        w->lx[p] = x[s->li[p]];
    if (!(most <= most_multiplier && fabs(x[k]) >= least_pivot))
        return 0;
    int differs = set(&w->pivot[k], 1 / x[k]);
    for (int p = s->u[k]; p < s->u[k + 1]; p++)
        differs |= set(&w->ux[p], x[s->ui[p]] * w->pivot[k]);
    if (s->above[k])
        differs |= set(&w->above[k], x[k + 1] * w->pivot[k]);
    for (int p = s->reach[k]; p < s->reach[k + 1] && differs; p++)
        s->due[s->reached[p]] = 1;
    return 1;
}

/* What is due; 0: see above. */
static int factor_rows(ns_partial_lu *s, ns_packed_triangular *w) {
    const unsigned char *at = s->due, *const end = s->due + s->n;
    while ((at = memchr(at, 1, (size_t)(end - at)))) {
        const int k = (int)(at - s->due);
        s->due[k] = 0;
        if (!factor_row(s, w, k))
            return 0;
    }
    return 1;
}

static int finish(ns_partial_lu *s, int good, ns_packed_triangular **sweep) {
    if (good && factor_rows(s, *sweep))
        return 1;
    memset(s->due, 0, (size_t)s->n);
    ns_linalg_packed_free(*sweep);
    *sweep = NULL;
    return 0;
}

int ns_linalg_partial_factor(ns_partial_lu *s, const double *value, ns_packed_triangular **sweep) {
    int good = 1;
    if (!*sweep) {
        *sweep = new_sweep(s);
        if (!*sweep)
            return NS_E_MEMORY;
        memset(s->due, 1, (size_t)s->n);
    }
    for (int k = 0; k < s->n && good; k++)
        good = take_row(s, value, k, *sweep);
    return finish(s, good, sweep) ? NS_OK : NS_E_SINGULAR;
}

int ns_linalg_partial_change(ns_partial_lu *s, const double *value, int rows, const int *row,
                             ns_packed_triangular **sweep) {
    int good = 1;
    for (int i = 0; i < rows && good; i++)
        good = take_row(s, value, s->place[row[i]], *sweep);
    return finish(s, good, sweep);
}
