/* src/theta/step.c - one step, tried. */
#include "theta_internal.h"

#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* What a guard may be negative by, relative to the bound on its rounding (guard_rounding.c): a few eps in
 * the accepted mode; in the mode of an answer of (P1), what its solver takes for zero. */
static const double tol_accepted = 4e-15, tol_answer = 1e-11;

/* What is zero comes out, refined, far below eps of the largest unknown, and what (P1) leaves behind of a
 * charge that has gone is some eps of it. */
static const double of_largest = 2e-4;

void ns_theta_forget_recent(ns_theta *s) {
    memset(s->recent, 0, sizeof s->recent);
    s->last = NULL;
}

int ns_theta_find_map(ns_theta *s, double h, int implicit, const ns_mode *mode, ns_map **out) {
    const double length = implicit ? -h : h; /* in the table's key a negative length: an implicit step */
    const unsigned long long key = ns_modes_table_key(s->s->m, length, mode);
    *out = (ns_map *)ns_modes_table_find(&s->maps, key, length, mode);
    if (*out)
        return NS_OK;
    const int status = ns_theta_map_build(s, h, implicit, mode, of_largest, out);
    if (status != NS_OK)
        return status;
    (*out)->entry.h = length;
    (*out)->entry.key = key;
    ns_modes_table_insert(&s->maps, &(*out)->entry);
    const long dropped = ns_modes_table_trim(&s->maps, &(*out)->entry);
    s->counts.evicted += dropped;
    if (dropped)
        ns_theta_forget_recent(s);
    return NS_OK;
}

static int recent_map(ns_theta *s, double h, int implicit, ns_map **out) {
    *out = s->last;
    if (*out && (*out)->h == h && (*out)->implicit == implicit)
        return NS_OK;
    ns_map **slot = &s->recent[(unsigned)(2 * ilogb(h) + implicit) % NS_RECENT];
    if (*slot && (*slot)->h == h && (*slot)->implicit == implicit) {
        s->last = *out = *slot;
        return NS_OK;
    }
    const int status = ns_theta_find_map(s, h, implicit, s->past.mode, out);
    if (status == NS_OK)
        s->last = *slot = *out;
    return status;
}

static void fill_inputs(ns_theta *s, double h, const double *z, int implicit) {
    const int r = s->r, nz = s->s->nz;
    double *in = s->trial.in;
    ns_copy_few(r, s->past.w, in);
    for (int i = 0; !implicit && i < r; i++)
        in[i] += h * s->past.d[i]; /* eta */
    for (int k = 0; s->fall && k < nz; k++)
        for (int i = 0; s->fall[k] != 0 && i < r; i++)
            in[i] += h * ((implicit ? 1 : s->theta) - 0.5) * s->E[i + k * s->s->n] * s->fall[k];
    s->fall = NULL;
    ns_copy_few(nz, z, in + r);
    in[r + nz] = 1;
}

/* Of the inputs too: a sine that grows is infinite some day. */
static int finite_state(const ns_theta *s) {
    return ns_sums_finite(s->s->nz, s->trial.in + s->r) && ns_sums_finite(s->r, s->trial.out);
}

/* The outputs of the map become the trial if the guards hold.  OK or GUARD. */
static int apply_map(ns_theta *s, ns_map *map, double tol) {
    ns_linalg_matvec_two(map->p, s->r, s->trial.in, s->q - s->r, s->trial.in + s->r, map->step, s->trial.out);
    if (!ns_none_negative(map->guards, s->trial.out + map->guard) && !ns_theta_guards_hold(s, map, tol))
        return NS_GUARD;
    s->trial.map = map;
    s->trial.h = map->h;
    s->trial.implicit = map->implicit;
    s->trial.has = 1;
    return NS_OK;
}

/* (P1) at the end of the step, then the map of its answer, checked.  A map is the more exact of the two: what
 * (P1) took for zero it may see broken, and then that pair changes. */
static int resolve_once(ns_theta *s, double h, int implicit, double fraction) {
    enum { FLIPS = 4 };
    ns_map *map;
    int status = ns_theta_lcp_solve(s, h, implicit, fraction);
    for (int round = 0; status == NS_OK; round++) {
        status = ns_theta_find_map(s, h, implicit, s->trial.mode, &map);
        if (status == NS_OK)
            status = apply_map(s, map, tol_answer);
        if (status != NS_GUARD)
            return status;
        if (round == FLIPS || !ns_theta_guards_flip(s, map, tol_answer, s->trial.mode))
            return NS_E_RESIDUAL;
        status = NS_OK;
    }
    return status;
}

/* (P1), and where the ideal laws leave something undetermined (P1) with leaks, whose answer has the mode of
 * real devices. */
static int resolve(ns_theta *s, double h, int implicit) {
    static const double fractions[] = {0, 1e-7};
    int first = NS_OK;
    ns_fault fault = s->fault;
    for (int k = 0; k < 2; k++) {
        memcpy(s->trial.mode, s->past.mode, (size_t)s->s->m);
        const int status = resolve_once(s, h, implicit, fractions[k]);
        if (status == NS_OK || status == NS_E_MEMORY)
            return status;
        if (k == 0) {
            first = status;
            fault = s->fault;
        }
    }
    s->fault = fault;
    if (first == NS_E_SINGULAR)
        ns_theta_name_undetermined(s, h, implicit);
    ns_theta_lcp_keep(s, h, implicit);
    return first;
}

int ns_theta_try(ns_theta *s, double h, const double *z, int implicit, ns_policy policy) {
    if (!s || (!z && s->s->nz > 0))
        return NS_E_NULL;
    ns_theta_forget_failure(s);
    if (!(h > 0) || !isfinite(h))
        return ns_theta_fail(s, NS_E_RANGE);
    s->trial.has = 0;
    s->counts.trials++;
    implicit = implicit || !s->carry;
    fill_inputs(s, h, z, implicit);
    ns_map *map;
    int status = recent_map(s, h, implicit, &map);
    if (status == NS_OK)
        status = apply_map(s, map, tol_accepted);
    s->trial.same_mode = status == NS_OK;
    if (!s->trial.same_mode) {
        if (status != NS_GUARD && status != NS_E_SINGULAR)
            return ns_theta_fail(s, status);
        if (policy == NS_HOLD)
            return NS_GUARD;
        if ((status = resolve(s, h, implicit)) != NS_OK)
            return ns_theta_fail(s, status);
    }
    if (!finite_state(s)) {
        s->trial.has = 0;
        return ns_theta_fail(s, NS_E_OVERFLOW);
    }
    return NS_OK;
}

int ns_theta_probe(ns_theta *s, double h, const double *z, int second) {
    const int status = ns_theta_try(s, h, z, 1, NS_HOLD);
    if (status != NS_OK)
        return status;
    memcpy(s->rate[second], s->trial.out + s->r, sizeof(double) * (size_t)s->r);
    s->trial.has = 0;
    return NS_OK;
}
