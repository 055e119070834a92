/* src/march/partition_advance.c - a run for each island: how far each goes at a time. */
#include "partition_internal.h"

#include <float.h>
#include <math.h>

/* Islands may end a little beyond what they are asked for; so often the others are asked to come after. */
enum { ROUNDS = 4 };
/* Events of islands that are not further apart than this, relative to their time, are one. */
static const double same = 4 * DBL_EPSILON;

static int try_one(ns_partition_run *f, int k, double t, ns_until until) {
    ns_part_run *s = &f->part[k];
    const double to = fmax(t, nextafter(s->accepted, INFINITY));
    const int status = s->run->table->try_to(s->run, to, until, &s->trial);
    s->tried = status == NS_OK;
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
        const int event = s->event && s->seen - t <= same * fabs(t);
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
            if (last - (s->tried ? s->trial : s->accepted) <= same * fabs(last))
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

static int go_to_time(ns_partition_run *f, double t) {
    int status = NS_OK;
    for (int k = 0; k < f->islands.count && status == NS_OK; k++)
        status = try_one(f, k, t, NS_TO_TIME);
    return status;
}

static int go_to(ns_partition_run *f, double t, ns_until until) {
    for (int k = 0; k < f->islands.count; k++)
        f->part[k].tried = f->part[k].passes = 0;
    const int status = until != NS_TO_TIME ? go_to_event(f, t) : go_to_time(f, t);
    return status == NS_OK ? come_together(f) : status;
}

void ns_march_partition_drop(ns_engine *e) {
    ns_partition_run *f = (ns_partition_run *)(void *)e;
    for (int k = 0; k < f->islands.count; k++)
        ns_engine_drop(f->part[k].run);
    f->has_trial = 0;
}

int ns_march_partition_try(ns_engine *e, double t, ns_until until, double *reached) {
    ns_partition_run *f = (ns_partition_run *)(void *)e;
    if (!f->started)
        return ns_march_partition_fail_here(f, NS_E_STATE);
    const int again = f->has_trial && (t == f->trial || (t == f->asked && until == f->until));
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
        if (s->tried) {
            const int status = ns_engine_accept(s->run);
            if (status != NS_OK)
                return ns_march_partition_fail(f, k, status);
            s->accepted = s->trial;
            s->at_event = ns_engine_at_event(s->run);
        }
        if (s->at_event || s->accepted > s->seen)
            s->event = 0;
        f->at_event |= s->at_event;
        s->tried = 0;
    }
    f->accepted = f->trial;
    f->has_trial = 0;
    return NS_OK;
}
