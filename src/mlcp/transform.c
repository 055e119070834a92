/* src/mlcp/transform.c - the principal pivot transform of W: exchanges, values. */
#include "transform.h"

#include <math.h>
#include <string.h>

static const double TRUST = 1e-8; /* a pivot must keep eight of sixteen digits; refinement does the rest */
static const double EASY = 0.1;   /* good enough not to look for a better one */

void ns_transform_start(ns_mlcp_solver *s) {
    const size_t m = (size_t)s->m;
    memcpy(s->P, s->p->W, m * m * sizeof *s->P);
    memset(s->in, 0, m);
    for (size_t i = 0; i < m; i++)
        s->diag[i] = fabs(s->p->W[i * (m + 1)]);
    s->changes = 0;
    s->have_transform = 1;
}

double ns_transform_trust(const ns_mlcp_solver *s, int k) {
    double p = fabs(s->P[(size_t)k * ((size_t)s->m + 1)]);
    return p > 0.0 ? p / s->diag[k] : 0.0;
}

double ns_transform_trust2(const ns_mlcp_solver *s, int k, int l) {
    const size_t m = (size_t)s->m, a = (size_t)k, b = (size_t)l;
    double across = s->P[a + b * m] * s->P[b + a * m];
    double det = s->P[a * (m + 1)] * s->P[b * (m + 1)] - across;
    double terms = s->diag[k] * s->diag[l] + fabs(across);
    return det != 0.0 ? fabs(det) / terms : 0.0;
}

/* P_IJ -= c r_J / p for all columns but k, row k aside. */
void ns_transform_pivot(ns_mlcp_solver *s, int k) {
    const size_t m = (size_t)s->m, kk = (size_t)k;
    double *restrict c = s->P + kk * m, *restrict diag = s->diag;
    const double p = c[kk], inverse = 1.0 / p;
    c[kk] = 0.0; /* row k: set after the update */
    for (size_t j = 0; j < m; j++) {
        double *restrict col = s->P + j * m;
        const double r = col[kk] * inverse, term = fabs(c[j] * r);
        if (j == kk || r == 0.0)
            continue;
        for (size_t i = 0; i < m; i++)
            col[i] -= c[i] * r;
        col[kk] = -r;
        diag[j] = term > diag[j] ? term : diag[j];
    }
    for (size_t i = 0; i < m; i++)
        c[i] *= inverse;
    c[kk] = inverse;
    diag[kk] *= inverse * inverse;
    s->in[k] ^= 1;
    s->changes++;
    s->pivots++;
}

void ns_transform_pivot2(ns_mlcp_solver *s, int k, int l) {
    const size_t m = (size_t)s->m, a = (size_t)k, b = (size_t)l;
    double *ca = s->P + a * m, *cb = s->P + b * m;
    const double aa = ca[a], ba = ca[b], ab = cb[a], bb = cb[b], det = aa * bb - ab * ba;
    const double lost = 1.0 / ns_transform_trust2(s, k, l);
    for (size_t j = 0; j < m; j++) {
        double *col = s->P + j * m;
        if (j == a || j == b || (col[a] == 0.0 && col[b] == 0.0))
            continue;
        const double ra = (bb * col[a] - ab * col[b]) / det, rb = (aa * col[b] - ba * col[a]) / det;
        const double term = fmax(fabs(ca[j] * ra), fabs(cb[j] * rb));
        for (size_t i = 0; i < m; i++)
            col[i] -= ca[i] * ra + cb[i] * rb;
        col[a] = -ra;
        col[b] = -rb;
        s->diag[j] = fmax(s->diag[j], term);
    }
    for (size_t i = 0; i < m; i++) {
        const double x = ca[i], y = cb[i];
        ca[i] = (x * bb - y * ba) / det;
        cb[i] = (y * aa - x * ab) / det;
    }
    ca[a] = bb / det;
    ca[b] = -ba / det;
    cb[a] = -ab / det;
    cb[b] = aa / det;
    const double da = s->diag[a];
    s->diag[a] = lost * s->diag[b] / fabs(det);
    s->diag[b] = lost * da / fabs(det);
    s->in[k] ^= 1;
    s->in[l] ^= 1;
    s->changes += 2;
    s->pivots += 2;
}

/* The entry of list with the best pivot; the first easy one will do. */
static int choose(const ns_mlcp_solver *s, int n, const int *list, double *trust) {
    int best = -1;
    *trust = 0.0;
    for (int a = 0; a < n && *trust < EASY; a++) {
        double t = ns_transform_trust(s, list[a]);
        if (t > *trust) {
            *trust = t;
            best = a;
        }
    }
    return best;
}

/* The best two of list; *first < *second. */
static double choose2(const ns_mlcp_solver *s, int n, const int *list, int *first, int *second) {
    double best = 0.0;
    for (int a = 0; a < n; a++)
        for (int b = a + 1; b < n && best < EASY; b++) {
            double t = ns_transform_trust2(s, list[a], list[b]);
            if (t > best) {
                best = t;
                *first = a;
                *second = b;
            }
        }
    return best;
}

int ns_transform_exchange(ns_mlcp_solver *s, int n, int *list) {
    while (n > 0) {
        double trust;
        int a = choose(s, n, list, &trust), b = 0;
        if (trust >= TRUST) {
            ns_transform_pivot(s, list[a]);
        } else if (choose2(s, n, list, &a, &b) >= TRUST) {
            ns_transform_pivot2(s, list[a], list[b]);
            list[b] = list[--n];
        } else
            break;
        list[a] = list[--n];
    }
    return n;
}

void ns_transform_values(ns_mlcp_solver *s) {
    const size_t m = (size_t)s->m;
    double *restrict out = s->g, *restrict size = s->size;
    memset(out, 0, m * sizeof *out);
    memset(size, 0, m * sizeof *size);
    for (size_t j = 0; j < m; j++) {
        const double v = s->in[j] ? -s->p->q[j] : s->mode[j] == NS_UPPER ? s->p->u[j] : s->p->l[j];
        const double *restrict col = s->P + j * m;
        s->way[j] = v;
        if (v == 0.0)
            continue;
        for (size_t i = 0; i < m; i++) {
            const double term = col[i] * v;
            out[i] += term;
            size[i] += fabs(term);
        }
    }
    for (size_t i = 0; i < m; i++) {
        const double q = s->p->q[i];
        s->lambda[i] = s->in[i] ? out[i] : s->way[i];
        s->y[i] = s->in[i] ? 0.0 : out[i] + q;
        size[i] += s->in[i] ? 0.0 : fabs(q);
    }
}

void ns_transform_correct(ns_mlcp_solver *s) {
    const size_t m = (size_t)s->m;
    memset(s->g, 0, m * sizeof *s->g);
    for (size_t j = 0; j < m; j++)
        if (s->in[j] && s->y[j] != 0.0)
            ns_matvec_add(s->m, 1, s->P + j * m, s->y + j, s->g);
    for (size_t i = 0; i < m; i++)
        if (s->in[i])
            s->lambda[i] -= s->g[i];
}
