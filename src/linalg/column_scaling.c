/* src/linalg/column_scaling.c - the units of the columns of a matrix, found from its entries.
 *
 * Curtis and Reid ("On the automatic scaling of matrices for Gaussian elimination", 1972): rho, gamma
 * minimise sum over W_ij != 0 of (e_ij + rho_i + gamma_j)^2,    e_ij the binary exponent of W_ij Without
 * rho_i = - mean over row i of (e_ij + gamma_j) this is S gamma = b, S positive semidefinite, which conjugate
 * gradients with the diagonal of counts solve in a few passes over W; what the powers of two in rows and
 * columns are is the same for any units the problem was written in.
 *
 * The mean is no unit where most entries of a row and column are next to nothing beside one (devices that
 * hardly notice each other: 1 on the diagonal, 1e-20 elsewhere): it would make lambda_j 1e10 units.  So no
 * entry may end more than 2^PEAK above the mean (Ruiz, "A scaling algorithm to equilibrate both rows and
 * columns norms in matrices", 2001).
 */
#include "column_scaling.h"
#include "simd.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { ITERATIONS = 40, SWEEPS = 8, PEAK = 10 };

static double exponent(double a) {
    uint64_t bits;
    memcpy(&bits, &a, sizeof bits);
    return (double)((int)(bits >> 52 & 0x7ff) - 1022);
}

typedef struct graph {
    int m;
    const double *W;
    double *rows, *columns; /* m: how many entries */
    double *mean;           /* m: of a row */
    double *list;           /* rows of the entries, column by column; NULL: too many */
} graph;

static void count(graph *g, double *list) {
    const double *end = list + (size_t)NS_UNITS_LIST * (size_t)g->m;
    double *at = list;
    memset(g->rows, 0, (size_t)g->m * sizeof *g->rows);
    for (int j = 0; j < g->m; j++) {
        const double *w = g->W + (size_t)j * (size_t)g->m;
        g->columns[j] = 0.0;
        for (int i = 0; i < g->m; i++) {
            if (w[i] == 0.0)
                continue;
            g->columns[j]++;
            g->rows[i]++;
            if (at < end)
                *at++ = i;
            else
                list = NULL;
        }
    }
    g->list = list;
}

/* v_i += x over column j, whose part of the list is next. */
static void add_column(const graph *g, int j, const double **list, double x, double *v) {
    const double *w = g->W + (size_t)j * (size_t)g->m;
    if (*list)
        for (const double *end = *list + (int)g->columns[j]; *list < end; ++*list)
            v[(int)**list] += x;
    else
        for (int i = 0; i < g->m; i++)
            if (w[i] != 0.0)
                v[i] += x;
}

/* The sum of v_i over column j. */
static double sum_column(const graph *g, int j, const double **list, const double *v) {
    const double *w = g->W + (size_t)j * (size_t)g->m;
    double sum = 0.0;
    if (*list)
        for (const double *end = *list + (int)g->columns[j]; *list < end; ++*list)
            sum += v[(int)**list];
    else
        for (int i = 0; i < g->m; i++)
            if (w[i] != 0.0)
                sum += v[i];
    return sum;
}

static void divide_by_rows(graph *g) {
    for (int i = 0; i < g->m; i++)
        g->mean[i] /= g->rows[i] > 0.0 ? g->rows[i] : 1.0;
}

/* out_j = sum over column j of (gamma_j - mean over row i of gamma_j). */
static void apply(graph *g, const double *gamma, double *out) {
    const double *list = g->list;
    memset(g->mean, 0, (size_t)g->m * sizeof *g->mean);
    for (int j = 0; j < g->m; j++)
        add_column(g, j, &list, gamma[j], g->mean);
    divide_by_rows(g);
    list = g->list;
    for (int j = 0; j < g->m; j++)
        out[j] = g->columns[j] * gamma[j] - sum_column(g, j, &list, g->mean);
}

/* b_j = sum over column j of (mean over row i of e_ij, less e_ij). */
static void right_side(graph *g, double *b) {
    const double *list = g->list;
    memset(g->mean, 0, (size_t)g->m * sizeof *g->mean);
    for (int j = 0; j < g->m; j++) {
        const double *w = g->W + (size_t)j * (size_t)g->m;
        b[j] = 0.0;
        for (int i = 0; i < g->m; i++)
            if (w[i] != 0.0) {
                g->mean[i] += exponent(w[i]);
                b[j] -= exponent(w[i]);
            }
    }
    divide_by_rows(g);
    for (int j = 0; j < g->m; j++)
        b[j] += sum_column(g, j, &list, g->mean);
}

static double dot(const graph *g, const double *r) {
    double sum = 0.0;
    for (int j = 0; j < g->m; j++)
        sum += g->columns[j] > 0.0 ? r[j] * r[j] / g->columns[j] : 0.0;
    return sum;
}

/* S gamma = b, gamma from 0; mean square error in bits below a hundredth. */
static void solve(graph *g, double *gamma, double *r, double *p, double *Sp) {
    size_t bytes = (size_t)g->m * sizeof *gamma;
    memset(gamma, 0, bytes);
    right_side(g, r);
    for (int j = 0; j < g->m; j++)
        p[j] = g->columns[j] > 0.0 ? r[j] / g->columns[j] : 0.0;
    double rr = dot(g, r);
    for (int it = 0; it < ITERATIONS && rr > 1e-4; it++) {
        double pSp = 0.0, before = rr;
        apply(g, p, Sp);
        for (int j = 0; j < g->m; j++)
            pSp += p[j] * Sp[j];
        if (!(pSp > 0.0))
            return;
        for (int j = 0; j < g->m; j++) {
            gamma[j] += before / pSp * p[j];
            r[j] -= before / pSp * Sp[j];
        }
        rr = dot(g, r);
        for (int j = 0; j < g->m; j++)
            p[j] = (g->columns[j] > 0.0 ? r[j] / g->columns[j] : 0.0) + rr / before * p[j];
    }
}

/* rho_i = - mean over row i of (e_ij + gamma_j) */
static void row_units(const graph *g, const double *gamma, double *rho) {
    memset(rho, 0, (size_t)g->m * sizeof *rho);
    for (int j = 0; j < g->m; j++) {
        const double *w = g->W + (size_t)j * (size_t)g->m;
        for (int i = 0; i < g->m; i++)
            if (w[i] != 0.0)
                rho[i] -= (exponent(w[i]) + gamma[j]) / g->rows[i];
    }
}

/* The largest exponents of the rows, in these units, to top, and those of the columns to high. */
static void highest(const graph *g, const double *gamma, const double *rho, double *top, double *high) {
    for (int i = 0; i < g->m; i++)
        top[i] = high[i] = 0.0;
    for (int j = 0; j < g->m; j++) {
        const double *w = g->W + (size_t)j * (size_t)g->m;
        for (int i = 0; i < g->m; i++) {
            if (w[i] == 0.0)
                continue;
            const double e = exponent(w[i]) + rho[i] + gamma[j];
            top[i] = e > top[i] ? e : top[i];
            high[j] = e > high[j] ? e : high[j];
        }
    }
}

/* Takes what stands out more than PEAK down to it, half by the row and half by the column (Ruiz). */
static void lower_peaks(const graph *g, double *gamma, double *rho, double *top, double *high) {
    double most = INFINITY;
    row_units(g, gamma, rho);
    for (int sweep = 0; sweep < SWEEPS && most > 1.0; sweep++) {
        highest(g, gamma, rho, top, high);
        most = 0.0;
        for (int i = 0; i < g->m; i++) {
            const double over = ns_higher(top[i] - PEAK, 0.0);
            rho[i] -= 0.5 * over;
            gamma[i] -= 0.5 * ns_higher(high[i] - PEAK, 0.0);
            most = ns_higher(most, over);
        }
    }
}

void ns_linalg_column_scaling(int m, const double *W, double *unit, double *work) {
    size_t n = (size_t)m;
    graph g = {m, W, work, work + n, work + 2 * n, NULL};
    count(&g, work + 7 * n);
    solve(&g, work + 3 * n, work + 4 * n, work + 5 * n, work + 6 * n);
    lower_peaks(&g, work + 3 * n, work + 4 * n, work + 5 * n, work + 6 * n);
    for (int j = 0; j < m; j++)
        unit[j] = ldexp(1.0, (int)fmin(fmax(rint(work[3 * n + (size_t)j]), -1000.0), 1000.0));
}

/* The row that stands for those joined with row i so far. */
static int root(double *parent, int i) {
    while ((int)parent[i] != i) {
        parent[i] = parent[(int)parent[i]];
        i = (int)parent[i];
    }
    return i;
}

/* Joins the rows in which a column stands; returns how many sets that makes fewer. */
static int join(int m, const double *w, double *parent) {
    int first = 0, fewer = 0;
    while (first < m && w[first] == 0.0)
        first++;
    int to = first < m ? root(parent, first) : 0;
    for (int i = first + 1; i < m; i++) {
        if (w[i] == 0.0)
            continue;
        const int from = root(parent, i);
        fewer += from != to;
        parent[from] = to;
    }
    return fewer;
}

void ns_linalg_spread(int m, const double *W, double *value, double *parent) {
    int sets = m;
    for (int i = 0; i < m; i++)
        parent[i] = i;
    for (int j = 0; j < m && sets > 1; j++)
        sets -= join(m, W + (size_t)j * (size_t)m, parent);
    for (int i = 0; i < m; i++) {
        const int to = root(parent, i);
        value[to] = value[i] > value[to] ? value[i] : value[to];
    }
    for (int i = 0; i < m; i++)
        value[i] = value[root(parent, i)];
}
