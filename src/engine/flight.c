/* src/engine/flight.c - the flight engine: exact from event to event (E1), (E2). */
#include "flight.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Events in a row that come sooner after each other than h 2^-20: they accumulate, or chatter. */
enum { NS_PILE = 40 };

static int allocate(ns_flight *f) {
    const ns_system *y = f->m->s;
    const size_t n = (size_t)y->n, m = (size_t)y->m, nz = (size_t)y->nz, r = (size_t)f->s->r;
    const size_t rows = 2 * m + (size_t)y->nc, q = r + (size_t)f->exo->nv;
    const size_t all = 3 * q + r + NS_ORDER * (r + rows) + (NS_SAMPLES + 1) * rows + 3 * rows + nz;
    f->block = calloc(all + 2 * (n + m) + 1, sizeof *f->block);
    f->want = calloc(2 * m + 1, sizeof *f->want);
    if (!f->block || !f->want)
        return NS_E_MEMORY;
    f->X = f->block;
    f->next = f->X + q;
    f->left = f->next + q;
    f->most = f->left + q;
    f->series = f->most + r;
    f->coef = f->series + NS_ORDER * r;
    f->guards = f->coef + NS_ORDER * rows;
    f->value = f->guards + (NS_SAMPLES + 1) * rows;
    f->rate = f->value + rows;
    f->slope = f->rate + 2 * rows;
    f->to.x = f->slope + nz;
    f->to.lambda = f->to.x + n;
    f->to.X = f->to.lambda + m;
    f->to.Lambda = f->to.X + n;
    f->to.mode = f->want + m;
    return NS_OK;
}

int ns_flight_create(ns_march *m, ns_flight **out) {
    ns_flight *f = calloc(1, sizeof *f);
    *out = NULL;
    if (!f)
        return NS_E_MEMORY;
    f->m = m;
    f->s = m->step;
    f->grounded = -INFINITY;
    f->limit = m->step->cache.limit;
    int status = ns_exo_create(m->s, &f->exo);
    if (status == NS_OK)
        status = allocate(f);
    if (status != NS_OK) {
        ns_flight_free(f);
        return status;
    }
    *out = f;
    return NS_OK;
}

void ns_flight_free(ns_flight *f) {
    if (!f)
        return;
    ns_flight_forget(f);
    ns_exo_free(f->exo);
    free(f->block);
    free(f->want);
    free(f);
}

int ns_flight_grounded(const ns_flight *f) {
    return f->m->live.t < f->grounded || f->m->live.t < f->exo->from;
}

/* From the accepted point of the stepper. */
static int load(ns_flight *f) {
    f->t = f->m->live.t;
    f->since = f->m->live.since;
    if (f->bytes > f->limit)
        ns_flight_forget(f);
    ns_theta_set_bounds(f->s);
    const int status = ns_flight_find(f, f->s->mode, &f->at);
    if (status != NS_OK)
        return status;
    memcpy(f->X, f->s->w, sizeof(double) * (size_t)f->s->r);
    ns_exo_at(f->exo, f->t, f->X + f->s->r);
    for (int i = 0; i < f->s->r; i++)
        f->most[i] = fmax(f->most[i], fabs(f->X[i]));
    return NS_OK;
}

/* x, lambda at X, (E1) at tau = 0: the stage of X - D X + D^2 X - ... */
static void read_point(ns_flight *f, double *x) {
    const ns_stage *k = f->at->level[0].stage;
    const int all = f->m->s->n + f->m->s->m;
    double sign = -1;
    memcpy(f->next, f->X, sizeof(double) * (size_t)k->q);
    ns_matvec(NS_ORDER * k->r, k->q, k->series, f->X, f->series);
    memcpy(f->left, f->X + k->r, sizeof(double) * (size_t)k->nv);
    for (int order = 1; order < NS_ORDER; order++, sign = -sign) {
        double *v = f->left, *next = f->left + k->nv;
        memcpy(next, v, sizeof(double) * (size_t)k->nv);
        ns_exo_stage(f->exo, k->g, next);
        for (int i = 0; i < k->nv; i++)
            v[i] = next[i] - v[i];
        for (int i = 0; i < k->r; i++)
            f->next[i] += sign * f->series[(order - 1) * k->r + i];
        for (int i = 0; i < k->nv; i++)
            f->next[k->r + i] += sign * v[i];
    }
    ns_matvec(all, k->q, k->xi, f->next, x);
}

/* The stepper's accepted point gets to be here. */
static void deposit(ns_flight *f) {
    ns_theta *s = f->s;
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m;
    read_point(f, f->to.x); /* and lambda */
    memset(f->to.X, 0, sizeof(double) * (n + m));
    memcpy(f->to.mode, f->at->mode, m);
    memcpy(s->w, f->X, sizeof(double) * (size_t)s->r);
    ns_system_inputs(s->s, f->t, f->m->live.at_event ? NS_LEFT : NS_RIGHT, f->m->z);
    ns_theta_jump(s, &f->to, f->m->z);
    memcpy(s->w, f->X, sizeof(double) * (size_t)s->r);
    ns_control_set(f->m, f->to.x);
    f->m->live.t = f->t;
    f->m->live.past_t = 0;
    f->m->live.since = f->since;
}

/* The step to take next: *leg, or (NULL) a short way by the series; its length. */
static int choose(ns_flight *f, ns_level *level, double rest, ns_leg **leg, double *h) {
    const ns_stage *k = level->stage;
    const double longest = ldexp(k->h, NS_GUARDED);
    int status = NS_OK;
    *leg = NULL;
    *h = rest;
    if (rest < longest * 1.01 || k->rows == 0)
        status = ns_leg_recurring(f, level, rest, leg);
    if (status != NS_OK || *leg || k->rows == 0 || rest <= k->h)
        return status;
    int rung = 0;
    while (rung < NS_GUARDED && ldexp(k->h, rung + 1) <= rest)
        rung++;
    status = ns_leg_rung(f, level, rung, leg);
    *h = ldexp(k->h, rung);
    return status;
}

/* From X over `span`, in steps of h at most, until a guard breaks: *broke; *done: how far it came. */
static int look(ns_flight *f, ns_level *level, double span, double *done, int *broke) {
    const double h = level->stage->h;
    *done = 0;
    *broke = 0;
    while (!*broke && *done < span) {
        double part = fmin(h, span - *done), when;
        if (span - *done - part < 1e-9 * h)
            part = span - *done;
        *broke = ns_watch_near(f, level, part, &when);
        if (*broke)
            part = when;
        const int status = part > 0 ? ns_leg_advance(f, level, part) : NS_OK;
        if (status != NS_OK)
            return status;
        *done = *done + part >= span * (1 - 1e-15) ? span : *done + part;
    }
    return NS_OK;
}

/* One step of at most `rest`; *done: how far it came, *broke: to where a guard breaks. */
static int advance(ns_flight *f, double rest, double *done, int *broke) {
    double until, h;
    ns_leg *leg;
    ns_level *level = ns_flight_level(f, &until);
    const double room = until - (f->t - f->since);
    int status = choose(f, level, room > 0 && room < rest ? room : rest, &leg, &h);
    if (status != NS_OK)
        return status;
    if (!leg)
        return look(f, level, h, done, broke);
    const int doubt = leg->samples > 0 ? ns_watch_leg(f, level, leg) : -1;
    if (doubt < 0) {
        ns_leg_take(f, level, leg);
        *done = h;
        return NS_OK;
    }
    const double before = h / leg->samples * doubt;
    double more = 0;
    status = before > 0 ? ns_leg_advance(f, level, before) : NS_OK;
    if (status == NS_OK)
        status = look(f, level, h / leg->samples, &more, broke);
    *done = before + more;
    return status;
}

/* To t, unless a guard breaks before. */
static int fly(ns_flight *f, double t, int *broke) {
    int status = NS_OK;
    *broke = 0;
    while (!*broke && f->t < t && status == NS_OK) {
        const double rest = t - f->t;
        double done = 0;
        if (f->m->budget-- <= 0)
            return ns_march_fail(f->m, NS_E_LIMIT);
        status = advance(f, rest, &done, broke);
        f->t = done >= rest * (1 - 1e-15) ? t : f->t + done;
    }
    return status;
}

/* The next instant that is known ahead, not after t: a corner, or commands that depend on time only, which are
 * left in m->flip. */
static double next_known(ns_flight *f, double t, int *commanded) {
    ns_march *m = f->m;
    m->live.t = f->t;
    const double corner = fmin(t, ns_march_next_corner(m));
    *commanded = 0;
    memset(m->flip, 0, (size_t)m->s->nc);
    if (m->s->nc == 0)
        return corner;
    ns_system_inputs(m->s, corner, NS_LEFT, m->z);
    if (!ns_control_by_time(m, m->z, m->flip))
        return corner;
    *commanded = 1;
    return ns_control_instant(m, corner, m->flip);
}

/* Right of t: inputs anew, and commands that jump with them. */
static void refresh(ns_flight *f, int corner) {
    ns_march *m = f->m;
    ns_exo_at(f->exo, f->t, f->X + f->s->r);
    if (corner) {
        ns_system_inputs(m->s, f->t, NS_RIGHT, m->z);
        ns_control_by_time(m, m->z, m->due);
        for (int c = 0; c < m->s->nc; c++)
            m->flip[c] |= m->due[c];
    }
}

static int inputs_jump(ns_flight *f) {
    ns_march *m = f->m;
    int jump = 0;
    ns_system_inputs(m->s, f->t, NS_LEFT, m->z_left);
    ns_system_inputs(m->s, f->t, NS_RIGHT, m->z);
    for (int i = 0; i < m->s->nz; i++)
        jump |= m->z[i] != m->z_left[i];
    return jump;
}

static void count(ns_flight *f) {
    const double near = ldexp(f->m->h, -NS_EVENT_RUNG);
    f->m->events++;
    f->crowd = f->t - f->event_t < near ? f->crowd + 1 : 0;
    f->event_t = f->t;
}

/* The event here; *stuck: it is for the scheme. */
static int turn(ns_flight *f, int natural, int *stuck) {
    count(f);
    const int status = f->crowd > NS_PILE ? NS_GUARD : ns_turn(f, natural);
    *stuck = status == NS_GUARD;
    if (!*stuck)
        f->since = f->t;
    return *stuck ? NS_OK : status;
}

static void ground(ns_flight *f) {
    f->grounded = f->t + f->m->h;
    f->crowd = 0;
}

int ns_flight_go(ns_flight *f, double t, ns_until until) {
    ns_march *m = f->m;
    int status = load(f), stuck = 0, broke = 0, commanded = 0;
    if (status != NS_OK) {
        f->grounded = m->live.t + m->h;
        return status == NS_E_MEMORY ? ns_march_fail(m, status) : NS_OK;
    }
    if (m->live.at_event) {
        refresh(f, m->live.jump);
        status = turn(f, !m->live.jump, &stuck);
        if (status == NS_OK && !stuck)
            m->live.at_event = m->live.jump = 0;
        if (until == NS_TO_EVENT)
            t = f->t;
    }
    while (status == NS_OK && !stuck && f->t < t) {
        const double known = next_known(f, t, &commanded);
        status = fly(f, known, &broke);
        if (status != NS_OK)
            break;
        if (broke)
            memset(m->flip, 0, (size_t)m->s->nc);
        const int corner = !broke && !commanded && f->t >= m->corner;
        if (!broke && !commanded && !corner)
            break; /* there */
        const int jump = corner && inputs_jump(f);
        if (until == NS_TO_EVENT && (broke || commanded || jump)) {
            m->live.at_event = 1;
            m->live.jump = jump;
            break;
        }
        refresh(f, corner);
        status = turn(f, broke, &stuck);
        m->live.at_event = stuck;
    }
    if (status != NS_OK)
        return status == NS_E_MEMORY ? ns_march_fail(m, status) : status;
    deposit(f);
    if (stuck)
        ground(f);
    return NS_OK;
}
