/* src/inputs/switch_times.c - commands that depend on time only: made, and flips of a single line from a
 * table.
 */
#include "switch_times.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* --- the inputs that act on a command --- */

static void widen_bounds(ns_switch_times *c, double a, double b) {
    c->least += fmin(a, b);
    c->most += fmax(a, b);
}

static void add_line(ns_switch_times *c, double gain, const ns_broken_line *p) {
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i <= p->n + 1; i++) {
        low = fmin(low, fmin(p->piece[i].v, p->piece[i].end));
        high = fmax(high, fmax(p->piece[i].v, p->piece[i].end));
    }
    widen_bounds(c, gain * low, gain * high);
    c->line[c->lines++] = (ns_switch_line){gain, {.line = p}};
}

static void add_curve(ns_switch_times *c, double gain, const ns_signal *s) {
    ns_wave_term term[NS_TERMS];
    ns_wave wave[NS_TERMS];
    double base;
    const int count = ns_inputs_wave_terms(s, term, wave, &base);
    c->g0 += gain * base;
    widen_bounds(c, gain * base, gain * base);
    for (int k = 0; k < count; k++) {
        ns_wave_term *x = &term[k];
        x->before *= gain;
        x->after *= gain;
        x->cc *= gain;
        x->cs *= gain;
        const double size = hypot(x->cc, x->cs), most = wave[k].theta < 0 ? INFINITY : size;
        widen_bounds(c, fmin(x->before, x->after - most), fmax(x->before, x->after + most));
        c->term[c->terms++] = (ns_switch_term){*x, wave[k], size};
    }
}

static int allocate_terms(ns_switch_times *c, int lines, int curves) {
    c->line = calloc((size_t)lines + 1, sizeof *c->line);
    c->term = calloc((size_t)curves * NS_TERMS + 1, sizeof *c->term);
    return c->line && c->term ? NS_OK : NS_E_MEMORY;
}

/* --- the table of a single line --- */

static double control_at(const ns_switch_times *c, double v, double *size) {
    const double term = c->line->gain * v;
    *size = fabs(c->g0) + fabs(term);
    return c->g0 + term;
}

/* Piece i of line p and a switch in this state. */
static ns_switch_flip flip_in_piece(const ns_switch_times *c, const ns_broken_line *p, int i, int closed) {
    const ns_line_piece *a = &p->piece[i];
    double size_left, size_right;
    const double left = ns_inputs_switch_excess(c, control_at(c, a->v, &size_left), closed);
    const double right = ns_inputs_switch_excess(c, control_at(c, a->end, &size_right), closed);
    if (left > NS_CONTROL_TOL * size_left)
        return (ns_switch_flip){a->t, 0, 0};
    if (!(right > NS_CONTROL_TOL * size_right))
        return (ns_switch_flip){NAN, 0, 0};
    const double rate = fabs(c->line->gain * a->slope);
    return (ns_switch_flip){a->t + fmax(0, -left) / rate, NS_CONTROL_TOL * size_right / rate, 0};
}

static int tabulate_flips(ns_switch_times *c) {
    const ns_broken_line *p = c->line->run.line;
    const size_t count = (size_t)p->n + 2;
    c->flip[0] = calloc(2 * count, sizeof *c->flip[0]);
    if (!c->flip[0])
        return NS_E_MEMORY;
    c->flip[1] = c->flip[0] + count;
    for (int closed = 0; closed < 2; closed++) {
        ns_switch_flip *flip = c->flip[closed];
        int later = 0;
        for (int i = p->n + 1; i >= 0; i--) {
            flip[i] = flip_in_piece(c, p, i, closed);
            flip[i].later = later;
            if (i <= p->n && !isnan(flip[i].t))
                later = i;
        }
    }
    return NS_OK;
}

/* To piece i of repetition k, which flips the switch. */
static void set_next(ns_switch_times *c, double k, int i) {
    ns_line_cursor *r = &c->line->run;
    const ns_switch_flip *f = &c->flip[c->closed][i];
    r->k = k;
    r->i = i;
    c->next = r->line->origin + (k * r->line->period + f->t);
    c->window = f->window;
    c->flips = 1;
}

/* To the next piece after the present one that flips the switch. */
static void find_later_flip(ns_switch_times *c) {
    const ns_line_cursor *r = &c->line->run;
    const ns_broken_line *p = r->line;
    const ns_switch_flip *flip = c->flip[c->closed];
    const int again = isnan(flip[p->from].t) ? flip[p->from].later : p->from;
    c->flips = 0;
    c->next = INFINITY;
    if (r->i <= p->n && flip[r->i].later > 0)
        set_next(c, r->k, flip[r->i].later);
    else if (r->i <= p->n && p->period > 0 && r->k + 1 < p->cycles && again > 0)
        set_next(c, r->k + 1, again);
    else if (r->i <= p->n && p->period > 0 && isfinite(p->cycles) && !isnan(flip[p->n + 1].t))
        set_next(c, p->cycles, p->n + 1);
}

/* In the rest of the present piece, or later. */
static void find_flip(ns_switch_times *c, double t) {
    const ns_line_cursor *r = &c->line->run;
    const ns_switch_flip *f = &c->flip[c->closed][r->i];
    const double slack = ns_system_signal_time_error(t, r->line->origin);
    const int inside = f->window > 0 || f->t > r->line->piece[r->i].t; /* not where the piece begins */
    if (inside || (!isnan(f->t) && r->t >= t - slack)) {
        set_next(c, r->k, r->i);
        c->next = fmax(c->next, t);
    } else
        find_later_flip(c);
}

/* --- all of them --- */

int ns_inputs_switch_create(const ns_system *s, int command, const ns_broken_line *line, ns_switch_times *c) {
    const ns_command *k = &s->command[command];
    const int gains = ns_inputs_gains(s, command);
    int curves = 0, input;
    *c = (ns_switch_times){.on = k->on, .off = k->off, .g0 = k->g0, .least = k->g0, .most = k->g0};
    for (int q = 0; q < gains; q++)
        curves += ns_inputs_gain(s, command, q, &input) != 0 && !ns_signal_is_linear(&s->z[input]);
    if (allocate_terms(c, gains, curves) != NS_OK)
        return NS_E_MEMORY;
    for (int q = 0; q < gains; q++) {
        const double gain = ns_inputs_gain(s, command, q, &input);
        if (gain != 0 && ns_signal_is_linear(&s->z[input]))
            add_line(c, gain, &line[input]);
        else if (gain != 0)
            add_curve(c, gain, &s->z[input]);
    }
    return c->lines == 1 && c->terms == 0 && c->line->run.line ? tabulate_flips(c) : NS_OK;
}

void ns_inputs_switch_free(ns_switch_times *c) {
    free(c->line);
    free(c->term);
    free(c->flip[0]);
    *c = (ns_switch_times){0};
}

void ns_inputs_switch_seek(ns_switch_times *c, double t, ns_side side, int closed) {
    const double sign = side == NS_LEFT ? -1 : 1;
    c->t = t + sign * ns_system_signal_time_error(t, t);
    for (int i = 0; i < c->lines; i++) {
        ns_line_cursor *r = &c->line[i].run;
        ns_system_line_seek(r, t + sign * ns_system_signal_time_error(t, r->line->origin));
    }
    const ns_switch_control v = ns_inputs_switch_control(c, t, t);
    const double rounding = NS_CONTROL_TOL * v.size + fabs(v.slope) * ns_system_signal_time_error(t, t);
    if (closed < 0)
        closed = ns_inputs_switch_excess(c, v.g, 0) > rounding;
    c->closed = closed;
    c->fresh = side == NS_RIGHT; /* what is beyond it by less is rounding */
    c->window = 0;
    c->t = t;
    if (ns_inputs_switch_excess(c, v.g, closed) > rounding) {
        c->next = t;
        c->flips = 1;
    } else if (c->flip[0])
        find_flip(c, t);
    else
        ns_inputs_switch_search(c);
}

void ns_inputs_switch_pass(ns_switch_times *c) {
    c->t = c->next;
    c->closed ^= c->flips;
    c->fresh = c->flips;
    if (!c->flip[0]) {
        ns_inputs_switch_search(c);
        return;
    }
    if (!c->flips) {
        ns_inputs_switch_seek(c, c->t, NS_RIGHT, c->closed);
        return;
    }
    /* the piece may come down again, after a jump that began it */
    const ns_switch_flip *f = &c->flip[c->closed][c->line->run.i];
    const ns_broken_line *p = c->line->run.line;
    if (!isnan(f->t) && p->origin + (c->line->run.k * p->period + f->t) > c->t)
        set_next(c, c->line->run.k, c->line->run.i);
    else
        find_later_flip(c);
}

const ns_line_cursor *ns_inputs_switch_repeats(const ns_switch_times *c) {
    const ns_line_cursor *r = &c->line->run;
    return c->flip[0] && c->flips && ns_system_line_repeats(r) ? r : NULL;
}

void ns_inputs_switch_skip(ns_switch_times *c, double repetitions) {
    ns_line_cursor *r = &c->line->run;
    set_next(c, r->k + repetitions, r->i);
}
