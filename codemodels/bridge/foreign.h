/* bridge/foreign.h - code models of other libraries: which model an instance is of. */
#ifndef BRIDGE_FOREIGN_H
#define BRIDGE_FOREIGN_H

#include "ngspice.h"

/* The name of the code model that inst is an instance of, as its ifspec.ifs has it ("adc_bridge"); NULL: it
 * is not known.  A constant string of that library. */
const char *ns_bridge_foreign_model(const MIFinstance *inst);

/* What that library says of the model; NULL: it is not known. */
IFdevice *ns_bridge_foreign_type(const MIFinstance *inst);

#endif
