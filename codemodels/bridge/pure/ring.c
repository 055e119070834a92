/* bridge/pure/ring.c - the period of a signal, and the elements whose energy swings with it. */
#include "ring.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct ns_ring {
    int n;
    double *now, *from;    /* n: the last point; where the period begins */
    double *cosine, *sine; /* n: integrals of x - from, times that of the phase; then amplitudes */
    double t, signal;      /* of the last point */
    int points, direction; /* added; 1: the signal rises, -1: it falls, 0: not known */
    double least, most;    /* of the signal */
    int turns;             /* peaks and valleys since the period began */
    double from_t, period; /* s; the period before the present one, 0: none */
    int is_known;
};

int ns_bridge_ring_create(int n, ns_ring **out) {
    const size_t size = (size_t)n;
    ns_ring *r = *out = calloc(1, sizeof *r);
    if (!r)
        return NS_E_MEMORY;
    r->n = n;
    r->now = calloc(4 * size + 1, sizeof *r->now);
    if (!r->now) {
        free(r);
        *out = NULL;
        return NS_E_MEMORY;
    }
    r->from = r->now + size;
    r->cosine = r->from + size;
    r->sine = r->cosine + size;
    return NS_OK;
}

void ns_bridge_ring_free(ns_ring *r) {
    if (r)
        free(r->now);
    free(r);
}

double ns_bridge_ring_period(const ns_ring *r) {
    return r->is_known ? r->period : 0.0;
}

static double omega_of(const ns_ring *r) {
    return 2.0 * 3.14159265358979323846 / r->period;
}

/* A period of this length (0: not known) begins at the last point. */
static void begin_period(ns_ring *r, double period) {
    const size_t size = (size_t)r->n * sizeof *r->now;
    memcpy(r->from, r->now, size);
    memset(r->cosine, 0, size);
    memset(r->sine, 0, size);
    r->from_t = r->t;
    r->period = period;
    r->turns = 0;
}

/* Takes out the line to the last point, and makes amplitudes of the integrals. */
static void end_period(ns_ring *r) {
    const double w = omega_of(r), length = r->t - r->from_t, c = cos(w * length), s = sin(w * length);
    const double line_cosine = s / w + (c - 1.0) / (w * w * length);
    const double line_sine = s / (w * w * length) - c / w;
    for (int k = 0; k < r->n; k++) {
        const double rise = r->now[k] - r->from[k];
        r->cosine[k] = (r->cosine[k] - rise * line_cosine) * 2.0 / length;
        r->sine[k] = (r->sine[k] - rise * line_sine) * 2.0 / length;
    }
    r->period = length;
    r->is_known = 1;
}

/* The last point is a peak or a valley. */
static void turn(ns_ring *r) {
    static const double alike = 0.05;
    const double length = r->t - r->from_t;
    if (++r->turns < 2)
        return;
    if (fabs(length - r->period) <= alike * r->period)
        end_period(r);
    else
        begin_period(r, length);
}

/* The trapezoids between the last point and one at t. */
static void integrate(ns_ring *r, double t, const double *x) {
    const double w = omega_of(r), before = w * (r->t - r->from_t), after = w * (t - r->from_t);
    const double half = 0.5 * (t - r->t);
    const double c0 = half * cos(before), s0 = half * sin(before), c1 = half * cos(after),
                 s1 = half * sin(after);
    for (int k = 0; k < r->n; k++) {
        const double v0 = r->now[k] - r->from[k], v1 = x[k] - r->from[k];
        r->cosine[k] += c0 * v0 + c1 * v1;
        r->sine[k] += s0 * v0 + s1 * v1;
    }
}

/* 1 if the signal turns at the last point, when it is this at the next one. */
static int turns_before(ns_ring *r, double signal) {
    static const double rounding = 1e-6; /* of all its way: no direction */
    const double rise = signal - r->signal;
    r->least = fmin(r->least, signal);
    r->most = fmax(r->most, signal);
    if (fabs(rise) <= rounding * (r->most - r->least))
        return 0;
    const int direction = rise > 0.0 ? 1 : -1, before = r->direction;
    r->direction = direction;
    return before == -direction;
}

void ns_bridge_ring_add(ns_ring *r, double t, double signal, const double *x) {
    if (r->is_known)
        return;
    if (r->points++ == 0)
        r->least = r->most = signal;
    else if (turns_before(r, signal))
        turn(r);
    if (r->is_known)
        return;
    if (r->period > 0.0)
        integrate(r, t, x);
    memcpy(r->now, x, (size_t)r->n * sizeof *x);
    r->t = t;
    r->signal = signal;
}

/* --- elements --- */

static int is_inductor(const ns_circuit *c, int id) {
    return ns_circuit_current_unknown(c, id) >= 0;
}

/* In a ring the inductors together swing by as much as the capacitors. */
static int is_ring(const ns_circuit *c, const double *joule) {
    static const double alike = 2.0;
    double inductors = 0.0, capacitors = 0.0;
    for (int id = 0; id < ns_circuit_count(c); id++)
        *(is_inductor(c, id) ? &inductors : &capacitors) += joule[id];
    return inductors > 0.0 && inductors <= alike * capacitors && capacitors <= alike * inductors;
}

/* The names of the elements that swing most, down to a part of the largest. */
static void name_largest(const ns_circuit *c, double *joule, char *line, size_t size) {
    enum { NAMES = 3 };
    static const double part = 0.1;
    double largest = 0.0;
    for (int k = 0; k < NAMES; k++) {
        int most = 0;
        for (int id = 1; id < ns_circuit_count(c); id++)
            most = joule[id] > joule[most] ? id : most;
        largest = fmax(largest, joule[most]);
        if (!(joule[most] > part * largest))
            return;
        const size_t used = strlen(line);
        const int comma = snprintf(line + used, size - used, "%s", k > 0 ? ", " : "");
        if (used + (size_t)comma < size)
            ns_circuit_name_element(c, most, line + used + comma, size - used - (size_t)comma);
        joule[most] = 0.0;
    }
}

int ns_bridge_ring_elements(const ns_ring *r, const ns_circuit *c, char *line, size_t size) {
    const int count = ns_circuit_count(c);
    double *joule = calloc(2 * (size_t)count + 1, sizeof *joule);
    *line = '\0';
    if (!joule)
        return NS_E_MEMORY;
    int status = ns_circuit_stored(c, r->cosine, joule, NULL);
    status = status ? status : ns_circuit_stored(c, r->sine, joule + count, NULL);
    for (int id = 0; id < count; id++)
        joule[id] += joule[count + id];
    if (!status && r->is_known && is_ring(c, joule))
        name_largest(c, joule, line, size);
    free(joule);
    return status;
}
