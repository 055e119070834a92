/* bridge/own_stored.c - the charge that the transit time of a D, or of an M's body diode, would hold, which
 * is left out.
 *
 * Where the current of the D ends it would flow back.  That is much where it is a good part of what the D
 * carries, and no trifle beside all that flows; or where the voltage that turns the D off moves it, as the
 * source of a hard-switched converter does, which has to supply it. */
#include "own_stored.h"

#include <math.h>

#include "report.h"
#include "versions.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

/* Of the charge that the D carries, and of the energy that V supply. */
static const double much = 0.05;
/* Of the charge of the largest current: less than that is a trifle. */
static const double trifle = 1e-5;

static double value_at(const ns_analysis *a, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? a->x[a->unknown[eq]] : 0.0;
}

ns_own_flow ns_bridge_own_flow(const CKTcircuit *ckt, const ns_analysis *a) {
    ns_own_flow flow = {0.0, 0.0};
    int stores = 0, idle = 0;
    for (int k = 0; k < a->ex.nowns; k++) {
        stores |= a->ex.own[k].tt > 0.0;
        idle |= a->ex.own[k].kind == OWN_DIODE && a->ex.own[k].seen.current.weight == 0.0;
    }
    for (int eq = 0; (stores || idle || !a->ex.options.cjo) && eq < a->ex.neq; eq++) {
        const double amperes = a->ex.element[eq] >= 0 ? fabs(value_at(a, eq)) : 0.0;
        flow.amperes = amperes > flow.amperes ? amperes : flow.amperes;
    }
    for (const GENmodel *model = stores ? ckt->CKThead[TYPE_VSRC] : NULL; model; model = model->GENnextModel)
        for (const GENinstance *inst = model->GENinstances; inst; inst = inst->GENnextInstance) {
            const VSRCinstance *v = (const VSRCinstance *)inst;
            flow.watts +=
                fmax((value_at(a, v->VSRCnegNode) - value_at(a, v->VSRCposNode)) * value_at(a, v->VSRCbranch),
                     0.0);
        }
    return flow;
}

/* The charge q that its transit time holds, by dq/dt = i - q/tt, of i in the mean since the point before;
 * what is there where its current ends flows back, against -v. */
static void count_stored(ns_own_taken *o, const ns_own_flow *flow, double i, double v, double seconds) {
    const double mean = 0.5 * (fmax(i, 0.0) + o->seen.through), rests = o->tt * mean;
    o->seen.carried += seconds * mean;
    o->seen.supplied += seconds * flow->watts;
    o->seen.flows += seconds * flow->amperes;
    if (mean != 0.0 || o->seen.held != 0.0)
        o->seen.held = rests + (o->seen.held - rests) * exp(-seconds / o->tt);
    if (i > NS_LEAK)
        return;
    o->seen.stored += o->seen.through > NS_LEAK ? o->seen.held : 0.0;
    o->seen.spent += o->seen.through > NS_LEAK ? o->seen.held * fmax(-v, 0.0) : 0.0;
    o->seen.held = 0.0;
}

void ns_bridge_own_count_stored(const ns_analysis *a, ns_own_taken *o, const ns_own_flow *flow, double i,
                                double v, double seconds) {
    if (!(o->tt > 0.0) || (o->kind == OWN_MOSFET && ns_circuit_device(a->ex.circuit, o->body, a->x, a->lambda,
                                                                      a->mode, &i, &v, NULL) != NS_OK))
        return;
    if (seconds >= 0.0)
        count_stored(o, flow, i, v, seconds);
    o->seen.through = fmax(i, 0.0);
}

/* 0.0: it is a trifle, or of a body diode, which carries little where its channel does. */
static double part_of_carried(const ns_own_taken *o) {
    if (o->kind == OWN_MOSFET)
        return 0.0;
    return o->seen.stored > trifle * o->seen.flows ? o->seen.stored / o->seen.carried : 0.0;
}

static double part_of_supplied(const ns_own_taken *o) {
    return o->seen.supplied > 0.0 ? o->seen.spent / o->seen.supplied : 0.0;
}

int ns_bridge_own_note_stored(const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = much;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (!(o->tt > 0.0) || o->id < 0 || a->ex.options.zero_diodes || !(o->seen.carried > 0.0))
            continue;
        const double part = fmax(part_of_carried(o), part_of_supplied(o));
        if (!(part > most))
            continue;
        most = part;
        worst = o;
    }
    if (worst && part_of_carried(worst) < most)
        ns_bridge_report_note(
            "%s: %s tt = %.3g s is left out: by that, the charge that would flow back when "
            "it turns off takes some %.2g of the energy that sources supply, and the result "
            "may be another one",
            worst->inst->GENname, worst->kind == OWN_MOSFET ? "its body diode's" : "its", worst->tt, most);
    else if (worst)
        ns_bridge_report_note(
            "%s: its tt = %.3g s is left out: by that, some %.2g of the charge that it carries "
            "would flow back when it turns off, and the result may be another one",
            worst->inst->GENname, worst->tt, most);
    return worst != NULL;
}
