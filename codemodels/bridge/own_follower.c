/* bridge/own_follower.c - the lines that stand for the square law of an M that is a source follower, or whose
 * drain holds its gate while it swings.
 *
 * Its gate is driven against ground, so v(gate,source) is what its current needs.  With v(gate,drain) = vth +
 * e and v(drain,source) = v its current is beta ((e + v) v - v^2/2) = beta (e v + v^2/2): at e = 0, where an
 * ohmic channel has no slope at all, v is sqrt(2 i/beta).  Below that it saturates: its source is where its
 * gate is, less vth and sqrt(2 i/beta). */
#include "own_follower.h"

#include <math.h>

/* V, at a current (A). */
typedef double law(const ns_own_taken *o, double amperes);

static double needed_voltage(const ns_own_taken *o, double amperes) {
    return ns_bridge_own_needs(&o->mosfet, amperes);
}

double ns_bridge_own_closed_voltage(const ns_own_mosfet *m, double beyond, double amperes) {
    enum { HALVINGS = 60, DOUBLINGS = 60 };
    double low = 0.0, high = 1e-6;
    for (int k = 0; k < DOUBLINGS && ns_bridge_own_channel(m, beyond + high, high) < amperes; k++)
        high *= 2.0;
    for (int k = 0; k < HALVINGS; k++) {
        const double middle = 0.5 * (low + high);
        if (ns_bridge_own_channel(m, beyond + middle, middle) < amperes)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* At v(gate,drain) of its drive. */
static double closed_voltage(const ns_own_taken *o, double amperes) {
    return ns_bridge_own_closed_voltage(&o->mosfet, o->drive - o->mosfet.vth, amperes);
}

/* The tangent of a law at the current that was found, or a flatter line, as that of a D. */
static ns_own_line line_of(const ns_own_taken *o, law *of, const ns_own_current *found) {
    static const double part = 1e-3; /* of the current */
    const double at = found->id, volts = of(o, at);
    const double slope = (of(o, (1.0 + part) * at) - of(o, (1.0 - part) * at)) / (2.0 * part * at);
    const ns_line_ends ends = {found->most, found->rush, found->blocks};
    const double ohm = ns_bridge_line_slope(slope, volts, of(o, ends.most), of(o, ends.rush), at, &ends);
    return (ns_own_line){at, volts - ohm * at, ohm};
}

/* From 0 V to its voltage at a current that is a guess. */
static ns_own_line guess_of(const ns_own_taken *o, double amperes) {
    return (ns_own_line){0.0, 0.0, closed_voltage(o, amperes) / amperes};
}

/* In a first pass: from 0 V to a part of its drive, and the current there.  A gate that needs nothing beyond
 * vth would have two M of a bridge carry what their supply gives while one of them opens, and a loop over it
 * be endlessly steep. */
static ns_own_line needs_of_guess(const ns_own_taken *o) {
    static const double part = 0.3, least = 0.1; /* V, the least one */
    const double above = o->mosfet.shift + fmax(part * (o->drive - o->mosfet.vth), least);
    const double amperes = ns_bridge_own_saturation(&o->mosfet, above);
    return amperes > 0.0 ? (ns_own_line){amperes, 0.0, fabs(above) / amperes} : (ns_own_line){0};
}

/* What its gate needs beyond vth. */
static ns_own_line needs_of(const ns_extract_walk *w, const ns_own_taken *o, const ns_own_current *found) {
    if (found)
        return line_of(o, needed_voltage, found);
    return w->found && w->found->is_first ? needs_of_guess(o) : (ns_own_line){0};
}

double ns_bridge_own_ohmic(const ns_own_taken *o) {
    static const double open_above = 1.0; /* V: of one whose gate rests below vth, and which never closes */
    const double above = o->drive - o->mosfet.vth;
    return ns_bridge_own_resistance(&o->mosfet, above > 0.0 ? above : open_above);
}

void ns_bridge_own_find_lines(ns_extract_walk *w, const GENinstance *inst, ns_own_taken *taken) {
    const ns_bridge_options *o = &w->ex->options;
    const ns_own_mosfet *m = &taken->mosfet;
    const int known = !o->zero_diodes && isnan(o->id);
    const ns_own_current *found = known ? ns_bridge_own_found(w, inst, OWN_CHANNEL) : NULL;
    taken->ron = ns_bridge_own_ohmic(taken);
    if (o->zero_diodes || !ns_bridge_own_saturates(taken))
        return;
    if (taken->follows == FOLLOWS_AND_CLOSES) {
        taken->closed = found ? line_of(taken, closed_voltage, found)
                              : guess_of(taken, isnan(o->id) ? NS_OWN_CURRENT : o->id);
        taken->ron = m->series + taken->closed.ohm;
    }
    if (known && taken->ron > 0.0)
        taken->overdrive = needs_of(w, taken, found);
    ns_bridge_extract_mix(w, &taken->closed, sizeof taken->closed);
    ns_bridge_extract_mix(w, &taken->overdrive, sizeof taken->overdrive);
}
