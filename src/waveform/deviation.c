/* src/waveform/deviation.c - how far the waveform is from the straight line of a segment, and its integral
 * from the trapezoid below that line. */
#include "waveform_internal.h"

#include <math.h>
#include <string.h>

void ns_waveform_note_size(ns_waveform *w, const double *row) {
    for (int i = 0; i < w->looked; i++) {
        const double size = fabs(row[w->signal[i]]);
        if (size <= w->largest[i])
            continue;
        w->largest[i] = size;
        w->kind_largest[w->kind[i]] = fmax(w->kind_largest[w->kind[i]], size);
        w->stale = 1;
    }
}

/* What values of signal i may be off by: rounding. */
static double noise_of(const ns_waveform *w, int i) {
    return fmax(fmax(w->noise * w->kind_largest[w->kind[i]], w->floor[w->kind[i]]), w->rounding[i]);
}

static void update_tolerances(ns_waveform *w) {
    for (int i = 0; i < w->looked && w->stale; i++) {
        const double allowed = fmax(w->lines * w->largest[i], noise_of(w, i));
        w->per_tolerance[i] = allowed > 0 ? 1 / allowed : 0;
    }
    w->stale = 0;
}

int ns_waveform_differ(ns_waveform *w, const double *a, const double *b) {
    update_tolerances(w);
    for (int i = 0; i < w->looked; i++)
        if (fabs(a[w->signal[i]] - b[w->signal[i]]) * w->per_tolerance[i] > 0.1)
            return 1;
    return 0;
}

/* The largest distance at the probes, as a part of what is allowed; of a parabola, whose middle may lie
 * between them, the largest of all. */
static double distance(ns_waveform *w, const ns_segment *g) {
    const double *a = g->at[0].v, *b = g->at[g->last].v;
    const double t0 = g->at[0].t, length = g->at[g->last].t - t0;
    double most = 0, parabola = 0.25;
    for (int j = 1; j < g->last; j++) {
        const double *v = g->at[j].v, part = (g->at[j].t - t0) / length;
        parabola = fmax(parabola, 4 * part * (1 - part));
        for (int i = 0; i < w->looked; i++) {
            const int at = w->signal[i];
            const double off = fabs(v[at] - a[at] - part * (b[at] - a[at])) * w->per_tolerance[i];
            if (off > most) {
                most = off;
                w->worst = i;
            }
        }
    }
    return most / parabola;
}

/* Integrals over a segment of the absolute value (w->own) and of the distance from the line (w->own_error),
 * by trapezoids between the probes. */
static void integrate(ns_waveform *w, const ns_segment *g) {
    const double *a = g->at[0].v, *b = g->at[g->last].v;
    const double t0 = g->at[0].t, per_length = 1 / (g->at[g->last].t - t0);
    memset(w->own, 0, sizeof *w->own * (size_t)w->looked);
    memset(w->own_error, 0, sizeof *w->own_error * (size_t)w->looked);
    for (int j = 0; j <= g->last; j++) {
        const double *v = g->at[j].v, part = (g->at[j].t - t0) * per_length;
        const double before = j > 0 ? g->at[j - 1].t : t0, after = g->at[j < g->last ? j + 1 : j].t;
        const double weight = 0.5 * (after - before);
        for (int i = 0; i < w->looked; i++) {
            const int at = w->signal[i];
            w->own[i] += weight * fabs(v[at]);
            w->own_error[i] += weight * (v[at] - a[at] - part * (b[at] - a[at]));
        }
    }
}

/* What a segment adds to the distance of integrals beyond half of what its own integral allows; with its
 * sign: over a ring these cancel. */
static double excess(const ns_waveform *w, int i) {
    const double allowed = 0.5 * w->lines * w->own[i], error = w->own_error[i];
    return error > allowed ? error - allowed : error < -allowed ? error + allowed : 0;
}

/* Of the half that is shared out since the last event, what a line of signal i of this length may take: an
 * even part of the 3 / sqrt(lines) lines that a decay takes at best; or what the line would have of its own
 * if the signal were there what it is at the next event: what does not decay to zero needs no even parts.
 * since: the integral since the event; rest: of that half. */
static double shared_out(const ns_waveform *w, int i, double length, double since, double rest) {
    static const double of_rest = 0.2, kept = 0.1;
    const double most = w->lines * since, even = fmin(sqrt(w->lines) / 3 * most, of_rest * rest);
    if (!w->is_first)
        return even;
    const double as_at_end = w->lines * fabs(w->at_end[w->signal[i]]) * length;
    return fmax(even, fmin(as_at_end, of_rest * (rest - kept * most)));
}

/* The distance of integrals since the last event, as a part of what is allowed: half of it by the segment's
 * own integral; the other half, by the integral since the event or while it lasts, is shared out. */
static double integral_distance(ns_waveform *w, const ns_segment *g) {
    const double end = g->at[g->last].t, length = end - g->at[0].t;
    const double time = fmin(1, (w->end - w->event_t) / fmax(end - w->start_t, length));
    double most = 0;
    integrate(w, g);
    for (int i = 0; i < w->looked; i++) {
        const double since = fmax(w->since_event[i] + w->own[i], (w->total[i] + w->own[i]) * time);
        const double rest = fmax(0.5 * w->lines * since - fabs(w->error[i]), 0);
        const double allowed =
            0.5 * w->lines * w->own[i] + shared_out(w, i, length, since, rest) + noise_of(w, i) * length;
        const double error = fabs(w->own_error[i]);
        if (error > most * allowed) {
            most = allowed > 0 ? error / allowed : INFINITY;
            w->worst = i;
        }
    }
    return most;
}

/* By how much the trapezoid of the squares of a and b is larger than the integral of the square of the line.
 */
static double square_error(double a, double b, double length) {
    return (b - a) * (b - a) / 6 * length;
}

static double square_between(double a, double b) {
    return (a * a + a * b + b * b) / 3;
}

/* What a segment may add to that by the squares in the rest of its stretch, which along a ramp from zero add
 * up to twice its own, or by the run's, whichever is larger. */
static double square_allowed(const ns_waveform *w, int i, double a, double t, double length) {
    const double mean = t > w->start_t ? w->square[i] / (t - w->start_t) : 0;
    return 0.25 * w->squares * length * fmax(square_between(fabs(a), w->end_values[w->signal[i]]), mean);
}

/* The distance of the integrals of squares, as a part of what is allowed; a ramp that takes no time borrows
 * from the run.
 */
static double square_distance(ns_waveform *w, const ns_segment *g) {
    static const double of_rest = 0.1;
    const double *a = g->at[0].v, *b = g->at[g->last].v, t = g->at[0].t, length = g->at[g->last].t - t;
    double most = 0;
    for (int i = 0; i < w->looked; i++) {
        const int at = w->signal[i];
        const double noise = noise_of(w, i);
        const double rest = fmax(0.5 * w->squares * w->square[i] - w->square_error[i], 0);
        const double allowed =
            square_allowed(w, i, a[at], t, length) + of_rest * rest + noise * noise * length;
        const double error = square_error(a[at], b[at], length);
        if (error > most * allowed) {
            most = allowed > 0 ? error / allowed : INFINITY;
            w->worst = i;
        }
    }
    return most;
}

double ns_waveform_deviation(ns_waveform *w, const ns_segment *g) {
    double off = 0;
    update_tolerances(w);
    if (g->last >= 2)
        off = distance(w, g);
    if (g->last >= 2 && off <= 1)
        off = fmax(off, integral_distance(w, g));
    w->squares_decide = 0;
    if (!(w->squares > 0 && off <= 1))
        return off;
    const double squares = square_distance(w, g);
    w->squares_decide = squares > off;
    return fmax(off, squares);
}

/* Where the parabola through a, v (at part of the way) and b turns, as a part of the way; 1: nowhere, or that
 * is not seen: it comes out by less than `seen` beyond both ends. */
static double turn(double a, double v, double b, double part, double seen) {
    const double bend = (v - a - part * (b - a)) / (part * (part - 1)); /* a + (b-a) s + bend s (s-1) */
    const double at = 0.5 - 0.5 * (b - a) / bend;
    if (!(at > 0 && at < 1))
        return 1;
    const double top = a + (b - a) * at + bend * at * (at - 1), near = fabs(top - a) < fabs(top - b) ? a : b;
    return fabs(top - near) > seen ? at : 1;
}

double ns_waveform_first_turn(ns_waveform *w, const ns_segment *g) {
    static const double seen = 0.019; /* of what a waveform may be off; a parabola is not all of it */
    const double t0 = g->at[0].t, length = g->at[g->last].t - t0;
    double first = 1;
    int middle = 1;
    if (g->last < 2)
        return INFINITY;
    while (middle + 1 < g->last && g->at[middle + 1].t - t0 <= 0.5 * length)
        middle++;
    const double *a = g->at[0].v, *v = g->at[middle].v, *b = g->at[g->last].v;
    const double part = (g->at[middle].t - t0) / length;
    update_tolerances(w);
    for (int i = 0; i < w->looked; i++) {
        const int at = w->signal[i];
        if (w->per_tolerance[i] > 0)
            first = fmin(first,
                         turn(a[at], v[at], b[at], part, fmax(seen / w->per_tolerance[i], w->rounding[i])));
    }
    return first < 1 && first * length > w->closest ? t0 + first * length : INFINITY;
}

void ns_waveform_begin_integrals(ns_waveform *w, double t) {
    w->event_t = t;
    memset(w->since_event, 0, sizeof *w->since_event * (size_t)w->looked);
    memset(w->error, 0, sizeof *w->error * (size_t)w->looked);
}

void ns_waveform_add_integrals(ns_waveform *w, const ns_segment *g, double sign) {
    integrate(w, g);
    for (int i = 0; i < w->looked; i++) {
        w->since_event[i] += sign * w->own[i];
        w->error[i] += sign * excess(w, i);
    }
}

static void note_square(ns_waveform *w, int i, double a, double b, double t, double length) {
    w->square_error[i] += fmax(square_error(a, b, length) - square_allowed(w, i, a, t, length), 0);
    w->square[i] += square_between(a, b) * length;
}

void ns_waveform_note_given(ns_waveform *w, const ns_segment *g) {
    const double *a = g->at[0].v, *b = g->at[g->last].v, length = g->at[g->last].t - g->at[0].t;
    w->by_squares += w->squares_decide;
    integrate(w, g);
    for (int i = 0; i < w->looked; i++) {
        const double slope = (b[w->signal[i]] - a[w->signal[i]]) / length;
        w->turned[i] += !g->from_event && slope * w->slope[i] < 0;
        w->slope[i] = g->jumps ? 0 : slope;
        note_square(w, i, a[w->signal[i]], b[w->signal[i]], g->at[0].t, length);
        w->total[i] += w->own[i];
    }
}
