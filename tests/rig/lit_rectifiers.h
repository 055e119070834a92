/* tests/rig/lit_rectifiers.h - the diode circuits of the literature: by hand, as netlists, and their exact
 * waveforms. */
#ifndef NONSMOOTH_TESTS_LIT_RECTIFIERS_H
#define NONSMOOTH_TESTS_LIT_RECTIFIERS_H

#include "nonsmooth.h"

typedef enum lit_rectifier {
    LIT_RLCD,     /* C, L and R with a diode in parallel;                  out = (v, i_L) */
    LIT_BRIDGE,   /* a bridge between an LC tank and a resistor;           out = (v, i_L) */
    LIT_FILTER,   /* a capacitor across that resistor;                     out = (v, i_L, v_load) */
    LIT_SUPPLY,   /* a sine in place of the tank;                          out = (v_load) */
    LIT_RESONANT, /* a square wave, L and C, a bridge, an L-C-R load;      out = (i_L1, v_C, i_L2, v_load) */
    LIT_RECTIFIERS
} lit_rectifier;

enum { LIT_OUT = 4, LIT_SAMPLES = 100, LIT_X = 16 };

/* How a circuit is run: fixed steps of h to `samples` instants, `every` apart. */
typedef struct lit_run {
    const char *name;
    double h, every;
    int samples, out;
    double scale[LIT_OUT]; /* size of each output */
} lit_run;
const lit_run *lit_run_of(lit_rectifier which);

/* The system written by hand, its charges and fluxes before the start (w0: LIT_X), and its outputs. */
ns_system *lit_hand(lit_rectifier which, double *w0);
void lit_hand_out(lit_rectifier which, const double *x, double *out);

/* The netlist, and its outputs. */
ns_circuit *lit_netlist(lit_rectifier which);
void lit_netlist_out(lit_rectifier which, const ns_circuit *c, const double *x, double *out);

/* out (samples*LIT_OUT): the exact outputs at the instants of the run.  In closed form, but for the filter
 * and the resonant converter: matrix exponentials, ends of modes by halving. */
void lit_exact(lit_rectifier which, double *out);

#endif
