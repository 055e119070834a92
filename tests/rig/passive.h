/* tests/rig/passive.h - random passive networks, and one more with a source, through the marcher. */
#ifndef NONSMOOTH_TESTS_PASSIVE_H
#define NONSMOOTH_TESTS_PASSIVE_H

#include "nonsmooth.h"

enum { NODES = 6, ELEMENTS = 11 };

/* DRIVE: a square wave of 1 V, 17 us, behind 10 ohm; value is not used. */
typedef enum kind { RES, CAP, IND, DIODE, SWITCH, DRIVE } kind;

typedef struct element {
    kind kind;
    int p, n;
    double value, ic, instant; /* ohm, F or H; V or A; s: when the switch opens, negative: closes */
} element;

/* Network number `seed` (ELEMENTS): always one capacitor and one inductor.  Then draw() goes on from there.
 */
void random_network(element *e, unsigned long seed);
unsigned draw(unsigned below);

typedef struct run {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    int id[ELEMENTS];
    int node[NODES];    /* numbers given to the nodes */
    double roff, theta; /* of all devices; theta = gamma */
    ns_method method;   /* plain(): NS_AUTO */
} run;

/* A run with nodes as they are; then its circuit with the elements in this order, started.  0: refused. */
run plain(double roff, double theta);
int begin(run *r, const element *e, const int *order, double h);
void end(run *r);
extern const int straight[ELEMENTS];

/* On to t.  0: refused, for a reason that may be; the line is printed. */
int go(run *r, double t);

/* Voltage or current of element k: what a capacitor or inductor holds, 0 of others.  Stored energy, J. */
double held(const run *r, const element *e, int k);
double energy(const run *r, const element *e);

#endif
