/* tests/rig/dice_signals.h - random sources: corners within some 10 s, values of some V, many coincidences.
 */
#ifndef NONSMOOTH_TESTS_DICE_SIGNALS_H
#define NONSMOOTH_TESTS_DICE_SIGNALS_H

#include "dice.h"
#include "nonsmooth/signal.h"

enum { DICE_SIGNAL_ROOM = 12 };

double dice_value(dice *d);
ns_signal dice_line(dice *d, double *room); /* PULSE or PWL, whose points are in room (DICE_SIGNAL_ROOM) */
ns_signal dice_curve(dice *d);              /* SIN or EXP */

#endif
