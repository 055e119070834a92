/* tests/rig/systems.c - small systems written by hand, for the tests of the engines. */
#include "systems.h"

#include <math.h>
#include <stdlib.h>

static ns_system *make(int n, int m, int nz, int nc) {
    ns_system *s;
    if (ns_system_create(n, m, nz, nc, &s) != NS_OK)
        abort();
    return s;
}

static void set(double *a, int rows, int i, int j, double v) {
    a[i + j * rows] = v;
}

ns_system *system_decay(void) {
    ns_system *s = make(1, 0, 0, 0);
    s->M[0] = 1;
    s->A[0] = -1;
    return s;
}

ns_system *system_lc_bridge(void) {
    const double C = 1e-6, L = 1e-2, R = 1e3;
    ns_system *s = make(2, 4, 0, 0);
    set(s->M, 2, 0, 0, C);
    set(s->M, 2, 1, 1, L);
    set(s->A, 2, 0, 1, -1);
    set(s->A, 2, 1, 0, 1);
    set(s->B, 2, 0, 2, -1);
    set(s->B, 2, 0, 3, 1);
    set(s->C, 4, 2, 0, -1);
    set(s->C, 4, 3, 0, 1);
    const double D[4][4] = {{1 / R, 1 / R, -1, 0}, {1 / R, 1 / R, 0, -1}, {1, 0, 0, 0}, {0, 1, 0, 0}};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            set(s->D, 4, i, j, D[i][j]);
    return s;
}

double lc_bridge_v(double v0, double t) {
    const double a = 500, w = sqrt(1e8 - a * a);
    return v0 * exp(-a * t) * (cos(w * t) - a / w * sin(w * t));
}

ns_system *system_half_wave(double amplitude, double freq, double load) {
    ns_system *s = make(3, 1, 1, 0);
    ns_signal sine = {.kind = NS_SIN};
    sine.u.sin.va = amplitude;
    sine.u.sin.freq = freq;
    if (ns_system_set_input(s, 0, &sine) != NS_OK)
        abort();
    set(s->A, 3, 0, 2, -1); /* KCL 1: i_V + i_D = 0 */
    set(s->B, 3, 0, 0, -1);
    set(s->A, 3, 1, 1, -1 / load); /* KCL 2: -v2/R + i_D = 0 */
    set(s->B, 3, 1, 0, 1);
    set(s->A, 3, 2, 0, -1); /* 0 = -v1 + z */
    set(s->E, 3, 2, 0, 1);
    set(s->C, 1, 0, 0, -1); /* y = v2 - v1 */
    set(s->C, 1, 0, 1, 1);
    return s;
}
