/* src/sparse/assemble.c - the sparse matrix of all modes: made from a system; its values; products. */
#include "assemble.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int ns_sparse_form_commit_dense(const ns_system *s, ns_large *a) {
    int status;
    ns_entries gx = {0}, gz = {0};
    for (int c = 0; c < s->nc; c++) {
        for (int i = 0; s->command[c].gx && i < s->n; i++) /* zeros too: it is a function of the state */
            if (s->command[c].gx[i] != 0 || i == 0)
                ns_linalg_entries_add(&gx, i, c, s->command[c].gx[i]);
        for (int i = 0; s->command[c].gz && i < s->nz; i++)
            if (s->command[c].gz[i] != 0)
                ns_linalg_entries_add(&gz, i, c, s->command[c].gz[i]);
    }
    (void)((status = ns_linalg_csc_of_dense(s->n, s->n, s->M, &a->M)) ||
           (status = ns_linalg_csc_of_dense(s->n, s->n, s->A, &a->A)) ||
           (status = ns_linalg_csc_of_dense(s->n, s->m, s->B, &a->B)) ||
           (status = ns_linalg_csc_of_dense(s->m, s->n, s->C, &a->C)) ||
           (status = ns_linalg_csc_of_dense(s->m, s->m, s->D, &a->D)) ||
           (status = ns_linalg_csc_of_dense(s->n, s->nz, s->E, &a->E)) ||
           (status = ns_linalg_csc_of_dense(s->m, s->nz, s->F, &a->F)) ||
           (status = ns_linalg_csc_of_entries(s->n, s->nc, &gx, &a->gx)) ||
           (status = ns_linalg_csc_of_entries(s->nz, s->nc, &gz, &a->gz)));
    ns_linalg_entries_free(&gx);
    ns_linalg_entries_free(&gz);
    return status;
}

void ns_sparse_form_let_go(ns_large *a) {
    enum { COUNT = 9 };
    ns_csc *const all[COUNT] = {&a->M, &a->A, &a->B, &a->C, &a->D, &a->E, &a->F, &a->gx, &a->gz};
    for (int i = 0; i < COUNT; i++)
        ns_linalg_csc_free(all[i]);
}

/* out = T a, by rows of a (at), rows of T (Tt), as rows of out (its columns).  What cancels to rounding is
 * left out (row_split.c). */
static int combine(const ns_csc *Tt, const ns_csc *at, ns_csc *out) {
    ns_entries terms = {0};
    for (int i = 0; i < Tt->columns; i++)
        for (int k = Tt->start[i]; k < Tt->start[i + 1]; k++) {
            const int row = Tt->row[k];
            for (int l = at->start[row]; l < at->start[row + 1]; l++)
                ns_linalg_entries_add(&terms, at->row[l], i, Tt->value[k] * at->value[l]);
        }
    const int status = ns_linalg_csc_of_terms(at->rows, Tt->columns, &terms, out);
    ns_linalg_entries_free(&terms);
    return status;
}

/* Rows of [a b], combined by T where it is not NULL. */
static int rows_of(const ns_csc *a, const ns_csc *b, const ns_csc *Tt, ns_csc *out) {
    ns_entries e = {0};
    const ns_csc *const half[] = {a, b};
    for (int h = 0; h < 2; h++)
        for (int j = 0; half[h] && j < half[h]->columns; j++)
            for (int k = half[h]->start[j]; k < half[h]->start[j + 1]; k++)
                ns_linalg_entries_add(&e, j + (h ? a->columns : 0), half[h]->row[k], half[h]->value[k]);
    ns_csc plain;
    int status = ns_linalg_csc_of_entries(a->columns + (b ? b->columns : 0), a->rows, &e, &plain);
    ns_linalg_entries_free(&e);
    if (!Tt) {
        *out = plain;
        return status;
    }
    if (status == NS_OK)
        status = combine(Tt, &plain, out);
    ns_linalg_csc_free(&plain);
    return status;
}

static void add_place(ns_entries *e, int row, int column, double m, double a, double g) {
    ns_linalg_entries_add(&e[0], row, column, m);
    ns_linalg_entries_add(&e[1], row, column, a);
    ns_linalg_entries_add(&e[2], row, column, g);
}

/* The values of e, whose places are K's. */
static int take_values(const ns_form *f, const ns_entries *e, double **value) {
    ns_csc a = {0};
    const int status = ns_linalg_csc_of_entries(f->size, f->size, e, &a);
    *value = a.value;
    a.value = NULL;
    ns_linalg_csc_free(&a);
    return status;
}

/* The places of laws, pair by pair. */
static int find_laws(ns_form *f) {
    const int all = f->K.start[f->size];
    f->law = calloc(2 * (size_t)all + (size_t)f->m + 2, sizeof(int));
    if (!f->law)
        return NS_E_MEMORY;
    f->law_place = f->law + f->m + 2;
    f->law_own = f->law_place + all;
    for (int k = 0; k < all; k++)
        if (f->K.row[k] >= f->n)
            f->law[f->K.row[k] - f->n + 2]++;
    for (int j = 0; j < f->m; j++)
        f->law[j + 2] += f->law[j + 1];
    for (int i = 0; i < f->size; i++)
        for (int k = f->K.start[i]; k < f->K.start[i + 1]; k++)
            if (f->K.row[k] >= f->n) {
                const int at = f->law[f->K.row[k] - f->n + 1]++;
                f->law_place[at] = k;
                f->law_own[at] = f->K.row[k] == i;
            }
    return NS_OK;
}

/* K: the places of all, with the values of M in K, those of controls in KG, the others in KA. */
static int make_places(ns_form *f) {
    ns_entries e[3] = {{0}};
    const ns_csc *const rows[] = {&f->Mt, &f->At, &f->Ct};
    for (int w = 0; w < 3; w++)
        for (int i = 0; i < rows[w]->columns; i++)
            for (int k = rows[w]->start[i]; k < rows[w]->start[i + 1]; k++) {
                const int row = w == 2 ? f->n + i : i;
                add_place(e, row, rows[w]->row[k], w == 0 ? rows[w]->value[k] : 0,
                          w == 0 ? 0 : rows[w]->value[k], 0);
            }
    for (int j = f->held ? 0 : f->n; j < f->size; j++)
        add_place(e, j, j, 0, 0, 0);
    for (int j = 0; j < f->m; j++)
        for (int c = f->command[j], k = c < 0 ? 0 : f->gx.start[c]; c >= 0 && k < f->gx.start[c + 1]; k++)
            add_place(e, f->n + j, f->gx.row[k], 0, 0, f->gx.value[k]);
    int status;
    (void)((status = ns_linalg_csc_of_entries(f->size, f->size, &e[0], &f->K)) ||
           (status = take_values(f, &e[1], &f->KA)) || (status = take_values(f, &e[2], &f->KG)));
    for (int i = 0; i < 3; i++)
        ns_linalg_entries_free(&e[i]);
    return status == NS_OK ? find_laws(f) : status;
}

static int copy_csc(const ns_csc *a, ns_csc *out) {
    ns_csc t;
    int status = ns_linalg_csc_transpose(a, &t);
    if (status == NS_OK) {
        status = ns_linalg_csc_transpose(&t, out);
        ns_linalg_csc_free(&t);
    }
    return status;
}

/* b = T b, E = T E */
static int take_inputs(ns_form *f, const ns_system *s, const ns_large *a) {
    ns_csc Et = {0};
    int status = rows_of(&a->E, NULL, &f->Tt, &Et);
    if (status == NS_OK)
        status = ns_linalg_csc_transpose(&Et, &f->E);
    ns_linalg_csc_free(&Et);
    for (int i = 0; i < f->n && status == NS_OK; i++) {
        double terms = 0;
        for (int k = f->Tt.start[i]; k < f->Tt.start[i + 1]; k++)
            terms += fabs(f->Tt.value[k] * s->b[f->Tt.row[k]]);
        f->b[i] = ns_linalg_csc_dot(&f->Tt, i, s->b);
        if (fabs(f->b[i]) <= 8 * DBL_EPSILON * terms)
            f->b[i] = 0;
    }
    for (int j = 0; j < f->m; j++)
        f->e[j] = s->e[j];
    return status;
}

static int identity(int n, ns_csc *out) {
    ns_entries e = {0};
    for (int i = 0; i < n; i++)
        ns_linalg_entries_add(&e, i, i, 1);
    const int status = ns_linalg_csc_of_entries(n, n, &e, out);
    ns_linalg_entries_free(&e);
    return status;
}

/* flow[i] += what is in row i of a. */
static void add_flows(const ns_csc *a, double *flow) {
    for (int k = 0; k < a->start[a->columns]; k++)
        flow[a->row[k]] += fabs(a->value[k]);
}

/* sums: the rows of A that stand in place of those of T A (ns_sparse_sum_leaky_parts()). */
static int split_rows(ns_form *f, const ns_system *s, const ns_large *a, int at_rest, ns_csc *sums) {
    if (!at_rest) {
        double *flow = calloc((size_t)f->n + 1, sizeof *flow);
        if (!flow)
            return NS_E_MEMORY;
        add_flows(&a->A, flow);
        add_flows(&a->B, flow);
        int status = ns_sparse_split(&a->M, flow, &f->Tt, f->algebraic);
        free(flow);
        if (status == NS_OK)
            status = ns_sparse_sum_parts(&a->M, &a->A, f->algebraic, &f->Tt);
        if (status == NS_OK)
            status = ns_sparse_sum_leaky_parts(s, a, f->algebraic, &f->Tt, sums);
        return status;
    }
    memset(f->algebraic, 1, (size_t)f->n);
    return identity(f->n, &f->Tt);
}

/* Drops the algebraic rows of T M: they are zero but for rounding. */
static void drop_algebraic(ns_form *f) {
    for (int i = 0, to = 0, from = 0; i < f->n; i++) {
        for (const int end = f->Mt.start[i + 1]; from < end; from++)
            if (!f->algebraic[i]) {
                f->Mt.row[to] = f->Mt.row[from];
                f->Mt.value[to++] = f->Mt.value[from];
            }
        f->Mt.start[i + 1] = to;
    }
}

static int fill(ns_form *f, const ns_system *s, const ns_large *a, int at_rest) {
    ns_csc sums = {0};
    int status = split_rows(f, s, a, at_rest, &sums);
    if (status == NS_OK)
        status = rows_of(&a->A, &a->B, &f->Tt, &f->At);
    if (status == NS_OK)
        status = ns_sparse_sums_put(&sums, f->n, &f->At);
    if (status != NS_OK || (status = rows_of(&a->M, NULL, &f->Tt, &f->Mt))) {
        ns_linalg_csc_free(&sums);
        return status;
    }
    drop_algebraic(f);
    (void)((status = rows_of(&a->C, &a->D, NULL, &f->Ct)) || (status = copy_csc(&a->gx, &f->gx)) ||
           (status = take_inputs(f, s, a)) || (status = copy_csc(&a->F, &f->F)) ||
           (status = ns_linalg_csc_transpose(&a->F, &f->Ft)) || (status = copy_csc(&a->gz, &f->gz)));
    for (int j = 0; j < f->m; j++)
        f->command[j] = -1;
    for (int c = 0; c < f->nc && status == NS_OK; c++)
        if (f->gx.start[c + 1] > f->gx.start[c] && s->command[c].on == s->command[c].off) {
            f->command[s->command[c].pair] = c;
            f->may_slide = 1;
        }
    if (status == NS_OK)
        status = make_places(f);
    if (status == NS_OK)
        status = ns_sparse_sums_find(f, &sums);
    ns_linalg_csc_free(&sums);
    return status;
}

static int hold_nothing(ns_form *f) {
    f->held = calloc((size_t)f->n + 1, sizeof(double));
    for (int i = 0; f->held && i < f->n; i++)
        f->held[i] = NAN;
    return f->held ? NS_OK : NS_E_MEMORY;
}

int ns_sparse_form_create(const ns_system *s, int at_rest, ns_form **out) {
    ns_large own;
    memset(&own, 0, sizeof own);
    *out = NULL;
    ns_form *f = calloc(1, sizeof *f);
    if (!f)
        return NS_E_MEMORY;
    *f = (ns_form){.n = s->n, .m = s->m, .nz = s->nz, .nc = s->nc, .size = s->n + s->m};
    f->algebraic = calloc((size_t)f->n + 1, 1);
    f->b = calloc((size_t)f->size + 1, sizeof(double));
    f->command = calloc((size_t)f->m + 1, sizeof(int));
    int status = f->algebraic && f->b && f->command ? NS_OK : NS_E_MEMORY;
    f->e = f->b ? f->b + f->n : NULL;
    if (status == NS_OK && at_rest)
        status = hold_nothing(f);
    if (status == NS_OK && !s->large)
        status = ns_sparse_form_commit_dense(s, &own);
    if (status == NS_OK)
        status = fill(f, s, s->large ? s->large : &own, at_rest);
    ns_sparse_form_let_go(&own);
    if (status != NS_OK) {
        ns_sparse_form_free(f);
        return status;
    }
    *out = f;
    return NS_OK;
}

void ns_sparse_form_free(ns_form *f) {
    if (!f)
        return;
    enum { COUNT = 10 };
    ns_csc *const all[COUNT] = {&f->K, &f->Mt, &f->At, &f->Ct, &f->E, &f->F, &f->Ft, &f->gx, &f->gz, &f->Tt};
    for (int i = 0; i < COUNT; i++)
        ns_linalg_csc_free(all[i]);
    free(f->KA);
    free(f->KG);
    free(f->law);
    free(f->command);
    free(f->summed);
    free(f->held);
    free(f->algebraic);
    free(f->b);
    free(f);
}

static int is_held(const ns_form *f, int i) {
    return f->held && !isnan(f->held[i]);
}

void ns_sparse_form_values(const ns_form *f, double g, const ns_mode *mode, const double *leak,
                           double *value) {
    for (int j = 0; j < f->size; j++)
        for (int k = f->K.start[j]; k < f->K.start[j + 1]; k++) {
            const int i = f->K.row[k];
            if (i < f->n && is_held(f, i))
                value[k] = i == j;
            else if (i < f->n)
                value[k] = f->K.value[k] - ns_sparse_form_rate(f, g, i) * f->KA[k];
            else if (ns_mode_slides(mode[i - f->n]))
                value[k] = f->KG[k];
            else if (mode[i - f->n] == NS_INSIDE)
                value[k] = f->KA[k] + (leak && i == j ? leak[i - f->n] : 0);
            else
                value[k] = (i == j) + (leak ? leak[i - f->n] * f->KA[k] : 0);
        }
    for (int j = 0; j < f->m; j++)
        ns_sparse_sums_value(f, mode[j], j, value);
}

void ns_sparse_form_law_values(const ns_form *f, ns_mode mode, int j, double *value) {
    for (int p = f->law[j]; p < f->law[j + 1]; p++) {
        const int k = f->law_place[p];
        value[k] = ns_mode_slides(mode) ? f->KG[k] : mode == NS_INSIDE ? f->KA[k] : f->law_own[p];
    }
    ns_sparse_sums_value(f, mode, j, value);
}

void ns_sparse_form_subtract(const ns_form *f, double g, const ns_mode *mode, const double *v, double *r) {
    for (int i = 0; i < f->n; i++)
        r[i] -= is_held(f, i) ? v[i]
                              : (f->algebraic[i] ? 0 : ns_linalg_csc_dot(&f->Mt, i, v)) -
                                    ns_sparse_form_rate(f, g, i) * ns_linalg_csc_dot(&f->At, i, v);
    for (int j = 0; j < f->m; j++)
        r[f->n + j] -= ns_mode_slides(mode[j]) ? ns_linalg_csc_dot(&f->gx, f->command[j], v)
                       : mode[j] == NS_INSIDE  ? ns_linalg_csc_dot(&f->Ct, j, v)
                                               : v[f->n + j];
}
