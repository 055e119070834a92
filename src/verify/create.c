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
    const size_t n = (size_t)s->n, m = (size_t)s->m, nc = (size_t)s->nc, all = ns_verify_columns(s);
    v->numbers = calloc(4 * n + 2 * m + nc + (3 + NS_VERIFY_NODES) * all, sizeof(double));
    v->command = calloc(2 * n + m + 1, sizeof *v->command);
    if (!v->numbers || !v->command)
        return NS_E_MEMORY;
    v->algebraic = v->command + m;
    v->stored = v->algebraic + n;
    v->unit = v->numbers;
    v->sign = v->unit + n;
    v->most_law = v->sign + n;
    v->most_w = v->most_law + n;
    v->most_lambda = v->most_w + n;
    v->most_y = v->most_lambda + m;
    v->most_control = v->most_y + m;
    v->u = v->most_control + nc;
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
    free(v);
}

void ns_verify_reset(ns_verify *v) {
    const ns_system *s = v->s;
    const size_t sizes = 2 * (size_t)s->n + 2 * (size_t)s->m + (size_t)s->nc;
    memset(v->most_law, 0, sizeof *v->most_law * sizes);
    v->most_any_lambda = v->most_any_y = v->most_energy = 0;
    v->most_number = least_number;
    for (int k = 0; k < s->nz; k++)
        v->most_number = fmax(v->most_number, peak(&s->z[k]));
}

void ns_verify_allow(ns_verify *v, double times) {
    v->times = times;
}

double ns_verify_effort(const ns_verify *v) {
    const ns_system *s = v->s;
    return v->law.start[s->n] + v->output.start[s->m] + v->control.start[s->nc] + s->n + s->m;
}
