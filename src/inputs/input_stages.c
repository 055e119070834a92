/* src/inputs/input_stages.c - inputs as sums of exponentials between corners; instants of commands. */
#include "input_stages.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "modes/bernstein_root.h"
#include "switch_times.h"
#include "waves.h"

static const double control_tol = NS_CONTROL_TOL;
enum { MOST_PIECES = 64, MOST_STEPS = 64, FAR = 16 };

/* Marks inputs that more than commands of time depend on. */
static void find_entering(ns_input_stages *in) {
    const ns_form *f = in->f;
    for (int k = 0; k < f->nz; k++)
        in->enters[k] = f->E.start[k + 1] > f->E.start[k] || f->F.start[k + 1] > f->F.start[k];
    for (int c = 0; c < f->nc; c++)
        for (int i = f->gz.start[c]; f->gx.start[c + 1] > f->gx.start[c] && i < f->gz.start[c + 1]; i++)
            in->enters[f->gz.row[i]] = 1;
}

int ns_inputs_stages_create(const ns_system *s, const ns_form *f, ns_input_stages **out) {
    const size_t nz = (size_t)s->nz, nc = (size_t)s->nc;
    *out = NULL;
    ns_input_stages *in = calloc(1, sizeof *in);
    if (!in)
        return NS_E_MEMORY;
    in->s = s;
    in->f = f;
    in->wave = calloc(nz + 1, sizeof *in->wave);
    in->review = calloc(2 * nc + nz + 1, sizeof(double));
    in->curved = calloc(nz + 1, sizeof(int));
    in->enters = calloc(nz + 1, 1);
    if (!in->wave || !in->review || !in->curved || !in->enters) {
        ns_inputs_stages_free(in);
        return NS_E_MEMORY;
    }
    in->instant = in->review + nc;
    in->most = in->instant + nc;
    find_entering(in);
    ns_inputs_stages_reset(in);
    *out = in;
    return NS_OK;
}

void ns_inputs_stages_free(ns_input_stages *in) {
    if (!in)
        return;
    free(in->wave);
    free(in->review);
    free(in->curved);
    free(in->enters);
    free(in);
}

void ns_inputs_stages_reset(ns_input_stages *in) {
    for (int k = 0; k < in->s->nz; k++)
        in->wave[k].from = INFINITY;
    for (int c = 0; c < in->s->nc; c++)
        in->review[c] = -INFINITY;
    in->corner = in->first = -INFINITY;
}

static void exponential(ns_exp_sum *w, double c_re, double c_im, double s_re, double s_im) {
    w->c[w->count][0] = c_re;
    w->c[w->count][1] = c_im;
    w->s[w->count][0] = s_re;
    w->s[w->count++][1] = s_im;
}

static void take_sine(const ns_signal *s, double t, ns_exp_sum *w) {
    static const double pi = 3.14159265358979323846;
    const double since = t - s->u.sin.td, turns = s->u.sin.freq * since + s->u.sin.phase / 360;
    if (w->until == s->u.sin.td) /* at rest before it */
        return;
    const double angle = 2 * pi * (turns - floor(turns)), damped = exp(-since * s->u.sin.theta);
    const double size = s->u.sin.va * (s->u.sin.theta != 0 ? damped : 1);
    exponential(w, size * sin(angle), -size * cos(angle), -s->u.sin.theta, 2 * pi * s->u.sin.freq);
}

static void take_exp(const ns_signal *s, double t, ns_exp_sum *w) {
    const double v = s->u.exp.v2 - s->u.exp.v1, d = 8 * DBL_EPSILON;
    const double one = t - s->u.exp.td1 + d * fabs(s->u.exp.td1),
                 two = t - s->u.exp.td2 + d * fabs(s->u.exp.td2);
    if (one < 0)
        return;
    exponential(w, -v * exp(-fmax(0, t - s->u.exp.td1) / s->u.exp.tau1), 0, -1 / s->u.exp.tau1, 0);
    if (two >= 0)
        exponential(w, v * exp(-fmax(0, t - s->u.exp.td2) / s->u.exp.tau2), 0, -1 / s->u.exp.tau2, 0);
}

static void take(const ns_signal *s, double t, ns_exp_sum *w) {
    *w = (ns_exp_sum){
        .from = t, .until = ns_signal_next_corner(s, t), .value = ns_signal_value(s, t, NS_RIGHT)};
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
static double size_of(const ns_exp_sum *w) {
    double size = 0;
    for (int e = 0; e < w->count; e++)
        size += hypot(w->c[e][0], w->c[e][1]);
    return size;
}

void ns_inputs_stages_at(ns_input_stages *in, double t) {
    in->corner = INFINITY;
    in->ncurved = 0;
    for (int k = 0; k < in->s->nz; k++) {
        ns_exp_sum *w = &in->wave[k];
        if (!(w->from <= t && t < w->until) || (w->count > 0 && w->from != t))
            take(&in->s->z[k], t, w);
        if (!in->enters[k])
            continue;
        in->corner = fmin(in->corner, w->until);
        if (w->count > 0 || w->slope != 0)
            in->curved[in->ncurved++] = k;
        if (w->count > 0)
            in->most[k] = fmax(in->most[k], fabs(w->value) + size_of(w));
    }
}

/* The share of exponential e in stage i: Re c u (g s u)^i with u = 1/(1 - g s). */
static double decayed(const ns_exp_sum *w, int e, double g, int i) {
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
        const ns_exp_sum *w = &in->wave[in->curved[k]];
        for (int e = 0; e < w->count; e++) { /* D = g s / (1 - g s) */
            const double re = g * w->s[e][0], im = g * w->s[e][1];
            const double d2 = (re * re + im * im) / ((1 - re) * (1 - re) + im * im);
            const double of = hypot(w->c[e][0], w->c[e][1]) / in->most[in->curved[k]];
            worst = fmax(worst, of * pow(d2, 0.5 * (order + 1)));
        }
    }
    return worst;
}

static double in_stage(const ns_exp_sum *w, double t, double g, int i) {
    double z = i == 0 ? w->value + w->slope * (t - w->from + g) : i == 1 ? w->slope * g : 0;
    for (int e = 0; e < w->count; e++)
        z += decayed(w, e, g, i);
    return z;
}

int ns_inputs_stages_stage(const ns_input_stages *in, double t, double g, int i, double *z) {
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

double ns_inputs_stages_excess(const ns_input_stages *in, int c, int closed, const double *z, double tol) {
    const ns_command *k = &in->s->command[c];
    const ns_csc *gz = &in->f->gz;
    double g = k->g0, size = fabs(k->g0);
    for (int i = gz->start[c]; i < gz->start[c + 1]; i++) {
        g += gz->value[i] * z[gz->row[i]];
        size += fabs(gz->value[i] * z[gz->row[i]]);
    }
    return (closed ? k->off - g : g - k->on) - tol * size;
}

/* A command's control, less the threshold that would change it, where lines and constants in it have no
 * corner: base + slope (t - from) and waves, counted with its sign. */
typedef struct piece {
    const ns_input_stages *in;
    int c;
    double sign, from, base, slope, size;
} piece;

static int is_wave(const ns_signal *z) {
    return z->kind == NS_SIN || z->kind == NS_EXP;
}

static double waves(const piece *p, double t) {
    const ns_csc *gz = &p->in->f->gz;
    double sum = 0;
    for (int i = gz->start[p->c]; i < gz->start[p->c + 1]; i++)
        if (is_wave(&p->in->s->z[gz->row[i]]))
            sum += gz->value[i] * ns_signal_value(&p->in->s->z[gz->row[i]], t, NS_LEFT);
    return sum;
}

/* From a to b; to b's right side if so. */
static piece piece_of(const ns_input_stages *in, int c, int closed, double a, double b) {
    const ns_command *k = &in->s->command[c];
    const ns_csc *gz = &in->f->gz;
    const double at = k->g0 - (closed ? k->off : k->on);
    piece p = {in, c, closed ? -1 : 1, a, at, 0, fabs(k->g0)};
    for (int i = gz->start[c]; i < gz->start[c + 1]; i++) {
        const ns_signal *z = &in->s->z[gz->row[i]];
        const double last = gz->value[i] * ns_signal_value(z, b, NS_LEFT);
        p.size += fabs(last);
        if (is_wave(z))
            continue;
        const double first = gz->value[i] * ns_signal_value(z, a, NS_RIGHT);
        p.base += first;
        p.slope += (last - first) / (b - a);
    }
    return p;
}

/* Positive where it would change. */
static double excess(const piece *p, double t) {
    return p->sign * (p->base + p->slope * (t - p->from) + waves(p, t));
}

static double short_of(const void *p, double t) {
    return -excess(p, t);
}

/* Where it crosses in (a, b], to rounding. */
static double instant_of(const piece *p, double a, double b) {
    return ns_modes_chords(short_of, p, a, b, DBL_EPSILON);
}

/* The rate of an exponential factor * exp(-a (t - from)), and a bound of how that changes from t to b. */
static void add_decay(double factor, double a, double t, double b, double from, double *rate, double *bend) {
    const double now = exp(-a * (t - from));
    *rate -= factor * a * now;
    *bend += fabs(factor) * a * a * (a < 0 ? exp(-a * (b - from)) : now);
}

/* The same of a wave that has no corner before b. */
static void add_wave(const ns_signal *z, double factor, double t, double b, double *rate, double *bend) {
    if (z->kind == NS_EXP) {
        const double v = factor * (z->u.exp.v2 - z->u.exp.v1);
        if (b > z->u.exp.td1)
            add_decay(-v, 1 / z->u.exp.tau1, t, b, z->u.exp.td1, rate, bend);
        if (b > z->u.exp.td2)
            add_decay(v, 1 / z->u.exp.tau2, t, b, z->u.exp.td2, rate, bend);
    } else if (z->kind == NS_SIN && b > z->u.sin.td) {
        const double w = 6.28318530717958647693 * z->u.sin.freq, theta = z->u.sin.theta;
        const double since = t - z->u.sin.td, va = factor * z->u.sin.va;
        const double angle = w * since + z->u.sin.phase * (6.28318530717958647693 / 360);
        const double now = theta != 0 ? exp(-theta * since) : 1;
        const double most = theta < 0 ? exp(-theta * (b - z->u.sin.td)) : now;
        *rate += va * now * (w * cos(angle) - theta * sin(angle));
        *bend += fabs(va) * most * (w * w + theta * theta);
    }
}

/* Whether it may turn round between two crests of its sine: a wave with anything else that moves. */
static int may_turn(const piece *p) {
    const ns_csc *gz = &p->in->f->gz;
    int moves = p->slope != 0;
    int bent = 0;
    for (int i = gz->start[p->c]; i < gz->start[p->c + 1]; i++) {
        const ns_signal *z = &p->in->s->z[gz->row[i]];
        moves += is_wave(z) + (z->kind == NS_EXP || (z->kind == NS_SIN && z->u.sin.theta != 0));
        bent += is_wave(z);
    }
    return bent && moves > 1;
}

/* Where it crosses in (a, b]: by steps that no crossing can be inside of (switch_time_search.c); INFINITY:
 * nowhere up to *b, which is less if they were too many. */
static double crossing(const piece *p, double a, double *b) {
    const ns_csc *gz = &p->in->f->gz;
    double at = a, before = a;
    for (int k = 0; k < MOST_STEPS; k++) {
        const double over = excess(p, at), beyond = over - control_tol * p->size;
        double rate = p->sign * p->slope, bend = 0;
        for (int i = gz->start[p->c]; i < gz->start[p->c + 1]; i++)
            add_wave(&p->in->s->z[gz->row[i]], p->sign * gz->value[i], at, *b, &rate, &bend);
        const int leaves = k == 0 && rate < 0; /* it has just changed: what is left is rounding */
        const int there = beyond >= -4 * DBL_EPSILON * p->size && !leaves;
        const double tau = there ? 0 : ns_inputs_switch_step(fmin(0, beyond), rate, bend);
        if (tau <= DBL_EPSILON * fabs(at))
            return over > 0 ? instant_of(p, before, at) : at;
        if (at + tau >= *b)
            return INFINITY;
        before = over <= 0 ? at : before;
        at += tau;
    }
    *b = at;
    return INFINITY;
}

/* How far after t its control is sure to cross at most once, if it is but one line or sine. */
static double reach(const ns_input_stages *in, int c, double t, double horizon) {
    const ns_csc *gz = &in->f->gz;
    double until = INFINITY;
    for (int i = gz->start[c]; i < gz->start[c + 1]; i++) {
        const ns_signal *z = &in->s->z[gz->row[i]];
        until = fmin(until, ns_signal_next_corner(z, t));
        if (z->kind == NS_SIN && z->u.sin.freq != 0 && z->u.sin.va != 0)
            until = fmin(until, ns_inputs_wave_crest(z, t));
        else if (z->kind == NS_EXP)
            until = fmin(until, t + horizon);
    }
    return until;
}

static int jumps(const ns_input_stages *in, int c, double t) {
    const ns_csc *gz = &in->f->gz;
    for (int i = gz->start[c]; i < gz->start[c + 1]; i++) {
        const ns_signal *z = &in->s->z[gz->row[i]];
        if (ns_signal_value(z, t, NS_LEFT) != ns_signal_value(z, t, NS_RIGHT))
            return 1;
    }
    return 0;
}

/* Its instant after t, piece by piece, up to a jump, or to where it is to be looked for again. */
static void look(ns_input_stages *in, int c, int closed, double t, double horizon) {
    double from = t;
    in->instant[c] = INFINITY;
    for (int pieces = 0; pieces < MOST_PIECES; pieces++) {
        double until = in->review[c] = reach(in, c, from, horizon);
        if (!isfinite(until))
            return;
        const piece p = piece_of(in, c, closed, from, until);
        if (may_turn(&p))
            in->instant[c] = crossing(&p, from, &until);
        else if (excess(&p, until) > control_tol * p.size)
            in->instant[c] = instant_of(&p, from, until);
        in->review[c] = until;
        if (isfinite(in->instant[c]) || until > t + FAR * horizon || jumps(in, c, until))
            return;
        from = until;
    }
}

void ns_inputs_stages_bracket(ns_input_stages *in, double t, double horizon, const ns_mode *mode) {
    in->first = INFINITY;
    for (int c = 0; c < in->s->nc; c++) {
        if (in->f->gx.start[c + 1] > in->f->gx.start[c] || in->f->gz.start[c + 1] == in->f->gz.start[c])
            continue;
        if (!(t < in->review[c] && t < in->instant[c]))
            look(in, c, mode[in->s->command[c].pair] == NS_INSIDE, t, horizon);
        in->first = fmin(in->first, fmin(in->review[c], in->instant[c]));
    }
}

double ns_inputs_stages_change(ns_input_stages *in, int c, int closed, double t, double horizon) {
    for (int k = 0; k < MOST_PIECES && in->instant[c] > t && in->review[c] <= t; k++)
        look(in, c, closed, in->review[c], horizon);
    return in->instant[c];
}
