/* nonsmooth/energy.h - charge and energy that elements of a circuit take in, integrated over a run.
 *
 * Between events by quadrature, over a jump from its impulses (ns_march_impulse()): a charge Q that passes at
 * once takes (v' + v+)/2 Q, a flux F takes (i- + i+)/2 F.  v+, i+: after the jump; i-: before it; v': with
 * sources as after it, but the charges before it.  So energy taken in by all elements adds up to zero
 * (Tellegen), and what a capacitor or an inductor takes is what it stores.  How devices in series share the
 * loss of a jump is not determined by ideal laws; a diode that conducted and blocks at the very instant at
 * which a switch cuts its current may get a part below zero.  Units: V, A, W, C, J, s.
 */
#ifndef NONSMOOTH_ENERGY_H
#define NONSMOOTH_ENERGY_H

#include "nonsmooth/circuit.h"
#include "nonsmooth/march.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ns_energy ns_energy;

/* For so many elements of c, whose numbers are id (NULL: all, in their order; the array is copied), after
 * ns_circuit_system(); c must outlive it and must not change.  On failure *out is NULL.  Errors: NULL, SIZE
 * (no such element), MEMORY. */
int ns_energy_create(const ns_circuit *c, int count, const int *id, ns_energy **out);
void ns_energy_free(ns_energy *e);       /* NULL is allowed */
int ns_energy_count(const ns_energy *e); /* elements */

/* Power at the last point, charge and energy taken in since ns_energy_begin() of element id[k]; p, q, joule
 * may be NULL.  p of a capacitor: NAN where rates were not given.  Errors: NULL, SIZE (k). */
int ns_energy_read(const ns_energy *e, int k, double *p, double *q, double *joule);

/* --- along a marcher --- */

/* All is zero, from the start of m on, which was just made at t0 (s): with what jumped in it, from voltages
 * and currents that the initial conditions of c determine (others: 0) to those at t0.  Errors: NULL, MEMORY,
 * those of ns_march_read(). */
int ns_energy_start(ns_energy *e, ns_march *m);

/* The same where another marcher was, at x (n) and lambda (m): what jumps begins there.  lambda
 * may be NULL (0).  Errors: as ns_energy_start(). */
int ns_energy_start_from(ns_energy *e, ns_march *m, const double *x, const double *lambda);

/* The same from the accepted point of m on, of which no trial was made; nothing jumps there.  Errors: as
 * ns_energy_start(). */
int ns_energy_begin_at(ns_energy *e, ns_march *m);

/* Goes on to t with m (NS_TO_STEP, accepting each trial).  Over each of its ways by a rule of 15 nodes on
 * parts whose lengths double, each halved until the rule's error is below 1e-12 of what is integrated.  To be
 * called after ns_energy_start(), and m moved by no one else.  Errors: NULL, STATE, MEMORY, those of
 * ns_march_try(). */
int ns_energy_march(ns_energy *e, ns_march *m, double t);

/* For those who move m themselves: takes in the trial that m made last (NS_TO_STEP), before it is accepted:
 * up to t, in parts if t grows from call to call (a jump not before its end).  Every trial that is accepted
 * must have been taken in up to its end, once.  Errors: as ns_energy_march(). */
int ns_energy_take(ns_energy *e, ns_march *m, double t);

/* Points looked at so far. */
long ns_energy_nodes(const ns_energy *e);

/* --- by hand: points of any integrator --- */

/* All is zero; the first point.  Errors of these: NULL. */
int ns_energy_begin(ns_energy *e, const ns_solution *at);
/* A node of a rule of quadrature; its weight, s. */
int ns_energy_add(ns_energy *e, double seconds, const ns_solution *at);
/* A jump, with the integrals of x (n) and lambda (m) over it. */
int ns_energy_jump(ns_energy *e, const ns_solution *before, const ns_solution *after, const double *x,
                   const double *lambda);
/* The last point: what capacitors took in, and powers, are those up to it. */
int ns_energy_point(ns_energy *e, const ns_solution *at);

#ifdef __cplusplus
}
#endif
#endif
