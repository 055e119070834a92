/* src/linalg/matching.c - scaling by the permutation with the largest product (Olschowka and Neumaier 1996).
 *
 * An assignment problem in the binary exponents: cost_ij = -exponent of a_ij, infinite for 0, solved by
 * shortest augmenting paths (Jonker and Volgenant).  Its duals u_i + v_j <= cost_ij, with equality on the
 * permutation, are the exponents of the scaling.
 */
#include "matching.h"

#include <limits.h>
#include <math.h>

enum { NEVER = INT_MAX };

typedef struct state {
    int n;
    const double *a;
    int *u, *v;  /* n+1 each; rows and columns count from 1, column 0 stands for the row that looks for one */
    int *row_of; /* row matched to a column, 0: none */
    int *from, *to; /* n+1: previous column on the path; distance of a column */
    int *done;
} state;

static int cost(const state *s, int i, int j) {
    int e;
    const double a = s->a[(i - 1) + (j - 1) * s->n];
    if (a == 0)
        return NEVER;
    (void)frexp(a, &e);
    return -e;
}

/* Extends the tree from column at; the nearest column outside gets the next.  Returns 0 if there is none. */
static int nearest(state *s, int at, int *delta) {
    const int i = s->row_of[at];
    int next = 0;
    *delta = NEVER;
    for (int j = 1; j <= s->n; j++) {
        if (s->done[j])
            continue;
        const int c = cost(s, i, j);
        if (c != NEVER && c - s->u[i] - s->v[j] < s->to[j]) {
            s->to[j] = c - s->u[i] - s->v[j];
            s->from[j] = at;
        }
        if (s->to[j] < *delta) {
            *delta = s->to[j];
            next = j;
        }
    }
    return next;
}

static void shift(state *s, int delta) {
    for (int j = 0; j <= s->n; j++) {
        if (s->done[j]) {
            s->u[s->row_of[j]] += delta;
            s->v[j] -= delta;
        } else if (s->to[j] != NEVER) {
            s->to[j] -= delta;
        }
    }
}

static int match_row(state *s, int i) {
    int at = 0;
    s->row_of[0] = i;
    for (int j = 0; j <= s->n; j++) {
        s->to[j] = NEVER;
        s->done[j] = 0;
    }
    while (s->row_of[at] != 0) {
        int delta;
        s->done[at] = 1;
        const int next = nearest(s, at, &delta);
        if (next == 0)
            return 0;
        shift(s, delta);
        at = next;
    }
    while (at != 0) { /* turns the path around */
        const int previous = s->from[at];
        s->row_of[at] = s->row_of[previous];
        at = previous;
    }
    return 1;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): work is written to through s */
int ns_match_scale(int n, const double *a, int *r, int *c, int *work) {
    state s = {n,
               a,
               work,
               work + (n + 1),
               work + 2 * (n + 1),
               work + 3 * (n + 1),
               work + 4 * (n + 1),
               work + 5 * (n + 1)};
    for (int j = 0; j <= n; j++)
        s.u[j] = s.v[j] = s.row_of[j] = 0;
    for (int i = 1; i <= n; i++)
        if (!match_row(&s, i))
            return 0;
    for (int i = 0; i < n; i++) {
        r[i] = s.u[i + 1];
        c[i] = s.v[i + 1];
    }
    return 1;
}
