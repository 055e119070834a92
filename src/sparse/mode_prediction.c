/* src/sparse/mode_prediction.c - events that go as they went the last time.
 *
 * What changes with a pair or a command is most often what changed with it before.  A leg in that mode is
 * taken at once, without steps of negligible length that look for the mode, and holds if it proves it: no
 * charge or flux jumps, as the powers D^i w of the leg vanish, and at its start all guards hold.  Where those
 * that change are mostly alone, one that was never seen before is expected to be, too; else Euler steps as
 * long as those of the leg before look for its mode, by the factors that serve that one.
 */
#include "sparse_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A guess that failed so often has to be right once without being tried; places looked at for one. */
enum { MOST_FAILED = 2, PLACES = 8 };
/* How far it is counted who was alone with its change, and who was not. */
enum { MOST_ALONE = 4 };
/* Steps that look for a mode; how often it may be in vain, and how many events go by then before it is tried
 * again. */
enum { MOST_STEPS = 4, MOST_SOUGHT = 4, REST = 16 };
/* Shares of the error allowed, of the largest lambda and y, that guards may be below zero by at the start,
 * between these as settings are tight or loose; of a leg that is so short that the next event may belong to
 * this one. */
static const double start_least = 1e-3, start_most = 3e-3, at_once = 1e-4;
/* What is let by in legs is no event now: with it, loose settings find all that is broken a little at each
 * event, and turn it over.  This many roots of reltol are between those. */
static const double roots = 3;

/* The place of a key, or an empty one, or the last that it may have, from then on its own. */
static ns_mode_prediction *place_of(ns_sparse *m, unsigned long long key) {
    size_t at = (key ^ key >> 29) * 0x9e3779b97f4a7c15U % m->guesses;
    for (int i = 1; i < PLACES && m->guess[at].key != key && m->guess[at].key != 0; i++)
        at = (at + 1) % m->guesses;
    if (m->guess[at].key != key)
        m->guess[at] = (ns_mode_prediction){.key = key};
    return &m->guess[at];
}

/* By the pairs that changed, and by which way they carried current, or voltage. */
static ns_mode_prediction *slot_of(ns_sparse *m, const ns_dense_step *before) {
    unsigned long long key = 14695981039346656037U;
    for (int j = 0; j < m->f->m; j++) {
        if (m->own_mode[j] == before->mode[j])
            continue;
        const double of = before->mode[j] == NS_INSIDE
                              ? before->xi[m->f->n + j]
                              : ns_linalg_csc_dot(&m->f->Ct, j, before->xi) + m->f->e[j];
        key = (key ^ (unsigned)(8 * j + 2 * m->own_mode[j] + (of > 0))) * 1099511628211U;
    }
    return place_of(m, key);
}

/* 1 if the guess was right, too. */
static int same(const ns_sparse *m, const ns_mode_prediction *g, const int *pair, int count) {
    if (g->count != count)
        return 0;
    for (int i = 0; i < count; i++)
        if (g->pair[i] != pair[i] || g->mode[i] != m->mode[pair[i]])
            return 0;
    return 1;
}

void ns_sparse_predict_learn(ns_sparse *m, const ns_dense_step *leg) {
    ns_mode_prediction *g = slot_of(m, leg);
    int pair[NS_GUESS_PAIRS], count = 0;
    for (int j = 0; j < m->f->m; j++) {
        if (m->mode[j] == m->own_mode[j])
            continue;
        if (count == NS_GUESS_PAIRS || ns_mode_slides(m->mode[j])) {
            g->sure = 0;
            g->count = -1;
            return;
        }
        pair[count++] = j;
    }
    if (same(m, g, pair, count))
        g->failed = 0;
    m->alone = count > 0 ? m->alone - 1 : m->alone + 1;
    m->alone = m->alone > MOST_ALONE ? MOST_ALONE : m->alone < -MOST_ALONE ? -MOST_ALONE : m->alone;
    g->sure = g->failed < MOST_FAILED;
    g->count = count;
    for (int i = 0; i < count; i++) {
        g->pair[i] = pair[i];
        g->mode[i] = m->mode[pair[i]];
    }
}

/* What a wrong guess must leave no trace in. */
static void keep_sizes(ns_sparse *m, int back) {
    const size_t bytes = sizeof(double) * (size_t)m->f->n;
    memcpy(back ? m->scale : m->kept_scale, back ? m->kept_scale : m->scale, bytes);
    m->kept_most[0] = back ? m->kept_most[0] : m->most_lambda;
    m->kept_most[1] = back ? m->kept_most[1] : m->most_y;
    memcpy(back ? m->lambda_of : m->kept_of[0], back ? m->kept_of[0] : m->lambda_of, sizeof m->lambda_of);
    memcpy(back ? m->y_of : m->kept_of[1], back ? m->kept_of[1] : m->y_of, sizeof m->y_of);
    m->most_lambda = m->kept_most[0];
    m->most_y = m->kept_most[1];
}

static int holds(ns_sparse *m, const ns_dense_step *leg) {
    if (!leg->calm)
        return 0;
    if (leg->why == NS_LEG_EVENT && (leg->pair >= 0 || leg->command >= 0) && leg->end < at_once * leg->g)
        return 0;
    const double share = fmax(start_least, fmin(start_most, roots * sqrt(m->o.reltol)));
    return ns_sparse_guard_starts(m, leg, share * m->o.reltol);
}

/* What is known of the place: nothing yet (then nothing else changes, perhaps), or something that is sure. */
static int worth_trying(const ns_sparse *m, const ns_mode_prediction *g) {
    if (g->sure)
        return NS_LEARNT_GUESS;
    return g->count == 0 && g->failed == 0 && m->alone > 0 ? NS_FIRST_GUESS : NS_NO_GUESS;
}

/* m->mode such that an Euler step of length g holds; 0: not found. */
static int seek(ns_sparse *m, double t, double g) {
    for (int round = 0; round < MOST_STEPS; round++) {
        if (ns_sparse_euler(m, t, g, m->w, 0, m->v, NULL) != NS_OK)
            return 0;
        const int flipped = ns_sparse_guard_flip(m, m->v, m->w, g, 0);
        m->counts.pivots += flipped;
        if (flipped == 0)
            return 1;
    }
    return 0;
}

/* 1 if it is time to look for a mode. */
static int may_seek(ns_sparse *m, const ns_mode_prediction *g) {
    if (m->sought <= 0 && ++m->sought <= 0)
        return 0;
    return g->count >= 0;
}

static void count_sought(ns_sparse *m, int found) {
    if (found)
        m->sought = MOST_SOUGHT;
    else if (--m->sought == 0)
        m->sought = -REST;
}

/* A leg in m->mode, if it holds there. */
static int try_leg(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg, int guess) {
    ns_sparse_guard_bounds(m);
    m->guessing = guess;
    const int status = ns_sparse_next_step(m, t, before, leg);
    m->guessing = NS_NO_GUESS;
    if (status == NS_OK && holds(m, leg)) {
        m->counts.events++;
        return 1;
    }
    m->counts.steps -= status == NS_OK;
    return 0;
}

static int seek_leg(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg) {
    const int found = seek(m, t, before->g) && try_leg(m, t, before, leg, NS_LEARNT_GUESS);
    count_sought(m, found);
    if (found)
        ns_sparse_predict_learn(m, before);
    return found;
}

static int guess_leg(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg,
                     ns_mode_prediction *g, int guess) {
    for (int i = 0; i < g->count; i++)
        m->mode[g->pair[i]] = g->mode[i];
    g->sure = try_leg(m, t, before, leg, guess);
    g->failed += !g->sure;
    return g->sure;
}

int ns_sparse_predict_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg) {
    ns_mode_prediction *g = slot_of(m, before);
    const int guess = worth_trying(m, g);
    if (before->euler || before->stuck > 0 || before->command >= 0 || (!guess && !may_seek(m, g)))
        return 0;
    keep_sizes(m, 0);
    if (guess ? guess_leg(m, t, before, leg, g, guess) : seek_leg(m, t, before, leg))
        return 1;
    keep_sizes(m, 1);
    memcpy(m->mode, m->own_mode, (size_t)m->f->m);
    ns_sparse_guard_bounds(m);
    return 0;
}
