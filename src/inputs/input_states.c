/* src/inputs/input_states.c - the inputs as states of their own. */
#include "input_states.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const double two_pi = 6.283185307179586476925286766559;

/* Adds a state, or finds the one that is there; z_k gets `by` of it. */
static int state_of(ns_input_states *e, const ns_input_state *want) {
    for (int i = 0; i < e->nv; i++) {
        const ns_input_state *is = &e->state[i];
        if (is->kind == want->kind && is->input == want->input && is->decay == want->decay &&
            is->omega == want->omega && is->from == want->from)
            return i;
    }
    e->state[e->nv] = *want;
    return e->nv++;
}

static void add(ns_input_states *e, int k, ns_input_state want, double by) {
    e->Z[k + e->s->nz * state_of(e, &want)] += by;
}

static int has_ramps(const ns_signal *z) {
    if (z->kind == NS_PULSE)
        return z->u.pulse.v1 != z->u.pulse.v2 && (z->u.pulse.tr > 0 || z->u.pulse.tf > 0);
    for (int i = 1; i < z->u.pwl.n; i++)
        if (z->u.pwl.t[i] > z->u.pwl.t[i - 1] && z->u.pwl.v[i] != z->u.pwl.v[i - 1])
            return 1;
    return 0;
}

/* The offset is a value until td, as it is another one before. */
static void add_sine(ns_input_states *e, int k) {
    const ns_signal *z = &e->s->z[k];
    const double phi = z->u.sin.phase * two_pi / 360, td = z->u.sin.td;
    ns_input_state pair = {NS_EXO_COS, -1, z->u.sin.theta, two_pi * z->u.sin.freq, td};
    add(e, k, pair, z->u.sin.va * sin(phi));
    pair.kind = NS_EXO_SIN;
    add(e, k, pair, z->u.sin.va * cos(phi));
    if (td > 0) {
        add(e, k, (ns_input_state){.kind = NS_EXO_VALUE, .input = k}, 1);
    } else {
        add(e, k, (ns_input_state){.kind = NS_EXO_ONE}, z->u.sin.vo);
        e->from = fmax(e->from, td);
    }
}

static void add_exponential(ns_input_states *e, int k) {
    const ns_signal *z = &e->s->z[k];
    const double rise = z->u.exp.v2 - z->u.exp.v1;
    add(e, k, (ns_input_state){.kind = NS_EXO_VALUE, .input = k}, 1);
    add(e, k, (ns_input_state){NS_EXO_DECAY, -1, 1 / z->u.exp.tau1, 0, z->u.exp.td1}, -rise);
    add(e, k, (ns_input_state){NS_EXO_DECAY, -1, 1 / z->u.exp.tau2, 0, z->u.exp.td2}, rise);
}

static void add_input(ns_input_states *e, int k) {
    const ns_signal *z = &e->s->z[k];
    if (z->kind == NS_DC) {
        add(e, k, (ns_input_state){.kind = NS_EXO_ONE}, z->u.dc);
    } else if (z->kind == NS_SIN) {
        add_sine(e, k);
    } else if (z->kind == NS_EXP) {
        add_exponential(e, k);
    } else {
        add(e, k, (ns_input_state){.kind = NS_EXO_VALUE, .input = k}, 1);
        if (has_ramps(z)) /* right behind its value */
            add(e, k, (ns_input_state){.kind = NS_EXO_SLOPE, .input = k}, 0);
    }
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

static void list_mutes(ns_input_states *e, int entering, const int *input) {
    for (int k = 0; k < e->s->nz; k++) {
        int enters = 0;
        for (int i = 0; i < entering; i++)
            enters |= input[i] == k;
        if (!enters && drives(e->s, k))
            e->mute[e->mutes++] = k;
    }
}

int ns_inputs_states_create(const ns_system *s, int entering, const int *input, ns_input_states **out) {
    ns_input_states *e = calloc(1, sizeof *e);
    const size_t nz = (size_t)s->nz, most = 4 * nz + 1;
    *out = NULL;
    if (!e)
        return NS_E_MEMORY;
    e->s = s;
    e->from = -INFINITY;
    e->state = calloc(most, sizeof *e->state);
    e->Z = calloc(nz * most + 1, sizeof *e->Z);
    e->mute = calloc(nz + 1, sizeof *e->mute);
    if (!e->state || !e->Z || !e->mute) {
        ns_inputs_states_free(e);
        return NS_E_MEMORY;
    }
    e->nv = 1; /* ONE */
    for (int i = 0; i < entering; i++)
        add_input(e, input[i]);
    list_mutes(e, entering, input);
    *out = e;
    return NS_OK;
}

void ns_inputs_states_free(ns_input_states *e) {
    if (!e)
        return;
    free(e->mute);
    free(e->state);
    free(e->Z);
    free(e);
}

/* t is at or beyond `from`, but for what a corner loses in rounding. */
static int begun(double t, double from) {
    return t - from >= -8 * DBL_EPSILON * fmax(fabs(t), fabs(from));
}

static double wave_at(const ns_input_state *is, double t) {
    if (!begun(t, is->from))
        return 0;
    const double phase = is->omega * (t - is->from),
                 size = is->decay == 0 ? 1 : exp(-is->decay * (t - is->from));
    return is->kind == NS_EXO_DECAY ? size : size * (is->kind == NS_EXO_COS ? cos(phase) : sin(phase));
}

void ns_inputs_states_at(const ns_input_states *e, double t, const double *z, const double *dz, double *v) {
    for (int i = 0; i < e->nv; i++) {
        const ns_input_state *is = &e->state[i];
        v[i] = is->kind == NS_EXO_ONE     ? 1
               : is->kind == NS_EXO_VALUE ? z[is->input]
               : is->kind == NS_EXO_SLOPE ? dz[is->input]
                                          : wave_at(is, t);
    }
}

/* (c, s) times the number re + i im. */
static void turn(double re, double im, double *v) {
    const double c = v[0], s = v[1];
    v[0] = re * c - im * s;
    v[1] = re * s + im * c;
}

void ns_inputs_states_stage(const ns_input_states *e, double g, double *v) {
    for (int i = 0; i < e->nv; i++) {
        const ns_input_state *is = &e->state[i];
        const double re = 1 + g * is->decay, im = g * is->omega;
        if (is->kind == NS_EXO_SLOPE)
            v[i - 1] += g * v[i];
        else if (is->kind == NS_EXO_DECAY)
            v[i] /= re;
        else if (is->kind == NS_EXO_COS)
            turn(re / (re * re + im * im), im / (re * re + im * im), v + i);
    }
}

void ns_inputs_states_advance(const ns_input_states *e, double h, double *v) {
    for (int i = 0; i < e->nv; i++) {
        const ns_input_state *is = &e->state[i];
        const double size = is->decay == 0 ? 1 : exp(-is->decay * h);
        if (is->kind == NS_EXO_SLOPE)
            v[i - 1] += h * v[i];
        else if (is->kind == NS_EXO_DECAY)
            v[i] *= size;
        else if (is->kind == NS_EXO_COS)
            turn(size * cos(is->omega * h), size * sin(is->omega * h), v + i);
    }
}

double ns_inputs_states_slope(const ns_input_states *e, int i, const double *v) {
    const ns_input_state *is = &e->state[i];
    switch (is->kind) {
    case NS_EXO_VALUE:
        return i + 1 < e->nv && e->state[i + 1].kind == NS_EXO_SLOPE ? v[i + 1] : 0;
    case NS_EXO_DECAY:
        return -is->decay * v[i];
    case NS_EXO_COS:
        return -is->decay * v[i] - is->omega * v[i + 1];
    case NS_EXO_SIN:
        return -is->decay * v[i] + is->omega * v[i - 1];
    default:
        return 0;
    }
}
