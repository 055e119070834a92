/* bridge/own_drive.c - the voltage at which a netlist drives the gate of a MOSFET: potentials of gate and
 * source, as ranges.  That of the gate is the one of the network of V and R around it, dividers included
 * (own_network.c); that of the source is the one that the first way along V, R and L leads to. */
#include <math.h>

#include "models.h"
#include "own_feedback.h"
#include "own_mosfet.h"
#include "own_pump.h"
#include "own_touch.h"
#include "own_voltage.h"

/* --- a gate that switches, or other M, connect with its source and with a supply --- */

/* The other end of a switch, or of the channel of an M, of which one is at this node; -1: it is none. */
static int beyond_switch(const GENinstance *inst, int here) {
    ns_own_mosfet m;
    int p, n;
    if (ns_bridge_own_kind(inst) == OWN_MOSFET) {
        ns_bridge_own_read_mosfet(inst, &m);
        if (m.gate == here)
            return -1;
    }
    if (!ns_bridge_own_contacts(inst, &p, &n))
        return -1;
    return p == here ? n : n == here ? p : -1;
}

/* The voltage of `node` above the source of m, along V, R, L and D, and what a D in between takes of it, is
 * added to *r.  1 if it goes from one to another in steps. */
static int add_end(const CKTcircuit *ckt, int source, int node, ns_own_range drop, ns_own_range *r) {
    ns_own_way w = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = source}, by_all = w;
    ns_own_way of_goal = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .along_r = 1};
    ns_own_range end = {0}, goal = {0};
    by_all.along_r = by_all.along_d = 1;
    if (!ns_bridge_own_way(&w, node, &end)) { /* V say it best */
        w = by_all;
        end = (ns_own_range){0};
        if (!ns_bridge_own_way(&w, node, &end))
            return 0;
    }
    if (w.met != source && ns_bridge_own_way(&of_goal, source, &goal))
        end = ns_bridge_own_add_gap(end, goal, 0);
    ns_bridge_own_extend(r, end.low + drop.low);
    ns_bridge_own_extend(r, end.high - drop.high);
    return end.switches && !end.amplifies;
}

/* The other node of a D of which one is at this node, and what it takes of the voltage there: of the highest
 * one where it pulls it up, of the lowest one where it pulls it down.  -1: it is none. */
static int beyond_diode(const GENinstance *inst, int here, ns_own_range *drop) {
    static const double amperes = 1e-3;
    ns_own_diode d = {0};
    if (ns_bridge_own_kind(inst) != OWN_DIODE)
        return -1;
    ns_bridge_own_read_diode(inst, &d);
    const double volts = ns_bridge_diode_law_voltage(&d.law, amperes);
    if (isnan(volts) || (d.cathode != here && d.anode != here))
        return -1;
    *(d.cathode == here ? &drop->high : &drop->low) = volts;
    return d.cathode == here ? d.anode : d.cathode;
}

/* What a gate is connected with. */
typedef struct gate_ends {
    ns_own_way way;
    const ns_own_mosfet *m;
    ns_own_range r;
    double opens, closes;             /* ohm, as those of ns_own_drive */
    double opens_share, closes_share; /* of v(source) in v(gate) then; NAN: not known */
    int known;                        /* the voltage while all switches are open */
} gate_ends;

/* ohm through which it is held; by: a switch that is closed, or NULL. */
static double ohm_by(const gate_ends *e, const GENinstance *by) {
    const ns_own_mosfet *m = e->m;
    const double farads = m->charge.source + m->charge.drain + m->charge.more;
    return ns_bridge_own_gate_ohm(e->way.ckt, m->gate, m->source, by, farads > 0.0 ? farads : 1e-12);
}

/* One of the states of what drives it. */
static void add_state(gate_ends *e, int closes, double ohm, double share) {
    double *of_ohm = closes ? &e->closes : &e->opens, *of_share = closes ? &e->closes_share : &e->opens_share;
    *of_ohm = fmin(*of_ohm, ohm);
    *of_share = fmin(*of_share, share);
}

/* The voltage that a switch gives the gate while it is closed, with what R leave of it; `end`: its other
 * end. */
static void add_closed(gate_ends *e, const GENinstance *by, int end) {
    const ns_own_range none = {0};
    ns_own_range level = {INFINITY, -INFINITY, 0, 1, 0.0, 0, 0}, volts;
    e->r.switches = 1;
    double share;
    if (ns_bridge_own_find_gate_by(e->way.ckt, e->m->gate, e->m->source, by, &volts, &share)) {
        ns_bridge_own_extend(&level, volts.low);
        ns_bridge_own_extend(&level, volts.high);
    } else {
        share = NAN;
        add_end(e->way.ckt, e->m->source, end, none, &level);
    }
    if (!(level.low <= level.high))
        return;
    const int closes = (e->m->sign > 0 ? level.low : -level.high) > e->m->vth;
    add_state(e, closes, ohm_by(e, by), share);
    ns_bridge_own_extend(&e->r, level.low);
    ns_bridge_own_extend(&e->r, level.high);
}

/* From a gate along R: the ends beyond all switches and D, and, where the voltage while all are open is not
 * known, those without one. */
static void visit_ends(gate_ends *e, int here) {
    const ns_own_range none = {0};
    ns_own_range volts = {0};
    ns_own_way *w = &e->way, by_v = {.ckt = w->ckt, .find = ns_bridge_own_find_voltage, .goal = w->goal};
    if (ns_bridge_own_way_has(w, here) || w->count == OWN_WAY_NODES)
        return;
    w->node[w->count++] = here;
    if (ns_bridge_own_way(&by_v, here, &volts)) {
        if (!e->known)
            add_end(w->ckt, w->goal, here, none, &e->r);
        return;
    }
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        ns_own_range drop = {0};
        const int end = beyond_switch(inst, here), beyond = beyond_diode(inst, here, &drop);
        int p, n;
        if (beyond >= 0 && beyond != w->goal) { /* one to the source drives nothing */
            e->r.switches |= add_end(w->ckt, w->goal, beyond, drop, &e->r);
        } else if (end >= 0) {
            add_closed(e, inst, end);
        } else if (ns_bridge_models_letter(inst) == 'r' &&
                   ns_bridge_own_wire(w, inst, here, &p, &n, &volts) && (p == here || n == here)) {
            visit_ends(e, p == here ? n : p);
        }
    }
}

/* What holds the gate while all switches are open is what they do not do: it opens, or closes, it. */
static void add_rest(gate_ends *e, double share, double volts) {
    const int rests = e->known || share > 1.0 - 1e-12;
    const int closes = rests ? e->m->sign * volts > e->m->vth : isnan(e->closes);
    if (rests || isnan(e->closes) != isnan(e->opens))
        add_state(e, closes, ohm_by(e, NULL), rests ? share : NAN);
}

/* 1 if switches, or D that are driven so, connect its gate with more than one voltage: those are in *r, and
 * the resistances that drive it in *e.  *r: while all are open, from which they take it across the
 * threshold; if known. */
static int find_ends(const CKTcircuit *ckt, const ns_own_mosfet *m, int known, double share, ns_own_range *r,
                     gate_ends *e) {
    *e = (gate_ends){.way = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = m->source, .along_r = 1},
                     .m = m,
                     .r = {INFINITY, -INFINITY, 0, 1, 0.0, 0, 0},
                     .opens = NAN,
                     .closes = NAN,
                     .opens_share = NAN,
                     .closes_share = NAN,
                     .known = known};
    if (known) {
        ns_bridge_own_extend(&e->r, r->low);
        ns_bridge_own_extend(&e->r, r->high);
    }
    visit_ends(e, m->gate);
    const double low = m->sign > 0 ? e->r.low : -e->r.high, high = m->sign > 0 ? e->r.high : -e->r.low;
    if (!e->r.switches || !(low < high) || (known && !(low <= m->vth && high > m->vth)))
        return 0;
    add_rest(e, share, r->low);
    *r = e->r;
    return 1;
}

/* left: what is left of its drive once its source is at its drain; of a gate that rests that is all. */
static void close_at(const ns_own_mosfet *m, double left, ns_own_drive *drive) {
    drive->follows = left > m->vth ? FOLLOWS_AND_CLOSES : FOLLOWS_GATE;
    if (!(left > m->vth))
        return;
    drive->low = drive->low == drive->high ? left : drive->low;
    drive->high = left;
}

/* What is left of its drive once its source is at its drain, with what R leave of it then; otherwise: where
 * that is not known. */
static double left_when_closed(const CKTcircuit *ckt, const ns_own_mosfet *m, double otherwise) {
    ns_own_range r = {0};
    double share;
    if (!ns_bridge_own_find_gate_closed(ckt, m->gate, m->source, m->drain, NULL, &r, &share))
        return otherwise;
    return m->sign > 0 ? r.high : -r.low;
}

/* The source of a closed M has the potential of its drain: the drive of one whose gate is driven against
 * ground. 0: that potential is not known. */
static int lower_when_closed(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    ns_own_way to_supply = {.ckt = ckt, .find = ns_bridge_own_find_voltage},
               along_r = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .along_r = 1};
    ns_own_range drain = {0};
    const int known =
        ns_bridge_own_way(&to_supply, m->drain, &drain) || ns_bridge_own_way(&along_r, m->drain, &drain);
    const double left = known ? left_when_closed(ckt, m, drive->high - drain.high) : NAN;
    close_at(m, left, drive);
    return known;
}

/* Likewise of a p channel whose drain is at a supply and whose load is at its source: where that is pulled
 * to is as much above its gate as its drive says. */
static void lower_when_p_closed(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    ns_own_way to_supply = {.ckt = ckt, .find = ns_bridge_own_find_voltage},
               of_source = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .along_r = 1};
    ns_own_range drain = {0}, source = {0};
    if (!ns_bridge_own_way(&to_supply, m->drain, &drain) ||
        !ns_bridge_own_way(&of_source, m->source, &source))
        return;
    const double left = left_when_closed(ckt, m, drive->high - source.high + drain.low);
    close_at(m, left, drive);
}

/* The drive of a gate that has these voltages; opens, closes: ohm. */
static ns_own_drive drive_of(const ns_own_mosfet *m, const ns_own_range *r, int follows, double opens,
                             double closes) {
    const double low = m->sign > 0 ? r->low : 0.0 - r->high, high = m->sign > 0 ? r->high : 0.0 - r->low;
    return (ns_own_drive){low, high, r->switches && !r->amplifies, follows, !r->sources, opens, closes};
}

/* Where its source leads nowhere, as behind a switch that protects against reversed polarity: v(gate,drain),
 * which is that of its drive while it is closed.  0: that is not known, or not above the threshold. */
static int find_drive_of_drain(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    ns_own_way to_supply = {.ckt = ckt, .find = ns_bridge_own_find_voltage};
    ns_own_range r = {0}, drain = {0};
    double share;
    if (!ns_bridge_own_way(&to_supply, m->drain, &drain) ||
        !ns_bridge_own_find_gate_closed(ckt, m->gate, m->source, m->drain, NULL, &r, &share) || r.amplifies ||
        drain.amplifies)
        return 0;
    r.sources |= drain.sources;
    const ns_own_drive found = drive_of(m, &r, FOLLOWS_AND_CLOSES, NAN, NAN);
    if (!(found.high > m->vth))
        return 0;
    *drive = found;
    return 1;
}

/* 1 if a shunt lies between the source and ground: its drop takes v(gate,source) back to the threshold as the
 * current rises, where a switch would open and close infinitely fast. */
static int is_raised(const CKTcircuit *ckt, int source) {
    ns_own_way w = {.ckt = ckt, .find = ns_bridge_own_find_voltage};
    ns_own_range volts = {0};
    return !ns_bridge_own_way(&w, source, &volts);
}

/* 1 if its source is connected to M, D, C and one R below 1 ohm alone, as that of a package: the driver of
 * the gate refers to the other end of that R, whose drop lowers v(gate,source) as that of a shunt does. */
static int is_behind_ohm(const CKTcircuit *ckt, const ns_own_mosfet *m) {
    int ohms = 0;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const ns_own_way w = {.ckt = ckt, .shunt = 1.0};
        const char letter = ns_bridge_models_letter(box->data);
        ns_own_range gap;
        int p, n;
        if (letter == 'm' || letter == 'd' || letter == 'c' || !ns_bridge_own_touches(box->data, m->source))
            continue;
        if (letter != 'r' ||
            (ns_bridge_own_wire(&w, box->data, m->source, &p, &n, &gap) && (p == m->gate || n == m->gate)))
            return 0;
        ohms += ns_bridge_own_wire(&w, box->data, m->source, &p, &n, &gap);
    }
    return ohms == 1;
}

static int find_drive(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    ns_own_range r = {0};
    gate_ends ends;
    static const double half = 0.5;
    double share, ohm;
    int is_pulled = 0; /* to ground, by what opens it */
    const int known = ns_bridge_own_find_gate(ckt, m->gate, m->source, &r, &share, &ohm);
    double opens = ohm, closes = ohm;
    if ((!known || (r.low == r.high && !r.amplifies)) && find_ends(ckt, m, known, share, &r, &ends)) {
        opens = ends.opens;
        closes = ends.closes;
        share = ends.closes_share < half ? 0.0 : 1.0;
        is_pulled = ends.opens_share < half;
    } else if (!known) {
        drive->opens = share > 1.0 - 1e-12 ? ohm : NAN; /* what charges it is not known */
        return find_drive_of_drain(ckt, m, drive);
    }
    ns_own_way to_ground = {.ckt = ckt,
                            .find = ns_bridge_own_find_voltage,
                            .shunt = 1.0}; /* ohm: more than most shunts that sense a current */
    ns_own_range source = {0};
    *drive = drive_of(m, &r, 0, opens, closes);
    const int is_tied = ns_bridge_own_way(&to_ground, m->source, &source);
    if (share >= half) {
        drive->follows = is_behind_ohm(ckt, m)   ? FOLLOWS_SHUNT
                         : is_pulled && !is_tied ? FOLLOWS_AND_CLOSES
                                                 : 0;
        return 1;
    }
    if (is_tied) {
        drive->follows = is_raised(ckt, m->source) ? FOLLOWS_SHUNT : 0;
        return 1;
    }
    if (m->sign > 0)
        return lower_when_closed(ckt, m, drive);
    lower_when_p_closed(ckt, m, drive);
    return 1;
}

/* What D between gate and source leave of it, where they break down. */
static void limit(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    const int up = m->sign > 0 ? m->gate : m->source, down = m->sign > 0 ? m->source : m->gate;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        ns_own_diode d;
        if (ns_bridge_own_kind(box->data) != OWN_DIODE)
            continue;
        ns_bridge_own_read_diode(box->data, &d);
        if (d.cathode == up && d.anode == down) {
            drive->low = fmin(drive->low, d.bv);
            drive->high = fmin(drive->high, d.bv);
        }
    }
}

/* A gate that rests below the threshold as long as nothing flows, and that V and R hold against the drain:
 * the source has the potential of that once the body diode conducts, as in a return that is protected against
 * reversed polarity, and v(gate,drain) closes it then. */
static void raise_by_drain(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    ns_own_range r = {0};
    double share;
    if (drive->low != drive->high || drive->high > m->vth ||
        !ns_bridge_own_find_gate_closed(ckt, m->gate, m->source, m->drain, NULL, &r, &share) ||
        r.low != r.high || share < 1.0 - 1e-12 || !(m->sign * r.low > m->vth))
        return;
    drive->low = drive->high = m->sign * r.low;
    drive->follows = drive->follows == FOLLOWS_GATE ? FOLLOWS_AND_CLOSES : drive->follows;
}

/* 1 if V, and `by` while that is closed, hold the node. */
static int is_held(const CKTcircuit *ckt, const GENinstance *by, int node) {
    ns_own_way w = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .closed = by};
    ns_own_range r = {0};
    return ns_bridge_own_way(&w, node, &r);
}

/* The voltage of its gate above one end of its channel while it is closed, and `by` too (or NULL), as V hold
 * it against that. 1 if it goes beyond the threshold. */
static int close_with(const CKTcircuit *ckt, const ns_own_mosfet *m, int end, const GENinstance *by,
                      ns_own_drive *drive) {
    const int other = end == m->drain ? m->source : m->drain;
    ns_own_range r = {0};
    double share;
    if (!ns_bridge_own_find_gate_closed(ckt, m->gate, other, end, by, &r, &share) || r.amplifies ||
        (share < 1.0 - 1e-12 && !is_held(ckt, by, end)))
        return 0;
    const ns_own_drive found = drive_of(m, &r, FOLLOWS_AND_CLOSES, NAN, NAN);
    if (!(found.high > m->vth))
        return 0;
    *drive = found;
    return 1;
}

/* Of two M in series, as those that protect a battery, one alone may lead nowhere, or to the load, which says
 * nothing of its gate: v(gate,drain) while both are closed. */
static int find_drive_of_series(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    if (close_with(ckt, m, m->drain, NULL, drive))
        return 1;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        ns_own_mosfet other;
        if (ns_bridge_own_kind(box->data) != OWN_MOSFET)
            continue;
        ns_bridge_own_read_mosfet(box->data, &other);
        if (other.gate == m->gate && other.source == m->source && other.drain == m->drain)
            continue; /* itself, or in parallel */
        if ((other.drain == m->drain || other.source == m->source) && other.sign == m->sign &&
            (close_with(ckt, m, m->drain, box->data, drive) ||
             close_with(ckt, m, m->source, box->data, drive)))
            return 1;
    }
    return 0;
}

int ns_bridge_own_find_drive(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    if (ns_bridge_own_is_fed(ckt, m))
        return 0;
    if (ns_bridge_own_find_pumped(ckt, m, drive))
        return 1;
    int known = find_drive(ckt, m, drive);
    if (known)
        raise_by_drain(ckt, m, drive);
    if (!known || !(drive->high > m->vth))
        known |= find_drive_of_series(ckt, m, drive);
    if (known)
        limit(ckt, m, drive);
    return known;
}
