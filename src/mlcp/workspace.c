/* src/mlcp/workspace.c - all memory of a solver, taken once: three blocks and the room for the factors. */
#include "mlcp_internal.h"

#include <stdlib.h>
#include <string.h>

#include "mlcp/verify/residual.h"

static void carve_doubles(ns_mlcp_solver *s, size_t m) {
    double *d = s->doubles;
    double **square[] = {&s->regularised.W, &s->elim.A, &s->elim.mag, &s->own.W};
    double **vector[] = {&s->q,
                         &s->regularised.q,
                         &s->regularised.value,
                         &s->kept.lambda,
                         &s->kept.y,
                         &s->units.rowmax,
                         &s->units.column,
                         &s->lambda,
                         &s->y,
                         &s->ysize,
                         &s->lsize,
                         &s->g,
                         &s->tab.beta,
                         &s->tab.lo,
                         &s->tab.hi,
                         &s->tab.cover,
                         &s->ray,
                         &s->proof.v,
                         &s->own.l,
                         &s->own.u,
                         &s->own.q,
                         &s->transform.yterms,
                         &s->transform.lterms,
                         &s->transform.largest,
                         &s->factored.centre,
                         &s->noted.lambda};
    for (size_t i = 0; i < sizeof square / sizeof *square; i++, d += m * m)
        *square[i] = d;
    for (size_t i = 0; i < sizeof vector / sizeof *vector; i++, d += m)
        *vector[i] = d;
    s->G = d;
    s->rhs = s->G + (m + 1) * (m + 1);
    s->xs = s->rhs + (m + 1) * (m + 2) + NS_MEASURE_WORK * m; /* small m: residual.c needs more */
    s->tab.T = s->xs + (m + 1) * (m + 2);
    s->tab.unit = s->tab.T + m * (m + 1);
    s->transform.P = s->tab.unit + 2 * m + 1;
}

static size_t count_doubles(size_t m) {
    return 4 * m * m + 26 * m + (m + 1) * (m + 1) + 2 * (m + 1) * (m + 2) + NS_MEASURE_WORK * m +
           m * (m + 1) + 2 * m + 1 + m * (m + 3);
}

static void carve_ints(ns_mlcp_solver *s, size_t m) {
    int *d = s->ints;
    int **vector[] = {&s->free,
                      &s->pair,
                      &s->fixed,
                      &s->rows,
                      &s->cols,
                      &s->tab.rowvar,
                      &s->tab.colvar,
                      &s->elim.row_exp,
                      &s->elim.col_exp,
                      &s->queue,
                      &s->elim.stuck_row,
                      &s->elim.stuck_col,
                      &s->elim.parent,
                      &s->regularised.row,
                      &s->regularised.col,
                      &s->units.part,
                      &s->transform.pair,
                      &s->transform.place,
                      &s->scale.row,
                      &s->scale.col};
    for (size_t i = 0; i < sizeof vector / sizeof *vector; i++, d += m + 1)
        *vector[i] = d;
    s->tab.where = d; /* 2m+1 */
}

int ns_mlcp_create(int m, ns_mlcp_solver **out) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (m < 0 || m > 20000) /* keeps m*m within int */
        return NS_E_SIZE;
    ns_mlcp_solver *s = calloc(1, sizeof *s);
    if (!s)
        return NS_E_MEMORY;
    size_t k = (size_t)m;
    s->cap = m;
    s->most = INFINITY;
    s->doubles = calloc(count_doubles(k), sizeof *s->doubles);
    s->ints = calloc(20 * (k + 1) + 2 * k + 1, sizeof *s->ints);
    s->bytes = calloc(k * k * sizeof(short) + 11 * (k + 1), 1);
    if (!s->doubles || !s->ints || !s->bytes || ns_linalg_lu_create(m + 1, &s->lu) != NS_OK) {
        ns_mlcp_free(s);
        return NS_E_MEMORY;
    }
    carve_doubles(s, k);
    carve_ints(s, k);
    s->elim.e = (short *)(void *)s->bytes; /* first: calloc aligns it */
    unsigned char *b = s->bytes + k * k * sizeof(short);
    s->tab.first_y = b;
    s->elim.rowdone = b + (k + 1);
    s->elim.coldone = b + 2 * (k + 1);
    s->mode = (ns_mode *)(b + 3 * (k + 1));
    s->tab.at_upper = (signed char *)(b + 4 * (k + 1));
    s->kept.mode = (ns_mode *)(b + 5 * (k + 1));
    s->own.have = b + 6 * (k + 1);
    s->transform.basic = b + 7 * (k + 1);
    s->factored.inside = b + 8 * (k + 1);
    s->noted.mode = (ns_mode *)(b + 9 * (k + 1));
    s->lowest = (ns_mode *)(b + 10 * (k + 1));
    *out = s;
    return NS_OK;
}

void ns_mlcp_free(ns_mlcp_solver *s) {
    if (!s)
        return;
    ns_linalg_lu_free(s->lu);
    free(s->doubles);
    free(s->ints);
    free(s->bytes);
    free(s);
}

void ns_mlcp_save(const ns_mlcp_solver *s, ns_mlcp_point *to) {
    const size_t m = (size_t)s->m;
    memcpy(to->lambda, s->lambda, m * sizeof *to->lambda);
    memcpy(to->y, s->y, m * sizeof *to->y);
    memcpy(to->mode, s->mode, m * sizeof *to->mode);
    to->method = s->method;
}

void ns_mlcp_restore(ns_mlcp_solver *s, const ns_mlcp_point *from) {
    const size_t m = (size_t)s->m;
    memcpy(s->lambda, from->lambda, m * sizeof *s->lambda);
    memcpy(s->y, from->y, m * sizeof *s->y);
    memcpy(s->mode, from->mode, m * sizeof *s->mode);
    s->method = from->method;
}
