/* src/circuit/ground_reference.c - parts of a circuit without any connection to ground (the far side of a
 * transformer).
 *
 * Nothing determines the voltage of such a part as a whole, and no current can leave it; a conductance from
 * one of its nodes to ground therefore carries none, changes nothing, and puts that node at 0 V.  A node with
 * an .ic is taken first: while it is held, what the conductance draws comes from what holds it.  A node that
 * only controls something belongs to no part: leaving it open is a mistake that must show; so is a current
 * source that alone leads to ground.
 */
#include <math.h>
#include <stdlib.h>

#include "circuit_internal.h"

/* The part a row belongs to, by one of its rows; ground has the row after those of the nodes. */
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

/* settled[part]: has ground, or no element; of other rows it means nothing. */
static void find_parts(const ns_circuit *c, int *parent, int *settled) {
    for (int i = 0; i <= c->nused; i++) {
        parent[i] = i;
        settled[i] = 1;
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
}

/* Settles each part that is not at the first of its nodes; held: only at nodes with an .ic. */
static void settle(const stamp *to, int *parent, int *settled, int held) {
    const ns_circuit *c = to->c;
    for (int k = 0, row = 0; k < c->nnodes; k++) {
        if (!c->node[k].used) {
            continue;
        }
        const int part = part_of(parent, row);
        if (!settled[part] && !(held && isnan(c->node[k].ic))) {
            ns_circuit_stamp_add(to, IN_A, row, row, -1);
            settled[part] = 1;
        }
        row++;
    }
}

int ns_circuit_ground_reference(const stamp *to) {
    const ns_circuit *c = to->c;
    const size_t count = (size_t)c->nused + 1;
    int *parent = calloc(2 * count, sizeof *parent);
    if (!parent) {
        return NS_E_MEMORY;
    }
    int *settled = parent + count;
    find_parts(c, parent, settled);
    settle(to, parent, settled, 1);
    settle(to, parent, settled, 0);
    free(parent);
    return NS_OK;
}
