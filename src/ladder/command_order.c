/* src/ladder/command_order.c - the right side of an event: commands change at once, or, where that is hasty,
 * in order.
 *
 * In order: switches that follow from one another in one instant, as a gate does that is
 * the inverse of another one: those change first whose change makes nothing jump, and what follows from that;
 * those that would make something jump wait, and change together.
 */
#include "events/ties.h"
#include "ladder_internal.h"

#include <math.h>
#include <string.h>

enum { DUE = 1, CHANGED = 2 }; /* a command, in l->order.due */

/* The event as it begins is kept. */
static void begin(ns_ladder *l) {
    const ns_instant *at = l->point->instant;
    ns_theta_save(l->step, l->order.past);
    l->order.now = l->point->now;
    l->order.jumps = l->jump.jumps;
    l->order.refused = l->jump.refused;
    memcpy(l->order.first, l->point->flip, (size_t)l->s->nc);
    l->order.any = at && at->any;
    if (l->order.any)
        memcpy(l->order.instant, at->sum, sizeof *at->sum * (size_t)at->size);
}

/* It is as it was kept. */
static void go_back(ns_ladder *l) {
    ns_instant *at = l->point->instant;
    ns_theta_restore(l->step, l->order.past);
    l->point->now = l->order.now;
    l->jump.jumps = l->order.jumps;
    l->jump.refused = l->order.refused;
    memcpy(l->point->flip, l->order.first, (size_t)l->s->nc);
    if (!at)
        return;
    ns_instant_clear(at);
    if (l->order.any)
        ns_instant_add(at, 0, at->size, 1, l->order.instant);
}

/* 1 if w is another one than at a point that was kept, which begins with w. */
static int has_jumped(const ns_ladder *l, const double *kept) {
    const ns_theta *s = l->step;
    double most = 0, largest = 0;
    for (int i = 0; i < s->r; i++) {
        most = fmax(most, fabs(s->past.w[i] - kept[i]) / s->unit[i]);
        largest = fmax(largest, fabs(kept[i]) / s->unit[i]);
    }
    return !(most <= ns_events_jump_waits * largest);
}

/* Command c changes alone: 1; 0: not without a jump. */
static int change_alone(ns_ladder *l, int c) {
    const ns_instant *at = l->point->instant;
    const ns_clock now = l->point->now;
    const long jumps = l->jump.jumps, refused = l->jump.refused;
    double h = 0;
    ns_theta_save(l->step, l->order.lone);
    memset(l->point->flip, 0, (size_t)l->s->nc);
    l->point->flip[c] = 1;
    if (ns_ladder_short_change(l, &h, 1) == NS_OK && !has_jumped(l, l->order.lone)) {
        l->order.due[c] = CHANGED;
        return 1;
    }
    ns_theta_restore(l->step, l->order.lone);
    l->point->now = now;
    if (at)
        memcpy(at->sum, l->instant, sizeof *at->sum * (size_t)at->size); /* as the short steps began */
    l->jump.jumps = jumps;
    l->jump.refused = refused;
    return 0;
}

/* Those that the state contradicts are due, too; 0: one of them has changed here. */
static int add_contradicted(ns_ladder *l) {
    (void)ns_ladder_switch_by_state(l, l->z, l->point->flip);
    for (int c = 0; c < l->s->nc; c++) {
        if (l->point->flip[c] && l->order.due[c] == CHANGED)
            return 0;
        l->order.due[c] = l->point->flip[c] ? DUE : l->order.due[c];
    }
    return 1;
}

/* One after another, those alone that make nothing jump; how many; -1: one would change twice. */
static int change_in_order(ns_ladder *l) {
    int count = 0, more = 1;
    while (more) {
        more = 0;
        for (int c = 0; c < l->s->nc && !more; c++)
            more = l->order.due[c] == DUE && change_alone(l, c);
        if (more && !add_contradicted(l))
            return -1;
        count += more;
    }
    return count;
}

/* From there.  Errors: LIMIT: there is no such order, or what follows in it contradicts itself. */
static int settle_in_order(ns_ladder *l) {
    double h = 0;
    int status = NS_OK, left = 0;
    if (!ns_ladder_any_by_state(l))
        return NS_E_LIMIT;
    go_back(l);
    memcpy(l->order.due, l->order.first, (size_t)l->s->nc);
    if (change_in_order(l) <= 0)
        return NS_E_LIMIT;
    for (int c = 0; c < l->s->nc; c++)
        left += l->point->flip[c] = l->order.due[c] == DUE;
    status = left ? ns_ladder_short_change(l, &h, 1) : NS_OK;
    return status == NS_OK && ns_ladder_switch_by_state(l, l->z, l->point->flip) ? NS_E_LIMIT : status;
}

/* With commands that change here change those of the state that would in the shortest step from here. */
static void flip_commands_met(ns_ladder *l) {
    const double h = ns_ladder_short_step(l);
    if (!ns_ladder_any_by_state(l) || ns_ladder_inputs_jump(l))
        return;
    ns_system_inputs(l->s, l->point->now.t + h, NS_LEFT, l->z);
    if (ns_theta_probe(l->step, h, l->z, 0) != NS_OK || !ns_ladder_switch_by_state(l, l->z, l->crossed))
        return;
    for (int c = 0; c < l->s->nc; c++)
        l->point->flip[c] |= l->crossed[c];
}

static void count_event(ns_ladder *l) {
    l->events++;
    (void)ns_events_count(&l->window, l->point->now.t, l->h);
}

static int any(const unsigned char *flip, int count) {
    for (int c = 0; c < count; c++)
        if (flip[c])
            return 1;
    return 0;
}

/* One switch may make another one switch: at most so many rounds as there are changes of switches, and one.
 * *hasty: 1: one changes after something jumped, which might not have jumped had that changed before. */
static int change_at_once(ns_ladder *l, int changed, int *hasty) {
    double h = 0;
    int status = NS_OK;
    *hasty = 0;
    memset(l->crossed, 0, (size_t)l->s->nc);
    for (int round = 0; round <= 2 * l->s->nc + 1; round++) {
        status = ns_ladder_short_change(l, &h, changed);
        if (status != NS_OK || !(changed = ns_ladder_switch_by_state(l, l->z, l->point->flip)))
            break;
        *hasty |= has_jumped(l, l->order.past);
    }
    return status == NS_OK && changed && ns_ladder_event_contradicts(l) ? NS_E_LIMIT : status;
}

int ns_ladder_event_resolve(ns_ladder *l) {
    const int commands = any(l->point->flip, l->s->nc), changed = l->point->input_jumps || commands;
    int hasty;
    if (commands)
        flip_commands_met(l);
    count_event(l);
    l->point->at_event = l->point->input_jumps = 0;
    begin(l);
    int status = change_at_once(l, changed, &hasty);
    if (commands && (hasty || (status != NS_OK && status != NS_E_MEMORY))) {
        l->contradiction = -1;
        status = settle_in_order(l);
        if (status != NS_OK && status != NS_E_MEMORY) {
            go_back(l);
            status = change_at_once(l, changed, &hasty);
        }
    }
    memset(l->point->flip, 0, (size_t)l->s->nc);
    if (status == NS_OK)
        (void)ns_ladder_short_rates(l);
    return status;
}
