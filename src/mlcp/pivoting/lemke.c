/* src/mlcp/pivoting/lemke.c - Lemke's method on the tableau of the pairs, boxes and degenerate ties included.
 *
 * A variable t >= 0 is added to the basic variables, basic = beta + T nonbasic + d t, where d > 0 pushes a
 * variable into its bounds.  With t large enough all guards hold; then t is driven to 0 along
 * the path on which every pair but one is complementary:
 *   y_a reaches 0           -> lambda_a leaves its bound
 *   lambda_a reaches l, u   -> y_a leaves 0 upwards, downwards
 *   t reaches 0             -> solved
 * (Cottle, Pang, Stone, "The Linear Complementarity Problem", 4.4; boxes as in Dirkse, Ferris, "PATH".)
 *
 * Ties: bound k is thought shifted by eps^k, eps positive and arbitrarily small: each basic variable v_k of
 * the start has v_k + eps^k in place of v_k.  Of the rows that tie, the one whose step is smallest as a
 * polynomial in eps leaves.  No two rows tie then, so no basis comes twice.  The coefficients are columns of
 * the present tableau: T[r,c] where v_k is nonbasic in column c.
 */
#include <math.h>
#include <string.h>

#include "mlcp/mlcp_internal.h"

static const double TIE =
    1e-12; /* of a size: rounding of a sum is 1e-16 of it times some hundred operations */
enum { RAY = -1, FLIP = -2 };

/* The variable that may move when var has stopped at a bound, and which way. */
static int complement(const ns_mlcp_solver *s, int var, double *dir) {
    *dir = s->tab.at_upper[var / 2] ? -1.0 : 1.0;
    return var ^ 1;
}

/* How far a basic variable is outside its bounds; *side gets +1 (below) or -1 (above). */
static double amount_outside(const ns_mlcp_solver *s, int r, double *side) {
    double below = ns_mlcp_tableau_lower(s, s->tab.rowvar[r]) - s->tab.beta[r];
    double above = s->tab.beta[r] - ns_mlcp_tableau_upper(s, s->tab.rowvar[r]);
    *side = below >= above ? 1.0 : -1.0;
    return below >= above ? below : above;
}

/* Of cover number `all`: any positive numbers will do, other ones lead another way. */
static double weight(int r, int all) {
    const double golden = 0.6180339887498949, x = golden * (double)(r + 1) * (double)(all - 1);
    return 1.0 + 9.0 * (x - floor(x));
}

/* Column of t: d in the units of the rows, and as s->tab.cover in terms of W and q. */
static void set_cover(ns_mlcp_solver *s, int all) {
    int n = s->np;
    double *d = s->tab.T + (size_t)n * (size_t)n;
    s->tab.colvar[n] = 2 * n;
    s->tab.ncol = n + 1;
    memset(s->tab.cover, 0, (size_t)s->m * sizeof *s->tab.cover);
    for (int r = 0; r < n; r++) {
        double side, v = amount_outside(s, r, &side);
        int two = s->tab.rowvar[r] % 2 == 0 && isfinite(s->tab.lo[r]) && isfinite(s->tab.hi[r]);
        d[r] = v > 0.0 || (all && !two) ? side : 0.0;
        if (all)
            d[r] *= weight(r, all);
        double shift = d[r] * s->tab.unit[s->tab.rowvar[r]];
        int i = s->pair[r];
        if (shift == 0.0)
            continue;
        if (s->tab.rowvar[r] % 2 == 1)
            s->tab.cover[i] += shift;
        else {
            shift = -shift;
            ns_linalg_matvec_add(s->m, 1, s->W + (size_t)i * (size_t)s->m, &shift, s->tab.cover);
        }
    }
}

/* The row that needs the largest t; of equals, the one whose shift eps^k makes it need most. */
static int first_row(const ns_mlcp_solver *s, double *t) {
    const double *d = s->tab.T + (size_t)s->np * (size_t)s->np;
    int best = -1;
    *t = 0.0;
    for (int r = 0; r < s->np; r++) {
        double side, v = amount_outside(s, r, &side);
        if (!(v > 0.0))
            continue;
        v /= fabs(d[r]);
        int tie = best >= 0 && v >= *t * (1.0 - TIE) && d[best] > 0.0;
        if (v > *t * (1.0 + TIE) || tie)
            best = r;
        *t = fmax(*t, v);
    }
    return best;
}

/* Coefficient of eps^k in the distance that row r (FLIP: the entering variable) may still go. */
static double shift_of(const ns_mlcp_solver *s, int r, int k, double way) {
    if (r == FLIP)
        return 0.0;
    int at = s->tab.where[2 * k + s->tab.first_y[k]];
    double c = at >= 0 ? (at == r ? 1.0 : 0.0) : -s->tab.T[r + (-1 - at) * s->np];
    return way < 0.0 ? c : -c; /* moving down, the distance is beta - lower; up, upper - beta */
}

/* 1 if candidate r (moving at rate dr) stops before candidate b (rate db) in the shifted problem. */
static int stops_before(const ns_mlcp_solver *s, int r, double dr, int b, double db) {
    for (int k = 0; k < s->np; k++) {
        double x = shift_of(s, r, k, dr) / fabs(dr), y = shift_of(s, b, k, db) / fabs(db);
        if (fabs(x - y) > 1e-9 * (fabs(x) + fabs(y)))
            return x < y;
    }
    return 0;
}

static double room_to_bound(const ns_mlcp_solver *s, int r, double rate) {
    double v = rate < 0.0 ? s->tab.beta[r] - ns_mlcp_tableau_lower(s, s->tab.rowvar[r])
                          : ns_mlcp_tableau_upper(s, s->tab.rowvar[r]) - s->tab.beta[r];
    return v > 0.0 ? v : 0.0;
}

/* Of the rows that reach a bound within limit the one that leaves: the first in the shifted problem.  free
 * (np): how far each may go.  FLIP: the entering variable's own other bound, RAY: none. */
static int leaving_row(const ns_mlcp_solver *s, const double *e, double dir, const double *free, double limit,
                       int best) {
    double rate = 1.0;
    for (int r = 0; r < s->np; r++) {
        if (e[r] == 0.0 || !(free[r] <= limit * fabs(e[r])))
            continue;
        if (s->tab.rowvar[r] == 2 * s->np)
            return r; /* t = 0 ends the search: it goes first */
        if (best == RAY || stops_before(s, r, dir * e[r], best, rate)) {
            best = r;
            rate = dir * e[r];
        }
    }
    return best;
}

/* Ratio test for column col moving in direction dir; range: how far the entering variable may go by itself.
 * Returns the row that stops it, FLIP, or RAY; *step gets the distance. */
static int ratio_test(ns_mlcp_solver *s, int col, double dir, double range, double *step) {
    const double *e = s->tab.T + (size_t)col * (size_t)s->np;
    double limit = range, *free = s->rhs; /* how far a row may go */
    for (int r = 0; r < s->np; r++)
        if (e[r] != 0.0) {
            free[r] = room_to_bound(s, r, dir * e[r]);
            if (free[r] + TIE < limit * fabs(e[r]))
                limit = (free[r] + TIE) / fabs(e[r]);
        }
    if (isinf(limit))
        return RAY;
    int best = leaving_row(s, e, dir, free, limit, range <= limit ? FLIP : RAY);
    *step = best == FLIP ? range : free[best] / fabs(e[best]);
    return best;
}

/* Moves the entering variable: all basic values follow. */
static void move_entering(ns_mlcp_solver *s, int col, double by) {
    const double *e = s->tab.T + (size_t)col * (size_t)s->np;
    for (int r = 0; r < s->np; r++)
        s->tab.beta[r] += e[r] * by;
}

/* Value of a nonbasic variable in its unit. */
static double nonbasic_value(const ns_mlcp_solver *s, int var) {
    if (var == 2 * s->np || var % 2 == 1)
        return 0.0;
    return s->tab.at_upper[var / 2] ? s->tab.hi[var / 2] : s->tab.lo[var / 2];
}

/* The pairs that move along a ray, largest first. */
static void name_ray(ns_mlcp_solver *s, int col) {
    const double *e = s->tab.T + (size_t)col * (size_t)s->np;
    memset(s->ray, 0, (size_t)s->np * sizeof *s->ray);
    for (int r = 0; r < s->np; r++)
        if (s->tab.rowvar[r] != 2 * s->np)
            s->ray[s->tab.rowvar[r] / 2] = fabs(e[r]);
    s->ray[s->tab.colvar[col] / 2] = fmax(1.0, s->ray[s->tab.colvar[col] / 2]);
    ns_mlcp_name(s, s->ray, s->np, s->pair);
}

static void read_mode(ns_mlcp_solver *s) {
    for (int a = 0; a < s->np; a++) {
        ns_mode bound = s->tab.at_upper[a] ? NS_UPPER : NS_LOWER;
        s->mode[s->pair[a]] = s->tab.where[2 * a] >= 0 ? NS_INSIDE : bound;
    }
}

/* Row r stops at a bound: it leaves, column col enters with value. */
static int exchange_leaving(ns_mlcp_solver *s, int r, int col, double rate, double value) {
    int out = s->tab.rowvar[r];
    if (out % 2 == 0 && out != 2 * s->np)
        s->tab.at_upper[out / 2] = rate > 0.0;
    ns_mlcp_tableau_exchange(s, r, col);
    s->tab.beta[r] = value;
    return out;
}

int ns_mlcp_lemke(ns_mlcp_solver *s, int all, int limit_factor) {
    double t, dir, step;
    const int n = s->np, limit = limit_factor * (PIVOTS_FLAT + PIVOTS_PER_PAIR * n);
    const int fresh = n > NS_QUICK ? n : NS_QUICK; /* made anew it costs as much as some n exchanges */
    set_cover(s, all);
    int r = first_row(s, &t);
    if (r < 0)
        return NS_OK;
    move_entering(s, n, t);
    double rate = -s->tab.T[r + n * n]; /* t falls from now on */
    int enter = complement(s, exchange_leaving(s, r, n, rate, t), &dir);
    for (int it = 1; it <= limit; it++) {
        int col = -1 - s->tab.where[enter], a = enter / 2;
        double range = enter % 2 == 0 ? s->tab.hi[a] - s->tab.lo[a] : INFINITY;
        r = ratio_test(s, col, dir, range, &step);
        if (r == RAY) {
            name_ray(s, col);
            return NS_E_INFEASIBLE;
        }
        s->pivots++;
        rate = r >= 0 ? dir * s->tab.T[r + col * n] : 0.0;
        move_entering(s, col, dir * step);
        if (r == FLIP) {
            s->tab.at_upper[a] = (signed char)!s->tab.at_upper[a];
            enter = complement(s, enter, &dir);
            continue;
        }
        int out = exchange_leaving(s, r, col, rate, nonbasic_value(s, enter) + dir * step);
        if (out == 2 * n) {
            read_mode(s);
            return NS_OK;
        }
        enter = complement(s, out, &dir);
        if (it % fresh == 0 && ns_mlcp_tableau_refresh(s) != NS_OK)
            return NS_E_SINGULAR;
    }
    return NS_E_LIMIT;
}
