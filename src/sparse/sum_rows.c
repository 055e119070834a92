/* src/sparse/sum_rows.c - the rows of (P2) that are sums of parts (leaky_parts.c), and lambda in them.
 *
 * While all devices block that lead out of a part nothing but their leaks is in its sum.  Beside these the
 * lambda of a device, 1, is large, and pivots for it that other rows of the part have would bring back into
 * the sum what was added up to nothing.  So a lambda that its own row gives, as it is at a bound, is left
 * out.
 */
#include "assemble.h"

#include <stdlib.h>

int ns_sparse_sums_put(const ns_csc *sums, int n, ns_csc *At) {
    ns_entries e = {0};
    ns_csc out = {0};
    if (!sums->start)
        return NS_OK;
    for (int i = 0; i < n; i++) {
        const int is_sum = sums->start[i + 1] > sums->start[i];
        for (int k = At->start[i]; k < At->start[i + 1]; k++)
            if (!is_sum || At->row[k] >= n)
                ns_linalg_entries_add(&e, At->row[k], i, At->value[k]);
        for (int k = sums->start[i]; k < sums->start[i + 1]; k++)
            ns_linalg_entries_add(&e, sums->row[k], i, sums->value[k]);
    }
    const int status = ns_linalg_csc_of_entries(At->rows, n, &e, &out);
    ns_linalg_entries_free(&e);
    if (status == NS_OK) {
        ns_linalg_csc_free(At);
        *At = out;
    }
    return status;
}

int ns_sparse_sums_find(ns_form *f, const ns_csc *sums) {
    int count = 0;
    if (!sums->start)
        return NS_OK;
    f->summed = calloc((size_t)f->m + 2 + 2 * (size_t)f->K.start[f->size], sizeof *f->summed);
    if (!f->summed)
        return NS_E_MEMORY;
    f->summed_place = f->summed + f->m + 1;
    f->summed_row = f->summed_place + f->K.start[f->size];
    for (int j = 0; j < f->m; j++) {
        for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
            const int i = f->K.row[k];
            if (i < f->n && sums->start[i + 1] > sums->start[i] && f->KA[k] != 0) {
                f->summed_row[count] = i;
                f->summed_place[count++] = k;
            }
        }
        f->summed[j + 1] = count;
    }
    return NS_OK;
}

/* 1 if lambda of a pair is given. */
static int is_known(ns_mode mode) {
    return mode != NS_INSIDE && !ns_mode_slides(mode);
}

void ns_sparse_sums_value(const ns_form *f, ns_mode mode, int j, double *value) {
    for (int p = f->summed ? f->summed[j] : 0; f->summed && p < f->summed[j + 1]; p++)
        value[f->summed_place[p]] = is_known(mode) ? 0 : -f->KA[f->summed_place[p]];
}

static void add_known(const ns_form *f, const ns_mode *mode, double sign, const double *v, double *r) {
    for (int j = 0; f->summed && j < f->m; j++)
        for (int p = f->summed[j]; p < f->summed[j + 1] && is_known(mode[j]); p++)
            r[f->summed_row[p]] += sign * f->KA[f->summed_place[p]] * v[f->n + j];
}

void ns_sparse_form_move_known(const ns_form *f, const ns_mode *mode, double *r) {
    add_known(f, mode, 1, r, r);
}

void ns_sparse_form_leave_known(const ns_form *f, const ns_mode *mode, const double *v, double *r) {
    add_known(f, mode, -1, v, r);
}
