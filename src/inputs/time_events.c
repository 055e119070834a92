/* src/inputs/time_events.c - the instants known ahead of time, in order.
 *
 * A heap holds, for each line that enters, its next corner, for each wave that enters its beginning, and for
 * each time-only command the instant it flips or up to where it is known not to.
 */
#include "time_events_internal.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

/* --- the heap --- */

static ns_switch_times *timed(const ns_time_events *s, int id) {
    return &s->command[id - s->lines - s->terms];
}

static double time_of(const ns_time_events *s, int id) {
    if (id < s->lines)
        return s->run[id].next;
    id -= s->lines;
    if (id < s->terms)
        return s->begun[id] ? INFINITY : s->term[id].from;
    return s->command[id - s->terms].next;
}

static void sift(ns_time_events *s, int at, ns_entry e) {
    for (int child; (child = 2 * at + 1) < s->count; at = child) {
        child += child + 1 < s->count && s->heap[child + 1].t < s->heap[child].t;
        if (e.t <= s->heap[child].t)
            break;
        s->heap[at] = s->heap[child];
    }
    s->heap[at] = e;
}

static void first_changed(ns_time_events *s) {
    const int id = s->heap[0].id;
    sift(s, 0, (ns_entry){time_of(s, id), id});
}

static void heapify(ns_time_events *s) {
    for (int id = 0; id < s->count; id++)
        s->heap[id] = (ns_entry){time_of(s, id), id};
    for (int at = s->count / 2; at-- > 0;)
        sift(s, at, s->heap[at]);
}

/* --- walking --- */

void ns_inputs_events_seek(ns_time_events *s, double t, ns_side side, const unsigned char *closed) {
    const double a_bit = side == NS_LEFT ? -1 : 1;
    for (int i = 0; i < s->lines; i++)
        ns_system_line_seek(&s->run[i], t + a_bit * ns_system_signal_slack(t, s->run[i].line->origin));
    for (int k = 0; k < s->terms; k++)
        s->begun[k] = s->term[k].from <= t + a_bit * ns_system_signal_slack(t, s->term[k].from);
    for (int c = 0; c < s->commands; c++) {
        const int index = s->command_index[c];
        ns_inputs_switch_seek(&s->command[c], t, side, closed ? closed[index] != 0 : -1);
        s->closed[index] = (unsigned char)s->command[c].closed;
    }
    heapify(s);
    s->now = t;
    s->instant = (ns_time_event){.t = t, .input = s->changed, .flip = s->flip};
}

/* Nothing happens there: a corner of nothing, or a command that is only searched on from there. */
static int is_blank(const ns_time_events *s, int id) {
    double k;
    if (id >= s->lines + s->terms)
        return !timed(s, id)->flips;
    if (id >= s->lines)
        return 0;
    const ns_line_cursor *r = &s->run[id];
    const ns_line_piece *a = ns_system_line_piece(r), *b = &r->line->piece[ns_system_line_following(r, &k)];
    return a->end == b->v && a->slope == b->slope;
}

static void go_on(ns_time_events *s, int id, double t) {
    if (id < s->lines)
        ns_system_line_pass(&s->run[id], t);
    else
        ns_inputs_switch_on(timed(s, id));
    first_changed(s);
}

double ns_inputs_events_next(ns_time_events *s, double until) {
    enum { BLANKS = 1000000 }; /* then one of them is told */
    if (s->count == 0)
        return INFINITY;
    for (int k = 0;
         k < BLANKS && s->heap[0].t <= until && s->heap[0].t < INFINITY && is_blank(s, s->heap[0].id); k++)
        go_on(s, s->heap[0].id, s->heap[0].t);
    return s->heap[0].t <= until ? fmax(s->heap[0].t, s->now) : INFINITY;
}

/* Where entry id is on a line that repeats for ever; NULL, *ends: it is not, *ends: nothing is to come. */
static const ns_line_cursor *repeats(const ns_time_events *s, int id, int *ends) {
    *ends = time_of(s, id) > DBL_MAX;
    if (*ends || (id >= s->lines && id < s->lines + s->terms))
        return NULL;
    if (id >= s->lines)
        return ns_inputs_switch_repeats(timed(s, id));
    return ns_system_line_repeats(&s->run[id]) ? &s->run[id] : NULL;
}

double ns_inputs_events_period(const ns_time_events *s) {
    double longest = 0;
    int ends;
    if (s->terms > 0) /* waves go on, with instants or without */
        return 0;
    for (int id = 0; id < s->count; id++) {
        const ns_line_cursor *r = repeats(s, id, &ends);
        if (!r && !ends)
            return 0;
        longest = r ? fmax(longest, r->line->period) : longest;
    }
    for (int id = 0; id < s->count; id++) {
        const ns_line_cursor *r = repeats(s, id, &ends);
        const double times = r ? longest / r->line->period : 1;
        if (fabs(times - rint(times)) > 2 * DBL_EPSILON * times)
            return 0;
    }
    return longest;
}

void ns_inputs_events_skip(ns_time_events *s, double t, double period) {
    int ends;
    for (int id = 0; id < s->count; id++) {
        const ns_line_cursor *r = repeats(s, id, &ends);
        const double times = r ? rint(period / r->line->period) : 0;
        if (r && id < s->lines)
            ns_system_line_skip(&s->run[id], times);
        else if (r)
            ns_inputs_switch_skip(timed(s, id), times);
    }
    s->now = t;
    heapify(s);
}

/* Among the entries at and below one of the heap, those no later than limit. */
static int any_event(const ns_time_events *s, int at, double limit) {
    double k;
    if (at >= s->count || s->heap[at].t > limit)
        return 0;
    const int id = s->heap[at].id;
    const ns_line_cursor *r = id < s->lines ? &s->run[id] : NULL;
    const int is = id >= s->lines + s->terms ? timed((ns_time_events *)s, id)->flips
                   : !r                      ? s->term[id - s->lines].jump
                        : ns_system_line_piece(r)->end != r->line->piece[ns_system_line_following(r, &k)].v;
    return is || any_event(s, 2 * at + 1, limit) || any_event(s, 2 * at + 2, limit);
}

int ns_inputs_events_is_event(const ns_time_events *s) {
    if (s->count == 0 || isinf(s->heap[0].t))
        return 0;
    const double now = fmax(s->heap[0].t, s->now);
    return any_event(s, 0, now + ns_system_signal_slack(now, now));
}

static void pass_corner(ns_time_events *s, int id, double limit) {
    ns_line_cursor *r = &s->run[id];
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

/* One that flips again and again within rounding has to wait. */
static void flip_command(ns_time_events *s, int c, double limit, int *touched) {
    enum { OFTEN = 4 };
    ns_switch_times *x = &s->command[c];
    if (x->flips && s->flipped[c]++ == 0)
        s->touched[(*touched)++] = c;
    ns_inputs_switch_on(x);
    if (s->flipped[c] > OFTEN && x->next <= limit) {
        x->next = nextafter(limit + ns_system_signal_slack(limit, limit), INFINITY);
        x->flips = 0;
    }
}

static void take(ns_time_events *s, int id, double limit, int *touched) {
    if (id < s->lines)
        pass_corner(s, id, limit);
    else if (id < s->lines + s->terms)
        begin_wave(s, id - s->lines);
    else
        flip_command(s, id - s->lines - s->terms, limit, touched);
    first_changed(s);
}

/* Switches driven by one source flip together: at the same instant up to rounding of time, or of their
 * controls. */
static int together(const ns_time_events *s, double limit) {
    const ns_entry *e = &s->heap[0];
    if (e->t <= limit)
        return 1;
    const int c = e->id - s->lines - s->terms;
    return c >= 0 && s->flipped[c] == 0 && s->command[c].flips && e->t <= limit + s->command[c].window;
}

const ns_time_event *ns_inputs_events_pass(ns_time_events *s) {
    int touched = 0;
    if (s->count == 0 || isinf(s->heap[0].t))
        return &s->instant;
    s->now = fmax(s->heap[0].t, s->now);
    s->instant = (ns_time_event){.t = s->now, .input = s->changed, .flip = s->flip};
    const double limit = s->now + ns_system_signal_slack(s->now, s->now);
    while (together(s, limit))
        take(s, s->heap[0].id, limit, &touched);
    for (int k = 0; k < touched; k++) {
        const int c = s->touched[k], index = s->command_index[c];
        if (s->flipped[c] % 2)
            s->flip[s->instant.flips++] = index;
        s->closed[index] = (unsigned char)s->command[c].closed;
        s->flipped[c] = 0;
    }
    return &s->instant;
}

/* --- looking --- */

const unsigned char *ns_inputs_events_closed(const ns_time_events *s) {
    return s->closed;
}

void ns_inputs_events_values(const ns_time_events *s, double t, double *z, double *dz) {
    for (int i = 0; i < s->lines; i++) {
        z[s->input[i]] = ns_system_line_value(&s->run[i], t);
        dz[s->input[i]] = ns_system_line_piece(&s->run[i])->slope;
    }
    for (int i = s->lines; i < s->entering; i++) {
        z[s->input[i]] = s->base[i];
        dz[s->input[i]] = 0;
    }
    for (int k = 0; k < s->terms; k++)
        z[s->term[k].input] += s->begun[k] ? s->term[k].after : s->term[k].before;
}

int ns_inputs_events_waves(const ns_time_events *s, const ns_wave **wave) {
    *wave = s->wave;
    return s->waves;
}

int ns_inputs_events_terms(const ns_time_events *s, const ns_wave_term **term) {
    *term = s->term;
    return s->terms;
}

int ns_inputs_events_entering(const ns_time_events *s, const int **input) {
    *input = s->input;
    return s->entering;
}
