/* src/sparse/factor_cache.c - factors of (P2), by mode and length, the least recently used dropped. */
#include "factor_cache.h"
#include "regularise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A mode that an update served so long, or came to so often, gets factors of its own. */
enum { LONG_SERVED = 16, OFTEN = 6 };
/* What a solution may leave of (P2), of the terms of its rows. */
static const double poor = 1e-8;
/* Of laws whose entries are about 1. */
static const double next_to_none = 1e-9;

static int make_scratch(ns_mode_factors *q) {
    for (int i = 0; i < 2 * NS_SCRATCH; i++) {
        ns_cached_factors *k = &q->scratch[0][0] + i;
        k->update = &q->update[0][0] + i;
        k->mode = calloc((size_t)q->f->m + 1, 1);
        if (!k->mode || ns_sparse_update_create(q->f, k->update) != NS_OK)
            return NS_E_MEMORY;
    }
    return NS_OK;
}

int ns_sparse_factors_create(const ns_form *f, size_t limit, ns_mode_factors **out) {
    *out = NULL;
    ns_mode_factors *q = calloc(1, sizeof *q);
    if (!q)
        return NS_E_MEMORY;
    q->f = f;
    q->limit = limit;
    q->value = calloc((size_t)f->K.start[f->size] + 1, sizeof(double));
    q->work = calloc(3 * (size_t)f->size + 1, sizeof(double));
    q->row = calloc((size_t)f->m + 1, sizeof(int));
    q->seen_v = q->work ? q->work + 2 * f->size : NULL;
    int status = q->value && q->work && q->row ? make_scratch(q) : NS_E_MEMORY;
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

int ns_sparse_factors_shared(ns_mode_factors *q, const ns_shared_branch *twin, int count) {
    return count > 0 ? ns_sparse_equivalent_create(q->f, twin, count, &q->stand_ins) : NS_OK;
}

static void drop(ns_mode_factors *q, ns_cached_factors *k) {
    q->bytes -= k->bytes;
    ns_linalg_factors_free(q->klu, k->factors);
    free(k->mode);
    free(k->scale);
    free(k);
}

void ns_sparse_factors_free(ns_mode_factors *q) {
    if (!q)
        return;
    for (int b = 0; b < NS_CACHE_BUCKETS; b++)
        while (q->bucket[b]) {
            ns_cached_factors *k = q->bucket[b];
            q->bucket[b] = k->next;
            drop(q, k);
        }
    for (int i = 0; i < 2 * NS_SCRATCH; i++) {
        ns_cached_factors *k = &q->scratch[0][0] + i;
        if (q->klu)
            ns_linalg_factors_free(q->klu, k->factors);
        free(k->mode);
        free(k->scale);
        ns_sparse_update_free(&q->update[0][0] + i);
    }
    ns_sparse_equivalent_free(&q->stand_ins);
    ns_linalg_klu_free(q->klu);
    free(q->value);
    free(q->work);
    free(q->row);
    free(q);
}

static unsigned long long key_of(const ns_form *f, double g, const ns_mode *mode) {
    unsigned long long h = 14695981039346656037U, bits;
    memcpy(&bits, &g, sizeof bits);
    h = (h ^ bits) * 1099511628211U;
    for (int j = 0; j < f->m; j++)
        h = (h ^ (unsigned char)mode[j]) * 1099511628211U;
    h = (h ^ (h >> 32)) * 11400714819323198485U; /* lengths h 2^-k differ in high bits alone */
    h ^= h >> 32;
    return h ? h : 1;
}

static int is_of(const ns_mode_factors *q, const ns_cached_factors *k, double g, const ns_mode *mode) {
    return k->factors && k->g == g && memcmp(k->mode, mode, (size_t)q->f->m) == 0;
}

/* The link that leads to the one used least recently, but for `but`. */
static ns_cached_factors **oldest(ns_mode_factors *q, const ns_cached_factors *but) {
    ns_cached_factors **found = NULL;
    for (int b = 0; b < NS_CACHE_BUCKETS; b++)
        for (ns_cached_factors **link = &q->bucket[b]; *link; link = &(*link)->next)
            if (*link != but && (!found || (*link)->used < (*found)->used))
                found = link;
    return found;
}

static void trim(ns_mode_factors *q, const ns_cached_factors *but) {
    ns_cached_factors **link;
    while (q->bytes > q->limit && (link = oldest(q, but))) {
        ns_cached_factors *k = *link;
        *link = k->next;
        drop(q, k);
        q->evicted++;
    }
}

static int factor_with_leaks(ns_mode_factors *q, ns_cached_factors *k) {
    const size_t size = (size_t)q->f->size;
    k->leaky = 1;
    ns_sparse_form_values(q->f, k->g, k->mode, NULL, q->value);
    if (!k->scale)
        k->scale = calloc(2 * size + 1, sizeof(double));
    const int status = k->scale
                           ? ns_sparse_leaks_find(q->f, k->mode, q->value, q->work, k->scale, k->scale + size)
                           : NS_E_MEMORY;
    if (status != NS_OK)
        return status;
    ns_sparse_form_values(q->f, k->g, k->mode, q->work, q->value);
    return ns_linalg_klu_factor(q->klu, q->value, &k->factors);
}

/* Pivots for all modes: those of one in which everything conducts, by next to no resistance. */
static int choose_pivots(ns_mode_factors *q, double g) {
    ns_mode *mode = malloc((size_t)q->f->m + 1);
    if (!mode)
        return NS_E_MEMORY;
    for (int j = 0; j < q->f->m; j++) {
        mode[j] = NS_INSIDE;
        q->work[j] = next_to_none;
    }
    ns_sparse_form_values(q->f, g, mode, q->work, q->value);
    const int status = ns_linalg_klu_partial(q->klu, q->value);
    q->chosen = status == NS_OK;
    free(mode);
    return status;
}

/* Fills in factors of k's mode and length. */
static int factor(ns_mode_factors *q, ns_cached_factors *k) {
    if (!q->chosen && choose_pivots(q, k->g) != NS_OK)
        return NS_E_MEMORY;
    q->made++;
    k->leaky = 0;
    ns_sparse_form_values(q->f, k->g, k->mode, NULL, q->value);
    const int status = ns_linalg_klu_factor(q->klu, q->value, &k->factors);
    return status == NS_E_SINGULAR ? factor_with_leaks(q, k) : status;
}

static int keep(ns_mode_factors *q, unsigned long long key, double g, const ns_mode *mode,
                ns_cached_factors **out) {
    const size_t m = (size_t)q->f->m;
    ns_cached_factors *k = calloc(1, sizeof *k);
    ns_mode *copy = calloc(m + 1, 1);
    if (!k || !copy) {
        free(k);
        free(copy);
        return NS_E_MEMORY;
    }
    memcpy(copy, mode, m);
    *k = (ns_cached_factors){.g = g, .key = key, .mode = copy};
    const int status = factor(q, k);
    if (status != NS_OK) {
        drop(q, k);
        return status;
    }
    k->bytes = sizeof *k + m + (k->scale ? 2 * sizeof(double) * (size_t)q->f->size : 0) +
               ns_linalg_factors_bytes(q->klu, k->factors);
    q->bytes += k->bytes;
    k->next = q->bucket[key % NS_CACHE_BUCKETS];
    q->bucket[key % NS_CACHE_BUCKETS] = k;
    trim(q, k);
    *out = k;
    return NS_OK;
}

/* 1 if the pivots for all modes serve this one too, by its laws that are not those of k. */
static int change_laws(ns_mode_factors *q, ns_cached_factors *k, const ns_mode *mode) {
    int rows = 0;
    for (int j = 0; j < q->f->m; j++)
        if (k->mode[j] != mode[j]) {
            ns_sparse_form_law_values(q->f, mode[j], j, q->value);
            q->row[rows++] = q->f->n + j;
        }
    return ns_linalg_klu_change(q->klu, k->factors, q->value, rows, q->row);
}

static int make_over(ns_mode_factors *q, ns_cached_factors *k, double g, const ns_mode *mode) {
    const int changed = k->factors && !k->leaky && k->g == g && change_laws(q, k, mode);
    k->g = g;
    memmove(k->mode, mode, (size_t)q->f->m);
    ns_sparse_update_reset(k->update, k->mode);
    q->updated += changed;
    return changed ? NS_OK : factor(q, k);
}

/* A scratch one of this length, else one that is not in use, else the one used least recently. */
static ns_cached_factors *scratch_for(ns_mode_factors *q, double g, int brief) {
    ns_cached_factors *best = q->scratch[brief];
    for (int i = 0; i < NS_SCRATCH; i++) {
        ns_cached_factors *k = &q->scratch[brief][i];
        if (k->factors && k->g == g)
            return k;
        if (best->factors && (!k->factors || k->used < best->used))
            best = k;
    }
    return best;
}

/* 1 if the factors there are can serve it. */
static int can_serve(ns_mode_factors *q, ns_cached_factors *k, double g, const ns_mode *mode) {
    if (!k->factors || k->g != g)
        return 0;
    if (memcmp(k->update->mode, mode, (size_t)q->f->m) == 0)
        return k->update->count == 0 || ++k->update->served < LONG_SERVED;
    if (k->leaky || !ns_sparse_update_to(k->update, q->klu, k->factors, g, k->mode, mode))
        return 0;
    q->updated++;
    return 1;
}

/* The scratch one that was asked for the last time, if it is asked for again. */
static ns_cached_factors *same_again(ns_mode_factors *q, double g, const ns_mode *mode, int brief) {
    ns_cached_factors *k = q->last[brief];
    if (!k || !k->factors || k->g != g || memcmp(k->update->mode, mode, (size_t)q->f->m) != 0)
        return NULL;
    return k->update->count == 0 || ++k->update->served < LONG_SERVED ? k : NULL;
}

/* 1 if it was asked for before, and not just once; 2: so often that factors of its own are worth while. */
static int is_known(ns_mode_factors *q, unsigned long long key) {
    unsigned char *times = &q->times[key % NS_SEEN];
    const int known = q->seen[key % NS_SEEN] == key;
    q->seen[key % NS_SEEN] = key;
    *times = (unsigned char)(known ? *times + (*times < OFTEN) : 0);
    return (*times > 1) + (*times == OFTEN);
}

int ns_sparse_factors_factor(ns_mode_factors *q, double g, const ns_mode *asked, int brief,
                             const ns_cached_factors **out) {
    const ns_mode *mode = ns_sparse_equivalent_mode(&q->stand_ins, asked);
    ns_cached_factors *k = same_again(q, g, mode, brief);
    int status = NS_OK;
    if (k) {
        k->used = ++q->clock;
        *out = k;
        return NS_OK;
    }
    const unsigned long long key = key_of(q->f, g, mode);
    k = q->bucket[key % NS_CACHE_BUCKETS];
    q->last[brief] = NULL;
    while (k && !(k->key == key && is_of(q, k, g, mode)))
        k = k->next;
    if (!k) {
        const int known = is_known(q, key);
        k = scratch_for(q, g, brief);
        if (known < 2 && ns_linalg_klu_is_partial(q->klu))
            status = k->update->count == 0 && is_of(q, k, g, mode) ? NS_OK : make_over(q, k, g, mode);
        else if (known < 2 && can_serve(q, k, g, mode))
            ;
        else if (known)
            status = keep(q, key, g, mode, &k);
        else
            status = make_over(q, k, g, mode);
    }
    if (status != NS_OK)
        return status;
    q->last[brief] = k->update ? k : NULL;
    k->used = ++q->clock;
    *out = k;
    return NS_OK;
}

static int solve(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v);

/* By an update, which the first solution has to confirm; else there are factors anew. */
static int solve_updated(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v) {
    ns_low_rank *u = k->update;
    const int good = ns_sparse_update_solve(u, q->klu, k->factors, r, v, u->checked ? NULL : q->seen_v);
    if (good &&
        (u->checked || ns_sparse_leaks_left(q->f, k->g, u->mode, NULL, r, v, q->seen_v, q->work) <= poor)) {
        u->checked = 1;
        return NS_OK;
    }
    ns_cached_factors *own = &q->scratch[0][0] + (k - &q->scratch[0][0]); /* nobody else has an update */
    const int status = make_over(q, own, k->g, u->mode);
    return status == NS_OK ? solve(q, k, r, v) : status;
}

static int solve_leaky(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v) {
    const ns_sparse_leaks with = {q->f, k->g, k->mode, k->scale, k->scale + q->f->size, q->klu, k->factors};
    return ns_sparse_leaks_solve(&with, r, v, q->work);
}

static int solve(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v) {
    if (k->leaky)
        return solve_leaky(q, k, r, v);
    if (k->update && k->update->count > 0)
        return solve_updated(q, k, r, v);
    memcpy(v, r, sizeof(double) * (size_t)q->f->size);
    ns_linalg_klu_solve(q->klu, k->factors, v);
    return NS_OK;
}

int ns_sparse_factors_solve(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v) {
    const int status = solve(q, k, ns_sparse_equivalent_right(&q->stand_ins, r), v);
    ns_sparse_equivalent_back(&q->stand_ins, v);
    return status;
}
