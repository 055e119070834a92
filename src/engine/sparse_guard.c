/* src/engine/sparse_guard.c - guards of a mode: after an Euler step, and over a leg.
 *
 * Over a leg a guard is a polynomial (E1).  A bound by its coefficients tells that most hold; the others are
 * looked into (sparse_search.h).
 */
#include "../linalg/lanes.h"
#include "sparse_march.h"
#include "sparse_search.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What a guard may be below zero by, relative to the terms it is summed from, and of a control. */
static const double rounding = 64 * DBL_EPSILON, control_rounding = 1e-12;
/* What the last of few stages may be of the error allowed; and what a crossing may be off by of the state. */
static const double few_share = 0.3, instant_share = 0.1;

void ns_guard_bounds(ns_sparse *m) {
    ns_twins_bound(m->s, m->twin, m->twins, m->mode, m->l, m->u);
}

void ns_guard_set(ns_sparse *m, int j, int upper) {
    if (ns_slides(m->mode[j]))
        m->mode[j] = upper ? NS_INSIDE : NS_LOWER; /* y is used up, or lambda */
    else if (m->mode[j] == NS_INSIDE)
        m->mode[j] = upper ? NS_UPPER : NS_LOWER;
    else
        m->mode[j] = NS_INSIDE;
}

/* The rounding of y_j at v. */
static double noise_of_y(const ns_sparse *m, int j, const double *v) {
    return rounding * (ns_csc_size(&m->f->Ct, j, v) + fabs(m->f->e[j])) + DBL_EPSILON * m->most_y;
}

/* The rounding of guards of pair j at v = (x, lambda), which was solved for with w and g: of the sum y, or of
 * lambda as what is left over in the rows it enters; where all of these are zero, beside the largest there
 * was. */
static double noise(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    const ns_form *f = m->f;
    double most = 0;
    if (m->mode[j] != NS_INSIDE && !ns_slides(m->mode[j]))
        return noise_of_y(m, j, v);
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i >= f->n || f->KA[k] == 0)
            continue;
        double terms = ns_csc_size(&f->At, i, v) + fabs(f->b[i]);
        if (!f->algebraic[i])
            terms += (ns_csc_size(&f->Mt, i, v) + fabs(w[i])) / g;
        most = fmax(most, terms / fabs(f->KA[k]));
    }
    return rounding * most + DBL_EPSILON * m->most_lambda + (ns_slides(m->mode[j]) ? noise_of_y(m, j, v) : 0);
}

/* Guards of pair j: how many, and number k of them at (lambda_j, y_j), what is constant in it counted so many
 * times. */
static int guards_of(const ns_sparse *m, int j) {
    if (ns_slides(m->mode[j]))
        return 2;
    return m->mode[j] == NS_INSIDE ? isfinite(m->l[j]) + isfinite(m->u[j]) : m->l[j] < m->u[j];
}

static int is_upper(const ns_sparse *m, int j, int k) {
    return k == 1 || !isfinite(m->l[j]);
}

static double guard(const ns_sparse *m, int j, int k, const double *v, const double *z, int constants) {
    const double lambda = v[m->f->n + j];
    if (m->mode[j] != NS_INSIDE) {
        const double y = ns_form_y(m->f, j, v, z, constants);
        if (ns_slides(m->mode[j]))
            return (m->mode[j] == NS_SLIDES_UP ? 1 : -1) * (k == 1 ? -y : lambda);
        return m->mode[j] == NS_LOWER ? y : -y;
    }
    return is_upper(m, j, k) ? (constants ? m->u[j] : 0) - lambda : lambda - (constants ? m->l[j] : 0);
}

/* What v may be off by where w is off by its rounding, at random: to m->next_v. */
static int shake(ns_sparse *m, const double *v, const double *w, double g) {
    const ns_form *f = m->f;
    const ns_kept *k;
    unsigned long long dice = 88172645463325252U;
    const int status = ns_modal_factor(m->q, g, m->mode, 1, &k);
    if (status != NS_OK)
        return status;
    memset(m->r, 0, sizeof(double) * (size_t)f->size);
    for (int i = 0; i < f->n; i++) {
        dice ^= dice << 13;
        dice ^= dice >> 7;
        dice ^= dice << 17;
        const double of =
            f->algebraic[i] ? ns_csc_size(&f->At, i, v) : fabs(w[i]) + ns_csc_size(&f->Mt, i, v);
        m->r[i] = (dice & 1024 ? 4 : -4) * DBL_EPSILON * of;
    }
    (void)ns_modal_solve(m->q, k, m->r, m->next_v);
    return NS_OK;
}

/* 1 if pair j keeps its law at v, to the last bit; any_F: inputs enter laws. */
static inline int holds(const ns_sparse *m, int j, const double *v, int any_F) {
    const ns_mode mode = m->mode[j];
    const double lambda = v[m->f->n + j];
    if (mode == NS_INSIDE)
        return (lambda >= m->l[j]) & (lambda <= m->u[j]);
    if (!(m->l[j] < m->u[j]))
        return !ns_slides(mode);
    double y = ns_csc_dot(&m->f->Ct, j, v) + m->f->e[j];
    if (any_F)
        y += ns_csc_dot(&m->f->Ft, j, m->z);
    return mode == NS_LOWER ? y >= 0 : y <= 0;
}

/* Whether a guard of pair j is negative by more than the sum of its terms explains; marks it in m->flip. */
static int is_broken(ns_sparse *m, int j, const double *v, const double *w, double g) {
    const int guards = guards_of(m, j);
    for (int k = 0; k < guards; k++) {
        const double value = guard(m, j, k, v, m->z, 1);
        if (!(value < 0) || value >= -noise(m, j, v, w, g))
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

int ns_guard_broken(ns_sparse *m, const double *v, const double *w, double g) {
    int count = 0;
    if (find_broken(m, v, w, g) == 0 || shake(m, v, w, g) != NS_OK)
        return 0;
    memset(m->z_none, 0, sizeof(double) * (size_t)m->f->nz);
    for (int j = 0; j < m->f->m; j++) {
        const int k = m->flip[j] == 2 && guards_of(m, j) == 2;
        if (!m->flip[j])
            continue;
        const double by = fabs(guard(m, j, k, m->next_v, m->z_none, 0));
        if (guard(m, j, k, v, m->z, 1) >= -(noise(m, j, v, w, g) + 16 * by))
            m->flip[j] = 0;
        count += m->flip[j] != 0;
    }
    return count;
}

int ns_guard_flip(ns_sparse *m, const double *v, const double *w, double g) {
    const int count = ns_guard_broken(m, v, w, g);
    for (int j = 0; j < m->f->m && count > 0; j++)
        if (m->flip[j]) {
            ns_guard_set(m, j, m->flip[j] == 2);
            m->touched[j] = 1;
        }
    return count;
}

/* --- commands of the state --- */

/* 1 if command c looks at the state, and may change by it. */
static int of_state(const ns_sparse *m, int c) {
    return !ns_slides(m->mode[m->s->command[c].pair]) && m->f->gx.start[c + 1] > m->f->gx.start[c];
}

/* By how much control c stays on its side of the threshold that would change it. */
static double margin(const ns_sparse *m, int c, const double *v, const double *z, int constants) {
    const ns_command *k = &m->s->command[c];
    const int closed = m->mode[k->pair] == NS_INSIDE;
    const double g = ns_csc_dot(&m->f->gx, c, v) + ns_csc_dot(&m->f->gz, c, z);
    if (!constants)
        return closed ? g : -g;
    return closed ? (g + k->g0) - k->off : k->on - (g + k->g0);
}

static double control_noise(const ns_sparse *m, int c, const double *v, const double *z) {
    return control_rounding *
           (ns_csc_size(&m->f->gx, c, v) + ns_csc_size(&m->f->gz, c, z) + fabs(m->s->command[c].g0));
}

/* Where a switch wants back what it has just left it stays between, beside what conducts while it is closed;
 * 0: it cannot. */
static int let_slide(ns_sparse *m, int c, const double *v, const ns_leg *leg) {
    const int j = m->s->command[c].pair, closed = m->mode[j] == NS_INSIDE;
    if (m->f->command[j] != c || (!closed && !(leg && leg->mode[j] == NS_INSIDE)))
        return 0;
    const double side = closed ? v[m->f->n + j] : -ns_form_y(m->f, j, v, m->z, 1);
    if (!(side < 0 || side > 0))
        return 0;
    for (int i = 0; i < m->f->m && !closed; i++)
        if (m->l[i] < m->u[i] && (isfinite(m->l[i]) || isfinite(m->u[i]))) /* not a switch */
            m->mode[i] = leg->mode[i];
    m->mode[j] = side > 0 ? NS_SLIDES_UP : NS_SLIDES_DOWN;
    return 1;
}

int ns_guard_commands(ns_sparse *m, const double *v, const ns_leg *leg, unsigned char *changed) {
    int count = 0;
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair;
        if (!of_state(m, c) || margin(m, c, v, m->z, 1) >= -control_noise(m, c, v, m->z))
            continue;
        const int slides = changed && changed[c] && let_slide(m, c, v, leg);
        if (!slides)
            m->mode[j] = m->mode[j] == NS_INSIDE ? NS_LOWER : NS_INSIDE;
        if (changed)
            changed[c] = (unsigned char)(1 + slides);
        count++;
    }
    if (count > 0)
        ns_guard_bounds(m);
    return count;
}

/* --- over a leg --- */

/* 1 if a bound by the coefficients of guard k of pair j tells that it holds, but for what it may be below
 * zero by. */
static int surely_holds(const ns_sparse *m, const ns_leg *leg, int j, int k) {
    const size_t size = (size_t)m->f->size, nz = (size_t)m->f->nz,
                 stages = leg->stages < NS_ORDER ? (size_t)leg->stages : NS_ORDER;
    double least;
    if (m->mode[j] == NS_INSIDE) {
        const double *lambda = leg->xi + m->f->n + j, little = -m->o.reltol * m->most_lambda;
        least = is_upper(m, j, k) ? m->u[j] - lambda[0] : lambda[0] - m->l[j];
        for (size_t i = 1; i < stages && least > little; i++)
            least -= ns_laguerre_most[i] * fabs(lambda[i * size]);
        return least > little;
    }
    const double little = ns_slides(m->mode[j]) ? 0 : -m->o.reltol * m->most_y;
    least = guard(m, j, k, leg->xi, leg->z, 1);
    for (size_t i = 1; i < stages && least > little; i++)
        least -= ns_laguerre_most[i] * fabs(guard(m, j, k, leg->xi + i * size, leg->z + i * nz, 0));
    return least > little;
}

static void coefficients(const ns_sparse *m, const ns_leg *leg, int terms, int pair, int k, int command,
                         double *G) {
    const size_t size = (size_t)m->f->size, nz = (size_t)m->f->nz;
    for (int i = 0; i < terms; i++) {
        const double *v = leg->xi + (size_t)i * size, *z = leg->z + (size_t)i * nz;
        G[i] = pair >= 0 ? guard(m, pair, k, v, z, i == 0) : margin(m, command, v, z, i == 0);
    }
}

typedef struct found {
    double at; /* share of the leg */
    int pair, k, command;
} found;

/* The next coefficient, guessed from the last two: what a guard is off by at the start of a leg. */
static double cut_off(const double *G, int terms) {
    const double last = fabs(G[terms - 1]), before = fabs(G[terms - 2]);
    return last < before ? 2 * last * (last / before) : last;
}

/* Where in the leg, before share `before` of it, a guard breaks by the coefficients there are; NAN: it does
 * not. */
static double breaks(const ns_sparse *m, const ns_leg *leg, int terms, const found *f, double before,
                     ns_curve *c) {
    const double size = f->pair < 0 ? 0 : m->mode[f->pair] == NS_INSIDE ? m->most_lambda : m->most_y;
    double G[NS_STAGES];
    ns_curve part;
    coefficients(m, leg, terms, f->pair, f->k, f->command, G);
    ns_curve_of(terms, G, leg->end / leg->g, c);
    before = before < 1 ? before : 1;
    ns_curve_cut(c, before, &part);
    const double tol = cut_off(G, terms) + m->o.reltol * size;
    if (ns_curve_holds(&part, tol))
        return NAN;
    return before *
           ns_curve_below(&part, tol + (f->pair >= 0 ? noise(m, f->pair, leg->xi, leg->dw, leg->g)
                                                     : control_noise(m, f->command, leg->xi, leg->z)));
}

/* By how much of the leg the crossing is off as later stages are missing. */
static double off_by(const ns_sparse *m, const ns_leg *leg, const found *f, const ns_curve *c) {
    double G[NS_STAGES];
    coefficients(m, leg, leg->stages, f->pair, f->k, f->command, G);
    return cut_off(G, leg->stages) / fabs(ns_curve_slope(c, f->at));
}

/* How the state moves in the leg, beside its scales. */
static double moves(const ns_sparse *m, const ns_leg *leg) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (fabs(leg->dw[m->f->n + i]) > most * m->scale[i])
            most = fabs(leg->dw[m->f->n + i]) / m->scale[i];
    return most * leg->end / leg->g;
}

/* Looks for one guard's crossing before the first found so far: roughly, then with so many stages more that
 * it is as exact as the step. */
static int look(ns_sparse *m, ns_leg *leg, found next, found *f) {
    ns_curve c;
    if (next.pair >= 0 && surely_holds(m, leg, next.pair, next.k))
        return NS_OK;
    if (!(breaks(m, leg, leg->stages < NS_ORDER ? leg->stages : NS_ORDER, &next, f->at, &c) < f->at))
        return NS_OK;
    do {
        const int status = ns_leg_more(m, leg);
        if (status != NS_OK)
            return status;
        next.at = breaks(m, leg, leg->stages, &next, 1, &c);
        if (next.at > 0)
            next.at = ns_curve_root(&c, next.at);
    } while (leg->stages < NS_STAGES &&
             !(off_by(m, leg, &next, &c) * moves(m, leg) <= instant_share * m->o.reltol));
    if (next.at < f->at)
        *f = next;
    return NS_OK;
}

void ns_guard_sizes(ns_sparse *m, const double *v) {
    for (int j = 0; j < m->f->m; j++) {
        m->most_lambda = ns_higher(fabs(v[m->f->n + j]), m->most_lambda);
        m->most_y = ns_higher(fabs(ns_csc_dot(&m->f->Ct, j, v)), m->most_y);
    }
}

int ns_guard_enough(const ns_sparse *m, const ns_leg *leg, int p) {
    const size_t last = (size_t)p - 1;
    const double *v = leg->xi + last * (size_t)m->f->size, *z = leg->z + last * (size_t)m->f->nz,
                 little = few_share * m->o.reltol;
    for (int j = 0; j < m->f->m; j++)
        if (guards_of(m, j) > 0 &&
            (m->mode[j] == NS_INSIDE ? !(fabs(v[m->f->n + j]) <= little * m->most_lambda)
                                     : !(fabs(ns_form_y(m->f, j, v, z, 0)) <= little * m->most_y)))
            return 0;
    for (int c = 0; c < m->s->nc; c++)
        if (of_state(m, c) && !(fabs(margin(m, c, v, z, 0)) <=
                                little * (ns_csc_size(&m->f->gx, c, leg->xi) +
                                          ns_csc_size(&m->f->gz, c, leg->z) + fabs(m->s->command[c].g0))))
            return 0;
    return 1;
}

int ns_guard_first(ns_sparse *m, ns_leg *leg) {
    found f = {INFINITY, -1, 0, -1};
    int status = NS_OK;
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        for (int k = 0; k < guards && status == NS_OK; k++)
            status = look(m, leg, (found){NAN, j, k, -1}, &f);
    }
    for (int c = 0; c < m->s->nc && status == NS_OK; c++)
        if (of_state(m, c))
            status = look(m, leg, (found){NAN, -1, 0, c}, &f);
    if (status != NS_OK || !(f.at <= 1))
        return status;
    leg->why = NS_LEG_EVENT;
    leg->pair = f.pair;
    leg->command = f.command;
    leg->upper = f.pair >= 0 && is_upper(m, f.pair, f.k);
    if (f.at < 1) {
        leg->end *= f.at;
        leg->end_t = ns_lower(leg->end_t, ns_higher(leg->t, leg->t + (leg->past_t + leg->end)));
    }
    return status;
}

int ns_guard_starts(ns_sparse *m, const ns_leg *leg, double share) {
    const size_t size = (size_t)m->f->size, last = (size_t)leg->stages - 1;
    const double *v_last = leg->xi + last * size, *z_last = leg->z + last * (size_t)m->f->nz;
    ns_leg_point(m, leg, 0, m->next_v);
    (void)ns_inputs_stage(m->in, leg->t, 0, 0, m->z);
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        const double little = share * (m->mode[j] == NS_INSIDE ? m->most_lambda : m->most_y);
        for (int k = 0; k < guards; k++) {
            const double value = guard(m, j, k, m->next_v, m->z, 1) + little;
            if (!(value >= 0) && !(value + 4 * fabs(guard(m, j, k, v_last, z_last, 0)) +
                                       noise(m, j, m->next_v, leg->dw, leg->g) >=
                                   0))
                return 0;
        }
    }
    return 1;
}
