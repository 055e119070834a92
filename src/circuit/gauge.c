/* src/circuit/gauge.c - parts of a circuit without any connection to ground (the far side of a transformer).
 *
 * Nothing determines the voltage of such a part as a whole, and no current can leave it; a conductance from
 * one of its nodes to ground therefore carries none, changes nothing, and puts that node at 0 V.  A node that
 * only controls something belongs to no part: leaving it open is a mistake that must show.
 */
#include <stdlib.h>

#include "circuit/circuit_internal.h"

/* The part a row belongs to, by its lowest row; ground is row -1, kept at parent[nused]. */
static int part_of(int *parent, int row) {
    while (parent[row] != row) {
        parent[row] = parent[parent[row]];
        row = parent[row];
    }
    return row;
}

static int row_or_ground(const ns_circuit *c, int node) {
    const int row = ns_circuit_node_unknown(c, node);
    return row < 0 ? c->nused : row;
}

int ns_stamp_gauge(const ns_circuit *c, ns_system *s) {
    const int count = c->nused + 1;
    int *parent = malloc(2 * sizeof *parent * (size_t)count), *settled = parent + count;
    if (!parent) {
        return NS_E_MEMORY;
    }
    for (int i = 0; i < count; i++) {
        parent[i] = i;
        settled[i] = 1; /* until something is connected there */
    }
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        if (e->kind != COUPLING) {
            const int p = row_or_ground(c, e->node[0]), n = row_or_ground(c, e->node[1]);
            settled[p] = settled[n] = 0;
            parent[part_of(parent, p)] = part_of(parent, n);
        }
    }
    settled[part_of(parent, c->nused)] = 1;
    for (int i = 0; i < c->nused; i++) {
        const int part = part_of(parent, i);
        if (!settled[i] && !settled[part]) {
            s->A[(size_t)i * (size_t)(s->n + 1)] -= 1;
            settled[part] = 1;
        }
    }
    free(parent);
    return NS_OK;
}
