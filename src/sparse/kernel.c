/* src/sparse/kernel.c - the sparse engine's steps as a kernel (engine/kernel.h). */
#include "guards.h"
#include "step.h"

#include <stdlib.h>
#include <string.h>

typedef struct ns_sparse_kernel {
    ns_kernel kernel;
    ns_sparse *m;
    ns_dense_step *step; /* of prepare() */
    double t;            /* s: the point */
    double *before;      /* n of the whole: M x there */
    double *x;           /* n of the whole */
    double *v[3],
        *z[3]; /* n+m of what stays; nz: x, lambda and inputs at tau, their rates and second rates */
} ns_sparse_kernel;

static ns_sparse_kernel *kernel_of(ns_kernel *k) {
    return (ns_sparse_kernel *)(void *)k;
}

static void free_kernel(ns_kernel *k) {
    ns_sparse_kernel *e = kernel_of(k);
    if (e->m)
        ns_sparse_free(&e->m->engine);
    free(e->before);
    free(e);
}

static int place(ns_kernel *k, double t, const double *w, const ns_mode *mode) {
    ns_sparse_kernel *e = kernel_of(k);
    ns_sparse *m = e->m;
    memcpy(e->before, w, sizeof(double) * (size_t)k->s->n);
    e->t = t;
    ns_sparse_guard_reset_modes(m, NULL);
    ns_sparse_guard_set_mode(m, mode);
    ns_inputs_stages_reset(m->in);
    ns_inputs_stages_at(m->in, t);
    ns_inputs_stages_find_command(m->in, t, m->o.h, m->mode);
    for (int i = 0; i < m->f->n; i++)
        m->work.w[i] = w[m->output_only->stays[i]];
    for (int i = 0; i < m->f->n; i++)
        m->w[i] = m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Tt, i, m->work.w);
    e->step = &m->steps[0];
    e->step->length_exponent = 0;
    e->step->time_lost = 0;
    e->step->after_event = 0;
    return NS_OK;
}

/* x of the whole from v of what stays, at t + tau. */
static void join(ns_sparse_kernel *e, const double *v, double tau) {
    ns_system_inputs(e->m->s, e->t + tau, tau > 0 ? NS_LEFT : NS_RIGHT, e->m->z);
    ns_sparse_output_join(e->m->output_only, v, e->m->z, e->x);
}

static int prepare(ns_kernel *k, double h, double *ahead) {
    ns_sparse_kernel *e = kernel_of(k);
    ns_sparse *m = e->m;
    const double known = fmin(m->in->corner, m->in->first), limit = fmin(e->t + h, known);
    const int status = ns_sparse_control_step(m, e->step, e->t, limit);
    *ahead = fmin(NS_POLE * e->step->g, limit - e->t);
    return status;
}

static int make_consistent(ns_kernel *k, double *moved, double *impulse, int *jumps) {
    ns_sparse_kernel *e = kernel_of(k);
    ns_sparse *m = e->m;
    const double g = ldexp(m->o.h, -NS_SHORT_EXPONENT);
    ns_jump_kind jump;
    int status = ns_sparse_project_consistent(m, e->t, g, NULL, &jump);
    *jumps = jump == NS_JUMPS;
    ns_instant_clear(&m->instant);
    if (status == NS_OK && *jumps)
        status = ns_sparse_instant_add(m, g, &m->instant);
    memcpy(impulse, m->instant.sum + m->f->n, sizeof *impulse * (size_t)m->f->m);
    double ahead;
    if (status == NS_OK)
        status = prepare(k, m->o.h, &ahead);
    if (status != NS_OK)
        return status;
    ns_sparse_step_point(m, e->step, 0, e->v[0]);
    join(e, e->v[0], 0);
    ns_system_charges(k->s, e->x, moved);
    for (int i = 0; i < k->s->n; i++)
        moved[i] -= e->before[i];
    return NS_OK;
}

static int state(ns_kernel *k, double tau, double *w) {
    ns_sparse_kernel *e = kernel_of(k);
    ns_sparse_step_point(e->m, e->step, tau, e->v[0]);
    join(e, e->v[0], tau);
    ns_system_charges(k->s, e->x, w);
    return NS_OK;
}

static int outputs(ns_kernel *k, double tau, double *x, double *lambda) {
    ns_sparse_kernel *e = kernel_of(k);
    ns_sparse_step_point(e->m, e->step, tau, e->v[0]);
    join(e, e->v[0], tau);
    memcpy(x, e->x, sizeof(double) * (size_t)k->s->n);
    for (int j = 0; j < k->s->m; j++)
        lambda[j] = e->v[0][e->m->f->n + j];
    return NS_OK;
}

/* Coefficients of (E1) at s, their derivatives and second ones by s: L_i' = -(L_0 + ... + L_i-1). */
static void coefficients(double s, double c[3][NS_ORDER]) {
    ns_modes_laguerre(s, NS_ORDER, c[0]);
    for (int d = 1; d < 3; d++) {
        double sum = 0;
        for (int i = 0; i < NS_ORDER; i++) {
            const double sign = i % 2 ? -1 : 1;
            c[d][i] = -sign * sum;
            sum += sign * c[d - 1][i];
        }
    }
}

static void combine(int count, int stages, const double *c, double scale, const double *images, double *out) {
    for (int a = 0; a < count; a++) {
        out[a] = 0;
        for (int i = 0; i < stages; i++)
            out[a] += scale * c[i] * images[(size_t)i * (size_t)count + (size_t)a];
    }
}

static int guards(ns_kernel *k, double tau, ns_guard *of) {
    ns_sparse_kernel *e = kernel_of(k);
    const ns_sparse *m = e->m;
    const double g = e->step->g;
    const int stages = e->step->stages < NS_ORDER ? e->step->stages : NS_ORDER;
    double c[3][NS_ORDER];
    coefficients(tau / g, c);
    for (int d = 0; d < 3; d++) {
        combine(m->f->size, stages, c[d], pow(g, -d), e->step->images, e->v[d]);
        combine(m->f->nz, stages, c[d], pow(g, -d), e->step->z, e->z[d]);
    }
    for (int i = 0; i < 2 * m->f->m + m->s->nc; i++)
        of[i] = (ns_guard){INFINITY, 0, 0, 0};
    for (int j = 0; j < m->f->m; j++)
        for (int i = 0; i < guards_of(m, j); i++)
            of[2 * j + (m->mode[j] == NS_INSIDE ? is_upper(m, j, i) : m->mode[j] == NS_UPPER)] =
                (ns_guard){guard(m, j, i, e->v[0], e->z[0], 1), guard(m, j, i, e->v[1], e->z[1], 0),
                           guard(m, j, i, e->v[2], e->z[2], 0),
                           ns_sparse_guard_rounding(m, j, e->v[0], e->step->powers, g)};
    for (int i = 0; i < m->s->nc; i++)
        if (of_state(m, i))
            of[2 * m->f->m + i] = (ns_guard){
                margin(m, i, e->v[0], e->z[0], 1), margin(m, i, e->v[1], e->z[1], 0),
                margin(m, i, e->v[2], e->z[2], 0), ns_sparse_guard_control_rounding(m, i, e->v[0], e->z[0])};
    return NS_OK;
}

static const ns_counts *cost(ns_kernel *k) {
    return ns_sparse_counts(&kernel_of(k)->m->engine);
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

static int make_parts(ns_sparse_kernel *e, const ns_sparse_options *o) {
    ns_engine *engine;
    const int status = ns_sparse_create(e->kernel.s, o, &engine, NULL);
    e->m = ns_sparse_of(engine);
    if (status != NS_OK)
        return status;
    const size_t n = (size_t)e->kernel.s->n, size = (size_t)e->m->f->size, nz = (size_t)e->m->f->nz;
    e->before = calloc(2 * n + 3 * (size + nz) + 1, sizeof *e->before);
    if (!e->before)
        return NS_E_MEMORY;
    e->x = e->before + n;
    for (int d = 0; d < 3; d++) {
        e->v[d] = e->x + n + (size_t)d * (size + nz);
        e->z[d] = e->v[d] + size;
    }
    return NS_OK;
}

int ns_sparse_kernel_create(const ns_system *s, const ns_sparse_options *o, ns_kernel **out) {
    ns_sparse_kernel *e = calloc(1, sizeof *e);
    *out = NULL;
    if (!e)
        return NS_E_MEMORY;
    e->kernel = (ns_kernel){&table, s};
    const int status = make_parts(e, o);
    if (status != NS_OK) {
        free_kernel(&e->kernel);
        return status;
    }
    *out = &e->kernel;
    return NS_OK;
}
