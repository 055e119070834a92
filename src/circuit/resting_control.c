/* src/circuit/resting_control.c - switches without hysteresis whose control rests at their threshold.
 *
 * A switch stays as it is while its control is at the threshold.  One that is to be open or closed there
 * (ns_circuit_switch_at_rest) has a threshold that is shifted by more than what is rounding of a control.  It
 * is shifted only where the control may rest there: two switches whose controls are complements change in the
 * same instant otherwise, and with the shift both would be open in between.
 */
#include <math.h>
#include <stdlib.h>

#include "circuit_internal.h"
#include "system/broken_line.h"

enum { MOST_SUMS = 4096, MOST_CORNERS = 4096 }; /* of levels, of inputs; more are not tried */

/* More than what counts as rounding of a control (1e-12 of its size). */
static double choice_shift(double size) {
    return 4e-12 * size;
}

double ns_circuit_switch_shift(double vt, double size) {
    return fmax(1e-9 * fmax(fabs(vt), 1e-3), choice_shift(size));
}

/* --- what is asked for --- */

int ns_circuit_switch_at_rest(ns_circuit *c, int id, int closed) {
    const int status = ns_circuit_check_is(c, id, SWITCH, "switch");
    if (status == NS_OK && c->element[id].sw.vh == 0)
        c->element[id].at_rest = (closed == 0) - (closed > 0);
    return status;
}

int ns_circuit_switch_rests(ns_circuit *c, int id) {
    const int status = ns_circuit_check_is(c, id, SWITCH, "switch");
    if (status == NS_OK)
        c->element[id].rests = 1;
    return status;
}

int ns_circuit_switch_as_it_came(ns_circuit *c, int id, int closed, int other) {
    const int status = ns_circuit_check_is(c, id, SWITCH, "switch");
    if (status == NS_OK && c->element[id].sw.vh == 0) {
        c->element[id].at_rest = NS_RESTS_AS_IT_CAME;
        c->element[id].at_constant = closed ? -1 : 1;
        c->element[id].at_any = other ? -1 : 1;
    }
    return status;
}

int ns_circuit_choice_at_rest(ns_circuit *c, int id, int holds, int group) {
    const int status = ns_circuit_check_is(c, id, CHOICE, "choice");
    if (status == NS_OK) {
        c->element[id].at_rest = holds ? -1 : 1;
        c->element[id].group = group;
    }
    return status;
}

/* --- a control that is a sum of inputs --- */

/* The inputs of a control and where their levels are. */
typedef struct level_sums {
    const ns_input_gain *term; /* count */
    int count;
    double threshold, tolerance;
    double highest, lowest; /* bounds of the sum */
    double size;            /* of the terms where they add up to the threshold */
    int tried;
    int status;
} level_sums;

static int any_level(level_sums *s, int k, double sum, double size);

/* A level of a signal that is no broken line: what holds before it begins. */
static int level_of_curve(level_sums *s, int k, double sum, double size) {
    const ns_signal *z = s->term[k].z;
    const double td = z->kind == NS_SIN ? z->u.sin.td : z->u.exp.td1;
    const int is_level = td > 0 || (z->kind == NS_SIN && z->u.sin.va == 0);
    const double own = s->term[k].gain * ns_signal_value(z, 0, NS_LEFT);
    return is_level && any_level(s, k + 1, sum + own, size + fabs(own));
}

static int level_of_line(level_sums *s, int k, double sum, double size) {
    ns_broken_line line;
    int found = 0;
    s->status = ns_system_line_create(s->term[k].z, &line);
    for (int i = 0; s->status == NS_OK && i <= line.n + 1 && !found; i++) {
        const double own = s->term[k].gain * line.piece[i].v;
        if (line.piece[i].slope == 0)
            found = any_level(s, k + 1, sum + own, size + fabs(own));
    }
    ns_system_line_free(&line);
    return found;
}

/* 1 if the sum, with any levels of the terms from k on, is at the threshold; also where too many were tried.
 */
static int any_level(level_sums *s, int k, double sum, double size) {
    if (s->status != NS_OK || s->tried++ > MOST_SUMS)
        return 1;
    s->size = size;
    if (k == s->count)
        return fabs(sum - s->threshold) <= s->tolerance;
    return ns_signal_is_linear(s->term[k].z) ? level_of_line(s, k, sum, size)
                                             : level_of_curve(s, k, sum, size);
}

/* 0 if one of them is a line that is over before the run begins: it stands for what is set later
 * (ns_march_set_input). */
static int all_have_their_levels(const level_sums *s) {
    for (int k = 0; k < s->count; k++) {
        const ns_signal *z = s->term[k].z;
        if (z->kind == NS_PWL && isnan(z->u.pwl.repeat) && z->u.pwl.td + z->u.pwl.t[z->u.pwl.n - 1] < 0)
            return 0;
    }
    return 1;
}

/* Of a control of which nothing is known: most come back from where the switch is on. */
static int way_of_any(const element *e) {
    return e->at_rest == NS_RESTS_AS_IT_CAME ? e->at_any : e->at_rest;
}

/* Bounds of a term. */
static void add_bounds(level_sums *s, const ns_input_gain *term) {
    const ns_signal *z = term->z;
    ns_broken_line line;
    double high = -INFINITY, low = INFINITY;
    if (!ns_signal_is_linear(z)) {
        const double middle = z->kind == NS_SIN ? z->u.sin.vo : z->u.exp.v1;
        const double reach = z->kind == NS_SIN ? z->u.sin.va : z->u.exp.v2 - z->u.exp.v1;
        high = middle + fabs(reach);
        low = middle - fabs(reach);
    } else if ((s->status = ns_system_line_create(z, &line)) == NS_OK) {
        for (int i = 0; i <= line.n + 1; i++) {
            high = fmax(high, fmax(line.piece[i].v, line.piece[i].end));
            low = fmin(low, fmin(line.piece[i].v, line.piece[i].end));
        }
        ns_system_line_free(&line);
    }
    s->highest += fmax(term->gain * high, term->gain * low);
    s->lowest += fmin(term->gain * high, term->gain * low);
}

int ns_circuit_largest_sum(double constant, const ns_input_gain *term, int count, double *largest) {
    *largest = fabs(constant);
    for (int k = 0; k < count; k++) {
        level_sums s = {0};
        add_bounds(&s, &term[k]);
        const double most = fmax(fabs(s.lowest), fabs(s.highest));
        *largest += isfinite(most) ? most : 0;
        if (s.status != NS_OK)
            return s.status;
    }
    return NS_OK;
}

int ns_circuit_largest_source(const ns_circuit *c, double *volts) {
    int status = NS_OK;
    *volts = 1;
    for (int i = 0; i < c->nelements && status == NS_OK; i++) {
        const element *e = &c->element[i];
        double own = 0;
        if (e->kind == SOURCE && e->output == NS_VOLTAGE)
            status = ns_circuit_largest_sum(0, &(ns_input_gain){&e->signal, 1}, 1, &own);
        *volts = fmax(*volts, own);
    }
    return status;
}

static int shift_of_known_choice(double constant, const ns_input_gain *term, int count, double *shift) {
    double size;
    const int status = ns_circuit_largest_sum(constant, term, count, &size);
    *shift = choice_shift(size);
    return status;
}

/* How far the sum is above the threshold. */
static double above(const level_sums *s, double constant, double t) {
    double sum = constant - s->threshold;
    for (int k = 0; k < s->count; k++)
        sum += s->term[k].gain * ns_signal_value(s->term[k].z, t, NS_RIGHT);
    return sum;
}

/* 1 if the sum is at the threshold throughout this interval: at parts of it, the roots of 2 to 7 less what is
 * whole, whose distances have no common measure: zeros of a sine have one. */
static int stays_within(const level_sums *s, double constant, double t, double end) {
    static const double part[] = {0.41421356237309505, 0.73205080756887729, 0.2360679774997897,
                                  0.44948974278317810, 0.6457513110645906};
    int stays = 1;
    for (size_t i = 0; i < sizeof part / sizeof *part && stays; i++)
        stays = fabs(above(s, constant, t + part[i] * (end - t))) <= s->tolerance;
    return stays;
}

/* Whether the sum is at the threshold between two corners of its terms, and where it comes from: bits.  Two
 * levels that add up to it may never be there at one time. */
enum { RESTS = 1, FROM_ABOVE = 2, FROM_BELOW = 4 };

static int ways_to_rest(const level_sums *s, double constant) {
    static const double sliver = 1e-12; /* of the time: rounding of a corner */
    int ways = 0, from = 0;
    double t = 0;
    for (int k = 0; k < MOST_CORNERS && isfinite(t); k++) {
        double next = INFINITY;
        for (int i = 0; i < s->count; i++)
            next = fmin(next, ns_signal_next_corner(s->term[i].z, t));
        const double end = isfinite(next) ? next : 2 * t + 1;
        const int is_wide = end - t > sliver * t, rests = is_wide && stays_within(s, constant, t, end);
        ways |= rests ? RESTS | from : 0;
        if (is_wide && !rests)
            from = above(s, constant, t + 0.75 * (end - t)) > 0 ? FROM_ABOVE : FROM_BELOW;
        t = next;
    }
    return ways;
}

/* Which way the threshold is shifted: 1: open there.  What comes to it from below is closed there, if that is
 * asked for; what is never anywhere else, as it was asked for. */
static int way_of_shift(const element *e, const level_sums *s) {
    if (e->at_rest != NS_RESTS_AS_IT_CAME)
        return e->at_rest;
    if (!(s->lowest < s->threshold - s->tolerance || s->highest > s->threshold + s->tolerance))
        return e->at_constant;
    return s->highest > s->threshold + s->tolerance ? 1 : -1;
}

/* Where a control that is to be as it came comes from: bits. */
static int ways_of_switch(const element *e, double constant, const ns_input_gain *term, int count) {
    static const double exact = 0.75; /* less than what a bridge holds a control beside its threshold by */
    const level_sums s = {.term = term,
                          .count = count,
                          .threshold = e->sw.vt,
                          .tolerance = exact * ns_circuit_switch_shift(e->sw.vt, 0)};
    const int asked = e->at_rest == NS_RESTS_AS_IT_CAME && count > 0 && all_have_their_levels(&s);
    return asked ? ways_to_rest(&s, constant) & (FROM_ABOVE | FROM_BELOW) : 0;
}

int ns_circuit_shift_known(const element *e, double constant, const ns_input_gain *term, int count,
                           double *shift, int *both_ways) {
    double size = ns_circuit_switch_shift(e->sw.vt, 0);
    const int status = e->kind == CHOICE ? shift_of_known_choice(constant, term, count, &size) : NS_OK;
    level_sums s = {
        .term = term, .count = count, .threshold = e->sw.vt, .tolerance = 2 * size, .highest = constant};
    s.lowest = constant;
    s.status = status;
    const int known = all_have_their_levels(&s);
    int rests = known ? any_level(&s, 0, constant, fabs(constant)) : e->kind == CHOICE || e->sw.vt == 0;
    rests = rests && (e->kind != CHOICE || !known || ways_to_rest(&s, constant) != 0);
    for (int k = 0; known && rests && k < count && s.status == NS_OK; k++)
        add_bounds(&s, &term[k]);
    int way = rests ? known ? way_of_shift(e, &s) : way_of_any(e) : 0;
    /* a sum of several may rest where none of them does */
    const int ways = rests || count > 1 ? ways_of_switch(e, constant, term, count) : 0;
    if (e->kind == SWITCH && known && rests)
        size = ns_circuit_switch_shift(e->sw.vt, s.size);
    *both_ways = ways == (FROM_ABOVE | FROM_BELOW);
    if (rests && (ways == FROM_ABOVE || ways == FROM_BELOW))
        way = ways == FROM_ABOVE ? 1 : -1;
    *shift = way * size;
    return s.status;
}

/* --- any other --- */

/* 1 if the switch b is closed where a is open and the other way round. */
static int are_complements(const element *a, const element *b) {
    if (b->kind != SWITCH || b->sw.vh != 0 || b->sw.vt != -a->sw.vt || (a->by[0] < 0) != (b->by[0] < 0))
        return 0;
    if (a->by[0] >= 0)
        return a->by[0] == b->by[0] && a->value == -b->value;
    return a->node[2] == b->node[3] && a->node[3] == b->node[2];
}

double ns_circuit_shift_unknown(const ns_circuit *c, const element *e) {
    if (e->at_rest == 0 || (e->sw.vt != 0 && !e->rests))
        return 0; /* an expression or a current rests at 0, if anywhere */
    for (int i = 0; i < c->nelements; i++)
        if (are_complements(e, &c->element[i]))
            return 0;
    return way_of_any(e) * ns_circuit_switch_shift(e->sw.vt, 0);
}

static int has_term(const element *b, double sign, const ns_term *t) {
    int has = 0;
    for (int k = 0; k < b->ncontrol && !has; k++)
        has = b->terms[k].is_current == t->is_current && b->terms[k].of == t->of &&
              b->terms[k].gain == sign * t->gain;
    return has;
}

/* 1 if b is a choice whose control is sign times that of a. */
static int has_control(const element *b, double sign, const element *a) {
    int same = b->kind == CHOICE && b->ncontrol == a->ncontrol && b->control == sign * a->control;
    for (int k = 0; same && k < a->ncontrol; k++)
        same = has_term(b, sign, &a->terms[k]);
    return same;
}

static int group_has(const ns_circuit *c, int group, double sign, const element *a) {
    int has = 0;
    for (int i = 0; i < c->nelements && !has; i++)
        has = c->element[i].group == group && has_control(&c->element[i], sign, a);
    return has;
}

/* 1 if another group has its opposite and nothing like it: what they choose changes in one instant.  (A sign
 * has both.) */
static int is_opposed(const ns_circuit *c, const element *e) {
    int opposed = 0;
    for (int i = 0; i < c->nelements && !opposed; i++) {
        const element *b = &c->element[i];
        opposed = b->group != e->group && has_control(b, -1, e) && !group_has(c, b->group, 1, e);
    }
    return opposed && !group_has(c, e->group, -1, e);
}

double ns_circuit_choice_shift_unknown(const ns_circuit *c, const element *e, double size) {
    if (!is_opposed(c, e))
        return e->at_rest * choice_shift(size);
    /* thresholds beside zero by rounding would leave both out, or hold both, for some 1e-18 s */
    return fabs(e->sw.vt) <= choice_shift(size) ? -e->sw.vt : 0;
}
