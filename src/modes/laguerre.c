/* src/modes/laguerre.c - the coefficients of (E1), (E2), by the three-term recurrence. */
#include "laguerre.h"

/* L_0 ... L_count at s. */
static void polynomials(double s, int count, double *L) {
    static const double part[] = {1, 1. / 2, 1. / 3, 1. / 4, 1. / 5, 1. / 6, 1. / 7, 1. / 8};
    L[0] = 1;
    L[1] = 1 - s;
    for (int i = 1; i < count; i++)
        L[i + 1] = ((2 * i + 1 - s) * L[i] - i * L[i - 1]) * part[i];
}

const double ns_modes_laguerre_max[NS_ORDER] = {1, 3.2668, 1.569, 2.5614, 1.4534, 1.5062, 2.1682, 1.6517};

static double sign(int i) {
    return i % 2 ? -1 : 1;
}

void ns_modes_laguerre(double s, int count, double *c) {
    polynomials(s, count - 1, c);
    for (int i = 1; i < NS_ORDER; i += 2)
        c[i] = -c[i];
}

/* L_i - L_{i-1} = -(s/i) K_{i-1}, K being Laguerre polynomials with alpha = 1: of a step far shorter than g
 * the difference of two numbers close to 1 would leave no digit. */
static void short_steps(double s, double *b) {
    double before = 0, K = 1;
    for (int i = 1; i <= NS_ORDER; i++) {
        b[i] = -sign(i) * s / i * K;
        const double next = (2 * i - s) / i * K - before;
        before = K;
        K = next;
    }
}

/* Differences where they have 12 digits: summed for what is infinitely fast, they leave L_8. */
void ns_modes_laguerre_steps(double s, double *b) {
    static const double is_short = 1.0 / 4096;
    double L[NS_ORDER + 1];
    b[0] = 1;
    if (s < is_short) {
        short_steps(s, b);
        return;
    }
    polynomials(s, NS_ORDER, L);
    for (int i = 1; i <= NS_ORDER; i++)
        b[i] = sign(i) * (L[i] - L[i - 1]); /* (E2) */
}
