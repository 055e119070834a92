/* src/reinit/order_solve.c - the orders of (P2) as h -> 0, with a bound on the rounding of each unknown.
 *
 * With the right null vectors N and the left ones L of K0:  Z1 = N a,  Z0 = Zp + N c,  G = L'K1 N,
 *
 *     G a = L'R0,   K0 Zp = R0 - K1 Z1,   G c = L'(R1 - K1 Zp)
 *
 * is linear in (R0, R1):  Z1 = Q R0,  Z0 = H R0 + Q R1, where Q/h + H + ... is the inverse of K0 + h K1.  So
 * residuals, summed in long double, give corrections, and the sizes t of what rows are summed from give
 * bounds: |Q| t and |H| t, times a few eps.  These follow any choice of units.
 */
#include "linalg/simd.h"
#include "order_expansion.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Of the terms of a row: what its data (16 roundings) may be off by; what contradicts the mode. */
static const double data_eps = 16 * DBL_EPSILON, contradiction = 1e-10;
/* What sums may cancel to. */
static const double coefficient_eps = 4 * DBL_EPSILON;

/* G. */
static int form_gap(ns_order_expansion *k) {
    const ns_ranked *f = k->zero;
    const int size = k->size, gap = size - f->rank;
    for (int j = 0; j < gap; j++) {
        memset(k->v, 0, sizeof(double) * (size_t)size);
        ns_linalg_ranked_add_right(f, j, 1, k->v);
        ns_linalg_matvec(size, size, k->K1, k->v, k->V);
        for (int i = 0; i < size; i++) {
            k->rest[i] = 0;
            for (int l = 0; l < size; l++)
                k->rest[i] += fabs(k->K1[i + l * size] * k->v[l]);
        }
        for (int i = 0; i < gap; i++)
            k->G[i + j * gap] = ns_linalg_ranked_left(f, i, k->V, k->rest, &k->SG[i + j * gap]);
    }
    return ns_linalg_ranked_create(gap, k->G, k->SG, &k->gap);
}

static int take_apart(ns_order_expansion *k) {
    ns_linalg_ranked_free(k->zero);
    ns_linalg_ranked_free(k->gap);
    k->zero = k->gap = NULL;
    const int status = ns_linalg_ranked_create(k->size, k->K0, k->S0, &k->zero);
    return status == NS_OK ? form_gap(k) : status;
}

/* Z += N a where G a = L' b; terms: sizes of those that b was summed from (NULL: b's).  0 if no a does that.
 */
static int add_null(ns_order_expansion *k, const double *b, const double *terms, double *Z) {
    const int gap = k->gap->n;
    double *rhs = k->few, *size = rhs + gap, *a = size + gap;
    int fits = 1;
    for (int i = 0; i < gap; i++)
        rhs[i] = ns_linalg_ranked_left(k->zero, i, b, terms, &size[i]);
    for (int i = 0; i < gap - k->gap->rank; i++) {
        double over = 0;
        fits = fits && fabs(ns_linalg_ranked_left(k->gap, i, rhs, size, &over)) <= contradiction * over;
    }
    ns_linalg_ranked_solve(k->gap, rhs, a);
    for (int i = 0; i < gap; i++)
        ns_linalg_ranked_add_right(k->zero, i, a[i], Z);
    return fits;
}

/* rest = R - K1 Z, v: the sizes of its terms (from: of R's; NULL: R's). */
static void subtract_flow(ns_order_expansion *k, const double *R, const double *from, const double *Z) {
    for (int i = 0; i < k->size; i++) {
        double flow = 0, terms = 0;
        for (int j = 0; j < k->size; j++) {
            const double term = k->K1[i + j * k->size] * Z[j];
            flow += term;
            terms += fabs(term);
        }
        k->rest[i] = R[i] - flow;
        k->v[i] = (from ? from[i] : fabs(R[i])) + terms;
    }
}

/* Z1 = Q R0, Z0 = H R0 + Q R1; f (NULL: none): of K0 Z1.  0 if that is no solution. */
static int solve_orders(ns_order_expansion *k, const double *f, const double *R0, const double *from,
                        const double *R1, double *Z1, double *Z0) {
    memset(Z1, 0, sizeof(double) * (size_t)k->size);
    if (f)
        ns_linalg_ranked_solve(k->zero, f, Z1);
    subtract_flow(k, R0, from, Z1);
    const int impulses = add_null(k, k->rest, k->v, Z1);
    subtract_flow(k, R0, from, Z1);
    ns_linalg_ranked_solve(k->zero, k->rest, Z0);
    subtract_flow(k, R1, NULL, Z0);
    return add_null(k, k->rest, k->v, Z0) && impulses;
}

/* Row i of K Z, its terms in *terms; S: their sizes. */
static long double row_product(int n, int i, const double *K, const double *S, const long double *Z,
                               double *terms) {
    long double sum = 0;
    for (int j = 0; j < n; j++) {
        sum += K[i + j * n] * Z[j];
        *terms += fabs(S[i + j * n] * (double)Z[j]);
    }
    return sum;
}

/* What row i of K1 one = given - K0 zero leaves over; NULL: zero.  Sums that cancel to the rounding of their
 * coefficients are zero: the conductances at a node add up to what joins it to others, and nothing leaks. */
static double left_over(const ns_order_expansion *k, int i, long double given, const long double *one,
                        const long double *zero) {
    double flows = 0, holds = fabs((double)given);
    long double flow = one ? row_product(k->size, i, k->K1, k->K1, one, &flows) : 0;
    long double held = given - (zero ? row_product(k->size, i, k->K0, k->S0, zero, &holds) : 0);
    if (fabsl(flow) <= coefficient_eps * flows)
        flow = 0;
    if (flow == 0 && fabsl(held) <= coefficient_eps * holds)
        held = 0;
    return (double)(held - flow);
}

/* (Z1, Z0) of (R0, R1) by residuals, in long double: a resistor between two fluxes takes their difference.
 * From a guess, which moves by what it does not fulfil and by no rounding beyond that.  What was left over
 * before the last round stays in work. */
static void refine_orders(ns_order_expansion *k, const long double *R0, const double *R1, long double *Z1,
                          long double *Z0) {
    const int size = k->size;
    double *f = k->work, *r0 = f + size, *r1 = r0 + size, *d1 = r1 + size, *d0 = d1 + size;
    for (int round = 0; round < 4; round++) {
        for (int i = 0; i < size; i++) {
            f[i] = left_over(k, i, 0, NULL, Z1);
            r0[i] = left_over(k, i, R0[i], Z1, Z0);
            r1[i] = left_over(k, i, R1[i], Z0, NULL);
        }
        (void)solve_orders(k, f, r0, NULL, r1, d1, d0);
        for (int i = 0; i < size; i++) {
            Z1[i] += d1[i];
            Z0[i] += d0[i];
        }
    }
}

/* Z1, Z0. */
static void impulses_and_values(ns_order_expansion *k) {
    const int size = k->size, n = k->s->s->n;
    long double *Z1 = k->fine, *Z0 = Z1 + size, *R0 = Z0 + size;
    for (int i = 0; i < size; i++) {
        Z1[i] = 0;
        Z0[i] = i < n ? k->guess[i] : 0;
        R0[i] = i < k->s->r ? k->w[i] : k->R0[i];
    }
    refine_orders(k, R0, k->R1, Z1, Z0);
    for (int i = 0; i < size; i++) {
        k->Z1[i] = (double)Z1[i];
        k->Z0[i] = (double)Z0[i];
    }
}

/* What the rows may be off by: K0 Z1 = 0 into t, K0 Z0 + K1 Z1 = R0 into t0, K1 Z0 = R1 into t1, beside what
 * was left over in these places. */
static void roundings(const ns_order_expansion *k, double *t, double *t0, double *t1) {
    for (int i = 0; i < k->size; i++) {
        double none = 0, zero = k->terms[i], one = fabs(k->R1[i]);
        for (int j = 0; j < k->size; j++) {
            const double moves = fabs(k->K1[i + j * k->size]), holds = k->S0[i + j * k->size];
            none += holds * fabs(k->Z1[j]);
            zero += moves * fabs(k->Z1[j]) + holds * fabs(k->Z0[j]);
            one += moves * fabs(k->Z0[j]);
        }
        t[i] = fabs(t[i]) + data_eps * none;
        t0[i] = fabs(t0[i]) + data_eps * zero;
        t1[i] = data_eps * one; /* what K0 Z makes up for at the next order is no error */
    }
}

/* e += |A| t for the columns of A. */
static void spread_over(int n, const double *A, const double *t, double *e) {
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            e[i] += t[j] != 0 ? fabs(A[i + j * n]) * t[j] : 0;
}

/* E1, E0: by how much Z1 and Z0 may be off.  Q goes into V, H into H.
 */
static void bound_orders(ns_order_expansion *k) {
    const int size = k->size;
    double *t = k->work, *t0 = t + size, *t1 = t0 + size, *unit = t1 + size;
    double *none = unit + size;
    memset(unit, 0, sizeof(double) * 2 * (size_t)size);
    for (int j = 0; j < size; j++) {
        unit[j] = 1;
        (void)solve_orders(k, NULL, unit, NULL, none, k->V + (size_t)j * (size_t)size,
                           k->H + (size_t)j * (size_t)size);
        unit[j] = 0;
    }
    roundings(k, t, t0, t1);
    memset(k->E1, 0, sizeof(double) * (size_t)size);
    memset(k->E0, 0, sizeof(double) * (size_t)size);
    spread_over(size, k->H, t, k->E1);
    spread_over(size, k->K1, k->E1, t0);
    spread_over(size, k->V, t0, k->E1);
    spread_over(size, k->H, t0, k->E0);
    spread_over(size, k->V, t1, k->E0);
}

/* By how much the rates may be off, from the rounding t of R1 - K1 Z0.  t, none: in work. */
static void bound_rates(ns_order_expansion *k, double *t, double *none) {
    const int size = k->size;
    for (int i = 0; i < size; i++) {
        double terms = fabs(k->R1[i]);
        none[i] = 0;
        for (int j = 0; j < size; j++) {
            const double one = fabs(k->K1[i + j * size]);
            terms += one * fabs(k->Z0[j]) + k->S0[i + j * size] * fabs(k->Z2[j]);
            t[i] += one * k->E0[j];
            none[i] += data_eps * one * fabs(k->Z2[j]);
        }
        t[i] += data_eps * terms;
    }
    memset(k->E2, 0, sizeof(double) * (size_t)size);
    spread_over(size, k->H, t, k->E2);
    spread_over(size, k->V, none, k->E2);
}

/* Z2 = H (R1 - K1 Z0), the part of x(h) that grows like h. */
static void find_rates(ns_order_expansion *k) {
    const int size = k->size;
    long double *Z0 = k->fine + size, *R0 = Z0 + size, *none = R0 + size, *Z2 = none + size;
    double *zero = k->Z2;
    memset(zero, 0, sizeof(double) * (size_t)size);
    for (int i = 0; i < size; i++) {
        R0[i] = left_over(k, i, k->R1[i], Z0, NULL);
        none[i] = Z2[i] = 0;
    }
    refine_orders(k, R0, zero, none, Z2);
    for (int i = 0; i < size; i++) {
        k->Z2[i] = (double)Z2[i];
        k->work[i] = fabs(k->work[size + i]); /* left over of R0 */
    }
    bound_rates(k, k->work, k->work + size);
}

/* Takes the component along v out of Z, or (keep) replaces it by that of keep; E: bounds on Z.  Both may be
 * NULL. */
static void project_out(int n, const double *v, const double *keep, double *Z, double *E) {
    const double whole = ns_dot(n, v, v), along = (ns_dot(n, v, Z) - (keep ? ns_dot(n, v, keep) : 0)) / whole;
    double off = 0;
    for (int i = 0; i < n; i++) {
        Z[i] -= along * v[i];
        off += E ? fabs(v[i]) * E[i] : 0;
    }
    for (int i = 0; E && i < n; i++)
        E[i] += fabs(v[i]) / whole * off;
}

/* Null vector o of K0 that G does not determine either, into v.  0: K1 does, and impulses of the next order
 * were needed. */
static int undetermined_vector(ns_order_expansion *k, int o, double *v) {
    const int size = k->size, gap = k->gap->n;
    memset(v, 0, sizeof(double) * (size_t)size);
    for (int i = 0; i < gap; i++)
        ns_linalg_ranked_add_right(k->zero, i, k->gap->right[(k->gap->rank + o) + i * gap], v);
    for (int i = 0; i < size; i++) {
        double sum = 0, terms = 0;
        for (int j = 0; j < size; j++) {
            sum += k->K1[i + j * size] * v[j];
            terms += fabs(k->K1[i + j * size] * v[j]);
        }
        if (fabs(sum) > contradiction * terms)
            return 0;
    }
    return 1;
}

/* What the equations do not determine is of least norm; of values, nearest to k->near. */
static int choose_undetermined(ns_order_expansion *k) {
    const int size = k->size, n = k->s->s->n, open = k->gap->n - k->gap->rank;
    for (int i = 0; i < size && k->near; i++)
        k->rest[i] = k->near[i < n ? i : n + k->inside[i - n]];
    for (int o = 0; o < open; o++) {
        double *v = k->V + (size_t)o * (size_t)size;
        if (!undetermined_vector(k, o, v))
            return 0;
        for (int p = 0; p < o; p++)
            project_out(size, k->V + (size_t)p * (size_t)size, NULL, v, NULL);
    }
    for (int o = 0; o < open; o++) {
        project_out(size, k->V + (size_t)o * (size_t)size, NULL, k->Z1, k->E1);
        project_out(size, k->V + (size_t)o * (size_t)size, k->near ? k->rest : NULL, k->Z0, k->E0);
    }
    return 1;
}

int ns_reinit_orders_solve(ns_order_expansion *k) {
    const int status = take_apart(k);
    if (status != NS_OK)
        return status;
    if (!solve_orders(k, NULL, k->R0, k->terms, k->R1, k->Z1, k->Z0))
        return NS_E_SINGULAR;
    impulses_and_values(k);
    bound_orders(k);
    find_rates(k);
    if (!choose_undetermined(k))
        return NS_E_SINGULAR;
    for (int i = 0; i < k->size; i++) {
        if (!isfinite(k->E1[i] + k->E0[i]))
            return NS_E_SINGULAR;
        if (fabs(k->Z1[i]) <= k->E1[i])
            k->Z1[i] = 0;
    }
    return NS_OK;
}
