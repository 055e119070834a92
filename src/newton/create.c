/* src/newton/create.c - the Newton stepper: made and freed. */
#include "newton_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/row_split.h"

static void create_iterate(ns_iterate *p, size_t n, size_t m, int *failed) {
    p->block = ns_linalg_vector(5 * n + 4 * m, failed);
    if (!p->block)
        return;
    p->x = p->block;
    p->f = p->x + n;
    p->g = p->f + n;
    p->r = p->g + n;
    p->R = p->r + n;
    p->lambda = p->R + n;
    p->y = p->lambda + m;
    p->h = p->y + m;
    p->Ry = p->h + m;
}

static int create_arrays(ns_newton *s) {
    const size_t n = (size_t)s->n, m = (size_t)s->m, all = n + m, nz = (size_t)s->model->nz;
    int failed = 0;
    create_iterate(&s->at, n, m, &failed);
    create_iterate(&s->next, n, m, &failed);
    double **const square[] = {&s->T, &s->M, &s->A, &s->K, &s->W};
    for (size_t i = 0; i < sizeof square / sizeof *square; i++)
        *square[i] = ns_linalg_vector(n * n, &failed);
    double **const long_n[] = {&s->xk, &s->rk, &s->fk, &s->past, &s->xr};
    for (size_t i = 0; i < sizeof long_n / sizeof *long_n; i++)
        *long_n[i] = ns_linalg_vector(n, &failed);
    double **const long_all[] = {&s->size, &s->ext, &s->bl, &s->bu, &s->sol, &s->other};
    for (size_t i = 0; i < sizeof long_all / sizeof *long_all; i++)
        *long_all[i] = ns_linalg_vector(all, &failed);
    s->lk = ns_linalg_vector(m, &failed);
    s->yk = ns_linalg_vector(m, &failed);
    s->q = ns_linalg_vector(m, &failed);
    s->z1 = ns_linalg_vector(nz, &failed);
    s->zr = ns_linalg_vector(nz, &failed);
    s->B = ns_linalg_vector(n * m, &failed);
    s->C = ns_linalg_vector(m * n, &failed);
    s->V = ns_linalg_vector(n * m, &failed);
    s->D = ns_linalg_vector(m * m, &failed);
    s->Wm = ns_linalg_vector(m * m, &failed);
    s->G = ns_linalg_vector(all * all, &failed);
    s->work = ns_linalg_vector(n * (n > m ? n : m) + all, &failed);
    s->spare = ns_linalg_vector(3 * n + 5 * m, &failed);
    s->mode = calloc(3 * m + all + 1, sizeof(ns_mode));
    if (failed || !s->mode || ns_linalg_lu_create((int)all, &s->lu) != NS_OK ||
        ns_mlcp_create((int)all, &s->mlcp) != NS_OK)
        return NS_E_MEMORY;
    s->trial_mode = s->mode + m;
    s->next_mode = s->trial_mode + m;
    s->all_mode = s->next_mode + m;
    return NS_OK;
}

static int split_rows(ns_newton *s) {
    const int n = s->n, status = ns_linalg_row_split(n, s->model->M, s->T, &s->rank);
    if (status != NS_OK)
        return status;
    ns_linalg_row_split_apply(n, n, s->T, s->model->M, s->M);
    for (int j = 0; j < n; j++)
        for (int i = s->rank; i < n; i++)
            s->M[i + j * n] = 0; /* exactly */
    return NS_OK;
}

static int options_in_range(const ns_newton_options *o) {
    return o->theta >= 0 && o->theta <= 1 && o->gamma > 0 && o->gamma <= 1 &&
           (o->relation == NS_RELATION_END || o->relation == NS_RELATION_GAMMA) && o->tolerance >= 0 &&
           o->tolerance < 1 && o->iterations >= 0 && o->halvings >= 0;
}

int ns_newton_create(const ns_model *model, const ns_newton_options *o, ns_newton **out, ns_fault *fault) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!model || !o)
        return NS_E_NULL;
    int status = ns_model_check(model, fault);
    if (status != NS_OK)
        return status;
    if (!options_in_range(o))
        return NS_E_RANGE;
    ns_newton *s = calloc(1, sizeof *s);
    if (!s)
        return NS_E_MEMORY;
    s->model = model;
    s->o = *o;
    s->o.tolerance = o->tolerance > 0 ? o->tolerance : 1e-12;
    s->o.iterations = o->iterations > 0 ? o->iterations : 50;
    s->o.halvings = o->halvings > 0 ? o->halvings : 10;
    s->n = model->n;
    s->m = model->m;
    s->fault.t = NAN;
    status = create_arrays(s);
    if (status == NS_OK)
        status = split_rows(s);
    if (status != NS_OK) {
        ns_newton_free(s);
        return status;
    }
    *out = s;
    return NS_OK;
}

void ns_newton_free(ns_newton *s) {
    if (!s)
        return;
    double *const arrays[] = {s->T,    s->M,  s->A,    s->K,    s->W,        s->xk,         s->rk,   s->fk,
                              s->past, s->xr, s->size, s->ext,  s->bl,       s->bu,         s->sol,  s->other,
                              s->lk,   s->yk, s->q,    s->z1,   s->zr,       s->B,          s->C,    s->V,
                              s->D,    s->Wm, s->G,    s->work, s->at.block, s->next.block, s->spare};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    free(s->mode);
    ns_linalg_lu_free(s->lu);
    ns_mlcp_free(s->mlcp);
    free(s);
}
