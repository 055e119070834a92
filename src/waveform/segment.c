/* src/waveform/segment.c - how far one straight line reaches. */
#include "waveform_internal.h"

#include <math.h>

/* A segment grows at most by this from one look to the next: just after an event, where anything fast may
 * happen, and later. */
static const double fresh_growth = 4, growth = 2;
/* The length at which the distance, which grows by its square, is what is allowed, is aimed at with this. */
static const double aim = 0.97;
/* Lengths that differ by less are not worth a look. */
static const double alike = 1.08;
/* A look on the way to a proposed length; not its middle, where an S would not be seen. */
static const double first_part = 0.45;

void ns_waveform_drop_segment(ns_waveform *w, ns_segment *g) {
    for (int i = 0; i < g->last; i++)
        ns_waveform_return_row(w, g->at[i].v);
    g->last = 0;
}

static void drop_end(ns_waveform *w, ns_segment *g) {
    ns_waveform_return_row(w, g->at[g->last--].v);
}

/* Probes closer together than a small part of its length are given back, but for its ends. */
static void thin(ns_waveform *w, ns_segment *g) {
    const double apart = (g->at[g->last].t - g->at[0].t) / (NS_PROBES / 3.0);
    int kept = 0;
    for (int i = 1; i < g->last; i++) {
        if (g->at[i].t - g->at[kept].t < apart)
            ns_waveform_return_row(w, g->at[i].v);
        else
            g->at[++kept] = g->at[i];
    }
    g->at[kept + 1] = g->at[g->last];
    g->last = kept + 1;
}

static int add_end(ns_waveform *w, ns_segment *g, double t) {
    double *row;
    if (g->last == NS_PROBES - 1)
        thin(w, g);
    const int status = ns_waveform_sample(w, w->end - t <= w->closest ? w->end : t, &row);
    if (status == NS_OK)
        g->at[++g->last] = (ns_probe){t, row};
    return status;
}

/* The length at which a line is as far off as is allowed, if it is `off` at this length. */
static double reach(double length, double off) {
    return aim * length / sqrt(fmax(off, 1e-6));
}

/* Where the next segment will be looked at first. */
static double first_length(ns_waveform *w, double t) {
    /* a curve that changes by a twentieth in the shortest time is as far off as allowed where part is 50 */
    const double part = fmin(0.5, 20 * sqrt(w->lines));
    const double least = fmax(part * ns_march_shortest(w->march, t, NULL), w->closest);
    return w->fresh ? least : fmax(first_part * w->proposal, w->closest);
}

/* The multiple of w->every that is nearest to t, as the number that a decimal in a netlist is read as. */
static double round_time(const ns_waveform *w, double t) {
    const double inverse = floor(1 / w->every + 0.5), k = floor(t / w->every + 0.5);
    return w->every < 1 && fabs(inverse * w->every - 1) < 1e-9 ? k / inverse : k * w->every;
}

/* The first such multiple after t. */
static double round_after(const ns_waveform *w, double t) {
    const double near = round_time(w, t);
    return near > t + w->closest ? near : round_time(w, t + w->every);
}

/* Where it ends at the latest: the end of the stretch, or a point that is asked for. */
static double last_time(const ns_waveform *w, double base) {
    const double t = fmin(w->end, base + w->longest);
    if (!(w->every < INFINITY))
        return t;
    const double round = round_after(w, base);
    return round < t + w->closest && fabs(round - w->until) > w->closest ? round : t;
}

/* Longer and longer, until the line is too far off; *off: how far it is. */
static int grow(ns_waveform *w, ns_segment *g, double base, double last_t, double *off) {
    enum { LOOKS = 400, SHORTER = 4 };
    const double most = last_t - base, grows = w->fresh ? fresh_growth : growth;
    double length = first_length(w, base), too_long = INFINITY;
    int shorter = 0;
    for (int look = 0; look < LOOKS; look++) {
        const int all = length >= most - fmax(w->closest, 1e-3 * most);
        length = all ? most : length;
        const int status = add_end(w, g, all ? last_t : base + length);
        if (status != NS_OK)
            return status;
        const double now = ns_waveform_deviation(w, g);
        double next = fmin(reach(length, now), grows * length);
        const int shortest = g->last == 1 && (shorter == SHORTER || length <= 4 * w->closest);
        if (now <= 1 || shortest) { /* the shortest one is taken as it is: each call moves on */
            *off = now;
            if (shortest && now > 1)
                break;
            if (all || next < alike * length || next * alike > too_long)
                break;
        } else {
            too_long = length;
            drop_end(w, g);
            next = fmax(reach(length, now), alike * (g->at[g->last].t - base));
            if (++shorter > SHORTER || next * alike > too_long)
                break;
        }
        length = next;
    }
    if (g->at[g->last].t < last_t && w->worst >= 0)
        w->limits[w->worst]++;
    return NS_OK;
}

/* The segment ends where a signal turns on its way, if one does: peaks and valleys are points. */
static int end_at_turn(ns_waveform *w, ns_segment *g) {
    const double t = ns_waveform_first_turn(w, g);
    if (!(t < g->at[g->last].t))
        return NS_OK;
    while (g->last > 0 && g->at[g->last].t >= t)
        drop_end(w, g);
    return add_end(w, g, t);
}

int ns_waveform_choose(ns_waveform *w) {
    ns_segment *g = &w->made;
    const double base = fmax(g->at[0].t, w->accepted_t);
    double off = 0;
    int status = grow(w, g, base, last_time(w, base), &off);
    const double chosen = g->at[g->last].t - base;
    if (status == NS_OK)
        status = end_at_turn(w, g);
    if (status != NS_OK)
        return status;
    w->proposal = fmin(fmax(reach(chosen, off), 0.5 * chosen), growth * chosen);
    w->fresh = 0;
    ns_waveform_add_integrals(w, g, 1);
    return NS_OK;
}

/* The two as one, as long as its probes find room. */
static void join(ns_waveform *w, ns_segment *a, ns_segment *b, ns_segment *both) {
    if (a->last + b->last >= NS_PROBES)
        thin(w, a);
    if (a->last + b->last >= NS_PROBES)
        thin(w, b);
    *both = *a;
    for (int i = 1; i <= b->last; i++)
        both->at[both->last + i] = b->at[i];
    both->last += b->last;
}

/* The integrals since the event with these, or (sign -1) without. */
static void count_both(ns_waveform *w, const ns_segment *a, const ns_segment *b, double sign) {
    if (!b->from_event)
        ns_waveform_add_integrals(w, a, sign);
    ns_waveform_add_integrals(w, b, sign);
}

int ns_waveform_merge(ns_waveform *w) {
    ns_segment *a = &w->pending, *b = &w->made, both;
    const double t = b->at[0].t;
    const int asked_for = w->every < INFINITY && t == round_time(w, t);
    if (!b->smooth || a->jumps || b->at[b->last].t - a->at[0].t > w->longest || asked_for)
        return 0;
    join(w, a, b, &both);
    count_both(w, a, b, -1);
    const int fits = ns_waveform_deviation(w, &both) <= 1 && ns_waveform_first_turn(w, &both) == INFINITY;
    if (fits) {
        ns_waveform_add_integrals(w, &both, 1);
        both.from_event |= b->from_event;
        *a = both;
        b->last = 0;
    } else {
        count_both(w, a, b, 1);
    }
    return fits;
}
