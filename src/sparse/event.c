/* src/sparse/event.c - one event: the new mode, and what jumps.
 *
 * A step of negligible length from the charges and fluxes there are tells which mode holds: pairs whose
 * guards it breaks change.  No time passes in it and its end is thrown away, unless charges or fluxes jump:
 * then they are those after a step that is shorter still.
 */
#include "sparse_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Rounds in which all broken pairs change at once, without getting fewer; at most. */
enum { BLOCK_ROUNDS = 6, MOST_ROUNDS = 100, SHORTER = 24, JUMPS = 8, COMMAND_ROUNDS = 64, LOCALS = 2 };
/* Of the terms of a bound: far above rounding. */
static const double far = 1e-6;
/* What w may be off by at an event, of the error of a step; where there is next to none, of the largest. */
static const double beside = 16, least_share = 1e-3;

/* Changes what is broken until nothing is, or it leads nowhere: SINGULAR or LIMIT. */
static int change_broken(ns_sparse *m, double t, double g, const double *w, double *v, double *by) {
    int best = m->f->m + 1, patience = BLOCK_ROUNDS;
    for (int round = 0; round < MOST_ROUNDS && patience > 0; round++) {
        const int status = ns_sparse_euler(m, t, g, w, 1, v, by);
        if (status != NS_OK && status != NS_E_SINGULAR)
            return status;
        const int flipped = ns_sparse_guard_flip(m, v, w, g, 1);
        m->counts.pivots += flipped;
        if (flipped == 0)
            return status;
        if (flipped >= best)
            patience--;
        else
            best = flipped;
    }
    return NS_E_LIMIT;
}

/* A bound is broken by a good part of the terms it is summed from: no rounding, but a part that floats was
 * elsewhere by the leaks of the mode in which (P1) was formed. */
static int floats_elsewhere(ns_sparse *m, const double *v, const double *w, double g) {
    int any = 0;
    if (ns_sparse_guard_broken(m, v, w, g, 1) == 0)
        return 0;
    for (int j = 0; j < m->f->m; j++)
        any |= m->flip[j] && m->mode[j] != NS_INSIDE && !ns_mode_slides(m->mode[j]) &&
               fabs(ns_sparse_form_y(m->f, j, v, m->z, 1)) >
                   far * (ns_linalg_csc_size(&m->f->Ct, j, v) + fabs(m->f->e[j]));
    return any;
}

int ns_sparse_event_consistent(ns_sparse *m, double t, double g, const double *w, double *v, double *by) {
    int status;
    memset(m->touched, 0, (size_t)m->f->m);
    for (int again = 0;; again++) {
        status = change_broken(m, t, g, w, v, by);
        if (status != NS_E_SINGULAR && status != NS_E_LIMIT)
            return status;
        status = ns_sparse_event_local(m, t, g, w, v, by);
        if (status != NS_OK || again >= LOCALS || !floats_elsewhere(m, v, w, g))
            return status;
    }
}

/* Commands of time change that do so now, or, at a start, have to; events that only rounding keeps apart are
 * one. */
void ns_sparse_event_command(ns_sparse *m, double t) {
    double sum = 0;
    ns_inputs_stages_find_command(m->in, t, m->o.h, m->mode);
    (void)ns_inputs_stages_flip_commands(m->in, t + ns_system_signal_slack(t, t), m->mode, &sum);
}

/* By how much by (n) moves w is no more than what events are located to. */
static int is_beside(const ns_sparse *m, const double *by) {
    const double size = ns_sparse_project_size(m);
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i] &&
            !(fabs(by[i]) <=
              beside * m->o.reltol * fmax(fmax(fabs(m->w[i]), m->scale[i]), least_share * size * m->unit[i])))
            return 0;
    return 1;
}

/* What begins to slide does so on its threshold: w, which is beside it by the error of a step, goes there.
 * From farther off nothing gets there in no time: it changes, as its control wants it to. */
static int reach_thresholds(ns_sparse *m, double t, double g, double *by) {
    int any = 0, status = NS_OK;
    for (int c = 0; c < m->s->nc; c++) {
        any |= m->changed[c] == 2;
        m->changed[c] = m->changed[c] != 0;
    }
    if (any)
        status = ns_sparse_euler(m, t, ldexp(g, -SHORTER), m->w, 1, m->fine_v, by);
    if (any && status == NS_OK && !is_beside(m, by)) {
        memcpy(m->mode, m->old_mode, (size_t)m->f->m);
        (void)ns_sparse_guard_commands(m, m->v, NULL, NULL);
        return NS_OK;
    }
    for (int i = 0; i < m->f->n && any && status == NS_OK; i++)
        m->w[i] += by[i];
    return status;
}

/* Commands that m->v contradicts change, or slide; how many. */
static int settle_commands(ns_sparse *m, const ns_dense_step *leg) {
    memcpy(m->old_mode, m->mode, (size_t)m->f->m);
    return ns_sparse_guard_commands(m, m->v, leg, m->changed);
}

/* Settled, and commands of the state settled with it. */
int ns_sparse_event_consistent_all(ns_sparse *m, double t, double g, const ns_dense_step *leg, double *by) {
    for (int round = 0;; round++) {
        int status = ns_sparse_event_consistent(m, t, g, m->w, m->v, by);
        if (status != NS_OK || round >= COMMAND_ROUNDS || !settle_commands(m, leg))
            return status;
        status = reach_thresholds(m, t, g, by);
        if (status != NS_OK)
            return status;
    }
}

int ns_sparse_event_count(ns_sparse *m, const ns_dense_step *leg, double t) {
    int status = NS_OK;
    for (int j = 0; j < m->f->m; j++) {
        if (m->mode[j] == leg->mode[j])
            continue;
        const double h = ldexp(m->o.h, -leg->next_rung);
        if (!(t - m->crowd_t[j] <= h)) {
            m->crowd_t[j] = t;
            m->crowd[j] = 0;
        }
        m->crowd_moved = 1;
        if (++m->crowd[j] > NS_CROWD_OF_PAIR)
            status = NS_E_LIMIT;
    }
    return status;
}

void ns_sparse_event_crowd(ns_sparse *m, int keep) {
    const size_t pairs = (size_t)m->f->m;
    int *const kept = m->crowd + pairs;
    double *const kept_t = m->crowd_t + pairs;
    if (!m->crowd_moved)
        return;
    memcpy(keep ? kept : m->crowd, keep ? m->crowd : kept, sizeof(int) * pairs);
    memcpy(keep ? kept_t : m->crowd_t, keep ? m->crowd_t : kept_t, sizeof(double) * pairs);
    *(keep ? &m->kept_euler_t : &m->euler_t) = keep ? m->euler_t : m->kept_euler_t;
    *(keep ? &m->kept_eulers : &m->eulers) = keep ? m->eulers : m->kept_eulers;
    m->crowd_moved = 0;
}

int ns_sparse_event_at(const ns_sparse *m, double t) {
    if (m->in->first <= t)
        return 1;
    for (int k = 0; k < m->s->nz; k++)
        if (m->in->wave[k].until == t &&
            ns_signal_value(&m->s->z[k], t, NS_LEFT) != ns_signal_value(&m->s->z[k], t, NS_RIGHT))
            return 1;
    return 0;
}

void ns_sparse_event_own(ns_sparse *m, const ns_dense_step *leg, double t) {
    ns_inputs_stages_at(m->in, t);
    m->contradicted = -1;
    memset(m->changed, 0, (size_t)m->s->nc);
    if (leg && leg->pair >= 0)
        ns_sparse_guard_set(m, leg->pair, leg->upper);
    if (leg && leg->command >= 0) {
        ns_sparse_guard_set(m, m->s->command[leg->command].pair, 0);
        m->changed[leg->command] = 1;
    }
    ns_sparse_event_command(m, t);
    ns_sparse_guard_bounds(m);
    memcpy(m->own_mode, m->mode, (size_t)m->f->m);
}

/* Where the last event left what breaks at once, hidden by rounding: the mode that a longer step finds, to
 * begin with. */
static void look_ahead(ns_sparse *m, double t, double g, double *by) {
    memcpy(m->old_mode, m->mode, (size_t)m->f->m);
    if (ns_sparse_event_consistent(m, t, g, m->w, m->v, by) != NS_OK)
        memcpy(m->mode, m->old_mode, (size_t)m->f->m);
}

/* Pairs, and what jumps with them, settled by steps of length g; commands stay. */
static int settle_and_jump(ns_sparse *m, double t, double g, ns_jump_kind *jump) {
    double *by = m->scale + 2 * m->f->n;
    int status = NS_OK;
    *jump = NS_JUMPS;
    for (int round = 0; round < JUMPS && status == NS_OK && *jump == NS_JUMPS; round++) {
        status = ns_sparse_event_consistent(m, t, g, m->w, m->v, by);
        if (status == NS_OK)
            status = ns_sparse_project_consistent(m, t, g, by, jump);
        m->counts.jumps += status == NS_OK && *jump == NS_JUMPS;
    }
    return status;
}

/* Whether a switch with a hysteresis changed once more, after all these rounds: it can be neither open nor
 * closed here, and nothing between. */
static int contradicts(ns_sparse *m) {
    for (int c = 0; c < m->s->nc; c++) {
        const ns_command *k = &m->s->command[c];
        if (m->mode[k->pair] != m->old_mode[k->pair] && k->on > k->off)
            m->contradicted = k->pair;
    }
    return m->contradicted >= 0;
}

/* m->mode and m->w to the right of an event by steps of length g.  Commands look at what is there when all
 * has jumped, not at impulses; at a start what was given jumps anew for those that change. */
static int resolve_by(ns_sparse *m, const ns_dense_step *leg, double t, double g, ns_jump_kind *jump) {
    for (int round = 0;; round++) {
        int status = settle_and_jump(m, t, g, jump);
        (void)ns_inputs_stages_stage(m->in, t, g, 0, m->z); /* as m->v has them */
        if (status != NS_OK || *jump == NS_LASTS || !settle_commands(m, leg))
            return status;
        if (round >= COMMAND_ROUNDS)
            return contradicts(m) ? NS_E_LIMIT : status;
        if (!leg)
            memcpy(m->w, m->event_w, sizeof(double) * (size_t)m->f->n);
        status = reach_thresholds(m, t, g, m->scale + 2 * m->f->n);
        if (status != NS_OK)
            return status;
    }
}

/* What an attempt begins with. */
static void keep(ns_sparse *m) {
    memcpy(m->event_w, m->w, sizeof(double) * (size_t)m->f->n);
    memcpy(m->event_mode, m->mode, (size_t)m->f->m);
    memcpy(m->event_changed, m->changed, (size_t)m->s->nc);
}

static void begin_again(ns_sparse *m) {
    memcpy(m->w, m->event_w, sizeof(double) * (size_t)m->f->n);
    memcpy(m->mode, m->event_mode, (size_t)m->f->m);
    memcpy(m->changed, m->event_changed, (size_t)m->s->nc);
    ns_sparse_guard_bounds(m);
}

int ns_sparse_resolve(ns_sparse *m, const ns_dense_step *leg, double t) {
    const int stuck = leg ? leg->stuck : 0;
    const double least = ldexp(m->o.h, -NS_EVENT_LEAST - m->o.finer);
    double g = fmax(ldexp(m->o.h, -NS_SHORT_RUNG - (leg ? leg->next_rung : 0) - stuck), least);
    ns_jump_kind jump;
    m->counts.problems++;
    if (stuck == 1 || stuck == 2)
        look_ahead(m, t, ldexp(g, 5 * stuck), m->scale + 2 * m->f->n);
    keep(m);
    int status = resolve_by(m, leg, t, g, &jump);
    while (status == NS_OK && jump == NS_LASTS) {
        g = fmax(ldexp(g, -NS_FINER), ns_sparse_finest(m));
        begin_again(m);
        status = resolve_by(m, leg, t, g, &jump);
    }
    m->counts.events++;
    return status;
}
