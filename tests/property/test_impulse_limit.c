/* tests/property/test_impulse_limit.c - the impulse problem is what a step with theta = gamma = 1 tends to as
 * h goes to 0.
 *
 * The limit is found by code that shares nothing with the library's: the step's equations of the system as it
 * stands, in long double, by Gaussian elimination in each of the 2^m modes; the one that obeys the laws is
 * taken at six lengths.  With p(h) = h x(h), a power series in h,
 *
 *     x(h) = X/h + x+ + ...,   X = p(0),  x+ = p'(0)
 *
 * by interpolation.  A second limit, from w+ = M x+, is what holds after the jump.  Networks: each node hangs
 * on a tree of R, L, C, two sources with a slope jump to their values at once, up to five diodes lie
 * anywhere.  So loops of capacitors and sources, and cuts of inductors, abound (index 2).
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "net.h"

enum { NODES = 6, RUNS = 1000, POINTS = 6, SIZE = 24 };

typedef long double real;

/* x, and lambda times h, of a step; by how much it misses the laws, relative. */
typedef struct step {
    real x[SIZE], L[SIZE], off;
} step;

static int eliminate(int n, real a[SIZE][SIZE + 1]) {
    for (int i = 0; i < n; i++) { /* rows to a largest entry of 1 */
        real most = 0;
        for (int j = 0; j < n; j++)
            most = fmaxl(most, fabsl(a[i][j]));
        for (int j = 0; j <= n && most > 0; j++)
            a[i][j] /= most;
    }
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++)
            p = fabsl(a[i][k]) > fabsl(a[p][k]) ? i : p;
        if (!(fabsl(a[p][k]) > 1e-15L)) /* a loop of diodes that conduct */
            return 0;
        for (int j = 0; j <= n; j++) {
            const real t = a[p][j];
            a[p][j] = a[k][j];
            a[k][j] = t;
        }
        for (int i = 0; i < n; i++) {
            const real f = i == k ? 0 : a[i][k] / a[k][k];
            for (int j = k; j <= n && f != 0; j++)
                a[i][j] -= f * a[k][j];
        }
    }
    return 1;
}

/* M x - h A x - B L = w + h (b + E z),   C x + e + F z = 0 or L = 0 for each pair (D is zero) */
static int solve(const ns_system *s, const real *w, const real *z, real h, unsigned mode, step *out) {
    static real a[SIZE][SIZE + 1];
    const int n = s->n, all = n + s->m;
    memset(a, 0, sizeof a);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            a[i][j] = s->M[i + j * n] - h * s->A[i + j * n];
        for (int j = 0; j < s->m; j++)
            a[i][n + j] = -s->B[i + j * n];
        a[i][all] = w[i] + h * s->b[i];
        for (int c = 0; c < s->nz; c++)
            a[i][all] += h * s->E[i + c * n] * z[c];
    }
    for (int j = 0; j < s->m; j++) {
        const int on = (int)(mode >> j & 1);
        a[n + j][n + j] = !on;
        a[n + j][all] = on ? -(real)s->e[j] : 0;
        for (int i = 0; i < n; i++)
            a[n + j][i] = on ? s->C[j + i * s->m] : 0;
        for (int c = 0; c < s->nz; c++)
            a[n + j][all] -= on ? s->F[j + c * s->m] * z[c] : 0;
    }
    if (!eliminate(all, a))
        return 0;
    for (int i = 0; i < n; i++)
        out->x[i] = a[i][all] / a[i][i];
    for (int j = 0; j < s->m; j++)
        out->L[j] = a[n + j][all] / a[n + j][n + j];
    return 1;
}

/* y of pair j: a sum of terms no larger than *size. */
static real y_of(const ns_system *s, int j, const real *x, const real *z, real *size) {
    real y = s->e[j];
    *size = fabsl(y);
    for (int i = 0; i < s->n; i++) {
        y += s->C[j + i * s->m] * x[i];
        *size = fmaxl(*size, fabsl(s->C[j + i * s->m] * x[i]));
    }
    for (int c = 0; c < s->nz; c++)
        y += s->F[j + c * s->m] * z[c];
    return y;
}

static void judge(const ns_system *s, const real *z, step *out) {
    real most = 1e-9L;
    out->off = 0;
    for (int j = 0; j < s->m; j++)
        most = fmaxl(most, fabsl(out->L[j]));
    for (int j = 0; j < s->m; j++) {
        real size, y = y_of(s, j, out->x, z, &size);
        out->off = fmaxl(out->off, -out->L[j] / most);
        out->off = fmaxl(out->off, -y / (size + 1e-3L)); /* V: networks are drawn with volts */
    }
}

/* The mode that misses the laws least; how far. */
static real search(const ns_system *s, const real *w, const real *z, real h, unsigned *mode) {
    real least = INFINITY;
    for (unsigned k = 0; k < 1u << s->m; k++) {
        step t;
        if (!solve(s, w, z, h, k, &t))
            continue;
        judge(s, z, &t);
        if (t.off < least) {
            least = t.off;
            *mode = k;
        }
    }
    return least;
}

/* From p at h, h/2, h/4, ...: p(0) and p'(0), by Neville's scheme with its derivative. */
static void at_zero(real h, const real *p, real *value, real *slope) {
    real v[POINTS], d[POINTS] = {0};
    for (int i = 0; i < POINTS; i++)
        v[i] = p[i];
    for (int k = 1; k < POINTS; k++)
        for (int i = 0; i + k < POINTS; i++) {
            const real a = h / (1 << i), b = h / (1 << (i + k)); /* 0 lies beyond both */
            d[i] = (v[i] - v[i + 1] + a * d[i + 1] - b * d[i]) / (a - b);
            v[i] = (a * v[i + 1] - b * v[i]) / (a - b);
        }
    *value = v[0];
    *slope = d[0];
}

/* X, Lambda and x, lambda: of both levels. */
typedef struct levels {
    real X[SIZE], L[SIZE], x[SIZE], l[SIZE];
} levels;

static void inputs(const ns_system *s, const real *z, const double *slope, real h, real *zh) {
    for (int c = 0; c < s->nz; c++)
        zh[c] = z[c] + h * slope[c];
}

/* Another mode obeys the laws with other x: diodes and sources in a loop share a current as they like. */
static int is_open(const ns_system *s, const real *w, const real *z, real h, unsigned mode) {
    step a, b;
    (void)solve(s, w, z, h, mode, &a);
    for (unsigned k = 0; k < 1u << s->m; k++) {
        if (!solve(s, w, z, h, k, &b))
            continue;
        judge(s, z, &b);
        for (int i = 0; i < s->n && b.off < 1e-12L; i++)
            if (fabsl(a.x[i] - b.x[i]) > 1e-6L * (1 + fabsl(a.x[i])))
                return 1;
    }
    return 0;
}

/* From w: 1 found, 0 the laws contradict each other, -1 modes change in between, or more than one answers. */
static int limit(const ns_system *s, const real *w, const real *z, const double *slope, levels *out) {
    const real h = ldexpl(1, -10), shortest = h / 256;
    real p[2 * SIZE][POINTS], zh[NET_MOST] = {0}, worst = 0;
    unsigned mode = 0;
    inputs(s, z, slope, shortest, zh);
    if (search(s, w, zh, shortest, &mode) > 1e-6L)
        return 0;
    if (is_open(s, w, zh, shortest, mode))
        return -1;
    for (int i = 0; i < POINTS; i++) {
        const real hi = h / (1 << i);
        step t;
        inputs(s, z, slope, hi, zh);
        if (!solve(s, w, zh, hi, mode, &t))
            return -1;
        judge(s, zh, &t);
        worst = fmaxl(worst, t.off);
        for (int j = 0; j < s->n; j++)
            p[j][i] = hi * t.x[j];
        for (int j = 0; j < s->m; j++)
            p[s->n + j][i] = t.L[j];
    }
    for (int j = 0; j < s->n; j++)
        at_zero(h, p[j], &out->X[j], &out->x[j]);
    for (int j = 0; j < s->m; j++)
        at_zero(h, p[s->n + j], &out->L[j], &out->l[j]);
    return worst > 1e-12L ? -1 : 1;
}

/* --- networks ------------------------------------------------------------------------------------------- */

static void passive(net *k, dice *d, int number, int p, int n) {
    char name[16];
    const int kind = dice_below(d, 5);
    const double size = ldexp(1, dice_below(d, 5) - 2); /* a quarter .. 4 */
    snprintf(name, sizeof name, "e%d", number);
    if (kind == 0)
        net_resistor(k, name, p, n, size);
    else if (kind < 3)
        net_capacitor(k, name, p, n, size, dice_integer(d, 5));
    else
        net_inductor(k, name, p, n, size, dice_integer(d, 5));
}

static int other(dice *d, int p, int nodes) {
    const int n = dice_below(d, nodes - 1);
    return n < p ? n : n + 1;
}

static void draw(net *k, dice *d) {
    int number = 0;
    for (int i = 1; i < NODES; i++)
        passive(k, d, number++, i, dice_below(d, i));
    for (int i = 0; i < 2; i++) {
        const int p = dice_below(d, NODES);
        passive(k, d, number++, p, other(d, p, NODES));
        net_voltage(k, i ? "v1" : "v0", NODES + i, 0, dice_integer(d, 5));
        passive(k, d, number++, NODES + i, dice_below(d, NODES));
    }
    for (int i = dice_below(d, 5); i >= 0; i--) {
        char name[16];
        snprintf(name, sizeof name, "d%d", i);
        const int p = dice_below(d, NODES + 2);
        net_diode(k, name, p, other(d, p, NODES + 2));
    }
}

/* --- both beside each other -------------------------------------------------------------------------------
 */

typedef struct tally {
    int same, none, open, charges, fluxes;
    double worst;
} tally;

static real largest(int n, const real *a, real least) {
    real most = least;
    for (int i = 0; i < n; i++)
        most = fmaxl(most, fabsl(a[i]));
    return most;
}

static void compare(tally *t, int n, const double *got, const real *expected) {
    const real most = largest(n, expected, 1); /* V, A, C, Wb: networks are drawn with some */
    for (int i = 0; i < n; i++)
        t->worst = fmax(t->worst, (double)(fabsl(got[i] - expected[i]) / most));
}

/* B lambda: how diodes in a loop share a current is open, but for the least norm. */
static void compare_flows(tally *t, const ns_system *s, const double *got, const real *expected) {
    double a[NET_MOST] = {0};
    real b[NET_MOST] = {0};
    for (int j = 0; j < s->m; j++)
        for (int i = 0; i < s->n; i++) {
            a[i] += s->B[i + j * s->n] * got[j];
            b[i] += s->B[i + j * s->n] * expected[j];
        }
    compare(t, s->n, a, b);
}

static void look(net *k, const double *slope, tally *t) {
    static levels jump, after;
    const ns_system *s = k->s;
    real w[NET_MOST] = {0}, z[NET_MOST] = {0};
    for (int i = 0; i < s->n; i++)
        w[i] = k->w0[i];
    for (int c = 0; c < s->nz; c++)
        z[c] = k->z[c];
    int found = limit(s, w, z, slope, &jump);
    for (int i = 0; i < s->n && found > 0; i++) {
        w[i] = 0;
        for (int j = 0; j < s->n; j++)
            w[i] += s->M[i + j * s->n] * jump.x[j];
    }
    if (found > 0)
        found = limit(s, w, z, slope, &after) > 0 ? 1 : -1;
    const int status = net_jump(k, slope);
    t->none += found == 0;
    t->open += found < 0;
    if (found == 0)
        assert_int_equal(status, NS_E_INFEASIBLE);
    if (found <= 0)
        return;
    assert_int_equal(status, NS_OK);
    compare(t, s->n, k->X, jump.X);
    compare_flows(t, s, k->Lambda, jump.L);
    compare(t, s->n, k->x, after.x);
    compare_flows(t, s, k->lambda, after.l);
    compare(t, s->n, k->w, w);
    t->same++;
    t->charges += largest(s->m, jump.L, 0) > 1e-6L;
    for (int node = 1; node < NODES; node++)
        if (fabs(net_voltage_of(k, k->X, node)) > 1e-6) {
            t->fluxes++;
            break;
        }
}

static void steps_tend_to_it(void **state) {
    (void)state;
    tally t = {0};
    for (int run = 0; run < RUNS; run++) {
        dice d = dice_make(77, (unsigned long long)run);
        net k = net_begin();
        draw(&k, &d);
        const double slope[2] = {dice_integer(&d, 3), dice_integer(&d, 3)};
        net_prepare(&k);
        look(&k, slope, &t);
        net_end(&k);
    }
    print_message(
        "%d networks: %d alike to %.1e (in %d charge goes through diodes, %d have impulses of voltages), %d "
        "without an answer, %d open\n",
        RUNS, t.same, t.worst, t.charges, t.fluxes, t.none, t.open);
    assert_true(t.same > RUNS / 2 && t.charges > RUNS / 5 && t.fluxes > RUNS / 5 && t.open <= RUNS / 50);
    assert_true(t.worst <
                1e-7); /* 2^-63 over h^2 = 2^-30, of unknowns that grow like 1/h; less where h^6 is */
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(steps_tend_to_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
