/* src/system/model.c - a linear system shown as a model: f = A x + b + E z, g = B lambda, h = C x + D lambda
 * + F z + e. */
#include "nonsmooth/model.h"

#include "linalg/dense.h"

/* What a callback hands out of the system. */
static int copy(double *out, const double *from, int p, int q) {
    ns_linalg_copy((size_t)p * (size_t)q, from, out);
    return 0;
}

static int linear_f(const ns_point *at, void *data, double *out) {
    const ns_system *s = data;
    copy(out, s->b, s->n, 1);
    ns_linalg_matvec_add(s->n, s->n, s->A, at->x, out);
    ns_linalg_matvec_add(s->n, s->nz, s->E, at->z, out); /* (S1) */
    return 0;
}

static int linear_g(const ns_point *at, void *data, double *out) {
    const ns_system *s = data;
    ns_linalg_matvec(s->n, s->m, s->B, at->lambda, out); /* (S2) */
    return 0;
}

static int linear_h(const ns_point *at, void *data, double *out) {
    const ns_system *s = data;
    copy(out, s->e, s->m, 1);
    ns_linalg_matvec_add(s->m, s->n, s->C, at->x, out);
    ns_linalg_matvec_add(s->m, s->m, s->D, at->lambda, out);
    ns_linalg_matvec_add(s->m, s->nz, s->F, at->z, out); /* (S3) */
    return 0;
}

static int constant_A(const ns_point *at, void *data, double *out) {
    const ns_system *s = data;
    (void)at;
    return copy(out, s->A, s->n, s->n);
}

static int constant_B(const ns_point *at, void *data, double *out) {
    const ns_system *s = data;
    (void)at;
    return copy(out, s->B, s->n, s->m);
}

static int constant_C(const ns_point *at, void *data, double *out) {
    const ns_system *s = data;
    (void)at;
    return copy(out, s->C, s->m, s->n);
}

static int constant_D(const ns_point *at, void *data, double *out) {
    const ns_system *s = data;
    (void)at;
    return copy(out, s->D, s->m, s->m);
}

int ns_model_of_system(const ns_system *s, ns_model *out) {
    if (!s || !out)
        return NS_E_NULL;
    const int status = ns_system_check(s, NULL);
    if (status != NS_OK)
        return status;
    if (s->nc > 0)
        return NS_E_SIZE;
    *out = (ns_model){.n = s->n,
                      .m = s->m,
                      .nz = s->nz,
                      .M = s->M,
                      .l = s->l,
                      .u = s->u,
                      .z = s->z,
                      .data = (void *)s, /* the callbacks only read it */
                      .f = linear_f,
                      .A = constant_A,
                      .g = linear_g,
                      .B = constant_B,
                      .h = linear_h,
                      .C = constant_C,
                      .D = constant_D};
    return NS_OK;
}
