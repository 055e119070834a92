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
    v->numbers = calloc(3 * n + m + 2 * ns_verify_sizes(s) + (3 + NS_VERIFY_NODES) * all, sizeof(double));
    v->command = calloc(2 * n + m + 1, sizeof *v->command);
    v->scan = calloc(m + 1, sizeof *v->scan);
    v->piece = calloc((size_t)s->nz + 1, sizeof *v->piece);
    if (!v->numbers || !v->command || !v->piece || !v->scan)
        return NS_E_MEMORY;
    v->algebraic = v->command + m;
    v->stored = v->algebraic + n;
    v->unit = v->numbers;
    v->sign = v->unit + n;
    v->times_row = v->sign + n;
    v->times_pair = v->times_row + n;
    v->most_law = v->times_pair + m;
    v->most_w = v->most_law + n;
    v->most_lambda = v->most_w + n;
    v->most_y = v->most_lambda + m;
    v->most_control = v->most_y + m;
    v->most_any = v->most_control + (size_t)s->nc;
    v->kept = v->most_any + NS_VERIFY_ANY;
    v->u = v->kept + ns_verify_sizes(s);
    v->u_left = v->u + all;
    v->spread = v->u_left + all;
    v->v = v->spread + all;
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
    v->scan_known = 1;
    for (int k = 0; k < v->output.start[s->m]; k++)
        v->scan_known &= v->output.column[k] < s->n + s->m || v->output.column[k] == s->n + s->m + s->nz;
    v->is_passive = ns_verify_passive_find(v);
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
    free(v->piece);
    free(v->scan);
    free(v);
}

void ns_verify_renew(ns_verify *v) {
    const ns_system *s = v->s;
    double *most = &v->most_any[NS_VERIFY_ANY_NUMBER];
    memset(v->piece, 0, sizeof *v->piece * (size_t)s->nz);
    for (int k = 0; k < s->nz; k++)
        *most = fmax(*most, peak(&s->z[k]));
}

void ns_verify_reset(ns_verify *v) {
    const ns_system *s = v->s;
    memset(v->most_law, 0, sizeof *v->most_law * ns_verify_sizes(s));
    for (int i = 0; i < s->n; i++)
        v->times_row[i] = 1;
    for (int j = 0; j < s->m; j++)
        v->times_pair[j] = 1;
    v->most_any[NS_VERIFY_ANY_NUMBER] = least_number;
    ns_verify_renew(v);
    v->grew = 1;
    (void)ns_verify_sizes_end(v, 1);
}

void ns_verify_scale(ns_verify *v, double times) {
    v->times = times;
}

void ns_verify_allow(ns_verify *v, const ns_verify_finding *f) {
    if (f->pair >= 0)
        v->times_pair[f->pair] = ns_verify_wrong;
    if (f->unknown >= 0)
        v->times_row[f->unknown] = ns_verify_wrong;
}

double ns_verify_effort(const ns_verify *v) {
    const ns_system *s = v->s;
    return v->law.start[s->n] + v->output.start[s->m] + v->control.start[s->nc] + s->n + s->m;
}
