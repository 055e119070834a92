/* bridge/own_mosfet_law.c - what the model of an M says of its channel, and of the charge of its gate. */
#include <math.h>

#include "own_mosfet.h"

double ns_bridge_own_gain(const ns_own_mosfet *m, double above) {
    return m->beta / (1.0 + m->theta * (above - m->bends_from));
}

double ns_bridge_own_overdrive(const ns_own_mosfet *m, double above) {
    const double v = above - m->shift;
    return m->slope > 0.0 && v < 30.0 * m->slope ? m->slope * log1p(exp(v / m->slope)) : v;
}

/* A: of a channel with so many volts (as mtriode counts them), at most those of saturation. */
static double current_at(const ns_own_mosfet *m, double above, double over, double volts) {
    const double critical = m->critical * (1.0 + m->theta * (above - m->bends_from));
    const double drifts = isinf(critical) ? over : over + critical - hypot(over, critical);
    const double v = fmin(volts, drifts);
    return ns_bridge_own_gain(m, above) * v * (over - 0.5 * v) / (1.0 + v / critical);
}

double ns_bridge_own_saturation(const ns_own_mosfet *m, double above) {
    return current_at(m, above, fmax(ns_bridge_own_overdrive(m, above), 0.0), INFINITY);
}

/* What ns_bridge_own_overdrive() makes `over` of. */
static double above_of(const ns_own_mosfet *m, double over) {
    const int is_weak = m->slope > 0.0 && over < 30.0 * m->slope;
    return m->shift + (is_weak ? m->slope * log(expm1(over / m->slope)) : over);
}

double ns_bridge_own_needs(const ns_own_mosfet *m, double amperes) {
    enum { ROUNDS = 4, WITH_DRIFT = 40 }; /* the gain hardly depends on what is sought */
    double above = 0.0, over = 0.0;
    for (int k = 0; k < (isinf(m->critical) ? ROUNDS : WITH_DRIFT); k++) {
        const double at = fmax(above, 0.0);
        const double gain =
            over > 0.0 ? 2.0 * current_at(m, at, over, INFINITY) / (over * over) : ns_bridge_own_gain(m, at);
        over = sqrt(2.0 * amperes / gain);
        above = above_of(m, over);
    }
    return above;
}

double ns_bridge_own_channel(const ns_own_mosfet *m, double above, double volts) {
    return current_at(m, above, fmax(ns_bridge_own_overdrive(m, above), 0.0), m->triode * volts);
}

double ns_bridge_own_resistance(const ns_own_mosfet *m, double above) {
    return m->series + 1.0 / (ns_bridge_own_gain(m, above) * m->triode * ns_bridge_own_overdrive(m, above));
}

double ns_bridge_own_gate_to_drain(const ns_own_mosfet *m, double v) {
    return m->charge.drain + m->charge.more / (1.0 + m->charge.bend * v);
}

double ns_bridge_own_late(const ns_own_mosfet *m, const ns_own_drive *drive, double volts, double *ohm) {
    const double opens_by = drive->opens + m->charge.ohm, closes_by = drive->closes + m->charge.ohm;
    const double low = m->vth - drive->low, high = drive->high - m->vth, bend = m->charge.bend;
    *ohm = 0.0;
    if (!(low > 0.0 && high > 0.0))
        return 0.0;
    const double all = m->charge.source + m->charge.drain + m->charge.more;
    const double swings =
        m->charge.drain * volts + (bend > 0.0 ? m->charge.more * (1.0 + log1p(bend * volts)) / bend : 0.0);
    const double opens = isnan(opens_by) ? 0.0 : opens_by * (all * log((low + high) / low) + swings / low);
    const double closes =
        isnan(closes_by) ? 0.0 : closes_by * (m->charge.source * log((low + high) / high) + swings / high);
    *ohm = opens > closes ? opens_by : closes_by;
    return opens - closes;
}
