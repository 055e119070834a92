/* src/march/run_watch.c - events and ends of repeated periods, judged while a trial is made (engine/watch.h).
 */
#include "run_internal.h"

#include <math.h>
#include <string.h>

/* Fewer than eight modes, in one number. */
static uint64_t last_word(size_t count, const ns_mode *mode) {
    uint32_t first = 0, last = 0;
    if (count >= sizeof first) { /* some of them twice */
        memcpy(&first, mode, sizeof first);
        memcpy(&last, mode + count - sizeof last, sizeof last);
    }
    for (size_t i = 0; i < count && count < sizeof first; i++)
        first = first << 8 | (unsigned char)mode[i];
    return (uint64_t)last << 32 | first;
}

static uint64_t hash(uint64_t key, size_t count, const ns_mode *mode) {
    uint64_t word;
    for (; count >= sizeof word; count -= sizeof word, mode += sizeof word) {
        memcpy(&word, mode, sizeof word);
        key = (key ^ word) * 0x9e3779b97f4a7c15u;
    }
    key = (key ^ last_word(count, mode)) * 0x9e3779b97f4a7c15u;
    return key ^ (key >> 32);
}

/* 1 if a key was not seen before; then it was. */
static int is_new(ns_run_check *k, uint64_t key) {
    uint64_t *place = &k->seen[(key >> 7) % NS_RUN_SEEN];
    const int differs = *place != key;
    *place = key;
    return differs;
}

/* The same of modes alone.  Every one is kept: where a few take each other's places, modes that recur look
 * like new ones. */
static void count_mode(ns_run_check *k, uint64_t key) {
    enum { TRIES = 8 };
    uint64_t *const first = &k->modes_seen[(key >> 7) % NS_RUN_MODES], *place = first;
    for (int i = 0; i < TRIES && *place != 0; i++) {
        if (*place == key)
            return;
        place = &k->modes_seen[((key >> 7) + (uint64_t)i + 1) % NS_RUN_MODES];
    }
    *(*place == 0 ? place : first) = key;
    k->modes++;
}

/* 1 if what comes back was not looked at for so many times. */
static int is_due(ns_run_check *k, uint64_t key) {
    enum { EVERY = 16 };
    unsigned char *times = &k->times[(key >> 7) % NS_RUN_SEEN];
    *times = (unsigned char)((*times + 1) % EVERY);
    return *times == 0;
}

/* What was not seen before is looked at on credit. */
static int may_spend(const ns_run *r, int is_unseen, double cost) {
    enum { DEBT = 16 };
    return r->check.credit >= (is_unseen ? -DEBT * cost : cost);
}

/* As much as may be spent: in full the first events, from which sizes are learnt, and then a few.  What was
 * not seen before is looked at on credit; of the sparse engine, whose looks are cheap, always. */
static ns_watch_part afford(ns_run *r, int is_unseen) {
    enum { FIRST = 8, EVERY = 64, DEBT = 64 };
    ns_run_check *k = &r->check;
    const double owes = !is_unseen ? 0 : r->is_dense ? DEBT * k->quick_cost : INFINITY;
    if (k->credit + owes < k->quick_cost)
        return NS_WATCH_NOTHING;
    const int is_full = k->looks++ < FIRST || k->looks % EVERY == 0;
    return is_full && may_spend(r, is_unseen, 2 * k->point_cost + k->event_cost) ? NS_WATCH_ALL
                                                                                 : NS_WATCH_SOME;
}

static ns_watch_part wants_left(ns_run *r, const ns_mode *mode) {
    ns_run_check *k = &r->check;
    ns_march_check_earn(k, k->event_gain);
    k->jumped_before = k->jumped;
    k->left_key = hash(1, (size_t)r->s->m, mode);
    count_mode(k, k->left_key);
    return k->left = afford(r, is_new(k, k->left_key) || is_due(k, k->left_key));
}

static ns_watch_part wants_right(ns_run *r, const ns_mode *mode) {
    ns_run_check *k = &r->check;
    const uint64_t jumps = k->jumped != k->jumped_before;
    const int is_unseen = is_new(k, hash(k->left_key ^ jumps, (size_t)r->s->m, mode));
    k->right = k->left;
    if (is_unseen)
        ns_march_check_earn(k, k->mode_gain);
    if (is_unseen && k->right == NS_WATCH_NOTHING)
        k->right = afford(r, 1);
    return k->right;
}

ns_watch_part ns_march_watch_wants(void *data, ns_watch_side side, const ns_mode *mode) {
    ns_run *r = data;
    ns_run_check *k = &r->check;
    k->has_all = r->is_dense;
    if (side == NS_WATCH_PERIOD) {
        k->periods = k->periods_rest;
        return NS_WATCH_SOME;
    }
    const ns_watch_part part = side == NS_WATCH_LEFT ? wants_left(r, mode) : wants_right(r, mode);
    k->shown_mode = part == NS_WATCH_NOTHING ? NULL : mode;
    return part == NS_WATCH_NOTHING ? part : NS_WATCH_SOME;
}

/* k->impulse, less what jumped before. */
static void take_impulse(ns_run *r) {
    ns_run_check *k = &r->check;
    const size_t all = (size_t)r->s->n + (size_t)r->s->m;
    if (!k->jumped)
        memset(k->impulse, 0, sizeof *k->impulse * all);
    for (size_t i = 0; i < all && k->jumped_before; i++)
        k->impulse[i] -= k->before[i];
}

/* The sparse engine shows at first what is at hand: what is wrong then is shown once more, to the last digit.
 */
static int asks_for_all(ns_run_check *k) {
    k->has_all = 1;
    return NS_GUARD;
}

/* In full, of what is at hand. */
static int some_is_right(ns_run *r, double t, ns_side side) {
    ns_run_check *k = &r->check;
    ns_verify_state at = ns_march_check_state(r, t, side, NULL);
    ns_verify_finding f;
    at.is_some = 1;
    k->credit -= k->point_cost;
    return ns_verify_point(k->verify, &at, &f) && ns_march_sliding_is_limit(r, &at);
}

/* 1 if an engine that goes again would take a million events to come to where it is asked for. */
static int crawls(ns_run_check *k, double t) {
    static const double look_after = 5e3, most = 1e6;
    if (k->again_events == 0)
        return 0;
    const double events = (double)k->again_events++,
                 part = (t - k->again_from) / (k->again_to - k->again_from);
    return events > look_after && part * most < events;
}

static int sees_left(ns_run *r, double t) {
    ns_run_check *k = &r->check;
    if (crawls(k, t))
        return NS_E_LIMIT;
    const ns_verify_state at = ns_march_check_state(r, t, NS_LEFT, NULL);
    if (k->jumped)
        memcpy(k->before, k->impulse, sizeof *k->before * ((size_t)r->s->n + (size_t)r->s->m));
    if (k->left == NS_WATCH_SOME) {
        ns_verify_quick_left(k->verify, &at);
        return NS_OK;
    }
    if (!(k->has_all ? ns_march_check_point(r, t, NS_LEFT) : some_is_right(r, t, NS_LEFT)))
        return k->has_all ? NS_E_RESIDUAL : asks_for_all(k);
    ns_verify_left(k->verify);
    return NS_OK;
}

static int impulses_are_right(const ns_run *r) {
    const ns_run_check *k = &r->check;
    return !k->jumped || ns_verify_quick_impulses(k->verify, k->impulse, k->impulse + r->s->n);
}

/* The right side, and how the left side led to it. */
static int change_is_right(ns_run *r, double t) {
    ns_run_check *k = &r->check;
    ns_verify_finding f;
    if (k->left == NS_WATCH_SOME)
        (void)ns_verify_left_in_full(k->verify, &f);
    if (!(k->has_all ? ns_march_check_point(r, t, NS_RIGHT) : some_is_right(r, t, NS_RIGHT)))
        return 0;
    if (k->left == NS_WATCH_NOTHING)
        return impulses_are_right(r);
    take_impulse(r);
    return k->has_all ? ns_march_check_event(r)
                      : ns_verify_event(k->verify, k->impulse, k->impulse + r->s->n, &f);
}

static int goes_forwards(const ns_run *r) {
    const ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n;
    return !k->jumped ||
           ns_verify_quick_directions(k->verify, k->impulse + n, k->jumped_before ? k->before + n : NULL);
}

/* From a left side that was seen in a hurry; where none was seen, by what jumped in the trial so far. */
static int quickly_leads_here(const ns_run *r) {
    return r->check.left == NS_WATCH_NOTHING ? impulses_are_right(r)
                                             : ns_verify_quick_stays(r->check.verify) && goes_forwards(r);
}

static int is_quickly_right(ns_run *r, double t) {
    ns_run_check *k = &r->check;
    const ns_verify_state at = ns_march_check_state(r, t, NS_RIGHT, NULL);
    k->checks++;
    k->credit -= k->quick_cost;
    return ns_verify_quick_point(k->verify, &at) && quickly_leads_here(r);
}

static int sees_right(ns_run *r, double t) {
    ns_run_check *k = &r->check;
    if ((k->right == NS_WATCH_SOME && is_quickly_right(r, t)) || change_is_right(r, t))
        return NS_OK;
    k->right = NS_WATCH_ALL;
    return k->has_all ? NS_E_RESIDUAL : asks_for_all(k);
}

/* k->here and k->impulse are the point and what jumped so far. */
int ns_march_watch_sees(void *data, ns_watch_side side, double t) {
    ns_run *r = data;
    const int status = side == NS_WATCH_LEFT                          ? sees_left(r, t)
                       : side == NS_WATCH_RIGHT                       ? sees_right(r, t)
                       : ns_march_check_quickly(r, t, NS_RIGHT, NULL) ? NS_OK
                                                                      : NS_E_RESIDUAL;
    if (status != NS_GUARD)
        r->check.shown_mode = NULL;
    if (side == NS_WATCH_LEFT)
        return status;
    if (status != NS_GUARD)
        r->check.left = NS_WATCH_NOTHING;
    return status;
}
