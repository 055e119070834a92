/* src/mlcp/infeasible/phase1.c - how close the linear constraints of a problem can be met.
 *
 * Complementarity left aside, a solution satisfies
 *     y = W lambda + q,  l <= lambda <= u,  y_i = 0 (free),  y_i >= 0 (u = inf),  y_i <= 0 (l = -inf)
 * Phase 1 of the simplex method, from nothing: y is basic, lambda rests at a bound (free: at 0).  The sum of
 * the amounts by which basic variables are outside their bounds is made least, in units in which the entries
 * of W are about 1.  Free lambda come in first, by elimination with complete pivoting, so that no basis need
 * hold all equalities: those that depend on others stay basic, inside their bounds or not.
 * With each entry goes the largest term it was ever summed from (reveal.c): rounding is told from an entry
 * that is small in its own right.
 */
#include "phase1.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const double SOUND = 1e-10; /* a pivot, of the terms it came from */
static const double NEAR = 1e-12;  /* of the terms of a value: inside its bounds */
static const double DULL = 1e-12;  /* a reduced cost below this part of its terms is 0 */
static const double AN_ENTRY = 12; /* instructions for it in an exchange, with what led to that */
enum { NONE = -1, FLIP = -2 };
enum { RENEW = 40 }; /* exchanges after which the tableau is made anew: entries lose a digit in some ten */

static double lower(const ns_phase1 *z, int var) {
    const int i = var / 2;
    const ns_mode mode = z->mode[i];
    if (var % 2 == 0)
        return mode == NS_UPPER ? z->s->tab.hi[i] : z->s->tab.lo[i];
    return ns_mlcp_least_y(z->s->p, i, mode);
}

static double upper(const ns_phase1 *z, int var) {
    const int i = var / 2;
    const ns_mode mode = z->mode[i];
    if (var % 2 == 0)
        return mode == NS_LOWER ? z->s->tab.lo[i] : z->s->tab.hi[i];
    return ns_mlcp_most_y(z->s->p, i, mode);
}

/* Value of a nonbasic variable. */
static double nonbasic_value(const ns_phase1 *z, int var) {
    const double lo = lower(z, var), hi = upper(z, var);
    if (var % 2 == 1 || (isinf(lo) && isinf(hi)))
        return 0.0;
    return isinf(lo) || (z->s->tab.at_upper[var / 2] && !isinf(hi)) ? hi : lo;
}

static void load_bounds(ns_phase1 *z) {
    ns_mlcp_solver *s = z->s;
    for (int j = 0; j < s->m; j++) {
        s->tab.lo[j] = ldexp(s->p->l[j], -s->elim.col_exp[j]);
        s->tab.hi[j] = ldexp(s->p->u[j], -s->elim.col_exp[j]);
        s->tab.at_upper[j] = fabs(s->tab.hi[j]) < fabs(s->tab.lo[j]);
    }
}

/* y basic but for those that may have any value: of fixed lambda, and of boxes that no mode is asked of. */
static void load_tableau(ns_phase1 *z) {
    ns_mlcp_solver *s = z->s;
    z->rows = z->cols = 0;
    for (int i = 0; i < s->m; i++) {
        if (isinf(s->p->l[i]) || isinf(s->p->u[i]) || (z->boxes && s->p->l[i] != s->p->u[i]))
            s->tab.rowvar[z->rows++] = 2 * i + 1;
        if (s->p->l[i] != s->p->u[i])
            s->tab.colvar[z->cols++] = 2 * i;
    }
    for (int r = 0; r < z->rows; r++) {
        z->value[r] = ldexp(s->q[s->tab.rowvar[r] / 2], s->elim.row_exp[s->tab.rowvar[r] / 2]);
        z->size[r] = fabs(z->value[r]);
    }
    for (int c = 0; c < z->cols; c++) {
        int j = s->tab.colvar[c] / 2;
        double rest = nonbasic_value(z, 2 * j);
        for (int r = 0; r < z->rows; r++) {
            int i = s->tab.rowvar[r] / 2;
            size_t k = (size_t)r + (size_t)c * (size_t)s->m;
            s->elim.A[k] =
                ldexp(s->p->W[(size_t)i + (size_t)j * (size_t)s->m], s->elim.row_exp[i] + s->elim.col_exp[j]);
            s->elim.mag[k] = fabs(s->elim.A[k]);
            z->value[r] += s->elim.A[k] * rest;
            z->size[r] = fmax(z->size[r], s->elim.mag[k] * fabs(rest));
        }
    }
}

/* Moves nonbasic variable c: all basic values follow. */
static void move_nonbasic(ns_phase1 *z, int c, double by) {
    const size_t k = (size_t)c * (size_t)z->s->m;
    const double *a = z->s->elim.A + k, *mag = z->s->elim.mag + k;
    for (int r = 0; r < z->rows; r++) {
        z->value[r] += a[r] * by;
        z->size[r] = fmax(z->size[r], mag[r] * fabs(by));
    }
}

/* One column of an exchange: entry p of it is divided, the others follow. */
static void update_column(const ns_phase1 *z, int p, const double *e, const double *emag, double pivot,
                          double *a, double *mag) {
    double f = a[p] / pivot, fmag = mag[p] / fabs(pivot);
    if (f != 0.0)
        for (int r = 0; r < z->rows; r++) {
            if (r == p || e[r] == 0.0)
                continue;
            a[r] -= e[r] * f;
            mag[r] = fmax(mag[r], fmax(emag[r] * fabs(f), fabs(e[r]) * fmag));
            if (fabs(a[r]) <= 4 * DBL_EPSILON * mag[r])
                a[r] = 0.0;
        }
    a[p] = -f;
    mag[p] = fmag;
}

static void exchange(ns_phase1 *z, int p, int c) {
    ns_mlcp_solver *s = z->s;
    const size_t m = (size_t)s->m;
    double *e = s->elim.A + (size_t)c * m, *emag = s->elim.mag + (size_t)c * m, pivot = e[p];
    for (int k = 0; k < z->cols; k++)
        if (k != c)
            update_column(z, p, e, emag, pivot, s->elim.A + (size_t)k * m, s->elim.mag + (size_t)k * m);
    for (int r = 0; r < z->rows; r++) {
        e[r] /= pivot;
        emag[r] /= fabs(pivot);
    }
    e[p] = emag[p] = 1.0 / pivot;
    emag[p] = fabs(emag[p]);
    int var = s->tab.rowvar[p];
    s->tab.rowvar[p] = s->tab.colvar[c];
    s->tab.colvar[c] = var;
    z->pivots++;
    s->searched += AN_ENTRY * z->rows * z->cols;
}

/* Row p goes to `to` and out, column c comes in. */
static void swap_row_and_column(ns_phase1 *z, int p, int c, double to) {
    const size_t k = (size_t)p + (size_t)c * (size_t)z->s->m;
    double by = (to - z->value[p]) / z->s->elim.A[k];
    double value = nonbasic_value(z, z->s->tab.colvar[c]) + by,
           size = fmax(fabs(value), z->size[p] / fabs(z->s->elim.A[k]));
    move_nonbasic(z, c, by);
    exchange(z, p, c);
    z->value[p] = value;
    z->size[p] = size;
}

/* Brings lambda_j with enter[j] in for y_i with leave[i], largest pivots first, as many as there are. */
static void bring_in(ns_phase1 *z, const unsigned char *leave, const unsigned char *enter) {
    const ns_mlcp_solver *s = z->s;
    for (int step = 0; step < z->rows; step++) {
        int bp = NONE, bc = NONE;
        double best = 0.0;
        for (int c = 0; c < z->cols; c++)
            for (int r = 0; s->tab.colvar[c] % 2 == 0 && enter[s->tab.colvar[c] / 2] && r < z->rows; r++) {
                size_t k = (size_t)r + (size_t)c * (size_t)s->m;
                if (s->tab.rowvar[r] % 2 == 0 || !leave[s->tab.rowvar[r] / 2] ||
                    !(fabs(s->elim.A[k]) > best) || !(fabs(s->elim.A[k]) > SOUND * s->elim.mag[k]))
                    continue;
                best = fabs(s->elim.A[k]);
                bp = r;
                bc = c;
            }
        if (bp < 0)
            return;
        swap_row_and_column(z, bp, bc, 0.0);
    }
}

/* The tableau of the same basis made anew from W and q. */
static void remake_tableau(ns_phase1 *z) {
    ns_mlcp_solver *s = z->s;
    memset(s->elim.rowdone, 0, (size_t)s->m);
    memset(s->elim.coldone, 0, (size_t)s->m);
    for (int c = 0; c < z->cols; c++)
        if (s->tab.colvar[c] % 2 == 1)
            s->elim.rowdone[s->tab.colvar[c] / 2] = 1;
    for (int r = 0; r < z->rows; r++)
        if (s->tab.rowvar[r] % 2 == 0)
            s->elim.coldone[s->tab.rowvar[r] / 2] = 1;
    load_tableau(z);
    bring_in(z, s->elim.rowdone, s->elim.coldone);
    z->pivots = 0;
}

/* Which rows are outside, which way; how many. */
static int measure_violations(ns_phase1 *z) {
    int count = 0;
    for (int r = 0; r < z->rows; r++) {
        double below = lower(z, z->s->tab.rowvar[r]) - z->value[r];
        double above = z->value[r] - upper(z, z->s->tab.rowvar[r]);
        int var = z->s->tab.rowvar[r],
            empty = var % 2 == 1 && z->s->units.rowmax[var / 2] == 0.0; /* y = q: exact */
        double near = NEAR * (empty ? z->size[r] : fmax(z->size[r], z->least));
        z->side[r] = below > near ? -1.0 : above > near ? 1.0 : 0.0;
        count += z->side[r] != 0.0;
    }
    return count;
}

/* Reduced cost of column c, 0 where it is rounding. */
static double reduced_cost(const ns_phase1 *z, int c) {
    const size_t k = (size_t)c * (size_t)z->s->m;
    double sum = 0.0, size = 0.0;
    for (int r = 0; r < z->rows; r++)
        if (z->side[r] != 0.0) {
            sum += z->side[r] * z->s->elim.A[k + (size_t)r];
            size += z->s->elim.mag[k + (size_t)r];
        }
    return fabs(sum) > DULL * size ? sum : 0.0;
}

static void price_columns(ns_phase1 *z) {
    for (int c = 0; c < z->cols; c++)
        z->cost[c] = reduced_cost(z, c);
}

/* The column by which the sum falls fastest, NONE: it is least. */
static int choose_column(const ns_phase1 *z) {
    const ns_mlcp_solver *s = z->s;
    int best = NONE;
    for (int c = 0; c < z->cols; c++) {
        int var = s->tab.colvar[c];
        double d = z->cost[c], rest = nonbasic_value(z, var);
        if (d == 0.0 || (d < 0.0 ? upper(z, var) <= rest : lower(z, var) >= rest))
            continue;
        if (best < 0 || fabs(d) > fabs(z->cost[best]))
            best = c;
    }
    return best;
}

/* Where column c, moving by dir, takes row r past its bounds: at[0] lower, at[1] upper. */
static void passed_bounds(const ns_phase1 *z, int r, double rate, double *at) {
    double lo = lower(z, z->s->tab.rowvar[r]), hi = upper(z, z->s->tab.rowvar[r]),
           way = rate > 0.0 ? 1.0 : -1.0;
    at[0] = at[1] = INFINITY;
    if (z->side[r] * way > 0.0 || rate == 0.0)
        return;
    if ((way < 0.0 || z->side[r] != 0.0) && isfinite(lo))
        at[0] = fmax(0.0, (lo - z->value[r]) / rate);
    if ((way > 0.0 || z->side[r] != 0.0) && isfinite(hi))
        at[1] = fmax(0.0, (hi - z->value[r]) / rate);
}

/* Along column c the sum falls at `slope`, less at every bound that is passed, as long as that is below 0.
 * The last bound passed is where to stop.  Its row (*high: upper bound), FLIP: c's own other bound, NONE:
 * nothing. */
static int choose_row(ns_phase1 *z, int c, double dir, double slope, int *high) {
    const ns_mlcp_solver *s = z->s;
    const double *e = s->elim.A + (size_t)c * (size_t)s->m, *mag = s->elim.mag + (size_t)c * (size_t)s->m;
    double range = upper(z, s->tab.colvar[c]) - lower(z, s->tab.colvar[c]), *at = s->xs;
    int best = NONE;
    for (int r = 0; r < z->rows; r++)
        passed_bounds(z, r, fabs(e[r]) > SOUND * mag[r] ? dir * e[r] : 0.0, at + (size_t)2 * (size_t)r);
    for (int pass = 0; pass < 2 * z->rows && slope < 0.0; pass++) {
        int k = 0;
        for (int i = 1; i < 2 * z->rows; i++)
            if (at[i] < at[k])
                k = i;
        if (!(at[k] < range))
            return isfinite(range) ? FLIP : best;
        at[k] = INFINITY;
        slope += fabs(e[k / 2]);
        best = k / 2;
        *high = k % 2;
    }
    return best;
}

static int move_column(ns_phase1 *z, int c) {
    int var = z->s->tab.colvar[c], high = 0;
    double dir = z->cost[c] < 0.0 ? 1.0 : -1.0;
    int r = choose_row(z, c, dir, -fabs(z->cost[c]), &high);
    if (r == NONE)
        return 0;
    if (r == FLIP) {
        move_nonbasic(z, c, dir * (upper(z, var) - lower(z, var)));
        z->s->tab.at_upper[var / 2] = (signed char)!z->s->tab.at_upper[var / 2];
        return 1;
    }
    int out = z->s->tab.rowvar[r];
    if (out % 2 == 0)
        z->s->tab.at_upper[out / 2] = (signed char)high;
    swap_row_and_column(z, r, c, high ? upper(z, out) : lower(z, out));
    return 1;
}

/* One step; 0: the sum is least.  Where nothing would stop it the reduced cost is rounding, for the sum is
 * never below 0. */
static int step_down(ns_phase1 *z) {
    const int c = choose_column(z);
    return c >= 0 && move_column(z, c);
}

void ns_mlcp_phase1_start(ns_phase1 *z, ns_mlcp_solver *s, int boxes, double floor) {
    *z = (ns_phase1){.s = s,
                     .boxes = boxes,
                     .most = INFINITY,
                     .mode = s->kept.mode,
                     .value = s->tab.beta,
                     .size = s->ysize,
                     .side = s->lsize,
                     .cost = s->tab.cover};
    memset(z->mode, NS_OPEN, (size_t)s->m);
    ns_linalg_equilibrate(s->m, s->p->W, s->m, s->elim.row_exp, s->elim.col_exp, s->elim.e);
    load_bounds(z);
    load_tableau(z);
    for (int r = 0; r < z->rows; r++)
        z->least = fmax(z->least, s->units.rowmax[s->tab.rowvar[r] / 2] > 0.0 ? floor * z->size[r] : 0.0);
    memset(s->elim.rowdone, 0, (size_t)s->m);
    for (int f = 0; f < s->nf; f++)
        s->elim.rowdone[s->free[f]] = 1;
    bring_in(z, s->elim.rowdone, s->elim.rowdone);
}

void ns_mlcp_phase1_put(ns_phase1 *z, int i, ns_mode mode) {
    const double before = nonbasic_value(z, 2 * i);
    z->mode[i] = mode;
    const double by = nonbasic_value(z, 2 * i) - before;
    for (int c = 0; c < z->cols; c++)
        if (z->s->tab.colvar[c] == 2 * i && by != 0.0)
            move_nonbasic(z, c, by);
}

int ns_mlcp_phase1_run(ns_phase1 *z) {
    for (int it = 0; it < PIVOTS_FLAT + PIVOTS_PER_PAIR * z->s->m; it++) {
        if (z->s->searched > z->most) {
            z->s->cut_off = 1;
            return NS_E_LIMIT;
        }
        if (z->pivots >= RENEW)
            remake_tableau(z);
        if (measure_violations(z) == 0)
            return NS_OK;
        price_columns(z);
        int moved = step_down(z);
        if (!moved && z->pivots == 0)
            return NS_E_INFEASIBLE;
        if (!moved)
            remake_tableau(z);
    }
    return NS_E_LIMIT;
}

void ns_mlcp_phase1_read(const ns_phase1 *z, double *value, int *basic) {
    const ns_mlcp_solver *s = z->s;
    for (int i = 0; i < s->m; i++) { /* fixed: lambda is in q */
        value[2 * i] = value[2 * i + 1] = 0.0;
        basic[2 * i] = 0;
        basic[2 * i + 1] = 1;
    }
    for (int r = 0; r < z->rows; r++) {
        value[s->tab.rowvar[r]] = z->value[r];
        basic[s->tab.rowvar[r]] = 1;
    }
    for (int c = 0; c < z->cols; c++) {
        value[s->tab.colvar[c]] = nonbasic_value(z, s->tab.colvar[c]);
        basic[s->tab.colvar[c]] = 0;
    }
}
