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

enum { MOST_SUMS = 4096 }; /* of levels; more are not tried */

double ns_circuit_switch_shift(double vt) {
    return 1e-9 * fmax(fabs(vt), 1e-3);
}

/* --- a control that is a sum of inputs --- */

/* The inputs of a control and where their levels are. */
typedef struct level_sums {
    const ns_input_gain *term; /* count */
    int count;
    double threshold, tolerance;
    double highest, lowest; /* bounds of the sum */
    int tried;
    int status;
} level_sums;

static int any_level(level_sums *s, int k, double sum);

/* A level of a signal that is no broken line: what holds before it begins. */
static int level_of_curve(level_sums *s, int k, double sum) {
    const ns_signal *z = s->term[k].z;
    const double td = z->kind == NS_SIN ? z->u.sin.td : z->u.exp.td1;
    const int is_level = td > 0 || (z->kind == NS_SIN && z->u.sin.va == 0);
    return is_level && any_level(s, k + 1, sum + s->term[k].gain * ns_signal_value(z, 0, NS_LEFT));
}

static int level_of_line(level_sums *s, int k, double sum) {
    ns_broken_line line;
    int found = 0;
    s->status = ns_system_line_create(s->term[k].z, &line);
    for (int i = 0; s->status == NS_OK && i <= line.n + 1 && !found; i++)
        if (line.piece[i].slope == 0)
            found = any_level(s, k + 1, sum + s->term[k].gain * line.piece[i].v);
    ns_system_line_free(&line);
    return found;
}

/* 1 if the sum, with any levels of the terms from k on, is at the threshold; also where too many were tried.
 */
static int any_level(level_sums *s, int k, double sum) {
    if (s->status != NS_OK || s->tried++ > MOST_SUMS)
        return 1;
    if (k == s->count)
        return fabs(sum - s->threshold) <= s->tolerance;
    return ns_signal_is_linear(s->term[k].z) ? level_of_line(s, k, sum) : level_of_curve(s, k, sum);
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

/* Which way the threshold is shifted: 1: open there.  What comes to it from below is closed there, if that is
 * asked for; what is never anywhere else, as it was asked for. */
static int way_of_shift(const element *e, const level_sums *s) {
    if (e->at_rest != NS_RESTS_AS_IT_CAME)
        return e->at_rest;
    if (!(s->lowest < s->threshold - s->tolerance || s->highest > s->threshold + s->tolerance))
        return e->at_constant;
    return s->highest > s->threshold + s->tolerance ? 1 : -1;
}

int ns_circuit_shift_known(const element *e, double constant, const ns_input_gain *term, int count,
                           double *shift) {
    const double size = ns_circuit_switch_shift(e->sw.vt);
    level_sums s = {
        .term = term, .count = count, .threshold = e->sw.vt, .tolerance = 2 * size, .highest = constant};
    s.lowest = constant;
    const int known = all_have_their_levels(&s), rests = known ? any_level(&s, 0, constant) : e->sw.vt == 0;
    for (int k = 0; known && rests && k < count && s.status == NS_OK; k++)
        add_bounds(&s, &term[k]);
    *shift = (rests ? known ? way_of_shift(e, &s) : way_of_any(e) : 0) * size;
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
    return way_of_any(e) * ns_circuit_switch_shift(e->sw.vt);
}
