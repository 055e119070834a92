/* bridge/pure/piecewise_curve.c - curves that end level, as tanh and atan, as chords. */
#include "piecewise.h"

#include <math.h>

enum { SAMPLES = 32, ROUNDS = 40, POINTS = PIECEWISE_CURVE / 4 };

/* The chords begin and end above the curve by what they may be off: so they are longer than those between
 * points of it.  Beyond the last one they are level where the curve ends. */
static double end_of_chord(double (*f)(double), double x, double within) {
    return x == 0.0 ? 0.0 : fmin(f(x) + within, f(INFINITY));
}

/* By how much the curve is off the chord from x to end, at most. */
static double off_chord(double (*f)(double), double x, double end, double within) {
    const double from = end_of_chord(f, x, within), to = end_of_chord(f, end, within);
    double off = 0.0;
    for (int k = 1; k < SAMPLES; k++) {
        const double part = (double)k / SAMPLES;
        off = fmax(off, fabs(f(x + part * (end - x)) - (1.0 - part) * from - part * to));
    }
    return off;
}

/* The end of the longest chord from x, at most `far`, that is within so much of the curve. */
static double longest_chord(double (*f)(double), double x, double far, double within) {
    double near = x, end = far;
    if (off_chord(f, x, end, within) <= within)
        return end;
    for (int k = 0; k < ROUNDS; k++) {
        const double middle = 0.5 * (near + end);
        *(off_chord(f, x, middle, within) <= within ? &near : &end) = middle;
    }
    return near;
}

int ns_bridge_piecewise_chords(double (*f)(double), double far, double within, double *xy) {
    double side[POINTS], x = 0.0;
    int n = 0;
    while (n < POINTS && x < far) {
        x = n + 1 < POINTS ? longest_chord(f, x, far, within) : far;
        side[n++] = x;
    }
    for (int k = 0; k < 2 * n; k++) { /* the two chords at 0 are one */
        const double at = k < n ? side[n - 1 - k] : side[k - n];
        xy[2 * k] = k < n ? -at : at;
        xy[2 * k + 1] = (k < n ? -1.0 : 1.0) * (at == far ? f(INFINITY) : end_of_chord(f, at, within));
    }
    return 2 * n;
}

ns_piecewise_value *ns_bridge_piecewise_curve(ns_piecewise *p, double (*f)(double), double far, double within,
                                              const ns_piecewise_value *a) {
    double xy[PIECEWISE_CURVE];
    return ns_bridge_piecewise_line(p, a, ns_bridge_piecewise_chords(f, far, within, xy), xy, 1);
}
