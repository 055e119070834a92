/* bridge/ngspice.h - the headers of ngspice that every file of the bridge needs. */
#ifndef BRIDGE_NGSPICE_H
#define BRIDGE_NGSPICE_H

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "ngspice/ngspice.h"

/* On Windows that header puts a function in its place, which ngspice's binary does not export. */
#undef fopen

#include "ngspice/cktdefs.h"
#include "ngspice/devdefs.h"
#include "ngspice/mifdefs.h"
#include "ngspice/mifproto.h"
#include "ngspice/sperror.h"

#endif
