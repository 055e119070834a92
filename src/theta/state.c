/* src/theta/state.c - the accepted point: where a start, a command, a step or a jump puts it; saved and
 * restored. */
#include "theta_internal.h"

#include "linalg/row_split.h"
#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* The mode of a pair before anything is known: at a finite bound, the lower one first; inside if there is
 * none. */
static ns_mode initial_mode(double l, double u) {
    if (isfinite(l))
        return NS_LOWER;
    return isfinite(u) ? NS_UPPER : NS_INSIDE;
}

int ns_theta_start(ns_theta *s, const double *w0, const unsigned char *closed) {
    if (!s || (!w0 && s->s->n > 0) || (!closed && s->s->nc > 0))
        return NS_E_NULL;
    ns_theta_forget_failure(s);
    for (int i = 0; i < s->s->n; i++)
        if (!isfinite(w0[i]))
            return ns_theta_fail(s, NS_E_NUMBER);
    ns_linalg_row_split_apply(s->s->n, 1, s->T, w0, s->sum);
    memcpy(s->past.w, s->sum, sizeof(double) * (size_t)s->r);
    memset(s->past.d, 0, sizeof(double) * (size_t)s->r);
    memset(s->past.d_rounding, 0, sizeof(double) * (size_t)s->r);
    s->past.d_rounding_h = 0;
    for (int j = 0; j < s->s->m; j++) {
        s->l[j] = s->s->l[j];
        s->u[j] = s->s->u[j];
        s->past.mode[j] = initial_mode(s->l[j], s->u[j]);
    }
    s->past.h = 0;
    s->past.jumped = 0;
    s->trial.has = 0;
    return ns_theta_command(s, closed);
}

void ns_theta_set_bounds(ns_theta *s) {
    ns_theta_set_mode(s, s->past.mode);
}

int ns_theta_command(ns_theta *s, const unsigned char *closed) {
    if (!s || (!closed && s->s->nc > 0))
        return NS_E_NULL;
    for (int c = 0; c < s->s->nc; c++) {
        const int j = s->s->command[c].pair;
        s->past.mode[j] = closed[c] ? NS_INSIDE : NS_LOWER;
    }
    ns_theta_set_bounds(s);
    s->trial.has = 0;
    ns_theta_forget_recent(s);
    return NS_OK;
}

/* The rounding of d does not decay: where lambda is the rate of what its constraint keeps, it alternates
 * between steps of theta = 1/2, undamped.  It is proportional to 1/h, so that longer steps add none. */
static void add_rate_rounding(ns_theta *s, const ns_map *map) {
    if (!map->implicit && !(map->h < s->past.d_rounding_h))
        return;
    ns_theta_rate_rounding(s, map, s->sum);
    for (int i = 0; i < s->r; i++)
        s->past.d_rounding[i] = map->implicit ? s->sum[i] : fmax(s->past.d_rounding[i], s->sum[i]);
    s->past.d_rounding_h = map->h;
}

int ns_theta_accept(ns_theta *s) {
    if (!s)
        return NS_E_NULL;
    if (!s->trial.has)
        return NS_E_STATE;
    if (s->carry)
        add_rate_rounding(s, s->trial.map);
    ns_copy_few(s->r, s->trial.out, s->past.w);
    if (s->carry)
        ns_copy_few(s->r, s->trial.out + s->r, s->past.d);
    double *in = s->past.in;
    s->past.in = s->trial.in;
    s->trial.in = in;
    s->past.h = s->trial.h;
    s->past.implicit = s->trial.implicit;
    s->past.jumped = 0;
    if (!s->trial.same_mode && memcmp(s->past.mode, s->trial.mode, (size_t)s->s->m) != 0) {
        memcpy(s->past.mode, s->trial.mode, (size_t)s->s->m);
        s->counts.events++;
        ns_theta_forget_recent(s);
    }
    s->counts.steps++;
    s->trial.has = 0;
    return NS_OK;
}

void ns_theta_take_rates(ns_theta *s) {
    add_rate_rounding(s, s->trial.map); /* of the step of 2 h; twice that for h */
    for (int i = 0; i < s->r; i++) {
        s->past.d[i] = 2 * s->rate[0][i] - s->rate[1][i];
        s->past.d_rounding[i] *= 5;
    }
}

/* As one block: w, d, d_rounding and x_lambda, which follow one another; in; d_rounding_h, h, implicit,
 * jumped; mode. */
size_t ns_theta_past_size(const ns_theta *s) {
    if (!s)
        return 0;
    const size_t numbers = 3 * (size_t)s->r + (size_t)s->s->n + (size_t)s->s->m + (size_t)s->q + 4;
    return numbers + ((size_t)s->s->m * sizeof *s->past.mode + sizeof(double) - 1) / sizeof(double);
}

void ns_theta_save(const ns_theta *s, double *past) {
    if (!s || !past)
        return;
    const size_t point = 3 * (size_t)s->r + (size_t)s->s->n + (size_t)s->s->m, q = (size_t)s->q;
    memcpy(past, s->past.w, sizeof *past * point);
    memcpy(past + point, s->past.in, sizeof *past * q);
    past += point + q;
    *past++ = s->past.d_rounding_h;
    *past++ = s->past.h;
    *past++ = s->past.implicit;
    *past++ = s->past.jumped;
    memcpy(past, s->past.mode, sizeof *s->past.mode * (size_t)s->s->m);
}

void ns_theta_restore(ns_theta *s, const double *past) {
    if (!s || !past)
        return;
    const size_t point = 3 * (size_t)s->r + (size_t)s->s->n + (size_t)s->s->m, q = (size_t)s->q;
    memcpy(s->past.w, past, sizeof *past * point);
    memcpy(s->past.in, past + point, sizeof *past * q);
    past += point + q;
    s->past.d_rounding_h = *past++;
    s->past.h = *past++;
    s->past.implicit = (int)*past++;
    s->past.jumped = (int)*past++;
    memcpy(s->past.mode, past, sizeof *s->past.mode * (size_t)s->s->m);
    ns_theta_set_bounds(s);
    s->trial.has = 0;
    ns_theta_forget_recent(s);
}

void ns_theta_set_mode(ns_theta *s, const ns_mode *mode) {
    ns_modes_set(s->s, s->shared, s->shared_count, mode, s->past.mode, s->l, s->u);
}

void ns_theta_set_charges(ns_theta *s, const double *w) {
    memcpy(s->past.w, w, sizeof *w * (size_t)s->r);
}

/* sum += row i of A (p columns) times x, with the sizes of its terms. */
static void add_row(int n, int p, int i, const double *A, const double *x, double *sum, double *terms) {
    for (int j = 0; j < p; j++) {
        *sum += A[i + j * n] * x[j];
        *terms += fabs(A[i + j * n] * x[j]);
    }
}

/* d = (1-theta) (A x + b + E z) + (1-gamma) B lambda, and its rounding: some eps of its terms.  No step was
 * made whose length would show more. */
static void jump_rates(ns_theta *s, const double *x, const double *lambda, const double *z) {
    const int n = s->s->n;
    for (int i = 0; i < s->r; i++) {
        double f = s->b[i], g = 0, terms = fabs(f);
        add_row(n, n, i, s->A, x, &f, &terms);
        add_row(n, s->s->nz, i, s->E, z, &f, &terms);
        add_row(n, s->s->m, i, s->B, lambda, &g, &terms);
        s->past.d[i] = (1 - s->theta) * f + (1 - s->gamma) * g;
        s->past.d_rounding[i] = 16 * terms;
    }
    s->past.d_rounding_h = INFINITY;
}

/* w to the right of a jump, row i: M x (x may be the small differences of large voltages) or what was there
 * and the impulses (J1), from the smaller terms. */
double ns_theta_jump_w(const ns_theta *s, int i, const double *x, const double *X, const double *Lambda) {
    const int n = s->s->n;
    double held = 0, moved = s->past.w[i], held_terms = 0, moved_terms = fabs(s->past.w[i]);
    add_row(n, n, i, s->M, x, &held, &held_terms);
    add_row(n, n, i, s->A, X, &moved, &moved_terms);
    add_row(n, s->s->m, i, s->B, Lambda, &moved, &moved_terms);
    return held_terms < moved_terms ? held : moved;
}

/* The accepted point becomes that of s->past.w, with these x and lambda. */
static void put_point(ns_theta *s, const double *x, const double *lambda, const ns_mode *mode,
                      const double *z) {
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m;
    memcpy(s->past.x_lambda, x, sizeof(double) * n);
    memcpy(s->past.x_lambda + n, lambda, sizeof(double) * m);
    ns_linalg_copy((size_t)s->s->nz, z, s->past.in + s->r); /* of the rest only a step's is read */
    if (s->carry)
        jump_rates(s, x, lambda, z);
    memcpy(s->past.mode, mode, m);
    s->past.jumped = 1;
    s->trial.has = 0;
    ns_theta_forget_recent(s);
}

void ns_theta_jump(ns_theta *s, const ns_impulse *jump, const double *z) {
    for (int i = 0; i < s->r; i++)
        s->past.w[i] = ns_theta_jump_w(s, i, jump->x, jump->X, jump->Lambda);
    put_point(s, jump->x, jump->lambda, jump->mode, z);
}

void ns_theta_put(ns_theta *s, const double *w, const double *x_lambda, const ns_mode *mode,
                  const double *z) {
    memcpy(s->past.w, w, sizeof(double) * (size_t)s->r);
    put_point(s, x_lambda, x_lambda + s->s->n, mode, z);
}

void ns_theta_set_controls(ns_theta *s, const double *x) {
    double *control = s->trial.out + s->r * (s->carry ? 2 : 1);
    for (int c = 0; c < s->s->nc; c++) {
        const double *gx = s->s->command[c].gx;
        control[c] = 0;
        for (int j = 0; gx && j < s->s->n; j++)
            control[c] += gx[j] * x[j];
    }
}
