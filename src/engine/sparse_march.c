/* src/engine/sparse_march.c - the marcher for large circuits: made, asked, accepted, read. */
#include "sparse_march.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEGS = sizeof((ns_sparse *)0)->leg / sizeof(ns_leg) };

int ns_sparse_fail(ns_sparse *m, double t, int status) {
    m->fault.status = (ns_status)status;
    m->fault.nunknowns = 0;
    if (status != NS_E_INFEASIBLE && status != NS_E_SINGULAR && status != NS_E_LIMIT)
        m->fault.npairs = 0;
    m->fault.t = t;
    return status;
}

static int make_leg(const ns_form *f, ns_leg *leg) {
    const size_t n = (size_t)f->n, size = (size_t)f->size, nz = (size_t)f->nz, s = NS_STAGES;
    leg->xi = calloc(s * size + (s + 1) * n + s * nz + 1, sizeof(double));
    leg->mode = calloc((size_t)f->m + 1, 1);
    if (!leg->xi || !leg->mode)
        return NS_E_MEMORY;
    leg->dw = leg->xi + s * size;
    leg->z = leg->dw + (s + 1) * n;
    return NS_OK;
}

static double *take(double **from, int count) {
    double *first = *from;
    *from += count;
    return first;
}

static int allocate(ns_sparse *m) {
    const int n = m->f->n, pairs = m->f->m, size = m->f->size;
    const size_t count = (size_t)(14 * n + 4 * pairs + 5 * size + 2 * m->f->nz) + 1;
    double *all = calloc(count, sizeof(double));
    m->w = all;
    m->mode = calloc(7 * (size_t)pairs + 2 * (size_t)m->s->nc + 1, 1);
    m->crowd = calloc(2 * (size_t)pairs + 1, sizeof(int));
    m->fine = calloc((size_t)size + 1, sizeof(long double));
    m->guesses = 8 * (size_t)pairs + 61;
    m->guess = calloc(m->guesses, sizeof *m->guess);
    if (!all || !m->mode || !m->crowd || !m->fine || !m->guess)
        return NS_E_MEMORY;
    m->old_mode = m->mode + pairs;
    m->shown = m->old_mode + pairs;
    m->own_mode = m->shown + pairs;
    m->flip = (unsigned char *)(m->own_mode + pairs);
    m->touched = m->flip + pairs;
    m->changed = m->touched + pairs;
    m->event_changed = m->changed + m->s->nc;
    m->event_mode = (ns_mode *)(m->event_changed + m->s->nc);
    m->w = take(&all, n);
    m->next_w = take(&all, n);
    m->before_w = take(&all, n);
    m->right_w = take(&all, n);
    m->gone = take(&all, n);
    m->finer_gone = take(&all, n);
    m->event_w = take(&all, n);
    m->scale = take(&all, 3 * n);
    m->unit = take(&all, n);
    m->kept_scale = take(&all, n);
    m->share = take(&all, n);
    m->rate = take(&all, n);
    m->l = take(&all, pairs);
    m->u = take(&all, pairs);
    m->crowd_t = take(&all, 2 * pairs);
    m->v = take(&all, size);
    m->r = take(&all, size);
    m->next_v = take(&all, size);
    m->rest = take(&all, size);
    m->fine_v = take(&all, size);
    m->z = take(&all, m->f->nz);
    m->z_none = take(&all, m->f->nz);
    int status = NS_OK;
    for (int i = 0; i < LEGS && status == NS_OK; i++)
        status = make_leg(m->f, &m->leg[i]);
    return status;
}

static void set_units(ns_sparse *m) {
    for (int i = 0; i < m->f->n; i++) {
        double most = 0;
        for (int k = m->f->Mt.start[i]; k < m->f->Mt.start[i + 1]; k++)
            most = fmax(most, fabs(m->f->Mt.value[k]));
        m->unit[i] = sqrt(most);
    }
}

static int make(ns_sparse *m, const ns_system *s) {
    int status = ns_aside_create(s, &m->aside);
    m->s = status == NS_OK ? &m->aside->rest : s;
    if (status == NS_OK)
        status = ns_form_create(m->s, 0, &m->f);
    if (status == NS_OK)
        status = ns_modal_create(m->f, m->o.bytes, &m->q);
    if (status == NS_OK)
        status = ns_inputs_create(m->s, m->f, &m->in);
    if (status == NS_OK)
        status = ns_sparse_twins(m->s, m->f, &m->twin, &m->twins);
    if (status == NS_OK)
        status = allocate(m);
    if (status != NS_OK)
        return status;
    set_units(m);
    return ns_scheme_create(m);
}

int ns_sparse_create(const ns_system *s, const ns_sparse_options *o, ns_sparse **out, ns_fault *fault) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!s || !o)
        return NS_E_NULL;
    if (!(o->h > 0) || !isfinite(o->h) || !(o->reltol >= 0) || !isfinite(o->reltol) ||
        !(o->theta >= 0 && o->theta <= 1))
        return NS_E_RANGE;
    int status = ns_system_check(s, fault);
    if (status != NS_OK)
        return status;
    ns_sparse *m = calloc(1, sizeof *m);
    if (!m)
        return NS_E_MEMORY;
    m->o = *o;
    m->o.reltol = o->reltol > 0 ? o->reltol : 1e-9;
    m->o.bytes = o->bytes ? o->bytes : (size_t)64 << 20;
    m->fault.t = NAN;
    status = make(m, s);
    if (status != NS_OK) {
        ns_sparse_free(m);
        return status;
    }
    *out = m;
    return NS_OK;
}

void ns_sparse_free(ns_sparse *m) {
    if (!m)
        return;
    for (int i = 0; i < LEGS; i++) {
        free(m->leg[i].xi);
        free(m->leg[i].mode);
    }
    free(m->w);
    free(m->mode);
    free(m->crowd);
    free(m->twin);
    free(m->fine);
    free(m->guess);
    ns_scheme_free(m);
    ns_inputs_free(m->in);
    ns_modal_free(m->q);
    ns_form_free(m->f);
    ns_aside_free(m->aside);
    free(m);
}

/* As far into the live leg as t is. */
static void move_to(ns_sparse *m, double t) {
    const int whole = t >= m->live->end_t || (m->live->euler && !(m->o.theta > 0));
    m->live_tau = whole ? m->live->end : fmin(t - m->live->t - m->live->past_t, m->live->end);
    m->live_t = whole ? m->live->end_t : t;
}

int ns_sparse_at_event(const ns_sparse *m) {
    return m->started && m->live->why == NS_LEG_EVENT && m->live_t >= m->live->end_t;
}

static int euler_leg(ns_sparse *m, ns_leg *leg, double t, double limit, double h) {
    const size_t n = (size_t)m->f->n;
    const double rest = limit - t - leg->past_t, g = fmin(h, rest);
    leg->t = t;
    leg->g = leg->end = g;
    leg->end_t = g < rest ? t + (leg->past_t + g) : limit;
    leg->why = NS_LEG_GOES_ON;
    leg->pair = leg->command = -1;
    leg->euler = 1;
    leg->stages = 1;
    leg->next_rung = leg->rung;
    memcpy(leg->dw, m->w, sizeof(double) * n);
    const int status = ns_event_settle(m, t, g, m->w, leg->xi, NULL);
    for (size_t i = 0; i < n; i++)
        leg->dw[n + i] = m->f->algebraic[i] ? 0 : ns_csc_dot(&m->f->Mt, (int)i, leg->xi) - m->w[i];
    memcpy(leg->mode, m->mode, (size_t)m->f->m);
    memcpy(leg->z, m->z, sizeof(double) * (size_t)m->f->nz);
    m->counts.steps++;
    return status;
}

/* The state at the end of a leg, as what comes next begins from. */
static void leave(ns_sparse *m, const ns_leg *leg) {
    ns_leg_state(m, leg, leg->end, m->w);
    memcpy(m->mode, leg->mode, (size_t)m->f->m);
    ns_guard_bounds(m);
}

/* The largest difference of two states, as a multiple of the error allowed. */
static double apart(const ns_sparse *m, const double *a, const double *b) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = fmax(most, fabs(a[i] - b[i]) / m->unit[i]);
    return most / (m->o.reltol * ns_fine_size(m));
}

/* Two Euler steps one after another as one leg. */
static int euler_twice(ns_sparse *m, ns_leg *leg, double t, double limit, double h) {
    const size_t bytes = sizeof(double) * (size_t)m->f->n;
    int status = euler_leg(m, leg, t, limit, h / 2);
    const double half = leg->end, past_t = leg->past_t;
    if (status != NS_OK || leg->end_t == limit)
        return status;
    leave(m, leg);
    leg->past_t = ns_leg_past(leg);
    status = euler_leg(m, leg, leg->end_t, limit, h / 2);
    memcpy(leg->dw, m->before_w, bytes);
    for (int i = 0; i < m->f->n; i++)
        leg->dw[m->f->n + i] = m->f->algebraic[i] ? 0 : ns_csc_dot(&m->f->Mt, i, leg->xi) - m->before_w[i];
    leg->t = t;
    leg->past_t = past_t;
    leg->end += half;
    return status;
}

/* Euler steps no longer than h, and such that their error is allowed.  Many of them in a short time are
 * chatter: that is refused (LIMIT), naming the pair of the last event. */
static int careful_leg(ns_sparse *m, ns_leg *leg, double t, double limit, double h) {
    const size_t n = (size_t)m->f->n, pairs = (size_t)m->f->m;
    const double past_t = leg->past_t;
    double off = INFINITY;
    int status = NS_OK;
    if (!(t - m->euler_t <= ldexp(m->o.h, -leg->rung))) {
        m->euler_t = t;
        m->eulers = 0;
    }
    m->crowd_moved = 1;
    if (++m->eulers > NS_MOST_EULERS)
        return NS_E_LIMIT;
    memcpy(m->before_w, m->w, sizeof(double) * n);
    memcpy(m->event_mode, m->mode, pairs);
    for (int less = 0; less < NS_LEAST_RUNG && off > 1; less += 2) {
        const double g = ldexp(h, -less);
        status = euler_leg(m, leg, t, limit, g);
        for (size_t i = 0; i < n && status == NS_OK; i++)
            m->right_w[i] = leg->dw[i] + leg->dw[n + i];
        for (int again = 0; again < 2; again++) {
            memcpy(m->w, m->before_w, sizeof(double) * n);
            memcpy(m->mode, m->event_mode, pairs);
            ns_guard_bounds(m);
            leg->past_t = past_t;
            if (again == 0 && status == NS_OK)
                status = euler_twice(m, leg, t, limit, g);
        }
        if (status != NS_OK)
            return status;
        for (size_t i = 0; i < n; i++)
            m->gone[i] = leg->dw[i] + leg->dw[n + i];
        off = apart(m, m->right_w, m->gone);
    }
    return off <= 1 ? NS_OK : NS_E_LIMIT;
}

/* A leg from m->w, m->mode at t after one that ended there. */
int ns_sparse_next_leg(ns_sparse *m, double t, const ns_leg *before, ns_leg *leg) {
    const double tiny = before ? ldexp(m->o.h, -before->next_rung - NS_SHORT_RUNG) : 0;
    const int stuck = before && before->why == NS_LEG_EVENT && !(before->end > tiny) ? before->stuck + 1 : 0;
    leg->rung = before ? before->next_rung : 0;
    leg->stuck = stuck;
    leg->past_t = before ? ns_leg_past(before) : 0;
    ns_inputs_at(m->in, t);
    ns_inputs_look(m->in, t, m->o.h, m->mode);
    const double limit = fmax(fmin(m->in->corner, m->in->first), nextafter(t, INFINITY));
    const double h = ldexp(m->o.h, -leg->rung);
    int status;
    if (m->o.theta > 0)
        return ns_scheme_go(m, t, t, leg);
    if (stuck > NS_STUCK)
        status = careful_leg(m, leg, t, limit, ldexp(h, -10));
    else
        status = ns_leg_begin(m, leg, t, limit);
    if (status == NS_OK && leg->why == NS_LEG_GOES_ON && leg->end_t == limit && ns_event_at(m, limit))
        leg->why = NS_LEG_EVENT;
    return status;
}

/* Where no mode is found in no time, an implicit Euler step that takes a while may: from m->w, m->mode. */
static int capture(ns_sparse *m, double t, const ns_leg *before, ns_leg *leg) {
    const size_t n = (size_t)m->f->n, pairs = (size_t)m->f->m;
    int status = NS_E_LIMIT;
    memcpy(m->next_w, m->w, sizeof(double) * n);
    memcpy(m->old_mode, m->mode, pairs);
    ns_inputs_at(m->in, t);
    ns_inputs_look(m->in, t, m->o.h, m->mode);
    const double limit = fmax(fmin(m->in->corner, m->in->first), nextafter(t, INFINITY));
    for (int less = NS_CAPTURE_FIRST; less >= 2 && status != NS_OK; less -= 4) {
        memcpy(m->w, m->next_w, sizeof(double) * n);
        memcpy(m->mode, m->old_mode, pairs);
        ns_guard_bounds(m);
        leg->rung = before->next_rung;
        leg->stuck = 0;
        leg->past_t = ns_leg_past(before);
        status = careful_leg(m, leg, t, limit, ldexp(m->o.h, -leg->rung - less));
    }
    if (status == NS_OK && leg->end_t == limit && ns_event_at(m, limit))
        leg->why = NS_LEG_EVENT;
    m->counts.refused++;
    m->budget -= 3000; /* it has no end in sight */
    return status;
}

static int is_refusal(int status) {
    return status == NS_E_SINGULAR || status == NS_E_LIMIT || status == NS_E_INFEASIBLE ||
           status == NS_E_RESIDUAL;
}

static ns_leg *free_leg(ns_sparse *m) {
    ns_leg *leg = m->leg;
    while (leg == m->live || leg == m->kept)
        leg++;
    return leg;
}

/* The event at the end of a leg, and the next one. */
static int past_event(ns_sparse *m, double t, const ns_leg *from, ns_leg *to) {
    ns_event_own(m, from, t);
    if (ns_guess_leg(m, t, from, to)) {
        return ns_event_count(m, from, t);
    }
    const int status = ns_sparse_resolve(m, from, t);
    if (is_refusal(status)) {
        leave(m, from);
        memcpy(m->mode, m->own_mode, (size_t)m->f->m);
        ns_guard_bounds(m);
    }
    return status == NS_OK ? ns_sparse_next_leg(m, t, from, to) : status;
}

/* Gave up at the end of a leg, for the sake of what changed there. */
static int blame(ns_sparse *m, const ns_leg *leg, int status) {
    const int pair = leg->pair >= 0 ? leg->pair : leg->command >= 0 ? m->s->command[leg->command].pair : -1;
    if (status == NS_E_LIMIT && (m->fault.npairs = pair >= 0))
        m->fault.pair[0] = pair;
    return status;
}

/* From the end of the live leg to the next one. */
static int go_on(ns_sparse *m) {
    ns_leg *from = m->live, *to = free_leg(m);
    const double t = from->end_t;
    int status;
    if (m->budget-- <= 0)
        return blame(m, from, NS_E_LIMIT);
    leave(m, from);
    if (from->euler) {
        memcpy(m->z, from->z, sizeof(double) * (size_t)m->f->nz);
        (void)ns_guard_commands(m, from->xi, NULL, NULL);
    }
    if (m->in->first == -INFINITY) { /* it was gone back to: its instants are known no more */
        ns_inputs_at(m->in, from->t);
        ns_inputs_look(m->in, from->t, m->o.h, from->mode);
    }
    status = from->why == NS_LEG_EVENT ? past_event(m, t, from, to) : ns_sparse_next_leg(m, t, from, to);
    if (is_refusal(status))
        status = capture(m, t, from, to);
    if (status != NS_OK)
        return blame(m, from, status);
    m->live = to;
    m->live_tau = 0;
    m->live_t = t;
    return NS_OK;
}

/* The same by steps of the scheme. */
static int step_on(ns_sparse *m) {
    ns_leg *from = m->live, *to = from == m->kept ? (from == m->leg ? m->leg + 1 : m->leg) : from;
    const double t = from->end_t;
    if (!m->scheme.running || m->scheme.t != t)
        leave(m, from);
    const int status = ns_scheme_go(m, t, m->asked, to);
    if (status != NS_OK)
        return status;
    m->live = to;
    m->live_tau = 0;
    m->live_t = t;
    return NS_OK;
}

static int go_to(ns_sparse *m, double t, ns_until until) {
    const double from = m->live_t;
    m->budget = 100000 + (long)fmin(1e12, 20000 * (t - from) / m->o.h);
    if (until == NS_TO_EVENT && ns_sparse_at_event(m))
        return go_on(m);
    while (m->live_t < t) {
        if (m->live_t < m->live->end_t) {
            move_to(m, t);
        } else {
            const int status = m->o.theta > 0 ? step_on(m) : go_on(m);
            if (status != NS_OK)
                return status;
        }
        if (until == NS_TO_EVENT && ns_sparse_at_event(m))
            return m->live_t > from ? NS_OK : go_on(m);
    }
    return NS_OK;
}

static void go_back(ns_sparse *m) {
    if (m->live != m->kept || m->live_t != m->kept_t) {
        ns_inputs_reset(m->in);
        m->scheme.running = 0;
    }
    m->live = m->kept;
    m->live_tau = m->kept_tau;
    m->live_t = m->kept_t;
    m->has_trial = 0;
    ns_event_crowd(m, 0);
}

int ns_sparse_try(ns_sparse *m, double t, ns_until until, double *reached) {
    if (!m || !reached)
        return NS_E_NULL;
    if (!m->started)
        return ns_sparse_fail(m, t, NS_E_STATE);
    if (!(t > m->kept_t) || !isfinite(t))
        return ns_sparse_fail(m, t, NS_E_RANGE);
    if (!(m->has_trial && (t == m->live_t || (t == m->asked && until == m->until)))) {
        go_back(m);
        m->asked = t;
        m->until = until;
        const int status = go_to(m, t, until);
        if (status != NS_OK) {
            const double at = m->live_t;
            go_back(m);
            return ns_sparse_fail(m, at, status);
        }
        m->has_trial = 1;
    }
    *reached = m->live_t;
    return NS_OK;
}

int ns_sparse_accept(ns_sparse *m) {
    if (!m)
        return NS_E_NULL;
    if (!m->has_trial)
        return NS_E_STATE;
    m->kept = m->live;
    m->kept_tau = m->live_tau;
    m->kept_t = m->live_t;
    m->has_trial = 0;
    ns_event_crowd(m, 1);
    return NS_OK;
}
