/* src/exact/input_series.c - what the series (E1) leaves off of an input at tau = 0.
 *
 * The charges M x of the series at tau = 0 are w - D^8 w.  An input alone is no charge, so all that its
 * series has of them, -D^8 of it, is an error.  It is a part of 1e-13 of what the input charges in the Euler
 * step, g; where the input rises by 1e11 A/s and ends after 0.1 ns, with g of 1 us, that is more than all
 * there is.
 */
#include "mode_kernel.h"

#include <float.h>
#include <math.h>

/* The largest of so many charges, each in its unit. */
static double largest(const ns_theta *s, const double *w) {
    double most = 0;
    for (int i = 0; i < s->r; i++)
        most = fmax(most, fabs(w[i]) / s->unit[i]);
    return most;
}

int ns_exact_kernel_leaves_off(const ns_theta *s, const ns_mode_kernel *k, int j, double *room) {
    static const double part = 1e-3, resolved = 1e-8; /* what is damped has D near -1 */
    const double *off = k->D8 + (size_t)j * (size_t)k->r, most = largest(s, off);
    if (j < k->r || most == 0 ||
        most > resolved * largest(s, k->laguerre_powers + (size_t)j * (size_t)(NS_ORDER * k->r)))
        return 0;
    ns_linalg_matvec(k->r, k->r, k->D8, off, room);
    return largest(s, room) <= part * most;
}

/* Guard g of input j, whose value lacks as much.  Rates by (E1) are sums over i of i, and of i (i - 1) / 2:
 * terms from i = 8 on are those of D^8 w, whose i is 8 less. */
static void add_to_guard(ns_mode_kernel *k, int g, int j, double lacks) {
    static const double order = NS_ORDER;
    const double *off = k->D8 + (size_t)j * (size_t)k->r;
    double rate = 0, second_rate = 0;
    for (int i = 0; i < k->r; i++) {
        rate += k->rate[i + g * k->q] * off[i];
        second_rate += k->second_rate[i + g * k->q] * off[i];
    }
    k->value[j + g * k->q] += lacks;
    k->rate[j + g * k->q] += rate - order * lacks / k->g;
    k->second_rate[j + g * k->q] +=
        second_rate + (order * (order - 1) / 2 * lacks / k->g - order * rate) / k->g;
    k->guard_values[g + 2 * j * k->rows] = k->value[j + g * k->q];
    k->guard_values[g + (2 * j + 1) * k->rows] = k->rate[j + g * k->q];
}

void ns_exact_kernel_add_left_off(const ns_theta *s, ns_mode_kernel *k, double *room) {
    static const double few = 64 * DBL_EPSILON;
    for (int j = k->r; j < k->q; j++) {
        const double *off = k->D8 + (size_t)j * (size_t)k->r;
        if (!ns_exact_kernel_leaves_off(s, k, j, room))
            continue;
        for (int g = 0; g < k->rows; g++) {
            double lacks = 0;
            for (int i = 0; i < k->r; i++)
                lacks += k->value[i + g * k->q] * off[i];
            if (fabs(lacks) > few * k->rounding[g + j * k->rows])
                add_to_guard(k, g, j, lacks);
        }
    }
}
