/* src/sparse/guards.h - guards of pairs, and of commands of the state, by numbers. */
#ifndef NS_SPARSE_GUARDS_H
#define NS_SPARSE_GUARDS_H

#include "sparse_internal.h"

#include <math.h>

/* What guards of pair j are summed from at v = (x, lambda), which was solved for with w and g. */
double ns_sparse_guard_terms(const ns_sparse *m, int j, const double *v, const double *w, double g);

/* The rounding of guards of pair j at v = (x, lambda), which was solved for with w and g: of the sum y, or of
 * lambda as what is left over in the rows it enters; where all of these are zero, beside the largest there
 * was.  Of the control of command c. */
double ns_sparse_guard_rounding(const ns_sparse *m, int j, const double *v, const double *w, double g);
double ns_sparse_guard_control_rounding(const ns_sparse *m, int c, const double *v, const double *z);

/* What v may be off by where w is off by its rounding, at random: to m->next_v.  brief: of
 * ns_sparse_factors_factor().
 */
int ns_sparse_guard_perturb(ns_sparse *m, const double *v, const double *w, double g, int brief);

/* Guards of pair j: how many, and number k of them at (lambda_j, y_j), what is constant in it counted so many
 * times. */
static inline int guards_of(const ns_sparse *m, int j) {
    if (ns_mode_slides(m->mode[j]))
        return 2;
    return m->mode[j] == NS_INSIDE ? isfinite(m->l[j]) + isfinite(m->u[j]) : m->l[j] < m->u[j];
}

static inline int is_upper(const ns_sparse *m, int j, int k) {
    return k == 1 || !isfinite(m->l[j]);
}

static inline double guard(const ns_sparse *m, int j, int k, const double *v, const double *z,
                           int constants) {
    const double lambda = v[m->f->n + j];
    if (m->mode[j] != NS_INSIDE) {
        const double y = ns_sparse_form_y(m->f, j, v, z, constants);
        if (ns_mode_slides(m->mode[j]))
            return (m->mode[j] == NS_SLIDES_UP ? 1 : -1) * (k == 1 ? -y : lambda);
        return m->mode[j] == NS_LOWER ? y : -y;
    }
    return is_upper(m, j, k) ? (constants ? m->u[j] : 0) - lambda : lambda - (constants ? m->l[j] : 0);
}

/* 1 if command c looks at the state, and may change by it. */
static inline int of_state(const ns_sparse *m, int c) {
    return !ns_mode_slides(m->mode[m->s->command[c].pair]) && m->f->gx.start[c + 1] > m->f->gx.start[c];
}

/* By how much control c stays on its side of the threshold that would change it. */
static inline double margin(const ns_sparse *m, int c, const double *v, const double *z, int constants) {
    const ns_command *k = &m->s->command[c];
    const int closed = m->mode[k->pair] == NS_INSIDE;
    const double g = ns_linalg_csc_dot(&m->f->gx, c, v) + ns_linalg_csc_dot(&m->f->gz, c, z);
    if (!constants)
        return closed ? g : -g;
    return closed ? (g + k->g0) - k->off : k->on - (g + k->g0);
}

#endif
