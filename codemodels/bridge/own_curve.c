/* bridge/own_curve.c - D that were taken, after .tran: were they far from their own curve? */
#include <math.h>

#include "own_show.h"
#include "own_structs.h"
#include "report.h"

/* A difference that counts, of the largest voltage across the D. */
static const double much = 0.05;

static int is_judged(const ns_analysis *a, const ns_own_taken *o) {
    return o->kind == OWN_DIODE && o->id >= 0 && !a->ex.options.zero_diodes;
}

void ns_bridge_own_count_point(const ns_analysis *a, double t) {
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_taken *o = &a->ex.own[k];
        double i, v;
        if (!is_judged(a, o) ||
            ns_circuit_device(a->ex.circuit, o->id, a->x, a->lambda, a->mode, &i, &v, NULL) != NS_OK)
            continue;
        ns_bridge_log_mean_add(&o->seen.current, 0.5 * (fmax(i, 0.0) + o->seen.i), t - o->seen.t);
        o->seen.t = t;
        o->seen.i = fmax(i, 0.0);
        o->seen.most_v = fmax(o->seen.most_v, fabs(v));
    }
}

static double own_current(const ns_own_taken *o) {
    return ns_bridge_log_mean_read(&o->seen.current);
}

/* V: the voltage of its own curve there, with rs; NAN: unknown. */
static double own_voltage(const ns_own_taken *o) {
    ns_own_diode d;
    ns_bridge_own_read_diode(o->inst, &d);
    return ns_bridge_diode_law_voltage(&d.law, own_current(o)) + o->rs * own_current(o);
}

static double taken_voltage(const ns_own_taken *o) {
    return o->diode.vf + o->diode.ron * own_current(o);
}

/* How far that is from what it was taken for, of the largest voltage across it. */
static double difference(const ns_analysis *a, const ns_own_taken *o) {
    if (!is_judged(a, o) || !(own_current(o) > 0.0))
        return 0.0;
    return fabs(taken_voltage(o) - own_voltage(o)) / o->seen.most_v;
}

int ns_bridge_own_note_curve(const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = much;
    for (int k = 0; k < a->ex.nowns; k++) {
        const double differs = difference(a, &a->ex.own[k]);
        if (!(differs > most))
            continue;
        most = differs;
        worst = &a->ex.own[k];
    }
    if (!worst)
        return 0;
    ns_bridge_report_note(
        "%s carried %.2g A, where its own voltage is %.3g V, not %.3g V: with id=%.1g in the "
        "model nonsmooth, vf is that of this current",
        worst->inst->GENname, own_current(worst), own_voltage(worst), taken_voltage(worst),
        own_current(worst));
    return 1;
}
