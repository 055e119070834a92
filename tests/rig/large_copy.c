/* tests/rig/large_copy.c - see large_copy.h. */
#include "large_copy.h"

#include <stdlib.h>
#include <string.h>

#include "linalg/sparse.h"

static void must(int status) {
    if (status != NS_OK)
        abort();
}

/* The controls as columns. */
static void pack(const ns_system *s, int state, int rows, ns_csc *out) {
    double *columns = calloc((size_t)rows * (size_t)s->nc + 1, sizeof *columns);
    if (!columns)
        abort();
    for (int c = 0; c < s->nc; c++) {
        const double *from = state ? s->command[c].gx : s->command[c].gz;
        if (from)
            memcpy(columns + c * rows, from, sizeof *from * (size_t)rows);
    }
    must(ns_linalg_csc_of_dense(rows, s->nc, columns, out));
    free(columns);
}

ns_system *large_copy(const ns_system *s) {
    const int n = s->n, m = s->m;
    ns_system *to;
    must(ns_system_create_large(n, m, s->nz, s->nc, &to));
    ns_large *a = to->large;
    must(ns_linalg_csc_of_dense(n, n, s->M, &a->M));
    must(ns_linalg_csc_of_dense(n, n, s->A, &a->A));
    must(ns_linalg_csc_of_dense(n, m, s->B, &a->B));
    must(ns_linalg_csc_of_dense(m, n, s->C, &a->C));
    must(ns_linalg_csc_of_dense(m, m, s->D, &a->D));
    must(ns_linalg_csc_of_dense(n, s->nz, s->E, &a->E));
    must(ns_linalg_csc_of_dense(m, s->nz, s->F, &a->F));
    pack(s, 1, n, &a->gx);
    pack(s, 0, s->nz, &a->gz);
    for (int i = 0; i < n; i++)
        to->b[i] = s->b[i];
    for (int j = 0; j < m; j++) {
        to->e[j] = s->e[j];
        to->l[j] = s->l[j];
        to->u[j] = s->u[j];
    }
    for (int i = 0; i < s->nz; i++)
        must(ns_system_set_input(to, i, &s->z[i]));
    for (int c = 0; c < s->nc; c++) {
        to->command[c] = s->command[c];
        to->command[c].gx = to->command[c].gz = NULL;
    }
    return to;
}
