/* src/exact/command_order.c - the mode after an event, when commands have changed: all at once, or, where
 * that is hasty, in order.
 *
 * In order: switches that follow from one another in one instant, as a gate does that is
 * the inverse of another one: those change first whose change makes nothing jump, and what follows from that;
 * those that would make something jump wait, and change together.  So two switches of a leg are never both
 * closed between two states of their gates, and no capacitor is emptied through them.
 */
#include "events/ties.h"
#include "guards.h"
#include "mode_selection.h"

#include <string.h>

static size_t bytes_of_X(const ns_exact *f) {
    return sizeof(double) * ((size_t)f->s->r + (size_t)f->inputs->nv);
}

/* The event as it begins is kept. */
static void begin(ns_exact *f) {
    const size_t nc = (size_t)f->system->nc;
    const ns_instant *jumped = f->point->instant;
    f->jumped = 0;
    memcpy(f->X_before, f->X, bytes_of_X(f));
    memcpy(f->order.first, f->point->flip, nc);
    memcpy(f->order.first_target, f->command_target, nc);
    memcpy(f->order.first_flips, f->flips, nc);
    f->order.any = jumped && jumped->any;
    if (f->order.any)
        memcpy(f->order.instant, jumped->sum, sizeof(double) * (size_t)jumped->size);
}

/* What jumped in this event did not. */
static void forget_jumps(ns_exact *f) {
    ns_instant *jumped = f->point->instant;
    f->jumped = 0;
    if (!jumped)
        return;
    ns_instant_clear(jumped);
    if (f->order.any)
        ns_instant_add(jumped, 0, jumped->size, 1, f->order.instant);
}

/* It is as it was kept, in that mode. */
static void go_back(ns_exact *f, ns_exact_mode *before) {
    const size_t nc = (size_t)f->system->nc;
    memcpy(f->X, f->X_before, bytes_of_X(f));
    f->state.mode = before;
    memcpy(f->point->flip, f->order.first, nc);
    memcpy(f->command_target, f->order.first_target, nc);
    memcpy(f->flips, f->order.first_flips, nc);
    forget_jumps(f);
}

/* 1 if X is another one than before the last command. */
static int has_jumped(const ns_exact *f) {
    double most = 0, largest = 0;
    for (int i = 0; i < f->s->r; i++) {
        most = fmax(most, fabs(f->X[i] - f->order.X[i]) / f->s->unit[i]);
        largest = fmax(largest, f->max_abs[i] / f->s->unit[i]);
    }
    return !(most <= ns_events_jump_waits * largest);
}

/* Command c changes alone: 1; 0: not without a jump. */
static int change_alone(ns_exact *f, int c) {
    ns_exact_mode *const mode = f->state.mode;
    int goes_on;
    memcpy(f->order.X, f->X, bytes_of_X(f));
    ns_exact_flips_clear(f);
    f->point->flip[c] = 1;
    f->command_target[c] = f->order.target[c];
    if (ns_exact_mode_after(f, 0, -1, &goes_on) == NS_OK && !goes_on && !has_jumped(f)) {
        f->order.due[c] = 0;
        return f->order.changed[c] = 1;
    }
    memcpy(f->X, f->order.X, bytes_of_X(f));
    f->state.mode = mode;
    forget_jumps(f);
    return 0;
}

/* Those that the state contradicts are due, too; 0: one of them has changed here. */
static int add_contradicted(ns_exact *f) {
    const ns_mode_kernel *k = f->state.mode->scale[0].kernel;
    for (int g = k->pair_rows; g < k->rows; g++) {
        const int c = k->row[g].command;
        if (f->order.due[c] || ns_exact_guard_sign(f, f->state.mode, g, f->X) != NS_SIGN_BREAKS)
            continue;
        if (f->order.changed[c])
            return 0;
        f->order.due[c] = 1;
        f->order.target[c] = NS_TARGET_TOGGLE;
    }
    return 1;
}

/* One after another, those alone that make nothing jump; how many: -1: one would change twice. */
static int change_in_order(ns_exact *f) {
    int count = 0, more = 1;
    while (more) {
        more = 0;
        for (int c = 0; c < f->system->nc && !more; c++)
            more = f->order.due[c] && change_alone(f, c);
        if (more && !add_contradicted(f))
            return -1;
        count += more;
    }
    return count;
}

/* Those that are left, together. */
static int change_rest(ns_exact *f) {
    enum { MAX_JUMPS = 4 };
    const size_t nc = (size_t)f->system->nc;
    int goes_on = memchr(f->order.due, 1, nc) != NULL;
    memcpy(f->point->flip, f->order.due, nc);
    memcpy(f->command_target, f->order.target, nc);
    for (int round = 0; round < MAX_JUMPS && goes_on; round++) {
        const int status = ns_exact_mode_after(f, round > 0, -1, &goes_on);
        if (status != NS_OK)
            return status;
        ns_exact_flips_clear(f);
    }
    return goes_on || ns_exact_flip_contradicted(f) ? NS_GUARD : NS_OK;
}

/* From there.  Errors: GUARD: there is no such order, or what follows in it contradicts itself. */
static int settle_in_order(ns_exact *f, ns_exact_mode *before) {
    const size_t nc = (size_t)f->system->nc;
    go_back(f, before);
    memcpy(f->order.due, f->order.first, nc);
    memcpy(f->order.target, f->order.first_target, nc);
    memset(f->order.changed, 0, nc);
    return change_in_order(f) > 0 ? change_rest(f) : NS_GUARD;
}

/* Modes one after another, until no jump and no command leads on.  *hasty: 1: a command changes after
 * something jumped, which might not have jumped had that changed before. */
static int settle_modes(ns_exact *f, int by_guard, int *hasty) {
    enum { MAX_JUMPS = 4 };
    int goes_on = 0;
    *hasty = 0;
    for (int round = 0; round <= 2 * f->system->nc + MAX_JUMPS; round++) {
        const int broken = round == 0 && by_guard ? f->event_guard : -1;
        const int status = ns_exact_mode_after(f, by_guard || goes_on, broken, &goes_on);
        if (status != NS_OK)
            return status;
        if (goes_on)
            ns_exact_flips_clear(f);
        else if (!ns_exact_flip_contradicted(f))
            return NS_OK;
        else
            *hasty |= f->jumped;
        by_guard = 0;
    }
    return NS_GUARD; /* the ladder has those that never settle */
}

/* The same; where commands change in haste, or no mode follows, they are put in order, if that can be. */
static int settle(ns_exact *f, int by_guard, ns_exact_mode *before) {
    const int commands = memchr(f->point->flip, 1, (size_t)f->system->nc) != NULL;
    int hasty;
    begin(f);
    int status = settle_modes(f, by_guard, &hasty);
    if (!commands || !(hasty || status == NS_GUARD) || f->timed)
        return status;
    status = settle_in_order(f, before);
    if (status != NS_GUARD)
        return status;
    go_back(f, before);
    return settle_modes(f, by_guard, &hasty);
}

int ns_exact_select_mode(ns_exact *f, int guard) {
    ns_exact_mode *const before = f->state.mode;
    f->resolves = 0;
    ns_exact_note_size(f);
    ns_exact_enter_remove_drift(f);
    ns_exact_event_is_of(f, guard);
    ns_exact_event_known_to(f, ns_exact_event_time_error(f));
    for (int c = 0; c < f->system->nc; c++)
        f->command_target[c] = NS_TARGET_TOGGLE;
    memset(f->flips, 0, (size_t)f->system->nc);
    int by_command = f->event_guard >= 0 && ns_exact_flip_of_guard(f);
    if (guard != NS_GUARD_UNKNOWN)
        by_command |= ns_exact_flip_met(f) > 0;
    int status = settle(f, guard != NS_GUARD_NONE && !by_command, before);
    ns_exact_flips_clear(f);
    if (f->failed != NS_OK)
        status = f->failed;
    if (status != NS_OK) {
        go_back(f, before);
        ns_exact_flips_clear(f);
    } else if (f->overruled) {
        ns_exact_event_quiet(f);
    }
    return status;
}
