/* bridge/dump.h - a step that failed, in a file that nsc-mlcp reads: a user's report. */
#ifndef BRIDGE_DUMP_H
#define BRIDGE_DUMP_H

#include "analysis.h"

/* If option dump names a file, writes the problem at which the marcher's last call failed into it, and into
 * more (size bytes, always terminated) what follows the error message: "; the problem that failed is
 * in FILE", or why it is not. */
void ns_bridge_dump_failed_step(const ns_analysis *a, char *more, size_t size);

#endif
