/* tests/bench/cases_multiplier.c - Cockcroft-Walton multipliers from rest: 100 V sine of 10 kHz, capacitors
 * of 1 uF, ideal diodes, no resistance but a load of 1 Mohm, 10 ms.
 *
 * Nodes along the chain of diodes: 0 (ground), 1, 2, ... 2N; diode j from node j to node j+1.  Capacitors
 * from the source to 1, from 1 to 3, 3 to 5, ... push the odd nodes; those from 0 to 2, 2 to 4, ... hold the
 * output, 2N.
 *
 * Reference: nodes joined by conducting diodes are intervals of the chain, so that KCL of the intervals has
 * two diagonals either side; a diode's current is what the part of its interval beyond it takes.  Which
 * diodes conduct after an event: of those that could (on the edge) all that are wrong change at once, current
 * against slope of voltage, until none is. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"

enum { MOST = 101, BAND = 2 };
static const real amplitude = 100, freq = 10e3L, farad = 1e-6L, load = 1e6L;
static const real slack = 1e-13L; /* V, A: some hundred roundings of the largest */

typedef struct multiplier {
    int nodes;          /* besides ground */
    char on[MOST];      /* diode j, j = 0 ... nodes-1 */
    int class_of[MOST]; /* of node 0 ... nodes; class 0 is ground */
    int classes;
    real band[MOST][BAND + 1]; /* L D L^T of the classes 1 ..., D on place 0 */
} multiplier;

static void source(void *data, real t, real *u) {
    (void)data;
    oracle_sine(0, amplitude, freq, 0, t, 1, u);
}

/* --- the matrix of a mode --- */

static void stamp(multiplier *m, int a, int b) {
    const int i = m->class_of[a] < m->class_of[b] ? m->class_of[a] : m->class_of[b];
    const int j = m->class_of[a] + m->class_of[b] - i;
    if (i == j)
        return;
    m->band[j][0] += farad;
    if (i > 0) {
        m->band[i][0] += farad;
        m->band[j][j - i] -= farad;
    }
}

static void factor(multiplier *m) {
    m->classes = 1;
    m->class_of[0] = 0;
    for (int k = 1; k <= m->nodes; k++)
        m->class_of[k] = m->on[k - 1] ? m->class_of[k - 1] : m->classes++;
    memset(m->band, 0, sizeof m->band);
    if (m->class_of[1] > 0)
        m->band[m->class_of[1]][0] += farad; /* to the source */
    for (int k = 2; k <= m->nodes; k++)
        stamp(m, k, k - 2);
    for (int j = 1; j < m->classes; j++) {
        for (int d = BAND; d > 0; d--) {
            const int i = j - d;
            if (i < 1)
                continue;
            for (int e = d + 1; e <= BAND && j - e > 0; e++)
                m->band[j][d] -= m->band[j][e] * m->band[i][e - d] * m->band[j - e][0];
            m->band[j][d] /= m->band[i][0];
        }
        for (int d = 1; d <= BAND && j - d > 0; d++)
            m->band[j][0] -= m->band[j][d] * m->band[j][d] * m->band[j - d][0];
    }
}

static void solve(const multiplier *m, real *b) {
    for (int j = 1; j < m->classes; j++)
        for (int d = 1; d <= BAND && j - d > 0; d++)
            b[j] -= m->band[j][d] * b[j - d];
    for (int j = 1; j < m->classes; j++)
        b[j] /= m->band[j][0];
    for (int j = m->classes - 1; j > 0; j--)
        for (int d = 1; d <= BAND && j - d > 0; d++)
            b[j - d] -= m->band[j][d] * b[j];
}

/* --- the flow: x are the nodes' voltages (of 1 ... nodes), u the source's; its slope is the input --- */

static void slopes(const multiplier *m, const real *x, real slope, real *dx) {
    real b[MOST] = {0};
    if (m->class_of[1] > 0)
        b[m->class_of[1]] += farad * slope;
    b[m->class_of[m->nodes]] -= x[m->nodes - 1] / load;
    solve(m, b);
    for (int k = 1; k <= m->nodes; k++)
        dx[k - 1] = m->class_of[k] > 0 ? b[m->class_of[k]] : 0;
}

static real at(const real *x, int node) {
    return node > 0 ? x[node - 1] : 0;
}

/* What leaves node k through capacitors and the load. */
static real leaves(const multiplier *m, const real *x, const real *dx, real slope, int k) {
    real sum = farad * (at(dx, k) - (k == 1 ? slope : at(dx, k - 2)));
    if (k + 2 <= m->nodes)
        sum += farad * (at(dx, k) - at(dx, k + 2));
    return sum + (k == m->nodes ? x[k - 1] / load : 0);
}

/* Of each diode: its current where it conducts, its reverse voltage where not. */
static void judge(const multiplier *m, const real *x, const real *dx, real slope, real *g) {
    real beyond = 0; /* what the nodes of the interval beyond the diode take */
    for (int j = m->nodes - 1; j >= 0; j--) {
        beyond = leaves(m, x, dx, slope, j + 1) + (j + 1 < m->nodes && m->on[j + 1] ? beyond : 0);
        g[j] = m->on[j] ? beyond : at(x, j + 1) - at(x, j);
    }
}

/* The series of the source's slope: (k+1) u_(k+1). */
static void slope_series(void *data, real t, real *u) {
    source(data, t, u);
    for (int k = 0; k + 1 < ORACLE_TERMS; k++)
        u[k] = (real)(k + 1) * u[k + 1];
    u[ORACLE_TERMS - 1] = 0;
}

static void rates(void *data, const real *x, const real *u, real *dx) {
    slopes(data, x, u[0], dx);
}

/* Neighbours may move together without a diode that conducts between them: rounding must not be an event
 * there.  The slack belongs to the constant term of the series, which alone has all of x; the others shift by
 * it too, by less than nothing. */
static void guards(void *data, const real *x, const real *dx, const real *u, real *g) {
    const multiplier *m = data;
    judge(m, x, dx, u[0], g);
    for (int j = 0; j < m->nodes; j++)
        g[j] += slack;
}

/* Marks the diodes on the edge that are in the wrong state, and counts them. */
static int wrong(multiplier *m, const char *edge, const real *x, real slope, char *is) {
    real dx[MOST], g[MOST] = {0};
    int count = 0;
    factor(m);
    slopes(m, x, slope, dx);
    judge(m, x, dx, slope, g);
    for (int j = 0; j < m->nodes; j++) {
        const real rise = at(dx, j) - at(dx, j + 1);
        is[j] = m->on[j] ? g[j] < -slack : edge[j] && rise * farad > slack;
        count += is[j];
    }
    return count;
}

/* All wrong ones at once while that leaves fewer, else the first of them alone until it does. */
static void choose(multiplier *m, real t, const real *x) {
    real u[ORACLE_TERMS];
    char edge[MOST] = {0}, is[MOST];
    int best = MOST, tries = 10, count;
    slope_series(m, t, u);
    for (int j = 0; j < m->nodes; j++)
        edge[j] = m->on[j] || fabsl(at(x, j) - at(x, j + 1)) < 2 * slack;
    for (int k = 0; k < 10000 && (count = wrong(m, edge, x, u[0], is)) > 0; k++) {
        if (count < best) {
            best = count;
            tries = 10;
        }
        for (int j = 0, left = tries-- > 0 ? count : 1; j < m->nodes && left > 0; j++)
            if (is[j]) {
                m->on[j] = !m->on[j];
                left--;
            }
    }
}

static void enter(void *data, real t, int guard, real *x) {
    multiplier *m = data;
    if (m->on[guard])
        m->on[guard] = 0; /* its current has just come to nothing: rounding must not keep it */
    else
        x[guard] = at(x, guard);
    choose(m, t, x);
}

static void exact(const bench_case *c, real fineness, real *values) {
    multiplier m = {.nodes = 2 * c->size};
    const oracle o = {m.nodes, 1,     m.nodes, fineness / freq / 16, &m, slope_series, rates,
                      guards,  enter, NULL};
    real x[MOST] = {0}, *all = calloc((size_t)m.nodes * (size_t)c->times, sizeof *all);
    if (!all)
        abort();
    choose(&m, 0, x);
    oracle_run(&o, x, c->times, c->time, all);
    for (int k = 0; k < c->times; k++)
        for (int i = 0; i < c->unknowns; i++)
            values[k * c->unknowns + i] = all[k * m.nodes + c->unknown[i].of - 1];
    free(all);
}

void case_multiplier(bench_case *c, int stages) {
    c->name = stages == 5 ? "multiplier5" : stages == 20 ? "multiplier20" : "multiplier50";
    c->title = "Cockcroft-Walton multiplier";
    c->origin = "power series of every mode, modes by pivoting";
    c->exact = exact;
    c->unit = 100e-6;
    c->size = stages;
    c->large = stages > 20;
    c->slow = stages > 20;
    deck *d = c->net = deck_create();
    const int last = 2 * stages, in = last + 1;
    deck_v(d, in, 0, deck_sine(0, (double)amplitude, (double)freq, 0));
    for (int k = 1; k <= last; k++) {
        deck_c(d, k == 1 ? in : k - 2, k, (double)farad, 0);
        deck_d(d, k - 1, k);
    }
    deck_r(d, last, 0, (double)load);
    case_voltage(c, 2);
    case_voltage(c, stages / 2 * 2);
    case_voltage(c, last);
    case_times(c, 10e-3, 10);
}
