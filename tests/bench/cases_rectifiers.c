/* tests/bench/cases_rectifiers.c - the LC bridge of the literature, and a six-pulse bridge behind 1 mH lines.
 *
 * The bridge of the first makes 1 kohm look like a plain resistor across the tank (1 uF at 10 V, 10 mH):
 *     v = 10 e^-at (cos wt - (a/w) sin wt),  a = 1/(2RC),  w^2 = 1/(LC) - a^2,   i = -C v' - v/R
 * The second: 325 V and 50 Hz a phase, 1 mH each, six diodes, 20 ohm and 50 mH, from rest, 100 ms. */
#include <math.h>

#include "cases.h"

static void lc_exact(const bench_case *c, real fineness, real *values) {
    const real C = 1e-6L, L = 10e-3L, R = 1e3L, V = 10, a = 1 / (2 * R * C), w = sqrtl(1 / (L * C) - a * a);
    (void)fineness;
    for (int k = 0; k < c->times; k++) {
        const real t = c->time[k], e = V * expl(-a * t), cosine = cosl(w * t), sine = sinl(w * t);
        const real v = e * (cosine - a / w * sine);
        const real slope = -a * v - e * (w * sine + a * cosine);
        values[2 * k] = fabsl(v); /* the rectified one */
        values[2 * k + 1] = -C * slope - v / R;
    }
}

void case_lc_bridge(bench_case *c) {
    c->name = "lc_bridge";
    c->title = "LC tank and diode bridge";
    c->origin = "closed form";
    c->exact = lc_exact;
    c->unit = 1e-3; /* some 3 half periods of 0.31 ms */
    deck *d = c->net = deck_create();
    enum { P = 1, N, TOP };
    deck_c(d, P, N, 1e-6, 10);
    const int coil = deck_l(d, P, N, 10e-3, 0);
    deck_d(d, P, TOP);
    deck_d(d, N, TOP);
    deck_d(d, 0, N);
    deck_d(d, 0, P);
    deck_r(d, TOP, 0, 1e3);
    case_voltage(c, TOP);
    case_current(c, coil);
    case_times(c, 5e-3, 10);
}

/* --- the six-pulse bridge: states are the line currents and that of the load --- */

static const double vm = 325, freq = 50, line = 1e-3, coil = 50e-3, load = 20;

typedef struct six_pulse {
    int upper[3], lower[3]; /* which diodes conduct */
} six_pulse;

static void phases(void *data, real t, real *u) {
    (void)data;
    for (int k = 0; k < 3; k++)
        oracle_sine(0, (real)vm, (real)freq, -120 * k, t, 3, u + k);
}

/* Potentials of the rails: at each rail the lines that feed it bring what the load takes,
 *     sum over its lines of (u_k - v)/line = i_load',   i_load' = (p - n - load i_load)/coil  (and minus that
 * below)
 */
static void rails(const six_pulse *s, const real *x, const real *u, real *p, real *n) {
    const real g = 1 / (real)line, h = 1 / (real)coil;
    real up = 0, down = 0, sum_up = 0, sum_down = 0;
    for (int k = 0; k < 3; k++) {
        up += s->upper[k] ? g : 0;
        down += s->lower[k] ? g : 0;
        sum_up += s->upper[k] ? g * u[k] : 0;
        sum_down += s->lower[k] ? g * u[k] : 0;
    }
    /* (up + h) p - h n = sum_up + h load i,   -h p + (down + h) n = sum_down - h load i */
    const real a = sum_up + h * (real)load * x[3], b = sum_down - h * (real)load * x[3];
    const real det = (up + h) * (down + h) - h * h;
    *p = ((down + h) * a + h * b) / det;
    *n = (h * a + (up + h) * b) / det;
}

static void six_rates(void *data, const real *x, const real *u, real *dx) {
    const six_pulse *s = data;
    real p, n;
    rails(s, x, u, &p, &n);
    for (int k = 0; k < 3; k++)
        dx[k] = s->upper[k] ? (u[k] - p) / (real)line : s->lower[k] ? (u[k] - n) / (real)line : 0;
    dx[3] = (p - n - (real)load * x[3]) / (real)coil;
}

/* Of each phase: the current while a diode conducts; p above and n below the phase while none does. */
static void six_guards(void *data, const real *x, const real *dx, const real *u, real *g) {
    const six_pulse *s = data;
    real p, n;
    (void)dx;
    rails(s, x, u, &p, &n);
    for (int k = 0; k < 3; k++) {
        const int free = !s->upper[k] && !s->lower[k];
        g[k] = s->upper[k] ? x[k] : free ? p - u[k] : 0;
        g[3 + k] = s->lower[k] ? -x[k] : free ? u[k] - n : 0;
    }
}

static void six_enter(void *data, real t, int guard, real *x) {
    six_pulse *s = data;
    const int k = guard % 3;
    int *which = guard < 3 ? &s->upper[k] : &s->lower[k];
    (void)t;
    if (*which)
        x[k] = 0;
    *which = !*which;
}

/* At t = 0 phase c (+281 V) and phase b (-281 V) conduct at once. */
static void six_exact(const bench_case *c, real fineness, real *values) {
    six_pulse s = {{0, 0, 1}, {0, 1, 0}};
    const oracle o = {4, 3, 6, 0.5e-3L * fineness, &s, phases, six_rates, six_guards, six_enter, NULL};
    real x[4] = {0}, all[4 * CASE_TIMES];
    oracle_run(&o, x, c->times, c->time, all);
    for (int k = 0; k < c->times; k++)
        for (int i = 0; i < 3; i++)
            values[3 * k + i] = all[4 * k + (i == 0 ? 3 : i - 1)];
}

void case_six_pulse(bench_case *c) {
    c->name = "six_pulse";
    c->title = "six-pulse bridge, 1 mH lines, inductive load";
    c->origin = "power series of every mode, commutations by halving";
    c->exact = six_exact;
    c->unit = 20e-3 / 6;
    deck *d = c->net = deck_create();
    enum { P = 7, N, M };
    int id[3];
    for (int k = 0; k < 3; k++) {
        deck_v(d, 1 + k, 0, deck_sine(0, vm, freq, -120 * k));
        id[k] = deck_l(d, 1 + k, 4 + k, line, 0);
        deck_d(d, 4 + k, P);
        deck_d(d, N, 4 + k);
    }
    deck_r(d, P, M, load);
    case_current(c, deck_l(d, M, N, coil, 0));
    case_current(c, id[0]);
    case_current(c, id[1]);
    case_times(c, 100e-3, 10);
    for (int k = 0; k < 9; k++)
        c->time[k] = 100e-3 - (9 - k) * 9.3e-3; /* not always in the same phase */
}
