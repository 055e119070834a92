/* src/circuit/initial.c - what initial conditions mean for the system: charges, fluxes, held nodes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "potentials.h"

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

int ns_circuit_node_ic_count(const ns_circuit *c) {
    int count = 0;
    for (int i = 0; c && i < c->nnodes; i++) {
        count += c->node[i].used && !isnan(c->node[i].ic);
    }
    return count;
}

/* 1 if voltage sources hold the node against ground, or against one of the count that are held already, whose
 * places are known. */
static int is_held_by_sources(const ns_potentials *p, int place, const int *held, int count) {
    int is = p->group[place] == p->group[ns_circuit_potentials_place(p, 0)];
    for (int k = 0; k < count && !is; k++) {
        is = p->group[held[k]] == p->group[place];
    }
    return is;
}

static int list_held_nodes(const ns_circuit *c, const ns_potentials *p, int *held, int *hold,
                           double *hold_x) {
    int count = 0;
    for (int i = 0; i < c->nnodes; i++) {
        const node_info *node = &c->node[i];
        if (!node->used || isnan(node->ic)) {
            continue;
        }
        const int place = ns_circuit_potentials_place(p, node->number);
        if (is_held_by_sources(p, place, held, count)) {
            continue; /* SPICE's .ic is a conductance, which yields to a source */
        }
        held[count] = place;
        hold[count] = node->unknown;
        hold_x[count] = node->ic;
        count++;
    }
    return count;
}

int ns_circuit_hold(const ns_circuit *c, int *hold, double *hold_x) {
    const int most = ns_circuit_node_ic_count(c);
    int count = 0, *held = most > 0 ? malloc((size_t)most * sizeof *held) : NULL;
    ns_potentials p;
    if (!held) {
        return most > 0 ? -1 : 0;
    }
    if (ns_circuit_potentials_find(&p, c)) {
        count = list_held_nodes(c, &p, held, hold, hold_x);
    } else {
        count = -1;
    }
    ns_circuit_potentials_free(&p);
    free(held);
    return count;
}
