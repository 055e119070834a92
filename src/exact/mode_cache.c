/* src/exact/mode_cache.c - modes that were met, each with time scales: kernels with steps as short as its
 * rates need.
 *
 * After a discontinuity what is fast is resolved until it has died out; from then on steps are longer.  What
 * dies out within a millionth of the ladder's h is taken as instantaneous, unless a guard breaks on its way.
 */
#include "exact_internal.h"

#include "guards.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A rate a has died out after 40/a: exp(-40) is rounding.  Rates of two time scales differ by 16 at least. */
static const double DIES_OUT = 40, MIN_RATIO = 16;

/* A rate rings if it is so many times its real part. */
static const double RINGING = 4;

static unsigned hash_of(const ns_mode *mode, int m) {
    unsigned hash = 2166136261u; /* FNV-1a */
    for (int j = 0; j < m; j++)
        hash = (hash ^ (unsigned)(mode[j] + 1)) * 16777619u;
    return (hash ^ (hash >> 16)) % NS_EXACT_BUCKETS;
}

static void free_time_scale(ns_time_scale *scale) {
    if (!scale->kernel) /* what else it has was made with that */
        return;
    ns_exact_kernel_free(scale->kernel);
    ns_exact_fast_free(scale->fast);
    for (int k = 0; k <= NS_MAX_EXPONENT; k++)
        ns_exact_step_free(scale->doubled[k]);
    for (int k = 0; k < NS_CACHED_STEPS; k++)
        ns_exact_step_free(scale->cached[k].map);
    *scale = (ns_time_scale){0};
}

static void free_time_scales(ns_exact_mode *k) {
    for (int i = 0; i < NS_TIME_SCALES; i++)
        free_time_scale(&k->scale[i]);
}

static void free_mode(ns_exact_mode *k) {
    if (!k)
        return;
    free_mode(k->other);
    free_time_scales(k);
    free(k->mode);
    free(k);
}

void ns_exact_mode_forget_all(ns_exact *f) {
    for (int b = 0; b < NS_EXACT_BUCKETS; b++) {
        for (ns_exact_mode *k = f->cache.bucket[b], *next; k; k = next) {
            next = k->next_in_bucket;
            free_mode(k);
        }
        f->cache.bucket[b] = NULL;
    }
    f->cache.bytes = 0;
}

static size_t bytes_of(const ns_exact *f, const ns_exact_mode *k) {
    size_t sum = sizeof *k + (size_t)f->system->m;
    for (int i = 0; i < NS_TIME_SCALES; i++) {
        const ns_time_scale *scale = &k->scale[i];
        sum += (scale->kernel ? scale->kernel->bytes : 0) + ns_exact_fast_bytes(scale->fast);
        for (int j = 0; j <= NS_MAX_EXPONENT; j++)
            sum += scale->doubled[j] ? scale->doubled[j]->bytes : 0;
        for (int j = 0; j < NS_CACHED_STEPS; j++)
            sum += scale->cached[j].map ? scale->cached[j].map->bytes : 0;
    }
    return sum + (k->other ? bytes_of(f, k->other) : 0);
}

/* `gone` is no successor of a mode any more. */
static void forget_successor(ns_exact_mode *from, const ns_exact_mode *gone) {
    int to = 0;
    for (int i = 0; i < NS_SUCCESSORS; i++)
        if (from->successor[i].mode != gone)
            from->successor[to++] = from->successor[i];
    while (to < NS_SUCCESSORS)
        from->successor[to++] = (ns_successor){0};
}

/* What points to the mode not used for longest; NULL: there is none but keep. */
static ns_exact_mode **least_recently_used(ns_exact *f, const ns_exact_mode *keep) {
    ns_exact_mode **found = NULL;
    for (int b = 0; b < NS_EXACT_BUCKETS; b++)
        for (ns_exact_mode **at = &f->cache.bucket[b]; *at; at = &(*at)->next_in_bucket)
            if (*at != keep && (!found || (*at)->last_used < (*found)->last_used))
                found = at;
    return found;
}

void ns_exact_mode_trim(ns_exact *f, ns_exact_mode *keep) {
    const size_t enough = f->cache.limit / 4 * 3;
    keep->last_used = ++f->cache.clock;
    while (f->cache.bytes > enough) {
        ns_exact_mode **at = least_recently_used(f, keep), *gone = at ? *at : NULL;
        if (!gone)
            return;
        *at = gone->next_in_bucket;
        for (int b = 0; b < NS_EXACT_BUCKETS; b++)
            for (ns_exact_mode *k = f->cache.bucket[b]; k; k = k->next_in_bucket)
                forget_successor(k, gone);
        f->cache.bytes -= bytes_of(f, gone);
        f->counts.evicted++;
        free_mode(gone);
    }
}

typedef struct ns_mode_rate {
    double size, dies; /* |rate|, 1/s; s until it has died out, INFINITY: never */
} ns_mode_rate;

static int by_size(const void *a, const void *b) {
    const double x = ((const ns_mode_rate *)a)->size, y = ((const ns_mode_rate *)b)->size;
    return (x < y) - (x > y);
}

/* s: what is resolved may not be shorter than the rounding of the time, of which it must last several times
 * as long. */
static double told_apart(const ns_exact *f) {
    static const double roundings = 64;
    return roundings * DBL_EPSILON * fabs(f->state.now.t);
}

/* s: what dies out within this is taken as instantaneous in mode k. */
static double instant_of(const ns_exact *f, const ns_exact_mode *k) {
    enum { FINEST_EXPONENT = 40 };
    return k->resolves ? fmax(ldexp(f->h, -FINEST_EXPONENT), told_apart(f)) : ldexp(f->h, -NS_EVENT_EXPONENT);
}

/* The rates that are resolved, largest first; how many.  k->has_instant: 1 if there are others; k->hides: if
 * some of these are finite. */
static int list_rates(const ns_exact *f, ns_exact_mode *k, const ns_mode_kernel *kernel, ns_mode_rate *rate,
                      double *room, int *status) {
    double *re = room, *im = room + kernel->r;
    const double instant = instant_of(f, k);
    int count = 0;
    k->hides = 0;
    k->shortest = INFINITY;
    *status = ns_exact_kernel_rates(kernel, re, im);
    for (int i = 0; i < kernel->r && *status == NS_OK; i++) {
        const double dies = re[i] < 0 ? DIES_OUT / -re[i] : INFINITY;
        if (dies > instant && isfinite(re[i])) {
            rate[count++] = (ns_mode_rate){hypot(re[i], im[i]), dies};
            k->shortest = fmin(k->shortest, dies);
        }
        if (dies <= instant && (isfinite(re[i]) || im[i] != 0))
            k->hides = 1;
    }
    k->has_instant = count < kernel->r;
    for (int i = 0; i < f->inputs->nv; i++) {
        const ns_input_state *is = &f->inputs->state[i];
        const double dies = is->wave.theta > 0 ? DIES_OUT / is->wave.theta : INFINITY;
        if ((is->kind == NS_STATE_DECAY || is->kind == NS_STATE_COS) && dies > instant)
            rate[count++] = (ns_mode_rate){hypot(is->wave.theta, is->omega), dies};
    }
    qsort(rate, (size_t)count, sizeof *rate, by_size);
    return count;
}

/* Where many short steps follow each other their rounding must not add up: on scales much faster than the
 * ladder, but the last. */
static int fill_flows(ns_exact *f, const ns_exact_mode *k, int i) {
    enum { MUCH_FASTER = 16 };
    const ns_time_scale *scale = &k->scale[i];
    return i + 1 < k->scales && scale->h < f->h / MUCH_FASTER
               ? ns_exact_kernel_flows(f->s, f->inputs, scale->kernel)
               : NS_OK;
}

ns_time_scale *ns_exact_mode_reach(ns_exact *f, ns_exact_mode *k, int i) {
    ns_time_scale *scale = &k->scale[i];
    if (scale->kernel)
        return scale;
    ns_theta_set_mode(f->s, k->mode);
    int status = ns_exact_kernel_build(f->s, f->inputs, scale->h / NS_POLE, k->mode, &scale->kernel);
    if (status == NS_OK)
        status = fill_flows(f, k, i);
    if (status != NS_OK) {
        if (status == NS_E_MEMORY)
            f->failed = status;
        ns_exact_kernel_free(scale->kernel);
        scale->kernel = NULL;
        k->scales = i; /* shorter steps cost more, and are right too */
        return NULL;
    }
    f->cache.bytes += scale->kernel->bytes;
    return scale;
}

/* Each starts where the rates of the one before have died out, if they do. */
static void list_time_scales(const ns_exact *f, ns_exact_mode *k, const ns_mode_rate *rate, int count) {
    double from = 0;
    int i = 0;
    while (k->scales < NS_TIME_SCALES) {
        const double size = i < count ? rate[i].size : 0;
        k->scale[k->scales].from = from;
        k->scale[k->scales++].h = ns_exact_kernel_length(f->h, size);
        while (i < count && rate[i].size * MIN_RATIO > size) { /* these are one time scale */
            k->scale[k->scales - 1].rings |= rate[i].size * rate[i].dies > RINGING * DIES_OUT;
            from = fmax(from, rate[i].dies);
            i++;
        }
        if (isinf(from) || size == 0)
            break;
    }
}

/* Of the kernel whose rates are read: those far from 1/h are lost in its rounding. */
static double probe_length(const ns_exact *f, const ns_exact_mode *k) {
    if (k->resolves)
        return ldexp(f->h, -NS_EVENT_EXPONENT);
    return f->cache.first_h < f->h / 64 || f->cache.first_h > f->h ? f->h : f->cache.first_h;
}

static int build_mode(ns_exact *f, ns_exact_mode *k) {
    const int r = f->s->r, all = r + f->inputs->nv;
    double *room = malloc(sizeof *room * (2 * (size_t)r + 1));
    ns_mode_rate *rate = malloc(sizeof *rate * ((size_t)all + 1));
    ns_mode_kernel *probe = NULL;
    const double guess = probe_length(f, k);
    int status =
        room && rate ? ns_exact_kernel_build(f->s, f->inputs, guess / NS_POLE, k->mode, &probe) : NS_E_MEMORY;
    const int known = k->resolves ? k->rates : -1;
    const int count = status == NS_OK ? list_rates(f, k, probe, rate, room, &status) : 0;
    k->rates = count;
    if (status == NS_OK && count == known)
        status = NS_GUARD; /* no more than before */
    if (status == NS_OK)
        list_time_scales(f, k, rate, count);
    for (int i = 0; i < k->scales && probe && status == NS_OK; i++)
        if (k->scale[i].h == guess) {
            k->scale[i].kernel = probe;
            probe = NULL;
        }
    if (status == NS_OK && !k->scale[0].kernel) {
        status =
            ns_exact_kernel_build(f->s, f->inputs, k->scale[0].h / NS_POLE, k->mode, &k->scale[0].kernel);
        f->cache.first_h = k->scale[0].h;
    }
    for (int i = 0; i < k->scales && status == NS_OK; i++)
        if (k->scale[i].kernel)
            status = fill_flows(f, k, i);
    for (int i = 0; i < k->scales && status == NS_OK; i++)
        f->cache.bytes += k->scale[i].kernel ? k->scale[i].kernel->bytes : 0;
    if (status != NS_OK)
        free_time_scales(k);
    ns_exact_kernel_free(probe);
    free(room);
    free(rate);
    return status;
}

static ns_exact_mode *new_mode(const ns_mode *mode, int m) {
    ns_exact_mode *k = calloc(1, sizeof *k);
    if (!k || !(k->mode = malloc((size_t)m + 1))) {
        free(k);
        return NULL;
    }
    memcpy(k->mode, mode, (size_t)m);
    return k;
}

static void forget_other(ns_exact *f, ns_exact_mode *k) {
    f->cache.bytes -= bytes_of(f, k->other);
    free_mode(k->other);
    k->other = NULL;
}

ns_exact_mode *ns_exact_mode_fine(ns_exact *f, ns_exact_mode *k) {
    if (!k->hides || k->resolves)
        return NULL;
    if (k->other && k->other->shortest < told_apart(f))
        forget_other(f, k);
    if (k->other)
        return k->other;
    ns_exact_mode *fine = new_mode(k->mode, f->system->m);
    int status = fine ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        fine->resolves = 1;
        fine->rates = k->rates;
        ns_theta_set_mode(f->s, k->mode);
        status = build_mode(f, fine);
    }
    f->failed = status == NS_E_MEMORY ? status : f->failed;
    k->resolves = status != NS_OK && status != NS_E_MEMORY;
    if (status != NS_OK) {
        free_mode(fine);
        return NULL;
    }
    f->cache.bytes += sizeof *fine + (size_t)f->system->m;
    return k->other = fine;
}

static void copy_kernels(ns_exact_mode *to, const ns_exact_mode *from) {
    memcpy(to->scale, from->scale, sizeof to->scale);
    to->scales = from->scales;
    to->rates = from->rates;
    to->has_instant = from->has_instant;
    to->hides = from->hides;
    to->resolves = from->resolves;
    to->shortest = from->shortest;
}

/* Mode k goes by the kernels of k->other from now on, and that has those of k. */
static void swap_kernels(ns_exact *f, ns_exact_mode *k) {
    const ns_exact_mode was = *k;
    copy_kernels(k, k->other);
    copy_kernels(k->other, &was);
    f->cache.steps_dropped++;
    f->entered = NULL;
}

int ns_exact_mode_resolve(ns_exact *f, ns_exact_mode *k) {
    ns_exact_mode *fine = ns_exact_mode_fine(f, k);
    if (!fine || !ns_exact_guards_are_readable(f, fine, k))
        return 0;
    swap_kernels(f, k);
    return 1;
}

void ns_exact_mode_coarsen(ns_exact *f, ns_exact_mode *k) {
    if (!k->resolves || !k->other || k == f->state.mode)
        return;
    if (k->shortest < told_apart(f) || !ns_exact_guards_are_readable(f, k, k->other))
        swap_kernels(f, k);
}

int ns_exact_mode_find(ns_exact *f, const ns_mode *mode, ns_exact_mode **out) {
    const size_t m = (size_t)f->system->m;
    ns_exact_mode **head = &f->cache.bucket[hash_of(mode, f->system->m)], *k = *head;
    while (k && memcmp(k->mode, mode, m) != 0)
        k = k->next_in_bucket;
    *out = k && k->status == NS_OK ? k : NULL;
    if (k)
        return k->status;
    k = new_mode(mode, f->system->m);
    if (!k)
        return NS_E_MEMORY;
    ns_theta_set_mode(f->s, mode);
    k->status = build_mode(f, k);
    if (k->status != NS_OK && k->status != NS_E_SINGULAR) {
        const int status = k->status;
        free_mode(k);
        return status;
    }
    k->next_in_bucket = *head;
    *head = k;
    *out = k->status == NS_OK ? k : NULL;
    f->cache.bytes += sizeof *k + m;
    f->counts.modes += k->status == NS_OK;
    return k->status;
}

/* The last one that has begun, so long after the discontinuity (s); *until: when the next one begins. */
static ns_time_scale *scale_at(ns_exact *f, double since, double *until) {
    ns_exact_mode *k = f->state.mode;
    int i = 0;
    *until = INFINITY;
    if (k->scales == 1)
        return &k->scale[0]; /* its kernel is built with the mode */
    while (i + 1 < k->scales && since >= k->scale[i + 1].from * (1 - 1e-9))
        i++;
    ns_time_scale *scale = k->scale[i].kernel ? &k->scale[i] : ns_exact_mode_reach(f, k, i);
    while (!scale)
        scale = ns_exact_mode_reach(f, k, --i);
    if (i + 1 < k->scales)
        *until = k->scale[i + 1].from;
    return scale;
}

/* s: t moves by its rounding at least. */
static double time_rounding(const ns_exact *f) {
    return 8 * DBL_EPSILON * fabs(f->state.now.t);
}

ns_time_scale *ns_exact_mode_time_scale(ns_exact *f, double *until) {
    return scale_at(f, f->state.now.t - f->state.last_event_t + time_rounding(f), until);
}

ns_time_scale *ns_exact_mode_scale_before(ns_exact *f) {
    const double since = f->state.now.t - f->state.last_event_t - time_rounding(f);
    double until;
    return scale_at(f, since * (1 - 2e-9), &until);
}
