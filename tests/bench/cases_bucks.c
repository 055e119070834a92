/* tests/bench/cases_bucks.c - open-loop buck converters from rest: 24 V, duty cycle 1/2, 100 kHz, 100 uH,
 * 22 uF, 5 ms.
 *
 *     synchronous, 5 ohm;   with a diode, 5 ohm (continuous current);
 *     with a diode, 200 ohm (K = 2L/(RT) = 0.1 < 1 - D: the current stops in every period)
 *
 * The gate crosses the threshold in the middle of its 10 ns edges: on from 5 ns to 5.005 us of each 10 us. */
#include <math.h>

#include "cases.h"

static const double vin = 24, period = 10e-6, L = 100e-6, C = 22e-6;

enum { ON, OFF, IDLE };

typedef struct buck {
    int mode, diode;
    real load;
} buck;

static void constant(void *data, real t, real *u) {
    (void)data;
    (void)t;
    for (int k = 0; k < ORACLE_TERMS; k++)
        u[k] = k == 0 ? (real)vin : 0;
}

/* x = (i, v):  L i' = source - v,  C v' = i - v/R */
static void rates(void *data, const real *x, const real *u, real *dx) {
    const buck *b = data;
    dx[0] = b->mode == IDLE ? 0 : ((b->mode == ON ? u[0] : 0) - x[1]) / (real)L;
    dx[1] = (x[0] - x[1] / b->load) / (real)C;
}

/* The diode's current while it conducts; v > 0 while it blocks. */
static void guards(void *data, const real *x, const real *dx, const real *u, real *g) {
    const buck *b = data;
    (void)dx;
    (void)u;
    g[0] = b->mode == IDLE ? x[1] : x[0];
    if (!b->diode || b->mode == ON)
        g[0] = 0;
}

static void enter(void *data, real t, int guard, real *x) {
    buck *b = data;
    if (guard >= 0) {
        b->mode = IDLE;
        x[0] = 0;
        return;
    }
    const real phase = fmodl(t - 5e-9L, (real)period) / (real)period;
    b->mode = phase < 0.25L || phase > 0.75L ? ON : b->diode && x[0] <= 0 ? IDLE : OFF;
}

/* 5 ns after every half period. */
static real corner(void *data, real t) {
    const real half = (real)period / 2;
    (void)data;
    return half * (floorl((t - 5e-9L) / half + 1e-6L) + 1) + 5e-9L;
}

static void exact(const bench_case *c, real fineness, real *values) {
    buck b = {c->extra ? IDLE : OFF, c->extra, c->size};
    const oracle o = {2, 1, 1, 2e-6L * fineness, &b, constant, rates, guards, enter, corner};
    real x[2] = {0, 0};
    oracle_run(&o, x, c->times, c->time, values);
}

void case_buck(bench_case *c, int diode, double load) {
    const int dcm = load > 100;
    c->name = !diode ? "buck_sync" : dcm ? "buck_dcm" : "buck_ccm";
    c->title = !diode ? "synchronous buck, 24 V, 100 kHz, from rest"
               : dcm  ? "buck with a diode, light load (DCM), from rest"
                      : "buck with a diode, full load (CCM), from rest";
    c->origin = "power series of the three modes, the diode's zero by halving";
    c->exact = exact;
    c->unit = period;
    c->extra = diode;
    c->size = (int)load;
    deck *d = c->net = deck_create();
    enum { IN = 1, X, OUT, GATE };
    deck_v(d, IN, 0, deck_dc(vin));
    deck_v(d, GATE, 0, deck_pulse(1, 0, 10e-9, period / 2 - 10e-9, period));
    deck_s(d, IN, X, GATE, 0, 0.5);
    if (diode)
        deck_d(d, 0, X);
    else
        deck_s(d, X, 0, 0, GATE, -0.5);
    const int coil = deck_l(d, X, OUT, L, 0);
    deck_c(d, OUT, 0, C, 0);
    deck_r(d, OUT, 0, load);
    case_current(c, coil);
    case_voltage(c, OUT);
    case_times(c, 5e-3, 10);
    for (int k = 0; k < 9; k++)
        c->time[k] += 4e-6; /* while current flows */
}
