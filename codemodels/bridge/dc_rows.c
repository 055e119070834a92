/* bridge/dc_rows.c - keeps ngspice from writing its .ic and .nodeset rows over ours in DC loads.
 *
 * It does so after all devices have loaded, for nodes with a flag; the flags are hidden meanwhile. */
#include "session.h"

void ns_bridge_dc_rows_hide(ns_session *b) {
    int k = 0;
    for (CKTnode *node = b->ckt->CKTnodes; node; node = node->next, k++) {
        b->held[k] = (int)(node->icGiven | (node->nsGiven << 1));
        node->icGiven = node->nsGiven = 0;
    }
    b->hidden = 1;
}

void ns_bridge_dc_rows_show(ns_session *b) {
    int k = 0;
    for (CKTnode *node = b->ckt->CKTnodes; b->hidden && node; node = node->next, k++) {
        node->icGiven = (unsigned)b->held[k] & 1U;
        node->nsGiven = (unsigned)b->held[k] >> 1 & 1U;
    }
    b->hidden = 0;
}
