/* src/exact/sample.c - the point anywhere on the way of a trial, which stays as it is.
 *
 * The trial is one mode, between corners of all inputs.  Its begin is kept; from there the steps of its
 * kernels lead to the same anchor for the same time, whatever was looked at before.
 */
#include "exact_internal.h"

#include "linalg/simd.h"

#include <math.h>
#include <string.h>

int ns_exact_output_of(ns_exact *f, ns_mode_kernel *k, const double *X, double *x_lambda) {
    const size_t bytes = k->bytes;
    int status = k->x_lambda_now ? NS_OK : ns_exact_output_map(f->s, f->inputs, k);
    if (status == NS_OK)
        status = ns_exact_output_map_apply(f->s, f->inputs, k, X, x_lambda, f->work.sum);
    f->cache.bytes += k->bytes - bytes;
    return status;
}

static void copy_state(const ns_exact *f, const double *from, double *to) {
    memcpy(to, from, sizeof *to * ((size_t)f->s->r + (size_t)f->inputs->nv));
}

void ns_exact_way_begin(ns_exact *f) {
    copy_state(f, f->X, f->way.X_from);
    f->way.from = f->state;
    f->way.scale = NULL;
}

/* An event that was resolved, or that could not be, at its begin leaves no way. */
void ns_exact_way_end(ns_exact *f) {
    f->way.known = f->state.now.t > f->way.from.now.t;
    f->way.end_t = f->state.now.t;
    f->way.line = NS_LINE_UNASKED;
}

/* *X moves on by tau; no step of the run is counted. */
static int move(ns_exact *f, ns_time_scale *scale, double tau, double **X) {
    const long steps = f->counts.steps;
    double *kept = f->X;
    f->X = *X;
    const int status = ns_exact_step_advance(f, scale, tau);
    *X = f->X;
    f->X = kept;
    f->counts.steps = steps;
    return status;
}

/* The time scale in force at the base.  Errors: MEMORY. */
static int enter_scale(ns_exact *f) {
    ns_exact_way *w = &f->way;
    const ns_exact_state kept = f->state;
    double until;
    f->state = w->base;
    w->scale = ns_exact_mode_time_scale(f, &until);
    f->state = kept;
    const double room = until - (w->base.now.t - w->base.last_event_t);
    w->room = room > 0 ? room : INFINITY;
    w->anchor = -1;
    w->prefixes = 0;
    const int status = f->failed;
    f->failed = NS_OK;
    if (status != NS_OK)
        w->scale = NULL;
    return status;
}

static int rewind_way(ns_exact *f) {
    copy_state(f, f->way.X_from, f->way.X_base);
    f->way.base = f->way.from;
    return enter_scale(f);
}

static double after_base(const ns_exact_way *w, double t) {
    return ns_higher(t - w->base.now.t - w->base.now.lost, 0);
}

/* The base goes to where the time scale for t comes into force. */
static int find_scale(ns_exact *f, double t) {
    ns_exact_way *w = &f->way;
    int status = !w->scale || t < w->base.now.t ? rewind_way(f) : NS_OK;
    for (int i = 0; i < NS_TIME_SCALES && status == NS_OK && after_base(w, t) > w->room; i++) {
        const double room = w->room;
        status = move(f, w->scale, room, &w->X_base);
        ns_clock_advance(&w->base.now, ns_lower(t, w->base.now.t + (w->base.now.lost + room)), room);
        status = status == NS_OK ? enter_scale(f) : status;
    }
    if (status != NS_OK)
        w->scale = NULL;
    return status;
}

/* X after so many of the prefixes. */
static double *prefix_row(const ns_exact *f, int prefixes) {
    const size_t q = (size_t)f->s->r + (size_t)f->inputs->nv + (size_t)f->inputs->output_only_inputs;
    return prefixes > 0 ? f->way.X_prefix + (size_t)(prefixes - 1) * q : f->way.X_base;
}

/* Drops the prefixes that are not on the way to `count` steps; how many steps the last one that stays is. */
static double keep_prefixes(ns_exact_way *w, double count) {
    const ns_exact_prefix *p = w->prefix;
    int n = w->prefixes;
    while (n > 0 && !(count >= p[n - 1].count && count - p[n - 1].count < p[n - 1].last))
        n--;
    w->prefixes = n;
    return n > 0 ? p[n - 1].count : 0;
}

/* One step of h 2^k = `length` h from the last prefix is the next one; the last one makes room for it if
 * there is none. */
static int add_prefix(ns_exact *f, int k, double length, double done) {
    ns_exact_way *w = &f->way;
    ns_step_map *map;
    const int status = ns_exact_step_of_length(f, w->scale, k, &map);
    if (status != NS_OK)
        return status;
    ns_exact_step_apply(f, w->scale->kernel, map, prefix_row(f, w->prefixes), w->X);
    w->prefixes += w->prefixes < NS_PREFIXES;
    copy_state(f, w->X, prefix_row(f, w->prefixes));
    w->prefix[w->prefixes - 1] = (ns_exact_prefix){done + length, length};
    return NS_OK;
}

/* The anchor: so many steps after the base, by the same steps whatever was looked at before. */
static int find_anchor(ns_exact *f, double count) {
    ns_exact_way *w = &f->way;
    const ns_mode_kernel *k = w->scale->kernel;
    if (count == w->anchor)
        return NS_OK;
    w->anchor = -1;
    double done = keep_prefixes(w, count);
    while (done < count) {
        double length = 1;
        int i = 0;
        for (; i < NS_MAX_EXPONENT && 2 * length <= count - done; i++)
            length *= 2;
        const int status = add_prefix(f, i, length, done);
        if (status != NS_OK)
            return status;
        done += length;
    }
    ns_linalg_matvec(NS_ORDER * k->r, k->q, k->laguerre_powers, prefix_row(f, w->prefixes), w->powers);
    w->anchor = count;
    return NS_OK;
}

/* w->X: tau after the anchor (E2). */
static void sum_series(ns_exact *f, double tau) {
    ns_exact_way *w = &f->way;
    const ns_mode_kernel *k = w->scale->kernel;
    double b[NS_ORDER + 1], *last = f->work.sum;
    copy_state(f, prefix_row(f, w->prefixes), w->X);
    ns_modes_laguerre_steps(tau / k->g, b);
    ns_linalg_matvec(k->r, NS_ORDER - 1, w->powers + k->r, b + 2, last); /* small terms first */
    for (int i = 0; i < k->r; i++)
        w->X[i] += last[i] + b[1] * w->powers[i];
    ns_inputs_states_advance(f->inputs, tau, w->X + k->r);
}

/* Inputs that only outputs follow. */
static void put_output_only(const ns_exact *f, double t, double *X) {
    const ns_side side = t > f->way.from.now.t ? NS_LEFT : NS_RIGHT;
    for (int i = 0; i < f->inputs->output_only_inputs; i++)
        X[f->s->r + f->inputs->nv + i] =
            ns_signal_value(&f->system->z[f->inputs->output_only_input[i]], t, side);
}

/* f->work.x_lambda at t, by the series. */
static int sample_series(ns_exact *f, double t) {
    ns_exact_way *w = &f->way;
    int status = find_scale(f, t);
    if (status != NS_OK)
        return status;
    const double h = w->scale->kernel->h, rest = after_base(w, t), count = floor(rest / h);
    status = find_anchor(f, count);
    if (status != NS_OK)
        return status;
    sum_series(f, rest - count * h);
    put_output_only(f, t, w->X);
    return ns_exact_output_of(f, w->scale->kernel, w->X, f->work.x_lambda);
}

/* Inputs and charges are straight lines. */
static int is_straight(const ns_exact *f) {
    int straight = f->s->r == 0;
    for (int i = 0; i < f->inputs->nv; i++)
        straight &= f->inputs->state[i].kind < NS_STATE_DECAY;
    return straight;
}

/* So are inputs that only outputs follow: the way ends at their corners. */
static int are_outputs_straight(const ns_exact *f) {
    int straight = is_straight(f);
    for (int i = 0; i < f->inputs->output_only_inputs; i++) {
        const ns_signal_kind kind = f->system->z[f->inputs->output_only_input[i]].kind;
        straight &= kind == NS_DC || kind == NS_PULSE || kind == NS_PWL;
    }
    return straight;
}

/* x, lambda at both ends of the way, if it is a straight line in all of them. */
static int find_line(ns_exact *f) {
    ns_exact_way *w = &f->way;
    const size_t bytes = sizeof(double) * ((size_t)f->s->s->n + (size_t)f->s->s->m);
    const double end[] = {w->from.now.t, w->end_t};
    w->line = are_outputs_straight(f) ? NS_LINE_KNOWN : NS_LINE_NONE;
    for (int k = 0; k < 2 && w->line == NS_LINE_KNOWN; k++) {
        const int status = sample_series(f, end[k]);
        if (status != NS_OK)
            return status;
        memcpy(w->x_lambda[k], f->work.x_lambda, bytes);
    }
    return NS_OK;
}

/* f->work.x_lambda at t, on the line. */
static void sample_line(ns_exact *f, double t) {
    const ns_exact_way *w = &f->way;
    const double *a = w->x_lambda[0], *b = w->x_lambda[1], from = w->from.now.t;
    const double part = (t - from) / (w->end_t - from);
    if (t >= w->end_t)
        a = b;
    for (int i = 0; i < f->s->s->n + f->s->s->m; i++)
        f->work.x_lambda[i] = a[i] + part * (b[i] - a[i]);
}

int ns_exact_sample(ns_exact *f, double t, const double **x_lambda) {
    ns_exact_way *w = &f->way;
    int status = w->known ? NS_OK : NS_E_STATE;
    *x_lambda = f->work.x_lambda;
    if (status == NS_OK && w->line == NS_LINE_UNASKED)
        status = find_line(f);
    if (status != NS_OK)
        return status;
    if (w->line != NS_LINE_KNOWN)
        return sample_series(f, t);
    sample_line(f, t);
    return NS_OK;
}

double ns_exact_shortest(ns_exact *f, double t, double *until) {
    enum { OF_LENGTH = 16 };
    const ns_exact_mode *k = f->way.from.mode;
    const double since = t - f->way.from.last_event_t, length = f->way.end_t - f->way.from.now.t;
    int i = 0;
    *until = INFINITY;
    while (i + 1 < k->scales && since >= k->scale[i + 1].from * (1 - 1e-9))
        i++;
    if (i + 1 < k->scales)
        *until = ns_higher(f->way.from.last_event_t + k->scale[i + 1].from, nextafter(t, INFINITY));
    double h = k->scale[i].h; /* the kernel's step: a part of the fastest time constant */
    if (h < length)
        h = ns_lower(h, length / OF_LENGTH);
    if (is_straight(f))
        h = INFINITY;
    if (*until >= f->way.end_t)
        *until = INFINITY;
    return ns_lower(h, f->output_only_shortest);
}
