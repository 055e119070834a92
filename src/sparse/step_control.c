/* src/sparse/step_control.c - how long a step is. */
#include "guards.h"
#include "largest.h"
#include "step.h"

#include <math.h>
#include <string.h>

/* The next step is at most 2^MOST_DOUBLINGS times as long. */
enum { MOST_DOUBLINGS = 4 };
/* A step so short that its matrix holds no digit of what it couples is made so many times as long, so often:
 * 2^-8 of the step that follows still takes no time in it. */
static const double much_longer = 16;
enum { LONGER = 2 };
/* An edge of a source goes on beyond its end in the stages of a longer step, at most to this multiple of
 * itself. */
static const double too_steep = 256;
/* A step that does not resolve the guard that ends it is made shorter by 2^-SHORTER, so often. */
enum { SHORTER = 2, MOST_SHORTER = 3 };
/* So many steps resolve a transient that is over in the shortest usual one; more of them follow rounding. */
enum { MOST_STEEP = 64 };

/* How many times a step may be doubled by the errors of the state, and of inputs in steps that are so many
 * times as long as the one that was tried first. */
static int allowed_doublings(const ns_sparse *m, int length_exponent, int first_exponent, double error,
                             double d) {
    int k = ns_sparse_step_doublings(error, d,
                                     length_exponent < MOST_DOUBLINGS ? length_exponent : MOST_DOUBLINGS);
    while (k > 0 && ns_sparse_step_inputs_error(m, first_exponent - k) > 1)
        k--;
    return k;
}

/* A time that is none for the step. */
static double negligible(const ns_sparse *m, const ns_dense_step *step, double room) {
    return ns_sparse_step_negligible(ns_sparse_step_length(m, step->length_exponent + NS_SHORT_EXPONENT),
                                     ns_sparse_finest(m), room);
}

/* 1 if the mode of the step does not hold at the end of an Euler step of length g, which takes away what
 * jumps: it was found by shorter ones, so this is a transient amid which other pairs change. */
static int changes_mode(ns_sparse *m, const ns_dense_step *step, double g) {
    return g > ns_sparse_finest(m) && ns_sparse_project_breaks(m, step->t, g, step->powers);
}

/* 1 if steps so short have a matrix of which no digit is left, or none of their solutions. */
static int is_too_short(int status) {
    return status == NS_E_SINGULAR || status == NS_E_RESIDUAL;
}

/* w at the beginning of the step made consistent with its mode by steps of length g, if pairs of the mode can
 * carry the impulses; else the worst of them is marked to break there. */
static int remove_jump(ns_sparse *m, ns_dense_step *step, double g) {
    const size_t bytes = sizeof(double) * (size_t)m->f->n;
    ns_jump_kind jumped = NS_NO_JUMP;
    int status = ns_sparse_project_consistent(m, step->t, g, NULL, &jumped);
    for (int longer = 0; longer < LONGER && is_too_short(status); longer++) {
        memcpy(m->w, step->powers, bytes);
        g *= much_longer;
        status = ns_sparse_project_consistent(m, step->t, g, NULL, &jumped);
    }
    if (status == NS_OK && jumped == NS_JUMPS && changes_mode(m, step, g)) {
        memcpy(m->w, step->powers, bytes);
        return status;
    }
    if (status == NS_OK && jumped == NS_JUMPS)
        status = ns_sparse_instant_misfit(m, step->t, g, &step->pair, &step->guard);
    if (status == NS_OK && step->pair >= 0) {
        memcpy(m->w, step->powers, bytes);
        return status;
    }
    if (status == NS_OK && jumped == NS_JUMPS)
        status = ns_sparse_instant_add(m, g, &m->instant);
    memcpy(step->powers, m->w, bytes);
    return status;
}

/* The search for the length of a step; exponents: of h 2^-exponent. */
typedef struct length_search {
    double room;         /* s: the step ends then at the latest */
    int first_exponent;  /* of the length that was tried first */
    int shortest;        /* of the shortest length that may be tried */
    int regular;         /* of the shortest one with which (P2) was regular; -1: none was yet */
    int jumps;           /* so often w was made consistent: by steps of negligible length, of the shortest */
    int tries;           /* lengths before this one */
    int found;           /* 1: the step has its length, or a pair that breaks where it begins */
    ns_step_error error; /* of the length that was tried last */
} length_search;

/* The first length to be tried is no longer than the inputs allow. */
static length_search begin_search(const ns_sparse *m, ns_dense_step *step, double room) {
    const int least = ns_sparse_least_exponent(m);
    length_search s = {
        .room = room, .regular = -1, .shortest = least + (m->steep_steps < MOST_STEEP ? NS_STEEPEST : 0)};
    step->length_exponent = step->length_exponent < s.shortest ? step->length_exponent : s.shortest;
    while (step->length_exponent < least &&
           ns_inputs_stages_steepest(m->in, ns_sparse_step_length(m, step->length_exponent) / NS_POLE) >
               too_steep)
        step->length_exponent++;
    while (step->length_exponent < least && ns_sparse_step_inputs_error(m, step->length_exponent) > 1)
        step->length_exponent++;
    s.first_exponent = step->length_exponent;
    return s;
}

/* (P2) is singular with so short a step, as digits do not suffice: 1 if a longer one is tried, and none that
 * is shorter than that. */
static int lengthen_to_regular(const ns_sparse *m, ns_dense_step *step, length_search *s) {
    const int least = ns_sparse_least_exponent(m);
    if (step->length_exponent > least)
        step->length_exponent = s->shortest = least;
    else if (s->regular >= 0 && s->regular < step->length_exponent)
        step->length_exponent = s->shortest = s->regular;
    else
        return 0;
    return 1;
}

/* w contradicts the algebraic equations where the step begins: it is made consistent by steps that take no
 * time; if it still does, that is a transient, and resolved; one that no step resolves jumps for the shortest
 * ones.  *again: a length is tried once more. */
static int pass_jump(ns_sparse *m, ns_dense_step *step, length_search *s, int *again) {
    const int least = ns_sparse_least_exponent(m);
    *again = 1;
    if (s->jumps > 0 && step->length_exponent < s->shortest &&
        s->error.time > ldexp(1, step->length_exponent - least)) {
        m->counts.trials++;
        step->length_exponent += (int)fmin(least - step->length_exponent, fmax(1, -log2(s->error.time) - 2));
        return NS_OK;
    }
    if (s->jumps > 1) {
        *again = 0;
        return NS_OK;
    }
    const double g = s->jumps++ == 0 ? negligible(m, step, s->room) : ns_sparse_finest(m);
    const int status = remove_jump(m, step, g);
    s->found = step->pair >= 0;
    return status;
}

/* The length is taken; the next one may be longer. */
static int accept_length(const ns_sparse *m, ns_dense_step *step, length_search *s) {
    step->next_exponent -=
        allowed_doublings(m, step->length_exponent, s->first_exponent, s->error.whole, s->error.ratio);
    if (s->error.whole > 1 && step->next_exponent < s->shortest)
        step->next_exponent++;
    step->resolved = s->error.until_room <= 1 && s->error.jump <= 1;
    s->found = 1;
    return s->error.whole < INFINITY ? NS_OK : NS_E_OVERFLOW;
}

/* By how many powers of two a step with this error and ratio d of D has to be shorter: as in
 * ns_sparse_step_doublings(), back.  A stiff part (d near 1) has to be resolved before its error falls. */
static int halvings(double error, double d) {
    enum { MOST = 8 };
    int k = 0;
    while (k < MOST && !(k > 0 && error <= 2)) {
        error *= pow(1 / (2 - d), NS_ORDER + 1);
        d = d / (2 - d);
        k++;
    }
    return k;
}

static int try_length(ns_sparse *m, ns_dense_step *step, length_search *s) {
    int again = 0;
    step->g = ns_sparse_step_length(m, step->length_exponent) / NS_POLE;
    int status = ns_sparse_step_stages(m, step, s->room);
    if (status == NS_E_SINGULAR && lengthen_to_regular(m, step, s))
        return NS_OK;
    s->regular = step->length_exponent;
    if (status == NS_OK)
        status = ns_sparse_step_measure(m, step, s->room, &s->error);
    step->next_exponent = step->length_exponent;
    if (status == NS_OK && m->predict.trying && s->error.jump > 1)
        return NS_E_LIMIT; /* as that of a stage: the prediction was wrong */
    if (status == NS_OK && step->stages == NS_ORDER && s->error.until_room <= 1 && s->error.jump > 1)
        status = pass_jump(m, step, s, &again);
    if (status != NS_OK || again)
        return status;
    if (s->error.until_room <= 1 || step->length_exponent >= s->shortest || s->tries >= s->shortest)
        return accept_length(m, step, s);
    m->counts.trials++;
    const int shorter = step->length_exponent + halvings(s->error.until_room, s->error.ratio);
    step->length_exponent = shorter < s->shortest ? shorter : s->shortest;
    return NS_OK;
}

/* A length for which the error until room is small enough, with its stages; the length of the next step.  If
 * pair >= 0 the mode does not hold where it begins. */
static int choose_length(ns_sparse *m, ns_dense_step *step, double room) {
    length_search s = begin_search(m, step, room);
    int status = NS_OK;
    for (; status == NS_OK && !s.found; s.tries++)
        status = try_length(m, step, &s);
    return status;
}

/* The step up to its first event, of the length that its error allows, or shorter; *begins: a pair breaks
 * where it begins. */
static int go_to_event(ns_sparse *m, ns_dense_step *step, double t, double limit, int *begins) {
    const double room = limit - t - step->time_lost;
    step->t = t;
    step->at_event = 0;
    step->pair = step->command = -1;
    step->is_euler = 0;
    memcpy(step->mode, m->mode, (size_t)m->f->m);
    memcpy(step->powers, m->w, sizeof(double) * (size_t)m->f->n);
    const int status = choose_length(m, step, room);
    *begins = status == NS_OK && step->pair >= 0;
    if (*begins) {
        step->at_event = 1;
        step->length = 0;
        step->end_t = t;
    }
    if (status != NS_OK || *begins)
        return status;
    const double h = ns_sparse_step_length(m, step->length_exponent);
    step->length = fmin(h, room);
    step->end_t = h < room * (1 - 1e-9) ? t + (step->time_lost + h) : limit;
    if (step->end_t == limit)
        step->length = room;
    return ns_sparse_location_first(m, step);
}

int ns_sparse_control_step(ns_sparse *m, ns_dense_step *step, double t, double limit) {
    const int least = ns_sparse_least_exponent(m);
    int begins, status = go_to_event(m, step, t, limit, &begins);
    for (int i = 0; i < MOST_SHORTER && status == NS_OK && !begins && step->length > 0 &&
                    step->length_exponent < least && ns_sparse_location_is_rough(m, step);
         i++) {
        m->counts.trials++;
        step->length_exponent += SHORTER;
        status = go_to_event(m, step, t, limit, &begins);
    }
    if (status != NS_OK || begins)
        return status;
    m->steep_steps = step->length_exponent > least ? m->steep_steps + 1 : 0;
    m->counts.steps++;
    ns_sparse_largest_accept(m, step->length_exponent, step->end_t > t);
    return NS_OK;
}
