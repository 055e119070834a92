/* tests/bench/cases_ladder.c - ladders of N switches: 10 V feeds N cells, each 100 ohm in series, 10 nF, and
 * 1 kohm behind a switch to ground.
 *
 * One triangle of 1 ms drives all: switch k closes while it is above (k + 1/2)/N, so that 2N flips spread
 * evenly over a period, two in a step of period/N.  A period is run.  Each flip is an event, which the next
 * one waits for: of 10,000 switches only a hundredth of a period, 200 flips, fits the time of the benchmark.
 * A step in its tables is one leg of an engine, from a flip to the next, with the flip. Reference: KCL of the
 * cells, commands at known instants. */
#include <math.h>
#include <stdlib.h>

#include "cases.h"

static const real volts = 10, series = 100, shunt = 1e3L, farad = 10e-9L;
static const double period = 1e-3, top = 1e-9; /* s; the triangle's flat part at 1 V */

typedef struct ladder {
    int n, closed; /* switches 0 ... closed-1 are */
    real t;        /* of the present mode */
} ladder;

static void constant(void *data, real t, real *u) {
    (void)data;
    (void)t;
    for (int k = 0; k < ORACLE_TERMS; k++)
        u[k] = k == 0 ? volts : 0;
}

static void rates(void *data, const real *x, const real *u, real *dx) {
    const ladder *l = data;
    for (int k = 0; k < l->n; k++) {
        const real left = ((k > 0 ? x[k - 1] : u[0]) - x[k]) / series;
        const real right = k + 1 < l->n ? (x[k] - x[k + 1]) / series : 0;
        dx[k] = (left - right - (k < l->closed ? x[k] / shunt : 0)) / farad;
    }
}

/* The instant of flip number j = 0 ... 2N-1 of a period: up through the thresholds, then down. */
static real flip(const ladder *l, int j) {
    const real ramp = ((real)period - (real)top) / 2;
    const int k = j < l->n ? j : 2 * l->n - 1 - j;
    const real level = ((real)k + 0.5L) / (real)l->n;
    return j < l->n ? ramp * level : ramp + (real)top + ramp * (1 - level);
}

static real corner(void *data, real t) {
    const ladder *l = data;
    const real begin = floorl(t / (real)period) * (real)period;
    int lo = -1, hi = 2 * l->n; /* the first flip after t is number hi */
    while (hi - lo > 1) {
        const int mid = (lo + hi) / 2;
        if (begin + flip(l, mid) > t * (1 + 1e-17L))
            hi = mid;
        else
            lo = mid;
    }
    return hi < 2 * l->n ? begin + flip(l, hi) : begin + (real)period + flip(l, 0);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): others write x */
static void enter(void *data, real t, int guard, real *x) {
    ladder *l = data;
    const real phase = t - floorl(t / (real)period) * (real)period;
    (void)guard;
    (void)x;
    l->closed += phase < (real)period / 2 ? 1 : -1;
}

static void exact(const bench_case *c, real fineness, real *values) {
    ladder l = {.n = c->size};
    const oracle o = {c->size, 1, 0, 0.5e-6L * fineness, &l, constant, rates, NULL, enter, corner};
    real *x = calloc((size_t)c->size, sizeof *x),
         *all = calloc((size_t)c->size * (size_t)c->times, sizeof *all);
    if (!x || !all)
        abort();
    oracle_run(&o, x, c->times, c->time, all);
    for (int k = 0; k < c->times; k++)
        for (int i = 0; i < c->unknowns; i++)
            values[k * c->unknowns + i] = all[k * c->size + c->unknown[i].of - 1];
    free(x);
    free(all);
}

void case_ladder(bench_case *c, int switches) {
    static const struct {
        int switches;
        const char *name;
    } names[] = {
        {16, "ladder16"}, {64, "ladder64"}, {320, "ladder320"}, {1000, "ladder1000"}, {0, "ladder10000"}};
    int at = 0;
    while (names[at].switches && names[at].switches != switches)
        at++;
    c->name = names[at].name;
    c->title = "ladder of switches, two flips a step";
    c->origin = "power series between known instants";
    c->exact = exact;
    c->unit = 20 * period / switches; /* steps of a twentieth see two flips */
    c->size = switches;
    c->large = switches > 64;
    c->slow = switches > 64;
    deck *d = c->net = deck_create();
    const int in = 2 * switches + 1, gate = in + 1;
    deck_v(d, in, 0, deck_dc((double)volts));
    deck_v(d, gate, 0, deck_pulse(1, 0, (period - top) / 2, top, period));
    for (int k = 1; k <= switches; k++) {
        deck_r(d, k == 1 ? in : k - 1, k, (double)series);
        deck_c(d, k, 0, (double)farad, 0);
        deck_r(d, k, switches + k, (double)shunt);
        deck_s(d, switches + k, 0, gate, 0, (k - 0.5) / switches);
    }
    case_voltage(c, 1);
    case_voltage(c, 4);
    case_voltage(c, 10);
    case_times(c, switches > 1000 ? period / 100 : period, 10);
}
