/* src/exact/charge_rates.c - by how much an Euler step changes each charge and flux. */
#include "mode_kernel.h"

#include <math.h>

/* g (A x + B lambda + E z + b) of differential row i, input k of the map: what D adds to its charge. */
static double flow_into(const ns_theta *s, const ns_map *map, int i, int k, double *terms) {
    const int n = s->s->n, m = s->s->m, r = s->r;
    const double *x = map->full + (size_t)k * (size_t)(n + m);
    double sum = k == s->q - 1 ? s->b[i] : k >= r ? s->E[i + (k - r) * n] : 0, size = fabs(sum);
    for (int j = 0; j < n; j++) {
        sum += s->A[i + j * n] * x[j];
        size += fabs(s->A[i + j * n] * x[j]);
    }
    for (int j = 0; j < m; j++) {
        sum += s->B[i + j * n] * x[n + j];
        size += fabs(s->B[i + j * n] * x[n + j]);
    }
    *terms = map->h * size;
    return map->h * sum;
}

/* The same as the difference of the charges M x after and w before the Euler step. */
static double charge_gained(const ns_theta *s, const ns_map *map, int i, int k, double *terms) {
    const int n = s->s->n;
    const double *x = map->full + (size_t)k * (size_t)(n + s->s->m);
    double sum = k == i ? -1 : 0;
    *terms = fabs(sum);
    for (int j = 0; j < n; j++) {
        sum += s->M[i + j * n] * x[j];
        *terms += fabs(s->M[i + j * n] * x[j]);
    }
    return sum;
}

/* D w: the flows into each charge.  Where these cancel, as through a resistor whose end is open, the
 * difference of the charges if it is summed from smaller terms. */
void ns_exact_kernel_charge_rates(const ns_theta *s, const ns_map *map, double *rates, double *size) {
    static const double cancelled = 1e-3;
    for (int k = 0; k < s->q; k++)
        for (int i = 0; i < s->r; i++) {
            double terms, fewer = INFINITY, sum = flow_into(s, map, i, k, &terms);
            const double gained = fabs(sum) < cancelled * terms ? charge_gained(s, map, i, k, &fewer) : 0;
            if (fewer < terms) {
                sum = gained;
                terms = fewer;
            }
            rates[i + k * s->r] = sum;
            size[i + k * s->r] = terms;
        }
}
