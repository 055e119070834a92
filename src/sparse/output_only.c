/* src/sparse/output_only.c - unknowns that are only shown are left out of the system, and solved for when
 * read. */
#include "output_only.h"

#include <stdlib.h>
#include <string.h>

#include "assemble.h"
#include "system/union_find.h"

/* Row i and unknown i are one node of a graph, in which each entry of a joins its row and its column; parent:
 * its connected parts. */
static void join(const ns_csc *a, int *parent) {
    for (int j = 0; j < a->columns; j++)
        for (int k = a->start[j]; k < a->start[j + 1]; k++)
            ns_system_union_join(parent, a->row[k], j);
}

/* Marks the parts in whose rows (by_column: columns) a has an entry. */
static void mark_used(const ns_csc *a, int by_column, int *parent, unsigned char *used) {
    for (int j = 0; j < a->columns; j++)
        for (int k = a->start[j]; k < a->start[j + 1]; k++)
            used[ns_system_union_top(parent, by_column ? j : a->row[k])] = 1;
}

/* used (n): at the top of each part, 1 if M, B, C or gx has an entry in it, so that it stays. */
static void find_parts(const ns_large *a, int n, int *parent, unsigned char *used) {
    ns_system_union_begin(parent, n);
    join(&a->M, parent);
    join(&a->A, parent);
    mark_used(&a->M, 1, parent, used);
    mark_used(&a->B, 0, parent, used);
    mark_used(&a->C, 1, parent, used);
    mark_used(&a->gx, 0, parent, used);
}

static void choose_unknowns(ns_output_only *a, int n, int *parent, const unsigned char *used) {
    for (int i = 0; i < n; i++)
        if (used[ns_system_union_top(parent, i)]) {
            a->place[i] = a->rest.n;
            a->stays[a->rest.n++] = i;
        } else {
            a->place[i] = -1 - a->count;
            a->unknown[a->count++] = i;
        }
}

/* The number of row or column i among those that stay (others: that are left out), negative if it is none of
 * them.  place: as in ns_output_only; NULL: i, all stay. */
static int placed(const int *place, int i, int others) {
    return !place ? i : others ? -1 - place[i] : place[i];
}

/* The rows and columns of from that stay, or (others) those that do not. */
static int pick_entries(const ns_csc *from, const int *row, const int *column, int rows, int columns,
                        int others, ns_csc *out) {
    ns_entries e = {0};
    for (int j = 0; j < from->columns; j++)
        for (int k = from->start[j]; k < from->start[j + 1]; k++) {
            const int r = placed(row, from->row[k], others), c = placed(column, j, others);
            if (r >= 0 && c >= 0)
                ns_linalg_entries_add(&e, r, c, from->value[k]);
        }
    const int status = ns_linalg_csc_of_entries(rows, columns, &e, out);
    ns_linalg_entries_free(&e);
    return status;
}

static int pick_rest(ns_output_only *a, const ns_large *all) {
    const ns_system *s = a->whole;
    const int *p = a->place, n = a->rest.n;
    int status;
    (void)((status = pick_entries(&all->M, p, p, n, n, 0, &a->large.M)) ||
           (status = pick_entries(&all->A, p, p, n, n, 0, &a->large.A)) ||
           (status = pick_entries(&all->B, p, NULL, n, s->m, 0, &a->large.B)) ||
           (status = pick_entries(&all->C, NULL, p, s->m, n, 0, &a->large.C)) ||
           (status = pick_entries(&all->D, NULL, NULL, s->m, s->m, 0, &a->large.D)) ||
           (status = pick_entries(&all->E, p, NULL, n, s->nz, 0, &a->large.E)) ||
           (status = pick_entries(&all->F, NULL, NULL, s->m, s->nz, 0, &a->large.F)) ||
           (status = pick_entries(&all->gx, p, NULL, n, s->nc, 0, &a->large.gx)) ||
           (status = pick_entries(&all->gz, NULL, NULL, s->nz, s->nc, 0, &a->large.gz)));
    for (int i = 0; i < n; i++) {
        a->b[i] = s->b[a->stays[i]];
        a->balance[i] = s->balance[a->stays[i]];
        a->ground[i] = s->ground[a->stays[i]];
    }
    return status;
}

/* follows: inputs in the equations of those left out.  bent: unknowns of a part in whose equations there is
 * an input that is no straight line between corners. */
static void list_inputs(ns_output_only *a, const ns_csc *E, int *parent) {
    unsigned char *bent = a->bent + a->count; /* of each root */
    for (int k = 0; k < E->columns; k++) {
        const ns_signal_kind kind = a->whole->z[k].kind;
        const int straight = kind == NS_DC || kind == NS_PULSE || kind == NS_PWL;
        for (int i = E->start[k]; i < E->start[k + 1] && !straight; i++)
            bent[ns_system_union_top(parent, a->unknown[E->row[i]])] = 1;
        if (E->start[k + 1] > E->start[k])
            a->follows[a->nfollows++] = k;
    }
    for (int i = 0; i < a->count; i++)
        a->bent[i] = bent[ns_system_union_top(parent, a->unknown[i])];
}

/* The equations of those left out, factored.  Errors: those of ns_linalg_klu_create(),
 * ns_linalg_klu_factor().
 */
static int factor_output(ns_output_only *a, const ns_large *all, int *parent) {
    ns_csc E = {0};
    int status = pick_entries(&all->A, a->place, a->place, a->count, a->count, 1, &a->A);
    if (status == NS_OK)
        status = pick_entries(&all->E, a->place, NULL, a->count, a->whole->nz, 1,
                              &E); /* its columns: as they are */
    if (status == NS_OK) {
        list_inputs(a, &E, parent);
        status = ns_linalg_csc_transpose(&E, &a->Et);
    }
    ns_linalg_csc_free(&E);
    if (status == NS_OK)
        status = ns_linalg_klu_create(a->count, a->A.start, a->A.row, &a->klu);
    return status == NS_OK ? ns_linalg_klu_factor(a->klu, a->A.value, &a->factors) : status;
}

/* Nothing is left out. */
static void keep_all(ns_output_only *a) {
    ns_linalg_factors_free(a->klu, a->factors);
    ns_linalg_klu_free(a->klu);
    a->factors = NULL;
    a->klu = NULL;
    a->rest = *a->whole;
    a->count = 0;
    for (int i = 0; i < a->rest.n; i++)
        a->place[i] = a->stays[i] = i;
}

static int split_system(ns_output_only *a, const ns_large *all) {
    const int n = a->whole->n;
    int *parent = calloc((size_t)n + 1, sizeof *parent);
    unsigned char *used = calloc((size_t)n + 1, 1);
    int status = parent && used ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        a->rest = *a->whole;
        a->rest.n = 0;
        find_parts(all, n, parent, used);
        choose_unknowns(a, n, parent, used);
    }
    if (status == NS_OK && a->count > 0)
        status = factor_output(a, all, parent);
    free(parent);
    free(used);
    if (status == NS_E_MEMORY)
        return status;
    if (status != NS_OK || a->count == 0) { /* a step of the whole system names what is singular */
        keep_all(a);
        return NS_OK;
    }
    a->rest.large = &a->large; /* in place of arrays */
    a->rest.M = a->rest.A = a->rest.B = a->rest.C = a->rest.D = a->rest.E = a->rest.F = NULL;
    a->rest.b = a->b;
    a->rest.balance = a->balance;
    a->rest.ground = a->ground;
    return pick_rest(a, all);
}

int ns_sparse_output_create(const ns_system *s, ns_output_only **out) {
    const size_t n = (size_t)s->n;
    ns_large own;
    memset(&own, 0, sizeof own);
    *out = NULL;
    ns_output_only *a = calloc(1, sizeof *a);
    if (!a)
        return NS_E_MEMORY;
    a->whole = s;
    a->place = calloc(3 * n + 1, sizeof *a->place);
    a->b = calloc(3 * n + (size_t)s->nz + 1, sizeof *a->b);
    a->follows = calloc((size_t)s->nz + 1, sizeof *a->follows);
    a->bent = calloc(3 * n + 1, 1);
    int status = a->place && a->b && a->follows && a->bent ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK && !s->large)
        status = ns_sparse_form_commit_dense(s, &own);
    if (status == NS_OK) {
        a->stays = a->place + n;
        a->unknown = a->stays + n;
        a->r = a->b + n;
        a->ground = a->r + n;
        a->z = a->ground + n;
        a->balance = a->bent + 2 * n;
        status = split_system(a, s->large ? s->large : &own);
    }
    ns_sparse_form_let_go(&own);
    if (status != NS_OK) {
        ns_sparse_output_free(a);
        return status;
    }
    *out = a;
    return NS_OK;
}

void ns_sparse_output_free(ns_output_only *a) {
    if (!a)
        return;
    ns_linalg_factors_free(a->klu, a->factors);
    ns_linalg_klu_free(a->klu);
    ns_sparse_form_let_go(&a->large);
    ns_linalg_csc_free(&a->A);
    ns_linalg_csc_free(&a->Et);
    free(a->place);
    free(a->b);
    free(a->follows);
    free(a->bent);
    free(a);
}

/* 1 if those left out are known at these inputs. */
static int is_known(const ns_output_only *a, const double *z) {
    int same = a->solves > 0;
    for (int i = 0; i < a->nfollows && same; i++)
        same = a->z[a->follows[i]] == z[a->follows[i]];
    return same;
}

static void solve_output(ns_output_only *a, const double *z) {
    for (int i = 0; i < a->count; i++)
        a->r[i] = -a->whole->b[a->unknown[i]] - ns_linalg_csc_dot(&a->Et, i, z);
    ns_linalg_klu_solve(a->klu, a->factors, a->r);
    for (int i = 0; i < a->nfollows; i++)
        a->z[a->follows[i]] = z[a->follows[i]];
    a->solves++;
}

void ns_sparse_output_join(ns_output_only *a, const double *rest, const double *z, double *x) {
    for (int i = 0; i < a->rest.n; i++)
        x[a->stays[i]] = rest[i];
    if (a->count == 0)
        return;
    if (!is_known(a, z))
        solve_output(a, z);
    for (int i = 0; i < a->count; i++)
        x[a->unknown[i]] = a->r[i];
}
