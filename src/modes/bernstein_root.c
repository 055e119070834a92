/* src/modes/bernstein_root.c - the first root of a guard over a step: bounded by Bernstein's form, which is
 * halved until it tells, then closed in. */
#include "bernstein_root.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { TERMS = NS_SEARCH_TERMS, SPLITS = 4000, DEEPEST = 52, SURE_DEPTH = 8 };

static const double binomial[TERMS][TERMS] = {{1},
                                              {1, 1},
                                              {1, 2, 1},
                                              {1, 3, 3, 1},
                                              {1, 4, 6, 4, 1},
                                              {1, 5, 10, 10, 5, 1},
                                              {1, 6, 15, 20, 15, 6, 1},
                                              {1, 7, 21, 35, 35, 21, 7, 1},
                                              {1, 8, 28, 56, 70, 56, 28, 8, 1}};

/* L_i(end u) = sum_k C(i,k) (-end u)^k / k! */
void ns_modes_curve_of(int terms, const double *G, double end, ns_curve *c) {
    double power = 1;
    c->terms = terms;
    for (int k = 0; k < terms; k++) {
        double sum = 0;
        for (int i = terms - 1; i >= k; i--)
            sum += (i % 2 ? -G[i] : G[i]) * binomial[i][k];
        c->p[k] = sum * power;
        power *= -end / (k + 1);
    }
}

static double value(const ns_curve *c, double u) {
    double sum = 0;
    for (int k = c->terms - 1; k >= 0; k--)
        sum = sum * u + c->p[k];
    return sum;
}

double ns_modes_curve_slope(const ns_curve *c, double u) {
    double sum = 0;
    for (int k = c->terms - 1; k > 0; k--)
        sum = sum * u + k * c->p[k];
    return sum;
}

typedef struct root_search {
    int terms, splits; /* left */
    double tol;
    double high; /* where it is below for sure, 0: not known */
} root_search;

/* Whether b, Bernstein's coefficients on [low, high], fall below -tol: from where to look, or NAN. */
static double first_below(root_search *s, const double *b, double low, double high, int depth) {
    double left[TERMS] = {0}, right[TERMS], least = b[0];
    const int terms = s->terms;
    int falls = 1; /* all the way: one root */
    for (int i = 1; i < terms; i++) {
        least = b[i] < least ? b[i] : least;
        falls &= b[i] <= b[i - 1];
    }
    if (least >= -s->tol)
        return NAN;
    if (b[0] < -s->tol || depth >= DEEPEST || s->splits-- <= 0)
        return low;
    if ((falls || depth >= SURE_DEPTH) && b[terms - 1] < -s->tol) {
        s->high = high;
        return low;
    }
    memcpy(right, b, sizeof right);
    for (int i = 0; i < terms; i++) { /* de Casteljau, at the middle */
        left[i] = right[0];
        for (int k = 0; k + 1 < terms - i; k++)
            right[k] = 0.5 * (right[k] + right[k + 1]);
    }
    /* right[terms-1-i] is the last of round i: already in place */
    const double mid = 0.5 * (low + high), first = first_below(s, left, low, mid, depth + 1);
    return isnan(first) ? first_below(s, right, mid, high, depth + 1) : first;
}

/* Of an end that stays where it is only half counts (Illinois), and each eighth time the middle is taken. */
double ns_modes_chords(ns_function *f, const void *data, double a, double b, double eps) {
    double at_a = f(data, a), at_b = f(data, b);
    int side = 0;
    for (int i = 0; i < 200 && at_a >= 0; i++) {
        const double d = eps * fmax(fabs(a), fabs(b));
        if (b - a <= 2 * d)
            break;
        double mid = i % 8 == 7 ? a + (b - a) / 2 : a + (b - a) * at_a / (at_a - at_b);
        mid = mid > a + d ? mid : a + d;
        mid = mid < b - d ? mid : b - d;
        const double at = f(data, mid);
        if (at < 0) {
            b = mid;
            at_b = at;
            at_a *= side == 1 ? 0.5 : 1;
            side = 1;
        } else {
            a = mid;
            at_a = at;
            at_b *= side == -1 ? 0.5 : 1;
            side = -1;
        }
    }
    return a;
}

static double value_at(const void *c, double u) {
    return value(c, u);
}

static double close_in(const ns_curve *c, double low, double high) {
    return ns_modes_chords(value_at, c, low, high, 2 * DBL_EPSILON);
}

void ns_modes_curve_cut(const ns_curve *c, double end, ns_curve *part) {
    double power = 1;
    part->terms = c->terms;
    for (int k = 0; k < c->terms; k++) {
        part->p[k] = c->p[k] * power;
        power *= end;
    }
}

/* By Horner's rule, once for each coefficient. */
void ns_modes_curve_rest(const ns_curve *c, double from, ns_curve *part) {
    ns_curve moved = *c;
    for (int k = 0; k < c->terms; k++)
        for (int i = c->terms - 2; i >= k; i--)
            moved.p[i] += from * moved.p[i + 1];
    ns_modes_curve_cut(&moved, 1 - from, part);
}

/* Bernstein's coefficients. */
static void to_bernstein(const ns_curve *c, double *b) {
    double p[TERMS];
    for (int k = 0; k < c->terms; k++)
        p[k] = c->p[k] / binomial[c->terms - 1][k];
    for (int j = 0; j < c->terms; j++) {
        b[j] = p[0];
        for (int k = 1; k <= j; k++)
            b[j] += p[k] * binomial[j][k];
    }
}

int ns_modes_curve_holds(const ns_curve *c, double tol) {
    double b[TERMS] = {0};
    int holds = 1;
    to_bernstein(c, b);
    for (int j = 0; j < c->terms; j++)
        holds &= b[j] >= -tol;
    return holds;
}

double ns_modes_curve_below(const ns_curve *c, double tol) {
    root_search s = {c->terms, SPLITS, tol, 0};
    ns_curve above = *c;
    double b[TERMS] = {0};
    to_bernstein(c, b);
    const double low = first_below(&s, b, 0, 1, 0);
    above.p[0] += tol;
    return s.high > low && value(&above, low) >= 0 && value(&above, s.high) < 0
               ? close_in(&above, low, s.high)
               : low;
}

double ns_modes_curve_root(const ns_curve *c, double at) {
    double low = at, high = at, step = 1e-9;
    if (value(c, at) < 0)
        for (; low > 0 && value(c, low) < 0; step *= 4)
            low = low > step ? low - step : 0;
    else
        for (; high < 1 && value(c, high) >= 0; step *= 4)
            high = high + step < 1 ? high + step : 1;
    if (value(c, low) < 0 || value(c, high) >= 0)
        return low <= 0 ? 0 : INFINITY; /* after the step */
    return close_in(c, low, high);
}
