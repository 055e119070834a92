/* src/sparse/equivalent_mode.c - switches in place of the pairs across them. */
#include "equivalent_mode.h"

#include <stdlib.h>
#include <string.h>

/* The sign of entry p of [C D] in row i over the same in row j: they agree in all of them. */
static double sign_of_y(const ns_form *f, int i, int j) {
    for (int k = f->Ct.start[i]; k < f->Ct.start[i + 1]; k++)
        for (int l = f->Ct.start[j]; l < f->Ct.start[j + 1]; l++)
            if (f->Ct.row[k] < f->n && f->Ct.row[k] == f->Ct.row[l] && f->Ct.value[k] != 0)
                return f->Ct.value[k] == f->Ct.value[l] ? 1 : -1;
    return 0;
}

/* The same of lambda, by the columns of B. */
static double sign_of_lambda(const ns_form *f, int i, int j) {
    for (int k = f->K.start[f->n + i]; k < f->K.start[f->n + i + 1]; k++)
        for (int l = f->K.start[f->n + j]; l < f->K.start[f->n + j + 1]; l++)
            if (f->K.row[k] < f->n && f->K.row[k] == f->K.row[l] && f->KA[k] != 0)
                return f->KA[k] == f->KA[l] ? 1 : -1;
    return 0;
}

int ns_sparse_equivalent_create(const ns_form *f, const ns_shared_branch *shared, int count,
                                ns_equivalents *s) {
    *s = (ns_equivalents){.m = f->m, .n = f->n};
    s->all = calloc((size_t)count + 1, sizeof *s->all);
    s->active = calloc((size_t)count + 1, sizeof *s->active);
    s->mode = calloc((size_t)f->m + 1, 1);
    s->r = calloc((size_t)f->size + 1, sizeof(double));
    if (!s->all || !s->active || !s->mode || !s->r)
        return NS_E_MEMORY;
    for (int i = 0; i < count; i++) {
        const int j = shared[i].pair, of = shared[i].of;
        const double y = sign_of_y(f, of, j), lambda = sign_of_lambda(f, of, j);
        if (y != 0 && lambda != 0 && !(ns_sparse_form_resistance(f, j) > 0))
            s->all[s->count++] = (ns_equivalent){j, of, shared[i].idle, y, lambda};
    }
    return NS_OK;
}

void ns_sparse_equivalent_free(ns_equivalents *s) {
    free(s->all);
    free(s->active);
    free(s->mode);
    free(s->r);
}

const ns_mode *ns_sparse_equivalent_mode(ns_equivalents *s, const ns_mode *mode) {
    s->active_count = 0;
    for (int i = 0; i < s->count; i++) {
        const ns_equivalent *p = &s->all[i];
        if (mode[p->pair] != NS_INSIDE || ns_mode_slides(mode[p->of]))
            continue;
        if (s->active_count == 0)
            memcpy(s->mode, mode, (size_t)s->m);
        if (s->mode[p->of] == NS_INSIDE) /* it is closed, or by another pair across it */
            continue;
        s->mode[p->of] = NS_INSIDE;
        s->mode[p->pair] = p->idle;
        s->active[s->active_count++] = i;
    }
    return s->active_count > 0 ? s->mode : mode;
}

const double *ns_sparse_equivalent_right(ns_equivalents *s, const double *r) {
    if (s->active_count == 0)
        return r;
    memcpy(s->r, r, sizeof(double) * (size_t)(s->n + s->m));
    for (int i = 0; i < s->active_count; i++) {
        const ns_equivalent *p = &s->all[s->active[i]];
        s->r[s->n + p->of] = p->y * r[s->n + p->pair];
        s->r[s->n + p->pair] = p->lambda * r[s->n + p->of];
    }
    return s->r;
}

void ns_sparse_equivalent_back(const ns_equivalents *s, double *v) {
    for (int i = 0; i < s->active_count; i++) {
        const ns_equivalent *p = &s->all[s->active[i]];
        const double lambda = v[s->n + p->of];
        v[s->n + p->of] = p->lambda * v[s->n + p->pair];
        v[s->n + p->pair] = p->lambda * lambda;
    }
}
