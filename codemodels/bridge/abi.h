/* bridge/abi.h - is the running ngspice the one whose headers this was compiled with? */
#ifndef BRIDGE_ABI_H
#define BRIDGE_ABI_H

#include "ngspice.h"

/* NULL if what is read of ckt is what it should be, else what is not: before a setup of one of our types, and
 * when the matrix and all values are there. */
const char *ns_bridge_abi_check_setup(const CKTcircuit *ckt);
const char *ns_bridge_abi_check(const CKTcircuit *ckt);

#endif
