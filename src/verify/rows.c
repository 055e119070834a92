/* src/verify/rows.c - the matrices of a system, row by row. */
#include "verify_internal.h"

#include "system/each_entry.h"

#include <math.h>
#include <stdlib.h>

/* Entries that are put into rows: counted first, then written. */
typedef struct filling {
    ns_verify_rows *to;
    int writes; /* 0: they are counted */
    int first;  /* column of u that column 0 is */
    int across; /* 1: rows are columns */
} filling;

static void put(const filling *f, int row, int column, double value) {
    int *at = &f->to->start[row + 1]; /* while it is written: the next place of row `row` */
    if (f->writes) {
        f->to->column[*at] = column;
        f->to->value[*at] = value;
    }
    ++*at;
}

static void visit(void *context, int row, int column, double value) {
    const filling *f = context;
    if (f->across)
        put(f, column, f->first + row, value);
    else
        put(f, row, f->first + column, value);
}

static void visit_constants(const filling *f, int count, const double *value, int column) {
    for (int i = 0; i < count; i++)
        if (value[i] != 0)
            put(f, i, column, value[i]);
}

/* A matrix of `rows` rows, its first column being `first` of u. */
static void visit_matrix(filling f, const double *dense, const ns_csc *sparse, int rows, int columns,
                         int first) {
    f.first = first;
    ns_system_each_entry(dense, sparse, rows, columns, visit, &f);
}

static void visit_law(const ns_system *s, filling f) {
    const int n = s->n, m = s->m;
    visit_matrix(f, s->A, NS_CSC_OF(s, A), n, n, 0);
    visit_matrix(f, s->B, NS_CSC_OF(s, B), n, m, n);
    visit_matrix(f, s->E, NS_CSC_OF(s, E), n, s->nz, n + m);
    visit_constants(&f, n, s->b, n + m + s->nz);
}

static void visit_output(const ns_system *s, filling f) {
    const int n = s->n, m = s->m;
    visit_matrix(f, s->C, NS_CSC_OF(s, C), m, n, 0);
    visit_matrix(f, s->D, NS_CSC_OF(s, D), m, m, n);
    visit_matrix(f, s->F, NS_CSC_OF(s, F), m, s->nz, n + m);
    visit_constants(&f, m, s->e, n + m + s->nz);
}

static void visit_charge(const ns_system *s, filling f) {
    visit_matrix(f, s->M, NS_CSC_OF(s, M), s->n, s->n, 0);
}

static void visit_control(const ns_system *s, filling f) {
    const int first = s->n + s->m;
    f.across = 1;
    ns_system_each_control(s, visit, &f);
    f.first = first;
    if (s->large)
        ns_system_each_entry(NULL, &s->large->gz, s->nz, s->nc, visit, &f);
    for (int c = 0; c < s->nc; c++) {
        const ns_command *k = &s->command[c];
        for (int i = 0; !s->large && k->gz && i < s->nz; i++)
            if (k->gz[i] != 0)
                put(&f, c, first + i, k->gz[i]);
        if (k->g0 != 0)
            put(&f, c, first + s->nz, k->g0);
    }
}

static void find_sizes(ns_verify_rows *r, int constant) {
    for (int i = 0; i < r->count; i++)
        for (int k = r->start[i]; k < r->start[i + 1]; k++)
            r->size[i] += r->column[k] == constant ? 0 : fabs(r->value[k]);
}

typedef void visit_all(const ns_system *s, filling f);

static int create(const ns_system *s, visit_all *all, int count, ns_verify_rows *r) {
    r->count = count;
    r->start = calloc((size_t)count + 2, sizeof *r->start);
    if (!r->start)
        return NS_E_MEMORY;
    all(s, (filling){r, 0, 0, 0}); /* start[i+1]: entries of row i */
    int entries = 0;
    for (int i = 0; i < count; i++) { /* where row i begins */
        const int own = r->start[i + 1];
        r->start[i + 1] = entries;
        entries += own;
    }
    r->column = calloc((size_t)entries + 1, sizeof *r->column);
    r->value = calloc((size_t)entries + 1, sizeof *r->value);
    r->size = calloc((size_t)count + 1, sizeof *r->size);
    if (!r->column || !r->value || !r->size)
        return NS_E_MEMORY;
    all(s, (filling){r, 1, 0, 0}); /* start[i+1]: where it ends */
    find_sizes(r, s->n + s->m + s->nz);
    return NS_OK;
}

int ns_verify_rows_create(ns_verify *v) {
    const ns_system *s = v->s;
    int status = create(s, visit_law, s->n, &v->law);
    if (status == NS_OK)
        status = create(s, visit_output, s->m, &v->output);
    if (status == NS_OK)
        status = create(s, visit_charge, s->n, &v->charge);
    return status == NS_OK ? create(s, visit_control, s->nc, &v->control) : status;
}

static void destroy(ns_verify_rows *r) {
    free(r->start);
    free(r->column);
    free(r->value);
    free(r->size);
}

void ns_verify_rows_free(ns_verify *v) {
    destroy(&v->law);
    destroy(&v->output);
    destroy(&v->charge);
    destroy(&v->control);
}
