/* src/sparse/guards.h - guards of pairs, and of commands by the state; the mode of the engine and its bounds.
 */
#ifndef NS_SPARSE_GUARDS_H
#define NS_SPARSE_GUARDS_H

#include "sparse_internal.h"

#include <math.h>

/* The mode, and bounds of commanded pairs and of those across them with it: all at their beginning (switches
 * open, or as in closed (nc)), all as in mode (m), one pair, the bounds after several pairs were set. */
void ns_sparse_guard_reset_modes(ns_sparse *m, const unsigned char *closed);
void ns_sparse_guard_set_mode(ns_sparse *m, const ns_mode *mode);
void ns_sparse_guard_bounds(ns_sparse *m);
static inline void ns_sparse_guard_set_pair(ns_sparse *m, int j, ns_mode to) {
    m->mode[j] = to;
}
static inline void ns_sparse_guard_toggle(ns_sparse *m, int j) { /* a switch, open or closed */
    ns_sparse_guard_set_pair(m, j, ns_mode_toggled(m->mode[j]));
}

/* How many guards are broken at v by more than rounding, after an Euler step g from w (n): they are marked in
 * m->flip. */
int ns_sparse_guard_broken(ns_sparse *m, const double *v, const double *w, double g, int brief);
/* The first ones that are marked there, at most so many, are left, and their pairs marked in m->touched; how
 * many. */
int ns_sparse_guard_flip(ns_sparse *m, int most);
/* How many commands by the state v contradicts: they change, or, if they had at this event already (changed
 * (nc), or NULL), their switch slides from the mode of that step on. */
int ns_sparse_guard_commands(ns_sparse *m, const double *v, const ns_dense_step *step,
                             unsigned char *changed);
/* 1 if v contradicts command c by the state. */
int ns_sparse_guard_contradicts(const ns_sparse *m, int c, const double *v);
/* The largest y of pairs at a bound, and lambda of pairs inside, of a change v of (x, lambda). work.no_inputs
 * is zero. */
void ns_sparse_guard_largest(const ns_sparse *m, const double *v, double *y, double *lambda);
/* 1 if pair j keeps its law at v, to the last bit. */
int ns_sparse_guard_holds(const ns_sparse *m, int j, const double *v);
/* 1 if lambda, y and controls of the last of p stages are so small that no further stages are needed. */
int ns_sparse_guard_enough(const ns_sparse *m, const ns_dense_step *step, int p);
/* What the last of all stages may leave of lambda or y of pair j, whichever its guard is. */
double ns_sparse_guard_all_stages(const ns_sparse *m, int j);

/* The sizes of the terms that guards of pair j are summed from at v = (x, lambda), solved for with w and g.
 */
double ns_sparse_guard_terms(const ns_sparse *m, int j, const double *v, const double *w, double g);
/* The same, at most the largest lambda or y so far: errors of the state count relative to it. */
double ns_sparse_guard_size(const ns_sparse *m, int j, const double *v, const double *w, double g);
/* Of the rows that lambda_j enters: the least sum of the sizes of their terms over its coefficient, charges
 * and fluxes as large as errors of them count by.  Between a node of many amperes and one of few, errors of
 * lambda_j are as small as these. */
double ns_sparse_guard_least_terms(const ns_sparse *m, int j, const double *v, double g);

/* The rounding of guards of pair j at v = (x, lambda), solved for with w and g: of the sum y, or of lambda as
 * the difference that is left in the rows it enters, and of the largest lambda and y so far.  Of the control
 * of command c. */
double ns_sparse_guard_rounding(const ns_sparse *m, int j, const double *v, const double *w, double g);
double ns_sparse_guard_control_rounding(const ns_sparse *m, int c, const double *v, const double *z);
/* The same, but of lambda in that row it enters where this is least: not without ns_sparse_guard_perturb().
 */
double ns_sparse_guard_least_rounding(const ns_sparse *m, int j, const double *v, const double *w, double g);
/* The size of the terms of that control; how far a guard whose terms have this size may be off where an event
 * was located. */
double ns_sparse_guard_control_terms(const ns_sparse *m, int c, const double *v, const double *z);
static inline double ns_sparse_guard_located(const ns_sparse *m, double terms) {
    return NS_LOCATION_ERROR * m->o.reltol * terms;
}

/* By how much v changes if w changes by its rounding, with random signs: to m->work.v.  brief: of
 * ns_sparse_factors_factor(). */
int ns_sparse_guard_perturb(ns_sparse *m, const double *v, const double *w, double g, int brief);

/* How many guards pair j has, and number k of them at v; constants: 1, or 0 where constant terms are left
 * out. */
static inline int guards_of(const ns_sparse *m, int j) {
    ns_mode to[2];
    return ns_mode_guards(m->mode[j], m->l[j], m->u[j], to);
}

/* Pair j leaves its mode by guard k of it, which broke. */
static inline void ns_sparse_guard_leave(ns_sparse *m, int j, int k) {
    ns_mode to[2];
    (void)ns_mode_guards(m->mode[j], m->l[j], m->u[j], to);
    m->mode[j] = to[k];
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

/* 1 if lambda of pair j, which conducts, has the wrong sign by more than a point that is shown may have. */
static inline int has_wrong_sign(const ns_sparse *m, int j, double lambda) {
    const double allowed = 1e-5 * m->largest.lambda;
    return lambda < m->l[j] - allowed || lambda > m->u[j] + allowed;
}

/* 1 if command c depends on the state, and may change by it. */
static inline int of_state(const ns_sparse *m, int c) {
    return !ns_mode_slides(m->mode[m->s->command[c].pair]) && m->f->gx.start[c + 1] > m->f->gx.start[c];
}

/* The distance of control c from the threshold that would change it; negative: beyond. */
static inline double margin(const ns_sparse *m, int c, const double *v, const double *z, int constants) {
    const ns_command *k = &m->s->command[c];
    const int closed = m->mode[k->pair] == NS_INSIDE;
    const double g = ns_linalg_csc_dot(&m->f->gx, c, v) + ns_linalg_csc_dot(&m->f->gz, c, z);
    if (!constants)
        return closed ? g : -g;
    return closed ? (g + k->g0) - k->off : k->on - (g + k->g0);
}

#endif
