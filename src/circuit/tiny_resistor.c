/* src/circuit/tiny_resistor.c - resistors that are tiny beside others at their nodes.
 *
 * The row of a node sums the conductances at it.  Beside 1 uohm hardly a digit is left of a leak of 1 Gohm,
 * which may be all that holds what floats behind open switches; and across 1 nohm the rounding of a voltage
 * is a current for which other resistors need a volt.  A tiny resistor gets a row of its own, 0 = R i - (v_p
 * - v_n), and its current is an unknown: then no row sums both.
 *
 * The rows of two nodes whose difference is given (by a voltage source, 0 ohm, a closed ideal device) are
 * summed when the current between them is eliminated: they count as one node.
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

/* 1 if the element gives the difference of its two voltages, whatever its current is. */
static int gives_voltage(const element *e) {
    switch (e->kind) {
    case DIODE:
        return e->diode.ron == 0;
    case SWITCH:
        return e->sw.ron == 0;
    case INDUCTOR:
        return 0;
    default:
        return e->current >= 0;
    }
}

/* least[row]: the smallest of all nodes that count as one. */
static int share_least(const ns_circuit *c, double *least) {
    int *set = malloc(((size_t)c->nused + 1) * sizeof *set);
    if (!set) {
        return NS_E_MEMORY;
    }
    ns_system_union_begin(set, c->nused);
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        const int gives = gives_voltage(e), p = gives ? ns_circuit_node_unknown(c, e->node[0]) : -1,
                  n = gives ? ns_circuit_node_unknown(c, e->node[1]) : -1;
        if (p >= 0 && n >= 0) {
            ns_system_union_join(set, p, n);
        }
    }
    for (int i = c->nused - 1; i >= 0; i--) { /* a set is represented by its least member */
        const int top = ns_system_union_top(set, i);
        least[top] = fmin(least[top], least[i]);
    }
    for (int i = 0; i < c->nused; i++) {
        least[i] = least[ns_system_union_top(set, i)];
    }
    free(set);
    return NS_OK;
}

static int stands_apart(const ns_circuit *c, const element *e, const double *least) {
    for (int end = 0; end < 2; end++) {
        const int row = ns_circuit_node_unknown(c, e->node[end]);
        if (row >= 0 && siemens_of(e) / apart > least[row]) {
            return 1;
        }
    }
    return 0;
}

/* The smallest conductance of a resistor that stands apart; INFINITY: none does. */
static double find_smallest(const ns_circuit *c, const double *least) {
    double smallest = INFINITY;
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        if (e->kind == RESISTOR && stands_apart(c, e, least)) {
            smallest = fmin(smallest, siemens_of(e));
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

int ns_circuit_tiny_resistors(ns_circuit *c) {
    if (!any_may_stand_apart(c)) {
        return NS_OK;
    }
    double *least = malloc(((size_t)c->nused + 1) * sizeof *least);
    if (!least) {
        return NS_E_MEMORY;
    }
    find_least(c, least);
    const int status = share_least(c, least);
    if (status != NS_OK) {
        free(least);
        return status;
    }
    const double smallest = find_smallest(c, least);
    for (int k = 0; k < c->nelements; k++) {
        element *e = &c->element[k];
        if (e->kind == RESISTOR && e->current < 0 && siemens_of(e) >= smallest / alike) {
            e->current = c->ncurrents++;
        }
    }
    free(least);
    return NS_OK;
}
