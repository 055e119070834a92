/* bridge/elements.h - the readers of single elements, one a SPICE letter. */
#ifndef BRIDGE_ELEMENTS_H
#define BRIDGE_ELEMENTS_H

#include "extract_walk.h"

ns_extract_reader ns_bridge_elements_resistor, ns_bridge_elements_capacitor, ns_bridge_elements_inductor,
    ns_bridge_elements_coupling;
ns_extract_reader ns_bridge_elements_vcvs, ns_bridge_elements_vccs, ns_bridge_elements_cccs,
    ns_bridge_elements_ccvs;
ns_extract_reader ns_bridge_sources_vsource, ns_bridge_sources_isource; /* sources.c */
ns_extract_reader ns_bridge_behavioural;                                /* behavioural.c */

#endif
