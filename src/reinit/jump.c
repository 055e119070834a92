/* src/reinit/jump.c - where the state jumps: the impulse problem (J1)-(J4), in no time.
 *
 * The short steps that resolve an event or a start converge to it, but they take time, in which resistors
 * carry charge.  They show whether the state jumps: then the impulse problem is solved instead, from the left
 * side, at that instant.
 */
#include "jump.h"
#include "impulse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A charge or flux jumps if it moves by more than its rates before and after explain, than rounding does, and
 * than matters beside the others.  Where a step moves as much by rates, it accounts for both: it does not
 * matter then which is taken. */
static const double beyond_rates = 64, beyond_rounding = 1e-12;

int ns_reinit_jump_create(const ns_theta *s, ns_jump *j) {
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m, past = ns_theta_past_size(s);
    const size_t nz = (size_t)s->s->nz;
    j->block = calloc(2 * past + 6 * n + 3 * m + 2 * nz + 1, sizeof *j->block);
    j->mode = calloc(m + 1, sizeof *j->mode);
    if (!j->block || !j->mode)
        return NS_E_MEMORY;
    j->before = j->block;
    j->after = j->before + past;
    j->w = j->after + past;
    j->rate = j->w + n;
    j->last = j->rate + n;
    j->x = j->last + n; /* and lambda */
    j->z = j->x + n + m;
    j->slope = j->z + nz;
    j->to.x = j->slope + nz;
    j->to.lambda = j->to.x + n;
    j->to.X = j->to.lambda + m;
    j->to.Lambda = j->to.X + n;
    j->to.mode = j->mode;
    return NS_OK;
}

void ns_reinit_jump_free(ns_jump *j) {
    free(j->block);
    free(j->mode);
}

/* What w moves by in a second at the end of the last step. */
static double rate_of(const ns_theta *s, int i) {
    if (s->past.jumped || !(s->past.h > 0))
        return 0;
    return fabs((s->past.w[i] - s->past.in[i]) / s->past.h + (s->past.implicit ? 0 : s->past.d[i]));
}

void ns_reinit_jump_begin(ns_jump *j, const ns_theta *s, ns_clock now) {
    ns_theta_save(s, j->before);
    j->left = now;
    j->last_t = now.t;
    memcpy(j->w, s->past.w, sizeof(double) * (size_t)s->r);
    memcpy(j->last, s->past.w, sizeof(double) * (size_t)s->r);
    for (int i = 0; i < s->r; i++)
        j->rate[i] = rate_of(s, i);
}

void ns_reinit_jump_last_step(ns_jump *j, const ns_theta *s, double t) {
    memcpy(j->last, s->past.w, sizeof(double) * (size_t)s->r);
    j->last_t = t;
}

static int beyond_the_rates(const ns_jump *j, const ns_theta *s, double t, int i) {
    const double time = j->last_t - j->left.t, after = t - j->last_t;
    const double rate = fmax(j->rate[i], fabs(s->past.w[i] - j->last[i]) / after);
    return fabs(j->last[i] - j->w[i]) > beyond_rates * time * rate;
}

/* j->x: after the short steps. */
static int beyond_the_rounding(const ns_jump *j, const ns_theta *s, int i) {
    double terms = fabs(j->w[i]);
    for (int k = 0; k < s->s->n; k++)
        terms += fabs(s->M[i + k * s->s->n] * j->x[k]);
    return fabs(j->last[i] - j->w[i]) > beyond_rounding * terms;
}

static double largest_amount(const ns_jump *j, const ns_theta *s) {
    double largest = 0;
    for (int i = 0; i < s->r; i++)
        largest = fmax(largest, fmax(fabs(j->w[i]), fabs(j->last[i])) / s->unit[i]);
    return largest;
}

/* Whether a charge or flux jumped in the short steps to t.  x_known: j->x is known. */
static int jumped(const ns_jump *j, const ns_theta *s, double t, int x_known) {
    const double largest = largest_amount(j, s);
    for (int i = 0; i < s->r && j->last_t > j->left.t; i++)
        if (beyond_the_rates(j, s, t, i) &&
            fabs(j->last[i] - j->w[i]) / s->unit[i] > beyond_rounding * largest &&
            (!x_known || beyond_the_rounding(j, s, i)))
            return 1;
    return 0;
}

/* dz/dt to the right of t: of a straight line by its other points, of a curve by two that are near. */
static double slope_of(const ns_signal *z, double t, double h) {
    const double room = fmin(h, ns_signal_next_corner(z, t) - t);
    const int straight = ns_signal_is_linear(z);
    const double near = t + ldexp(room, straight ? -2 : -14), far = t + ldexp(room, straight ? -1 : -13);
    const double z0 = ns_signal_value(z, t, NS_RIGHT), z2 = ns_signal_value(z, far, NS_LEFT);
    if (!(near > t && far > near))
        return 0;
    const double whole = (z2 - z0) / (far - t);
    return straight ? whole : 2 * (ns_signal_value(z, near, NS_LEFT) - z0) / (near - t) - whole;
}

static int solve_impulse(ns_jump *j, ns_theta *s, double h, int *any) {
    ns_system_inputs(s->s, j->left.t, NS_RIGHT, j->z);
    for (int i = 0; i < s->s->nz; i++)
        j->slope[i] = slope_of(&s->s->z[i], j->left.t, h);
    return ns_reinit_impulse_solve(s, j->z, j->slope, j->x, &j->to, any);
}

int ns_reinit_jump_commit(ns_jump *j, ns_theta *s, double h, ns_clock *now, double *z) {
    if (!jumped(j, s, now->t, 0))
        return NS_OK;
    int any = 0, status = ns_theta_read(s, j->x, j->x + s->s->n, NULL);
    if (status == NS_E_MEMORY)
        return status;
    if (status != NS_OK || !jumped(j, s, now->t, 1))
        return NS_OK;
    ns_theta_save(s, j->after);
    ns_theta_restore(s, j->before);
    status = solve_impulse(j, s, h, &any);
    if (status != NS_OK || !any) {
        ns_theta_restore(s, j->after);
        j->refused += status != NS_OK;
        return status == NS_E_MEMORY ? status : NS_OK;
    }
    ns_theta_jump(s, &j->to, j->z);
    *now = j->left;
    memcpy(z, j->z, sizeof(double) * (size_t)s->s->nz);
    ns_theta_set_controls(s, j->to.x);
    j->jumps++;
    return NS_OK;
}
