/* src/engine/sparse_guess.c - events that go as they went the last time.
 *
 * What changes with a pair or a command is most often what changed with it before.  A leg in that mode is
 * taken at once, without steps of negligible length that look for the mode, and holds if it proves it: no
 * charge or flux jumps, as the powers D^i w of the leg vanish, and at its start all guards hold.
 */
#include "sparse_march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A guess that failed so often has to be right once without being tried. */
enum { MOST_FAILED = 2 };
/* Shares of the error allowed, of the largest lambda and y, that guards may be below zero by at the start;
 * of a leg that is so short that the next event may belong to this one. */
static const double start_share = 1e-3, at_once = 1e-4;

/* By the pairs that changed, and by which way they carried current, or voltage. */
static ns_guess *slot_of(ns_sparse *m, const ns_leg *before) {
    unsigned long long key = 14695981039346656037U;
    for (int j = 0; j < m->f->m; j++) {
        if (m->own_mode[j] == before->mode[j])
            continue;
        const double of = before->mode[j] == NS_INSIDE ? before->xi[m->f->n + j]
                                                       : ns_csc_dot(&m->f->Ct, j, before->xi) + m->f->e[j];
        key = (key ^ (unsigned)(8 * j + 2 * m->own_mode[j] + (of > 0))) * 1099511628211U;
    }
    ns_guess *g = &m->guess[(key ^ key >> 29) * 0x9e3779b97f4a7c15U % m->guesses];
    if (g->key != key)
        *g = (ns_guess){.key = key};
    return g;
}

/* 1 if the guess was right, too. */
static int same(const ns_sparse *m, const ns_guess *g, const int *pair, int count) {
    if (g->count != count)
        return 0;
    for (int i = 0; i < count; i++)
        if (g->pair[i] != pair[i] || g->mode[i] != m->mode[pair[i]])
            return 0;
    return 1;
}

void ns_guess_learn(ns_sparse *m, const ns_leg *leg) {
    ns_guess *g = slot_of(m, leg);
    int pair[NS_GUESS_PAIRS], count = 0;
    for (int j = 0; j < m->f->m; j++) {
        if (m->mode[j] == m->own_mode[j])
            continue;
        if (count == NS_GUESS_PAIRS || ns_slides(m->mode[j])) {
            g->sure = 0;
            g->count = -1;
            return;
        }
        pair[count++] = j;
    }
    if (same(m, g, pair, count))
        g->failed = 0;
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

static int holds(ns_sparse *m, const ns_leg *leg) {
    if (!leg->calm)
        return 0;
    if (leg->why == NS_LEG_EVENT && (leg->pair >= 0 || leg->command >= 0) && leg->end < at_once * leg->g)
        return 0;
    return ns_guard_starts(m, leg, start_share * m->o.reltol);
}

int ns_guess_leg(ns_sparse *m, double t, const ns_leg *before, ns_leg *leg) {
    ns_guess *g = slot_of(m, before);
    if (!g->sure || before->euler || before->stuck > 0 || before->command >= 0)
        return 0;
    keep_sizes(m, 0);
    for (int i = 0; i < g->count; i++)
        m->mode[g->pair[i]] = g->mode[i];
    ns_guard_bounds(m);
    m->guessing = 1;
    const int status = ns_sparse_next_leg(m, t, before, leg);
    m->guessing = 0;
    if (status == NS_OK && holds(m, leg)) {
        m->counts.events++;
        return 1;
    }
    m->counts.steps -= status == NS_OK;
    g->sure = 0;
    g->failed++;
    keep_sizes(m, 1);
    memcpy(m->mode, m->own_mode, (size_t)m->f->m);
    ns_guard_bounds(m);
    return 0;
}
