/* bridge/own_elements.c - ngspice's own D, S and W, taken as ideal diodes and switches. */
#include "own_elements.h"

#include <ctype.h>
#include <math.h>

#include "own_structs.h"

/* Not taken: what to write so that it is. */
static int refuse_untaken(ns_extract_walk *w, const GENinstance *inst, const char *group) {
    char what[200];
    snprintf(what, sizeof what,
             "%c elements are taken as ideal ones only with take=\"all\" or \"%s\" in a model nonsmooth, as "
             ".include nonsmooth.inc sets it",
             toupper((unsigned char)inst->GENname[0]), group);
    return ns_bridge_extract_refuse(w, inst, what);
}

static int refuse_value(ns_extract_walk *w, const GENinstance *inst, const char *name, double value,
                        const char *why) {
    char what[200];
    snprintf(what, sizeof what, "%s = %g %s", name, value, why);
    return ns_bridge_extract_refuse(w, inst, what);
}

static int keep(ns_extract_walk *w, const ns_own_taken *taken) {
    ns_own_taken *more = realloc(w->ex->own, (size_t)(w->ex->nowns + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    w->ex->own = more;
    w->ex->own[w->ex->nowns++] = *taken;
    return NS_OK;
}

/* --- D --- */

static double voltage_of(const ns_own_diode *d, const ns_bridge_options *o) {
    return o->zero_diodes ? 0.0 : ns_bridge_diode_law_voltage(&d->law, o->id);
}

static int add_junction_capacitor(ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d) {
    char name[EXTRACT_NAME];
    snprintf(name, sizeof name, "%.140s#cjo", inst->GENname);
    ns_bridge_extract_mix(w, &d->farads, sizeof d->farads);
    return ns_circuit_capacitor(w->ex->circuit, name, d->anode, d->cathode, d->farads, NAN, NULL);
}

static int add_diode(ns_extract_walk *w, GENinstance *inst, const ns_own_diode *d, const ns_diode *ideal) {
    int id = -1;
    int status = ns_circuit_diode(w->ex->circuit, inst->GENname, d->anode, d->cathode, ideal, &id);
    if (!status && w->ex->options.cjo && d->farads > 0.0)
        status = add_junction_capacitor(w, inst, d);
    ns_bridge_extract_mix(w, ideal, sizeof *ideal);
    if (status)
        return status;
    const int hidden = d->inside != d->anode;
    return keep(w, &(ns_own_taken){.inst = inst,
                                   .id = id,
                                   .is_diode = 1,
                                   .diode = *ideal,
                                   .anode = d->anode,
                                   .inside = hidden ? d->inside : 0,
                                   .rs = d->rs});
}

int ns_bridge_own_diode(ns_extract_walk *w, GENinstance *inst) {
    const ns_bridge_options *o = &w->ex->options;
    ns_own_diode d;
    if (!o->take_diodes)
        return refuse_untaken(w, inst, "diodes");
    if (ns_bridge_own_kind(inst) != OWN_DIODE)
        return ns_bridge_extract_refuse(w, inst, "only D elements of a model of type D are taken");
    ns_bridge_own_read_diode(inst, &d);
    if (d.heats)
        return ns_bridge_extract_refuse(w, inst, "a D with self-heating (thermal) is not taken");
    const double vf = voltage_of(&d, o);
    if (isnan(vf))
        return refuse_value(w, inst, "id", o->id, "A does not flow through this D below 100 V: give id");
    const double gmin = w->ckt->CKTgmin;
    const ns_diode ideal = {.vf = vf,
                            .ron = o->zero_diodes ? 0.0 : d.rs,
                            .roff = gmin > 0.0 ? 1.0 / gmin : INFINITY,
                            .vz = d.bv,
                            .rz = o->zero_diodes ? 0.0 : d.rs};
    return add_diode(w, inst, &d, &ideal);
}

/* --- S and W --- */

static int add_resistor(const ns_extract_walk *w, const GENinstance *inst, const ns_own_switch *s, int *id) {
    return ns_circuit_resistor(w->ex->circuit, inst->GENname, s->p, s->n, s->ron, id);
}

/* A switch of ron > roff is one that opens where the control rises. */
static int add_voltage_switch(const ns_extract_walk *w, const GENinstance *inst, const ns_own_switch *s,
                              int *id) {
    const int opens = s->ron > s->roff;
    const ns_switch ideal = {.vt = opens ? -s->vt : s->vt,
                             .vh = s->vh,
                             .ron = opens ? s->roff : s->ron,
                             .roff = opens ? s->ron : s->roff};
    const int status = ns_circuit_switch(w->ex->circuit, inst->GENname, s->p, s->n, opens ? s->cn : s->cp,
                                         opens ? s->cp : s->cn, &ideal, id);
    return status ? status : ns_circuit_switch_initially(w->ex->circuit, *id, opens != s->closed);
}

static int add_current_switch(ns_extract_walk *w, const GENinstance *inst, const ns_own_switch *s, int *id) {
    const ns_switch ideal = {.vt = s->vt, .vh = s->vh, .ron = s->ron, .roff = s->roff};
    const int eq = s->branch;
    const int by = eq > 0 && eq < w->ex->neq ? w->ex->element[eq] : -1;
    if (by < 0)
        return EXTRACT_LATER;
    if (s->ron > s->roff)
        return refuse_value(w, inst, "ron", s->ron,
                            "above roff is not supported for W: exchange them and its control");
    const int status =
        ns_circuit_switch_by_current(w->ex->circuit, inst->GENname, s->p, s->n, by, &ideal, id);
    return status ? status : ns_circuit_switch_initially(w->ex->circuit, *id, s->closed);
}

static int take_switch(ns_extract_walk *w, GENinstance *inst, const ns_own_switch *s, int by_current) {
    int id = -1;
    int status;
    if (!w->ex->options.take_switches)
        return refuse_untaken(w, inst, "switches");
    if (s->vh < 0.0)
        return refuse_value(
            w, inst, by_current ? "ih" : "vh", s->vh,
            "is not supported (ngspice then switches early, at vt-|vh| upwards): use 0 or more");
    if (s->ron == s->roff)
        status = add_resistor(w, inst, s, &id);
    else
        status = by_current ? add_current_switch(w, inst, s, &id) : add_voltage_switch(w, inst, s, &id);
    const double numbers[] = {s->vt, s->vh, s->ron, s->roff, s->closed};
    if (status)
        return status;
    ns_bridge_extract_mix(w, numbers, sizeof numbers);
    return keep(
        w, &(ns_own_taken){.inst = inst, .id = s->ron == s->roff ? -1 : id, .inverted = s->ron > s->roff});
}

int ns_bridge_own_switch(ns_extract_walk *w, GENinstance *inst) {
    ns_own_switch s;
    if (ns_bridge_own_kind(inst) != OWN_SWITCH)
        return ns_bridge_extract_refuse(w, inst, "only S elements of a model of type SW are taken");
    ns_bridge_own_read_switch(inst, &s);
    return take_switch(w, inst, &s, 0);
}

int ns_bridge_own_current_switch(ns_extract_walk *w, GENinstance *inst) {
    ns_own_switch s;
    if (ns_bridge_own_kind(inst) != OWN_CURRENT_SWITCH)
        return ns_bridge_extract_refuse(w, inst, "only W elements of a model of type CSW are taken");
    ns_bridge_own_read_current_switch(inst, &s);
    return take_switch(w, inst, &s, 1);
}
