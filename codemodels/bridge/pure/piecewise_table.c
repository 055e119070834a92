/* bridge/pure/piecewise_table.c - a table over conditions as a sum of choices, in which no value is lost. */
#include "piecewise_internal.h"

#include <math.h>
#include <string.h>

enum { PASSES = 2 };

ns_piecewise_value *ns_bridge_piecewise_fail_spread(ns_piecewise *p) {
    p->instead = p->status ? p->instead : "give values that are less far apart";
    return ns_bridge_piecewise_fail(
        p, NS_E_RANGE, "one value is more than 1e9 times as large as another, which is lost in their sum");
}

/* --- which sets of conditions can hold --- */

/* 1 if a has the terms of b times the sign. */
static int has_terms(const ns_piecewise_condition *a, double sign, const ns_piecewise_condition *b) {
    int same = a->nterms == b->nterms;
    for (int k = 0; k < a->nterms && same; k++)
        same = a->term[k].is_current == b->term[k].is_current && a->term[k].of == b->term[k].of &&
               a->term[k].gain == sign * b->term[k].gain;
    return same;
}

/* 1 if a holds wherever b does: they have the same terms, and a is the weaker one. */
static int follows(const ns_piecewise_condition *a, const ns_piecewise_condition *b) {
    return a->constant - a->threshold >= b->constant - b->threshold && has_terms(a, 1.0, b);
}

/* 1 if a and b, which hold or do not, are no contradiction. */
static int agree(const ns_piecewise_condition *a, int a_holds, const ns_piecewise_condition *b, int b_holds) {
    if ((b_holds && !a_holds && follows(a, b)) || (a_holds && !b_holds && follows(b, a)))
        return 0;
    if (a_holds != b_holds || !has_terms(a, -1.0, b))
        return 1;
    return a_holds == (a->constant - a->threshold + b->constant - b->threshold > 0.0);
}

static int is_possible(const ns_piecewise *p, const ns_piecewise_value *v, int set) {
    int possible = 1;
    for (int i = 0; i < v->nconditions; i++)
        for (int k = 0; k < i && possible; k++)
            possible = agree(&p->condition[v->condition[i]], set >> i & 1, &p->condition[v->condition[k]],
                             set >> k & 1);
    return possible;
}

/* The set without the conditions that others of it imply: a value that is compared with eight numbers is in
 * nine ranges, not in 256. */
static int shorten(const ns_piecewise *p, const ns_piecewise_value *v, int set) {
    for (int i = 0; i < v->nconditions; i++)
        for (int k = 0; k < v->nconditions && set >> i & 1; k++)
            if (k != i && set >> k & 1 &&
                follows(&p->condition[v->condition[i]], &p->condition[v->condition[k]]))
                set &= ~(1 << i);
    return set;
}

/* --- the sum --- */

/* The table as a sum: of each set of conditions what is added where all of them hold. */
static void table_to_sum(const ns_piecewise *p, const ns_piecewise_value *v, double *sum) {
    const int size = 1 << v->nconditions;
    memcpy(sum, v->table, (size_t)size * sizeof *sum);
    for (int k = 0; k < v->nconditions; k++)
        for (int set = 0; set < size; set++)
            if (set & (1 << k))
                sum[set] -= sum[set & ~(1 << k)];
    for (int set = size - 1; set > 0; set--) {
        const int same = shorten(p, v, set);
        sum[same] += same != set ? sum[set] : 0.0;
        sum[set] = same != set ? 0.0 : sum[set];
    }
}

/* How many times as large as a value the terms of its sum are, at most; zero: what counts as the size of a
 * value 0, or 0: they are not looked at. */
static double spread_of(const ns_piecewise *p, const ns_piecewise_value *v, double zero) {
    double terms[PIECEWISE_TABLE], spread = 0.0;
    const int size = 1 << v->nconditions;
    table_to_sum(p, v, terms);
    for (int set = 0; set < size; set++)
        terms[set] = fabs(terms[set]);
    for (int k = 0; k < v->nconditions; k++)
        for (int set = 0; set < size; set++)
            if (set & (1 << k))
                terms[set] += terms[set & ~(1 << k)];
    for (int set = 0; set < size; set++) {
        const double value = v->table[set] != 0.0 ? fabs(v->table[set]) : zero;
        if (value > 0.0 && terms[set] > spread * value && is_possible(p, v, set))
            spread = terms[set] / value;
    }
    return spread;
}

/* The set with the smallest value that is not 0. */
static int smallest_of(const ns_piecewise *p, const ns_piecewise_value *v) {
    int at = -1;
    for (int set = 0; set < 1 << v->nconditions; set++)
        if (v->table[set] != 0.0 && (at < 0 || fabs(v->table[set]) < fabs(v->table[at])) &&
            is_possible(p, v, set))
            at = set;
    return at;
}

/* v with these of its conditions negated. */
static void turn(const ns_piecewise_value *v, const int *negated, int mask, ns_piecewise_value *out) {
    for (int k = 0; k < v->nconditions; k++)
        out->condition[k] = mask >> k & 1 ? negated[k] : v->condition[k];
    for (int set = 0; set < 1 << v->nconditions; set++)
        out->table[set] = v->table[set ^ mask];
}

/* From this mask on each condition is negated if the spread is smaller then; returns it. */
static double descend(const ns_piecewise *p, const ns_piecewise_value *v, const int *negated, double zero,
                      ns_piecewise_value *out, int *mask) {
    turn(v, negated, *mask, out);
    double best = spread_of(p, out, zero);
    for (int k = 0; k < PASSES * v->nconditions; k++) {
        const int other = *mask ^ 1 << k % v->nconditions;
        turn(v, negated, other, out);
        const double spread = spread_of(p, out, zero);
        *mask = spread < best ? other : *mask;
        best = fmin(spread, best);
    }
    return best;
}

/* v, or where values would be lost beside others v over conditions of which some are negated. */
static const ns_piecewise_value *without_loss(ns_piecewise *p, const ns_piecewise_value *v, double size) {
    int negated[PIECEWISE_CONDITIONS], mask = 0, other = smallest_of(p, v);
    const double zero = other < 0 ? 0.0 : fmin(fabs(v->table[other]), 1.0 / fmax(size, 1.0));
    if (spread_of(p, v, zero) <= PIECEWISE_SPREAD_KEPT)
        return v;
    ns_piecewise_value *out = ns_bridge_piecewise_make(p, v->nconditions, 0);
    for (int k = 0; k < v->nconditions && out; k++) {
        negated[k] = ns_bridge_piecewise_negated(p, v->condition[k]);
        out = negated[k] >= 0 ? out : NULL;
    }
    if (!out)
        return NULL;
    const double from_none = descend(p, v, negated, zero, out, &mask);
    if (descend(p, v, negated, zero, out, &other) < from_none)
        mask = other;
    turn(v, negated, mask, out);
    return spread_of(p, out, 0.0) <= PIECEWISE_SPREAD_MAX ? out : ns_bridge_piecewise_fail_spread(p);
}

const ns_piecewise_value *ns_bridge_piecewise_table_sum(ns_piecewise *p, const ns_piecewise_value *v,
                                                        double size, double *sum) {
    v = without_loss(p, v, size);
    if (v)
        table_to_sum(p, v, sum);
    return v;
}

/* --- two values --- */

/* The largest, or the smallest that is not 0 (none: 1) of what a is. */
static double extreme_of(const ns_piecewise *p, const ns_piecewise_value *a, int largest) {
    double extreme = 0.0;
    for (int set = 0; a->is_discrete && set < 1 << a->nconditions; set++) {
        const double value = fabs(a->table[set]);
        if (value > 0.0 && (extreme == 0.0 || (largest ? value > extreme : value < extreme)))
            extreme = value;
    }
    extreme = a->is_discrete ? extreme : ns_bridge_piecewise_size(p, a);
    return extreme > 0.0 || largest ? extreme : 1.0;
}

double ns_bridge_piecewise_beside(const ns_piecewise *p, const ns_piecewise_value *base,
                                  const ns_piecewise_value *other) {
    return extreme_of(p, base, 1) / extreme_of(p, other, 0);
}
