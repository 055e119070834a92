/* bridge/pure/piecewise.c - values of piecewise linear expressions, and the elements that they are made of.
 */
#include "piecewise_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- discrete values --- */

/* u where all these conditions hold, else 0. */
static ns_piecewise_value *where_all_hold(ns_piecewise *p, const ns_piecewise_value *of, int set,
                                          const ns_piecewise_value *u) {
    for (int k = 0; k < of->nconditions && u; k++)
        if (set & (1 << k))
            u = ns_bridge_piecewise_add_choice(p, of->condition[k], u);
    return (ns_piecewise_value *)u;
}

/* a times a discrete value. */
static ns_piecewise_value *times_table(ns_piecewise *p, const ns_piecewise_value *a,
                                       const ns_piecewise_value *v) {
    double sum[PIECEWISE_TABLE];
    v = a ? ns_bridge_piecewise_table_sum(p, v, ns_bridge_piecewise_size(p, a), sum) : NULL;
    if (!v)
        return NULL;
    ns_piecewise_value *total = ns_bridge_piecewise_sum(p, sum[0], a, 0.0, a);
    for (int set = 1; set < 1 << v->nconditions && total; set++)
        if (sum[set] != 0.0)
            total = ns_bridge_piecewise_sum(p, 1.0, total, sum[set], where_all_hold(p, v, set, a));
    return total;
}

/* As an affine value. */
static ns_piecewise_value *to_affine(ns_piecewise *p, const ns_piecewise_value *v) {
    if (!v || !v->is_discrete)
        return (ns_piecewise_value *)v;
    ns_piecewise_value *one = ns_bridge_piecewise_make(p, -1, 0);
    if (!one)
        return NULL;
    one->table[0] = 1.0;
    return times_table(p, one, v);
}

/* Makes *to depend on the conditions of v too, and *place (of each of v's) where they are; 0: there are too
 * many.
 */
static int join_conditions(ns_piecewise_value *to, const ns_piecewise_value *v, int *place) {
    for (int k = 0; k < v->nconditions; k++) {
        int at = 0;
        while (at < to->nconditions && to->condition[at] != v->condition[k])
            at++;
        if (at == PIECEWISE_CONDITIONS)
            return 0;
        to->condition[at] = v->condition[k];
        to->nconditions = at == to->nconditions ? at + 1 : to->nconditions;
        place[k] = at;
    }
    return 1;
}

static double table_at(const ns_piecewise_value *v, int set, const int *place) {
    int own = 0;
    for (int k = 0; k < v->nconditions; k++)
        own |= (set >> place[k] & 1) << k;
    return v->table[own];
}

/* f of discrete values (c: 0, or a third one that f does not see, which chooses a or b). */
static ns_piecewise_value *combine(ns_piecewise *p, double (*f)(double, double), const ns_piecewise_value *a,
                                   const ns_piecewise_value *b, const ns_piecewise_value *c) {
    ns_piecewise_value all = {0};
    int of_a[PIECEWISE_CONDITIONS], of_b[PIECEWISE_CONDITIONS], of_c[PIECEWISE_CONDITIONS];
    if (!join_conditions(&all, a, of_a) || !join_conditions(&all, b, of_b) ||
        (c && !join_conditions(&all, c, of_c)))
        return ns_bridge_piecewise_fail(p, NS_E_LIMIT, "it depends on more than 10 conditions at once");
    ns_piecewise_value *v = ns_bridge_piecewise_make(p, all.nconditions, 0);
    for (int set = 0; v && set < 1 << all.nconditions; set++) {
        const double x = table_at(a, set, of_a), y = table_at(b, set, of_b);
        v->table[set] = c ? (table_at(c, set, of_c) != 0.0 ? x : y) : f(x, y);
        if (!isfinite(v->table[set]))
            return ns_bridge_piecewise_fail(p, NS_E_NUMBER, "it is no finite number, under some condition");
    }
    if (v)
        memcpy(v->condition, all.condition, sizeof v->condition);
    return v;
}

ns_piecewise_value *ns_bridge_piecewise_map2(ns_piecewise *p, double (*f)(double, double),
                                             const ns_piecewise_value *a, const ns_piecewise_value *b) {
    if (a && b && !(a->is_discrete && b->is_discrete))
        return ns_bridge_piecewise_fail(p, NS_E_RANGE, "a function of a signal that is not piecewise linear");
    return a && b ? combine(p, f, a, b, NULL) : NULL;
}

ns_piecewise_value *ns_bridge_piecewise_map(ns_piecewise *p, double (*f)(double),
                                            const ns_piecewise_value *a) {
    if (a && !a->is_discrete)
        return ns_bridge_piecewise_fail(p, NS_E_RANGE, "a function of a signal that is not piecewise linear");
    ns_piecewise_value *v = a ? ns_bridge_piecewise_make(p, a->nconditions, 0) : NULL;
    for (int set = 0; v && set < 1 << a->nconditions; set++) {
        v->table[set] = f(a->table[set]);
        if (!isfinite(v->table[set]))
            return ns_bridge_piecewise_fail(p, NS_E_NUMBER, "it is no finite number, under some condition");
    }
    if (v)
        memcpy(v->condition, a->condition, sizeof v->condition);
    return v;
}

/* --- sums, products --- */

static double plus(double a, double b) {
    return a + b;
}

static double times(double a, double b) {
    return a * b;
}

static void add_term(ns_piecewise_value *v, ns_term t, double times_by) {
    for (int k = 0; k < v->nterms; k++)
        if (v->term[k].is_current == t.is_current && v->term[k].of == t.of) {
            v->term[k].gain += times_by * t.gain;
            return;
        }
    t.gain *= times_by;
    v->term[v->nterms++] = t;
}

static void drop_zeros(ns_piecewise_value *v) {
    int kept = 0;
    for (int k = 0; k < v->nterms; k++)
        if (v->term[k].gain != 0.0)
            v->term[kept++] = v->term[k];
    v->nterms = kept;
}

static ns_piecewise_value *scaled(ns_piecewise *p, double by, const ns_piecewise_value *a) {
    ns_piecewise_value *v = a ? ns_bridge_piecewise_make(p, a->nconditions, a->nterms) : NULL;
    for (int set = 0; v && set < (a->is_discrete ? 1 << a->nconditions : 1); set++)
        v->table[set] = by * a->table[set];
    for (int k = 0; v && k < a->nterms; k++)
        v->term[k] = (ns_term){a->term[k].is_current, a->term[k].of, by * a->term[k].gain};
    if (v)
        memcpy(v->condition, a->condition, sizeof v->condition);
    return v;
}

static ns_piecewise_value *sum_of_affine(ns_piecewise *p, double ca, const ns_piecewise_value *a, double cb,
                                         const ns_piecewise_value *b) {
    ns_piecewise_value *v = a && b ? ns_bridge_piecewise_make(p, -1, a->nterms + b->nterms) : NULL;
    if (!v)
        return NULL;
    v->nterms = 0;
    v->table[0] = ca * a->table[0] + cb * b->table[0];
    for (int k = 0; k < a->nterms; k++)
        add_term(v, a->term[k], ca);
    for (int k = 0; k < b->nterms; k++)
        add_term(v, b->term[k], cb);
    drop_zeros(v);
    return v;
}

ns_piecewise_value *ns_bridge_piecewise_sum(ns_piecewise *p, double ca, const ns_piecewise_value *a,
                                            double cb, const ns_piecewise_value *b) {
    if (!a || !b)
        return NULL;
    if (a->is_discrete && b->is_discrete && a->nconditions + b->nconditions <= PIECEWISE_CONDITIONS)
        return combine(p, plus, scaled(p, ca, a), scaled(p, cb, b), NULL);
    return sum_of_affine(p, ca, to_affine(p, a), cb, to_affine(p, b));
}

ns_piecewise_value *ns_bridge_piecewise_product(ns_piecewise *p, const ns_piecewise_value *a,
                                                const ns_piecewise_value *b) {
    double c;
    if (!a || !b)
        return NULL;
    if (ns_bridge_piecewise_is_constant(a, &c))
        return scaled(p, c, b);
    if (ns_bridge_piecewise_is_constant(b, &c))
        return scaled(p, c, a);
    if (a->is_discrete && b->is_discrete)
        return combine(p, times, a, b, NULL);
    if (b->is_discrete)
        return times_table(p, (ns_piecewise_value *)a, b);
    if (a->is_discrete)
        return times_table(p, (ns_piecewise_value *)b, a);
    return ns_bridge_piecewise_fail(p, NS_E_RANGE, "a product of two signals");
}

static double inverse(double a) {
    return 1.0 / a;
}

ns_piecewise_value *ns_bridge_piecewise_quotient(ns_piecewise *p, const ns_piecewise_value *a,
                                                 const ns_piecewise_value *b) {
    if (!a || !b)
        return NULL;
    if (!b->is_discrete)
        return ns_bridge_piecewise_fail(p, NS_E_RANGE, "a quotient by a signal");
    return ns_bridge_piecewise_product(p, a, ns_bridge_piecewise_map(p, inverse, b));
}

/* --- corners, conditions --- */

static double positive(double a) {
    return a > 0.0 ? a : 0.0;
}

static double is_above(double a) {
    return a > 0.0;
}

ns_piecewise_value *ns_bridge_piecewise_positive(ns_piecewise *p, const ns_piecewise_value *a) {
    if (!a)
        return NULL;
    if (!a->is_discrete && a->nterms > 0)
        return ns_bridge_piecewise_add_kink(p, a);
    if (!a->is_discrete)
        return ns_bridge_piecewise_constant(p, positive(a->table[0]));
    return ns_bridge_piecewise_map(p, positive, a);
}

static int has_values(const ns_piecewise_value *a) {
    for (int k = 0; k < a->nterms; k++)
        if (a->term[k].is_current == 2)
            return 1;
    return 0;
}

ns_piecewise_value *ns_bridge_piecewise_above(ns_piecewise *p, const ns_piecewise_value *a) {
    if (!a || a->is_discrete)
        return a ? ns_bridge_piecewise_map(p, is_above, a) : NULL;
    if (a->nterms == 0)
        return ns_bridge_piecewise_constant(p, is_above(a->table[0]));
    if (has_values(a))
        a = ns_bridge_piecewise_at_a_node(p, a);
    const int condition = a ? ns_bridge_piecewise_find_condition(p, a) : -1;
    ns_piecewise_value *v = condition >= 0 ? ns_bridge_piecewise_make(p, 1, 0) : NULL;
    if (v) {
        v->condition[0] = condition;
        v->table[1] = 1.0;
    }
    return v;
}

/* 1 where it is not 0. */
static double is_not_zero(double a) {
    return a != 0.0;
}

static double is_zero(double a) {
    return a == 0.0;
}

/* base + (other - base) where it holds: the smaller one is the base, if the other would lose it. */
ns_piecewise_value *ns_bridge_piecewise_choose(ns_piecewise *p, const ns_piecewise_value *condition,
                                               const ns_piecewise_value *a, const ns_piecewise_value *b) {
    if (!condition || !a || !b)
        return NULL;
    if (!condition->is_discrete)
        condition = ns_bridge_piecewise_sum(
            p, 1.0, ns_bridge_piecewise_above(p, condition), 1.0,
            ns_bridge_piecewise_above(p, ns_bridge_piecewise_sum(p, -1.0, condition, 0.0, condition)));
    if (!condition)
        return NULL;
    if (a->is_discrete && b->is_discrete &&
        a->nconditions + b->nconditions + condition->nconditions <= PIECEWISE_CONDITIONS)
        return combine(p, plus, a, b, condition);
    const ns_piecewise_value *by = ns_bridge_piecewise_map(p, is_not_zero, condition), *base = b, *other = a;
    if (ns_bridge_piecewise_beside(p, b, a) > PIECEWISE_SPREAD_KEPT &&
        ns_bridge_piecewise_beside(p, a, b) < ns_bridge_piecewise_beside(p, b, a)) {
        by = ns_bridge_piecewise_map(p, is_zero, condition);
        base = a;
        other = b;
    }
    if (ns_bridge_piecewise_beside(p, base, other) > PIECEWISE_SPREAD_MAX)
        return ns_bridge_piecewise_fail_spread(p);
    ns_piecewise_value *difference = ns_bridge_piecewise_sum(p, 1.0, other, -1.0, base);
    return ns_bridge_piecewise_sum(p, 1.0, base, 1.0, ns_bridge_piecewise_product(p, difference, by));
}

static double slope_of(const double *v, int k) {
    return (v[2 * k + 3] - v[2 * k + 1]) / (v[2 * k + 2] - v[2 * k]);
}

/* a - x */
static ns_piecewise_value *less(ns_piecewise *p, const ns_piecewise_value *a, double x) {
    return ns_bridge_piecewise_sum(p, 1.0, a, -x, ns_bridge_piecewise_constant(p, 1.0));
}

/* 1 if the ramps of a line that bends at its corners are so large, 1 V or the width of the line beyond them,
 * that their rounding is one of the values. */
static int is_steep(int n, const double *v, int ends_level) {
    double ramps = 0.0, largest = 0.0, before = ends_level ? 0.0 : slope_of(v, 0);
    for (int k = 0; k < n; k++) {
        const double after = k + 1 < n ? slope_of(v, k) : ends_level ? 0.0 : before;
        ramps += fabs(after - before) * fmax(1.0, v[2 * n - 2] - v[2 * k]);
        largest = fmax(largest, fabs(v[2 * k + 1]));
        before = after;
    }
    return ramps > PIECEWISE_SPREAD_KEPT * largest;
}

/* The line as what each of its pieces adds, which stays exactly what it is beyond the piece: w - max(w - x,
 * 0) of a piece of width w.  Twice as many kinks. */
static ns_piecewise_value *steep_line(ns_piecewise *p, const ns_piecewise_value *a, int n, const double *v,
                                      int ends_level) {
    ns_piecewise_value *y = ns_bridge_piecewise_constant(p, v[1]);
    for (int k = 0; k + 1 < n && y; k++) {
        const double width = v[2 * k + 2] - v[2 * k];
        ns_piecewise_value *x = less(p, a, v[2 * k]);
        if (v[2 * k + 3] == v[2 * k + 1])
            continue;
        x = k > 0 || ends_level ? ns_bridge_piecewise_positive(p, x) : x;
        if (k + 2 < n || ends_level) {
            ns_piecewise_value *left = ns_bridge_piecewise_sum(p, -1.0, less(p, x, width), 0.0, x);
            x = ns_bridge_piecewise_sum(p, -1.0, less(p, ns_bridge_piecewise_positive(p, left), width), 0.0,
                                        x);
        }
        y = ns_bridge_piecewise_sum(p, 1.0, y, slope_of(v, k), x);
    }
    return y;
}

ns_piecewise_value *ns_bridge_piecewise_line(ns_piecewise *p, const ns_piecewise_value *a, int n,
                                             const double *v, int ends_level) {
    double before = ends_level ? 0.0 : slope_of(v, 0);
    if (is_steep(n, v, ends_level))
        return steep_line(p, a, n, v, ends_level);
    ns_piecewise_value *at = less(p, a, v[0]);
    ns_piecewise_value *y =
        ns_bridge_piecewise_sum(p, before, at, v[1], ns_bridge_piecewise_constant(p, 1.0));
    for (int k = ends_level ? 0 : 1; k < (ends_level ? n : n - 1) && y; k++) {
        const double after = k + 1 < n ? slope_of(v, k) : 0.0;
        at = less(p, a, v[2 * k]);
        if (after != before)
            y = ns_bridge_piecewise_sum(p, 1.0, y, after - before, ns_bridge_piecewise_positive(p, at));
        before = after;
    }
    return y;
}

int ns_bridge_piecewise_affine(ns_piecewise *p, const ns_piecewise_value *v, ns_affine *out) {
    const ns_piecewise_value *a = to_affine(p, v);
    if (a)
        *out = (ns_affine){a->table[0], a->nterms, a->term};
    return a != NULL;
}
