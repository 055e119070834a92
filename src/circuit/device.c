/* src/circuit/device.c - current, voltage and state of a diode or switch read out of a solution. */
#include <math.h>
#include <stddef.h>

#include "circuit_internal.h"

static double volts(const ns_circuit *c, int number, const double *x) {
    int index = ns_circuit_node_unknown(c, number);
    return index < 0 || !x ? 0 : x[index];
}

int ns_circuit_device(const ns_circuit *c, int id, const double *x, const double *lambda, const ns_mode *mode,
                      double *i, double *v, int *on) {
    const element *e;
    double across, through;
    int state, breakdown;
    if (!c) {
        return NS_E_NULL;
    }
    if (id < 0 || id >= c->nelements || c->element[id].pair < 0) {
        return NS_E_SIZE;
    }
    if (!lambda || !mode || (!x && c->nused > 0)) {
        return NS_E_NULL;
    }
    e = &c->element[id];
    breakdown = e->kind == DIODE && !isinf(e->diode.vz);
    across = volts(c, e->node[0], x) - volts(c, e->node[1], x);
    through = lambda[e->pair] + across / (e->kind == DIODE ? e->diode.roff : e->sw.roff);
    state = mode[e->pair] == NS_INSIDE || mode[e->pair] > NS_UPPER; /* or it slides */
    if (breakdown) {
        through -= lambda[e->pair + 1];
        state = state ? 1 : -(mode[e->pair + 1] == NS_INSIDE);
    }
    if (i) {
        *i = through;
    }
    if (v) {
        *v = across;
    }
    if (on) {
        *on = state;
    }
    return NS_OK;
}
