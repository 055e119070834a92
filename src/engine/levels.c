/* src/engine/levels.c - the orders in 1/h of a mode's step as h -> 0: the impulsive and the finite level.
 *
 * A step of length h with theta = gamma = 1 in a mode is (P2), K(h) Z = R(h), Z = (x, lambda_J), and
 *
 *     K(h) = K0 + h K1,   R(h) = R0 + h R1,   Z(h) = Z1/h + Z0 + ...
 *     K0 = [ M; -A -B_J; C_J D_JJ ],   K1 = [ -A -B_J; 0; 0 ]   (differential rows; algebraic rows; pairs)
 *
 * whose orders 1/h, 1, h are two levels, impulsive and finite, and the condition that there is a third:
 *
 *     K0 Z1 = 0,   K0 Z0 + K1 Z1 = R0,   K0 . + K1 Z0 = R1
 *
 * With the right null vectors N and the left ones L of K0:  Z1 = N a,  Z0 = Zp + N c,  G = L'K1 N,
 *
 *     G a = L'R0,   K0 Zp = R0 - K1 Z1,   G c = L'(R1 - K1 Zp)
 */
#include "levels.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The residual of an answer, relative to the terms of each row; of what is left of an equation without
 * unknowns. */
static const double residual_max = 1e-10;
static const double of_largest = 1e-3;

int ns_levels_create(ns_theta *s, ns_levels *k) {
    const size_t all = (size_t)s->s->n + (size_t)s->s->m, square = all * all;
    double **const vectors[] = {&k->R0, &k->R1, &k->terms, &k->Z1,   &k->Z0, &k->unit,
                                &k->X,  &k->x,  &k->v,     &k->rest, &k->few};
    const size_t count = sizeof vectors / sizeof *vectors;
    memset(k, 0, sizeof *k);
    k->s = s;
    k->K0 = calloc(6 * square + (count + 2) * all + 1, sizeof(double));
    if (!k->K0)
        return NS_E_MEMORY;
    k->K1 = k->K0 + square;
    k->S0 = k->K1 + square;
    k->G = k->S0 + square;
    k->SG = k->G + square;
    k->V = k->SG + square;
    for (size_t i = 0; i < count; i++)
        *vectors[i] = k->V + square + i * all;
    return NS_OK;
}

void ns_levels_free(ns_levels *k) {
    ns_ranked_free(k->zero);
    ns_ranked_free(k->gap);
    free(k->K0);
}

/* One row of (P2) without its matrix: what is given of order 1, with the sizes of its terms. */
static double given(const ns_levels *k, int i, const double *z, double *terms) {
    const ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m, pair = i < n ? 0 : s->inside[i - n];
    double sum = i < n ? s->b[i] : -s->s->e[pair];
    *terms = fabs(sum);
    for (int c = 0; z && c < s->s->nz; c++) {
        const double t = z[c] * (i < n ? s->E[i + c * n] : -s->s->F[pair + c * m]);
        sum += t;
        *terms += fabs(t);
    }
    for (int j = 0; j < m; j++) {
        const ns_mode mode = s->trial_mode[j];
        if (mode == NS_INSIDE)
            continue;
        const double bound = mode == NS_LOWER ? s->l[j] : s->u[j];
        const double t = bound * (i < n ? s->B[i + j * n] : -s->s->D[pair + j * m]);
        sum += t;
        *terms += fabs(t);
    }
    return sum;
}

/* What is given of order h: charge flows, sources move. */
static double given_next(const ns_levels *k, int i, const double *z, const double *slope) {
    const ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m;
    double sum = 0;
    if (i < s->r)
        return given(k, i, z, &sum);
    for (int c = 0; slope && c < s->s->nz; c++)
        sum += slope[c] * (i < n ? s->E[i + c * n] : -s->s->F[s->inside[i - n] + c * m]);
    return sum;
}

/* Sizes of the terms that row i of T sums up in a column. */
static double summed(const ns_theta *s, int i, const double *column) {
    double size = 0;
    for (int j = 0; j < s->s->n; j++)
        size += fabs(s->T[i + j * s->s->n] * column[j]);
    return size;
}

/* (P2) in s->trial_mode, by powers of h. */
static void form(ns_levels *k, const double *z, const double *slope) {
    ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m, r = s->r;
    k->nj = 0;
    for (int j = 0; j < m; j++)
        if (s->trial_mode[j] == NS_INSIDE)
            s->inside[k->nj++] = j;
    const int size = k->size = n + k->nj;
    for (int j = 0; j < size; j++) {
        const int pair = j < n ? 0 : s->inside[j - n];
        const double *flow = j < n ? s->A + (size_t)j * (size_t)n : s->B + (size_t)pair * (size_t)n;
        double *zero = k->K0 + (size_t)j * (size_t)size, *one = k->K1 + (size_t)j * (size_t)size;
        double *terms = k->S0 + (size_t)j * (size_t)size;
        memset(one, 0, sizeof(double) * (size_t)size);
        for (int i = 0; i < n; i++) {
            zero[i] = i >= r ? -flow[i] : j < n ? s->M[i + j * n] : 0;
            one[i] = i < r ? -flow[i] : 0;
            terms[i] =
                i < r ? fabs(zero[i])
                      : summed(s, i,
                               j < n ? s->s->A + (size_t)j * (size_t)n : s->s->B + (size_t)pair * (size_t)n);
        }
        for (int i = 0; i < k->nj; i++)
            terms[n + i] = zero[n + i] =
                j < n ? s->s->C[s->inside[i] + j * m] : s->s->D[s->inside[i] + pair * m];
    }
    for (int i = 0; i < size; i++) {
        k->R0[i] = i < r ? s->w[i] : given(k, i, z, &k->terms[i]);
        if (i < r)
            k->terms[i] = fabs(s->w[i]);
        k->R1[i] = given_next(k, i, z, slope);
    }
}

/* G = L'K1 N. */
static int form_gap(ns_levels *k) {
    const ns_ranked *f = k->zero;
    const int size = k->size, gap = size - f->rank;
    for (int j = 0; j < gap; j++) {
        memset(k->v, 0, sizeof(double) * (size_t)size);
        ns_ranked_add_right(f, j, 1, k->v);
        ns_matvec(size, size, k->K1, k->v, k->V);
        for (int i = 0; i < size; i++) {
            k->rest[i] = 0;
            for (int l = 0; l < size; l++)
                k->rest[i] += fabs(k->K1[i + l * size] * k->v[l]);
        }
        for (int i = 0; i < gap; i++)
            k->G[i + j * gap] = ns_ranked_left(f, i, k->V, k->rest, &k->SG[i + j * gap]);
    }
    return ns_ranked_create(gap, k->G, k->SG, &k->gap);
}

/* Z += N a where G a = L' b; terms: sizes of those that b was summed from.  0 if no a does that. */
static int add_null(ns_levels *k, const double *b, const double *terms, double *Z) {
    const int gap = k->gap->n;
    double *rhs = k->few, *size = rhs + gap, *a = size + gap;
    for (int i = 0; i < gap; i++)
        rhs[i] = ns_ranked_left(k->zero, i, b, terms, &size[i]);
    for (int i = 0; i < gap - k->gap->rank; i++) {
        double over = 0;
        if (fabs(ns_ranked_left(k->gap, i, rhs, size, &over)) > residual_max * over)
            return 0;
    }
    ns_ranked_solve(k->gap, rhs, a);
    for (int i = 0; i < gap; i++)
        ns_ranked_add_right(k->zero, i, a[i], Z);
    return 1;
}

/* Of unknown i of (P2). */
static double unit_of(const ns_levels *k, int i) {
    const int n = k->s->s->n;
    return k->unit[i < n ? i : n + k->s->inside[i - n]];
}

static double dot(const ns_levels *k, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < k->size; i++)
        sum += a[i] / unit_of(k, i) * (b[i] / unit_of(k, i));
    return sum;
}

/* Takes out of Z what lies along v, in the units of the factors. */
static void project(const ns_levels *k, const double *v, double *Z) {
    const double share = dot(k, v, Z) / dot(k, v, v);
    for (int i = 0; i < k->size; i++)
        Z[i] -= share * v[i];
}

/* What G leaves open, and K1 as well, is of least norm.  0: K1 does not, which takes impulses of the next
 * order to settle. */
static int close_open(ns_levels *k) {
    const int size = k->size, gap = k->gap->n, open = gap - k->gap->rank;
    for (int o = 0; o < open; o++) {
        double *v = k->V + (size_t)o * (size_t)size, *through = k->v;
        memset(v, 0, sizeof(double) * (size_t)size);
        for (int i = 0; i < gap; i++)
            ns_ranked_add_right(k->zero, i, k->gap->right[(k->gap->rank + o) + i * gap], v);
        for (int i = 0; i < size; i++) {
            double sum = 0, terms = 0;
            for (int j = 0; j < size; j++) {
                sum += k->K1[i + j * size] * v[j];
                terms += fabs(k->K1[i + j * size] * v[j]);
            }
            through[i] = fabs(sum) <= residual_max * terms ? 0 : sum;
            if (through[i] != 0)
                return 0;
        }
        for (int p = 0; p < o; p++)
            project(k, k->V + (size_t)p * (size_t)size, v);
    }
    for (int o = 0; o < open; o++) {
        project(k, k->V + (size_t)o * (size_t)size, k->Z1);
        project(k, k->V + (size_t)o * (size_t)size, k->Z0);
    }
    return 1;
}

static double largest(const ns_levels *k, const double *Z) {
    double most = 0;
    for (int i = 0; i < k->size; i++)
        most = fmax(most, fabs(Z[i]) / unit_of(k, i));
    return most;
}

/* |K0 Z0 + K1 Z1 - R0| and |K0 Z1| against the terms of each row, and against a share of what the largest
 * unknown would be there: what is zero comes out as rounding of others. */
static double residual(const ns_levels *k) {
    const int size = k->size;
    const double most0 = of_largest * largest(k, k->Z0), most1 = of_largest * largest(k, k->Z1);
    double worst = 0;
    for (int i = 0; i < size; i++) {
        double sum = -k->R0[i], terms = k->terms[i], impulse = 0, impulses = 0;
        for (int j = 0; j < size; j++) {
            const double *zero = &k->K0[i + j * size], *one = &k->K1[i + j * size];
            sum += *zero * k->Z0[j] + *one * k->Z1[j];
            terms += fabs(*zero) * (fabs(k->Z0[j]) + most0 * unit_of(k, j));
            terms += fabs(*one) * (fabs(k->Z1[j]) + most1 * unit_of(k, j));
            impulse += *zero * k->Z1[j];
            impulses += fabs(*zero) * (fabs(k->Z1[j]) + most1 * unit_of(k, j));
        }
        if (fabs(sum) > worst * terms)
            worst = fabs(sum) / terms;
        if (fabs(impulse) > worst * impulses)
            worst = fabs(impulse) / impulses;
    }
    return worst;
}

/* rest = R - K1 Z, v: the sizes of its terms (from: of R's).  What cancels in K1 Z is zero: resistors carry
 * no impulse, but the fluxes at their two ends leave rounding. */
static void subtract(ns_levels *k, const double *R, const double *from, const double *Z) {
    for (int i = 0; i < k->size; i++) {
        double flow = 0, terms = 0;
        for (int j = 0; j < k->size; j++) {
            const double term = k->K1[i + j * k->size] * Z[j];
            flow += term;
            terms += fabs(term);
        }
        k->rest[i] = R[i] - (fabs(flow) <= 64 * DBL_EPSILON * terms ? 0 : flow);
        k->v[i] = (from ? from[i] : fabs(R[i])) + terms;
    }
}

static int take_apart(ns_levels *k) {
    ns_ranked_free(k->zero);
    ns_ranked_free(k->gap);
    k->zero = k->gap = NULL;
    const int status = ns_ranked_create(k->size, k->K0, k->S0, &k->zero);
    return status == NS_OK ? form_gap(k) : status;
}

/* Z1 and Z0 with all pairs. */
static void spread(ns_levels *k) {
    const ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m;
    memcpy(k->X, k->Z1, sizeof(double) * (size_t)n);
    memcpy(k->x, k->Z0, sizeof(double) * (size_t)n);
    for (int j = 0; j < m; j++) {
        k->X[n + j] = 0;
        k->x[n + j] = s->trial_mode[j] == NS_LOWER ? s->l[j] : s->u[j];
    }
    for (int i = 0; i < k->nj; i++) {
        k->X[n + s->inside[i]] = k->Z1[n + i];
        k->x[n + s->inside[i]] = k->Z0[n + i];
    }
}

int ns_levels_expand(ns_levels *k, const double *z, const double *slope) {
    form(k, z, slope);
    const int status = take_apart(k);
    if (status != NS_OK)
        return status;
    memset(k->Z1, 0, sizeof(double) * (size_t)k->size);
    if (!add_null(k, k->R0, k->terms, k->Z1))
        return NS_E_SINGULAR;
    subtract(k, k->R0, k->terms, k->Z1);
    ns_ranked_solve(k->zero, k->rest, k->Z0);
    subtract(k, k->R1, NULL, k->Z0);
    if (!add_null(k, k->rest, k->v, k->Z0) || !close_open(k))
        return NS_E_SINGULAR;
    if (!(residual(k) <= residual_max))
        return NS_E_RESIDUAL;
    spread(k);
    return NS_OK;
}

double ns_levels_scale(ns_levels *k, double h) {
    ns_theta *s = k->s;
    const int all = s->s->n + s->s->m;
    double rate = 0;
    memset(s->trial_mode, NS_INSIDE, (size_t)s->s->m);
    form(k, NULL, NULL);
    for (int i = 0; i < all * all; i++)
        k->G[i] = k->K0[i] + h * k->K1[i];
    (void)ns_lu_factor(s->lu, all, k->G, NULL, NULL); /* for its scaling */
    const double *rows = ns_lu_rows(s->lu), *units = ns_lu_units(s->lu);
    memcpy(k->unit, units, sizeof(double) * (size_t)all);
    for (int j = 0; j < all; j++) {
        int given = 0;
        for (int i = 0; i < all; i++)
            given |= k->K0[i + j * all] != 0;
        for (int i = 0; i < all && given; i++)
            rate = fmax(rate, rows[i] * fabs(k->K1[i + j * all]) * units[j]);
    }
    return rate;
}
