/* src/verify/event.c - from the left side of an event to its right side: what jumps is explained by impulses,
 * or nothing jumps. */
#include "verify_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What impulses may be off by, of the terms of their equations and of the largest of a kind; of the largest
 * number in them.  Energy: of what there is. */
static const double of_impulse = 1e-5, of_all = 1e-9, of_energy = 1e-5;
/* What does not count as a move, of a charge's terms. */
static const double rounding = 1e-9;
/* So much larger than that an impulse is one. */
static const double clearly = 1e3;

/* A jump, judged. */
typedef struct jump {
    double seconds;             /* that it took */
    double lambda_off, any_off; /* what impulses of lambda, of all, may be off by */
} jump;

static ns_verify_sum charge_left(const ns_verify *v, int i) {
    return v->has_w_left ? (ns_verify_sum){v->w_left[i], fabs(v->w_left[i])}
                         : ns_verify_row(&v->charge, i, v->u_left);
}

static double moved(const ns_verify *v, int i) {
    return ns_verify_row(&v->charge, i, v->u).sum - charge_left(v, i).sum;
}

/* Also what flows in the time that it may take. */
static double moved_in(const ns_verify *v, int i, double seconds) {
    return ns_verify_sizes_charge_off(v, i) + seconds * ns_verify_row(&v->law, i, v->u).size;
}

/* Of an event whose two sides have one time: transients that die out in it. */
static double moved_off(const ns_verify *v, int i) {
    const double dies_out = ns_verify_dies_out * v->o.transient;
    return moved_in(v, i, v->t > v->t_left || v->o.instant < dies_out ? v->o.instant : dies_out);
}

/* How a charge or a flux differs between u_left and u: by rounding, as it may in the time that an event
 * takes, or by more. */
typedef enum moves { NONE, LITTLE, JUMPS } moves;

static moves most_of_moves(ns_verify *v) {
    moves most = NONE;
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        const ns_verify_sum from = charge_left(v, i), to = ns_verify_row(&v->charge, i, v->u);
        const double move = fabs(to.sum - from.sum);
        ns_verify_sizes_charge(v, i, ns_verify_larger(from.size, to.size));
        if (move <= rounding * to.size || move <= moved_in(v, i, v->o.transient))
            continue;
        if (!(move <= moved_off(v, i)))
            most = JUMPS;
        most = most == NONE ? LITTLE : most;
    }
    return most;
}

/* v->v: X, Lambda, and the integrals of inputs and of 1 over the time that it took. */
static void fill_impulse(ns_verify *v, double seconds, const double *X, const double *Lambda) {
    const size_t n = (size_t)v->s->n, m = (size_t)v->s->m, known = (size_t)v->s->nz + 1;
    memcpy(v->v, X, sizeof *X * n);
    if (m > 0)
        memcpy(v->v + n, Lambda, sizeof *X * m);
    for (size_t k = 0; k < known; k++)
        v->v[n + m + k] = seconds * v->u[n + m + k];
}

/* --- (J1), (J2): every row --- */

static void judge_balance(const ns_verify *v, const jump *j, ns_verify_finding *worst) {
    for (int i = 0; i < v->s->n; i++) {
        const ns_verify_sum carried = ns_verify_row(&v->law, i, v->v);
        const double rest = fabs(moved(v, i) - carried.sum);
        const double off =
            v->times * v->times_row[i] * (of_impulse * carried.size + j->any_off * v->law.size[i]) +
            moved_off(v, i);
        if (!(rest <= off))
            ns_verify_note(worst, NS_VERIFY_JUMP, -1, i, rest / off);
    }
}

/* The second half of (J1): charges and fluxes are finite, so that their integral over an instant is nothing.
 * An Euler step that is taken for an instant obeys the first half. */
static void judge_integrals(const ns_verify *v, const jump *j, ns_verify_finding *worst) {
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        const double integral = fabs(ns_verify_row(&v->charge, i, v->v).sum);
        const double off = v->times * v->times_row[i] *
                           ((j->seconds + v->o.instant) * v->most_w[i] + j->any_off * v->charge.size[i]);
        if (!(integral <= off))
            ns_verify_note(worst, NS_VERIFY_JUMP, -1, i, integral / off);
    }
}

/* --- (J4) --- */

/* A bound that an impulse obeys: none, or zero. */
static double bound(double b) {
    return isinf(b) ? b : 0;
}

/* What follows an impulse: y+ is zero after one of lambda, lambda+ at its bound after one of y. */
static double after_error(const ns_verify *v, int i, double lambda_share, double y_share) {
    const double y = ns_verify_row(&v->output, i, v->u).sum, lambda = v->u[v->s->n + i];
    const double to_l = fabs(lambda - v->s->l[i]), to_u = fabs(v->s->u[i] - lambda);
    const double off = ns_verify_sizes_lambda_off(v, i) + ns_verify_sizes_rounding_around(v, i);
    if (lambda_share > clearly)
        return fabs(y) / ns_verify_sizes_y_off(v, i);
    return y_share > clearly ? (to_l < to_u ? to_l : to_u) / off : 0;
}

static double impulse_y_off(const ns_verify *v, int i, const jump *j, double size) {
    return v->times * v->times_pair[i] * (of_impulse * size + j->any_off * v->output.size[i]) +
           2 * (j->seconds + v->o.instant) * v->most_y[i] + DBL_MIN;
}

static double impulse_error(const ns_verify *v, int i, const jump *j) {
    const double lambda = v->v[v->s->n + i];
    const ns_verify_sum y = ns_verify_row(&v->output, i, v->v);
    const double lambda_off = v->times * v->times_pair[i] * j->lambda_off +
                              2 * (j->seconds + v->o.instant) * v->most_lambda[i],
                 y_off = impulse_y_off(v, i, j, y.size);
    const double lambda_share = fabs(lambda) / lambda_off, y_share = fabs(y.sum) / y_off;
    if (v->command[i] >= 0) /* open or closed, before or after */
        return lambda_share < y_share ? lambda_share : y_share;
    const double error =
        ns_verify_law_error(bound(v->s->l[i]), bound(v->s->u[i]), lambda, y.sum, lambda_off, y_off);
    return j->seconds > 0 ? error : ns_verify_larger(after_error(v, i, lambda_share, y_share), error);
}

static void judge_pairs(const ns_verify *v, const jump *j, ns_verify_finding *worst) {
    for (int i = 0; i < v->s->m; i++)
        ns_verify_note(worst, NS_VERIFY_IMPULSE, i, -1, impulse_error(v, i, j));
}

static int is_diode(const ns_verify *v, int i) {
    return v->command[i] < 0 && v->s->l[i] == 0 && isinf(v->s->u[i]);
}

/* The current of a diode is not negative at any instant, so its charge is not, either, however short the time
 * in which it passes. */
static double backward_error(const ns_verify *v, int i, const jump *j, double lambda) {
    if (!is_diode(v, i))
        return 0;
    return -lambda / (v->times * v->times_pair[i] * j->lambda_off + 2 * v->o.transient * v->most_lambda[i]);
}

static void judge_directions(const ns_verify *v, const jump *j, ns_verify_finding *worst) {
    for (int i = 0; i < v->s->m; i++)
        ns_verify_note(worst, NS_VERIFY_IMPULSE, i, -1, backward_error(v, i, j, v->v[v->s->n + i]));
}

/* --- energy --- */

static double energy(const ns_verify *v, const double *u, double *size) {
    double sum = 0;
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        const ns_verify_sum w = ns_verify_row(&v->charge, i, u);
        sum += v->sign[i] * u[i] * w.sum / 2;
        *size += fabs(u[i]) * w.size / 2;
    }
    return sum;
}

/* The part of a row that inputs and constants are. */
static double given(const ns_verify *v, const ns_verify_rows *r, int i) {
    const int first = v->s->n + v->s->m;
    double sum = 0;
    for (int k = r->start[i]; k < r->start[i + 1]; k++)
        if (r->column[k] >= first)
            sum +=
                fabs(r->value[k]) * ns_verify_larger(fabs(v->u[r->column[k]]), fabs(v->u_left[r->column[k]]));
    return sum;
}

/* A bound on what sources put in. */
static double put_in(const ns_verify *v) {
    double sum = 0;
    for (int i = 0; i < v->s->n; i++)
        sum += fabs(v->v[i]) * given(v, &v->law, i);
    for (int i = 0; i < v->s->m; i++)
        sum += fabs(v->v[v->s->n + i]) * given(v, &v->output, i);
    return sum;
}

/* What charges may be off by makes of it. */
static double moved_energy_off(const ns_verify *v) {
    double sum = DBL_MIN;
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        sum += ns_verify_larger(fabs(v->u[i]), fabs(v->u_left[i])) * moved_off(v, i);
    }
    return sum;
}

static void judge_energy(const ns_verify *v, ns_verify_finding *worst) {
    double size = 0;
    if (!v->is_passive || v->has_w_left)
        return;
    const double before = energy(v, v->u_left, &size), after = energy(v, v->u, &size);
    const double off = v->times * of_energy * size + moved_energy_off(v), grown = after - before - put_in(v);
    if (grown > off)
        ns_verify_note(worst, NS_VERIFY_ENERGY, -1, v->stored[0], grown / off);
}

void ns_verify_energy_over(ns_verify *v, double seconds, ns_verify_finding *worst) {
    for (int i = 0; i < v->s->n + v->s->m; i++)
        v->v[i] = seconds * ns_verify_larger(fabs(v->u[i]), fabs(v->u_left[i]));
    judge_energy(v, worst);
}

static double largest(size_t count, const double *a) {
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = ns_verify_larger(fabs(a[i]), most);
    return most;
}

/* v->v, and what impulses may be off by, of a jump that takes j->seconds. */
static void fill_jump(ns_verify *v, const double *X, const double *Lambda, jump *j) {
    const size_t n = (size_t)v->s->n, m = (size_t)v->s->m;
    fill_impulse(v, j->seconds, X, Lambda);
    j->any_off = of_all * largest(n + m, v->v);
    j->lambda_off = of_impulse * largest(m, v->v + n) + j->any_off + DBL_MIN;
}

/* A number of which not even `hopeless` is as small as all numbers before leaves no digit of what was there:
 * each law holds to the rounding of its terms then, whatever they are. */
static const double hopeless = 1e-18;

/* The largest of u, and which it is; -1: all are zero. */
static double largest_of(const ns_verify *v, const double *u, int *at) {
    double most = 0;
    *at = -1;
    for (int i = 0; i < v->s->n + v->s->m; i++)
        if (fabs(u[i]) > most) {
            most = fabs(u[i]);
            *at = i;
        }
    return most;
}

static void judge_against(const ns_verify *v, double before, ns_verify_finding *worst) {
    const int n = v->s->n;
    int at;
    const double most = largest_of(v, v->u, &at);
    if (!v->has_w_left && before > 0 && at >= 0)
        ns_verify_note(worst, NS_VERIFY_NUMBER, at < n ? -1 : at - n, at < n ? at : -1,
                       hopeless * most / before);
}

int ns_verify_keeps_digits(ns_verify *v, ns_verify_finding *worst) {
    static const double no_time = 1024 * DBL_EPSILON;
    int at;
    *worst = ns_verify_nothing(v->t);
    if (fabs(v->t - v->t_left) <= no_time * fabs(v->t))
        judge_against(v, largest_of(v, v->u_left, &at), worst);
    return !(worst->error > ns_verify_wrong);
}

void ns_verify_left(ns_verify *v) {
    v->most_left = v->most_any[NS_VERIFY_ANY_NUMBER];
    memcpy(v->u_left, v->u, sizeof *v->u * ns_verify_columns(v->s));
    v->t_left = v->t;
    v->has_w_left = 0;
}

void ns_verify_left_charges(ns_verify *v, double t, const double *w) {
    for (int i = 0; i < v->s->n; i++)
        v->w_left[i] = v->unit[i] > 0 ? w[i] : 0;
    v->t_left = t;
    v->has_w_left = 1;
}

int ns_verify_left_in_full(ns_verify *v, ns_verify_finding *worst) {
    const double *x = v->u_left;
    const ns_verify_state at = {v->t_left, NS_LEFT, x, x + v->s->n, NULL, 1};
    const int right = ns_verify_point(v, &at, worst);
    ns_verify_left(v);
    return right;
}

int ns_verify_event(ns_verify *v, const double *X, const double *Lambda, ns_verify_finding *worst) {
    jump j = {.seconds = v->t - v->t_left};
    *worst = ns_verify_nothing(v->t);
    judge_against(v, v->most_left, worst);
    ns_verify_memory_event(v, worst);
    const moves most = most_of_moves(v);
    if (most == NONE)
        return ns_verify_sizes_end(v, worst);
    fill_jump(v, X, Lambda, &j);
    judge_directions(v, &j, worst);
    if (most == LITTLE)
        return ns_verify_sizes_end(v, worst);
    judge_balance(v, &j, worst);
    judge_integrals(v, &j, worst);
    judge_pairs(v, &j, worst);
    judge_energy(v, worst);
    return ns_verify_sizes_end(v, worst);
}

int ns_verify_quick_directions(const ns_verify *v, const double *Lambda, const double *before) {
    const size_t m = (size_t)v->s->m;
    double most = 0;
    for (size_t i = 0; i < m; i++)
        most = ns_verify_larger(fabs(Lambda[i]) + (before ? fabs(before[i]) : 0), most);
    const jump j = {.lambda_off = of_impulse * most + DBL_MIN};
    for (size_t i = 0; i < m; i++)
        if (backward_error(v, (int)i, &j, Lambda[i] - (before ? before[i] : 0)) > 1)
            return 0;
    return 1;
}

/* 1 if the impulses of diode i, of an energy above `little` (J), are of the wrong sign. */
static int is_impulse_wrong(const ns_verify *v, int i, const jump *j, double little) {
    const ns_verify_sum y = ns_verify_row(&v->output, i, v->v);
    const double lambda = v->v[v->s->n + i];
    return (backward_error(v, i, j, lambda) > 1 && -lambda * v->most_y[i] > little) ||
           (-y.sum > impulse_y_off(v, i, j, y.size) && -y.sum * v->most_lambda[i] > little);
}

int ns_verify_quick_impulses(ns_verify *v, const double *X, const double *Lambda) {
    static const double little = 1e-6;
    jump j = {0};
    double size = 0;
    int any = 0;
    (void)energy(v, v->u, &size);
    fill_jump(v, X, Lambda, &j);
    for (int i = 0; i < v->s->m && !any; i++)
        any = is_diode(v, i) && is_impulse_wrong(v, i, &j, little * size);
    return !any;
}
