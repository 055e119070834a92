/* bridge/pure/late_text.c - the line for an output that changed at a time that was already simulated. */
#include "late_text.h"

#include <stdio.h>

void ns_bridge_late_text(char *text, size_t size, double t, const char *output, const char *name,
                         const char *model) {
    if (name)
        snprintf(text, size,
                 "at t = %g s: %.100s (%s) changed its output at a time that was already simulated: its "
                 "control changes its frequency or duty cycle too much between two timepoints, "
                 "which is not supported: let it change more slowly, or give .tran a tmax",
                 t, name, model);
    else
        snprintf(
            text, size,
            "at t = %g s: the digital input of %.100s (dac_bridge) changed at a time that was already "
            "simulated: an event of the digital parts came before the time for which ngspice's queue had "
            "it: give .tran a tmax",
            t, output);
}
