/* src/sparse/guards.c - guards of a mode after an Euler step, and which of them are broken. */
#include "guards.h"
#include "events/ties.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Below zero by no more than this, relative to the terms that it is summed from, a guard holds; a control. */
static const double rounding = 64 * DBL_EPSILON, control_rounding = 1e-12;
/* The last of few stages, or of all, may be this multiple of the error allowed. */
static const double few_stages = 0.3, all_stages = 3;

void ns_sparse_guard_reset_modes(ns_sparse *m, const unsigned char *closed) {
    for (int j = 0; j < m->f->m; j++) {
        m->l[j] = m->s->l[j];
        m->u[j] = m->s->u[j];
        m->mode[j] = isfinite(m->l[j]) ? NS_LOWER : isfinite(m->u[j]) ? NS_UPPER : NS_INSIDE;
    }
    for (int c = 0; c < m->s->nc; c++)
        m->mode[m->s->command[c].pair] =
            (closed ? closed[c] : m->s->command[c].closed) ? NS_INSIDE : NS_LOWER;
    ns_sparse_guard_bounds(m);
}

void ns_sparse_guard_set_mode(ns_sparse *m, const ns_mode *mode) {
    ns_modes_set(m->s, m->shared, m->shared_count, mode, m->mode, m->l, m->u);
}

void ns_sparse_guard_bounds(ns_sparse *m) {
    ns_sparse_guard_set_mode(m, m->mode);
}

static double sizes_of_y(const ns_sparse *m, int j, const double *v) {
    return ns_linalg_csc_size(&m->f->Ct, j, v) + fabs(m->f->e[j]);
}

/* Of the rows that lambda_j enters: the largest sum of the sizes of their other terms, over its coefficient;
 * *least: the smallest one.  w NULL: charges and fluxes are as large as errors of them count by. */
static double sizes_of_lambda(const ns_sparse *m, int j, const double *v, const double *w, double g,
                              double *least) {
    const ns_form *f = m->f;
    double largest = 0;
    *least = INFINITY;
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i >= f->n || f->KA[k] == 0)
            continue;
        double terms = ns_linalg_csc_size(&f->At, i, v) + fabs(f->b[i]);
        if (w && !f->algebraic[i])
            terms += (ns_linalg_csc_size(&f->Mt, i, v) + fabs(w[i])) / g;
        else if (!w && m->inverse_scale[i] > 0)
            terms += 1 / m->inverse_scale[i] / g;
        largest = fmax(largest, terms / fabs(f->KA[k]));
        *least = fmin(*least, terms / fabs(f->KA[k]));
    }
    return largest;
}

double ns_sparse_guard_terms(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    double least;
    if (m->mode[j] == NS_INSIDE)
        return sizes_of_lambda(m, j, v, w, g, &least);
    return sizes_of_y(m, j, v) + (ns_mode_slides(m->mode[j]) ? sizes_of_lambda(m, j, v, w, g, &least) : 0);
}

double ns_sparse_guard_least_rounding(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    double least;
    if (m->mode[j] != NS_INSIDE)
        return ns_sparse_guard_rounding(m, j, v, w, g);
    (void)sizes_of_lambda(m, j, v, w, g, &least);
    const int in_sums = m->f->summed && m->f->summed[j] < m->f->summed[j + 1];
    return (least < INFINITY ? rounding * least : 0) + (in_sums ? 0 : DBL_EPSILON * m->largest.lambda);
}

double ns_sparse_guard_rounding(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    const int inside = m->mode[j] == NS_INSIDE;
    return rounding * ns_sparse_guard_terms(m, j, v, w, g) +
           DBL_EPSILON *
               ((inside ? 0 : m->largest.y) + (inside || ns_mode_slides(m->mode[j]) ? m->largest.lambda : 0));
}

/* To m->r: rounding of the rows of x at v, with random signs.  Returns the largest unknown. */
static double fill_rounding(ns_sparse *m, const double *v, const double *w) {
    const ns_form *f = m->f;
    unsigned long long random = 88172645463325252U;
    double largest = 0;
    memset(m->r, 0, sizeof(double) * (size_t)f->size);
    for (int i = 0; i < f->n; i++) {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        const double of = f->algebraic[i] ? ns_linalg_csc_size(&f->At, i, v)
                                          : fabs(w[i]) + ns_linalg_csc_size(&f->Mt, i, v);
        m->r[i] = (random & 1024 ? 4 : -4) * DBL_EPSILON * of;
        largest = ns_higher(largest, fabs(v[i]));
    }
    return largest;
}

/* laws: with what leaks leave closed pairs of their laws, which nothing else shows where they rest at 0 V. */
static int perturb(ns_sparse *m, const double *v, const double *w, double g, int brief, int laws) {
    const ns_form *f = m->f;
    const ns_cached_factors *k;
    const int status = ns_sparse_factors_factor(m->q, g, m->mode, brief, &k);
    if (status != NS_OK)
        return status;
    const double largest = fill_rounding(m, v, w);
    for (int j = 0; j < f->m && laws && k->has_leaks; j++) {
        const double y = m->mode[j] == NS_INSIDE ? ns_sparse_form_y(f, j, v, m->z, 1) : 0;
        m->r[f->n + j] = copysign(fmin(fabs(y), DBL_EPSILON * largest), y);
    }
    (void)ns_sparse_factors_correct(m->q, k, m->r, m->work.v);
    return NS_OK;
}

int ns_sparse_guard_perturb(ns_sparse *m, const double *v, const double *w, double g, int brief) {
    return perturb(m, v, w, g, brief, 0);
}

/* 1 if pair j keeps its law at v, to the last bit; any_F: inputs enter laws. */
static inline int holds(const ns_sparse *m, int j, const double *v, int any_F) {
    const ns_mode mode = m->mode[j];
    const double lambda = v[m->f->n + j];
    if (mode == NS_INSIDE)
        return (lambda >= m->l[j]) & (lambda <= m->u[j]);
    if (!(m->l[j] < m->u[j]))
        return !ns_mode_slides(mode);
    double y = ns_linalg_csc_dot(&m->f->Ct, j, v) + m->f->e[j];
    if (any_F)
        y += ns_linalg_csc_dot(&m->f->Ft, j, m->z);
    return mode == NS_LOWER ? y >= 0 : y <= 0;
}

int ns_sparse_guard_holds(const ns_sparse *m, int j, const double *v) {
    return holds(m, j, v, m->f->Ft.start[m->f->m] > 0);
}

double ns_sparse_guard_least_terms(const ns_sparse *m, int j, const double *v, double g) {
    double least;
    (void)sizes_of_lambda(m, j, v, NULL, g, &least);
    return least;
}

double ns_sparse_guard_size(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    return ns_lower(ns_sparse_guard_terms(m, j, v, w, g),
                    m->mode[j] == NS_INSIDE ? m->largest.lambda : m->largest.y);
}

/* What a guard of pair j may be off by where an event was located, if that counts. */
static double located(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    return m->is_near ? ns_sparse_guard_located(m, ns_sparse_guard_size(m, j, v, w, g)) : 0;
}

/* 1 if a guard of pair j is negative by more than the rounding of its terms: marks it in m->flip. */
static int is_broken(ns_sparse *m, int j, const double *v, const double *w, double g) {
    const int guards = guards_of(m, j);
    for (int k = 0; k < guards; k++) {
        const double value = guard(m, j, k, v, m->z, 1);
        if (!(value < 0) ||
            value >= -(ns_sparse_guard_least_rounding(m, j, v, w, g) + located(m, j, v, w, g)))
            continue;
        m->flip[j] = (unsigned char)(1 + k);
        return 1;
    }
    return 0;
}

static int find_broken(ns_sparse *m, const double *v, const double *w, double g) {
    const int any_F = m->f->Ft.start[m->f->m] > 0, pairs = m->f->m;
    int count = 0;
    memset(m->flip, 0, (size_t)pairs);
    for (int j = 0; j < pairs; j++)
        if (!holds(m, j, v, any_F))
            count += is_broken(m, j, v, w, g);
    return count;
}

int ns_sparse_guard_broken(ns_sparse *m, const double *v, const double *w, double g, int brief) {
    int count = 0;
    if (find_broken(m, v, w, g) == 0 || perturb(m, v, w, g, brief, 1) != NS_OK)
        return 0;
    memset(m->work.no_inputs, 0, sizeof(double) * (size_t)m->f->nz);
    for (int j = 0; j < m->f->m; j++) {
        const int k = m->flip[j] - 1;
        if (k < 0)
            continue;
        const double by = fabs(guard(m, j, k, m->work.v, m->work.no_inputs, 0));
        if (guard(m, j, k, v, m->z, 1) >= -(ns_sparse_guard_least_rounding(m, j, v, w, g) + 16 * by))
            m->flip[j] = 0;
        count += m->flip[j] != 0;
    }
    return count;
}

int ns_sparse_guard_flip(ns_sparse *m, int most) {
    int count = 0;
    for (int j = 0; j < m->f->m && count < most; j++)
        if (m->flip[j]) {
            ns_sparse_guard_leave(m, j, m->flip[j] - 1);
            m->touched[j] = 1;
            count++;
        }
    return count;
}

void ns_sparse_guard_largest(const ns_sparse *m, const double *v, double *y, double *lambda) {
    *y = *lambda = 0;
    for (int j = 0; j < m->f->m; j++)
        if (m->mode[j] == NS_INSIDE)
            *lambda = ns_higher(*lambda, fabs(v[m->f->n + j]));
        else
            *y = ns_higher(*y, fabs(ns_sparse_form_y(m->f, j, v, m->work.no_inputs, 0)));
}

double ns_sparse_guard_all_stages(const ns_sparse *m, int j) {
    return all_stages * m->o.reltol * (m->mode[j] == NS_INSIDE ? m->largest.lambda : m->largest.y);
}

int ns_sparse_guard_enough(const ns_sparse *m, const ns_dense_step *step, int p) {
    const size_t last = (size_t)p - 1;
    const double *v = step->images + last * (size_t)m->f->size, *z = step->z + last * (size_t)m->f->nz,
                 little = (p < NS_ORDER ? few_stages : all_stages) * m->o.reltol;
    for (int j = 0; j < m->f->m; j++)
        if (guards_of(m, j) > 0 &&
            (m->mode[j] == NS_INSIDE ? !(fabs(v[m->f->n + j]) <= little * m->largest.lambda)
                                     : !(fabs(ns_sparse_form_y(m->f, j, v, z, 0)) <= little * m->largest.y)))
            return 0;
    for (int c = 0; c < m->s->nc; c++)
        if (of_state(m, c) &&
            !(fabs(margin(m, c, v, z, 0)) <=
              little * (ns_linalg_csc_size(&m->f->gx, c, step->images) +
                        ns_linalg_csc_size(&m->f->gz, c, step->z) + fabs(m->s->command[c].g0))))
            return 0;
    return 1;
}

/* --- commands by the state --- */

double ns_sparse_guard_control_terms(const ns_sparse *m, int c, const double *v, const double *z) {
    return ns_linalg_csc_size(&m->f->gx, c, v) + ns_linalg_csc_size(&m->f->gz, c, z) +
           fabs(m->s->command[c].g0);
}

double ns_sparse_guard_control_rounding(const ns_sparse *m, int c, const double *v, const double *z) {
    return control_rounding * ns_sparse_guard_control_terms(m, c, v, z);
}

/* A switch whose control asks for the state that it has just left slides; pairs that are no switches then
 * have the mode of the step before, in which the switch was closed.  0: it cannot slide. */
static int let_slide(ns_sparse *m, int c, const double *v, const ns_dense_step *step) {
    const int j = m->s->command[c].pair, closed = m->mode[j] == NS_INSIDE;
    if (!closed && !(step && step->mode[j] == NS_INSIDE))
        return 0;
    const double side = closed ? v[m->f->n + j] : -ns_sparse_form_y(m->f, j, v, m->z, 1);
    if (!(side < 0 || side > 0))
        return 0;
    for (int i = 0; i < m->f->m && !closed; i++)
        if (m->l[i] < m->u[i] && (isfinite(m->l[i]) || isfinite(m->u[i]))) /* not a switch */
            m->mode[i] = step->mode[i];
    m->mode[j] = ns_events_sliding_mode(side);
    return 1;
}

/* At a start a control that is zero may be off by the rounding of the largest unknown. */
static double rounding_at_start(const ns_sparse *m, const double *v) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        most = fmax(most, fabs(v[i]));
    return control_rounding * most;
}

/* The same; others: what the control may be off by beside its own rounding. */
static int contradicts(const ns_sparse *m, int c, const double *v, double others) {
    return of_state(m, c) && margin(m, c, v, m->z, 1) <
                                 -(others + m->apart[c] + ns_sparse_guard_control_rounding(m, c, v, m->z));
}

int ns_sparse_guard_contradicts(const ns_sparse *m, int c, const double *v) {
    return contradicts(m, c, v, 0);
}

int ns_sparse_guard_commands(ns_sparse *m, const double *v, const ns_dense_step *step,
                             unsigned char *changed) {
    const double others = changed && !step ? rounding_at_start(m, v) : 0;
    int count = 0;
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair;
        if (!contradicts(m, c, v, others))
            continue;
        const int slides =
            changed && ns_events_slides(&m->s->command[c], changed[c]) && let_slide(m, c, v, step);
        if (!slides)
            ns_sparse_guard_toggle(m, j);
        if (changed)
            changed[c] = (unsigned char)(1 + slides);
        count++;
    }
    if (count > 0)
        ns_sparse_guard_bounds(m);
    return count;
}
