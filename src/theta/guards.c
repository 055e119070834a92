/* src/theta/guards.c - the inequalities that keep a mode: their rows in a map, and whether they hold. */
#include "theta_internal.h"

#include <math.h>
#include <string.h>

/* y as a function of the inputs: C x + D lambda + F z + e, column k of the map. */
static void fill_y(const ns_theta *s, const ns_map *map, int k, double *y) {
    const int n = s->s->n, m = s->s->m;
    const double *v = map->full + (size_t)k * (size_t)(n + m);
    const double *given = k == s->q - 1 ? s->s->e
                          : k >= s->r   ? s->s->F + (size_t)(k - s->r) * (size_t)m
                                        : NULL;
    ns_linalg_matvec(m, n, s->s->C, v, y);
    ns_linalg_matvec_add(m, m, s->s->D, v + n, y);
    for (int j = 0; given && j < m; j++)
        y[j] += given[j];
}

int ns_theta_guards_of(const ns_theta *s, const ns_mode *mode, int j) {
    ns_mode to[2];
    return ns_mode_slides(mode[j]) ? 0 : ns_mode_guards(mode[j], s->l[j], s->u[j], to);
}

int ns_theta_guard_count(const ns_theta *s, const ns_mode *mode) {
    int count = 0;
    for (int j = 0; j < s->s->m; j++)
        count += ns_theta_guards_of(s, mode, j);
    return count;
}

void ns_theta_guard_fill(const ns_theta *s, ns_map *map, int k) {
    const int n = s->s->n, m = s->s->m;
    const double *lambda = map->full + (size_t)k * (size_t)(n + m) + n;
    double *row = map->step + (size_t)k * (size_t)map->p + map->guard;
    const int one = k == s->q - 1;
    double *y = s->Z; /* which the rounding of the map is found with, later */
    if (m == 0)
        return;
    fill_y(s, map, k, y);
    for (int j = 0; j < m; j++) {
        if (map->entry.mode[j] == NS_INSIDE) {
            if (isfinite(s->l[j]))
                *row++ = lambda[j] - (one ? s->l[j] : 0);
            if (isfinite(s->u[j]))
                *row++ = (one ? s->u[j] : 0) - lambda[j];
        } else if (s->l[j] < s->u[j]) {
            *row++ = map->entry.mode[j] == NS_LOWER ? y[j] : -y[j];
        }
    }
}

/* The rounding of d counts up to this many eps of the terms of a guard: after a start or an event whose rates
 * were not probed it is so large that any guard would hold. */
static const double max_d_rounding = 1e6;

/* Of the terms of input k, eta = w + h d and what d may be off by. */
double ns_theta_input_size(const ns_theta *s, const ns_map *map, int k) {
    if (k >= s->r)
        return fabs(s->trial.in[k]);
    if (map->implicit)
        return fabs(s->past.w[k]);
    const double own = fabs(s->past.w[k]) + map->h * fabs(s->past.d[k]);
    return own + fmin(map->h * s->past.d_rounding[k], max_d_rounding * own);
}

/* Guard g is negative by more than rounding may be (or no number). */
static int guard_broke(const ns_theta *s, const ns_map *map, int g, double tol) {
    const double guard = s->trial.out[map->guard + g];
    if (guard >= 0)
        return 0;
    double size = 0;
    for (int k = 0; k < s->q; k++)
        size += map->rounding[g + k * map->guards] * ns_theta_input_size(s, map, k);
    return !(guard >= -tol * size);
}

int ns_theta_guards_hold(const ns_theta *s, const ns_map *map, double tol) {
    for (int g = 0; g < map->guards; g++)
        if (guard_broke(s, map, g, tol))
            return 0;
    return 1;
}

int ns_theta_guards_flip(const ns_theta *s, const ns_map *map, double tol, ns_mode *mode) {
    int flipped = 0;
    for (int j = 0, g = 0; j < s->s->m; j++) {
        ns_mode to[2];
        const int count = ns_mode_guards(map->entry.mode[j], s->l[j], s->u[j], to);
        for (int k = 0; k < count && k < 2; k++, g++) {
            if (!guard_broke(s, map, g, tol))
                continue;
            mode[j] = to[k];
            flipped = 1;
        }
    }
    return flipped;
}
