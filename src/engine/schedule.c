/* src/engine/schedule.c - the instants known ahead of time, in order.
 *
 * A heap holds, for each line that enters, its next corner, for each wave that enters its beginning, and for
 * each time-only command the instant it flips or up to where it is known not to.
 */
#include "schedule.h"

#include "timed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct entry {
    double t;
    int id; /* lines, then terms, then commands */
} entry;

struct ns_schedule {
    const ns_system *s;
    ns_pieces *pieces; /* nz; of lines */
    int lines;
    ns_run *run; /* lines that enter, */
    int *input;  /* whose they are; after them the curves that enter */
    int entering;
    double *base; /* entering; of the curves */
    int terms, waves;
    ns_wave_term *term;
    unsigned char *begun; /* terms */
    ns_wave *wave;
    int commands;
    ns_timed *command;
    int *command_index; /* which of the system's */
    int *flipped;       /* commands: how often in this instant */
    int *touched;       /* commands: some of them are in this instant */
    int count;
    entry *heap;
    double now;
    unsigned char *closed; /* nc */
    ns_instant instant;
    int *changed, *flip; /* the lists of the instant */
};

/* --- making --- */

static int column_acts(int rows, const double *a, int k) {
    for (int i = 0; i < rows; i++)
        if (a[(size_t)i + (size_t)k * (size_t)rows] != 0)
            return 1;
    return 0;
}

static int enters(const ns_system *s, int k) {
    int acts = column_acts(s->n, s->E, k) || column_acts(s->m, s->F, k);
    for (int c = 0; c < s->nc && !acts; c++)
        acts = s->command[c].gx && s->command[c].gz && s->command[c].gz[k] != 0;
    return acts;
}

static int wave_of(ns_schedule *s, const ns_wave *w) {
    int k = 0;
    while (k < s->waves &&
           !(s->wave[k].freq == w->freq && s->wave[k].theta == w->theta && s->wave[k].td == w->td))
        k++;
    if (k == s->waves)
        s->wave[s->waves++] = *w;
    return k;
}

static void take_curve(ns_schedule *s, int input) {
    ns_wave wave[NS_TERMS];
    const int count = ns_wave_terms(&s->s->z[input], s->term + s->terms, wave, &s->base[s->entering]);
    s->input[s->entering++] = input;
    for (int k = 0; k < count; k++) {
        ns_wave_term *x = &s->term[s->terms++];
        x->input = input;
        x->wave = wave_of(s, &wave[k]);
    }
}

static void take_inputs(ns_schedule *s, const unsigned char *acting) {
    for (int i = 0; i < s->s->nz; i++)
        if (ns_signal_is_linear(&s->s->z[i]) && (acting ? acting[i] : enters(s->s, i))) {
            s->run[s->lines++].line = &s->pieces[i];
            s->input[s->entering++] = i;
        }
    for (int i = 0; i < s->s->nz; i++)
        if (!ns_signal_is_linear(&s->s->z[i]) && (acting ? acting[i] : enters(s->s, i)))
            take_curve(s, i);
}

static int cut_lines(ns_schedule *s) {
    int status = NS_OK;
    for (int i = 0; i < s->s->nz && status == NS_OK; i++)
        if (ns_signal_is_linear(&s->s->z[i]))
            status = ns_pieces_create(&s->s->z[i], &s->pieces[i]);
    return status;
}

static int take_commands(ns_schedule *s) {
    int status = NS_OK;
    for (int c = 0; c < s->s->nc && status == NS_OK; c++) {
        if (s->s->command[c].gx)
            continue;
        s->command_index[s->commands] = c;
        status = ns_timed_create(s->s, c, s->pieces, &s->command[s->commands++]);
    }
    return status;
}

static int allocate(ns_schedule *s) {
    const size_t nz = (size_t)s->s->nz + 1, nc = (size_t)s->s->nc + 1;
    s->pieces = calloc(nz, sizeof *s->pieces);
    s->run = calloc(nz, sizeof *s->run);
    s->input = calloc(nz, sizeof *s->input);
    s->base = calloc(nz, sizeof *s->base);
    s->term = calloc(NS_TERMS * nz, sizeof *s->term);
    s->begun = calloc(NS_TERMS * nz, 1);
    s->wave = calloc(NS_TERMS * nz, sizeof *s->wave);
    s->command = calloc(nc, sizeof *s->command);
    s->command_index = calloc(nc, sizeof *s->command_index);
    s->flipped = calloc(nc, sizeof *s->flipped);
    s->touched = calloc(nc, sizeof *s->touched);
    s->heap = calloc((1 + NS_TERMS) * nz + nc, sizeof *s->heap);
    s->closed = calloc(nc, 1);
    s->changed = calloc((1 + NS_TERMS) * nz, sizeof *s->changed);
    s->flip = calloc(nc, sizeof *s->flip);
    const int made = s->pieces && s->run && s->input && s->base && s->term && s->begun && s->wave;
    return made && s->command && s->command_index && s->flipped && s->touched && s->heap && s->closed &&
                   s->changed && s->flip
               ? NS_OK
               : NS_E_MEMORY;
}

int ns_schedule_create(const ns_system *system, const unsigned char *acting, ns_schedule **out) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!system)
        return NS_E_NULL;
    ns_schedule *s = calloc(1, sizeof *s);
    if (!s)
        return NS_E_MEMORY;
    s->s = system;
    int status = allocate(s);
    if (status == NS_OK)
        status = cut_lines(s);
    if (status == NS_OK)
        status = take_commands(s);
    if (status != NS_OK) {
        ns_schedule_free(s);
        return status;
    }
    take_inputs(s, acting);
    s->count = s->lines + s->terms + s->commands;
    ns_schedule_seek(s, 0, NS_RIGHT, NULL);
    *out = s;
    return NS_OK;
}

void ns_schedule_free(ns_schedule *s) {
    if (!s)
        return;
    for (int i = 0; s->pieces && i < s->s->nz; i++)
        ns_pieces_free(&s->pieces[i]);
    for (int c = 0; s->command && c < s->commands; c++)
        ns_timed_free(&s->command[c]);
    free(s->pieces);
    free(s->run);
    free(s->input);
    free(s->base);
    free(s->term);
    free(s->begun);
    free(s->wave);
    free(s->command);
    free(s->command_index);
    free(s->flipped);
    free(s->touched);
    free(s->heap);
    free(s->closed);
    free(s->changed);
    free(s->flip);
    free(s);
}

/* --- the heap --- */

static ns_timed *timed(const ns_schedule *s, int id) {
    return &s->command[id - s->lines - s->terms];
}

static double time_of(const ns_schedule *s, int id) {
    if (id < s->lines)
        return s->run[id].next;
    id -= s->lines;
    if (id < s->terms)
        return s->begun[id] ? INFINITY : s->term[id].from;
    return s->command[id - s->terms].next;
}

static void sift(ns_schedule *s, int at, entry e) {
    for (int child; (child = 2 * at + 1) < s->count; at = child) {
        child += child + 1 < s->count && s->heap[child + 1].t < s->heap[child].t;
        if (e.t <= s->heap[child].t)
            break;
        s->heap[at] = s->heap[child];
    }
    s->heap[at] = e;
}

static void first_changed(ns_schedule *s) {
    const int id = s->heap[0].id;
    sift(s, 0, (entry){time_of(s, id), id});
}

/* --- walking --- */

void ns_schedule_seek(ns_schedule *s, double t, ns_side side, const unsigned char *closed) {
    const double a_bit = side == NS_LEFT ? -1 : 1;
    for (int i = 0; i < s->lines; i++)
        ns_run_seek(&s->run[i], t + a_bit * ns_signal_slack(t, s->run[i].line->origin));
    for (int k = 0; k < s->terms; k++)
        s->begun[k] = s->term[k].from <= t + a_bit * ns_signal_slack(t, s->term[k].from);
    for (int c = 0; c < s->commands; c++) {
        const int index = s->command_index[c];
        ns_timed_seek(&s->command[c], t, side, closed ? closed[index] != 0 : -1);
        s->closed[index] = (unsigned char)s->command[c].closed;
    }
    for (int id = 0; id < s->count; id++)
        s->heap[id] = (entry){time_of(s, id), id};
    for (int at = s->count / 2; at-- > 0;)
        sift(s, at, s->heap[at]);
    s->now = t;
    s->instant = (ns_instant){.t = t, .input = s->changed, .flip = s->flip};
}

/* Nothing happens there: a corner of nothing, or a command that is only searched on from there. */
static int is_blank(const ns_schedule *s, int id) {
    double k;
    if (id >= s->lines + s->terms)
        return !timed(s, id)->flips;
    if (id >= s->lines)
        return 0;
    const ns_run *r = &s->run[id];
    const ns_piece *a = ns_run_piece(r), *b = &r->line->piece[ns_run_following(r, &k)];
    return a->end == b->v && a->slope == b->slope;
}

static void go_on(ns_schedule *s, int id, double t) {
    if (id < s->lines)
        ns_run_pass(&s->run[id], t);
    else
        ns_timed_on(timed(s, id));
    first_changed(s);
}

double ns_schedule_next(ns_schedule *s, double until) {
    enum { BLANKS = 1000000 }; /* then one of them is told */
    if (s->count == 0)
        return INFINITY;
    for (int k = 0;
         k < BLANKS && s->heap[0].t <= until && s->heap[0].t < INFINITY && is_blank(s, s->heap[0].id); k++)
        go_on(s, s->heap[0].id, s->heap[0].t);
    return s->heap[0].t <= until ? fmax(s->heap[0].t, s->now) : INFINITY;
}

/* Among the entries at and below one of the heap, those no later than limit. */
static int any_event(const ns_schedule *s, int at, double limit) {
    double k;
    if (at >= s->count || s->heap[at].t > limit)
        return 0;
    const int id = s->heap[at].id;
    const ns_run *r = id < s->lines ? &s->run[id] : NULL;
    const int is = id >= s->lines + s->terms ? timed((ns_schedule *)s, id)->flips
                   : !r                      ? s->term[id - s->lines].jump
                        : ns_run_piece(r)->end != r->line->piece[ns_run_following(r, &k)].v;
    return is || any_event(s, 2 * at + 1, limit) || any_event(s, 2 * at + 2, limit);
}

int ns_schedule_is_event(const ns_schedule *s) {
    if (s->count == 0 || isinf(s->heap[0].t))
        return 0;
    const double now = fmax(s->heap[0].t, s->now);
    return any_event(s, 0, now + ns_signal_slack(now, now));
}

static void pass_corner(ns_schedule *s, int id, double limit) {
    ns_run *r = &s->run[id];
    const ns_piece *from = ns_run_piece(r);
    ns_run_pass(r, limit);
    const ns_piece *to = ns_run_piece(r);
    const int jump = from->end != to->v, turn = from->slope != to->slope;
    s->instant.jump |= jump;
    s->instant.turn |= turn;
    if (jump || turn)
        s->changed[s->instant.inputs++] = s->input[id];
}

static void begin_wave(ns_schedule *s, int k) {
    s->begun[k] = 1;
    s->instant.jump |= s->term[k].jump;
    s->instant.turn = 1;
    s->changed[s->instant.inputs++] = s->term[k].input;
}

/* One that flips again and again within rounding has to wait. */
static void flip_command(ns_schedule *s, int c, double limit, int *touched) {
    enum { OFTEN = 4 };
    ns_timed *x = &s->command[c];
    if (x->flips && s->flipped[c]++ == 0)
        s->touched[(*touched)++] = c;
    ns_timed_on(x);
    if (s->flipped[c] > OFTEN && x->next <= limit) {
        x->next = nextafter(limit + ns_signal_slack(limit, limit), INFINITY);
        x->flips = 0;
    }
}

static void take(ns_schedule *s, int id, double limit, int *touched) {
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
static int together(const ns_schedule *s, double limit) {
    const entry *e = &s->heap[0];
    if (e->t <= limit)
        return 1;
    const int c = e->id - s->lines - s->terms;
    return c >= 0 && s->flipped[c] == 0 && s->command[c].flips && e->t <= limit + s->command[c].window;
}

const ns_instant *ns_schedule_go(ns_schedule *s) {
    int touched = 0;
    if (s->count == 0 || isinf(s->heap[0].t))
        return &s->instant;
    s->now = fmax(s->heap[0].t, s->now);
    s->instant = (ns_instant){.t = s->now, .input = s->changed, .flip = s->flip};
    const double limit = s->now + ns_signal_slack(s->now, s->now);
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

double ns_schedule_time(const ns_schedule *s) {
    return s->now;
}

const unsigned char *ns_schedule_closed(const ns_schedule *s) {
    return s->closed;
}

void ns_schedule_inputs(const ns_schedule *s, double t, double *z, double *dz) {
    for (int i = 0; i < s->lines; i++) {
        z[s->input[i]] = ns_run_value(&s->run[i], t);
        dz[s->input[i]] = ns_run_piece(&s->run[i])->slope;
    }
    for (int i = s->lines; i < s->entering; i++) {
        z[s->input[i]] = s->base[i];
        dz[s->input[i]] = 0;
    }
    for (int k = 0; k < s->terms; k++)
        z[s->term[k].input] += s->begun[k] ? s->term[k].after : s->term[k].before;
}

int ns_schedule_waves(const ns_schedule *s, const ns_wave **wave) {
    *wave = s->wave;
    return s->waves;
}

int ns_schedule_terms(const ns_schedule *s, const ns_wave_term **term) {
    *term = s->term;
    return s->terms;
}

int ns_schedule_term_counts(const ns_schedule *s, int k) {
    return s->begun[k];
}

int ns_schedule_entering(const ns_schedule *s, const int **input) {
    *input = s->input;
    return s->entering;
}
