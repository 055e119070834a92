/* src/sparse/create.c - the engine for large circuits: made, freed. */
#include "sparse_internal.h"

#include "system/broken_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double default_reltol = 1e-9;
static const size_t default_bytes = (size_t)64 << 20;
enum { STEPS = sizeof((ns_sparse *)0)->steps / sizeof(ns_dense_step) };

static int allocate_step(const ns_form *f, ns_dense_step *step) {
    const size_t n = (size_t)f->n, size = (size_t)f->size, nz = (size_t)f->nz, s = NS_STAGES;
    step->images = calloc(s * size + (s + 1) * n + s * nz + 1, sizeof(double));
    step->mode = calloc((size_t)f->m + 1, 1);
    if (!step->images || !step->mode)
        return NS_E_MEMORY;
    step->powers = step->images + s * size;
    step->z = step->powers + (s + 1) * n;
    return NS_OK;
}

/* The first of so many numbers of those that are left. */
static double *next_array(double **left, int count) {
    double *first = *left;
    *left += count;
    return first;
}

static void place_numbers(ns_sparse *m, double *left) {
    const int n = m->f->n, pairs = m->f->m, size = m->f->size, nz = m->f->nz;
    m->w = next_array(&left, n);
    m->unit = next_array(&left, n);
    m->rate = next_array(&left, n);
    m->before_event.w = next_array(&left, n);
    m->largest.w = next_array(&left, n);
    m->saved_largest.w = next_array(&left, n);
    m->tried_largest.w = next_array(&left, n);
    m->inverse_scale = next_array(&left, n);
    m->work.w = next_array(&left, n);
    m->work.move = next_array(&left, n);
    m->work.rates = next_array(&left, n);
    m->work.before_w = next_array(&left, n);
    m->work.right_w = next_array(&left, n);
    m->work.removed = next_array(&left, n);
    m->work.finer_removed = next_array(&left, n);
    m->l = next_array(&left, pairs);
    m->u = next_array(&left, pairs);
    m->apart = next_array(&left, pairs); /* a pair has one command at most */
    m->v = next_array(&left, size);
    m->r = next_array(&left, size);
    m->work.v = next_array(&left, size);
    m->work.residual = next_array(&left, size);
    m->work.projected = next_array(&left, size);
    m->z = next_array(&left, nz);
    m->work.no_inputs = next_array(&left, nz);
    m->inside.v = next_array(&left, size);
    m->inside.z = next_array(&left, nz);
    m->instant = (ns_instant){size, 0, next_array(&left, size)};
    m->before_event.instant = (ns_instant){size, 0, next_array(&left, size)};
}

static void place_modes(ns_sparse *m) {
    const int pairs = m->f->m, nc = m->s->nc;
    m->work.mode = m->mode + pairs;
    m->shown_mode = m->work.mode + pairs;
    m->commanded_mode = m->shown_mode + pairs;
    m->before_event.mode = m->commanded_mode + pairs;
    m->work.tried_mode = m->before_event.mode + pairs;
    m->work.lcp_mode = m->work.tried_mode + pairs;
    m->work.lasting_mode = m->work.lcp_mode + pairs;
    m->work.lone_mode = m->work.lasting_mode + pairs;
    m->work.wanted = m->work.lone_mode + pairs;
    m->flip = (unsigned char *)(m->work.wanted + pairs);
    m->touched = m->flip + pairs;
    m->changed = m->touched + pairs;
    m->before_event.changed = m->changed + nc;
    m->due = m->before_event.changed + nc;
}

static int allocate_state(ns_sparse *m) {
    const size_t n = (size_t)m->f->n, pairs = (size_t)m->f->m, size = (size_t)m->f->size,
                 nz = (size_t)m->f->nz;
    double *numbers = calloc(15 * n + 3 * pairs + 8 * size + 3 * nz + 1, sizeof(double));
    m->w = numbers;
    m->mode = calloc(12 * pairs + 3 * (size_t)m->s->nc + 1, 1);
    m->chatter.flips = calloc(2 * pairs + 1, sizeof *m->chatter.flips);
    m->work.exact = calloc(size + 1, sizeof(long double));
    if (!numbers || !m->mode || !m->chatter.flips || !m->work.exact)
        return NS_E_MEMORY;
    place_numbers(m, numbers);
    place_modes(m);
    m->accepted_chatter.flips = m->chatter.flips + pairs;
    int status = ns_sparse_predict_create(m);
    if (status == NS_OK)
        status = ns_sparse_transient_create(m);
    for (int i = 0; i < STEPS && status == NS_OK; i++)
        status = allocate_step(m->f, &m->steps[i]);
    return status;
}

static void set_units(ns_sparse *m) {
    for (int i = 0; i < m->f->n; i++) {
        double largest = 0;
        for (int k = m->f->Mt.start[i]; k < m->f->Mt.start[i + 1]; k++)
            largest = fmax(largest, fabs(m->f->Mt.value[k]));
        m->unit[i] = sqrt(largest);
    }
}

/* Inputs that no step looks at. */
static double shortest_of_inputs(const ns_sparse *m) {
    double most = 0;
    for (int k = 0; k < m->f->nz; k++)
        if (!m->in->enters[k])
            most = fmax(most, ns_inputs_wave_rate(&m->s->z[k]));
    return NS_REACH / most;
}

/* by (n) += what each pair with a resistance conducts from an unknown with a charge, in its row. */
static void add_pairs(const ns_form *f, const double *held, double *by) {
    for (int j = 0; j < f->m; j++) {
        double ohm = 0;
        for (int k = f->Ct.start[j]; k < f->Ct.start[j + 1]; k++)
            ohm += f->Ct.row[k] == f->n + j ? f->Ct.value[k] : 0;
        for (int k = f->Ct.start[j]; ohm > 0 && k < f->Ct.start[j + 1]; k++)
            if (f->Ct.row[k] < f->n && held[f->Ct.row[k]] > 0)
                by[f->Ct.row[k]] += f->Ct.value[k] * f->Ct.value[k] / ohm;
    }
}

/* The shortest time, in s, in which a capacitance that a pair with a resistance can discharge is discharged:
 * where others are at that time, what charges are left depends on which pair stops first.  held, by: n. */
static double shortest_race(const ns_form *f, double *held, double *by) {
    double rate = 0;
    memset(held, 0, sizeof *held * (size_t)f->n);
    memset(by, 0, sizeof *by * (size_t)f->n);
    for (int i = 0; i < f->n; i++)
        for (int k = f->Mt.start[i]; k < f->Mt.start[i + 1]; k++)
            held[f->Mt.row[k]] = fmax(held[f->Mt.row[k]], fabs(f->Mt.value[k]));
    add_pairs(f, held, by);
    for (int i = 0; i < f->n; i++) {
        if (!(by[i] > 0))
            continue;
        for (int k = f->At.start[i]; k < f->At.start[i + 1]; k++)
            by[i] += f->At.row[k] == i ? fabs(f->At.value[k]) : 0;
        rate = fmax(rate, by[i] / held[i]);
    }
    return 1 / rate;
}

/* o.finer, so that a step which resolves an event is short beside the shortest ramp of an input, and beside
 * discharges that race. */
static int finer_of(const ns_sparse *m) {
    static const double of_ramp = 1.0 / 128, of_race = 1.0 / 1024;
    const double least = ldexp(m->o.h, -NS_EVENT_LEAST_EXPONENT - m->o.finer);
    const double need = fmin(of_ramp * ns_system_lines_shortest(m->s->nz, m->s->z),
                             of_race * shortest_race(m->f, m->work.w, m->work.move));
    return need < least ? (int)fmin(NS_MOST_FINER, m->o.finer + ceil(log2(least / need))) : m->o.finer;
}

static int create_parts(ns_sparse *m, const ns_system *s) {
    int status = ns_sparse_output_create(s, &m->output_only);
    m->s = status == NS_OK ? &m->output_only->rest : s;
    if (status == NS_OK)
        status = ns_sparse_form_create(m->s, 0, &m->f);
    if (status == NS_OK)
        status = ns_sparse_factors_create(m->f, m->o.bytes, &m->q);
    if (status == NS_OK)
        status = ns_inputs_stages_create(m->s, &m->in);
    if (status == NS_OK)
        status = ns_modes_shared_find(m->s, &m->shared, &m->shared_count);
    if (status == NS_OK)
        status = ns_sparse_factors_shared(m->q, m->shared, m->shared_count);
    if (status == NS_OK)
        status = allocate_state(m);
    if (status != NS_OK)
        return status;
    set_units(m);
    m->inputs_shortest = shortest_of_inputs(m);
    m->o.finer = m->usual_finer = finer_of(m);
    return ns_sparse_theta_create(m);
}

static ns_method method(const ns_engine *e) {
    return ((const ns_sparse *)(const void *)e)->o.theta > 0 ? NS_THETA : NS_SPARSE;
}

static int be_finer(ns_engine *e) {
    static const double less = 1.0 / 64;
    ns_sparse *m = ns_sparse_of(e);
    if (m->o.reltol <= default_reltol)
        return 0;
    m->o.reltol = fmax(less * m->o.reltol, default_reltol);
    return 1;
}

static const ns_engine_table table = {
    .free = ns_sparse_free,
    .start = ns_sparse_start,
    .start_dc = ns_sparse_start_dc,
    .try_to = ns_sparse_try,
    .drop = ns_sparse_drop,
    .accept = ns_sparse_accept,
    .read = ns_sparse_read,
    .impulse = ns_sparse_impulse,
    .mode = ns_sparse_mode,
    .at_event = ns_sparse_at_event,
    .method = method,
    .counts = ns_sparse_counts,
    .work = ns_sparse_work,
    .fault = ns_sparse_fault,
    .sample = ns_sparse_sample,
    .shortest = ns_sparse_shortest,
    .bend = ns_sparse_bend,
    .peek = ns_sparse_peek,
    .watch = ns_sparse_watch,
    .set_input = ns_sparse_set_input,
    .be_finer = be_finer,
};

int ns_sparse_create(const ns_system *s, const ns_sparse_options *o, ns_engine **out, ns_fault *fault) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!s || !o)
        return NS_E_NULL;
    if (!(o->h > 0) || !isfinite(o->h) || !(o->reltol >= 0) || !isfinite(o->reltol) ||
        !(o->theta >= 0 && o->theta <= 1))
        return NS_E_RANGE;
    int status = ns_system_check(s, fault);
    if (status != NS_OK)
        return status;
    ns_sparse *m = calloc(1, sizeof *m);
    if (!m)
        return NS_E_MEMORY;
    m->engine.table = &table;
    m->o = *o;
    m->o.reltol = o->reltol > 0 ? o->reltol : default_reltol;
    m->o.bytes = o->bytes ? o->bytes : default_bytes;
    m->fault.t = NAN;
    status = create_parts(m, s);
    if (status != NS_OK) {
        ns_sparse_free(&m->engine);
        return status;
    }
    *out = &m->engine;
    return NS_OK;
}

void ns_sparse_free(ns_engine *e) {
    ns_sparse *m = ns_sparse_of(e);
    if (!m)
        return;
    for (int i = 0; i < STEPS; i++) {
        free(m->steps[i].images);
        free(m->steps[i].mode);
    }
    free(m->w);
    free(m->mode);
    free(m->chatter.flips);
    free(m->shared);
    free(m->work.exact);
    ns_sparse_predict_free(m);
    ns_sparse_transient_free(m);
    ns_sparse_theta_free(m);
    ns_inputs_stages_free(m->in);
    ns_sparse_factors_free(m->q);
    ns_sparse_form_free(m->f);
    ns_sparse_output_free(m->output_only);
    free(m);
}
