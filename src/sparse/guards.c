/* src/sparse/guards.c - guards of a mode after an Euler step, and which of them are broken. */
#include "guards.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What a guard may be below zero by, relative to the terms it is summed from, and of a control. */
static const double rounding = 64 * DBL_EPSILON, control_rounding = 1e-12;

void ns_sparse_guard_bounds(ns_sparse *m) {
    ns_modes_shared_bound(m->s, m->twin, m->twins, m->mode, m->l, m->u);
}

void ns_sparse_guard_set(ns_sparse *m, int j, int upper) {
    if (ns_mode_slides(m->mode[j]))
        m->mode[j] = upper ? NS_INSIDE : NS_LOWER; /* y is used up, or lambda */
    else if (m->mode[j] == NS_INSIDE)
        m->mode[j] = upper ? NS_UPPER : NS_LOWER;
    else
        m->mode[j] = NS_INSIDE;
}

static double terms_of_y(const ns_sparse *m, int j, const double *v) {
    return ns_linalg_csc_size(&m->f->Ct, j, v) + fabs(m->f->e[j]);
}

/* The largest of what is left over in the rows that lambda_j enters. */
static double terms_of_lambda(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    const ns_form *f = m->f;
    double most = 0;
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i >= f->n || f->KA[k] == 0)
            continue;
        double terms = ns_linalg_csc_size(&f->At, i, v) + fabs(f->b[i]);
        if (!f->algebraic[i])
            terms += (ns_linalg_csc_size(&f->Mt, i, v) + fabs(w[i])) / g;
        most = fmax(most, terms / fabs(f->KA[k]));
    }
    return most;
}

double ns_sparse_guard_terms(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    if (m->mode[j] == NS_INSIDE)
        return terms_of_lambda(m, j, v, w, g);
    return terms_of_y(m, j, v) + (ns_mode_slides(m->mode[j]) ? terms_of_lambda(m, j, v, w, g) : 0);
}

double ns_sparse_guard_rounding(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    const int inside = m->mode[j] == NS_INSIDE;
    return rounding * ns_sparse_guard_terms(m, j, v, w, g) +
           DBL_EPSILON *
               ((inside ? 0 : m->most_y) + (inside || ns_mode_slides(m->mode[j]) ? m->most_lambda : 0));
}

int ns_sparse_guard_perturb(ns_sparse *m, const double *v, const double *w, double g, int brief) {
    const ns_form *f = m->f;
    const ns_kept_factors *k;
    unsigned long long dice = 88172645463325252U;
    const int status = ns_sparse_factors_factor(m->q, g, m->mode, brief, &k);
    if (status != NS_OK)
        return status;
    memset(m->r, 0, sizeof(double) * (size_t)f->size);
    for (int i = 0; i < f->n; i++) {
        dice ^= dice << 13;
        dice ^= dice >> 7;
        dice ^= dice << 17;
        const double of = f->algebraic[i] ? ns_linalg_csc_size(&f->At, i, v)
                                          : fabs(w[i]) + ns_linalg_csc_size(&f->Mt, i, v);
        m->r[i] = (dice & 1024 ? 4 : -4) * DBL_EPSILON * of;
    }
    (void)ns_sparse_factors_solve(m->q, k, m->r, m->next_v);
    return NS_OK;
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

/* Whether a guard of pair j is negative by more than the sum of its terms explains; marks it in m->flip. */
static int is_broken(ns_sparse *m, int j, const double *v, const double *w, double g) {
    const int guards = guards_of(m, j);
    for (int k = 0; k < guards; k++) {
        const double value = guard(m, j, k, v, m->z, 1);
        if (!(value < 0) || value >= -ns_sparse_guard_rounding(m, j, v, w, g))
            continue;
        m->flip[j] = (unsigned char)(1 + is_upper(m, j, k));
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
    if (find_broken(m, v, w, g) == 0 || ns_sparse_guard_perturb(m, v, w, g, brief) != NS_OK)
        return 0;
    memset(m->z_none, 0, sizeof(double) * (size_t)m->f->nz);
    for (int j = 0; j < m->f->m; j++) {
        const int k = m->flip[j] == 2 && guards_of(m, j) == 2;
        if (!m->flip[j])
            continue;
        const double by = fabs(guard(m, j, k, m->next_v, m->z_none, 0));
        if (guard(m, j, k, v, m->z, 1) >= -(ns_sparse_guard_rounding(m, j, v, w, g) + 16 * by))
            m->flip[j] = 0;
        count += m->flip[j] != 0;
    }
    return count;
}

int ns_sparse_guard_flip(ns_sparse *m, const double *v, const double *w, double g, int brief) {
    const int count = ns_sparse_guard_broken(m, v, w, g, brief);
    for (int j = 0; j < m->f->m && count > 0; j++)
        if (m->flip[j]) {
            ns_sparse_guard_set(m, j, m->flip[j] == 2);
            m->touched[j] = 1;
        }
    return count;
}

/* --- commands of the state --- */

double ns_sparse_guard_control_rounding(const ns_sparse *m, int c, const double *v, const double *z) {
    return control_rounding * (ns_linalg_csc_size(&m->f->gx, c, v) + ns_linalg_csc_size(&m->f->gz, c, z) +
                               fabs(m->s->command[c].g0));
}

/* Where a switch wants back what it has just left it stays between, beside what conducts while it is closed;
 * 0: it cannot. */
static int let_slide(ns_sparse *m, int c, const double *v, const ns_dense_step *leg) {
    const int j = m->s->command[c].pair, closed = m->mode[j] == NS_INSIDE;
    if (m->f->command[j] != c || (!closed && !(leg && leg->mode[j] == NS_INSIDE)))
        return 0;
    const double side = closed ? v[m->f->n + j] : -ns_sparse_form_y(m->f, j, v, m->z, 1);
    if (!(side < 0 || side > 0))
        return 0;
    for (int i = 0; i < m->f->m && !closed; i++)
        if (m->l[i] < m->u[i] && (isfinite(m->l[i]) || isfinite(m->u[i]))) /* not a switch */
            m->mode[i] = leg->mode[i];
    m->mode[j] = side > 0 ? NS_SLIDES_UP : NS_SLIDES_DOWN;
    return 1;
}

int ns_sparse_guard_commands(ns_sparse *m, const double *v, const ns_dense_step *leg,
                             unsigned char *changed) {
    int count = 0;
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair;
        if (!of_state(m, c) || margin(m, c, v, m->z, 1) >= -ns_sparse_guard_control_rounding(m, c, v, m->z))
            continue;
        const int slides = changed && changed[c] && let_slide(m, c, v, leg);
        if (!slides)
            m->mode[j] = m->mode[j] == NS_INSIDE ? NS_LOWER : NS_INSIDE;
        if (changed)
            changed[c] = (unsigned char)(1 + slides);
        count++;
    }
    if (count > 0)
        ns_sparse_guard_bounds(m);
    return count;
}
