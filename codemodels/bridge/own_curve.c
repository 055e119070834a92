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

void ns_bridge_own_count_point(const ns_analysis *a) {
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_taken *o = &a->ex.own[k];
        double i, v;
        if (!is_judged(a, o) ||
            ns_circuit_device(a->ex.circuit, o->id, a->x, a->lambda, a->mode, &i, &v, NULL) != NS_OK)
            continue;
        o->most_i = fmax(o->most_i, i);
        o->most_v = fmax(o->most_v, fabs(v));
    }
}

/* V: the voltage of its own curve at its largest current, with rs. */
static double own_voltage(const ns_own_taken *o) {
    ns_own_diode d;
    ns_bridge_own_read_diode(o->inst, &d);
    return ns_bridge_diode_law_voltage(&d.law, o->most_i) + o->rs * o->most_i;
}

/* How far that is from what it was taken for, of the largest voltage across it; below the current at which
 * its curve was read. */
static double difference(const ns_analysis *a, const ns_own_taken *o) {
    if (!is_judged(a, o) || !(o->most_i > 0.0 && o->most_i < a->ex.options.id))
        return 0.0;
    return fabs(o->diode.vf + o->diode.ron * o->most_i - own_voltage(o)) / o->most_v;
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
        "%s carried %.2g A at most, where its own voltage is %.3g V, not %.3g V: with id=%.1g in the model "
        "nonsmooth, vf is that of a smaller current",
        worst->inst->GENname, worst->most_i, own_voltage(worst),
        worst->diode.vf + worst->diode.ron * worst->most_i, worst->most_i);
    return 1;
}
