/* src/theta/guard_rounding.c - by how much the guards of a map may be rounding.
 *
 * Column k of the map is X_k, a solution of (P2), and guard g is a row c_g of it.  Summing it up costs some
 * eps of its terms; and X_k itself, which leaves R_k = rhs - K X_k over, is off by E_k = K^-1 R_k:
 *
 *     rounding_gk = |c_g| |X_k| + |c_g E_k| / eps
 *
 * A bound, |c_g K^-1| |K| |X_k|, would be larger by as much as K is ill-conditioned: it would allow volts
 * where inductors alone carry the current of some node, as their L/h amplifies a current that is only
 * rounding. Where K is singular, K_g has leaks G (theta/regularise.h), and E = (1 - K_g^-1 G) K_g^-1 R is the
 * error of what is determined.
 */
#include "regularise.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Column g of s->Z: guard g as a function of (x, lambda_J), up to its sign. */
static void fill_functionals(ns_theta *s, const ns_map *map, int nj) {
    const int n = s->s->n, m = s->s->m, size = n + nj;
    int g = 0;
    memset(s->Z, 0, sizeof(double) * (size_t)size * (size_t)map->guards);
    for (int j = 0, inside = 0; j < m; j++) {
        const int count = ns_theta_guards_of(s, map->entry.mode, j);
        double *z = s->Z + (size_t)g * (size_t)size;
        if (map->entry.mode[j] == NS_INSIDE) {
            for (int k = 0; k < count; k++)
                z[n + inside + k * size] = 1;
            inside++;
        } else if (count > 0) {
            for (int i = 0; i < n; i++)
                z[i] = s->s->C[j + i * m];
            for (int i = 0; i < nj; i++)
                z[n + i] = s->s->D[j + s->inside[i] * m];
        }
        g += count;
    }
}

/* Guard g, c_g, in row g of the rounding: |c_g| |X_k|, a fraction of the same with every X_ik as large as the
 * largest (largest, q), and |c_g E_k|/eps. */
static void fill_row(const ns_theta *s, ns_map *map, int size, int g, double fraction,
                     const double *largest) {
    const double *c = s->Z + (size_t)g * (size_t)size, *unit = ns_linalg_lu_units(s->lu);
    const int count = ns_theta_refine_nonzeros(size, c, 1, s->list);
    double units = 0;
    for (int i = 0; i < count; i++)
        units += fabs(c[s->list[i]]) * unit[s->list[i]];
    for (int k = 0; k < s->q; k++) {
        const double *x = s->X + (size_t)k * (size_t)size, *e = s->R + (size_t)k * (size_t)size;
        double sum = 0, off = 0;
        for (int i = 0; i < count; i++) {
            const int at = s->list[i];
            sum += fabs(c[at] * x[at]);
            off += c[at] * e[at];
        }
        map->rounding[g + k * map->guards] = sum + fraction * units * largest[k] + fabs(off) / DBL_EPSILON;
    }
}

/* R becomes E. */
static void solve_for_error(ns_theta *s, const ns_leaks *leaks, int size, int exactly) {
    double *more = s->R + (size_t)size * (size_t)s->q;
    ns_theta_refine_residual(s, size, exactly, s->R);
    ns_linalg_lu_solve(s->lu, s->q, s->R);
    for (int k = 0; leaks && k < s->q; k++) {
        double *e = s->R + (size_t)k * (size_t)size;
        ns_theta_leak_times(s, leaks, e, more);
        ns_linalg_lu_solve(s->lu, 1, more);
        for (int i = 0; i < size; i++)
            e[i] -= more[i];
    }
}

/* |c| |X_k| + |c E_k| / eps for d_i, c = ((1-theta) A, (1-gamma) B) on its row. */
static double d_rounding(const ns_theta *s, int nj, int i, int k) {
    const int n = s->s->n, size = n + nj;
    const double *x = s->X + (size_t)k * (size_t)size, *e = s->R + (size_t)k * (size_t)size;
    double sum = 0, off = 0;
    for (int j = 0; j < size; j++) {
        const double c =
            j < n ? (1 - s->theta) * s->A[i + j * n] : (1 - s->gamma) * s->B[i + s->inside[j - n] * n];
        sum += fabs(c * x[j]);
        off += c * e[j];
    }
    return sum + fabs(off) / DBL_EPSILON;
}

void ns_theta_map_rounding(ns_theta *s, ns_map *map, const ns_leaks *leaks, int nj, int exactly,
                           double fraction) {
    const int size = s->s->n + nj;
    double *largest = s->R + (size_t)size * (size_t)s->q; /* q */
    fill_functionals(s, map, nj);
    solve_for_error(s, leaks, size, exactly);
    for (int k = 0; k < s->q; k++)
        largest[k] = ns_linalg_lu_largest(s->lu, s->X + (size_t)k * (size_t)size);
    for (int g = 0; g < map->guards; g++)
        fill_row(s, map, size, g, fraction, largest);
    for (int k = 0; s->carry && k < s->q; k++)
        for (int i = 0; i < s->r; i++)
            map->d_rounding[i + k * s->r] = d_rounding(s, nj, i, k);
}

void ns_theta_rate_rounding(const ns_theta *s, const ns_map *map, double *rounding) {
    memset(rounding, 0, sizeof(double) * (size_t)s->r);
    for (int k = 0; k < s->q; k++) {
        const double input = ns_theta_input_size(s, map, k);
        for (int i = 0; i < s->r; i++)
            rounding[i] += map->d_rounding[i + k * s->r] * input;
    }
}
