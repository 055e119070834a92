/* src/mlcp/pivoting/transform.c - the principal pivot transform of W, of the pairs that are looked at:
 * exchanges, values.
 *
 * s->transform.pair[0..nwho-1] are those pairs, s->transform.place[i] the place of pair i among them, -1
 * elsewhere.  P (leading dimension stride()), diag, and all that is called a or b here are numbered by place.
 */
#include "transform.h"

#include <math.h>
#include <string.h>

#include "linalg/abs_product.h"
#include "mlcp/verify/residual_bound.h"

static const double TRUST = 1e-8; /* a pivot must keep eight of sixteen digits; refinement does the rest */
static const double EASY = 0.1;   /* good enough not to look for a better one */

void ns_mlcp_transform_start(ns_mlcp_solver *s) {
    memset(s->transform.basic, 0, (size_t)s->m);
    for (int i = 0; i < s->m; i++)
        s->transform.place[i] = -1;
    s->transform.count = 0;
    s->transform.valid = 1;
}

/* --- which pairs --- */

static inline size_t stride(const ns_mlcp_solver *s) {
    return ((size_t)s->m + 3) & ~(size_t)3;
}

static inline double *column(const ns_mlcp_solver *s, int a) {
    return s->transform.P + (size_t)a * stride(s);
}

/* y += v x for n entries of columns of P, and for what lies between the last and the next multiple of four,
 * where nothing is ever read: short loops without rests. */
static inline void add_multiple(int n, double v, const double *restrict x, double *restrict y) {
    for (int a = 0; a < n; a += 4)
        for (int k = a; k < a + 4; k++)
            y[k] += v * x[k];
}

/* Row and column of pair i, which is not basic, behind the others:
 *     P_ai = [W_ai] - sum_J P_aj W_ji,   P_ia = [W_ia] + sum_J W_ij P_ja,   [] where a is not basic. */
static int add_pair(ns_mlcp_solver *s, int i) {
    const size_t m = (size_t)s->m, ld = stride(s);
    const double *Wi = s->p->W + (size_t)i * m, own = Wi[i];
    const int n = s->transform.count;
    if (s->transform.place[i] >= 0)
        return s->transform.place[i];
    double *new = column(s, n), *across = s->transform.P + n, *row = s->g, size = fabs(own), sum = own;
    int *held = s->elim.parent, count = 0; /* where the row of W is not 0, and what it is */
    memset(new, 0, (size_t)n * sizeof *new);
    for (int b = 0; b < n; b++) {
        const int j = s->transform.pair[b];
        const double w = s->p->W[(size_t)i + (size_t)j * m];
        across[(size_t)b * ld] = s->transform.basic[j] ? 0.0 : w;
        if (!s->transform.basic[j])
            new[b] += Wi[j];
        else if (Wi[j] != 0.0)
            add_multiple(n, -Wi[j], column(s, b), new);
        held[count] = b;
        row[count] = w;
        count += s->transform.basic[j] && w != 0.0;
    }
    for (int b = 0; b < n; b++) {
        const double *col = column(s, b);
        double v = across[(size_t)b * ld];
        for (int h = 0; h < count; h++)
            v += row[h] * col[held[h]];
        across[(size_t)b * ld] = v;
    }
    for (int h = 0; h < count; h++) {
        const double term = row[h] * new[held[h]];
        sum += term;
        size = fabs(term) > size ? fabs(term) : size;
    }
    new[n] = sum;
    s->transform.largest[n] = size;
    s->transform.pair[n] = i;
    s->transform.place[i] = n;
    return s->transform.count++;
}

/* The last comes into its place. */
static void drop_pair(ns_mlcp_solver *s, int a) {
    const int last = --s->transform.count;
    s->transform.place[s->transform.pair[a]] = -1;
    if (a == last)
        return;
    const double *from = column(s, last);
    double *to = column(s, a);
    for (int b = 0; b < last; b++) {
        column(s, b)[a] = column(s, b)[last];
        to[b] = from[b];
    }
    to[a] = from[last];
    s->transform.largest[a] = s->transform.largest[last];
    s->transform.pair[a] = s->transform.pair[last];
    s->transform.place[s->transform.pair[a]] = a;
}

void ns_mlcp_transform_tidy(ns_mlcp_solver *s) {
    for (int a = s->transform.count - 1; a >= 0; a--)
        if (!s->transform.basic[s->transform.pair[a]])
            drop_pair(s, a);
}

/* --- exchanges --- */

double ns_mlcp_transform_trust(ns_mlcp_solver *s, int i) {
    const int a = add_pair(s, i);
    const double p = fabs(column(s, a)[a]);
    return p > 0.0 ? p / s->transform.largest[a] : 0.0;
}

double ns_mlcp_transform_trust2(ns_mlcp_solver *s, int i, int j) {
    const int a = add_pair(s, i), b = add_pair(s, j);
    const double across = column(s, b)[a] * column(s, a)[b];
    const double det = column(s, a)[a] * column(s, b)[b] - across;
    const double terms = s->transform.largest[a] * s->transform.largest[b] + fabs(across);
    return det != 0.0 ? fabs(det) / terms : 0.0;
}

static void count_exchange(ns_mlcp_solver *s, int i) {
    s->transform.basic[i] ^= 1;
    s->pivots++;
}

void ns_mlcp_transform_move(ns_mlcp_solver *s, int i, int n, const int *list) {
    const size_t m = (size_t)s->m;
    const int k = s->transform.place[i];
    const double *col = column(s, k),
                 by = s->transform.basic[i] ? ns_mlcp_bound(s, i, s->mode[i]) - s->lambda[i] : -s->y[i];
    const double step = by / col[k];
    if (!s->transform.basic[i] && s->own.nonzeros.few)
        s->transform.lterms[i] = fabs(s->lambda[i]);
    for (int a = 0; a < s->transform.count; a++) {
        const int j = s->transform.pair[a];
        const double change = j == i && !s->transform.basic[i] ? step
                              : s->transform.basic[j]          ? step * col[a]
                                                               : 0.0;
        s->lambda[j] += change;
        s->transform.lterms[j] += s->own.nonzeros.few ? fabs(change) : 0.0;
        if (change != 0.0 && s->own.nonzeros.few)
            ns_mlcp_nonzeros_add(&s->own.nonzeros, j, s->p->W + (size_t)j * m, change, s->y,
                                 s->transform.yterms);
        else
            for (int b = 0; b < n && change != 0.0; b++)
                s->y[list[b]] += s->p->W[(size_t)list[b] + (size_t)j * m] * change;
    }
    s->transform.carried &= s->own.nonzeros.few;
}

/* P_IJ -= c r_J / p for all columns but k, row k aside. */
void ns_mlcp_transform_pivot(ns_mlcp_solver *s, int i) {
    const int k = s->transform.place[i], n = s->transform.count;
    double *restrict c = column(s, k), *restrict diag = s->transform.largest;
    const double p = c[k], inverse = 1.0 / p;
    c[k] = 0.0; /* row k: set after the update */
    for (int b = 0; b < n; b++) {
        double *restrict col = column(s, b);
        const double r = col[k] * inverse, term = fabs(c[b] * r);
        if (b == k || r == 0.0)
            continue;
        add_multiple(n, -r, c, col);
        col[k] = -r;
        diag[b] = term > diag[b] ? term : diag[b];
    }
    for (int a = 0; a < n; a++)
        c[a] *= inverse;
    c[k] = inverse;
    diag[k] *= inverse * inverse;
    count_exchange(s, i);
}

void ns_mlcp_transform_pivot2(ns_mlcp_solver *s, int i, int j) {
    const int a = s->transform.place[i], b = s->transform.place[j], n = s->transform.count;
    double *ca = column(s, a), *cb = column(s, b);
    const double aa = ca[a], ba = ca[b], ab = cb[a], bb = cb[b], det = aa * bb - ab * ba;
    const double lost = 1.0 / ns_mlcp_transform_trust2(s, i, j);
    for (int k = 0; k < n; k++) {
        double *col = column(s, k);
        if (k == a || k == b || (col[a] == 0.0 && col[b] == 0.0))
            continue;
        const double ra = (bb * col[a] - ab * col[b]) / det, rb = (aa * col[b] - ba * col[a]) / det;
        const double term = fmax(fabs(ca[k] * ra), fabs(cb[k] * rb));
        for (int r = 0; r < n; r++)
            col[r] -= ca[r] * ra + cb[r] * rb;
        col[a] = -ra;
        col[b] = -rb;
        s->transform.largest[k] = fmax(s->transform.largest[k], term);
    }
    for (int r = 0; r < n; r++) {
        const double x = ca[r], y = cb[r];
        ca[r] = (x * bb - y * ba) / det;
        cb[r] = (y * aa - x * ab) / det;
    }
    ca[a] = bb / det;
    ca[b] = -ba / det;
    cb[a] = -ab / det;
    cb[b] = aa / det;
    const double da = s->transform.largest[a];
    s->transform.largest[a] = lost * s->transform.largest[b] / fabs(det);
    s->transform.largest[b] = lost * da / fabs(det);
    count_exchange(s, i);
    count_exchange(s, j);
}

/* The entry of list with the best pivot; the first easy one will do. */
static int best_pivot(ns_mlcp_solver *s, int n, const int *list, double *trust) {
    int best = -1;
    *trust = 0.0;
    for (int a = 0; a < n && *trust < EASY; a++) {
        double t = ns_mlcp_transform_trust(s, list[a]);
        if (t > *trust) {
            *trust = t;
            best = a;
        }
    }
    return best;
}

/* The best two of list; *first < *second. */
static double best_pivot2(ns_mlcp_solver *s, int n, const int *list, int *first, int *second) {
    double best = 0.0;
    for (int a = 0; a < n; a++)
        for (int b = a + 1; b < n && best < EASY; b++) {
            double t = ns_mlcp_transform_trust2(s, list[a], list[b]);
            if (t > best) {
                best = t;
                *first = a;
                *second = b;
            }
        }
    return best;
}

int ns_mlcp_transform_exchange(ns_mlcp_solver *s, int n, int *list) {
    while (n > 0) {
        double trust;
        int a = best_pivot(s, n, list, &trust), b = 0;
        if (trust >= TRUST) {
            ns_mlcp_transform_pivot(s, list[a]);
        } else if (best_pivot2(s, n, list, &a, &b) >= TRUST) {
            ns_mlcp_transform_pivot2(s, list[a], list[b]);
            list[b] = list[--n];
        } else
            break;
        list[a] = list[--n];
    }
    return n;
}

/* --- values --- */

void ns_mlcp_transform_column(ns_mlcp_solver *s, int i, double *rate) {
    const size_t m = (size_t)s->m;
    const double *col = column(s, add_pair(s, i));
    if (s->transform.basic[i])
        memset(rate, 0, m * sizeof *rate);
    else
        memcpy(rate, s->p->W + (size_t)i * m, m * sizeof *rate);
    for (int a = 0; a < s->transform.count; a++)
        if (s->transform.basic[s->transform.pair[a]])
            ns_linalg_matvec_add(s->m, 1, s->p->W + (size_t)s->transform.pair[a] * m, col + a, rate);
    for (int a = 0; a < s->transform.count; a++)
        rate[s->transform.pair[a]] = col[a];
}

void ns_mlcp_transform_values(ns_mlcp_solver *s) {
    const int n = s->transform.count, ld = (int)stride(s);
    double *x = s->rhs, *sum = x + n, *terms = sum + n, *none = terms + n;
    int plain = 1; /* lambda at its bounds is 0 */
    memset(s->lambda, 0, (size_t)s->m * sizeof *s->lambda);
    for (int i = 0; i < s->m && !s->at_zero; i++)
        if (!s->transform.basic[i]) {
            s->lambda[i] = ns_mlcp_bound(s, i, s->mode[i]);
            plain &= s->lambda[i] == 0.0;
        }
    if (!plain)
        ns_mlcp_sum_terms(s->p, &s->own.nonzeros, s->lambda, s->y, s->transform.yterms);
    memset(sum, 0, 3 * (size_t)n * sizeof *sum);
    for (int a = 0; a < n; a++)
        x[a] = -(plain ? s->p->q : s->y)[s->transform.pair[a]];
    ns_linalg_abs_product_add(n, n, ld, s->transform.P, x, sum, terms);
    if (!plain) { /* the terms of y count, of which x may be a small difference */
        memset(terms, 0, (size_t)n * sizeof *terms);
        for (int a = 0; a < n; a++)
            x[a] = s->transform.yterms[s->transform.pair[a]];
        ns_linalg_abs_product_add(n, n, ld, s->transform.P, x, none, terms);
    }
    for (int a = 0; a < n; a++) {
        s->lambda[s->transform.pair[a]] = sum[a];
        s->transform.lterms[s->transform.pair[a]] = terms[a];
    }
}

void ns_mlcp_transform_correct(ns_mlcp_solver *s) {
    const int n = s->transform.count;
    memset(s->g, 0, (size_t)n * sizeof *s->g);
    for (int b = 0; b < n; b++)
        ns_linalg_matvec_add(n, 1, column(s, b), s->y + s->transform.pair[b], s->g);
    for (int a = 0; a < n; a++)
        s->lambda[s->transform.pair[a]] -= s->g[a];
}
