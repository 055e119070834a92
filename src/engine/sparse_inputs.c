/* src/engine/sparse_inputs.c - inputs as sums of exponentials between corners; instants of commands. */
#include "sparse_inputs.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "laguerre.h"
#include "marcher.h"

static const double control_tol = 1e-12; /* as in control.c */

int ns_inputs_create(const ns_system *s, const ns_form *f, ns_inputs **out) {
    const size_t nz = (size_t)s->nz, nc = (size_t)s->nc;
    *out = NULL;
    ns_inputs *in = calloc(1, sizeof *in);
    if (!in)
        return NS_E_MEMORY;
    in->s = s;
    in->f = f;
    in->wave = calloc(nz + 1, sizeof *in->wave);
    in->review = calloc(2 * nc + 2 * nz + 1, sizeof(double));
    in->curved = calloc(nz + 1, sizeof(int));
    if (!in->wave || !in->review || !in->curved) {
        ns_inputs_free(in);
        return NS_E_MEMORY;
    }
    in->instant = in->review + nc;
    in->work = in->instant + nc;
    in->most = in->work + nz;
    ns_inputs_reset(in);
    *out = in;
    return NS_OK;
}

void ns_inputs_free(ns_inputs *in) {
    if (!in)
        return;
    free(in->wave);
    free(in->review);
    free(in->curved);
    free(in);
}

void ns_inputs_reset(ns_inputs *in) {
    for (int k = 0; k < in->s->nz; k++)
        in->wave[k].from = INFINITY;
    for (int c = 0; c < in->s->nc; c++)
        in->review[c] = -INFINITY;
    in->corner = in->first = -INFINITY;
}

static void exponential(ns_swing *w, double c_re, double c_im, double s_re, double s_im) {
    w->c[w->count][0] = c_re;
    w->c[w->count][1] = c_im;
    w->s[w->count][0] = s_re;
    w->s[w->count++][1] = s_im;
}

static void take_sine(const ns_signal *s, double t, ns_swing *w) {
    static const double pi = 3.14159265358979323846;
    const double since = t - s->u.sin.td, turns = s->u.sin.freq * since + s->u.sin.phase / 360;
    if (w->until == s->u.sin.td) /* at rest before it */
        return;
    const double angle = 2 * pi * (turns - floor(turns)), damped = exp(-since * s->u.sin.theta);
    const double size = s->u.sin.va * (s->u.sin.theta != 0 ? damped : 1);
    exponential(w, size * sin(angle), -size * cos(angle), -s->u.sin.theta, 2 * pi * s->u.sin.freq);
}

static void take_exp(const ns_signal *s, double t, ns_swing *w) {
    const double v = s->u.exp.v2 - s->u.exp.v1, d = 8 * DBL_EPSILON;
    const double one = t - s->u.exp.td1 + d * fabs(s->u.exp.td1),
                 two = t - s->u.exp.td2 + d * fabs(s->u.exp.td2);
    if (one < 0)
        return;
    exponential(w, -v * exp(-fmax(0, t - s->u.exp.td1) / s->u.exp.tau1), 0, -1 / s->u.exp.tau1, 0);
    if (two >= 0)
        exponential(w, v * exp(-fmax(0, t - s->u.exp.td2) / s->u.exp.tau2), 0, -1 / s->u.exp.tau2, 0);
}

static void take(const ns_signal *s, double t, ns_swing *w) {
    *w =
        (ns_swing){.from = t, .until = ns_signal_next_corner(s, t), .value = ns_signal_value(s, t, NS_RIGHT)};
    if (s->kind == NS_SIN)
        take_sine(s, t, w);
    else if (s->kind == NS_EXP)
        take_exp(s, t, w);
    else if (isfinite(w->until))
        w->slope = (ns_signal_value(s, w->until, NS_LEFT) - w->value) / (w->until - t);
    for (int i = 0; i < w->count; i++)
        w->value -= w->c[i][0];
}

/* The sum of the sizes of its exponentials. */
static double size_of(const ns_swing *w) {
    double size = 0;
    for (int e = 0; e < w->count; e++)
        size += hypot(w->c[e][0], w->c[e][1]);
    return size;
}

void ns_inputs_at(ns_inputs *in, double t) {
    in->corner = INFINITY;
    in->ncurved = 0;
    for (int k = 0; k < in->s->nz; k++) {
        ns_swing *w = &in->wave[k];
        if (!(w->from <= t && t < w->until) || (w->count > 0 && w->from != t))
            take(&in->s->z[k], t, w);
        in->corner = fmin(in->corner, w->until);
        if (w->count > 0 || w->slope != 0)
            in->curved[in->ncurved++] = k;
        if (w->count > 0)
            in->most[k] = fmax(in->most[k], fabs(w->value) + size_of(w));
    }
}

/* The share of exponential e in stage i: Re c u (g s u)^i with u = 1/(1 - g s). */
static double decayed(const ns_swing *w, int e, double g, int i) {
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

double ns_inputs_error(const ns_inputs *in, double g) {
    double worst = 0;
    for (int k = 0; k < in->ncurved; k++) {
        const ns_swing *w = &in->wave[in->curved[k]];
        for (int e = 0; e < w->count; e++) { /* D = g s / (1 - g s) */
            const double re = g * w->s[e][0], im = g * w->s[e][1];
            const double d2 = (re * re + im * im) / ((1 - re) * (1 - re) + im * im);
            const double of = hypot(w->c[e][0], w->c[e][1]) / in->most[in->curved[k]];
            worst = fmax(worst, of * pow(d2, 0.5 * (NS_ORDER + 1)));
        }
    }
    return worst;
}

static double in_stage(const ns_swing *w, double t, double g, int i) {
    double z = i == 0 ? w->value + w->slope * (t - w->from + g) : i == 1 ? w->slope * g : 0;
    for (int e = 0; e < w->count; e++)
        z += decayed(w, e, g, i);
    return z;
}

int ns_inputs_stage(const ns_inputs *in, double t, double g, int i, double *z) {
    int any = 0;
    if (i > 0) {
        memset(z, 0, sizeof(double) * (size_t)in->s->nz);
        for (int k = 0; k < in->ncurved; k++) {
            z[in->curved[k]] = in_stage(&in->wave[in->curved[k]], t, g, i);
            any |= z[in->curved[k]] != 0;
        }
        return any;
    }
    for (int k = 0; k < in->s->nz; k++) {
        z[k] = in_stage(&in->wave[k], t, g, 0);
        any |= z[k] != 0;
    }
    return any;
}

double ns_inputs_excess(const ns_inputs *in, int c, int closed, const double *z, double tol) {
    const ns_command *k = &in->s->command[c];
    const ns_csc *gz = &in->f->gz;
    double g = k->g0, size = fabs(k->g0);
    for (int i = gz->start[c]; i < gz->start[c + 1]; i++) {
        g += gz->value[i] * z[gz->row[i]];
        size += fabs(gz->value[i] * z[gz->row[i]]);
    }
    return (closed ? k->off - g : g - k->on) - tol * size;
}

static double excess_at(ns_inputs *in, int c, int closed, double t, double tol) {
    const ns_csc *gz = &in->f->gz;
    for (int i = gz->start[c]; i < gz->start[c + 1]; i++)
        in->work[gz->row[i]] = ns_signal_value(&in->s->z[gz->row[i]], t, NS_LEFT);
    return ns_inputs_excess(in, c, closed, in->work, tol);
}

/* Where it crosses in (a, b]: by bisection to the last number before. */
static double instant_of(ns_inputs *in, int c, int closed, double a, double b) {
    for (int i = 0; i < 200; i++) {
        const double mid = a + (b - a) / 2;
        if (!(mid > a && mid < b))
            break;
        *(excess_at(in, c, closed, mid, 0) > 0 ? &b : &a) = mid;
    }
    return a;
}

/* How far its control is sure to cross at most once. */
static double reach(const ns_inputs *in, int c, double t, double horizon) {
    const ns_csc *gz = &in->f->gz;
    double until = INFINITY;
    for (int i = gz->start[c]; i < gz->start[c + 1]; i++) {
        const ns_signal *z = &in->s->z[gz->row[i]];
        until = fmin(until, in->wave[gz->row[i]].until);
        if (z->kind == NS_SIN && z->u.sin.freq != 0 && z->u.sin.va != 0)
            until = fmin(until, ns_control_crest(z, t));
        else if (z->kind == NS_EXP)
            until = fmin(until, t + horizon);
    }
    return until;
}

void ns_inputs_look(ns_inputs *in, double t, double horizon, const ns_mode *mode) {
    in->first = INFINITY;
    for (int c = 0; c < in->s->nc; c++) {
        if (in->f->gx.start[c + 1] > in->f->gx.start[c] || in->f->gz.start[c + 1] == in->f->gz.start[c])
            continue;
        if (!(t < in->review[c] && t < in->instant[c])) {
            const int closed = mode[in->s->command[c].pair] == NS_INSIDE;
            in->review[c] = reach(in, c, t, horizon);
            in->instant[c] = INFINITY;
            if (isfinite(in->review[c]) && excess_at(in, c, closed, in->review[c], control_tol) > 0)
                in->instant[c] = instant_of(in, c, closed, t, in->review[c]);
        }
        in->first = fmin(in->first, fmin(in->review[c], in->instant[c]));
    }
}
