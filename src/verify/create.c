/* src/verify/create.c - the object: equations, which rows hold charges, and nothing seen yet. */
#include "verify_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where all numbers are smaller, rounding is that of this one. */
static const double least_number = 1e-2;

/* The largest size of a source, of curved ones a bound. */
static double peak(const ns_signal *s) {
    double most = 0;
    switch (s->kind) {
    case NS_DC:
        return fabs(s->u.dc);
    case NS_PULSE:
        return fmax(fabs(s->u.pulse.v1), fabs(s->u.pulse.v2));
    case NS_SIN:
        return fabs(s->u.sin.vo) + fabs(s->u.sin.va);
    case NS_EXP:
        return fmax(fabs(s->u.exp.v1), fabs(s->u.exp.v2));
    case NS_PWL:
        for (int i = 0; i < s->u.pwl.n; i++)
            most = fmax(most, fabs(s->u.pwl.v[i]));
        return most;
    }
    return most;
}

static int allocate(ns_verify *v) {
    const ns_system *s = v->s;
    const size_t n = (size_t)s->n, m = (size_t)s->m, all = ns_verify_columns(s);
    v->numbers =
        calloc(4 * n + m + 2 * ns_verify_sizes(s) + (5 + NS_VERIFY_NODES) * (all + 1), sizeof(double));
    v->command = calloc(4 * n + 5 * m + (size_t)s->nz + (size_t)s->nc + 1, sizeof *v->command);
    v->quick.pair = calloc(m + 1, sizeof *v->quick.pair);
    v->inputs.piece = calloc((size_t)s->nz + 1, sizeof *v->inputs.piece);
    v->slides = calloc(m + 1, 1);
    v->memory = calloc((size_t)s->nc + 1, sizeof *v->memory);
    if (!v->slides || !v->memory || !v->numbers || !v->command || !v->inputs.piece || !v->quick.pair)
        return NS_E_MEMORY;
    v->algebraic = v->command + m;
    v->stored = v->algebraic + n;
    v->is_aside = v->stored + n;
    v->quick.plain = v->is_aside + n;
    v->quick.other = v->quick.plain + m;
    v->is_loose_row = v->quick.other + m;
    v->is_loose_pair = v->is_loose_row + n;
    v->inputs.moving = v->is_loose_pair + m;
    v->by_state = v->inputs.moving + s->nz;
    v->is_excused = v->by_state + s->nc;
    v->unit = v->numbers;
    v->sign = v->unit + n;
    v->w_left = v->sign + n;
    v->times_row = v->w_left + n;
    v->times_pair = v->times_row + n;
    v->most_law = v->times_pair + m;
    v->most_w = v->most_law + n;
    v->most_lambda = v->most_w + n;
    v->most_y = v->most_lambda + m;
    v->most_control = v->most_y + m;
    v->most_any = v->most_control + (size_t)s->nc;
    v->kept = v->most_any + NS_VERIFY_ANY;
    v->u = v->kept + ns_verify_sizes(s);
    v->u_left = v->u + all + 1;
    v->spread = v->u_left + all + 1;
    v->quick.row = v->spread + all + 1;
    v->quick.charge = v->quick.row + all + 1;
    v->v = v->quick.charge + all + 1;
    return NS_OK;
}

static double unit_of(const ns_verify_rows *charge, int i) {
    double most = 0;
    for (int k = charge->start[i]; k < charge->start[i + 1]; k++)
        most = fmax(most, fabs(charge->value[k]));
    return sqrt(most);
}

static void find_rows(ns_verify *v) {
    const ns_system *s = v->s;
    for (int i = 0; i < s->n; i++) {
        v->unit[i] = unit_of(&v->charge, i);
        if (v->unit[i] > 0)
            v->stored[v->storeds++] = i;
        else
            v->algebraic[v->algebraics++] = i;
    }
    for (int j = 0; j < s->m; j++)
        v->command[j] = -1;
    for (int c = 0; c < s->nc; c++)
        v->command[s->command[c].pair] = c;
    v->is_passive = ns_verify_passive_find(v);
    ns_verify_quick_find(v);
}

int ns_verify_create(const ns_system *s, const ns_verify_options *o, ns_verify **out) {
    ns_verify *v = calloc(1, sizeof *v);
    *out = NULL;
    if (!v)
        return NS_E_MEMORY;
    v->s = s;
    v->o = *o;
    v->times = 1;
    int status = allocate(v);
    if (status == NS_OK)
        status = ns_verify_rows_create(v);
    if (status != NS_OK) {
        ns_verify_free(v);
        return status;
    }
    find_rows(v);
    status = ns_verify_aside_find(v);
    if (status != NS_OK) {
        ns_verify_free(v);
        return status;
    }
    ns_verify_reset(v);
    *out = v;
    return NS_OK;
}

void ns_verify_free(ns_verify *v) {
    if (!v)
        return;
    ns_verify_rows_free(v);
    free(v->numbers);
    free(v->command);
    free(v->slides);
    free(v->inputs.piece);
    free(v->memory);
    free(v->quick.pair);
    free(v);
}

/* What sources may make of the terms of rows: where they begin at zero, nothing else tells. */
static void grow_by_sources(const ns_verify *v, const ns_verify_rows *r, double *most) {
    const int first = v->s->n + v->s->m;
    for (int i = 0; i < r->count; i++) {
        double size = 0;
        for (int k = r->start[i]; k < r->start[i + 1]; k++)
            if (r->column[k] >= first)
                size += fabs(r->value[k]) * v->spread[r->column[k]];
        most[i] = fmax(most[i], size);
    }
}

void ns_verify_renew(ns_verify *v) {
    const ns_system *s = v->s;
    double *source = v->spread + s->n + s->m, *most = &v->most_any[NS_VERIFY_ANY_NUMBER];
    ns_verify_finding none = ns_verify_nothing(0);
    for (int k = 0; k < s->nz; k++) {
        source[k] = peak(&s->z[k]);
        *most = fmax(*most, source[k]);
    }
    source[s->nz] = 1;
    grow_by_sources(v, &v->law, v->most_law);
    grow_by_sources(v, &v->output, v->most_y);
    grow_by_sources(v, &v->control, v->most_control);
    memset(source, 0, sizeof *source * ((size_t)s->nz + 1));
    memset(v->inputs.piece, 0, sizeof *v->inputs.piece * (size_t)s->nz);
    v->inputs.from = INFINITY;
    ns_verify_memory_reset(v);
    v->grew = 1;
    (void)ns_verify_sizes_end(v, &none);
}

void ns_verify_reset(ns_verify *v) {
    const ns_system *s = v->s;
    memset(v->most_law, 0, sizeof *v->most_law * ns_verify_sizes(s));
    for (int i = 0; i < s->n; i++)
        v->times_row[i] = 1;
    for (int j = 0; j < s->m; j++)
        v->times_pair[j] = 1;
    memset(v->is_loose_row, 0, sizeof *v->is_loose_row * (size_t)s->n);
    memset(v->is_loose_pair, 0, sizeof *v->is_loose_pair * (size_t)s->m);
    v->most_any[NS_VERIFY_ANY_NUMBER] = least_number;
    v->quick.is_ready = 0;
    v->excused_t = NAN;
    ns_verify_renew(v);
}

void ns_verify_scale(ns_verify *v, double times, double instant, double transient) {
    if (v->times != times)
        v->quick.is_ready = 0;
    v->times = times;
    v->o.instant = instant;
    v->o.transient = transient;
}

void ns_verify_excuse(ns_verify *v, double t, int pair) {
    if (v->excused_t != t)
        memset(v->is_excused, 0, sizeof *v->is_excused * (size_t)v->s->m);
    v->excused_t = t;
    v->is_excused[pair] = 1;
}

void ns_verify_allow(ns_verify *v, const ns_verify_finding *f) {
    if (f->pair >= 0)
        v->times_pair[f->pair] = ns_verify_wrong;
    if (f->unknown >= 0)
        v->times_row[f->unknown] = ns_verify_wrong;
    v->quick.is_old = 1;
}

double ns_verify_effort(const ns_verify *v) {
    const ns_system *s = v->s;
    return v->law.start[s->n] + v->output.start[s->m] + v->control.start[s->nc] + s->n + s->m;
}
