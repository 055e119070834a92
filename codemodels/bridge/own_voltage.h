/* bridge/own_voltage.h - the voltage between two nodes, as sources drive it through V, R and E. */
#ifndef BRIDGE_OWN_VOLTAGE_H
#define BRIDGE_OWN_VOLTAGE_H

#include "own_way.h"

ns_own_find_voltage ns_bridge_own_find_voltage;

#endif
