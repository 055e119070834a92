/* src/march/run_refuse.c - what was found wrong: excused, where it lasts for a moment; where it is so by
 * every engine allowed or refused. */
#include "run_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Goes to t without a check of what lies before; the engine's point there to xl (n+m); *right: that point is
 * right.  0: the engine fails on the way. */
static int look_at(ns_run *r, double t, double *xl, int *right) {
    ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    double reached;
    ns_engine_watch(r->at_work, NULL);
    const int goes = r->at_work->table->try_to(r->at_work, t, NS_TO_TIME, &reached) == NS_OK &&
                     ns_engine_read(r->at_work, NULL, k->here, k->here + n, NULL) == NS_OK;
    memcpy(xl, k->here, sizeof *xl * all);
    *right = goes && ns_march_check_point(r, reached, NS_RIGHT);
    ns_engine_drop(r->at_work);
    ns_engine_watch(r->at_work, &k->watch);
    return goes;
}

/* The pair of f is wrong at its time, `at`, but right after d and 2 d s; it does not jump to there: after
 * d/16 it has gone half the way at most. */
static int is_right_after(ns_run *r, const ns_verify_finding *f, const double *at, double d) {
    enum { SOON_EXPONENT = -4 };
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    const double soon = ldexp(d, SOON_EXPONENT);
    double *between = r->check.nodes + all, *later = between + all;
    const ns_verify_state way[] = {{f->t, NS_RIGHT, at, at + n, NULL, 0},
                                   {f->t + soon, NS_RIGHT, between, between + n, NULL, 0},
                                   {f->t + d, NS_RIGHT, later, later + n, NULL, 0}};
    int right;
    return look_at(r, f->t + 2 * d, later, &right) && right && look_at(r, way[2].t, later, &right) && right &&
           look_at(r, way[1].t, between, &right) && ns_verify_is_gradual(r->check.verify, f->pair, way);
}

/* 1: the accepted point is at t. */
static int begins_at(ns_run *r, double t) {
    double now;
    ns_engine_drop(r->at_work);
    return ns_engine_read(r->at_work, &now, NULL, NULL, NULL) == NS_OK && now == t;
}

/* Looks may take this part of what the run took so far, or of what comes before a first question. */
static const double look_part = 0.25;

/* Looks at longer and longer d, up to `longest`, until the pair of f is right after one.  Each goes all the
 * way from the accepted point again: what they take is bounded, as the engine may crawl there. */
static int is_right_later(ns_run *r, const ns_verify_finding *f, const double *at, double shortest,
                          double longest) {
    enum { SHORTEST_EXPONENT = -20, LONGER_EXPONENT = 2 };
    ns_engine *e = r->at_work;
    const double kept = e->most_work, most = look_part * fmax(ns_march_run_work(r).all,
                                                              ns_march_first_question(r->s, r->is_dense));
    int right = 0;
    e->most_work = ns_engine_work(e).all + most;
    for (double d = fmax(shortest, ldexp(longest, SHORTEST_EXPONENT));
         !right && d <= longest && !ns_engine_is_over(e); d = ldexp(d, LONGER_EXPONENT))
        right = d > shortest && is_right_after(r, f, at, d);
    e->most_work = kept;
    return right;
}

static int is_excused(ns_run *r, const ns_verify_finding *f) {
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    const double rounding = ns_verify_roundings * DBL_EPSILON * fabs(f->t);
    double *at = r->check.nodes;
    const ns_verify_state here = {f->t, NS_RIGHT, at, at + n, NULL, 0};
    if (f->cause != NS_VERIFY_LAW)
        return 0;
    memcpy(at, r->check.here, sizeof *at * all);
    int right = rounding > 0 && is_right_after(r, f, at, rounding);
    const double longest =
        !right && begins_at(r, f->t) ? ns_verify_excusable(r->check.verify, f->pair, &here) : 0;
    if (longest > 0)
        right = is_right_later(r, f, at, rounding, longest);
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

int ns_march_run_refuse_failed(ns_run *r) {
    r->fault = r->failed;
    r->refused = 1;
    return (int)r->fault.status;
}
