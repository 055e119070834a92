/* tests/rig/networks.c - (P1) of random passive networks: whole ones (unknowns: node voltages, inductor and
 * transformer currents, then devices) and steps reduced to their devices, W = D + h C W^-1 B. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lapacke.h>

#include "generators.h"

typedef struct branch {
    int a, b; /* nodes; b = -1: ground */
} branch;

static branch draw_branch(sample *s, int nodes) {
    branch e = {.a = dice_below(&s->dice, nodes), .b = dice_below(&s->dice, nodes + 1) - 1};
    if (e.b == e.a)
        e.b = -1;
    return e;
}

static void stamp_conductance(double *K, int n, branch e, double g) {
    K[e.a + e.a * n] += g;
    if (e.b >= 0) {
        K[e.b + e.b * n] += g;
        K[e.a + e.b * n] -= g;
        K[e.b + e.a * n] -= g;
    }
}

/* Branch k of current lambda_k from a to b, ratio times: KCL of the nodes, its own voltage with a minus. */
static void stamp_current(double *K, int n, int k, branch e, double ratio) {
    K[e.a + k * n] += ratio;
    K[k + e.a * n] -= ratio;
    if (e.b >= 0) {
        K[e.b + k * n] -= ratio;
        K[k + e.b * n] += ratio;
    }
}

/* A conductance of a step: G, C/h or h/L. */
static double step_conductance(sample *s, double h) {
    int kind = dice_below(&s->dice, 3);
    if (s->exact)
        return 1 + dice_below(&s->dice, 8);
    return kind == 0   ? dice_decades(&s->dice, -6, 3)
           : kind == 1 ? dice_decades(&s->dice, -9, -3) / h
                       : h / dice_decades(&s->dice, -6, -2);
}

static double winding(sample *s) { /* ratio of a transformer */
    return s->exact ? 1 + dice_below(&s->dice, 4) : dice_decades(&s->dice, -1, 1);
}

static int device_law(sample *s) { /* diode; switch, closed or open: two in five */
    int k = dice_below(&s->dice, 10);
    return k < 6 ? LAW_PAIR : k < 8 ? LAW_EQUALITY : LAW_FIXED;
}

static void draw_devices(sample *s, int first) {
    double ties = dice_below(&s->dice, 3) ? 0.05 : 0.5;
    for (int i = 0; i < first; i++)
        sample_draw(s, i, LAW_EQUALITY, 0);
    for (int i = first; i < s->m; i++) {
        int law = device_law(s);
        sample_draw(s, i, law, ties);
        if (law == LAW_FIXED) /* an open switch: no current */
            s->l[i] = s->u[i] = s->lambda[i] = 0;
    }
}

void generate_whole(sample *s, int max) {
    int m = max < 3 ? 3 : max, nodes = 1 + dice_below(&s->dice, m - 1), coils, turns, n;
    double h = dice_decades(&s->dice, -9, -3);
    coils = dice_below(&s->dice, 1 + (m - nodes) / 3);
    turns = dice_below(&s->dice, 1 + (m - nodes - coils) / 3);
    n = nodes + coils + turns;
    sample_start(s, m);
    s->exact = dice_below(&s->dice, 3) == 0;
    s->kind = s->exact ? "network, short numbers" : "network";
    int branches = dice_below(&s->dice, 2 * nodes + 1); /* few: many nodes float or hang on devices only */
    for (int k = 0; k < branches; k++)
        stamp_conductance(s->W, m, draw_branch(s, nodes), step_conductance(s, h));
    branch last = draw_branch(s, nodes);
    for (int k = nodes; k < m; k++) {
        int again = k > n && dice_below(&s->dice, 5) == 0; /* in parallel with the one before */
        last = again ? last : draw_branch(s, nodes);
        stamp_current(s->W, m, k, last, 1);
        if (k >= nodes + coils && k < n)
            stamp_current(s->W, m, k, draw_branch(s, nodes), -winding(s));
        else if (k < nodes + coils)
            s->W[k + k * m] = 1 / step_conductance(s, h);
        else if (dice_below(&s->dice, 2))
            s->W[k + k * m] = s->exact ? 1 : dice_decades(&s->dice, -3, 0); /* Ron */
    }
    draw_devices(s, n);
    sample_finish(s, 0.25);
}

/* K = S + (0 T'; -T 0): n nodes of which the last few are loops (L/h + R, coupled to nodes without loss). */
static void draw_network(sample *s, double *K, int n, double h) {
    int loops = dice_below(&s->dice, n / 3 + 1), nodes = n - loops;
    memset(K, 0, (size_t)n * (size_t)n * sizeof *K);
    for (int i = 0; i < n; i++) /* every node has some capacitance, every loop some inductance */
        K[i + i * n] = i < nodes ? dice_decades(&s->dice, -9, -3) / h : dice_decades(&s->dice, -6, -2) / h;
    for (int k = 0; k < 2 * nodes; k++)
        stamp_conductance(K, n, draw_branch(s, nodes), step_conductance(s, h));
    for (int k = nodes; k < n; k++)
        stamp_current(K, n, k, draw_branch(s, nodes), 1);
}

/* Column j of E: device j across a branch, in series with a loop, or behind a transformer. */
static void draw_device(sample *s, double *E, int n, int j) {
    double *e = E + j * n;
    branch at = draw_branch(s, n);
    memset(e, 0, (size_t)n * sizeof *e);
    if (j > 0 && dice_below(&s->dice, 6) == 0) { /* parallel, or antiparallel */
        double sign = dice_below(&s->dice, 2) ? 1 : -1;
        for (int i = 0; i < n; i++)
            e[i] = sign * e[i - n];
        return;
    }
    e[at.a] = dice_below(&s->dice, 2) ? 1 : -1;
    if (at.b >= 0)
        e[at.b] = -e[at.a];
    if (dice_below(&s->dice, 8) == 0)
        e[dice_below(&s->dice, n)] += winding(s);
}

/* W = E' K^-1 E + D with D of the on-resistances: devices without one make it singular. */
void generate_reduced(sample *s, int m) {
    int n = dice_size(&s->dice, 1, s->cap), pivot[1024];
    double h = dice_decades(&s->dice, -9, -3), *K = s->work, *E = s->work2;
    n = n > 2 * m ? 2 * m : n > 1024 ? 1024 : n;
    sample_start(s, m);
    s->kind = "reduced network";
    draw_network(s, K, n, h);
    for (int j = 0; j < m; j++)
        draw_device(s, E, n, j);
    double *X = malloc((size_t)n * (size_t)m * sizeof *X);
    if (!X)
        abort();
    memcpy(X, E, (size_t)n * (size_t)m * sizeof *X);
    if (LAPACKE_dgesv(LAPACK_COL_MAJOR, n, m, K, n, pivot, X, n) != 0)
        abort(); /* S is positive definite */
    for (int j = 0; j < m; j++) {
        for (int i = 0; i < m; i++)
            for (int k = 0; k < n; k++)
                *sample_entry(s, i, j) += E[k + i * n] * X[k + j * n];
        if (dice_below(&s->dice, 3))
            *sample_entry(s, j, j) += dice_decades(&s->dice, -6, 0);
    }
    free(X);
    draw_devices(s, 0);
    sample_finish(s, 0.25);
}
