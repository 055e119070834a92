/* src/reinit/jump.c - where the state jumps: the impulse problem (J1)-(J4), in no time.
 *
 * The short steps that resolve an event or a start tend to it, but time goes by in them, and resistors carry
 * charge meanwhile.  They show whether the state jumps: then it does so again, from the left side, at that
 * instant.
 */
#include "march/march_internal.h"

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
    j->left = calloc(2 * past + 6 * n + 3 * m + 2 * nz + 1, sizeof *j->left);
    j->mode = calloc(m + 1, sizeof *j->mode);
    if (!j->left || !j->mode)
        return NS_E_MEMORY;
    j->right = j->left + past;
    j->w = j->right + past;
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
    free(j->left);
    free(j->mode);
}

/* What w moves by in a second at the end of the last step. */
static double rate_of(const ns_theta *s, int i) {
    if (s->jumped || !(s->h > 0))
        return 0;
    return fabs((s->w[i] - s->in[i]) / s->h + (s->implicit ? 0 : s->d[i]));
}

void ns_reinit_jump_begin(ns_march *m) {
    ns_jump *j = &m->jump;
    const ns_theta *s = m->step;
    ns_theta_save(s, j->left);
    j->left_t = j->last_t = m->live.t;
    j->left_past = m->live.time_lost;
    memcpy(j->w, s->w, sizeof(double) * (size_t)s->r);
    memcpy(j->last, s->w, sizeof(double) * (size_t)s->r);
    for (int i = 0; i < s->r; i++)
        j->rate[i] = rate_of(s, i);
}

void ns_reinit_jump_last_step(ns_march *m) {
    memcpy(m->jump.last, m->step->w, sizeof(double) * (size_t)m->step->r);
    m->jump.last_t = m->live.t;
}

static int beyond_the_rates(const ns_march *m, int i) {
    const ns_jump *j = &m->jump;
    const double time = j->last_t - j->left_t, after = m->live.t - j->last_t;
    const double rate = fmax(j->rate[i], fabs(m->step->w[i] - j->last[i]) / after);
    return fabs(j->last[i] - j->w[i]) > beyond_rates * time * rate;
}

/* x: after the short steps. */
static int beyond_the_rounding(const ns_march *m, int i) {
    const ns_theta *s = m->step;
    const ns_jump *j = &m->jump;
    double terms = fabs(j->w[i]);
    for (int k = 0; k < s->s->n; k++)
        terms += fabs(s->M[i + k * s->s->n] * j->x[k]);
    return fabs(j->last[i] - j->w[i]) > beyond_rounding * terms;
}

double ns_reinit_jump_amount(const ns_theta *s, int i, double w) {
    double most = 0;
    for (int k = 0; k < s->s->n; k++)
        most = fmax(most, fabs(s->M[i + k * s->s->n]));
    return fabs(w) / sqrt(most);
}

static double largest_amount(const ns_march *m) {
    double most = 0;
    for (int i = 0; i < m->step->r; i++)
        most = fmax(most, ns_reinit_jump_amount(m->step, i, fmax(fabs(m->jump.w[i]), fabs(m->jump.last[i]))));
    return most;
}

/* read: x after the short steps is known. */
static int jumps(const ns_march *m, int read) {
    const ns_jump *j = &m->jump;
    const double most = largest_amount(m);
    for (int i = 0; i < m->step->r && j->last_t > j->left_t; i++)
        if (beyond_the_rates(m, i) &&
            ns_reinit_jump_amount(m->step, i, j->last[i] - j->w[i]) > beyond_rounding * most &&
            (!read || beyond_the_rounding(m, i)))
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

static int solve(ns_march *m, int *any) {
    ns_jump *j = &m->jump;
    ns_system_inputs(m->s, j->left_t, NS_RIGHT, j->z);
    for (int i = 0; i < m->s->nz; i++)
        j->slope[i] = slope_of(&m->s->z[i], j->left_t, m->h);
    return ns_reinit_impulse_solve(m->step, j->z, j->slope, j->x, &j->to, any);
}

int ns_reinit_jump_commit(ns_march *m) {
    ns_jump *j = &m->jump;
    if (!jumps(m, 0))
        return NS_OK;
    int any = 0, status = ns_theta_read(m->step, j->x, j->x + m->s->n, NULL);
    if (status == NS_E_MEMORY)
        return ns_march_fail(m, status);
    if (status != NS_OK || !jumps(m, 1))
        return NS_OK;
    ns_theta_save(m->step, j->right);
    ns_theta_restore(m->step, j->left);
    status = solve(m, &any);
    if (status != NS_OK || !any) {
        ns_theta_restore(m->step, j->right);
        m->counts.jumps_by_steps += status != NS_OK;
        return status == NS_E_MEMORY ? ns_march_fail(m, status) : NS_OK;
    }
    ns_theta_jump(m->step, &j->to, j->z);
    m->live.t = j->left_t;
    m->live.time_lost = j->left_past;
    memcpy(m->z, j->z, sizeof(double) * (size_t)m->s->nz);
    ns_ladder_switch_set(m, j->to.x);
    m->counts.jumps++;
    return NS_OK;
}
