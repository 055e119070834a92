/* src/energy/accumulate.c - charge and energy of elements, summed up node by node and jump by jump. */
#include "energy_internal.h"

#include <math.h>
#include <stdlib.h>

/* --- made --- */

typedef struct term_list {
    ns_current_term *term; /* NULL: counted only */
    int count;
} term_list;

static void list_term(void *to, int index, double gain) {
    term_list *l = to;
    if (l->term)
        l->term[l->count] = (ns_current_term){index, gain};
    l->count++;
}

static void list_terms(ns_energy *e, const int *id, term_list *l) {
    for (int k = 0; k < e->count; k++) {
        ns_watched *w = &e->of[k];
        w->first = l->count;
        w->branch = ns_circuit_branch(e->c, id ? id[k] : k, list_term, l);
        w->terms = l->count - w->first;
    }
}

static int make(ns_energy *e, const int *id) {
    term_list l = {NULL, 0};
    e->of = calloc((size_t)e->count + 1, sizeof *e->of);
    if (!e->of)
        return NS_E_MEMORY;
    list_terms(e, id, &l);
    e->term = calloc((size_t)l.count + 1, sizeof *e->term);
    if (!e->term)
        return NS_E_MEMORY;
    l = (term_list){e->term, 0};
    list_terms(e, id, &l);
    return ns_energy_path_create(e);
}

int ns_energy_create(const ns_circuit *c, int count, const int *id, ns_energy **out) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!c)
        return NS_E_NULL;
    const int all = ns_circuit_branch_count(c);
    if (id && count < 0)
        return NS_E_SIZE;
    for (int k = 0; id && k < count; k++)
        if (id[k] < 0 || id[k] >= all)
            return NS_E_SIZE;
    ns_energy *e = calloc(1, sizeof *e);
    if (!e)
        return NS_E_MEMORY;
    e->c = c;
    e->count = id ? count : all;
    e->unknowns = ns_circuit_branch_unknowns(c);
    e->pairs = ns_circuit_branch_pairs(c);
    const int status = make(e, id);
    if (status != NS_OK) {
        ns_energy_free(e);
        return status;
    }
    *out = e;
    return NS_OK;
}

void ns_energy_free(ns_energy *e) {
    if (!e)
        return;
    free(e->of);
    free(e->term);
    free(e->block);
    free(e->part);
    free(e->step);
    free(e->begin);
    free(e);
}

int ns_energy_count(const ns_energy *e) {
    return e ? e->count : 0;
}

long ns_energy_nodes(const ns_energy *e) {
    return e ? e->nodes : 0;
}

/* --- summed up --- */

void ns_energy_sum(ns_sum *to, double value) {
    const double sum = to->sum + value;
    to->lost += fabs(to->sum) >= fabs(value) ? (to->sum - sum) + value : (value - sum) + to->sum;
    to->sum = sum;
}

/* The terms of a current. */
static double terms_of(const ns_energy *e, const ns_watched *w, const double *x, const double *lambda) {
    const ns_current_term *t = e->term + w->first;
    double sum = 0;
    for (int k = 0; k < w->terms; k++)
        sum += t[k].gain * (t[k].index < e->unknowns ? x[t[k].index] : lambda[t[k].index - e->unknowns]);
    return sum;
}

/* What is put out whatever the solution is. */
static double given(const ns_branch *b, double t, ns_side side) {
    return b->amperes + (b->signal ? ns_signal_value(b->signal, t, side) : 0);
}

void ns_energy_branch(const ns_energy *e, const ns_watched *w, const ns_solution *at, double *v, double *i) {
    const ns_branch *b = &w->branch;
    *v = ns_branch_voltage(b, at->x);
    *i = terms_of(e, w, at->x, at->lambda) + b->siemens * *v + given(b, at->t, at->side);
    if (b->farads != 0 && at->rates)
        *i += b->farads * ns_branch_voltage(b, at->rates);
}

int ns_energy_add(ns_energy *e, double seconds, const ns_solution *at) {
    if (!e || !at)
        return NS_E_NULL;
    for (int k = 0; k < e->count; k++) {
        ns_watched *w = &e->of[k];
        double v, i;
        ns_energy_branch(e, w, at, &v, &i);
        ns_energy_sum(&w->q, seconds * i);
        ns_energy_sum(&w->joule, seconds * v * i);
    }
    e->nodes++;
    return NS_OK;
}

int ns_energy_jump(ns_energy *e, const ns_solution *before, const ns_solution *after, const double *x,
                   const double *lambda) {
    if (!e || !before || !after)
        return NS_E_NULL;
    ns_energy_path_begin(e, after->t, before->x, e->begin);
    const double seconds = after->t - before->t; /* of short steps, if any, in which v and i pass too */
    for (int k = 0; k < e->count; k++) {
        ns_watched *w = &e->of[k];
        double v[2], i[2];
        ns_energy_branch(e, w, before, &v[0], &i[0]);
        ns_energy_branch(e, w, after, &v[1], &i[1]);
        const double flux = ns_branch_voltage(&w->branch, x),
                     charge = terms_of(e, w, x, lambda) + w->branch.siemens * flux +
                              seconds * given(&w->branch, after->t, NS_RIGHT);
        const double begin = ns_branch_voltage(&w->branch, e->begin);
        const double mean_v = (begin + v[1]) / 2, mean_i = (i[0] + i[1]) / 2;
        ns_energy_sum(&w->q, charge);
        ns_energy_sum(&w->joule, mean_v * charge + mean_i * flux - seconds * mean_v * mean_i);
    }
    return NS_OK;
}

int ns_energy_point(ns_energy *e, const ns_solution *at) {
    if (!e || !at)
        return NS_E_NULL;
    for (int k = 0; k < e->count; k++) {
        ns_watched *w = &e->of[k];
        ns_energy_branch(e, w, at, &w->v, &w->i);
        if (w->branch.farads != 0 && !at->rates)
            w->i = NAN;
    }
    return NS_OK;
}

int ns_energy_begin(ns_energy *e, const ns_solution *at) {
    const int status = ns_energy_point(e, at);
    for (int k = 0; status == NS_OK && k < e->count; k++) {
        ns_watched *w = &e->of[k];
        w->v0 = w->v;
        w->q = w->joule = (ns_sum){0, 0};
    }
    return status;
}

int ns_energy_read(const ns_energy *e, int k, double *p, double *q, double *joule) {
    if (!e)
        return NS_E_NULL;
    if (k < 0 || k >= e->count)
        return NS_E_SIZE;
    const ns_watched *w = &e->of[k];
    const double f = w->branch.farads, charge = f * (w->v - w->v0);
    if (p)
        *p = w->v * w->i;
    if (q)
        *q = f != 0 ? charge : w->q.sum + w->q.lost;
    if (joule)
        *joule = f != 0 ? charge * (w->v + w->v0) / 2 : w->joule.sum + w->joule.lost;
    return NS_OK;
}
