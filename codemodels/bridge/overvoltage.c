/* bridge/overvoltage.c - a switch that interrupts a coil's current into its roff: that current times roff is
 * its voltage, as a real one would not have it.  Right as it is, but hardly what was meant. */
#include "overvoltage.h"

#include <math.h>
#include <stdlib.h>

#include "models.h"
#include "pure/source_compare.h"
#include "report.h"
#include "sources.h"

/* V; and times all that sources give: beyond both nothing is meant. */
static const double too_much = 1e5, times_sources = 1e4;

static double sum_of_sources(const CKTcircuit *ckt) {
    double sum = 0.0;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const char letter = ns_bridge_models_letter(box->data);
        ns_signal z;
        double *points;
        if ((letter != 'v' && letter != 'i') || ns_bridge_sources_signal(ckt, box->data, 0, &z, &points))
            continue;
        sum += ns_bridge_source_size(&z);
        free(points);
    }
    return sum;
}

/* V: the largest voltage of a node so far. */
static double most_at(const ns_analysis *a, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? a->max_abs[a->unknown[eq]] : 0.0;
}

/* More than *most at node p or n of inst. */
static void look_at(const ns_analysis *a, const GENinstance *inst, int p, int n, double *most,
                    const GENinstance **found) {
    const double volts = fmax(most_at(a, p), most_at(a, n));
    if (!(volts > *most))
        return;
    *most = volts;
    *found = inst;
}

int ns_bridge_overvoltage_note(const CKTcircuit *ckt, const ns_analysis *a) {
    const GENinstance *found = NULL;
    const double sources = sum_of_sources(ckt);
    double most = fmax(too_much, times_sources * sources);
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (o->kind == OWN_SWITCH || o->kind == OWN_CURRENT_SWITCH)
            look_at(a, o->inst, o->sw.p, o->sw.n, &most, &found);
        else if (o->kind == OWN_MOSFET)
            look_at(a, o->inst, o->mosfet.drain, o->mosfet.source, &most, &found);
    }
    for (int k = 0; k < a->ex.ndevices; k++) {
        const MIFinstance *inst = a->ex.device[k].inst;
        if (ns_bridge_models_kind(&inst->gen) == KIND_SWITCH)
            look_at(a, &inst->gen, ns_bridge_models_node(inst, SWITCH_P),
                    ns_bridge_models_node(inst, SWITCH_N), &most, &found);
    }
    if (found)
        ns_bridge_report_note(
            "%s: %.2g V at one of its nodes, where sources give %.3g V at most: its roff carries "
            "the current of a coil that it interrupts; give that another path, as a D or "
            "R and C in series across it",
            found->GENname, most, sources);
    return found != NULL;
}
