/* src/sparse/mode_prediction.c - the mode after an event, predicted from the last event of the same kind.
 *
 * The pairs that change with a guard or a command are most often those that changed with it before.  So a
 * step in that mode is tried first, without Euler steps of negligible length that search for the mode.  It is
 * believed if no charge or flux jumps, as the powers D^i w of the step vanish, or as its error is one that
 * is allowed, and if all guards hold at its start.  For an event that was never seen it is tried that no
 * other pair changes, if that was so for most events; else Euler steps as long as those of the step before
 * search for the mode, by factors that there are.  A step that is not believed is kept: if the search finds
 * its mode, and nothing jumps, it is the one that follows.
 */
#include "guards.h"
#include "largest.h"
#include "step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A prediction that failed so often is not tried until it would have been right; entries tried for a key. */
enum { MOST_FAILED = 2, PLACES = 8 };
/* The count of events in which no other pair changed, less the others, is cut off there. */
enum { MOST_ALONE = 4 };
/* Euler steps of one search; searches that fail before REST events go by without one. */
enum { MOST_STEPS = 4, MOST_SOUGHT = 4, REST = 16 };
/* At the start of a step guards may be below zero by fraction * reltol of the largest lambda and y, where
 * fraction = roots * sqrt(reltol), between start_least and start_most: what steps let pass must be no event
 * here. */
static const double start_least = 1e-3, start_most = 3e-3, roots = 3;
/* An event before this fraction of a step may belong to the one before it. */
static const double at_once = 1e-4;

int ns_sparse_predict_create(ns_sparse *m) {
    m->predict.places = 8 * (size_t)m->f->m + 61;
    m->predict.table = calloc(m->predict.places, sizeof *m->predict.table);
    return m->predict.table ? NS_OK : NS_E_MEMORY;
}

void ns_sparse_predict_free(ns_sparse *m) {
    free(m->predict.table);
}

void ns_sparse_predict_reset(ns_sparse *m) {
    memset(m->predict.table, 0, m->predict.places * sizeof *m->predict.table);
    m->predict.alone = 0;
    m->predict.sought = 1;
}

/* The entry of a key; if there is none an empty one, or the last that was tried, is made its own. */
static ns_mode_prediction *place_of(ns_sparse *m, unsigned long long key) {
    size_t at = (key ^ key >> 29) * 0x9e3779b97f4a7c15U % m->predict.places;
    for (int i = 1; i < PLACES && m->predict.table[at].key != key && m->predict.table[at].key != 0; i++)
        at = (at + 1) % m->predict.places;
    if (m->predict.table[at].key != key)
        m->predict.table[at] = (ns_mode_prediction){.key = key};
    return &m->predict.table[at];
}

/* The entry of an event: by the pairs that it changed itself, and by the signs of their lambda or y before.
 */
static ns_mode_prediction *entry_of(ns_sparse *m, const ns_dense_step *before) {
    unsigned long long key = 14695981039346656037U;
    for (int j = 0; j < m->f->m; j++) {
        if (m->commanded_mode[j] == before->mode[j])
            continue;
        const double of = before->mode[j] == NS_INSIDE
                              ? before->images[m->f->n + j]
                              : ns_linalg_csc_dot(&m->f->Ct, j, before->images) + m->f->e[j];
        key = (key ^ (unsigned)(8 * j + 2 * m->commanded_mode[j] + (of > 0))) * 1099511628211U;
    }
    return place_of(m, key);
}

/* 1 if it predicts these pairs in these modes. */
static int predicts(const ns_sparse *m, const ns_mode_prediction *g, const int *pair, int count) {
    if (g->count != count)
        return 0;
    for (int i = 0; i < count; i++)
        if (g->pair[i] != pair[i] || g->mode[i] != m->mode[pair[i]])
            return 0;
    return 1;
}

void ns_sparse_predict_learn(ns_sparse *m, const ns_dense_step *step) {
    ns_mode_prediction *g = entry_of(m, step);
    int pair[NS_PREDICTED_PAIRS], count = 0;
    for (int j = 0; j < m->f->m; j++) {
        if (m->mode[j] == m->commanded_mode[j])
            continue;
        if (count == NS_PREDICTED_PAIRS || ns_mode_slides(m->mode[j])) {
            g->sure = 0;
            g->count = -1;
            return;
        }
        pair[count++] = j;
    }
    if (predicts(m, g, pair, count))
        g->failed = 0;
    m->predict.alone = count > 0 ? m->predict.alone - 1 : m->predict.alone + 1;
    m->predict.alone = m->predict.alone > MOST_ALONE    ? MOST_ALONE
                       : m->predict.alone < -MOST_ALONE ? -MOST_ALONE
                                                        : m->predict.alone;
    g->sure = g->failed < MOST_FAILED;
    g->count = count;
    for (int i = 0; i < count; i++) {
        g->pair[i] = pair[i];
        g->mode[i] = m->mode[pair[i]];
    }
}

/* 1 if all guards hold at the start of a step, but for this fraction of the largest lambda and y, and for
 * what later stages would add: for the pair `own` that the event changed (-1: none), which is at zero there;
 * for others where stages vanish. */
static int guards_hold_at_start(ns_sparse *m, const ns_dense_step *step, double fraction, int own) {
    const size_t size = (size_t)m->f->size, last = (size_t)step->stages - 1;
    const double *v_last = step->images + last * size, *z_last = step->z + last * (size_t)m->f->nz;
    ns_sparse_step_point(m, step, 0, m->work.v);
    (void)ns_inputs_stages_stage(m->in, step->t, 0, 0, m->z);
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        const double allowed = fraction * (m->mode[j] == NS_INSIDE ? m->largest.lambda : m->largest.y);
        const double later = step->converged || j == own ? 4 : 0;
        for (int k = 0; k < guards; k++) {
            if (!(guard(m, j, k, m->work.v, m->z, 1) + allowed +
                      later * fabs(guard(m, j, k, v_last, z_last, 0)) >=
                  0))
                return 0;
        }
    }
    return 1;
}

/* 1 if a step that was tried proves its mode, after the guard of the pair `own` broke. */
static int proves_mode(ns_sparse *m, const ns_dense_step *step, int own) {
    if (!step->converged && !step->resolved)
        return 0;
    if (step->at_event && (step->pair >= 0 || step->command >= 0) && step->length < at_once * step->g)
        return 0;
    const double fraction = fmax(start_least, fmin(start_most, roots * sqrt(m->o.reltol)));
    return guards_hold_at_start(m, step, fraction * m->o.reltol, own);
}

/* Whether its prediction, or, if nothing is known yet, that no other pair changes, is worth a step. */
static ns_prediction_kind kind_of(const ns_sparse *m, const ns_mode_prediction *g) {
    if (g->sure)
        return NS_LEARNT_PREDICTION;
    return g->count == 0 && g->failed == 0 && m->predict.alone > 0 ? NS_FIRST_PREDICTION : NS_NO_PREDICTION;
}

/* m->mode such that an Euler step of length g holds; 0: not found. */
static int search_by_euler(ns_sparse *m, double t, double g) {
    for (int round = 0; round < MOST_STEPS; round++) {
        if (ns_sparse_step_euler(m, t, g, m->w, 0, m->v, NULL) != NS_OK)
            return 0;
        const int flipped = ns_sparse_guard_flip(m, ns_sparse_guard_broken(m, m->v, m->w, g, 0));
        m->counts.pivots += flipped;
        if (flipped == 0)
            return 1;
    }
    return 0;
}

/* 1 if a search for the mode may be tried. */
static int may_search(ns_sparse *m, const ns_mode_prediction *g) {
    if (m->predict.sought <= 0 && ++m->predict.sought <= 0)
        return 0;
    return g->count >= 0;
}

static void count_search(ns_sparse *m, int found) {
    if (found)
        m->predict.sought = MOST_SOUGHT;
    else if (--m->predict.sought == 0)
        m->predict.sought = -REST;
}

/* A step in m->mode, 0: it does not prove that mode. */
static int try_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step,
                    ns_prediction_kind kind) {
    ns_sparse_guard_bounds(m);
    m->predict.trying = kind;
    const int status = ns_sparse_next_step(m, t, before, step);
    m->predict.trying = NS_NO_PREDICTION;
    if (status == NS_OK && proves_mode(m, step, before->pair)) {
        m->counts.events++;
        return 1;
    }
    m->counts.steps -= status == NS_OK;
    m->predict.has_tried = status == NS_OK;
    return 0;
}

static int searched_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step) {
    const int found = search_by_euler(m, t, before->g) && try_step(m, t, before, step, NS_LEARNT_PREDICTION);
    count_search(m, found);
    if (found)
        ns_sparse_predict_learn(m, before);
    return found;
}

static int predicted_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step,
                          ns_mode_prediction *g, ns_prediction_kind kind) {
    for (int i = 0; i < g->count; i++)
        ns_sparse_guard_set_pair(m, g->pair[i], g->mode[i]);
    g->sure = try_step(m, t, before, step, kind);
    g->failed += !g->sure;
    return g->sure;
}

int ns_sparse_predict_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step) {
    ns_mode_prediction *g = entry_of(m, before);
    const ns_prediction_kind kind = kind_of(m, g);
    m->predict.has_tried = 0;
    if (before->is_euler || before->failures > 0 || before->command >= 0 || (!kind && !may_search(m, g)))
        return 0;
    ns_sparse_largest_save(m, &m->saved_largest);
    if (kind ? predicted_step(m, t, before, step, g, kind) : searched_step(m, t, before, step))
        return 1;
    if (m->predict.has_tried)
        ns_sparse_largest_save(m, &m->tried_largest);
    ns_sparse_largest_restore(m, &m->saved_largest);
    ns_sparse_guard_set_mode(m, m->commanded_mode);
    return 0;
}

int ns_sparse_predict_take(ns_sparse *m, double t, const ns_dense_step *step) {
    if (!m->predict.has_tried || memcmp(m->mode, step->mode, (size_t)m->f->m) != 0 ||
        memcmp(m->w, step->powers, sizeof *m->w * (size_t)m->f->n) != 0)
        return 0;
    ns_sparse_largest_restore(m, &m->tried_largest);
    (void)ns_sparse_next_limit(m, t);
    ns_inputs_stages_late(m->in, step->time_lost);
    m->counts.steps++;
    return 1;
}
