/* src/exact/mode_cache.c - modes that were met, each with its levels: stages as short as its rates ask for.
 *
 * After a discontinuity what is fast must be resolved until it has died out; from then on what is slower sets
 * the pace.  What dies out within a millionth of the marcher's h is taken for instantaneous.
 */
#include "exact_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A rate a is over after DEAD/a: exp(-DEAD) is rounding.  Levels are apart by this factor at least. */
static const double DEAD = 40, APART = 16;

static unsigned hash_of(const ns_mode *mode, int m) {
    unsigned hash = 2166136261u; /* FNV-1a */
    for (int j = 0; j < m; j++)
        hash = (hash ^ (unsigned)(mode[j] + 1)) * 16777619u;
    return (hash ^ (hash >> 16)) % NS_EXACT_BUCKETS;
}

static void free_level(ns_time_scale *level) {
    ns_exact_kernel_free(level->stage);
    for (int k = 0; k <= NS_UNGUARDED; k++)
        ns_exact_step_free(level->rung[k]);
    for (int k = 0; k < NS_KEPT; k++)
        ns_exact_step_free(level->kept[k].leg);
}

static void free_mode(ns_exact_mode *k) {
    for (int i = 0; i < NS_LEVELS; i++)
        free_level(&k->level[i]);
    free(k->mode);
    free(k);
}

void ns_exact_mode_forget_all(ns_exact *f) {
    for (int b = 0; b < NS_EXACT_BUCKETS; b++) {
        for (ns_exact_mode *k = f->bucket[b], *next; k; k = next) {
            next = k->chain;
            free_mode(k);
        }
        f->bucket[b] = NULL;
    }
    f->bytes = 0;
    f->at = NULL;
}

static size_t bytes_of(const ns_exact *f, const ns_exact_mode *k) {
    size_t sum = sizeof *k + (size_t)f->system->m;
    for (int i = 0; i < NS_LEVELS; i++) {
        const ns_time_scale *level = &k->level[i];
        sum += level->stage ? level->stage->bytes : 0;
        for (int j = 0; j <= NS_UNGUARDED; j++)
            sum += level->rung[j] ? level->rung[j]->bytes : 0;
        for (int j = 0; j < NS_KEPT; j++)
            sum += level->kept[j].leg ? level->kept[j].leg->bytes : 0;
    }
    return sum;
}

/* No mode is followed by this one any more. */
static void unfollow(ns_exact_mode *from, const ns_exact_mode *gone) {
    int to = 0;
    for (int i = 0; i < NS_SUCCESSORS; i++)
        if (from->follower[i].mode != gone)
            from->follower[to++] = from->follower[i];
    while (to < NS_SUCCESSORS)
        from->follower[to++] = (ns_successor){0};
}

/* Where the mode that was not flown for longest hangs; NULL: there is none but keep. */
static ns_exact_mode **oldest(ns_exact *f, const ns_exact_mode *keep) {
    ns_exact_mode **found = NULL;
    for (int b = 0; b < NS_EXACT_BUCKETS; b++)
        for (ns_exact_mode **at = &f->bucket[b]; *at; at = &(*at)->chain)
            if (*at != keep && (!found || (*at)->used < (*found)->used))
                found = at;
    return found;
}

void ns_exact_mode_trim(ns_exact *f, ns_exact_mode *keep) {
    const size_t enough = f->limit / 4 * 3;
    keep->used = ++f->clock;
    while (f->bytes > enough) {
        ns_exact_mode **at = oldest(f, keep), *gone = at ? *at : NULL;
        if (!gone)
            return;
        *at = gone->chain;
        for (int b = 0; b < NS_EXACT_BUCKETS; b++)
            for (ns_exact_mode *k = f->bucket[b]; k; k = k->chain)
                unfollow(k, gone);
        f->bytes -= bytes_of(f, gone);
        f->s->counts.evicted++;
        free_mode(gone);
    }
}

typedef struct ns_mode_rate {
    double size, dies; /* |rate|; seconds until it is over, INFINITY: never */
} ns_mode_rate;

static int by_size(const void *a, const void *b) {
    const double x = ((const ns_mode_rate *)a)->size, y = ((const ns_mode_rate *)b)->size;
    return (x < y) - (x > y);
}

/* The rates that matter, the largest first; how many.  *at_once: there are others. */
static int list_rates(const ns_exact *f, const ns_mode_kernel *stage, ns_mode_rate *rate, double *room,
                      int *at_once, int *status) {
    double *re = room, *im = room + stage->r;
    const double instant = ldexp(f->h, -NS_EVENT_EXPONENT);
    int count = 0;
    *status = ns_exact_kernel_rates(stage, re, im);
    for (int i = 0; i < stage->r && *status == NS_OK; i++) {
        const double dies = re[i] < 0 ? DEAD / -re[i] : INFINITY;
        if (dies > instant && isfinite(re[i]))
            rate[count++] = (ns_mode_rate){hypot(re[i], im[i]), dies};
    }
    *at_once = count < stage->r;
    for (int i = 0; i < f->exo->nv; i++) {
        const ns_input_state *is = &f->exo->state[i];
        const double dies = is->wave.theta > 0 ? DEAD / is->wave.theta : INFINITY;
        if ((is->kind == NS_STATE_DECAY || is->kind == NS_STATE_COS) && dies > instant)
            rate[count++] = (ns_mode_rate){hypot(is->wave.theta, is->omega), dies};
    }
    qsort(rate, (size_t)count, sizeof *rate, by_size);
    return count;
}

/* h of a stage for this rate: a power of two of the marcher's h, which other levels and modes then share. */
static double length_for(const ns_exact *f, double rate) {
    const double longest = 256 * f->h;
    if (!(rate > 0) || NS_REACH / rate >= longest)
        return longest;
    return ldexp(f->h, (int)floor(log2(NS_REACH / rate / f->h)));
}

ns_time_scale *ns_exact_mode_reach(ns_exact *f, ns_exact_mode *k, int i) {
    ns_time_scale *level = &k->level[i];
    if (level->stage)
        return level;
    ns_theta_set_mode(f->s, k->mode);
    const int status = ns_exact_kernel_build(f->s, f->exo, level->h / NS_POLE, k->mode, &level->stage);
    if (status != NS_OK) {
        if (status == NS_E_MEMORY)
            f->status = status;
        k->levels = i; /* the one before is slower, and right */
        return NULL;
    }
    f->bytes += level->stage->bytes;
    return level;
}

/* Each goes on from where the rates of the one before have died out, if they do. */
static void list_levels(const ns_exact *f, ns_exact_mode *k, const ns_mode_rate *rate, int count) {
    double from = 0;
    int i = 0;
    while (k->levels < NS_LEVELS) {
        const double size = i < count ? rate[i].size : 0;
        k->level[k->levels].from = from;
        k->level[k->levels++].h = length_for(f, size);
        while (i < count && rate[i].size * APART > size) { /* these die out together */
            from = fmax(from, rate[i].dies);
            i++;
        }
        if (isinf(from) || size == 0)
            break;
    }
}

static int build(ns_exact *f, ns_exact_mode *k) {
    const int r = f->s->r, all = r + f->exo->nv;
    double *room = malloc(sizeof *room * (2 * (size_t)r + 1));
    ns_mode_rate *rate = malloc(sizeof *rate * ((size_t)all + 1));
    ns_mode_kernel *probe = NULL;
    /* shorter ones see nothing slow, longer ones nothing fast */
    const double guess = f->guess < f->h / 64 || f->guess > f->h ? f->h : f->guess;
    int status =
        room && rate ? ns_exact_kernel_build(f->s, f->exo, guess / NS_POLE, k->mode, &probe) : NS_E_MEMORY;
    const int count = status == NS_OK ? list_rates(f, probe, rate, room, &k->instant, &status) : 0;
    if (status == NS_OK)
        list_levels(f, k, rate, count);
    if (status == NS_OK && k->level[0].h == guess) {
        k->level[0].stage = probe;
        f->bytes += probe->bytes;
        probe = NULL;
    } else if (status == NS_OK) {
        status = ns_exact_kernel_build(f->s, f->exo, k->level[0].h / NS_POLE, k->mode, &k->level[0].stage);
        f->guess = k->level[0].h;
        f->bytes += status == NS_OK ? k->level[0].stage->bytes : 0;
    }
    ns_exact_kernel_free(probe);
    free(room);
    free(rate);
    return status;
}

int ns_exact_mode_find(ns_exact *f, const ns_mode *mode, ns_exact_mode **out) {
    const size_t m = (size_t)f->system->m;
    ns_exact_mode **head = &f->bucket[hash_of(mode, f->system->m)], *k = *head;
    while (k && memcmp(k->mode, mode, m) != 0)
        k = k->chain;
    *out = k && k->status == NS_OK ? k : NULL;
    if (k)
        return k->status;
    k = calloc(1, sizeof *k);
    if (!k || !(k->mode = malloc(m + 1))) {
        free(k);
        return NS_E_MEMORY;
    }
    memcpy(k->mode, mode, m);
    ns_theta_set_mode(f->s, mode);
    k->status = build(f, k);
    if (k->status != NS_OK && k->status != NS_E_SINGULAR) {
        const int status = k->status;
        free_mode(k);
        return status;
    }
    k->chain = *head;
    *head = k;
    *out = k->status == NS_OK ? k : NULL;
    f->bytes += sizeof *k + m;
    f->s->counts.modes += k->status == NS_OK;
    return k->status;
}

ns_time_scale *ns_exact_mode_time_scale(ns_exact *f, double *until) {
    ns_exact_mode *k = f->at;
    int i = 0;
    *until = INFINITY;
    if (k->levels == 1)
        return &k->level[0];                                             /* which is there */
    const double flown = f->t - f->since + 8 * DBL_EPSILON * fabs(f->t); /* t must be seen to move */
    while (i + 1 < k->levels && flown >= k->level[i + 1].from * (1 - 1e-9))
        i++;
    ns_time_scale *level = k->level[i].stage ? &k->level[i] : ns_exact_mode_reach(f, k, i);
    while (!level)
        level = ns_exact_mode_reach(f, k, --i);
    if (i + 1 < k->levels)
        *until = k->level[i + 1].from;
    return level;
}
