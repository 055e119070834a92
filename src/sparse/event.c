/* src/sparse/event.c - one event: the mode after it, and the charges and fluxes that jump.
 *
 * An Euler step of negligible length from the charges and fluxes before it decides the mode: pairs whose
 * guards it breaks change, until it breaks none.  The end of that step is not used, unless charges or fluxes
 * jump (project.c).
 */
#include "event.h"
#include "events/ties.h"
#include "guards.h"
#include "largest.h"
#include "step.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Rounds of changing all broken pairs at once: so many in which their number does not fall, so many at most.
 */
enum { EXTRA_ROUNDS = 6, MOST_ROUNDS = 100 };
/* Local problems for one step; jumps of one event; rounds of commands. */
enum { LOCALS = 2, JUMPS = 8, COMMAND_ROUNDS = 64 };
/* A step so many powers of two shorter does not move w but to where it has to be. */
enum { SHORTER = 24 };
/* A bound broken by this fraction of its terms is far beyond rounding. */
static const double far = 1e-6;
/* The scale of a small w_i, in the largest. */
static const double least_scale = 1e-3;

/* 1 if (P2) is singular only because steps are so short: beside the terms of capacitors no digit is left of
 * those of an inductor.  Leaks then decide what the inductor has to. */
static int are_digits_lost(ns_sparse *m, double g) {
    const ns_cached_factors *k;
    return m->longest_g > g && ns_sparse_factors_factor(m->q, g, m->mode, 1, &k) == NS_OK && k->has_leaks &&
           ns_sparse_factors_factor(m->q, m->longest_g, m->mode, 1, &k) == NS_OK && !k->has_leaks;
}

/* Changes the pairs whose guards are broken until none is: all at once; one_by_one: where their number does
 * not fall the first one alone, which ends (Judice and Pires, Computers & Operations Research 21, 1994).
 * Errors: SINGULAR, LIMIT (it does not end), RESIDUAL (digits are lost). */
static int change_broken(ns_sparse *m, double t, double g, const double *w, int one_by_one, double *v,
                         double *by) {
    int best = m->f->m + 1, extra = EXTRA_ROUNDS;
    for (int round = 0; round < MOST_ROUNDS && (extra > 0 || one_by_one); round++) {
        const int status = ns_sparse_step_euler(m, t, g, w, 1, v, by);
        if (status != NS_OK && status != NS_E_SINGULAR)
            return status;
        if (are_digits_lost(m, g))
            return NS_E_RESIDUAL;
        const int broken = ns_sparse_guard_broken(m, v, w, g, 1);
        if (broken == 0)
            return status;
        m->counts.pivots += ns_sparse_guard_flip(m, extra > 0 ? broken : 1);
        if (broken >= best)
            extra--;
        else if (extra <= 0)
            extra = 1;
        best = broken < best ? broken : best;
    }
    return NS_E_LIMIT;
}

/* 1 if a bound is broken by far more than rounding: (P1) was formed in a mode whose leaks fix the voltage of
 * a floating part otherwise than those of the mode it found. */
static int floats_otherwise(ns_sparse *m, const double *v, const double *w, double g) {
    int any = 0;
    if (ns_sparse_guard_broken(m, v, w, g, 1) == 0)
        return 0;
    for (int j = 0; j < m->f->m; j++)
        any |= m->flip[j] && m->mode[j] != NS_INSIDE && !ns_mode_slides(m->mode[j]) &&
               fabs(ns_sparse_form_y(m->f, j, v, m->z, 1)) >
                   far * (ns_linalg_csc_size(&m->f->Ct, j, v) + fabs(m->f->e[j]));
    return any;
}

/* The same from `from`, one by one where need be; if that does not end, the mode is that of (P1) again. */
static int change_one_by_one(ns_sparse *m, double t, double g, const double *w, const ns_mode *from,
                             double *v, double *by) {
    memcpy(m->work.lcp_mode, m->mode, (size_t)m->f->m);
    ns_sparse_guard_set_mode(m, from);
    if (change_broken(m, t, g, w, 1, v, by) == NS_OK)
        return NS_OK;
    ns_sparse_guard_set_mode(m, m->work.lcp_mode);
    return ns_sparse_step_euler(m, t, g, w, 1, v, by);
}

/* By guards, else by (P1), which may be formed where leaks of 1e9 V leave no digit of what decides. */
static int find_mode(ns_sparse *m, double t, double g, const double *w, double *v, double *by) {
    int status;
    memset(m->touched, 0, (size_t)m->f->m);
    for (int again = 0; again <= LOCALS; again++) {
        status = change_broken(m, t, g, w, 0, v, by);
        if (status != NS_E_SINGULAR && status != NS_E_LIMIT)
            return status;
        status = ns_sparse_local_lcp(m, t, g, w, v, by);
        if (status != NS_OK || !floats_otherwise(m, v, w, g))
            return status;
    }
    return change_one_by_one(m, t, g, w, m->work.tried_mode, v, by);
}

int ns_sparse_event_consistent(ns_sparse *m, double t, double g, const double *w, double *v, double *by) {
    memcpy(m->work.tried_mode, m->mode, (size_t)m->f->m);
    return find_mode(m, t, g, w, v, by);
}

/* Commands of time change that do so now, or, at a start, have to; events that only rounding keeps apart are
 * one. */
void ns_sparse_event_time_commands(ns_sparse *m, double t) {
    double sum = 0;
    ns_inputs_stages_find_command(m->in, t, m->o.h, m->mode);
    (void)ns_inputs_stages_flip_commands(m->in, t + ns_system_signal_time_error(t, t), m->mode, &sum);
}

/* 1 if by (n) moves w no farther than events are located to. */
static int is_within_location(const ns_sparse *m, const double *by) {
    const double size = ns_sparse_largest_size(m);
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i] &&
            !(fabs(by[i]) <= NS_LOCATION_ERROR * m->o.reltol *
                                 fmax(fmax(fabs(m->w[i]), m->largest.w[i]), least_scale * size * m->unit[i])))
            return 0;
    return 1;
}

int ns_sparse_event_to_thresholds(ns_sparse *m, double t, double g, double *by) {
    int any = 0, status = NS_OK;
    for (int c = 0; c < m->s->nc; c++) {
        any |= m->changed[c] == 2;
        m->changed[c] = m->changed[c] != 0;
    }
    if (any)
        status = ns_sparse_step_euler(m, t, ldexp(g, -SHORTER), m->w, 1, m->work.projected, by);
    if (any && status == NS_OK && !is_within_location(m, by)) {
        ns_sparse_guard_set_mode(m, m->work.mode);
        (void)ns_sparse_guard_commands(m, m->v, NULL, NULL);
        return NS_OK;
    }
    for (int i = 0; i < m->f->n && any && status == NS_OK; i++)
        m->w[i] += by[i];
    return status;
}

int ns_sparse_event_change_commands(ns_sparse *m, const ns_dense_step *step) {
    memcpy(m->work.mode, m->mode, (size_t)m->f->m);
    return ns_sparse_guard_commands(m, m->v, step, m->changed);
}

int ns_sparse_event_consistent_all(ns_sparse *m, double t, double g, const ns_dense_step *step, double *by) {
    for (int round = 0;; round++) {
        int status = ns_sparse_event_consistent(m, t, g, m->w, m->v, by);
        if (status != NS_OK || round >= COMMAND_ROUNDS || !ns_sparse_event_change_commands(m, step))
            return status;
        status = ns_sparse_event_to_thresholds(m, t, g, by);
        if (status != NS_OK)
            return status;
    }
}

int ns_sparse_event_at(const ns_sparse *m, double t) {
    if (m->in->first <= t)
        return 1;
    for (int k = 0; k < m->s->nz; k++)
        if (ns_signal_value(&m->s->z[k], t, NS_LEFT) != ns_signal_value(&m->s->z[k], t, NS_RIGHT))
            return 1;
    return 0;
}

/* Commands that change with the event at the end of the step (ties.h).  One without hysteresis whose control
 * is another than that of the event may go back, and does not slide then. */
static void change_met_commands(ns_sparse *m, const ns_dense_step *step) {
    for (int c = 0; c < m->s->nc; c++) {
        const ns_command *k = &m->s->command[c];
        const ns_tie tie = ns_events_tie(k, m->mode[k->pair]);
        if (c == step->command || k->pair == step->pair || tie == NS_TIE_NONE)
            continue;
        const int same = tie == NS_TIE_SAME && ns_sparse_location_is_same(m, step, c, &m->apart[c]);
        if (!same && !ns_sparse_location_meets(m, step, c, &m->apart[c]))
            continue;
        ns_sparse_guard_toggle(m, k->pair);
        m->changed[c] = same || tie == NS_TIE_MET;
    }
}

void ns_sparse_event_own_changes(ns_sparse *m, const ns_dense_step *step, double t) {
    ns_inputs_stages_at(m->in, t);
    ns_inputs_stages_late(m->in, step ? ns_sparse_step_time_lost(step) : 0);
    m->contradicting_pair = -1;
    memset(m->changed, 0, (size_t)m->s->nc);
    memset(m->apart, 0, sizeof *m->apart * (size_t)m->s->nc);
    if (step)
        change_met_commands(m, step);
    if (step && step->pair >= 0)
        ns_sparse_guard_leave(m, step->pair, step->guard);
    if (step && step->command >= 0) {
        ns_sparse_guard_toggle(m, m->s->command[step->command].pair);
        m->changed[step->command] = 1;
    }
    ns_sparse_event_time_commands(m, t);
    ns_sparse_guard_bounds(m);
    memcpy(m->commanded_mode, m->mode, (size_t)m->f->m);
}

/* A jump that m->mode has in steps of length g, and that its pairs cannot carry: that mode follows later, and
 * other ones come before it within that time.  Where digits suffice for shorter steps nothing jumped. */
static int refuse_jump(ns_sparse *m, double t, double g, ns_jump_kind *jump) {
    int pair, broken;
    const int status = ns_sparse_instant_misfit(m, t, g, &pair, &broken);
    if (status != NS_OK || pair < 0)
        return status;
    if (g <= ns_sparse_finest(m))
        return NS_E_LIMIT;
    memcpy(m->w, m->work.before_w, sizeof *m->w * (size_t)m->f->n);
    *jump = NS_LASTS;
    return NS_OK;
}

int ns_sparse_event_find(ns_sparse *m, double t, double g, ns_jump_kind *jump) {
    double *by = m->work.move;
    int status = NS_OK;
    *jump = NS_JUMPS;
    for (int round = 0; round < JUMPS && status == NS_OK && *jump == NS_JUMPS; round++) {
        status = ns_sparse_event_consistent(m, t, g, m->w, m->v, by);
        if (status == NS_OK)
            status = ns_sparse_project_consistent(m, t, g, by, jump);
        if (status == NS_OK && *jump == NS_JUMPS)
            status = refuse_jump(m, t, g, jump);
        if (status == NS_OK && *jump == NS_JUMPS) {
            m->counts.jumps++;
            status = ns_sparse_instant_add(m, g, &m->instant);
        }
    }
    return status;
}

void ns_sparse_event_save(ns_sparse *m) {
    memcpy(m->before_event.w, m->w, sizeof(double) * (size_t)m->f->n);
    memcpy(m->before_event.mode, m->mode, (size_t)m->f->m);
    memcpy(m->before_event.changed, m->changed, (size_t)m->s->nc);
    ns_sparse_instant_save(m);
}

void ns_sparse_event_restore(ns_sparse *m) {
    memcpy(m->w, m->before_event.w, sizeof(double) * (size_t)m->f->n);
    memcpy(m->changed, m->before_event.changed, (size_t)m->s->nc);
    ns_sparse_instant_restore(m);
    ns_sparse_guard_set_mode(m, m->before_event.mode);
}
