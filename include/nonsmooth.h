/* nonsmooth.h - ideal diodes and switches as complementarity systems: the whole public interface.
 *
 * Layers, each using only those above it:
 *   status.h   the status codes with their texts, and what a failed call reports
 *   mlcp.h     mixed linear complementarity problems (P1): no time, no circuit
 *   text.h     (P1) as plain text
 *   csc.h      a sparse matrix, column by column
 *   signal.h   sources as functions of time, with their corners
 *   system.h   complementarity systems (S1)-(S4)
 *   theta.h    one theta-gamma step (T1)(T6)(T7)(P1), tried and accepted
 *   impulse.h  the state after a jump (J1)-(J4)
 *   march.h    many steps: events located, jumps resolved, values on both sides of a jump
 *   waveform.h the points of a march between which waveforms are straight lines
 *   model.h    (S1)-(S4) with nonlinear f, g, h and their Jacobians
 *   newton.h   one theta-gamma step of a model, (T1)-(T5) around (P1)
 *   circuit.h  R, L, C, K, sources, ideal diodes and switches -> (S1)-(S4)
 *   energy.h   charge and energy that each element takes in over a run
 *
 * The library never prints, never exits, keeps no global state.  Matrices are dense, column by
 * column (entry (i,j) of a p-by-q matrix is at [i + j*p]), in SI units.  Functions that can fail
 * return an ns_status: 0 is success, positive means "try a smaller step", negative is an error.  The tags
 * (S1) to (J4) and (E1), (E2) are defined in src/README.md, a complete example is in include/README.md.
 */
#ifndef NONSMOOTH_H
#define NONSMOOTH_H

#include "nonsmooth/circuit.h"
#include "nonsmooth/csc.h"
#include "nonsmooth/energy.h"
#include "nonsmooth/impulse.h"
#include "nonsmooth/march.h"
#include "nonsmooth/mlcp.h"
#include "nonsmooth/model.h"
#include "nonsmooth/newton.h"
#include "nonsmooth/signal.h"
#include "nonsmooth/status.h"
#include "nonsmooth/system.h"
#include "nonsmooth/text.h"
#include "nonsmooth/theta.h"
#include "nonsmooth/waveform.h"

#endif
