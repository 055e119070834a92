/* src/system/signal.c - values and corners of sources as functions of time.
 *
 * PULSE and PWL are both broken lines: points (t[i], v[i]), the value held before the first and after the
 * last, the points from `from` on repeated with a period.  Point i of repetition k lies at
 *     time_of_point(k,i) = origin + (k period + t[i]),
 * computed from k, so that nothing drifts.  Times within `slack` of a corner, a few roundings, count as the
 * corner itself: what a caller computes to be a corner is found to be one.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "signal_internal.h"

/* From (t0,v0) to (t1,v1), held outside. */
static double between(double t, double t0, double v0, double t1, double v1) {
    if (t <= t0) {
        return v0;
    }
    return t >= t1 ? v1 : v0 + (v1 - v0) * ((t - t0) / (t1 - t0));
}

/* From here on a point is at the end of a period. */
static double end_of(double period) {
    return isinf(period) ? NAN : period * (1 - 8 * DBL_EPSILON);
}

/* SPICE's PULSE as a broken line; a pulse longer than its period is cut off there and jumps back. */
static ns_line pulse_line(const ns_signal *s, ns_pulse_points *p) {
    double v1 = s->u.pulse.v1, v2 = s->u.pulse.v2, per = s->u.pulse.per;
    double top = s->u.pulse.tr, fall = top + s->u.pulse.pw, end = fall + s->u.pulse.tf;
    ns_line g = {4, p->t, p->v, s->u.pulse.td, per, 0, INFINITY, 0, end_of(per)};
    if (s->u.pulse.cycles > 0) {
        g.cycles = s->u.pulse.cycles;
    }
    *p = (ns_pulse_points){{0, top, fall, end, per}, {v1, v2, v2, v1, v1}};
    if (end > per * (1 + 8 * DBL_EPSILON)) {
        double cut = per <= top ? between(per, 0, v1, top, v2) : between(per, fall, v2, end, v1);
        g.n = 5;
        for (int i = 1; i < 4; i++) {
            if (p->t[i] > per) {
                p->t[i] = per;
                p->v[i] = cut;
            }
        }
    }
    return g;
}

static ns_line pwl_line(const ns_signal *s) {
    int n = s->u.pwl.n;
    const double *t = s->u.pwl.t;
    ns_line g = {n, t, s->u.pwl.v, s->u.pwl.td, INFINITY, 0, INFINITY, t[0], NAN};
    if (!isnan(s->u.pwl.repeat)) {
        g.period = t[n - 1] - s->u.pwl.repeat;
        while (g.from + 1 < n && t[g.from + 1] <= s->u.pwl.repeat) {
            g.from++; /* the last of equal times: what holds to the right of the jump */
        }
        g.first = t[g.from];
        g.last = end_of(g.period);
    }
    return g;
}

/* Where repetition k and the next begin, less the origin. */
typedef struct turn {
    double here, next;
} turn;

static turn turn_of(const ns_line *g, double k) {
    if (isinf(g->period)) {
        return (turn){0, 0};
    }
    return (turn){k * g->period, (k + 1) * g->period + g->first};
}

/* A point at the end of a period is the first of the next one, to the last bit. */
static double time_of_point(const ns_line *g, turn r, int i) {
    double t = g->t[i];
    return g->origin + (t - g->first >= g->last ? r.next : r.here + t);
}

/* floor(x), which may be a call. */
static double floor_of(double x) {
    if (!(fabs(x) < 1e15)) {
        return floor(x);
    }
    double cut = (double)(long long)x;
    return cut > x ? cut - 1 : cut;
}

/* The repetition that t lies in. */
static double repetition(const ns_line *g, double t) {
    double k, most = g->cycles - 1;
    if (isinf(g->period)) {
        return 0;
    }
    k = floor_of((t - g->origin - g->first) / g->period);
    if (g->origin + (k * g->period + g->first) > t) {
        k -= 1;
    } else if (g->origin + ((k + 1) * g->period + g->first) <= t) {
        k += 1;
    }
    k = k < most ? k : most;
    return k > 0 ? k : 0;
}

/* The last point of repetition k at or before t, -1 if there is none. */
static int point_before(const ns_line *g, double k, turn r, double t) {
    int low = k > 0 ? g->from : 0, high = g->n;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (time_of_point(g, r, middle) <= t) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low - 1;
}

static double line_value(const ns_line *g, double t, ns_side side) {
    double d = ns_system_signal_time_error(t, g->origin), beside = side == NS_LEFT ? t - d : t + d;
    double k = repetition(g, beside);
    turn r = turn_of(g, k);
    int i = point_before(g, k, r, beside);
    if (i < 0) {
        return g->v[0];
    }
    if (i + 1 == g->n) {
        return g->v[i];
    }
    return between(t, time_of_point(g, r, i), g->v[i], time_of_point(g, r, i + 1), g->v[i + 1]);
}

static double line_next(const ns_line *g, double t) {
    double after = t + ns_system_signal_time_error(t, g->origin), k = repetition(g, after);
    int i = point_before(g, k, turn_of(g, k), after);
    for (int tries = 0; tries < 4; tries++) { /* more than two only where a period is within rounding of 0 */
        double corner;
        if (++i >= g->n) {
            i = g->from;
            k += 1;
        }
        if (k > 0 && (isinf(g->period) || k >= g->cycles)) {
            return INFINITY;
        }
        corner = time_of_point(g, turn_of(g, k), i);
        if (corner > after) {
            return corner;
        }
    }
    return t + 2 * ns_system_signal_time_error(t, g->origin); /* periods too short to tell apart */
}

/* 1 if t is beyond all points of a PWL that is not repeated: it stays at the last one. */
static int is_over(const ns_signal *s, double t) {
    const double end = s->u.pwl.td + s->u.pwl.t[s->u.pwl.n - 1];
    return isnan(s->u.pwl.repeat) && t - ns_system_signal_time_error(t, s->u.pwl.td) >= end;
}

static double sin_value(const ns_signal *s, double t) {
    static const double pi = 3.14159265358979323846;
    double since = fmax(0, t - s->u.sin.td), turns = s->u.sin.freq * since + s->u.sin.phase / 360;
    double wave = s->u.sin.va * sin(2 * pi * (turns - floor(turns)));
    if (s->u.sin.theta != 0) { /* not inf * 0 */
        wave *= exp(-since * s->u.sin.theta);
    }
    return s->u.sin.vo + wave;
}

/* As SPICE: nothing before td1, even where td2 < td1 (then a jump at td1). */
static double exp_value(const ns_signal *s, double t, ns_side side) {
    double v1 = s->u.exp.v1, v2 = s->u.exp.v2, d = ns_system_signal_time_error(t, s->u.exp.td1), value = v1;
    if ((side == NS_LEFT ? t - d : t + d) < s->u.exp.td1) {
        return v1;
    }
    value -= (v2 - v1) * expm1(-fmax(0, t - s->u.exp.td1) / s->u.exp.tau1);
    if (t > s->u.exp.td2) {
        value -= (v1 - v2) * expm1(-(t - s->u.exp.td2) / s->u.exp.tau2);
    }
    return value;
}

/* The first of two corners that lies after t. */
static double first_after(double t, double a, double b) {
    double c = fmin(a, b);
    if (c > t + ns_system_signal_time_error(t, c)) {
        return c;
    }
    c = fmax(a, b);
    return c > t + ns_system_signal_time_error(t, c) ? c : INFINITY;
}

/* 1 if t is far from all corners of a pulse that repeats for ever: *value, as line_value() has it to the last
 * bit. */
static int is_inside_piece(const ns_signal *s, double t, double *value) {
    const double per = s->u.pulse.per, td = s->u.pulse.td, since = t - td, margin = 1e-6 * per;
    const double v1 = s->u.pulse.v1, v2 = s->u.pulse.v2;
    const double top = s->u.pulse.tr, fall = top + s->u.pulse.pw, end = fall + s->u.pulse.tf;
    if (!(since > 0 && fabs(t) < 1e8 * per && end <= per && s->u.pulse.cycles == 0 && per < INFINITY)) {
        return 0;
    }
    const double here = (double)(long long)(since / per) * per, at = since - here;
    if (at < margin || at > per - margin || fabs(at - top) < margin || fabs(at - fall) < margin ||
        fabs(at - end) < margin) {
        return 0;
    }
    *value = at < top ? between(t, td + here, v1, td + (here + top), v2)
                      : between(t, td + (here + fall), v2, td + (here + end), v1);
    return 1;
}

double ns_signal_value(const ns_signal *s, double t, ns_side side) {
    ns_pulse_points p;
    ns_line g;
    double value;
    switch (s ? (int)s->kind : -1) {
    case NS_DC:
        return s->u.dc;
    case NS_PULSE:
        if (is_inside_piece(s, t, &value)) {
            return value;
        }
        g = pulse_line(s, &p);
        return line_value(&g, t, side);
    case NS_PWL:
        if (is_over(s, t)) {
            return s->u.pwl.v[s->u.pwl.n - 1];
        }
        g = pwl_line(s);
        return line_value(&g, t, side);
    case NS_SIN:
        return sin_value(s, t);
    case NS_EXP:
        return exp_value(s, t, side);
    default:
        return NAN;
    }
}

double ns_signal_next_corner(const ns_signal *s, double t) {
    ns_pulse_points p;
    ns_line g;
    switch (s && !isnan(t) ? (int)s->kind : -1) {
    case NS_PULSE:
        g = pulse_line(s, &p);
        return line_next(&g, t);
    case NS_PWL:
        g = pwl_line(s);
        return line_next(&g, t);
    case NS_SIN:
        return first_after(t, s->u.sin.td, s->u.sin.td);
    case NS_EXP:
        return first_after(t, s->u.exp.td1, s->u.exp.td2);
    default:
        return INFINITY;
    }
}

int ns_system_signal_line(const ns_signal *s, ns_pulse_points *p, ns_line *g) {
    if (s->kind == NS_PULSE)
        *g = pulse_line(s, p);
    else if (s->kind == NS_PWL)
        *g = pwl_line(s);
    return s->kind == NS_PULSE || s->kind == NS_PWL;
}

int ns_signal_is_linear(const ns_signal *s) {
    return s && (s->kind == NS_DC || s->kind == NS_PULSE || s->kind == NS_PWL);
}

int ns_system_signal_copy(const ns_signal *from, ns_signal *to) {
    size_t bytes;
    double *t, *v;
    if (from->kind != NS_PWL) {
        *to = *from;
        return NS_OK;
    }
    bytes = (size_t)from->u.pwl.n * sizeof(double);
    t = malloc(bytes);
    v = malloc(bytes);
    if (!t || !v) {
        free(t);
        free(v);
        return NS_E_MEMORY;
    }
    memcpy(t, from->u.pwl.t, bytes);
    memcpy(v, from->u.pwl.v, bytes);
    *to = *from;
    to->u.pwl.t = t;
    to->u.pwl.v = v;
    return NS_OK;
}

void ns_system_signal_release(ns_signal *s) {
    if (s->kind == NS_PWL) {
        free((void *)s->u.pwl.t);
        free((void *)s->u.pwl.v);
    }
    memset(s, 0, sizeof *s);
    s->kind = NS_DC;
}
