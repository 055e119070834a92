/* tests/rig/proofs.h - problems (P1), and solves of which every claim is judged. */
#ifndef PROOFS_H
#define PROOFS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/mlcp.h"

enum { MAX = 40 };
#define INF INFINITY

/* A problem, and what a solve of it gave. */
typedef struct trial {
    int m;
    double W[MAX * MAX], q[MAX], l[MAX], u[MAX], lambda[MAX], y[MAX], v[MAX];
    ns_mode mode[MAX];
    ns_mlcp_info info;
    int has_proof;
} trial;

static inline ns_mlcp problem(const trial *t) {
    return (ns_mlcp){.m = t->m, .W = t->W, .q = t->q, .l = t->l, .u = t->u};
}

/* Solves, and judges by the problem alone what is claimed. */
static inline int solve(trial *t, ns_mlcp_method method) {
    ns_mlcp p = problem(t);
    ns_mlcp_solver *s;
    assert_int_equal(ns_mlcp_create(t->m, &s), NS_OK);
    assert_int_equal(ns_mlcp_use(s, method), NS_OK);
    int status = ns_mlcp_solve(s, &p, t->mode, t->lambda, t->y, &t->info);
    const double *v = ns_mlcp_certificate(s);
    t->has_proof = v != NULL;
    assert_int_equal(t->info.certified, t->has_proof);
    if (v) {
        assert_int_equal(status, NS_E_INFEASIBLE);
        assert_true(ns_mlcp_certify(&p, v) > 0.0);
        assert_true(t->info.fault.npairs > 0);
        memcpy(t->v, v, (size_t)t->m * sizeof *v);
    }
    if (status == NS_OK)
        assert_true(ns_mlcp_residual(&p, t->lambda, NULL) < 1e-10);
    if (status == NS_E_INFEASIBLE && !v)
        assert_int_equal(t->info.method, NS_MLCP_ENUMERATE);
    ns_mlcp_free(s);
    return status;
}

static inline void by_rows(trial *t, const double *rows) {
    for (int i = 0; i < t->m; i++)
        for (int j = 0; j < t->m; j++)
            t->W[i + j * t->m] = rows[i * t->m + j];
}

static inline void close_to(double got, double expected) {
    if (!(fabs(got - expected) <= 1e-14 * fmax(1.0, fabs(expected))))
        fail_msg("%.17g is not %.17g", got, expected);
}

#endif
