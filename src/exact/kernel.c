/* src/exact/kernel.c - the exact engine's matrices as a kernel (engine/kernel.h). */
#include "exact_internal.h"
#include "guards.h"
#include "mode_selection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct ns_exact_kernel {
    ns_kernel kernel;
    ns_theta *step;
    ns_exact *exact;
    ns_dense_point point;
    const ns_mode_kernel *at; /* matrices of the point's mode, for prepare()'s time */
    double *X, *P;            /* q: the state at tau; r*q: the step to there */
    double *before;           /* n: M x before make_consistent() */
    double *x;                /* n+m: x, lambda */
    ns_counts counts;         /* as cost() shows them */
} ns_exact_kernel;

static ns_exact_kernel *kernel_of(ns_kernel *k) {
    return (ns_exact_kernel *)(void *)k;
}

static void free_kernel(ns_kernel *k) {
    ns_exact_kernel *e = kernel_of(k);
    ns_exact_free(e->exact);
    ns_theta_free(e->step);
    free(e->point.flip);
    free(e->X);
    free(e);
}

static int place(ns_kernel *k, double t, const double *w, const ns_mode *mode) {
    ns_exact_kernel *e = kernel_of(k);
    for (int c = 0; c < k->s->nc; c++)
        e->point.flip[c] = mode[k->s->command[c].pair] == NS_INSIDE;
    int status = ns_theta_start(e->step, w, e->point.flip);
    memset(e->point.flip, 0, (size_t)k->s->nc);
    if (status != NS_OK)
        return status;
    ns_theta_set_mode(e->step, mode);
    memcpy(e->before, w, sizeof(double) * (size_t)k->s->n);
    e->point.now = (ns_clock){t, 0};
    e->point.last_event_t = t;
    return ns_exact_place(e->exact);
}

/* e->X, e->x: the state at tau, and x, lambda there. */
static int find_outputs(ns_exact_kernel *e, double tau) {
    ns_exact *f = e->exact;
    const int r = e->at->r;
    ns_exact_kernel_step(e->at, tau, e->P);
    ns_linalg_matvec(r, e->at->q, e->P, f->X, e->X);
    memcpy(e->X + r, f->X + r, sizeof(double) * (size_t)e->at->nv);
    ns_inputs_states_advance(f->inputs, tau, e->X + r);
    return ns_exact_output_at(f, e->point.now.t + tau, tau > 0 ? NS_LEFT : NS_RIGHT, e->X, e->x);
}

static int make_consistent(ns_kernel *k, double *moved, double *impulse, int *jumps) {
    ns_exact_kernel *e = kernel_of(k);
    ns_exact *f = e->exact;
    const int n = k->s->n, all = n + k->s->m;
    const ns_mode_kernel *fastest = f->state.mode->scale[0].kernel;
    *jumps = ns_exact_enter(f, f->state.mode);
    /* lambda of the Euler step that takes away what jumps, times its length */
    for (int j = 0; j < k->s->m; j++) {
        impulse[j] = 0;
        for (int i = 0; i < fastest->r && *jumps; i++)
            impulse[j] += fastest->g * fastest->step_x_lambda[(size_t)(n + j) + (size_t)i * (size_t)all] *
                          f->work.gone[i];
    }
    memcpy(f->X, f->X_next, sizeof(double) * (size_t)fastest->q);
    e->at = fastest;
    const int status = find_outputs(e, 0);
    if (status != NS_OK)
        return status;
    ns_system_charges(k->s, e->x, moved);
    for (int i = 0; i < n; i++)
        moved[i] -= e->before[i];
    return NS_OK;
}

static int prepare(ns_kernel *k, double h, double *ahead) {
    ns_exact_kernel *e = kernel_of(k);
    double until;
    e->at = ns_exact_mode_time_scale(e->exact, &until)->kernel;
    const double t = e->point.now.t, known = ns_inputs_events_next(e->exact->events, t + h) - t;
    *ahead = fmin(fmin(h, e->at->h), fmin(known, until));
    return NS_OK;
}

static int state(ns_kernel *k, double tau, double *w) {
    const int status = find_outputs(kernel_of(k), tau);
    if (status == NS_OK)
        ns_system_charges(k->s, kernel_of(k)->x, w);
    return status;
}

static int outputs(ns_kernel *k, double tau, double *x, double *lambda) {
    ns_exact_kernel *e = kernel_of(k);
    const int status = find_outputs(e, tau);
    memcpy(x, e->x, sizeof(double) * (size_t)k->s->n);
    ns_linalg_copy((size_t)k->s->m, e->x + k->s->n, lambda);
    return status;
}

/* Which of the guards of a kernel row g of the matrices is. */
static int index_of(const ns_system *s, const ns_mode_kernel *at, const ns_mode *mode, int g) {
    const ns_guard_row *row = &at->row[g];
    if (row->command >= 0)
        return 2 * s->m + row->command;
    return 2 * row->pair + (row->to == NS_UPPER || mode[row->pair] == NS_UPPER);
}

static int guards(ns_kernel *k, double tau, ns_guard *guard) {
    ns_exact_kernel *e = kernel_of(k);
    const int status = find_outputs(e, tau);
    for (int g = 0; g < 2 * k->s->m + k->s->nc; g++)
        guard[g] = (ns_guard){INFINITY, 0, 0, 0};
    for (int g = 0; g < e->at->rows && status == NS_OK; g++) {
        const double rate = ns_exact_guard_of(e->at, e->at->rate, g, e->X);
        guard[index_of(k->s, e->at, ns_theta_mode(e->step), g)] =
            (ns_guard){ns_exact_guard_of(e->at, e->at->value, g, e->X), rate,
                       ns_exact_guard_of(e->at, e->at->second_rate, g, e->X),
                       ns_exact_guard_rounding_at(e->exact, e->at, g, e->X, rate)};
    }
    return status;
}

static const ns_counts *cost(ns_kernel *k) {
    ns_exact_kernel *e = kernel_of(k);
    const ns_counts *kept = ns_exact_counts(e->exact);
    e->counts = *ns_theta_counts(e->step);
    e->counts.modes += kept->modes;
    e->counts.maps += kept->maps;
    return &e->counts;
}

static const ns_kernel_table table = {
    .free = free_kernel,
    .place = place,
    .make_consistent = make_consistent,
    .prepare = prepare,
    .state = state,
    .outputs = outputs,
    .guards = guards,
    .cost = cost,
};

static int make_parts(ns_exact_kernel *e, double h) {
    const ns_theta_options options = {1, 1, 0};
    int status = ns_theta_create(e->kernel.s, &options, &e->step, NULL);
    e->point.flip = calloc((size_t)e->kernel.s->nc + 1, 1);
    if (status == NS_OK)
        status = e->point.flip ? ns_exact_create(e->step, &e->point, h, &e->exact) : NS_E_MEMORY;
    if (status != NS_OK)
        return status;
    const size_t n = (size_t)e->kernel.s->n, m = (size_t)e->kernel.s->m, r = (size_t)e->step->r;
    const size_t q = r + (size_t)e->exact->inputs->nv,
                 output_only_inputs = (size_t)e->exact->inputs->output_only_inputs;
    e->X = calloc(q + output_only_inputs + r * q + 2 * n + m + 1, sizeof *e->X);
    if (!e->X)
        return NS_E_MEMORY;
    e->P = e->X + q + output_only_inputs;
    e->before = e->P + r * q;
    e->x = e->before + n;
    return NS_OK;
}

int ns_exact_kernel_create(const ns_system *s, double h, ns_kernel **out) {
    ns_exact_kernel *e = calloc(1, sizeof *e);
    *out = NULL;
    if (!e)
        return NS_E_MEMORY;
    e->kernel = (ns_kernel){&table, s};
    const int status = make_parts(e, h);
    if (status != NS_OK) {
        free_kernel(&e->kernel);
        return status;
    }
    *out = &e->kernel;
    return NS_OK;
}
