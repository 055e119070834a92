/* src/march/run_check_create.c - the check of a run: made, attached to an engine, and what it costs. */
#include "run_internal.h"
#include "system/broken_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- what it costs: estimates in instructions --- */

/* The theta scheme may be off by so many times as much; with gamma below 1, where what decays fast rings, and
 * where it locates no event, devices are off their laws. */
static const double of_scheme = 10, of_rough_scheme = 1000;
/* A start as well: sizes are those of one point, and the largest of a start at rest is rounding.  Its first
 * steps are implicit, but for those that locate no event. */
static const double of_start = 10;
/* Checks may take this part of what is earned. */
static const double fraction = 0.025;

static void estimate_costs(ns_run *r) {
    ns_run_check *k = &r->check;
    const double effort = ns_verify_effort(k->verify), size = (double)r->s->n + (double)r->s->m;
    k->point_cost = 1000 + 30 * effort + 300 * (double)r->s->nz;
    k->event_cost = 300 + 5 * effort;
    k->way_cost = NS_VERIFY_NODES * (k->point_cost + 300) + 40 * effort;
    k->quick_cost = 1500 + 10 * effort + 12 * (double)r->s->nz + (r->is_dense ? 5 * size * size : 16 * size);
    if (r->is_dense) {
        k->trial_gain = fraction * (400 + 4 * size * size);
        k->event_gain = fraction * (1000 + 40 * size * size);
        k->periods_rest = (int)fmin(1e6, k->quick_cost / (fraction * (250 + 5 * size * size)));
    } else {
        k->trial_gain = fraction * 1000;
        k->event_gain = fraction * (4000 + 120 * effort);
    }
    k->trial_cost = k->trial_gain / fraction;
    k->mode_gain = r->is_dense ? fraction * 6 * size * size * size : 0;
    k->periods = k->periods_rest;
}

/* What an event may take, s: with the sparse engine, src/README.md; short beside ramps of inputs, which are
 * resolved; of steps that locate none a step. */
static double instant_of(const ns_run *r) {
    enum { INSTANT_EXPONENT = -11, LEAST_EXPONENT = -36 };
    if (r->kind == NS_RUN_SCHEME)
        return r->is_dense ? ldexp(r->options.h, INSTANT_EXPONENT) : r->options.h;
    return fmin(ldexp(r->options.h, INSTANT_EXPONENT),
                fmax(ldexp(r->options.h, LEAST_EXPONENT), r->check.shortest / 4));
}

/* What decays as fast as this is part of a jump, s: it has died out within the instant to which events are
 * located.  Steps that pass an event add up what flows in them, too. */
static double transient_of(const ns_run *r) {
    enum { SHORTER_EXPONENT = -9 };
    return r->kind == NS_RUN_SCHEME ? instant_of(r)
                                    : ldexp(instant_of(r), SHORTER_EXPONENT) / ns_verify_dies_out;
}

/* --- made --- */

int ns_march_check_create(ns_run *r) {
    ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n, m = (size_t)r->s->m, all = n + m;
    k->shortest = ns_system_lines_shortest(r->s->nz, r->s->z);
    const ns_verify_options o = {.reltol = r->options.method == NS_EXACT ? 0 : r->options.reltol,
                                 .instant = instant_of(r),
                                 .transient = transient_of(r)};
    k->numbers = calloc((3 + NS_VERIFY_NODES) * all + m + 1, sizeof *k->numbers);
    k->seen = calloc((NS_RUN_SEEN + NS_RUN_MODES) * sizeof *k->seen + NS_RUN_SEEN, 1);
    if (!k->numbers || !k->seen)
        return NS_E_MEMORY;
    k->modes_seen = k->seen + NS_RUN_SEEN;
    k->times = (unsigned char *)(k->modes_seen + NS_RUN_MODES);
    k->here = k->numbers;
    k->before = k->here + all;
    k->impulse = k->before + all;
    k->nodes = k->impulse + all;
    k->y = k->nodes + NS_VERIFY_NODES * all;
    const int status = ns_verify_create(r->s, &o, &k->verify);
    if (status != NS_OK)
        return status;
    k->watch = (ns_watch){.data = r,
                          .wants = ns_march_watch_wants,
                          .sees = ns_march_watch_sees,
                          .x = k->here,
                          .lambda = k->here + n,
                          .X = k->impulse,
                          .Lambda = k->impulse + n,
                          .jumped = &k->jumped,
                          .periods = &k->periods};
    ns_march_check_attach(r);
    return NS_OK;
}

void ns_march_check_free(ns_run *r) {
    free(r->check.numbers);
    free(r->check.seen);
    ns_march_sliding_free(&r->check);
    ns_verify_free(r->check.verify);
}

void ns_march_check_attach(ns_run *r) {
    r->check.is_old = 0;
    r->check.left = NS_WATCH_NOTHING;
    estimate_costs(r);
    ns_engine_watch(r->at_work, &r->check.watch);
    ns_march_check_scale(r);
}

static double allowance_of(const ns_run *r) {
    const int is_rough = !r->is_dense || (r->options.method == NS_THETA && r->options.gamma < 1);
    return r->kind != NS_RUN_SCHEME ? 1 : is_rough ? of_rough_scheme : of_scheme;
}

void ns_march_check_scale(ns_run *r) {
    ns_verify_scale(r->check.verify, allowance_of(r), instant_of(r), transient_of(r));
}

void ns_march_check_scale_start(ns_run *r) {
    const int is_captured = r->kind == NS_RUN_SCHEME && !r->is_dense;
    ns_verify_scale(r->check.verify, is_captured ? of_rough_scheme : of_start, instant_of(r),
                    transient_of(r));
}

void ns_march_check_reset(ns_run *r) {
    ns_run_check *k = &r->check;
    ns_verify_reset(k->verify);
    memset(k->seen, 0, sizeof *k->seen * (NS_RUN_SEEN + NS_RUN_MODES));
    k->is_old = k->found = 0;
    k->left = NS_WATCH_NOTHING;
    k->credit = 0;
    k->looks = 0;
    k->dice = 1;
}

void ns_march_check_renew(ns_run *r) {
    ns_verify_renew(r->check.verify);
    r->check.is_old = r->check.found = 0;
    r->check.left = NS_WATCH_NOTHING;
}
