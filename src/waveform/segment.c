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
/* A line that is as far off as this is long enough; looked for is one that is as far off as that. */
static const double enough = 0.8, wanted = 0.9;

void ns_waveform_drop_segment(ns_waveform *w, ns_segment *g) {
    for (int i = 0; i < g->last; i++)
        ns_waveform_return_row(w, g->at[i].v);
    g->last = 0;
}

static void drop_end(ns_waveform *w, ns_segment *g) {
    ns_waveform_return_row(w, g->at[g->last--].v);
}

static void drop_probes(ns_waveform *w, ns_segment *g) {
    while (g->last > 0)
        drop_end(w, g);
}

/* Probes closer together than a small part of its length are given back, but for its ends. */
static void thin(ns_waveform *w, ns_segment *g) {
    const double apart = (g->at[g->last].t - g->at[0].t) / (NS_PROBES / 3.0);
    int kept = 0;
    for (int i = 1; i < g->last; i++) {
        if (g->at[i].t - g->at[kept].t <= apart)
            ns_waveform_return_row(w, g->at[i].v);
        else
            g->at[++kept] = g->at[i];
    }
    g->at[kept + 1] = g->at[g->last];
    g->last = kept + 1;
}

/* What was sampled on the way of the stretch becomes a probe, if it is as far from where the segment begins:
 * where one line is all of the stretch. */
static int take_amid(ns_waveform *w, ns_segment *g, double t) {
    static const double as_far = 0.02;
    if (!w->amid.v || g->last > 0 || !(fabs(t - w->amid.t) <= as_far * (w->amid.t - g->at[0].t)))
        return 0;
    g->at[++g->last] = w->amid;
    w->amid.v = NULL;
    return 1;
}

static int add_end(ns_waveform *w, ns_segment *g, double t) {
    double *row;
    if (take_amid(w, g, t))
        return NS_OK;
    if (g->last == NS_PROBES - 1)
        thin(w, g);
    const int status =
        w->end - t <= w->closest ? ns_waveform_sample_end(w, &row) : ns_waveform_sample(w, t, &row);
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
    /* a curve that changes by a twentieth in the shortest time is as far off as allowed at 57 sqrt(lines) of
     * it, and by two fifths where part is 8 */
    const double part = fmin(8, 40 * sqrt(w->lines));
    const double least = fmax(part * ns_march_shortest(w->march, t, NULL), w->closest);
    return w->fresh ? least : fmax(ns_waveform_first_part * w->proposal, w->closest);
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

/* The search for the length of one segment. */
typedef struct ns_search {
    double base, last_t;         /* s: where it begins, where it ends at the latest */
    double least;                /* s: it is never shorter */
    double length;               /* s: looked at next */
    double off;                  /* of the line that was taken: how far off it is */
    double too_long, too_far;    /* s: the last length that was too long, INFINITY: none; how far off it is */
    double near_enough, near_by; /* s: the longest length seen that was not, 0: none; how far off it is */
    double aimed;        /* s: the length that too_long says is right, where no probe is left; 0: none */
    double first_length; /* s: the first one that was; 0: none */
    int shorter;         /* lengths that were too long */
    int is_shortest;     /* 1: the next line is taken as it is */
} ns_search;

static void begin_search(ns_waveform *w, double base, ns_search *s) {
    *s = (ns_search){.base = base, .last_t = last_time(w, base), .too_long = INFINITY};
    s->least = fmax(w->closest, 2e-15 * fabs(base));
    s->length = fmax(first_length(w, base), s->least);
}

/* The next length is looked at; *all: it is all the way. */
static int try_length(ns_waveform *w, ns_segment *g, ns_search *s, int *all, double *off) {
    const double most = s->last_t - s->base;
    *all = s->length >= most - fmax(s->least, 1e-3 * most);
    if (*all && g->last == 0 && ns_waveform_first_part * most > s->least) {
        *all = 0; /* no line is taken unseen */
        s->length = ns_waveform_first_part * most;
    }
    s->length = *all ? most : s->length;
    const int status = add_end(w, g, *all ? s->last_t : s->base + s->length);
    *off = status == NS_OK ? ns_waveform_deviation(w, g) : 0;
    return status;
}

/* 1 if the longest line that is near enough is long enough, beside one that is too long. */
static int is_found(const ns_search *s) {
    return s->near_by > enough || s->near_enough * alike * alike > s->too_long;
}

/* Between these two: where a power of the length that goes through both is what is wanted. */
static double length_between(const ns_search *s) {
    const double least = 1e-3; /* below that rounding counts */
    const double ratio = s->too_long / s->near_enough, by = fmax(s->near_by, least);
    const double part = log(wanted / by) / log(s->too_far / by);
    return s->near_enough * fmin(fmax(pow(ratio, part), alike), ratio / alike);
}

/* The line is near enough: 1 if it is taken, 0: a longer one is looked at.  With one probe it was not seen
 * yet. */
static int lengthen(const ns_waveform *w, const ns_segment *g, ns_search *s, double off) {
    const double least = alike * s->length, most = (w->fresh ? fresh_growth : growth) * s->length;
    double next = fmin(reach(s->length, off), most);
    s->off = off;
    if (g->last == 1) {
        const double right = s->aimed > 0 ? s->aimed : w->fresh ? next : w->proposal;
        s->length = fmax(right, least);
        return 0;
    }
    s->near_enough = s->length;
    s->near_by = off;
    if (s->too_long < INFINITY) {
        s->length = length_between(s);
        return is_found(s);
    }
    s->length = fmax(next, least);
    return next < least;
}

/* The line is too far off: 1 if the one before is taken, 0: a shorter one is looked at.  A probe that no line
 * was seen to be near to goes too, unless it lies on the way of the next one. */
static int shorten(ns_waveform *w, ns_segment *g, ns_search *s, double off) {
    enum { SHORTER = 8 };
    const double next = reach(s->length, off);
    s->first_length = s->first_length > 0 ? s->first_length : s->length;
    s->too_long = s->length;
    s->too_far = off;
    s->shorter++;
    drop_end(w, g);
    if (g->last > 1) {
        s->length = length_between(s);
        return is_found(s) || s->shorter > SHORTER;
    }
    if (g->last == 1 && next > alike * (g->at[1].t - s->base) && next < s->too_long - s->least) {
        s->length = next;
        return 0;
    }
    drop_probes(w, g);
    s->aimed = next;
    s->length = fmax(ns_waveform_first_part * next, s->least);
    s->is_shortest = s->length <= s->least || s->shorter > SHORTER;
    return 0;
}

/* A smooth curve is at most four times as far off where a line is twice as long. */
static int is_suspect(const ns_waveform *w, const ns_search *s, double off) {
    return s->shorter > 2 || (s->shorter > 0 && !w->fresh && off > 16);
}

/* Is it rounding that no line comes near to?  If it is, the search begins anew: *again. */
static int look_for_rounding(ns_waveform *w, ns_segment *g, ns_search *s, int *again) {
    const int status = ns_waveform_measure_rounding(w, s->base, s->first_length, again);
    if (!*again)
        return status;
    drop_probes(w, g);
    s->length = s->first_length;
    s->too_long = INFINITY;
    s->aimed = 0;
    s->shorter = s->is_shortest = 0;
    return status;
}

/* Longer and longer, until the line is too far off.  The shortest one is taken as it is: each call moves on.
 */
static int grow(ns_waveform *w, ns_segment *g, ns_search *s) {
    enum { LOOKS = 400 };
    int taken = 0, status = NS_OK;
    for (int count = 0; count < LOOKS && !taken && status == NS_OK; count++) {
        double off;
        int all;
        status = try_length(w, g, s, &all, &off);
        if (status != NS_OK)
            break;
        if (s->is_shortest)
            taken = 1;
        else
            taken = off <= 1 ? lengthen(w, g, s, off) || all : shorten(w, g, s, off);
        if (is_suspect(w, s, off) && !w->rounding_known) {
            int again;
            status = look_for_rounding(w, g, s, &again);
            taken = taken && !again;
        }
    }
    return status;
}

/* The segment ends where a signal turns on its way, if one does: peaks and valleys are points. */
static int end_at_turn(ns_waveform *w, ns_segment *g) {
    const double t = ns_waveform_first_turn(w, g);
    if (!(t < g->at[g->last].t - w->closest))
        return NS_OK;
    while (g->last > 0 && g->at[g->last].t >= t)
        drop_end(w, g);
    return add_end(w, g, t);
}

/* The segment after one of this length, that is so far off, grows by as much as that did from the one before:
 * along a decay lines become longer and longer. */
static void propose(ns_waveform *w, double chosen, double off) {
    const double trend = w->fresh ? 1 : fmin(fmax(chosen / w->chosen, 1 / growth), growth);
    w->proposal = fmin(fmax(trend * reach(chosen, off), 0.5 * chosen), growth * chosen);
    w->chosen = chosen;
}

int ns_waveform_choose(ns_waveform *w) {
    ns_segment *g = &w->made;
    ns_search s;
    ns_waveform_forget_rounding(w);
    begin_search(w, fmax(g->at[0].t, w->accepted_t), &s);
    int status = grow(w, g, &s);
    const double chosen = g->at[g->last].t - s.base;
    if (status == NS_OK && g->at[g->last].t < s.last_t && w->worst >= 0)
        w->limits[w->worst]++;
    if (status == NS_OK)
        status = end_at_turn(w, g);
    if (status != NS_OK)
        return status;
    propose(w, chosen, s.off);
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
    if (ns_waveform_distance(w, &both) > 1)
        return 0;
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
