/* src/linalg/row_split.c - which rows of M x' = ... are differential, which algebraic.
 *
 * Gaussian elimination with complete pivoting on the equilibrated M.  Every entry carries a bound of the
 * rounding it may contain, in units of eps; an entry within 64 of these counts as zero, so cancelled entries
 * go while a pF beside a mF stays.  The rows that gave pivots are the differential ones and enter T as they
 * are.  Every other row i gives a left null vector of M, the multipliers that eliminated it:
 *     T row = e_i + sum over pivot rows of t_j e_j.
 * For capacitors alone the t_j are integers (KCL summed over what floats); the nearest integers are taken
 * where they annul M as well.  T M is therefore zero in rows r..n-1 up to rounding of the sums, and whoever
 * forms it puts exact zeros there: nothing but rounding is dropped.
 *
 * Which of the rows of a floating part becomes their sum is free.  The charge of the row that does is what
 * the others leave, with the rounding of all that flows in these: 1e-10 of 1600 A through the diodes at one
 * end of a snubber is more than the snubber carries.  So, where it is known how much flows in the rows, those
 * in which little flows are pivots.  A row of several branches does not take the place of one of a single
 * branch for that: what is left of its rounded sum at a megavolt is charge from nowhere
 * (tests/property/test_jumps.c).
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/status.h"
#include "row_split.h"

typedef struct elimination {
    int n, rank;
    double *a;          /* n*n, what is left of M */
    double *err;        /* n*n, bound of its rounding over eps */
    double *t;          /* n*n, row combinations so far: a = t R M C */
    double *r, *c;      /* n, scales of rows and columns, powers of two */
    int *row;           /* n, 1: gave a pivot */
    int *column;        /* n, 1: pivoted */
    double *most;       /* n, the largest entry of a column that may be a pivot; 0: there is none */
    int *most_row;      /* n, the first row that it is in */
    double *by, *slop;  /* n, work: what is subtracted from a row, of the pivot's; the rounding of that */
    const double *flow; /* n, how much flows in a row; NULL: not known */
} elimination;

static const double eps_factor = 64 * DBL_EPSILON;
/* Multipliers this near to integers are tried as integers: a pivot may be as small as 64 roundings, so that a
 * multiplier is wrong by a 64th, and one that passed several such pivots by more. */
static const double near = 0.25;
/* A pivot of this part of the largest one is as good; so much less flows in a row that is taken for that. */
static const double as_large = 1.0 / 16, much_less = 1.0 / 256;

static size_t ij(int n, int i, int j) {
    return (size_t)i + (size_t)j * (size_t)n;
}

static int begin(elimination *g, int n) {
    size_t nn = (size_t)n * (size_t)n;
    memset(g, 0, sizeof *g);
    g->n = n;
    g->a = calloc(3 * nn, sizeof(double));
    g->r = calloc(5 * (size_t)n, sizeof(double));
    g->row = calloc(3 * (size_t)n, sizeof(int));
    if (!g->a || !g->r || !g->row) {
        return 0;
    }
    g->err = g->a + nn;
    g->t = g->err + nn;
    g->c = g->r + n;
    g->most = g->c + n;
    g->by = g->most + n;
    g->slop = g->by + n;
    g->column = g->row + n;
    g->most_row = g->column + n;
    return 1;
}

static void end(elimination *g) {
    free(g->a);
    free(g->r);
    free(g->row);
}

/* The power of two nearest 1/sqrt(x), 1 for 0. */
static double half_scale(double x) {
    int e;
    if (!(x > 0) || isinf(x)) {
        return 1;
    }
    (void)frexp(x, &e);
    return ldexp(1, -(int)lround(0.5 * (e - 1)));
}

/* The largest entry of each row (side 0) or column to most (n). */
static void find_largest(const elimination *g, const double *M, int side, double *most) {
    memset(most, 0, (size_t)g->n * sizeof *most);
    for (int j = 0; j < g->n; j++)
        for (int i = 0; i < g->n; i++) {
            const double m = fabs(M[ij(g->n, i, j)]);
            double *to = &most[side ? j : i];
            if (m > 0 && m * (side ? g->c[j] : g->r[i]) * (side ? g->r[i] : g->c[j]) > *to)
                *to = m * (side ? g->c[j] : g->r[i]) * (side ? g->r[i] : g->c[j]);
        }
}

/* Makes the largest entry of each row and column about 1 (Ruiz).  size: what entries were summed from. */
static void equilibrate(elimination *g, const double *M, const double *size) {
    int n = g->n;
    for (int i = 0; i < n; i++) {
        g->r[i] = g->c[i] = 1;
    }
    for (int pass = 0, changes = 1; pass < 12 && changes; pass++) {
        changes = 0;
        for (int side = 0; side < 2; side++) {
            double *own = side ? g->c : g->r;
            find_largest(g, M, side, g->by);
            for (int i = 0; i < n; i++) {
                const double by = half_scale(g->by[i]);
                changes |= by != 1;
                own[i] *= by;
            }
        }
    }
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            g->a[ij(n, i, j)] = M[ij(n, i, j)] * g->r[i] * g->c[j];
            g->err[ij(n, i, j)] = fabs(size[ij(n, i, j)]) * g->r[i] * g->c[j];
            g->t[ij(n, i, j)] = i == j;
        }
    }
}

/* The size of an entry that may be a pivot; 0: it is rounding, or its row or column had one. */
static double pivot_size(const elimination *g, int i, int j) {
    const double size = fabs(g->a[ij(g->n, i, j)]);
    return g->row[i] || g->column[j] || !(size > eps_factor * g->err[ij(g->n, i, j)]) ? 0 : size;
}

/* The largest entry of a row, and its column; 0 if all of it is rounding. */
static double largest_of_row(const elimination *g, int i, int *pj) {
    double most = 0;
    for (int j = 0; j < g->n; j++) {
        const double size = pivot_size(g, i, j);
        if (size > most) {
            most = size;
            *pj = j;
        }
    }
    return most;
}

/* 1 if a row is that of one branch: its entries cancel exactly, at any voltage that the part is at; those of
 * a rounded sum of branches do not. */
static int is_one_branch(const elimination *g, const double *M, int i) {
    int count = 0;
    for (int j = 0; j < g->n; j++)
        count += M[ij(g->n, i, j)] != 0;
    return count <= 2;
}

/* A row in which much less flows than in row *pi, and whose pivot is as good as `most`, in its place; but not
 * that of several branches in place of that of one. */
static void find_quiet_pivot(const elimination *g, const double *M, double most, int *pi, int *pj) {
    const int several = !is_one_branch(g, M, *pi);
    double least = much_less * g->flow[*pi];
    for (int i = 0; i < g->n; i++) {
        int j = 0;
        if (g->flow[i] < least && (several || is_one_branch(g, M, i)) &&
            largest_of_row(g, i, &j) > as_large * most) {
            least = g->flow[i];
            *pi = i;
            *pj = j;
        }
    }
}

static void look_at_column(elimination *g, int j) {
    g->most[j] = 0;
    g->most_row[j] = -1;
    for (int i = 0; i < g->n && !g->column[j]; i++) {
        const double size = pivot_size(g, i, j);
        if (size > g->most[j]) {
            g->most[j] = size;
            g->most_row[j] = i;
        }
    }
}

/* The largest entry that is not rounding; 0 if there is none. */
static int find_pivot(const elimination *g, const double *M, int *pi, int *pj) {
    double most = 0;
    for (int j = 0; j < g->n; j++) {
        if (g->most[j] > most) {
            most = g->most[j];
            *pi = g->most_row[j];
            *pj = j;
        }
    }
    if (most > 0 && g->flow) {
        find_quiet_pivot(g, M, most, pi, pj);
    }
    return most > 0;
}

/* Column j of the row combinations, and of what is left of M, once by and slop are known. */
static void eliminate_in_column(elimination *g, int p, int j) {
    const int n = g->n;
    double *t = g->t + ij(n, 0, j), *a = g->a + ij(n, 0, j), *err = g->err + ij(n, 0, j);
    for (int i = 0; i < n && t[p] != 0; i++)
        t[i] -= g->by[i] * t[p];
    const int changes = !g->column[j] && (a[p] != 0 || err[p] != 0);
    for (int i = 0; i < n && changes; i++) {
        err[i] += fabs(g->by[i]) * err[p] + g->slop[i] * fabs(a[p]);
        a[i] -= g->by[i] * a[p];
    }
    if (changes || g->most_row[j] == p)
        look_at_column(g, j);
}

/* Subtracts multiples of row p from all rows without pivot so that column q vanishes there. */
static void eliminate(elimination *g, int p, int q) {
    const int n = g->n;
    double *column = g->a + ij(n, 0, q);
    const double pivot = column[p], slop = g->err[ij(n, p, q)] / fabs(pivot);
    g->row[p] = g->column[q] = 1;
    g->most[q] = 0;
    for (int i = 0; i < n; i++) {
        const int goes = !g->row[i] && column[i] != 0;
        g->by[i] = goes ? column[i] / pivot : 0;
        g->slop[i] = goes ? g->err[ij(n, i, q)] / fabs(pivot) + fabs(g->by[i]) * slop : 0;
        column[i] = goes ? 0 : column[i];
    }
    for (int j = 0; j < n; j++)
        eliminate_in_column(g, p, j);
}

/* 1 if v M = 0 within the rounding of its terms. */
static int annuls(int n, const double *M, const double *size, const double *v) {
    for (int j = 0; j < n; j++) {
        double sum = 0, terms = 0;
        for (int i = 0; i < n; i++) {
            sum += v[i] * M[ij(n, i, j)];
            terms += fabs(v[i] * size[ij(n, i, j)]);
        }
        if (fabs(sum) > eps_factor * terms) {
            return 0;
        }
    }
    return 1;
}

/* Integers in v's place if they do as well: a floating set of capacitors sums its rows exactly. */
static void round_vector(int n, const double *M, const double *size, double *v, double *work) {
    for (int i = 0; i < n; i++) {
        work[i] = nearbyint(v[i]) + 0.0;
        if (fabs(v[i] - work[i]) > near) {
            return;
        }
    }
    if (annuls(n, M, size, work)) {
        memcpy(v, work, (size_t)n * sizeof(double));
    }
}

/* Null vector of row i in the units of M; v and work: n. */
static void null_vector(const elimination *g, const double *M, const double *size, int i, double *v,
                        double *work) {
    for (int j = 0; j < g->n; j++) {
        v[j] = g->t[ij(g->n, i, j)] * (g->r[j] / g->r[i]);
    }
    round_vector(g->n, M, size, v, work);
}

static void fill(const elimination *g, const double *M, const double *size, double *T, double *work) {
    int n = g->n, differential = 0, algebraic = g->rank;
    memset(T, 0, (size_t)n * (size_t)n * sizeof(double));
    for (int i = 0; i < n; i++) {
        if (g->row[i]) {
            T[ij(n, differential++, i)] = 1;
        } else {
            null_vector(g, M, size, i, work, work + n);
            for (int j = 0; j < n; j++) {
                T[ij(n, algebraic, j)] = work[j];
            }
            algebraic++;
        }
    }
}

static int split(int n, const double *M, const double *size, const double *flow, double *T, int *rank) {
    elimination g;
    double *work;
    int p = 0, q = 0;
    *rank = 0;
    if (n == 0) {
        return NS_OK;
    }
    work = calloc(2 * (size_t)n, sizeof(double));
    if (!work || !begin(&g, n)) {
        if (work) {
            end(&g);
        }
        free(work);
        return NS_E_MEMORY;
    }
    g.flow = flow;
    equilibrate(&g, M, size);
    for (int j = 0; j < n; j++)
        look_at_column(&g, j);
    while (g.rank < n && find_pivot(&g, M, &p, &q)) {
        eliminate(&g, p, q);
        g.rank++;
    }
    fill(&g, M, size, T, work);
    *rank = g.rank;
    end(&g);
    free(work);
    return NS_OK;
}

int ns_linalg_row_split_rows(int n, const double *M, const double *size, double *T, int *rank) {
    return split(n, M, size, NULL, T, rank);
}

int ns_linalg_row_split(int n, const double *M, double *T, int *rank) {
    return ns_linalg_row_split_quiet(n, M, NULL, T, rank);
}

int ns_linalg_row_split_quiet(int n, const double *M, const double *flow, double *T, int *rank) {
    if (!rank || (n > 0 && (!T || !M))) {
        return NS_E_NULL;
    }
    return split(n, M, M, flow, T, rank);
}

/* One entry of T from.  What cancels is zero: a resistor inside a part that T sums up must leave no trace of
 * its rounding, or a floating part hangs on that. */
static double clean_sum(int n, const double *row, const double *column) {
    double sum = 0, size = 0;
    for (int k = 0; k < n; k++) {
        const double term = row[k * n] * column[k];
        sum += term;
        size += fabs(term);
    }
    return fabs(sum) <= 8 * DBL_EPSILON * size ? 0 : sum;
}

/* Row i of T is that of 1, as most are. */
static int is_unit(int n, const double *T, int i) {
    int zeros = 0;
    for (int k = 0; k < n; k++)
        zeros += T[i + k * n] == 0;
    return zeros == n - 1 && T[i + i * n] == 1;
}

void ns_linalg_row_split_apply(int n, int columns, const double *T, const double *from, double *to) {
    for (int i = 0; i < n; i++) {
        const int unit = is_unit(n, T, i);
        for (int j = 0; j < columns; j++) {
            const double *column = from + (size_t)j * (size_t)n;
            to[i + j * n] = unit ? column[i] : clean_sum(n, T + i, column);
        }
    }
}
