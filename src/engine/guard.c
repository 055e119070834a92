/* src/engine/guard.c - the inequalities that keep a mode: their rows in a map, and whether they hold. */
#include "open.h"
#include "stepper.h"

#include <math.h>
#include <string.h>

/* y_j as a function of the inputs: C x + D lambda + F z + e, column k of the map. */
static double y_entry(const ns_theta *s, const ns_map *map, int j, int k) {
    const int n = s->s->n, m = s->s->m;
    const double *v = map->full + (size_t)k * (size_t)(n + m);
    double y = 0;
    for (int i = 0; i < n; i++)
        y += s->s->C[j + i * m] * v[i];
    for (int i = 0; i < m; i++)
        y += s->s->D[j + i * m] * v[n + i];
    if (k == s->q - 1)
        y += s->s->e[j];
    else if (k >= s->r)
        y += s->s->F[j + (k - s->r) * m];
    return y;
}

int ns_guard_count(const ns_theta *s, const ns_mode *mode) {
    int count = 0;
    for (int j = 0; j < s->s->m; j++) {
        if (mode[j] == NS_INSIDE)
            count += isfinite(s->l[j]) + isfinite(s->u[j]);
        else if (s->l[j] < s->u[j])
            count++;
    }
    return count;
}

void ns_guard_fill(const ns_theta *s, ns_map *map, int k) {
    const int n = s->s->n, m = s->s->m;
    const double *lambda = map->full + (size_t)k * (size_t)(n + m) + n;
    double *row = map->step + (size_t)k * (size_t)map->p + (map->p - map->guards);
    const int one = k == s->q - 1;
    for (int j = 0; j < m; j++) {
        if (map->mode[j] == NS_INSIDE) {
            if (isfinite(s->l[j]))
                *row++ = lambda[j] - (one ? s->l[j] : 0);
            if (isfinite(s->u[j]))
                *row++ = (one ? s->u[j] : 0) - lambda[j];
        } else if (s->l[j] < s->u[j]) {
            *row++ = map->mode[j] == NS_LOWER ? y_entry(s, map, j, k) : -y_entry(s, map, j, k);
        }
    }
}

/* Of the terms of input k, eta = w + h d and what d may be off by. */
double ns_input_size(const ns_theta *s, const ns_map *map, int k) {
    if (k >= s->r)
        return fabs(s->trial_in[k]);
    return fabs(s->w[k]) + (map->implicit ? 0 : map->h * (fabs(s->d[k]) + s->d_noise[k]));
}

/* By how much guard g may be rounding. */
static double size_of(const ns_theta *s, const ns_map *map, int g, double tol) {
    double size = 0;
    for (int k = 0; k < s->q; k++)
        size += map->noise[g + k * map->guards] * ns_input_size(s, map, k);
    return tol * size;
}

/* Guard g broke, but its share of what is open may be another.  s->Z: room for the sizes of all. */
static int settle(const ns_theta *s, const ns_map *map, double tol) {
    for (int g = 0; g < map->guards; g++)
        s->Z[g] = size_of(s, map, g, tol);
    return ns_open_settle(map->guards, s->s->m, map->open, s->out + (map->p - map->guards), s->Z);
}

static int is_open(const ns_theta *s, const ns_map *map, int g) {
    int any = 0;
    for (int k = 0; map->open && k < s->s->m; k++)
        any |= map->open[g + k * map->guards] != 0;
    return any;
}

int ns_guards_hold(const ns_theta *s, const ns_map *map, double tol) {
    const double *guard = s->out + (map->p - map->guards);
    int doubt = 0;
    for (int g = 0; g < map->guards; g++) {
        if (guard[g] >= 0 || guard[g] >= -size_of(s, map, g, tol))
            continue;
        if (!is_open(s, map, g))
            return NS_GUARD;
        doubt = 1;
    }
    return doubt ? settle(s, map, tol) : NS_OK;
}

int ns_guards_flip(const ns_theta *s, const ns_map *map, double tol, ns_mode *mode) {
    const double *guard = s->out + (map->p - map->guards);
    int flipped = 0;
    for (int j = 0, g = 0; j < s->s->m; j++) {
        const int inside = map->mode[j] == NS_INSIDE;
        const int low = inside && isfinite(s->l[j]), high = inside && isfinite(s->u[j]);
        const int count = inside ? low + high : s->l[j] < s->u[j];
        for (int k = 0; k < count; k++, g++) {
            if (guard[g] >= 0 || guard[g] >= -size_of(s, map, g, tol) || is_open(s, map, g))
                continue;
            mode[j] = !inside ? NS_INSIDE : low && k == 0 ? NS_LOWER : NS_UPPER;
            flipped = 1;
        }
    }
    return flipped;
}
