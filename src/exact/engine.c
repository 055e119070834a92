/* src/exact/engine.c - the exact engine: exact from event to event (E1), (E2). */
#include "exact_internal.h"
#include "sliding.h"

#include "linalg/simd.h"
#include "system/active_inputs.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Events in a row that come sooner after each other than h 2^-20: they accumulate, or chatter. */
enum { NS_PILE = 40 };
/* Steps that a way may take beyond what the scheme would; half as many each time that was in vain. */
enum { NS_PATIENCE = 100000 };

static int allocate(ns_exact *f) {
    const ns_system *y = f->system;
    const size_t n = (size_t)y->n, m = (size_t)y->m, nz = (size_t)y->nz, r = (size_t)f->s->r;
    const size_t rows = 2 * m + (size_t)y->nc, q = r + (size_t)f->exo->nv;
    const size_t all = 4 * (q + (size_t)f->exo->mutes) + 2 * r + NS_ORDER * (r + rows) +
                       (NS_SAMPLES + 1) * rows + rows + 2 * nz;
    f->block = calloc(all + 2 * (n + m) + 1, sizeof *f->block);
    f->want = calloc(2 * m + 1, sizeof *f->want);
    f->closed = calloc(3 * (size_t)y->nc + 1, sizeof *f->closed);
    f->goal = calloc((size_t)y->nc + 1, sizeof *f->goal);
    if (!f->block || !f->want || !f->closed || !f->goal)
        return NS_E_MEMORY;
    f->flip = f->closed + y->nc;
    f->turns = f->flip + y->nc;
    f->X = f->block;
    f->next = f->X + q + (size_t)f->exo->mutes;
    f->left = f->next + q + (size_t)f->exo->mutes;
    f->ahead = f->left + q + (size_t)f->exo->mutes;
    f->most = f->ahead + q + (size_t)f->exo->mutes;
    f->series = f->most + r;
    f->gone = f->series + NS_ORDER * r;
    f->coef = f->gone + r;
    f->guards = f->coef + NS_ORDER * rows;
    f->rate = f->guards + (NS_SAMPLES + 1) * rows;
    f->z = f->rate + rows;
    f->slope = f->z + nz;
    f->to.x = f->slope + nz;
    f->to.lambda = f->to.x + n;
    f->to.X = f->to.lambda + m;
    f->to.Lambda = f->to.X + n;
    f->to.mode = f->want + m;
    return NS_OK;
}

void ns_exact_accept(ns_exact *f) {
    f->kept = f->past;
}

void ns_exact_drop(ns_exact *f) {
    f->past = f->kept;
    f->doubted_at = NULL;
}

/* It begins anew. */
static void forget_past(ns_exact *f) {
    f->kept =
        (ns_exact_past){.grounded = -INFINITY, .event_t = -INFINITY, .patience = f->timed ? NS_PATIENCE : 0};
    ns_exact_drop(f);
}

static int all_timed(const ns_system *s) {
    for (int c = 0; c < s->nc; c++)
        if (s->command[c].gx)
            return 0;
    return 1;
}

int ns_exact_create(ns_theta *step, ns_dense_point *point, double h, ns_exact **out) {
    ns_exact *f = calloc(1, sizeof *f);
    *out = NULL;
    if (!f)
        return NS_E_MEMORY;
    f->system = step->s;
    f->s = step;
    f->point = point;
    f->h = f->guess = h;
    f->limit = step->cache.limit;
    f->timed = all_timed(f->system);
    forget_past(f);
    ns_exact_watch_pieces(NS_POLE, f->pieces);
    f->acting = calloc((size_t)f->system->nz + 1, 1);
    int status = f->acting ? ns_system_active_inputs(f->system, f->acting) : NS_E_MEMORY;
    if (status == NS_OK)
        status = ns_inputs_events_create(f->system, f->acting, &f->schedule);
    if (status == NS_OK)
        status = ns_inputs_states_create(f->system, f->schedule, &f->exo);
    if (status == NS_OK)
        status = allocate(f);
    step->counts.input_states = f->exo ? f->exo->nv : 0;
    if (status != NS_OK) {
        ns_exact_free(f);
        return status;
    }
    *out = f;
    return NS_OK;
}

void ns_exact_free(ns_exact *f) {
    if (!f)
        return;
    ns_exact_period_drop(f);
    ns_exact_mode_forget_all(f);
    ns_inputs_states_free(f->exo);
    ns_inputs_events_free(f->schedule);
    free(f->laps.v);
    free(f->closed);
    free(f->goal);
    free(f->acting);
    free(f->block);
    free(f->want);
    free(f);
}

int ns_exact_in_fallback(const ns_exact *f) {
    return f->point->now.t < f->past.grounded || f->point->now.t < f->exo->from;
}

double ns_exact_fallback_until(const ns_exact *f) {
    return fmax(f->past.grounded, f->exo->from);
}

/* The inputs at t, on the side where the schedule stands. */
static void read_inputs(ns_exact *f) {
    ns_inputs_events_values(f->schedule, f->t, f->z, f->slope);
    ns_inputs_states_at(f->exo, f->t, f->z, f->slope, f->X + f->s->r);
}

/* The schedule to where the exact is, unless it is there. */
static void seek(ns_exact *f) {
    const ns_system *y = f->system;
    int same = f->t >= f->from && (f->t < f->to_t || (f->point->at_event && f->t == f->to_t));
    for (int c = 0; c < y->nc; c++) {
        f->closed[c] = f->s->past.mode[y->command[c].pair] == NS_INSIDE;
        same = same && (y->command[c].gx || f->closed[c] == ns_inputs_events_closed(f->schedule)[c]);
    }
    if (same)
        return;
    ns_inputs_events_seek(f->schedule, f->t, f->point->at_event ? NS_LEFT : NS_RIGHT, f->closed);
    f->from = f->to_t = f->t;
}

/* What is kept fits the limit again. */
static void trim(ns_exact *f) {
    if (f->bytes <= f->limit)
        return;
    ns_exact_period_drop(f); /* it points to modes */
    ns_exact_mode_trim(f, f->at);
}

int ns_exact_place(ns_exact *f) {
    f->t = f->point->now.t;
    f->time_lost = f->point->now.lost;
    f->since = f->point->last_event_t;
    ns_theta_set_bounds(f->s); /* and twins rest */
    const int status = ns_exact_mode_find(f, ns_theta_mode(f->s), &f->at);
    if (status != NS_OK)
        return status;
    trim(f);
    seek(f);
    memcpy(f->X, f->s->past.w, sizeof(double) * (size_t)f->s->r);
    read_inputs(f);
    for (int i = 0; i < f->s->r; i++)
        f->most[i] = ns_higher(f->most[i], fabs(f->X[i]));
    return NS_OK;
}

/* From the accepted point of the stepper. */
static int load(ns_exact *f) {
    const int status = ns_exact_place(f);
    if (status == NS_OK && !f->point->at_event)
        ns_exact_enter_consistent(f);
    return status;
}

int ns_exact_output_at(ns_exact *f, double t, ns_side side, double *X, double *x) {
    double until;
    ns_mode_kernel *k = ns_exact_mode_time_scale(f, &until)->stage;
    const int all = f->system->n + f->system->m;
    if (!k->now) {
        const int status = ns_exact_output_map(f->s, f->exo, k);
        if (status != NS_OK)
            return status;
        f->bytes += sizeof(double) * (size_t)all * (size_t)(k->q + f->exo->mutes);
    }
    ns_system_inputs(f->system, t, side, f->z);
    for (int i = 0; i < f->exo->mutes; i++)
        X[k->q + i] = f->z[f->exo->mute[i]];
    ns_linalg_matvec(all, k->q + f->exo->mutes, k->now, X, x);
    return NS_OK;
}

/* The stepper's accepted point gets to be here. */
static int deposit(ns_exact *f) {
    const int status = ns_exact_output_at(f, f->t, f->point->at_event ? NS_LEFT : NS_RIGHT, f->X, f->to.x);
    if (status != NS_OK)
        return status;
    ns_theta_set_mode(f->s, f->at->mode);
    ns_theta_put(f->s, f->X, f->to.x, f->at->mode, f->z);
    ns_theta_set_controls(f->s, f->to.x);
    f->point->now.t = f->t;
    f->point->now.lost = f->time_lost;
    f->point->last_event_t = f->since;
    return NS_OK;
}

int ns_exact_find_consistent(ns_exact *f) {
    f->t = f->since = f->point->now.t;
    f->time_lost = f->point->now.lost;
    f->to_t = -INFINITY; /* seek */
    forget_past(f);
    seek(f);
    ns_exact_period_drop(f);
    memcpy(f->X, f->s->past.w, sizeof(double) * (size_t)f->s->r);
    read_inputs(f);
    for (int i = 0; i < f->s->r; i++)
        f->most[i] = fabs(f->X[i]);
    ns_theta_set_bounds(f->s);
    const int status = ns_exact_select_start(f);
    return status == NS_OK ? deposit(f) : status;
}

/* At an instant of the schedule: commands flip, inputs jump or turn. */
static void pass(ns_exact *f, const ns_time_event *what) {
    f->from = f->to_t = what->t;
    for (int i = 0; i < what->flips; i++)
        f->point->flip[what->flip[i]] = 1;
    read_inputs(f);
}

static void count(ns_exact *f) {
    const double near = f->h / (1 << NS_EVENT_EXPONENT);
    f->events++;
    f->past.crowd = f->t - f->past.event_t < near ? f->past.crowd + 1 : 0;
    f->past.event_t = f->t;
}

/* The event here; *stuck: it is for the scheme, which gets f->point->flip. */
static int turn(ns_exact *f, int natural, int *stuck) {
    const size_t nc = (size_t)f->system->nc;
    const ns_exact_mode *was = f->at;
    const int broken = f->broken;
    count(f);
    memcpy(f->flip, f->point->flip, nc);
    const int status = f->past.crowd > NS_PILE ? NS_GUARD : ns_exact_select_mode(f, natural);
    *stuck = status == NS_GUARD;
    if (*stuck)
        memcpy(f->point->flip, f->flip, nc);
    else
        f->since = f->t;
    f->doubted_at = natural && f->at == was && broken >= 0 ? was : NULL;
    f->doubted = broken;
    f->point->at_event = *stuck;
    return *stuck ? NS_OK : status;
}

/* The event that the accepted point is the left side of. */
static int turn_first(ns_exact *f, int *stuck) {
    const double near = f->t + ns_system_signal_slack(f->t, f->t);
    const int known = ns_inputs_events_next(f->schedule, near) <= near;
    memset(f->point->flip, 0, (size_t)f->system->nc);
    if (known)
        pass(f, ns_inputs_events_pass(f->schedule));
    return turn(f, !known, stuck);
}

/* To t, or to where a guard breaks: *broke. */
static int advance(ns_exact *f, double t, int *broke) {
    ns_exact_step step = {0};
    int status = NS_OK;
    while (status == NS_OK && !step.broke && f->t < t) {
        const int recorded = f->laps.open;
        if (recorded)
            ns_exact_period_note_inputs(f);
        status = ns_exact_advance(f, t, &step);
        if (recorded)
            ns_exact_period_record(f, &step);
    }
    *broke = step.broke;
    return status;
}

/* To the next event and beyond it, or to t; *stop: this was the last.  An event right where the march stands
 * is gone through, to its right side. */
static int leap(ns_exact *f, double accepted_t, double t, ns_until until, int *stuck, int *stop) {
    int broke;
    f->to_t = ns_inputs_events_next(f->schedule, t);
    const int status = advance(f, fmin(t, f->to_t), &broke);
    const int known = !broke && f->t >= f->to_t;
    f->broken_t = f->t;
    f->broken_at = broke ? f->at : NULL;
    *stop = status != NS_OK || !(broke || known);
    if (*stop)
        return status;
    const int ends =
        f->t >= t || (until == NS_TO_EVENT && (!known || ns_inputs_events_is_event(f->schedule)));
    if (ends && f->t > accepted_t) {
        f->point->at_event = *stop = 1;
        f->point->input_jumps = known;
        return NS_OK;
    }
    *stop = ends;
    memset(f->point->flip, 0, (size_t)f->system->nc);
    const ns_exact_mode *was = f->at;
    const int guard = f->broken;
    if (known)
        pass(f, ns_inputs_events_pass(f->schedule));
    const int turned = turn(f, !known, stuck);
    if (turned != NS_OK || *stuck || until != NS_TO_TIME)
        ns_exact_period_abort(f);
    else if (known)
        return ns_exact_period_time_event(f);
    else
        ns_exact_period_guard_broke(f, was, guard);
    return turned;
}

/* The scheme has the next event, and more if the exact was shorter than the rest before it, or so short
 * that there would be thousands of them in h (where switches may chatter, than h); the more there were
 * already, the shorter they count. */
static void ground(ns_exact *f) {
    enum { MANY_RUNG = 10, LONG_RUNG = 6, FOR_GOOD = 64 };
    const double h = f->h, least = ldexp(h, 2 - NS_EVENT_EXPONENT), flown = f->t - f->past.grounded;
    if (flown > h)
        f->past.stuck /= 2;
    const double few = f->timed ? ldexp(h, -MANY_RUNG) * (1 + f->past.stuck / FOR_GOOD) : h;
    const int again = flown < fmax(f->past.rest, few);
    f->past.rest = f->budget < 0 ? h : fmin(h, fmax(least, again ? 4 * f->past.rest : f->past.rest / 4));
    f->past.stuck += f->past.rest > ldexp(h, -LONG_RUNG) ? FOR_GOOD : 1;
    f->past.grounded = f->t + f->past.rest;
    f->past.crowd = 0;
    memcpy(f->want, ns_theta_mode(f->s), (size_t)f->system->m);
    for (int c = 0; c < f->system->nc; c++) { /* it knows no third mode */
        ns_mode *mode = &f->want[f->system->command[c].pair];
        if (ns_mode_slides(*mode))
            *mode = NS_LOWER;
    }
    ns_theta_set_mode(f->s, f->want);
}

int ns_exact_go(ns_exact *f, double accepted_t, double t, ns_until until) {
    int status = load(f), stuck = 0, stop = 0;
    if (status != NS_OK) {
        f->budget = 0;
        f->t = f->point->now.t;
        ground(f);
        return status == NS_E_MEMORY ? status : NS_OK;
    }
    if (f->point->at_event) {
        status = turn_first(f, &stuck);
        stop = until == NS_TO_EVENT;
    }
    /* each event takes a few steps; the scheme has what takes more of them than it would */
    f->budget = 4000 + f->past.patience + (long)fmin(1e12, 4000 * (t - f->t) / f->h);
    ns_exact_period_abort(f);
    while (status == NS_OK && !stuck && !stop && f->t < t) {
        if (until == NS_TO_TIME && ns_exact_period_replay(f, t))
            continue;
        status = leap(f, accepted_t, t, until, &stuck, &stop);
        trim(f);
    }
    if (f->status != NS_OK) {
        status = f->status;
        f->status = NS_OK;
    }
    if (status == NS_E_LIMIT) {
        f->past.patience /= 2;
        stuck = 1;
        status = NS_OK;
    }
    if (status != NS_OK)
        return status;
    status = deposit(f);
    if (stuck)
        ground(f);
    return status;
}

int ns_exact_failures(const ns_exact *f) {
    return f->past.stuck;
}

int ns_exact_timed(const ns_exact *f) {
    return f->timed;
}

long ns_exact_events(const ns_exact *f) {
    return f->events;
}
