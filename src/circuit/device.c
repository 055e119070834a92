/* src/circuit/device.c - current, voltage and state of a diode or switch read out of a solution. */
#include <math.h>
#include <stddef.h>

#include "circuit_internal.h"

int ns_circuit_device(const ns_circuit *c, int id, const double *x, const double *lambda, const ns_mode *mode,
                      double *i, double *v, int *on) {
    const ns_solution at = {.x = x, .lambda = lambda};
    if (!c) {
        return NS_E_NULL;
    }
    if (id < 0 || id >= c->nelements || c->element[id].pair < 0 || c->element[id].nnodes == 0) {
        return NS_E_SIZE;
    }
    const element *e = &c->element[id];
    if (mode && lambda && i && !v && !on && isinf(e->kind == DIODE ? e->diode.roff : e->sw.roff)) {
        *i = lambda[e->pair] - (ns_circuit_pairs_of(e) == 2 ? lambda[e->pair + 1] : 0);
        return NS_OK;
    }
    const int status = mode ? ns_circuit_power(c, id, &at, v, i, NULL) : NS_E_NULL;
    if (status != NS_OK || !on) {
        return status;
    }
    *on = mode[e->pair] == NS_INSIDE || mode[e->pair] > NS_UPPER; /* or it slides */
    if (!*on && ns_circuit_pairs_of(e) == 2) {
        *on = -(mode[e->pair + 1] == NS_INSIDE);
    }
    return NS_OK;
}
