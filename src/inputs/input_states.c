/* src/inputs/input_states.c - the inputs as states of their own. */
#include "input_states.h"

#include <math.h>
#include <stdlib.h>

#include "time_events_internal.h"

static const double two_pi = 6.283185307179586476925286766559;

/* Adds a state, or finds the one that is there; z_k gets `gain` times it. */
static void add_state(ns_input_states *e, int k, ns_input_state want, double gain) {
    int i = 0;
    while (i < e->nv && !(e->state[i].kind == want.kind && e->state[i].input == want.input &&
                          e->state[i].from == want.from && e->state[i].wave.freq == want.wave.freq &&
                          e->state[i].wave.theta == want.wave.theta && e->state[i].wave.td == want.wave.td))
        i++;
    if (i == e->nv)
        e->state[e->nv++] = want;
    e->Z[k + e->s->nz * i] += gain;
}

static int has_ramps(const ns_broken_line *p) {
    for (int i = 1; i <= p->n; i++)
        if (p->piece[i].slope != 0)
            return 1;
    return 0;
}

static void add_line(ns_input_states *e, int k, const ns_broken_line *p) {
    if (e->s->z[k].kind == NS_DC) {
        add_state(e, k, (ns_input_state){.kind = NS_STATE_ONE}, e->s->z[k].u.dc);
        return;
    }
    add_state(e, k, (ns_input_state){.kind = NS_STATE_VALUE, .input = k}, 1);
    if (has_ramps(p)) /* right behind its value */
        add_state(e, k, (ns_input_state){.kind = NS_STATE_SLOPE, .input = k}, 0);
}

static void add_term(ns_input_states *e, const ns_wave_term *x, const ns_wave *wave) {
    ns_input_state state = {
        .kind = NS_STATE_DECAY, .wave = *wave, .omega = two_pi * wave->freq, .from = x->from};
    if (wave->freq == 0) {
        add_state(e, x->input, state, x->cc);
        return;
    }
    state.kind = NS_STATE_COS;
    add_state(e, x->input, state, x->cc);
    state.kind = NS_STATE_SIN;
    add_state(e, x->input, state, x->cs);
}

/* What is left beside its waves is constant once all have begun; until then it is a value. */
static void add_curve(ns_input_states *e, const ns_time_events *events, int at) {
    const int k = events->input[at];
    double begins = -INFINITY, rest = events->base[at];
    for (int i = 0; i < events->terms; i++) {
        const ns_wave_term *x = &events->term[i];
        if (x->input != k)
            continue;
        add_term(e, x, &events->wave[x->wave]);
        rest += x->after;
        begins = fmax(begins, x->from);
    }
    if (begins > 0) {
        add_state(e, k, (ns_input_state){.kind = NS_STATE_VALUE, .input = k}, 1);
    } else {
        add_state(e, k, (ns_input_state){.kind = NS_STATE_ONE}, rest);
        e->from = fmax(e->from, begins);
    }
}

static int has_ramp_signal(const ns_signal *s) {
    for (int i = 1; i < s->u.pwl.n; i++)
        if (s->u.pwl.v[i] != s->u.pwl.v[i - 1] && s->u.pwl.t[i] != s->u.pwl.t[i - 1])
            return 1;
    return 0;
}

int ns_inputs_states_has(const ns_input_states *e, int input) {
    for (int i = 0; i < e->nv; i++)
        if ((e->state[i].kind == NS_STATE_VALUE || e->state[i].kind == NS_STATE_SLOPE) &&
            e->state[i].input == input)
            return 1;
    return 0;
}

int ns_inputs_states_can_be(const ns_input_states *e, int input) {
    int value = 0, slope = 0;
    for (int i = 0; i < e->nv; i++) {
        value |= e->state[i].kind == NS_STATE_VALUE && e->state[i].input == input;
        slope |= e->state[i].kind == NS_STATE_SLOPE && e->state[i].input == input;
    }
    return slope || !value || !has_ramp_signal(&e->s->z[input]);
}

static int drives(const ns_system *s, int k) {
    for (int i = 0; i < s->n; i++)
        if (s->E[i + k * s->n] != 0)
            return 1;
    for (int j = 0; j < s->m; j++)
        if (s->F[j + k * s->m] != 0)
            return 1;
    return 0;
}

static void list_output_only(ns_input_states *e, const ns_time_events *events) {
    for (int k = 0; k < e->s->nz; k++) {
        int enters = 0;
        for (int i = 0; i < events->entering; i++)
            enters |= events->input[i] == k;
        if (!enters && drives(e->s, k))
            e->output_only_input[e->output_only_inputs++] = k;
    }
}

int ns_inputs_states_create(const ns_system *s, const ns_time_events *events, ns_input_states **out) {
    ns_input_states *e = calloc(1, sizeof *e);
    const size_t nz = (size_t)s->nz, most = 4 * nz + 1;
    *out = NULL;
    if (!e)
        return NS_E_MEMORY;
    e->s = s;
    e->from = -INFINITY;
    e->state = calloc(most, sizeof *e->state);
    e->Z = calloc(nz * most + 1, sizeof *e->Z);
    e->output_only_input = calloc(nz + 1, sizeof *e->output_only_input);
    if (!e->state || !e->Z || !e->output_only_input) {
        ns_inputs_states_free(e);
        return NS_E_MEMORY;
    }
    e->nv = 1; /* ONE */
    for (int i = 0; i < events->lines; i++)
        add_line(e, events->input[i], events->cursor[i].line);
    for (int i = events->lines; i < events->entering; i++)
        add_curve(e, events, i);
    list_output_only(e, events);
    *out = e;
    return NS_OK;
}

void ns_inputs_states_free(ns_input_states *e) {
    if (!e)
        return;
    free(e->output_only_input);
    free(e->state);
    free(e->Z);
    free(e);
}

/* t is at or beyond `from`, but for what a corner loses in rounding. */
static int has_begun(double t, double from) {
    return t - from >= -ns_system_signal_time_error(t, from);
}

void ns_inputs_states_at(const ns_input_states *e, double t, const double *z, const double *dz, double *v) {
    for (int i = 0; i < e->nv; i++) {
        const ns_input_state *is = &e->state[i];
        double c = 0, s = 0;
        if (is->kind >= NS_STATE_DECAY && has_begun(t, is->from))
            ns_inputs_wave_at(&is->wave, t, &c, &s);
        v[i] = is->kind == NS_STATE_ONE     ? 1
               : is->kind == NS_STATE_VALUE ? z[is->input]
               : is->kind == NS_STATE_SLOPE ? dz[is->input]
                                            : c;
        if (is->kind == NS_STATE_COS) /* its SIN follows */
            v[++i] = s;
    }
}

/* (c, s) times the number re + i im. */
static void rotate(double re, double im, double *v) {
    const double c = v[0], s = v[1];
    v[0] = re * c - im * s;
    v[1] = re * s + im * c;
}

void ns_inputs_states_stage(const ns_input_states *e, double g, double *v) {
    for (int i = 0; i < e->nv; i++) {
        const ns_input_state *is = &e->state[i];
        const double re = 1 + g * is->wave.theta, im = g * is->omega;
        if (is->kind == NS_STATE_SLOPE)
            v[i - 1] += g * v[i];
        else if (is->kind == NS_STATE_DECAY)
            v[i] /= re;
        else if (is->kind == NS_STATE_COS)
            rotate(re / (re * re + im * im), im / (re * re + im * im), v + i);
    }
}

void ns_inputs_states_advance(const ns_input_states *e, double h, double *v) {
    for (int i = 0; i < e->nv; i++) {
        const ns_input_state *is = &e->state[i];
        const double size = is->wave.theta == 0 ? 1 : exp(-is->wave.theta * h);
        if (is->kind == NS_STATE_SLOPE)
            v[i - 1] += h * v[i];
        else if (is->kind == NS_STATE_DECAY)
            v[i] *= size;
        else if (is->kind == NS_STATE_COS)
            rotate(size * cos(is->omega * h), size * sin(is->omega * h), v + i);
    }
}

double ns_inputs_states_slope(const ns_input_states *e, int i, const double *v) {
    const ns_input_state *is = &e->state[i];
    switch (is->kind) {
    case NS_STATE_VALUE:
        return i + 1 < e->nv && e->state[i + 1].kind == NS_STATE_SLOPE ? v[i + 1] : 0;
    case NS_STATE_DECAY:
        return -is->wave.theta * v[i];
    case NS_STATE_COS:
        return -is->wave.theta * v[i] - is->omega * v[i + 1];
    case NS_STATE_SIN:
        return -is->wave.theta * v[i] + is->omega * v[i - 1];
    default:
        return 0;
    }
}
