/* src/theta/create.c - the theta-gamma stepper: made and freed. */
#include "theta_internal.h"

#include "linalg/row_split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ns_mode *modes(size_t count, int *failed) {
    ns_mode *v = calloc(count ? count : 1, sizeof(ns_mode));
    *failed |= !v;
    return v;
}

static int allocate(ns_theta *s) {
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m, nz = (size_t)s->s->nz, nc = (size_t)s->s->nc;
    const size_t all = 2 * n + m, q = n + nz + 1; /* as many holds as unknowns, r <= n */
    const size_t size = n + m;
    int failed = 0;
    s->M = ns_linalg_vector(n * n, &failed);
    s->A = ns_linalg_vector(n * n, &failed);
    s->T = ns_linalg_vector(n * n, &failed);
    s->B = ns_linalg_vector(n * m, &failed);
    s->b = ns_linalg_vector(n, &failed);
    s->E = ns_linalg_vector(n * nz, &failed);
    s->l = ns_linalg_vector(m, &failed);
    s->u = ns_linalg_vector(m, &failed);
    s->w = ns_linalg_vector(n, &failed);
    s->d = ns_linalg_vector(n, &failed);
    s->d_noise = ns_linalg_vector(n, &failed);
    s->sum = ns_linalg_vector(n, &failed);
    s->rate[0] = ns_linalg_vector(n, &failed);
    s->rate[1] = ns_linalg_vector(n, &failed);
    s->in = ns_linalg_vector(q, &failed);
    s->at = ns_linalg_vector(n + m, &failed);
    s->trial_in = ns_linalg_vector(q, &failed);
    s->out = ns_linalg_vector(2 * n + nc + 2 * m + 4, &failed);
    s->X = ns_linalg_vector(size * q, &failed);
    s->R = ns_linalg_vector((2 * size + 1) * q, &failed);
    s->Z = ns_linalg_vector(size * 2 * m, &failed);
    s->leak = ns_linalg_vector(m, &failed);
    s->rhs = ns_linalg_vector(all, &failed);
    s->sol = ns_linalg_vector(all, &failed);
    s->resid = ns_linalg_vector(all, &failed);
    s->bl = ns_linalg_vector(all, &failed);
    s->bu = ns_linalg_vector(all, &failed);
    s->control = ns_linalg_vector(nc, &failed);
    s->mode = modes(m, &failed);
    s->trial_mode = modes(m, &failed);
    s->work_mode = modes(all, &failed);
    s->inside = calloc(m + all + 1, sizeof(int));
    failed |= !s->inside;
    s->list = s->inside ? s->inside + m : NULL;
    return failed ? NS_E_MEMORY : ns_theta_room(s, 0);
}

int ns_theta_room(ns_theta *s, int holds) {
    const int size = s->s->n + s->s->m + holds;
    ns_mlcp_solver *mlcp = NULL;
    ns_lu *lu = NULL;
    int failed = 0;
    if (s->K && size <= s->room)
        return NS_OK;
    double *K = ns_linalg_vector((size_t)size * (size_t)size, &failed);
    if (failed || ns_linalg_lu_create(size, &lu) != NS_OK || ns_mlcp_create(size, &mlcp) != NS_OK ||
        ns_mlcp_alike(mlcp, 1) != NS_OK) {
        free(K);
        ns_linalg_lu_free(lu);
        ns_mlcp_free(mlcp);
        return NS_E_MEMORY;
    }
    free(s->K);
    ns_linalg_lu_free(s->lu);
    ns_mlcp_free(s->mlcp);
    s->K = K;
    s->lu = lu;
    s->mlcp = mlcp;
    s->room = size;
    return NS_OK;
}

static int split(ns_theta *s) {
    const int n = s->s->n;
    const int status = ns_system_split(s->s, s->T, &s->r);
    if (status != NS_OK)
        return status;
    ns_linalg_row_split_apply(n, n, s->T, s->s->M, s->M);
    ns_linalg_row_split_apply(n, n, s->T, s->s->A, s->A);
    ns_linalg_row_split_apply(n, s->s->m, s->T, s->s->B, s->B);
    ns_linalg_row_split_apply(n, s->s->nz, s->T, s->s->E, s->E);
    ns_linalg_row_split_apply(n, 1, s->T, s->s->b, s->b);
    for (int j = 0; j < n; j++)
        for (int i = s->r; i < n; i++)
            s->M[i + j * n] = 0; /* exactly: rounding of T M is all that could be left */
    s->q = s->r + s->s->nz + 1;
    return NS_OK;
}

static int in_range(const ns_theta_options *o) {
    return o->theta >= 0 && o->theta <= 1 && o->gamma > 0 && o->gamma <= 1;
}

int ns_theta_create(const ns_system *system, const ns_theta_options *o, ns_theta **out, ns_fault *fault) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!system || !o)
        return NS_E_NULL;
    int status = ns_system_check(system, fault);
    if (status != NS_OK)
        return status;
    if (!in_range(o))
        return NS_E_RANGE;
    if (system->large)
        return NS_E_SIZE;
    ns_theta *s = calloc(1, sizeof *s);
    if (!s)
        return NS_E_MEMORY;
    s->s = system;
    s->theta = o->theta;
    s->gamma = o->gamma;
    s->carry = o->theta < 1 || o->gamma < 1;
    s->cache.limit = o->map_bytes ? o->map_bytes : (size_t)32 << 20;
    s->fault.t = NAN;
    status = allocate(s);
    if (status == NS_OK)
        status = split(s);
    if (status == NS_OK)
        status = ns_modes_shared_find(system, &s->twin, &s->twins);
    if (status != NS_OK) {
        ns_theta_free(s);
        return status;
    }
    *out = s;
    return NS_OK;
}

void ns_theta_free(ns_theta *s) {
    if (!s)
        return;
    double *const arrays[] = {s->M,     s->A,    s->T,   s->B,        s->b,   s->E,       s->l,       s->u,
                              s->w,     s->d,    s->in,  s->trial_in, s->out, s->K,       s->X,       s->R,
                              s->Z,     s->leak, s->rhs, s->d_noise,  s->sum, s->rate[0], s->rate[1], s->sol,
                              s->resid, s->bl,   s->bu,  s->control,  s->at};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    free(s->mode);
    free(s->trial_mode);
    free(s->work_mode);
    free(s->inside);
    free(s->twin);
    ns_theta_cache_clear(&s->cache);
    ns_linalg_lu_free(s->lu);
    ns_mlcp_free(s->mlcp);
    free(s);
}
