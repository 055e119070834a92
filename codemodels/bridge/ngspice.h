/* bridge/ngspice.h - the headers of ngspice that every file of the bridge needs. */
#ifndef BRIDGE_NGSPICE_H
#define BRIDGE_NGSPICE_H

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "ngspice/ngspice.h"

#include "ngspice/cktdefs.h"
#include "ngspice/devdefs.h"
#include "ngspice/mifdefs.h"
#include "ngspice/mifproto.h"
#include "ngspice/sperror.h"

#endif
