/* src/sparse/read.c - the point of the trial, points on the way to it, its mode, and the counts. */
#include "sparse_internal.h"

#include "linalg/simd.h"
#include "step.h"
#include "theta/name_fault.h"

#include <math.h>
#include <string.h>

/* Unknowns may overflow before the state does: they are named, and read all the same. */
static int check_read(ns_sparse *m, double at, const double *x, const double *lambda, const double *y) {
    ns_fault found = {.status = NS_E_OVERFLOW, .t = at};
    found.nunknowns = ns_theta_name_infinite(m->output_only->whole->n, x, found.unknown);
    found.npairs = ns_theta_name_infinite(m->f->m, lambda, found.pair);
    if (found.nunknowns + found.npairs == 0)
        found.npairs = ns_theta_name_infinite(m->f->m, y, found.pair);
    if (found.nunknowns + found.npairs == 0)
        return NS_OK;
    m->fault = found;
    return NS_E_OVERFLOW;
}

/* --- what rounding of w makes of x --- */

/* Rounding of w contradicts the constraints of a mode.  In an Euler step of g that is an impulse: a rounding
 * of a flux, divided by g, is a voltage, 100 V for a g of 1e-15 s at the star point of coils.  D reverses its
 * sign from image to image, while all else vanishes in the powers of D: in the last image the impulse is
 * alone.  It counts as alone if the last two images add up to less than `alone` of it, or than
 * `almost_nothing` of the largest unknown; an image below `nothing` of that holds no impulse. */
static const double alone = 1e-2, almost_nothing = 1e-9, nothing = 1e-10;

typedef enum last_image { MOVES, HAS_IMPULSE, IS_IMPULSE } last_image;

static last_image look_at_last(const ns_sparse *m, const ns_dense_step *step, const double *v) {
    const size_t size = (size_t)m->f->size;
    if (step->stages < 2)
        return MOVES;
    const double *before = step->images + (size_t)(step->stages - 2) * size, *last = before + size;
    double most = 0, largest = 0, moves = 0;
    for (size_t i = 0; i < size; i++) {
        most = ns_higher(most, fabs(v[i]));
        largest = ns_higher(largest, fabs(last[i]));
        moves = ns_higher(moves, fabs(last[i] + before[i]));
    }
    if (largest <= nothing * most || moves > largest)
        return MOVES;
    return moves <= ns_higher(alone * largest, almost_nothing * most) ? IS_IMPULSE : HAS_IMPULSE;
}

/* v (n+m), x and lambda at tau, less that impulse, which is in all images with one sign or the other. */
static void subtract(const ns_sparse *m, const ns_dense_step *step, double tau, double *v) {
    const double *last = step->images + (size_t)(step->stages - 1) * (size_t)m->f->size;
    double c[NS_STAGES], sum = 0;
    ns_sparse_step_series(step, tau, c);
    for (int i = 0; i < step->stages; i++)
        sum += (step->stages - i) % 2 ? c[i] : -c[i];
    for (int i = 0; i < m->f->size; i++)
        v[i] -= sum * last[i];
}

static int take_off_impulse(ns_sparse *m, ns_dense_step *step, double tau, double *v) {
    const int stages = step->stages;
    int status = NS_OK;
    if (step->is_euler || m->o.theta > 0)
        return NS_OK;
    step->stages = step->shown > stages ? step->shown : stages;
    last_image last = look_at_last(m, step, v);
    while (last == HAS_IMPULSE && status == NS_OK && step->stages < NS_STAGES) {
        status = ns_sparse_step_more(m, step);
        last = status == NS_OK ? look_at_last(m, step, v) : MOVES;
    }
    if (last == IS_IMPULSE) {
        ns_sparse_step_point(m, step, tau, v);
        subtract(m, step, tau, v);
    }
    step->shown = step->stages;
    step->stages = stages;
    return status == NS_E_MEMORY ? status : NS_OK; /* without that stage it stays as it is */
}

int ns_sparse_read(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    ns_sparse *m = ns_sparse_of(e);
    if (!m->started)
        return ns_sparse_fail(m, NAN, NS_E_STATE);
    const double at = m->trial.t;
    const int more =
        m->trial.t < m->trial.step->end_t || m->trial.step->at_event || m->trial.step->stages < NS_ORDER;
    int status = more ? ns_sparse_step_more(m, m->trial.step) : NS_OK;
    if (status != NS_OK)
        return ns_sparse_fail(m, at, status);
    if (m->o.theta > 0)
        status = ns_sparse_theta_point(m, m->trial.step, m->trial.tau, m->v);
    else
        ns_sparse_step_point(m, m->trial.step, m->trial.tau, m->v);
    if (status == NS_OK)
        status = take_off_impulse(m, m->trial.step, m->trial.tau, m->v);
    if (status != NS_OK)
        return ns_sparse_fail(m, at, status);
    if (t)
        *t = at;
    for (int k = 0; k < m->f->nz; k++)
        m->z[k] = ns_signal_value(&m->s->z[k], at, m->trial.t > m->trial.step->t ? NS_LEFT : NS_RIGHT);
    if (x)
        ns_sparse_output_join(m->output_only, m->v, m->z, x);
    if (lambda)
        memcpy(lambda, m->v + m->f->n, sizeof(double) * (size_t)m->f->m);
    for (int j = 0; y && j < m->f->m; j++)
        y[j] = m->trial.step->mode[j] == NS_INSIDE ? 0 : ns_sparse_form_y(m->f, j, m->v, m->z, 1);
    return check_read(m, at, x, lambda, y);
}

/* --- on the way of the trial, which is inside one step --- */

/* 1 if t is on the way of a trial with NS_TO_STEP, else *status. */
static int is_on_way(const ns_sparse *m, double t, int *status) {
    const double from = m->engine.way_from, to = m->trial.t;
    *status = !m->started || !m->has_trial || m->until != NS_TO_STEP || !(to > from) ? NS_E_STATE
              : !(t >= from && t <= to)                                              ? NS_E_RANGE
                                                                                     : NS_OK;
    return *status == NS_OK;
}

/* 1: modes changed where a start ended, in no time; the way is that of the start alone. */
static int is_start_alone(const ns_sparse *m) {
    return !(m->trial.t > m->accepted.t);
}

/* From m->v at the end of an Euler step to its value at t, on a straight line from the accepted point. */
static void join_on_line(ns_sparse *m, double t) {
    const ns_sparse_point *from = m->accepted.step == m->trial.step ? &m->trial : &m->accepted;
    const double part = (t - m->accepted.t) / (m->trial.t - m->accepted.t);
    ns_sparse_step_point(m, from->step, from->tau, m->work.v);
    for (int i = 0; i < m->f->size; i++)
        m->v[i] = (1 - part) * m->work.v[i] + part * m->v[i];
}

/* m->v = x, lambda at t. */
static int point_on_way(ns_sparse *m, double t) {
    ns_dense_step *step = m->trial.step;
    const double tau = t >= step->end_t ? step->length : fmin(t - step->t - step->time_lost, step->length);
    if (m->o.theta > 0)
        return ns_sparse_theta_point(m, step, tau, m->v);
    int status = ns_sparse_step_shown(m, step, tau, m->v);
    if (status == NS_OK)
        status = take_off_impulse(m, step, tau, m->v);
    if (status == NS_OK && step->is_euler && step->stages == 1 && !is_start_alone(m))
        join_on_line(m, t);
    return status;
}

int ns_sparse_sample(ns_engine *e, double t, double *x, double *lambda) {
    ns_sparse *m = ns_sparse_of(e);
    int status;
    if (is_on_way(m, t, &status)) {
        t = fmax(t, m->accepted.t);
        status = point_on_way(m, t);
    }
    if (status != NS_OK)
        return ns_sparse_fail(m, t, status);
    for (int i = 0; x && i < m->output_only->nfollows; i++) {
        const int k = m->output_only->follows[i];
        m->z[k] = ns_signal_value(&m->s->z[k], t, t > m->accepted.t ? NS_LEFT : NS_RIGHT);
    }
    if (x)
        ns_sparse_output_join(m->output_only, m->v, m->z, x);
    if (lambda)
        memcpy(lambda, m->v + m->f->n, sizeof(double) * (size_t)m->f->m);
    return check_read(m, t, x, lambda, NULL);
}

double ns_sparse_shortest(ns_engine *e, double t, double *until) {
    enum { OF_LENGTH = 16 };
    const ns_sparse *m = ns_sparse_of(e);
    int status;
    *until = INFINITY;
    if (!is_on_way(m, t, &status))
        return NAN;
    return m->trial.step->is_euler || is_start_alone(m)
               ? INFINITY
               : fmin((m->trial.t - m->accepted.t) / OF_LENGTH, m->inputs_shortest);
}

/* As (E1): a line between two points of L_i is at most as far off as an eighth of the square of their
 * distance times the largest second derivative between 0 and NS_POLE, which is that at 0. */
static double bend_of_series(const ns_sparse *m, int place) {
    const ns_dense_step *step = m->trial.step;
    const int stages = step->shown > step->stages ? step->shown : step->stages;
    const double length = (m->trial.t - m->accepted.t) / step->g;
    double sum = 0;
    for (int i = 2; i < stages; i++)
        sum += 0.5 * i * (i - 1) * fabs(step->images[(size_t)i * (size_t)m->f->size + (size_t)place]);
    return length <= NS_POLE * (1 + 1e-9) ? 0.125 * length * length * sum : INFINITY;
}

double ns_sparse_bend(const ns_engine *e, int unknown) {
    const ns_sparse *m = (const ns_sparse *)(const void *)e;
    const int place = m->output_only->place[unknown];
    if (m->o.theta > 0 || m->trial.step->is_euler)
        return INFINITY;
    return place >= 0 ? bend_of_series(m, place) : m->output_only->bent[-1 - place] ? INFINITY : 0;
}

const ns_mode *ns_sparse_mode(ns_engine *e) {
    const ns_sparse *m = ns_sparse_of(e);
    const ns_mode *mode = m->trial.step ? m->trial.step->mode : m->mode;
    for (int j = 0; j < m->f->m; j++)
        m->shown_mode[j] = ns_mode_slides(mode[j]) ? NS_INSIDE : mode[j];
    return m->shown_mode;
}

const ns_counts *ns_sparse_counts(ns_engine *e) {
    ns_sparse *m = ns_sparse_of(e);
    m->counts.factors = ns_linalg_klu_fresh(m->q->klu) + ns_linalg_klu_refactor(m->q->klu);
    m->counts.maps = m->q->made;
    m->counts.evicted = m->q->evicted;
    return &m->counts;
}

/* Instructions for a solution, a problem (P1), factors: fitted to those that callgrind counted in 85 circuits
 * of tests/stress, one of each class: from 0.74 to 1.18 times as many in nine of ten, 0.46 times in one.  A
 * solution by factors with leaks is one of a Krylov cycle, whose vectors and residuals cost three times as
 * much. */
ns_work ns_sparse_work(ns_engine *e) {
    static const double a_solution = 500, by_size = 117, a_problem = 110, factors = 1700, with_leaks = 300;
    ns_sparse *m = ns_sparse_of(e);
    const ns_counts *c = ns_sparse_counts(e);
    const double size = (double)m->f->n + (double)m->f->m;
    const double once = factors * size * (double)c->factors;
    const double solved = (a_solution + by_size * size) * (double)ns_linalg_klu_solves(m->q->klu);
    const double leaks = with_leaks * size * (double)m->q->leaky_solves;
    return (ns_work){.all = once + solved + leaks + a_problem * size * (double)c->problems + m->searched,
                     .once = once,
                     .events = (double)c->events};
}

const ns_fault *ns_sparse_fault(const ns_engine *e) {
    return &((const ns_sparse *)(const void *)e)->fault;
}
