/* src/march/partition_advance.c - a run for each island: how far each goes at a time.
 *
 * With NS_TO_STEP a trial ends where that of the first island does.  The others keep theirs while the
 * accepted point of the whole is on the way of it: their own accepted points lag behind.
 */
#include "partition_internal.h"

#include <math.h>

/* Islands may end a little beyond what they are asked for; so often the others are asked to come after. */
enum { ROUNDS = 4 };
static int try_one(ns_partition_run *f, int k, double t, ns_until until) {
    ns_part_run *s = &f->part[k];
    const double to = fmax(t, nextafter(s->accepted, INFINITY));
    const int status = s->run->table->try_to(s->run, to, until, &s->trial);
    s->tried = status == NS_OK;
    s->is_step = until == NS_TO_STEP;
    return status == NS_OK ? NS_OK : ns_march_partition_fail(f, k, status);
}

/* Looks ahead to its next event, at most to t, where that is not known.  One that is right here is passed. */
static int look_ahead(ns_partition_run *f, int k, double t) {
    ns_part_run *s = &f->part[k];
    if (s->seen > s->accepted && (s->event || s->seen >= t))
        return NS_OK;
    const int status = try_one(f, k, t, NS_TO_EVENT);
    if (status != NS_OK)
        return status;
    s->event = ns_engine_at_event(s->run);
    s->passes = !s->event && s->trial < t;
    s->seen = s->passes ? s->accepted : s->trial;
    return NS_OK;
}

/* Where the first events are, at most t; or how many islands pass one right here. */
static int first_events(ns_partition_run *f, double t, double *first, int *passing) {
    *first = t;
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        const int status = look_ahead(f, k, *first);
        if (status != NS_OK)
            return status;
        if (s->event)
            *first = fmin(*first, s->seen);
        *passing += s->passes;
    }
    return NS_OK;
}

/* All to t, those with events there to their left sides. */
static int go_there(ns_partition_run *f, double t) {
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        const int event = s->event && s->seen - t <= ns_march_partition_same * fabs(t);
        const double to = event ? s->seen : t;
        if (s->tried && s->trial == to && (!event || ns_engine_at_event(s->run)))
            continue;
        const int status = try_one(f, k, to, event ? NS_TO_EVENT : NS_TO_TIME);
        if (status != NS_OK)
            return status;
    }
    return NS_OK;
}

/* From the left sides of events to their right ones. */
static int pass_events(ns_partition_run *f, double t) {
    int status = NS_OK;
    for (int k = 0; k < f->islands.count && status == NS_OK; k++) {
        f->part[k].passes = f->part[k].at_event;
        if (f->part[k].passes)
            status = try_one(f, k, t, NS_TO_EVENT);
    }
    return status;
}

/* Where events are passed, the others stay. */
static void stay(ns_partition_run *f) {
    for (int k = 0; k < f->islands.count; k++)
        if (!f->part[k].passes) {
            ns_engine_drop(f->part[k].run);
            f->part[k].tried = 0;
        }
}

/* Where the last has come to; the others come after. */
static int come_together(ns_partition_run *f) {
    double last = f->accepted;
    for (int round = 0; round < ROUNDS; round++) {
        int behind = 0;
        for (int k = 0; k < f->islands.count; k++)
            last = fmax(last, f->part[k].tried ? f->part[k].trial : f->part[k].accepted);
        for (int k = 0; k < f->islands.count; k++) {
            ns_part_run *s = &f->part[k];
            if (last - (s->tried ? s->trial : s->accepted) <= ns_march_partition_same * fabs(last))
                continue;
            const int status = try_one(f, k, last, NS_TO_TIME);
            if (status != NS_OK)
                return status;
            behind = 1;
        }
        if (!behind)
            break;
    }
    f->trial = last;
    return NS_OK;
}

static int go_to_event(ns_partition_run *f, double t) {
    double first = t;
    int passing = f->at_event;
    const int status = passing ? pass_events(f, t) : first_events(f, t, &first, &passing);
    if (status == NS_OK && passing)
        stay(f);
    return status == NS_OK && !passing ? go_there(f, first) : status;
}

/* --- to the end of a step --- */

static int accept_one(ns_partition_run *f, int k) {
    ns_part_run *s = &f->part[k];
    const int status = ns_engine_accept(s->run);
    if (status != NS_OK)
        return ns_march_partition_fail(f, k, status);
    s->accepted = s->trial;
    s->at_event = ns_engine_at_event(s->run);
    s->tried = s->lags = 0;
    return NS_OK;
}

/* Islands that lag behind come to the accepted point of the whole, in between two events. */
static int catch_up(ns_partition_run *f) {
    int status = NS_OK;
    for (int k = 0; k < f->islands.count && status == NS_OK; k++) {
        ns_part_run *s = &f->part[k];
        if (!s->lags)
            continue;
        s->seen = s->accepted;
        status = try_one(f, k, f->accepted, NS_TO_TIME);
        if (status == NS_OK)
            status = accept_one(f, k);
    }
    return status;
}

static void drop_one(ns_part_run *s) {
    ns_engine_drop(s->run);
    s->tried = 0;
}

/* Where the first one ends, after the accepted point; trials from before serve again. */
static int first_end(ns_partition_run *f, double t, double *end) {
    *end = t;
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        const int serves = s->tried && s->is_step && s->trial > f->accepted;
        const int status = serves ? NS_OK : try_one(f, k, t, NS_TO_STEP);
        if (status != NS_OK)
            return status;
        *end = fmin(*end, s->trial);
    }
    return NS_OK;
}

/* From the left sides of events to their right ones; *end: where the last one comes to.  The others stay. */
static int pass_steps(ns_partition_run *f, double t, double *end) {
    int status = NS_OK;
    *end = f->accepted;
    for (int k = 0; k < f->islands.count && status == NS_OK; k++) {
        ns_part_run *s = &f->part[k];
        if (s->at_event)
            status = try_one(f, k, t, NS_TO_STEP);
        else if (!s->lags)
            drop_one(s);
        if (s->at_event)
            *end = fmax(*end, s->trial);
    }
    return status;
}

/* Those that end before it come to the end: what passed an event took some time. */
static int come_to(ns_partition_run *f, double end) {
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        const double at = s->tried ? s->trial : s->accepted;
        const int status =
            end - at > ns_march_partition_same * fabs(end) ? try_one(f, k, end, NS_TO_TIME) : NS_OK;
        if (status != NS_OK)
            return status;
    }
    return NS_OK;
}

static int go_to_step(ns_partition_run *f, double t) {
    double end = t, last;
    int status = f->at_event ? pass_steps(f, t, &end) : first_end(f, t, &end);
    if (status == NS_OK && f->at_event)
        status = come_to(f, end);
    last = end;
    for (int k = 0; k < f->islands.count; k++) /* together, but for rounding */
        if (f->part[k].tried && f->part[k].trial - end <= ns_march_partition_same * fabs(end))
            last = fmax(last, f->part[k].trial);
    f->trial = last;
    return status;
}

/* --- a trial --- */

static int go_to_time(ns_partition_run *f, double t) {
    int status = NS_OK;
    for (int k = 0; k < f->islands.count && status == NS_OK; k++)
        status = try_one(f, k, t, NS_TO_TIME);
    return status;
}

static int go_to(ns_partition_run *f, double t, ns_until until) {
    if (until == NS_TO_STEP)
        return go_to_step(f, t);
    int status = catch_up(f);
    for (int k = 0; k < f->islands.count; k++)
        f->part[k].tried = f->part[k].passes = 0;
    if (status == NS_OK)
        status = until == NS_TO_EVENT ? go_to_event(f, t) : go_to_time(f, t);
    return status == NS_OK ? come_together(f) : status;
}

void ns_march_partition_drop(ns_engine *e) {
    ns_partition_run *f = (ns_partition_run *)(void *)e;
    for (int k = 0; k < f->islands.count; k++)
        if (!f->part[k].lags)
            drop_one(&f->part[k]);
    f->has_trial = 0;
}

int ns_march_partition_try(ns_engine *e, double t, ns_until until, double *reached) {
    ns_partition_run *f = (ns_partition_run *)(void *)e;
    if (!f->started)
        return ns_march_partition_fail_here(f, NS_E_STATE);
    const int same = until == f->until;
    const int again =
        f->has_trial && ((t == f->trial && (same || until != NS_TO_STEP)) || (t == f->asked && same));
    if (!(t > f->accepted) || !isfinite(t))
        return ns_march_partition_fail_here(f, NS_E_RANGE);
    if (!again) {
        const int status = go_to(f, t, until);
        if (status != NS_OK) {
            ns_march_partition_drop(e);
            return status;
        }
        f->has_trial = 1;
        f->asked = t;
        f->until = until;
    }
    *reached = f->trial;
    return NS_OK;
}

int ns_march_partition_accept(ns_engine *e) {
    ns_partition_run *f = (ns_partition_run *)(void *)e;
    if (!f->has_trial)
        return NS_E_STATE;
    f->at_event = 0;
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        const int goes_on = ns_march_partition_is_on_way(s, f->trial);
        const int status = s->tried && !goes_on ? accept_one(f, k) : NS_OK;
        if (status != NS_OK)
            return status;
        s->lags = goes_on && s->accepted < f->trial;
        f->at_event |= s->at_event;
    }
    f->accepted = f->trial;
    f->has_trial = 0;
    return NS_OK;
}

/* The part, which is at the accepted point, has its copy of the input replaced. */
static int set_input_of(ns_partition_run *f, int part, int own, const ns_signal *signal) {
    ns_part_run *s = &f->part[part];
    int status = ns_system_set_input(s->island->s, own, signal);
    if (status == NS_OK)
        status = s->run->table->set_input(s->run, own, signal);
    s->at_event = ns_engine_at_event(s->run);
    f->at_event |= s->at_event;
    return status == NS_OK ? NS_OK : ns_march_partition_fail(f, part, status);
}

int ns_march_partition_set_input(ns_engine *e, int input, const ns_signal *signal) {
    ns_partition_run *f = (ns_partition_run *)(void *)e;
    int status = catch_up(f);
    ns_march_partition_drop(e);
    for (int k = 0; k < f->islands.count && status == NS_OK; k++) {
        const ns_island *i = f->part[k].island;
        f->part[k].seen = f->part[k].accepted;
        for (int own = 0; own < i->s->nz && status == NS_OK; own++)
            if (i->input[own] == input)
                status = set_input_of(f, k, own, signal);
    }
    return status;
}
