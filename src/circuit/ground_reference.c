/* src/circuit/ground_reference.c - parts of a circuit without any connection to ground (the far side of a
 * transformer).
 *
 * Nothing determines the voltage of such a part as a whole, and no current can leave it; a conductance from
 * one of its nodes to ground therefore carries none, changes nothing, and puts that node at 0 V.  A node with
 * an .ic is taken first: while it is held, what the conductance draws comes from what holds it.  A node that
 * only controls something belongs to no part: an open control is a mistake that must be refused, and so is a
 * part that only a current source connects to ground.
 */
#include <math.h>
#include <stdlib.h>

#include "circuit_internal.h"
#include "system/union_find.h"

int ns_circuit_row_or_ground(const ns_circuit *c, int node) {
    const int row = ns_circuit_node_unknown(c, node);
    return row < 0 ? c->nused : row;
}

/* part (nused+1): union-find over rows; floating[r]: the part whose top is row r has elements, and no ground.
 */
static void find_parts(const ns_circuit *c, int *part, unsigned char *floating) {
    ns_system_union_begin(part, c->nused + 1);
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        if (e->nnodes > 0) {
            const int p = ns_circuit_row_or_ground(c, e->node[0]),
                      n = ns_circuit_row_or_ground(c, e->node[1]);
            floating[p] = floating[n] = 1;
            ns_system_union_join(part, p, n);
        }
    }
    floating[ns_system_union_top(part, c->nused)] = 0;
}

/* Grounds each floating part at the first of its nodes; held: only at nodes with an .ic. */
static void ground_parts(const stamp *to, int *part, unsigned char *floating, int held) {
    const ns_circuit *c = to->c;
    for (int k = 0; k < c->nnodes; k++) {
        const node_info *node = &c->node[k];
        const int top = node->used ? ns_system_union_top(part, node->unknown) : 0;
        if (node->used && floating[top] && !(held && isnan(node->ic))) {
            ns_circuit_stamp_add(to, IN_A, node->unknown, node->unknown, -1);
            ns_circuit_stamp_add(to, IN_A, -1, node->unknown, 1);
            floating[top] = 0;
        }
    }
}

int ns_circuit_ground_reference(const stamp *to) {
    const size_t rows = (size_t)to->c->nused + 1;
    int *part = calloc(rows, sizeof *part);
    unsigned char *floating = calloc(rows, 1);
    const int status = part && floating ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        find_parts(to->c, part, floating);
        ground_parts(to, part, floating, 1);
        ground_parts(to, part, floating, 0);
    }
    free(part);
    free(floating);
    return status;
}
