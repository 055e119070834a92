/* bridge/own_models.c - what ngspice makes of D, S and W in its PSpice and LTspice modes: `d1 a k dm` of a
 * model with Ron, Roff, Vfwd becomes `ad1 a k adm` of a sidiode; `s1` and `w1` of a VSWITCH with VON and
 * VOFF, an ISWITCH with ION and IOFF, become `as1` of a pswitch, `aw1` of an aswitch. */
#include "own_models.h"

#include <math.h>
#include <string.h>

#include "models.h"
#include "own_elements.h"
#include "own_open.h"

/* In the order of their ifspec.ifs. */
enum { SIDIODE_RON, SIDIODE_ROFF, SIDIODE_VFWD, SIDIODE_VREV, SIDIODE_ILIMIT, SIDIODE_REVILIMIT };
enum { SIDIODE_EPSILON = SIDIODE_REVILIMIT + 1, SIDIODE_REVEPSILON, SIDIODE_RREV };
enum { SWITCH_OFF_AT, SWITCH_ON_AT, SWITCH_LOG, SWITCH_R_OFF, SWITCH_R_ON };
enum { CONTROL, OUTPUT };

static const double infinite = 1e29; /* as of its own limits */

/* Refuses it by the name that the user wrote. */
static int refuse(ns_extract_walk *w, const MIFinstance *inst, const char *what) {
    char name[EXTRACT_NAME];
    ns_bridge_models_own_name(inst, name, sizeof name);
    ns_bridge_extract_line(w->ex, E_UNSUPP, name, what);
    return EXTRACT_REFUSED;
}

static const Mif_Smp_Ptr_t *port_of(const MIFinstance *inst, int connection) {
    return &inst->conn[connection]->port[0]->smp_data;
}

/* --- sidiode --- */

static int read_sidiode(ns_extract_walk *w, MIFinstance *inst) {
    const Mif_Smp_Ptr_t *nodes = port_of(inst, 0);
    const double rrev = ns_bridge_models_real(inst, SIDIODE_RREV),
                 vrev = ns_bridge_models_real(inst, SIDIODE_VREV);
    const double ron = ns_bridge_models_real(inst, SIDIODE_RON);
    const ns_diode d = {.vf = ns_bridge_models_real(inst, SIDIODE_VFWD),
                        .ron = ron,
                        .roff = ns_bridge_models_ohms(inst, SIDIODE_ROFF),
                        .vz = vrev < infinite ? vrev : INFINITY,
                        .rz = rrev == 0.0 ? ron : rrev};
    int id = -1;
    if (!w->ex->options.take_diodes)
        return refuse(w, inst,
                      "a D with Ron, Roff, Vfwd is taken as ideal only with take=\"all\" or \"diodes\" in a "
                      "model nonsmooth, as .include nonsmooth.inc sets it");
    if (ns_bridge_models_real(inst, SIDIODE_ILIMIT) < infinite ||
        ns_bridge_models_real(inst, SIDIODE_REVILIMIT) < infinite)
        return refuse(w, inst, "a D with Ilimit or Revilimit is not supported: leave it out");
    if (d.roff == d.ron)
        return ns_circuit_resistor(w->ex->circuit, inst->MIFname, nodes->pos_node, nodes->neg_node, ron,
                                   NULL);
    const int status =
        ns_circuit_diode(w->ex->circuit, inst->MIFname, nodes->pos_node, nodes->neg_node, &d, &id);
    ns_bridge_extract_mix(w, &d, sizeof d);
    return status ? status
                  : ns_bridge_own_keep(
                        w, &(ns_own_taken){.inst = &inst->gen,
                                           .smoothed = ns_bridge_models_real(inst, SIDIODE_EPSILON) > 0.0 ||
                                                       ns_bridge_models_real(inst, SIDIODE_REVEPSILON) > 0.0,
                                           .kind = OWN_SIDIODE,
                                           .id = id,
                                           .diode = d});
}

/* --- pswitch, aswitch --- */

/* It has some resistance in between, on a scale of logarithms or of ohms; as ideal it changes in the middle.
 * *opens: where the control rises. */
static ns_switch read_values(const MIFinstance *inst, int *opens) {
    const double on_at = ns_bridge_models_real(inst, SWITCH_ON_AT);
    const double off_at = ns_bridge_models_real(inst, SWITCH_OFF_AT);
    const double on = ns_bridge_models_real(inst, SWITCH_R_ON),
                 off = ns_bridge_models_ohms(inst, SWITCH_R_OFF);
    *opens = (on_at < off_at) != (on > off);
    return (ns_switch){.vt = 0.5 * (on_at + off_at), .ron = fmin(on, off), .roff = fmax(on, off)};
}

static int add_by_voltage(const ns_extract_walk *w, const MIFinstance *inst, ns_switch *s, int opens,
                          int *id) {
    const Mif_Smp_Ptr_t *at = port_of(inst, OUTPUT), *control = port_of(inst, CONTROL);
    s->vt = opens ? -s->vt : s->vt;
    return ns_circuit_switch(w->ex->circuit, inst->MIFname, at->pos_node, at->neg_node,
                             opens ? control->neg_node : control->pos_node,
                             opens ? control->pos_node : control->neg_node, s, id);
}

static int add_by_current(ns_extract_walk *w, const MIFinstance *inst, ns_switch *s, int opens, int *id) {
    const Mif_Smp_Ptr_t *at = port_of(inst, OUTPUT);
    const int by = ns_bridge_extract_element(w, port_of(inst, CONTROL)->ibranch);
    s->vt = opens ? -s->vt : s->vt;
    if (by < 0)
        return EXTRACT_LATER;
    return ns_circuit_switch_by_current(w->ex->circuit, inst->MIFname, at->pos_node, at->neg_node, by,
                                        opens ? -1.0 : 1.0, s, id);
}

/* What is known of it at once: its control, and where that has its own model between on and off. */
static ns_own_taken begin_switch(MIFinstance *inst, int by_current) {
    const double on_at = ns_bridge_models_real(inst, SWITCH_ON_AT);
    const double off_at = ns_bridge_models_real(inst, SWITCH_OFF_AT);
    const Mif_Smp_Ptr_t *control = port_of(inst, CONTROL);
    ns_own_taken taken = {.inst = &inst->gen, .kind = OWN_PSWITCH, .id = -1, .vt = 0.5 * (on_at + off_at)};
    taken.between.pos = by_current ? control->ibranch : control->pos_node;
    taken.between.neg = by_current ? 0 : control->neg_node;
    taken.between.off_at = off_at;
    taken.between.on_at = on_at;
    taken.between.off = ns_bridge_models_real(inst, SWITCH_R_OFF);
    taken.between.on = ns_bridge_models_real(inst, SWITCH_R_ON);
    taken.between.by_logarithm = inst->param[SWITCH_LOG]->element[0].bvalue == MIF_TRUE;
    return taken;
}

static int read_switch(ns_extract_walk *w, MIFinstance *inst) {
    const Mif_Port_Type_t control = inst->conn[CONTROL]->port[0]->type;
    const int by_current = control == MIF_VSOURCE_CURRENT;
    int opens;
    ns_switch s = read_values(inst, &opens);
    ns_own_taken taken = begin_switch(inst, by_current);
    if (!w->ex->options.take_switches)
        return refuse(
            w, inst,
            "an S or W with VON, VOFF is taken as ideal only with take=\"all\" or \"switches\" in a "
            "model nonsmooth, as .include nonsmooth.inc sets it");
    if (control == MIF_CURRENT || control == MIF_DIFF_CURRENT)
        return refuse(w, inst, "a switch controlled by a current of its own is not supported: use %vnam");
    ns_bridge_extract_mix(w, &s, sizeof s);
    if (s.ron == s.roff)
        return ns_circuit_resistor(w->ex->circuit, inst->MIFname, port_of(inst, OUTPUT)->pos_node,
                                   port_of(inst, OUTPUT)->neg_node, s.ron, NULL);
    int status = by_current ? add_by_current(w, inst, &s, opens, &taken.id)
                            : add_by_voltage(w, inst, &s, opens, &taken.id);
    if (!by_current && status == NS_OK)
        status = ns_bridge_own_hold_open(w, taken.between.pos, taken.between.neg, &taken);
    return status ? status : ns_bridge_own_keep(w, &taken);
}

int ns_bridge_own_models(ns_extract_walk *w, MIFinstance *inst, const char *model, int *status) {
    if (strcmp(model, "sidiode") == 0)
        *status = read_sidiode(w, inst);
    else if (strcmp(model, "pswitch") == 0 || strcmp(model, "aswitch") == 0)
        *status = read_switch(w, inst);
    else
        return 0;
    return 1;
}
