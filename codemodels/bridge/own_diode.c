/* bridge/own_diode.c - ngspice's own D, taken as ideal diodes: which line stands for its curve. */
#include <math.h>

#include "own_current.h"
#include "own_elements.h"
#include "own_structs.h"

int ns_bridge_own_check_law(ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d) {
    if (!(d->law.bottom.volts > 0.0))
        return ns_bridge_extract_refuse(w, inst, "n of its model must be above 0");
    return d->rs < 0.0 ? ns_bridge_own_refuse_value(w, inst, "rs", d->rs, "must be at least 0") : NS_OK;
}

static int add_junction_capacitor(ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d) {
    char name[EXTRACT_NAME];
    snprintf(name, sizeof name, "%.140s#cjo", inst->GENname);
    ns_bridge_extract_mix(w, &d->farads, sizeof d->farads);
    return ns_circuit_capacitor(w->ex->circuit, name, d->anode, d->cathode, d->farads, NAN, NULL);
}

const ns_own_current *ns_bridge_own_found(const ns_extract_walk *w, const GENinstance *inst,
                                          ns_own_path path) {
    const ns_own_found *c = w->found;
    for (int k = 0; c && k < c->count; k++)
        if (c->of[k].inst == inst && c->of[k].path == path)
            return &c->of[k];
    return NULL;
}

static const ns_own_current *found_current(const ns_extract_walk *w, const GENinstance *inst) {
    return ns_bridge_own_found(w, inst, OWN_FORWARDS);
}

static const ns_own_current *found_breakdown(const ns_extract_walk *w, const GENinstance *inst) {
    return isnan(w->ex->options.id) && !w->ex->options.zero_diodes
               ? ns_bridge_own_found(w, inst, OWN_BACKWARDS)
               : NULL;
}

/* The current at which its curve is read. */
double ns_bridge_own_current_of(const ns_extract_walk *w, const GENinstance *inst) {
    const ns_own_current *found = found_current(w, inst);
    if (!isnan(w->ex->options.id))
        return w->ex->options.id;
    const double otherwise = w->found ? w->found->otherwise : NS_OWN_CURRENT;
    return found ? found->id : fmax(otherwise, ns_bridge_own_parallel_current(w->found, inst));
}

static void note_pass(const ns_extract_walk *w, const ns_own_diode *d, ns_own_taken *taken) {
    const ns_own_current *found = found_current(w, taken->inst), *broken = found_breakdown(w, taken->inst);
    if (!w->found || !isnan(w->ex->options.id))
        return;
    taken->pass.seconds = found || !w->found->fails ? w->found->seconds : 0.0;
    taken->pass.whole = w->found->whole;
    taken->pass.idle = !found;
    taken->pass.tangent = found && !found->faint;
    taken->pass.faint = found && found->faint;
    taken->pass.broken = broken ? broken->id : 0.0;
    if (taken->beyond_id ||
        (taken->pass.tangent &&
         taken->diode.ron - d->rs < (1.0 - 1e-6) * ns_bridge_diode_law_slope(&d->law, found->id)))
        taken->pass.to = found->rush;
}

static ns_line_ends ends_of(const ns_own_current *found) {
    return (ns_line_ends){found->most, found->rush, found->blocks};
}

/* Likewise in breakdown, where the pass found its current; else at bv. */
static void set_breakdown(const ns_breakdown_law *law, const ns_own_current *found, ns_diode *ideal) {
    if (!found || !(law->volts > 0.0) || !(law->amperes > 0.0))
        return;
    const ns_line_ends ends = ends_of(found);
    const double slope = ns_bridge_breakdown_law_line(law, found->id, &ends);
    const double vz = ns_bridge_breakdown_law_voltage(law, found->id) - slope * found->id;
    if (!(vz > 0.0))
        return;
    ideal->vz = vz;
    ideal->rz += slope;
}

/* Of a current that a pass found; of a guess, none. */
static const ns_own_current *known_current(const ns_extract_walk *w, const GENinstance *inst) {
    const ns_own_current *found = isnan(w->ex->options.id) ? found_current(w, inst) : NULL;
    return found && !found->faint && !w->ex->options.zero_diodes ? found : NULL;
}

static ns_diode_lines lines_of(const ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d) {
    const ns_own_current *found = known_current(w, inst);
    if (!found)
        return (ns_diode_lines){0};
    const ns_line_ends ends = ends_of(found);
    return ns_bridge_diode_law_lines(&d->law, found->id, &ends);
}

/* A line for its curve, vf its voltage at a current.  Where that is the current that it carries the line is
 * the tangent there, or a flatter one where it carries much more at times; where it is a guess, vf is the
 * same for all currents: a tangent would be far off at larger ones.  The series resistance is added; none, if
 * it has none: one of microohms would be worse. */
static ns_diode ideal_of(const ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d, double vf,
                         double slope) {
    const double gmin = w->ckt->CKTgmin, rs = w->ex->options.zero_diodes ? 0.0 : d->rs;
    const ns_own_current *found = known_current(w, inst);
    ns_diode ideal = {.vf = found ? vf - slope * found->id : vf,
                      .ron = rs + slope,
                      .roff = gmin > 0.0 ? 1.0 / gmin : INFINITY,
                      .vz = d->bv,
                      .rz = rs};
    set_breakdown(&d->breakdown, found_breakdown(w, inst), &ideal);
    return ideal;
}

ns_diode ns_bridge_own_ideal_of(const ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d,
                                double vf) {
    const ns_own_current *found = known_current(w, inst);
    if (!found)
        return ideal_of(w, inst, d, vf, 0.0);
    const ns_line_ends ends = ends_of(found);
    return ideal_of(w, inst, d, vf, ns_bridge_diode_law_line(&d->law, found->id, &ends));
}

/* Two lines are those of two diodes in parallel: the second one, if there is one, begins to conduct at the
 * knee. */
static int add_lines(ns_extract_walk *w, const ns_own_diode *d, const ns_diode_lines *lines,
                     ns_own_taken *taken) {
    const double ron = taken->diode.ron, beyond = d->rs + lines->beyond;
    char name[EXTRACT_NAME];
    ns_bridge_extract_mix(w, &taken->diode, sizeof taken->diode);
    const int status = ns_circuit_diode(w->ex->circuit, taken->inst->GENname, d->anode, d->cathode,
                                        &taken->diode, &taken->id);
    if (status != NS_OK || !(lines->knee > 0.0))
        return status;
    taken->beyond = (ns_diode){.vf = taken->diode.vf + ron * lines->knee,
                               .ron = ron * beyond / (ron - beyond),
                               .roff = INFINITY,
                               .vz = INFINITY};
    ns_bridge_extract_mix(w, &taken->beyond, sizeof taken->beyond);
    snprintf(name, sizeof name, "%.140s#rush", taken->inst->GENname);
    return ns_circuit_diode(w->ex->circuit, name, d->anode, d->cathode, &taken->beyond, &taken->beyond_id);
}

static int add_diode(ns_extract_walk *w, GENinstance *inst, const ns_own_diode *d, double vf) {
    const ns_diode_lines lines = lines_of(w, inst, d);
    ns_own_taken taken = {.inst = inst,
                          .kind = OWN_DIODE,
                          .diode = ideal_of(w, inst, d, vf, lines.slope),
                          .at = ns_bridge_own_current_of(w, inst),
                          .anode = d->anode,
                          .inside = d->inside != d->anode ? d->inside : 0,
                          .rs = d->rs,
                          .tt = d->tt};
    int status = add_lines(w, d, &lines, &taken);
    if (!status && w->ex->options.cjo && d->farads > 0.0)
        status = add_junction_capacitor(w, inst, d);
    if (status)
        return status;
    note_pass(w, d, &taken);
    return ns_bridge_own_keep(w, &taken);
}

int ns_bridge_own_diode(ns_extract_walk *w, GENinstance *inst) {
    const ns_bridge_options *o = &w->ex->options;
    ns_own_diode d;
    if (!o->take_diodes)
        return ns_bridge_own_refuse_untaken(w, inst, "diodes");
    if (ns_bridge_own_kind(inst) != OWN_DIODE)
        return ns_bridge_extract_refuse(w, inst, "only D elements of a model of type D are taken");
    ns_bridge_own_read_diode(inst, &d);
    if (d.heats)
        return ns_bridge_extract_refuse(w, inst, "a D with self-heating (thermal) is not taken");
    const int status = ns_bridge_own_check_law(w, inst, &d);
    if (status)
        return status;
    const double at = ns_bridge_own_current_of(w, inst),
                 vf = o->zero_diodes ? 0.0 : ns_bridge_diode_law_voltage(&d.law, at);
    if (isnan(vf))
        return ns_bridge_own_refuse_value(w, inst, "id", at,
                                          "A does not flow through this D below 100 V: give id");
    return add_diode(w, inst, &d, vf);
}
