/* src/newton/create.c - the Newton stepper: made, started, accepted, read, freed. */
#include "newton_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/row_split.h"

static void make_iterate(ns_iterate *p, size_t n, size_t m, int *failed) {
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

static int allocate(ns_newton *s) {
    const size_t n = (size_t)s->n, m = (size_t)s->m, all = n + m, nz = (size_t)s->model->nz;
    int failed = 0;
    make_iterate(&s->at, n, m, &failed);
    make_iterate(&s->next, n, m, &failed);
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

static int split(ns_newton *s) {
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
    status = allocate(s);
    if (status == NS_OK)
        status = split(s);
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

int ns_newton_fail(ns_newton *s, int status) {
    s->fault.status = (ns_status)status;
    return status;
}

static ns_mode mode_of(double lambda, double l, double u) {
    return lambda == l ? NS_LOWER : lambda == u ? NS_UPPER : NS_INSIDE;
}

static void keep(ns_newton *s) {
    memcpy(s->xk, s->at.x, sizeof(double) * (size_t)s->n);
    memcpy(s->rk, s->at.r, sizeof(double) * (size_t)s->n);
    memcpy(s->lk, s->at.lambda, sizeof(double) * (size_t)s->m);
    memcpy(s->yk, s->at.y, sizeof(double) * (size_t)s->m);
    s->has_fk = s->has_trial = 0;
}

int ns_newton_start(ns_newton *s, double t0, const double *x, const double *lambda) {
    if (!s || (!x && s->n > 0))
        return NS_E_NULL;
    s->has_trial = 0; /* s->at is written below */
    s->fault.t = t0;
    s->fault.npairs = s->fault.nunknowns = 0;
    if (!isfinite(t0) || !ns_linalg_finite((size_t)s->n, x) ||
        (lambda && !ns_linalg_finite((size_t)s->m, lambda)))
        return ns_newton_fail(s, NS_E_NUMBER);
    s->t1 = s->tr = t0;
    s->cx = 1;
    for (int i = 0; i < s->model->nz; i++)
        s->z1[i] = s->zr[i] = ns_signal_value(&s->model->z[i], t0, NS_RIGHT);
    ns_linalg_copy((size_t)s->n, x, s->at.x);
    for (int i = 0; i < s->m; i++)
        s->at.lambda[i] = fmin(fmax(lambda ? lambda[i] : 0, s->model->l[i]), s->model->u[i]);
    int status = ns_newton_values(s, &s->at);
    if (status == NS_OK)
        status = ns_newton_jacobians(s, &s->at);
    if (status != NS_OK)
        return ns_newton_fail(s, status == NS_DIVERGED ? NS_E_RANGE : status);
    memcpy(s->at.y, s->at.h, sizeof(double) * (size_t)s->m); /* (S3) */
    for (int i = 0; i < s->m; i++)
        s->mode[i] = mode_of(s->at.lambda[i], s->model->l[i], s->model->u[i]);
    keep(s);
    s->t = t0;
    s->started = 1;
    return NS_OK;
}

int ns_newton_accept(ns_newton *s) {
    if (!s)
        return NS_E_NULL;
    if (!s->has_trial)
        return NS_E_STATE;
    keep(s);
    memcpy(s->mode, s->trial_mode, (size_t)s->m);
    s->t = s->t1;
    s->counts.steps++;
    return NS_OK;
}

static void hand_out(double *to, const double *from, int count) {
    if (to)
        memcpy(to, from, sizeof(double) * (size_t)count);
}

int ns_newton_read(const ns_newton *s, double *t, double *x, double *lambda, double *y, double *r) {
    if (!s)
        return NS_E_NULL;
    if (!s->started)
        return NS_E_STATE;
    hand_out(t, &s->t, 1);
    hand_out(x, s->xk, s->n);
    hand_out(lambda, s->lk, s->m);
    hand_out(y, s->yk, s->m);
    hand_out(r, s->rk, s->n);
    return NS_OK;
}

const ns_newton_counts *ns_newton_counts_of(const ns_newton *s) {
    return &s->counts;
}

const ns_fault *ns_newton_fault(const ns_newton *s) {
    return &s->fault;
}
