/* src/march/run_check.c - what the engine at work answers is judged before it counts.
 *
 * Of the sparse engine every event is judged, and of the exact one every change of modes that was not seen
 * before; all else as often as it costs a few hundredths of what the engine itself does: points at the end of
 * trials, known events, ends of periods that are repeated, and ways.
 */
#include "run_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- what it costs: estimates in instructions --- */

/* Checks may take this part of what is earned. */
static const double share = 0.03;

static void estimate_costs(ns_run *r) {
    ns_run_check *k = &r->check;
    const double effort = ns_verify_effort(k->verify), size = (double)r->s->n + (double)r->s->m;
    k->point_cost = 1000 + 30 * effort + 300 * (double)r->s->nz;
    k->event_cost = 300 + 5 * effort;
    k->way_cost = NS_VERIFY_NODES * (k->point_cost + 300) + 40 * effort;
    if (r->is_dense) {
        k->trial_gain = share * (400 + 4 * size * size);
        k->event_gain = share * (1000 + 40 * size * size);
        k->period_gain = share * (250 + 5 * size * size);
    } else {
        k->trial_gain = share * 1000;
        k->event_gain = share * (4000 + 120 * effort);
        k->period_gain = 0;
    }
}

static void earn(ns_run_check *k, double gain) {
    const double most = 2 * k->way_cost;
    if (k->credit < most)
        k->credit = fmin(k->credit + gain, most);
}

/* --- made --- */

static ns_watch_part wants(void *data, ns_watch_side side, const ns_mode *mode);
static int sees(void *data, ns_watch_side side, double t);

int ns_march_check_create(ns_run *r) {
    enum { INSTANT_EXPONENT = -11 }; /* with the sparse engine, src/README.md */
    ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n, m = (size_t)r->s->m, all = n + m;
    const ns_verify_options o = {.reltol = r->options.method == NS_EXACT ? 0 : r->options.reltol,
                                 .instant = ldexp(r->options.h, INSTANT_EXPONENT)};
    k->numbers = calloc((3 + NS_VERIFY_NODES) * all + m + 1, sizeof *k->numbers);
    if (!k->numbers)
        return NS_E_MEMORY;
    k->here = k->numbers;
    k->before = k->here + all;
    k->impulse = k->before + all;
    k->nodes = k->impulse + all;
    k->y = k->nodes + NS_VERIFY_NODES * all;
    const int status = ns_verify_create(r->s, &o, &k->verify);
    if (status != NS_OK)
        return status;
    k->watch = (ns_watch){.data = r,
                          .wants = wants,
                          .sees = sees,
                          .x = k->here,
                          .lambda = k->here + n,
                          .X = k->impulse,
                          .Lambda = k->impulse + n};
    ns_march_check_attach(r);
    return NS_OK;
}

void ns_march_check_free(ns_run *r) {
    free(r->check.numbers);
    ns_verify_free(r->check.verify);
}

void ns_march_check_attach(ns_run *r) {
    r->check.is_old = r->check.has_left = 0;
    estimate_costs(r);
    ns_engine_watch(r->at_work, &r->check.watch);
}

void ns_march_check_reset(ns_run *r) {
    ns_run_check *k = &r->check;
    ns_verify_reset(k->verify);
    memset(k->seen, 0, sizeof k->seen);
    k->is_old = k->has_left = k->found = 0;
    k->credit = 0;
    k->doubts = 0;
    k->dice = 1;
}

void ns_march_check_renew(ns_run *r) {
    ns_verify_renew(r->check.verify);
    r->check.is_old = r->check.has_left = r->check.found = 0;
}

/* --- judged --- */

static ns_verify_state state_of(const ns_run *r, double t, ns_side side, const double *xl, const double *y) {
    return (ns_verify_state){t, side, xl, xl + r->s->n, y};
}

/* The scheme has its own accuracy. */
static void set_times(ns_run *r) {
    const int is_scheme = ns_engine_method(r->at_work) == NS_THETA;
    ns_verify_scale(r->check.verify, is_scheme ? ns_verify_wrong : 1);
}

/* An error that may be rounding counts as such from now on: at once if no other engine is more exact, or if
 * the other ones were asked often enough. */
static int is_allowed(ns_run *r) {
    enum { OFTEN = 4 };
    ns_run_check *k = &r->check;
    if (k->finding.error > ns_verify_wrong || (r->kind == NS_RUN_SPARSE && k->doubts++ < OFTEN))
        return 0;
    ns_verify_allow(k->verify, &k->finding);
    return 1;
}

/* What something cost; 1 if it is right. */
static int take(ns_run *r, double cost, int right) {
    ns_run_check *k = &r->check;
    k->credit -= cost;
    k->checks++;
    right = right || is_allowed(r);
    k->found |= !right;
    return right;
}

static int judge_point(ns_run *r, double t, ns_side side, const double *y) {
    ns_run_check *k = &r->check;
    const ns_verify_state at = state_of(r, t, side, k->here, y);
    set_times(r);
    return take(r, k->point_cost, ns_verify_point(k->verify, &at, &k->finding));
}

int ns_march_check_point(ns_run *r, double t, ns_side side) {
    return judge_point(r, t, side, NULL);
}

int ns_march_check_event(ns_run *r) {
    ns_run_check *k = &r->check;
    set_times(r);
    return take(r, k->event_cost, ns_verify_event(k->verify, k->impulse, k->impulse + r->s->n, &k->finding));
}

static double roll(ns_run_check *k) {
    k->dice = k->dice * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(k->dice >> 11) * 0x1p-53;
}

/* A part of the way of the trial: not its first moment, in which transients may be that nothing resolves. */
static int find_part(ns_run *r, double end, double *a, double *b) {
    enum { TIMES = 4 };
    ns_run_check *k = &r->check;
    double until, begin;
    const double d = roll(k), shortest = ns_engine_shortest(r->at_work, k->from, &until);
    begin = k->from + fmin(shortest, (end - k->from) / 4);
    *a = begin + (end - begin) * d * d;
    const double length = TIMES * ns_engine_shortest(r->at_work, *a, &until);
    *b = fmin(fmin(end, *a + length), until);
    return *b - *a > 1e-12 * fabs(*b); /* not where times are rounding */
}

/* Of a trial with NS_TO_STEP from k->from to end; 1 if it is right, or cannot be judged. */
static int judge_way(ns_run *r, double end) {
    ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    double t[NS_VERIFY_NODES], a, b;
    if (ns_engine_method(r->at_work) == NS_THETA || !find_part(r, end, &a, &b))
        return 1;
    ns_verify_flow_times(a, b, t);
    for (size_t i = 0; i < NS_VERIFY_NODES; i++) {
        double *x = k->nodes + i * all;
        if (ns_engine_sample(r->at_work, t[i], x, x + n) != NS_OK)
            return 1;
    }
    set_times(r);
    return take(r, k->way_cost, ns_verify_flow(k->verify, t, k->nodes, &k->finding));
}

/* --- inside of a trial --- */

static uint64_t hash(uint64_t key, size_t count, const ns_mode *mode) {
    uint64_t word;
    for (; count >= sizeof word; count -= sizeof word, mode += sizeof word) {
        memcpy(&word, mode, sizeof word);
        key = (key ^ word) * 0x9e3779b97f4a7c15u;
    }
    word = 0;
    memcpy(&word, mode, count);
    key = (key ^ word) * 0x9e3779b97f4a7c15u;
    return key ^ (key >> 32);
}

/* 1 if a key was not seen before; then it was. */
static int is_new(ns_run_check *k, uint64_t key) {
    uint64_t *place = &k->seen[(key >> 7) % NS_RUN_SEEN];
    const int differs = *place != key;
    *place = key;
    return differs;
}

/* What was not seen before is looked at on credit. */
static int may_spend(const ns_run *r, int is_unseen, double cost) {
    enum { DEBT = 16 };
    return r->check.credit >= (is_unseen ? -DEBT * cost : cost);
}

static ns_watch_part wants_left(ns_run *r, const ns_mode *mode) {
    ns_run_check *k = &r->check;
    int is_unseen = 0;
    earn(k, k->event_gain);
    if (r->is_dense) {
        k->left_key = hash(1, (size_t)r->s->m, mode);
        is_unseen = is_new(k, k->left_key);
    }
    k->has_left = may_spend(r, is_unseen, 2 * k->point_cost + k->event_cost);
    return k->has_left ? NS_WATCH_ALL : NS_WATCH_NOTHING;
}

/* Pairs of the sparse engine, which is wrong more often, are always looked at; in large circuits its modes
 * hardly recur. */
static ns_watch_part wants_right(ns_run *r, const ns_mode *mode) {
    ns_run_check *k = &r->check;
    k->looks_at = k->has_left ? NS_WATCH_ALL : NS_WATCH_NOTHING;
    if (r->is_dense && is_new(k, hash(k->left_key, (size_t)r->s->m, mode)) && may_spend(r, 1, k->point_cost))
        k->looks_at = NS_WATCH_ALL;
    else if (!r->is_dense && !k->has_left)
        k->looks_at = NS_WATCH_PAIRS;
    return k->looks_at;
}

static ns_watch_part wants(void *data, ns_watch_side side, const ns_mode *mode) {
    ns_run *r = data;
    ns_run_check *k = &r->check;
    if (side == NS_WATCH_LEFT)
        return wants_left(r, mode);
    if (side == NS_WATCH_RIGHT)
        return wants_right(r, mode);
    earn(k, k->period_gain);
    return k->credit >= k->point_cost ? NS_WATCH_ALL : NS_WATCH_NOTHING;
}

/* Nothing but the pairs is known. */
static int sees_pairs(ns_run *r) {
    ns_run_check *k = &r->check;
    k->checks++;
    k->looks_at = NS_WATCH_ALL;
    return ns_verify_scan(k->verify, k->here, k->here + r->s->n) ? NS_OK : NS_GUARD;
}

/* k->here and k->impulse are the point and what jumped so far. */
static int sees(void *data, ns_watch_side side, double t) {
    ns_run *r = data;
    ns_run_check *k = &r->check;
    const size_t all = (size_t)r->s->n + (size_t)r->s->m;
    if (side == NS_WATCH_RIGHT && k->looks_at == NS_WATCH_PAIRS)
        return sees_pairs(r);
    int right = judge_point(r, t, side == NS_WATCH_LEFT ? NS_LEFT : NS_RIGHT, NULL);
    if (right && side == NS_WATCH_LEFT) {
        memcpy(k->before, k->impulse, sizeof *k->before * all);
        ns_verify_left(k->verify);
    } else if (right && side == NS_WATCH_RIGHT && k->has_left) {
        for (size_t i = 0; i < all; i++)
            k->impulse[i] -= k->before[i];
        right = ns_march_check_event(r);
    }
    if (side != NS_WATCH_LEFT)
        k->has_left = 0;
    return right ? NS_OK : NS_E_RESIDUAL;
}

/* --- a trial --- */

/* 1 if a trial is the same as the last one, which was judged. */
static int is_same(const ns_run_check *k, double t, ns_until until) {
    return k->is_old && k->asked == t && k->until == (int)until;
}

/* How far a way goes on which no input has a corner. */
static double first_corner(const ns_run *r, double t) {
    for (int k = 0; k < r->s->nz; k++)
        t = fmin(t, ns_signal_next_corner(&r->s->z[k], r->check.from));
    return t;
}

/* What a trial counted that is made once more. */
static void uncount(ns_run *r, const ns_counts *was) {
    const ns_counts *now = r->at_work->table->counts(r->at_work);
    r->before.steps -= now->steps - was->steps;
    r->before.events -= now->events - was->events;
    r->before.jumps -= now->jumps - was->jumps;
    r->before.searches -= now->searches - was->searches;
    r->before.predicted -= now->predicted - was->predicted;
}

/* A look at the way before a trial that cannot be sampled.  Returns to where that trial is to go. */
static double probe(ns_run *r, double t, ns_until until) {
    ns_run_check *k = &r->check;
    const ns_counts was = *r->at_work->table->counts(r->at_work);
    const double to = first_corner(r, t);
    double reached;
    k->credit -= k->trial_gain / share;
    if (!(to > k->from))
        return t;
    const int status = r->at_work->table->try_to(r->at_work, to, NS_TO_STEP, &reached);
    if (status == NS_OK && reached > k->from) {
        k->way_next = 0;
        (void)judge_way(r, reached);
        if (until == NS_TO_EVENT && ns_engine_at_event(r->at_work))
            return reached;
    }
    if (status != NS_OK || reached != t)
        uncount(r, &was);
    return t;
}

double ns_march_check_begin(ns_run *r, double t, ns_until until) {
    ns_run_check *k = &r->check;
    k->found = 0;
    if (is_same(k, t, until))
        return t;
    k->is_old = k->has_left = 0;
    earn(k, k->trial_gain);
    if (!k->way_next || k->credit < k->way_cost + k->trial_gain / share)
        return t;
    ns_engine_drop(r->at_work);
    if (ns_engine_at_event(r->at_work) || ns_engine_read(r->at_work, &k->from, NULL, NULL, NULL) != NS_OK)
        k->from = INFINITY; /* it has no way */
    return until == NS_TO_STEP || !(t > k->from) ? t : probe(r, t, until);
}

/* The end of a trial, as a point that is shown. */
static int judge_end(ns_run *r, double reached) {
    ns_run_check *k = &r->check;
    if (ns_engine_read(r->at_work, NULL, k->here, k->here + r->s->n, k->y) != NS_OK)
        return 1;
    k->way_next = 1;
    return judge_point(r, reached, ns_engine_at_event(r->at_work) ? NS_LEFT : NS_RIGHT, k->y);
}

int ns_march_check_end(ns_run *r, double t, ns_until until, double reached) {
    ns_run_check *k = &r->check;
    if (k->found || is_same(k, t, until))
        return !k->found;
    k->is_old = 1;
    k->asked = t;
    k->until = (int)until;
    if (!k->way_next)
        return k->credit < k->point_cost || judge_end(r, reached);
    if (until != NS_TO_STEP || k->credit < k->way_cost || !(reached > k->from))
        return 1;
    k->way_next = 0;
    return judge_way(r, reached);
}
