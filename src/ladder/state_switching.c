/* src/ladder/state_switching.c - which switches have to change, and when a command that depends on time only
 * does so. */
#include "ladder_internal.h"

#include <math.h>
#include <string.h>

/* A control beyond its threshold by less than this, relative to its terms, has not crossed it: rounding. */
static const double control_tol = 1e-12;

static int is_closed(const ns_ladder *l, int c) {
    return ns_theta_mode(l->step)[l->s->command[c].pair] == NS_INSIDE;
}

double ns_ladder_switch_by_time(ns_ladder *l, double until, unsigned char *flip) {
    const double t = l->point->now.t;
    for (int c = 0; c < l->s->nc; c++)
        l->closed[c] = (unsigned char)is_closed(l, c);
    memset(flip, 0, (size_t)l->s->nc);
    ns_inputs_events_seek(l->commands, t, NS_RIGHT, l->closed);
    if (!(ns_inputs_events_next(l->commands, until) <= until))
        return INFINITY;
    const ns_time_event *event = ns_inputs_events_pass(l->commands);
    for (int k = 0; k < event->flips; k++)
        flip[event->flip[k]] = 1;
    return event->t;
}

/* By how much the control of command c is beyond the threshold that changes it (> 0: it has to change), but
 * for rounding: of its terms, and of others (V). */
static double excess(const ns_ladder *l, int c, double from_state, const double *z, double others) {
    const ns_command *k = &l->s->command[c];
    double g = k->g0 + from_state, size = fabs(k->g0) + fabs(from_state);
    for (int i = 0; k->gz && i < l->s->nz; i++) {
        g += k->gz[i] * z[i];
        size += fabs(k->gz[i] * z[i]);
    }
    return (is_closed(l, c) ? k->off - g : g - k->on) - (control_tol * size + others);
}

int ns_ladder_switch_by_state(ns_ladder *l, const double *z, unsigned char *flip) {
    const double *from_state = ns_theta_controls(l->step);
    int count = 0;
    for (int c = 0; c < l->s->nc; c++) {
        flip[c] = l->s->command[c].gx && excess(l, c, from_state[c], z, l->apart[c]) > 0;
        count += flip[c];
    }
    return count;
}

double ns_ladder_switch_excess(const ns_ladder *l, int c) {
    return excess(l, c, ns_theta_controls(l->step)[c], l->z, 0);
}

int ns_ladder_switch_at_start(ns_ladder *l, const double *x, const double *z, unsigned char *flip) {
    const double *from_state = ns_theta_controls(l->step);
    double most = 0;
    int count = 0;
    for (int i = 0; i < l->s->n; i++)
        most = fmax(most, fabs(x[i]));
    for (int c = 0; c < l->s->nc; c++) {
        const double *gx = l->s->command[c].gx;
        double gain = 0;
        for (int i = 0; gx && i < l->s->n; i++)
            gain = fmax(gain, fabs(gx[i]));
        flip[c] = gx && excess(l, c, from_state[c], z, control_tol * gain * most) > 0;
        count += flip[c];
    }
    return count;
}

void ns_ladder_switch_apply(ns_ladder *l, const unsigned char *flip) {
    int any = 0;
    for (int c = 0; c < l->s->nc; c++) {
        l->closed[c] = (unsigned char)(is_closed(l, c) != flip[c]);
        any |= flip[c];
    }
    if (any)
        (void)ns_theta_command(l->step, l->closed); /* cannot fail: both pointers are ours */
}
