/* src/exact/sliding.c - modes in which a switch slides: its control is held exactly at its threshold, by any
 * current between that of the open switch and that of the closed one.
 *
 * For (P2) that is a pair inside whose row is another one: the control less its threshold instead of y.
 */
#include "sliding.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int ns_exact_sliding_count(const ns_mode *mode, int m) {
    int count = 0;
    for (int j = 0; j < m; j++)
        count += ns_mode_slides(mode[j]);
    return count;
}

/* The system with the rows of sliding pairs changed, while a map is built. */
typedef struct ns_sliding_system {
    ns_system system;
    double *C, *D, *F, *e; /* its rows of pairs */
    double *l, *u;         /* the stepper's bounds, to be restored */
    ns_mode *mode;
} ns_sliding_system;

static void set_rows(const ns_theta *s, const ns_mode *mode, ns_sliding_system *w) {
    const int n = s->s->n, m = s->s->m, nz = s->s->nz;
    for (int c = 0; c < s->s->nc; c++) {
        const ns_command *of = &s->s->command[c];
        const int j = of->pair;
        if (!ns_mode_slides(mode[j]))
            continue;
        for (int i = 0; i < n; i++)
            w->C[j + i * m] = of->gx[i];
        for (int i = 0; i < m; i++)
            w->D[j + i * m] = 0;
        for (int k = 0; k < nz; k++)
            w->F[j + k * m] = of->gz ? of->gz[k] : 0;
        w->e[j] = of->g0 - of->on;
        w->mode[j] = NS_INSIDE;
        s->l[j] = -INFINITY;
        s->u[j] = INFINITY;
    }
}

/* An Euler step may be as short as ron C.  Its largest unknowns, currents that recharge capacitors within it,
 * are then 1e12 times the others: only this fraction of them counts as the size that rounding is relative to.
 */
static const double of_largest = 1e-9;

int ns_exact_sliding_map(ns_theta *s, double g, const ns_mode *mode, ns_map **out) {
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m, nz = (size_t)s->s->nz;
    if (ns_exact_sliding_count(mode, s->s->m) == 0)
        return ns_theta_map_build(s, g, 1, mode, of_largest, out);
    const ns_system *was = s->s;
    ns_sliding_system w = {.system = *was};
    *out = NULL;
    w.C = malloc(sizeof *w.C * (m * (n + m + nz + 3)));
    w.mode = malloc(m);
    if (!w.C || !w.mode) {
        free(w.C);
        free(w.mode);
        return NS_E_MEMORY;
    }
    w.D = w.C + m * n;
    w.F = w.D + m * m;
    w.e = w.F + m * nz;
    w.l = w.e + m;
    w.u = w.l + m;
    memcpy(w.C, was->C, sizeof *w.C * m * n);
    memcpy(w.D, was->D, sizeof *w.C * m * m);
    ns_linalg_copy(m * nz, was->F, w.F);
    memcpy(w.e, was->e, sizeof *w.C * m);
    memcpy(w.l, s->l, sizeof *w.C * m);
    memcpy(w.u, s->u, sizeof *w.C * m);
    memcpy(w.mode, mode, m);
    set_rows(s, mode, &w);
    w.system.C = w.C;
    w.system.D = w.D;
    w.system.F = w.F;
    w.system.e = w.e;
    s->s = &w.system;
    const int status = ns_theta_map_build(s, g, 1, w.mode, of_largest, out);
    s->s = was;
    memcpy(s->l, w.l, sizeof *w.C * m);
    memcpy(s->u, w.u, sizeof *w.C * m);
    free(w.mode);
    free(w.C);
    return status;
}

/* y of pair j by input k of the map, and the size of its terms. */
static double y_entry(const ns_theta *s, const ns_map *map, int j, int k, double *terms) {
    const int n = s->s->n, m = s->s->m;
    const double *v = map->full + (size_t)k * (size_t)(n + m);
    double y = k == s->q - 1 ? s->s->e[j] : k >= s->r ? s->s->F[j + (k - s->r) * m] : 0;
    *terms = fabs(y);
    for (int i = 0; i < n; i++) {
        y += s->s->C[j + i * m] * v[i];
        *terms += fabs(s->s->C[j + i * m] * v[i]);
    }
    for (int i = 0; i < m; i++) {
        y += s->s->D[j + i * m] * v[n + i];
        *terms += fabs(s->s->D[j + i * m] * v[n + i]);
    }
    return y;
}

void ns_exact_sliding_fill(const ns_theta *s, const ns_map *map, const ns_mode *mode, int rows, double *row,
                           double *noise) {
    const int n = s->s->n, m = s->s->m;
    for (int j = 0, g = 0; j < m; j++) {
        if (!ns_mode_slides(mode[j]))
            continue;
        const double sign = mode[j] == NS_SLIDES_UP ? 1 : -1;
        for (int k = 0; k < s->q; k++) {
            const double lambda = map->full[(size_t)k * (size_t)(n + m) + (size_t)(n + j)];
            row[g + k * rows] = sign * lambda;
            noise[g + k * rows] = fabs(lambda);
            row[g + 1 + k * rows] = -sign * y_entry(s, map, j, k, &noise[g + 1 + k * rows]);
        }
        g += 2;
    }
}
