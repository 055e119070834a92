/* src/mlcp/pivoting/pivot.c - principal pivoting on the transform of W, from the last mode.
 *
 * The pair whose guard is broken worst, in units of the terms of its value, is flipped, as long as that lets
 * the number of broken guards fall now and then.  (Then other methods are quicker than flips by least index,
 * Murty's rule, which is finite on P-matrices.)  Blocks of pairs flipped at once, block.c's way, cost more
 * pivots here: half of them are flipped back.  Pairs that are broken together follow each other without a
 * look at all the others in between.  A pair whose diagonal entry is 0 is exchanged together with the first
 * pair that its change would break (Keller's rule).  Whatever does not come out so within its bounds is left
 * to other methods.
 *
 * The transform is kept: a solve from the mode of the last one costs one product with the inverse of the
 * block of the pairs that are inside, and one with their columns of W, which reads the guards and checks the
 * answer at once.
 */
#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"
#include "mlcp/verify/residual_bound.h"
#include "transform.h"

enum { WITHOUT_GAIN = 8, ROUNDS = 20, ROUNDS_PER_PAIR = 10 };
static const double FINE = 1e-14;     /* equations hold: a hundredth of what guards are read to */
static const double TRUST = 1e-8;     /* as transform.c */
static const double ROUNDING = 1e-10; /* of the terms of an y: as solve.c accepts an answer */

/* --- guards --- */

/* By how much the guard of pair i is broken, if that is above 0; *size: of the terms of its value. */
static inline double violation(const ns_mlcp_solver *s, int i, double *size) {
    if (s->transform.basic[i]) {
        const double under = s->p->l[i] - s->lambda[i], over = s->lambda[i] - s->p->u[i];
        *size = s->transform.lterms[i];
        return under > over ? under : over;
    }
    *size = s->transform.yterms[i];
    return s->mode[i] == NS_LOWER ? -s->y[i] : s->y[i];
}

static inline int guard_holds(const ns_mlcp_solver *s, int i) {
    double size;
    return !(violation(s, i, &size) > s->transform.slack * size);
}

/* The mode that the guard of pair i, which is broken, asks for. */
static ns_mode mode_wanted(const ns_mlcp_solver *s, int i) {
    if (!s->transform.basic[i])
        return NS_INSIDE;
    return s->lambda[i] < s->p->l[i] ? NS_LOWER : NS_UPPER;
}

/* list gets the pairs whose guard is broken, of n in from, which may be list; *worst: the pair most so, in
 * units of the terms of its value. */
static int list_violated(const ns_mlcp_solver *s, int n, const int *from, int *list, int *worst) {
    double most = 0.0;
    int left = 0;
    for (int k = 0; k < n; k++) {
        const int i = from[k];
        double size;
        const double by = violation(s, i, &size);
        if (by > s->transform.slack * size) {
            list[left++] = i;
            if (by > most * size) {
                most = by / size;
                *worst = i;
            }
        }
    }
    return left;
}

/* --- exchanges --- */

/* Makes the transform that of s->mode, or of one near it where that is singular: from the one there is, or
 * *anew from W.  0: an equality is left. */
static int align_transform(ns_mlcp_solver *s, int *anew) {
    int *list = s->queue, n = 0;
    if (!s->transform.valid || *anew) {
        ns_mlcp_transform_start(s);
        *anew = 1;
        s->factors++;
    }
    for (int i = 0; i < s->m; i++)
        if (s->transform.basic[i] != (s->mode[i] == NS_INSIDE))
            list[n++] = i;
    const long before = s->pivots;
    n = ns_mlcp_transform_exchange(s, n, list);
    ns_mlcp_transform_tidy(s);
    if (*anew) /* they made the basis, as a factorisation would */
        s->pivots = before;
    for (int k = 0; k < n; k++) {
        int i = list[k];
        if (isinf(s->p->l[i]) && isinf(s->p->u[i]))
            return 0;
        s->mode[i] = s->transform.basic[i] ? NS_INSIDE : ns_mlcp_fit_mode(s, i, NS_LOWER);
    }
    return 1;
}

/* How far pair i lets its value change at rate `slope` until its guard breaks. */
static double room_to_bound(const ns_mlcp_solver *s, int i, double slope) {
    if (s->transform.basic[i])
        return slope > 0.0 ? (s->p->u[i] - s->lambda[i]) / slope : (s->p->l[i] - s->lambda[i]) / slope;
    if (s->mode[i] == NS_LOWER)
        return slope < 0.0 ? -s->y[i] / slope : INFINITY;
    return slope > 0.0 ? -s->y[i] / slope : INFINITY;
}

/* The pair that breaks first when the nonbasic of k changes by `way` times the rates; -1: none. */
static int first_to_break(ns_mlcp_solver *s, int k, double way, const double *rate, double *far) {
    int first = -1;
    for (int a = 0; a < s->np; a++) {
        const int i = s->pair[a];
        const double slope = way * rate[i];
        if (i == k || slope == 0.0 || !guard_holds(s, i))
            continue;
        const double t = fmax(room_to_bound(s, i, slope), 0.0);
        if (t < *far && ns_mlcp_transform_trust2(s, k, i) >= TRUST) {
            *far = t;
            first = i;
        }
    }
    return first;
}

/* Pair k, broken, whose diagonal entry is 0: with a partner, or from one bound to the other.  0: neither. */
static int exchange_with_partner(ns_mlcp_solver *s, int k) {
    const ns_mode to = mode_wanted(s, k);
    const int up = s->transform.basic[k] ? to == NS_LOWER : s->mode[k] == NS_LOWER;
    double far = s->transform.basic[k] ? INFINITY : s->p->u[k] - s->p->l[k], *rate = s->rhs;
    ns_mlcp_transform_column(s, k, rate);
    const int i = first_to_break(s, k, up ? 1.0 : -1.0, rate, &far);
    if (i < 0 && isinf(far))
        return 0;
    if (i < 0) {
        s->mode[k] = up ? NS_UPPER : NS_LOWER;
        return 1;
    }
    const double slope = up ? rate[i] : -rate[i];
    s->mode[i] = !s->transform.basic[i] ? NS_INSIDE : slope < 0.0 ? NS_LOWER : NS_UPPER;
    s->mode[k] = to;
    ns_mlcp_transform_pivot2(s, k, i);
    return 1;
}

/* Flips pair i.  0: neither its pivot nor one together with another pair can be trusted. */
static int flip_pair(ns_mlcp_solver *s, int i) {
    int done = 1;
    s->transform.carried = 0;
    if (ns_mlcp_transform_trust(s, i) < TRUST)
        done = exchange_with_partner(s, i);
    else {
        s->mode[i] = mode_wanted(s, i);
        ns_mlcp_transform_pivot(s, i);
    }
    ns_mlcp_transform_tidy(s);
    return done;
}

/* Flips pair i, the worst of the n in list, lets the others follow, and so on while one of them is still
 * broken. */
static int flip_in_turn(ns_mlcp_solver *s, int i, int n, int *list) {
    while (n > 0) {
        if (ns_mlcp_transform_trust(s, i) < TRUST)
            return flip_pair(s, i);
        s->mode[i] = mode_wanted(s, i);
        ns_mlcp_transform_move(s, i, n, list);
        ns_mlcp_transform_pivot(s, i);
        if (!s->transform.basic[i])
            ns_mlcp_transform_tidy(s);
        int left = 0;
        for (int k = 0; k < n; k++)
            if (list[k] != i)
                list[left++] = list[k];
        n = list_violated(s, left, list, list, &i);
    }
    return 1;
}

/* --- rounds --- */

/* How well the equations of the pairs inside hold. */
static double equation_error(const ns_mlcp_solver *s) {
    double most = 0.0;
    for (int a = 0; a < s->transform.count; a++) {
        const int i = s->transform.pair[a];
        if (!(fabs(s->y[i]) <= most * s->transform.yterms[i]))
            most = fabs(s->y[i]) / s->transform.yterms[i];
    }
    return most;
}

/* The pairs whose guard is broken, at lambda of s->mode and y from W and lambda.  A guard is not read more
 * finely than the equations hold; where that leaves none broken, lambda is refined once. */
static int read_guards(ns_mlcp_solver *s, int *list, int *worst) {
    ns_mlcp_transform_values(s);
    ns_mlcp_sum_terms(s->p, &s->own.nonzeros, s->lambda, s->y, s->transform.yterms);
    s->transform.carried = 1;
    s->transform.slack = NS_MLCP_GUARD * fmax(1.0, equation_error(s) / FINE);
    int n = list_violated(s, s->np, s->pair, list, worst);
    if (n > 0 || s->transform.slack == NS_MLCP_GUARD)
        return n;
    s->transform.slack = NS_MLCP_GUARD;
    ns_mlcp_transform_correct(s);
    ns_mlcp_sum_terms(s->p, &s->own.nonzeros, s->lambda, s->y, s->transform.yterms);
    return list_violated(s, s->np, s->pair, list, worst);
}

/* From s->mode to one whose guards hold.  The values that came along with the flips will do to find more to
 * flip. */
static int find_mode(ns_mlcp_solver *s) {
    int *list = s->queue, best = s->np + 1, rounds_left = WITHOUT_GAIN, worst = 0;
    s->transform.carried = 0;
    for (int round = 0; round < ROUNDS + ROUNDS_PER_PAIR * s->np; round++) {
        int n = s->transform.carried ? list_violated(s, s->np, s->pair, list, &worst) : 0;
        if (n == 0)
            n = read_guards(s, list, &worst);
        if (n == 0)
            return NS_OK;
        if (n < best) {
            best = n;
            rounds_left = WITHOUT_GAIN + s->np / 4;
        } else if (--rounds_left <= 0)
            return NS_E_LIMIT;
        if (!flip_in_turn(s, worst, n, list))
            return NS_E_LIMIT;
    }
    return NS_E_LIMIT;
}

/* lambda into its bounds; whether it was outside. */
static int clamp_lambda(ns_mlcp_solver *s) {
    int moved = 0;
    for (int i = 0; i < s->m; i++) {
        const double v = s->lambda[i], l = s->p->l[i], u = s->p->u[i];
        if (v < l || v > u) {
            s->lambda[i] = v < l ? l : u;
            moved = 1;
        }
    }
    return moved;
}

/* The residual of the answer, whose y is that of lambda before it was put into its bounds. */
static double answer_residual(ns_mlcp_solver *s) {
    if (clamp_lambda(s))
        ns_mlcp_sum_terms(s->p, &s->own.nonzeros, s->lambda, s->y, s->transform.yterms);
    const double r = ns_mlcp_residual_bound_of(s->p, s->lambda, s->y, s->transform.yterms);
    if (r <= NS_MLCP_GOOD)
        return r;
    const double full = ns_mlcp_measure(s->p, s->lambda, s->alike, s->rhs, NULL);
    return isnan(full) ? full : fmin(r, full); /* fmin would drop the NaN of terms that overflow */
}

/* y of the answer: 0 inside, not beyond 0 at a bound.  1: that was more than rounding. */
static int clamp_y(ns_mlcp_solver *s) {
    int cut = 0;
    for (int f = 0; f < s->nf; f++)
        s->y[s->free[f]] = 0.0;
    for (int a = 0; a < s->np; a++) {
        const int i = s->pair[a];
        const double y = s->y[i];
        if (s->mode[i] == NS_INSIDE || (s->mode[i] == NS_LOWER ? y < 0.0 : y > 0.0)) {
            cut |= fabs(y) > ROUNDING * s->transform.yterms[i];
            s->y[i] = 0.0;
        }
    }
    return cut;
}

static int is_all_lower(const ns_mlcp_solver *s, const ns_mode *mode) {
    int n = 0;
    if (s->m == 0 || memcmp(mode, s->lowest, (size_t)s->m) == 0)
        return 1;
    for (int i = 0; i < s->m; i++)
        n += ns_mlcp_fit_mode(s, i, mode[i]) != ns_mlcp_fit_mode(s, i, NS_LOWER);
    return n == 0;
}

/* From mode (NULL: all at the lower bounds), or near it. */
static int solve_from(ns_mlcp_solver *s, const ns_mode *mode, int *anew, double *residual) {
    *residual = INFINITY;
    if (!s->transform.settled || memcmp(mode, s->mode, (size_t)s->m) != 0) {
        s->transform.settled = 0;
        ns_mlcp_start_from(s, mode);
        if (!align_transform(s, anew))
            return NS_E_SINGULAR;
    }
    const int status = find_mode(s);
    if (status != NS_OK)
        return status;
    *residual = answer_residual(s);
    return *residual <= NS_MLCP_ACCEPT ? NS_OK : NS_E_RESIDUAL;
}

/* From mode; where the transform may be at fault, from a new one; where the mode may, from another. */
int ns_mlcp_pivot_from(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    int anew = 0, status = NS_E_LIMIT;
    s->now = *s->p;
    if (s->transform.settled || !is_all_lower(s, mode))
        status = solve_from(s, mode, &anew, residual);
    for (int k = anew || status == NS_E_LIMIT; k < 2 && status != NS_OK; k++) {
        s->transform.valid = s->transform.settled = 0;
        anew = 1;
        status = solve_from(s, k ? NULL : mode, &anew, residual);
    }
    s->transform.settled = s->transform.valid = status == NS_OK;
    if (status == NS_OK && clamp_y(s)) {
        s->transform.settled = 0; /* the mode may change */
        status = ns_mlcp_make_consistent(s, residual) ? NS_OK : NS_E_RESIDUAL;
    }
    return status;
}

int ns_mlcp_pivot(ns_mlcp_solver *s) {
    double residual;
    ns_mode *start = s->tab.at_upper; /* room of its own */
    for (int i = 0; i < s->m; i++)
        start[i] = s->mode[i];
    return ns_mlcp_pivot_from(s, start, &residual);
}
