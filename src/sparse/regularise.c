/* src/sparse/regularise.c - (P2) where the laws of devices leave it singular: the limit of vanishing leaks.
 *
 * Two closed switches in parallel share a current in no particular way; a part behind open ones floats.  With
 * a leak across each open pair and a resistance in series with each closed one K is regular, K_g, and
 *
 *     v <- v + K_g^-1 (r - K v),   from v = 0
 *
 * converges to a solution of K v = r: what is determined in a few rounds; what is open as the leaks divide
 * it. Where parts are coupled by less than the leaks, rounds gain little each: a few Krylov cycles (GMRES)
 * follow.
 */
#include "regularise.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 3, CYCLES = 3, KRYLOV = 12 };
/* The residual of (P2), relative to the largest terms: rounds end below `holds`; (P2) is solved below
 * `may_hold`. */
static const double holds = 64 * DBL_EPSILON, may_hold = 1e-11;
/* What decayed to smaller numbers has lost its digits. */
static const double nothing = DBL_MIN / DBL_EPSILON;
/* The equations contradict each other where the residual stays above `fell` of the right-hand side; or above
 * `least` of it, if a current larger than `far` of the largest changed its sign and grew: to `grown` times
 * the largest of the first rounds, or to `grown_far` times, if the residual is below `little`. */
static const double fell = 1e-3, least = 1e-9, far = 1e-3, little = 1e-7, grown = 1e3, grown_far = 1e9;

/* The terms that row i of (P2) is summed from. */
static double terms_of(const ns_form *f, double g, const ns_mode *mode, int i, const double *v) {
    const int j = i - f->n;
    if (j < 0)
        return (f->algebraic[i] ? 0 : ns_linalg_csc_size(&f->Mt, i, v)) +
               ns_sparse_form_rate(f, g, i) * ns_linalg_csc_size(&f->At, i, v);
    return ns_mode_slides(mode[j]) ? ns_linalg_csc_size(&f->gx, f->command[j], v)
           : mode[j] == NS_INSIDE  ? ns_linalg_csc_size(&f->Ct, j, v)
                                   : fabs(v[i]);
}

/* Those of lambda_j as what is left over in the rows it enters. */
static double terms_around(const ns_form *f, double g, const ns_mode *mode, int j, const double *v) {
    double most = 0;
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i < f->n && f->KA[k] != 0)
            most =
                ns_higher(terms_of(f, g, mode, i, v) / fabs(f->KA[k] * ns_sparse_form_rate(f, g, i)), most);
    }
    return most;
}

/* known: lambdas of open pairs were moved to r. */
static double left_of(const ns_form *f, double g, const ns_mode *mode, const double *scale, const double *r,
                      const double *v, const double *seen, int known, double *rest) {
    double worst = 0, most = 0;
    for (int i = 0; scale && i < f->size; i++)
        most = fmax(most, scale[i] * (fabs(r[i]) + terms_of(f, g, mode, i, v)));
    memcpy(rest, r, sizeof(double) * (size_t)f->size);
    ns_sparse_form_subtract(f, g, mode, v, rest);
    if (known)
        ns_sparse_form_leave_known(f, mode, v, rest);
    for (int i = 0; i < f->size; i++) {
        const int j = i - f->n;
        if (fabs(rest[i]) < nothing)
            continue;
        double terms = fabs(r[i]) + terms_of(f, g, mode, i, v) + (scale ? far * most / scale[i] : 0);
        if (j >= 0 && mode[j] != NS_INSIDE && !ns_mode_slides(mode[j]))
            terms += terms_around(f, g, mode, j, v);
        if (seen && fabs(rest[i]) > worst * terms) /* terms may be what others round */
            terms += terms_of(f, g, mode, i, seen);
        worst = fabs(rest[i]) <= worst * terms ? worst : fabs(rest[i]) / terms; /* NaN stays */
    }
    return worst;
}

double ns_sparse_leaks_left(const ns_form *f, double g, const ns_mode *mode, const double *scale,
                            const double *r, const double *v, const double *seen, double *rest) {
    return left_of(f, g, mode, scale, r, v, seen, 0, rest);
}

/* The same of right-hand sides of rounds, to which lambdas of open pairs were moved. */
static double leaves(const ns_sparse_leaks *k, const double *r, const double *v, double *rest) {
    return left_of(k->f, k->g, k->mode, k->scale, r, v, NULL, 1, rest);
}

/* --- rounds --- */

static double dot(int size, const double *unit, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < size; i++)
        sum += a[i] * unit[i] * (b[i] * unit[i]);
    return sum;
}

/* Takes out of q what lies along the first count of Q, orthonormal; h: how much. */
static void straighten(int size, const double *unit, int count, const double *Q, double *q, double *h) {
    for (int i = 0; i < count; i++) {
        const double *along = Q + (size_t)i * (size_t)size;
        const double weight = dot(size, unit, along, q);
        h[i] += weight;
        for (int l = 0; l < size; l++)
            q[l] -= weight * along[l];
    }
}

/* The weight (count) of each direction such that what they make is nearest to beta e_1: H is Hessenberg,
 * column by column of KRYLOV + 1, and is rotated. */
static void least_squares(int count, double beta, double (*H)[KRYLOV + 1], double *weight) {
    double right[KRYLOV + 1] = {beta};
    for (int k = 0; k < count; k++) {
        const double size = hypot(H[k][k], H[k][k + 1]), c = size > 0 ? H[k][k] / size : 1,
                     s = size > 0 ? H[k][k + 1] / size : 0;
        for (int j = k; j < count; j++) {
            const double upper = H[j][k], lower = H[j][k + 1];
            H[j][k] = c * upper + s * lower;
            H[j][k + 1] = c * lower - s * upper;
        }
        right[k + 1] = -s * right[k];
        right[k] *= c;
    }
    for (int k = count - 1; k >= 0; k--) {
        double sum = right[k];
        for (int j = k + 1; j < count; j++)
            sum -= H[j][k] * weight[j];
        weight[k] = fabs(H[k][k]) > DBL_EPSILON ? sum / H[k][k] : 0;
    }
}

/* v += K^-1 rest, by GMRES with K_g as preconditioner.  Q: room for KRYLOV + 1 vectors. */
static void krylov_cycle(const ns_sparse_leaks *k, const ns_null_space *z, const double *rest, double *v,
                         double *Q) {
    const int size = k->f->size;
    double H[KRYLOV][KRYLOV + 1] = {{0}}, weight[KRYLOV] = {0};
    int count = 0;
    memcpy(Q, rest, sizeof(double) * (size_t)size);
    ns_linalg_klu_solve(k->klu, k->factors, Q);
    const double beta = sqrt(dot(size, k->unit, Q, Q));
    for (int i = 0; i < size && beta > 0; i++)
        Q[i] /= beta;
    while (count < KRYLOV && beta > 0) {
        double *q = Q + (size_t)count * (size_t)size, *next = q + size, *h = H[count];
        memset(next, 0, sizeof(double) * (size_t)size);
        ns_sparse_form_subtract(k->f, k->g, k->mode, q, next);
        ns_sparse_form_leave_known(k->f, k->mode, q, next);
        for (int i = 0; i < size; i++)
            next[i] = -next[i];
        if (z)
            ns_sparse_null_make_solvable(k, z, next);
        ns_linalg_klu_solve(k->klu, k->factors, next);
        count++;
        straighten(size, k->unit, count, Q, next, h);
        straighten(size, k->unit, count, Q, next, h);
        h[count] = sqrt(dot(size, k->unit, next, next));
        if (!(h[count] > 1e-14))
            break;
        for (int i = 0; i < size; i++)
            next[i] /= h[count];
    }
    least_squares(count, beta, H, weight);
    for (int i = 0; i < count; i++)
        for (int l = 0; l < size; l++)
            v[l] += weight[i] * Q[(size_t)i * (size_t)size + (size_t)l];
}

static double largest(const ns_sparse_leaks *k, const double *rest) {
    double most = 0;
    for (int i = 0; i < k->f->size; i++)
        most = fmax(most, fabs(rest[i]) * k->scale[i]);
    return most;
}

/* 1 if laws of closed pairs are violated by far more than rounding of their terms. */
static int laws_contradict(const ns_sparse_leaks *k, const double *v, const double *rest) {
    double most = 0, off = 0;
    for (int j = 0; j < k->f->m; j++)
        if (k->mode[j] == NS_INSIDE) {
            most = fmax(most, ns_linalg_csc_size(&k->f->Ct, j, v));
            off = fmax(off, fabs(rest[k->f->n + j]));
        }
    return off > fell * most;
}

/* 1 if the current of a closed pair has another sign than after the first rounds, and is so many times as
 * large as the largest was. */
static int any_reversed(const ns_sparse_leaks *k, const double *first, const double *v, double times) {
    const double *was = first + k->f->n, *is = v + k->f->n;
    double most = 0;
    for (int j = 0; j < k->f->m; j++)
        most = k->mode[j] == NS_INSIDE ? fmax(most, fabs(was[j])) : most;
    for (int j = 0; j < k->f->m; j++)
        if (k->mode[j] == NS_INSIDE && fabs(was[j]) > far * most && was[j] * is[j] < 0 &&
            fabs(is[j]) > times * most)
            return 1;
    return 0;
}

/* Relative to unknowns that grow a contradiction gets small. */
static int contradicts(const ns_sparse_leaks *k, const double *r, const double *first, const double *v,
                       const double *rest) {
    const double now = largest(k, rest), all = largest(k, r);
    const double times = now > little * all ? grown : grown_far;
    return now > fell * all ||
           (now > least * all && laws_contradict(k, v, rest) && any_reversed(k, first, v, times));
}

/* Rounds by the factors with leaks, from v = 0; z: the null space, of which right is free, or NULL.  Returns
 * what is left. */
static double go_rounds(const ns_sparse_leaks *k, const ns_null_space *z, const double *right, double *v,
                        double *rest) {
    const size_t bytes = sizeof(double) * (size_t)k->f->size;
    double left = INFINITY;
    memcpy(rest, right, bytes);
    memset(v, 0, bytes);
    for (int round = 0; round < ROUNDS && left > holds; round++) {
        if (z) {
            ns_sparse_null_make_solvable(k, z, rest);
        }
        ns_linalg_klu_solve(k->klu, k->factors, rest);
        for (int i = 0; i < k->f->size; i++)
            v[i] += rest[i];
        left = leaves(k, right, v, rest);
    }
    return left;
}

/* Then Krylov cycles. */
static double go_on(const ns_sparse_leaks *k, const ns_null_space *z, const double *right, double left,
                    double *v, double *rest, double *Q) {
    /* weakly coupled parts are far off at a small residual; at rest (g = 0) they cannot be told from floating
     * ones, which further rounds would take elsewhere */
    for (int cycle = 0; cycle < CYCLES && left > (cycle == 0 && k->g > 0 ? holds : may_hold); cycle++) {
        if (z)
            ns_sparse_null_make_solvable(k, z, rest);
        krylov_cycle(k, z, rest, v, Q);
        left = leaves(k, right, v, rest);
    }
    return left;
}

/* The null space; NULL: there is none, or it cannot be found. */
static const ns_null_space *null_of(const ns_sparse_leaks *k, ns_null_known *null) {
    if (!null->sought && (*null->search || ns_sparse_null_search_create(k->f, null->search) == NS_OK))
        (void)ns_sparse_null_find(*null->search, k, &null->space);
    null->sought = 1;
    return null->space && null->space->count > 0 ? null->space : NULL;
}

/* Krylov cycles make of rounding what they like where K leaves v open: that is as the leaks make it.  Beside
 * what is open a residual may look small that is not, so cycles follow, unless none is left that gains. */
static void set_undetermined(const ns_sparse_leaks *k, ns_null_known *null, const double *r, double left,
                             double *v, double *rest, double *Q) {
    const size_t bytes = sizeof(double) * (size_t)k->f->size;
    const ns_null_space *z = null_of(k, null);
    double *kept = Q + (KRYLOV + 1) * (size_t)k->f->size, before = INFINITY;
    if (!z)
        return;
    const double enough = fmax(largest(k, rest), DBL_MIN), most = fmax(enough, least * largest(k, r));
    memcpy(kept, v, bytes);
    for (int round = 0; round < ROUNDS; round++) {
        ns_sparse_null_settle(k, z, v);
        const double now = leaves(k, r, v, rest);
        const double all = largest(k, rest);
        if ((now <= fmax(holds, left) && all <= most) || (now <= may_hold && all <= enough))
            return;
        if (now > before / 2)
            break;
        before = now;
        (void)go_on(k, z, r, now, v, rest, Q);
    }
    memcpy(v, kept, bytes);
}

/* 1 if r has along one direction what no v gives, beyond the rounding of the terms at v, and it is in the
 * rest still. */
static int lacks_along(const ns_sparse_leaks *k, const double *direction, const double *r, const double *v,
                       const double *rest) {
    double has = 0, left = 0, terms = 0;
    for (int i = 0; i < k->f->size; i++) {
        const double l = direction[i] * k->scale[i];
        if (l == 0)
            continue;
        has += l * r[i];
        left += l * rest[i];
        terms += fabs(l) * (fabs(r[i]) + terms_of(k->f, k->g, k->mode, i, v));
    }
    return fabs(has) > holds * terms && fabs(left) > fabs(has) / 2;
}

/* 1 if unknowns grew, and of what no v gives v has given nothing: beside what grew it is too small to show in
 * the residual.  So is a forward drop of 10 nV beside 500 V, in a loop of closed switches. */
static int grew_in_vain(const ns_sparse_leaks *k, ns_null_known *null, const double *r, const double *first,
                        const double *v, const double *rest) {
    double was = 0, is = 0;
    for (int i = 0; i < k->f->size; i++) {
        was = ns_higher(was, fabs(first[i] * k->unit[i]));
        is = ns_higher(is, fabs(v[i] * k->unit[i]));
    }
    const ns_null_space *z = is > grown * was ? null_of(k, null) : NULL;
    int any = 0;
    for (int c = 0; z && c < z->count && !any; c++)
        any = lacks_along(k, z->left + (size_t)c * (size_t)k->f->size, r, first, rest);
    return any;
}

/* r is what rounding left: it is made solvable first. */
static int solve_residual(const ns_sparse_leaks *k, const ns_null_space *z, const double *r, double *v,
                          double *rest, double *Q) {
    double *right = Q + (KRYLOV + 1) * (size_t)k->f->size;
    memcpy(right, r, sizeof(double) * (size_t)k->f->size);
    ns_sparse_null_make_solvable(k, z, right);
    const double left = go_on(k, z, right, go_rounds(k, z, right, v, rest), v, rest, Q);
    if (!(left <= may_hold))
        return NS_E_SINGULAR;
    ns_sparse_null_settle(k, z, v);
    return NS_OK;
}

static int solve_rounds(const ns_sparse_leaks *k, ns_null_known *null, int residual, const double *r,
                        double *v, double *rest, double *Q) {
    double *first = Q + (KRYLOV + 1) * (size_t)k->f->size, before = go_rounds(k, NULL, r, v, rest);
    memcpy(first, v, sizeof(double) * (size_t)k->f->size);
    double left = go_on(k, NULL, r, before, v, rest, Q);
    if (!(left <= before)) { /* cycles took it farther off */
        memcpy(v, first, sizeof(double) * (size_t)k->f->size);
        left = leaves(k, r, v, rest);
    }
    if (left <= may_hold && !contradicts(k, r, first, v, rest) && !grew_in_vain(k, null, r, first, v, rest)) {
        if (left != before)
            set_undetermined(k, null, r, left, v, rest, Q);
        return NS_OK;
    }
    const ns_null_space *z = residual ? null_of(k, null) : NULL;
    return z ? solve_residual(k, z, r, v, rest, Q) : NS_E_SINGULAR;
}

int ns_sparse_leaks_solve(const ns_sparse_leaks *k, ns_null_known *null, int residual, const double *r,
                          double *v, double *rest) {
    const size_t size = (size_t)k->f->size;
    double *Q = calloc((KRYLOV + 3) * size + 1, sizeof(double));
    if (!Q)
        return NS_E_MEMORY;
    double *right = Q + (KRYLOV + 2) * size;
    memcpy(right, r, sizeof(double) * size);
    ns_sparse_form_move_known(k->f, k->mode, right);
    const int status = solve_rounds(k, null, residual, right, v, rest, Q);
    if (status == NS_E_SINGULAR) {
        memcpy(v, right, sizeof(double) * size);
        ns_linalg_klu_solve(k->klu, k->factors, v);
    }
    free(Q);
    return status;
}
