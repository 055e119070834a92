/* src/verify/aside.c - unknowns that no charge, no device and no control depends on, as the currents of
 * sources: what is looked at in a hurry may be without them.
 */
#include "verify_internal.h"

#include "system/union_find.h"

#include <stdlib.h>

/* Row i and the unknowns in it, as one part. */
static void join(const ns_verify_rows *r, int n, int *of) {
    for (int i = 0; i < n; i++)
        for (int k = r->start[i]; k < r->start[i + 1]; k++)
            if (r->column[k] < n)
                ns_system_union_join(of, i, r->column[k]);
}

/* The parts of unknowns in these rows are used; by_row: also those of rows that hold others than unknowns,
 * between n and until. */
static void mark(const ns_verify_rows *r, int n, int until, int by_row, int *of, unsigned char *used) {
    for (int i = 0; i < r->count; i++)
        for (int k = r->start[i]; k < r->start[i + 1]; k++)
            if (r->column[k] < n && !by_row)
                used[ns_system_union_top(of, r->column[k])] = 1;
            else if (by_row && r->column[k] >= n && r->column[k] < until)
                used[ns_system_union_top(of, i)] = 1;
}

int ns_verify_aside_find(ns_verify *v) {
    const int n = v->s->n, m = v->s->m;
    int *of = calloc((size_t)n + 1, sizeof *of);
    unsigned char *used = calloc((size_t)n + 1, 1);
    if (of && used) {
        ns_system_union_begin(of, n);
        join(&v->law, n, of);
        join(&v->charge, n, of);
        mark(&v->law, n, n + m, 1, of, used);
        mark(&v->output, n, n, 0, of, used);
        mark(&v->charge, n, n, 0, of, used);
        mark(&v->control, n, n, 0, of, used);
        for (int i = 0; i < n; i++)
            v->is_aside[i] = !used[ns_system_union_top(of, i)];
    }
    const int status = of && used ? NS_OK : NS_E_MEMORY;
    free(of);
    free(used);
    return status;
}
