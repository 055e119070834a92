/* tests/rig/systems.h - small systems written by hand, for the tests of the engines. */
#ifndef NONSMOOTH_TESTS_SYSTEMS_H
#define NONSMOOTH_TESTS_SYSTEMS_H

#include "nonsmooth.h"

/* C v' = -v/R, C = R = 1: one state, no pair. */
ns_system *system_decay(void);

/* The LC bridge in the form of the literature (two states, four pairs): x = (v, i), C = 1 uF, L = 10 mH,
 * R = 1 kohm;  C v' = -i - lambda3 + lambda4,  L i' = v;
 * lambda = (-v_DR1, -v_DF2, i_DF1, i_DR2),  y = (i_DR1, i_DF2, -v_DF1, -v_DR2).
 * The bridge makes R look like a plain resistor across the tank:
 *     v(t) = V0 e^(-at) (cos wt - (a/w) sin wt),  a = 1/(2RC) = 500/s,  w = sqrt(1/(LC) - a^2). */
ns_system *system_lc_bridge(void);
double lc_bridge_v(double v0, double t); /* v(t) with i(0) = 0 */

/* A sine source on node 1, a diode 1 -> 2, a load from 2 to ground; x = (v1, v2, current of the source).
 * Purely algebraic. */
ns_system *system_half_wave(double amplitude, double freq, double load);

#endif
