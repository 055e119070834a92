/* bridge/dc_rows.h - keeps ngspice from writing its .ic and .nodeset rows over ours in DC loads.
 *
 * It writes them after all devices have loaded, for nodes with a flag; the flags are hidden meanwhile. */
#ifndef BRIDGE_DC_ROWS_H
#define BRIDGE_DC_ROWS_H

#include "ngspice.h"

typedef struct ns_dc_rows {
    unsigned char *flags; /* of the nodes, in their order, as they were */
    int hidden;
} ns_dc_rows;

int ns_bridge_dc_rows_hide(ns_dc_rows *rows, CKTcircuit *ckt); /* OK or E_NOMEM */
void ns_bridge_dc_rows_show(ns_dc_rows *rows, CKTcircuit *ckt);
void ns_bridge_dc_rows_clear(ns_dc_rows *rows); /* the nodes may be gone */

#endif
