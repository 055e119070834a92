/* bridge/own_elements.c - ngspice's own S, W and M, taken as ideal switches. */
#include "own_elements.h"

#include <math.h>

#include "own_closed.h"
#include "own_feedback.h"
#include "own_follower.h"
#include "own_open.h"
#include "own_structs.h"

/* --- S and W --- */

static int add_resistor(const ns_extract_walk *w, const GENinstance *inst, const ns_own_switch *s, int *id) {
    return ns_circuit_resistor(w->ex->circuit, inst->GENname, s->p, s->n, s->ron, id);
}

/* A switch is taken: its state where the control does not say; without hysteresis ngspice changes it where
 * the control comes to the threshold from either side, and has it closed where that is all it ever is. */
static int set_states(const ns_extract_walk *w, int id, const ns_own_switch *s, int opens,
                      const ns_own_start *start) {
    const int uic = !w->dc && (w->ckt->CKTmode & MODEUIC) != 0;
    const int closed = opens != ns_bridge_own_is_closed_at_rest(w->ckt, uic, s);
    const int begins = s->vh == 0.0 ? closed : opens != ns_bridge_own_is_closed_inside(w, s);
    const int comes_back = opens != (start && start->falls);
    ns_circuit *c = w->ex->circuit;
    int status = ns_circuit_switch_initially(c, id, begins);
    if (status == NS_OK && start)
        status = ns_circuit_switch_rests(c, id);
    return status ? status : ns_circuit_switch_as_it_came(c, id, closed, w->dc ? closed : comes_back);
}

/* A switch of ron > roff is one that opens where the control rises. */
static int add_voltage_switch(ns_extract_walk *w, const GENinstance *inst, ns_own_switch *s, int *id) {
    const int opens = s->ron > s->roff;
    const ns_switch ideal = {.vt = opens ? -s->vt : s->vt,
                             .vh = s->vh,
                             .ron = opens ? s->roff : s->ron,
                             .roff = opens ? s->ron : s->roff};
    const ns_own_start *start = ns_bridge_own_found_start(w, inst);
    const int first = opens ? s->cn : s->cp;
    int cp = first,
        status = start ? ns_bridge_own_hold_found(w, s, start, &cp) : ns_bridge_own_hold_start(w, s, &cp);
    s->held = cp != first;
    if (status == NS_OK)
        status = ns_circuit_switch(w->ex->circuit, inst->GENname, s->p, s->n, cp, opens ? s->cp : s->cn,
                                   &ideal, id);
    return status ? status : set_states(w, *id, s, opens, start);
}

static int add_current_switch(ns_extract_walk *w, const GENinstance *inst, const ns_own_switch *s, int *id) {
    const int opens = s->ron > s->roff;
    const double gain = opens ? -1.0 : 1.0;
    const ns_switch ideal = {
        .vt = gain * s->vt, .vh = s->vh, .ron = fmin(s->ron, s->roff), .roff = fmax(s->ron, s->roff)};
    const int by = ns_bridge_extract_element(w, s->branch);
    const ns_own_start *start = ns_bridge_own_found_start(w, inst);
    int status, cp = 0;
    if (by < 0)
        return EXTRACT_LATER;
    if (start) {
        status = ns_bridge_own_current_node(w, inst, by, gain, &cp);
        status = status ? status : ns_bridge_own_hold_found(w, s, start, &cp);
        status =
            status ? status : ns_circuit_switch(w->ex->circuit, inst->GENname, s->p, s->n, cp, 0, &ideal, id);
    } else {
        status =
            ns_circuit_switch_by_current(w->ex->circuit, inst->GENname, s->p, s->n, by, gain, &ideal, id);
    }
    return status ? status : set_states(w, *id, s, opens, start);
}

static int take_switch(ns_extract_walk *w, GENinstance *inst, ns_own_switch *s, int by_current) {
    ns_own_taken taken = {
        .inst = inst, .kind = by_current ? OWN_CURRENT_SWITCH : OWN_SWITCH, .inverted = s->ron > s->roff};
    int status;
    if (!w->ex->options.take_switches)
        return ns_bridge_own_refuse_untaken(w, inst, "switches");
    if (s->ron < 0.0 || s->roff < 0.0)
        return ns_bridge_own_refuse_value(w, inst, s->ron < 0.0 ? "ron" : "roff",
                                          s->ron < 0.0 ? s->ron : s->roff, "must be at least 0");
    status = by_current ? NS_OK : ns_bridge_own_hold_open(w, s->cp, s->cn, &taken);
    if (status)
        return status;
    if (s->ron == s->roff)
        status = add_resistor(w, inst, s, &taken.id);
    else if (s->early > 0.0)
        status = ns_bridge_own_add_early(w, inst, s, &taken);
    else
        status = by_current ? add_current_switch(w, inst, s, &taken.id)
                            : add_voltage_switch(w, inst, s, &taken.id);
    const double numbers[] = {s->vt, s->vh, s->early, s->ron, s->roff, s->closed};
    if (status)
        return status;
    ns_bridge_extract_mix(w, numbers, sizeof numbers);
    taken.id = s->ron == s->roff ? -1 : taken.id;
    taken.sw = *s;
    return ns_bridge_own_keep(w, &taken);
}

int ns_bridge_own_switch(ns_extract_walk *w, GENinstance *inst) {
    ns_own_switch s;
    if (ns_bridge_own_kind(inst) != OWN_SWITCH)
        return ns_bridge_extract_refuse(w, inst, "only S elements of a model of type SW are taken");
    ns_bridge_own_read_switch(inst, w->dc ? w->ckt : NULL, &s);
    return take_switch(w, inst, &s, 0);
}

int ns_bridge_own_current_switch(ns_extract_walk *w, GENinstance *inst) {
    ns_own_switch s;
    if (ns_bridge_own_kind(inst) != OWN_CURRENT_SWITCH)
        return ns_bridge_extract_refuse(w, inst, "only W elements of a model of type CSW are taken");
    ns_bridge_own_read_current_switch(inst, w->dc ? w->ckt : NULL, !w->dc && (w->ckt->CKTmode & MODEUIC), &s);
    return take_switch(w, inst, &s, 1);
}

/* --- M --- */

/* What takes every M as a switch. */
#define TAKE_BY_VGS                                                                                          \
    "lines AOPT 0 opts and .model opts nonsmooth(take=\"all\" mosfet=\"switch\" vgs=10) in place of the "    \
    ".include"

/* With option mosfet="driven"; knows: mosfet="switch" would know the drive. */
static int refuse_undriven(ns_extract_walk *w, const GENinstance *inst, const ns_own_mosfet *m,
                           const ns_own_drive *drive, int knows) {
    char what[400], rests[120];
    const int has_gamma = m->bulk != m->source && m->gamma != 0.0;
    snprintf(rests, sizeof rests,
             "its gate rests at %.4g V, where an M may amplify or limit a current (vto = %.4g V)",
             drive->high, m->vth);
    snprintf(what, sizeof what, "this M is not plainly a switch: %s; %s",
             has_gamma ? "its bulk is not its source, and raises its threshold (gamma)"
             : drive->low == drive->high
                 ? rests
                 : "no PULSE, PWL, B source, digital part, switch or other M drives its gate, along V "
                   "and R, from below to above its threshold",
             knows ? ".include nonsmooth_mosfet.inc (mosfet=\"switch\") takes every M as a switch"
                   : TAKE_BY_VGS " take every M as one (vgs: v(gate,source) when closed)");
    return ns_bridge_extract_refuse(w, inst, what);
}

/* 1 if the gate rests plainly: below the threshold, or so far above it, and without a signal, that it is no
 * bias at which an M amplifies or limits a current. */
static int rests_plainly(const ns_extract_walk *w, const ns_own_mosfet *m, const ns_own_drive *drive) {
    static const double plainly = 2.0; /* V */
    return drive->low == drive->high && !ns_bridge_own_is_coupled(w->ckt, m) &&
           (drive->high <= m->vth || (m->vth > 0.0 && drive->high - m->vth >= plainly));
}

/* What vgs says of a gate: it is charged to that by what is not known, where it rests otherwise. */
static void raise_to(const ns_own_mosfet *m, double vgs, ns_own_drive *drive) {
    drive->closes = drive->low == drive->high ? NAN : drive->closes;
    drive->low = drive->low <= m->vth ? drive->low : 0.0;
    drive->high = vgs;
}

/* What the netlist drives the gate with; where it does not switch it plainly, option vgs. */
static int find_drive(ns_extract_walk *w, const GENinstance *inst, const ns_own_mosfet *m,
                      ns_own_drive *found, double *volts, int *follows) {
    static const char too_low[] = "V is the highest of v(gate,source), and not above the threshold: this M "
                                  "is no switch, or give another "
                                  "vgs by " TAKE_BY_VGS;
    const ns_bridge_options *o = &w->ex->options;
    static const ns_own_drive none = {.low = NAN, .high = NAN, .opens = NAN, .closes = NAN};
    ns_own_drive drive = none;
    int known = ns_bridge_own_find_drive(w->ckt, m, &drive);
    if (known && drive.by_r && ns_bridge_own_is_coupled(w->ckt, m)) {
        known = 0; /* it is driven through what is coupled to it */
        drive = none;
    }
    if (!drive.follows && ns_bridge_own_has_feedback(w->ckt, m))
        drive.follows = FOLLOWS_DRAIN;
    *found = drive;
    const int rests = known && rests_plainly(w, m, &drive);
    const int is_plain = rests || (known && drive.switches && drive.low <= m->vth && drive.high > m->vth);
    const double given = is_plain ? NAN : o->vgs;
    *follows = isnan(given) || drive.follows != FOLLOWS_AND_CLOSES ? drive.follows : FOLLOWS_GATE;
    if (m->bulk != m->source && !*follows)
        *follows = FOLLOWS_GATE; /* no body diode keeps its source from pulling its drain along */
    *volts = isnan(given) ? drive.high : given;
    if (!isnan(given))
        raise_to(m, given, found);
    if (o->mosfets == NS_MOSFETS_DRIVEN && (!is_plain || (m->bulk != m->source && m->gamma != 0.0)))
        return refuse_undriven(w, inst, m, &drive, *volts > m->vth);
    if (isnan(*volts))
        return ns_bridge_extract_refuse(
            w, inst, "sources do not say how its gate is driven: give that voltage as vgs, by " TAKE_BY_VGS);
    return rests || *volts > m->vth ? NS_OK : ns_bridge_own_refuse_value(w, inst, "drive", *volts, too_low);
}

/* ohm: beside its channel or, where bulk is not the source, beside each junction. */
static double leak_of(const ns_extract_walk *w, const ns_own_mosfet *m) {
    const double gmin = w->ckt->CKTgmin;
    return fmin(m->leak, gmin > 0.0 ? 1.0 / gmin : INFINITY);
}

static int add_body_diode(ns_extract_walk *w, const GENinstance *inst, ns_own_taken *taken) {
    const ns_own_diode *d = &taken->mosfet.body;
    char name[EXTRACT_NAME];
    const double at = ns_bridge_own_current_of(w, inst);
    const double vf = w->ex->options.zero_diodes ? 0.0 : ns_bridge_diode_law_voltage(&d->law, at);
    if (isnan(vf))
        return ns_bridge_own_refuse_value(w, inst, "id", at,
                                          "A does not flow through its body diode below 100 V");
    snprintf(name, sizeof name, "%.140s#body", inst->GENname);
    taken->diode = ns_bridge_own_ideal_of(w, inst, d, vf);
    if (taken->follows) /* its leak, which a switch has in its channel */
        taken->diode.roff = leak_of(w, &taken->mosfet);
    taken->at = at;
    taken->tt = d->tt;
    ns_bridge_extract_mix(w, &taken->diode, sizeof taken->diode);
    return ns_circuit_diode(w->ex->circuit, name, d->anode, d->cathode, &taken->diode, &taken->body);
}

/* A bulk that is not the source has a junction to that as well, which keeps a coil from pulling the source
 * below it, where the channel would follow. */
static int add_bulk_diode(const ns_extract_walk *w, const GENinstance *inst, ns_own_taken *taken) {
    const ns_own_mosfet *m = &taken->mosfet;
    char name[EXTRACT_NAME];
    if (m->bulk == m->source)
        return NS_OK;
    snprintf(name, sizeof name, "%.140s#bulk", inst->GENname);
    return ns_circuit_diode(w->ex->circuit, name, m->at_source.anode, m->at_source.cathode, &taken->diode,
                            &taken->bulk);
}

/* One direction of a channel, of an n channel from drain to source: ron, a follower that is no higher than
 * the gate less vto and what its current needs beyond that, and a diode, called `name`, against current in
 * the other direction, whose vf is what its line has at no current.  A p channel is its mirror image: no
 * lower than the gate and vto more. */
static int add_way(ns_extract_walk *w, const ns_own_taken *taken, const char *name, int from, int to,
                   int *id) {
    ns_circuit *c = w->ex->circuit;
    char part[EXTRACT_NAME];
    const int is_n = taken->mosfet.sign > 0;
    const double sign = is_n ? 1.0 : -1.0;
    const int behind = ns_bridge_extract_new_node(w), follows = ns_bridge_extract_new_node(w);
    const int is_forwards = to == taken->mosfet.source, needs_more = is_forwards && taken->overdrive.at > 0.0;
    const double ron = is_forwards ? taken->ron : ns_bridge_own_ohmic(taken);
    const double by_ron = needs_more ? taken->overdrive.ohm / ron : 0.0;
    const ns_term above[3] = {
        {0, behind, sign * (1.0 - by_ron)}, {0, taken->mosfet.gate, -sign}, {0, from, sign * by_ron}};
    const double vf = is_forwards ? taken->closed.volts : 0.0;
    const ns_affine u = {taken->mosfet.vth + (needs_more ? taken->overdrive.volts : 0.0) - vf,
                         needs_more ? 3 : 2, above};
    const ns_diode forwards = {.vf = vf, .roff = INFINITY, .vz = INFINITY};
    int kink;
    snprintf(part, sizeof part, "%.140s#ron", name);
    int status = ns_circuit_resistor(c, part, from, behind, ron, NULL);
    snprintf(part, sizeof part, "%.140s#follower", name);
    status = status ? status : ns_circuit_kink(c, part, &u, &kink);
    if (status)
        return status;
    snprintf(part, sizeof part, "%.140s#gate", name);
    status = ns_circuit_linear(c, part, NS_VOLTAGE, behind, follows, 0.0, 1, &(ns_term){2, kink, sign}, NULL);
    return status ? status
                  : ns_circuit_diode(c, name, is_n ? follows : to, is_n ? to : follows, &forwards, id);
}

/* As a source follower, where a switch would open and close infinitely fast.  Backwards its drain is the
 * lower end (the upper one of a p channel), and follows. */
static int add_follower(ns_extract_walk *w, const GENinstance *inst, ns_own_taken *taken) {
    const ns_own_mosfet *m = &taken->mosfet;
    char name[EXTRACT_NAME];
    snprintf(name, sizeof name, "%.140s#back", inst->GENname);
    const int status = add_way(w, taken, inst->GENname, m->drain, m->source, &taken->id);
    return status ? status : add_way(w, taken, name, m->source, m->drain, &taken->back);
}

/* V: where the switch changes.  At vth the channel carries nothing, and a gate may rest there, as at 0 V of a
 * model without vto, or come to rest there by an R and a C: that is open. */
static double threshold_of(const ns_own_taken *taken) {
    static const double at_threshold = 1e-3; /* of what the drive is beyond it: 1e-6 of its current */
    const double vth = taken->mosfet.vth, beyond = taken->drive - vth;
    const double near = at_threshold * (beyond > 0.0 ? beyond : 1.0);
    return fabs(taken->driven.low - vth) < near ? vth + near : vth;
}

static int add_channel(ns_extract_walk *w, const GENinstance *inst, ns_own_taken *taken) {
    const ns_own_mosfet *m = &taken->mosfet;
    const ns_switch ideal = {.vt = threshold_of(taken), .ron = taken->ron, .roff = leak_of(w, m)};
    const int cp = m->sign > 0 ? m->gate : m->source, cn = m->sign > 0 ? m->source : m->gate;
    ns_bridge_extract_mix(w, &ideal, sizeof ideal);
    if (taken->follows)
        return add_follower(w, inst, taken);
    return ns_circuit_switch(w->ex->circuit, inst->GENname, m->drain, m->source, cp, cn, &ideal, &taken->id);
}

/* Refuses a model of values that no M has. */
static int check_model(ns_extract_walk *w, const GENinstance *inst, const ns_own_mosfet *m) {
    if (m->heats)
        return ns_bridge_extract_refuse(w, inst, "an M with self-heating (thermal) is not taken");
    if (!(m->beta > 0.0))
        return ns_bridge_own_refuse_value(w, inst, "kp", m->beta,
                                          "(of levels 1 and 3: times w/l) must be above 0");
    if (m->series < 0.0)
        return ns_bridge_own_refuse_value(w, inst, "rd + rs", m->series, "must be at least 0");
    return ns_bridge_own_check_law(w, inst, &m->body);
}

int ns_bridge_own_mosfet(ns_extract_walk *w, GENinstance *inst) {
    ns_own_taken taken = {.inst = inst, .kind = OWN_MOSFET, .id = -1, .body = -1, .bulk = -1, .back = -1};
    const ns_own_mosfet *m = &taken.mosfet;
    if (!w->ex->options.mosfets)
        return ns_bridge_extract_refuse(w, inst,
                                        "M elements are taken, as switches, only with mosfet=\"driven\" or "
                                        "\"switch\" in a model nonsmooth, as "
                                        ".include nonsmooth.inc sets it");
    if (ns_bridge_own_kind(inst) != OWN_MOSFET)
        return ns_bridge_extract_refuse(
            w, inst, "only M elements of a model VDMOS or of level 1 or 3 are taken as switches");
    ns_bridge_own_read_mosfet(inst, &taken.mosfet);
    int status = check_model(w, inst, m);
    status = status ? status : find_drive(w, inst, m, &taken.driven, &taken.drive, &taken.follows);
    if (status)
        return status;
    ns_bridge_own_find_lines(w, inst, &taken);
    ns_bridge_own_find_held(w->ckt, &taken);
    status = add_channel(w, inst, &taken);
    status = status ? status : add_body_diode(w, inst, &taken);
    status = status ? status : add_bulk_diode(w, inst, &taken);
    return status ? status : ns_bridge_own_keep(w, &taken);
}
