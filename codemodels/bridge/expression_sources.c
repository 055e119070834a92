/* bridge/expression_sources.c - sources that expressions share: the time, and functions of it. */
#include "expression.h"

#include <math.h>

/* Of the run, s. */
static double stop_of(const ns_extract_walk *w) {
    return w->ckt->CKTfinalTime > 0.0 ? w->ckt->CKTfinalTime : 1.0;
}

static int add_hidden(ns_extract_walk *w, const char *kind, const ns_signal *z, int *node) {
    char name[EXTRACT_NAME];
    const ns_signal dc = {.kind = NS_DC, .u.dc = ns_signal_value(z, 0.0, NS_RIGHT)};
    if (w->next_node <= w->ex->neq)
        w->next_node = w->ex->neq + 1;
    *node = w->next_node++;
    snprintf(name, sizeof name, "%s (%d)", kind, *node);
    const int status = ns_circuit_source(w->ex->circuit, name, NS_VOLTAGE, *node, 0, w->dc ? &dc : z, NULL);
    return status ? status : ns_circuit_name_node(w->ex->circuit, *node, name);
}

int ns_bridge_expression_time(ns_extract_walk *w, int *node) {
    const double t[2] = {0.0, 2.0 * stop_of(w)};
    ns_signal z = {.kind = NS_PWL};
    z.u.pwl.n = 2;
    z.u.pwl.t = z.u.pwl.v = t;
    z.u.pwl.repeat = NAN;
    const int status = w->time_node > 0 ? NS_OK : add_hidden(w, "time", &z, &w->time_node);
    *node = w->time_node;
    return status;
}

int ns_bridge_expression_sine(ns_extract_walk *w, const ns_signal *sine, int *node) {
    return add_hidden(w, "sine", sine, node);
}

int ns_bridge_expression_sawtooth(ns_extract_walk *w, double slope, double offset, int *node) {
    const double period = 1.0 / fabs(slope);
    ns_signal z = {.kind = NS_PULSE};
    z.u.pulse.v2 = 1.0;
    z.u.pulse.td = ((slope > 0.0 ? floor(offset) : ceil(offset)) - offset) / slope;
    z.u.pulse.tr = slope > 0.0 ? period : 0.0;
    z.u.pulse.tf = period - z.u.pulse.tr;
    z.u.pulse.per = period;
    return add_hidden(w, "sawtooth", &z, node);
}
