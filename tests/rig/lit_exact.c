/* tests/rig/lit_exact.c - the exact waveforms of the diode circuits of the literature. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "flow.h"
#include "lit_rectifiers.h"

static const double pi = 3.14159265358979323846;
static const double C = 1e-6, L = 10e-3, R = 1e3, Cf = 0.3e-6;

/* v and i of C, L and R in parallel from (v0, i0), t later:
 * v = e^-at (v0 cos wt + k sin wt),  i = -C v' - v/R */
static void ring(double damping, double v0, double i0, double t, double *v, double *i) {
    const double a = damping / (2 * R * C), w = sqrt(1 / (L * C) - a * a);
    const double k = (-i0 / C - a * v0) / w, c = cos(w * t), s = sin(w * t), e = exp(-a * t);
    *v = e * (v0 * c + k * s);
    const double slope = -a * *v + w * e * (k * c - v0 * s);
    *i = -C * slope - 2 * a * C * *v;
}

/* While v > 0 the diode conducts and R damps; while v < 0 C and L ring alone.  v = 0 first where
 * tan wt = w/a, then every half period of the one and the other. */
static void rlcd_at(double t, double *v, double *i) {
    const double a = 1 / (2 * R * C), w = sqrt(1 / (L * C) - a * a), free = pi * sqrt(L * C);
    double length = atan2(w, a) / w, damping = 1;
    *v = 10;
    *i = 0;
    while (t > length) {
        ring(damping, *v, *i, length, v, i);
        *v = 0;
        t -= length;
        damping = 1 - damping;
        length = damping > 0 ? pi / w : free;
    }
    ring(damping, *v, *i, t, v, i);
}

/* By phase from the last crest of the source: conducting, v = 10 cos - 2 vf, until C v' + v/R = 0; then
 * decaying until the source comes up again.  The same from crest to crest, from the start on. */
static double supply_at(double t) {
    const double w = 1e4, drop = 0.42, tau = w * R * Cf;
    double lo = 0, hi = pi / 2;
    for (int k = 0; k < 60; k++) {
        const double mid = (lo + hi) / 2;
        if (-10 * w * Cf * sin(mid) + (10 * cos(mid) - drop) / R > 0)
            lo = mid;
        else
            hi = mid;
    }
    const double leaves = lo, phase = fmod(w * t, pi);
    if (phase < leaves)
        return 10 * cos(phase) - drop;
    const double decayed = (10 * cos(leaves) - drop) * exp(-(phase - leaves) / tau);
    return fmax(decayed, -10 * cos(phase) - drop);
}

/* --- by matrix exponentials --- */

static const double little = 1e-12; /* a mode is entered when it is due by more than this: no toggling */

static double filter_current(const double *x) { /* out of p, while C and Cf are in parallel */
    return Cf * (-x[1] - x[0] / R) / (C + Cf) + x[0] / R;
}

enum { UP, DOWN, BLOCKED, OVERLAP }; /* v > 0 conducts, v < 0 conducts, nothing does, all diodes do */

static int filter_next(int mode, const double *x) {
    if (mode == BLOCKED)
        return x[0] > x[2] + little ? UP : -x[0] > x[2] + little ? DOWN : BLOCKED;
    return (mode == UP ? filter_current(x) : -filter_current(x)) < -little ? BLOCKED : mode;
}

static void filter_land(int mode, double *x) {
    if (mode != BLOCKED)
        x[2] = fabs(x[0]);
}

static void set_filter(flow *f) {
    const double both = C + Cf;
    const double up[] = {-1 / (R * both), -1 / both, 0, 1 / L, 0, 0, -1 / (R * both), -1 / both, 0};
    const double down[] = {-1 / (R * both), -1 / both, 0, 1 / L, 0, 0, 1 / (R * both), 1 / both, 0};
    const double blocked[] = {0, -1 / C, 0, 1 / L, 0, 0, 0, 0, -1 / (R * Cf)};
    f->n = 3;
    f->modes = 3;
    memcpy(f->A[UP], up, sizeof up);
    memcpy(f->A[DOWN], down, sizeof down);
    memcpy(f->A[BLOCKED], blocked, sizeof blocked);
    f->next = filter_next;
    f->land = filter_land;
}

/* x = (i1, v, i2, v_load, source) */
static int resonant_next(int mode, const double *x) {
    const int side = x[0] > x[2] ? UP : DOWN; /* where v goes once i1 is more than the load takes */
    switch (mode) {
    case UP:
        return x[2] < -little ? BLOCKED : x[1] >= -little ? UP : fabs(x[0]) <= x[2] ? OVERLAP : side;
    case DOWN:
        return x[2] < -little ? BLOCKED : x[1] <= little ? DOWN : fabs(x[0]) <= x[2] ? OVERLAP : side;
    case OVERLAP:
        return fabs(x[0]) <= x[2] + little ? OVERLAP : side;
    default:
        return fabs(x[1]) <= x[3] + little ? BLOCKED : x[1] > 0 ? UP : DOWN;
    }
}

static void resonant_land(int mode, double *x) {
    if (mode == BLOCKED)
        x[2] = 0;
    if (mode == OVERLAP)
        x[1] = 0;
}

static void set_resonant(flow *f) {
    const double L1 = 150e-6, C1 = 68e-9, L2 = 0.4e-3, C2 = 2.2e-6, load = 33;
    f->n = 5;
    f->modes = 4;
    for (int mode = 0; mode < 4; mode++) {
        const double side = mode == UP ? 1 : mode == DOWN ? -1 : 0;
        double(*A)[5] = (double(*)[5])f->A[mode];
        A[0][4] = 1 / L1; /* i1' = (source - v)/L1 */
        A[0][1] = -1 / L1;
        if (mode != OVERLAP) { /* v' = (i1 - side i2)/C1 */
            A[1][0] = 1 / C1;
            A[1][2] = -side / C1;
        }
        if (mode != BLOCKED) { /* i2' = (side v - v_load)/L2 */
            A[2][1] = side / L2;
            A[2][3] = -1 / L2;
        }
        A[3][2] = 1 / C2;
        A[3][3] = -1 / (load * C2);
    }
    f->next = resonant_next;
    f->land = resonant_land;
}

static void flow_samples(lit_rectifier which, double *out) {
    const lit_run *run = lit_run_of(which);
    flow *f = calloc(1, sizeof *f);
    if (!f)
        abort();
    double x[FLOW_N] = {0};
    int mode = which == LIT_FILTER ? UP : BLOCKED;
    const int halves = which == LIT_FILTER ? 1 : 11, steps = 50;
    if (which == LIT_FILTER) {
        set_filter(f);
        x[0] = x[2] = 10 * C / (C + Cf); /* the charge of C, on both */
    } else
        set_resonant(f);
    f->dt = run->every / (halves * steps);
    flow_prepare(f);
    for (int k = 0; k < run->samples * halves; k++) {
        if (which == LIT_RESONANT)
            x[4] = k % 2 ? -1 : 1;
        flow_run(f, steps, &mode, x);
        if ((k + 1) % halves == 0)
            memcpy(out + (k / halves) * LIT_OUT, x, sizeof(double) * (size_t)run->out);
    }
    free(f);
}

void lit_exact(lit_rectifier which, double *out) {
    const lit_run *run = lit_run_of(which);
    if (which == LIT_FILTER || which == LIT_RESONANT) {
        flow_samples(which, out);
        return;
    }
    for (int k = 0; k < run->samples; k++) {
        const double t = run->every * (k + 1);
        double *at = out + (size_t)k * LIT_OUT;
        if (which == LIT_RLCD)
            rlcd_at(t, at, at + 1);
        else if (which == LIT_BRIDGE)
            ring(1, 10, 0, t, at, at + 1); /* the bridge makes R look like a plain resistor */
        else
            at[0] = supply_at(t);
    }
}
