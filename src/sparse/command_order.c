/* src/sparse/command_order.c - the right side of an event: commands change at once, or, where that is hasty,
 * in order.
 *
 * In order: switches that follow from one another in one instant, as a gate does that is the inverse of
 * another one: see exact/command_order.c.
 */
#include "event.h"
#include "events/ties.h"
#include "guards.h"
#include "largest.h"
#include "step.h"

#include <string.h>

/* Rounds of commands. */
enum { COMMAND_ROUNDS = 64 };
enum { DUE = 1, CHANGED = 2 }; /* a command, in m->due */

/* The mode where the event began, but with the switches of commands that the event changed as in `step`:
 * these are due.  How many. */
static int undo_commands(ns_sparse *m, const ns_dense_step *step) {
    int count = 0;
    ns_sparse_event_restore(m);
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair;
        m->due[c] = m->mode[j] != step->mode[j] ? DUE : 0;
        count += m->due[c] == DUE;
        m->work.wanted[j] = m->mode[j]; /* that it changes to */
        m->mode[j] = step->mode[j];
    }
    ns_sparse_guard_bounds(m);
    return count;
}

/* 1 if w is another one than before the event. */
static int has_jumped(ns_sparse *m) {
    for (int i = 0; i < m->f->n; i++)
        m->work.move[i] = m->w[i] - m->before_event.w[i];
    return !(ns_sparse_largest_of(m, m->work.move) <= ns_events_jump_waits * ns_sparse_largest_size(m));
}

/* m->mode and m->w as they are with command c changed alone: 1; 0: not without a jump. */
static int change_alone(ns_sparse *m, double t, double g, int c) {
    const int j = m->s->command[c].pair;
    const long jumps = m->counts.jumps;
    ns_jump_kind jump;
    memcpy(m->work.lone_mode, m->mode, (size_t)m->f->m);
    m->mode[j] = m->work.wanted[j];
    ns_sparse_guard_bounds(m);
    if (ns_sparse_event_find(m, t, g, &jump) == NS_OK && jump == NS_NO_JUMP && !has_jumped(m)) {
        m->due[c] = CHANGED;
        return 1;
    }
    m->counts.jumps = jumps;
    memcpy(m->w, m->before_event.w, sizeof *m->w * (size_t)m->f->n);
    ns_sparse_instant_restore(m);
    ns_sparse_guard_set_mode(m, m->work.lone_mode);
    return 0;
}

/* Those that m->v contradicts are due, too; 0: one of them has changed here. */
static int add_contradicted(ns_sparse *m) {
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair;
        if (m->due[c] == DUE || !ns_sparse_guard_contradicts(m, c, m->v))
            continue;
        if (m->due[c] == CHANGED)
            return 0;
        m->due[c] = DUE;
        m->work.wanted[j] = ns_mode_toggled(m->mode[j]);
    }
    return 1;
}

/* One after another, those alone that make nothing jump; how many; -1: one would change twice. */
static int change_in_order(ns_sparse *m, double t, double g) {
    int count = 0, more = 1;
    while (more) {
        more = 0;
        for (int c = 0; c < m->s->nc && !more; c++)
            more = m->due[c] == DUE && change_alone(m, t, g, c);
        (void)ns_inputs_stages_stage(m->in, t, g, 0, m->z); /* as m->v has them */
        if (more && !add_contradicted(m))
            return -1;
        count += more;
    }
    return count;
}

/* From where the event began to its right side by steps of length g.  Errors: LIMIT: there is no such order,
 * or what follows in it contradicts itself; those of a search for a mode. */
static int resolve_in_order(ns_sparse *m, const ns_dense_step *step, double t, double g, ns_jump_kind *jump) {
    if (undo_commands(m, step) == 0 || change_in_order(m, t, g) <= 0)
        return NS_E_LIMIT;
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair;
        m->mode[j] = m->due[c] == DUE ? m->work.wanted[j] : m->mode[j];
        m->changed[c] |= m->due[c] != 0;
        m->due[c] = m->due[c] ? CHANGED : 0;
    }
    ns_sparse_guard_bounds(m);
    const int status = ns_sparse_event_find(m, t, g, jump);
    (void)ns_inputs_stages_stage(m->in, t, g, 0, m->z);
    for (int c = 0; c < m->s->nc && status == NS_OK; c++)
        if (ns_sparse_guard_contradicts(m, c, m->v))
            return NS_E_LIMIT;
    return status;
}

/* Where the step after the last event ended at once, what broke it was hidden by rounding, or by what is left
 * of a transient that no step resolves: the search begins with the mode that a longer step finds, and guards
 * that this mode breaks by no more than events are located to hold. */
static void begin_with_longer_step(ns_sparse *m, double t, double g, double *by) {
    memcpy(m->work.mode, m->mode, (size_t)m->f->m);
    if (ns_sparse_event_consistent(m, t, g, m->w, m->v, by) != NS_OK)
        ns_sparse_guard_set_mode(m, m->work.mode);
}

/* 1 if a switch with a hysteresis changed in the last of so many rounds: it can be neither open nor closed
 * here, and it cannot slide. */
static int find_contradicting(ns_sparse *m) {
    for (int c = 0; c < m->s->nc; c++) {
        const ns_command *k = &m->s->command[c];
        if (m->mode[k->pair] != m->work.mode[k->pair] && k->on > k->off)
            m->contradicting_pair = k->pair;
    }
    return m->contradicting_pair >= 0;
}

/* m->mode and m->w to the right of an event by steps of length g.  Commands see the state after all jumps,
 * not the impulses; at a start every command that changes begins anew with the w that was given.  *hasty: 1:
 * one changes after something jumped, which might not have jumped had that changed before. */
static int resolve_at_once(ns_sparse *m, const ns_dense_step *step, double t, double g, ns_jump_kind *jump,
                           int *hasty) {
    const long jumps = m->counts.jumps;
    *hasty = 0;
    for (int round = 0;; round++) {
        int status = ns_sparse_event_find(m, t, g, jump);
        (void)ns_inputs_stages_stage(m->in, t, g, 0, m->z); /* as m->v has them */
        if (status != NS_OK || *jump == NS_LASTS || !ns_sparse_event_change_commands(m, step))
            return status;
        *hasty |= m->counts.jumps > jumps;
        if (round >= COMMAND_ROUNDS)
            return find_contradicting(m) ? NS_E_LIMIT : status;
        if (!step) {
            memcpy(m->w, m->before_event.w, sizeof(double) * (size_t)m->f->n);
            ns_sparse_instant_restore(m);
        }
        status = ns_sparse_event_to_thresholds(m, t, g, m->work.move);
        if (status != NS_OK)
            return status;
    }
}

/* The same; where commands change in haste, or no mode is found, they are put in order, if that can be. */
static int resolve_with(ns_sparse *m, const ns_dense_step *step, double t, double g, ns_jump_kind *jump) {
    int hasty;
    const long jumps = m->counts.jumps;
    int status = resolve_at_once(m, step, t, g, jump, &hasty);
    if (!step || m->f->gx.start[m->f->nc] == 0 || !(hasty || (status != NS_OK && status != NS_E_MEMORY)))
        return status;
    const int refused = status, pair = m->contradicting_pair;
    const ns_fault fault = m->fault;
    status = resolve_in_order(m, step, t, g, jump);
    if (status == NS_OK) {
        m->contradicting_pair = -1;
        return status;
    }
    m->counts.jumps = jumps;
    m->contradicting_pair = pair;
    m->fault = fault;
    if (status == NS_E_MEMORY || !hasty)
        return status == NS_E_MEMORY ? status : refused;
    ns_sparse_event_restore(m);
    return resolve_at_once(m, step, t, g, jump, &hasty);
}

/* Steps of length g would lose a transient: shorter ones, until nothing lasts, or the finest.  Where digits
 * do not suffice for these, the mode is that of the longest, nothing jumps, and the steps that follow resolve
 * the transient. */
static void resolve_transient(ns_sparse *m, const ns_dense_step *step, double t, double g) {
    ns_jump_kind jump = NS_LASTS;
    int status = NS_OK;
    memcpy(m->work.lasting_mode, m->mode, (size_t)m->f->m);
    m->longest_g = g;
    while (status == NS_OK && jump == NS_LASTS && g > ns_sparse_finest(m)) {
        g = fmax(ldexp(g, -NS_FINER), ns_sparse_finest(m));
        ns_sparse_event_restore(m);
        status = resolve_with(m, step, t, g, &jump);
    }
    m->longest_g = 0;
    if (status == NS_OK)
        return;
    ns_sparse_event_restore(m);
    ns_sparse_guard_set_mode(m, m->work.lasting_mode);
}

/* The length of the Euler steps that resolve an event: negligible beside steps, and beside the time to the
 * next corner of a source. */
static double negligible(const ns_sparse *m, const ns_dense_step *step, double t) {
    const double least = ldexp(m->o.h, -NS_EVENT_LEAST_EXPONENT - m->o.finer);
    const double g = ldexp(m->o.h, -NS_SHORT_EXPONENT - (step ? step->next_exponent + step->failures : 0));
    return fmax(ns_sparse_step_negligible(g, least, m->in->corner - t), least);
}

int ns_sparse_event_resolve(ns_sparse *m, const ns_dense_step *step, double t) {
    const int failures = step ? step->failures : 0;
    double g = negligible(m, step, t);
    ns_jump_kind jump;
    m->counts.problems++;
    if (failures == 1 || failures == 2)
        begin_with_longer_step(m, t, ldexp(g, 5 * failures), m->work.move);
    ns_sparse_event_save(m);
    m->is_near = failures == 1 || failures == 2;
    int status = resolve_with(m, step, t, g, &jump);
    if (status == NS_OK && jump == NS_LASTS)
        resolve_transient(m, step, t, g);
    m->is_near = 0;
    m->counts.events++;
    return status;
}
