/* src/system/dense_copy.c - the matrices of a large system, written out. */
#include "dense_copy.h"

#include "linalg/dense.h"

#include <stdlib.h>

static void copy_entries(const ns_csc *from, double *to) {
    for (int j = 0; j < from->columns; j++)
        for (int k = from->start[j]; k < from->start[j + 1]; k++)
            to[(size_t)from->row[k] + (size_t)j * (size_t)from->rows] = from->value[k];
}

/* Column c as an array; NULL where it is empty.  Errors: MEMORY. */
static int copy_column(const ns_csc *from, int c, double **to) {
    if (from->start[c + 1] == from->start[c])
        return NS_OK;
    *to = calloc((size_t)from->rows + 1, sizeof(double));
    for (int k = from->start[c]; *to && k < from->start[c + 1]; k++)
        (*to)[from->row[k]] = from->value[k];
    return *to ? NS_OK : NS_E_MEMORY;
}

static int copy_commands(const ns_system *s, ns_system *to) {
    int status = NS_OK;
    for (int c = 0; c < s->nc && status == NS_OK; c++) {
        to->command[c] = s->command[c];
        to->command[c].gx = to->command[c].gz = NULL;
        status = copy_column(&s->large->gx, c, &to->command[c].gx);
        if (status == NS_OK)
            status = copy_column(&s->large->gz, c, &to->command[c].gz);
    }
    return status;
}

int ns_system_dense_copy(const ns_system *s, ns_system **out) {
    const ns_large *a = s->large;
    ns_system *to;
    int status = ns_system_create(s->n, s->m, s->nz, s->nc, &to);
    *out = NULL;
    if (status != NS_OK)
        return status;
    copy_entries(&a->M, to->M);
    copy_entries(&a->A, to->A);
    copy_entries(&a->B, to->B);
    copy_entries(&a->C, to->C);
    copy_entries(&a->D, to->D);
    copy_entries(&a->E, to->E);
    copy_entries(&a->F, to->F);
    ns_linalg_copy((size_t)s->n, s->b, to->b);
    ns_linalg_copy((size_t)s->m, s->e, to->e);
    ns_linalg_copy((size_t)s->m, s->l, to->l);
    ns_linalg_copy((size_t)s->m, s->u, to->u);
    for (int k = 0; k < s->nz && status == NS_OK; k++)
        status = ns_system_set_input(to, k, &s->z[k]);
    if (status == NS_OK)
        status = copy_commands(s, to);
    if (status != NS_OK) {
        ns_system_free(to);
        return status;
    }
    *out = to;
    return NS_OK;
}
