/* tests/rig/dice_signals.c - see dice_signals.h. */
#include "dice_signals.h"

#include <math.h>

enum { POINTS = DICE_SIGNAL_ROOM / 2 };

static double dice_time(dice *d) { /* a multiple of 1/8 as often as not: coincidences */
    return dice_chance(d, 0.5) ? (1 + dice_below(d, 40)) / 8.0 : 5 * dice_uniform(d) + 0.05;
}

double dice_value(dice *d) {
    return dice_chance(d, 0.5) ? dice_eighths(d, 2) : 2 * dice_either(d);
}

static ns_signal a_pulse(dice *d) {
    ns_signal s = {.kind = NS_PULSE};
    const double per = 1 + dice_time(d);
    s.u.pulse.v1 = dice_value(d);
    s.u.pulse.v2 = dice_value(d);
    s.u.pulse.td = dice_chance(d, 0.3) ? 0 : dice_time(d) - 1;
    s.u.pulse.tr = dice_chance(d, 0.3) ? 0 : dice_time(d) / 4;
    s.u.pulse.tf = dice_chance(d, 0.3) ? 0 : dice_time(d) / 4;
    s.u.pulse.pw = dice_chance(d, 0.2) ? 0 : dice_time(d) / 3;
    s.u.pulse.per = dice_chance(d, 0.2) ? INFINITY : per;
    s.u.pulse.cycles = dice_chance(d, 0.2) ? 1 + dice_below(d, 4) : 0;
    return s;
}

static ns_signal a_pwl(dice *d, double *room) {
    double *t = room, *v = room + POINTS;
    ns_signal s = {.kind = NS_PWL};
    const int n = 1 + dice_below(d, POINTS);
    t[0] = dice_chance(d, 0.5) ? 0 : dice_time(d) - 1;
    for (int i = 0; i < n; i++) {
        v[i] = dice_value(d);
        if (i > 0)
            t[i] = t[i - 1] + (dice_chance(d, 0.2) ? 0 : dice_time(d));
    }
    s.u.pwl.n = n;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    const int back = dice_below(d, n);
    if (t[back] < t[n - 1] - 0.5 && dice_chance(d, 0.5))
        s.u.pwl.repeat = t[back];
    s.u.pwl.td = dice_chance(d, 0.5) ? 0 : dice_time(d);
    return s;
}

ns_signal dice_curve(dice *d) {
    if (dice_chance(d, 0.6))
        return (ns_signal){.kind = NS_SIN,
                           .u.sin = {dice_value(d), dice_value(d), 2 * dice_either(d), dice_time(d) - 1,
                                     dice_chance(d, 0.5) ? 0 : 0.1 * dice_either(d), 360 * dice_either(d)}};
    const double td1 = dice_time(d) - 0.5;
    return (ns_signal){.kind = NS_EXP,
                       .u.exp = {dice_value(d), dice_value(d), td1, dice_time(d),
                                 td1 + (dice_chance(d, 0.9) ? dice_time(d) : -0.25), dice_time(d)}};
}

ns_signal dice_line(dice *d, double *room) {
    return dice_chance(d, 0.5) ? a_pulse(d) : a_pwl(d, room);
}
