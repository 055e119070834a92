/* bridge/pure/ring.h - a signal that goes up and down: its period, and the elements whose energy swings with
 * it.
 *
 * Points of a waveform are added one by one, peaks and valleys of the signal among them.  As soon as a
 * period, from peak to peak or from valley to valley, is as long as the one before, the part of each unknown
 * that swings with that period is known: what it is beyond the straight line from the beginning to the end of
 * the period, times sine and cosine. */
#ifndef BRIDGE_RING_H
#define BRIDGE_RING_H

#include "nonsmooth/circuit.h"

typedef struct ns_ring ns_ring;

/* n: unknowns.  Errors: MEMORY. */
int ns_bridge_ring_create(int n, ns_ring **out);
void ns_bridge_ring_free(ns_ring *r); /* NULL is allowed */

/* The point at t, s, later than the one before: the signal and x (n). */
void ns_bridge_ring_add(ns_ring *r, double t, double signal, const double *x);

/* s; 0: not known yet.  Then no more points are taken. */
double ns_bridge_ring_period(const ns_ring *r);

/* When the period is known: the elements of c that make the ring, three at most, "l1, c1", into line (size
 * bytes). Empty if it is none: in a ring the inductors and the capacitors hold the same energy in turns.
 * Errors: MEMORY. */
int ns_bridge_ring_elements(const ns_ring *r, const ns_circuit *c, char *line, size_t size);

#endif
