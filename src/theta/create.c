/* src/theta/create.c - the theta-gamma stepper: made and freed. */
#include "theta_internal.h"

#include "linalg/cut_sets.h"
#include "linalg/leakage.h"
#include "linalg/row_split.h"
#include "linalg/summed_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* All arrays of numbers but K, one block; those of the accepted point follow one another. */
static int create_arrays(ns_theta *s) {
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m, nz = (size_t)s->s->nz, nc = (size_t)s->s->nc;
    const size_t size = n + m, all = size + n, q = n + nz + 1; /* at most: r = n, n unknowns held */
    const struct {
        double **array;
        size_t count;
    } list[] = {{&s->M, n * n},
                {&s->A, n * n},
                {&s->T, n * n},
                {&s->B, n * m},
                {&s->b, n},
                {&s->E, n * nz},
                {&s->unit, n},
                {&s->l, m},
                {&s->u, m},
                {&s->past.w, 3 * n + size},
                {&s->past.in, q},
                {&s->trial.in, q},
                {&s->trial.out, 2 * n + nc + 2 * m + 4},
                {&s->sum, n},
                {&s->rate[0], n},
                {&s->rate[1], n},
                {&s->X, size * q},
                {&s->R, (2 * size + 1) * q},
                {&s->Z, size * 2 * m},
                {&s->leak, m},
                {&s->rhs, all},
                {&s->sol, all},
                {&s->resid, all},
                {&s->bl, all},
                {&s->bu, all}};
    size_t sum = 0;
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        sum += (list[i].count + 1) & ~(size_t)1; /* each begins at a multiple of 16 bytes */
    s->block = calloc(sum + 1, sizeof *s->block);
    for (size_t i = 0, at = 0; s->block && i < sizeof list / sizeof *list; i++) {
        *list[i].array = s->block + at;
        at += (list[i].count + 1) & ~(size_t)1;
    }
    return s->block ? NS_OK : NS_E_MEMORY;
}

static int create_lists(ns_theta *s) {
    const size_t m = (size_t)s->s->m, all = 2 * (size_t)s->s->n + m;
    s->inside = calloc(m + all + 1, sizeof *s->inside);
    s->past.mode = calloc(2 * m + all + 1, sizeof *s->past.mode);
    if (!s->inside || !s->past.mode)
        return NS_E_MEMORY;
    s->list = s->inside + m;
    s->trial.mode = s->past.mode + m;
    s->lcp_mode = s->trial.mode + m;
    return NS_OK;
}

int ns_theta_reserve(ns_theta *s, int holds) {
    const int size = s->s->n + s->s->m + holds;
    ns_mlcp_solver *mlcp = NULL;
    ns_lu *lu = NULL;
    int failed = 0;
    if (s->K && size <= s->capacity)
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
    s->capacity = size;
    return NS_OK;
}

static int list_stored(ns_theta *s) {
    const int n = s->s->n;
    int count = 0;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < s->r; i++)
            count += s->M[i + j * n] != 0;
    s->stored = malloc(sizeof *s->stored * ((size_t)count + 1));
    if (!s->stored)
        return NS_E_MEMORY;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < s->r; i++)
            if (s->M[i + j * n] != 0)
                s->stored[s->stores++] = (ns_stored){i, j, s->M[i + j * n]};
    return NS_OK;
}

/* The system's rows, differential ones first. */
static int split_system(ns_theta *s) {
    const int n = s->s->n;
    int status = ns_system_split(s->s, s->T, &s->r);
    if (status != NS_OK)
        return status;
    ns_linalg_row_split_apply(n, n, s->T, s->s->M, s->M);
    status = ns_linalg_cut_sets(n, s->s->M, s->r, s->T, s->M);
    if (status == NS_OK)
        status = ns_linalg_leakage(n, s->s->M, s->r, s->T, s->M);
    if (status == NS_OK)
        status = ns_linalg_summed_parts(n, s->s->A, s->s->M, s->r, s->T);
    if (status != NS_OK)
        return status;
    ns_linalg_row_split_apply(n, n, s->T, s->s->A, s->A);
    ns_linalg_row_split_apply(n, s->s->m, s->T, s->s->B, s->B);
    ns_linalg_row_split_apply(n, s->s->nz, s->T, s->s->E, s->E);
    ns_linalg_row_split_apply(n, 1, s->T, s->s->b, s->b);
    for (int j = 0; j < n; j++)
        for (int i = s->r; i < n; i++)
            s->M[i + j * n] = 0; /* exactly: rounding of T M is all that could be left */
    for (int i = 0; i < s->r; i++) {
        for (int j = 0; j < n; j++)
            s->unit[i] = fmax(s->unit[i], fabs(s->M[i + j * n]));
        s->unit[i] = sqrt(s->unit[i]);
    }
    s->q = s->r + s->s->nz + 1;
    s->past.d = s->past.w + s->r;
    s->past.d_rounding = s->past.d + s->r;
    s->past.x_lambda = s->past.d_rounding + s->r;
    return list_stored(s);
}

static int in_range(const ns_theta_options *o) {
    return o->theta >= 0 && o->theta <= 1 && o->gamma > 0 && o->gamma <= 1;
}

static void free_map(void *owner, ns_mode_entry *map) {
    (void)owner;
    ns_theta_map_free((ns_map *)map);
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
    s->search_left = INFINITY;
    s->theta = o->theta;
    s->gamma = o->gamma;
    s->carry = o->theta < 1 || o->gamma < 1;
    s->maps.m = system->m;
    s->maps.limit = o->map_bytes ? o->map_bytes : (size_t)128 << 20;
    s->maps.free_entry = free_map;
    s->fault.t = NAN;
    status = create_arrays(s);
    if (status == NS_OK)
        status = create_lists(s);
    if (status == NS_OK)
        status = ns_theta_reserve(s, 0);
    if (status == NS_OK)
        status = split_system(s);
    if (status == NS_OK)
        status = ns_modes_shared_find(system, &s->shared, &s->shared_count);
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
    free(s->block);
    free(s->K);
    free(s->past.mode);
    free(s->inside);
    free(s->stored);
    free(s->shared);
    ns_modes_table_clear(&s->maps);
    ns_linalg_lu_free(s->lu);
    ns_mlcp_free(s->mlcp);
    free(s);
}
