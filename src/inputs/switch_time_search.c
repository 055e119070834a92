/* src/inputs/switch_time_search.c - when a sum of lines and waves crosses its threshold.
 *
 * Between the corners of its lines g is a straight line, or f = g - threshold is at most
 *     f(t) + f'(t) tau + second_rate tau^2 / 2,        second_rate >= |f''|
 * and where that comes to zero f has not been beyond the threshold before, however short the excursion.  Such
 * steps end at the crossing as fast as Newton's do.
 */
#include "switch_times.h"

#include <float.h>
#include <math.h>

static void sum_line(const ns_switch_line *x, double t, ns_switch_control *v) {
    const double term = x->gain * ns_system_line_value(&x->run, fmin(t, x->run.next));
    v->g += term;
    v->size += fabs(term);
    v->slope += x->gain * ns_system_line_piece(&x->run)->slope;
}

/* later: up to where the second rate is bounded. */
static void sum_wave(const ns_switch_term *x, double t, double later, ns_switch_control *v) {
    const double omega = 6.28318530717958647693 * x->wave.freq, theta = x->wave.theta;
    double c, s;
    ns_inputs_wave_at(&x->wave, t, &c, &s);
    const double term = x->term.after + x->term.cc * c + x->term.cs * s;
    v->g += term;
    v->size += fabs(term);
    v->slope += x->term.cs * (omega * c - theta * s) - x->term.cc * (omega * s + theta * c);
    double second_rate = x->size * (omega * omega + theta * theta);
    if (theta != 0) /* largest here if it decays */
        second_rate *= exp(-theta * ((theta < 0 ? later : t) - x->wave.td));
    v->second_rate += second_rate;
}

ns_switch_control ns_inputs_switch_control(const ns_switch_times *c, double t, double later) {
    ns_switch_control v = {c->g0, fabs(c->g0), 0, 0};
    for (int i = 0; i < c->lines; i++)
        sum_line(&c->line[i], t, &v);
    for (int i = 0; i < c->terms; i++)
        if (c->t >= c->term[i].term.from)
            sum_wave(&c->term[i], t, later, &v);
        else {
            v.g += c->term[i].term.before;
            v.size += fabs(c->term[i].term.before);
        }
    return v;
}

static void set_flip(ns_switch_times *c, double t, double window) {
    c->next = t;
    c->flips = 1;
    c->window = window;
}

/* What is left of the excess where the switch has just flipped is rounding, of a steep g. */
static int just_flipped(const ns_switch_times *c, double rate) {
    return c->fresh && !(rate > 0);
}

/* g is straight up to stop. */
static void search_line(ns_switch_times *c, double stop) {
    const ns_switch_control a = ns_inputs_switch_control(c, c->t, c->t);
    const double left = ns_inputs_switch_excess(c, a.g, c->closed), rate = c->closed ? -a.slope : a.slope;
    c->next = stop;
    if (left > NS_CONTROL_TOL * a.size && !just_flipped(c, rate)) {
        set_flip(c, c->t, 0);
        return;
    }
    if (!(rate > 0) || isinf(stop))
        return;
    const ns_switch_control b = ns_inputs_switch_control(c, stop, stop);
    if (ns_inputs_switch_excess(c, b.g, c->closed) > NS_CONTROL_TOL * b.size)
        set_flip(c, fmin(stop, c->t + fmax(0, -left) / rate), NS_CONTROL_TOL * b.size / rate);
}

/* The smallest tau with f + rate tau + second_rate tau^2 / 2 = 0, f <= 0; INFINITY: there is none. */
static double step_to_zero(double f, double rate, double second_rate) {
    const double root = sqrt(rate * rate - 2 * second_rate * f);
    if (rate > 0)
        return -2 * f / (rate + root);
    return second_rate > 0 ? (root - rate) / second_rate : INFINITY;
}

/* From t, where g is beyond the threshold by what is more than rounding, back to where it is at it. */
static void step_back(ns_switch_times *c, double last, ns_switch_control v) {
    double t = last, rate = c->closed ? -v.slope : v.slope;
    for (int round = 0; round < 20 && rate > 0; round++) {
        const double step = ns_inputs_switch_excess(c, v.g, c->closed) / rate;
        t = fmax(c->t, fmin(t - step, last));
        if (v.second_rate * step * step <= rate * DBL_EPSILON * fabs(t))
            break;
        v = ns_inputs_switch_control(c, t, t);
        rate = c->closed ? -v.slope : v.slope;
    }
    set_flip(c, t, rate > 0 ? NS_CONTROL_TOL * v.size / rate : 0);
}

/* Up to where the second rate of a growing wave is bounded: beyond one time constant the bound is too large
 * to be of use. */
static double bound_reach(const ns_switch_times *c, double t, double stop) {
    for (int i = 0; i < c->terms; i++)
        if (c->term[i].wave.theta < 0)
            stop = fmin(stop, t - 1 / c->term[i].wave.theta);
    return stop;
}

static void search_waves(ns_switch_times *c, double stop) {
    enum { STEPS = 64 }; /* then the search continues from there */
    double t = c->t;
    for (int k = 0; k < STEPS; k++) {
        const double later = bound_reach(c, t, stop);
        const ns_switch_control v = ns_inputs_switch_control(c, t, later);
        const double rate = c->closed ? -v.slope : v.slope;
        const double excess = ns_inputs_switch_excess(c, v.g, c->closed) - NS_CONTROL_TOL * v.size;
        if (!(v.size < INFINITY && v.second_rate < INFINITY)) {
            c->next = stop; /* it overflows, which others report */
            return;
        }
        const int leaves = k == 0 && rate < 0 && just_flipped(c, rate);
        const int beyond = excess >= -4 * DBL_EPSILON * v.size && !leaves;
        const double tau = beyond ? 0 : step_to_zero(fmin(0, excess), rate, v.second_rate);
        if (beyond || tau <= DBL_EPSILON * fabs(t)) {
            step_back(c, t, v);
            return;
        }
        if (!(t + tau < later) && !(later < stop)) {
            c->next = stop;
            return;
        }
        t = fmin(t + tau, later);
    }
    c->next = t;
}

void ns_inputs_switch_search(ns_switch_times *c) {
    double stop = INFINITY;
    int curved = 0;
    c->flips = 0;
    c->window = 0;
    c->next = INFINITY;
    if (!(c->closed ? c->least < c->off : c->most > c->on))
        return;
    for (int i = 0; i < c->lines; i++) {
        ns_system_line_pass(&c->line[i].run, c->t);
        stop = fmin(stop, c->line[i].run.next);
    }
    for (int i = 0; i < c->terms; i++) {
        const double from = c->term[i].term.from;
        curved |= c->t >= from;
        stop = c->t >= from ? stop : fmin(stop, from);
    }
    if (curved)
        search_waves(c, stop);
    else
        search_line(c, stop);
}
