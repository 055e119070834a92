/* src/verify/inputs.c - inputs at any time; straight pieces of them are kept, as the next time is most often
 * on the same one.
 */
#include "verify_internal.h"

#include <math.h>

/* The straight piece that begins at t. */
static void find_piece(const ns_signal *s, double t, ns_verify_piece *p) {
    const double end = ns_signal_next_corner(s, t), value = ns_signal_value(s, t, NS_RIGHT);
    const int is_finite = end < INFINITY;
    p->from = t;
    p->to = end;
    p->value = value;
    p->slope = is_finite ? (ns_signal_value(s, end, NS_LEFT) - value) / (end - t) : 0;
}

static double value_at(const ns_signal *s, double t, ns_side side, ns_verify_piece *p) {
    if (ns_signal_is_linear(s))
        find_piece(s, t, p);
    return ns_signal_value(s, t, side);
}

void ns_verify_inputs(ns_verify *v, double t, ns_side side, double *z) {
    for (int k = 0; k < v->s->nz; k++) {
        ns_verify_piece *p = &v->piece[k];
        const int is_on = t > p->from && t < p->to;
        z[k] = is_on ? p->value + p->slope * (t - p->from) : value_at(&v->s->z[k], t, side, p);
    }
}
