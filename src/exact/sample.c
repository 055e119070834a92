/* src/exact/sample.c - the point anywhere on the way of a trial, which stays as it is.
 *
 * The trial is one mode, between corners of all inputs.  Its begin is kept, and a second state goes on from
 * where it was asked for last, by the steps that the trial has made or others of the same kernels.
 */
#include "exact_internal.h"

#include "linalg/simd.h"

#include <math.h>
#include <string.h>

int ns_exact_output_of(ns_exact *f, const double *X, double *x_lambda) {
    double until;
    ns_mode_kernel *k = ns_exact_mode_time_scale(f, &until)->kernel;
    const int all = f->system->n + f->system->m, columns = k->q + f->inputs->mutes;
    if (!k->x_lambda_now) {
        const int status = ns_exact_output_map(f->s, f->inputs, k);
        if (status != NS_OK)
            return status;
        f->cache.bytes += sizeof(double) * (size_t)all * (size_t)columns;
    }
    ns_linalg_matvec(all, columns, k->x_lambda_now, X, x_lambda);
    return NS_OK;
}

static size_t bytes_of_state(const ns_exact *f) {
    return sizeof *f->X * ((size_t)f->s->r + (size_t)f->inputs->nv);
}

static void rewind_way(ns_exact *f) {
    memcpy(f->way.X, f->way.X_from, bytes_of_state(f));
    f->way.at = f->way.from;
}

void ns_exact_way_begin(ns_exact *f) {
    memcpy(f->way.X_from, f->X, bytes_of_state(f));
    f->way.from = f->state;
    rewind_way(f);
}

/* An event that was resolved, or that could not be, at its begin leaves no way. */
void ns_exact_way_end(ns_exact *f) {
    f->way.known = f->state.now.t > f->way.from.now.t;
    f->way.end_t = f->state.now.t;
}

/* The state goes on to t in its mode, through its time scales. */
static int go_on(ns_exact *f, double t) {
    ns_exact_state *s = &f->state;
    int status = NS_OK;
    for (int i = 0; i <= NS_TIME_SCALES && status == NS_OK; i++) {
        const double rest = t - s->now.t - s->now.lost;
        double until;
        if (!(rest > 0))
            break;
        ns_time_scale *scale = ns_exact_mode_time_scale(f, &until);
        const double room = until - (s->now.t - s->last_event_t);
        const int all = !(room > 0 && room < rest) || i == NS_TIME_SCALES;
        const double part = all ? rest : room;
        status = ns_exact_step_advance(f, scale, part);
        ns_clock_advance(&s->now, all ? t : ns_lower(t, s->now.t + (s->now.lost + part)), part);
    }
    return status;
}

/* Inputs that only outputs follow. */
static void put_mutes(const ns_exact *f, double t, double *X) {
    const ns_side side = t > f->way.from.now.t ? NS_LEFT : NS_RIGHT;
    for (int i = 0; i < f->inputs->mutes; i++)
        X[f->s->r + f->inputs->nv + i] = ns_signal_value(&f->system->z[f->inputs->mute[i]], t, side);
}

/* f->state, f->X are those of the way. */
static int sample_here(ns_exact *f, double t) {
    int status = go_on(f, t);
    put_mutes(f, t, f->X);
    if (status == NS_OK)
        status = ns_exact_output_of(f, f->X, f->work.x_lambda);
    if (f->failed != NS_OK)
        status = f->failed;
    f->failed = NS_OK;
    return status;
}

int ns_exact_sample(ns_exact *f, double t, const double **x_lambda) {
    const ns_exact_state state = f->state;
    const long steps = f->counts.steps;
    double *X = f->X;
    *x_lambda = f->work.x_lambda;
    if (!f->way.known)
        return NS_E_STATE;
    if (t < f->way.at.now.t)
        rewind_way(f);
    f->state = f->way.at;
    f->X = f->way.X;
    const int status = sample_here(f, t);
    f->way.at = f->state;
    f->way.X = f->X;
    f->state = state;
    f->X = X;
    f->counts.steps = steps;
    if (status != NS_OK)
        rewind_way(f);
    return status;
}

/* Of inputs that only outputs follow. */
static double shortest_of_mutes(const ns_exact *f) {
    double most = 0;
    for (int i = 0; i < f->inputs->mutes; i++)
        most = ns_higher(most, ns_inputs_wave_rate(&f->system->z[f->inputs->mute[i]]));
    return NS_REACH / most;
}

/* Inputs and charges are straight lines. */
static int is_straight(const ns_exact *f) {
    int straight = f->s->r == 0;
    for (int i = 0; i < f->inputs->nv; i++)
        straight &= f->inputs->state[i].kind < NS_STATE_DECAY;
    return straight;
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
    const double h = is_straight(f) ? INFINITY : ns_lower(k->scale[i].h, length / OF_LENGTH);
    return ns_lower(h, shortest_of_mutes(f));
}
