/* bridge/report.h - messages for the user, one line each. */
#ifndef BRIDGE_REPORT_H
#define BRIDGE_REPORT_H

#include "ngspice.h"

#if defined(__GNUC__)
#define REPORT_PRINTF(format, first)                                                                         \
    __attribute__((__format__(__printf__, format, first), __nonnull__(format)))
#else
#define REPORT_PRINTF(format, first)
#endif

/* "nonsmooth: ...", on ngspice's error stream and on its output stream; where ngspice is a library,
 * "Instance: nonsmooth   Message: ..." to the host's callback.  Each line begins on a line of its own. */
void ns_bridge_report_error(const char *format, ...) REPORT_PRINTF(1, 2);
void ns_bridge_report_note(const char *format, ...) REPORT_PRINTF(1, 2);

/* Before the first message, and when ngspice turns to another circuit: the circuit that messages are about,
 * and the number of one of our device types in it. */
void ns_bridge_report_about(CKTcircuit *ckt, int type);

/* What our device types compute: ngspice calls it for one of them while a message is sent. */
void ns_bridge_report_cm_func(Mif_Private_t *unused);

/* The code of ngspice that comes nearest to a status of the library. */
int ns_bridge_report_code(int status);

#endif
