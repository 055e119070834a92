/* src/exact/engine.c - the exact engine: from event to event (E1), (E2). */
#include "exact_internal.h"
#include "sliding.h"

#include "guards.h"
#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* More events in a row than this, each within h 2^-20 of the one before: they accumulate, or a switch
 * chatters. */
enum { NS_MAX_EVENT_COUNT = 40 };
/* Steps that a trial may take beyond what the ladder would; halved each time they were used up.  And those
 * between events of diodes alone, which a ring may make many of: the ladder damps that. */
enum { NS_EXTRA_STEPS = 100000, NS_DIODE_STEPS = 5000000 };

void ns_exact_accept(ns_exact *f) {
    f->past.trials++;
    f->past.period = f->record.duration;
    f->accepted = f->past;
    f->way.known = 0;
}

void ns_exact_drop(ns_exact *f) {
    f->past = f->accepted;
    f->unmended.mode = f->left.mode = NULL;
    f->way.known = 0;
}

static void reset_past(ns_exact *f) {
    f->accepted = (ns_exact_past){.fallback_until = -INFINITY,
                                  .guard_t = -INFINITY,
                                  .previous_event_t = -INFINITY,
                                  .extra_steps = f->timed ? NS_EXTRA_STEPS : 0};
    ns_exact_drop(f);
}

/* --- the point, from the run and back --- */

/* Inputs at t, on the side where the list of instants stands. */
static void read_inputs(ns_exact *f) {
    const double t = f->state.now.t;
    ns_inputs_events_values(f->events, t, f->work.z, f->work.slope);
    ns_inputs_states_at(f->inputs, t, f->work.z, f->work.slope, f->X + f->s->r);
}

/* The list of instants is put to the present time, unless it is there. */
static void seek_events(ns_exact *f) {
    const ns_system *y = f->system;
    const double t = f->state.now.t;
    int same = t >= f->events_from && (t < f->events_to || (f->point->at_event && t == f->events_to));
    for (int c = 0; c < y->nc; c++) {
        f->work.closed[c] = ns_theta_mode(f->s)[y->command[c].pair] == NS_INSIDE;
        same = same && (y->command[c].gx || f->work.closed[c] == ns_inputs_events_closed(f->events)[c]);
    }
    if (same)
        return;
    ns_inputs_events_seek(f->events, t, f->point->at_event ? NS_LEFT : NS_RIGHT, f->work.closed);
    f->events_from = f->events_to = t;
}

/* What is kept fits the limit again. */
static void trim_cache(ns_exact *f) {
    if (f->cache.bytes <= f->cache.limit)
        return;
    ns_exact_period_drop(f); /* it points to modes */
    ns_exact_mode_trim(f, f->state.mode);
}

static void load_time(ns_exact *f) {
    f->state.now = f->point->now;
    f->state.last_event_t = f->point->last_event_t;
}

static void load_charges(ns_exact *f) {
    seek_events(f);
    memcpy(f->X, f->s->past.w, sizeof(double) * (size_t)f->s->r);
    read_inputs(f);
    ns_exact_note_size(f);
}

int ns_exact_place(ns_exact *f) {
    load_time(f);
    ns_theta_set_bounds(f->s); /* pairs across closed switches become idle */
    const int status = ns_exact_mode_find(f, ns_theta_mode(f->s), &f->state.mode);
    if (status != NS_OK)
        return status;
    trim_cache(f);
    load_charges(f);
    return NS_OK;
}

static int load_point(ns_exact *f) {
    const int status = ns_exact_place(f);
    if (status == NS_OK && !f->point->at_event)
        ns_exact_enter_consistent(f);
    return status;
}

int ns_exact_output_at(ns_exact *f, double t, ns_side side, double *X, double *x_lambda) {
    double until;
    const ns_time_scale *scale =
        side == NS_LEFT ? ns_exact_mode_scale_before(f) : ns_exact_mode_time_scale(f, &until);
    ns_mode_kernel *k = scale->kernel;
    ns_system_inputs(f->system, t, side, f->work.z);
    for (int i = 0; i < f->inputs->output_only_inputs; i++)
        X[k->q + i] = f->work.z[f->inputs->output_only_input[i]];
    return ns_exact_output_of(f, k, X, x_lambda);
}

/* The run's point is that of the state. */
static int store_point(ns_exact *f) {
    const ns_side side = f->point->at_event ? NS_LEFT : NS_RIGHT;
    const int status = ns_exact_output_at(f, f->state.now.t, side, f->X, f->work.x_lambda);
    if (status != NS_OK)
        return status;
    ns_theta_set_mode(f->s, f->state.mode->mode);
    ns_theta_put(f->s, f->X, f->work.x_lambda, f->state.mode->mode, f->work.z);
    ns_theta_set_controls(f->s, f->work.x_lambda);
    f->point->now = f->state.now;
    f->point->last_event_t = f->state.last_event_t;
    return NS_OK;
}

int ns_exact_find_consistent(ns_exact *f, int guess) {
    load_time(f);
    f->state.last_event_t = f->state.now.t;
    f->events_to = -INFINITY; /* seek_events() has to seek */
    reset_past(f);
    ns_exact_period_drop(f);
    memset(f->max_abs, 0, sizeof(double) * (size_t)f->s->r);
    load_charges(f);
    ns_theta_set_bounds(f->s);
    const int status = ns_exact_select_start(f, guess);
    return status == NS_OK ? store_point(f) : status;
}

/* --- events --- */

/* No command has flipped; if the event is one known ahead, its instant is passed: commands flip, inputs jump
 * or turn. */
static void begin_event(ns_exact *f, int timed) {
    memset(f->point->flip, 0, (size_t)f->system->nc);
    if (!timed)
        return;
    const ns_time_event *what = ns_inputs_events_pass(f->events);
    f->events_from = f->events_to = what->t;
    for (int i = 0; i < what->flips; i++)
        f->point->flip[what->flip[i]] = 1;
    read_inputs(f);
}

static void count_event(ns_exact *f) {
    const double near = f->h / (1 << NS_EVENT_EXPONENT);
    f->counts.events++;
    f->past.event_count = f->state.now.t - f->past.previous_event_t < near ? f->past.event_count + 1 : 0;
    f->past.previous_event_t = f->state.now.t;
}

void ns_exact_watch(ns_exact *f, const ns_watch *w) {
    f->watch = w;
}

/* What jumped so far, and that the point is there. */
static int tell(const ns_exact *f, ns_watch_side side) {
    const ns_watch *w = f->watch;
    const size_t n = (size_t)f->system->n, m = (size_t)f->system->m;
    if (*w->jumped) {
        memcpy(w->X, f->point->instant->sum, sizeof *w->X * n);
        memcpy(w->Lambda, f->point->instant->sum + n, sizeof *w->Lambda * m);
    }
    return w->sees(w->data, side, f->state.now.t);
}

/* 1 if the point is to be shown. */
static int is_wanted(const ns_exact *f, ns_watch_side side) {
    if (f->watch)
        *f->watch->jumped = f->point->instant ? f->point->instant->any : 0;
    return ns_watch_wants(f->watch, side, f->state.mode->mode) != NS_WATCH_NOTHING;
}

/* The point is shown to who wants to see it. */
static int show(ns_exact *f, ns_watch_side side) {
    const ns_watch *w = f->watch;
    const size_t n = (size_t)f->system->n, m = (size_t)f->system->m;
    if (!is_wanted(f, side))
        return NS_OK;
    const int status = ns_exact_output_at(f, f->state.now.t, side == NS_WATCH_LEFT ? NS_LEFT : NS_RIGHT, f->X,
                                          f->work.x_lambda);
    if (status != NS_OK)
        return status;
    memcpy(w->x, f->work.x_lambda, sizeof *w->x * n);
    memcpy(w->lambda, f->work.x_lambda + n, sizeof *w->x * m);
    return tell(f, side);
}

/* The same, where the run's point is the left side of an event: inputs may stand on its right side already.
 */
static int show_first(ns_exact *f) {
    const ns_watch *w = f->watch;
    if (!is_wanted(f, NS_WATCH_LEFT))
        return NS_OK;
    const int status = ns_theta_read(f->s, w->x, w->lambda, NULL);
    return status == NS_OK ? tell(f, NS_WATCH_LEFT) : status;
}

/* The event here is resolved: guard broke, or (NS_GUARD_NONE) an instant known ahead was passed.  *failed: it
 * is left to the ladder, which gets point->flip. */
static int resolve_event(ns_exact *f, int guard, int *failed) {
    const size_t nc = (size_t)f->system->nc;
    const ns_exact_mode *was = f->state.mode;
    count_event(f);
    memcpy(f->work.flip, f->point->flip, nc);
    const int many = f->past.event_count > NS_MAX_EVENT_COUNT;
    const int status = many ? NS_GUARD : ns_exact_select_mode(f, guard);
    *failed = status == NS_GUARD;
    if (*failed)
        memcpy(f->point->flip, f->work.flip, nc);
    else
        f->state.last_event_t = f->state.now.t;
    ns_exact_event_note_mended(f, was, guard);
    f->point->at_event = *failed;
    if (*failed || status != NS_OK)
        return *failed ? NS_OK : status;
    return show(f, NS_WATCH_RIGHT);
}

/* The event that the accepted point is the left side of. */
static int resolve_first_event(ns_exact *f, int *failed) {
    const double t = f->state.now.t, near = t + ns_system_signal_time_error(t, t);
    const int timed = ns_inputs_events_next(f->events, near) <= near;
    const int known = f->broken.t == t && f->broken.mode == f->state.mode;
    const int status = show_first(f);
    if (status != NS_OK)
        return status;
    begin_event(f, timed);
    return resolve_event(f, timed ? NS_GUARD_NONE : known ? f->broken.guard : NS_GUARD_UNKNOWN, failed);
}

/* To t, or to where a guard breaks: *guard, else NS_GUARD_NONE; or, if it may, to where a trial has taken
 * enough work: the engine that takes less is chosen between trials. */
static int advance_to(ns_exact *f, double t, int may_pause, int *guard) {
    ns_exact_step step = {.guard = NS_GUARD_NONE};
    ns_clock from = f->state.now;
    int status = NS_OK;
    const double begin = f->state.now.t;
    while (status == NS_OK && step.guard < 0 && f->state.now.t < t &&
           !(may_pause && f->state.now.t > begin && ns_exact_is_to_pause(f))) {
        from = f->state.now;
        const int recorded = f->record.open;
        if (recorded)
            ns_exact_period_note_inputs(f);
        status = ns_exact_advance(f, t, &step);
        if (recorded)
            ns_exact_period_record(f, &step);
    }
    *guard = f->broken.guard = step.guard;
    f->broken.at_once = from.t == f->state.now.t && from.lost == f->state.now.lost;
    f->broken.t = f->state.now.t;
    f->broken.mode = *guard >= 0 ? f->state.mode : NULL;
    if (*guard >= 0)
        f->past.guard_t = f->state.now.t;
    return status;
}

/* The event ahead is resolved, and recorded as part of a period. */
static int pass_event(ns_exact *f, int guard, ns_until until, int *failed) {
    const ns_exact_mode *was = f->state.mode;
    int status = show(f, NS_WATCH_LEFT);
    if (status == NS_OK) {
        begin_event(f, guard < 0);
        status = resolve_event(f, guard, failed);
    }
    if (status != NS_OK || *failed || until != NS_TO_TIME)
        ns_exact_period_abort(f);
    else if (guard < 0)
        return ns_exact_period_time_event(f);
    else
        ns_exact_period_guard_broke(f, was, guard);
    return status;
}

/* Where a switch of the state changes no longer before a known event than that is known, the two are one: the
 * event is there. */
static void join_known_event(ns_exact *f, int *guard) {
    const double t = f->state.now.t;
    if (*guard < 0 || f->state.mode->scale[0].kernel->row[*guard].command < 0 ||
        f->events_to > t + ns_system_signal_time_error(t, t))
        return;
    ns_clock_advance(&f->state.now, f->events_to, 0);
    *guard = NS_GUARD_NONE;
}

/* To the next event and through it, or to t; *stop: no further.  A trial that is to end at events stops at
 * their left side, but passes one right where the accepted point is. */
static int go_to_event(ns_exact *f, double accepted_t, double t, ns_until until, int *failed, int *stop) {
    int guard;
    f->events_to = ns_inputs_events_next(f->events, t);
    const int status = advance_to(f, fmin(t, f->events_to), until == NS_TO_STEP, &guard);
    if (status == NS_OK)
        join_known_event(f, &guard);
    const int timed = guard < 0 && f->state.now.t >= f->events_to;
    *stop = status != NS_OK || !(guard >= 0 || timed);
    if (*stop)
        return status;
    const int ends = f->state.now.t >= t || until == NS_TO_STEP ||
                     (until == NS_TO_EVENT && (!timed || ns_inputs_events_is_event(f->events)));
    *stop = ends;
    if (ends && f->state.now.t > accepted_t) {
        f->point->at_event = 1;
        f->point->input_jumps = timed;
        return NS_OK;
    }
    return pass_event(f, guard, until, failed);
}

/* --- a trial --- */

/* A period as the one before, where one begins: 1. */
static int repeat_period(ns_exact *f, double t) {
    if (!ns_exact_period_replay(f, t))
        return 0;
    f->state.last_event_t = f->past.previous_event_t = f->events_from = f->events_to = f->state.now.t;
    f->unmended.mode = f->left.mode = NULL;
    return 1;
}

/* 1 if the last event was the break of a diode's guard: no switch changed, so none chatters. */
static int was_of_diode(const ns_exact *f) {
    const ns_exact_mode *in = f->broken.mode;
    if (!in || f->state.last_event_t != f->broken.t)
        return 0;
    const ns_guard_row *row = &in->scale[0].kernel->row[f->broken.guard];
    return row->command < 0 && !ns_mode_slides(in->mode[row->pair]);
}

/* The next event, as go_to_event(); steps to one of a diode count for nothing, as long as *spare lasts. */
static int go_to_next(ns_exact *f, double accepted_t, double t, ns_until until, long *spare, int *failed,
                      int *stop) {
    const long before = f->state.steps_left;
    const int status = go_to_event(f, accepted_t, t, until, failed, stop);
    const long used = before - f->state.steps_left;
    if (status == NS_OK && used <= *spare && was_of_diode(f)) {
        *spare -= used;
        f->state.steps_left = before;
    }
    return status;
}

/* From the state to t, or to the first event; *failed: to an event that is left to the ladder. */
static int go_on(ns_exact *f, double accepted_t, double t, ns_until until, int *failed) {
    int status = NS_OK, stop = 0;
    long spare = NS_DIODE_STEPS;
    if (f->point->at_event) {
        status = resolve_first_event(f, failed);
        stop = until != NS_TO_TIME;
    }
    /* each event takes a few steps; the ladder has what takes more of them than it would */
    f->state.steps_left = 4000 + f->past.extra_steps + (long)fmin(1e12, 4000 * (t - f->state.now.t) / f->h);
    ns_exact_period_abort(f);
    while (status == NS_OK && !*failed && !stop && f->state.now.t < t) {
        if (until == NS_TO_TIME && repeat_period(f, t)) {
            status = f->watch && --*f->watch->periods < 0 ? show(f, NS_WATCH_PERIOD) : NS_OK;
            continue;
        }
        status = go_to_next(f, accepted_t, t, until, &spare, failed, &stop);
        trim_cache(f);
    }
    if (f->failed != NS_OK)
        status = f->failed;
    f->failed = NS_OK;
    if (status != NS_E_LIMIT || ns_exact_is_over(f))
        return status;
    f->past.extra_steps /= 2;
    *failed = 1;
    return NS_OK;
}

int ns_exact_go(ns_exact *f, double accepted_t, double t, ns_until until) {
    int failed = 0, status = load_point(f);
    f->past.has_no_matrices = status != NS_OK;
    if (status != NS_OK) {
        f->state.steps_left = 0;
        ns_exact_fallback_start(f);
        return status == NS_E_MEMORY ? status : NS_OK;
    }
    if (until == NS_TO_STEP)
        ns_exact_way_begin(f);
    status = go_on(f, accepted_t, t, until, &failed);
    if (status == NS_OK)
        status = store_point(f);
    else
        failed = 0;
    if (until == NS_TO_STEP && status == NS_OK)
        ns_exact_way_end(f);
    if (failed)
        ns_exact_fallback_start(f);
    return status;
}
