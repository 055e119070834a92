/* src/circuit/device.c - current, voltage and state of a diode or switch read out of a solution.
 *
 * Every device is read at every point that is shown, so this does not go through ns_circuit_power(). */
#include <math.h>
#include <stddef.h>

#include "circuit_internal.h"

/* The unknown that is the voltage of e->node[end]; -1: ground. */
static int unknown_at(const ns_circuit *c, const element *e, int end) {
    const int number = e->node[end], place = e->place[end];
    if (number <= 0)
        return -1;
    if (place < c->nnodes && c->node[place].number == number) /* else nodes were added since */
        return c->node[place].used ? c->node[place].unknown : -1;
    return ns_circuit_node_unknown(c, number);
}

/* V at a node; 0 if no element names it. */
static double volts_at(const ns_circuit *c, const element *e, int end, const double *x) {
    const int unknown = unknown_at(c, e, end);
    /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): x may be NULL where there are no unknowns */
    return unknown >= 0 ? x[unknown] : 0;
}

static void read_current(const ns_circuit *c, const element *e, const double *x, const double *lambda,
                         double *i, double *v) {
    const double roff = e->kind == DIODE ? e->diode.roff : e->sw.roff;
    *i = lambda[e->pair] - (ns_circuit_pairs_of(e) == 2 ? lambda[e->pair + 1] : 0);
    if (!v && isinf(roff)) {
        return;
    }
    const double across = volts_at(c, e, 0, x) - volts_at(c, e, 1, x);
    *i += across / roff;
    if (v) {
        *v = across;
    }
}

int ns_circuit_device(const ns_circuit *c, int id, const double *x, const double *lambda, const ns_mode *mode,
                      double *i, double *v, int *on) {
    double current;
    if (!c) {
        return NS_E_NULL;
    }
    if (id < 0 || id >= c->nelements || c->element[id].pair < 0 || c->element[id].nnodes == 0) {
        return NS_E_SIZE;
    }
    const element *e = &c->element[id];
    if (!mode || !lambda || (!x && c->nused + c->ncurrents > 0)) {
        return NS_E_NULL;
    }
    read_current(c, e, x, lambda, i ? i : &current, v);
    if (on) {
        *on = mode[e->pair] == NS_INSIDE || mode[e->pair] > NS_UPPER; /* or it slides */
        if (!*on && ns_circuit_pairs_of(e) == 2) {
            *on = -(mode[e->pair + 1] == NS_INSIDE);
        }
    }
    return NS_OK;
}
