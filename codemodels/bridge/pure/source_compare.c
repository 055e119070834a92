/* bridge/pure/source_compare.c - is a source of ngspice what it was read as? */
#include "source_compare.h"

#include <math.h>

enum { SPREAD = 16 }; /* instants that belong to no signal */

/* Parts of the run that are no simple fractions of each other, so of no period either. */
static double spread(int k, double tstop) {
    static const double golden = 0.6180339887498949;
    return tstop * fmod((k + 1) * golden, 1.0);
}

/* The middles of the first segments of z, at most `most` of them. */
static int middles(const ns_signal *z, double tstop, int most, double *t) {
    double from = 0.0;
    int n = 0;
    while (n < most && from < tstop) {
        const double to = fmin(ns_signal_next_corner(z, from), tstop);
        t[n++] = 0.5 * (from + to);
        from = to > from ? to : tstop;
    }
    return n;
}

int ns_bridge_source_instants(const ns_signal *z, int n, double tstop, double *t) {
    int count = 0;
    for (; count < SPREAD; count++)
        t[count] = spread(count, tstop);
    for (int i = 0; i < n; i++) {
        const int left = SOURCE_INSTANTS - count;
        const int share = (left + n - i - 1) / (n - i); /* of those left, rounded up */
        count += middles(&z[i], tstop, share, t + count);
    }
    return count;
}

double ns_bridge_source_size(const ns_signal *z) {
    double size = 0.0;
    switch (z->kind) {
    case NS_DC:
        return fabs(z->u.dc);
    case NS_PULSE:
        return fmax(fabs(z->u.pulse.v1), fabs(z->u.pulse.v2));
    case NS_SIN:
        return fabs(z->u.sin.vo) + fabs(z->u.sin.va);
    case NS_EXP:
        return fabs(z->u.exp.v1) + fabs(z->u.exp.v2);
    case NS_PWL:
        for (int i = 0; i < z->u.pwl.n; i++)
            size = fmax(size, fabs(z->u.pwl.v[i]));
        break;
    }
    return size;
}

int ns_bridge_source_agrees(const ns_signal *z, double t, double tstop, double got, double *wanted) {
    static const double rounding_of_times = 1e-14, rounding = 1e-9; /* ngspice's are 50 times smaller */
    double low = INFINITY, high = -INFINITY;
    for (int k = -1; k <= 1; k++) {
        const double near = fmax(t + k * rounding_of_times * tstop, 0.0);
        const double left = ns_signal_value(z, near, NS_LEFT), right = ns_signal_value(z, near, NS_RIGHT);
        low = fmin(low, fmin(left, right));
        high = fmax(high, fmax(left, right));
    }
    const double tolerance = rounding * fmax(ns_bridge_source_size(z), fmax(fabs(low), fabs(high)));
    *wanted = ns_signal_value(z, t, NS_LEFT);
    return got >= low - tolerance && got <= high + tolerance; /* not for NAN */
}
