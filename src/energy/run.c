/* src/energy/run.c - charge and energy along a marcher: quadrature over each way between events.
 *
 * Right after an event the fastest transients are there, later only slower ones: so the parts of a way begin
 * with some of the shortest times (ns_march_shortest()) and double.  A part is halved until the rules of
 * Gauss (7 nodes) and Kronrod (15) agree.
 */
#include "energy_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Kronrod's nodes in [-1, 1] (0 the last), their weights, and Gauss' weights, of every other node (Piessens
 * et al., QUADPACK, 1983). */
enum { HALF = 8, NODES = 2 * HALF - 1 };
static const double node[HALF] = {0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
                                  0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
                                  0.586087235467691130294144838258730, 0.405845151377397166906606412076961,
                                  0.207784955007898467600689403773245, 0};
static const double kronrod[HALF] = {
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
static const double gauss[HALF] = {
    0, 0.129484966168869693270611432679082, 0, 0.279705391489276667901467771423780,
    0, 0.381830050505118944950369775488975, 0, 0.417959183673469387755102040816327};

/* The difference of the rules, of the sizes of what is integrated, at which that of 15 nodes is right to
 * 1e-12 (QUADPACK: (200 difference)^1.5); the part of all so far that counts as such a size; halvings one
 * inside another, and of one way: where values are rounding, the rules never agree. */
static const double agree = 5e-11, of_all = 1e-4;
enum { DEPTH = 40, MOST_PASSES = 1000 };

/* --- a part of a way --- */

/* |v i| and |i| of all elements over a part. */
typedef struct sizes {
    double joule, charge;
} sizes;

static void add_node(ns_energy *e, const ns_solution *at, double weight, double difference, sizes *all) {
    for (int k = 0; k < e->count; k++) {
        ns_part_sum *s = &e->part[k];
        double v, i;
        ns_energy_branch(e, &e->of[k], at, &v, &i);
        const double p = v * i;
        s->q += weight * i;
        s->joule += weight * p;
        s->q_off += difference * i;
        s->joule_off += difference * p;
        all->charge += weight * fabs(i);
        all->joule += weight * fabs(p);
    }
    e->nodes++;
}

/* Both rules over a part; *all: sizes. */
static int apply_rules(ns_energy *e, ns_march *m, double from, double to, sizes *all) {
    const double middle = (from + to) / 2, half = (to - from) / 2;
    *all = (sizes){0, 0};
    for (int k = 0; k < e->count; k++)
        e->part[k] = (ns_part_sum){0, 0, 0, 0};
    for (int k = 0; k < NODES; k++) { /* in the order of time */
        const int of = k < HALF ? k : NODES - 1 - k;
        const double t = middle + (k < HALF ? -half : half) * node[of];
        const int status = ns_march_sample(m, t, e->between, e->between + e->unknowns);
        if (status != NS_OK)
            return status;
        const ns_solution at = {t, NS_LEFT, e->between, e->between + e->unknowns, NULL};
        add_node(e, &at, half * kronrod[of], half * (kronrod[of] - gauss[of]), all);
    }
    return NS_OK;
}

static int rules_agree(const ns_energy *e, const sizes *all) {
    const double joule = agree * (all->joule + of_all * e->joule);
    const double charge = agree * (all->charge + of_all * e->charge);
    for (int k = 0; k < e->count; k++)
        if (!(fabs(e->part[k].joule_off) <= joule) || !(fabs(e->part[k].q_off) <= charge))
            return 0;
    return 1;
}

static void take_part(ns_energy *e, const sizes *all) {
    for (int k = 0; k < e->count; k++) {
        ns_energy_sum(&e->of[k].q, e->part[k].q);
        ns_energy_sum(&e->of[k].joule, e->part[k].joule);
    }
    e->joule += all->joule;
    e->charge += all->charge;
}

/* So long a part from t on is a polynomial of such a degree that the rule of 15 nodes is exact for its
 * square: where the rules differ there, values are rounding. */
static double smooth_length(ns_march *m, double t) {
    enum { TIMES = 4 };
    return TIMES * ns_march_shortest(m, t, NULL);
}

/* Halved where the rules do not agree: from the left to the right. */
static int integrate_part(ns_energy *e, ns_march *m, double from, double to) {
    double end[DEPTH + 1] = {to};
    int status = NS_OK;
    for (int depth = 0; depth >= 0 && status == NS_OK;) {
        sizes all;
        const double length = end[depth] - from;
        status = apply_rules(e, m, from, end[depth], &all);
        if (status == NS_OK && depth < DEPTH && !rules_agree(e, &all) && length > smooth_length(m, from)) {
            end[depth + 1] = from + length / 2;
            depth++;
            continue;
        }
        take_part(e, &all);
        from = end[depth--];
    }
    return status;
}

/* --- a trial --- */

static int integrate_way(ns_energy *e, ns_march *m, double from, double to) {
    double length = smooth_length(m, from);
    int status = NS_OK;
    for (double t = from; t < to && status == NS_OK; length *= 2) {
        const double end = length < (to - t) / 2 ? t + length : to;
        if (!(end > t)) /* beside t it is nothing */
            continue;
        status = integrate_part(e, m, t, end);
        t = end;
    }
    return status;
}

static int read_point(const ns_energy *e, ns_march *m, int which, double *t) {
    const int status = ns_march_read(m, t, e->point[which], e->point[which] + e->unknowns, NULL);
    return status;
}

static ns_solution solution(const ns_energy *e, int which, double t, ns_side side) {
    return (ns_solution){t, side, e->point[which], e->point[which] + e->unknowns, NULL};
}

/* From the last point, at e->t, to the next, at t. */
static int pass_jump(ns_energy *e, ns_march *m, double t) {
    const ns_solution before = solution(e, 0, e->t, NS_LEFT), after = solution(e, 1, t, NS_RIGHT);
    const int status = ns_march_impulse(m, e->between, e->between + e->unknowns);
    return status == NS_OK ? ns_energy_jump(e, &before, &after, e->between, e->between + e->unknowns)
                           : status;
}

/* The end of a trial, at t, is the last point. */
static void take_end(ns_energy *e, ns_march *m, double t) {
    double *next = e->point[1];
    e->point[1] = e->point[0];
    e->point[0] = next;
    e->t = t;
    e->at_event = ns_march_at_event(m);
}

int ns_energy_take(ns_energy *e, ns_march *m, double t) {
    if (!e || !m)
        return NS_E_NULL;
    if (!e->block)
        return NS_E_STATE;
    double end;
    int status = read_point(e, m, 1, &end);
    if (status != NS_OK)
        return status;
    const int jumps = e->at_event || !(end > e->t), ends = !(t < end);
    if (!jumps)
        status = integrate_way(e, m, e->t, ends ? end : t);
    else if (ends)
        status = pass_jump(e, m, end);
    if (status == NS_OK && ends)
        take_end(e, m, end);
    else if (status == NS_OK && !jumps)
        e->t = fmax(e->t, t);
    return status;
}

static int step(ns_energy *e, ns_march *m, double t, double *reached) {
    int status = ns_march_try(m, t, NS_TO_STEP, reached);
    if (status == NS_OK)
        status = ns_energy_take(e, m, *reached);
    return status == NS_OK ? ns_march_accept(m) : status;
}

int ns_energy_march(ns_energy *e, ns_march *m, double t) {
    if (!e || !m)
        return NS_E_NULL;
    if (!e->block)
        return NS_E_STATE;
    for (int passes = 0; e->t < t && passes <= MOST_PASSES; passes++) {
        const double from = e->t;
        double reached;
        const int status = step(e, m, t, &reached);
        if (status != NS_OK)
            return status;
        passes = e->t > from ? 0 : passes;
    }
    const ns_solution last = solution(e, 0, e->t, NS_RIGHT);
    const int status = ns_energy_point(e, &last);
    return e->t < t ? NS_E_LIMIT : status;
}

/* --- a start --- */

static int allocate(ns_energy *e) {
    const size_t size = (size_t)e->unknowns + (size_t)e->pairs, count = (size_t)e->count;
    if (!e->block)
        e->block = calloc(3 * size + 1, sizeof *e->block);
    if (!e->part)
        e->part = calloc(count + 1, sizeof *e->part);
    if (!e->block || !e->part)
        return NS_E_MEMORY;
    e->point[0] = e->block;
    e->point[1] = e->block + size;
    e->between = e->block + 2 * size;
    return NS_OK;
}

/* Whether anything jumped, by the integrals in e->between. */
static int any(const ns_energy *e) {
    for (int k = 0; k < e->unknowns + e->pairs; k++)
        if (e->between[k] != 0)
            return 1;
    return 0;
}

/* The marcher's point is the first one. */
static int begin_here(ns_energy *e, ns_march *m) {
    int status = allocate(e);
    if (status == NS_OK)
        status = read_point(e, m, 0, &e->t);
    if (status != NS_OK)
        return status;
    e->nodes = 0;
    e->joule = e->charge = 0;
    e->at_event = ns_march_at_event(m);
    const ns_solution now = solution(e, 0, e->t, NS_RIGHT);
    return ns_energy_begin(e, &now);
}

int ns_energy_begin_at(ns_energy *e, ns_march *m) {
    return e && m ? begin_here(e, m) : NS_E_NULL;
}

/* Where a start begins: at x, or (NULL) at the initial conditions. */
static void put_first(ns_energy *e, const double *x, const double *lambda) {
    memset(e->point[0], 0, sizeof(double) * (size_t)(e->unknowns + e->pairs));
    if (!x) {
        ns_energy_path_initial(e, e->t, e->point[0]);
        return;
    }
    memcpy(e->point[0], x, sizeof *x * (size_t)e->unknowns);
    if (lambda)
        memcpy(e->point[0] + e->unknowns, lambda, sizeof *lambda * (size_t)e->pairs);
}

/* The jump of a start, to the point that is there. */
static int take_start(ns_energy *e, ns_march *m, const double *x, const double *lambda) {
    memcpy(e->point[1], e->point[0], sizeof(double) * (size_t)(e->unknowns + e->pairs));
    put_first(e, x, lambda);
    const ns_solution first = solution(e, 0, e->t, NS_LEFT), now = solution(e, 1, e->t, NS_RIGHT);
    int status = ns_energy_begin(e, &first);
    if (status == NS_OK)
        status = pass_jump(e, m, e->t);
    if (status == NS_OK)
        status = ns_energy_point(e, &now);
    memcpy(e->point[0], e->point[1], sizeof(double) * (size_t)(e->unknowns + e->pairs));
    return status;
}

static int start(ns_energy *e, ns_march *m, const double *x, const double *lambda) {
    int status = ns_energy_begin_at(e, m);
    if (status == NS_OK)
        status = ns_march_impulse(m, e->between, e->between + e->unknowns);
    return status == NS_OK && any(e) ? take_start(e, m, x, lambda) : status;
}

int ns_energy_start(ns_energy *e, ns_march *m) {
    return start(e, m, NULL, NULL);
}

int ns_energy_start_from(ns_energy *e, ns_march *m, const double *x, const double *lambda) {
    return x ? start(e, m, x, lambda) : NS_E_NULL;
}
