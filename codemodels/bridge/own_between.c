/* bridge/own_between.c - switches with VON, VOFF (ION, IOFF) whose control is long between these.
 *
 * Their own model is a resistor of some value in between there; what was taken changes at once, in the
 * middle. That is no difference where the control comes through in little time. */
#include "own_between.h"

#include <math.h>

#include "extract_walk.h"
#include "models.h"
#include "report.h"

/* That part of the time is long; that part of the largest current or voltage is much. */
static const double is_long = 0.05, much = 0.05;

static double value_at(const ns_analysis *a, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? a->x[a->unknown[eq]] : 0.0;
}

/* The part of the straight line from one value of the control to another one that lies between on and off. */
static double part_between(const ns_own_taken *o, double from, double to) {
    const double low = fmin(o->between.on_at, o->between.off_at);
    const double high = fmax(o->between.on_at, o->between.off_at);
    const double within = fmin(fmax(from, to), high) - fmax(fmin(from, to), low);
    if (from == to)
        return from > low && from < high;
    return fmax(within, 0.0) / fabs(to - from);
}

/* ohm: what its own model is at a control. */
static double own_ohm(const ns_own_taken *o, double control) {
    const double part = (control - o->between.off_at) / (o->between.on_at - o->between.off_at);
    const double within = fmin(fmax(part, 0.0), 1.0), off = o->between.off, on = o->between.on;
    return o->between.by_logarithm ? off * pow(on / off, within) : off + within * (on - off);
}

/* 1 if that lets much through while the switch is open, or has much across it while the switch is closed. */
static int does_else(const ns_analysis *a, ns_own_taken *o, double control) {
    double i, v;
    int on;
    if (ns_circuit_device(a->ex.circuit, o->id, a->x, a->lambda, a->mode, &i, &v, &on) != NS_OK)
        return 0;
    o->between.most_i = fmax(o->between.most_i, fabs(i));
    o->between.most_v = fmax(o->between.most_v, fabs(v));
    return on ? fabs(i) * own_ohm(o, control) > much * o->between.most_v
              : fabs(v) / own_ohm(o, control) > much * o->between.most_i;
}

void ns_bridge_own_count_between(const ns_analysis *a, ns_own_taken *o, double seconds) {
    const double control = value_at(a, o->between.pos) - value_at(a, o->between.neg);
    const int counts = does_else(a, o, control);
    if (seconds > 0.0) {
        if (counts || o->between.counts)
            o->between.seconds += seconds * part_between(o, o->between.control, control);
        o->between.all += seconds;
    }
    o->between.control = control;
    o->between.counts = counts;
}

int ns_bridge_own_note_between(const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = is_long;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (o->kind != OWN_PSWITCH || !(o->between.seconds > most * o->between.all))
            continue;
        most = o->between.seconds / o->between.all;
        worst = o;
    }
    if (worst) {
        char name[EXTRACT_NAME];
        ns_bridge_models_own_name((const MIFinstance *)worst->inst, name, sizeof name);
        ns_bridge_report_note(
            "%s: its control was between %.4g and %.4g for %.2g of the time, where its own "
            "model is a resistor of some value in between; here it changes at once at %.4g, "
            "and the result may be another one",
            name, fmin(worst->between.on_at, worst->between.off_at),
            fmax(worst->between.on_at, worst->between.off_at), most, worst->vt);
    }
    return worst != NULL;
}
