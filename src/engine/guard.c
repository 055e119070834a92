/* src/engine/guard.c - the inequalities that keep a mode: their rows in a map, and whether they hold. */
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

/* Column g of s->Z: guard g as a function of (x, lambda_J), up to its sign. */
static void fill_functionals(ns_theta *s, const ns_map *map, int nj) {
    const int n = s->s->n, m = s->s->m, size = n + nj;
    int g = 0;
    memset(s->Z, 0, sizeof(double) * (size_t)size * (size_t)map->guards);
    for (int j = 0, inside = 0; j < m; j++) {
        if (map->mode[j] == NS_INSIDE) {
            const int here = isfinite(s->l[j]) + isfinite(s->u[j]);
            for (int k = 0; k < here; k++)
                s->Z[n + inside + (g + k) * size] = 1;
            g += here;
            inside++;
        } else if (s->l[j] < s->u[j]) {
            double *z = s->Z + (size_t)g * (size_t)size;
            for (int i = 0; i < n; i++)
                z[i] = s->s->C[j + i * m];
            for (int i = 0; i < nj; i++)
                z[n + i] = s->s->D[j + s->inside[i] * m];
            g++;
        }
    }
}

/* Sizes of the terms of every row of (P2), column k. */
static void row_terms(const ns_theta *s, int size, int k, double *terms) {
    const double *x = s->X + (size_t)k * (size_t)size;
    for (int i = 0; i < size; i++)
        terms[i] = 0;
    for (int j = 0; j < size; j++)
        for (int i = 0; i < size; i++)
            terms[i] += fabs(s->K[i + j * size] * x[j]);
}

/* Beside the terms that are there: what is zero comes out, refined, far below eps of the largest unknown in
 * the units of the factors, and what (P1) leaves behind of a charge that has gone is some eps of it. */
static const double of_largest = 2e-4;

/* |c_g| |X_k|, and a share of the same with every X_ik as large as the largest of its column. */
static double own_terms(const ns_theta *s, int size, const double *c, int k) {
    const double *x = s->X + (size_t)k * (size_t)size, *unit = ns_lu_units(s->lu);
    double sum = 0, units = 0, largest = 0;
    for (int i = 0; i < size; i++) {
        sum += fabs(c[i] * x[i]);
        units += fabs(c[i]) * unit[i];
        largest = fmax(largest, fabs(x[i]) / unit[i]);
    }
    return sum + of_largest * units * largest;
}

/* A solution of (P2) is good to some eps of the terms of each of its rows.  What that does to guard g is a
 * bound on its rounding:  noise_gk = |c_g| |X_k| + |c_g K^-1| |K| |X_k|,  c_g the guard as a function of (x,
 * lambda_J). */
static void own_noise(ns_theta *s, const ns_map *map, int nj, double *own) {
    const int size = s->s->n + nj, ng = map->guards;
    fill_functionals(s, map, nj);
    for (int k = 0; k < s->q; k++)
        for (int g = 0; g < ng; g++)
            own[g + k * ng] = own_terms(s, size, s->Z + (size_t)g * (size_t)size, k);
}

/* Adds the second part.  Returns the most that it is, relative to the first. */
static double add_noise_of_rows(ns_theta *s, ns_map *map, int size) {
    const int ng = map->guards;
    double *terms = s->rhs, most = 0; /* free between problems */
    ns_lu_solve_transposed(s->lu, ng, s->Z);
    for (int k = 0; k < s->q; k++) {
        row_terms(s, size, k, terms);
        for (int g = 0; g < ng; g++) {
            const double *z = s->Z + (size_t)g * (size_t)size;
            double *noise = &map->noise[g + k * ng], sum = 0;
            for (int i = 0; i < size; i++)
                sum += fabs(z[i]) * terms[i];
            most = fmax(most, sum / *noise);
            *noise += sum;
        }
    }
    return most;
}

/* What the guards have to be looked at together with: s->Z as add_noise_of_rows() left it. */
static int keep_doubt(ns_theta *s, ns_map *map, int nj) {
    const int size = s->s->n + nj;
    ns_doubt *d = map->doubt = ns_doubt_create(size, map->guards, s->q);
    if (!d)
        return NS_E_MEMORY;
    memcpy(d->Z, s->Z, sizeof(double) * (size_t)size * (size_t)map->guards);
    for (int k = 0; k < s->q; k++)
        row_terms(s, size, k, d->terms + (size_t)k * (size_t)size);
    own_noise(s, map, nj, d->own);
    map->bytes +=
        sizeof(double) * ((size_t)size * (size_t)(map->guards + s->q) + (size_t)(map->guards * s->q));
    return NS_OK;
}

/* A bound as large as this beside the guard's own terms excuses what somebody could see. */
static const double of_own = 1e4;

int ns_guard_noise(ns_theta *s, ns_map *map, int nj) {
    own_noise(s, map, nj, map->noise);
    const double most = add_noise_of_rows(s, map, s->s->n + nj);
    return most > of_own && map->guards > 1 ? keep_doubt(s, map, nj) : NS_OK;
}

static double bound(const ns_theta *s, const double *noise, int guards, int g) {
    double size = 0;
    for (int k = 0; k < s->q; k++)
        size += noise[g + k * guards] * fabs(s->trial_in[k]);
    return size;
}

int ns_guards_hold(const ns_theta *s, const ns_map *map, double tol) {
    const double *guard = s->out + (map->p - map->guards);
    int doubt = 0;
    for (int g = 0; g < map->guards; g++) {
        if (guard[g] >= 0)
            continue;
        if (!(guard[g] >= -tol * bound(s, map->noise, map->guards, g)))
            return NS_GUARD;
        doubt |= map->doubt && guard[g] < -tol * bound(s, map->doubt->own, map->guards, g);
    }
    return doubt ? ns_doubt_settle(map->doubt, guard, s->trial_in, tol) : NS_OK;
}
