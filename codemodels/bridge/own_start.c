/* bridge/own_start.c - the state of an S at the start of .tran where its control does not say it, as in
 * ngspice.
 *
 * Without hysteresis and with its control exactly at the threshold, ngspice has it closed in the operating
 * point and until the control first leaves the threshold.  The library's switch is in one state at its
 * threshold throughout, so a voltage source is put in series with the control until the control leaves.  It
 * is 1.5 times what ns_circuit_switch_as_it_came() shifts the threshold by. */
#include <math.h>
#include <stdlib.h>

#include "own_elements.h"
#include "sources.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

enum { MOST_CORNERS = 10000 }; /* at which the control stays */

/* Of ns_circuit_switch_shift(): less than what makes a level of a control lie beside its threshold. */
static const double hold = 1.5;

/* V: the control with which ngspice begins under uic. */
static double control_of_uic(const CKTcircuit *ckt, const ns_own_switch *s) {
    double volts = 0.0;
    for (const CKTnode *node = ckt->CKTnodes; node && s->branch <= 0; node = node->next)
        if (node->icGiven)
            volts += (node->number == s->cp ? node->ic : 0.0) - (node->number == s->cn ? node->ic : 0.0);
    return volts;
}

int ns_bridge_own_is_closed_at_rest(const CKTcircuit *ckt, int uic, const ns_own_switch *s) {
    const double begins = control_of_uic(ckt, s);
    if (!uic)
        return 1;
    return s->vt == begins ? s->closed : s->vt > begins;
}

static int is_uic(const ns_extract_walk *w) {
    return !w->dc && (w->ckt->CKTmode & MODEUIC) != 0;
}

int ns_bridge_own_is_closed_inside(const ns_extract_walk *w, const ns_own_switch *s) {
    const double begins = control_of_uic(w->ckt, s);
    if (!is_uic(w) || s->branch > 0 || (begins >= s->vt - s->vh && begins <= s->vt + s->vh))
        return s->closed;
    return begins > s->vt;
}

/* The V between the nodes of the control, NULL: there is none; *sign: of its value in the control. */
static const GENinstance *source_of(const ns_extract_walk *w, const ns_own_switch *s, double *sign) {
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        if (ns_bridge_models_letter(inst) != 'v')
            continue;
        const VSRCinstance *v = (const VSRCinstance *)inst;
        *sign = v->VSRCposNode == s->cp ? 1.0 : -1.0;
        if ((v->VSRCposNode == s->cp && v->VSRCnegNode == s->cn) ||
            (v->VSRCposNode == s->cn && v->VSRCnegNode == s->cp))
            return inst;
    }
    return NULL;
}

/* 1 if z begins at this value and leaves it later, from leaves[0] on, to be elsewhere at leaves[1]. */
static int begins_at(const ns_signal *z, double value, double *leaves) {
    leaves[1] = 0.0;
    for (int k = 0; k < MOST_CORNERS; k++) {
        leaves[0] = leaves[1];
        if (ns_signal_value(z, leaves[0], NS_RIGHT) != value)
            return 0;
        leaves[1] = ns_signal_next_corner(z, leaves[0]);
        if (!isfinite(leaves[1]))
            return 0;
        if (ns_signal_value(z, leaves[1], NS_LEFT) != value)
            return leaves[0] > 0.0;
    }
    return 0;
}

/* volts up to until[0] and none from until[1] on, or for ever, are added to the control at *cp. */
static int add_series(ns_extract_walk *w, const double *until, double volts, int *cp) {
    const double level[2] = {volts, 0.0};
    ns_signal z = {.kind = isfinite(until[1]) ? NS_PWL : NS_DC};
    char name[EXTRACT_NAME];
    const int node = ns_bridge_extract_new_node(w);
    if (z.kind == NS_DC) {
        z.u.dc = volts;
    } else {
        z.u.pwl.n = 2;
        z.u.pwl.t = until;
        z.u.pwl.v = level;
        z.u.pwl.repeat = NAN;
    }
    snprintf(name, sizeof name, "start (%d)", node);
    const int status = ns_circuit_source(w->ex->circuit, name, NS_VOLTAGE, node, *cp, &z, NULL);
    ns_bridge_extract_mix(w, until, 2 * sizeof *until);
    *cp = node;
    return status ? status : ns_circuit_name_node(w->ex->circuit, node, name);
}

/* V: what holds it in that state. */
static double hold_of(const ns_own_switch *s, int closed) {
    return (closed != (s->ron > s->roff) ? hold : -hold) * ns_circuit_switch_shift(s->vt);
}

int ns_bridge_own_hold_start(ns_extract_walk *w, const ns_own_switch *s, int *cp) {
    double sign, leaves[2], *points;
    ns_signal z;
    const GENinstance *v = !w->dc && s->vh == 0.0 ? source_of(w, s, &sign) : NULL;
    if (!v || ns_bridge_sources_signal(w->ckt, v, 0, &z, &points)) /* what it cannot read is refused there */
        return NS_OK;
    const int begins = begins_at(&z, sign * s->vt, leaves);
    const int closed = ns_bridge_own_is_closed_at_rest(w->ckt, is_uic(w), s);
    free(points);
    return begins ? add_series(w, leaves, hold_of(s, closed), cp) : NS_OK;
}

int ns_bridge_own_hold_found(ns_extract_walk *w, const ns_own_switch *s, const ns_own_start *start, int *cp) {
    return add_series(w, start->until, hold_of(s, start->closed), cp);
}

const ns_own_start *ns_bridge_own_found_start(const ns_extract_walk *w, const GENinstance *inst) {
    const ns_own_found *found = w->found;
    for (int k = 0; found && k < found->nstarts; k++)
        if (found->start[k].inst == inst)
            return &found->start[k];
    return NULL;
}

int ns_bridge_own_current_node(ns_extract_walk *w, const GENinstance *inst, int by, double gain, int *node) {
    char name[EXTRACT_NAME];
    *node = ns_bridge_extract_new_node(w);
    snprintf(name, sizeof name, "%.140s#control", inst->GENname);
    const int status = ns_circuit_icontrolled(w->ex->circuit, name, NS_VOLTAGE, *node, 0, by, gain, NULL);
    return status ? status : ns_circuit_name_node(w->ex->circuit, *node, name);
}
