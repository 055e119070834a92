/* bridge/analog_ports.c - ports, parameters and states of XSPICE's analog code models. */
#include "analog_ports.h"

#include <math.h>

/* Of states: as large as the charges of other capacitors. */
static const double farads = 1e-6;

/* --- ports --- */

static int branch_of(const Mif_Port_Data_t *port) {
    return port->type == MIF_VSOURCE_CURRENT ? port->smp_data.ibranch : 0;
}

int ns_bridge_analog_is_ready(const ns_extract_walk *w, const MIFinstance *inst) {
    for (int i = 0; i < inst->num_conn; i++)
        for (int k = 0; !inst->conn[i]->is_null && inst->conn[i]->is_input && k < inst->conn[i]->size; k++) {
            const int branch = branch_of(inst->conn[i]->port[k]);
            if (branch > 0 && w->ex->element[branch] < 0)
                return 0;
        }
    return 1;
}

static ns_piecewise_value *fail(ns_analog *a, int status, const char *why) {
    if (a->p.status == NS_OK) {
        a->p.status = status;
        a->p.why = why;
    }
    return NULL;
}

ns_piecewise_value *ns_bridge_analog_voltage(ns_analog *a, int node) {
    return node > 0 ? ns_bridge_piecewise_term(&a->p, (ns_term){0, node, 1.0})
                    : ns_bridge_piecewise_constant(&a->p, 0.0);
}

/* A source of 0 V carries the current of the port. */
static ns_piecewise_value *sense_current(ns_analog *a, const Mif_Port_Data_t *port) {
    const ns_signal zero = {.kind = NS_DC};
    char name[EXTRACT_NAME];
    int id = -1;
    snprintf(name, sizeof name, "%.100s: current %d", a->inst->MIFname, port->smp_data.ibranch);
    const int status = ns_circuit_source(a->w->ex->circuit, name, NS_VOLTAGE, port->smp_data.pos_node,
                                         port->smp_data.neg_node, &zero, &id);
    ns_bridge_extract_current(a->w, port->smp_data.ibranch, id);
    return status ? fail(a, status, NULL) : ns_bridge_piecewise_term(&a->p, (ns_term){1, id, 1.0});
}

ns_piecewise_value *ns_bridge_analog_input(ns_analog *a, int c, int k) {
    const Mif_Port_Data_t *port = a->inst->conn[c]->port[k];
    const ns_piecewise_value *p;
    switch (port->type) {
    case MIF_VOLTAGE:
        return ns_bridge_analog_voltage(a, port->smp_data.pos_node);
    case MIF_DIFF_VOLTAGE:
        p = ns_bridge_analog_voltage(a, port->smp_data.pos_node);
        return ns_bridge_piecewise_sum(&a->p, 1.0, p, -1.0,
                                       ns_bridge_analog_voltage(a, port->smp_data.neg_node));
    case MIF_VSOURCE_CURRENT:
        return ns_bridge_piecewise_term(&a->p, (ns_term){1, a->w->ex->element[port->smp_data.ibranch], 1.0});
    case MIF_CURRENT:
    case MIF_DIFF_CURRENT:
        return sense_current(a, port);
    default:
        return fail(a, NS_E_RANGE, "a port of this type: use %v, %vd, %i, %id or %vnam");
    }
}

int ns_bridge_analog_output(ns_analog *a, int c, const ns_piecewise_value *v) {
    const Mif_Port_Data_t *port = a->inst->conn[c]->port[0];
    const Mif_Smp_Ptr_t *at = &port->smp_data;
    const int is_voltage = port->type == MIF_VOLTAGE || port->type == MIF_DIFF_VOLTAGE;
    ns_affine u;
    int id = -1;
    if (!is_voltage && port->type != MIF_CURRENT && port->type != MIF_DIFF_CURRENT)
        (void)fail(a, NS_E_RANGE, "an output of this type: use %v, %vd, %i or %id");
    if (a->p.status || !v || !ns_bridge_piecewise_affine(&a->p, v, &u))
        return a->p.status;
    /* ngspice's output currents flow from the first node through the model to the second */
    const int status =
        ns_circuit_linear(a->w->ex->circuit, a->inst->MIFname, is_voltage ? NS_VOLTAGE : NS_CURRENT,
                          at->pos_node, at->neg_node, u.constant, u.nterms, u.terms, &id);
    ns_bridge_extract_current(a->w, is_voltage ? at->branch : 0, id);
    return status;
}

/* --- parameters --- */

double ns_bridge_analog_number(const ns_analog *a, int parameter) {
    return ns_bridge_analog_element(a, parameter, 0);
}

double ns_bridge_analog_element(const ns_analog *a, int parameter, int k) {
    const double value = a->inst->param[parameter]->element[k].rvalue;
    ns_bridge_extract_mix(a->w, &value, sizeof value);
    return value;
}

int ns_bridge_analog_size(const ns_analog *a, int parameter) {
    return a->inst->param[parameter]->is_null ? 0 : a->inst->param[parameter]->size;
}

int ns_bridge_analog_given(const ns_analog *a, int parameter) {
    return !a->inst->param[parameter]->is_null;
}

/* --- states --- */

int ns_bridge_analog_node(ns_analog *a) {
    return ns_bridge_extract_new_node(a->w);
}

/* In .op and .dc a state is where it starts. */
static int add_fixed(ns_analog *a, const char *name, int node, double ic) {
    const ns_signal dc = {.kind = NS_DC, .u.dc = ic};
    return ns_circuit_source(a->w->ex->circuit, name, NS_VOLTAGE, node, 0, &dc, NULL);
}

int ns_bridge_analog_state(ns_analog *a, int node, double ic, const ns_piecewise_value *rate) {
    ns_circuit *c = a->w->ex->circuit;
    char name[EXTRACT_NAME];
    ns_affine u;
    snprintf(name, sizeof name, "%.100s: state %d", a->name, node);
    if (a->w->dc)
        return add_fixed(a, name, node, ic);
    const ns_piecewise_value *amperes = rate ? ns_bridge_piecewise_sum(&a->p, farads, rate, 0.0, rate) : NULL;
    if (!amperes || !ns_bridge_piecewise_affine(&a->p, amperes, &u))
        return a->p.status;
    int status = ns_circuit_capacitor(c, name, node, 0, farads, ic, NULL);
    snprintf(name, sizeof name, "%.100s: rate %d", a->name, node);
    status = status ? status
                    : ns_circuit_linear(c, name, NS_CURRENT, 0, node, u.constant, u.nterms, u.terms, NULL);
    status = status ? status : ns_circuit_name_node(c, node, name);
    return status ? status : ns_circuit_node_ic(c, node, ic);
}

/* --- values --- */

ns_piecewise_value *ns_bridge_analog_scaled(ns_analog *a, double k, const ns_piecewise_value *v,
                                            double offset) {
    return ns_bridge_piecewise_sum(&a->p, k, v, k * offset, ns_bridge_piecewise_constant(&a->p, 1.0));
}

ns_piecewise_value *ns_bridge_analog_limited(ns_analog *a, const ns_piecewise_value *v,
                                             const ns_piecewise_value *low, const ns_piecewise_value *high) {
    ns_piecewise *p = &a->p;
    if (low) /* max(v, low) */
        v = ns_bridge_piecewise_sum(
            p, 1.0, low, 1.0, ns_bridge_piecewise_positive(p, ns_bridge_piecewise_sum(p, 1.0, v, -1.0, low)));
    if (high) /* min(v, high) */
        v = ns_bridge_piecewise_sum(
            p, 1.0, v, -1.0, ns_bridge_piecewise_positive(p, ns_bridge_piecewise_sum(p, 1.0, v, -1.0, high)));
    return (ns_piecewise_value *)v;
}
