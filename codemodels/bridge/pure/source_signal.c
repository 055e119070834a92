/* bridge/pure/source_signal.c - V and I sources of ngspice as signals, with ngspice's defaults. */
#include "source_signal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Parameter k, 0 if there are fewer. */
static double number(const ns_source *s, int k) {
    return k < s->order ? s->coeffs[k] : 0.0;
}

/* Parameter k, a voltage or current, of all m sources. */
static double size(const ns_source *s, int k) {
    return s->m * number(s, k);
}

/* Parameter k, a time or frequency, for which 0 stands for ngspice's default. */
static double number_or(const ns_source *s, int k, double instead) {
    return number(s, k) != 0.0 ? number(s, k) : instead;
}

static double positive_or(const ns_source *s, int k, double instead) {
    return number(s, k) > 0.0 ? number(s, k) : instead;
}

/* Parameter k, a time that may be 0. */
static double not_negative_or(const ns_source *s, int k, double instead) {
    return k < s->order && s->coeffs[k] >= 0.0 ? s->coeffs[k] : instead;
}

static void time_pulse(const ns_source *s, ns_signal *z) {
    enum { TO_FALL = 5 }; /* parameters */
    double width = s->tstop, period = width;
    if (s->pulse == PULSE_OF_39) {
        z->u.pulse.tr = number_or(s, 3, s->tstep);
        z->u.pulse.tf = number_or(s, 4, s->tstep);
        z->u.pulse.pw = number_or(s, 5, width);
        z->u.pulse.per = number_or(s, 6, period);
        return;
    }
    if (s->pulse == PULSE_OF_46 || s->order == TO_FALL)
        width = 0.0;
    z->u.pulse.tr = positive_or(s, 3, s->tstep);
    z->u.pulse.tf = positive_or(s, 4, s->tstep);
    z->u.pulse.pw = not_negative_or(s, 5, width);
    if (s->pulse == PULSE_OF_46)
        period = z->u.pulse.tr + z->u.pulse.pw + z->u.pulse.tf;
    z->u.pulse.per = positive_or(s, 6, period);
}

static const char *make_pulse(const ns_source *s, ns_signal *z) {
    const double cycles = number(s, 7);
    if (cycles > 0.0 && (cycles != floor(cycles) || cycles > 1e9))
        return "the number of pulses must be a whole number of at most 1e9";
    z->kind = NS_PULSE;
    z->u.pulse.v1 = size(s, 0);
    z->u.pulse.v2 = size(s, 1);
    z->u.pulse.td = number(s, 2);
    time_pulse(s, z);
    z->u.pulse.cycles = cycles > 0.0 ? (int)cycles : 0;
    return NULL;
}

static const char *make_sine(const ns_source *s, ns_signal *z) {
    z->kind = NS_SIN;
    z->u.sin.vo = size(s, 0);
    z->u.sin.va = size(s, 1);
    z->u.sin.freq = number_or(s, 2, 1.0 / s->tstop);
    z->u.sin.td = number(s, 3);
    z->u.sin.theta = number(s, 4);
    z->u.sin.phase = number(s, 5);
    return NULL;
}

static const char *make_exponential(const ns_source *s, ns_signal *z) {
    z->kind = NS_EXP;
    z->u.exp.v1 = size(s, 0);
    z->u.exp.v2 = size(s, 1);
    z->u.exp.td1 = number_or(s, 2, s->tstep);
    z->u.exp.tau1 = number_or(s, 3, s->tstep);
    z->u.exp.td2 = number_or(s, 4, z->u.exp.td1 + s->tstep);
    z->u.exp.tau2 = number_or(s, 5, s->tstep);
    return NULL;
}

static const char *make_pwl(const ns_source *s, ns_signal *z, double **points) {
    const int n = s->order / 2;
    double *t = n > 0 ? malloc(2 * (size_t)n * sizeof *t) : NULL;
    if (!t)
        return n > 0 ? "out of memory" : "a PWL source needs at least one point";
    for (int i = 0; i < n; i++) {
        t[i] = s->coeffs[2 * i];
        t[n + i] = size(s, 2 * i + 1);
    }
    *points = t;
    z->kind = NS_PWL;
    z->u.pwl.n = n;
    z->u.pwl.t = t;
    z->u.pwl.v = t + n;
    z->u.pwl.td = s->delay;
    z->u.pwl.repeat = s->repeats ? s->coeffs[s->repeat_index] : NAN;
    return NULL;
}

static const char *make_dc(double value, ns_signal *z) {
    memset(z, 0, sizeof *z);
    z->kind = NS_DC;
    z->u.dc = value;
    return NULL;
}

static const char *make_signal(const ns_source *s, ns_signal *z, double **points) {
    switch (s->as_dc && s->dc_given ? SOURCE_DC : s->function) {
    case SOURCE_DC:
        return make_dc(s->m * s->dc, z);
    case SOURCE_PULSE:
        return make_pulse(s, z);
    case SOURCE_SINE:
        return make_sine(s, z);
    case SOURCE_EXP:
        return make_exponential(s, z);
    case SOURCE_PWL:
        return make_pwl(s, z, points);
    default:
        return "this function of a source is not supported; DC, PULSE, SIN, EXP and PWL are";
    }
}

const char *ns_bridge_source_signal(const ns_source *s, ns_signal *z, double **points) {
    const char *why;
    *points = NULL;
    memset(z, 0, sizeof *z);
    why = make_signal(s, z, points);
    if (!why && s->as_dc && z->kind != NS_DC) /* ngspice's DC value is the function's at t = 0 */
        make_dc(ns_signal_value(z, 0.0, NS_LEFT), z);
    return why;
}
