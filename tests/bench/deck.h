/* tests/bench/deck.h - a circuit as a list of parts, made once: a circuit of the library and netlists for
 * ngspice come from the same numbers. */
#ifndef NONSMOOTH_TESTS_DECK_H
#define NONSMOOTH_TESTS_DECK_H

#include <stdio.h>

#include "nonsmooth.h"

typedef struct deck deck;

/* Every diode is ideal, every switch has ron = 0 and no leak. */
deck *deck_create(void);
void deck_free(deck *d); /* NULL is allowed */

/* A part between nodes p and n; returns its number.  ic: initial voltage or current. */
int deck_r(deck *d, int p, int n, double ohms);
int deck_c(deck *d, int p, int n, double farads, double ic);
int deck_l(deck *d, int p, int n, double henries, double ic);
int deck_v(deck *d, int p, int n, ns_signal s);
int deck_i(deck *d, int p, int n, ns_signal s);
int deck_d(deck *d, int anode, int cathode);
int deck_s(deck *d, int p, int n, int cp, int cn, double vt); /* closed while v(cp)-v(cn) > vt */
int deck_e(deck *d, int p, int n, int cp, int cn, double gain);
int deck_g(deck *d, int p, int n, int cp, int cn, double gain);
int deck_f(deck *d, int p, int n, int by, double gain); /* by: a voltage source or E */

ns_signal deck_dc(double value);
ns_signal deck_pulse(double v2, double td, double edge, double pw, double per); /* from 0 */
ns_signal deck_sine(double vo, double va, double freq, double phase);

int deck_devices(const deck *d); /* diodes and switches */

/* What stands for the devices in a netlist. */
typedef enum deck_diode { DECK_D, DECK_SIDIODE, DECK_IDEAL } deck_diode;
typedef struct deck_models {
    deck_diode diode; /* ngspice's D (is=1e-14), its sidiode, or our ideal_diode and ideal_switch */
    double n;         /* emission coefficient of D */
    double ron, roff; /* of S and sidiode, ohm */
    double vh;        /* half hysteresis of S, V */
} deck_models;

/* The circuit; ic as in ns_circuit_rest().  Its element numbers are the parts'. */
int deck_circuit(const deck *d, ns_circuit **out);

/* The element and .model lines. */
void deck_netlist(const deck *d, const deck_models *models, FILE *file);

/* ngspice's name of a part's current ("l1"). */
void deck_name(const deck *d, int at, char *name, size_t size);

#endif
