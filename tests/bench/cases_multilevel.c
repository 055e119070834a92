/* tests/bench/cases_multilevel.c - one phase of a modular multilevel converter, N half-bridge cells an arm,
 * no control but phase-shifted carriers of 1 kHz.
 *
 * +-400 V, arms p -> x_u and x_l -> n of N cells, arm coils of 3 mH, load 10 ohm + 5 mH, cells of 2 mF at
 * 800/N V, references 0.5 -+ 0.4 sin(2 pi 50 t).  In a cell from terminal a down to terminal b, with its
 * capacitor from c to b: switch A (a-c) closes while reference - carrier > 5 mV, switch B (a-b) while it is
 * < -5 mV, each with a diode across it (a -> c, b -> a).  Between the two the diodes decide: a current into a
 * charges the capacitor, one out of it passes by, and none flows while what the arm sees lies between both.
 *
 * Reference: i_u, i_l, capacitor voltages.  With S the sum of an arm's inserted cells and v_o the voltage of
 * the coils' common node,
 *
 *     L i_u' = 400 - S_u - v_o,   L i_l' = v_o + 400 - S_l,   Lo (i_u - i_l)' = v_o - R (i_u - i_l),   C v' =
 * i */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"

enum { MOST = 80 };
static const real rail = 400, arm = 3e-3L, load_l = 5e-3L, load_r = 10, farad = 2e-3L, period = 1e-3L,
                  band = 5e-3L;
static const double edge = 0.000499995, top = 10e-9; /* of the carriers, s */

typedef enum state { BYPASSED, INSERTED, OPEN } state;

typedef struct leg {
    int n;            /* cells an arm */
    state cell[MOST]; /* upper arm, then lower arm, as commanded */
    int sign[2];      /* of each arm's current: what its open cells do; 0: none flows */
    real next[MOST];  /* when the command of a cell changes */
} leg;

static real delay_of(const leg *l, int cell) {
    const int lower = cell >= l->n, k = lower ? cell - l->n : cell;
    return period * ((real)k / (real)l->n - 1 + (lower ? 0.5L / (real)l->n : 0));
}

/* Reference less carrier. */
static real excess(const leg *l, int cell, real t) {
    const real pi = 3.14159265358979323846264338327950288L;
    const real reference = 0.5L + (cell < l->n ? -0.4L : 0.4L) * sinl(2 * pi * 50 * t);
    real phase = fmodl(t - delay_of(l, cell), period);
    const real up = (real)edge, flat = up + (real)top;
    return reference - (phase < up          ? phase / up
                        : phase < flat      ? 1
                        : phase < flat + up ? 1 - (phase - flat) / up
                                            : 0);
}

static state command(const leg *l, int cell, real t) {
    const real e = excess(l, cell, t);
    return e > band ? INSERTED : e < -band ? BYPASSED : OPEN;
}

/* The next change of a cell's command: it stands for at least half a microsecond. */
static real change(const leg *l, int cell, real t) {
    const state now = command(l, cell, t + 1e-9L);
    real lo = t + 1e-9L, hi = lo;
    while (command(l, cell, hi) == now && hi < t + period)
        hi = (lo = hi) + 0.5e-6L;
    for (int k = 0; k < 70; k++) {
        const real mid = (lo + hi) / 2;
        if (command(l, cell, mid) == now)
            lo = mid;
        else
            hi = mid;
    }
    return hi;
}

/* --- the flow: x = (i_u, i_l, v of the cells) --- */

/* What an arm's cells hold against the current; open ones as `sign` has it (0: by-passed). */
static real held(const leg *l, int side, int sign, const real *x) {
    real sum = 0;
    for (int k = side * l->n; k < (side + 1) * l->n; k++)
        if (l->cell[k] == INSERTED || (l->cell[k] == OPEN && sign > 0))
            sum += x[2 + k];
    return sum;
}

static void constant(void *data, real t, real *u) {
    (void)data;
    (void)t;
    for (int k = 0; k < ORACLE_TERMS; k++)
        u[k] = k == 0 ? rail : 0;
}

/* Slopes of both currents and the voltage of the common node, for these signs. */
static void currents(const leg *l, const int *sign, const real *x, real e, real *slope, real *vo) {
    const real su = held(l, 0, sign[0], x), sl = held(l, 1, sign[1], x), drop = load_r * (x[0] - x[1]);
    const real gu = sign[0] ? 1 / arm : 0, gl = sign[1] ? 1 / arm : 0, go = 1 / load_l;
    /* gu (e - su - vo) - gl (vo + e - sl) = go (vo - drop) */
    *vo = (gu * (e - su) - gl * (e - sl) + go * drop) / (gu + gl + go);
    slope[0] = gu * (e - su - *vo);
    slope[1] = gl * (*vo + e - sl);
}

static void rates(void *data, const real *x, const real *u, real *dx) {
    const leg *l = data;
    real vo;
    currents(l, l->sign, x, u[0], dx, &vo);
    for (int k = 0; k < 2 * l->n; k++) {
        const int side = k >= l->n;
        const int in = l->cell[k] == INSERTED || (l->cell[k] == OPEN && l->sign[side] > 0);
        dx[2 + k] = in ? x[side] / farad : 0;
    }
}

static int opens(const leg *l, int side) {
    int count = 0;
    for (int k = side * l->n; k < (side + 1) * l->n; k++)
        count += l->cell[k] == OPEN;
    return count;
}

/* Arms with open cells: the current keeps its sign; where none flows, what the arm sees lies between both. */
static void guards(void *data, const real *x, const real *dx, const real *u, real *g) {
    const leg *l = data;
    real slope[2], vo;
    (void)dx;
    currents(l, l->sign, x, u[0], slope, &vo);
    for (int side = 0; side < 2; side++) {
        const real sees = u[0] - (side ? -vo : vo);
        g[2 * side] = g[2 * side + 1] = 0;
        if (opens(l, side) == 0)
            continue;
        if (l->sign[side]) {
            g[2 * side] = (real)l->sign[side] * x[side];
        } else {
            g[2 * side] = held(l, side, 1, x) - sees;
            g[2 * side + 1] = sees - held(l, side, -1, x);
        }
    }
}

/* The sign of an arm whose current is zero: that in which it then grows. */
static void leave_zero(leg *l, int side, const real *x) {
    int sign[2] = {l->sign[0], l->sign[1]};
    for (int s = 1; s >= -1; s -= 2) {
        real slope[2], vo;
        sign[side] = s;
        currents(l, sign, x, rail, slope, &vo);
        l->sign[side] = s;
        if ((real)s * slope[side] > 0)
            return;
    }
    l->sign[side] = 0;
}

static void enter(void *data, real t, int guard, real *x) {
    leg *l = data;
    for (int k = 0; k < 2 * l->n; k++)
        if (l->next[k] <= t) {
            l->cell[k] = command(l, k, t + 1e-9L);
            l->next[k] = change(l, k, t);
        }
    for (int side = 0; side < 2; side++) {
        const int broke = guard >= 0 && guard / 2 == side;
        if (broke)
            x[side] = 0;
        if (x[side] == 0 && opens(l, side) > 0)
            leave_zero(l, side, x);
        else
            l->sign[side] = x[side] < 0 ? -1 : 1; /* of no matter without open cells */
    }
}

static real corner(void *data, real t) {
    const leg *l = data;
    real first = INFINITY;
    (void)t;
    for (int k = 0; k < 2 * l->n; k++)
        first = fminl(first, l->next[k]);
    return first;
}

static void exact(const bench_case *c, real fineness, real *values) {
    leg l = {.n = c->size};
    const int n = 2 + 2 * l.n;
    const oracle o = {n, 1, 4, 50e-6L * fineness, &l, constant, rates, guards, enter, corner};
    real x[2 + MOST] = {0}, *all = calloc((size_t)n * (size_t)c->times, sizeof *all);
    if (!all)
        abort();
    for (int k = 0; k < 2 * l.n; k++)
        x[2 + k] = 2 * rail / (real)l.n;
    enter(&l, 0, -1, x); /* next[] is 0: every command is read */
    oracle_run(&o, x, c->times, c->time, all);
    for (int k = 0; k < c->times; k++) {
        const real *at = all + k * n;
        values[3 * k] = at[0] - at[1];
        values[3 * k + 1] = at[0];
        values[3 * k + 2] = at[1];
    }
    free(all);
}

/* --- the circuit --- */

typedef struct wires {
    int next; /* the next free node */
    int reference[2];
} wires;

/* A cell from node a down to node b. */
static void put_cell(deck *d, wires *w, int side, real delay, int a, int b, double volts) {
    const int top_node = w->next++, gate = w->next++;
    deck_v(d, w->reference[side], gate,
           deck_pulse(1, (double)delay, edge, top, (double)period)); /* gate = reference - carrier */
    deck_s(d, top_node, a, gate, 0, (double)band);
    deck_s(d, a, b, 0, gate, (double)band);
    deck_d(d, a, top_node);
    deck_d(d, b, a);
    deck_c(d, top_node, b, (double)farad, volts);
}

static void put_arm(deck *d, wires *w, const leg *l, int side, int from, int to) {
    for (int k = 0; k < l->n; k++) {
        const int b = k + 1 < l->n ? w->next++ : to;
        put_cell(d, w, side, delay_of(l, side * l->n + k), from, b, 2 * (double)rail / l->n);
        from = b;
    }
}

void case_multilevel(bench_case *c, int cells, double end) {
    static const char *const names[] = {"multilevel4", "multilevel10", "multilevel20", "multilevel40"};
    const leg l = {.n = cells};
    c->name = names[cells == 4 ? 0 : cells == 10 ? 1 : cells == 20 ? 2 : 3];
    c->title = "multilevel converter leg";
    c->origin = "power series between commands, signs of the arm currents by halving";
    c->exact = exact;
    c->unit = (double)period / 8;
    c->size = cells;
    c->large = cells > 10;
    c->slow = cells > 10;
    deck *d = c->net = deck_create();
    enum { P = 1, N, XU, XL, OUT, Y, RU, RL, FREE };
    wires w = {FREE, {RU, RL}};
    deck_v(d, P, 0, deck_dc((double)rail));
    deck_v(d, 0, N, deck_dc((double)rail));
    deck_v(d, RU, 0, deck_sine(0.5, -0.4, 50, 0));
    deck_v(d, RL, 0, deck_sine(0.5, 0.4, 50, 0));
    put_arm(d, &w, &l, 0, P, XU);
    put_arm(d, &w, &l, 1, XL, N);
    const int upper = deck_l(d, XU, OUT, (double)arm, 0), lower = deck_l(d, OUT, XL, (double)arm, 0);
    deck_r(d, OUT, Y, (double)load_r);
    case_current(c, deck_l(d, Y, 0, (double)load_l, 0));
    case_current(c, upper);
    case_current(c, lower);
    case_times(c, end, 8);
}
