/* src/circuit/tiny_resistor.c - resistors that are tiny beside others at their nodes.
 *
 * The row of a node sums the conductances at it.  Beside 1 uohm hardly a digit is left of a leak of 1 Gohm,
 * which may be all that holds what floats behind open switches; and across 1 nohm the rounding of a voltage
 * is a current for which other resistors need a volt.  A tiny resistor gets a row of its own, 0 = R i - (v_p
 * - v_n), and its current is an unknown: then no row sums both.
 *
 * Where a voltage is eliminated, its row is added to those of its neighbours, the more of it the larger the
 * conductance between them; so too where the difference of two voltages is given (by a voltage source, 0 ohm,
 * a closed ideal device).  What rounding makes of a large conductance thus gets as far as larger conductances
 * than the small one lead: beside 1 nohm it is 0.1 uS (10 Mohm), be there 1 mohm or a closed switch between.
 */
#include <math.h>
#include <stdlib.h>

#include "circuit_internal.h"
#include "system/union_find.h"

/* Conductances with a larger ratio than `apart` are not summed; a leak, which need not be known as well, may
 * be `leak` times smaller. */
static const double apart = 1e6, leak = 1e6;
/* Where one resistor is tiny, all others up to this many times its resistance count as tiny too. */
static const double alike = 1e3;

static double least_of_device(double ron, double roff) {
    return isinf(roff) ? 1 / ron : fmin(1 / ron, leak / roff);
}

/* 0: none. */
static double siemens_of(const element *e) {
    switch (e->kind) {
    case RESISTOR:
        return e->value != 0 ? fabs(1 / e->value) : 0;
    case DIODE:
        return least_of_device(e->diode.ron, e->diode.roff);
    case SWITCH:
        return least_of_device(e->sw.ron, e->sw.roff);
    default:
        return 0;
    }
}

/* least[row]: the smallest conductance at that node. */
static void find_least(const ns_circuit *c, double *least) {
    for (int i = 0; i < c->nused; i++) {
        least[i] = INFINITY;
    }
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        const double siemens = siemens_of(e);
        for (int end = 0; end < 2 && siemens > 0; end++) {
            const int row = ns_circuit_node_unknown(c, e->node[end]);
            if (row >= 0) {
                least[row] = fmin(least[row], siemens);
            }
        }
    }
}

/* What joins two nodes: siemens, INFINITY where the difference of their voltages is given. */
typedef struct conductor {
    double siemens;
    int p, n; /* rows, -1: ground */
    int is_resistor;
} conductor;

/* 0: it joins no nodes. */
static double joining_siemens(const element *e) {
    switch (e->kind) {
    case DIODE:
        return 1 / e->diode.ron;
    case SWITCH:
        return 1 / e->sw.ron;
    case INDUCTOR:
        return 0;
    default:
        return e->current >= 0 ? INFINITY : siemens_of(e);
    }
}

static int by_siemens(const void *a, const void *b) {
    const conductor *one = a, *other = b;
    return (one->siemens < other->siemens) - (one->siemens > other->siemens);
}

/* The largest first; how many. */
static int list_conductors(const ns_circuit *c, conductor *list) {
    int count = 0;
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        const double siemens = joining_siemens(e);
        if (siemens > 0) {
            list[count++] =
                (conductor){siemens, ns_circuit_node_unknown(c, e->node[0]),
                            ns_circuit_node_unknown(c, e->node[1]), e->kind == RESISTOR && e->current < 0};
        }
    }
    qsort(list, (size_t)count, sizeof *list, by_siemens);
    return count;
}

/* least[], of the set's least member: of all its nodes. */
static void join(const conductor *by, int *set, double *least) {
    if (by->p < 0 || by->n < 0) {
        return;
    }
    const int p = ns_system_union_top(set, by->p), n = ns_system_union_top(set, by->n);
    ns_system_union_join(set, p, n);
    least[p < n ? p : n] = fmin(least[p], least[n]);
}

static double least_at(int row, int *set, const double *least) {
    return row < 0 ? INFINITY : least[ns_system_union_top(set, row)];
}

/* The smallest conductance of a resistor that stands apart; INFINITY: none does.  Nodes that are joined by at
 * least its own / `apart` count as one. */
static double find_smallest(const conductor *list, int count, int *set, double *least) {
    double smallest = INFINITY;
    for (int k = 0, joined = 0; k < count; k++) {
        const double too_small = list[k].siemens / apart;
        if (!list[k].is_resistor) {
            continue;
        }
        for (; joined < count && list[joined].siemens >= too_small; joined++) {
            join(&list[joined], set, least);
        }
        if (least_at(list[k].p, set, least) < too_small || least_at(list[k].n, set, least) < too_small) {
            smallest = list[k].siemens;
        }
    }
    return smallest;
}

/* 1 if some resistor would stand apart if all nodes were one. */
static int any_may_stand_apart(const ns_circuit *c) {
    double of_resistors = 0, of_all = INFINITY;
    for (int k = 0; k < c->nelements; k++) {
        const double siemens = siemens_of(&c->element[k]);
        if (siemens > 0) {
            of_all = fmin(of_all, siemens);
        }
        if (c->element[k].kind == RESISTOR) {
            of_resistors = fmax(of_resistors, siemens);
        }
    }
    return of_resistors / apart > of_all;
}

/* *smallest: as find_smallest().  Errors: MEMORY. */
static int look_for_smallest(const ns_circuit *c, double *smallest) {
    double *least = malloc(((size_t)c->nused + 1) * sizeof *least);
    int *set = malloc(((size_t)c->nused + 1) * sizeof *set);
    conductor *list = malloc(((size_t)c->nelements + 1) * sizeof *list);
    const int status = least && set && list ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        find_least(c, least);
        ns_system_union_begin(set, c->nused);
        *smallest = find_smallest(list, list_conductors(c, list), set, least);
    }
    free(list);
    free(set);
    free(least);
    return status;
}

int ns_circuit_tiny_resistors(ns_circuit *c) {
    double smallest;
    if (!any_may_stand_apart(c)) {
        return NS_OK;
    }
    const int status = look_for_smallest(c, &smallest);
    for (int k = 0; k < c->nelements && status == NS_OK; k++) {
        element *e = &c->element[k];
        if (e->kind == RESISTOR && e->current < 0 && siemens_of(e) >= smallest / alike) {
            e->current = c->ncurrents++;
        }
    }
    return status;
}
