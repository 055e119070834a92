/* src/system/each_entry.c - the entries of a system that are not zero, dense or large, one by one. */
#include "each_entry.h"

void ns_system_each_entry(const double *dense, const ns_csc *sparse, int rows, int columns, ns_visit *visit,
                          void *context) {
    for (int j = 0; sparse && j < columns; j++)
        for (int k = sparse->start[j]; k < sparse->start[j + 1]; k++)
            if (sparse->value[k] != 0)
                visit(context, sparse->row[k], j, sparse->value[k]);
    for (int j = 0; dense && j < columns; j++)
        for (int i = 0; i < rows; i++)
            if (dense[(size_t)i + (size_t)j * (size_t)rows] != 0)
                visit(context, i, j, dense[(size_t)i + (size_t)j * (size_t)rows]);
}

/* Controls: rows are unknowns, columns commands. */
void ns_system_each_control(const ns_system *s, ns_visit *visit, void *context) {
    if (s->large) {
        ns_system_each_entry(NULL, &s->large->gx, s->n, s->nc, visit, context);
        return;
    }
    for (int c = 0; c < s->nc; c++)
        for (int j = 0; s->command[c].gx && j < s->n; j++)
            if (s->command[c].gx[j] != 0)
                visit(context, j, c, s->command[c].gx[j]);
}
