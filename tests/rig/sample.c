/* tests/rig/sample.c - drawing laws and answers, finishing a problem, judging what was answered. */
#include "sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lapacke.h>

int sample_create(int cap, sample *s) {
    size_t m = (size_t)cap;
    memset(s, 0, sizeof *s);
    s->W = calloc(3 * m * m + 11 * m + 1, sizeof *s->W);
    if (!s->W)
        return -1;
    s->cap = cap;
    s->work = s->W + m * m;
    s->work2 = s->work + m * m;
    double **vector[] = {&s->q, &s->l, &s->u, &s->lambda, &s->y, &s->row, &s->col, &s->farkas};
    double *at = s->work2 + m * m;
    for (size_t k = 0; k < sizeof vector / sizeof *vector; k++, at += m)
        *vector[k] = at;
    s->judging = at;
    return 0;
}

void sample_free(sample *s) {
    free(s->W);
    memset(s, 0, sizeof *s);
}

void sample_start(sample *s, int m) {
    s->m = m;
    s->unique = s->exact = s->none = 0;
    s->kind = "?";
    memset(s->W, 0, (size_t)m * (size_t)m * sizeof *s->W);
    memset(s->farkas, 0, (size_t)m * sizeof *s->farkas);
    for (int i = 0; i < m; i++)
        s->row[i] = s->col[i] = 1.0;
}

double *sample_entry(sample *s, int i, int j) {
    return &s->W[(size_t)i + (size_t)j * (size_t)s->m];
}

double sample_value(sample *s) {
    return s->exact ? dice_integer(&s->dice, 3) : dice_either(&s->dice);
}

static double magnitude(sample *s) { /* of a lambda or y, > 0 */
    return s->exact ? (1 + dice_below(&s->dice, 24)) / 8.0 : 1e-3 + dice_uniform(&s->dice);
}

static int pick(sample *s, int laws) {
    int n = 0, law[7];
    for (int bit = 1; bit <= LAW_EQUALITY; bit *= 2)
        if (laws & bit)
            law[n++] = bit;
    return law[dice_below(&s->dice, n)];
}

void sample_draw(sample *s, int i, int laws, double ties) {
    int law = pick(s, laws), tie = dice_chance(&s->dice, ties), where = dice_below(&s->dice, 3);
    double at = s->exact ? dice_eighths(&s->dice, 2) : dice_either(&s->dice), wide = 2 * magnitude(s);
    s->l[i] = law == LAW_PAIR                       ? 0
              : law == LAW_RELAY                    ? -1
              : law & (LAW_REVERSED | LAW_EQUALITY) ? -INFINITY
                                                    : at;
    s->u[i] = law == LAW_REVERSED || law == LAW_FIXED ? at
              : law == LAW_BOX                        ? at + wide
              : law == LAW_RELAY                      ? 1
                                                      : INFINITY;
    double from = isfinite(s->l[i]) ? s->l[i] : isfinite(s->u[i]) ? s->u[i] - wide : -wide / 2;
    double to = isfinite(s->u[i]) ? s->u[i] : from + wide;
    s->lambda[i] = s->exact ? (from + to) / 2 : from + (to - from) * dice_uniform(&s->dice);
    s->y[i] = 0;
    if (law == LAW_FIXED) {
        s->lambda[i] = at;
        s->y[i] = (dice_below(&s->dice, 2) ? 1 : -1) * magnitude(s);
    } else if (isfinite(s->l[i]) && (where == 0 || (where == 1 && isinf(s->u[i])))) {
        s->lambda[i] = s->l[i];
        s->y[i] = tie ? 0 : magnitude(s);
    } else if (isfinite(s->u[i]) && where == 1) {
        s->lambda[i] = s->u[i];
        s->y[i] = tie ? 0 : -magnitude(s);
    }
}

void sample_draw_all(sample *s, int laws, double ties) {
    for (int i = 0; i < s->m; i++)
        sample_draw(s, i, laws, ties);
}

static void set_q(sample *s) {
    for (int i = 0; i < s->m; i++) {
        long double q = s->y[i];
        for (int j = 0; j < s->m; j++)
            q -= (long double)*sample_entry(s, i, j) * s->lambda[j];
        s->q[i] = (double)q;
    }
}

void sample_units(sample *s, int bits) {
    for (int i = 0; i < s->m; i++) {
        double r = ldexp(1, dice_below(&s->dice, 2 * bits + 1) - bits);
        double c = ldexp(1, dice_below(&s->dice, 2 * bits + 1) - bits);
        s->row[i] *= r;
        s->col[i] *= c;
        s->y[i] *= r;
        s->q[i] *= r;
        s->farkas[i] /= r;
        s->lambda[i] /= c;
        s->l[i] /= c;
        s->u[i] /= c;
        for (int k = 0; k < s->m; k++) {
            *sample_entry(s, i, k) *= r;
            *sample_entry(s, k, i) *= c;
        }
    }
}

void sample_finish(sample *s, double spoil) {
    set_q(s);
    if (dice_chance(&s->dice, spoil))
        sample_units(s, 1 + dice_below(&s->dice, 50));
}

ns_mlcp sample_problem(const sample *s) {
    return (ns_mlcp){.m = s->m, .W = s->W, .q = s->q, .l = s->l, .u = s->u};
}

/* W_ij in the units in which the problem was made. */
static double natural(const sample *s, int i, int j) {
    return s->W[(size_t)i + (size_t)j * (size_t)s->m] / (s->row[i] * s->col[j]);
}

/* In natural units: y_i and the sum of the sizes of its terms. */
static void read_row(const sample *s, const double *lambda, int i, double *y, double *size) {
    long double sum = s->q[i] / s->row[i];
    *size = fabs(s->q[i] / s->row[i]);
    for (int j = 0; j < s->m; j++) {
        double w = natural(s, i, j), v = lambda[j] * s->col[j];
        sum += (long double)w * v;
        *size += fabs(w * v);
    }
    *y = (double)sum;
}

/* By how much row i breaks its law, y in units of `size`. */
static double broken(double lambda, double l, double u, double y, double size) {
    if (!(lambda >= l && lambda <= u))
        return NAN;
    if (l == u || y == 0)
        return 0;
    double e = fabs(y) / size, to_bound = y > 0 ? lambda - l : u - lambda;
    return fmin(e, to_bound);
}

/* The lambda_j that a row would notice in full, of the rows with a large entry in its column the one that
 * needs most: what lambda_j is made of has that size, though it may have cancelled.  size: of the rows. */
static double weight(const sample *s, int j, const double *size) {
    double top = 0, most = 0;
    for (int i = 0; i < s->m; i++)
        top = fmax(top, fabs(natural(s, i, j)));
    for (int i = 0; i < s->m; i++) {
        double w = fabs(natural(s, i, j));
        if (w >= 0.1 * top && w > 0)
            most = fmax(most, size[i] / w);
    }
    return most;
}

/* A row all of whose terms are rounding (a branch in which nothing flows) is measured against 1e-5 of the
 * largest term that its lambda would make in it if they had not cancelled, or were as large as the largest: a
 * few roundings of 1e-16 there are then 1e-10 here. */
double sample_residual(const sample *s, const double *lambda) {
    double worst = 0, any = 0, *size = s->judging, *y = size + s->m, *most = y + s->m;
    for (int i = 0; i < s->m; i++)
        read_row(s, lambda, i, &y[i], &size[i]);
    for (int j = 0; j < s->m; j++)
        any = fmax(any, fabs(lambda[j] * s->col[j]));
    for (int j = 0; j < s->m; j++)
        most[j] = fmax(weight(s, j, size), any);
    for (int i = 0; i < s->m; i++) {
        double c = s->col[i], floor = 0;
        for (int j = 0; j < s->m; j++)
            floor = fmax(floor, 1e-5 * fabs(natural(s, i, j)) * most[j]);
        double whole = fmax(size[i], floor);
        double e = broken(lambda[i] * c, s->l[i] * c, s->u[i] * c, y[i], whole > 0 ? whole : 1);
        if (!(e <= worst))
            worst = e;
        if (isnan(e))
            break;
    }
    return worst;
}

/* The least of a x over lo <= x <= hi, an a that is rounding being 0 where there is no other end to it. */
static long double least(long double a, double lo, double hi, int rounding) {
    double end = a > 0 ? lo : hi;
    return a == 0 || (isinf(end) && rounding) ? 0 : a * end;
}

/* 1e-14: a sum of up to 200 products of numbers that are rounded to 1e-16. */
double sample_margin(const sample *s, const double *v) {
    long double sum = 0, size = 0;
    for (int j = 0; j < s->m; j++) {
        long double t = 0, terms = 0, own;
        for (int i = 0; i < s->m; i++) {
            long double term = (long double)v[i] * s->W[(size_t)i + (size_t)j * (size_t)s->m];
            t += term;
            terms += fabsl(term);
        }
        own = least(-t, s->l[j], s->u[j], fabsl(t) <= 1e-14L * terms) - (long double)v[j] * s->q[j];
        if (isfinite(s->l[j]) || isfinite(s->u[j]))
            own += least(v[j], isinf(s->u[j]) ? 0 : -INFINITY, isinf(s->l[j]) ? 0 : INFINITY, 0);
        sum += own;
        size += fabsl(own);
    }
    return isfinite((double)size) && size > 0 ? (double)(sum / size) : -1;
}

/* What relative errors of all terms come to in lambda and y (Bauer and Skeel): the largest entry of |A^-1| t,
 * A the columns of W where the mode has lambda inside, -1 on the diagonal elsewhere, t the sums of sizes of
 * rows. */
static double condition_of(sample *s, const double *lambda, const ns_mode *mode) {
    int m = s->m, pivot[1024];
    size_t n = (size_t)m;
    double worst = 0, *size = s->judging, *y = size + s->m, *out = y + s->m;
    if (m > 1024)
        return NAN;
    for (int i = 0; i < m; i++) {
        read_row(s, lambda, i, &y[i], &size[i]);
        size[i] += fabs(y[i]);
        out[i] = 0;
        for (int j = 0; j < m; j++)
            s->work[(size_t)i + (size_t)j * n] = mode[j] != NS_INSIDE ? -(double)(i == j) : natural(s, i, j);
    }
    if (LAPACKE_dgetrf(LAPACK_COL_MAJOR, m, m, s->work, m, pivot) != 0 ||
        LAPACKE_dgetri(LAPACK_COL_MAJOR, m, s->work, m, pivot) != 0)
        return INFINITY;
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++)
            out[i] += fabs(s->work[(size_t)i + (size_t)j * n]) * size[j];
    for (int i = 0; i < m; i++)
        worst = fmax(worst, out[i]);
    return worst;
}

double sample_error(sample *s, const double *lambda, const ns_mode *mode, double *condition) {
    double most = 1, worst = 0;
    for (int i = 0; i < s->m; i++) {
        most = fmax(most, fabs(s->lambda[i] * s->col[i]));
        worst = fmax(worst, fabs(lambda[i] - s->lambda[i]) * s->col[i]);
    }
    *condition = condition_of(s, lambda, mode) / most;
    return worst / most;
}
