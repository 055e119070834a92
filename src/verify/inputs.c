/* src/verify/inputs.c - inputs at any time; straight pieces of them are kept, as the next time is most often
 * on the same one.
 */
#include "verify_internal.h"

#include <float.h>
#include <math.h>

/* The straight piece that begins at t; its slope is found when it is asked for again. */
static double begin_piece(const ns_signal *s, double t, ns_verify_piece *p) {
    p->from = t;
    p->to = ns_signal_next_corner(s, t);
    p->slope = NAN;
    return p->value = ns_signal_value(s, t, NS_RIGHT);
}

static double slope_of(const ns_signal *s, const ns_verify_piece *p) {
    return p->to < INFINITY ? (ns_signal_value(s, p->to, NS_LEFT) - p->value) / (p->to - p->from) : 0;
}

static int is_on(const ns_verify_piece *p, double t, ns_side side) {
    return (t > p->from || (t == p->from && side == NS_RIGHT)) && t < p->to;
}

static double value_anew(const ns_signal *s, double t, ns_side side, ns_verify_piece *p) {
    if (!is_on(p, t, side)) {
        if (side == NS_RIGHT && ns_signal_is_linear(s))
            return begin_piece(s, t, p);
        return ns_signal_value(s, t, side);
    }
    if (t == p->from)
        return p->value;
    p->slope = slope_of(s, p);
    return p->value + p->slope * (t - p->from);
}

static inline double value_of(const ns_signal *s, double t, ns_side side, ns_verify_piece *p) {
    const double value = p->value + p->slope * (t - p->from); /* NaN: its slope is not known yet */
    return is_on(p, t, side) && value == value ? value : value_anew(s, t, side, p);
}

/* All of them, and where those that are constant are. */
static void find_all(ns_verify *v, double t, ns_side side, double *z) {
    ns_verify_inputs *in = &v->inputs;
    in->movings = 0;
    in->from = -INFINITY;
    in->to = INFINITY;
    for (int k = 0; k < v->s->nz; k++) {
        const ns_verify_piece *p = &in->piece[k];
        z[k] = value_of(&v->s->z[k], t, side, &in->piece[k]);
        if (!is_on(p, t, side) || p->slope != 0) { /* also if it is not known yet */
            in->moving[in->movings++] = k;
            continue;
        }
        in->from = ns_verify_larger(in->from, p->from);
        in->to = p->to < in->to ? p->to : in->to;
    }
}

void ns_verify_inputs_at(ns_verify *v, double t, ns_side side, double *z) {
    const ns_verify_inputs *in = &v->inputs;
    if (!(t > in->from && t < in->to)) {
        find_all(v, t, side, z);
        return;
    }
    for (int i = 0; i < in->movings; i++) {
        const int k = in->moving[i];
        z[k] = value_of(&v->s->z[k], t, side, &v->inputs.piece[k]);
    }
}

int ns_verify_inputs_spread(ns_verify *v, double t) {
    const double near = ns_verify_roundings * DBL_EPSILON * fabs(t);
    double *spread = v->spread + v->s->n + v->s->m;
    int any = 0;
    for (int k = 0; k < v->s->nz; k++) {
        const ns_signal *s = &v->s->z[k];
        spread[k] = fabs(ns_signal_value(s, t + near, NS_RIGHT) - ns_signal_value(s, t - near, NS_LEFT));
        any |= spread[k] > 0;
    }
    return any;
}
