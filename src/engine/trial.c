/* src/engine/trial.c - one step, tried and accepted. */
#include "stepper.h"

#include <math.h>
#include <string.h>

/* A guard counts as broken when it is negative by more than rounding: this times the sum of the
 * magnitudes of the terms that make it up (maps come out of one LU, some thousands of eps). */
static const double guard_tol = 1e-11;
/* After (P1) was solved, its mode's map may differ from the solver's own answer by the condition
 * of the problem: this much, relative to the same sum, is believed. */
static const double answer_tol = 1e-7;

/* The map of (h, implicit, mode), from the recent ones, the cache, or built. */
int ns_theta_map(ns_theta *s, double h, int implicit, const ns_mode *mode, ns_map **out) {
    *out = ns_cache_find(&s->cache, h, implicit, mode, s->s->m);
    if (*out)
        return NS_OK;
    const int status = ns_map_build(s, h, implicit, mode, out);
    if (status != NS_OK)
        return status;
    ns_cache_insert(&s->cache, *out, s->s->m);
    const long dropped = ns_cache_trim(&s->cache, s->s->m, *out);
    s->counts.evicted += dropped;
    if (dropped)
        ns_theta_forget_recent(s);
    return NS_OK;
}

static int recent_map(ns_theta *s, double h, int implicit, ns_map **out) {
    ns_map **slot = &s->recent[(unsigned)(2 * ilogb(h) + implicit) % NS_RECENT];
    if (*slot && (*slot)->h == h && (*slot)->implicit == implicit) {
        *out = *slot;
        return NS_OK;
    }
    const int status = ns_theta_map(s, h, implicit, s->mode, out);
    if (status == NS_OK)
        s->recent[(unsigned)(2 * ilogb(h) + implicit) % NS_RECENT] = *out;
    return status;
}

static void fill_inputs(ns_theta *s, double h, const double *z, int implicit) {
    for (int i = 0; i < s->r; i++)
        s->trial_in[i] = implicit ? s->w[i] : s->w[i] + h * s->d[i]; /* eta */
    for (int k = 0; k < s->s->nz; k++)
        s->trial_in[s->r + k] = z[k];
    s->trial_in[s->q - 1] = 1;
}

/* All guards of out hold up to tol. */
static int guards_hold(const ns_theta *s, const ns_map *map, double tol) {
    const double *guard = s->out + (map->p - map->guards);
    for (int g = 0; g < map->guards; g++) {
        if (guard[g] >= 0)
            continue;
        const double *row = map->step + (map->p - map->guards);
        double size = 0;
        for (int k = 0; k < s->q; k++)
            size += fabs(row[g + k * map->p] * s->trial_in[k]);
        if (!(guard[g] >= -tol * size))
            return 0;
    }
    return 1;
}

static int finite_state(const ns_theta *s) {
    double sum = 0;
    for (int i = 0; i < s->r; i++)
        sum += s->out[i];
    return isfinite(sum);
}

/* The map is taken: its outputs become the trial if the guards hold. */
static int apply(ns_theta *s, ns_map *map, double tol) {
    ns_matvec(map->p, s->q, map->step, s->trial_in, s->out);
    if (!guards_hold(s, map, tol))
        return 0;
    s->trial_map = map;
    s->trial_h = map->h;
    s->trial_implicit = map->implicit;
    s->has_trial = 1;
    return 1;
}

/* (P1) at the end of the step, then the map of its answer, checked. */
static int resolve(ns_theta *s, double h, int implicit) {
    int status = NS_E_RESIDUAL;
    memcpy(s->trial_mode, s->mode, (size_t)s->s->m);
    for (int round = 0; round < 3 && status == NS_E_RESIDUAL; round++) {
        ns_map *map;
        status = ns_problem_solve(s, h, implicit);
        if (status == NS_OK)
            status = ns_theta_map(s, h, implicit, s->trial_mode, &map);
        if (status == NS_OK && !apply(s, map, answer_tol))
            status = NS_E_RESIDUAL;
    }
    return status;
}

int ns_theta_try(ns_theta *s, double h, const double *z, int implicit, ns_policy policy) {
    if (!s || (!z && s->s->nz > 0))
        return NS_E_NULL;
    if (!(h > 0) || !isfinite(h))
        return ns_theta_fail(s, NS_E_RANGE);
    s->has_trial = 0;
    s->counts.trials++;
    implicit = implicit || !s->carry;
    fill_inputs(s, h, z, implicit);
    ns_map *map;
    int status = recent_map(s, h, implicit, &map);
    if (status == NS_OK && apply(s, map, guard_tol))
        memcpy(s->trial_mode, s->mode, (size_t)s->s->m);
    else if (status != NS_OK && status != NS_E_SINGULAR)
        return ns_theta_fail(s, status);
    else if (policy == NS_HOLD)
        return NS_GUARD;
    else if ((status = resolve(s, h, implicit)) != NS_OK)
        return ns_theta_fail(s, status);
    if (!finite_state(s)) {
        s->has_trial = 0;
        return ns_theta_fail(s, NS_E_OVERFLOW);
    }
    return NS_OK;
}

int ns_theta_accept(ns_theta *s) {
    if (!s)
        return NS_E_NULL;
    if (!s->has_trial)
        return NS_E_STATE;
    memcpy(s->w, s->out, sizeof(double) * (size_t)s->r);
    if (s->carry)
        memcpy(s->d, s->out + s->r, sizeof(double) * (size_t)s->r);
    double *in = s->in;
    s->in = s->trial_in;
    s->trial_in = in;
    s->h = s->trial_h;
    s->implicit = s->trial_implicit;
    if (memcmp(s->mode, s->trial_mode, (size_t)s->s->m) != 0) {
        memcpy(s->mode, s->trial_mode, (size_t)s->s->m);
        s->counts.events++;
        ns_theta_forget_recent(s);
    }
    s->counts.steps++;
    s->has_trial = 0;
    return NS_OK;
}
