/* src/ladder/mirrored.c - switches that one comparison commands change in one instant.
 *
 * A sign of the state is two comparisons, whose thresholds are beside zero by rounding, one above, one below:
 * between them, for 1e-14 s, neither holds, and a bridge that both drive would be open.  So a command whose
 * control is that of the event but for a factor, and that meets its own threshold within h
 * 2^-NS_RATE_EXPONENT, changes with it.
 */
#include "ladder_internal.h"

#include <math.h>

static const double alike = 1e-9;  /* two controls, of their largest gain */
static const double beside = 1e-8; /* two thresholds, of the control's terms */

static int is_plain(const ns_command *k) {
    return k->gx && k->on == k->off;
}

static double gain(const double *of, int i) {
    return of ? of[i] : 0;
}

static int is_multiple(int count, const double *a, const double *b, double factor, double largest) {
    for (int i = 0; i < count; i++)
        if (fabs(gain(a, i) - factor * gain(b, i)) > alike * fabs(factor) * largest)
            return 0;
    return 1;
}

/* The control of a is that of b but for a factor, with which both change by the same movement. */
static int goes_with(const ns_ladder *l, const ns_command *a, const ns_command *b) {
    const ns_mode *mode = ns_theta_mode(l->step);
    const int same_way = (mode[a->pair] == NS_INSIDE) == (mode[b->pair] == NS_INSIDE);
    double largest = 0, factor = 0;
    if (a == b || !is_plain(a) || !is_plain(b))
        return 0;
    for (int i = 0; i < l->s->n; i++)
        if (fabs(b->gx[i]) > largest) {
            largest = fabs(b->gx[i]);
            factor = a->gx[i] / b->gx[i];
        }
    return (same_way ? factor > 0 : factor < 0) && is_multiple(l->s->n, a->gx, b->gx, factor, largest) &&
           is_multiple(l->s->nz, a->gz, b->gz, factor, largest);
}

/* How far command c is from its threshold at x, z (> 0: it has not met it); *size: of its terms. */
static double distance(const ns_ladder *l, int c, const double *x, const double *z, double *size) {
    const ns_command *k = &l->s->command[c];
    double g = k->g0;
    *size = fabs(k->g0) + fabs(k->on);
    for (int i = 0; i < l->s->n; i++) {
        g += k->gx[i] * x[i];
        *size += fabs(k->gx[i] * x[i]);
    }
    for (int i = 0; i < l->s->nz; i++) {
        g += gain(k->gz, i) * z[i];
        *size += fabs(gain(k->gz, i) * z[i]);
    }
    return ns_theta_mode(l->step)[k->pair] == NS_INSIDE ? g - k->off : k->on - g;
}

/* How far it is from there at x, z to the left of an event, if it moves on as in the last trial, of length h,
 * and meets its threshold at once; 0: it does not. */
static double gap(const ns_ladder *l, int c, const double *x, const double *z, double h) {
    double size;
    const double left = distance(l, c, x, z, &size), came = left + ns_ladder_switch_excess(l, c);
    const double delay = h * left / came;
    return came > 0 && left > 0 && left <= beside * size && delay <= ldexp(l->h, -NS_RATE_EXPONENT) &&
                   l->point->now.t + 2 * delay < l->limit
               ? left
               : 0;
}

/* The command that is to change and that c goes with. */
static int leader_of(const ns_ladder *l, int c) {
    for (int k = 0; k < l->s->nc; k++)
        if (l->point->flip[k] == 1 && goes_with(l, &l->s->command[c], &l->s->command[k]))
            return k;
    return -1;
}

/* x, z of the point, and a trial from there. */
static int look_ahead(ns_ladder *l, double h) {
    double *x = l->jump.x;
    const int status = ns_theta_read(l->step, x, x + l->s->n, NULL);
    if (status != NS_OK)
        return status;
    ns_system_inputs(l->s, l->point->now.t, NS_RIGHT, l->z_left);
    ns_system_inputs(l->s, l->point->now.t + (l->point->now.lost + h), NS_LEFT, l->z);
    const int tried = ns_theta_try(l->step, h, l->z, 0, NS_HOLD);
    return tried < 0 ? tried : NS_OK;
}

int ns_ladder_switch_mirrored(ns_ladder *l) {
    enum { FOLLOWS = 2 };
    const double h = 2 * ns_ladder_short_step(l);
    unsigned char *flip = l->point->flip;
    int looked = 0, status = NS_OK;
    for (int c = 0; c < l->s->nc && status == NS_OK; c++) {
        if (flip[c] || leader_of(l, c) < 0)
            continue;
        if (!looked++)
            status = look_ahead(l, h);
        l->apart[c] = status == NS_OK ? gap(l, c, l->jump.x, l->z_left, h) * (1 + 1e-6) : 0;
        flip[c] = l->apart[c] > 0 ? FOLLOWS : 0;
        l->any_apart |= flip[c] != 0;
    }
    for (int c = 0; c < l->s->nc; c++)
        flip[c] = flip[c] != 0;
    return status;
}

void ns_ladder_switch_passed(ns_ladder *l) {
    l->any_apart = 0;
    for (int c = 0; c < l->s->nc; c++) {
        if (l->apart[c] > 0 && ns_ladder_switch_excess(l, c) <= 0)
            l->apart[c] = 0;
        l->any_apart |= l->apart[c] > 0;
    }
}
