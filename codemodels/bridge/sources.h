/* bridge/sources.h - V and I of ngspice. */
#ifndef BRIDGE_SOURCES_H
#define BRIDGE_SOURCES_H

#include "ngspice.h"
#include "pure/source_signal.h"

/* inst, a V or an I, as a signal: of .tran, or (as_dc) its DC value.  Returns NULL, or why it is none;
 * *points: see ns_bridge_source_signal(). */
const char *ns_bridge_sources_signal(const CKTcircuit *ckt, const GENinstance *inst, int as_dc, ns_signal *z,
                                     double **points);

#endif
