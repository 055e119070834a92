/* bridge/force.c - makes ngspice's next solve return a given solution exactly.
 *
 * After all devices have loaded the matrix, it is cleared and ones are put on elements that make up a
 * permutation; the right-hand side is the solution, permuted.  The solve is exact then, whatever the
 * elements and the time step are, and no pivot can be chosen other than the ones.  The elements are a
 * perfect matching of rows and columns, diagonal ones first (they give little fill-in).  KLU factors blocks
 * of the matrix, which were chosen by its structure: all elements of a perfect matching lie inside them. */
#include "force.h"

#include <string.h>

/* A matching in the making. */
typedef struct matching {
    const ns_matrix_columns *m;
    int *of_row;    /* the element chosen in a row, -1: none */
    int *column_of; /* the column of that element */
    int unserved;   /* the column that found none */
    int *seen;      /* of a row: the last search that met it, from 1 on */
    int search;
} matching;

static int choose(matching *g, int k, int column) {
    const int row = g->m->element[k].row;
    g->of_row[row] = k;
    g->column_of[row] = column;
    return 1;
}

/* Finds a row for column c, sending other columns elsewhere where that helps. */
static int augment(matching *g, int c) {
    for (int k = g->m->begin[c]; k < g->m->begin[c + 1]; k++) {
        const int row = g->m->element[k].row;
        if (g->seen[row] == g->search)
            continue;
        g->seen[row] = g->search;
        if (g->of_row[row] < 0 || augment(g, g->column_of[row]))
            return choose(g, k, c);
    }
    return 0;
}

/* 1 if column c is served by its diagonal. */
static int take_diagonal(matching *g, int c) {
    for (int k = g->m->begin[c]; k < g->m->begin[c + 1]; k++)
        if (g->m->row_number[g->m->element[k].row] == g->m->column_number[c])
            return choose(g, k, c);
    return 0;
}

static int match_columns(matching *g, unsigned char *served) {
    for (int c = 0; c < g->m->n; c++)
        g->of_row[c] = -1;
    for (int c = 0; c < g->m->n; c++)
        served[c] = (unsigned char)take_diagonal(g, c);
    for (int c = 0; c < g->m->n; c++) {
        g->search = c + 1;
        if (!served[c] && !augment(g, c)) {
            g->unserved = c;
            return E_SINGULAR;
        }
    }
    return OK;
}

static int choose_entries(ns_force *f, matching *g, unsigned char *served) {
    const int error = match_columns(g, served);
    for (int row = 0; row < g->m->n && !error; row++)
        f->entry[row] = (ns_force_entry){g->m->element[g->of_row[row]].value, g->m->row_number[row],
                                         g->m->column_number[g->column_of[row]]};
    return error;
}

/* *unserved: where it is E_SINGULAR, the equation number of an unknown without a row. */
static int match(ns_force *f, int *unserved) {
    const size_t n = (size_t)f->columns.n;
    matching g = {.m = &f->columns};
    unsigned char *served = calloc(n + 1, 1);
    int error = E_NOMEM;
    f->entry = calloc(n + 1, sizeof *f->entry);
    g.of_row = calloc(n + 1, sizeof *g.of_row);
    g.column_of = calloc(n + 1, sizeof *g.column_of);
    g.seen = calloc(n + 1, sizeof *g.seen);
    if (f->entry && g.of_row && g.column_of && g.seen && served)
        error = choose_entries(f, &g, served);
    *unserved = f->columns.column_number[g.unserved];
    free(g.of_row);
    free(g.column_of);
    free(g.seen);
    free(served);
    return error;
}

int ns_bridge_force_prepare(ns_force *f, const SMPmatrix *matrix, int neq, int *unserved) {
    int error;
    ns_bridge_force_clear(f);
    error = ns_bridge_matrix_columns_read(&f->columns, matrix);
    if (!error)
        f->value = calloc((size_t)neq, sizeof *f->value);
    error = error ? error : f->value ? match(f, unserved) : E_NOMEM;
    if (error)
        ns_bridge_force_clear(f);
    return error;
}

void ns_bridge_force_clear(ns_force *f) {
    ns_bridge_matrix_columns_clear(&f->columns);
    free(f->entry);
    free(f->value);
    memset(f, 0, sizeof *f);
}

void ns_bridge_force_apply(const ns_force *f, double *rhs) {
    const ns_matrix_columns *m = &f->columns;
    for (int k = 0; k < m->begin[m->n]; k++) /* fill-in is zero: ngspice cleared it, and no device loads it */
        *m->element[k].value = 0.0;
    rhs[0] = 0.0;
    for (int i = 0; i < m->n; i++) {
        *f->entry[i].element = 1.0;
        rhs[f->entry[i].row] = f->value[f->entry[i].column];
    }
}
