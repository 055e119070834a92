/* src/circuit/initial.c - what initial conditions mean for the system: charges, fluxes, held nodes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "circuit_internal.h"

typedef struct fluxes {
    const ns_circuit *c;
    double *w0;
} fluxes;

static double node_volts(const ns_circuit *c, int number) {
    int found, place = ns_circuit_find_node(c, number, &found);
    return found && !isnan(c->node[place].ic) ? c->node[place].ic : 0;
}

static void add_at_row(double *w0, int row, double value) {
    if (row >= 0 && w0) {
        w0[row] += value;
    }
}

static void add_charge(const ns_circuit *c, const element *e, double *w0) {
    double v = isnan(e->ic) ? node_volts(c, e->node[0]) - node_volts(c, e->node[1]) : e->ic;
    add_at_row(w0, ns_circuit_node_unknown(c, e->node[0]), e->value * v);
    add_at_row(w0, ns_circuit_node_unknown(c, e->node[1]), -e->value * v);
}

static void add_flux(void *data, int row, int column, double henries) {
    const fluxes *to = data;
    double i = to->c->element[column].ic;
    add_at_row(to->w0, ns_circuit_current_unknown(to->c, row), isnan(i) ? 0 : henries * i);
}

int ns_circuit_rest(const ns_circuit *c, double *w0) {
    fluxes to = {c, w0};
    if (!c || (!w0 && c->nused + c->ncurrents > 0)) {
        return NS_E_NULL;
    }
    for (int i = 0; i < c->nused + c->ncurrents; i++) {
        w0[i] = 0;
    }
    for (int i = 0; i < c->nelements; i++) {
        if (c->element[i].kind == CAPACITOR) {
            add_charge(c, &c->element[i], w0);
        }
    }
    ns_circuit_each_inductance(c, add_flux, &to);
    return NS_OK;
}

/* Fills hold and hold_x where they are given. */
static int list_held_nodes(const ns_circuit *c, int *hold, double *hold_x) {
    int count = 0;
    for (int i = 0; i < c->nnodes; i++) {
        if (c->node[i].used && !isnan(c->node[i].ic)) {
            if (hold) {
                hold[count] = c->node[i].unknown;
            }
            if (hold_x) {
                hold_x[count] = c->node[i].ic;
            }
            count++;
        }
    }
    return count;
}

int ns_circuit_node_ic_count(const ns_circuit *c) {
    return c ? list_held_nodes(c, NULL, NULL) : 0;
}

int ns_circuit_hold(const ns_circuit *c, int *hold, double *hold_x) {
    return c ? list_held_nodes(c, hold, hold_x) : 0;
}
