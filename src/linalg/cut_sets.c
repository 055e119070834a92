/* src/linalg/cut_sets.c - charges of parts of a network of capacitors in place of those of single nodes.
 *
 * Where 1 pF is in series with 1 mF, the charge of the pF is the sum of the charges of the nodes at either
 * end of the mF, and rounding of these is 1e9 roundings of that.  So the sum itself is taken as the state:
 * the charge of a cut set, of all capacitors that lead out of a set of nodes.  The sets are those of a
 * spanning tree of largest capacitors: from the end of a tree's edge of capacitance c, away from the root,
 * what larger capacitors of the tree join to it.  No capacitor that leads out of such a set is much larger
 * than c.
 */
#include "cut_sets.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/status.h"

/* Smaller ratios cost three digits at most. */
static const double larger = 1e3, eps_factor = 64 * DBL_EPSILON;

typedef struct cut_network {
    int n;
    const double *M;
    double *ground; /* n: capacitance from a node to ground */
    double *edge;   /* n: of the tree's edge to the parent; 0: the root, or not reached yet */
    int *place;     /* n: the row of T that is this row of M; -1: none, */
    int *parent;    /* n: in the tree; -1: ground or none */
    int *order;     /* n: nodes of the part, parents first */
    int *reached;   /* n: 0: no part yet, */
    int *inside;    /* n: in the set */
} cut_network;

static double entry(const cut_network *c, int i, int j) {
    return c->M[(size_t)i + (size_t)j * (size_t)c->n];
}

static int create(cut_network *c, int n, const double *M) {
    const size_t size = (size_t)n;
    memset(c, 0, sizeof *c);
    c->n = n;
    c->M = M;
    c->ground = calloc(2 * size + 1, sizeof *c->ground);
    c->place = calloc(5 * size + 1, sizeof *c->place);
    if (!c->ground || !c->place)
        return NS_E_MEMORY;
    c->edge = c->ground + n;
    c->parent = c->place + n;
    c->order = c->parent + n;
    c->reached = c->order + n;
    c->inside = c->reached + n;
    return NS_OK;
}

static void destroy(cut_network *c) {
    free(c->ground);
    free(c->place);
}

/* The first `rank` rows of T are rows of M as they are. */
static void find_places(cut_network *c, int rank, const double *T) {
    for (int i = 0; i < c->n; i++) {
        c->place[i] = -1;
        for (int k = 0; k < rank; k++)
            if (T[(size_t)k + (size_t)i * (size_t)c->n] != 0)
                c->place[i] = k;
    }
}

/* Row i is that of a node of capacitors; ground: the capacitance to ground. */
static int is_node(const cut_network *c, int i, double *ground) {
    double sum = 0, size = 0;
    for (int j = 0; j < c->n; j++) {
        const double a = entry(c, i, j);
        if (i != j && (a > 0 || a != entry(c, j, i)))
            return 0;
        sum += a;
        size += fabs(a);
    }
    *ground = sum > eps_factor * size ? sum : 0;
    return size > 0 && sum >= -eps_factor * size;
}

int ns_linalg_cut_sets_part(int n, const double *M, int first, int *row, int *reached) {
    int count = 1;
    row[0] = first;
    reached[first] = 1;
    for (int at = 0; at < count; at++)
        for (int j = 0; j < n; j++) {
            const size_t i = (size_t)row[at], k = (size_t)j;
            if (!reached[j] && (M[i + k * (size_t)n] != 0 || M[k + i * (size_t)n] != 0)) {
                reached[j] = 1;
                row[count++] = j;
            }
        }
    return count;
}

/* All nodes that capacitors join to `first`, in c->order; how many, 0: some are no nodes of capacitors. */
static int list_part(cut_network *c, int first) {
    const int count = ns_linalg_cut_sets_part(c->n, c->M, first, c->order, c->reached);
    int all_nodes = 1;
    for (int k = 0; k < count; k++)
        all_nodes &= is_node(c, c->order[k], &c->ground[c->order[k]]);
    return all_nodes ? count : 0;
}

enum { ROOT_IS_GROUND = -1, NO_TREE = -2 };

/* Of a part: the node whose row is not among those that T keeps; ROOT_IS_GROUND: all are, as capacitors lead
 * to ground; NO_TREE: this is no such part. */
static int root_of(const cut_network *c, int count) {
    int missing = 0, root = ROOT_IS_GROUND, grounded = 0;
    for (int k = 0; k < count; k++) {
        const int i = c->order[k];
        grounded |= c->ground[i] > 0;
        if (c->place[i] < 0) {
            missing++;
            root = i;
        }
    }
    return missing == !grounded ? root : NO_TREE;
}

/* Of the nodes from `from` on the one with the largest capacitor to the tree is put there. */
static void put_next(cut_network *c, int from, int count) {
    int best = from;
    for (int k = from + 1; k < count; k++)
        if (c->edge[c->order[k]] > c->edge[c->order[best]])
            best = k;
    const int i = c->order[best];
    c->order[best] = c->order[from];
    c->order[from] = i;
}

/* The spanning tree of largest capacitors (Prim); order: parents first. */
static void grow_tree(cut_network *c, int count, int root) {
    for (int k = 0; k < count; k++) {
        const int i = c->order[k];
        c->edge[i] = i == root ? INFINITY : root == ROOT_IS_GROUND ? c->ground[i] : 0;
        c->parent[i] = -1;
    }
    for (int at = 0; at < count; at++) {
        put_next(c, at, count);
        const int i = c->order[at];
        for (int k = at + 1; k < count; k++) {
            const int j = c->order[k];
            if (-entry(c, i, j) > c->edge[j]) {
                c->edge[j] = -entry(c, i, j);
                c->parent[j] = i;
            }
        }
    }
}

/* c->inside: the node at place `at` in the order, and what larger capacitors join to it; how many. */
static int gather(cut_network *c, int at, int count) {
    const double least = larger * c->edge[c->order[at]];
    int found = 1;
    memset(c->inside, 0, sizeof *c->inside * (size_t)c->n);
    c->inside[c->order[at]] = 1;
    for (int k = at + 1; k < count; k++) {
        const int i = c->order[k];
        if (c->parent[i] >= 0 && c->inside[c->parent[i]] && c->edge[i] > least) {
            c->inside[i] = 1;
            found++;
        }
    }
    return found;
}

/* The capacitance from column j to nodes outside, if it is inside, or to nodes inside. */
static double across(const cut_network *c, int j) {
    double sum = c->inside[j] ? c->ground[j] : 0;
    for (int i = 0; i < c->n; i++)
        if (i != j && c->inside[i] != c->inside[j])
            sum += c->inside[j] ? -entry(c, i, j) : entry(c, i, j);
    return sum;
}

static void write_rows(const cut_network *c, int row, double *T, double *TM) {
    for (int j = 0; j < c->n; j++) {
        const size_t at = (size_t)row + (size_t)j * (size_t)c->n;
        T[at] = c->inside[j];
        TM[at] = across(c, j);
    }
}

int ns_linalg_cut_sets(int n, const double *M, int rank, double *T, double *TM) {
    cut_network c;
    const int status = create(&c, n, M);
    if (status == NS_OK)
        find_places(&c, rank, T);
    for (int first = 0; first < n && status == NS_OK; first++) {
        const int count = c.reached[first] ? 0 : list_part(&c, first), root = root_of(&c, count);
        if (count < 2 || root == NO_TREE)
            continue;
        grow_tree(&c, count, root);
        for (int at = 0; at < count; at++)
            if (c.order[at] != root && gather(&c, at, count) > 1)
                write_rows(&c, c.place[c.order[at]], T, TM);
    }
    destroy(&c);
    return status;
}
