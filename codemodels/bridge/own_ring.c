/* bridge/own_ring.c - the capacitance of junctions, which is left out, where it would ring with a coil.
 *
 * Where the current of a D comes to zero by itself, as that of a converter in discontinuous mode, the voltage
 * across the coil V = L di/dt goes to zero, and the junctions that have to follow it take 1/2 C V^2 from the
 * coil: a ring of V sqrt(C/L) = sqrt(C V di/dt).  The next pulse begins with a part of that. */
#include "own_ring.h"

#include <math.h>

#include "report.h"

#include "spicelib/devices/ind/inddefs.h"

/* Of the peak of a pulse. */
static const double much = 0.03;

/* Of the charge that the busiest D carries: what one of less ends, as a clamp, hardly matters. */
static const double trifle = 0.1;

/* Of the largest jump of a D: one that jumps by less does not ring, another one took its current over. */
static const double of_others = 0.1;

/* Of the peak of a pulse: a coil of less current carries none. */
static const double at_rest = 1e-3;

/* Of the duration of a pulse: a current that takes longer for its second half ends by itself, not because
 * a switch takes it over; and so long after its end the voltages of the ideal circuit have changed. */
static const double by_itself = 0.1, at_once = 1e-3;

static double farads_of(const ns_own_taken *o) {
    const double v = fabs(o->seen.v);
    ns_own_diode d;
    if (o->kind == OWN_MOSFET)
        return ns_bridge_own_junction(&o->mosfet.body, v) + ns_bridge_own_gate_to_drain(&o->mosfet, v);
    if (o->kind != OWN_DIODE)
        return 0.0;
    ns_bridge_own_read_diode(o->inst, &d);
    return ns_bridge_own_junction(&d, v);
}

/* All voltages before the jump: those of this point if its D has none yet, else of the point before. */
static void mark_all(ns_analysis *a, const ns_own_taken *ended) {
    const int is_before = fabs(ended->seen.v) < 0.01 * ended->seen.most_v;
    for (int k = 0; k < a->ex.nowns; k++)
        a->ex.own[k].ring.mark = is_before ? a->ex.own[k].seen.v : a->ex.own[k].ring.v;
}

/* 1 if a coil carries no current any more: with that it rings. */
static int has_coil_at_rest(const CKTcircuit *ckt, const ns_analysis *a, double most) {
    const GENmodel *model = a->ex.inductors >= 0 ? ckt->CKThead[a->ex.inductors] : NULL;
    for (; model; model = model->GENnextModel)
        for (const GENinstance *inst = model->GENinstances; inst; inst = inst->GENnextInstance) {
            const int at = a->unknown[((const INDinstance *)inst)->INDbrEq];
            if (at >= 0 && fabs(a->x[at]) < at_rest * most)
                return 1;
        }
    return 0;
}

/* What rings, with the voltages of this point. */
static void read_jump(const CKTcircuit *ckt, ns_analysis *a) {
    const ns_own_taken *ended = &a->ex.own[a->ring.own - 1];
    const double volts = fabs(ended->seen.v - ended->ring.mark);
    double sum = 0.0, most = 0.0;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        const double jump = o->seen.v - o->ring.mark;
        most = fmax(most, o->kind == OWN_DIODE ? fabs(jump) : 0.0);
        sum += o->seen.i > NS_LEAK ? 0.0 : farads_of(o) * jump * jump;
    }
    if (!(volts > a->ring.volts && volts > of_others * most) || !has_coil_at_rest(ckt, a, ended->ring.most))
        return;
    a->ring.volts = volts;
    a->ring.farads = sum / (volts * volts);
    a->ring.amperes = sqrt(a->ring.slope * a->ring.farads * volts);
}

static void add_ring(ns_analysis *a) {
    ns_own_taken *o = a->ring.own ? &a->ex.own[a->ring.own - 1] : NULL;
    if (o) {
        o->ring.rings += a->ring.amperes;
        o->ring.farads = fmax(o->ring.farads, a->ring.farads);
    }
    a->ring.own = 0;
}

static void end_pulse(ns_analysis *a, int k, double t) {
    ns_own_taken *o = &a->ex.own[k];
    const double second_half = t - o->ring.half, all = t - o->ring.began;
    o->ring.is_on = 0;
    o->ring.peaks += o->ring.most;
    if (!(second_half > by_itself * all))
        return;
    add_ring(a);
    a->ring.own = k + 1;
    a->ring.until = t + at_once * all;
    a->ring.slope = o->ring.at_half / second_half;
    a->ring.volts = a->ring.amperes = a->ring.farads = 0.0;
    mark_all(a, o);
}

/* Of a D: its pulse begins, goes on or ends. */
static void follow_pulse(ns_analysis *a, int k, double t) {
    ns_own_taken *o = &a->ex.own[k];
    const double i = o->seen.i;
    o->ring.charge += o->ring.is_on ? (t - o->ring.t) * i : 0.0;
    o->ring.t = t;
    if (i > NS_LEAK && !o->ring.is_on) {
        o->ring.began = t;
        o->ring.most = 0.0;
        o->ring.is_on = 1;
    }
    o->ring.most = i > o->ring.most ? i : o->ring.most;
    if (i > NS_LEAK && i >= 0.5 * o->ring.most) {
        o->ring.half = t;
        o->ring.at_half = i;
    }
    if (i <= NS_LEAK && o->ring.is_on)
        end_pulse(a, k, t);
}

void ns_bridge_own_count_ring(const CKTcircuit *ckt, ns_analysis *a, double t, int follows) {
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_taken *o = &a->ex.own[k];
        o->ring.is_on &= follows;
        if (o->kind == OWN_DIODE && o->id >= 0)
            follow_pulse(a, k, t);
    }
    if (a->ring.own && t <= a->ring.until && follows)
        read_jump(ckt, a);
    else if (a->ring.own)
        add_ring(a);
    for (int k = 0; k < a->ex.nowns; k++)
        a->ex.own[k].ring.v = a->ex.own[k].seen.v;
}

int ns_bridge_own_note_ring(const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = much, busiest = 0.0;
    for (int k = 0; k < a->ex.nowns; k++)
        busiest = fmax(busiest, a->ex.own[k].ring.charge);
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        const double part = o->ring.peaks > 0.0 ? 2.0 * o->ring.rings / o->ring.peaks : 0.0;
        if (!(part > most) || o->ring.charge < trifle * busiest)
            continue;
        most = part;
        worst = o;
    }
    if (worst)
        ns_bridge_report_note(
            "%s: when its current has come to zero, the capacitance of the junctions there, which is left "
            "out, would ring, and the charge of the next pulse be up to %.2g of it more or less: a C of "
            "%.2g F in parallel with %s stands for it",
            worst->inst->GENname, most, worst->ring.farads, worst->inst->GENname);
    return worst != NULL;
}
