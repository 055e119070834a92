/* tests/unit/mlcp/test_random.c - the MLCP solver on thousands of problems made backwards from an answer.
 *
 * lambda and y are drawn so that they obey the law of each pair, and q = y - W lambda.  Where the answer is
 * unique (W a P-matrix) it must come back; elsewhere the natural residual decides, which shares nothing
 * with the solver.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/mlcp.h"

enum { MAX = 120, TIMES = 2000 };
typedef enum law { PAIR, EQUALITY, FIXED, BOX } law;

/* One problem and the answer it was made from. */
static struct {
    int m;
    double W[MAX * MAX], q[MAX], l[MAX], u[MAX], lambda[MAX], y[MAX];
} g;

static unsigned long long seed;

static double uniform(void) /* in [0,1); xorshift */
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (double)(seed >> 11) / 9007199254740992.0;
}

static double either(void) /* in [-1,1) */
{
    return 2.0 * uniform() - 1.0;
}

static int below(int n) {
    return (int)(uniform() * n);
}

static double decades(double lo, double hi) {
    return pow(10.0, lo + (hi - lo) * uniform());
}

static double *W(int i, int j) {
    return &g.W[i + j * g.m];
}

static void draw_box(int i) {
    int where = below(3);
    g.l[i] = -uniform();
    g.u[i] = uniform();
    if (below(4) == 0)
        g.l[i] = -INFINITY;
    else if (below(4) == 0)
        g.u[i] = INFINITY;
    double lo = fmax(g.l[i], -1), hi = fmin(g.u[i], 1);
    g.lambda[i] = lo + (hi - lo) * uniform();
    g.y[i] = 0;
    if (where == 1 && isfinite(g.l[i])) {
        g.lambda[i] = g.l[i];
        g.y[i] = uniform();
    } else if (where == 2 && isfinite(g.u[i])) {
        g.lambda[i] = g.u[i];
        g.y[i] = -uniform();
    }
}

/* Bounds, lambda and y of index i. */
static void draw(int i, law k) {
    double v = either();
    if (k == BOX) {
        draw_box(i);
        return;
    }
    if (k == PAIR && below(10) == 0) /* degenerate: both zero */
        v = 0;
    g.l[i] = k == PAIR ? 0 : k == FIXED ? v : -INFINITY;
    g.u[i] = k == FIXED ? v : INFINITY;
    g.lambda[i] = k == PAIR ? fmax(v, 0) : v;
    g.y[i] = k == PAIR ? fmax(-v, 0) : k == FIXED ? either() : 0;
}

static void set_q(void) {
    for (int i = 0; i < g.m; i++) {
        g.q[i] = g.y[i];
        for (int j = 0; j < g.m; j++)
            g.q[i] -= *W(i, j) * g.lambda[j];
    }
}

/* Strictly dominant diagonal: a P-matrix, not symmetric; the answer is unique. */
static void dominant(int m, int laws) {
    g.m = m;
    for (int i = 0; i < m; i++) {
        double sum = 0;
        for (int j = 0; j < m; j++) {
            *W(i, j) = either();
            sum += j == i ? 0 : fabs(*W(i, j));
        }
        *W(i, i) = sum + 0.1 + uniform();
        draw(i, (law)below(laws));
    }
    set_q();
}

/* V V' of given rank plus a skew part: monotone, singular where the rank is not full. */
static void monotone(int m, int rank, int laws) {
    double V[MAX * MAX];
    g.m = m;
    for (int k = 0; k < m * rank; k++)
        V[k] = either();
    for (int i = 0; i < m; i++)
        for (int j = 0; j <= i; j++) {
            double sum = 0, skew = i == j ? 0 : either();
            for (int k = 0; k < rank; k++)
                sum += V[i + k * m] * V[j + k * m];
            *W(i, j) = sum + skew;
            *W(j, i) = sum - skew;
        }
    for (int i = 0; i < m; i++)
        draw(i, (law)below(laws));
    set_q();
}

static void stamp_conductance(int a, int b, double v) {
    *W(a, a) += v;
    if (b >= 0) {
        *W(b, b) += v;
        *W(a, b) -= v;
        *W(b, a) -= v;
    }
}

/* Branch k from a to b: its current in KCL, its voltage in its own row, series resistance z. */
static void stamp_branch(int k, int a, int b, double z) {
    *W(a, k) += 1;
    *W(k, a) -= 1;
    if (b >= 0) {
        *W(b, k) -= 1;
        *W(k, b) += 1;
    }
    *W(k, k) = z;
}

/* One time step of a passive network, unreduced: nodes, inductors, diodes and closed or open switches, ideal
 * or with resistance.  Many nodes are held by diodes only, so the block of the equalities alone is singular.
 * lo, hi: decades of conductances; leak: of off conductances. */
static void network(double lo, double hi, double leak) {
    int nodes = 2 + below(8), coils = below(3), devices = 1 + below(8), n = nodes + coils;
    g.m = n + devices;
    memset(g.W, 0, sizeof g.W);
    for (int k = 0; k < 2 * nodes; k++) {
        int a = below(nodes), b = below(nodes + 1) - 1;
        if (a != b)
            stamp_conductance(a, b, decades(lo, hi));
    }
    for (int k = nodes; k < g.m; k++) {
        int a = below(nodes), b = below(nodes + 1) - 1;
        b = b == a ? -1 : b;
        if (k >= n && below(2))
            stamp_conductance(a, b, leak);
        stamp_branch(k, a, b, k < n ? 1 / decades(lo, hi) : below(2) ? 0 : 1e-3);
    }
    for (int i = 0; i < g.m; i++)
        draw(i, i < n ? EQUALITY : below(5) ? PAIR : below(2) ? EQUALITY : FIXED);
    for (int i = 0; i < g.m; i++) /* an open switch */
        if (g.l[i] == g.u[i])
            g.l[i] = g.u[i] = g.lambda[i] = 0;
    set_q();
}

/* A step so short that charge jumps: capacitors at every node, rows of nodes times h, currents up to 1e8 A.
 */
static void impulse(void) {
    int n = 2 + below(8);
    double h = decades(-15, -9);
    g.m = n + 1 + below(10);
    memset(g.W, 0, sizeof g.W);
    for (int k = 0; k < 2 * n; k++) {
        int a = k % n, b = k < n ? -1 : below(n);
        if (a != b)
            stamp_conductance(a, b, decades(-8, -4));
    }
    for (int k = n; k < g.m; k++) {
        int a = below(n), b = below(n + 1) - 1;
        stamp_branch(k, a, b == a ? -1 : b, below(2) ? 0 : 1e-3);
        for (int i = 0; i < n; i++)
            *W(i, k) *= h;
    }
    for (int i = 0; i < g.m; i++) {
        draw(i, i < n || below(10) == 0 ? EQUALITY : PAIR);
        g.lambda[i] *= i < n ? 10 : below(2) ? decades(-3, 0) : 1e-7 / h;
    }
    set_q();
}

/* The same problem with rows and columns in units that differ by up to 24 decades. */
static void spoil_units(void) {
    double r[MAX], c[MAX];
    for (int i = 0; i < g.m; i++) {
        r[i] = decades(-12, 12);
        c[i] = decades(-12, 12);
        g.lambda[i] /= c[i];
        g.l[i] /= c[i];
        g.u[i] /= c[i];
        if (g.l[i] == g.u[i])
            g.lambda[i] = g.l[i];
        g.y[i] *= r[i];
    }
    for (int i = 0; i < g.m; i++)
        for (int j = 0; j < g.m; j++)
            *W(i, j) *= r[i] * c[j];
    set_q();
}

static ns_mlcp_solver *solver;
static ns_mode mode[MAX];
static double lambda[MAX], y[MAX];
static long pivots, factors;

/* Solves g from mode[]; the answer must satisfy the problem and the signs of its mode. */
static void solve(void) {
    ns_mlcp p = {.m = g.m, .W = g.W, .q = g.q, .l = g.l, .u = g.u};
    ns_mlcp_info info;
    int status = ns_mlcp_solve(solver, &p, mode, lambda, y, &info);
    if (status != NS_OK)
        fail_msg("m = %d, seed after it %llu: %s", g.m, seed, ns_status_name(status));
    assert_true(ns_mlcp_residual(&p, lambda, NULL) < 1e-10);
    for (int i = 0; i < g.m; i++) {
        assert_true(lambda[i] >= g.l[i] && lambda[i] <= g.u[i]);
        if (g.l[i] == g.u[i])
            continue;
        if (mode[i] == NS_INSIDE)
            assert_true(y[i] == 0);
        else
            assert_true(lambda[i] == (mode[i] == NS_LOWER ? g.l[i] : g.u[i]) && y[i] * mode[i] <= 0);
    }
    pivots = info.pivots;
    factors = info.factors;
}

static void any_mode(void) {
    for (int i = 0; i < g.m; i++)
        mode[i] = (ns_mode)(below(3) - 1);
}

/* rel: rounding times the condition, in units of the largest answer, which is about 1. */
static void answer_is_the_known_one(double rel) {
    for (int i = 0; i < g.m; i++)
        assert_true(fabs(lambda[i] - g.lambda[i]) < rel);
}

static void unique_answers_come_back(void **state) {
    (void)state;
    for (int laws = 1; laws <= 4; laws++)
        for (int k = 0; k < TIMES; k++) {
            dominant(1 + below(20), laws);
            any_mode();
            solve();
            answer_is_the_known_one(1e-12); /* condition below 1e3 */
        }
}

static void monotone_problems(void **state) {
    (void)state;
    for (int laws = 1; laws <= 4; laws++)
        for (int k = 0; k < TIMES / 2; k++) {
            int m = 1 + below(20);
            monotone(m, below(m + 1), laws);
            any_mode();
            solve();
        }
}

static void passive_networks(void **state) {
    (void)state;
    for (int k = 0; k < TIMES; k++) {
        network(-3, 0, 1e-12);
        any_mode();
        solve();
    }
}

static void passive_networks_over_fifteen_decades(void **state) {
    (void)state;
    for (int k = 0; k < TIMES; k++) {
        network(-12, 3, 1e-12);
        any_mode();
        solve();
    }
}

static void jumps(void **state) {
    (void)state;
    for (int k = 0; k < TIMES; k++) {
        impulse();
        any_mode();
        solve();
    }
}

static void badly_scaled(void **state) {
    (void)state;
    for (int k = 0; k < TIMES; k++) {
        if (k % 2)
            dominant(1 + below(20), 4);
        else
            monotone(10, 6, 4);
        spoil_units();
        any_mode();
        solve();
    }
}

static void a_hundred_unknowns_are_no_different(void **state) {
    (void)state;
    for (int k = 0; k < 40; k++) {
        monotone(MAX, MAX / 2, 4);
        any_mode();
        solve();
        assert_true(pivots <= 25 || factors >= 3); /* the tableau is made anew now and then */
    }
}

/* From its own mode an answer costs nothing; from one with one pair wrong, little. */
static void warm_starts(void **state) {
    (void)state;
    long total = 0, most = 0;
    for (int k = 0; k < TIMES; k++) {
        dominant(1 + below(20), 2);
        any_mode();
        solve();
        solve();
        assert_int_equal(pivots, 0);
        int i = below(g.m);
        mode[i] = mode[i] == NS_INSIDE ? NS_LOWER : NS_INSIDE;
        solve();
        total += pivots;
        most = pivots > most ? pivots : most;
    }
    assert_true(total <= 2 * TIMES);
    assert_true(most <= 10); /* of at most 20 pairs */
}

/* Lemke's method in exact arithmetic does not care for the units of pairs; in ours it must not much. */
static void units_do_not_change_the_answer(void **state) {
    (void)state;
    for (int k = 0; k < TIMES; k++) {
        dominant(1 + below(20), 4);
        double plain[MAX];
        memcpy(plain, g.lambda, sizeof plain);
        spoil_units();
        any_mode();
        solve();
        for (int i = 0; i < g.m; i++) /* g.lambda / plain is the unit of column i; 1e-12 as above */
            assert_true(fabs(lambda[i] - g.lambda[i]) * fabs(plain[i]) <= 1e-12 * fabs(g.lambda[i]) ||
                        plain[i] == 0);
    }
}

static int setup(void **state) {
    (void)state;
    seed = 88172645463325252ull;
    return ns_mlcp_create(MAX, &solver);
}

static int teardown(void **state) {
    (void)state;
    ns_mlcp_free(solver);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(unique_answers_come_back, setup, teardown),
        cmocka_unit_test_setup_teardown(monotone_problems, setup, teardown),
        cmocka_unit_test_setup_teardown(passive_networks, setup, teardown),
        cmocka_unit_test_setup_teardown(passive_networks_over_fifteen_decades, setup, teardown),
        cmocka_unit_test_setup_teardown(jumps, setup, teardown),
        cmocka_unit_test_setup_teardown(badly_scaled, setup, teardown),
        cmocka_unit_test_setup_teardown(a_hundred_unknowns_are_no_different, setup, teardown),
        cmocka_unit_test_setup_teardown(warm_starts, setup, teardown),
        cmocka_unit_test_setup_teardown(units_do_not_change_the_answer, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
