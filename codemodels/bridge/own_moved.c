/* bridge/own_moved.c - the charge that the capacitance of a D's junction moves back and forth, which is left
 * out.
 *
 * It is much where it is a good part of what the D carries, as in a small rectifier at a high frequency, and
 * both are no trifle beside all that flows. */
#include "own_moved.h"

#include <math.h>

#include "report.h"

/* Of the charge that the D carries; of that of the largest current: less is a trifle. */
static const double much = 0.1, trifle = 0.02;
/* Of the largest voltage across it: it did not change. */
static const double alike = 1e-3;

/* C: of the junction at v, V, forwards; that of a D that conducts is not its junction's. */
static double charge_at(const ns_own_taken *o, double v) {
    const double backwards = fmax(-v, 0.0);
    ns_own_diode d;
    ns_bridge_own_read_diode(o->inst, &d);
    const double power = 1.0 - d.grading;
    if (!(d.built_in > 0.0) || power == 0.0)
        return d.farads * backwards;
    return d.farads * d.built_in / power * (pow(1.0 + backwards / d.built_in, power) - 1.0);
}

void ns_bridge_own_count_moved(const ns_analysis *a, ns_own_taken *o, const ns_own_flow *flow, double mean,
                               double v, double seconds) {
    const double step = v - o->moved.v;
    if (o->kind != OWN_DIODE || a->ex.options.cjo)
        return;
    if (seconds > 0.0) {
        o->moved.carried += seconds * mean;
        o->moved.beside += seconds * flow->amperes;
    }
    if (!(fabs(step) > alike * o->seen.most_v))
        return;
    if (step * o->moved.way < 0.0) { /* it turned at the point before */
        const double there = charge_at(o, o->moved.v);
        o->moved.charge += fabs(there - o->moved.turned);
        o->moved.turned = there;
    }
    o->moved.way = step > 0.0 ? 1 : -1;
    o->moved.v = v;
}

/* What moves one way, of what it carries. */
static double part_moved(const ns_own_taken *o) {
    const double one_way = 0.5 * o->moved.charge, least = trifle * o->moved.beside;
    return one_way > least && o->moved.carried > least ? one_way / o->moved.carried : 0.0;
}

int ns_bridge_own_note_moved(const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = much;
    for (int k = 0; k < a->ex.nowns; k++) {
        const double part = part_moved(&a->ex.own[k]);
        if (!(part > most))
            continue;
        most = part;
        worst = &a->ex.own[k];
    }
    if (worst)
        ns_bridge_report_note("%s: the capacitance of its junction is left out: that would carry %.2g of the "
                              "charge that the diode carries to and fro, and the result may be another one: "
                              "the option cjo=1 takes that at 0 V",
                              worst->inst->GENname, most);
    return worst != NULL;
}
