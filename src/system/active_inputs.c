/* src/system/active_inputs.c - which inputs anything that happens depends on.
 *
 * Rows and unknowns that an entry of the system joins belong to one island (union-find).  An island in which
 * nothing is a state, a law, or a command by the state only follows its inputs.
 */
#include "active_inputs.h"
#include "union_find.h"

#include <stdlib.h>

/* Elements of the union-find: n rows of (S1), m rows of (S3), n + m unknowns. */
typedef struct islands {
    int n, m;
    int *of; /* 2 (n+m) */
} islands;

static int top_of(const islands *a, int i) {
    return ns_system_union_top(a->of, i);
}

static void join_unknown(const islands *a, int row, int unknown) {
    ns_system_union_join(a->of, row, a->n + a->m + unknown);
}

static void join_entries(const islands *a, const double *e, int rows, int columns, int first_row,
                         int first_column) {
    for (int j = 0; j < columns; j++)
        for (int i = 0; i < rows; i++)
            if (e[i + j * rows] != 0)
                join_unknown(a, first_row + i, first_column + j);
}

static void mark_alive(const islands *a, int node, unsigned char *alive) {
    alive[top_of(a, node)] = 1;
}

static void mark_states(const islands *a, const ns_system *s, unsigned char *alive) {
    for (int j = 0; j < s->n; j++)
        for (int i = 0; i < s->n; i++)
            if (s->M[i + j * s->n] != 0)
                mark_alive(a, i, alive);
}

/* Pairs but those of commands by time; and what commands by the state look at. */
static void mark_laws(const islands *a, const ns_system *s, unsigned char *alive, unsigned char *commanded) {
    for (int c = 0; c < s->nc; c++) {
        commanded[s->command[c].pair] = 1;
        for (int j = 0; s->command[c].gx && j < s->n; j++)
            if (s->command[c].gx[j] != 0)
                mark_alive(a, s->n + s->m + j, alive);
    }
    for (int j = 0; j < s->m; j++)
        if (!commanded[j])
            mark_alive(a, s->n + j, alive);
}

static int is_active(const islands *a, const ns_system *s, const unsigned char *alive, int k) {
    for (int i = 0; i < s->n; i++)
        if (s->E[i + k * s->n] != 0 && alive[top_of(a, i)])
            return 1;
    for (int j = 0; j < s->m; j++)
        if (s->F[j + k * s->m] != 0 && alive[top_of(a, s->n + j)])
            return 1;
    for (int c = 0; c < s->nc; c++)
        if (s->command[c].gx && s->command[c].gz && s->command[c].gz[k] != 0)
            return 1;
    return 0;
}

int ns_system_active_inputs(const ns_system *s, unsigned char *active) {
    const int n = s->n, m = s->m;
    islands a = {n, m, malloc(sizeof(int) * 2 * ((size_t)n + (size_t)m + 1))};
    unsigned char *alive = calloc(2 * (size_t)n + 3 * (size_t)m + 1, 1);
    if (!a.of || !alive) {
        free(a.of);
        free(alive);
        return NS_E_MEMORY;
    }
    ns_system_union_begin(a.of, 2 * (n + m));
    join_entries(&a, s->M, n, n, 0, 0);
    join_entries(&a, s->A, n, n, 0, 0);
    join_entries(&a, s->B, n, m, 0, n);
    join_entries(&a, s->C, m, n, n, 0);
    join_entries(&a, s->D, m, m, n, n);
    mark_states(&a, s, alive);
    mark_laws(&a, s, alive, alive + 2 * (n + m));
    for (int k = 0; k < s->nz; k++)
        active[k] = (unsigned char)is_active(&a, s, alive, k);
    free(a.of);
    free(alive);
    return NS_OK;
}
