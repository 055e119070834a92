/* src/verify/quick.c - a point in a hurry: what passes is right; what does not may be.
 *
 * All algebraic rows of (S1) are added up, each with a random weight over what it may be off by: one dot
 * product, in which an error of any row shows.  Charges and fluxes likewise: where the sum is the same on
 * both sides of an event, nothing jumps.  Nothing is learnt of sizes here.
 */
#include "verify_internal.h"

#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* --- prepared: by what was learnt so far --- */

/* A weight of either sign, from 1 to 2: of row i. */
static double weight(int i) {
    unsigned long long dice = ((unsigned long long)i + 1) * 0x9e3779b97f4a7c15ULL;
    dice = (dice ^ (dice >> 29)) * 0xbf58476d1ce4e5b9ULL;
    const double size = 1 + (double)(dice >> 12) * 0x1p-52;
    return dice & 1 ? -size : size;
}

/* How many times as much what is rounding may be off by. */
static double looseness(int is_loose) {
    return is_loose ? ns_verify_wrong : 1;
}

static void add_row(const ns_verify_rows *r, int i, double times, double *sum) {
    for (int k = r->start[i]; k < r->start[i + 1]; k++)
        sum[r->column[k]] += times * r->value[k];
}

static void prepare_sums(ns_verify *v) {
    ns_verify_quick *q = &v->quick;
    memset(q->row, 0, sizeof *q->row * ns_verify_columns(v->s));
    memset(q->charge, 0, sizeof *q->charge * ns_verify_columns(v->s));
    for (int k = 0; k < v->algebraics; k++) {
        const int i = v->algebraic[k];
        if (!v->is_aside[i])
            add_row(&v->law, i, weight(i) / looseness(v->is_loose_row[i]) / ns_verify_sizes_law_off(v, i),
                    q->row);
    }
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        add_row(&v->charge, i, weight(i) / looseness(v->is_loose_row[i]) / ns_verify_sizes_charge_off(v, i),
                q->charge);
    }
}

static void prepare_pairs(ns_verify *v) {
    for (int j = 0; j < v->s->m; j++) {
        ns_verify_quick_pair *p = &v->quick.pair[j];
        const int c = v->command[j];
        const double times = looseness(v->is_loose_pair[j]);
        p->y_off = times * ns_verify_sizes_y_off(v, j);
        p->lambda_off = times * ns_verify_sizes_lambda_off(v, j);
        if (c < 0)
            continue;
        const double off = ns_verify_sizes_control_off(v, c);
        p->on = v->s->command[c].on + off;
        p->off = v->s->command[c].off - off;
    }
}

static void prepare(ns_verify *v) {
    v->quick.is_old = 0;
    v->quick.is_ready = 1;
    prepare_sums(v);
    prepare_pairs(v);
}

/* --- the shape of y and of controls --- */

/* A row as u[plus] - u[minus] + own u[at] + constant, if it is one. */
static ns_verify_difference difference_of(const ns_system *s, const ns_verify_rows *r, int i, int own) {
    const int one = s->n + s->m + s->nz, zero = one + 1;
    ns_verify_difference d = {.plus = zero, .minus = zero, .is_one = 1};
    for (int k = r->start[i]; k < r->start[i + 1]; k++) {
        const int column = r->column[k];
        if (column == one)
            d.constant += r->value[k];
        else if (column == own)
            d.own += r->value[k];
        else if (r->value[k] == 1 && d.plus == zero)
            d.plus = column;
        else if (r->value[k] == -1 && d.minus == zero)
            d.minus = column;
        else
            d.is_one = 0;
    }
    return d;
}

static int is_plain(const ns_verify *v, int j) {
    return v->command[j] < 0 && v->quick.pair[j].y.is_one && v->s->l[j] == 0 && v->s->u[j] == INFINITY;
}

void ns_verify_quick_find(ns_verify *v) {
    ns_verify_quick *q = &v->quick;
    for (int j = 0; j < v->s->m; j++) {
        ns_verify_quick_pair *p = &q->pair[j];
        p->y = difference_of(v->s, &v->output, j, v->s->n + j);
        if (v->command[j] >= 0)
            p->control = difference_of(v->s, &v->control, v->command[j], -1);
        if (is_plain(v, j))
            q->plain[q->plains++] = j;
        else
            q->other[q->others++] = j;
    }
}

static inline double difference(const ns_verify_difference *d, double own, const double *u) {
    return u[d->plus] - u[d->minus] + d->own * own + d->constant;
}

static inline double value_of(const ns_verify_difference *d, const ns_verify_rows *r, int i, double own,
                              const double *u) {
    return d->is_one ? difference(d, own, u) : ns_verify_row(r, i, u).sum;
}

/* --- judged --- */

static double dot(size_t count, const double *a, const double *b) {
    ns_simd sum = {0};
    double rest = 0;
    size_t i = 0;
    for (; i + NS_LANES <= count; i += NS_LANES)
        sum += *(const ns_simd *)(a + i) * *(const ns_simd *)(b + i);
    for (; i < count; i++)
        rest += a[i] * b[i];
    double both[NS_LANES];
    memcpy(both, &sum, sizeof both);
    for (int k = 0; k < NS_LANES; k++)
        rest += both[k];
    return rest;
}

/* Open or closed, as its control says.  lambda of it. */
static int switch_holds(ns_verify *v, int j, double lambda) {
    const ns_verify_quick_pair *p = &v->quick.pair[j];
    const int c = v->command[j], open = fabs(lambda) <= p->lambda_off;
    const double g = value_of(&p->control, &v->control, c, 0, v->u);
    if (g < p->off)
        return open;
    const int shut = fabs(value_of(&p->y, &v->output, j, lambda, v->u)) <= p->y_off;
    if (g > p->on)
        return shut;
    const int closed = ns_verify_memory_at(v, c, g);
    return closed < 0 ? shut || open : closed ? shut : open; /* one that slides is looked at in full */
}

static int pair_holds(ns_verify *v, int j, const double *shown) {
    const ns_verify_quick_pair *p = &v->quick.pair[j];
    const double lambda = v->u[v->s->n + j];
    if (shown && !(fabs(shown[j] - value_of(&p->y, &v->output, j, lambda, v->u)) <= p->y_off))
        return 0;
    if (v->command[j] >= 0)
        return switch_holds(v, j, lambda);
    const double y = value_of(&p->y, &v->output, j, lambda, v->u);
    const double above = lambda - v->s->l[j], below = v->s->u[j] - lambda;
    return above >= -p->lambda_off && below >= -p->lambda_off &&
           (fabs(y) <= p->y_off || (y > 0 ? above : below) <= p->lambda_off);
}

static int plain_as_shown(ns_verify *v, const double *shown) {
    for (int k = 0; k < v->quick.plains; k++)
        if (!pair_holds(v, v->quick.plain[k], shown))
            return 0;
    return 1;
}

/* NaN of lambda or y is not seen here; rows_hold() sees it. */
static int plain_hold(const ns_verify *v) {
    const double *u = v->u, *lambdas = u + v->s->n;
    double least = 0, most = 0; /* of the smaller one of lambda and y, each with what it may be off by */
    for (int k = 0; k < v->quick.plains; k++) {
        const int j = v->quick.plain[k];
        const ns_verify_quick_pair *p = &v->quick.pair[j];
        const double lambda = lambdas[j], y = difference(&p->y, lambda, u);
        least = ns_lower(ns_lower(lambda + p->lambda_off, y + p->y_off), least);
        most = ns_higher(ns_lower(lambda - p->lambda_off, y - p->y_off), most);
    }
    return least >= 0 && most <= 0;
}

static int pairs_hold(ns_verify *v, const double *shown) {
    const ns_verify_quick *q = &v->quick;
    for (int k = 0; k < q->others; k++)
        if (!pair_holds(v, q->other[k], shown))
            return 0;
    return shown ? plain_as_shown(v, shown) : plain_hold(v);
}

static int rows_hold(const ns_verify *v) {
    return fabs(dot(ns_verify_columns(v->s), v->quick.row, v->u)) <= 1;
}

int ns_verify_quick_point(ns_verify *v, const ns_verify_state *at) {
    if (!v->quick.is_ready)
        prepare(v);
    ns_verify_fill(v, at);
    if (rows_hold(v) && pairs_hold(v, at->y))
        return 1;
    if (!v->quick.is_old)
        return 0;
    prepare(v);
    return rows_hold(v) && pairs_hold(v, at->y);
}

void ns_verify_quick_left(ns_verify *v, const ns_verify_state *at) {
    const size_t n = (size_t)v->s->n, m = (size_t)v->s->m;
    memcpy(v->u_left, at->x, sizeof *v->u_left * n);
    if (m > 0)
        memcpy(v->u_left + n, at->lambda, sizeof *v->u_left * m);
    v->t_left = at->t;
    v->has_w_left = 0;
}

static int charges_stay(const ns_verify *v) {
    const size_t n = (size_t)v->s->n;
    return fabs(dot(n, v->quick.charge, v->u) - dot(n, v->quick.charge, v->u_left)) <= 1;
}

int ns_verify_quick_stays(ns_verify *v) {
    if (!ns_verify_memory_stays(v))
        return 0;
    if (charges_stay(v))
        return 1;
    if (!v->quick.is_old)
        return 0;
    prepare(v);
    return charges_stay(v);
}
