/* src/engine/past.c - the accepted point: saved, restored, read. */
#include "stepper.h"

#include <math.h>
#include <string.h>

/* past = w, d, d_noise, in, noisy_h, h, implicit, mode */
size_t ns_theta_past_size(const ns_theta *s) {
    return s ? (size_t)(3 * s->r + s->q + 3 + s->s->m) : 0;
}

void ns_theta_save(const ns_theta *s, double *past) {
    if (!s || !past)
        return;
    const size_t r = (size_t)s->r, q = (size_t)s->q;
    memcpy(past, s->w, sizeof(double) * r);
    memcpy(past + r, s->d, sizeof(double) * r);
    memcpy(past + 2 * r, s->d_noise, sizeof(double) * r);
    memcpy(past + 3 * r, s->in, sizeof(double) * q);
    past += 3 * r + q;
    *past++ = s->noisy_h;
    *past++ = s->h;
    *past++ = s->implicit;
    for (int j = 0; j < s->s->m; j++)
        past[j] = s->mode[j];
}

void ns_theta_restore(ns_theta *s, const double *past) {
    if (!s || !past)
        return;
    const size_t r = (size_t)s->r, q = (size_t)s->q;
    memcpy(s->w, past, sizeof(double) * r);
    memcpy(s->d, past + r, sizeof(double) * r);
    memcpy(s->d_noise, past + 2 * r, sizeof(double) * r);
    memcpy(s->in, past + 3 * r, sizeof(double) * q);
    past += 3 * r + q;
    s->noisy_h = *past++;
    s->h = *past++;
    s->implicit = (int)*past++;
    for (int j = 0; j < s->s->m; j++)
        s->mode[j] = (ns_mode)past[j];
    ns_theta_set_bounds(s);
    s->has_trial = 0;
    ns_theta_forget_recent(s);
}

/* The first few of v (n, or NULL) that are not finite; returns how many. */
static int list_infinite(int n, const double *v, int *index) {
    int count = 0;
    for (int i = 0; v && i < n && count < NS_FAULT_MAX; i++)
        if (!isfinite(v[i]))
            index[count++] = i;
    return count;
}

/* What only follows from the state may overflow before it does.  y may be NULL. */
static int check_read(ns_theta *s, const double *y) {
    const int n = s->s->n, m = s->s->m;
    ns_fault found = {.t = s->fault.t};
    found.nunknowns = list_infinite(n, s->sol, found.unknown);
    found.npairs = list_infinite(m, s->sol + n, found.pair);
    if (found.nunknowns + found.npairs == 0)
        found.npairs = list_infinite(m, y, found.pair);
    if (found.nunknowns + found.npairs == 0)
        return NS_OK;
    s->fault = found;
    return ns_theta_fail(s, NS_E_OVERFLOW);
}

int ns_theta_read(ns_theta *s, double *x, double *lambda, double *y) {
    if (!s)
        return NS_E_NULL;
    if (!(s->h > 0))
        return NS_E_STATE;
    ns_map *map;
    const int status = ns_theta_map(s, s->h, s->implicit, s->mode, &map);
    if (status != NS_OK)
        return ns_theta_fail(s, status);
    const int n = s->s->n, m = s->s->m;
    ns_matvec(n + m, s->q, map->full, s->in, s->sol);
    if (x)
        memcpy(x, s->sol, sizeof(double) * (size_t)n);
    if (lambda)
        memcpy(lambda, s->sol + n, sizeof(double) * (size_t)m);
    if (y) {
        ns_copy((size_t)m, s->s->e, y);
        ns_matvec_add(m, n, s->s->C, s->sol, y); /* (S3) */
        ns_matvec_add(m, m, s->s->D, s->sol + n, y);
        ns_matvec_add(m, s->s->nz, s->s->F, s->in + s->r, y);
    }
    return check_read(s, y);
}
