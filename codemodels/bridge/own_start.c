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
    if (!uic)
        return 1;
    const double begins = control_of_uic(ckt, s);
    return s->vt == begins ? s->closed : s->vt > begins;
}

static int is_uic(const ns_extract_walk *w) {
    return !w->dc && (w->ckt->CKTmode & MODEUIC) != 0;
}

int ns_bridge_own_is_closed_inside(const ns_extract_walk *w, const ns_own_switch *s) {
    const double half = s->vh + s->early;
    if (!is_uic(w) && s->early > 0.0)
        return w->dc ? s->closed : 1;
    if (!is_uic(w) || (s->branch > 0 && s->early == 0.0))
        return s->closed;
    const double begins = control_of_uic(w->ckt, s);
    if (begins >= s->vt - half && begins <= s->vt + half)
        return s->closed;
    return s->early > 0.0 ? begins < s->vt : begins > s->vt;
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

/* A source z is added to the control at *cp. */
static int add_held(ns_extract_walk *w, const ns_signal *z, int *cp) {
    char name[EXTRACT_NAME];
    const int node = ns_bridge_extract_new_node(w);
    snprintf(name, sizeof name, "start (%d)", node);
    const int status = ns_circuit_source(w->ex->circuit, name, NS_VOLTAGE, node, *cp, z, NULL);
    *cp = node;
    return status ? status : ns_circuit_name_node(w->ex->circuit, node, name);
}

/* volts up to until[0] and none from until[1] on, or for ever, are added. */
static int add_series(ns_extract_walk *w, const double *until, double volts, int *cp) {
    const double level[2] = {volts, 0.0};
    ns_signal z = {.kind = isfinite(until[1]) ? NS_PWL : NS_DC};
    if (z.kind == NS_DC) {
        z.u.dc = volts;
    } else {
        z.u.pwl.n = 2;
        z.u.pwl.t = until;
        z.u.pwl.v = level;
        z.u.pwl.repeat = NAN;
    }
    ns_bridge_extract_mix(w, until, 2 * sizeof *until);
    return add_held(w, &z, cp);
}

/* V: what holds it in that state; size: of what its control is the difference of, there. */
static double hold_of(const ns_own_switch *s, int closed, double size) {
    return (closed != (s->ron > s->roff) ? hold : -hold) * ns_circuit_switch_shift(s->vt, size);
}

/* 1 if a line of points is at value, and above, and below it. */
static int rests_between(const ns_signal *z, double value) {
    int sides[3] = {0};
    for (int k = 0; z->kind == NS_PWL && isnan(z->u.pwl.repeat) && k < z->u.pwl.n; k++)
        sides[(z->u.pwl.v[k] > value) - (z->u.pwl.v[k] < value) + 1] = 1;
    return sides[0] && sides[1] && sides[2];
}

/* A control that comes to the threshold from either side and rests there: closed if it came from below, open
 * if from above, all along the line, whose points get what holds it so; between them it changes while the
 * control is away. */
static int hold_between(ns_extract_walk *w, const ns_own_switch *s, const ns_signal *z, double sign,
                        int closed, int *cp) {
    const int n = z->u.pwl.n;
    double *level = calloc((size_t)n, sizeof *level);
    ns_signal held = *z;
    if (!level)
        return NS_E_MEMORY;
    level[0] = hold_of(s, closed, 0.0);
    for (int k = 1; k < n; k++) {
        const double before = z->u.pwl.v[k - 1] - sign * s->vt;
        const int arrives = z->u.pwl.v[k] == sign * s->vt && before != 0.0;
        level[k] = arrives ? hold_of(s, sign * before < 0.0, 0.0) : level[k - 1];
    }
    held.u.pwl.v = level;
    const int status = add_held(w, &held, cp);
    free(level);
    return status;
}

int ns_bridge_own_hold_start(ns_extract_walk *w, const ns_own_switch *s, int *cp) {
    double sign, leaves[2], *points;
    ns_signal z;
    const GENinstance *v = !w->dc && s->vh == 0.0 ? source_of(w, s, &sign) : NULL;
    if (!v || ns_bridge_sources_signal(w->ckt, v, 0, &z, &points)) /* what it cannot read is refused there */
        return NS_OK;
    const int closed = ns_bridge_own_is_closed_at_rest(w->ckt, is_uic(w), s);
    int status = NS_OK;
    if (rests_between(&z, sign * s->vt))
        status = hold_between(w, s, &z, sign, closed, cp);
    else if (begins_at(&z, sign * s->vt, leaves))
        status = add_series(w, leaves, hold_of(s, closed, 0.0), cp);
    free(points);
    return status;
}

int ns_bridge_own_hold_found(ns_extract_walk *w, const ns_own_switch *s, const ns_own_start *start, int *cp) {
    return add_series(w, start->until, hold_of(s, start->closed, start->size), cp);
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
