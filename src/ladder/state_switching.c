/* src/ladder/state_switching.c - which switches have to change, and when a command that depends on time only
 * does so. */
#include "inputs/waves.h"
#include "ladder_internal.h"

#include <float.h>
#include <math.h>

/* A control beyond its threshold by less than this, relative to its terms, has not crossed it: rounding. */
static const double control_tol = 1e-12;

static int is_closed(const ns_ladder *l, int c) {
    return ns_theta_mode(l->step)[l->s->command[c].pair] == NS_INSIDE;
}

/* By how much g is beyond the threshold that changes command c (> 0: it has to change), less tol times the
 * size of its terms. */
static double excess(const ns_ladder *l, int c, double from_state, const double *z, double tol) {
    const ns_command *k = &l->s->command[c];
    double g = k->g0 + from_state, size = fabs(k->g0) + fabs(from_state);
    for (int i = 0; k->gz && i < l->s->nz; i++) {
        g += k->gz[i] * z[i];
        size += fabs(k->gz[i] * z[i]);
    }
    return (is_closed(l, c) ? k->off - g : g - k->on) - tol * size;
}

int ns_ladder_switch_by_time(ns_ladder *l, const double *z, unsigned char *flip) {
    int count = 0;
    for (int c = 0; c < l->s->nc; c++) {
        flip[c] = !l->s->command[c].gx && excess(l, c, 0, z, control_tol) > 0;
        count += flip[c];
    }
    return count;
}

int ns_ladder_switch_by_state(ns_ladder *l, const double *z, unsigned char *flip) {
    const double *from_state = ns_theta_controls(l->step);
    int count = 0;
    for (int c = 0; c < l->s->nc; c++) {
        flip[c] = l->s->command[c].gx && excess(l, c, from_state[c], z, control_tol) > 0;
        count += flip[c];
    }
    return count;
}

static double excess_at(ns_ladder *l, int c, double t, double tol) {
    ns_system_inputs(l->s, t, NS_LEFT, l->z_left);
    return excess(l, c, 0, l->z_left, tol);
}

/* Where command c crosses in [a, b], excess > 0 at b: by bisection to the last number before. */
static double instant_of(ns_ladder *l, int c, double a, double b) {
    if (excess_at(l, c, a, 0) > 0)
        return a;
    for (int i = 0; i < 200; i++) {
        const double mid = a + (b - a) / 2;
        if (!(mid > a && mid < b))
            break;
        *(excess_at(l, c, mid, 0) > 0 ? &b : &a) = mid;
    }
    return a;
}

double ns_ladder_switch_instant(ns_ladder *l, double t, unsigned char *flip) {
    double first = t;
    for (int c = 0; c < l->s->nc; c++)
        if (flip[c])
            first = fmin(first, instant_of(l, c, l->point->now.t, t));
    /* switches driven by one source cross together: the same instant up to rounding, that of time too, which
     * a steep source magnifies */
    const double soon = fmin(t, first + 8 * DBL_EPSILON * fabs(first));
    for (int c = 0; c < l->s->nc; c++)
        flip[c] = flip[c] && excess_at(l, c, soon, -control_tol) > 0;
    return first;
}

double ns_ladder_switch_next_crest(const ns_ladder *l, double t) {
    double next = INFINITY;
    for (int c = 0; c < l->s->nc; c++) {
        const ns_command *k = &l->s->command[c];
        for (int i = 0; !k->gx && k->gz && i < l->s->nz; i++) {
            const ns_signal *s = &l->s->z[i];
            if (k->gz[i] != 0 && s->kind == NS_SIN && s->u.sin.freq != 0 && s->u.sin.va != 0)
                next = fmin(next, ns_inputs_wave_crest(s, t));
        }
    }
    return next;
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
