/* src/theta/step_map.c - the step of one mode and one length as a small dense matrix.
 *
 * In a mode the pairs J are inside (y_J = 0) and the others sit at a bound (lambda_N = l or u).  With
 * W = M - h theta A (T1) on the differential rows and -A on the algebraic ones, the step is
 *
 *     [ W    -h gamma B_J ] [ x        ]   [ eta + h theta (b + E z) + h gamma B_N lambda_N ]
 *     [ C_J   D_JJ        ] [ lambda_J ] = [ -(F z + e)_J - D_JN lambda_N                   ]      (P2)
 *
 * (h gamma and h theta read 1 on algebraic rows).  Eliminating x gives (P1) in that mode; (P2) is kept
 * whole because W alone is singular in circuits whose devices all block.
 */
#include "regularise.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the last refinement may still move: far above rounding, far below what a pivot of rounding does. */
static const double moved_max = 1e-10;
/* What leaks leave to refine if they determine only what K does not: rounding of 1e-16 by leaks of 1e-10, or
 * less. */
static const double leaks_matter = 1e-4;
/* Below, K may be singular but for rounding; with pivots that differ by less, what an estimate of the
 * condition could show, the refinement shows too. */
static const double rcond_min = 1e-14, pivots_min = 1e-6;

static int list_inside(const ns_theta *s, const ns_mode *mode, int *inside) {
    int count = 0;
    for (int j = 0; j < s->s->m; j++)
        if (mode[j] == NS_INSIDE)
            inside[count++] = j;
    return count;
}

static double bound_of(const ns_theta *s, const ns_mode *mode, int j) {
    return mode[j] == NS_LOWER ? s->l[j] : s->u[j];
}

/* K is (n+nj)^2. */
int ns_theta_map_matrix(ns_theta *s, double h, int implicit, const ns_mode *mode) {
    const int n = s->s->n, m = s->s->m, nj = list_inside(s, mode, s->inside), size = n + nj;
    const double ht = implicit ? h : h * s->theta, hg = implicit ? h : h * s->gamma;
    for (int j = 0; j < n; j++) {
        double *col = s->K + (size_t)j * (size_t)size;
        for (int i = 0; i < n; i++) {
            const double a = s->A[i + j * n];
            col[i] = i < s->r ? s->M[i + j * n] - ht * a : -a; /* (T1) */
        }
        for (int i = 0; i < nj; i++)
            col[n + i] = s->s->C[s->inside[i] + j * m];
    }
    for (int k = 0; k < nj; k++) {
        const int j = s->inside[k];
        double *col = s->K + (size_t)(n + k) * (size_t)size;
        for (int i = 0; i < n; i++)
            col[i] = -(i < s->r ? hg : 1.0) * s->B[i + j * n];
        for (int i = 0; i < nj; i++)
            col[n + i] = s->s->D[s->inside[i] + j * m];
    }
    return nj;
}

/* Right-hand sides of (P2), one column for each input of the map: X. */
static void form_columns(ns_theta *s, double h, int implicit, const ns_mode *mode, int nj, double *X) {
    const int n = s->s->n, m = s->s->m, nz = s->s->nz, size = n + nj;
    const double ht = implicit ? h : h * s->theta, hg = implicit ? h : h * s->gamma;
    memset(X, 0, sizeof(double) * (size_t)size * (size_t)s->q);
    for (int i = 0; i < s->r; i++)
        X[i + i * size] = 1;
    for (int k = 0; k < nz; k++) {
        double *col = X + (size_t)(s->r + k) * (size_t)size;
        for (int i = 0; i < n; i++)
            col[i] = (i < s->r ? ht : 1) * s->E[i + k * n];
        for (int i = 0; i < nj; i++)
            col[n + i] = -s->s->F[s->inside[i] + k * m];
    }
    double *one = X + (size_t)(s->q - 1) * (size_t)size;
    for (int i = 0; i < n; i++)
        one[i] = (i < s->r ? ht : 1) * s->b[i];
    for (int i = 0; i < nj; i++)
        one[n + i] = -s->s->e[s->inside[i]];
    for (int j = 0; j < m; j++) {
        const double bound = mode[j] == NS_INSIDE ? 0 : bound_of(s, mode, j);
        if (bound == 0)
            continue;
        for (int i = 0; i < n; i++)
            one[i] += (i < s->r ? hg : 1) * s->B[i + j * n] * bound;
        for (int i = 0; i < nj; i++)
            one[n + i] -= s->s->D[s->inside[i] + j * m] * bound;
    }
}

/* full = (x, lambda) from the solution in X. */
static void fill_full(const ns_theta *s, ns_map *map, int nj) {
    const int n = s->s->n, m = s->s->m, size = n + nj;
    for (int k = 0; k < s->q; k++) {
        const double *from = s->X + (size_t)k * (size_t)size;
        double *to = map->full + (size_t)k * (size_t)(n + m);
        memcpy(to, from, sizeof(double) * (size_t)n);
        for (int j = 0; j < m; j++)
            to[n + j] =
                map->entry.mode[j] != NS_INSIDE && k == s->q - 1 ? bound_of(s, map->entry.mode, j) : 0;
        for (int i = 0; i < nj; i++)
            to[n + s->inside[i]] = from[n + i];
    }
}

/* d = (1-theta) (A x + b + E z) + (1-gamma) B lambda on row i, column k. */
static double slope_entry(const ns_theta *s, const double *v, int i, int k) {
    const int n = s->s->n, m = s->s->m;
    double f = k == s->q - 1 ? s->b[i] : k >= s->r ? s->E[i + (k - s->r) * n] : 0, g = 0;
    for (int j = 0; j < n; j++)
        f += s->A[i + j * n] * v[j];
    for (int j = 0; j < m; j++)
        g += s->B[i + j * n] * v[n + j];
    return (1 - s->theta) * f + (1 - s->gamma) * g;
}

static void fill_step(const ns_theta *s, ns_map *map) {
    const int n = s->s->n, m = s->s->m, r = s->r;
    for (int k = 0; k < s->q; k++) {
        const double *v = map->full + (size_t)k * (size_t)(n + m);
        double *out = map->step + (size_t)k * (size_t)map->p;
        for (int i = 0; i < r; i++) {
            double w = 0;
            for (int j = 0; j < n; j++)
                w += s->M[i + j * n] * v[j];
            *out++ = w;
        }
        for (int i = 0; s->carry && i < r; i++)
            *out++ = slope_entry(s, v, i, k);
        for (int c = 0; c < s->s->nc; c++) {
            const double *gx = s->s->command[c].gx;
            double g = 0;
            for (int j = 0; gx && j < n; j++)
                g += gx[j] * v[j];
            *out++ = g;
        }
        ns_theta_guard_fill(s, map, k);
    }
}

static ns_map *map_create(const ns_theta *s, const ns_mode *mode) {
    const size_t m = (size_t)s->s->m, n = (size_t)s->s->n, q = (size_t)s->q;
    const int guards = ns_theta_guard_count(s, mode);
    const int guard = (s->r * (s->carry ? 2 : 1) + s->s->nc + 1) & ~1, p = (guard + guards + 3) & ~3;
    const size_t rates = s->carry ? (size_t)s->r : 0;
    const size_t numbers = ((size_t)p + n + m + (size_t)guards + rates) * q;
    const size_t bytes = sizeof(ns_map) + numbers * sizeof(double) + m;
    ns_map *map = calloc(1, bytes);
    if (!map)
        return NULL;
    map->p = p;
    map->guards = guards;
    map->guard = guard;
    map->entry.bytes = bytes;
    map->step = (double *)(void *)(map + 1);
    map->full = map->step + (size_t)p * q;
    map->rounding = map->full + (n + m) * q;
    map->d_rounding = map->rounding + (size_t)guards * q;
    map->entry.mode = (ns_mode *)(map->d_rounding + rates * q);
    memcpy(map->entry.mode, mode, m);
    return map;
}

/* X from the right-hand sides in R.  K's condition is that of its scaling; whether its factors are good for
 * anything shows in the refinement. */
static int solve_factored(ns_theta *s, int size, int *exactly) {
    memcpy(s->X, s->R, sizeof(double) * (size_t)size * (size_t)s->q);
    ns_linalg_lu_solve(s->lu, s->q, s->X);
    return ns_theta_refine(s, size, exactly) <= moved_max ? NS_OK : NS_E_SINGULAR;
}

/* The same by leaks (ns_theta_leak_solve()): X and the factors K_g.  *moved: what the refinement with K_g
 * still moved, relative to X. */
static int solve_with_leaks(ns_theta *s, const ns_leaks *leaks, int nj, double *moved) {
    const int size = s->s->n + nj;
    memcpy(s->X, s->R, sizeof(double) * (size_t)size * (size_t)s->q);
    const int status = ns_theta_leak_solve(s, leaks, nj, s->q);
    if (status == NS_OK)
        *moved = ns_theta_refine_exactly(s, size);
    return status;
}

/* X by K as it is, whatever its condition, if that converges. */
static int solve_as_it_is(ns_theta *s, int size, int *exactly) {
    s->counts.factors++;
    const int status = ns_linalg_lu_factor(s->lu, size, s->K, NULL);
    return status == NS_OK ? solve_factored(s, size, exactly) : status;
}

/* K, each entry changed by some units of its rounding. */
static void round_entries(double *K, size_t count) {
    unsigned dice = 1;
    for (size_t i = 0; i < count; i++) {
        dice = dice * 1664525u + 1013904223u;
        K[i] *= 1 + (dice >> 31 ? 4 : -4) * DBL_EPSILON;
    }
}

/* 1 if X is that of `before` but for its rounding. */
static int is_same_solution(ns_theta *s, int size, const double *before) {
    static const double same = 1e-8;
    double *change = s->R + (size_t)size * (size_t)s->q;
    for (int k = 0; k < s->q; k++) {
        const double *x = s->X + (size_t)k * (size_t)size, *was = before + (size_t)k * (size_t)size;
        for (int i = 0; i < size; i++)
            change[i] = x[i] - was[i];
        if (!(ns_linalg_lu_largest(s->lu, change) <= same * ns_linalg_lu_largest(s->lu, x)))
            return 0;
    }
    return 1;
}

/* The same where leaks fail: of a singular K, the factors of another matrix, which differs from it by
 * rounding, lead to another X in the null space. */
static int solve_if_regular(ns_theta *s, int size, int *exactly) {
    const size_t square = (size_t)size * (size_t)size, count = (size_t)size * (size_t)s->q;
    double *K = malloc(sizeof *K * (square + count + 1));
    if (!K)
        return NS_E_MEMORY;
    double *const X = K + square;
    memcpy(K, s->K, sizeof *K * square);
    round_entries(s->K, square);
    s->counts.factors++;
    int status = ns_linalg_lu_factor(s->lu, size, s->K, NULL);
    memcpy(s->K, K, sizeof *K * square);
    if (status == NS_OK)
        status = solve_factored(s, size, exactly);
    memcpy(X, s->X, sizeof *X * count);
    if (status == NS_OK)
        status = solve_as_it_is(s, size, exactly);
    if (status == NS_OK && !is_same_solution(s, size, X))
        status = NS_E_SINGULAR;
    free(K);
    return status;
}

/* X from the right-hand sides in R.  A pivot that is only rounding can pass for one, with an X of any size
 * in the null space; leaks show it, as they determine what the null space does not and leave the rest alone.
 * Where they do not, as they are more than what determines the rest, K is regular after all, of a condition
 * near 1e15 or above.  *leaky: there are leaks in the factors. */
static int solve_columns(ns_theta *s, const ns_leaks *leaks, int nj, int *leaky, int *exactly) {
    const int size = s->s->n + nj;
    double moved = 0;
    *leaky = *exactly = 0;
    s->counts.factors++;
    const int regular = ns_linalg_lu_factor(s->lu, size, s->K, NULL);
    if (regular != NS_OK && regular != NS_E_SINGULAR)
        return regular;
    if (regular == NS_OK &&
        (ns_linalg_lu_pivots(s->lu) >= pivots_min || ns_linalg_lu_rcond(s->lu) >= rcond_min) &&
        solve_factored(s, size, exactly) == NS_OK)
        return NS_OK;
    int status = solve_with_leaks(s, leaks, nj, &moved);
    if (regular == NS_OK && status == NS_OK && moved > leaks_matter) {
        if (solve_as_it_is(s, size, exactly) == NS_OK)
            return NS_OK;
        status = solve_with_leaks(s, leaks, nj, &moved);
    }
    if (regular == NS_OK && status == NS_E_SINGULAR)
        return solve_if_regular(s, size, exactly);
    *leaky = *exactly = status == NS_OK;
    return status;
}

int ns_theta_map_build(ns_theta *s, double h, int implicit, const ns_mode *mode, double fraction,
                       ns_map **out) {
    const int nj = ns_theta_map_matrix(s, h, implicit, mode);
    const ns_leaks leaks = {mode, implicit ? h : h * s->theta, s->leak};
    int leaky, exactly;
    *out = NULL;
    ns_theta_forget_failure(s); /* K is used */
    form_columns(s, h, implicit, mode, nj, s->R);
    const int status = solve_columns(s, &leaks, nj, &leaky, &exactly);
    if (status != NS_OK)
        return status;
    ns_map *map = map_create(s, mode);
    if (!map)
        return NS_E_MEMORY;
    map->h = h;
    map->implicit = implicit;
    fill_full(s, map, nj);
    fill_step(s, map);
    ns_theta_map_rounding(s, map, leaky ? &leaks : NULL, nj, exactly, fraction);
    s->counts.maps++;
    *out = map;
    return NS_OK;
}

void ns_theta_map_free(ns_map *map) {
    free(map);
}
