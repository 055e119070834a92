/* src/ladder/engine.c - the ladder engine: made, started, and asked for the next part of a trial. */
#include "ladder_internal.h"
#include "system/active_inputs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int allocate_arrays(ns_ladder *l) {
    const size_t nz = (size_t)l->s->nz, nc = (size_t)l->s->nc, all = (size_t)l->s->n + (size_t)l->s->m,
                 past = ns_theta_past_size(l->step);
    l->z = calloc(3 * nz + 2 * nc + 2 * all + 2 * past + 1, sizeof(double));
    l->due = calloc(5 * nc + nz + 1, 1);
    if (!l->z || !l->due)
        return NS_E_MEMORY;
    l->z_left = l->z + nz;
    l->fall = l->z_left + nz;
    l->apart = l->fall + nz;
    l->accepted_apart = l->apart + nc;
    l->instant = l->accepted_apart + nc;
    l->order.instant = l->instant + all;
    l->order.past = l->order.instant + all;
    l->order.lone = l->order.past + past;
    l->crossed = l->due + nc;
    l->closed = l->crossed + nc;
    l->order.first = l->closed + nc;
    l->order.due = l->order.first + nc;
    l->active = l->order.due + nc;
    int status = ns_system_active_inputs(l->s, l->active);
    if (status == NS_OK)
        status = ns_inputs_events_create(l->s, NULL, &l->commands);
    return status == NS_OK ? ns_reinit_jump_create(l->step, &l->jump) : status;
}

int ns_ladder_create(ns_theta *step, ns_dense_point *point, double h, ns_ladder **out) {
    ns_ladder *l = calloc(1, sizeof *l);
    *out = NULL;
    if (!l)
        return NS_E_MEMORY;
    l->s = step->s;
    l->step = step;
    l->h = h;
    l->point = point;
    l->contradiction = -1;
    const int status = allocate_arrays(l);
    if (status != NS_OK) {
        ns_ladder_free(l);
        return status;
    }
    *out = l;
    return NS_OK;
}

void ns_ladder_free(ns_ladder *l) {
    if (!l)
        return;
    ns_reinit_jump_free(&l->jump);
    ns_inputs_events_free(l->commands);
    free(l->z);
    free(l->due);
    free(l);
}

void ns_ladder_begin_trial(ns_ladder *l, double dt) {
    /* each event takes some 2 x 24 steps to be located, NS_CROWDING of them fit into one h */
    l->contradiction = -1;
    ns_theta_forget_failure(l->step);
    l->budget = 4000 + (long)fmin(1e12, 4000 * dt / l->h);
}

void ns_ladder_accept(ns_ladder *l) {
    l->accepted_window = l->window;
    memcpy(l->accepted_apart, l->apart, sizeof *l->apart * (size_t)l->s->nc);
}

void ns_ladder_drop(ns_ladder *l) {
    l->window = l->accepted_window;
    memcpy(l->apart, l->accepted_apart, sizeof *l->apart * (size_t)l->s->nc);
    l->any_apart = 1; /* may be */
    l->corner = -INFINITY;
}

/* A corner of an input is resolved as an event.  Where an input jumps, commands may jump with it; where it
 * only turns, currents that are its rate jump, and the rates with them: 0, NS_TO_EVENT goes on.  Where
 * nothing but commands and what is only shown follows it (!is_active), only a mode that ends there too is an
 * event. */
static int look_at_corner(ns_ladder *l, int is_active) {
    const int jump = ns_ladder_inputs_jump(l);
    if (!jump && !is_active) {
        l->point->at_event = !ns_ladder_short_rates(l);
        return 1;
    }
    if (jump)
        (void)ns_ladder_switch_by_time(l, l->point->now.t, l->point->flip);
    l->point->at_event = l->point->input_jumps = 1;
    return jump;
}

int ns_ladder_set_input(ns_ladder *l, int input) {
    l->corner = -INFINITY;
    const int status = ns_inputs_events_renew(NULL, input, &l->commands);
    if (status == NS_OK && !l->point->at_event)
        (void)look_at_corner(l, l->active[input]);
    return status;
}

int ns_ladder_go(ns_ladder *l, const ns_ladder_stop *stop, int *done) {
    ns_dense_point *p = l->point;
    const double corner = ns_ladder_next_corner(l);
    l->limit = fmin(stop->t, corner);
    l->until = stop->interrupt > p->now.t ? fmin(l->limit, stop->interrupt) : l->limit;
    const int is_active = l->corner_is_active;
    int turns = 0;
    *done = 0;
    if (p->at_event) {
        const int status = ns_ladder_event_resolve(l);
        p->last_event_t = p->now.t;
        *done = stop->from_event;
        return status;
    }
    l->one_step = stop->until == NS_TO_STEP;
    const int status = ns_ladder_walk(l, l->until);
    if (status == NS_OK && !p->at_event && p->now.t == corner)
        turns = !look_at_corner(l, is_active);
    *done = stop->until == NS_TO_STEP || (p->at_event && !turns && stop->until == NS_TO_EVENT);
    if (*done && p->at_event &&
        !(p->now.t > stop->accepted_t)) /* right where the trial began: on to its right side */
        return ns_ladder_event_resolve(l);
    return status;
}

/* Commands in the guess become those of the start. */
static void set_guess(ns_ladder *l, ns_mode *guess) {
    for (int c = 0; c < l->s->nc; c++) {
        const int pair = l->s->command[c].pair;
        guess[pair] = ns_theta_mode(l->step)[pair];
    }
    ns_theta_set_mode(l->step, guess);
}

int ns_ladder_restart(ns_ladder *l, double t0, const double *w0, ns_mode *guess) {
    l->point->now = (ns_clock){t0, 0};
    const int status = ns_theta_start(l->step, w0, l->closed);
    if (status == NS_OK && guess)
        set_guess(l, guess);
    return status;
}

int ns_ladder_start(ns_ladder *l, double t0, const double *w0, const unsigned char *closed) {
    const size_t nc = (size_t)l->s->nc;
    *l->point = (ns_dense_point){.now = {t0, 0}, .flip = l->point->flip, .instant = l->point->instant};
    l->window = (ns_event_window){0};
    l->corner = -INFINITY;
    l->limit = l->until = INFINITY;
    l->contradiction = -1;
    for (size_t c = 0; c < nc; c++)
        l->closed[c] = closed ? closed[c] : l->s->command[c].closed != 0;
    const int status = ns_theta_start(l->step, w0, l->closed);
    if (status != NS_OK)
        return status;
    ns_system_inputs(l->s, t0, NS_RIGHT, l->z);
    (void)ns_ladder_switch_by_time(l, t0, l->point->flip);
    for (size_t c = 0; c < nc; c++)
        l->closed[c] = (unsigned char)(l->closed[c] != l->point->flip[c]);
    memset(l->point->flip, 0, nc);
    memset(l->crossed, 0, nc);
    memset(l->apart, 0, sizeof *l->apart * nc);
    l->any_apart = 0;
    return NS_OK;
}

int ns_ladder_find_consistent(ns_ladder *l) {
    const double h = ns_ladder_short_step(l);
    ns_ladder_short_begin(l);
    int status = ns_ladder_short_try(l, h); /* the jump, */
    if (status == NS_OK)
        status = ns_ladder_short_settle(l, h); /* then algebraic unknowns free of it */
    if (status == NS_OK)
        status = ns_ladder_short_commit(l);
    return status;
}

/* Commands that contradict their controls in x; at most so many of them. */
static int toggle(ns_ladder *l, const double *x, int most) {
    unsigned char *flip = l->point->flip;
    const int flips = ns_ladder_switch_at_start(l, x, l->z, l->point->flip);
    for (int c = 0; c < l->s->nc; c++) {
        flip[c] = (unsigned char)(flip[c] && most-- > 0);
        l->closed[c] = (unsigned char)(l->closed[c] != flip[c]);
        l->crossed[c] = (unsigned char)(l->crossed[c] + (flip[c] && l->crossed[c] < 2));
    }
    return flips;
}

int ns_ladder_toggle(ns_ladder *l) {
    double *x = l->jump.x;
    return ns_theta_read(l->step, x, x + l->s->n, NULL) == NS_OK && toggle(l, x, l->s->nc);
}

int ns_ladder_end_start(ns_ladder *l) {
    const int contradicts = ns_ladder_event_contradicts(l);
    memset(l->point->flip, 0, (size_t)l->s->nc);
    if (!contradicts)
        (void)ns_ladder_short_rates(l);
    return !contradicts;
}

int ns_ladder_operating_point(ns_ladder *l, double t0, int nhold, const int *hold, const double *hold_x,
                              double *x, ns_mode *mode) {
    const int together = 2 * l->s->nc; /* rounds; then one by one, as of two that open each other */
    int status = NS_OK;
    for (int round = 0; round <= 2 * together; round++) {
        status = ns_theta_command(l->step, l->closed);
        memcpy(mode, ns_theta_mode(l->step), (size_t)l->s->m);
        ns_system_inputs(l->s, t0, NS_RIGHT, l->z);
        if (status == NS_OK)
            status = ns_theta_lcp_dc(l->step, l->z, nhold, hold, hold_x, mode, x);
        if (status != NS_OK)
            return status;
        ns_theta_set_controls(l->step, x);
        if (!toggle(l, x, round < together ? l->s->nc : 1))
            break;
    }
    return status;
}

int ns_ladder_contradiction(const ns_ladder *l) {
    return l->contradiction;
}

void ns_ladder_counts(const ns_ladder *l, ns_counts *counts) {
    counts->events += l->events;
    counts->jumps += l->jump.jumps;
    counts->jumps_by_steps += l->jump.refused;
}
