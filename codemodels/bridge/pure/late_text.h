/* bridge/pure/late_text.h - the line for an output that changed at a time that was already simulated. */
#ifndef BRIDGE_LATE_TEXT_H
#define BRIDGE_LATE_TEXT_H

#include <stddef.h>

/* At t (s); output: the dac_bridge; name, model: of the d_osc or d_pwm whose edge came last, NULL: there is
 * none. */
void ns_bridge_late_text(char *text, size_t size, double t, const char *output, const char *name,
                         const char *model);

#endif
