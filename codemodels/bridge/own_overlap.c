/* bridge/own_overlap.c - two M in series of which one closes while the charge of the other one's gate, which
 * is left out, would still have that closed: a half bridge without a dead time. */
#include "own_overlap.h"

#include <math.h>

#include "own_touch.h"
#include "report.h"

/* Of the charge that an M carries: what flows through both counts. */
static const double much = 0.02;

int ns_bridge_own_in_series(const ns_own_mosfet *m, const ns_own_mosfet *n) {
    return n->drain == m->source || n->source == m->drain || (n->drain == m->drain && n->sign != m->sign);
}

/* 1 if a D, or a D and an R in series, takes the charge of its gate away, past the resistance that it is
 * given by. */
static int has_diode_off(const CKTcircuit *ckt, const ns_analysis *a, const ns_own_mosfet *m) {
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_diode d;
        if (a->ex.own[k].kind != OWN_DIODE)
            continue;
        ns_bridge_own_read_diode(a->ex.own[k].inst, &d);
        const int near = m->sign > 0 ? d.anode : d.cathode, far = m->sign > 0 ? d.cathode : d.anode;
        if (near == m->gate || (far != m->gate && ns_bridge_own_joined_by_r(ckt, near, m->gate)))
            return 1;
    }
    return 0;
}

/* s: by which the charge of its gate has it open later; close later. */
static double opens_late(const ns_own_taken *o) {
    ns_own_drive drive = o->driven;
    double ohm;
    drive.closes = NAN;
    return ns_bridge_own_late(&o->mosfet, &drive, o->seen.most_v, &ohm);
}

static double closes_late(const ns_own_taken *o) {
    ns_own_drive drive = o->driven;
    double ohm;
    drive.opens = NAN;
    return -ns_bridge_own_late(&o->mosfet, &drive, o->seen.most_v, &ohm);
}

/* m opens so long (s; below 0: after that) before n closes. */
static void add(const CKTcircuit *ckt, const ns_analysis *a, ns_own_taken *m, const ns_own_taken *n,
                double gap) {
    const double late = opens_late(m) - closes_late(n), both = late - gap;
    const double beyond = 0.5 * (m->drive - m->mosfet.vth); /* V: in the middle of its way */
    if (!(late > 0.0) || !(both > 0.0) || fabs(gap) > late || has_diode_off(ckt, a, &m->mosfet))
        return;
    m->overlap.seconds += both;
    m->overlap.count += 1.0;
    m->overlap.charge += 0.5 * both * ns_bridge_own_saturation(&m->mosfet, beyond);
    m->overlap.with = 1 + (int)(n - a->ex.own);
}

void ns_bridge_own_count_overlap(const CKTcircuit *ckt, ns_analysis *a, ns_own_taken *o, double above,
                                 double t) {
    const int opens = above <= 0.0 && o->seen.above > 0.0, closes = above > 0.0 && o->seen.above <= 0.0;
    if (!opens && !closes)
        return;
    *(opens ? &o->overlap.opened : &o->overlap.closed) = t;
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_taken *other = &a->ex.own[k];
        if (other == o || other->kind != OWN_MOSFET || other->follows || o->follows ||
            !ns_bridge_own_in_series(&o->mosfet, &other->mosfet))
            continue;
        if (closes && other->seen.above <= 0.0 && other->seen.openings > 0.0)
            add(ckt, a, other, o, t - other->overlap.opened);
        else if (opens && other->seen.above > 0.0 && other->overlap.closed > 0.0)
            add(ckt, a, o, other, other->overlap.closed - t);
    }
}

int ns_bridge_own_note_overlap(const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = much;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (!(o->overlap.charge > most * o->seen.all_of) || !(o->seen.all_of > 0.0))
            continue;
        most = o->overlap.charge / o->seen.all_of;
        worst = o;
    }
    if (worst)
        ns_bridge_report_note(
            "%s: the charge of its gate is left out: by that it would still be closed when %s closes, and "
            "both short-circuit what is across them for some %.2g s each time: give them a dead time of "
            "more than that, or the result may be another one",
            worst->inst->GENname, a->ex.own[worst->overlap.with - 1].inst->GENname,
            worst->overlap.seconds / worst->overlap.count);
    return worst != NULL;
}
