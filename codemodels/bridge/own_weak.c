/* bridge/own_weak.c - M whose gate comes slowly through what its own channel conducts at below vto.
 *
 * In weak inversion (ksubthres of a VDMOS, 0.1 V if it is not given) a channel carries a current from some
 * tenths of a volt below vto on. As a switch it changes at vto. That is no difference where the gate comes
 * through in little time. */
#include "own_weak.h"

#include <math.h>

#include "report.h"

/* That part of the time is long. */
static const double is_long = 0.005;

/* Of the drive beyond the threshold. */
static const double at_threshold = 1e-3;

/* V: how far below vto its own channel carries the largest current since it closed; 0: it does not. */
static double volts_below(const ns_own_taken *o) {
    return o->weak.most > NS_LEAK ? fmax(-ns_bridge_own_needs(&o->mosfet, o->weak.most), 0.0) : 0.0;
}

/* s: for how long v(gate,source) is in these, if it moves by so many V/s. */
static double time_below(const ns_own_taken *o, double rate) {
    return rate > 0.0 ? volts_below(o) / rate : 0.0;
}

/* V: as near to it a point is a side of an event at vto. */
static double beside(const ns_own_taken *o) {
    return at_threshold * (o->drive - o->mosfet.vth);
}

/* V/s: at which v(gate,source) comes to this point from the one before, or came to that one, where both are
 * sides of the event at vto. */
static double rate_of(const ns_own_taken *o, double above, double seconds) {
    const double by = above - o->seen.above;
    if (fabs(above) < beside(o) && fabs(o->seen.above) < beside(o))
        return o->weak.rate;
    return seconds > 0.0 ? by / seconds : copysign(INFINITY, by); /* it jumps */
}

static void add(ns_own_taken *o, double rate) {
    const double seconds = time_below(o, rate);
    if (seconds > o->weak.longest) {
        o->weak.longest = seconds;
        o->weak.volts = volts_below(o);
        o->weak.amperes = o->weak.most;
    }
    o->weak.seconds += seconds;
}

void ns_bridge_own_count_weak(ns_own_taken *o, double i, double above, double seconds) {
    const int was_closed = o->seen.above > 0.0, is_closed = above > 0.0;
    if (o->follows || !(o->mosfet.slope > 0.0))
        return;
    if (is_closed && !was_closed) {
        o->weak.rate = rate_of(o, above, seconds);
        o->weak.most = 0.0;
    }
    if (is_closed)
        o->weak.most = fmax(o->weak.most, i);
    if (!is_closed && was_closed) {
        add(o, o->weak.rate);
        o->weak.opened = above > -beside(o);
        o->weak.rate = 0.0;
    } else if (!is_closed && seconds > 0.0) {
        o->weak.rate = rate_of(o, above, seconds);
        if (o->weak.opened)
            add(o, -o->weak.rate);
        o->weak.opened = o->weak.opened && above > -beside(o);
    }
    o->weak.all += seconds;
}

int ns_bridge_own_note_weak(const ns_analysis *a) {
    ns_own_taken worst = {0};
    double most = is_long;
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_taken o = a->ex.own[k];
        if (o.kind == OWN_MOSFET && o.seen.above > 0.0) /* it is closed at the end */
            add(&o, o.weak.rate);
        if (o.kind != OWN_MOSFET || !(o.weak.seconds > most * o.weak.all))
            continue;
        most = o.weak.seconds / o.weak.all;
        worst = o;
    }
    if (worst.inst)
        ns_bridge_report_note(
            "%s: its own model carries its %.2g A from %.2g V below vto on (ksubthres), and its gate was "
            "between these for %.2g of the time; here it changes at vto, and the result may be another one: "
            "with vto "
            "lower by that in its model it changes there",
            worst.inst->GENname, worst.weak.amperes, worst.weak.volts, most);
    return worst.inst != NULL;
}
