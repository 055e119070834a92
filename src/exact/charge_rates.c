/* src/exact/charge_rates.c - by how much an Euler step changes each charge and flux. */
#include "linalg/abs_product.h"
#include "mode_kernel.h"

#include <math.h>

/* rates (r) = g (A x + B lambda + E z + b) of the differential rows, input k of the map: what D adds to each
 * charge.  size (r): of the terms. */
static void add_flows(const ns_theta *s, const ns_map *map, int k, double *rates, double *size) {
    const int n = s->s->n, m = s->s->m, r = s->r;
    const double *x = map->full + (size_t)k * (size_t)(n + m);
    for (int i = 0; i < r; i++) {
        rates[i] = k == s->q - 1 ? s->b[i] : k >= r ? s->E[i + (k - r) * n] : 0;
        size[i] = fabs(rates[i]);
    }
    ns_linalg_abs_product_add(r, n, n, s->A, x, rates, size);
    ns_linalg_abs_product_add(r, m, n, s->B, x + n, rates, size);
    for (int i = 0; i < r; i++) {
        rates[i] *= map->h;
        size[i] *= map->h;
    }
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
    for (int k = 0; k < s->q; k++, rates += s->r, size += s->r) {
        add_flows(s, map, k, rates, size);
        for (int i = 0; i < s->r; i++) {
            double fewer;
            if (!(fabs(rates[i]) < cancelled * size[i]))
                continue;
            const double gained = charge_gained(s, map, i, k, &fewer);
            if (fewer < size[i]) {
                rates[i] = gained;
                size[i] = fewer;
            }
        }
    }
}
