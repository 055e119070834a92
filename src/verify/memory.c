/* src/verify/memory.c - whether a switch with hysteresis is closed between its thresholds: by what happened
 * before.
 *
 * Where sources alone control it, that is known at every instant, from the corners of these sources.  Where
 * the state does, a switch that changes alone, at an instant at which no source jumps, does so at a
 * threshold.
 */
#include "verify_internal.h"

#include <math.h>

/* Corners that are passed in one go; after more than these nothing is known. */
enum { MOST_CORNERS = 4096 };

/* --- by sources --- */

/* Of their inputs; the constant counts too. */
static double control_at(const ns_verify *v, int c, double t, ns_side side) {
    const ns_verify_rows *r = &v->control;
    const int first = v->s->n + v->s->m;
    double sum = 0;
    for (int k = r->start[c]; k < r->start[c + 1]; k++) {
        const int input = r->column[k] - first;
        sum += r->value[k] * (input < v->s->nz ? ns_signal_value(&v->s->z[input], t, side) : 1);
    }
    return sum;
}

static double next_corner(const ns_verify *v, int c, double t) {
    const ns_verify_rows *r = &v->control;
    double next = INFINITY;
    for (int k = r->start[c]; k < r->start[c + 1]; k++) {
        const int input = r->column[k] - v->s->n - v->s->m;
        if (input < v->s->nz)
            next = fmin(next, ns_signal_next_corner(&v->s->z[input], t));
    }
    return next;
}

static int is_by_sources(const ns_verify *v, int c) {
    const ns_verify_rows *r = &v->control;
    const int first = v->s->n + v->s->m;
    for (int k = r->start[c]; k < r->start[c + 1]; k++) {
        const int input = r->column[k] - first;
        if (input < 0 || (input < v->s->nz && !ns_signal_is_linear(&v->s->z[input])))
            return 0;
    }
    return 1;
}

/* A control that comes near a threshold, and not clearly beyond it, leaves open what it does. */
static void learn(const ns_verify *v, int c, double g, ns_verify_memory *m) {
    const ns_command *k = &v->s->command[c];
    const double off = ns_verify_sizes_control_off(v, c);
    if (g > k->on + off)
        m->closed = 1;
    else if (g < k->off - off)
        m->closed = 0;
    else if ((g > k->on - off && m->closed == 0) || (g < k->off + off && m->closed == 1))
        m->closed = -1;
}

void ns_verify_memory_reset(ns_verify *v) {
    v->by_states = 0;
    for (int c = 0; c < v->s->nc; c++) {
        const int remembers = v->s->command[c].on > v->s->command[c].off, known = is_by_sources(v, c);
        v->memory[c] = (ns_verify_memory){remembers && known, -1, -INFINITY, -INFINITY};
        if (remembers && !known)
            v->by_state[v->by_states++] = c;
    }
}

void ns_verify_start_switches(ns_verify *v, double t, const unsigned char *closed) {
    for (int c = 0; c < v->s->nc; c++) {
        ns_verify_memory *m = &v->memory[c];
        if (!m->is_known_by_sources)
            continue;
        m->closed = closed ? closed[c] != 0 : v->s->command[c].closed != 0;
        m->t = t;
        m->corner = next_corner(v, c, t);
        learn(v, c, control_at(v, c, t, NS_RIGHT), m);
    }
}

int ns_verify_memory_at(ns_verify *v, int c, double g) {
    ns_verify_memory *m = &v->memory[c];
    if (!m->is_known_by_sources)
        return -1;
    if (v->t < m->t || m->corner == -INFINITY) { /* a trial that was dropped went further */
        m->closed = -1;
        m->corner = next_corner(v, c, v->t);
    }
    for (int k = 0; m->corner < v->t; k++) {
        if (k == MOST_CORNERS) {
            m->closed = -1;
            m->corner = next_corner(v, c, v->t);
            break;
        }
        learn(v, c, control_at(v, c, m->corner, NS_LEFT), m);
        learn(v, c, control_at(v, c, m->corner, NS_RIGHT), m);
        m->corner = next_corner(v, c, m->corner);
    }
    m->t = v->t;
    learn(v, c, g, m);
    return m->closed;
}

/* --- by the state --- */

/* 1: closed; 0: open; -1: it carries and blocks nothing. */
static int state_in(const ns_verify *v, int j, const double *u) {
    const double lambda = fabs(u[v->s->n + j]), y = fabs(ns_verify_row(&v->output, j, u).sum);
    const int carries = lambda > ns_verify_sizes_lambda_off(v, j), blocks = y > ns_verify_sizes_y_off(v, j);
    return carries == blocks ? -1 : carries;
}

static int sources_stay(const ns_verify *v) {
    const int first = v->s->n + v->s->m;
    int stay = 1;
    for (int k = first; k < first + v->s->nz; k++)
        stay &= v->u[k] == v->u_left[k];
    return stay;
}

/* By how much a control is short of the threshold at which its switch changes, of what it may be off by. */
static double short_of(const ns_verify *v, int c, int closes) {
    const ns_command *k = &v->s->command[c];
    const double g = ns_verify_row(&v->control, c, v->u_left).sum;
    const double spread = v->spreads ? 2 * ns_verify_row(&v->control, c, v->spread).size : 0;
    return (closes ? k->on - g : g - k->off) / (ns_verify_sizes_control_off(v, c) + spread);
}

/* The same for a switch that carries and blocks nothing on one side: it may have changed.  Where that is the
 * left side, it did only if its control is at a threshold, not beyond. */
static double may_be_short_of(const ns_verify *v, int c, int before) {
    if (before >= 0)
        return short_of(v, c, !before);
    const double on = fabs(short_of(v, c, 1)), off = fabs(short_of(v, c, 0));
    return on < off ? on : off;
}

/* Of all switches that changed, how far the nearest one is from its threshold; *pair: -1: none changed. */
static double least_short(const ns_verify *v, int *pair) {
    double least = INFINITY, least_known = INFINITY;
    *pair = -1;
    for (int c = 0; c < v->s->nc; c++) {
        const int j = v->s->command[c].pair, before = state_in(v, j, v->u_left), after = state_in(v, j, v->u);
        if (before == after && before >= 0)
            continue;
        const int is_known = before >= 0 && after >= 0;
        const double lacks = is_known ? short_of(v, c, after) : may_be_short_of(v, c, before);
        if (is_known && lacks < least_known) {
            *pair = j;
            least_known = lacks;
        }
        least = fmin(least, lacks);
    }
    return least;
}

void ns_verify_memory_event(ns_verify *v, ns_verify_finding *worst) {
    int pair;
    if (v->has_w_left || v->t != v->t_left || !sources_stay(v))
        return;
    double least = least_short(v, &pair);
    if (pair >= 0 && least > 1) { /* rare: a source on an edge of some roundings of t */
        v->spreads = ns_verify_inputs_spread(v, v->t);
        least = v->spreads ? least_short(v, &pair) : least;
        v->spreads = 0;
    }
    if (pair >= 0) /* one of them is the first: its control is there */
        ns_verify_note(worst, NS_VERIFY_COMMAND, pair, -1, least);
}

/* Less than memory_event() asks, of one switch: its control, of unknowns at the left side. */
static int changes_short_of(const ns_verify *v, int c) {
    const ns_command *k = &v->s->command[c];
    const int j = k->pair, known = v->s->n + v->s->m;
    const double off = ns_verify_sizes_lambda_off(v, j);
    const int closes = fabs(v->u[v->s->n + j]) > off;
    if (closes == (fabs(v->u_left[v->s->n + j]) > off))
        return 0;
    const ns_verify_rows *r = &v->control;
    double g = 0;
    for (int i = r->start[c]; i < r->start[c + 1]; i++)
        g += r->value[i] * (r->column[i] < known ? v->u_left : v->u)[r->column[i]];
    return (closes ? k->on - g : g - k->off) > ns_verify_sizes_control_off(v, c);
}

int ns_verify_memory_stays(const ns_verify *v) {
    int stays = 1;
    for (int k = 0; k < v->by_states && stays; k++)
        stays = !changes_short_of(v, v->by_state[k]);
    return stays;
}
