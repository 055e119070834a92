/* src/circuit/inductor_cuts.c - inductors whose currents add up to zero in every mode of the devices.
 *
 * Three windings end in one star point, or coils are all that joins a bridge to its supply and its load:
 * Kirchhoff's current law of such a part, sum of i_k = 0, has no voltage in it, and a step of length h finds
 * the voltage of the part as what h v/L leaves of the rounding of the currents: 0.1 V beside 1 A and 1 mH at
 * h = 1e-18 s.  So the flux of one inductor t of such a cut is written by the currents of the others: L_rt
 * i_t = L_rt (sum of +-i_k).  The solutions are the same.  Then rows of M depend on each other, and
 * row_split.c makes of them the algebraic row of the voltage, in which there is neither h nor a current.
 *
 * A part is what elements other than inductors join.  Each edge of a spanning forest of inductors between
 * parts makes one cut: of itself, and of inductors that are not in the forest.
 */
#include "circuit_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "system/union_find.h"

/* Inductors that one cut, or cuts and couplings, join: more are left as they are, as M would be dense there.
 */
enum { MOST = 40 };
/* Initial currents, of the largest: what is above is no rounding of numbers that a user wrote. */
static const double rounding = 1e-9;

typedef struct forest {
    const ns_circuit *c;
    int *part;         /* nused+1: the part of a node; that of ground is the last */
    int *joined;       /* nused+1: parts that inductors of the forest join */
    int *group;        /* nelements: inductors that cuts and couplings join */
    int *size;         /* nelements: inductors in a group, all 0 */
    unsigned char *in; /* nelements: an inductor of the forest */
} forest;

static int part_of(const forest *f, int k, int end) {
    return ns_system_union_top(f->part, ns_circuit_row_or_ground(f->c, f->c->element[k].node[end]));
}

static int is_inductor(const forest *f, int k) {
    return f->c->element[k].kind == INDUCTOR;
}

static void find_parts(const forest *f) {
    ns_system_union_begin(f->part, f->c->nused + 1);
    for (int k = 0; k < f->c->nelements; k++)
        if (!is_inductor(f, k) && f->c->element[k].nnodes > 0)
            ns_system_union_join(f->part, part_of(f, k, 0), part_of(f, k, 1));
}

/* Returns how many inductors the forest has. */
static int find_forest(const forest *f) {
    int count = 0;
    ns_system_union_begin(f->joined, f->c->nused + 1);
    for (int k = 0; k < f->c->nelements; k++) {
        if (!is_inductor(f, k))
            continue;
        const int p = part_of(f, k, 0), n = part_of(f, k, 1);
        f->in[k] = ns_system_union_top(f->joined, p) != ns_system_union_top(f->joined, n);
        ns_system_union_join(f->joined, p, n);
        count += f->in[k];
    }
    return count;
}

/* Parts that the forest joins without inductor `edge`. */
static void cut_forest(const forest *f, int edge) {
    ns_system_union_begin(f->joined, f->c->nused + 1);
    for (int k = 0; k < f->c->nelements; k++)
        if (f->in[k] && k != edge)
            ns_system_union_join(f->joined, part_of(f, k, 0), part_of(f, k, 1));
}

/* Inductors that leave what is joined to the first node of `edge`, beside it.  Returns how many; MOST + 1:
 * more. */
static int list_cut(const forest *f, int edge, int *of, signed char *sign) {
    int count = 0;
    cut_forest(f, edge);
    const int inside = ns_system_union_top(f->joined, part_of(f, edge, 0));
    for (int k = 0; k < f->c->nelements && count <= MOST; k++) {
        if (!is_inductor(f, k) || k == edge)
            continue;
        const int leaves = (ns_system_union_top(f->joined, part_of(f, k, 0)) == inside) -
                           (ns_system_union_top(f->joined, part_of(f, k, 1)) == inside);
        if (leaves != 0) {
            of[count] = k;
            sign[count++] = (signed char)-leaves;
        }
    }
    return count;
}

/* What the inductor's current is at the start. */
static double initial(const ns_circuit *c, int k) {
    return isnan(c->element[k].ic) ? 0 : c->element[k].ic;
}

/* 1 if the initial currents of a cut add up to zero: else some flux would be lost. */
static int holds_at_start(const ns_circuit *c, int edge, const ns_inductor_cuts *cuts) {
    double sum = initial(c, edge), size = fabs(sum);
    for (int k = cuts->first[edge]; k < cuts->first[edge] + cuts->count[edge]; k++) {
        sum -= cuts->sign[k] * initial(c, cuts->of[k]);
        size = fmax(size, fabs(initial(c, cuts->of[k])));
    }
    return fabs(sum) <= rounding * size;
}

/* 1 if a node with an .ic lies beyond the cut from ground: while that holds it, a current may enter there
 * that the inductors carry to ground, and some of their flux would be lost.  The forest is cut at `edge`. */
static int is_fed(const forest *f) {
    const ns_circuit *c = f->c;
    const int ground = ns_system_union_top(f->joined, ns_system_union_top(f->part, c->nused));
    for (int k = 0; k < c->nnodes; k++)
        if (c->node[k].used && !isnan(c->node[k].ic) &&
            ns_system_union_top(f->joined, ns_system_union_top(f->part, c->node[k].unknown)) != ground)
            return 1;
    return 0;
}

static void join_groups(const forest *f, const ns_inductor_cuts *cuts) {
    const ns_circuit *c = f->c;
    ns_system_union_begin(f->group, c->nelements);
    for (int k = 0; k < c->nelements; k++) {
        if (c->element[k].kind == COUPLING)
            ns_system_union_join(f->group, c->element[k].by[0], c->element[k].by[1]);
        for (int l = cuts->first[k]; l < cuts->first[k] + cuts->count[k]; l++)
            ns_system_union_join(f->group, k, cuts->of[l]);
    }
}

/* 1 if no group of inductors is larger than MOST. */
static int groups_are_small(const forest *f, const ns_inductor_cuts *cuts) {
    int small = 1;
    join_groups(f, cuts);
    for (int k = 0; k < f->c->nelements && small; k++)
        small = ++f->size[ns_system_union_top(f->group, k)] <= MOST;
    return small;
}

/* All cuts; 0: they are not to be used. */
static int list_cuts(const forest *f, ns_inductor_cuts *cuts) {
    int next = 0;
    for (int k = 0; k < f->c->nelements; k++) {
        cuts->first[k] = next;
        if (!f->in[k])
            continue;
        cuts->count[k] = list_cut(f, k, cuts->of + next, cuts->sign + next);
        if (cuts->count[k] > MOST || !holds_at_start(f->c, k, cuts))
            return 0;
        if (is_fed(f))
            cuts->count[k] = 0;
        next += cuts->count[k];
    }
    return groups_are_small(f, cuts);
}

static int allocate(const ns_circuit *c, forest *f, ns_inductor_cuts *cuts) {
    const size_t rows = (size_t)c->nused + 1, elements = (size_t)c->nelements + 1;
    f->part = calloc(2 * rows + 2 * elements, sizeof *f->part);
    f->in = calloc(elements, 1);
    cuts->first = calloc(2 * elements, sizeof *cuts->first);
    if (!f->part || !f->in || !cuts->first)
        return NS_E_MEMORY;
    f->joined = f->part + rows;
    f->group = f->joined + rows;
    f->size = f->group + elements;
    cuts->count = cuts->first + elements;
    return NS_OK;
}

static int find_cuts(const forest *f, ns_inductor_cuts *cuts) {
    find_parts(f);
    const size_t room = (size_t)(MOST + 1) * (size_t)find_forest(f) + 1;
    cuts->of = calloc(room, sizeof *cuts->of);
    cuts->sign = calloc(room, 1);
    if (!cuts->of || !cuts->sign)
        return NS_E_MEMORY;
    if (!list_cuts(f, cuts))
        memset(cuts->count, 0, (size_t)f->c->nelements * sizeof *cuts->count);
    return NS_OK;
}

int ns_circuit_find_cuts(const ns_circuit *c, ns_inductor_cuts *cuts) {
    forest f = {.c = c};
    memset(cuts, 0, sizeof *cuts);
    int status = allocate(c, &f, cuts);
    if (status == NS_OK)
        status = find_cuts(&f, cuts);
    free(f.part);
    free(f.in);
    return status;
}

void ns_circuit_free_cuts(ns_inductor_cuts *cuts) {
    free(cuts->first);
    free(cuts->of);
    free(cuts->sign);
}
