/* tests/stress/vary.h - a netlist -> another one of its kind.
 *
 * Every value is multiplied by a factor between 0.3 and 3: of a source its amplitude, its time and its edges,
 * of a model each parameter, of .tran its step.  Equal values of equal parameters keep one factor in half of
 * the circuits, so that ties stay ties.  One circuit in three has a second copy with other values, which a
 * resistor joins.  Lines are shuffled, nodes and parts have other names.
 */
#ifndef NONSMOOTH_TESTS_VARY_H
#define NONSMOOTH_TESTS_VARY_H

#include "netlist.h"

/* *to is empty.  The same number makes the same circuit. */
void vary(const netlist *from, unsigned long long number, netlist *to);

#endif
