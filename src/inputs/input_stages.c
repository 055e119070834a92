/* src/inputs/input_stages.c - inputs as sums of exponentials between corners; instants of commands. */
#include "input_stages.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "switch_times.h"
#include "system/each_entry.h"

/* Instants of commands are looked for this many times as far as a step reaches. */
static const double look_ahead = 2;

static const double two_pi = 6.28318530717958647693;

static void mark_entering(void *context, int row, int input, double value) {
    ns_input_stages *in = context;
    (void)row;
    (void)value;
    in->enters[input] = 1;
}

/* Marks inputs that more than commands of time depend on. */
static void find_entering(ns_input_stages *in) {
    const ns_system *s = in->s;
    ns_system_each_entry(s->E, NS_CSC_OF(s, E), s->n, s->nz, mark_entering, in);
    ns_system_each_entry(s->F, NS_CSC_OF(s, F), s->m, s->nz, mark_entering, in);
    for (int c = 0; c < s->nc; c++)
        if (!ns_inputs_is_time_only(s, c))
            for (int q = 0; q < ns_inputs_gains(s, c); q++) {
                int input;
                if (ns_inputs_gain(s, c, q, &input) != 0)
                    in->enters[input] = 1;
            }
}

static void find_terms(ns_input_stages *in) {
    double base;
    for (int k = 0; k < in->s->nz; k++)
        in->terms[k] = ns_inputs_wave_terms(&in->s->z[k], in->term[k], in->term_wave[k], &base);
}

int ns_inputs_stages_create(const ns_system *s, ns_input_stages **out) {
    const size_t nz = (size_t)s->nz + 1;
    *out = NULL;
    ns_input_stages *in = calloc(1, sizeof *in);
    if (!in)
        return NS_E_MEMORY;
    in->s = s;
    in->sum = calloc(nz, sizeof *in->sum);
    in->term = calloc(nz, sizeof *in->term);
    in->term_wave = calloc(nz, sizeof *in->term_wave);
    in->max_abs = calloc(nz, sizeof *in->max_abs);
    in->terms = calloc(2 * nz, sizeof(int));
    in->closed = calloc((size_t)s->nc + 1, 1);
    in->enters = calloc(nz, 1);
    const int made = in->sum && in->term && in->term_wave && in->max_abs && in->terms && in->closed;
    if (!made || !in->enters || ns_inputs_events_create(s, NULL, &in->commands) != NS_OK) {
        ns_inputs_stages_free(in);
        return NS_E_MEMORY;
    }
    in->curved = in->terms + nz;
    find_entering(in);
    find_terms(in);
    ns_inputs_stages_reset(in);
    *out = in;
    return NS_OK;
}

void ns_inputs_stages_free(ns_input_stages *in) {
    if (!in)
        return;
    ns_inputs_events_free(in->commands);
    free(in->sum);
    free(in->term);
    free(in->term_wave);
    free(in->max_abs);
    free(in->terms);
    free(in->closed);
    free(in->enters);
    free(in);
}

void ns_inputs_stages_reset(ns_input_stages *in) {
    for (int k = 0; k < in->s->nz; k++)
        in->sum[k].from = INFINITY;
    in->corner = in->first = -INFINITY;
}

int ns_inputs_stages_renew(ns_input_stages *in, int input) {
    ns_inputs_stages_reset(in);
    return ns_inputs_events_renew(NULL, input, &in->commands);
}

/* Adds the exponential of a term that has begun: (cc - i cs) (c + i s) at t. */
static void add_exponential(const ns_wave_term *x, const ns_wave *wave, double t, ns_exp_sum *w) {
    double c, s;
    ns_inputs_wave_at(wave, fmax(t, wave->td), &c, &s);
    w->c[w->count][0] = x->cc * c + x->cs * s;
    w->c[w->count][1] = x->cc * s - x->cs * c;
    w->s[w->count][0] = -wave->theta;
    w->s[w->count][1] = two_pi * wave->freq;
    w->value -= w->c[w->count++][0];
}

static void expand_input(ns_input_stages *in, int k, double t) {
    const ns_signal *s = &in->s->z[k];
    ns_exp_sum *w = &in->sum[k];
    *w = (ns_exp_sum){
        .from = t, .until = ns_signal_next_corner(s, t), .value = ns_signal_value(s, t, NS_RIGHT)};
    if (ns_signal_is_linear(s) && isfinite(w->until))
        w->slope = (ns_signal_value(s, w->until, NS_LEFT) - w->value) / (w->until - t);
    for (int i = 0; i < in->terms[k]; i++)
        if (t >= in->term[k][i].from - ns_system_signal_time_error(t, in->term[k][i].from))
            add_exponential(&in->term[k][i], &in->term_wave[k][i], t, w);
}

/* The sum of the sizes of its exponentials. */
static double size_of_exponentials(const ns_exp_sum *w) {
    double size = 0;
    for (int e = 0; e < w->count; e++)
        size += hypot(w->c[e][0], w->c[e][1]);
    return size;
}

void ns_inputs_stages_at(ns_input_stages *in, double t) {
    in->corner = INFINITY;
    in->late = 0;
    in->ncurved = 0;
    for (int k = 0; k < in->s->nz; k++) {
        ns_exp_sum *w = &in->sum[k];
        if (!(w->from <= t && t < w->until) || (w->count > 0 && w->from != t))
            expand_input(in, k, t);
        if (!in->enters[k])
            continue;
        in->corner = fmin(in->corner, w->until);
        if (w->count > 0 || w->slope != 0)
            in->curved[in->ncurved++] = k;
        if (w->count > 0)
            in->max_abs[k] = fmax(in->max_abs[k], fabs(w->value) + size_of_exponentials(w));
    }
}

/* The share of exponential e in stage i: Re c u (g s u)^i with u = 1/(1 - g s). */
static double stage_of_exponential(const ns_exp_sum *w, int e, double g, int i) {
    const double re = 1 - g * w->s[e][0], im = -g * w->s[e][1], of = re * re + im * im;
    const double u[2] = {re / of, -im / of};
    const double gs[2] = {g * w->s[e][0], g * w->s[e][1]};
    const double d[2] = {gs[0] * u[0] - gs[1] * u[1], gs[0] * u[1] + gs[1] * u[0]};
    double c[2] = {w->c[e][0] * u[0] - w->c[e][1] * u[1], w->c[e][0] * u[1] + w->c[e][1] * u[0]};
    for (int k = 0; k < i; k++) {
        const double next = c[0] * d[0] - c[1] * d[1];
        c[1] = c[0] * d[1] + c[1] * d[0];
        c[0] = next;
    }
    return c[0];
}

double ns_inputs_stages_error(const ns_input_stages *in, double g, int order) {
    double worst = 0;
    for (int k = 0; k < in->ncurved; k++) {
        const ns_exp_sum *w = &in->sum[in->curved[k]];
        for (int e = 0; e < w->count; e++) { /* D = g s / (1 - g s) */
            const double re = g * w->s[e][0], im = g * w->s[e][1];
            const double d2 = (re * re + im * im) / ((1 - re) * (1 - re) + im * im);
            const double of = hypot(w->c[e][0], w->c[e][1]) / in->max_abs[in->curved[k]];
            worst = fmax(worst, of * pow(d2, 0.5 * (order + 1)));
        }
    }
    return worst;
}

double ns_inputs_stages_steepest(const ns_input_stages *in, double g) {
    double most = 0;
    for (int k = 0; k < in->ncurved; k++) {
        const ns_exp_sum *w = &in->sum[in->curved[k]];
        const double end = w->value + w->slope * (w->until - w->from);
        if (w->slope != 0)
            most = fmax(most, fabs(w->slope) * g / fmax(fabs(w->value), fabs(end)));
    }
    return most;
}

/* after: the time since w begins, s */
static double stage_of_input(const ns_exp_sum *w, double after, double g, int i) {
    double z = i == 0 ? w->value + w->slope * (after + g) : i == 1 ? w->slope * g : 0;
    for (int e = 0; e < w->count; e++)
        z += stage_of_exponential(w, e, g, i);
    return z;
}

int ns_inputs_stages_stage(const ns_input_stages *in, double t, double g, int i, double *z) {
    int any = 0;
    if (i > 0) {
        memset(z, 0, sizeof(double) * (size_t)in->s->nz);
        for (int k = 0; k < in->ncurved; k++) {
            z[in->curved[k]] = stage_of_input(&in->sum[in->curved[k]], 0, g, i);
            any |= z[in->curved[k]] != 0;
        }
        return any;
    }
    for (int k = 0; k < in->s->nz; k++) {
        z[k] = stage_of_input(&in->sum[k], t - in->sum[k].from + in->late, g, 0);
        any |= z[k] != 0;
    }
    return any;
}

void ns_inputs_stages_find_command(ns_input_stages *in, double t, double h, const ns_mode *mode) {
    if (in->first == -INFINITY) {
        for (int c = 0; c < in->s->nc; c++)
            in->closed[c] = mode[in->s->command[c].pair] == NS_INSIDE;
        ns_inputs_events_seek(in->commands, t, NS_RIGHT, in->closed);
    }
    in->first = ns_inputs_events_next(in->commands, t + look_ahead * h);
}

int ns_inputs_stages_flip_commands(ns_input_stages *in, double t, ns_mode *mode, double *sum) {
    int count = 0;
    while (ns_inputs_events_next(in->commands, t) <= t) {
        const ns_time_event *event = ns_inputs_events_pass(in->commands);
        for (int k = 0; k < event->flips; k++) {
            ns_mode *of = &mode[in->s->command[event->flip[k]].pair];
            *of = *of == NS_INSIDE ? NS_LOWER : NS_INSIDE;
        }
        count += event->flips;
        *sum += event->t * event->flips;
    }
    return count;
}
