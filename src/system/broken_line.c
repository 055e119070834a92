/* src/system/broken_line.c - a broken line piece by piece, and walking along it. */
#include "broken_line.h"

#include <math.h>
#include <stdlib.h>

/* From point i of g to the next; a slope too steep for a number is a jump. */
static ns_line_piece piece_from_point(const ns_line *g, int i) {
    ns_line_piece p = {g->t[i], g->v[i], 0, g->v[i]};
    const double slope = i + 1 < g->n ? (g->v[i + 1] - g->v[i]) / (g->t[i + 1] - g->t[i]) : 0;
    if (slope != 0 && isfinite(slope)) {
        p.slope = slope;
        p.end = g->v[i + 1];
    }
    return p;
}

/* Of points at the same time the last counts; one at the end of the period is the first of the next. */
static void fill_pieces(const ns_line *g, ns_broken_line *p) {
    for (int i = 0; i < g->n && !(g->t[i] - g->first >= g->last) && isfinite(g->t[i]); i++) {
        if (i + 1 < g->n && g->t[i + 1] == g->t[i])
            continue;
        p->piece[++p->n] = piece_from_point(g, i);
        if (p->from == 0 && g->t[i] >= g->first)
            p->from = p->n;
    }
    p->piece[0] = (ns_line_piece){p->piece[1].t, g->v[0], 0, g->v[0]};
    p->piece[p->n + 1] = (ns_line_piece){g->first, g->v[g->n - 1], 0, g->v[g->n - 1]};
}

/* Whether anything happens in a repetition. */
static int has_events(const ns_broken_line *p) {
    for (int i = p->from; i <= p->n; i++) {
        const ns_line_piece *a = &p->piece[i], *b = &p->piece[i < p->n ? i + 1 : p->from];
        if (a->slope != b->slope || a->end != b->v)
            return 1;
    }
    return 0;
}

int ns_system_line_create(const ns_signal *s, ns_broken_line *p) {
    const double level = s->kind == NS_DC ? s->u.dc : 0, start = 0;
    ns_pulse_points points;
    ns_line g = {1, &start, &level, 0, INFINITY, 0, INFINITY, 0, NAN};
    (void)ns_system_signal_line(s, &points, &g);
    *p = (ns_broken_line){.origin = g.origin, .cycles = g.cycles};
    p->piece = calloc((size_t)g.n + 2, sizeof *p->piece);
    if (!p->piece)
        return NS_E_MEMORY;
    fill_pieces(&g, p);
    if (isfinite(g.period) && has_events(p))
        p->period = g.period;
    return NS_OK;
}

static double shortest_piece(const ns_signal *s) {
    ns_pulse_points points;
    ns_line g;
    double least = INFINITY;
    if (!ns_system_signal_line(s, &points, &g))
        return least;
    for (int i = 1; i < g.n; i++) {
        const double length = g.t[i] - g.t[i - 1];
        if (length > 2 * ns_system_signal_time_error(g.t[i], g.origin))
            least = fmin(least, length);
    }
    return least;
}

double ns_system_lines_shortest(int count, const ns_signal *s) {
    double least = INFINITY;
    for (int k = 0; k < count; k++)
        least = fmin(least, shortest_piece(&s[k]));
    return least;
}

void ns_system_line_free(ns_broken_line *p) {
    free(p->piece);
    p->piece = NULL;
}

/* Where piece i of repetition k begins. */
static double start_of_piece(const ns_broken_line *p, double k, int i) {
    return p->origin + (k * p->period + p->piece[i].t);
}

int ns_system_line_following(const ns_line_cursor *r, double *k) {
    const ns_broken_line *p = r->line;
    *k = r->k;
    if (r->i < p->n)
        return r->i + 1;
    if (r->i > p->n || !(p->period > 0))
        return -1;
    *k += 1;
    return *k < p->cycles ? p->from : p->n + 1;
}

static void find_next(ns_line_cursor *r) {
    double k;
    const int i = ns_system_line_following(r, &k);
    r->next = i < 0 ? INFINITY : start_of_piece(r->line, k, i);
}

/* To the next piece; there must be one. */
static void step_to_next(ns_line_cursor *r) {
    r->i = ns_system_line_following(r, &r->k);
    r->t = r->next;
    find_next(r);
}

void ns_system_line_skip(ns_line_cursor *r, double repetitions) {
    r->k += repetitions;
    r->t = start_of_piece(r->line, r->k, r->i);
    find_next(r);
}

/* The repetition that t lies in. */
static double repetition(const ns_broken_line *p, double t) {
    if (!(p->period > 0))
        return 0;
    double k = floor((t - p->origin - p->piece[p->from].t) / p->period);
    if (start_of_piece(p, k, p->from) > t)
        k -= 1;
    else if (start_of_piece(p, k + 1, p->from) <= t)
        k += 1;
    return fmax(0, fmin(k, p->cycles));
}

void ns_system_line_seek(ns_line_cursor *r, double t) {
    const ns_broken_line *p = r->line;
    r->k = repetition(p, t);
    int low = r->k > 0 ? p->from : 0, high = p->n;
    if (r->k >= p->cycles)
        low = high = p->n + 1;
    while (low < high) {
        const int middle = low + (high - low + 1) / 2;
        if (start_of_piece(p, r->k, middle) <= t)
            low = middle;
        else
            high = middle - 1;
    }
    r->i = low;
    r->t = start_of_piece(p, r->k, low);
    find_next(r);
    if (r->next <= t) /* periods too short to tell apart */
        r->next = t + 2 * ns_system_signal_time_error(t, p->origin);
}

void ns_system_line_pass(ns_line_cursor *r, double t) {
    for (int steps = 0; r->next <= t; steps++) {
        if (steps > 2 * r->line->n + 2) {
            ns_system_line_seek(r, t);
            return;
        }
        step_to_next(r);
    }
}
