/* src/march/select.c - which engine a run uses. */
#include "select.h"

#include <math.h>

/* Dense matrices of modes are fastest up to so many unknowns and pairs; then one sparse factor a mode is. */
enum { DENSE_FASTEST = 64 };
/* Unknowns and pairs up to which large systems are also written out for the dense engines, which get slow. */
enum { DENSE_MOST = 1500 };
/* h is what the scheme needs for its accuracy; steps of the sparse engine, which controls its error, may be
 * 2^6 times as long. */
enum { LONGER_EXPONENT = 6 };

int ns_march_too_large(const ns_system *s) {
    return s->large && s->n + s->m > DENSE_MOST;
}

/* The scheme by sparse factors: one matrix for theta and gamma. */
static int sparse_takes_theta(const ns_march_options *o) {
    return o->method == NS_THETA && o->theta > 0 && o->theta <= 1 && o->theta == o->gamma;
}

ns_sparse_options ns_march_sparse_options(const ns_march_options *o) {
    const int longer = o->method == NS_AUTO ? LONGER_EXPONENT : 0;
    return (ns_sparse_options){
        .h = ldexp(o->h, longer), .reltol = o->reltol, .bytes = o->map_bytes, .finer = longer, .theta = 0};
}

int ns_march_begins_sparse(const ns_system *s, const ns_march_options *o, ns_sparse_options *sparse) {
    const int large = s->large || s->n + s->m > DENSE_FASTEST;
    const int theta = sparse_takes_theta(o) && (ns_march_too_large(s) || o->capture);
    *sparse = ns_march_sparse_options(o);
    if (theta) {
        sparse->theta = o->theta;
        sparse->reltol = 0;
    }
    return o->method == NS_SPARSE || (o->method == NS_AUTO && large) || theta;
}

static int is_refusal(int status) {
    return status == NS_E_SINGULAR || status == NS_E_INFEASIBLE || status == NS_E_LIMIT ||
           status == NS_E_RESIDUAL || status == NS_E_OVERFLOW;
}

int ns_march_leaves_sparse(const ns_system *s, const ns_march_options *o, int status) {
    return is_refusal(status) && o->method != NS_SPARSE && !ns_march_too_large(s);
}

int ns_march_leaves_dense(const ns_march_options *o, int status) {
    return is_refusal(status) && o->method == NS_AUTO;
}

int ns_march_chooses(const ns_system *s, const ns_march_options *o) {
    return o->method == NS_AUTO && !ns_march_too_large(s);
}

/* The dense engines take 50 cubes of the size to be made, and as much for some modes: a question is to cost
 * a small part of what was done.  The first modes of a run do not tell much. */
double ns_march_first_question(const ns_system *s, int is_dense) {
    static const double least = 2e7;
    const double size = (double)s->n + (double)s->m;
    return least + (is_dense ? 60 : 300) * size * size * size;
}

/* Of 91 circuits of tests/stress none needed less: a prediction and a step of exact, 20 solutions by factors.
 * Where each event brought exact a new mode it took up to 22 cubes of the size. */
ns_choice_bounds ns_march_bounds_of_event(const ns_system *s, int by_sparse) {
    const double size = (double)s->n + (double)s->m, cube = size * size * size;
    return by_sparse ? (ns_choice_bounds){20 * (400 + 106 * size), 75e3 * size, 0, 0}
                     : (ns_choice_bounds){16e3 + 2.4 * size * size, 22 * cube, 8 * cube, 1};
}

double ns_march_retry_interval(const ns_march_options *o, double before) {
    return before > 0 ? 4 * before : ldexp(o->h, LONGER_EXPONENT);
}
