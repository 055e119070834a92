/* bridge/own_early.c - S and W of a negative vh, which ngspice closes at vt-|vh| upwards and opens at vt+|vh|
 * downwards: in between the direction counts in which the control came.
 *
 * Three switches do that: one is closed above vt+|vh|; beside it lie, in series, one that is closed above
 * vt-|vh|, and one that remembers, by a hysteresis that is a trifle wider than both, that the control came
 * from below, as ngspice takes it where it is in between from the start on. So the switch itself changes
 * exactly at vt-|vh| and vt+|vh|, where one of the first two does.
 */
#include "own_elements.h"
#include "own_show.h"

#include <math.h>
#include <stdio.h>

/* By which the hysteresis is wider, of |vh|. */
static const double wider = 1e-6;

/* Closed above vt, or (sign < 0) below; what controls it: s, with s->ron > s->roff the other way round. */
static int add(ns_extract_walk *w, const char *name, int p, int n, const ns_own_switch *s, double sign,
               ns_switch *ideal, int *id) {
    ideal->vt *= sign;
    if (s->branch <= 0)
        return ns_circuit_switch(w->ex->circuit, name, p, n, sign > 0.0 ? s->cp : s->cn,
                                 sign > 0.0 ? s->cn : s->cp, ideal, id);
    return ns_circuit_switch_by_current(w->ex->circuit, name, p, n, ns_bridge_extract_element(w, s->branch),
                                        sign, ideal, id);
}

int ns_bridge_own_add_early(ns_extract_walk *w, const GENinstance *inst, const ns_own_switch *s,
                            ns_own_taken *taken) {
    const int opens = s->ron > s->roff;
    const double sign = opens ? -1.0 : 1.0, ron = fmin(s->ron, s->roff), roff = fmax(s->ron, s->roff);
    if (s->branch > 0 && ns_bridge_extract_element(w, s->branch) < 0)
        return EXTRACT_LATER;
    const int between = ns_bridge_extract_new_node(w);
    ns_switch high = {.vt = s->vt + sign * s->early, .ron = ron, .roff = INFINITY};
    ns_switch above_low = {.vt = s->vt - sign * s->early, .ron = 0.5 * ron, .roff = roff};
    ns_switch memory = {.vt = s->vt, .vh = (1.0 + wider) * s->early, .ron = 0.5 * ron, .roff = roff};
    ns_circuit *c = w->ex->circuit;
    char name[EXTRACT_NAME];
    int status = add(w, inst->GENname, s->p, s->n, s, sign, &high, &taken->id);
    snprintf(name, sizeof name, "%.140s#low", inst->GENname);
    status = status ? status : add(w, name, s->p, between, s, sign, &above_low, &taken->early.low);
    snprintf(name, sizeof name, "%.140s#below", inst->GENname);
    status = status ? status : add(w, name, between, s->n, s, -sign, &memory, &taken->early.from_below);
    status = status ? status
                    : ns_circuit_switch_initially(c, taken->early.from_below,
                                                  opens != ns_bridge_own_is_closed_inside(w, s));
    status = status ? status : ns_circuit_switch_at_rest(c, taken->early.low, 1);
    return status ? status : ns_circuit_switch_at_rest(c, taken->id, 0);
}

void ns_bridge_own_add_beside_early(const ns_analysis *a, const ns_own_taken *o, double *i, int *on) {
    double beside = 0.0;
    int low = 0, from_below = 0;
    if (!(o->sw.early > 0.0) || o->id < 0)
        return;
    ns_circuit_device(a->ex.circuit, o->early.low, a->x, a->lambda, a->mode, &beside, NULL, &low);
    ns_circuit_device(a->ex.circuit, o->early.from_below, a->x, a->lambda, a->mode, NULL, NULL, &from_below);
    *i += beside;
    *on |= low && from_below;
}
