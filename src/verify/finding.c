/* src/verify/finding.c - the worst that was found, and its text. */
#include "verify_internal.h"

#include <math.h>

void ns_verify_note(ns_verify_finding *worst, ns_verify_cause cause, int pair, int unknown, double error) {
    if (error <= worst->error)
        return;
    worst->cause = cause;
    worst->pair = pair;
    worst->unknown = unknown;
    worst->error = isnan(error) ? INFINITY : error;
}

const char *ns_verify_text(ns_verify_cause cause) {
    switch (cause) {
    case NS_VERIFY_NUMBER:
        return "a number is not finite, or too large for any other to count";
    case NS_VERIFY_ROW:
        return "currents or voltages do not add up";
    case NS_VERIFY_OUTPUT:
        return "the voltage shown is not that of the nodes";
    case NS_VERIFY_LAW:
        return "voltage and current have the wrong signs";
    case NS_VERIFY_COMMAND:
        return "the switch is not as its control says; if it moves that, delay its control by R and C";
    case NS_VERIFY_JUMP:
        return "a charge or a flux jumps without a cause";
    case NS_VERIFY_IMPULSE:
        return "an impulse has the wrong sign";
    case NS_VERIFY_ENERGY:
        return "energy grows in a jump";
    case NS_VERIFY_CHATTER:
        return "another device changes with each switching";
    case NS_VERIFY_FLOW:
        return "a charge or a flux is not the integral of what flows";
    case NS_VERIFY_RIGHT:
        break;
    }
    return "nothing is wrong";
}
