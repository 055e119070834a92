/* src/sparse/event_location.c - guards over a leg: the first that breaks.
 *
 * There a guard is a polynomial (E1).  Bounds by its coefficients tell that most hold; the others are looked
 * into (bernstein_root.h).
 */
#include "guards.h"
#include "linalg/simd.h"
#include "modes/bernstein_root.h"

#include <math.h>
#include <string.h>

/* What the last of few stages, or of all, may be of the error allowed; and what a crossing may be off by of
 * the state. */
static const double few_share = 0.3, all_share = 3, instant_share = 0.1;
/* Of the error allowed, what lambda and y may be below zero by: whoever is so when another one changes may
 * have to change with it. */
static const double below = 0.1;
/* Below zero by less than this share of the largest unknown: perhaps by rounding. */
static const double shallow = 1e-7;

/* 1 if a bound by the coefficients of guard k of pair j tells that it holds. */
static int surely_holds(const ns_sparse *m, const ns_dense_step *leg, int j, int k) {
    const size_t size = (size_t)m->f->size, nz = (size_t)m->f->nz,
                 stages = leg->stages < NS_ORDER ? (size_t)leg->stages : NS_ORDER;
    double least;
    if (m->mode[j] == NS_INSIDE) {
        const double *lambda = leg->xi + m->f->n + j;
        least = is_upper(m, j, k) ? m->u[j] - lambda[0] : lambda[0] - m->l[j];
        for (size_t i = 1; i < stages && least > 0; i++)
            least -= ns_modes_laguerre_max[i] * fabs(lambda[i * size]);
        return least > 0;
    }
    least = guard(m, j, k, leg->xi, leg->z, 1);
    for (size_t i = 1; i < stages && least > 0; i++)
        least -= ns_modes_laguerre_max[i] * fabs(guard(m, j, k, leg->xi + i * size, leg->z + i * nz, 0));
    return least > 0;
}

/* How large what a guard of pair j is summed from is, and no larger than lambda and y ever were: beside it
 * counts what the state is off by. */
static double size_of(const ns_sparse *m, const ns_dense_step *leg, int j) {
    return ns_lower(ns_sparse_guard_terms(m, j, leg->xi, leg->dw, leg->g),
                    m->mode[j] == NS_INSIDE ? m->most_lambda : m->most_y);
}

static void coefficients(const ns_sparse *m, const ns_dense_step *leg, int terms, int pair, int k,
                         int command, double *G) {
    const size_t size = (size_t)m->f->size, nz = (size_t)m->f->nz;
    for (int i = 0; i < terms; i++) {
        const double *v = leg->xi + (size_t)i * size, *z = leg->z + (size_t)i * nz;
        G[i] = pair >= 0 ? guard(m, pair, k, v, z, i == 0) : margin(m, command, v, z, i == 0);
    }
}

typedef struct found {
    double at; /* share of the leg */
    int pair, k, command;
    double noise;
    int shaken; /* m->next_v is what rounding may do to unknowns of the leg */
} found;

/* The next coefficient, guessed from the last two: what a guard is off by at the start of a leg. */
static double cut_off(const double *G, int terms) {
    const double last = fabs(G[terms - 1]), before = fabs(G[terms - 2]);
    return last < before ? 2 * last * (last / before) : last;
}

/* Where in the leg, before share `before` of it, a guard breaks by the coefficients there are; NAN: it does
 * not. */
static double breaks(const ns_sparse *m, const ns_dense_step *leg, int terms, const found *f, double before,
                     ns_curve *c) {
    double G[NS_STAGES] = {0};
    ns_curve part;
    coefficients(m, leg, terms, f->pair, f->k, f->command, G);
    ns_modes_curve_of(terms, G, leg->end / leg->g, c);
    before = before < 1 ? before : 1;
    ns_modes_curve_cut(c, before, &part);
    double tol = cut_off(G, terms);
    if (ns_modes_curve_holds(&part, tol))
        return NAN;
    tol += f->pair >= 0 ? below * m->o.reltol * size_of(m, leg, f->pair) : 0;
    if (ns_modes_curve_holds(&part, tol))
        return NAN;
    return before *
           ns_modes_curve_below(
               &part, tol + f->noise +
                          (f->pair >= 0 ? ns_sparse_guard_rounding(m, f->pair, leg->xi, leg->dw, leg->g)
                                        : ns_sparse_guard_control_rounding(m, f->command, leg->xi, leg->z)));
}

/* What is below zero by so little, beside the largest unknown, may be rounding of others than its own terms:
 * by how much it is. */
static void take_noise(ns_sparse *m, const ns_dense_step *leg, const ns_curve *c, found *next, found *f) {
    double most = 0;
    for (int i = 0; i < m->f->size; i++)
        most = ns_higher(most, fabs(leg->xi[i]));
    if (next->pair < 0 || !ns_modes_curve_holds(c, shallow * most))
        return;
    if (!f->shaken)
        f->shaken = ns_sparse_guard_perturb(m, leg->xi, leg->dw, leg->g, 0) == NS_OK &&
                            ns_sparse_step_residue(m, leg, m->next_v) == NS_OK
                        ? 1
                        : -1;
    memset(m->z_none, 0, sizeof(double) * (size_t)m->f->nz);
    if (f->shaken > 0)
        next->noise = 16 * fabs(guard(m, next->pair, next->k, m->next_v, m->z_none, 0));
}

/* By how much of the leg the crossing is off as later stages are missing. */
static double off_by(const ns_sparse *m, const ns_dense_step *leg, const found *f, const ns_curve *c) {
    double G[NS_STAGES] = {0};
    coefficients(m, leg, leg->stages, f->pair, f->k, f->command, G);
    return cut_off(G, leg->stages) / fabs(ns_modes_curve_slope(c, f->at));
}

/* How the state moves in the leg, beside its scales. */
static double moves(const ns_sparse *m, const ns_dense_step *leg) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (fabs(leg->dw[m->f->n + i]) > most * m->scale[i])
            most = fabs(leg->dw[m->f->n + i]) / m->scale[i];
    return most * leg->end / leg->g;
}

/* Looks for one guard's crossing before the first found so far: roughly, then with so many stages more that
 * it is as exact as the step. */
static int look(ns_sparse *m, ns_dense_step *leg, found next, found *f) {
    ns_curve c;
    if (next.pair >= 0 && surely_holds(m, leg, next.pair, next.k))
        return NS_OK;
    const int terms = leg->stages < NS_ORDER ? leg->stages : NS_ORDER;
    if (!(breaks(m, leg, terms, &next, f->at, &c) < f->at))
        return NS_OK;
    take_noise(m, leg, &c, &next, f);
    if (next.noise > 0 && !(breaks(m, leg, terms, &next, f->at, &c) < f->at))
        return NS_OK;
    do {
        const int status = ns_sparse_step_more(m, leg);
        if (status != NS_OK)
            return status;
        next.at = breaks(m, leg, leg->stages, &next, 1, &c);
        if (next.at > 0)
            next.at = ns_modes_curve_root(&c, next.at);
    } while (leg->stages < NS_STAGES &&
             !(off_by(m, leg, &next, &c) * moves(m, leg) <= instant_share * m->o.reltol));
    next.shaken = f->shaken;
    if (next.at < f->at)
        *f = next;
    return NS_OK;
}

/* Of legs as long as this one or longer: volts and amperes of a shorter one may be those of a transient. */
static double most_of(const double *of, int rung) {
    double most = 0;
    for (int r = 0; r <= rung; r++)
        most = ns_higher(of[r], most);
    return most;
}

void ns_sparse_guard_sizes(ns_sparse *m, const double *v, int rung) {
    double most_lambda = most_of(m->lambda_of, rung), most_y = most_of(m->y_of, rung);
    for (int j = 0; j < m->f->m; j++) {
        most_lambda = ns_higher(fabs(v[m->f->n + j]), most_lambda);
        most_y = ns_higher(fabs(ns_linalg_csc_dot(&m->f->Ct, j, v)), most_y);
    }
    m->most_lambda = most_lambda;
    m->most_y = most_y;
}

void ns_sparse_guard_keep_sizes(ns_sparse *m, int rung) {
    m->lambda_of[rung] = m->most_lambda;
    m->y_of[rung] = m->most_y;
}

int ns_sparse_guard_enough(const ns_sparse *m, const ns_dense_step *leg, int p) {
    const size_t last = (size_t)p - 1;
    const double *v = leg->xi + last * (size_t)m->f->size, *z = leg->z + last * (size_t)m->f->nz,
                 little = (p < NS_ORDER ? few_share : all_share) * m->o.reltol;
    for (int j = 0; j < m->f->m; j++)
        if (guards_of(m, j) > 0 &&
            (m->mode[j] == NS_INSIDE ? !(fabs(v[m->f->n + j]) <= little * m->most_lambda)
                                     : !(fabs(ns_sparse_form_y(m->f, j, v, z, 0)) <= little * m->most_y)))
            return 0;
    for (int c = 0; c < m->s->nc; c++)
        if (of_state(m, c) &&
            !(fabs(margin(m, c, v, z, 0)) <=
              little * (ns_linalg_csc_size(&m->f->gx, c, leg->xi) + ns_linalg_csc_size(&m->f->gz, c, leg->z) +
                        fabs(m->s->command[c].g0))))
            return 0;
    return 1;
}

int ns_sparse_guard_first(ns_sparse *m, ns_dense_step *leg) {
    found f = {INFINITY, -1, 0, -1, 0, 0};
    int status = NS_OK;
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        for (int k = 0; k < guards && status == NS_OK; k++)
            status = look(m, leg, (found){NAN, j, k, -1, 0, 0}, &f);
    }
    for (int c = 0; c < m->s->nc && status == NS_OK; c++)
        if (of_state(m, c))
            status = look(m, leg, (found){NAN, -1, 0, c, 0, 0}, &f);
    if (status != NS_OK || !(f.at <= 1))
        return status;
    leg->why = NS_LEG_EVENT;
    leg->pair = f.pair;
    leg->command = f.command;
    leg->upper = f.pair >= 0 && is_upper(m, f.pair, f.k);
    if (f.at < 1) {
        leg->end *= f.at;
        leg->end_t = ns_lower(leg->end_t, ns_higher(leg->t, leg->t + (leg->time_lost + leg->end)));
    }
    return status;
}

int ns_sparse_guard_starts(ns_sparse *m, const ns_dense_step *leg, double share) {
    const size_t size = (size_t)m->f->size, last = (size_t)leg->stages - 1;
    const double *v_last = leg->xi + last * size, *z_last = leg->z + last * (size_t)m->f->nz;
    ns_sparse_step_point(m, leg, 0, m->next_v);
    (void)ns_inputs_stages_stage(m->in, leg->t, 0, 0, m->z);
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        const double little = share * (m->mode[j] == NS_INSIDE ? m->most_lambda : m->most_y);
        for (int k = 0; k < guards; k++) {
            const double value = guard(m, j, k, m->next_v, m->z, 1) + little;
            if (!(value >= 0) && !(value + 4 * fabs(guard(m, j, k, v_last, z_last, 0)) +
                                       ns_sparse_guard_rounding(m, j, m->next_v, leg->dw, leg->g) >=
                                   0))
                return 0;
        }
    }
    return 1;
}
