/* src/circuit/branch.h - the voltage and the current of an element in terms of a solution.
 *
 *     v = x[p] - x[n]
 *     i = siemens v + farads dv/dt + amperes + signal(t) + sum of terms
 *
 * The impulses of x and lambda give those of v and i by the same terms, without amperes and signal.
 */
#ifndef NS_CIRCUIT_BRANCH_H
#define NS_CIRCUIT_BRANCH_H

#include "nonsmooth/circuit.h"

typedef struct ns_branch {
    int p, n; /* of x; -1: ground */
    double siemens, farads, amperes;
    const ns_signal *signal; /* A, owned by the circuit; NULL: none */
} ns_branch;

/* One term of a current: gain times x[index], or, from the number of unknowns on, times lambda. */
typedef void ns_branch_visit(void *to, int index, double gain);

/* The branch of element id, which must be one; visit gets its terms.  A coupling has neither voltage nor
 * current.  To be called after ns_circuit_system(). */
ns_branch ns_circuit_branch(const ns_circuit *c, int id, ns_branch_visit *visit, void *to);

/* Unknowns; pairs; elements. */
int ns_circuit_branch_unknowns(const ns_circuit *c);
int ns_circuit_branch_pairs(const ns_circuit *c);
int ns_circuit_branch_count(const ns_circuit *c);

static inline double ns_branch_voltage(const ns_branch *b, const double *x) {
    return (b->p < 0 ? 0 : x[b->p]) - (b->n < 0 ? 0 : x[b->n]);
}

#endif
