/* tests/rig/literature.c - the buck converter of the literature; one step reduced to its pairs. */
#include "literature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the reduced step --- */

/* X = (M - h A)^-1 X by Gauss' elimination with row exchanges; X is n*columns. */
static void solve_step(const ns_system *s, double h, int columns, double *X) {
    const int n = s->n;
    double *W = malloc(sizeof(double) * (size_t)(n * n));
    if (!W)
        abort();
    for (int i = 0; i < n * n; i++)
        W[i] = s->M[i] - h * s->A[i]; /* (T1) */
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(W[i + k * n]) > fabs(W[p + k * n]))
                p = i;
        if (W[p + k * n] == 0)
            abort();
        for (int j = 0; j < n + columns; j++) {
            double *column = j < n ? W + j * n : X + (j - n) * n, kept = column[k];
            column[k] = column[p];
            column[p] = kept;
        }
        for (int i = k + 1; i < n; i++) {
            const double factor = W[i + k * n] / W[k + k * n];
            for (int j = k; j < n + columns; j++) {
                double *column = j < n ? W + j * n : X + (j - n) * n;
                column[i] -= factor * column[k];
            }
        }
    }
    for (int j = 0; j < columns; j++)
        for (int i = n - 1; i >= 0; i--) {
            double *x = X + j * n;
            for (int k = i + 1; k < n; k++)
                x[i] -= W[i + k * n] * x[k];
            x[i] /= W[i + i * n];
        }
    free(W);
}

void lit_reduced_matrix(const ns_system *s, double h, double *W) {
    const int n = s->n, m = s->m;
    double *X = malloc(sizeof(double) * (size_t)(n * m));
    if (!X)
        abort();
    memcpy(X, s->B, sizeof(double) * (size_t)(n * m));
    solve_step(s, h, m, X);
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++) {
            double sum = 0;
            for (int k = 0; k < n; k++)
                sum += s->C[i + k * m] * X[k + j * n];
            W[i + j * m] = s->D[i + j * m] + h * sum; /* (P1) */
        }
    free(X);
}

/* out = (M - h A)^-1 (M x + h (b + E z + B lambda)); lambda NULL: none, which is x_free. */
static void step_state(const ns_system *s, double h, const double *x, const double *z, const double *lambda,
                       double *out) {
    const int n = s->n;
    for (int i = 0; i < n; i++) {
        double f = s->b[i], w = 0;
        for (int k = 0; k < s->nz; k++)
            f += s->E[i + k * n] * z[k];
        for (int k = 0; lambda && k < s->m; k++)
            f += s->B[i + k * n] * lambda[k];
        for (int k = 0; k < n; k++)
            w += s->M[i + k * n] * x[k];
        out[i] = w + h * f; /* (T6) */
    }
    solve_step(s, h, 1, out);
}

void lit_reduced_vector(const ns_system *s, double h, const double *x, const double *z, double *q) {
    double *x_free = malloc(sizeof(double) * (size_t)s->n);
    if (!x_free)
        abort();
    step_state(s, h, x, z, NULL, x_free);
    for (int i = 0; i < s->m; i++) {
        q[i] = s->e[i]; /* (T7) */
        for (int k = 0; k < s->n; k++)
            q[i] += s->C[i + k * s->m] * x_free[k];
        for (int k = 0; k < s->nz; k++)
            q[i] += s->F[i + k * s->m] * z[k];
    }
    free(x_free);
}

void lit_reduced_state(const ns_system *s, double h, const double *x, const double *z, const double *lambda,
                       double *next) {
    step_state(s, h, x, z, lambda, next);
}

/* --- the buck converter --- */

/* f(x) = sum of slope max(0, x - start), near max(0, x)^2. */
typedef struct hinge {
    double slope, start;
} hinge;
static const hinge two_hinges[] = {{0.41421356, 0}, {1.17157288, 0.5}};
static const hinge five_hinges[] = {
    {0.09, 0}, {0.2238, 0.1}, {0.4666, 0.2487}, {1.1605, 0.6182}, {2.8863, 1.5383}};

typedef struct buck_values {
    double L, Cout, Rload, R12, C11, R11, R21, C21, tau;
} buck_values;

static const double pi = 3.14159265358979323846;
static const double vin = 3, vf = 0.8, threshold = 2, half_k = 5, amplifier = 1e4, high = 3;

static buck_values values_of(lit_set set) {
    buck_values v = {10e-6, 22e-6, 10, 227.8e3, 20e-12, 15.58e3, 5.613e6, 1.9e-12, 0};
    v.tau = 1 / (2 * pi * 30e6);
    if (set != LIT_STANDARD) {
        v.L = 4e-6;
        v.Cout = 10e-6;
        v.R11 = 10e3;
        v.R21 = 8e6;
        v.C11 = 10e-12;
    }
    return v;
}

static void set(double *a, int rows, int i, int j, double v) {
    a[i + j * rows] = v;
}

/* Row i of A gets factor times (the linear form of `row`). */
static void add_row(ns_system *s, int i, double factor, const double *row) {
    for (int k = 0; k < s->n; k++)
        s->A[i + k * s->n] += factor * row[k];
}

/* L, Cout and the compensator around the amplifier, whose summing node m takes no current:
 *   v(m) (1/R12 + 1/R11 + 1/R21) = v_out/R12 + (v_out - v_C11)/R11 + (v_C21 + v_err)/R21 */
static void fill_states(ns_system *s, const buck_values *v) {
    const double g12 = 1 / v->R12, g11 = 1 / v->R11, g21 = 1 / v->R21, g = g12 + g11 + g21;
    const double vm[] = {0, (g12 + g11) / g, -g11 / g, g21 / g, g21 / g};
    const double i12[] = {0, g12 * (1 - vm[1]), -g12 * vm[2], -g12 * vm[3], -g12 * vm[4]};
    const double i11[] = {0, g11 * (1 - vm[1]), g11 * (-1 - vm[2]), -g11 * vm[3], -g11 * vm[4]};
    const double i21[] = {0, g21 * vm[1], g21 * vm[2], g21 * (vm[3] - 1), g21 * (vm[4] - 1)};
    const double M[] = {v->L, v->Cout, v->C11, v->C21, v->tau};
    for (int i = 0; i < LIT_BUCK_N; i++)
        set(s->M, s->n, i, i, M[i]);
    set(s->A, s->n, LIT_BUCK_IL, LIT_BUCK_VOUT, -1); /* L i' = v(D) - v_out;  v(D): see fill_diodes() */
    set(s->A, s->n, LIT_BUCK_VOUT, LIT_BUCK_IL, 1);
    set(s->A, s->n, LIT_BUCK_VOUT, LIT_BUCK_VOUT, -1 / v->Rload);
    add_row(s, LIT_BUCK_VOUT, -1, i12);
    add_row(s, LIT_BUCK_VOUT, -1, i11);
    add_row(s, LIT_BUCK_VC11, 1, i11);
    add_row(s, LIT_BUCK_VC21, 1, i21);
    add_row(s, LIT_BUCK_ERR, -amplifier, vm);
    s->A[LIT_BUCK_ERR * (s->n + 1)] -= 1;
    set(s->E, s->n, LIT_BUCK_ERR, 1, amplifier);
}

/* Two hinges: lambda_0 = max(0, 15 s + 1.5), lambda_1 = max(0, 15 s - 1.5).  Relay: y = -s. */
static int fill_comparator(ns_system *s, lit_comparator comparator) {
    const int pairs = comparator == LIT_RELAY ? 1 : 2;
    const double gain = comparator == LIT_RELAY ? 1 : 15;
    for (int i = 0; i < pairs; i++) {
        set(s->C, s->m, i, LIT_BUCK_ERR, gain);
        set(s->F, s->m, i, 0, -gain);
        s->e[i] = comparator == LIT_RELAY ? 0 : high * (i - 0.5);
        set(s->D, s->m, i, i, comparator == LIT_RELAY ? 0 : 1);
    }
    if (comparator == LIT_RELAY)
        s->u[0] = high;
    return pairs;
}

double lit_buck_gate(lit_comparator comparator, const double *lambda) {
    return comparator == LIT_RELAY ? lambda[0] : lambda[0] - lambda[1];
}

/* lambda_i = max(0, on_gate v(G) + on_drain v(D) + constant),  v(D) = lambda_last - vf. */
static void fill_hinge(ns_system *s, int i, lit_comparator comparator, double on_gate, double on_drain,
                       double constant) {
    const int last = s->m - 1;
    set(s->D, s->m, i, i, 1);
    set(s->D, s->m, i, 0, -on_gate);
    if (comparator != LIT_RELAY)
        set(s->D, s->m, i, 1, on_gate);
    set(s->D, s->m, i, last, -on_drain);
    s->e[i] = on_drain * vf - constant;
}

/* KCL at D:  i(DN) = i_L + i(MN) + i(DP) - i(MP);  the hinges of branch k enter with sign[k]. */
static void fill_diodes(ns_system *s) {
    const int dp = s->m - 2, dn = s->m - 1;
    set(s->D, s->m, dp, dn, -1); /* y = vin + vf - v(D) */
    s->e[dp] = vin + 2 * vf;
    set(s->D, s->m, dn, dp, 1);
    set(s->C, s->m, dn, LIT_BUCK_IL, 1);
    set(s->B, s->n, LIT_BUCK_IL, dn, 1); /* v(D) = lambda - vf */
    s->b[LIT_BUCK_IL] = -vf;
}

static ns_signal straight(const double *t, const double *v, double repeat) {
    ns_signal s = {.kind = NS_PWL};
    s.u.pwl.n = 2;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = repeat;
    return s;
}

static void fill_inputs(ns_system *s, lit_set set) {
    const double t[] = {0, 100e-6}, v[] = {0, 1.8}, slow_t[] = {0, LIT_BUCK_SLOW}, slow_v[] = {0, 2.25};
    const ns_signal reference = straight(t, v, NAN), sawtooth = straight(slow_t, slow_v, 0);
    ns_signal ramp = {.kind = NS_PULSE};
    ramp.u.pulse.v2 = 2.25;
    ramp.u.pulse.tr = 1.655e-6;
    ramp.u.pulse.tf = 10e-9;
    ramp.u.pulse.pw = 1e-9;
    ramp.u.pulse.per = 1.6667e-6;
    if (ns_system_set_input(s, 0, set == LIT_SLIDING_SLOW ? &sawtooth : &ramp) != NS_OK ||
        ns_system_set_input(s, 1, &reference) != NS_OK)
        abort();
}

ns_system *lit_buck(int hinges, lit_set set_of_values, lit_comparator comparator) {
    static const struct {
        double on_gate, on_drain, constant, sign;
    } branch[] = {{-1, 0, 3, -1}, {-1, 1, 0, 1}, {1, 0, 0, 1}, {1, -1, 0, -1}}; /* vSG, vDG, vGS, vGD */
    const hinge *f = hinges == 2 ? two_hinges : five_hinges;
    const buck_values v = values_of(set_of_values);
    const int pairs = (comparator == LIT_RELAY ? 1 : 2) + 4 * hinges + 2;
    ns_system *s;
    if ((hinges != 2 && hinges != 5) || ns_system_create(LIT_BUCK_N, pairs, 2, 0, &s) != NS_OK)
        abort();
    fill_states(s, &v);
    int i = fill_comparator(s, comparator);
    for (int k = 0; k < 4; k++)
        for (int j = 0; j < hinges; j++, i++) {
            fill_hinge(s, i, comparator, branch[k].on_gate, branch[k].on_drain,
                       branch[k].constant - threshold - f[j].start);
            set(s->D, s->m, s->m - 1, i, branch[k].sign * half_k * f[j].slope);
        }
    fill_diodes(s);
    fill_inputs(s, set_of_values);
    return s;
}
