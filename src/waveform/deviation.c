/* src/waveform/deviation.c - how far the waveform is from the straight line of a segment, and its integral
 * from the trapezoid below that line.
 *
 * The values that are looked at lie one after another in a row (ns_waveform_seen()), and so do all numbers
 * about them, with zeros to the next multiple of NS_WIDE behind the last: loops take NS_WIDE at once. */
#include "linalg/simd.h"
#include "waveform_internal.h"

#include <math.h>
#include <string.h>

/* What values of signal i may be off by: rounding. */
static double noise_of(const ns_waveform *w, int i) {
    return ns_higher(ns_higher(w->noise * w->kind_largest[w->kind[i]], w->floor[w->kind[i]]), w->rounding[i]);
}

static void update_tolerances(ns_waveform *w) {
    for (int i = 0; i < w->looked && w->stale; i++) {
        const double allowed = ns_higher(w->lines * w->largest[i], noise_of(w, i));
        w->per_tolerance[i] = allowed > 0 ? 1 / allowed : 0;
    }
    w->stale = 0;
}

int ns_waveform_differ(ns_waveform *w, const double *a, const double *b) {
    const double *left = ns_waveform_seen(w, a), *right = ns_waveform_seen(w, b);
    update_tolerances(w);
    for (int i = 0; i < w->looked; i++)
        if (fabs(left[i] - right[i]) * w->per_tolerance[i] > 0.1)
            return 1;
    return 0;
}

/* The signal of which off (NS_WIDE, from signal i on) is the largest of all, if that is above *most. */
ALWAYS_INLINE void take_most(ns_waveform *w, int i, const double *off, double *most) {
    if (NS_WIDE_BELOW_OR_AT(CONST_WIDE(off, 0), NS_WIDE_OF(*most)))
        return;
    for (int k = 0; k < NS_WIDE; k++)
        if (off[k] > *most) {
            *most = off[k];
            w->worst = i + k;
        }
}

/* The largest distance at the probes, as a part of what is allowed; of a parabola, whose middle may lie
 * between them, the largest of all. */
ALWAYS_INLINE double find_distance(ns_waveform *w, const ns_segment *g) {
    const double *a = ns_waveform_seen(w, g->at[0].v), *b = ns_waveform_seen(w, g->at[g->last].v);
    const double t0 = g->at[0].t, length = g->at[g->last].t - t0;
    double most = 0, parabola = 0.25;
    for (int j = 1; j < g->last; j++) {
        const double *v = ns_waveform_seen(w, g->at[j].v), part = (g->at[j].t - t0) / length;
        parabola = fmax(parabola, 4 * part * (1 - part));
        for (int i = 0; i < w->looked; i += NS_WIDE) {
            const ns_simd_wide from = CONST_WIDE(a, i), over = CONST_WIDE(v, i) - from;
            const ns_simd_wide off =
                (over - part * (CONST_WIDE(b, i) - from)) * CONST_WIDE(w->per_tolerance, i);
            double size[NS_WIDE];
            WIDE(size, 0) = NS_WIDE_SIZE(off);
            take_most(w, i, size, &most);
        }
    }
    return most / parabola;
}

static double distance_narrow(ns_waveform *w, const ns_segment *g) {
    return find_distance(w, g);
}

NS_WIDE_TARGET static double distance_wide(ns_waveform *w, const ns_segment *g) {
    return find_distance(w, g);
}

/* 1 if w->own and w->own_error are those of g. */
static int is_integrated(const ns_waveform *w, const ns_segment *g) {
    int same = w->integrated == g->last;
    for (int j = 0; same && j <= g->last; j++)
        same = w->integrated_row[j] == g->at[j].v && w->integrated_t[j] == g->at[j].t;
    return same;
}

/* Probes of a segment: values, parts of the way, and lengths for which each of them stands. */
typedef struct trapezoids {
    int last;
    const double *v[NS_PROBES];
    double part[NS_PROBES], weight[NS_PROBES];
} ns_trapezoids;

ALWAYS_INLINE void sum_trapezoids(const ns_trapezoids *z, int count, double *own, double *error) {
    for (int i = 0; i < count; i += NS_WIDE) {
        const ns_simd_wide from = CONST_WIDE(z->v[0], i), rise = CONST_WIDE(z->v[z->last], i) - from;
        ns_simd_wide size = {0}, off = {0};
        for (int j = 0; j <= z->last; j++) {
            const ns_simd_wide value = CONST_WIDE(z->v[j], i);
            size += z->weight[j] * NS_WIDE_SIZE(value);
            off += z->weight[j] * (value - from - z->part[j] * rise);
        }
        WIDE(own, i) = size;
        WIDE(error, i) = off;
    }
}

static void sum_narrow(const ns_trapezoids *z, int count, double *own, double *error) {
    sum_trapezoids(z, count, own, error);
}

NS_WIDE_TARGET static void sum_wide(const ns_trapezoids *z, int count, double *own, double *error) {
    sum_trapezoids(z, count, own, error);
}

/* Integrals over a segment of the absolute value (w->own) and of the distance from the line (w->own_error),
 * by trapezoids between the probes. */
static void integrate(ns_waveform *w, const ns_segment *g) {
    if (is_integrated(w, g))
        return;
    ns_trapezoids z;
    const double t0 = g->at[0].t, per_length = 1 / (g->at[g->last].t - t0);
    z.last = w->integrated = g->last;
    z.v[0] = ns_waveform_seen(w, g->at[0].v);
    for (int j = 0; j <= g->last; j++) {
        const double before = j > 0 ? g->at[j - 1].t : t0, after = g->at[j < g->last ? j + 1 : j].t;
        z.v[j] = ns_waveform_seen(w, g->at[j].v);
        z.part[j] = (g->at[j].t - t0) * per_length;
        z.weight[j] = 0.5 * (after - before);
        w->integrated_row[j] = g->at[j].v;
        w->integrated_t[j] = g->at[j].t;
    }
    (ns_simd_is_wide() ? sum_wide : sum_narrow)(&z, w->looked, w->own, w->own_error);
}

/* Of the half that is shared out since the last event, what a line of signal i of this length may take: an
 * even part of the 3 / sqrt(lines) lines that a decay takes at best; or what the line would have of its own
 * if the signal were there what it is at the next event: what does not decay to zero needs no even parts.
 * since: the integral since the event; rest: of that half. */
static double shared_out(const ns_waveform *w, int i, double length, double since, double rest) {
    static const double of_rest = 0.2, kept = 0.1;
    const double most = w->lines * since, even = ns_lower(sqrt(w->lines) / 3 * most, of_rest * rest);
    if (!w->is_first)
        return even;
    const double as_at_end = w->lines * fabs(w->at_end[w->signal[i]]) * length;
    return ns_higher(even, ns_lower(as_at_end, of_rest * (rest - kept * most)));
}

/* 1 if the integrals of NS_WIDE signals from i on are off by no more than this part of those of their
 * absolute values. */
static int are_exact(const ns_waveform *w, int i, double part) {
    return NS_WIDE_BELOW_OR_AT(NS_WIDE_SIZE(CONST_WIDE(w->own_error, i)), part * CONST_WIDE(w->own, i));
}

/* The distance of the integral of signal i since the last event, as a part of what is allowed: half of it by
 * the segment's own integral; the other half, by the integral since the event or while it lasts, is shared
 * out. time: what the time between two events is of the run. */
static void take_integral(ns_waveform *w, int i, double length, double time, double *most) {
    const double since = ns_higher(w->since_event[i] + w->own[i], (w->total[i] + w->own[i]) * time);
    const double rest = ns_higher(0.5 * w->lines * since - fabs(w->error[i]), 0);
    const double allowed =
        0.5 * w->lines * w->own[i] + shared_out(w, i, length, since, rest) + noise_of(w, i) * length;
    const double error = fabs(w->own_error[i]);
    if (!(error > *most * allowed))
        return;
    *most = allowed > 0 ? error / allowed : INFINITY;
    w->worst = i;
}

/* The largest of these, or `off` if that is larger. */
static double integral_distance(ns_waveform *w, const ns_segment *g, double off) {
    static const double least = 1e-6; /* less is not told apart */
    const double end = g->at[g->last].t, length = end - g->at[0].t;
    const double time = fmin(1, (w->end - w->event_t) / fmax(end - w->start_t, length));
    double most = fmax(off, least);
    integrate(w, g);
    for (int i = 0; i < w->looked; i += NS_WIDE) {
        if (are_exact(w, i, most * 0.5 * w->lines)) /* at least that much is allowed */
            continue;
        for (int k = i; k < i + NS_WIDE && k < w->looked; k++)
            take_integral(w, k, length, time, &most);
    }
    return most;
}

/* A line from a to b of some length (s), and squares of late: 1 / time. */
typedef struct squared_line {
    const double *a, *b;
    double length, per_time;
} ns_squared_line;

static ns_squared_line squared_line(const ns_waveform *w, const ns_segment *g) {
    return (ns_squared_line){ns_waveform_seen(w, g->at[0].v), ns_waveform_seen(w, g->at[g->last].v),
                             g->at[g->last].t - g->at[0].t, w->square_time > 0 ? 1 / w->square_time : 0};
}

/* Of NS_WIDE signals from i on: by how much the trapezoid of the square is larger than the integral of the
 * square of the line; and what it may add to that by the squares in the rest of its stretch, which along a
 * ramp from zero add up to twice its own, or by the run's of late, whichever is larger. */
ALWAYS_INLINE void square_errors(const ns_waveform *w, const ns_squared_line *g, int i, double *error,
                                 double *allowed) {
    const ns_simd_wide from = CONST_WIDE(g->a, i), rise = CONST_WIDE(g->b, i) - from;
    const ns_simd_wide size = NS_WIDE_SIZE(from), end = CONST_WIDE(w->end_values, i);
    const ns_simd_wide mean = CONST_WIDE(w->square, i) * g->per_time;
    const ns_simd_wide between = (size * size + size * end + end * end) / 3;
    WIDE(error, 0) = rise * rise * (g->length / 6);
    WIDE(allowed, 0) = NS_WIDE_HIGHER(between, mean) * (0.25 * w->squares * g->length);
}

/* The distance of signal i's; a ramp that takes no time borrows from the run. */
static void take_square(ns_waveform *w, int i, double length, double error, double allowed, double *most) {
    static const double of_rest = 0.1;
    const double noise = noise_of(w, i);
    const double rest = fmax(0.5 * w->squares * w->square[i] - w->square_error[i], 0);
    const double all = allowed + of_rest * rest + noise * noise * length;
    if (!(error > *most * all))
        return;
    *most = all > 0 ? error / all : INFINITY;
    w->worst = i;
}

/* The distance of the integrals of squares, as a part of what is allowed, or `off` if that is larger. */
ALWAYS_INLINE double find_square_distance(ns_waveform *w, const ns_squared_line *g, double off) {
    double most = off;
    for (int i = 0; i < w->looked; i += NS_WIDE) {
        double error[NS_WIDE], allowed[NS_WIDE];
        square_errors(w, g, i, error, allowed);
        if (NS_WIDE_BELOW_OR_AT(CONST_WIDE(error, 0), most * CONST_WIDE(allowed, 0)))
            continue;
        for (int k = 0; k < NS_WIDE && i + k < w->looked; k++)
            if (!(error[k] <= most * allowed[k]))
                take_square(w, i + k, g->length, error[k], allowed[k], &most);
    }
    return most;
}

static double square_distance_narrow(ns_waveform *w, const ns_squared_line *g, double off) {
    return find_square_distance(w, g, off);
}

NS_WIDE_TARGET static double square_distance_wide(ns_waveform *w, const ns_squared_line *g, double off) {
    return find_square_distance(w, g, off);
}

static double square_distance(ns_waveform *w, const ns_segment *g, double off) {
    const ns_squared_line line = squared_line(w, g);
    return (ns_simd_is_wide() ? square_distance_wide : square_distance_narrow)(w, &line, off);
}

double ns_waveform_distance(ns_waveform *w, const ns_segment *g) {
    update_tolerances(w);
    return g->last < 2 ? 0 : (ns_simd_is_wide() ? distance_wide : distance_narrow)(w, g);
}

double ns_waveform_deviation(ns_waveform *w, const ns_segment *g) {
    double off = ns_waveform_distance(w, g);
    if (g->last >= 2) /* where the line is too far off, too: how far both are leads to the right length */
        off = integral_distance(w, g, off);
    w->squares_decide = 0;
    if (!(w->squares > 0 && off <= 1))
        return off;
    const double squares = square_distance(w, g, off);
    w->squares_decide = squares > off;
    return squares;
}

/* 1 if the parabola through a, v (at part of the way) and b turns on the way. */
static int turns(double a, double v, double b, double part) {
    return fabs(b - a) * (part * (1 - part)) < fabs(v - a - part * (b - a));
}

/* Where that parabola turns, as a part of the way; 1: nowhere, or it turns unseen, by less than `seen` beyond
 * both ends. */
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
    const double *a = ns_waveform_seen(w, g->at[0].v), *v = ns_waveform_seen(w, g->at[middle].v);
    const double *b = ns_waveform_seen(w, g->at[g->last].v);
    const double part = (g->at[middle].t - t0) / length;
    update_tolerances(w);
    for (int i = 0; i < w->looked; i++)
        if (turns(a[i], v[i], b[i], part) && w->per_tolerance[i] > 0)
            first =
                fmin(first, turn(a[i], v[i], b[i], part, fmax(seen / w->per_tolerance[i], w->rounding[i])));
    return first < 1 && first * length > w->closest ? t0 + first * length : INFINITY;
}

void ns_waveform_begin_integrals(ns_waveform *w, double t) {
    w->event_t = t;
    memset(w->since_event, 0, sizeof *w->since_event * (size_t)w->looked);
    memset(w->error, 0, sizeof *w->error * (size_t)w->looked);
}

/* A segment may be wrong by half of `lines` of its own integral; what its integral is wrong by beyond that is
 * added to w->error, with its sign: over a ring these cancel. */
void ns_waveform_add_integrals(ns_waveform *w, const ns_segment *g, double sign) {
    integrate(w, g);
    for (int i = 0; i < w->looked; i += NS_WIDE) {
        const ns_simd_wide own = CONST_WIDE(w->own, i), error = CONST_WIDE(w->own_error, i);
        const ns_simd_wide allowed = 0.5 * w->lines * own, below = NS_WIDE_LOWER(error, allowed);
        const ns_simd_wide within = NS_WIDE_HIGHER(below, -allowed);
        WIDE(w->since_event, i) += sign * own;
        WIDE(w->error, i) += sign * (error - within);
    }
}

ALWAYS_INLINE void add_squares(ns_waveform *w, const ns_squared_line *g, double left_over) {
    for (int i = 0; i < w->looked; i += NS_WIDE) {
        double error[NS_WIDE], allowed[NS_WIDE];
        const ns_simd_wide left = CONST_WIDE(g->a, i), right = CONST_WIDE(g->b, i), none = {0};
        square_errors(w, g, i, error, allowed);
        const ns_simd_wide beyond = WIDE(error, 0) - WIDE(allowed, 0);
        WIDE(w->square_error, i) = left_over * WIDE(w->square_error, i) + NS_WIDE_HIGHER(beyond, none);
        WIDE(w->square, i) =
            left_over * WIDE(w->square, i) + (left * left + left * right + right * right) * (g->length / 3);
    }
}

static void add_squares_narrow(ns_waveform *w, const ns_squared_line *g, double left_over) {
    add_squares(w, g, left_over);
}

NS_WIDE_TARGET static void add_squares_wide(ns_waveform *w, const ns_squared_line *g, double left_over) {
    add_squares(w, g, left_over);
}

/* What was before fades, so that a large start does not hide what is small later: by 1/e in the time since
 * the start over `fades`. */
static void note_squares(ns_waveform *w, const ns_segment *g) {
    static const double fades = 16;
    const double length = g->at[g->last].t - g->at[0].t, before = g->at[0].t - w->start_t;
    const double left_over = before > 0 ? before / (before + fades * length) : 0;
    w->square_time = left_over * w->square_time + length;
    const ns_squared_line line = squared_line(w, g);
    (ns_simd_is_wide() ? add_squares_wide : add_squares_narrow)(w, &line, left_over);
}

void ns_waveform_note_given(ns_waveform *w, const ns_segment *g) {
    const double *a = ns_waveform_seen(w, g->at[0].v), *b = ns_waveform_seen(w, g->at[g->last].v);
    const double length = g->at[g->last].t - g->at[0].t;
    w->by_squares += w->squares_decide;
    integrate(w, g);
    for (int i = 0; i < w->looked; i++) {
        const double slope = (b[i] - a[i]) / length;
        w->turned[i] += !g->from_event && slope * w->slope[i] < 0;
        w->slope[i] = g->jumps ? 0 : slope;
        w->total[i] += w->own[i];
    }
    if (w->squares > 0)
        note_squares(w, g);
}
