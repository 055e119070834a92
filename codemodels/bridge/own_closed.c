/* bridge/own_closed.c - a follower that its gate closes, or that conducts backwards, beside its own model.
 *
 * Its channel conducts both ways: the higher end (of a p channel the lower one) is its drain at that time,
 * the other one its source.  Closed, it has the ron of its drive, which at a lower v(gate,drain) is too
 * small.  An end that V hold as its source cannot be raised: its model carries no more than the current of
 * saturation there.  Else it carries that at another voltage. */
#include "own_closed.h"

#include <math.h>

#include "own_current.h"
#include "own_follower.h"
#include "own_voltage.h"
#include "report.h"

enum { FORWARDS, BACKWARDS };

static int is_held(const CKTcircuit *ckt, int node) {
    ns_own_way w = {.ckt = ckt, .find = ns_bridge_own_find_voltage};
    ns_own_range r = {0};
    return ns_bridge_own_way(&w, node, &r);
}

void ns_bridge_own_find_held(const CKTcircuit *ckt, ns_own_taken *o) {
    if (!ns_bridge_own_is_follower(o))
        return;
    o->closed_way[FORWARDS].held = is_held(ckt, o->mosfet.source);
    o->closed_way[BACKWARDS].held = is_held(ckt, o->mosfet.drain);
}

static double voltage_at(const ns_analysis *a, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? a->x[a->unknown[eq]] : 0.0;
}

/* What is off, and of what that is a part, at i A from the end `from`, its drain then, to `to`: of all that
 * it carries, both ways (A), where V hold `to`, else of the largest voltage, V. */
static void judge(const ns_analysis *a, const ns_own_taken *o, int held, int from, int to, double i,
                  double both_ways, double *off, double *of) {
    const ns_own_mosfet *m = &o->mosfet;
    const double gate = voltage_at(a, m->gate), v_from = voltage_at(a, from), v_to = voltage_at(a, to);
    const double beyond = m->sign * (gate - v_from) - m->vth;
    *off = *of = 0.0;
    if (!(both_ways > NS_LEAK))
        return;
    *of = held ? both_ways : fmax(fmax(fabs(v_from), fabs(v_to)), o->seen.most_v);
    if (!(i > NS_LEAK))
        return;
    if (held)
        *off = fmax(i - ns_bridge_own_saturation(m, m->sign * (gate - v_to) - m->vth), 0.0);
    else
        *off = fabs(ns_bridge_own_closed_voltage(m, beyond, i) + m->series * i - m->sign * (v_from - v_to));
}

/* Between two points counts the smaller one of both: the gate may have changed in far less time than lies
 * between them. */
static void add(ns_own_taken *o, int k, double off, double of, double seconds) {
    if (seconds > 0.0) {
        o->closed_way[k].all_off += seconds * fmin(off, o->closed_way[k].off);
        o->closed_way[k].all_of += 0.5 * seconds * (of + o->closed_way[k].of);
    }
    o->closed_way[k].off = off;
    o->closed_way[k].of = of;
}

void ns_bridge_own_count_closed(const ns_analysis *a, ns_own_taken *o, double i, double seconds) {
    const ns_own_mosfet *m = &o->mosfet;
    double off, of, back = 0.0;
    if (!ns_bridge_own_is_follower(o))
        return;
    if (o->back >= 0)
        ns_circuit_device(a->ex.circuit, o->back, a->x, a->lambda, a->mode, &back, NULL, NULL);
    const double both_ways = fmax(i, 0.0) + fmax(back, 0.0);
    judge(a, o, o->closed_way[FORWARDS].held, m->drain, m->source, ns_bridge_own_is_following(a, o) ? 0.0 : i,
          both_ways, &off, &of);
    add(o, FORWARDS, off, of, seconds);
    judge(a, o, o->closed_way[BACKWARDS].held, m->source, m->drain, back, both_ways, &off, &of);
    add(o, BACKWARDS, off, of, seconds);
}

static double part_off(const ns_own_taken *o, int k) {
    return o->closed_way[k].all_of > 0.0 ? o->closed_way[k].all_off / o->closed_way[k].all_of : 0.0;
}

double ns_bridge_own_closed_off(const ns_own_taken *o) {
    return fmax(part_off(o, FORWARDS), part_off(o, BACKWARDS));
}

void ns_bridge_own_note_one_closed(const ns_own_taken *o) {
    const int k = part_off(o, BACKWARDS) > part_off(o, FORWARDS);
    const char *end = k == BACKWARDS ? "drain" : "source", *way = k == BACKWARDS ? " backwards" : "";
    if (o->closed_way[k].held)
        ns_bridge_report_note(
            "%s carried%s more than its own model carries at the v(gate,%s) of that time, by %.2g of its "
            "charge: it is no switch there, the result is wrong: drive its gate higher, or leave .include "
            "nonsmooth.inc out",
            o->inst->GENname, way, end, part_off(o, k));
    else
        ns_bridge_report_note(
            "%s had the voltage across its channel wrong while it conducted%s, by %.2g of the largest "
            "voltage there: its ron was that of another gate voltage: the result is wrong: give the voltage "
            "of its gate as vgs, drive it to that of its ron, or leave .include nonsmooth.inc out",
            o->inst->GENname, way, part_off(o, k));
}
