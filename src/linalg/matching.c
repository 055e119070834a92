/* src/linalg/matching.c - scaling by the permutation with the largest product (Olschowka and Neumaier 1996).
 *
 * An assignment problem in the binary exponents: cost_ij = -exponent of a_ij, infinite for 0, solved by
 * shortest augmenting paths (Jonker and Volgenant).  Its duals u_i + v_j <= cost_ij, with equality on the
 * permutation, are the exponents of the scaling.
 */
#include "matching.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

enum { NEVER = INT_MAX, NONE = SHRT_MAX };

typedef struct path_search {
    int n;
    const short *cost; /* n*n, row by row; NONE: infinite */
    int *u, *v;  /* n+1 each; rows and columns count from 1, column 0 stands for the row that looks for one */
    int *row_of; /* row matched to a column, 0: none */
    int *from, *to; /* n+1: previous column on the path; distance of a column */
    int *done;
} path_search;

static short cost(double a) {
    uint64_t bits;
    int e;
    memcpy(&bits, &a, sizeof bits);
    if ((bits << 1) == 0)
        return NONE;
    e = (int)(bits >> 52 & 0x7ff) - 1022;
    if (e == -1022) /* not normalised */
        (void)frexp(a, &e);
    return (short)-e;
}

/* Extends the tree from column at, which is as far away as *far; the nearest column outside gets the next,
 * and *far its distance.  Returns 0 if there is none.  Nothing comes nearer that is in the tree already. */
static int nearest(path_search *s, int at, int *far) {
    const int n = s->n, i = s->row_of[at], by = *far - s->u[i];
    const short *row = s->cost + (size_t)(i - 1) * (size_t)n - 1;
    int next = 0, least = NEVER;
    for (int j = 1; j <= n; j++) {
        const int to = row[j] == NONE ? NEVER : row[j] + by - s->v[j], nearer = to < s->to[j];
        s->from[j] = nearer ? at : s->from[j];
        s->to[j] = nearer ? to : s->to[j];
        const int open = s->done[j] ? NEVER : s->to[j];
        if (open < least) {
            least = open;
            next = j;
        }
    }
    *far = least;
    return next;
}

/* The duals move by how much nearer a column of the tree was than the one that ends it. */
static void shift(path_search *s, int far) {
    for (int j = 0; j <= s->n; j++)
        if (s->done[j]) {
            s->u[s->row_of[j]] += far - s->to[j];
            s->v[j] -= far - s->to[j];
        }
}

static int match_row(path_search *s, int i) {
    int at = 0, far = 0;
    s->row_of[0] = i;
    for (int j = 0; j <= s->n; j++) {
        s->to[j] = NEVER;
        s->done[j] = 0;
    }
    s->to[0] = 0;
    while (s->row_of[at] != 0) {
        s->done[at] = 1;
        at = nearest(s, at, &far);
        if (at == 0)
            return 0;
    }
    shift(s, far);
    while (at != 0) { /* turns the path around */
        const int previous = s->from[at];
        s->row_of[at] = s->row_of[previous];
        at = previous;
    }
    return 1;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): work is written to through s */
int ns_linalg_match_scale(int n, const double *a, int *r, int *c, short *e, int *work) {
    path_search s = {n,
                     e,
                     work,
                     work + (n + 1),
                     work + 2 * (n + 1),
                     work + 3 * (n + 1),
                     work + 4 * (n + 1),
                     work + 5 * (n + 1)};
    for (int j = 0; j <= n; j++)
        s.u[j] = s.v[j] = s.row_of[j] = 0;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            e[(size_t)j + (size_t)i * (size_t)n] = cost(a[(size_t)i + (size_t)j * (size_t)n]);
    for (int i = 1; i <= n; i++)
        if (!match_row(&s, i))
            return 0;
    for (int i = 0; i < n; i++) {
        r[i] = s.u[i + 1];
        c[i] = s.v[i + 1];
    }
    return 1;
}
