/* tests/rig/hysteretic_pump.h - 10 V charge C1 = 2 nF through R1; a diode leads from there to C2 = 120 nF
 * with R2 across it.  A switch with thresholds of 0.5 and 0.6 V of C2 discharges C1.  As it opens, at 0.5 V,
 * C1 is charged to 0.5 V before the diode conducts: C2 is never below 0.5 V.
 */
#ifndef HYSTERETIC_PUMP_H
#define HYSTERETIC_PUMP_H

#include "rig.h"
#include "signals.h"

enum { PUMP_FED = 1, PUMP_OUT = 2, PUMP_SUPPLY = 3 };

/* C1 from its node to `other`: ground, or the supply. */
static inline rig build_pump(double r1, double r2, int other, int *diode) {
    const ns_switch contact = {.vt = 0.55, .vh = 0.05, .ron = 0, .roff = INFINITY};
    const ns_diode d = {.vf = 0, .ron = 0, .roff = INFINITY, .vz = INFINITY};
    const ns_signal supply = dc(10);
    rig k = begin();
    assert_int_equal(ns_circuit_source(k.c, "v1", NS_VOLTAGE, PUMP_SUPPLY, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", PUMP_SUPPLY, PUMP_FED, r1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", PUMP_FED, other, 2e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "as1", PUMP_FED, 0, PUMP_OUT, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "ad1", PUMP_FED, PUMP_OUT, &d, diode), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", PUMP_OUT, 0, 120e-9, 0.55, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", PUMP_OUT, 0, r2, NULL), NS_OK);
    return k;
}

static inline double pump_voltage(const rig *k, int node) {
    return k->x[ns_circuit_node_unknown(k->c, node)];
}

#endif
