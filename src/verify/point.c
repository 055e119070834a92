/* src/verify/point.c - a point that is shown: algebraic rows of (S1), (S3), (S4), switches and controls. */
#include "verify_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What rounding leaves of the terms of y. */
static const double digits = 1e-13;
/* An instant that is found is known to so many units of eps. */
static const double instant_roundings = 4;

/* --- the point --- */

void ns_verify_fill(ns_verify *v, const ns_verify_state *at) {
    const size_t n = (size_t)v->s->n, m = (size_t)v->s->m;
    v->t = at->t;
    memcpy(v->u, at->x, sizeof *v->u * n);
    if (m > 0)
        memcpy(v->u + n, at->lambda, sizeof *v->u * m);
    ns_verify_inputs_at(v, at->t, at->side, v->u + n + m);
    v->u[n + m + (size_t)v->s->nz] = 1;
}

/* What that makes of a row. */
static double spread_of(const ns_verify *v, const ns_verify_rows *r, int i) {
    return v->spreads ? 2 * ns_verify_row(r, i, v->spread).size : 0;
}

/* How far input k moves in the rounding of an instant, beside t: its jump at t is none of that.  Slopes are
 * those over a time in which corners can be told apart. */
static double steepness_of(const ns_verify *v, int k) {
    const ns_signal *s = &v->s->z[k];
    const double t = v->t, near = ns_verify_roundings * DBL_EPSILON * fabs(t);
    const double after = ns_signal_value(s, t + near, NS_LEFT) - ns_signal_value(s, t, NS_RIGHT);
    const double before = ns_signal_value(s, t, NS_LEFT) - ns_signal_value(s, t - near, NS_RIGHT);
    return ns_verify_larger(fabs(after), fabs(before)) * (instant_roundings / ns_verify_roundings);
}

/* Of all inputs, where any is steep, for what they make of any voltage: networks of resistors, capacitors and
 * ideal devices do not amplify. */
static double steepest(const ns_verify *v) {
    double sum = 0;
    for (int k = 0; v->spreads && k < v->s->nz; k++)
        sum += steepness_of(v, k);
    return sum;
}

/* What steep inputs make of unknown or lambda `column` in row i, if the row is algebraic: other unknowns move
 * by `all`, other lambdas are taken to stay. */
static double steep_in(const ns_verify *v, int i, int column, double all) {
    const ns_verify_rows *law = &v->law;
    const int first = v->s->n + v->s->m;
    double moves = 0, own = 0;
    if (v->charge.start[i] < v->charge.start[i + 1])
        return 0;
    for (int k = law->start[i]; k < law->start[i + 1]; k++) {
        const int input = law->column[k] - first;
        if (law->column[k] == column)
            own = fabs(law->value[k]);
        else if (law->column[k] < v->s->n)
            moves += fabs(law->value[k]) * all;
        else if (input >= 0 && input < v->s->nz)
            moves += fabs(law->value[k]) * steepness_of(v, input);
    }
    return own > 0 ? moves / own : 0;
}

/* What they make of y of pair j by its unknowns, each by its own row: 1e-17 s of an edge of 1e11 A/s into
 * 1 kohm are 1 mV. */
static double steep_y(const ns_verify *v, int j) {
    const ns_verify_rows *r = &v->output;
    const double all = steepest(v);
    double sum = 0;
    for (int k = r->start[j]; v->spreads && k < r->start[j + 1]; k++)
        if (r->column[k] < v->s->n)
            sum += fabs(r->value[k]) * (all + steep_in(v, r->column[k], r->column[k], 0));
    return 2 * sum;
}

static double steep_lambda(const ns_verify *v, int j) {
    const double all = steepest(v);
    double most = 0;
    for (int i = 0; v->spreads && i < v->s->n; i++)
        most = ns_verify_larger(most, steep_in(v, i, v->s->n + j, all));
    return 2 * most;
}

static int numbers_are_finite(const ns_verify *v, ns_verify_finding *worst) {
    const int n = v->s->n, all = n + v->s->m;
    double sum = 0;
    for (int i = 0; i < all; i++)
        sum += v->u[i] * 0;
    for (int i = 0; i < all && sum != 0; i++)
        if (!isfinite(v->u[i]))
            ns_verify_note(worst, NS_VERIFY_NUMBER, i < n ? -1 : i - n, i < n ? i : -1, INFINITY);
    return worst->cause == NS_VERIFY_RIGHT;
}

/* --- Kirchhoff's laws and those of elements without charge --- */

static void judge_rows(ns_verify *v, int is_some, ns_verify_finding *worst) {
    for (int k = 0; k < v->algebraics; k++) {
        const int i = v->algebraic[k];
        if (is_some && v->is_aside[i])
            continue;
        const ns_verify_sum s = ns_verify_row(&v->law, i, v->u);
        ns_verify_grow(v, &v->most_law[i], s.size);
        if (fabs(s.sum) <= digits * s.size)
            continue;
        const double off = ns_verify_sizes_law_off(v, i);
        if (!(fabs(s.sum) <= off))
            ns_verify_note(worst, NS_VERIFY_ROW, -1, i, fabs(s.sum) / (off + spread_of(v, &v->law, i)));
    }
}

/* --- pairs --- */

double ns_verify_law_error(double l, double u, double lambda, double y, double lambda_off, double y_off) {
    const double out = ns_verify_larger(l - lambda, lambda - u) / lambda_off;
    const double bound = (y > 0 ? lambda - l : u - lambda) / lambda_off, law = fabs(y) / y_off;
    return ns_verify_larger(out, bound < law ? bound : law);
}

/* A pair as it is, what it may be off by, and its control. */
typedef struct pair_values {
    double lambda, y, lambda_off, y_off;
    double g, g_off; /* of a switch */
    int closed;      /* it is, it is not, -1: it is not known */
} pair_values;

/* How far a pair without a control is from its law. */
static double law_error(const ns_verify *v, int j, const pair_values *p) {
    return ns_verify_law_error(v->s->l[j], v->s->u[j], p->lambda, p->y, p->lambda_off, p->y_off);
}

/* How far a switch is from being open, closed, whichever is nearer. */
static double switch_error(const pair_values *p) {
    const double open = fabs(p->lambda) / p->lambda_off, shut = fabs(p->y) / p->y_off;
    return open < shut ? open : shut;
}

/* The same for what its control wants.  At the threshold it may slide, between open and closed. */
static double command_error(const ns_command *k, const pair_values *p) {
    if (p->g > k->on + p->g_off)
        return fabs(p->y) / p->y_off;
    if (p->g < k->off - p->g_off)
        return fabs(p->lambda) / p->lambda_off;
    if (p->closed >= 0 && p->g < k->on - p->g_off && p->g > k->off + p->g_off)
        return p->closed ? fabs(p->y) / p->y_off : fabs(p->lambda) / p->lambda_off;
    return k->on == k->off ? 0 : switch_error(p);
}

/* 1 if all is as it should be to the last digit or so. */
static int is_clearly_right(const ns_verify *v, int j, const pair_values *p, double y_size) {
    const int c = v->command[j], is_shut = fabs(p->y) <= digits * y_size;
    if (c >= 0)
        return (is_shut && p->g > v->s->command[c].on) || (p->lambda == 0 && p->g < v->s->command[c].off);
    if (!(p->lambda >= v->s->l[j] && p->lambda <= v->s->u[j]))
        return 0;
    return is_shut || (p->y > 0 ? p->lambda == v->s->l[j] : p->lambda == v->s->u[j]);
}

/* g is the control; what it may be off by is found where it matters. */
static void read_control(ns_verify *v, int c, pair_values *p) {
    const ns_verify_sum g = ns_verify_row(&v->control, c, v->u);
    ns_verify_grow(v, &v->most_control[c], g.size);
    p->g = g.sum;
    p->closed = ns_verify_memory_at(v, c, p->g);
}

static void find_offs(const ns_verify *v, int j, pair_values *p) {
    const int c = v->command[j];
    p->lambda_off = ns_verify_sizes_lambda_off(v, j);
    p->y_off = ns_verify_sizes_y_off(v, j) + spread_of(v, &v->output, j) + steep_y(v, j);
    if (c < 0)
        return;
    p->g_off = ns_verify_sizes_control_off(v, c) + spread_of(v, &v->control, c);
}

/* What edges of sources make of a control in the time that an event may take. */
static double edge_of(const ns_verify *v, int c) {
    const double t = v->t, near = v->o.instant;
    double sum = 0;
    for (int k = 0; k < v->s->nz; k++) {
        const ns_signal *s = &v->s->z[k];
        sum += fabs(ns_signal_value(s, t + near, NS_RIGHT) - ns_signal_value(s, t - near, NS_LEFT));
    }
    return sum * v->control.size[c];
}

/* Without hysteresis, by the state. */
static int can_slide(const ns_verify *v, int c) {
    const ns_verify_rows *r = &v->control;
    int by_state = 0;
    for (int k = r->start[c]; k < r->start[c + 1]; k++)
        by_state |= r->column[k] < v->s->n;
    return by_state && v->s->command[c].on == v->s->command[c].off;
}

/* A switch that is neither open nor closed: if that is right it slides. */
static void note_sliding(ns_verify *v, int j, const pair_values *p) {
    v->slides[j] = switch_error(p) > ns_verify_wrong && can_slide(v, v->command[j]);
    v->slidings += v->slides[j];
}

static void judge_closely(const ns_verify *v, int j, pair_values *p, ns_verify_finding *worst) {
    const int c = v->command[j];
    double error = c < 0 ? law_error(v, j, p) : command_error(&v->s->command[c], p);
    if (error <= 1)
        return;
    p->lambda_off += ns_verify_sizes_rounding_around(v, j) + steep_lambda(v, j);
    if (c >= 0)
        p->g_off += edge_of(v, c);
    error = c < 0 ? law_error(v, j, p) : command_error(&v->s->command[c], p);
    const int is_command = c >= 0 && switch_error(p) <= 1;
    if (!is_command && v->t == v->excused_t && v->is_excused[j])
        return;
    ns_verify_note(worst, is_command ? NS_VERIFY_COMMAND : NS_VERIFY_LAW, j, -1, error);
}

static void judge_pair(ns_verify *v, int j, const double *y_shown, ns_verify_finding *worst) {
    const ns_verify_sum y = ns_verify_row(&v->output, j, v->u);
    pair_values p = {.lambda = v->u[v->s->n + j], .y = y.sum};
    ns_verify_grow(v, &v->most_lambda[j], fabs(p.lambda));
    ns_verify_grow(v, &v->most_y[j], y.size);
    ns_verify_grow(v, &v->most_any[NS_VERIFY_ANY_LAMBDA], fabs(p.lambda));
    ns_verify_grow(v, &v->most_any[NS_VERIFY_ANY_Y], y.size);
    if (v->command[j] >= 0)
        read_control(v, v->command[j], &p);
    const double differs = y_shown ? fabs(y_shown[j] - y.sum) : 0;
    if (is_clearly_right(v, j, &p, y.size) && differs <= digits * y.size)
        return;
    find_offs(v, j, &p);
    if (!(differs <= p.y_off))
        ns_verify_note(worst, NS_VERIFY_OUTPUT, j, -1, differs / p.y_off);
    if (v->command[j] >= 0)
        note_sliding(v, j, &p);
    judge_closely(v, j, &p, worst);
}

static int judge(ns_verify *v, const ns_verify_state *at, ns_verify_finding *worst) {
    *worst = ns_verify_nothing(at->t);
    memset(v->slides, 0, (size_t)v->s->m);
    v->slidings = 0;
    judge_rows(v, at->is_some, worst);
    for (int j = 0; j < v->s->m; j++)
        judge_pair(v, j, at->y, worst);
    return worst->cause == NS_VERIFY_RIGHT;
}

/* The entry of row i in a column. */
static double entry(const ns_verify_rows *r, int i, int column) {
    double sum = 0;
    for (int k = r->start[i]; k < r->start[i + 1]; k++)
        sum += r->column[k] == column ? r->value[k] : 0;
    return sum;
}

double ns_verify_excusable(ns_verify *v, int pair, const ns_verify_state *at) {
    static const double instants = 64;
    double longest = instants * v->o.instant;
    int any = 0;
    ns_verify_fill(v, at);
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        const double flows = fabs(entry(&v->law, i, v->s->n + pair) * at->lambda[pair]);
        if (!(flows > 0))
            continue;
        any = 1;
        const double most = ns_verify_larger(v->most_w[i], ns_verify_row(&v->charge, i, v->u).size);
        longest = fmin(longest, ns_verify_sizes_charge_off_of(v, i, most) / flows);
    }
    return any ? longest : 0;
}

/* The middle lies in the first half of the way, but for rounding. */
static int is_gradual(const double *a, double off) {
    const double half = (a[0] + a[2]) / 2, low = a[0] < half ? a[0] : half;
    return a[1] >= low - off && a[1] <= ns_verify_larger(a[0], half) + off;
}

int ns_verify_is_gradual(ns_verify *v, int pair, const ns_verify_state at[3]) {
    double lambda[3], y[3];
    for (int k = 0; k < 3; k++) {
        ns_verify_fill(v, &at[k]);
        lambda[k] = v->u[v->s->n + pair];
        y[k] = ns_verify_row(&v->output, pair, v->u).sum;
    }
    return is_gradual(lambda, ns_verify_sizes_lambda_off(v, pair)) &&
           is_gradual(y, ns_verify_sizes_y_off(v, pair));
}

int ns_verify_point(ns_verify *v, const ns_verify_state *at, ns_verify_finding *worst) {
    *worst = ns_verify_nothing(at->t);
    ns_verify_fill(v, at);
    if (!numbers_are_finite(v, worst))
        return 0;
    ns_verify_sizes_numbers(v, v->u);
    if (judge(v, at, worst))
        return ns_verify_sizes_end(v, worst);
    v->spreads = ns_verify_inputs_spread(v, at->t); /* rare: an input jumps, or is steep */
    if (v->spreads)
        (void)judge(v, at, worst);
    v->spreads = 0;
    return ns_verify_sizes_end(v, worst);
}

int ns_verify_slides(const ns_verify *v, int j) {
    return v->slides[j];
}

int ns_verify_slidings(const ns_verify *v) {
    return v->slidings;
}

double ns_verify_off_lambda(const ns_verify *v, int j) {
    return ns_verify_sizes_lambda_off(v, j);
}

double ns_verify_off_y(const ns_verify *v, int j) {
    return ns_verify_sizes_y_off(v, j);
}

double ns_verify_off_control(const ns_verify *v, int j) {
    return ns_verify_sizes_control_off(v, v->command[j]);
}
