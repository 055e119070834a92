/* src/theta/state.c - the accepted point: saved, restored, put beyond a jump, read. */
#include "name_fault.h"
#include "theta_internal.h"

#include <math.h>
#include <string.h>

/* past = w, d, d_noise, in, noisy_h, h, implicit, jumped, at, mode */
size_t ns_theta_past_size(const ns_theta *s) {
    return s ? (size_t)(3 * s->r + s->q + 4 + s->s->n + 2 * s->s->m) : 0;
}

void ns_theta_save(const ns_theta *s, double *past) {
    if (!s || !past)
        return;
    const size_t r = (size_t)s->r, q = (size_t)s->q, all = (size_t)s->s->n + (size_t)s->s->m;
    memcpy(past, s->w, sizeof(double) * r);
    memcpy(past + r, s->d, sizeof(double) * r);
    memcpy(past + 2 * r, s->d_noise, sizeof(double) * r);
    memcpy(past + 3 * r, s->in, sizeof(double) * q);
    past += 3 * r + q;
    *past++ = s->noisy_h;
    *past++ = s->h;
    *past++ = s->implicit;
    *past++ = s->jumped;
    memcpy(past, s->at, sizeof(double) * all);
    past += all;
    for (int j = 0; j < s->s->m; j++)
        past[j] = s->mode[j];
}

void ns_theta_restore(ns_theta *s, const double *past) {
    if (!s || !past)
        return;
    const size_t r = (size_t)s->r, q = (size_t)s->q, all = (size_t)s->s->n + (size_t)s->s->m;
    memcpy(s->w, past, sizeof(double) * r);
    memcpy(s->d, past + r, sizeof(double) * r);
    memcpy(s->d_noise, past + 2 * r, sizeof(double) * r);
    memcpy(s->in, past + 3 * r, sizeof(double) * q);
    past += 3 * r + q;
    s->noisy_h = *past++;
    s->h = *past++;
    s->implicit = (int)*past++;
    s->jumped = (int)*past++;
    memcpy(s->at, past, sizeof(double) * all);
    past += all;
    for (int j = 0; j < s->s->m; j++)
        s->mode[j] = (ns_mode)past[j];
    ns_theta_set_bounds(s);
    s->has_trial = 0;
    ns_theta_forget_recent(s);
}

/* sum += row i of A (p columns) times x, with the sizes of its terms. */
static void add_row(int n, int p, int i, const double *A, const double *x, double *sum, double *terms) {
    for (int j = 0; j < p; j++) {
        *sum += A[i + j * n] * x[j];
        *terms += fabs(A[i + j * n] * x[j]);
    }
}

/* d = (1-theta) (A x + b + E z) + (1-gamma) B lambda, and its noise: some roundings of its terms.  No step of
 * a length that would tell more was made. */
static void jump_rates(ns_theta *s, const double *x, const double *lambda, const double *z) {
    const int n = s->s->n;
    for (int i = 0; i < s->r; i++) {
        double f = s->b[i], g = 0, terms = fabs(f);
        add_row(n, n, i, s->A, x, &f, &terms);
        add_row(n, s->s->nz, i, s->E, z, &f, &terms);
        add_row(n, s->s->m, i, s->B, lambda, &g, &terms);
        s->d[i] = (1 - s->theta) * f + (1 - s->gamma) * g;
        s->d_noise[i] = 16 * terms;
    }
    s->noisy_h = INFINITY;
}

/* w to the right of a jump, row i: M x (x may be the small differences of large voltages) or what was there
 * and the impulses (J1), from the smaller terms. */
double ns_theta_jump_w(const ns_theta *s, int i, const double *x, const double *X, const double *Lambda) {
    const int n = s->s->n;
    double held = 0, moved = s->w[i], held_terms = 0, moved_terms = fabs(s->w[i]);
    add_row(n, n, i, s->M, x, &held, &held_terms);
    add_row(n, n, i, s->A, X, &moved, &moved_terms);
    add_row(n, s->s->m, i, s->B, Lambda, &moved, &moved_terms);
    return held_terms < moved_terms ? held : moved;
}

/* The accepted point gets to be that of s->w, with these x and lambda. */
static void put(ns_theta *s, const double *x, const double *lambda, const ns_mode *mode, const double *z) {
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m, r = (size_t)s->r;
    memcpy(s->at, x, sizeof(double) * n);
    memcpy(s->at + n, lambda, sizeof(double) * m);
    memcpy(s->in, s->w, sizeof(double) * r);
    ns_linalg_copy((size_t)s->s->nz, z, s->in + r);
    s->in[s->q - 1] = 1;
    if (s->carry)
        jump_rates(s, x, lambda, z);
    memcpy(s->mode, mode, m);
    s->jumped = 1;
    s->has_trial = 0;
    ns_theta_forget_recent(s);
}

void ns_theta_jump(ns_theta *s, const ns_impulse *jump, const double *z) {
    for (int i = 0; i < s->r; i++)
        s->w[i] = ns_theta_jump_w(s, i, jump->x, jump->X, jump->Lambda);
    put(s, jump->x, jump->lambda, jump->mode, z);
}

void ns_theta_put(ns_theta *s, const double *w, const double *at, const ns_mode *mode, const double *z) {
    memcpy(s->w, w, sizeof(double) * (size_t)s->r);
    put(s, at, at + s->s->n, mode, z);
}

void ns_theta_set_controls(ns_theta *s, const double *x) {
    double *control = s->out + s->r * (s->carry ? 2 : 1);
    for (int c = 0; c < s->s->nc; c++) {
        const double *gx = s->s->command[c].gx;
        control[c] = 0;
        for (int j = 0; gx && j < s->s->n; j++)
            control[c] += gx[j] * x[j];
    }
}

/* What only follows from the state may overflow before it does.  y may be NULL. */
static int check_read(ns_theta *s, const double *y) {
    const int n = s->s->n, m = s->s->m;
    ns_fault found = {.t = s->fault.t};
    found.nunknowns = ns_theta_name_infinite(n, s->sol, found.unknown);
    found.npairs = ns_theta_name_infinite(m, s->sol + n, found.pair);
    if (found.nunknowns + found.npairs == 0)
        found.npairs = ns_theta_name_infinite(m, y, found.pair);
    if (found.nunknowns + found.npairs == 0)
        return NS_OK;
    s->fault = found;
    return ns_theta_fail(s, NS_E_OVERFLOW);
}

/* x, lambda of the accepted point, into s->sol. */
static int solve_at(ns_theta *s) {
    const int all = s->s->n + s->s->m;
    ns_map *map;
    if (s->jumped) {
        memcpy(s->sol, s->at, sizeof(double) * (size_t)all);
        return NS_OK;
    }
    const int status = ns_theta_find_map(s, s->h, s->implicit, s->mode, &map);
    if (status == NS_OK)
        ns_linalg_matvec(all, s->q, map->full, s->in, s->sol);
    return status;
}

int ns_theta_read(ns_theta *s, double *x, double *lambda, double *y) {
    if (!s)
        return NS_E_NULL;
    if (!s->jumped && !(s->h > 0))
        return NS_E_STATE;
    const int status = solve_at(s);
    if (status != NS_OK)
        return ns_theta_fail(s, status);
    const int n = s->s->n, m = s->s->m;
    if (x)
        memcpy(x, s->sol, sizeof(double) * (size_t)n);
    if (lambda)
        memcpy(lambda, s->sol + n, sizeof(double) * (size_t)m);
    if (y) {
        ns_linalg_copy((size_t)m, s->s->e, y);
        ns_linalg_matvec_add(m, n, s->s->C, s->sol, y); /* (S3) */
        ns_linalg_matvec_add(m, m, s->s->D, s->sol + n, y);
        ns_linalg_matvec_add(m, s->s->nz, s->s->F, s->in + s->r, y);
    }
    return check_read(s, y);
}
