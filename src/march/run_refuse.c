/* src/march/run_refuse.c - what was found wrong: excused, where it lasts for a moment; where it is so by
 * every engine allowed or refused. */
#include "run_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The engine's point at t, gone to without a look at what is before it, to xl (n+m), is right. */
static int is_right_at(ns_run *r, double t, double *xl) {
    ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    double reached;
    ns_engine_watch(r->at_work, NULL);
    int right = r->at_work->table->try_to(r->at_work, t, NS_TO_TIME, &reached) == NS_OK &&
                ns_engine_read(r->at_work, NULL, k->here, k->here + n, NULL) == NS_OK;
    memcpy(xl, k->here, sizeof *xl * all);
    right = right && ns_march_check_point(r, reached, NS_RIGHT);
    ns_engine_drop(r->at_work);
    ns_engine_watch(r->at_work, &k->watch);
    return right;
}

/* The pair of f is wrong at its time, `at`, but right after d and 2 d s, to which it moves in a straight
 * line. */
static int is_right_after(ns_run *r, const ns_verify_finding *f, const double *at, double d) {
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    double *later = r->check.nodes + all, *latest = later + all;
    const ns_verify_state line[] = {{f->t, NS_RIGHT, at, at + n, NULL, 0},
                                    {f->t + d, NS_RIGHT, later, later + n, NULL, 0},
                                    {f->t + 2 * d, NS_RIGHT, latest, latest + n, NULL, 0}};
    return is_right_at(r, line[1].t, later) && is_right_at(r, line[2].t, latest) &&
           ns_verify_is_straight(r->check.verify, f->pair, line);
}

/* 1: the accepted point is at t. */
static int begins_at(ns_run *r, double t) {
    double now;
    ns_engine_drop(r->at_work);
    return ns_engine_read(r->at_work, &now, NULL, NULL, NULL) == NS_OK && now == t;
}

static int is_excused(ns_run *r, const ns_verify_finding *f) {
    enum { SHORTEST_EXPONENT = -20, LONGER_EXPONENT = 2 };
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    const double rounding = ns_verify_roundings * DBL_EPSILON * fabs(f->t);
    double *at = r->check.nodes;
    const ns_verify_state here = {f->t, NS_RIGHT, at, at + n, NULL, 0};
    if (f->cause != NS_VERIFY_LAW)
        return 0;
    memcpy(at, r->check.here, sizeof *at * all);
    int right = rounding > 0 && is_right_after(r, f, at, rounding);
    /* each of these goes all the way to there again */
    const int looks_on = !right && begins_at(r, f->t);
    const double longest = looks_on ? ns_verify_excusable(r->check.verify, f->pair, &here) : 0;
    for (double d = fmax(rounding, ldexp(longest, SHORTEST_EXPONENT)); !right && d < longest;
         d = ldexp(d, LONGER_EXPONENT))
        right = d > rounding && is_right_after(r, f, at, d);
    if (right)
        ns_verify_excuse(r->check.verify, f->t, f->pair);
    return right;
}

int ns_march_run_goes_excused(ns_run *r, int (*again)(ns_run *r, const void *data), const void *data) {
    enum { PAIRS = 8 };
    for (int i = 0; i < PAIRS; i++) {
        const ns_verify_finding f = r->check.finding;
        if (!is_excused(r, &f))
            return 0;
        if (again(r, data))
            return 1;
        if (!r->check.found) /* the engine failed for another reason */
            return 0;
    }
    return 0;
}

int ns_march_run_allows(ns_run *r, const ns_verify_finding *f) {
    if (f->error > ns_verify_wrong * ns_verify_wrong)
        return 0;
    ns_verify_allow(r->check.verify, f);
    return 1;
}

int ns_march_run_refuse(ns_run *r, const ns_verify_finding *f) {
    if (f->cause == NS_VERIFY_CHATTER)
        return ns_march_sliding_refuse(r, f);
    r->fault = (ns_fault){.status = NS_E_RESIDUAL, .t = f->t, .why = ns_verify_text(f->cause)};
    if (f->pair >= 0)
        r->fault.pair[r->fault.npairs++] = f->pair;
    if (f->unknown >= 0)
        r->fault.unknown[r->fault.nunknowns++] = f->unknown;
    r->refused = 1;
    return NS_E_RESIDUAL;
}
