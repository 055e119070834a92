/* src/sparse/factor_cache.c - factors of (P2), by mode and length, the least recently used dropped. */
#include "factor_cache.h"
#include "regularise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* After so many calls for one mode by an update, or so many updates to it, a mode gets factors of its own. */
enum { LONG_SERVED = 16, OFTEN = 6 };
/* The largest residual of (P2) that a solution may leave, relative to the terms of its rows. */
static const double poor = 1e-8;
/* Leaks that leave the matrix singular are made so many times as large, so often. */
enum { LARGER_LEAKS = 3 };
static const double larger_leaks = 1e3;
/* Resistance of each pair while pivots are chosen, where the entries of its law are about 1. */
static const double tiny_resistance = 1e-9;

static int create_working(ns_mode_factors *q) {
    for (int i = 0; i < 2 * NS_WORKING; i++) {
        ns_cached_factors *k = &q->working[0][0] + i;
        k->update = &q->update[0][0] + i;
        k->of.mode = calloc((size_t)q->f->m + 1, 1);
        if (!k->of.mode || ns_sparse_update_create(q->f, k->update) != NS_OK)
            return NS_E_MEMORY;
    }
    return NS_OK;
}

static void free_of_mode(ns_cached_factors *k) {
    if (k->null)
        ns_sparse_null_free(k->null->space);
    free(k->null);
    free(k->of.mode);
    free(k->scale);
}

static void free_cached(void *owner, ns_mode_entry *e) {
    ns_cached_factors *k = (ns_cached_factors *)(void *)e;
    ns_linalg_factors_free(((ns_mode_factors *)owner)->klu, k->factors);
    free_of_mode(k);
    free(k);
}

int ns_sparse_factors_create(const ns_form *f, size_t limit, ns_mode_factors **out) {
    *out = NULL;
    ns_mode_factors *q = calloc(1, sizeof *q);
    if (!q)
        return NS_E_MEMORY;
    q->f = f;
    q->kept = (ns_mode_table){.m = f->m, .limit = limit, .free_entry = free_cached, .owner = q};
    q->value = calloc((size_t)f->K.start[f->size] + 1, sizeof(double));
    q->work = calloc(3 * (size_t)f->size + 1, sizeof(double));
    q->row = calloc((size_t)f->m + (size_t)(f->summed ? f->summed[f->m] : 0) + 1, sizeof(int));
    q->seen_v = q->work ? q->work + 2 * f->size : NULL;
    int status = q->value && q->work && q->row ? create_working(q) : NS_E_MEMORY;
    if (status == NS_OK)
        status = ns_linalg_klu_create(f->size, f->K.start, f->K.row, &q->klu);
    if (status != NS_OK) {
        ns_sparse_factors_free(q);
        return status;
    }
    ns_linalg_klu_often_zero(q->klu, f->n); /* the laws of what is at a bound of zero */
    *out = q;
    return NS_OK;
}

int ns_sparse_factors_shared(ns_mode_factors *q, const ns_shared_branch *shared, int count) {
    return count > 0 ? ns_sparse_equivalent_create(q->f, shared, count, &q->equivalents) : NS_OK;
}

void ns_sparse_factors_free(ns_mode_factors *q) {
    if (!q)
        return;
    ns_modes_table_clear(&q->kept);
    for (int i = 0; i < 2 * NS_WORKING; i++) {
        ns_cached_factors *k = &q->working[0][0] + i;
        if (q->klu)
            ns_linalg_factors_free(q->klu, k->factors);
        free_of_mode(k);
        ns_sparse_update_free(&q->update[0][0] + i);
    }
    ns_sparse_equivalent_free(&q->equivalents);
    ns_linalg_klu_free(q->klu);
    ns_sparse_null_search_free(q->search);
    free(q->value);
    free(q->work);
    free(q->row);
    free(q);
}

static int is_of(const ns_mode_factors *q, const ns_cached_factors *k, double g, const ns_mode *mode) {
    return k->factors && k->of.h == g && memcmp(k->of.mode, mode, (size_t)q->f->m) == 0;
}

/* With the leaks in k->scale; where they are but rounding of what is rigid in a floating part, with larger
 * ones.
 */
static int factor_leaks(ns_mode_factors *q, ns_cached_factors *k) {
    double *leak = k->scale + 2 * q->f->size;
    int status = NS_E_SINGULAR;
    for (int larger = 0; larger <= LARGER_LEAKS && status == NS_E_SINGULAR; larger++) {
        for (int j = 0; j < q->f->m && larger > 0; j++)
            leak[j] *= larger_leaks;
        ns_sparse_form_values(q->f, k->of.h, k->of.mode, leak, q->value);
        status = ns_linalg_klu_factor(q->klu, q->value, &k->factors);
    }
    return status;
}

static int factor_with_leaks(ns_mode_factors *q, ns_cached_factors *k) {
    const size_t size = (size_t)q->f->size;
    k->has_leaks = 1;
    ns_sparse_form_values(q->f, k->of.h, k->of.mode, NULL, q->value);
    if (!k->null)
        k->null = calloc(1, sizeof *k->null);
    if (!k->null)
        return NS_E_MEMORY;
    ns_sparse_null_free(k->null->space);
    *k->null = (ns_null_known){.search = &q->search};
    if (!k->scale)
        k->scale = calloc(2 * size + (size_t)q->f->m + 1, sizeof(double));
    const int status = k->scale ? ns_sparse_leaks_find(q->f, k->of.mode, q->value, k->scale + 2 * size,
                                                       k->scale, k->scale + size)
                                : NS_E_MEMORY;
    return status == NS_OK ? factor_leaks(q, k) : status;
}

/* Pivots for all modes: those of the one in which all pairs conduct, with a tiny resistance each. */
static int choose_pivots(ns_mode_factors *q, double g) {
    ns_mode *mode = malloc((size_t)q->f->m + 1);
    if (!mode)
        return NS_E_MEMORY;
    for (int j = 0; j < q->f->m; j++) {
        mode[j] = NS_INSIDE;
        q->work[j] = tiny_resistance;
    }
    ns_sparse_form_values(q->f, g, mode, q->work, q->value);
    const int status = ns_linalg_klu_partial(q->klu, q->value);
    q->has_pivots = status == NS_OK;
    free(mode);
    return status;
}

/* New factors for the mode and length of k. */
static int factor_mode(ns_mode_factors *q, ns_cached_factors *k) {
    if (!q->has_pivots && choose_pivots(q, k->of.h) != NS_OK)
        return NS_E_MEMORY;
    q->made++;
    k->has_leaks = 0;
    ns_sparse_form_values(q->f, k->of.h, k->of.mode, NULL, q->value);
    const int status = ns_linalg_klu_factor(q->klu, q->value, &k->factors);
    return status == NS_E_SINGULAR ? factor_with_leaks(q, k) : status;
}

/* New factors of their own for a mode and a length. */
static int make_kept(ns_mode_factors *q, unsigned long long key, double g, const ns_mode *mode,
                     ns_cached_factors **out) {
    const size_t m = (size_t)q->f->m, scales = sizeof(double) * (2 * (size_t)q->f->size + m);
    ns_cached_factors *k = calloc(1, sizeof *k);
    ns_mode *copy = calloc(m + 1, 1);
    if (!k || !copy) {
        free(k);
        free(copy);
        return NS_E_MEMORY;
    }
    memcpy(copy, mode, m);
    k->of = (ns_mode_entry){.h = g, .mode = copy, .key = key};
    const int status = factor_mode(q, k);
    if (status != NS_OK) {
        free_cached(q, &k->of);
        return status;
    }
    k->of.bytes = sizeof *k + m + (k->scale ? scales : 0) + ns_linalg_factors_bytes(q->klu, k->factors);
    ns_modes_table_insert(&q->kept, &k->of);
    q->evicted += ns_modes_table_trim(&q->kept, &k->of);
    *out = k;
    return NS_OK;
}

/* 1 if the pivots for all modes serve this one too: the laws that differ from those of k are refactored. */
static int change_laws(ns_mode_factors *q, ns_cached_factors *k, const ns_mode *mode) {
    int rows = 0;
    for (int j = 0; j < q->f->m; j++)
        if (k->of.mode[j] != mode[j]) {
            ns_sparse_form_law_values(q->f, mode[j], j, q->value);
            q->row[rows++] = q->f->n + j;
            for (int p = q->f->summed ? q->f->summed[j] : 0; q->f->summed && p < q->f->summed[j + 1]; p++)
                q->row[rows++] = q->f->summed_row[p];
        }
    return ns_linalg_klu_change(q->klu, k->factors, q->value, rows, q->row);
}

static int remake_working(ns_mode_factors *q, ns_cached_factors *k, double g, const ns_mode *mode) {
    const int changed = k->factors && !k->has_leaks && k->of.h == g && change_laws(q, k, mode);
    k->of.h = g;
    memmove(k->of.mode, mode, (size_t)q->f->m);
    ns_sparse_update_reset(k->update, k->of.mode);
    q->updated += changed;
    return changed ? NS_OK : factor_mode(q, k);
}

/* Working factors of this length, else unused ones, else those used least recently. */
static ns_cached_factors *choose_working(ns_mode_factors *q, double g, int brief) {
    ns_cached_factors *best = q->working[brief];
    for (int i = 0; i < NS_WORKING; i++) {
        ns_cached_factors *k = &q->working[brief][i];
        if (k->factors && k->of.h == g)
            return k;
        if (best->factors && (!k->factors || k->used < best->used))
            best = k;
    }
    return best;
}

/* 1 if these factors can serve the mode, by an update. */
static int can_serve(ns_mode_factors *q, ns_cached_factors *k, double g, const ns_mode *mode) {
    if (!k->factors || k->of.h != g)
        return 0;
    if (memcmp(k->update->mode, mode, (size_t)q->f->m) == 0)
        return k->update->count == 0 || ++k->update->served < LONG_SERVED;
    if (k->has_leaks || !ns_sparse_update_to(k->update, q->klu, k->factors, g, k->of.mode, mode))
        return 0;
    q->updated++;
    return 1;
}

/* The working factors of the last call, if they are asked for again. */
static ns_cached_factors *same_again(ns_mode_factors *q, double g, const ns_mode *mode, int brief) {
    ns_cached_factors *k = q->last[brief];
    if (!k || !k->factors || k->of.h != g || memcmp(k->update->mode, mode, (size_t)q->f->m) != 0)
        return NULL;
    return k->update->count == 0 || ++k->update->served < LONG_SERVED ? k : NULL;
}

/* 1 if it was asked for more than twice; 2: so often that it gets factors of its own in any case. */
static int is_known(ns_mode_factors *q, unsigned long long key) {
    unsigned char *times = &q->times[key % NS_SEEN];
    const int known = q->seen[key % NS_SEEN] == key;
    q->seen[key % NS_SEEN] = key;
    *times = (unsigned char)(known ? *times + (*times < OFTEN) : 0);
    return (*times > 1) + (*times == OFTEN);
}

int ns_sparse_factors_factor(ns_mode_factors *q, double g, const ns_mode *asked, int brief,
                             const ns_cached_factors **out) {
    const ns_mode *mode = ns_sparse_equivalent_mode(&q->equivalents, asked);
    ns_cached_factors *k = same_again(q, g, mode, brief);
    int status = NS_OK;
    if (k) {
        k->used = ++q->clock;
        *out = k;
        return NS_OK;
    }
    const unsigned long long key = ns_modes_table_key(q->f->m, g, mode);
    q->last[brief] = NULL;
    k = (ns_cached_factors *)(void *)ns_modes_table_find(&q->kept, key, g, mode);
    if (!k) {
        const int known = is_known(q, key);
        k = choose_working(q, g, brief);
        if (known < 2 && ns_linalg_klu_is_partial(q->klu))
            status = k->update->count == 0 && is_of(q, k, g, mode) ? NS_OK : remake_working(q, k, g, mode);
        else if (known < 2 && can_serve(q, k, g, mode))
            ;
        else if (known)
            status = make_kept(q, key, g, mode, &k);
        else
            status = remake_working(q, k, g, mode);
    }
    if (status != NS_OK)
        return status;
    q->last[brief] = k->update ? k : NULL;
    k->used = ++q->clock;
    *out = k;
    return NS_OK;
}

static int solve_factored(ns_mode_factors *q, const ns_cached_factors *k, int residual, const double *r,
                          double *v);

/* By an update, if the first solution confirms it; else the factors are made anew. */
static int solve_updated(ns_mode_factors *q, const ns_cached_factors *k, int residual, const double *r,
                         double *v) {
    ns_low_rank *u = k->update;
    const int good =
        ns_sparse_update_solve(u, q->klu, k->factors, k->of.mode, r, v, u->checked ? NULL : q->seen_v);
    if (good && (u->checked ||
                 ns_sparse_leaks_left(q->f, k->of.h, u->mode, NULL, r, v, q->seen_v, q->work) <= poor)) {
        u->checked = 1;
        return NS_OK;
    }
    ns_cached_factors *own =
        &q->working[0][0] + (k - &q->working[0][0]); /* only working factors have updates */
    const int status = remake_working(q, own, k->of.h, u->mode);
    return status == NS_OK ? solve_factored(q, k, residual, r, v) : status;
}

/* What is known of the null space is kept with the factors. */
static int solve_with_leaks(ns_mode_factors *q, const ns_cached_factors *k, int residual, const double *r,
                            double *v) {
    const double *scale = k->scale;
    const ns_sparse_leaks with = {
        q->f, k->of.h, k->of.mode, scale, scale + q->f->size, scale + 2 * q->f->size, q->klu, k->factors};
    const long before = ns_linalg_klu_solves(q->klu);
    const int status = ns_sparse_leaks_solve(&with, k->null, residual, r, v, q->work);
    q->leaky_solves += ns_linalg_klu_solves(q->klu) - before;
    return status;
}

static int solve_factored(ns_mode_factors *q, const ns_cached_factors *k, int residual, const double *r,
                          double *v) {
    if (k->has_leaks)
        return solve_with_leaks(q, k, residual, r, v);
    if (k->update && k->update->count > 0)
        return solve_updated(q, k, residual, r, v);
    memcpy(v, r, sizeof(double) * (size_t)q->f->size);
    ns_sparse_form_move_known(q->f, k->of.mode, v);
    ns_linalg_klu_solve(q->klu, k->factors, v);
    return NS_OK;
}

static int solve(ns_mode_factors *q, const ns_cached_factors *k, int residual, const double *r, double *v) {
    const int status = solve_factored(q, k, residual, ns_sparse_equivalent_right(&q->equivalents, r), v);
    ns_sparse_equivalent_back(&q->equivalents, v);
    return status;
}

int ns_sparse_factors_solve(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v) {
    return solve(q, k, 0, r, v);
}

int ns_sparse_factors_correct(ns_mode_factors *q, const ns_cached_factors *k, const double *rest, double *v) {
    return solve(q, k, 1, rest, v);
}
