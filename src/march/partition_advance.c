/* src/march/partition_advance.c - marchers side by side: how far each goes at a time. */
#include "partition_internal.h"

#include <float.h>
#include <math.h>

/* Islands may end a little beyond what they are asked for; so often the others are asked to come after. */
enum { ROUNDS = 4 };
/* Events of islands that are not further apart than this, relative to their time, are one. */
static const double same = 4 * DBL_EPSILON;

static int try_one(ns_partition_run *f, int k, double t, ns_until until) {
    ship *s = &f->ship[k];
    const double to = fmax(t, nextafter(s->kept, INFINITY));
    const int status = ns_march_try(s->march, to, until, &s->live);
    s->tried = status == NS_OK;
    return status == NS_OK ? NS_OK : ns_march_partition_fail(f, k, status);
}

/* Looks ahead to its next event, at most to t, where that is not known.  One that is right here is passed. */
static int look_ahead(ns_partition_run *f, int k, double t) {
    ship *s = &f->ship[k];
    if (s->seen > s->kept && (s->event || s->seen >= t))
        return NS_OK;
    const int status = try_one(f, k, t, NS_TO_EVENT);
    if (status != NS_OK)
        return status;
    s->event = ns_march_at_event(s->march);
    s->passes = !s->event && s->live < t;
    s->seen = s->passes ? s->kept : s->live;
    return NS_OK;
}

/* Where the first events are, at most t; or how many islands pass one right here. */
static int first_events(ns_partition_run *f, double t, double *first, int *passing) {
    *first = t;
    for (int k = 0; k < f->islands.count; k++) {
        ship *s = &f->ship[k];
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
        ship *s = &f->ship[k];
        const int event = s->event && s->seen - t <= same * fabs(t);
        const double to = event ? s->seen : t;
        if (s->tried && s->live == to && (!event || ns_march_at_event(s->march)))
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
        f->ship[k].passes = f->ship[k].at_event;
        if (f->ship[k].passes)
            status = try_one(f, k, t, NS_TO_EVENT);
    }
    return status;
}

/* Where events are passed, the others stay. */
static void stay(ns_partition_run *f) {
    for (int k = 0; k < f->islands.count; k++)
        if (!f->ship[k].passes) {
            ns_march_drop(f->ship[k].march);
            f->ship[k].tried = 0;
        }
}

/* Where the last has come to; the others come after. */
static int come_together(ns_partition_run *f) {
    double last = f->kept;
    for (int round = 0; round < ROUNDS; round++) {
        int behind = 0;
        for (int k = 0; k < f->islands.count; k++)
            last = fmax(last, f->ship[k].tried ? f->ship[k].live : f->ship[k].kept);
        for (int k = 0; k < f->islands.count; k++) {
            ship *s = &f->ship[k];
            if (last - (s->tried ? s->live : s->kept) <= same * fabs(last))
                continue;
            const int status = try_one(f, k, last, NS_TO_TIME);
            if (status != NS_OK)
                return status;
            behind = 1;
        }
        if (!behind)
            break;
    }
    f->live = last;
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
        f->ship[k].tried = f->ship[k].passes = 0;
    const int status = until == NS_TO_EVENT ? go_to_event(f, t) : go_to_time(f, t);
    return status == NS_OK ? come_together(f) : status;
}

void ns_march_partition_drop(ns_partition_run *f) {
    for (int k = 0; k < f->islands.count; k++)
        ns_march_drop(f->ship[k].march);
    f->has_trial = 0;
}

int ns_march_partition_try(ns_partition_run *f, double t, ns_until until, double *reached) {
    if (!f->started)
        return ns_march_partition_fail_here(f, NS_E_STATE);
    const int again = f->has_trial && (t == f->live || (t == f->asked && until == f->until));
    if (!(t > f->kept) || !isfinite(t))
        return ns_march_partition_fail_here(f, NS_E_RANGE);
    if (!again) {
        const int status = go_to(f, t, until);
        if (status != NS_OK) {
            ns_march_partition_drop(f);
            return status;
        }
        f->has_trial = 1;
        f->asked = t;
        f->until = until;
    }
    *reached = f->live;
    return NS_OK;
}

int ns_march_partition_accept(ns_partition_run *f) {
    if (!f->has_trial)
        return NS_E_STATE;
    f->at_event = 0;
    for (int k = 0; k < f->islands.count; k++) {
        ship *s = &f->ship[k];
        if (s->tried) {
            const int status = ns_march_accept(s->march);
            if (status != NS_OK)
                return ns_march_partition_fail(f, k, status);
            s->kept = s->live;
            s->at_event = ns_march_at_event(s->march);
        }
        if (s->at_event || s->kept > s->seen)
            s->event = 0;
        f->at_event |= s->at_event;
        s->tried = 0;
    }
    f->kept = f->live;
    f->has_trial = 0;
    return NS_OK;
}
