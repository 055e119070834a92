/* src/march/run_check.c - what the engine at work answers is judged before it counts.
 *
 * In a hurry (ns_verify_quick_point()): the end of every trial; both sides of every event of the sparse
 * engine, and of the exact one as often as it costs a few hundredths of what the engine itself does, as ends
 * of periods that are repeated.  In full: what is not clearly right then, every change of modes of the exact
 * engine not seen before, and now and then others; parts of ways.  A change of modes in which something jumps
 * counts as another than the same one without a jump.
 */
#include "linalg/simd.h"
#include "run_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void ns_march_check_earn(ns_run_check *k, double gain) {
    const double most = 2 * k->way_cost;
    if (k->credit < most)
        k->credit = ns_lower(k->credit + gain, most);
}

/* --- judged --- */

ns_verify_state ns_march_check_state(const ns_run *r, double t, ns_side side, const double *y) {
    const double *xl = r->check.here;
    return (ns_verify_state){t, side, xl, xl + r->s->n, y, 0};
}

/* What something cost; 1 if it is right. */
static int take(ns_run *r, double cost, int right) {
    ns_run_check *k = &r->check;
    k->credit -= cost;
    k->checks++;
    k->found |= !right;
    return right;
}

int ns_march_check_shown(ns_run *r, double t, ns_side side, const double *y) {
    ns_run_check *k = &r->check;
    const ns_verify_state at = ns_march_check_state(r, t, side, y);
    return take(r, k->point_cost,
                ns_verify_point(k->verify, &at, &k->finding) && ns_march_sliding_is_limit(r, &at));
}

int ns_march_check_point(ns_run *r, double t, ns_side side) {
    return ns_march_check_shown(r, t, side, NULL);
}

/* In a hurry; what is not clearly right is judged in full. */
int ns_march_check_quickly(ns_run *r, double t, ns_side side, const double *y) {
    ns_run_check *k = &r->check;
    const ns_verify_state at = ns_march_check_state(r, t, side, y);
    if (!ns_verify_quick_point(k->verify, &at))
        return ns_march_check_shown(r, t, side, y);
    k->checks++;
    return 1;
}

int ns_march_check_event(ns_run *r) {
    ns_run_check *k = &r->check;
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

/* Points of the way at these times, to k->nodes. */
static int sample_way(ns_run *r, int count, const double *t) {
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    for (int i = 0; i < count; i++) {
        double *x = r->check.nodes + (size_t)i * all;
        if (ns_engine_sample(r->at_work, t[i], x, x + n) != NS_OK)
            return 0;
    }
    return 1;
}

/* Steps that locate no event jump on the way: they are not judged. */
static int judge_step(ns_run *r, double end) {
    ns_run_check *k = &r->check;
    const double t[] = {k->from, end}, *to = k->nodes + r->s->n + r->s->m;
    if (!r->is_dense || !sample_way(r, 2, t))
        return 1;
    const ns_verify_state first = {t[0], NS_RIGHT, k->nodes, k->nodes + r->s->n, NULL, 0},
                          last = {end, NS_LEFT, to, to + r->s->n, NULL, 0};
    return take(r, k->event_cost, ns_verify_step(k->verify, &first, &last, &k->finding));
}

/* Of a trial with NS_TO_STEP from k->from to end; 1 if it is right, or cannot be judged. */
static int judge_way(ns_run *r, double end) {
    ns_run_check *k = &r->check;
    double t[NS_VERIFY_NODES], a, b;
    if (ns_engine_method(r->at_work) == NS_THETA)
        return judge_step(r, end);
    if (!find_part(r, end, &a, &b))
        return 1;
    ns_verify_flow_times(a, b, t);
    return !sample_way(r, NS_VERIFY_NODES, t) ||
           take(r, k->way_cost, ns_verify_flow(k->verify, t, k->nodes, &k->finding));
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
    k->credit -= k->trial_cost;
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

/* A trial that goes from the left side of an event to its right side by steps of the scheme: nobody shows
 * these sides to r->check.watch. */
static void begin_event(ns_run *r) {
    ns_run_check *k = &r->check;
    double t;
    ns_march_check_earn(k, k->event_gain);
    if (k->credit < 2 * k->point_cost + k->event_cost)
        return;
    ns_engine_drop(r->at_work);
    if (!ns_engine_at_event(r->at_work) ||
        ns_engine_read(r->at_work, &t, k->here, k->here + r->s->n, NULL) != NS_OK)
        return;
    k->knows_left = ns_march_check_point(r, t, NS_LEFT);
    k->found = 0; /* it was accepted */
    ns_verify_left(k->verify);
}

static int judge_event(ns_run *r, double reached) {
    ns_run_check *k = &r->check;
    k->knows_left = 0;
    if (ns_engine_read(r->at_work, NULL, k->here, k->here + r->s->n, NULL) != NS_OK ||
        ns_engine_impulse(r->at_work, k->impulse, k->impulse + r->s->n) != NS_OK)
        return 1;
    return ns_march_check_point(r, reached, NS_RIGHT) && ns_march_check_event(r);
}

/* How many steps the engine took since this was asked last; others than the scheme take few in a trial. */
static double steps_since(ns_run *r) {
    ns_run_check *k = &r->check;
    if (r->kind != NS_RUN_SCHEME)
        return 1;
    const long now = r->at_work->table->counts(r->at_work)->steps, since = now - k->steps;
    k->steps = now;
    return fmax((double)since, 1);
}

double ns_march_check_begin(ns_run *r, double t, ns_until until) {
    ns_run_check *k = &r->check;
    k->found = 0;
    if (is_same(k, t, until))
        return t;
    k->is_old = k->knows_left = 0;
    k->left = NS_WATCH_NOTHING;
    ns_march_check_earn(k, k->trial_gain * steps_since(r));
    if (until != NS_TO_TIME && ns_engine_method(r->at_work) == NS_THETA && ns_engine_at_event(r->at_work))
        begin_event(r);
    if (!k->way_next || k->credit < k->way_cost + k->trial_cost)
        return t;
    ns_engine_drop(r->at_work);
    if (ns_engine_at_event(r->at_work) || ns_engine_read(r->at_work, &k->from, NULL, NULL, NULL) != NS_OK)
        k->from = INFINITY; /* it has no way */
    return until == NS_TO_STEP || !(t > k->from) ? t : probe(r, t, until);
}

/* The point judged last, where steps that take no time follow an event. */
static int keeps_digits(ns_run *r) {
    ns_run_check *k = &r->check;
    ns_verify_finding f;
    if (ns_verify_keeps_digits(k->verify, &f))
        return 1;
    k->found = 1;
    k->finding = f;
    return 0;
}

/* The end of a trial, as a point that is shown. */
static int judge_end(ns_run *r, double reached) {
    ns_run_check *k = &r->check;
    const ns_side side = ns_engine_at_event(r->at_work) ? NS_LEFT : NS_RIGHT;
    if (r->kind == NS_RUN_SCHEME) { /* its steps cost less than that */
        if (k->credit < k->quick_cost)
            return 1;
        k->credit -= k->quick_cost;
    }
    if (ns_engine_peek(r->at_work, k->here, k->here + r->s->n) == NS_OK) {
        const ns_verify_state at = ns_march_check_state(r, reached, side, NULL);
        k->checks++;
        k->way_next = 1;
        if (ns_verify_quick_point(k->verify, &at))
            return keeps_digits(r);
    }
    if (ns_engine_read(r->at_work, NULL, k->here, k->here + r->s->n, k->y) != NS_OK)
        return 1;
    k->way_next = 1;
    return ns_march_check_quickly(r, reached, side, k->y) && keeps_digits(r);
}

int ns_march_check_end(ns_run *r, double t, ns_until until, double reached) {
    ns_run_check *k = &r->check;
    if (k->found || is_same(k, t, until))
        return !k->found;
    k->is_old = 1;
    k->asked = t;
    k->until = (int)until;
    const int looks_at_way =
        k->way_next && until == NS_TO_STEP && k->credit >= k->way_cost && reached > k->from;
    if (k->knows_left)
        return judge_event(r, reached);
    if (!judge_end(r, reached) || !looks_at_way)
        return !k->found;
    k->way_next = 0;
    return judge_way(r, reached);
}
