/* bridge/own_curve.c - D and M that were taken, after .tran: were they far from their own curves? */
#include <math.h>

#include "own_between.h"
#include "own_closed.h"
#include "own_current.h"
#include "own_follower.h"
#include "own_moved.h"
#include "own_overlap.h"
#include "own_ring.h"
#include "own_show.h"
#include "own_stored.h"
#include "own_structs.h"
#include "own_supply.h"
#include "own_touch.h"
#include "own_weak.h"
#include "report.h"

/* A difference that counts, of the largest voltage across the device. */
static const double much = 0.05;

/* A gate so near the threshold is at it, of its drive beyond it. */
static const double held_within = 1e-6;

/* Both sides of an event at the threshold are as near to it, of the same. */
static const double at_threshold = 1e-3;

/* What a D that is off would carry by its own model counts, of the largest current of a source or an
 * inductor. */
static const double much_missed = 0.01;

static int is_judged(const ns_analysis *a, const ns_own_taken *o) {
    return o->id >= 0 && (o->kind == OWN_MOSFET || (o->kind == OWN_DIODE && !a->ex.options.zero_diodes));
}

static double voltage_at(const ns_analysis *a, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? a->x[a->unknown[eq]] : 0.0;
}

/* V: a follower is more than the element of its current. */
static double across_channel(const ns_analysis *a, const ns_own_taken *o) {
    return voltage_at(a, o->mosfet.drain) - voltage_at(a, o->mosfet.source);
}

static double above_threshold(const ns_analysis *a, const ns_own_mosfet *m) {
    return m->sign * (voltage_at(a, m->gate) - voltage_at(a, m->source)) - m->vth;
}

/* A: of the current i that beyond saturation, at v(gate,source) of `above` V beyond vto. */
static double beyond_saturation(const ns_own_mosfet *m, double i, double above) {
    return i > NS_LEAK ? fmax(i - ns_bridge_own_saturation(m, above), 0.0) : 0.0;
}

/* A switch: the current (A) beyond that of saturation at its present v(gate,source), of its current; not
 * while its drain holds its gate at what that needs.  A follower: by how much the voltage (V) beyond vto that
 * its own gate needs while it is not closed is another one than was taken, of that of its source while it
 * carries a current. */
static void judge_channel(const ns_analysis *a, const ns_own_taken *o, double i, double *off, double *of) {
    const ns_own_mosfet *m = &o->mosfet;
    const double above = above_threshold(a, m);
    if (!ns_bridge_own_is_follower(o)) {
        const double needs = o->overdrive.volts + o->overdrive.ohm * fmax(i, 0.0);
        const int held = o->follows && above < needs + held_within * (o->drive - m->vth);
        *off = held ? 0.0 : beyond_saturation(m, i, above);
        *of = fabs(i);
    } else {
        const double amperes = fmax(i, 0.0), needs = ns_bridge_own_needs(m, amperes);
        const double taken = o->overdrive.volts + o->overdrive.ohm * amperes;
        *off = i > NS_LEAK && ns_bridge_own_is_following(a, o) ? fabs(needs - taken) : 0.0;
        *of = i > NS_LEAK ? fabs(voltage_at(a, m->source)) : 0.0; /* that of a p channel rests at a supply */
    }
}

/* What is off between the point before and this one, in the mean.  Where v(gate,source) is straight, that of
 * a switch at midpoints.  Else as much as at the end where less is off: a gate that is not in the plot asks
 * for no points, and may change in far less time than lies between two.  Where it is at its threshold at both
 * ends, it closed and opened the switch there, and was above it in between. */
static double mean_off(const ns_own_taken *o, double i, double above, double off) {
    enum { PARTS = 16 };
    double sum = 0.0;
    const double near = at_threshold * (o->drive - o->mosfet.vth);
    if (!o->gate_is_shown && !o->follows && fabs(above) < near && fabs(o->seen.above) < near)
        return 0.0;
    if (!o->gate_is_shown || o->follows)
        return fmin(off, o->seen.off);
    for (int k = 0; k < PARTS; k++) {
        const double part = (k + 0.5) / PARTS;
        sum += beyond_saturation(&o->mosfet, o->seen.i + part * (fmax(i, 0.0) - o->seen.i),
                                 o->seen.above + part * (above - o->seen.above));
    }
    return sum / PARTS;
}

/* 1 + the index of another M, one end of whose channel is one of o's, and that carries much of its current
 * too, while both gates are above the threshold: they short-circuit what is across both.  0: there is none.
 */
static int find_overlap(const ns_analysis *a, const ns_own_taken *o, double i) {
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *other = &a->ex.own[k];
        double amperes;
        if (other == o || other->kind != OWN_MOSFET || other->id < 0 || other->follows ||
            !(above_threshold(a, &other->mosfet) > 0.0) ||
            !ns_bridge_own_in_series(&o->mosfet, &other->mosfet))
            continue;
        if (ns_circuit_device(a->ex.circuit, other->id, a->x, a->lambda, a->mode, &amperes, NULL, NULL) ==
                NS_OK &&
            fabs(amperes) > 0.5 * i)
            return k + 1;
    }
    return 0;
}

static void count_channel(const CKTcircuit *ckt, ns_analysis *a, ns_own_taken *o, double i, double seconds,
                          double t) {
    const double above = above_threshold(a, &o->mosfet);
    double off, of;
    judge_channel(a, o, i, &off, &of);
    if (off > 0.5 * of && !o->seen.overlaps && !ns_bridge_own_is_follower(o))
        o->seen.overlaps = find_overlap(a, o, i);
    if (seconds > 0.0) {
        o->seen.all_off += seconds * mean_off(o, i, above, off);
        o->seen.all_of += 0.5 * seconds * (of + o->seen.of);
    }
    if (seconds >= 0.0)
        ns_bridge_own_count_overlap(ckt, a, o, above, t);
    o->seen.closed += above > 0.0 && o->seen.above > 0.0 ? fmax(seconds, 0.0) : 0.0;
    o->seen.openings += above <= 0.0 && o->seen.above > 0.0 && seconds >= 0.0 ? 1.0 : 0.0;
    ns_bridge_own_count_weak(o, i, above, seconds);
    o->seen.above = above;
    o->seen.off = off;
    o->seen.of = of;
}

/* A: what its own model carries at v, V. */
static double model_current(const ns_own_taken *o, double v) {
    ns_own_diode d;
    ns_bridge_own_read_diode(o->inst, &d);
    return ns_bridge_diode_law_current(&d.law, v);
}

/* A D that has not conducted yet, at v, V: what its own model would have carried since the point before. */
static void count_missed(ns_own_taken *o, const ns_own_flow *flow, double v, double seconds) {
    const double forwards = v > 0.0 ? v : 0.0, middle = 0.5 * (forwards + o->seen.forwards);
    if (seconds > 0.0 && o->seen.i <= NS_LEAK) {
        o->seen.missed += middle > 0.0 ? seconds * model_current(o, middle) : 0.0;
        o->seen.beside += seconds * flow->amperes;
        o->seen.seconds += seconds;
        o->seen.most_forwards = forwards > o->seen.most_forwards ? forwards : o->seen.most_forwards;
    }
    o->seen.forwards = forwards;
}

void ns_bridge_own_count_point(const CKTcircuit *ckt, ns_analysis *a, double since, double t) {
    const ns_own_flow flow = ns_bridge_own_flow(ckt, a);
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_taken *o = &a->ex.own[k];
        double i, v;
        if (o->kind == OWN_PSWITCH) {
            ns_bridge_own_count_between(a, o, o->seen.t >= since ? t - o->seen.t : -1.0);
            o->seen.t = t;
        }
        if (!is_judged(a, o) ||
            ns_circuit_device(a->ex.circuit, o->id, a->x, a->lambda, a->mode, &i, &v, NULL) != NS_OK)
            continue;
        const double seconds = o->seen.t >= since ? t - o->seen.t : 0.0;
        ns_bridge_own_add_beyond(a, o, a->mode, &i);
        i = o->kind == OWN_MOSFET && !o->follows ? o->mosfet.sign * i : i;
        const double forwards = i > 0.0 ? i : 0.0, mean = 0.5 * (forwards + o->seen.i);
        if (o->seen.t >= since)
            ns_bridge_pulse_mean_add(&o->seen.current, mean > NS_LEAK, mean, o->seen.t, t);
        if (o->kind == OWN_MOSFET) {
            count_channel(ckt, a, o, i, seconds, t);
            ns_bridge_own_count_closed(a, o, i, seconds);
            ns_bridge_own_count_supply(a, o, o->seen.t >= since ? t - o->seen.t : -1.0);
        }
        if (o->kind == OWN_DIODE && o->seen.current.weight == 0.0)
            count_missed(o, &flow, v, seconds);
        ns_bridge_own_count_stored(a, o, &flow, i, v, o->seen.t >= since ? t - o->seen.t : -1.0);
        ns_bridge_own_count_moved(a, o, &flow, mean, v, o->seen.t >= since ? t - o->seen.t : -1.0);
        o->seen.t = t;
        o->seen.i = forwards;
        o->seen.v = o->kind == OWN_MOSFET ? across_channel(a, o) : v;
        o->seen.most_v = fabs(o->seen.v) > o->seen.most_v ? fabs(o->seen.v) : o->seen.most_v;
    }
    ns_bridge_own_count_ring(ckt, a, t, t > since);
}

static double own_current(const ns_own_taken *o) {
    ns_pulse_mean mean = o->seen.current;
    ns_bridge_pulse_mean_end(&mean, o->seen.t);
    return ns_bridge_pulse_mean_read(&mean);
}

/* V: the voltage v of its channel at a current, by the square law: above v - triode v^2/2 = c; INFINITY: it
 * carries less. */
static double channel_voltage(const ns_own_taken *o, double amperes) {
    const ns_own_mosfet *m = &o->mosfet;
    const double beyond = o->drive - m->vth, above = ns_bridge_own_overdrive(m, beyond);
    const double c = amperes / (ns_bridge_own_gain(m, beyond) * m->triode);
    const double rest = above * above - 2.0 * m->triode * c;
    if (o->follows == FOLLOWS_AND_CLOSES)
        return ns_bridge_own_closed_voltage(m, beyond, amperes) + m->series * amperes;
    return rest < 0.0 ? INFINITY : 2.0 * c / (above + sqrt(rest)) + m->series * amperes;
}

/* V: the voltage of its own curve there, with rs; NAN: unknown. */
static double own_voltage(const ns_own_taken *o, double amperes) {
    ns_own_diode d;
    if (o->kind == OWN_MOSFET)
        return channel_voltage(o, amperes);
    ns_bridge_own_read_diode(o->inst, &d);
    return ns_bridge_diode_law_voltage(&d.law, amperes) + o->rs * amperes;
}

static double taken_voltage(const ns_own_taken *o, double amperes) {
    const double more = o->beyond_id ? o->diode.vf + o->diode.ron * amperes - o->beyond.vf : 0.0;
    if (more > 0.0)
        return o->beyond.vf + more / o->diode.ron * ns_bridge_own_slope_beyond(o);
    return o->kind == OWN_MOSFET ? o->closed.volts + o->ron * amperes : o->diode.vf + o->diode.ron * amperes;
}

/* How far that is from what it was taken for, of the largest voltage across it. */
static double difference(const ns_analysis *a, const ns_own_taken *o) {
    if (!is_judged(a, o) || !(own_current(o) > 0.0))
        return 0.0;
    return fabs(taken_voltage(o, own_current(o)) - own_voltage(o, own_current(o))) / o->seen.most_v;
}

static double part_off(const ns_own_taken *o) {
    return own_current(o) > 0.0 && o->seen.all_of > 0.0 ? o->seen.all_off / o->seen.all_of : 0.0;
}

static void note_channel(const ns_analysis *a, const ns_own_taken *o) {
    if (ns_bridge_own_is_follower(o) && o->overdrive.at > 0.0)
        ns_bridge_report_note(
            "%s, a source follower, had the voltage of its source wrong by some %.2g of it: "
            "what its own gate needs beyond vto is that at %.2g A",
            o->inst->GENname, part_off(o), o->overdrive.at);
    else if (ns_bridge_own_is_follower(o))
        ns_bridge_report_note(
            "%s, a source follower, had its source too %s by some %.2g of that voltage: what its own gate "
            "needs beyond vto is left out; drive it against its source, or add that to vto",
            o->inst->GENname, o->mosfet.sign > 0 ? "high" : "low", part_off(o));
    else if (o->seen.overlaps)
        ns_bridge_report_note(
            "%s and %s were closed at the same time, and %s carried more than its own model carries at the "
            "v(gate,source) of that time, by %.2g of its charge: the result is wrong: open one before the "
            "other one closes (a dead time), drive their gates by steeper edges, or leave .include "
            "nonsmooth.inc out",
            o->inst->GENname, a->ex.own[o->seen.overlaps - 1].inst->GENname, o->inst->GENname, part_off(o));
    else
        ns_bridge_report_note(
            "%s carried more than its own model carries at the v(gate,source) of that time, by "
            "%.2g of its charge: it is no switch there, the result is wrong: drive its gate higher or by "
            "steeper edges, or leave .include nonsmooth.inc out",
            o->inst->GENname, part_off(o));
}

static void note(const ns_own_taken *o, double amperes) {
    const double volts = own_voltage(o, amperes);
    if (isinf(volts))
        ns_bridge_report_note(
            "%s carried %.2g A, more than its own model carries at %.4g V: it is no switch "
            "there, the result is wrong: drive its gate higher, give its model a larger kp, or "
            "leave .include nonsmooth.inc out",
            o->inst->GENname, amperes, o->drive);
    else if (o->kind == OWN_MOSFET)
        ns_bridge_report_note("%s carried %.2g A, where the channel of its own model has %.3g V, not %.3g V: "
                              "as a switch it has too %s a ron there",
                              o->inst->GENname, amperes, volts, taken_voltage(o, amperes),
                              volts > taken_voltage(o, amperes) ? "small" : "large");
    else
        ns_bridge_report_note(
            "%s carried %.2g A, where its own voltage is %.3g V, not %.3g V: with the option id=%.2g, "
            "vf is that of this current",
            o->inst->GENname, amperes, volts, taken_voltage(o, amperes), amperes);
}

/* The D farthest from what it carried, if that is more than ten times, or less than a tenth, of a current
 * that was not found but guessed.  most: the currents, A; NULL: those of .tran. */
static const ns_own_taken *find_far_guess(const ns_analysis *a, const double *most, double *amperes) {
    static const double far = 10.0, differs = 0.01; /* where rs has most of the voltage, it hardly does */
    const ns_own_taken *worst = NULL;
    double by = log(far);
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        const int is_guess = o->kind == OWN_DIODE && !o->pass.tangent && isnan(a->ex.options.id);
        const double i = most ? most[k] : own_current(o);
        if (!is_judged(a, o) || !is_guess || !(i > NS_LEAK) || !(fabs(log(i / o->at)) > by) ||
            fabs(taken_voltage(o, i) - own_voltage(o, i)) < differs * own_voltage(o, i))
            continue;
        by = fabs(log(i / o->at));
        *amperes = i;
        worst = o;
    }
    return worst;
}

int ns_bridge_own_note_guess(const ns_analysis *a, const double *most) {
    double amperes = 0.0;
    const ns_own_taken *worst = find_far_guess(a, most, &amperes);
    if (worst)
        note(worst, amperes);
    return worst != NULL;
}

void ns_bridge_own_count_dc(const ns_analysis *a, double *most) {
    for (int k = 0; k < a->ex.nowns; k++) {
        double i;
        if (is_judged(a, &a->ex.own[k]) && ns_circuit_device(a->ex.circuit, a->ex.own[k].id, a->x, a->lambda,
                                                             a->mode, &i, NULL, NULL) == NS_OK)
            most[k] = fmax(most[k], i);
    }
}

/* The D that never conducted, though by its own model it would have carried most, beside what flows. */
static int note_missed(const CKTcircuit *ckt, const ns_analysis *a) {
    const ns_own_taken *worst = NULL;
    double most = much_missed;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (!is_judged(a, o) || o->kind != OWN_DIODE || own_current(o) > 0.0 ||
            !(o->seen.missed > NS_LEAK * o->seen.seconds) || !(o->seen.missed > most * o->seen.beside) ||
            ns_bridge_own_is_opposed(ckt, o->inst))
            continue;
        most = o->seen.beside > 0.0 ? o->seen.missed / o->seen.beside : INFINITY;
        worst = o;
    }
    if (worst)
        ns_bridge_report_note("%s did not conduct at up to %.3g V, where its own model carries %.2g A in the "
                              "mean: its vf is too high for that, the result is wrong: with the option "
                              "id=%.2g, vf is that of this current",
                              worst->inst->GENname, worst->seen.most_forwards,
                              worst->seen.missed / worst->seen.seconds,
                              worst->seen.missed / worst->seen.seconds);
    return worst != NULL;
}

/* The M whose gate's charge counts most beside the time that it is closed. */
static int note_charge(const ns_analysis *a) {
    static const double counts = 0.02;
    const ns_own_taken *worst = NULL;
    double most = counts, late = 0.0, through = 0.0;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (!is_judged(a, o) || o->kind != OWN_MOSFET || o->follows || !(o->seen.closed > 0.0))
            continue;
        double ohm;
        const double by = ns_bridge_own_late(&o->mosfet, &o->driven, o->seen.most_v, &ohm),
                     part = fabs(by) * o->seen.openings / o->seen.closed;
        if (!(part > most))
            continue;
        most = part;
        late = by;
        through = ohm;
        worst = o;
    }
    if (worst)
        ns_bridge_report_note(
            "%s: the charge of its gate is left out: through %.3g ohm that would have it closed "
            "%.2g s %s each time, %.2g of that, and the result may be another one",
            worst->inst->GENname, through, fabs(late), late > 0.0 ? "longer" : "shorter", most);
    return worst != NULL;
}

/* The one that is off most, if that is much: from its curve, else in what its channel carried, else where its
 * gate closes it too little. */
static int note_worst(const ns_analysis *a) {
    enum { CURVE, CHANNEL, CLOSED, WAYS };
    const ns_own_taken *worst[WAYS] = {NULL};
    double most[WAYS] = {much, much, much};
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        const double off[WAYS] = {difference(a, o), is_judged(a, o) ? part_off(o) : 0.0,
                                  ns_bridge_own_closed_off(o)};
        for (int way = 0; way < WAYS; way++)
            if (off[way] > most[way]) {
                most[way] = off[way];
                worst[way] = o;
            }
    }
    if (worst[CURVE])
        note(worst[CURVE], own_current(worst[CURVE]));
    else if (worst[CHANNEL])
        note_channel(a, worst[CHANNEL]);
    else if (worst[CLOSED])
        ns_bridge_own_note_one_closed(worst[CLOSED]);
    return worst[CURVE] || worst[CHANNEL] || worst[CLOSED];
}

int ns_bridge_own_note_curve(const CKTcircuit *ckt, const ns_analysis *a) {
    const int by_law = note_worst(a) || note_missed(ckt, a) || ns_bridge_own_note_guess(a, NULL);
    const int by_stored = ns_bridge_own_note_stored(a), by_moved = ns_bridge_own_note_moved(a);
    const int by_gate = ns_bridge_own_note_overlap(a) || note_charge(a);
    const int by_ring = ns_bridge_own_note_ring(a), by_supply = ns_bridge_own_note_supply(a);
    const int by_control = ns_bridge_own_note_between(a) || ns_bridge_own_note_weak(a);
    return by_law || by_stored || by_moved || by_gate || by_ring || by_supply || by_control;
}
