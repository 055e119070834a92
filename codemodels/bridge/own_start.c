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

/* V: the control with which ngspice begins under uic. */
static double control_of_uic(const ns_extract_walk *w, const ns_own_switch *s) {
    double volts = 0.0;
    for (const CKTnode *node = w->ckt->CKTnodes; node; node = node->next)
        if (node->icGiven)
            volts += (node->number == s->cp ? node->ic : 0.0) - (node->number == s->cn ? node->ic : 0.0);
    return volts;
}

static int is_uic(const ns_extract_walk *w) {
    return !w->dc && (w->ckt->CKTmode & MODEUIC) != 0;
}

int ns_bridge_own_is_closed_at_rest(const ns_extract_walk *w, const ns_own_switch *s) {
    const double begins = control_of_uic(w, s);
    if (!is_uic(w))
        return 1;
    return s->vt == begins ? s->closed : s->vt > begins;
}

int ns_bridge_own_is_closed_inside(const ns_extract_walk *w, const ns_own_switch *s) {
    const double begins = control_of_uic(w, s);
    if (!is_uic(w) || s->vh == 0.0 || s->branch > 0 || (begins >= s->vt - s->vh && begins <= s->vt + s->vh))
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

static int add_series(ns_extract_walk *w, const double *until, double volts, int *cp) {
    const double level[2] = {volts, 0.0};
    ns_signal z = {.kind = NS_PWL};
    char name[EXTRACT_NAME];
    if (w->next_node <= w->ex->neq)
        w->next_node = w->ex->neq + 1;
    const int node = w->next_node++;
    z.u.pwl.n = 2;
    z.u.pwl.t = until;
    z.u.pwl.v = level;
    z.u.pwl.repeat = NAN;
    snprintf(name, sizeof name, "start (%d)", node);
    const int status = ns_circuit_source(w->ex->circuit, name, NS_VOLTAGE, node, *cp, &z, NULL);
    *cp = node;
    return status ? status : ns_circuit_name_node(w->ex->circuit, node, name);
}

int ns_bridge_own_hold_start(ns_extract_walk *w, const ns_own_switch *s, int opens, int *cp) {
    double sign, leaves[2], *points;
    ns_signal z;
    const int holds = !w->dc && s->vh == 0.0 && ns_bridge_own_is_closed_at_rest(w, s);
    const GENinstance *v = holds ? source_of(w, s, &sign) : NULL;
    if (!v || ns_bridge_sources_signal(w->ckt, v, 0, &z, &points)) /* what it cannot read is refused there */
        return NS_OK;
    const int begins = begins_at(&z, sign * s->vt, leaves);
    free(points);
    const double volts = (opens ? -1.5 : 1.5) * ns_circuit_switch_shift(s->vt);
    return begins ? add_series(w, leaves, volts, cp) : NS_OK;
}
