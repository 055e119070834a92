/* src/mlcp/pivoting/tableau.c - the canonical tableau of the pairs: basic = beta + T nonbasic.
 *
 * Free lambda are basic for ever and free y never are, so neither has a row or a column here: the tableau is
 * np by np whatever the size of the circuit.  It is made from W and q through one LU, not by accumulating
 * exchanges; sums that cancel to rounding are made 0, so that an entry counts as a pivot however small it is
 * (a current that enters a capacitor for 1e-13 s moves its voltage by 1e-7 V an ampere, and must).  Entries
 * are in units: variable v is `unit[v]` times its entry.
 */
#include "mlcp/mlcp_internal.h"

#include <math.h>
#include <string.h>

static const double CANCELLED = 1e-14; /* a sum this small against its terms is 0 */

/* rows and cols of G as the labels of the tableau have it. */
static void pick_labels(ns_mlcp_solver *s) {
    int nr = s->nf, nc = nr;
    memcpy(s->rows, s->free, (size_t)s->nf * sizeof *s->rows);
    memcpy(s->cols, s->free, (size_t)s->nf * sizeof *s->cols);
    for (int a = 0; a < s->np; a++) {
        if (s->tab.where[2 * a + 1] < 0)
            s->rows[nr++] = s->pair[a];
        if (s->tab.where[2 * a] >= 0)
            s->cols[nc++] = s->pair[a];
    }
    if (s->tab.where[2 * s->np] >= 0)
        s->cols[nc++] = -1;
    s->k = nc;
}

static const double *column(const ns_mlcp_solver *s, int j) {
    return j < 0 ? s->tab.cover : s->W + (size_t)j * (size_t)s->m;
}

static int factor_labels(ns_mlcp_solver *s) {
    pick_labels(s);
    for (int j = 0; j < s->k; j++) {
        const double *col = column(s, s->cols[j]);
        for (int i = 0; i < s->k; i++)
            s->G[(size_t)i + (size_t)j * (size_t)s->k] = col[s->rows[i]];
    }
    return ns_mlcp_basis_factor_of(s, s->k, s->G, NULL);
}

/* g = q + W lambda of the nonbasic lambda that are not 0 (t is 0 where nonbasic). */
static void constant_part(ns_mlcp_solver *s) {
    memcpy(s->g, s->q, (size_t)s->m * sizeof *s->g);
    for (int a = 0; a < s->np; a++) {
        int i = s->pair[a];
        double v = s->tab.at_upper[a] ? s->p->u[i] : s->p->l[i];
        if (s->tab.where[2 * a] < 0 && v != 0.0)
            ns_linalg_matvec_add(s->m, 1, column(s, i), &v, s->g);
    }
}

/* Problem index whose column of W a nonbasic variable has; -1 for t. */
static int index_of(const ns_mlcp_solver *s, int var) {
    return ns_is_t(s, var) ? -1 : s->pair[var / 2];
}

/* Right-hand sides: the constant part, then one column a nonbasic variable. */
static void right_sides(ns_mlcp_solver *s) {
    int k = s->k;
    double *b = s->rhs;
    for (int i = 0; i < k; i++)
        b[i] = -s->g[s->rows[i]];
    for (int c = 0; c < s->tab.ncol; c++) {
        int var = s->tab.colvar[c], j = index_of(s, var);
        b += k;
        if (ns_is_y(s, var)) {
            for (int i = 0; i < k; i++)
                b[i] = s->rows[i] == j ? 1.0 : 0.0;
            continue;
        }
        const double *col = column(s, j);
        for (int i = 0; i < k; i++)
            b[i] = -col[s->rows[i]];
    }
}

/* Row r of the tableau belongs to basic y_i: y_i = g_i + W[i,cols] (solutions) + W[i,nonbasic]. */
static void y_row(ns_mlcp_solver *s, int r, int i) {
    double *w = s->ray; /* scratch: row i of W at cols */
    for (int j = 0; j < s->k; j++)
        w[j] = column(s, s->cols[j])[i];
    for (int c = -1; c < s->tab.ncol; c++) {
        const double *x = s->rhs + (size_t)(c + 1) * (size_t)s->k;
        double sum = 0.0, size = 0.0;
        for (int j = 0; j < s->k; j++) {
            sum += w[j] * x[j];
            size += fabs(w[j] * x[j]);
        }
        if (c < 0)
            s->tab.beta[r] = s->g[i] + sum;
        else {
            double own = ns_is_y(s, s->tab.colvar[c]) ? 0.0 : column(s, index_of(s, s->tab.colvar[c]))[i];
            int rounding = fabs(sum + own) <= CANCELLED * (size + fabs(own));
            s->tab.T[r + c * s->np] = rounding ? 0.0 : sum + own;
        }
    }
}

/* Row r belongs to a basic lambda (or t): entry `at` of the solutions. */
static void x_row(ns_mlcp_solver *s, int r, int at) {
    s->tab.beta[r] = s->rhs[at];
    for (int c = 0; c < s->tab.ncol; c++)
        s->tab.T[r + c * s->np] = s->rhs[(size_t)at + (size_t)(c + 1) * (size_t)s->k];
}

static void to_units(ns_mlcp_solver *s) {
    for (int c = 0; c < s->tab.ncol; c++) {
        double *t = s->tab.T + (size_t)c * (size_t)s->np, u = s->tab.unit[s->tab.colvar[c]];
        for (int r = 0; r < s->np; r++)
            t[r] *= u / s->tab.unit[s->tab.rowvar[r]];
    }
    for (int r = 0; r < s->np; r++)
        s->tab.beta[r] /= s->tab.unit[s->tab.rowvar[r]];
}

/* Entries of solutions that are rounding against the rest of their column, in the units of the factors. */
static void drop_rounding(ns_mlcp_solver *s) {
    const double *unit = ns_linalg_lu_units(s->lu);
    for (int c = 1; c <= s->tab.ncol; c++) {
        double *x = s->rhs + (size_t)c * (size_t)s->k, top = 0.0;
        for (int j = 0; j < s->k; j++)
            top = fmax(top, fabs(x[j]) / unit[j]);
        for (int j = 0; j < s->k; j++)
            if (fabs(x[j]) / unit[j] <= CANCELLED * top)
                x[j] = 0.0;
    }
}

/* Fills beta and T for the labels at hand; G is factored. */
static void fill_tableau(ns_mlcp_solver *s) {
    constant_part(s);
    right_sides(s);
    ns_linalg_lu_solve(s->lu, 1 + s->tab.ncol, s->rhs);
    drop_rounding(s);
    int at = s->nf;
    for (int a = 0; a < s->np; a++)
        if (s->tab.where[2 * a] >= 0)
            x_row(s, s->tab.where[2 * a], at++);
    if (s->tab.where[2 * s->np] >= 0)
        x_row(s, s->tab.where[2 * s->np], at);
    for (int a = 0; a < s->np; a++)
        if (s->tab.where[2 * a + 1] >= 0)
            y_row(s, s->tab.where[2 * a + 1], s->pair[a]);
    to_units(s);
}

void ns_mlcp_tableau_start(ns_mlcp_solver *s) {
    for (int a = 0; a < s->np; a++) {
        int i = s->pair[a], inside = s->mode[i] == NS_INSIDE;
        s->tab.rowvar[a] = inside ? 2 * a : 2 * a + 1;
        s->tab.colvar[a] = inside ? 2 * a + 1 : 2 * a;
        s->tab.where[2 * a] = inside ? a : -1 - a;
        s->tab.where[2 * a + 1] = inside ? -1 - a : a;
        s->tab.at_upper[a] = s->mode[i] == NS_UPPER;
        s->tab.first_y[a] = !inside;
        s->tab.unit[2 * a] = s->lsize[i];
        s->tab.unit[2 * a + 1] = s->ysize[i];
        s->tab.lo[a] = s->p->l[i] / s->lsize[i];
        s->tab.hi[a] = s->p->u[i] / s->lsize[i];
    }
    s->tab.unit[2 * s->np] = 1.0;
    s->tab.where[2 * s->np] = -1 - s->np;
    s->tab.ncol = s->np;
    fill_tableau(s);
}

int ns_mlcp_tableau_refresh(ns_mlcp_solver *s) {
    int status = factor_labels(s);
    if (status == NS_OK)
        fill_tableau(s);
    return status;
}

void ns_mlcp_tableau_exchange(ns_mlcp_solver *s, int row, int col) {
    const int in = s->tab.colvar[col], out = s->tab.rowvar[row];
    ns_linalg_exchange(s->np, s->tab.ncol, s->tab.T, row, col, CANCELLED);
    s->tab.rowvar[row] = in;
    s->tab.colvar[col] = out;
    s->tab.where[in] = row;
    s->tab.where[out] = -1 - col;
}
