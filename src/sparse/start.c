/* src/sparse/start.c - a consistent start: from charges and fluxes, or from the DC operating point. */
#include "guards.h"
#include "largest.h"

#include <math.h>
#include <string.h>

/* Nothing known; switches as in closed (nc; NULL: as their commands say), other pairs at a bound. */
static void forget_past(ns_sparse *m, const unsigned char *closed) {
    ns_sparse_guard_reset_modes(m, closed);
    ns_sparse_chatter_reset(m);
    ns_sparse_largest_reset(m);
    ns_sparse_predict_reset(m);
    ns_sparse_theta_stop(m);
    ns_inputs_stages_reset(m->in);
    m->fault.npairs = 0;
    m->steep_steps = m->digits_lost = 0;
}

/* From m->w and m->mode, made consistent.  Any charges and fluxes may be far from where they lead: what
 * spreads in the shortest time is resolved. */
static int start_from_state(ns_sparse *m, double t0) {
    ns_sparse_be_finest(m, t0);
    ns_sparse_event_own_changes(m, NULL, t0);
    int status = ns_sparse_event_resolve(m, NULL, t0);
    m->counts.events--; /* a start is none */
    if (status == NS_OK)
        status = ns_sparse_first_step(m);
    if (m->contradicting_pair >= 0) {
        m->fault.npairs = 1;
        m->fault.pair[0] = m->contradicting_pair;
    }
    return status == NS_OK ? NS_OK : ns_sparse_fail(m, t0, status);
}

static int can_start_at(const ns_sparse *m, double t0) {
    return isfinite(t0) && t0 + m->o.h > t0;
}

int ns_sparse_start(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    ns_sparse *m = ns_sparse_of(e);
    if (!w0 && m->output_only->whole->n > 0)
        return NS_E_NULL;
    ns_sparse_rewind(m, t0);
    if (!can_start_at(m, t0))
        return ns_sparse_fail(m, t0, NS_E_NUMBER);
    for (int i = 0; w0 && i < m->output_only->whole->n; i++)
        if (!isfinite(w0[i]))
            return ns_sparse_fail(m, t0, NS_E_NUMBER);
    forget_past(m, closed);
    for (int i = 0; w0 && i < m->f->n; i++)
        m->work.w[i] = w0[m->output_only->stays[i]];
    for (int i = 0; i < m->f->n; i++)
        m->w[i] = m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Tt, i, m->work.w);
    return start_from_state(m, t0);
}

/* The first command that contradicts its control in m->v changes; 0: there is none. */
static int change_first_command(ns_sparse *m) {
    ns_mode *was = m->work.mode;
    int first = -1;
    memcpy(was, m->mode, (size_t)m->f->m);
    memset(m->changed, 0, (size_t)m->s->nc); /* none slides */
    if (!ns_sparse_guard_commands(m, m->v, NULL, m->changed))
        return 0;
    for (int c = 0; c < m->s->nc && first < 0; c++)
        first = m->changed[c] ? m->s->command[c].pair : -1;
    was[first] = m->mode[first];
    ns_sparse_guard_set_mode(m, was);
    ns_sparse_guard_bounds(m);
    return 1;
}

/* With the matrices at rest in place of the engine's own: x and lambda to m->v. */
static int find_mode_at_rest(ns_sparse *m, double t0, ns_form *f, ns_mode_factors *q) {
    ns_form *const own = m->f;
    ns_mode_factors *const factors = m->q;
    m->f = f;
    m->q = q;
    memset(m->w, 0, sizeof(double) * (size_t)f->n);
    memset(m->changed, 0, (size_t)m->s->nc);
    ns_inputs_stages_at(m->in, t0);
    ns_sparse_event_time_commands(m, t0);
    ns_sparse_guard_bounds(m);
    int status = ns_sparse_event_consistent_all(m, t0, 0, NULL, m->work.w);
    /* of two that open each other one opens */
    for (int k = 0; k <= 2 * m->s->nc && status == NS_OK && change_first_command(m); k++)
        status = ns_sparse_event_consistent(m, t0, 0, m->w, m->v, m->work.w);
    m->f = own;
    m->q = factors;
    return status;
}

static int operating_point(ns_sparse *m, double t0, int nhold, const int *hold, const double *hold_x) {
    ns_form *f = NULL;
    ns_mode_factors *q = NULL;
    int status = ns_sparse_form_create(m->s, 1, &f);
    for (int k = 0; k < nhold && status == NS_OK; k++)
        if (m->output_only->place[hold[k]] >= 0)
            f->held[m->output_only->place[hold[k]]] = hold_x[k];
    if (status == NS_OK)
        status = ns_sparse_factors_create(f, m->o.bytes, &q);
    if (status == NS_OK)
        status = find_mode_at_rest(m, t0, f, q);
    ns_sparse_factors_free(q);
    ns_sparse_form_free(f);
    return status;
}

int ns_sparse_start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    ns_sparse *m = ns_sparse_of(e);
    if (nhold > 0 && (!hold || !hold_x))
        return NS_E_NULL;
    ns_sparse_rewind(m, t0);
    if (!can_start_at(m, t0))
        return ns_sparse_fail(m, t0, NS_E_NUMBER);
    if (nhold < 0 || nhold > m->output_only->whole->n)
        return ns_sparse_fail(m, t0, NS_E_SIZE);
    for (int k = 0; k < nhold; k++)
        if (hold[k] < 0 || hold[k] >= m->output_only->whole->n)
            return ns_sparse_fail(m, t0, NS_E_SIZE);
    forget_past(m, NULL);
    const int status = operating_point(m, t0, nhold, hold, hold_x);
    if (status != NS_OK)
        return ns_sparse_fail(m, t0, status);
    for (int i = 0; i < m->f->n; i++)
        m->w[i] = m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Mt, i, m->v);
    ns_system_inputs(m->s, t0, NS_RIGHT, m->z);
    if (x)
        ns_sparse_output_join(m->output_only, m->v, m->z, x);
    for (int k = 0; x && k < nhold; k++)
        x[hold[k]] = hold_x[k];
    return start_from_state(m, t0);
}
