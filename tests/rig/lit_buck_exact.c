/* tests/rig/lit_buck_exact.c - the buck converter of the literature integrated without complementarity. */
#include "lit_buck_exact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = LIT_BUCK_N, STAGES = 7 };

typedef struct circuit {
    double L, Cout, R12, C11, R11, R21, C21, gain;
    int hinges;
    const double *slope, *start;
} circuit;

static const double slope2[] = {0.41421356, 1.17157288}, start2[] = {0, 0.5};
static const double slope5[] = {0.09, 0.2238, 0.4666, 1.1605, 2.8863},
                    start5[] = {0, 0.1, 0.2487, 0.6182, 1.5383};

static circuit circuit_of(int hinges, lit_set set, double gain) {
    circuit c = {10e-6, 22e-6, 227.8e3, 20e-12, 15.58e3, 5.613e6, 1.9e-12, gain, hinges, slope5, start5};
    if (hinges == 2) {
        c.slope = slope2;
        c.start = start2;
    }
    if (set == LIT_SLIDING) {
        c.L = 4e-6;
        c.Cout = 10e-6;
        c.R11 = 10e3;
        c.R21 = 8e6;
        c.C11 = 10e-12;
    }
    return c;
}

static double f(const circuit *c, double v) { /* near max(0, v)^2 */
    double sum = 0;
    for (int k = 0; k < c->hinges && v > c->start[k]; k++)
        sum += c->slope[k] * (v - c->start[k]);
    return sum;
}

/* What the diode from ground must bring (> 0), or that to vin take (< 0), for v(D) to be d; `rest` is what of
 * it does not depend on d. */
static double surplus(const circuit *c, double g, double rest, double d) {
    return rest + 5 * (f(c, d - g - 2) - f(c, g - d - 2));
}

/* The root lies between two neighbouring corners of the transistors' curves, between which all is straight.
 * Where nothing conducts, i is 0 and stays so: v(D) = v_out. */
static double drain(const circuit *c, double g, double i, double out) {
    const double rest = i + 5 * (f(c, g - 2) - f(c, 3 - g - 2));
    double lo = -0.8, hi = 3.8, at_lo = surplus(c, g, rest, lo), at_hi = surplus(c, g, rest, hi);
    if (at_lo >= 0)
        return lo;
    if (at_hi <= 0)
        return hi;
    for (int k = 0; k < 2 * c->hinges; k++) {
        const double start = c->start[k / 2], corner = k % 2 ? g + 2 + start : g - 2 - start;
        if (corner <= lo || corner >= hi)
            continue;
        const double s = surplus(c, g, rest, corner);
        if (s <= 0) {
            lo = corner;
            at_lo = s;
        }
        if (s >= 0) {
            hi = corner;
            at_hi = s;
        }
    }
    if (surplus(c, g, rest, out) == 0)
        return out;
    return at_hi > at_lo ? lo - at_lo * (hi - lo) / (at_hi - at_lo) : lo;
}

static double ramp(double t) {
    const double period = 1.6667e-6, s = t - period * floor(t / period);
    if (s < 1.655e-6)
        return 2.25 * s / 1.655e-6;
    return s < 1.656e-6 ? 2.25 : s < 1.666e-6 ? 2.25 * (1.666e-6 - s) / 10e-9 : 0;
}

static void slopes(const circuit *c, double t, const double *x, double *out) {
    const double g12 = 1 / c->R12, g11 = 1 / c->R11, g21 = 1 / c->R21;
    const double vref = 1.8 * fmin(1, t / 100e-6);
    const double vm = (g12 * x[1] + g11 * (x[1] - x[2]) + g21 * (x[3] + x[4])) / (g12 + g11 + g21);
    const double i12 = g12 * (x[1] - vm), i11 = g11 * (x[1] - x[2] - vm), i21 = g21 * (vm - x[3] - x[4]);
    const double g = fmin(3, fmax(0, 1.5 + c->gain * (ramp(t) - x[4])));
    out[0] = (drain(c, g, x[0], x[1]) - x[1]) / c->L;
    out[1] = (x[0] - x[1] / 10 - i12 - i11) / c->Cout;
    out[2] = i11 / c->C11;
    out[3] = i21 / c->C21;
    out[4] = (1e4 * (vref - vm) - x[4]) * 2 * 3.14159265358979323846 * 30e6;
}

/* One step of Dormand and Prince's pair; k[0] holds the slopes at x, k[6] gets those at the end.  Returns the
 * local error relative to the sizes of the states. */
static double pair_step(const circuit *c, double t, double h, const double *x, double k[STAGES][N],
                        double *next) {
    static const double a[STAGES][STAGES] = {
        {0},
        {1.0 / 5},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static const double at[STAGES] = {0, 0.2, 0.3, 0.8, 8.0 / 9, 1, 1};
    static const double gap[STAGES] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                       -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    static const double size[N] = {0.5, 1.8, 0.01, 0.2, 2};
    double error = 0;
    for (int s = 1; s < STAGES; s++) {
        for (int i = 0; i < N; i++) {
            double sum = 0;
            for (int j = 0; j < s; j++)
                sum += a[s][j] * k[j][i];
            next[i] = x[i] + h * sum;
        }
        slopes(c, t + at[s] * h, next, k[s]);
    }
    for (int i = 0; i < N; i++) {
        double sum = 0;
        for (int s = 0; s < STAGES; s++)
            sum += gap[s] * k[s][i];
        error = fmax(error, fabs(h * sum) / size[i]);
    }
    return error;
}

/* From t to end, over which the inputs are straight. */
static void advance(const circuit *c, double t, double end, double tolerance, double *h, double *x) {
    double k[STAGES][N], next[N];
    slopes(c, t, x, k[0]);
    while (t < end) {
        const int last = t + *h >= end;
        const double step = last ? end - t : *h;
        const double error = pair_step(c, t, step, x, k, next);
        if (error <= tolerance) {
            t = last ? end : t + step;
            memcpy(x, next, sizeof next);
            memcpy(k[0], k[6], sizeof k[0]);
        }
        if (error > tolerance || !last)
            *h = step * fmin(3, fmax(0.2, 0.9 * pow(tolerance / (error + 1e-30), 0.2)));
        if (*h < 1e-17)
            abort();
    }
}

/* The first corner of the inputs after t. */
static double next_corner(double t) {
    const double period = 1.6667e-6, corners[] = {0, 1.655e-6, 1.656e-6, 1.666e-6, period};
    const double start = period * floor(t / period + 1e-9);
    double next = t < 100e-6 * (1 - 1e-12) ? 100e-6 : INFINITY;
    for (int k = 0; k < 5; k++)
        if (start + corners[k] > t + 1e-15)
            next = fmin(next, start + corners[k]);
    return next;
}

void lit_buck_exact(int hinges, lit_set set, double gain, double tolerance, double every, int samples,
                    double *X) {
    const circuit c = circuit_of(hinges, set, gain);
    double x[N] = {0}, t = 0, h = 1e-11;
    for (int k = 0; k < samples; k++) {
        const double until = every * (k + 1);
        while (t < until) {
            const double end = fmin(until, next_corner(t));
            advance(&c, t, end, tolerance, &h, x);
            t = end;
        }
        memcpy(X + (size_t)k * N, x, sizeof x);
    }
}
