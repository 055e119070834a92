/* bridge/pure/source_signal.h - V and I sources of ngspice as signals, with ngspice's defaults. */
#ifndef BRIDGE_SOURCE_SIGNAL_H
#define BRIDGE_SOURCE_SIGNAL_H

#include "nonsmooth/signal.h"

/* ngspice's numbers of the functions that a signal can be. */
typedef enum ns_source_function {
    SOURCE_DC = 0,
    SOURCE_PULSE = 1,
    SOURCE_SINE = 2,
    SOURCE_EXP = 3,
    SOURCE_PWL = 5
} ns_source_function;

/* What PULSE takes for a time that is missing or not positive. */
typedef enum ns_source_pulse {
    PULSE_OF_39, /* where 0 or missing: rise and fall tstep, width and period tstop */
    PULSE_OF_46, /* where not positive or missing: rise and fall tstep, width 0, period that of one pulse */
    PULSE_OF_47 /* where not positive or missing: rise and fall tstep, period tstop; width: 0 is 0, tstop, but
                 * 0 after a fall that is the last parameter */
} ns_source_pulse;

typedef struct ns_source {
    int function; /* an ns_source_function, or another number of ngspice's */
    int order;
    const double *coeffs; /* order: its parameters as the netlist has them */
    int dc_given;
    double dc;
    double m; /* so many equal sources side by side; of voltages 1 */

    ns_source_pulse pulse;
    int repeats;      /* PWL: r= was given */
    int repeat_index; /* in coeffs, of the time to go back to */
    double delay;     /* PWL: td=, s */

    int as_dc;           /* its DC value is wanted */
    double tstep, tstop; /* of .tran, for the defaults, s */
} ns_source;

/* Makes the signal and returns NULL, or why not.  Times and values of a PWL lie in *points, which the caller
 * frees (NULL: it is none). */
const char *ns_bridge_source_signal(const ns_source *s, ns_signal *z, double **points);

#endif
