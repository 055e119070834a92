/* src/system/jacobian.c - ns_model_check_jacobians(): callbacks against central differences.
 *
 * For every variable the differences are taken over a ladder of steps d, from the shortest that moves the
 * variable upwards.  Two neighbours D(d), D(d/4) give one extrapolated value and say how far to trust it:
 *
 *     (16 D(d/4) - D(d)) / 15,     |D(d) - D(d/4)| + eps (|f+| + |f-|) / d
 *
 * The trust is best where rounding no longer shows and curvature does not yet.  Every entry keeps its own
 * best length, and looks no further once its differences have begun to disagree again: far out a saturated
 * function looks very flat, and very certain of it.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/dense.h"
#include "nonsmooth/model.h"

enum { EXPONENT_LOW = -80, EXPONENT_HIGH = 44, EXPONENT_BY = 2 };
/* This much worse than at the best length so far: beyond the range in which the function is smooth. */
static const double gone_wrong = 1e4;
/* A difference counts above this multiple of the estimated error, b->trust. */
static const double margin = 10;

typedef struct bench {
    const ns_model *model;
    ns_point at; /* its x and lambda are the copies below */
    double *x, *lambda, *z;
    double *given;          /* the Jacobian */
    double *up, *down;      /* values at both ends of a step */
    double *value, *before; /* differences of this length and the one below */
    double *best, *trust;   /* for one column */
} bench;

static int begin(bench *b, const ns_model *model) {
    const size_t n = (size_t)model->n, m = (size_t)model->m, k = n > m ? n : m;
    memset(b, 0, sizeof *b);
    b->model = model;
    b->x = calloc(n + m + (size_t)model->nz + 6 * k + k * k + 1, sizeof(double));
    if (!b->x)
        return NS_E_MEMORY;
    b->lambda = b->x + n;
    b->z = b->lambda + m;
    b->up = b->z + model->nz;
    b->down = b->up + k;
    b->value = b->down + k;
    b->before = b->value + k;
    b->best = b->before + k;
    b->trust = b->best + k;
    b->given = b->trust + k;
    return NS_OK;
}

/* The function and the Jacobian of one kind; NULL: zero. */
typedef struct kind {
    ns_function value, derivative;
    ns_jacobian which;
    int rows, columns, by_lambda;
} kind;

static int evaluate(const bench *b, ns_function f, int rows, double *out) {
    return f(&b->at, b->model->data, out) == 0 && ns_linalg_finite((size_t)rows, out);
}

/* Central differences over a step of about d in b->value; 0 if there are none. */
static int difference(bench *b, const kind *k, double *variable, double d) {
    const double here = *variable;
    const double right = here + d, left = here - d;
    *variable = right;
    const int up = right - left > d && evaluate(b, k->value, k->rows, b->up);
    *variable = left;
    const int both = up && evaluate(b, k->value, k->rows, b->down);
    *variable = here;
    for (int i = 0; both && i < k->rows; i++)
        b->value[i] = (b->up[i] - b->down[i]) / (right - left);
    return both && ns_linalg_finite((size_t)k->rows, b->value);
}

static void compare_lengths(bench *b, int rows, double d) {
    for (int i = 0; i < rows; i++) {
        const double trust =
            fabs(b->value[i] - b->before[i]) + DBL_EPSILON * (fabs(b->up[i]) + fabs(b->down[i])) / d;
        if (trust < b->trust[i]) {
            b->best[i] = (16 * b->before[i] - b->value[i]) / 15;
            b->trust[i] = trust;
        } else if (trust > gone_wrong * b->trust[i]) {
            b->trust[i] = -fabs(b->trust[i]); /* it stands */
        }
    }
}

/* Column of one variable: b->best, b->trust. */
static int differentiate(bench *b, const kind *k, double *variable) {
    int had = 0, any = 0, exponent;
    for (int i = 0; i < k->rows; i++)
        b->trust[i] = INFINITY;
    (void)frexp(*variable, &exponent);
    const int low = *variable != 0 && exponent - 48 > EXPONENT_LOW ? exponent - 48 : EXPONENT_LOW;
    const int high = *variable != 0 && exponent + 2 > EXPONENT_HIGH ? exponent + 2 : EXPONENT_HIGH;
    for (int length = low; length <= high; length += EXPONENT_BY) {
        const double d = ldexp(1, length);
        const int have = difference(b, k, variable, d);
        if (have && had) {
            compare_lengths(b, k->rows, d);
            any = 1;
        }
        had = have;
        double *swap = b->before;
        b->before = b->value;
        b->value = swap;
    }
    for (int i = 0; i < k->rows; i++)
        b->trust[i] = fabs(b->trust[i]);
    return any;
}

static void judge(const bench *b, const kind *k, int column, ns_jacobian_error *worst) {
    for (int i = 0; i < k->rows; i++) {
        const double given = b->given[i + column * k->rows];
        const double beyond = fabs(given - b->best[i]) - margin * b->trust[i];
        const double size = fmax(fabs(given), fabs(b->best[i]));
        const double error = size > 0 && beyond > 0 ? beyond / size : 0;
        if (error > worst->error)
            *worst = (ns_jacobian_error){error, k->which, i, column, given, b->best[i]};
    }
}

static int check_one(bench *b, const kind *k, ns_jacobian_error *worst) {
    const int count = k->rows * k->columns;
    if (!k->value || count == 0)
        return NS_OK;
    memset(b->given, 0, sizeof(double) * (size_t)count);
    if (k->derivative && !evaluate(b, k->derivative, count, b->given))
        return NS_E_NUMBER;
    for (int j = 0; j < k->columns; j++) {
        if (!differentiate(b, k, (k->by_lambda ? b->lambda : b->x) + j))
            return NS_E_NUMBER;
        judge(b, k, j, worst);
    }
    return NS_OK;
}

static int check_all(bench *b, ns_jacobian_error *worst) {
    const ns_model *p = b->model;
    const kind kinds[] = {{p->f, p->A, NS_JACOBIAN_A, p->n, p->n, 0},
                          {p->m > 0 ? p->g : NULL, p->K, NS_JACOBIAN_K, p->n, p->n, 0},
                          {p->g, p->B, NS_JACOBIAN_B, p->n, p->m, 1},
                          {p->h, p->C, NS_JACOBIAN_C, p->m, p->n, 0},
                          {p->h, p->D, NS_JACOBIAN_D, p->m, p->m, 1}};
    int status = NS_OK;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds && status == NS_OK; i++)
        status = check_one(b, &kinds[i], worst);
    return status;
}

int ns_model_check_jacobians(const ns_model *model, double t, const double *x, const double *lambda,
                             ns_jacobian_error *worst) {
    bench b;
    int status = ns_model_check(model, NULL);
    if (status != NS_OK)
        return status;
    if (!worst || (model->n > 0 && !x) || (model->m > 0 && !lambda))
        return NS_E_NULL;
    *worst = (ns_jacobian_error){0};
    if (!isfinite(t) || !ns_linalg_finite((size_t)model->n, x) || !ns_linalg_finite((size_t)model->m, lambda))
        return NS_E_NUMBER;
    if (begin(&b, model) != NS_OK)
        return NS_E_MEMORY;
    for (int i = 0; i < model->n; i++)
        b.x[i] = x[i];
    for (int i = 0; i < model->m; i++)
        b.lambda[i] = lambda[i];
    for (int i = 0; i < model->nz; i++)
        b.z[i] = ns_signal_value(&model->z[i], t, NS_RIGHT);
    b.at = (ns_point){t, b.x, b.lambda, b.z};
    status = check_all(&b, worst);
    free(b.x);
    return status;
}
