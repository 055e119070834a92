/* src/system/partition.c - which unknowns and pairs belong to one island, and what all islands see.
 *
 * Unknown j is known as a function of time where a row r without charges and pairs (its law) contains no
 * other unknown but known ones: the voltage of a supply, by the law of its branch.  Unknown r, the current of
 * that branch, then is shared: row j, the balance at the node, determines it and nothing else, and each
 * island has its part of it.  If r appears anywhere but in balances (it commands something), or a balance has
 * a charge of an island (a capacitor from the supply), j is an unknown as any other.  All else is joined by
 * the entries of the system (union-find).
 */
#include "partition.h"

#include <stdlib.h>
#include <string.h>

#include "partition_internal.h"

/* Sources upon sources: so many passes; and so many tries without those that matter. */
enum { PASSES = 8, TRIES = 8 };

/* --- what is known --- */

static void mark_lawless(void *context, int row, int column, double value) {
    ns_plan *p = context;
    (void)column;
    (void)value;
    p->lawless[row] = 1;
}

static void mark_mattering(void *context, int row, int column, double value) {
    ns_plan *p = context;
    (void)row;
    (void)value;
    p->matters[column] = 1;
}

static void mark_charge(void *context, int row, int column, double value) {
    mark_lawless(context, row, column, value);
    mark_mattering(context, row, column, value);
}

static void mark_control(void *context, int unknown, int command, double value) {
    (void)value;
    mark_mattering(context, command, unknown, 1);
}

/* Unknowns of a row that are not known: how many, and the last. */
static void count_unknown(void *context, int row, int column, double value) {
    ns_plan *p = context;
    (void)value;
    if (p->role[column] != NS_KNOWN) {
        p->count[row]++;
        p->last[row] = column;
    }
}

/* Makes the unknown that row r determines known, and r shared; 1 if that is new. */
static int know_by_row(ns_plan *p, int r) {
    const int j = p->last[r];
    const int barred = p->lawless[r] || p->barred[r] || p->count[r] != 1 || p->role[r] != NS_OWN;
    if (barred || (j != r && p->role[j] != NS_OWN) || (j != r && p->matters[r]))
        return 0;
    p->role[r] = NS_SHARED;
    p->role[j] = NS_KNOWN;
    p->law[j] = r;
    return 1;
}

static void find_known(ns_plan *p) {
    const ns_system *s = p->s;
    int found = 1;
    memset(p->role, NS_OWN, (size_t)s->n);
    for (int pass = 0; found && pass < PASSES; pass++) {
        memset(p->count, 0, sizeof *p->count * (size_t)s->n);
        ns_system_each_entry(s->A, NS_CSC_OF(s, A), s->n, s->n, count_unknown, p);
        found = 0;
        for (int r = 0; r < s->n; r++)
            found += know_by_row(p, r);
    }
}

/* Bars a known voltage's law if its current (shared) enters a row other than the balance of such a node. */
static void bar_share(void *context, int row, int column, double value) {
    ns_plan *p = context;
    (void)value;
    if (p->role[column] == NS_SHARED && p->role[row] != NS_KNOWN) {
        p->barred[column] = 1;
        p->retry = 1;
    }
}

/* Bars it if that balance holds a charge of an island. */
static void bar_charge(void *context, int row, int column, double value) {
    ns_plan *p = context;
    (void)value;
    if (p->role[row] == NS_KNOWN && p->role[column] == NS_OWN) {
        p->barred[p->law[row]] = 1;
        p->retry = 1;
    }
}

static void find_shared(ns_plan *p) {
    const ns_system *s = p->s;
    ns_system_each_entry(s->M, NS_CSC_OF(s, M), s->n, s->n, mark_charge, p);
    ns_system_each_entry(s->B, NS_CSC_OF(s, B), s->n, s->m, mark_lawless, p);
    ns_system_each_entry(s->C, NS_CSC_OF(s, C), s->m, s->n, mark_mattering, p);
    ns_system_each_control(s, mark_control, p);
    p->retry = 1;
    for (int k = 0; p->retry && k < TRIES; k++) {
        find_known(p);
        p->retry = 0;
        ns_system_each_entry(s->A, NS_CSC_OF(s, A), s->n, s->n, bar_share, p);
        ns_system_each_entry(s->M, NS_CSC_OF(s, M), s->n, s->n, bar_charge, p);
    }
    if (p->retry)
        memset(p->role, NS_OWN, (size_t)s->n);
}

/* --- joined by entries --- */

static void join_nodes(const ns_plan *p, int i, int j) {
    ns_system_union_join(p->of, i, j);
}

/* Own ones to own ones, what is known or shared among itself. */
static void join_unknowns(void *context, int row, int column, double value) {
    const ns_plan *p = context;
    (void)value;
    if ((p->role[row] == NS_OWN) == (p->role[column] == NS_OWN))
        join_nodes(p, row, column);
}

static void join_force(void *context, int row, int pair, double value) {
    const ns_plan *p = context;
    (void)value;
    if (p->role[row] == NS_OWN)
        join_nodes(p, row, p->s->n + pair);
}

static void join_guard(void *context, int pair, int column, double value) {
    join_force(context, column, pair, value);
}

static void join_pairs(void *context, int pair, int other, double value) {
    const ns_plan *p = context;
    (void)value;
    join_nodes(p, p->s->n + pair, p->s->n + other);
}

static void join_control(void *context, int unknown, int command, double value) {
    const ns_plan *p = context;
    join_force(context, unknown, p->s->command[command].pair, value);
}

static void join_system(ns_plan *p) {
    const ns_system *s = p->s;
    ns_system_union_begin(p->of, s->n + s->m);
    ns_system_each_entry(s->A, NS_CSC_OF(s, A), s->n, s->n, join_unknowns, p);
    ns_system_each_entry(s->M, NS_CSC_OF(s, M), s->n, s->n, join_unknowns, p);
    ns_system_each_entry(s->B, NS_CSC_OF(s, B), s->n, s->m, join_force, p);
    ns_system_each_entry(s->C, NS_CSC_OF(s, C), s->m, s->n, join_guard, p);
    ns_system_each_entry(s->D, NS_CSC_OF(s, D), s->m, s->m, join_pairs, p);
    ns_system_each_control(s, join_control, p);
    for (int j = 0; j < s->n; j++)
        if (p->role[j] == NS_KNOWN)
            join_nodes(p, j, p->law[j]);
}

/* --- islands --- */

/* Numbers the tops: islands with pairs in the order of their first pair, all without pairs as one behind
 * them. Returns how many islands there are, 0 where less than two or too many have pairs. */
static int number_islands(ns_plan *p) {
    const int n = p->s->n, m = p->s->m;
    int islands = 0, rest = 0;
    for (int i = 0; i < n + m; i++)
        p->number[i] = -1;
    for (int k = n; k < n + m; k++)
        if (p->number[ns_system_plan_group(p, k)] < 0)
            p->number[ns_system_plan_group(p, k)] = islands++;
    if (islands < 2 || islands > NS_MOST_ISLANDS)
        return 0;
    for (int i = 0; i < n; i++)
        if (p->role[i] == NS_OWN && p->number[ns_system_plan_group(p, i)] < 0) {
            p->number[ns_system_plan_group(p, i)] = islands;
            rest = 1;
        }
    return islands + rest;
}

static int allocate_plan(ns_plan *p) {
    const size_t n = (size_t)p->s->n, all = n + (size_t)p->s->m;
    p->bytes = calloc(4 * n + 1, 1);
    p->ints = calloc(3 * n + 2 * all + 1, sizeof(int));
    if (!p->bytes || !p->ints)
        return NS_E_MEMORY;
    p->role = p->bytes;
    p->lawless = p->bytes + n;
    p->matters = p->bytes + 2 * n;
    p->barred = p->bytes + 3 * n;
    p->count = p->ints;
    p->last = p->ints + n;
    p->law = p->ints + 2 * n;
    p->of = p->ints + 3 * n;
    p->number = p->ints + 3 * n + all;
    return NS_OK;
}

void ns_system_partition_free(ns_islands *a) {
    for (int c = 0; a->island && c < a->count; c++) {
        ns_system_free(a->island[c].s);
        free(a->island[c].unknown);
        free(a->island[c].pair);
        free(a->island[c].input);
    }
    free(a->island);
    free(a->shared);
    *a = (ns_islands){0};
}

int ns_system_partition(const ns_system *s, ns_islands *out) {
    ns_plan p = {.s = s};
    *out = (ns_islands){0};
    if (s->m < 2)
        return NS_OK;
    int status = allocate_plan(&p);
    if (status == NS_OK) {
        find_shared(&p);
        join_system(&p);
        const int count = number_islands(&p);
        if (count > 0)
            status = ns_system_partition_build(&p, count, out);
    }
    if (status != NS_OK)
        ns_system_partition_free(out);
    free(p.bytes);
    free(p.ints);
    return status;
}
