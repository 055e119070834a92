/* src/sparse/theta_step.c - the scheme for large circuits: steps of one length, and nothing is located.
 *
 * With theta = gamma a step of (T8) is one of implicit Euler, of length g = theta h, from w to x_g, and
 *
 *     w+ = w + (M x_g - w)/theta.
 *
 * Inputs, commands and laws are those at t + g: what changes in a step does so there.  Where theta < 1 would
 * let ring what jumps, because a law broke, or a command moves much more than moved before, the step is that
 * of Euler alone, to t + g.  Between its ends w is a straight line; x is asked for by one more solution.
 */
#include "linalg/simd.h"
#include "sparse_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Something may jump where a step moves so many times as much as the one before; it did where the next one
 * would move no more than this share of it. */
static const double leap = 4, dead = 0.5;

int ns_sparse_theta_create(ns_sparse *m) {
    const size_t n = (size_t)m->f->n, size = (size_t)m->f->size, nz = (size_t)m->f->nz;
    ns_sparse_theta *k = &m->scheme;
    if (!(m->o.theta > 0))
        return NS_OK;
    k->g = m->o.theta * m->o.h;
    k->base = calloc(size + 2 * n + 2 * nz + 1, sizeof(double));
    if (!k->base)
        return NS_E_MEMORY;
    k->units = k->base + size;
    k->by = k->units + n;
    k->base_z = k->by + n;
    k->z = k->base_z + nz;
    for (size_t i = 0; i < n; i++)
        k->units[i] = m->f->algebraic[i] || !(m->unit[i] > 0) ? 0 : 1 / m->unit[i];
    k->whole_pass = m->f->gx.start[m->f->nc] == 0;
    return ns_sparse_laws_create(m->f->m, &k->laws);
}

void ns_sparse_theta_free(ns_sparse *m) {
    free(m->scheme.base);
    ns_sparse_laws_free(&m->scheme.laws);
}

/* --- inputs and commands --- */

/* Looks at all of them anew at t; their values there. */
static void meet_corner(ns_sparse *m, double t) {
    ns_sparse_theta *k = &m->scheme;
    ns_inputs_stages_at(m->in, t);
    k->corner = m->in->corner;
    for (int i = 0; i < m->f->nz; i++)
        k->z[i] = ns_signal_value(&m->s->z[i], t, NS_RIGHT);
    k->known = 0;
}

static void take_inputs(ns_sparse *m, double t) {
    ns_sparse_theta *k = &m->scheme;
    if (!(t < k->corner)) {
        meet_corner(m, t);
        return;
    }
    for (int c = 0; c < m->in->ncurved; c++) {
        const int i = m->in->curved[c];
        const ns_exp_sum *w = &m->in->wave[i];
        k->z[i] =
            w->count > 0 ? ns_signal_value(&m->s->z[i], t, NS_LEFT) : w->value + w->slope * (t - w->from);
    }
}

/* Commands of time that change until t do; their mean instant. */
static double take_commands(ns_sparse *m, double t) {
    double sum = 0;
    const int count = ns_inputs_stages_flip_commands(m->in, t, m->mode, &sum);
    if (count > 0)
        ns_sparse_guard_bounds(m);
    ns_inputs_stages_at(m->in, t);
    m->scheme.corner = -INFINITY; /* waves were looked at elsewhere */
    return count > 0 ? sum / count : t;
}

/* --- a step --- */

static void know(ns_sparse *m) {
    ns_sparse_theta *k = &m->scheme;
    if (k->known)
        return;
    ns_sparse_step_rhs(m, k->g, NULL, k->z, 1, 1);
    memcpy(k->base, m->r, sizeof(double) * (size_t)m->f->size);
    memcpy(k->base_z, k->z, sizeof(double) * (size_t)m->f->nz);
    ns_sparse_laws_set(&k->laws, m->f, m->mode, m->l, m->u);
    k->known = 1;
}

/* What inputs that moved since base was made add to it. */
static void add_inputs(const ns_sparse *m, double *r) {
    const ns_form *f = m->f;
    const ns_sparse_theta *k = &m->scheme;
    for (int c = 0; c < m->in->ncurved; c++) {
        const int i = m->in->curved[c];
        const double by = k->z[i] - k->base_z[i];
        for (int p = f->E.start[i]; p < f->E.start[i + 1]; p++)
            r[f->E.row[p]] += ns_sparse_form_rate(f, k->g, f->E.row[p]) * f->E.value[p] * by;
        for (int p = f->F.start[i]; p < f->F.start[i + 1]; p++)
            if (m->mode[f->F.row[p]] == NS_INSIDE)
                r[f->n + f->F.row[p]] -= f->F.value[p] * by;
    }
}

/* x_g and lambda in m->mode, to v. */
static int solve(ns_sparse *m, double *v) {
    const size_t n = (size_t)m->f->n;
    const ns_kept_factors *k;
    know(m);
    int status = ns_sparse_factors_factor(m->q, m->scheme.g, m->mode, 1, &k);
    if (status != NS_OK)
        return status;
    memcpy(m->r, m->scheme.base, sizeof(double) * (size_t)m->f->size);
    for (size_t i = 0; i < n; i++)
        m->r[i] += m->w[i];
    add_inputs(m, m->r);
    return ns_sparse_factors_solve(m->q, k, m->r, v);
}

/* Whether all laws hold at v. */
static int all_hold(const ns_sparse *m, const double *v) {
    const ns_packed_laws *k = &m->scheme.laws;
    if (!ns_sparse_laws_hold(k, v))
        return 0;
    for (int i = 0; i < k->others; i++)
        if (!ns_sparse_guard_holds(m, k->other[i], v))
            return 0;
    return 1;
}

/* x_g with what breaks changed, and commands of the state that it contradicts: once in a step. */
static int settle(ns_sparse *m, double t, double *v, int *broke) {
    const size_t nz = (size_t)m->f->nz;
    *broke = 0;
    for (int round = 0;; round++) {
        memcpy(m->z, m->scheme.z, sizeof(double) * nz);
        int status = solve(m, v);
        if (status != NS_OK || !all_hold(m, v)) {
            if (status != NS_OK && status != NS_E_SINGULAR)
                return status;
            memcpy(m->old_mode, m->mode, (size_t)m->f->m);
            status = ns_sparse_event_consistent(m, t, m->scheme.g, m->w, v, NULL);
            if (status != NS_OK)
                return status;
            if (memcmp(m->old_mode, m->mode, (size_t)m->f->m) != 0) {
                *broke = 1;
                m->scheme.known = 0;
            }
        }
        if (m->scheme.whole_pass || round > 0 || !ns_sparse_guard_commands(m, v, NULL, NULL))
            return NS_OK;
        m->scheme.known = 0;
        *broke = 1;
    }
}

/* by (n): what w moves by in g; the size of that. */
static double move(const ns_sparse *m, const double *v, double *by) {
    const ns_form *f = m->f;
    double most = 0;
    for (int i = 0; i < f->n; i++) {
        by[i] = f->algebraic[i] ? 0 : ns_linalg_csc_dot(&f->Mt, i, v) - m->w[i];
        most = ns_higher(fabs(by[i]) * m->scheme.units[i], most);
    }
    return most;
}

/* What the past mode has of a step in which commands change, at `share` of it: dw + 2 n to be mixed in. */
static void mix(const ns_sparse *m, const ns_dense_step *leg, double share) {
    const int n = m->f->n;
    double *by = leg->dw + n, *last = by + n;
    for (int i = 0; i < n; i++) {
        const double before = last[i];
        last[i] = by[i];
        by[i] += share * (before - by[i]);
    }
}

/* Commands are again as they were in leg->mode. */
static void take_back(ns_sparse *m, const ns_dense_step *leg) {
    memcpy(m->mode, leg->mode, (size_t)m->f->m);
    ns_sparse_guard_bounds(m);
    ns_inputs_stages_reset(m->in);
    ns_inputs_stages_at(m->in, m->scheme.t);
    m->scheme.corner = -INFINITY;
}

/* From m->w at m->scheme.t to leg->xi; what it moves to leg->dw + n.  *broke: laws did. */
static int stay(ns_sparse *m, ns_dense_step *leg, int *broke) {
    take_inputs(m, m->scheme.t + m->scheme.g);
    const int status = settle(m, m->scheme.t, leg->xi, broke);
    if (status == NS_OK)
        m->scheme.moves = move(m, leg->xi, leg->dw + m->f->n);
    return status;
}

/* Whether one more step of Euler's, after the one that leg has, would move much less: what theta < 1 would
 * let ring.  Asked where more moves than before. */
static int dies_out(ns_sparse *m, const ns_dense_step *leg, double moved) {
    const size_t n = (size_t)m->f->n;
    if (m->scheme.moves <= leap * moved || !(m->o.theta < 1))
        return 0;
    for (size_t i = 0; i < n; i++)
        m->w[i] += leg->dw[n + i];
    const int status = solve(m, m->next_v);
    const double next = status == NS_OK ? move(m, m->next_v, m->next_w) : 0;
    memcpy(m->w, leg->dw, sizeof(double) * n);
    return !(next > dead * m->scheme.moves);
}

/* stay() where commands change on the way.  *leaps: it has to be Euler's step. */
static int change(ns_sparse *m, ns_dense_step *leg, int *leaps) {
    const size_t n = (size_t)m->f->n;
    ns_sparse_theta *k = &m->scheme;
    const double moved = k->moves;
    int before;
    memcpy(leg->mode, m->mode, (size_t)m->f->m);
    int status = stay(m, leg, &before);
    if (status != NS_OK)
        return status;
    memcpy(leg->dw + 2 * n, leg->dw + n, sizeof(double) * n);
    const double share = fmax(0, (take_commands(m, k->t + m->o.h) - k->t) / m->o.h);
    status = stay(m, leg, leaps);
    if (status != NS_OK)
        return status;
    *leaps |= before;
    const int jumps = dies_out(m, leg, *leaps ? 0 : moved);
    *leaps |= jumps;
    const double most = !*leaps ? 1 : jumps ? 0.5 * m->o.theta : m->o.theta;
    if (share > most) { /* not in this step, or nearer to its end: the next one begins with it */
        take_back(m, leg);
        return stay(m, leg, &before);
    }
    if (!jumps) {
        mix(m, leg, *leaps ? share / m->o.theta : share);
        leg->stages = 2;
    }
    m->counts.events++;
    return NS_OK;
}

static int step(ns_sparse *m, ns_dense_step *leg) {
    const size_t n = (size_t)m->f->n;
    ns_sparse_theta *k = &m->scheme;
    const double moved = k->moves;
    const int turns = !(k->t + k->g < k->corner);
    int leaps = 0, status;
    leg->stages = 1;
    memcpy(leg->dw, m->w, sizeof(double) * n);
    memcpy(leg->dw + 3 * n, k->by, sizeof(double) * n);
    ns_inputs_stages_find_command(m->in, k->t, m->o.h, m->mode);
    if (m->in->first <= k->t + m->o.h) {
        status = change(m, leg, &leaps);
    } else {
        status = stay(m, leg, &leaps);
        m->counts.events += leaps;
        if (status == NS_OK && turns && !leaps)
            leaps = dies_out(m, leg, moved);
    }
    if (status != NS_OK)
        return status;
    const double on = leaps ? 1 : 1 / m->o.theta;
    for (size_t i = 0; i < n; i++)
        m->w[i] += on * leg->dw[n + i];
    leg->smooth = k->smooth && !leaps && leg->stages == 1;
    k->smooth = !leaps;
    memcpy(k->by, leg->dw + (size_t)leg->stages * n, sizeof(double) * n);
    leg->t = k->t;
    leg->g = k->g;
    leg->end = leaps ? k->g : m->o.h;
    leg->end_t = k->t + leg->end;
    if (!(leg->end_t > k->t))
        return NS_E_RANGE;
    k->t = leg->end_t;
    m->counts.steps++;
    m->counts.trials++;
    return NS_OK;
}

int ns_sparse_theta_go(ns_sparse *m, double t, double until, ns_dense_step *leg) {
    ns_sparse_theta *k = &m->scheme;
    int status;
    if (k->t != t || !k->running) {
        k->t = t;
        k->corner = -INFINITY;
        k->known = 0;
        k->running = 1;
        k->moves = 0;
        k->smooth = 0;
        ns_inputs_stages_reset(m->in);
        meet_corner(m, t);
    }
    do
        status = step(m, leg);
    while (status == NS_OK && k->t < until);
    if (status != NS_OK) {
        k->running = 0;
        return status;
    }
    leg->time_lost = 0;
    leg->rung = leg->next_rung = leg->stuck = 0;
    leg->why = NS_LEG_GOES_ON;
    leg->pair = leg->command = -1;
    leg->euler = 1;
    memcpy(leg->mode, m->mode, (size_t)m->f->m);
    return NS_OK;
}

/* K(g) x = w - g rate + g f at any time in the step, with the rate that it has, and turns by if nothing
 * broke.
 */
int ns_sparse_theta_point(ns_sparse *m, const ns_dense_step *leg, double tau, double *v) {
    const size_t n = (size_t)m->f->n;
    const double *rate = leg->dw + (size_t)leg->stages * n, *before = leg->dw + 3 * n; /* times g */
    const ns_kept_factors *k;
    if (tau == leg->g && leg->stages == 1) {
        memcpy(v, leg->xi, sizeof(double) * (size_t)m->f->size);
        return NS_OK;
    }
    if (memcmp(m->mode, leg->mode, (size_t)m->f->m) != 0) {
        memcpy(m->mode, leg->mode, (size_t)m->f->m);
        ns_sparse_guard_bounds(m);
        m->scheme.running = 0;
    }
    for (int i = 0; i < m->f->nz; i++)
        m->z[i] = ns_signal_value(&m->s->z[i], leg->t + tau, tau > 0 ? NS_LEFT : NS_RIGHT);
    const double turn = leg->smooth ? (tau - leg->g) / m->o.h : 0;
    for (size_t i = 0; i < n; i++)
        m->next_w[i] = leg->dw[i] + tau / leg->g * leg->dw[n + i] - rate[i] - turn * (rate[i] - before[i]);
    ns_sparse_step_rhs(m, leg->g, m->next_w, m->z, 1, 1);
    int status = ns_sparse_factors_factor(m->q, leg->g, m->mode, 1, &k);
    if (status == NS_OK)
        status = ns_sparse_factors_solve(m->q, k, m->r, v);
    return status == NS_E_SINGULAR ? NS_OK : status;
}
