/* bridge/own_between.c - switches with VON, VOFF (ION, IOFF) whose control is long between these.
 *
 * Their own model is a resistor of some value in between there; what was taken changes at once, in the
 * middle. That is no difference where the control comes through in little time. */
#include "own_between.h"

#include <math.h>

#include "own_models.h"
#include "report.h"

/* That part of the time is long. */
static const double much = 0.05;

static double value_at(const ns_analysis *a, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? a->x[a->unknown[eq]] : 0.0;
}

/* The part of the straight line from one value to another one that lies between `low` and `high`. */
static double part_between(double from, double to, double low, double high) {
    const double within = fmin(fmax(from, to), high) - fmax(fmin(from, to), low);
    if (from == to)
        return from > low && from < high;
    return fmax(within, 0.0) / fabs(to - from);
}

void ns_bridge_own_count_between(const ns_analysis *a, ns_own_taken *o, double seconds) {
    const double control = value_at(a, o->between.pos) - value_at(a, o->between.neg);
    if (seconds > 0.0) {
        o->between.seconds +=
            seconds * part_between(o->between.control, control, o->between.low, o->between.high);
        o->between.all += seconds;
    }
    o->between.control = control;
}

int ns_bridge_own_note_between(const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = much;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (o->kind != OWN_PSWITCH || !(o->between.seconds > most * o->between.all))
            continue;
        most = o->between.seconds / o->between.all;
        worst = o;
    }
    if (worst) {
        char name[EXTRACT_NAME];
        ns_bridge_own_models_name((const MIFinstance *)worst->inst, name, sizeof name);
        ns_bridge_report_note(
            "%s: its control was between %.4g and %.4g for %.2g of the time, where its own "
            "model is a resistor of some value in between; here it changes at once at %.4g, "
            "and the result may be another one",
            name, worst->between.low, worst->between.high, most, worst->vt);
    }
    return worst != NULL;
}
