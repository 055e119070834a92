/* tests/rig/prepared.h - a solver that has read a random problem (P1) and sorted its pairs, for tests of what
 * it works on; equations solved in long double. */
#ifndef PREPARED_H
#define PREPARED_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "mlcp/mlcp_internal.h"

#define INF INFINITY

enum { MAX = 10 };

typedef struct rig {
    ns_mlcp_solver *s;
    int m;
    double W[MAX * MAX], q[MAX], l[MAX], u[MAX];
} rig;

static inline ns_mlcp_solver *begin(rig *r) {
    const ns_mlcp p = {.m = r->m, .W = r->W, .q = r->q, .l = r->l, .u = r->u};
    assert_int_equal(ns_mlcp_create(r->m, &r->s), NS_OK);
    assert_int_equal(ns_mlcp_load(r->s, &p), NS_OK);
    r->s->p = &r->s->given;
    assert_int_equal(ns_mlcp_fetch_all(r->s), NS_OK);
    ns_mlcp_units(r->s);
    ns_mlcp_take_given(r->s);
    return r->s;
}

/* Free, given, complementary and boxed pairs; one W in two is of few entries, so that sums cancel. */
static inline void draw(rig *r, dice *d) {
    const double density = dice_chance(d, 0.5) ? 0.5 : 1;
    r->m = 3 + dice_below(d, MAX - 2);
    for (int i = 0; i < r->m; i++) {
        const int law = dice_below(d, 6);
        r->l[i] = law == 0 || law == 3 ? -INF : law == 1 ? 0.75 : dice_eighths(d, 1);
        r->u[i] = law == 0 ? INF : law == 1 ? 0.75 : law == 2 ? INF : fmax(r->l[i], -2) + 3;
        r->q[i] = dice_eighths(d, 4);
        for (int j = 0; j < r->m; j++)
            r->W[i + j * r->m] = dice_chance(d, density) ? dice_eighths(d, 2) + 3 * (i == j) : 0;
    }
}

/* x (n) := A^-1 x; A is row by row.  1: its smallest pivot is above 1e-3. */
static inline int solve(int n, long double A[MAX + 1][MAX + 1], long double *x) {
    long double least = 1;
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k; i < n; i++)
            p = fabsl(A[i][k]) > fabsl(A[p][k]) ? i : p;
        for (int j = 0; j < n; j++) {
            const long double v = A[k][j];
            A[k][j] = A[p][j];
            A[p][j] = v;
        }
        const long double v = x[k];
        x[k] = x[p];
        x[p] = v;
        least = fminl(least, fabsl(A[k][k]));
        for (int i = 0; i < n && A[k][k] != 0; i++) {
            const long double f = i == k ? 0 : A[i][k] / A[k][k];
            for (int j = k; j < n; j++)
                A[i][j] -= f * A[k][j];
            x[i] -= f * x[k];
        }
    }
    for (int k = 0; k < n; k++)
        x[k] /= A[k][k];
    return least > 1e-3L;
}

/* y = W lambda + q (NULL: 0) where lambda of `in` is solved for and the others are given, y of `held` is
 * given: the rest of both is written.  0: nearly singular. */
static inline int solve_for(int m, const double *W, const double *q, const unsigned char *in,
                            const unsigned char *held, double *lambda, double *y) {
    long double A[MAX + 1][MAX + 1], x[MAX + 1], sum[MAX];
    int row[MAX], column[MAX], rows = 0, columns = 0;
    for (int i = 0; i < m; i++) {
        if (held[i])
            row[rows++] = i;
        if (in[i])
            column[columns++] = i;
        sum[i] = q ? q[i] : 0;
        for (int j = 0; j < m; j++)
            sum[i] += in[j] ? 0 : (long double)W[i + j * m] * lambda[j];
    }
    assert_int_equal(rows, columns);
    for (int i = 0; i < rows; i++) {
        x[i] = y[row[i]] - sum[row[i]];
        for (int j = 0; j < rows; j++)
            A[i][j] = W[row[i] + column[j] * m];
    }
    if (!solve(rows, A, x))
        return 0;
    for (int j = 0; j < rows; j++)
        lambda[column[j]] = (double)x[j];
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < rows; j++)
            sum[i] += x[j] * W[i + column[j] * m];
        y[i] = held[i] ? y[i] : (double)sum[i];
    }
    return 1;
}

#endif
