/* src/sparse/theta_step.c - the theta scheme for large circuits: steps of one length, in which no event is
 * located.
 *
 * With theta = gamma a step of (T8) is one of implicit Euler, of length g = theta h, from w to x_g, and
 *
 *     w+ = w + (M x_g - w)/theta.
 *
 * Inputs, commands and laws are those at t + g: what changes in a step changes there.  With theta < 1 a jump,
 * where a law broke or a command moves w much more than before, would ring on: there the step is an Euler
 * step to t + g. Between its ends w is linear in time; x at a time between is one more solution.
 */
#include "guards.h"
#include "linalg/simd.h"
#include "step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A step that moves w by more than leap times the step before may jump; it does if the next Euler step would
 * move it by no more than dies_out times that. */
static const double leap = 4, dies_out_by = 0.5;

int ns_sparse_theta_create(ns_sparse *m) {
    const size_t n = (size_t)m->f->n, size = (size_t)m->f->size, nz = (size_t)m->f->nz;
    ns_sparse_theta *k = &m->theta;
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
    k->no_commands_by_state = m->f->gx.start[m->f->nc] == 0;
    return ns_sparse_laws_create(m->f->m, &k->laws);
}

void ns_sparse_theta_free(ns_sparse *m) {
    free(m->theta.base);
    ns_sparse_laws_free(&m->theta.laws);
}

/* --- inputs and commands --- */

/* Inputs at t, and up to when they go on without a corner. */
static void pass_corner(ns_sparse *m, double t) {
    ns_sparse_theta *k = &m->theta;
    ns_inputs_stages_at(m->in, t);
    k->corner = m->in->corner;
    for (int i = 0; i < m->f->nz; i++)
        k->z[i] = ns_signal_value(&m->s->z[i], t, NS_RIGHT);
    k->known = 0;
}

static void set_inputs(ns_sparse *m, double t) {
    ns_sparse_theta *k = &m->theta;
    if (!(t < k->corner)) {
        pass_corner(m, t);
        return;
    }
    for (int c = 0; c < m->in->ncurved; c++) {
        const int i = m->in->curved[c];
        const ns_exp_sum *w = &m->in->sum[i];
        k->z[i] =
            w->count > 0 ? ns_signal_value(&m->s->z[i], t, NS_LEFT) : w->value + w->slope * (t - w->from);
    }
}

/* Commands of time that change up to t do so; their mean instant. */
static double change_commands(ns_sparse *m, double t) {
    double sum = 0;
    const int count = ns_inputs_stages_flip_commands(m->in, t, m->mode, &sum);
    ns_sparse_guard_bounds(m);
    ns_inputs_stages_at(m->in, t);
    m->theta.corner = -INFINITY; /* inputs were expanded elsewhere */
    return count > 0 ? sum / count : t;
}

/* --- a step --- */

/* The right-hand side without w, and the laws, of the mode and of inputs at t + g. */
static void fill_base(ns_sparse *m) {
    ns_sparse_theta *k = &m->theta;
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
    const ns_sparse_theta *k = &m->theta;
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
static int solve_step(ns_sparse *m, double *v) {
    const size_t n = (size_t)m->f->n;
    const ns_cached_factors *k;
    fill_base(m);
    int status = ns_sparse_factors_factor(m->q, m->theta.g, m->mode, 1, &k);
    if (status != NS_OK)
        return status;
    memcpy(m->r, m->theta.base, sizeof(double) * (size_t)m->f->size);
    for (size_t i = 0; i < n; i++)
        m->r[i] += m->w[i];
    add_inputs(m, m->r);
    return ns_sparse_factors_solve(m->q, k, m->r, v);
}

/* 1 if all laws hold at v. */
static int all_hold(const ns_sparse *m, const double *v) {
    const ns_packed_laws *k = &m->theta.laws;
    if (!ns_sparse_laws_hold(k, v))
        return 0;
    for (int i = 0; i < k->others; i++)
        if (!ns_sparse_guard_holds(m, k->other[i], v))
            return 0;
    return 1;
}

/* x_g in a mode whose laws hold; *broke: the mode changed.  Commands by the state change once in a step. */
static int find_consistent(ns_sparse *m, double t, double *v, int *broke) {
    const size_t nz = (size_t)m->f->nz;
    *broke = 0;
    for (int round = 0;; round++) {
        memcpy(m->z, m->theta.z, sizeof(double) * nz);
        int status = solve_step(m, v);
        if (status != NS_OK || !all_hold(m, v)) {
            if (status != NS_OK && status != NS_E_SINGULAR)
                return status;
            memcpy(m->work.mode, m->mode, (size_t)m->f->m);
            status = ns_sparse_event_consistent(m, t, m->theta.g, m->w, v, NULL);
            if (status != NS_OK)
                return status;
            if (memcmp(m->work.mode, m->mode, (size_t)m->f->m) != 0) {
                *broke = 1;
                m->theta.known = 0;
            }
        }
        if (m->theta.no_commands_by_state || round > 0 || !ns_sparse_guard_commands(m, v, NULL, NULL))
            return NS_OK;
        m->theta.known = 0;
        *broke = 1;
    }
}

/* by (n): what w moves by in g; the size of that. */
static double find_move(const ns_sparse *m, const double *v, double *by) {
    const ns_form *f = m->f;
    double most = 0;
    for (int i = 0; i < f->n; i++) {
        by[i] = f->algebraic[i] ? 0 : ns_linalg_csc_dot(&f->Mt, i, v) - m->w[i];
        most = ns_higher(fabs(by[i]) * m->theta.units[i], most);
    }
    return most;
}

/* Of a step whose commands change after a fraction of it: the past mode moves w by powers + 2 n in its part.
 */
static void mix_moves(const ns_sparse *m, const ns_dense_step *step, double fraction) {
    const int n = m->f->n;
    double *by = step->powers + n, *last = by + n;
    for (int i = 0; i < n; i++) {
        const double before = last[i];
        last[i] = by[i];
        by[i] += fraction * (before - by[i]);
    }
}

/* Commands are again as they were in step->mode. */
static void undo_commands(ns_sparse *m, const ns_dense_step *step) {
    ns_sparse_guard_set_mode(m, step->mode);
    ns_inputs_stages_reset(m->in);
    ns_inputs_stages_at(m->in, m->theta.t);
    m->theta.corner = -INFINITY;
}

/* From m->w at m->theta.t to step->images; what it moves to step->powers + n.  *broke: laws did. */
static int step_in_mode(ns_sparse *m, ns_dense_step *step, int *broke) {
    set_inputs(m, m->theta.t + m->theta.g);
    const int status = find_consistent(m, m->theta.t, step->images, broke);
    if (status == NS_OK)
        m->theta.moves = find_move(m, step->images, step->powers + m->f->n);
    return status;
}

/* 1 if w moved by much more than before (moved), and one more Euler step would move it by much less: with
 * theta < 1 that would ring on. */
static int dies_out(ns_sparse *m, const ns_dense_step *step, double moved) {
    const size_t n = (size_t)m->f->n;
    if (m->theta.moves <= leap * moved || !(m->o.theta < 1))
        return 0;
    for (size_t i = 0; i < n; i++)
        m->w[i] += step->powers[n + i];
    const int status = solve_step(m, m->work.v);
    const double next = status == NS_OK ? find_move(m, m->work.v, m->work.w) : 0;
    memcpy(m->w, step->powers, sizeof(double) * n);
    return !(next > dies_out_by * m->theta.moves);
}

/* The same where commands change in it.  *leaps: it has to be an Euler step. */
static int step_with_commands(ns_sparse *m, ns_dense_step *step, int *leaps) {
    const size_t n = (size_t)m->f->n;
    ns_sparse_theta *k = &m->theta;
    const double moved = k->moves;
    int before;
    memcpy(step->mode, m->mode, (size_t)m->f->m);
    int status = step_in_mode(m, step, &before);
    if (status != NS_OK)
        return status;
    memcpy(step->powers + 2 * n, step->powers + n, sizeof(double) * n);
    const double fraction = fmax(0, (change_commands(m, k->t + m->o.h) - k->t) / m->o.h);
    status = step_in_mode(m, step, leaps);
    if (status != NS_OK)
        return status;
    *leaps |= before;
    const int jumps = dies_out(m, step, *leaps ? 0 : moved);
    *leaps |= jumps;
    const double latest = !*leaps ? 1 : jumps ? 0.5 * m->o.theta : m->o.theta;
    if (fraction > latest) { /* the next step begins with the change: that is nearer to it */
        undo_commands(m, step);
        return step_in_mode(m, step, &before);
    }
    if (!jumps) {
        mix_moves(m, step, *leaps ? fraction / m->o.theta : fraction);
        step->stages = 2;
    }
    m->counts.events++;
    return NS_OK;
}

static int try_step(ns_sparse *m, ns_dense_step *step) {
    const size_t n = (size_t)m->f->n;
    ns_sparse_theta *k = &m->theta;
    const double moved = k->moves;
    const int has_corner = !(k->t + k->g < k->corner);
    int leaps = 0, status;
    step->stages = 1;
    memcpy(step->powers, m->w, sizeof(double) * n);
    memcpy(step->powers + 3 * n, k->by, sizeof(double) * n);
    ns_inputs_stages_find_command(m->in, k->t, m->o.h, m->mode);
    if (m->in->first <= k->t + m->o.h) {
        status = step_with_commands(m, step, &leaps);
    } else {
        status = step_in_mode(m, step, &leaps);
        m->counts.events += leaps;
        if (status == NS_OK && has_corner && !leaps)
            leaps = dies_out(m, step, moved);
    }
    if (status != NS_OK)
        return status;
    const double on = leaps ? 1 : 1 / m->o.theta;
    for (size_t i = 0; i < n; i++)
        m->w[i] += on * step->powers[n + i];
    step->is_smooth = k->smooth && !leaps && step->stages == 1;
    k->smooth = !leaps;
    memcpy(k->by, step->powers + (size_t)step->stages * n, sizeof(double) * n);
    step->t = k->t;
    step->g = k->g;
    step->length = leaps ? k->g : m->o.h;
    step->end_t = k->t + step->length;
    if (!(step->end_t > k->t))
        return NS_E_RANGE;
    k->t = step->end_t;
    m->counts.steps++;
    m->counts.trials++;
    return NS_OK;
}

void ns_sparse_theta_stop(ns_sparse *m) {
    m->theta.running = 0;
}

int ns_sparse_theta_go(ns_sparse *m, double t, double until, ns_dense_step *step) {
    ns_sparse_theta *k = &m->theta;
    int status;
    if (k->t != t || !k->running) {
        k->t = t;
        k->corner = -INFINITY;
        k->known = 0;
        k->running = 1;
        k->moves = 0;
        k->smooth = 0;
        pass_corner(m, t);
    }
    do
        status = try_step(m, step);
    while (status == NS_OK && k->t < until);
    if (status != NS_OK) {
        k->running = 0;
        return status;
    }
    step->time_lost = 0;
    step->length_exponent = step->next_exponent = step->failures = step->unchanged = 0;
    step->at_event = 0;
    step->pair = step->command = -1;
    step->is_euler = 1;
    memcpy(step->mode, m->mode, (size_t)m->f->m);
    return NS_OK;
}

/* K(g) x = w - g rate + g f at any time in the step, with its rate, which changes linearly from that of the
 * step before if no law broke. */
int ns_sparse_theta_point(ns_sparse *m, const ns_dense_step *step, double tau, double *v) {
    const size_t n = (size_t)m->f->n;
    const double *rate = step->powers + (size_t)step->stages * n,
                 *before = step->powers + 3 * n; /* times g */
    const ns_cached_factors *k;
    if (tau == step->g && step->stages == 1) {
        memcpy(v, step->images, sizeof(double) * (size_t)m->f->size);
        return NS_OK;
    }
    if (memcmp(m->mode, step->mode, (size_t)m->f->m) != 0) {
        ns_sparse_guard_set_mode(m, step->mode);
        ns_sparse_theta_stop(m);
    }
    for (int i = 0; i < m->f->nz; i++)
        m->z[i] = ns_signal_value(&m->s->z[i], step->t + tau, tau > 0 ? NS_LEFT : NS_RIGHT);
    const double change = step->is_smooth ? (tau - step->g) / m->o.h : 0;
    for (size_t i = 0; i < n; i++)
        m->work.w[i] =
            step->powers[i] + tau / step->g * step->powers[n + i] - rate[i] - change * (rate[i] - before[i]);
    ns_sparse_step_rhs(m, step->g, m->work.w, m->z, 1, 1);
    int status = ns_sparse_factors_factor(m->q, step->g, m->mode, 1, &k);
    if (status == NS_OK)
        status = ns_sparse_factors_solve(m->q, k, m->r, v);
    return status == NS_E_SINGULAR ? NS_OK : status;
}
