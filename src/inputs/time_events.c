/* src/inputs/time_events.c - events known ahead of time, in order.
 *
 * A heap holds, for each line that enters, its next corner, for each wave that enters its beginning, and for
 * each time-only command the time at which it flips or up to which it is known not to.
 */
#include "time_events_internal.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* --- the heap --- */

static ns_switch_times *command_of(const ns_time_events *s, int id) {
    return &s->command[id - s->lines - s->terms];
}

static double time_of(const ns_time_events *s, int id) {
    if (id < s->lines)
        return s->cursor[id].next;
    id -= s->lines;
    if (id < s->terms)
        return s->begun[id] ? INFINITY : s->term[id].from;
    return s->command[id - s->terms].next;
}

static void sift_down(ns_time_events *s, int at, ns_entry e) {
    for (int child; (child = 2 * at + 1) < s->count; at = child) {
        child += child + 1 < s->count && s->heap[child + 1].t < s->heap[child].t;
        if (e.t <= s->heap[child].t)
            break;
        s->heap[at] = s->heap[child];
    }
    s->heap[at] = e;
}

static void update_first(ns_time_events *s) {
    const int id = s->heap[0].id;
    sift_down(s, 0, (ns_entry){time_of(s, id), id});
}

static void order_heap(ns_time_events *s) {
    for (int at = s->count / 2; at-- > 0;)
        sift_down(s, at, s->heap[at]);
}

/* --- from event to event --- */

void ns_inputs_events_seek(ns_time_events *s, double t, ns_side side, const unsigned char *closed) {
    const double sign = side == NS_LEFT ? -1 : 1;
    for (int i = 0; i < s->lines; i++)
        ns_system_line_seek(&s->cursor[i],
                            t + sign * ns_system_signal_time_error(t, s->cursor[i].line->origin));
    for (int k = 0; k < s->terms; k++)
        s->begun[k] = s->term[k].from <= t + sign * ns_system_signal_time_error(t, s->term[k].from);
    for (int c = 0; c < s->commands; c++) {
        const int index = s->command_index[c];
        ns_inputs_switch_seek(&s->command[c], t, side, closed ? closed[index] != 0 : -1);
        s->closed[index] = (unsigned char)s->command[c].closed;
    }
    for (int id = 0; id < s->count; id++)
        s->heap[id] = (ns_entry){time_of(s, id), id};
    order_heap(s);
    s->now = t;
    s->instant = (ns_time_event){.t = t, .input = s->changed, .flip = s->flip};
}

/* No event: a corner without a change, or a time from which the search for a flip continues. */
static int is_blank(const ns_time_events *s, int id) {
    double k;
    if (id >= s->lines + s->terms)
        return !command_of(s, id)->flips;
    if (id >= s->lines)
        return 0;
    const ns_line_cursor *r = &s->cursor[id];
    const ns_line_piece *a = ns_system_line_piece(r), *b = &r->line->piece[ns_system_line_following(r, &k)];
    return a->end == b->v && a->slope == b->slope;
}

static void pass_blank(ns_time_events *s, int id, double t) {
    if (id < s->lines)
        ns_system_line_pass(&s->cursor[id], t);
    else
        ns_inputs_switch_pass(command_of(s, id));
    update_first(s);
}

double ns_inputs_events_next(ns_time_events *s, double until) {
    enum { MOST_BLANKS = 1000000 }; /* then one of them counts as an event */
    if (s->count == 0)
        return INFINITY;
    for (int k = 0;
         k < MOST_BLANKS && s->heap[0].t <= until && s->heap[0].t < INFINITY && is_blank(s, s->heap[0].id);
         k++)
        pass_blank(s, s->heap[0].id, s->heap[0].t);
    return s->heap[0].t <= until ? fmax(s->heap[0].t, s->now) : INFINITY;
}

/* Where entry id is on a line that repeats for ever; NULL, *ends: it is not, *ends: nothing is to come. */
static const ns_line_cursor *repeating_line(const ns_time_events *s, int id, int *ends) {
    *ends = time_of(s, id) > DBL_MAX;
    if (*ends || (id >= s->lines && id < s->lines + s->terms))
        return NULL;
    if (id >= s->lines)
        return ns_inputs_switch_repeats(command_of(s, id));
    return ns_system_line_repeats(&s->cursor[id]) ? &s->cursor[id] : NULL;
}

double ns_inputs_events_period(const ns_time_events *s) {
    double longest = 0;
    int ends;
    if (s->terms > 0) /* waves do not end, with events or without */
        return 0;
    for (int id = 0; id < s->count; id++) {
        const ns_line_cursor *r = repeating_line(s, id, &ends);
        if (!r && !ends)
            return 0;
        longest = r ? fmax(longest, r->line->period) : longest;
    }
    for (int id = 0; id < s->count; id++) {
        const ns_line_cursor *r = repeating_line(s, id, &ends);
        const double times = r ? longest / r->line->period : 1;
        if (fabs(times - rint(times)) > 2 * DBL_EPSILON * times)
            return 0;
    }
    return longest;
}

void ns_inputs_events_skip(ns_time_events *s, double t, double period) {
    int ends;
    for (int at = 0; at < s->count; at++) {
        const int id = s->heap[at].id;
        const ns_line_cursor *r = repeating_line(s, id, &ends);
        if (!r)
            continue;
        const double times = rint(period / r->line->period);
        if (id < s->lines)
            ns_system_line_skip(&s->cursor[id], times);
        else
            ns_inputs_switch_skip(command_of(s, id), times);
        s->heap[at].t = time_of(s, id);
    }
    s->now = t;
    order_heap(s); /* times moved on alike but for rounding */
}

/* Among the entries at and below one of the heap, those no later than limit. */
static int any_event(const ns_time_events *s, int at, double limit) {
    double k;
    if (at >= s->count || s->heap[at].t > limit)
        return 0;
    const int id = s->heap[at].id;
    const ns_line_cursor *r = id < s->lines ? &s->cursor[id] : NULL;
    const int is = id >= s->lines + s->terms ? command_of((ns_time_events *)s, id)->flips
                   : !r                      ? s->term[id - s->lines].jump
                        : ns_system_line_piece(r)->end != r->line->piece[ns_system_line_following(r, &k)].v;
    return is || any_event(s, 2 * at + 1, limit) || any_event(s, 2 * at + 2, limit);
}

int ns_inputs_events_is_event(const ns_time_events *s) {
    if (s->count == 0 || isinf(s->heap[0].t))
        return 0;
    const double now = fmax(s->heap[0].t, s->now);
    return any_event(s, 0, now + ns_system_signal_time_error(now, now));
}

static void pass_corner(ns_time_events *s, int id, double limit) {
    ns_line_cursor *r = &s->cursor[id];
    const ns_line_piece *from = ns_system_line_piece(r);
    ns_system_line_pass(r, limit);
    const ns_line_piece *to = ns_system_line_piece(r);
    const int jump = from->end != to->v, turn = from->slope != to->slope;
    s->instant.jump |= jump;
    s->instant.turn |= turn;
    if (jump || turn)
        s->changed[s->instant.inputs++] = s->input[id];
}

static void begin_wave(ns_time_events *s, int k) {
    s->begun[k] = 1;
    s->instant.jump |= s->term[k].jump;
    s->instant.turn = 1;
    s->changed[s->instant.inputs++] = s->term[k].input;
}

/* A switch that flips more than OFTEN times within rounding flips again no earlier than after it. */
static void flip_command(ns_time_events *s, int c, double limit, int *touched) {
    enum { OFTEN = 4 };
    ns_switch_times *x = &s->command[c];
    if (x->flips && s->flips[c]++ == 0)
        s->touched[(*touched)++] = c;
    ns_inputs_switch_pass(x);
    if (s->flips[c] > OFTEN && x->next <= limit) {
        x->next = nextafter(limit + ns_system_signal_time_error(limit, limit), INFINITY);
        x->flips = 0;
    }
}

static void pass_entry(ns_time_events *s, int id, double limit, int *touched) {
    if (id < s->lines)
        pass_corner(s, id, limit);
    else if (id < s->lines + s->terms)
        begin_wave(s, id - s->lines);
    else
        flip_command(s, id - s->lines - s->terms, limit, touched);
    update_first(s);
}

/* Switches driven by one source flip together: at the same instant up to rounding of time, or of their
 * controls. */
static int is_simultaneous(const ns_time_events *s, double limit) {
    const ns_entry *e = &s->heap[0];
    if (e->t <= limit)
        return 1;
    const int c = e->id - s->lines - s->terms;
    return c >= 0 && s->flips[c] == 0 && s->command[c].flips && e->t <= limit + s->command[c].window;
}

const ns_time_event *ns_inputs_events_pass(ns_time_events *s) {
    int touched = 0;
    if (s->count == 0 || isinf(s->heap[0].t))
        return &s->instant;
    s->now = fmax(s->heap[0].t, s->now);
    s->instant = (ns_time_event){.t = s->now, .input = s->changed, .flip = s->flip};
    const double limit = s->now + ns_system_signal_time_error(s->now, s->now);
    while (is_simultaneous(s, limit))
        pass_entry(s, s->heap[0].id, limit, &touched);
    for (int k = 0; k < touched; k++) {
        const int c = s->touched[k], index = s->command_index[c];
        if (s->flips[c] % 2)
            s->flip[s->instant.flips++] = index;
        s->closed[index] = (unsigned char)s->command[c].closed;
        s->flips[c] = 0;
    }
    return &s->instant;
}

/* --- what holds there --- */

const unsigned char *ns_inputs_events_closed(const ns_time_events *s) {
    return s->closed;
}

void ns_inputs_events_values(const ns_time_events *s, double t, double *z, double *dz) {
    for (int i = 0; i < s->lines; i++) {
        z[s->input[i]] = ns_system_line_value(&s->cursor[i], t);
        dz[s->input[i]] = ns_system_line_piece(&s->cursor[i])->slope;
    }
    for (int i = s->lines; i < s->entering; i++) {
        z[s->input[i]] = s->base[i];
        dz[s->input[i]] = 0;
    }
    for (int k = 0; k < s->terms; k++)
        z[s->term[k].input] += s->begun[k] ? s->term[k].after : s->term[k].before;
}
