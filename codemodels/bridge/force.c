/* bridge/force.c - makes ngspice's next solve return a given solution exactly.
 *
 * After all devices have loaded the matrix, it is cleared and ones are put on elements that make up a
 * permutation; the right-hand side is the solution, permuted.  The solve is exact then, whatever the
 * elements and the time step are, and no pivot can be chosen other than the ones.  The elements are a
 * perfect matching of rows and columns, diagonal ones first (they give little fill-in). */
#include "force.h"

#include <string.h>

#include "ngspice/spmatrix.h"

#include "maths/sparse/spdefs.h"

/* A matching in the making; indices are the matrix's internal ones at that time, 1..n. */
typedef struct matching {
    const struct MatrixFrame *m;
    ElementPtr *of_row; /* the element chosen in a row */
    int *seen;          /* of a row: the last search that met it */
    int search;
} matching;

/* Finds a row for column c, sending other columns elsewhere where that helps. */
static int augment(matching *g, int c) {
    for (ElementPtr e = g->m->FirstInCol[c]; e; e = e->NextInCol) {
        const int row = e->Row;
        if (g->seen[row] == g->search)
            continue;
        g->seen[row] = g->search;
        if (!g->of_row[row] || augment(g, g->of_row[row]->Col)) {
            g->of_row[row] = e;
            return 1;
        }
    }
    return 0;
}

static int is_diagonal(const struct MatrixFrame *m, ElementPtr e, int c) {
    return m->IntToExtRowMap[e->Row] == m->IntToExtColMap[c];
}

/* 1 if column c is served by its diagonal. */
static int take_diagonal(matching *g, int c) {
    for (ElementPtr e = g->m->FirstInCol[c]; e; e = e->NextInCol) {
        if (is_diagonal(g->m, e, c)) {
            g->of_row[e->Row] = e;
            return 1;
        }
    }
    return 0;
}

static int match_columns(matching *g, unsigned char *served) {
    for (int c = 1; c <= g->m->Size; c++)
        served[c] = (unsigned char)take_diagonal(g, c);
    for (int c = 1; c <= g->m->Size; c++) {
        g->search = c;
        if (!served[c] && !augment(g, c))
            return E_SINGULAR;
    }
    return OK;
}

static int choose_entries(ns_force *f, matching *g, unsigned char *served) {
    const int error = match_columns(g, served);
    for (int row = 1; row <= g->m->Size && !error; row++) {
        ElementPtr e = g->of_row[row];
        f->entry[row - 1] =
            (ns_force_entry){&e->Real, g->m->IntToExtRowMap[row], g->m->IntToExtColMap[e->Col]};
    }
    return error;
}

int ns_bridge_force_prepare(ns_force *f, SMPmatrix *matrix, int neq) {
    const size_t n = (size_t)matrix->Size;
    matching g = {.m = matrix};
    unsigned char *served = calloc(n + 1, 1);
    int error = E_NOMEM;
    ns_bridge_force_clear(f);
    f->entry = calloc(n, sizeof *f->entry);
    f->value = calloc((size_t)neq, sizeof *f->value);
    g.of_row = calloc(n + 1, sizeof(ElementPtr));
    g.seen = calloc(n + 1, sizeof *g.seen);
    if (f->entry && f->value && g.of_row && g.seen && served)
        error = choose_entries(f, &g, served);
    f->matrix = matrix;
    f->n = matrix->Size;
    free(g.of_row);
    free(g.seen);
    free(served);
    if (error)
        ns_bridge_force_clear(f);
    return error;
}

void ns_bridge_force_clear(ns_force *f) {
    free(f->entry);
    free(f->value);
    memset(f, 0, sizeof *f);
}

void ns_bridge_force_apply(const ns_force *f, double *rhs) {
    for (int c = 1; c <= f->matrix->Size; c++)
        for (ElementPtr e = f->matrix->FirstInCol[c]; e; e = e->NextInCol)
            e->Real = 0.0;
    for (int eq = 0; eq <= f->matrix->ExtSize; eq++)
        rhs[eq] = 0.0;
    for (int i = 0; i < f->n; i++) {
        *f->entry[i].element = 1.0;
        rhs[f->entry[i].row] = f->value[f->entry[i].column];
    }
}
