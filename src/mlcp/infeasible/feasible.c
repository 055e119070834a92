/* src/mlcp/infeasible/feasible.c - are linear equations and bounds consistent?  The simplex method on y = W
 * lambda + q.
 *
 * The sum of the violations of all bounds is made as small as it will be (phase 1, any basis may be the
 * first).  If it ends above 0, the row that says so is one of Farkas: multipliers v of the equations with sum
 * v_i y_i - sum (W'v)_j lambda_j = v'q     but     v'q is more than the bounds let the left side be. It is
 * computed anew from W and q, so the tableau may round as it likes: it can fail to decide, not decide
 * wrongly.
 */
#include "feasible.h"

#include <math.h>
#include <string.h>

enum { PIVOTS = 100, PER_ROW = 10, AGAIN = 40 };
static const double FEAS = 1e-11;   /* a bound is kept if broken by no more, against the largest value */
static const double PIVOT = 1e-9;   /* least pivot, against the largest of its column */
static const double ZERO = 1e-13;   /* sums this small against their terms are 0 */
static const double CANCEL = 1e-12; /* as certificate.c has it */
static const double MARGIN = 1e-10; /* by which a proof must hold, against its terms */

static double *entry(const ns_simplex *p, int r, int c) {
    return p->T + (size_t)r + (size_t)c * (size_t)p->m;
}

void ns_mlcp_simplex_release(const ns_mlcp_solver *s, ns_simplex *p, int i) {
    double l = s->p->l[i], u = s->p->u[i], unit = ldexp(1.0, -s->c[i] - p->shift);
    int fixed = l == u, m = p->m; /* a fixed lambda is folded into q: 0 here */
    p->lo[i] = fixed ? 0.0 : l * unit;
    p->hi[i] = fixed ? 0.0 : u * unit;
    p->lo[m + i] = fixed || isfinite(u) ? -INFINITY : 0.0;
    p->hi[m + i] = fixed || isfinite(l) ? INFINITY : 0.0;
}

void ns_mlcp_simplex_fix(const ns_mlcp_solver *s, ns_simplex *p, int i, ns_mode mode) {
    int m = p->m;
    ns_mlcp_simplex_release(s, p, i);
    if (mode == NS_INSIDE) {
        p->lo[m + i] = p->hi[m + i] = 0.0;
        return;
    }
    p->lo[i] = p->hi[i] = mode == NS_LOWER ? p->lo[i] : p->hi[i];
    p->lo[m + i] = mode == NS_LOWER ? 0.0 : -INFINITY;
    p->hi[m + i] = mode == NS_LOWER ? INFINITY : 0.0;
}

/* T of the basis in which all y are basic. */
static void identity(ns_simplex *p) {
    size_t m = (size_t)p->m;
    memcpy(p->T, p->W, m * m * sizeof *p->T);
    memcpy(p->T + m * m, p->q, m * sizeof *p->T);
    for (int i = 0; i < p->m; i++) {
        p->rowvar[i] = p->m + i;
        p->colvar[i] = i;
        p->where[p->m + i] = i;
        p->where[i] = -1 - i;
    }
    p->since = 0;
}

void ns_mlcp_simplex_start(ns_mlcp_solver *s, ns_simplex *p) {
    int m = s->m, e = 0;
    double top = 0.0;
    *p = (ns_simplex){.m = m,
                      .W = s->A,
                      .q = s->blo,
                      .T = s->T,
                      .lo = s->xs,
                      .hi = s->xs + 2 * m,
                      .value = s->unit,
                      .price = s->beta,
                      .v = s->ray,
                      .weight = s->cover,
                      .rowvar = s->rowvar,
                      .colvar = s->colvar,
                      .where = s->where};
    ns_linalg_equilibrate(m, s->W, m, s->r, s->c, s->e);
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++) {
            size_t k = (size_t)i + (size_t)j * (size_t)m;
            p->W[k] = ldexp(s->W[k], s->r[i] + s->c[j]);
        }
    for (int i = 0; i < m; i++)
        top = fmax(top, fabs(ldexp(s->q[i], s->r[i])));
    if (top > 0.0)
        (void)frexp(top, &e);
    p->shift = e;
    for (int i = 0; i < m; i++) {
        p->q[i] = ldexp(s->q[i], s->r[i] - e);
        p->weight[i] = 0.0;
        ns_mlcp_simplex_release(s, p, i);
        p->value[i] = fmin(fmax(0.0, p->lo[i]), p->hi[i]);
    }
    identity(p);
}

static void exchange(ns_simplex *p, int row, int col) {
    const int m = p->m, in = p->colvar[col], out = p->rowvar[row];
    ns_linalg_exchange(m, m + 1, p->T, row, col, ZERO);
    p->rowvar[row] = in;
    p->colvar[col] = out;
    p->where[in] = row;
    p->where[out] = -1 - col;
    p->since++;
}

/* The tableau of the same basis anew, by elimination with complete pivoting; what cannot come in stays out.
 */
static void renew(ns_mlcp_solver *s, ns_simplex *p) {
    int m = p->m;
    int *want = s->queue; /* 1: lambda_j is to be basic; and of y_i: 2, it is not */
    for (int i = 0; i < m; i++)
        want[i] = (p->where[i] >= 0 ? 1 : 0) + (p->where[m + i] < 0 ? 2 : 0);
    identity(p);
    for (int step = 0; step < m; step++) {
        int br = -1, bc = -1;
        double best = PIVOT;
        for (int c = 0; c < m; c++)
            for (int r = 0; r < m; r++) {
                int y = p->rowvar[r] - m, x = p->colvar[c];
                if (y < 0 || x >= m || !(want[y] & 2) || !(want[x] & 1) || fabs(*entry(p, r, c)) <= best)
                    continue;
                best = fabs(*entry(p, r, c));
                br = r;
                bc = c;
            }
        if (br < 0)
            break;
        exchange(p, br, bc);
    }
    p->since = 0;
}

/* Nonbasic values into their bounds, basic ones from them; the largest of all. */
static double evaluate(ns_simplex *p) {
    int m = p->m;
    double top = 1.0;
    for (int c = 0; c < m; c++) {
        int var = p->colvar[c];
        double v = fmin(fmax(p->value[var], p->lo[var]), p->hi[var]);
        if (var >= m) /* a bound of y is 0 or none */
            v = 0.0;
        p->value[var] = v;
        top = fmax(top, fabs(v));
    }
    for (int r = 0; r < m; r++) {
        double sum = *entry(p, r, m);
        for (int c = 0; c < m; c++)
            sum += *entry(p, r, c) * p->value[p->colvar[c]];
        p->value[p->rowvar[r]] = sum;
        top = fmax(top, fabs(sum));
    }
    return top;
}

/* Which way a basic variable is outside its bounds: -1, 0, 1. */
static int side(const ns_simplex *p, int var, double tol) {
    return p->value[var] < p->lo[var] - tol ? -1 : p->value[var] > p->hi[var] + tol ? 1 : 0;
}

/* price = slope of the sum of violations along each nonbasic variable.  0: no violation. */
static int set_price(ns_simplex *p, double tol) {
    int any = 0;
    for (int c = 0; c < p->m; c++) {
        double sum = 0.0, size = 0.0;
        for (int r = 0; r < p->m; r++) {
            int g = side(p, p->rowvar[r], tol);
            sum += g * *entry(p, r, c);
            size += g ? fabs(*entry(p, r, c)) : 0.0;
            any |= g;
        }
        p->price[c] = fabs(sum) <= ZERO * size ? 0.0 : sum;
    }
    return any != 0;
}

/* The column to enter: the steepest, or (bland) the one of lowest number; -1: none. */
static int choose(const ns_simplex *p, int bland, double tol, double *dir) {
    int best = -1;
    double most = tol;
    for (int c = 0; c < p->m; c++) {
        int var = p->colvar[c];
        double g = p->price[c];
        int may = g < 0.0 ? p->value[var] < p->hi[var] : p->value[var] > p->lo[var];
        if (!may || fabs(g) <= most)
            continue;
        if (bland && best >= 0 && p->colvar[best] < var)
            continue;
        best = c;
        most = bland ? tol : fabs(g);
    }
    if (best >= 0)
        *dir = p->price[best] < 0.0 ? 1.0 : -1.0;
    return best;
}

/* How far column col may go until row r is at the next bound it comes to. */
static double reach(const ns_simplex *p, int r, double rate, double tol) {
    int var = p->rowvar[r], out = side(p, var, tol);
    double bound = rate > 0.0 ? (out < 0 ? p->lo[var] : p->hi[var]) : (out > 0 ? p->hi[var] : p->lo[var]);
    if (isinf(bound) || (rate > 0.0 && out > 0) || (rate < 0.0 && out < 0))
        return INFINITY;
    return fmax((bound - p->value[var]) / rate, 0.0);
}

/* The row that stops column col, of those that tie the one of largest pivot (bland: of lowest number); -1:
 * the other bound of the column does, -2: nothing. */
static int stop(const ns_simplex *p, int col, double dir, int bland, double tol, double *step) {
    const double *e = entry(p, 0, col);
    double big = 0.0, limit = p->hi[p->colvar[col]] - p->lo[p->colvar[col]], range = limit;
    int best = -1;
    for (int r = 0; r < p->m; r++)
        big = fmax(big, fabs(e[r]));
    for (int r = 0; r < p->m; r++)
        if (fabs(e[r]) > PIVOT * big)
            limit = fmin(limit, reach(p, r, dir * e[r], tol) + tol / fabs(e[r]));
    if (isinf(limit))
        return -2;
    for (int r = 0; r < p->m; r++) {
        if (fabs(e[r]) <= PIVOT * big || reach(p, r, dir * e[r], tol) > limit)
            continue;
        int better = best < 0 || (bland ? p->rowvar[r] < p->rowvar[best] : fabs(e[r]) > fabs(e[best]));
        best = better ? r : best;
    }
    *step = best < 0 || range < limit ? range : reach(p, best, dir * e[best], tol);
    return best < 0 || range < limit ? -1 : best;
}

static void advance(ns_simplex *p, int col, double dir, int row, double step, double tol) {
    int in = p->colvar[col];
    double rate = row >= 0 ? dir * *entry(p, row, col) : 0.0;
    p->value[in] += dir * step;
    if (row < 0)
        return;
    int out = p->rowvar[row], was = side(p, out, tol);
    double bound = rate > 0.0 ? (was < 0 ? p->lo[out] : p->hi[out]) : (was > 0 ? p->hi[out] : p->lo[out]);
    exchange(p, row, col);
    p->value[out] = bound;
}

/* The largest w x for x in [lo,hi], added to *most. */
static void add_most(double w, double lo, double hi, double *most, double *size) {
    if (w == 0.0)
        return;
    double part = w * (w > 0.0 ? hi : lo);
    *most += part;
    *size += fabs(part);
}

/* v of the prices at hand, and whether it proves from W, q and the bounds that there is no solution. */
static int proves(ns_simplex *p, double tol) {
    int m = p->m;
    double most = 0.0, size = 0.0, sum = 0.0, top = 0.0;
    for (int i = 0; i < m; i++) {
        int at = p->where[m + i];
        p->v[i] = at >= 0 ? side(p, m + i, tol) : -p->price[-1 - at];
        top = fmax(top, fabs(p->v[i]));
    }
    for (int i = 0; i < m; i++) { /* any v will do: rounding, and what has the wrong sign, is left out */
        double lo = p->lo[m + i], hi = p->hi[m + i];
        if (fabs(p->v[i]) <= ZERO * top || isinf(p->v[i] > 0.0 ? hi : lo))
            p->v[i] = 0.0;
        add_most(p->v[i], lo, hi, &most, &size);
        sum += p->v[i] * p->q[i];
        size += fabs(p->v[i] * p->q[i]);
    }
    for (int j = 0; j < m; j++) {
        double w = 0.0, terms = 0.0;
        for (int i = 0; i < m; i++) {
            double term = p->W[(size_t)i + (size_t)j * (size_t)m] * p->v[i];
            w -= term;
            terms += fabs(term);
        }
        add_most(fabs(w) <= CANCEL * terms ? 0.0 : w, p->lo[j], p->hi[j], &most, &size);
    }
    if (!(sum > most + MARGIN * size))
        return 0;
    for (int i = 0; i < m && top > 0.0; i++)
        p->weight[i] += fabs(p->v[i]) / top;
    return 1;
}

int ns_mlcp_simplex_run(ns_mlcp_solver *s, ns_simplex *p) {
    int limit = PIVOTS + PER_ROW * p->m, fresh = 0;
    for (int k = 0; k < limit; k++) {
        if (p->since >= AGAIN)
            renew(s, p);
        double tol = FEAS * evaluate(p), dir = 1.0, step = 0.0;
        int bland = k > limit / 2, broken = set_price(p, tol);
        int col = broken ? choose(p, bland, tol, &dir) : -1;
        int row = col >= 0 ? stop(p, col, dir, bland, tol, &step) : -2;
        if (row > -2) {
            advance(p, col, dir, row, step, tol);
            s->pivots++;
            fresh = 0;
            continue;
        }
        if (!broken && p->since == 0)
            return NS_OK;
        if (broken && proves(p, tol))
            return NS_E_INFEASIBLE;
        if (fresh)
            return broken ? NS_E_LIMIT : NS_OK;
        renew(s, p); /* once more on a tableau made anew */
        fresh = 1;
    }
    return NS_E_LIMIT;
}
