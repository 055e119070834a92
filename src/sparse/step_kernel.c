/* src/sparse/step_kernel.c - one step in one mode, by solves with one factor of (P2): its stages, what
 * rounding left of them, and state and unknowns at any time in it. */
#include "guards.h"
#include "linalg/simd.h"
#include "regularise.h"
#include "step.h"

#include <math.h>
#include <string.h>

/* Solutions that leave more of (P2) than this fraction of its terms have lost digits. */
static const double accurate = 1e-10;
/* Rounding of the first stage below this fraction of the error allowed does not count. */
static const double rough = 0.1;

/* The right-hand side of the row of a pair that slides, without inputs. */
static double threshold(const ns_sparse *m, int j) {
    const ns_command *c = &m->s->command[m->f->command[j]];
    return c->on - c->g0;
}

/* m->r: the right-hand side of an Euler step of length g from w; m->rate: T (b + E z), with b if constants,
 * with E z if any. */
void ns_sparse_step_rhs(ns_sparse *m, double g, const double *w, const double *z, int any, int constants) {
    const ns_form *f = m->f;
    const int n = f->n;
    double *r = m->r, *rate = m->rate;
    if (constants)
        memcpy(rate, f->b, sizeof(double) * (size_t)n);
    else
        memset(rate, 0, sizeof(double) * (size_t)n);
    if (any)
        ns_linalg_csc_times_add(&f->E, z, rate);
    for (int i = 0; i < n; i++)
        r[i] = f->algebraic[i] ? rate[i] : (w ? w[i] : 0) + g * rate[i];
    for (int i = 0; f->held && i < n; i++)
        if (!isnan(f->held[i]))
            r[i] = f->held[i];
    for (int j = 0; j < f->m; j++)
        r[n + j] = !constants                ? 0
                   : m->mode[j] == NS_INSIDE ? -f->e[j]
                   : m->mode[j] == NS_LOWER  ? m->l[j]
                   : m->mode[j] == NS_UPPER  ? m->u[j]
                                             : threshold(m, j);
    for (int j = 0; any && f->Ft.start[f->m] > 0 && j < f->m; j++)
        if (m->mode[j] == NS_INSIDE)
            r[n + j] -= ns_linalg_csc_dot(&f->Ft, j, z);
    for (int j = 0; any && f->may_slide && j < f->m; j++)
        if (ns_mode_slides(m->mode[j]))
            r[n + j] -= ns_linalg_csc_dot(&f->gz, f->command[j], z);
}

/* by = D w = g (A x + B lambda + f) */
static void rates(const ns_sparse *m, double g, const double *v, double *by) {
    const ns_form *f = m->f;
    for (int i = 0; i < f->n; i++)
        by[i] = f->algebraic[i] ? 0 : g * (ns_linalg_csc_dot(&f->At, i, v) + m->rate[i]);
}

int ns_sparse_step_euler(ns_sparse *m, double t, double g, const double *w, int brief, double *v,
                         double *by) {
    const ns_cached_factors *k;
    int status = ns_sparse_factors_factor(m->q, g, m->mode, brief, &k);
    if (status != NS_OK) {
        for (int i = 0; i < m->f->size; i++)
            v[i] = NAN; /* breaks no guard */
        return status;
    }
    int any = 1;
    if (m->o.theta > 0 || m->transient.runs)
        ns_system_inputs(m->s, t + g, m->transient.runs ? NS_LEFT : NS_RIGHT, m->z);
    else
        any = ns_inputs_stages_stage(m->in, t, g, 0, m->z);
    ns_sparse_step_rhs(m, g, w, m->z, any, 1);
    status = ns_sparse_factors_solve(m->q, k, m->r, v);
    if (by)
        rates(m, g, v, by);
    return status;
}

int ns_sparse_step_solve(ns_sparse *m, const ns_cached_factors *k, double t, double g, int i, const double *w,
                         double *z, double *v, double *by) {
    const int any = ns_inputs_stages_stage(m->in, t, g, i, z);
    ns_sparse_step_rhs(m, g, w, z, any, i == 0);
    /* what contradicts the equations does so in stage 0; in D^i w it is what rounding left of that */
    const int status =
        i == 0 ? ns_sparse_factors_solve(m->q, k, m->r, v) : ns_sparse_factors_correct(m->q, k, m->r, v);
    if (status == NS_OK)
        rates(m, g, v, by);
    return status;
}

int ns_sparse_step_stage(ns_sparse *m, ns_dense_step *step, const ns_cached_factors *k, int i) {
    const size_t n = (size_t)m->f->n, size = (size_t)m->f->size, nz = (size_t)m->f->nz;
    double *w = step->powers + (size_t)i * n;
    return ns_sparse_step_solve(m, k, step->t, step->g, i, w, step->z + (size_t)i * nz,
                                step->images + (size_t)i * size, w + n);
}

/* m->work.v: K^-1 of what stage i leaves of (P2), which stays in m->r.  0: it is not known. */
static int correction_of(ns_sparse *m, const ns_dense_step *step, const ns_cached_factors *k, int i) {
    const size_t n = (size_t)m->f->n, at = (size_t)i;
    const int any = ns_inputs_stages_stage(m->in, step->t, step->g, i, m->z);
    ns_sparse_step_rhs(m, step->g, step->powers + at * n, m->z, any, i == 0);
    ns_sparse_form_subtract(m->f, step->g, m->mode, step->images + at * (size_t)m->f->size, m->r);
    return ns_sparse_factors_solve(m->q, k, m->r, m->work.v) == NS_OK;
}

/* 1 if the rounding of the first stage, in which all of w is, moves D w by more than errors may: later stages
 * cannot tell that from a fast transient. */
static int first_stage_is_rough(ns_sparse *m, const ns_dense_step *step, const ns_cached_factors *k) {
    double most = 0;
    if (!correction_of(m, step, k, 0))
        return 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = ns_higher(fabs(ns_linalg_csc_dot(&m->f->At, i, m->work.v)) * m->inverse_scale[i], most);
    return step->g * most > rough * m->o.reltol;
}

int ns_sparse_step_digits_lost(ns_sparse *m, const ns_dense_step *step) {
    const size_t i = (size_t)step->stages - 1, n = (size_t)m->f->n;
    const ns_cached_factors *k;
    if (ns_sparse_factors_factor(m->q, step->g, m->mode, 0, &k) != NS_OK || k->has_leaks)
        return 0; /* with leaks solutions are corrected */
    const int any = ns_inputs_stages_stage(m->in, step->t, step->g, (int)i, m->z);
    ns_sparse_step_rhs(m, step->g, step->powers + i * n, m->z, any, i == 0);
    return !(ns_sparse_leaks_left(m->f, step->g, m->mode, NULL, m->r, step->images + i * (size_t)m->f->size,
                                  NULL, m->work.residual) <= accurate) ||
           first_stage_is_rough(m, step, k);
}

int ns_sparse_step_refine(ns_sparse *m, ns_dense_step *step) {
    const ns_cached_factors *k;
    int status = ns_sparse_factors_factor(m->q, step->g, m->mode, 0, &k);
    for (int i = 0; i < step->stages && status == NS_OK; i++) {
        double *v = step->images + (size_t)i * (size_t)m->f->size;
        status = ns_sparse_step_stage(m, step, k, i);
        if (status != NS_OK)
            return status;
        ns_sparse_form_subtract(m->f, step->g, m->mode, v, m->r);
        if (ns_sparse_factors_correct(m->q, k, m->r, m->work.v) != NS_OK)
            continue;
        for (int a = 0; a < m->f->size; a++)
            v[a] += m->work.v[a];
        rates(m, step->g, v, step->powers + (size_t)(i + 1) * (size_t)m->f->n);
    }
    return status;
}

int ns_sparse_step_residue(ns_sparse *m, const ns_dense_step *step, double *sum) {
    const size_t n = (size_t)m->f->n, size = (size_t)m->f->size;
    const ns_cached_factors *k;
    double *left = m->work.residual;
    memset(left, 0, sizeof *left * size);
    for (int i = 0; i < step->stages; i++) {
        const int any = ns_inputs_stages_stage(m->in, step->t, step->g, i, m->z);
        ns_sparse_step_rhs(m, step->g, step->powers + (size_t)i * n, m->z, any, i == 0);
        ns_sparse_form_subtract(m->f, step->g, m->mode, step->images + (size_t)i * size, m->r);
        for (size_t j = 0; j < size; j++)
            left[j] += i % 2 ? -m->r[j] : m->r[j];
    }
    int status = ns_sparse_factors_factor(m->q, step->g, m->mode, 0, &k);
    if (status == NS_OK)
        status = ns_sparse_factors_correct(m->q, k, left, m->v);
    for (size_t j = 0; j < size && (status == NS_OK || status == NS_E_SINGULAR); j++)
        sum[j] += m->v[j];
    return status == NS_E_SINGULAR ? NS_OK : status;
}

int ns_sparse_step_more(ns_sparse *m, ns_dense_step *step) {
    const ns_cached_factors *k;
    if (step->stages == NS_STAGES || step->is_euler)
        return NS_OK;
    ns_sparse_guard_set_mode(m, step->mode);
    ns_inputs_stages_at(m->in, step->t);
    ns_inputs_stages_late(m->in, step->time_lost);
    int status = ns_sparse_factors_factor(m->q, step->g, m->mode, 0, &k);
    if (status == NS_OK)
        status = ns_sparse_step_stage(m, step, k, step->stages);
    if (status == NS_E_SINGULAR &&
        step->stages < NS_ORDER) { /* this stage is rounding, and rounding contradicts the equations */
        memset(step->images + (size_t)step->stages * (size_t)m->f->size, 0,
               sizeof(double) * (size_t)m->f->size);
        memset(step->powers + (size_t)(step->stages + 1) * (size_t)m->f->n, 0,
               sizeof(double) * (size_t)m->f->n);
        status = NS_OK;
    }
    if (status == NS_OK)
        step->stages++;
    return status;
}

double ns_sparse_step_time_lost(const ns_dense_step *step) {
    return step->time_lost + (step->t - step->end_t) + step->length;
}

/* out = sum of coefficient i times a[i], vectors of count numbers, `terms` of them: entries k to before end.
 */
static void combine_few(size_t count, int terms, const double *coefficient, const double *a, double *out,
                        size_t k) {
    for (; k < count; k++) {
        double sum = coefficient[0] * a[k];
        for (int i = 1; i < terms; i++)
            sum += coefficient[i] * a[(size_t)i * count + k];
        out[k] = sum;
    }
}

/* The same of whole blocks of two registers; returns where they end. */
ALWAYS_INLINE size_t combine_blocks(size_t count, int terms, const double *coefficient, const double *a,
                                    double *out) {
    enum { BLOCK = 2 * NS_WIDE };
    size_t k = 0;
    for (; k + BLOCK <= count; k += BLOCK) {
        const double *of = a + k;
        ns_simd_wide low = coefficient[0] * *(const ns_simd_wide *)of,
                     high = coefficient[0] * *(const ns_simd_wide *)(of + NS_WIDE);
        for (int i = 1; i < terms; i++) {
            of += count;
            low += coefficient[i] * *(const ns_simd_wide *)of;
            high += coefficient[i] * *(const ns_simd_wide *)(of + NS_WIDE);
        }
        *(ns_simd_wide *)(out + k) = low;
        *(ns_simd_wide *)(out + k + NS_WIDE) = high;
    }
    return k;
}

NS_WIDE_TARGET static size_t combine_wide(size_t count, int terms, const double *coefficient, const double *a,
                                          double *out) {
    return combine_blocks(count, terms, coefficient, a, out);
}

static void combine(size_t count, int terms, const double *coefficient, const double *a, double *out) {
    const size_t k = ns_simd_is_wide() ? combine_wide(count, terms, coefficient, a, out)
                                       : combine_blocks(count, terms, coefficient, a, out);
    combine_few(count, terms, coefficient, a, out, k);
}

double ns_sparse_step_negligible(double g, double least, double room) {
    static const double of_room = 16;
    while (g > least && g * of_room > room)
        g *= 0.5;
    return g;
}

void ns_sparse_step_state(const ns_sparse *m, const ns_dense_step *step, double tau, double *w) {
    const size_t n = (size_t)m->f->n;
    double b[NS_ORDER + 1];
    if (step->is_euler) {
        for (size_t i = 0; i < n; i++)
            w[i] = step->powers[i] + tau / step->g * step->powers[n + i];
        return;
    }
    ns_modes_laguerre_steps(tau / step->g, b); /* (E2) */
    /* the smallest terms first, w itself last */
    memcpy(w, step->powers, sizeof(double) * n);
    const int last = step->stages < NS_ORDER ? step->stages : NS_ORDER;
    for (size_t k = 0; k < n; k++) {
        double sum = 0;
        for (int i = last; i > 0; i--)
            sum += b[i] * step->powers[(size_t)i * n + k];
        w[k] += sum;
    }
}

void ns_sparse_step_series(const ns_dense_step *step, double tau, double *c) {
    const double s = tau / step->g;
    double b[NS_ORDER + 1];
    ns_modes_laguerre(s, NS_ORDER, c); /* (E1) */
    if (step->stages > NS_ORDER) {
        ns_modes_laguerre_steps(s, b);
        c[NS_ORDER] = b[NS_ORDER] - c[NS_ORDER - 1]; /* L_8 = b_8 + L_7 */
    }
}

void ns_sparse_step_point(const ns_sparse *m, const ns_dense_step *step, double tau, double *v) {
    double c[NS_STAGES];
    if (step->is_euler) {
        memcpy(v, step->images, sizeof(double) * (size_t)m->f->size);
        for (int i = 0; step->stages == 2 && i < m->f->size; i++)
            v[i] += (1 - tau / step->length) * (step->images[m->f->size + i] - v[i]);
        return;
    }
    ns_sparse_step_series(step, tau, c);
    combine((size_t)m->f->size, step->stages, c, step->images, v);
}

int ns_sparse_step_shown(ns_sparse *m, ns_dense_step *step, double tau, double *v) {
    const int stages = step->stages;
    int status = NS_OK;
    if (step->shown <= stages) {
        status = ns_sparse_step_more(m, step);
        step->shown = step->stages;
    }
    step->stages = step->shown;
    ns_sparse_step_point(m, step, tau, v);
    step->stages = stages;
    return status;
}
