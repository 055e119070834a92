/* src/sparse/packed_laws.c - laws of pairs, packed. */
#include "packed_laws.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int ns_sparse_laws_create(int pairs, ns_packed_laws *k) {
    const size_t m = (size_t)pairs, terms = NS_LAW_TERMS;
    *k = (ns_packed_laws){.count = pairs};
    k->at = calloc((terms + 1) * m + 1, sizeof(int));
    k->by = calloc((terms + 1) * m + 1, sizeof(double));
    if (!k->at || !k->by)
        return NS_E_MEMORY;
    k->other = k->at + terms * m;
    k->constant = k->by + terms * m;
    return NS_OK;
}

void ns_sparse_laws_free(ns_packed_laws *k) {
    free(k->at);
    free(k->by);
}

/* sign y_j; lambda_j stays at its bound.  0: too many terms. */
static int pack_voltage(const ns_form *f, int j, double sign, double bound, int *at, double *by,
                        double *constant) {
    int terms = 0;
    *constant = sign * f->e[j];
    if (f->Ft.start[j + 1] > f->Ft.start[j])
        return 0;
    for (int k = f->Ct.start[j]; k < f->Ct.start[j + 1]; k++) {
        if (f->Ct.row[k] == f->n + j) {
            *constant += sign * f->Ct.value[k] * bound;
        } else if (terms == NS_LAW_TERMS) {
            return 0;
        } else {
            at[terms] = f->Ct.row[k];
            by[terms++] = sign * f->Ct.value[k];
        }
    }
    return 1;
}

/* 0: it is one of the others. */
static int pack_law(const ns_form *f, ns_mode mode, int j, double l, double u, int *at, double *by,
                    double *constant) {
    if (ns_mode_slides(mode) || (mode == NS_INSIDE && isfinite(l) && isfinite(u)))
        return 0;
    if (mode == NS_INSIDE && (isfinite(l) || isfinite(u))) {
        at[0] = f->n + j;
        by[0] = isfinite(l) ? 1 : -1;
        *constant = isfinite(l) ? -l : u;
    } else if (mode != NS_INSIDE && l < u) {
        const double sign = mode == NS_LOWER ? 1 : -1;
        return pack_voltage(f, j, sign, mode == NS_LOWER ? l : u, at, by, constant);
    }
    return 1;
}

void ns_sparse_laws_set(ns_packed_laws *k, const ns_form *f, const ns_mode *mode, const double *l,
                        const double *u) {
    const size_t all = NS_LAW_TERMS * (size_t)k->count;
    memset(k->at, 0, sizeof(int) * all);
    memset(k->by, 0, sizeof(double) * all);
    k->others = 0;
    for (int j = 0; j < k->count; j++) {
        int *at = k->at + NS_LAW_TERMS * j;
        double *by = k->by + NS_LAW_TERMS * j;
        k->constant[j] = 0;
        if (pack_law(f, mode[j], j, l[j], u[j], at, by, &k->constant[j]))
            continue;
        memset(by, 0, sizeof *by * NS_LAW_TERMS);
        k->constant[j] = 0;
        k->other[k->others++] = j;
    }
}

int ns_sparse_laws_hold(const ns_packed_laws *k, const double *v) {
    const int *at = k->at;
    const double *by = k->by;
    int broken = 0;
    for (int j = 0; j < k->count; j++) {
        const double a = by[2 * j] * v[at[2 * j]], b = by[2 * j + 1] * v[at[2 * j + 1]];
        broken |= !(k->constant[j] + (a + b) >= 0);
    }
    return !broken;
}
