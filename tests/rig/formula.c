/* tests/rig/formula.c - one step of a linear system by (T1), (T6), (T7), (P1) and (T8), literally. */
#include "formula.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/dense.h"

enum { N = FORMULA_N, P = FORMULA_P, Z = FORMULA_Z };

ns_system *formula_system(dice *d) {
    ns_system *s;
    if (ns_system_create(N, P, Z, 0, &s) != NS_OK)
        abort();
    double *const parts[] = {s->A, s->B, s->b, s->E, s->e, s->F};
    const int sizes[] = {N * N, N * P, N, N * Z, P, P * Z};
    for (int k = 0; k < 6; k++)
        for (int i = 0; i < sizes[k]; i++)
            parts[k][i] = dice_either(d);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            s->M[i + j * N] = 0.2 * dice_either(d) + (i == j ? 1 : 0);
    for (int i = 0; i < P; i++) {
        s->D[i + i * P] = 1;
        for (int j = 0; j < N; j++)
            s->C[i + j * P] = s->B[j + i * N];
    }
    const ns_signal none = {.kind = NS_DC};
    for (int k = 0; k < Z; k++)
        if (ns_system_set_input(s, k, &none) != NS_OK)
            abort();
    return s;
}

static void solve(const double *W, int columns, double *b) {
    ns_lu *f;
    if (ns_linalg_lu_create(N, &f) != NS_OK || ns_linalg_lu_factor(f, N, W, NULL) != NS_OK)
        abort();
    ns_linalg_lu_solve(f, columns, b);
    ns_linalg_lu_free(f);
}

/* lambda of y = Wm lambda + q, 0 <= y _|_ lambda >= 0: projected Gauss-Seidel to rounding. */
static void complementary(const double *Wm, const double *q, double *lambda) {
    for (int i = 0; i < P; i++)
        lambda[i] = 0;
    for (int sweep = 0; sweep < 3000; sweep++)
        for (int i = 0; i < P; i++) {
            double y = q[i];
            for (int c = 0; c < P; c++)
                y += Wm[i + c * P] * lambda[c];
            lambda[i] = fmax(0, lambda[i] - y / Wm[i + i * P]);
        }
}

static void free_state(const ns_system *s, const formula_scheme *o, const formula_point *k,
                       const formula_inputs *z, double *v) {
    const double h = o->h, th = o->theta, carried = o->relation == NS_RELATION_GAMMA ? 0 : h * (1 - o->gamma);
    for (int i = 0; i < N; i++) {
        double m = 0, a = 0, r = 0, b0 = s->b[i], b1 = s->b[i];
        for (int j = 0; j < N; j++) {
            m += s->M[i + j * N] * k->x[j];
            a += s->A[i + j * N] * k->x[j];
        }
        for (int j = 0; j < P; j++)
            r += s->B[i + j * N] * k->lambda[j];
        for (int j = 0; j < Z; j++) {
            b0 += s->E[i + j * N] * z->before[j];
            b1 += s->E[i + j * N] * z->end[j];
        }
        v[i] = m + h * (1 - th) * a + h * (th * b1 + (1 - th) * b0) + carried * r; /* (T6) */
    }
}

void formula_step(const ns_system *s, const formula_scheme *o, const formula_point *k,
                  const formula_inputs *z, formula_point *next, double *x_free) {
    const int inside = o->relation == NS_RELATION_GAMMA;
    const double hr = inside ? o->h : o->h * o->gamma, cx = inside ? o->gamma : 1; /* (T8) */
    double W[N * N], V[N * P], v[N], q[P], Wm[P * P], lambda[P];
    for (int i = 0; i < N * N; i++)
        W[i] = s->M[i] - o->h * o->theta * s->A[i]; /* (T1) */
    free_state(s, o, k, z, v);
    solve(W, 1, v);
    if (x_free)
        memcpy(x_free, v, sizeof v);
    memcpy(V, s->B, sizeof V);
    solve(W, P, V);
    for (int i = 0; i < P; i++) {
        q[i] = s->e[i];
        for (int j = 0; j < N; j++)
            q[i] += s->C[i + j * P] * (cx * v[j] + (1 - cx) * k->x[j]);
        for (int j = 0; j < Z; j++)
            q[i] += s->F[i + j * P] * z->relation[j]; /* (T7) */
        for (int c = 0; c < P; c++) {
            Wm[i + c * P] = s->D[i + c * P];
            for (int j = 0; j < N; j++)
                Wm[i + c * P] += cx * hr * s->C[i + j * P] * V[j + c * N]; /* (P1) */
        }
    }
    complementary(Wm, q, lambda);
    for (int i = 0; i < N; i++) {
        next->x[i] = v[i];
        for (int c = 0; c < P; c++)
            next->x[i] += hr * V[i + c * N] * lambda[c];
    }
    memcpy(next->lambda, lambda, sizeof lambda);
}
