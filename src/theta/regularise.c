/* src/theta/regularise.c - what the ideal laws do not determine, taken as the limit of real devices.
 *
 * How two closed ideal switches in parallel share a current is undetermined; a part of a circuit behind open
 * ones floats.  Real switches have a resistance and real open ones leak: with conductances g across the open
 * pairs and resistances rho in series with the others (P2) is regular, K_g, and
 *
 *     X <- X + K_g^-1 (rhs - K X),   from X = 0
 *
 * converges to a solution of K X = rhs, the limit g, rho -> 0: what is determined to rounding in a few
 * rounds, what is undetermined as the leaks share it.
 */
#include "regularise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 30 };
/* So many moves of about one size in a row, and the rounds end: the last one would stay above last_move. */
enum { EQUAL_MOVES = 5 };
/* K_g with leaks of these fractions has a reciprocal condition above this, if the leaks determine all. */
static const double rcond_min = 1e-15;
/* Leaks are this fraction of the entries of K, or the next: small enough that each round gains digits of
 * everything that matters more, large enough to leave K_g some digits.  Between a charge that hardly flows
 * in a step and a negligible resistance a leak may be lost in one of two rows: the last ones are such that
 * they count in every row. */
enum { EVERYWHERE = 2 };
static const double fractions[] = {1e-10, 1e-13, 1e-10}, max_entry = 1e-2;

/* The rounds end when a residual is some eps of the largest unknown, in the units of the factors, in every
 * term of its row.  They have converged if that came about, or if no more than left_over of the right-hand
 * side remains; and if the last round moved nothing any more: what contradicts itself grows by the same
 * amount in every round, to whatever size, and so do unknowns that matter less than the leaks. */
static const double rounding = 1e-15, left_over = 1e-12, last_move = 1e-2;

static double least_of(double a, double b) {
    return b > 0 ? fmin(a, b) : a;
}

/* The largest entry of 1 siemens across pair j; *least: of those that are not zero. */
static double entry_across(const ns_theta *s, double ht, int j, double *least) {
    const int n = s->s->n, m = s->s->m;
    const double *rows = ns_linalg_lu_rows(s->lu), *units = ns_linalg_lu_units(s->lu);
    double high_row = 0, high_column = 0, low_row = INFINITY, low_column = INFINITY;
    for (int i = 0; i < n; i++) {
        const double row = (i < s->r ? ht : 1) * fabs(s->B[i + j * n]) * rows[i];
        const double column = fabs(s->s->C[j + i * m]) * units[i];
        high_row = fmax(high_row, row);
        high_column = fmax(high_column, column);
        low_row = least_of(low_row, row);
        low_column = least_of(low_column, column);
    }
    *least = low_row * low_column;
    return high_row * high_column;
}

double ns_theta_leak_across(const ns_theta *s, double ht, int j, double fraction) {
    double least;
    const double entry = entry_across(s, ht, j, &least);
    return entry > 0 && isfinite(fraction / entry) ? fraction / entry : 0;
}

/* Of that fraction wherever it enters, where that is not more than max_entry elsewhere. */
static double leak_everywhere(const ns_theta *s, double ht, int j, double fraction) {
    double least;
    const double entry = entry_across(s, ht, j, &least), leak = fmin(fraction / least, max_entry / entry);
    return entry > 0 && isfinite(leak) ? leak : 0;
}

double ns_theta_leak_series(const ns_theta *s, int row, double fraction) {
    return fraction / (ns_linalg_lu_rows(s->lu)[row] * ns_linalg_lu_units(s->lu)[row]);
}

static void find_leaks(const ns_theta *s, const ns_leaks *leaks, int attempt) {
    const double fraction = fractions[attempt];
    for (int j = 0, row = s->s->n; j < s->s->m; j++)
        if (leaks->mode[j] == NS_INSIDE)
            leaks->of[j] = ns_theta_leak_series(s, row++, fraction);
        else if (attempt == EVERYWHERE)
            leaks->of[j] = leak_everywhere(s, leaks->ht, j, fraction);
        else
            leaks->of[j] = ns_theta_leak_across(s, leaks->ht, j, fraction);
}

/* Leaks of one kind (inside or not) are alike, but none is more than `most_times` its own: how parallel
 * devices share a current, or open devices in series a voltage, then is the same whatever the scaling of K,
 * and so in steps of all lengths. */
static void make_alike(const ns_theta *s, const ns_leaks *leaks, int inside, double most_times) {
    double most = 0;
    for (int j = 0; j < s->s->m; j++)
        if ((leaks->mode[j] == NS_INSIDE) == inside)
            most = fmax(most, leaks->of[j]);
    for (int j = 0; j < s->s->m; j++)
        if ((leaks->mode[j] == NS_INSIDE) == inside)
            leaks->of[j] = fmin(most, most_times * leaks->of[j]);
}

/* s->K becomes K_g. */
static void add_leaks(ns_theta *s, const ns_leaks *leaks, int size) {
    const int n = s->s->n, m = s->s->m;
    for (int j = 0, row = n; j < m; j++) {
        if (leaks->mode[j] == NS_INSIDE) {
            s->K[row * (size + 1)] += leaks->of[j];
            row++;
            continue;
        }
        for (int k = 0; k < n; k++)
            for (int i = 0; i < n; i++)
                s->K[i + k * size] +=
                    (i < s->r ? leaks->ht : 1) * leaks->of[j] * s->B[i + j * n] * s->s->C[j + k * m];
    }
}

/* Adds `by` times column j to out; row: that of pair j if it is inside. */
static void add_column(const ns_theta *s, const ns_leaks *leaks, int j, int row, double by, double *out) {
    if (leaks->mode[j] == NS_INSIDE)
        out[row] += leaks->of[j] * by;
    else
        for (int i = 0; i < s->s->n; i++)
            out[i] += (i < s->r ? leaks->ht : 1) * leaks->of[j] * s->B[i + j * s->s->n] * by;
}

static int count_inside(const ns_leaks *leaks, int m) {
    int count = 0;
    for (int j = 0; j < m; j++)
        count += leaks->mode[j] == NS_INSIDE;
    return count;
}

void ns_theta_leak_times(const ns_theta *s, const ns_leaks *leaks, const double *x, double *out) {
    const int n = s->s->n, m = s->s->m;
    memset(out, 0, sizeof(double) * (size_t)(n + count_inside(leaks, m)));
    for (int j = 0, row = n; j < m; j++) {
        double y = 0;
        for (int i = 0; leaks->mode[j] != NS_INSIDE && i < n; i++)
            y += s->s->C[j + i * m] * x[i];
        add_column(s, leaks, j, row, leaks->mode[j] == NS_INSIDE ? x[row] : y, out);
        row += leaks->mode[j] == NS_INSIDE;
    }
}

/* A right-hand side whose rounds are not over. */
typedef struct ns_leak_column {
    int index;    /* which */
    int equal;    /* for how many rounds moved was about the same */
    double worst; /* the residual after the last round, against the terms of its row */
    double moved; /* what that round moved */
} ns_leak_column;

/* What the rounds work on, in one block. */
typedef struct ns_leak_work {
    double *K;      /* size*size: (P2) without leaks, */
    double *rhs;    /* size*nrhs: its right-hand sides; */
    double *of_row; /* size: sums of the absolute entries of K, in units of the factors */
    double *step;   /* size*nrhs: residuals, and what they move, of columns whose rounds are not over */
    ns_leak_column *column;
} ns_leak_work;

static void sum_rows(const ns_theta *s, int size, const double *K, double *of_row) {
    const double *unit = ns_linalg_lu_units(s->lu);
    memset(of_row, 0, sizeof *of_row * (size_t)size);
    for (int j = 0; j < size; j++)
        for (int i = 0; i < size; i++)
            of_row[i] += fabs(K[i + j * size]) * unit[j];
}

/* residual = rhs - K X, one column.  Returns its largest entry against the terms of its row, in *left against
 * the largest of the right-hand side. */
static double residual_of(const ns_theta *s, int size, const ns_leak_work *w, const double *rhs,
                          const double *X, double *residual, double *left) {
    const double *rows = ns_linalg_lu_rows(s->lu), largest = ns_linalg_lu_largest(s->lu, X);
    double worst = 0, given = 0, over = 0;
    ns_linalg_matvec(size, size, w->K, X, residual);
    for (int i = 0; i < size; i++) {
        const double terms = fabs(rhs[i]) + w->of_row[i] * largest;
        residual[i] = rhs[i] - residual[i];
        given = fmax(given, fabs(rhs[i]) * rows[i]);
        over = fmax(over, fabs(residual[i]) * rows[i]);
        if (terms > 0)
            worst = fmax(worst, fabs(residual[i]) / terms);
    }
    *left = given > 0 ? over / given : 0;
    return worst;
}

/* One round of a column, whose step was solved for: X moves by it, and it becomes the residual.  1: it was
 * the last one; *converged. */
static int finish_round(const ns_theta *s, int size, const ns_leak_work *w, ns_leak_column *c, double *step,
                        int *converged) {
    const size_t at = (size_t)c->index * (size_t)size;
    const int last = c->worst <= rounding || c->equal == EQUAL_MOVES;
    const double before = c->moved;
    double *X = s->X + at, left;
    for (int i = 0; i < size; i++)
        X[i] += step[i];
    c->moved = ns_linalg_lu_largest(s->lu, step);
    c->equal = c->moved > 0.99 * before ? c->equal + 1 : 0;
    c->worst = residual_of(s, size, w, w->rhs + at, X, step, &left);
    *converged = (c->worst <= 10 * rounding || left <= left_over) &&
                 c->moved <= last_move * ns_linalg_lu_largest(s->lu, X);
    return last;
}

/* Rounds on all columns side by side, of each one more when it has converged. */
static int solve_columns(ns_theta *s, int size, int nrhs, const ns_leak_work *w) {
    const size_t bytes = sizeof(double) * (size_t)size;
    int left = nrhs;
    memset(s->X, 0, bytes * (size_t)nrhs);
    memcpy(w->step, w->rhs, bytes * (size_t)nrhs);
    for (int k = 0; k < nrhs; k++)
        w->column[k] = (ns_leak_column){.index = k, .worst = INFINITY};
    for (int round = 1; left > 0; round++) {
        const int columns = left;
        ns_linalg_lu_solve(s->lu, columns, w->step);
        left = 0;
        for (int k = 0; k < columns; k++) {
            double *step = w->step + (size_t)k * (size_t)size;
            int converged;
            if (!finish_round(s, size, w, &w->column[k], step, &converged) && round < ROUNDS) {
                w->column[left] = w->column[k];
                memmove(w->step + (size_t)left++ * (size_t)size, step, bytes);
            } else if (!converged)
                return NS_E_SINGULAR;
        }
    }
    return NS_OK;
}

static int solve_with(ns_theta *s, const ns_leaks *leaks, int size, int nrhs, int attempt,
                      const ns_leak_work *w) {
    double rcond = 0;
    find_leaks(s, leaks, attempt);
    if (attempt == 0) {
        make_alike(s, leaks, 1, 1e3);
        make_alike(s, leaks, 0, 1e6);
    }
    add_leaks(s, leaks, size);
    s->counts.factors++;
    const int status = ns_linalg_lu_factor(s->lu, size, s->K, &rcond);
    if (status != NS_OK || rcond < rcond_min)
        return status == NS_OK ? NS_E_SINGULAR : status;
    sum_rows(s, size, w->K, w->of_row);
    return solve_columns(s, size, nrhs, w);
}

static int allocate_work(size_t size, size_t nrhs, ns_leak_work *w) {
    const size_t square = size * size, count = size * nrhs;
    w->K = malloc(sizeof *w->K * (square + 2 * count + size + 1));
    w->column = malloc(sizeof *w->column * (nrhs + 1));
    if (!w->K || !w->column) {
        free(w->K);
        free(w->column);
        return NS_E_MEMORY;
    }
    w->rhs = w->K + square;
    w->step = w->rhs + count;
    w->of_row = w->step + count;
    return NS_OK;
}

int ns_theta_leak_solve(ns_theta *s, const ns_leaks *leaks, int nj, int nrhs) {
    const int size = s->s->n + nj;
    const size_t square = (size_t)size * (size_t)size, count = (size_t)size * (size_t)nrhs;
    ns_leak_work w;
    if (allocate_work((size_t)size, (size_t)nrhs, &w) != NS_OK)
        return NS_E_MEMORY;
    memcpy(w.K, s->K, sizeof(double) * square);
    memcpy(w.rhs, s->X, sizeof(double) * count);
    int status = NS_E_SINGULAR;
    for (int k = 0; k <= EVERYWHERE && status == NS_E_SINGULAR; k++) {
        (void)ns_linalg_lu_factor(s->lu, size, w.K, NULL); /* for the scaling of K itself */
        status = solve_with(s, leaks, size, nrhs, k, &w);
        memcpy(s->K, w.K, sizeof(double) * square);
    }
    free(w.K);
    free(w.column);
    return status;
}
