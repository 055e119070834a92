/* tests/rig/signals.h - sources in one line. */
#ifndef SIGNALS_H
#define SIGNALS_H

#include "nonsmooth/signal.h"

static inline ns_signal dc(double v) {
    return (ns_signal){.kind = NS_DC, .u.dc = v};
}

static inline ns_signal pulse(double v1, double v2, double td, double tr, double tf, double pw, double per) {
    return (ns_signal){.kind = NS_PULSE, .u.pulse = {v1, v2, td, tr, tf, pw, per, 0}};
}

#endif
