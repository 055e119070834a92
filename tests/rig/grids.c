/* tests/rig/grids.c - (P1) of passive networks with a plan: nodes v, diode currents i, K v + E i = b,
 *
 *     whole     lambda = (v, i),  y = (K v + E i - b, -E' v + Ron i)
 *     reduced   lambda = i,       y = (E' K^-1 E + Ron) i - E' K^-1 b
 */
#include "grids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lapacke.h>

typedef struct grid {
    int n, width; /* nodes; in a row of the mesh */
    double *K;    /* n*n */
    double *b;    /* n */
    int *a, *c;   /* diodes: anode, cathode; -1: ground */
    double leak;  /* conductance of an open diode */
} grid;

const char *grid_name(int kind) {
    static const char *const names[] = {"ladder", "mesh", "mesh, ron", "nodes", "nodes, switches"};
    return kind >= 0 && kind < GRID_KINDS ? names[kind] : "?";
}

static void stamp(const grid *g, int a, int c, double conductance) {
    const size_t n = (size_t)g->n, i = (size_t)a, j = (size_t)c;
    g->K[i + i * n] += conductance;
    if (c < 0)
        return;
    g->K[j + j * n] += conductance;
    g->K[i + j * n] -= conductance;
    g->K[j + i * n] -= conductance;
}

/* A neighbour of a node: the next, or the one below; ground at the rim. */
static int neighbour(const grid *g, int a, int down) {
    const int c = down ? a + g->width : a + 1;
    return c < g->n && (down || c % g->width != 0) ? c : -1;
}

/* A capacitor to ground at each node, C/h of least .. 1; resistances of 1 Ohm .. 1 kOhm. */
static void draw_passive(sample *s, const grid *g, double least, double resistors) {
    memset(g->K, 0, (size_t)g->n * (size_t)g->n * sizeof *g->K);
    for (int a = 0; a < g->n; a++) {
        stamp(g, a, -1, dice_decades(&s->dice, log10(least), 0));
        for (int down = 0; down < (g->width < g->n ? 2 : 1); down++)
            if (dice_chance(&s->dice, resistors))
                stamp(g, a, neighbour(g, a, down), dice_decades(&s->dice, -3, 0));
        g->b[a] = dice_either(&s->dice);
    }
}

static void draw_diodes(sample *s, const grid *g, int n) {
    for (int k = 0; k < n; k++) {
        const int one = g->width == g->n ? k : dice_below(&s->dice, g->n);
        const int other = neighbour(g, one, g->width < g->n && dice_below(&s->dice, 2));
        const int turn = other >= 0 && dice_below(&s->dice, 2);
        g->a[k] = turn ? other : one;
        g->c[k] = turn ? one : other;
        stamp(g, one, other, g->leak);
    }
}

static double across(const grid *g, const double *v, int k) {
    return v[g->a[k]] - (g->c[k] < 0 ? 0.0 : v[g->c[k]]);
}

/* Column k of E. */
static void incidence(const grid *g, int k, double *e) {
    memset(e, 0, (size_t)g->n * sizeof *e);
    e[g->a[k]] = 1;
    if (g->c[k] >= 0)
        e[g->c[k]] = -1;
}

static void reduce(sample *s, const grid *g, double ron) {
    const int n = g->n, m = s->m;
    double *X = s->work2; /* n*m <= cap*cap */
    for (int k = 0; k < m; k++)
        incidence(g, k, X + (size_t)k * (size_t)n);
    if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'L', n, m, g->K, n, X, n) != 0)
        abort(); /* every node has a capacitor */
    LAPACKE_dpotrs(LAPACK_COL_MAJOR, 'L', n, 1, g->K, n, g->b, n);
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < m; j++)
            *sample_entry(s, i, j) = across(g, X + (size_t)j * (size_t)n, i);
        *sample_entry(s, i, i) += ron;
        s->q[i] = -across(g, g->b, i);
    }
}

static void whole(sample *s, const grid *g, double ron) {
    for (int j = 0; j < g->n; j++) {
        memcpy(sample_entry(s, 0, j), g->K + (size_t)j * (size_t)g->n, (size_t)g->n * sizeof *g->K);
        s->q[j] = -g->b[j];
    }
    for (int k = g->n; k < s->m; k++) {
        incidence(g, k - g->n, sample_entry(s, 0, k));
        for (int i = 0; i < g->n; i++)
            *sample_entry(s, k, i) = -*sample_entry(s, i, k);
        *sample_entry(s, k, k) = ron;
        s->q[k] = 0;
    }
}

void grid_make(sample *s, int kind, int m, unsigned long long number) {
    const int is_whole = kind == GRID_NODES || kind == GRID_SWITCHES, ladder = kind == GRID_LADDER;
    const double ron = kind == GRID_RON ? 1e-3 : 0;
    grid g = {.n = ladder ? m : (m + 1) / 2, .leak = kind == GRID_RON ? 1e-9 : 0};
    int *ends = calloc(2 * (size_t)m + 1, sizeof *ends);
    if (!ends)
        abort();
    s->dice = dice_make(97, number);
    sample_start(s, m);
    g.width = ladder ? g.n : (int)ceil(sqrt(g.n));
    g.K = s->work;
    g.b = s->y;
    g.a = ends;
    g.c = ends + m;
    draw_passive(s, &g, is_whole ? 1e-9 : 1e-3, is_whole ? 0.3 : 0.9);
    draw_diodes(s, &g, is_whole ? m - g.n : m);
    for (int i = 0; i < m; i++) {
        const int closed = is_whole && (i < g.n || (kind == GRID_SWITCHES && dice_below(&s->dice, 5) == 0));
        s->l[i] = closed ? -INFINITY : 0;
        s->u[i] = INFINITY;
    }
    if (is_whole)
        whole(s, &g, ron);
    else
        reduce(s, &g, ron);
    s->kind = grid_name(kind);
    free(ends);
}
