/* tests/bench/cases_switching.c - events without end: sliding, and bouncing.
 *
 * Sliding chopper: a 20 V source, a switch that closes while ref > out, ref = 7.5 + 2 sin(2 pi 1k t), a
 * freewheel resistor of 2.5 ohm (with a diode, which would change each time, it is refused), 100 uH, 10 ohm,
 * no hysteresis.  Closed at first, out = 20 (1 - e^(-t R/L)), until it meets ref; from then on it slides, out
 * = ref, for that asks of the coil no more than it can: |L/R ref'| = 0.13 V lies well inside [-5/4 ref, 20 -
 * ref].
 *
 * Bouncing (the "twisting" of sliding mode control): with Sgn the set-valued sign, T = 1 ms,
 *
 *     T v1' = v2,   T v2' = -5 Sgn(v1) - 4 Sgn(v2),   v1 = 0, v2 = 3 at first.
 *
 * From v1 = 0, v2 = p > 0: v2 falls at a rate of 9 to 0 in p/9, at v1 = p^2/18; then, negative, at a rate of
 * 1, until v1 = p^2/18 - s^2/2 = 0 at s = p/3, v2 = -p/3.  So each half turn takes 4p/9 and leaves a third of
 * p; they accumulate at  (4p/9)/(1 - 1/3) = 2p/3 = 2 (ms),  and all rests from there on.
 *
 * A relay is a diode bridge across which a current source lies: it takes I Sgn(v), any current in [-I, I] at
 * v = 0.  One with 4 mA lies across C2 (v2), one with 5 mA across a copy of v1, and its current is drawn from
 * C2. */
#include <math.h>

#include "cases.h"

static const real pi = 3.14159265358979323846264338327950288L;

static real reference_of(real t) {
    return 7.5L + 2 * sinl(2 * pi * 1e3L * t);
}

static void chopper_exact(const bench_case *c, real fineness, real *values) {
    (void)fineness;
    real lo = 0, hi = 20e-6L; /* out = 17 V there */
    for (int k = 0; k < 80; k++) {
        const real mid = (lo + hi) / 2;
        if (20 * -expm1l(-mid * 1e5L) < reference_of(mid))
            lo = mid;
        else
            hi = mid;
    }
    for (int k = 0; k < c->times; k++) {
        const real t = c->time[k];
        values[k] = t < lo ? 20 * -expm1l(-t * 1e5L) : reference_of(t);
    }
}

void case_chopper(bench_case *c) {
    c->name = "chopper";
    c->title = "sliding chopper without hysteresis";
    c->origin = "closed form: sliding, v(out) = v(ref)";
    c->exact = chopper_exact;
    c->unit = 10e-6; /* L/R */
    c->feeds_back = 1;
    deck *d = c->net = deck_create();
    enum { X = 1, OUT, REF, IN };
    deck_v(d, IN, 0, deck_dc(20));
    deck_v(d, REF, 0, deck_sine(7.5, 2, 1e3, 0));
    deck_s(d, IN, X, REF, OUT, 0);
    deck_r(d, X, 0, 2.5);
    deck_l(d, X, OUT, 100e-6, 0);
    deck_r(d, OUT, 0, 10);
    case_voltage(c, OUT);
    case_times(c, 2e-3, 8);
}

/* v1, v2 at t, in units of T. */
static void bounce(real t, real *v1, real *v2) {
    real p = 3, sign = 1;
    *v1 = *v2 = 0;
    if (t >= 2)
        return;
    while (t > 4 * p / 9) {
        t -= 4 * p / 9;
        p /= 3;
        sign = -sign;
    }
    const real s = t - p / 9;
    *v2 = sign * (s < 0 ? -9 * s : -s);
    *v1 = sign * (p * p / 18 - (s < 0 ? 4.5L : 0.5L) * s * s);
}

static void bouncing_exact(const bench_case *c, real fineness, real *values) {
    (void)fineness;
    for (int k = 0; k < c->times; k++)
        bounce((real)c->time[k] * 1e3L, values + 2 * k, values + 2 * k + 1);
}

/* A bridge from node a to ground that takes i Sgn(v(a)). */
static void relay(deck *d, int a, int p, int n, double i) {
    deck_d(d, a, p);
    deck_d(d, 0, p);
    deck_d(d, n, a);
    deck_d(d, n, 0);
    deck_i(d, p, n, deck_dc(i));
}

void case_bouncing(bench_case *c) {
    static const double times[] = {0.5e-3, 1e-3, 1.5e-3, 1.9e-3, 1.99e-3, 1.999e-3, 2.5e-3, 3e-3};
    c->name = "bouncing";
    c->title = "two relays: events accumulate at 2 ms";
    c->origin = "closed form";
    c->exact = bouncing_exact;
    c->unit = 1e-3;
    c->accumulates = 2e-3;
    deck *d = c->net = deck_create();
    enum { V1 = 1, V2, COPY, P1, N1, P2, N2 };
    deck_c(d, V1, 0, 1e-6, 0);
    deck_c(d, V2, 0, 1e-6, 3);
    deck_g(d, 0, V1, V2, 0, 1e-3);
    const int copy = deck_e(d, COPY, 0, V1, 0, 1);
    relay(d, COPY, P1, N1, 5e-3);
    relay(d, V2, P2, N2, 4e-3);
    deck_f(d, 0, V2, copy, 1); /* what E brings flows against its own current */
    case_voltage(c, V1);
    case_voltage(c, V2);
    c->end = 3e-3;
    c->times = 8;
    for (int k = 0; k < c->times; k++)
        c->time[k] = times[k];
}
