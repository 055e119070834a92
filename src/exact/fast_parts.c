/* src/exact/fast_parts.c - what rings much faster than the rest of its mode: its eigenvectors. */
#include "fast_parts.h"

#include "exact_internal.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rates within this ratio of the fastest are fast; the rest's steps have to be so much longer to be worth it.
 */
enum { FAST_RATIO = 16, LEAST_GAIN = 8 };

void ns_exact_fast_free(ns_fast_parts *p) {
    if (!p)
        return;
    ns_exact_fast_free(p->wider);
    for (int k = 0; k < NS_LONG_STEPS; k++)
        ns_exact_step_free(p->step[k]);
    free(p->left);
    free(p->is_first);
    free(p);
}

size_t ns_exact_fast_bytes(const ns_fast_parts *p) {
    size_t sum = p ? p->bytes + ns_exact_fast_bytes(p->wider) : 0;
    for (int k = 0; p && k < NS_LONG_STEPS; k++)
        sum += p->step[k] ? p->step[k]->bytes : 0;
    return sum;
}

static ns_fast_parts *allocate(const ns_mode_kernel *k, int count) {
    const size_t n = (size_t)count, q = (size_t)k->q, r = (size_t)k->r, rows = (size_t)k->rows;
    const size_t numbers = n * (2 * q + r + rows + 2) + q + rows;
    ns_fast_parts *p = calloc(1, sizeof *p);
    if (!p)
        return NULL;
    p->left = calloc(numbers + 1, sizeof *p->left);
    p->is_first = calloc(n + 1, 1);
    if (!p->left || !p->is_first) {
        ns_exact_fast_free(p);
        return NULL;
    }
    p->count = count;
    p->left_size = p->left + n * q;
    p->right = p->left_size + n * q;
    p->guard = p->right + n * r;
    p->amplitude = p->guard + n * rows;
    p->noise = p->amplitude + n;
    p->rest = p->noise + n;
    p->bound = p->rest + q;
    p->bytes = sizeof *p + numbers * sizeof *p->left + n;
    return p;
}

/* Eigenvalues and eigenvectors of D, w by w. */
typedef struct ns_eigen {
    double *re, *im;      /* r */
    double *left, *right; /* r*r, as LAPACK gives them */
    double *D;            /* r*r */
} ns_eigen;

static int find_eigenvectors(const ns_mode_kernel *k, ns_eigen *e) {
    const size_t r = (size_t)k->r;
    *e = (ns_eigen){.re = malloc(sizeof(double) * (3 * r * r + 2 * r + 1))};
    if (!e->re)
        return NS_E_MEMORY;
    e->im = e->re + r;
    e->left = e->im + r;
    e->right = e->left + r * r;
    e->D = e->right + r * r;
    for (size_t j = 0; j < r; j++)
        memcpy(e->D + j * r, k->laguerre_powers + j * NS_ORDER * r, sizeof(double) * r);
    return ns_linalg_eigenvectors(k->r, e->D, e->re, e->im, e->left, e->right);
}

/* d is the eigenvalue of an Euler step: the rate d / (1 + d) / g, of *growth its real part; its size. */
static double rate_of(double g, double re, double im, double *growth) {
    const double a = 1 + re, size = a * a + im * im;
    *growth = (re * a + im * im) / size / g;
    return hypot(re, im) / sqrt(size) / g;
}

/* Rates that this time scale resolves, above `least`, are fast. */
static int is_fast(const ns_mode_kernel *k, double size, double least) {
    return size > least && size < 1.5 * NS_REACH / k->h;
}

/* With each rate that is fast those within the ratio of it are so too: what all of them are above. */
static double widen(const ns_mode_kernel *k, const ns_eigen *e, double least) {
    double growth, slowest = least * FAST_RATIO, before = INFINITY;
    while (slowest < before) {
        before = slowest;
        for (int i = 0; i < k->r; i++) {
            const double size = rate_of(k->g, e->re[i], e->im[i], &growth);
            slowest = is_fast(k, size, before / FAST_RATIO) ? ns_lower(slowest, size) : slowest;
        }
    }
    return slowest / FAST_RATIO;
}

/* The parts of the time scale that are fast, and the kernel's step for the rest; 0: the rest is as fast. */
static int count_fast(const ns_exact *f, const ns_mode_kernel *k, const ns_eigen *e, double least,
                      double *slow_h) {
    const double fastest = NS_REACH / k->h;
    double rest = 0, growth, most_growth = 0;
    int count = 0;
    for (int i = 0; i < k->r; i++) {
        const double size = rate_of(k->g, e->re[i], e->im[i], &growth);
        const int fast = is_fast(k, size, least);
        count += fast;
        most_growth = fast ? ns_higher(most_growth, growth) : most_growth;
        rest = !fast && size < fastest ? ns_higher(rest, size) : rest;
    }
    for (int i = 0; i < f->inputs->nv; i++) {
        const ns_input_state *is = &f->inputs->state[i];
        if (is->kind == NS_STATE_DECAY || is->kind == NS_STATE_COS)
            rest = ns_higher(rest, hypot(is->wave.theta, is->omega));
    }
    *slow_h = ns_exact_kernel_length(f->h, rest);
    const double longest = ldexp(*slow_h, NS_MAX_GUARDED_EXPONENT);
    return *slow_h >= LEAST_GAIN * k->h && most_growth * longest < 1e-3 ? count : 0;
}

/* d I - D of the inputs, its real and imaginary part side by side (4 nv*nv), transposed. */
static void fill_input_system(const ns_input_states *e, double g, double re, double im, double *a,
                              double *v) {
    const int nv = e->nv, n = 2 * nv;
    for (int j = 0; j < nv; j++) {
        memset(v, 0, sizeof *v * (size_t)nv);
        v[j] = 1;
        ns_inputs_states_stage(e, g, v);
        for (int i = 0; i < nv; i++) {
            const double D = v[i] - (i == j);
            a[j + i * n] = a[j + nv + (i + nv) * n] = (i == j ? re : 0) - D;
            a[j + nv + i * n] = i == j ? im : 0;
            a[j + (i + nv) * n] = i == j ? -im : 0;
        }
    }
}

/* The rows of a part by inputs: row_v (d - D_vv) = row_w D_wv, real part and imaginary part. */
static int extend_to_inputs(const ns_exact *f, const ns_mode_kernel *k, ns_fast_parts *p, int at, double re,
                            double im) {
    const int nv = k->nv, pair = p->is_first[at];
    const size_t n = 2 * (size_t)nv;
    ns_lu *lu = NULL;
    double *a = calloc(n * n + n + (size_t)nv + 1, sizeof *a), *b = a ? a + n * n : NULL;
    int status = a ? ns_linalg_lu_create((int)n, &lu) : NS_E_MEMORY;
    if (status == NS_OK) {
        fill_input_system(f->inputs, k->g, re, im, a, b + n);
        for (int j = 0; j < nv; j++) {
            const double *D = k->laguerre_powers + (size_t)(k->r + j) * (size_t)(NS_ORDER * k->r);
            for (int i = 0; i < k->r; i++) {
                b[j] += p->left[at + i * p->count] * D[i];
                b[nv + j] += pair ? p->left[at + 1 + i * p->count] * D[i] : 0;
            }
        }
        status = ns_linalg_lu_factor(lu, (int)n, a, NULL);
    }
    if (status == NS_OK) {
        ns_linalg_lu_solve(lu, 1, b);
        for (int j = 0; j < nv; j++) {
            p->left[at + (k->r + j) * p->count] = b[j];
            if (pair)
                p->left[at + 1 + (k->r + j) * p->count] = b[nv + j];
        }
    }
    ns_linalg_lu_free(lu);
    free(a);
    return status;
}

/* Part `at` of eigenvalue i, or both of a pair: u scaled so that u v = 1; w = 2 Re(v u w). */
static void fill_part(const ns_mode_kernel *k, const ns_eigen *e, ns_fast_parts *p, int at, int i) {
    const int r = k->r, pair = p->is_first[at];
    const double *ur = e->left + i * r, *ui = ur + r, *vr = e->right + i * r, *vi = vr + r;
    double re = 0, im = 0; /* of conj(u) v */
    for (int j = 0; j < r; j++) {
        re += ur[j] * vr[j] + (pair ? ui[j] * vi[j] : 0);
        im += pair ? ur[j] * vi[j] - ui[j] * vr[j] : 0;
    }
    const double size = re * re + im * im;
    for (int j = 0; j < r; j++) {
        const double a = ur[j], b = pair ? -ui[j] : 0;
        p->left[at + j * p->count] = (a * re + b * im) / size;
        p->right[j + at * r] = (pair ? 2 : 1) * vr[j];
        if (pair) {
            p->left[at + 1 + j * p->count] = (b * re - a * im) / size;
            p->right[j + (at + 1) * r] = -2 * vi[j];
        }
    }
}

static void fill_guards(const ns_mode_kernel *k, ns_fast_parts *p) {
    for (int at = 0; at < p->count; at += 1 + p->is_first[at])
        for (int g = 0; g < k->rows; g++) {
            const double *c = k->value + g * k->q;
            double first = 0, second = 0;
            for (int j = 0; j < k->r; j++) {
                first += c[j] * p->right[j + at * k->r];
                second += p->is_first[at] ? c[j] * p->right[j + (at + 1) * k->r] : 0;
            }
            p->guard[g + at * k->rows] = hypot(first, second);
        }
    for (int i = 0; i < p->count * k->q; i++)
        p->left_size[i] = fabs(p->left[i]);
}

static int fill(const ns_exact *f, const ns_mode_kernel *k, const ns_eigen *e, double least,
                ns_fast_parts *p) {
    int status = NS_OK;
    for (int i = 0, at = 0; i < k->r && at < p->count && status == NS_OK; i++) {
        double growth;
        const int pair = e->im[i] != 0;
        if (is_fast(k, rate_of(k->g, e->re[i], e->im[i], &growth), least)) {
            p->is_first[at] = (unsigned char)pair;
            fill_part(k, e, p, at, i);
            status = extend_to_inputs(f, k, p, at, e->re[i], e->im[i]);
            at += 1 + pair;
        }
        i += pair;
    }
    fill_guards(k, p);
    const size_t numbers = (size_t)p->count * (size_t)(k->q + k->r + k->rows);
    return status == NS_OK && !ns_linalg_finite(numbers, p->left_size) ? NS_E_NUMBER : status;
}

/* The parts above `least`; none if the rest is as fast or the parts cannot be told apart.  NULL: no memory.
 */
static ns_fast_parts *make(const ns_exact *f, const ns_mode_kernel *k, const ns_eigen *e, double least) {
    double slow_h;
    const int count = count_fast(f, k, e, least, &slow_h);
    ns_fast_parts *p = allocate(k, count);
    const int status = p && count > 0 ? fill(f, k, e, least, p) : NS_OK;
    if (status == NS_E_MEMORY) {
        ns_exact_fast_free(p);
        return NULL;
    }
    if (p && status != NS_OK)
        p->count = 0;
    if (p)
        p->slow_h = slow_h;
    return p;
}

/* Those of the time scale, or the wider ones if these alone leave a rest that is slower. */
static int make_both(const ns_exact *f, const ns_mode_kernel *k, const ns_eigen *e, ns_fast_parts **out) {
    const double least = NS_REACH / k->h / FAST_RATIO, wider = widen(k, e, least);
    ns_fast_parts *p = make(f, k, e, least), *w = p && wider < least ? make(f, k, e, wider) : NULL;
    *out = p;
    if (!p || (wider < least && !w)) {
        ns_exact_fast_free(p);
        *out = NULL;
        return NS_E_MEMORY;
    }
    if (w && w->count > 0 && p->count == 0) {
        ns_exact_fast_free(p);
        *out = w;
    } else if (w && w->count > p->count) {
        p->wider = w;
    } else {
        ns_exact_fast_free(w);
    }
    return NS_OK;
}

int ns_exact_fast_build(ns_exact *f, ns_time_scale *scale) {
    const ns_mode_kernel *k = scale->kernel;
    ns_eigen e;
    int status = find_eigenvectors(k, &e);
    if (status == NS_OK) {
        status = make_both(f, k, &e, &scale->fast);
    } else if (status != NS_E_MEMORY) {
        scale->fast = allocate(k, 0);
        status = scale->fast ? NS_OK : NS_E_MEMORY;
    }
    free(e.re);
    f->cache.bytes += ns_exact_fast_bytes(scale->fast);
    return status;
}

void ns_exact_fast_split(const ns_exact *f, const ns_mode_kernel *k, ns_fast_parts *p) {
    for (int j = 0; j < k->q; j++)
        p->rest[j] = fabs(f->X[j]);
    ns_linalg_matvec(p->count, k->q, p->left, f->X, p->amplitude);
    ns_linalg_matvec(p->count, k->q, p->left_size, p->rest, p->noise);
    ns_linalg_matvec(k->r, p->count, p->right, p->amplitude, p->rest);
    for (int j = 0; j < k->q; j++)
        p->rest[j] = f->X[j] - (j < k->r ? p->rest[j] : 0);
    for (int i = 0; i < p->count; i++) {
        const double rounding = 64 * DBL_EPSILON * p->noise[i];
        if (p->is_first[i]) {
            p->amplitude[i] = hypot(p->amplitude[i], p->amplitude[i + 1]) + rounding;
            p->amplitude[i] += 64 * DBL_EPSILON * p->noise[i + 1];
            p->amplitude[++i] = 0;
        } else {
            p->amplitude[i] = fabs(p->amplitude[i]) + rounding;
        }
    }
    ns_linalg_matvec(k->rows, p->count, p->guard, p->amplitude, p->bound);
}
