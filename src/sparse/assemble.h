/* src/sparse/assemble.h - (P2) of every mode and every length of step as one sparse matrix.
 *
 *     rows 0..n-1:  M x - g (A x + B lambda)   (algebraic rows: -(A x + B lambda)), combined by T
 *     row n+j:      (C x + D lambda)_j if pair j is inside, else lambda_j; if it slides, its control
 *
 * The places of its entries hold for all modes and lengths: what a mode changes are values.
 */
#ifndef NS_SPARSE_ASSEMBLE_H
#define NS_SPARSE_ASSEMBLE_H

#include "linalg/sparse.h"
#include "modes/mode.h"
#include "nonsmooth/system.h"

typedef struct ns_form {
    int n, m, nz, nc;
    int size;                 /* n+m */
    ns_csc K;                 /* size*size: M at its places, */
    double *KA;               /* and at the same places A, B; C, D; */
    double *KG;               /* in rows of commanded pairs their control */
    int *law;                 /* m+2: the row of pair j in it: from law[j] to law[j+1] */
    int *law_place, *law_own; /* its places, and 1 where it is lambda_j's */
    int *command;             /* m: whose control depends on the state and has no hysteresis, -1: none */
    int may_slide;            /* one of them is not -1 */
    unsigned char *algebraic; /* n: the row of M is zero */
    ns_csc Mt, At, Ct;        /* their columns are the rows of M (n), [A B], [C D] (size) */
    ns_csc E, F;              /* n*nz, m*nz */
    ns_csc Ft;
    ns_csc gx, gz; /* n*nc, nz*nc */
    ns_csc Tt;     /* its columns are the rows of T */
    double *b, *e; /* n, m */
    int *summed; /* m+1, or NULL: where the sums of parts have lambda_j in K: from summed[j] to summed[j+1] */
    int *summed_place, *summed_row; /* the places, and the rows */
    double *held; /* n, or NULL: what x_i is held at in place of row i (a node's KCL), NAN: it is not */
} ns_form;

/* The matrices of a system that has dense arrays, and frees them.  Errors: MEMORY. */
int ns_sparse_form_commit_dense(const ns_system *s, ns_large *a);
void ns_sparse_form_let_go(ns_large *a);

/* at_rest: M counts as zero, rows are not combined, and unknowns may be held.  Errors: MEMORY, those of
 * ns_linalg_row_split(). */
int ns_sparse_form_create(const ns_system *s, int at_rest, ns_form **out);
void ns_sparse_form_free(ns_form *f); /* NULL is allowed */

/* The values of K (at K's places).  leak (m), or NULL: with a conductance across each open pair and a
 * resistance in series with each that is inside (sparse/regularise.h). */
void ns_sparse_form_values(const ns_form *f, double g, const ns_mode *mode, const double *leak,
                           double *value);

/* Those in the row of pair j, and in sums of parts. */
void ns_sparse_form_law_values(const ns_form *f, ns_mode mode, int j, double *value);

/* r -= K v, without leaks. */
void ns_sparse_form_subtract(const ns_form *f, double g, const ns_mode *mode, const double *v, double *r);

/* The factor of the rates in row i < n: g, or 1 where it is algebraic. */
static inline double ns_sparse_form_rate(const ns_form *f, double g, int i) {
    return f->algebraic[i] ? 1 : g;
}

/* y_j at v = (x, lambda) and z; constants: 1, or 0 where e is left out. */
static inline double ns_sparse_form_y(const ns_form *f, int j, const double *v, const double *z,
                                      int constants) {
    double y = ns_linalg_csc_dot(&f->Ct, j, v) + (constants ? f->e[j] : 0);
    if (f->Ft.start[j + 1] > f->Ft.start[j])
        y += ns_linalg_csc_dot(&f->Ft, j, z);
    return y;
}

/* The resistance of pair j where it conducts: |D_jj|. */
static inline double ns_sparse_form_resistance(const ns_form *f, int j) {
    for (int k = f->Ct.start[j]; k < f->Ct.start[j + 1]; k++)
        if (f->Ct.row[k] == f->n + j)
            return f->Ct.value[k] < 0 ? -f->Ct.value[k] : f->Ct.value[k];
    return 0;
}

/* split_rows.c: the columns of Tt are rows of T (ns_system_split(), but in place: row i of T M is that row
 * of M, or zero, then algebraic[i]), from M; flow (n): the sizes of all other terms of a row.  Errors:
 * MEMORY. */
int ns_sparse_split(const ns_csc *M, const double *flow, ns_csc *Tt, unsigned char *algebraic);
/* summed_parts.c: some of the algebraic rows of T, those of single rows, become sums (linalg/summed_parts.h).
 * Errors: MEMORY. */
int ns_sparse_sum_parts(const ns_csc *M, const ns_csc *A, const unsigned char *algebraic, ns_csc *Tt);
/* The same file: 1 if the rows of part p, part[row] == p, cancel in column j of a, but for rounding. */
int ns_sparse_part_cancels(const ns_csc *a, const int *part, int p, int j);
/* leaky_parts.c: some of the algebraic rows of T become sums of all balances of a part.  a: the matrices of
 * s; sums: column i, if it is not empty, is row i of T A without the rounding of A; freed by the caller.
 * Errors: MEMORY. */
int ns_sparse_sum_leaky_parts(const ns_system *s, const ns_large *a, const unsigned char *algebraic,
                              ns_csc *Tt, ns_csc *sums);

/* sum_rows.c: rows of At whose columns of sums are not empty become these, with what B has in them.  Errors:
 * MEMORY. */
int ns_sparse_sums_put(const ns_csc *sums, int n, ns_csc *At);
/* Where they have lambda, once there are places.  Errors: MEMORY. */
int ns_sparse_sums_find(ns_form *f, const ns_csc *sums);
/* The values of lambda_j in them: 0 where its own row gives it. */
void ns_sparse_sums_value(const ns_form *f, ns_mode mode, int j, double *value);
/* Then it is taken from r (size) instead, before that is solved for; and where r is r - K v, what is left
 * without it. */
void ns_sparse_form_move_known(const ns_form *f, const ns_mode *mode, double *r);
void ns_sparse_form_leave_known(const ns_form *f, const ns_mode *mode, const double *v, double *r);

#endif
