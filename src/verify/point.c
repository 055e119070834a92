/* src/verify/point.c - a point that is shown: algebraic rows of (S1), (S3), (S4), switches and controls. */
#include "verify_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What a control may be beyond its threshold, of the largest that it was: events close together count as one.
 */
static const double of_control = 1e-3;
/* Inputs are known at a time that is rounded, in units of eps. */
static const double roundings = 64;

/* --- findings --- */

ns_verify_finding ns_verify_nothing(double t) {
    return (ns_verify_finding){NS_VERIFY_RIGHT, -1, -1, t, 1};
}

void ns_verify_note(ns_verify_finding *worst, ns_verify_cause cause, int pair, int unknown, double error) {
    if (error <= worst->error)
        return;
    worst->cause = cause;
    worst->pair = pair;
    worst->unknown = unknown;
    worst->error = isnan(error) ? INFINITY : error;
}

const char *ns_verify_text(ns_verify_cause cause) {
    switch (cause) {
    case NS_VERIFY_NUMBER:
        return "a number is not finite";
    case NS_VERIFY_ROW:
        return "currents or voltages do not add up";
    case NS_VERIFY_OUTPUT:
        return "the voltage shown is not that of the nodes";
    case NS_VERIFY_LAW:
        return "voltage and current have the wrong signs";
    case NS_VERIFY_COMMAND:
        return "the switch is not as its control says";
    case NS_VERIFY_JUMP:
        return "a charge or a flux jumps without a cause";
    case NS_VERIFY_IMPULSE:
        return "an impulse has the wrong sign";
    case NS_VERIFY_ENERGY:
        return "energy grows in a jump";
    case NS_VERIFY_FLOW:
        return "a charge or a flux is not the integral of what flows";
    case NS_VERIFY_RIGHT:
        break;
    }
    return "nothing is wrong";
}

/* --- the point --- */

static void fill_inputs(const ns_verify *v, double t, ns_side side, double *z) {
    for (int k = 0; k < v->s->nz; k++)
        z[k] = ns_signal_value(&v->s->z[k], t, side);
}

void ns_verify_fill(const ns_verify *v, const ns_verify_state *at, double *u) {
    const size_t n = (size_t)v->s->n, m = (size_t)v->s->m;
    memcpy(u, at->x, sizeof *u * n);
    if (m > 0)
        memcpy(u + n, at->lambda, sizeof *u * m);
    fill_inputs(v, at->t, at->side, u + n + m);
    u[n + m + (size_t)v->s->nz] = 1;
}

/* By how much inputs differ around t; 0: not at all. */
static int find_spread(ns_verify *v, double t) {
    const int first = v->s->n + v->s->m;
    const double near = roundings * DBL_EPSILON * fabs(t);
    double *before = v->u_left + first, *spread = v->spread + first;
    int any = 0;
    fill_inputs(v, t - near, NS_LEFT, before);
    fill_inputs(v, t + near, NS_RIGHT, spread);
    for (int k = 0; k < v->s->nz; k++) {
        spread[k] = fabs(spread[k] - before[k]);
        any |= spread[k] > 0;
    }
    return any;
}

/* What that makes of a row. */
static double spread_of(const ns_verify *v, const ns_verify_rows *r, int i) {
    return v->spreads ? 2 * ns_verify_row(r, i, v->spread).size : 0;
}

static int numbers_are_finite(const ns_verify *v, ns_verify_finding *worst) {
    const int n = v->s->n, all = n + v->s->m;
    double sum = 0;
    for (int i = 0; i < all; i++)
        sum += v->u[i] * 0;
    for (int i = 0; i < all && sum != 0; i++)
        if (!isfinite(v->u[i]))
            ns_verify_note(worst, NS_VERIFY_NUMBER, i < n ? -1 : i - n, i < n ? i : -1, INFINITY);
    return worst->cause == NS_VERIFY_RIGHT;
}

/* --- Kirchhoff's laws and those of elements without charge --- */

static void judge_rows(ns_verify *v, ns_verify_finding *worst) {
    for (int k = 0; k < v->algebraics; k++) {
        const int i = v->algebraic[k];
        const ns_verify_sum s = ns_verify_row(&v->law, i, v->u);
        v->most_law[i] = ns_verify_larger(s.size, v->most_law[i]);
        const double off = ns_verify_sizes_law_off(v, i);
        if (!(fabs(s.sum) <= off))
            ns_verify_note(worst, NS_VERIFY_ROW, -1, i, fabs(s.sum) / (off + spread_of(v, &v->law, i)));
    }
}

/* --- pairs --- */

double ns_verify_law_error(double l, double u, double lambda, double y, double lambda_off, double y_off) {
    const double out = ns_verify_larger(l - lambda, lambda - u) / lambda_off;
    const double bound = (y > 0 ? lambda - l : u - lambda) / lambda_off, law = fabs(y) / y_off;
    return ns_verify_larger(out, bound < law ? bound : law);
}

/* A pair as it is, what it may be off by, and what its control wants. */
typedef struct pair_values {
    double lambda, y, lambda_off, y_off;
    int wanted; /* of a switch: 1 closed, -1 open, 0 either */
    int slides; /* of a switch: its control is at the threshold, and it may be between */
} pair_values;

/* How far a pair is from its law. */
static double pair_error(const ns_verify *v, int j, const pair_values *p) {
    const double open = fabs(p->lambda) / p->lambda_off, shut = fabs(p->y) / p->y_off;
    if (v->command[j] < 0)
        return ns_verify_law_error(v->s->l[j], v->s->u[j], p->lambda, p->y, p->lambda_off, p->y_off);
    if (p->slides)
        return 0;
    return p->wanted > 0 ? shut : p->wanted < 0 ? open : open < shut ? open : shut;
}

static void read_control(ns_verify *v, int c, pair_values *p) {
    const ns_command *k = &v->s->command[c];
    const ns_verify_sum g = ns_verify_row(&v->control, c, v->u);
    v->most_control[c] = ns_verify_larger(g.size, v->most_control[c]);
    const double threshold = ns_verify_larger(fabs(k->on), fabs(k->off)),
                 off = of_control * ns_verify_larger(v->most_control[c], threshold) +
                       spread_of(v, &v->control, c);
    p->slides = k->on == k->off && fabs(g.sum - k->on) <= off;
    p->wanted = g.sum > k->on + off ? 1 : g.sum < k->off - off ? -1 : 0;
}

static pair_values read_pair(ns_verify *v, int j, const ns_verify_sum *y) {
    pair_values p = {.lambda = v->u[v->s->n + j], .y = y->sum};
    v->most_lambda[j] = ns_verify_larger(fabs(p.lambda), v->most_lambda[j]);
    v->most_y[j] = ns_verify_larger(y->size, v->most_y[j]);
    v->most_any_lambda = ns_verify_larger(fabs(p.lambda), v->most_any_lambda);
    v->most_any_y = ns_verify_larger(y->size, v->most_any_y);
    p.lambda_off = ns_verify_sizes_lambda_off(v, j);
    p.y_off = ns_verify_sizes_y_off(v, j) + spread_of(v, &v->output, j);
    if (v->command[j] >= 0)
        read_control(v, v->command[j], &p);
    return p;
}

static void judge_pair(ns_verify *v, int j, const double *y_shown, ns_verify_finding *worst) {
    const ns_verify_sum y = ns_verify_row(&v->output, j, v->u);
    pair_values p = read_pair(v, j, &y);
    if (y_shown && !(fabs(y_shown[j] - y.sum) <= p.y_off))
        ns_verify_note(worst, NS_VERIFY_OUTPUT, j, -1, fabs(y_shown[j] - y.sum) / p.y_off);
    if (pair_error(v, j, &p) <= 1)
        return;
    p.lambda_off += ns_verify_sizes_rounding_around(v, j);
    const double error = pair_error(v, j, &p);
    const int wanted = p.wanted;
    p.wanted = 0;
    ns_verify_note(worst, wanted && pair_error(v, j, &p) <= 1 ? NS_VERIFY_COMMAND : NS_VERIFY_LAW, j, -1,
                   error);
}

static int judge(ns_verify *v, const ns_verify_state *at, ns_verify_finding *worst) {
    *worst = ns_verify_nothing(at->t);
    judge_rows(v, worst);
    for (int j = 0; j < v->s->m; j++)
        judge_pair(v, j, at->y, worst);
    return worst->cause == NS_VERIFY_RIGHT;
}

int ns_verify_point(ns_verify *v, const ns_verify_state *at, ns_verify_finding *worst) {
    *worst = ns_verify_nothing(at->t);
    ns_verify_fill(v, at, v->u);
    if (!numbers_are_finite(v, worst))
        return 0;
    ns_verify_sizes_numbers(v, v->u);
    if (judge(v, at, worst))
        return 1;
    v->spreads = find_spread(v, at->t); /* rare: an input jumps, or is steep */
    const int right = v->spreads && judge(v, at, worst);
    v->spreads = 0;
    return right;
}
