/* bridge/expression_steps.c - a factor that V alone make, each of which goes from one of two values to the
 * other one in no time that counts: it is a comparison then, and may be multiplied with a signal. */
#include "expression_reader.h"

#include <math.h>
#include <stdlib.h>

#include "sources.h"

/* Of its period, or of the run: what it may take on its way between them. */
static const double short_way = 2e-3;

/* The two values; both NAN: none was seen, the same: one. */
typedef struct two_levels {
    double low, high; /* V */
} two_levels;

/* One value more; 0: it is a third one. */
static int add_level(two_levels *l, double v) {
    const double near = 1e-9 * fmax(fabs(v), fmax(fabs(l->low), fabs(l->high)));
    if (isnan(l->low))
        l->low = l->high = v;
    else if (l->low == l->high)
        *l = (two_levels){fmin(l->low, v), fmax(l->low, v)};
    return fabs(v - l->low) <= near || fabs(v - l->high) <= near;
}

static int levels_of_pulse(const ns_signal *z, double stop, two_levels *l) {
    const double way = z->u.pulse.tr + z->u.pulse.tf;
    return add_level(l, z->u.pulse.v1) && add_level(l, z->u.pulse.v2) &&
           (isinf(stop) ||
            (way + z->u.pulse.pw <= z->u.pulse.per && way <= short_way * fmin(z->u.pulse.per, stop)));
}

static int levels_of_pwl(const ns_signal *z, double stop, two_levels *l) {
    const double *t = z->u.pwl.t, *v = z->u.pwl.v;
    const int n = z->u.pwl.n;
    double way = 0.0, all = stop;
    if (!isnan(z->u.pwl.repeat))
        all = fmin(stop, t[n - 1] - z->u.pwl.repeat);
    for (int k = 0; k < n; k++) {
        if (!add_level(l, v[k]))
            return 0;
        way += k > 0 && v[k] != v[k - 1] ? t[k] - t[k - 1] : 0.0;
    }
    return way <= short_way * all;
}

/* 1 if a V holds the node at one of two values. */
static int find_levels(const ns_extract_walk *w, int node, two_levels *l) {
    const double stop =
        w->ckt->CKTfinalTime > 0.0 ? w->ckt->CKTfinalTime : INFINITY; /* before .tran is read */
    ns_signal z;
    double *points = NULL;
    int sign, found = 0;
    const GENinstance *inst = w->dc ? NULL : ns_bridge_expression_holder(w, node, 0, &sign);
    *l = (two_levels){NAN, NAN};
    if (inst && !ns_bridge_sources_signal(w->ckt, inst, 0, &z, &points))
        found = (z.kind == NS_PULSE && levels_of_pulse(&z, stop, l)) ||
                (z.kind == NS_PWL && levels_of_pwl(&z, stop, l));
    free(points);
    if (found && sign < 0)
        *l = (two_levels){-l->high, -l->low};
    return found;
}

/* The voltage of the node as a comparison. */
static ns_piecewise_value *step_of(expression_reader *r, int node, const two_levels *l) {
    ns_piecewise *p = &r->p;
    const ns_piecewise_value *one = ns_bridge_piecewise_constant(p, 1.0);
    const ns_piecewise_value *beyond = ns_bridge_piecewise_sum(
        p, 1.0, ns_bridge_piecewise_term(p, (ns_term){0, node, 1.0}), -0.5 * (l->low + l->high), one);
    return ns_bridge_piecewise_sum(p, l->low, one, l->high - l->low, ns_bridge_piecewise_above(p, beyond));
}

/* Of each term of u; 0: a term is something else. */
static int find_all_levels(const expression_reader *r, const ns_affine *u, two_levels *l) {
    int all = u->nterms > 0 && u->nterms <= PIECEWISE_CONDITIONS;
    for (int k = 0; k < u->nterms && all; k++)
        all = u->terms[k].is_current == 0 && find_levels(r->w, u->terms[k].of, &l[k]);
    return all;
}

const ns_piecewise_value *ns_bridge_expression_steps(expression_reader *r, const ns_piecewise_value *a) {
    ns_affine u;
    two_levels l[PIECEWISE_CONDITIONS];
    if (!a || ns_bridge_piecewise_is_discrete(a) || !ns_bridge_piecewise_affine(&r->p, a, &u) ||
        !find_all_levels(r, &u, l))
        return a;
    const ns_piecewise_value *one = ns_bridge_piecewise_constant(&r->p, 1.0);
    const ns_piecewise_value *sum = ns_bridge_piecewise_sum(&r->p, u.constant, one, 0.0, one);
    for (int k = 0; k < u.nterms; k++)
        sum = ns_bridge_piecewise_sum(&r->p, 1.0, sum, u.terms[k].gain, step_of(r, u.terms[k].of, &l[k]));
    if (!*r->w->ex->stepped)
        snprintf(r->w->ex->stepped, sizeof r->w->ex->stepped, "%.79s", r->p.name);
    return sum;
}
