/* bridge/dc_rows.c - keeps ngspice from writing its .ic and .nodeset rows over ours in DC loads. */
#include "dc_rows.h"

#include <string.h>

int ns_bridge_dc_rows_hide(ns_dc_rows *rows, CKTcircuit *ckt) {
    int k = 0;
    if (!rows->flags && !(rows->flags = calloc((size_t)ckt->CKTmaxEqNum, 1)))
        return E_NOMEM;
    for (CKTnode *node = ckt->CKTnodes; node; node = node->next, k++) {
        rows->flags[k] = (unsigned char)(node->icGiven | (node->nsGiven << 1));
        node->icGiven = node->nsGiven = 0;
    }
    rows->hidden = 1;
    return OK;
}

void ns_bridge_dc_rows_show(ns_dc_rows *rows, CKTcircuit *ckt) {
    int k = 0;
    for (CKTnode *node = ckt->CKTnodes; rows->hidden && node; node = node->next, k++) {
        node->icGiven = rows->flags[k] & 1U;
        node->nsGiven = (rows->flags[k] >> 1) & 1U;
    }
    rows->hidden = 0;
}

void ns_bridge_dc_rows_clear(ns_dc_rows *rows) {
    free(rows->flags);
    memset(rows, 0, sizeof *rows);
}
