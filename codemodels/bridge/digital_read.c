/* bridge/digital_read.c - XSPICE's digital parts read: bridges between them and the circuit. */
#include "digital.h"
#include "digital_control.h"
#include "extract_walk.h"

#include <math.h>
#include <string.h>

#include "ngspice/cmtypes.h"

enum { ADC_LOW, ADC_HIGH };
enum { DAC_LOW, DAC_HIGH, DAC_UNDEFINED, DAC_LOAD, DAC_RISE, DAC_FALL };

static int is_digital(const Mif_Port_Data_t *port) {
    return port->type == MIF_DIGITAL || port->type == MIF_USER_DEFINED;
}

static int refuse(ns_extract_walk *w, MIFinstance *inst, const char *model, const char *why) {
    char what[200];
    snprintf(what, sizeof what, "code model %.40s is not supported: %s", model, why);
    return ns_bridge_extract_refuse(w, &inst->gen, what);
}

/* --- ports of the circuit --- */

/* A source of 0 V that carries the current of a port. */
static int add_ammeter(ns_extract_walk *w, const MIFinstance *inst, const Mif_Port_Data_t *port) {
    const ns_signal zero = {.kind = NS_DC};
    char name[EXTRACT_NAME];
    int id = -1;
    snprintf(name, sizeof name, "%.100s: current %d", inst->MIFname, port->smp_data.ibranch);
    const int status = ns_circuit_source(w->ex->circuit, name, NS_VOLTAGE, port->smp_data.pos_node,
                                         port->smp_data.neg_node, &zero, &id);
    ns_bridge_extract_current(w, port->smp_data.ibranch, id);
    return status;
}

static int read_port(ns_extract_walk *w, MIFinstance *inst, ns_digital_input *to) {
    const Mif_Smp_Ptr_t *at = &to->port->smp_data;
    switch (to->port->type) {
    case MIF_VOLTAGE:
        to->p = at->pos_node;
        return NS_OK;
    case MIF_DIFF_VOLTAGE:
        to->p = at->pos_node;
        to->n = at->neg_node;
        return NS_OK;
    case MIF_VSOURCE_CURRENT:
        to->p = at->ibranch;
        return NS_OK;
    case MIF_CURRENT:
    case MIF_DIFF_CURRENT:
        to->p = at->ibranch;
        return add_ammeter(w, inst, to->port);
    default:
        return ns_bridge_extract_refuse(w, &inst->gen,
                                        "a port of this type is not supported: use %v, %vd, %i, "
                                        "%id or %vnam");
    }
}

static int add_input(ns_extract_walk *w, MIFinstance *inst, Mif_Port_Data_t *port, const char *model) {
    const int is_bridge = strcmp(model, "adc_bridge") == 0;
    ns_digital *d = &w->ex->digital;
    ns_digital_input in = {.inst = inst, .port = port, .is_bridge = is_bridge};
    ns_digital_input *more = realloc(d->input, (size_t)(d->ninputs + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    d->input = more;
    if (is_bridge) {
        in.low = ns_bridge_models_real(inst, ADC_LOW);
        in.high = fmax(in.low, ns_bridge_models_real(inst, ADC_HIGH));
        ns_bridge_extract_mix(w, &in.low, 2 * sizeof in.low);
    }
    int status = read_port(w, inst, &in);
    status = status ? status : ns_bridge_digital_control_make(&in, model);
    if (status == NS_OK)
        d->input[d->ninputs++] = in;
    return status;
}

/* --- outputs of a dac_bridge --- */

static ns_digital_output levels_of(const MIFinstance *inst, const Mif_Port_Data_t *port) {
    ns_digital_output o = {.name = inst->gen.GENname, .port = port, .input = -1};
    const int middle = !inst->param[DAC_LOW]->is_null && !inst->param[DAC_HIGH]->is_null &&
                       inst->param[DAC_UNDEFINED]->is_null;
    o.level[ZERO] = ns_bridge_models_real(inst, DAC_LOW);
    o.level[ONE] = ns_bridge_models_real(inst, DAC_HIGH);
    o.level[UNKNOWN] = middle ? o.level[ZERO] + 0.5 * (o.level[ONE] - o.level[ZERO])
                              : ns_bridge_models_real(inst, DAC_UNDEFINED);
    o.rise = ns_bridge_models_real(inst, DAC_RISE);
    o.fall = ns_bridge_models_real(inst, DAC_FALL);
    o.state = ns_bridge_digital_state(port);
    return o;
}

/* A signal that stands at the level of the state; its ramp long past says that others are to come. */
static int add_source(ns_extract_walk *w, MIFinstance *inst, const Mif_Port_Data_t *out,
                      ns_digital_output *o) {
    const double v = o->level[o->state], volts[2] = {v + 1.0, v}, t[2] = {-2.0, -1.0};
    ns_signal z = {.kind = NS_PWL};
    const int is_voltage = out->type == MIF_VOLTAGE || out->type == MIF_DIFF_VOLTAGE;
    char name[EXTRACT_NAME];
    int id = -1;
    if (!is_voltage && out->type != MIF_CURRENT && out->type != MIF_DIFF_CURRENT)
        return ns_bridge_extract_refuse(w, &inst->gen,
                                        "an output of this type is not supported: use %v or %vd");
    z.u.pwl.n = 2;
    z.u.pwl.t = t;
    z.u.pwl.v = volts;
    z.u.pwl.repeat = NAN;
    snprintf(name, sizeof name, "%.100s: output %d", inst->MIFname, w->ex->digital.noutputs);
    const int status =
        ns_circuit_source(w->ex->circuit, name, is_voltage ? NS_VOLTAGE : NS_CURRENT,
                          is_voltage ? out->smp_data.pos_node : out->smp_data.neg_node,
                          is_voltage ? out->smp_data.neg_node : out->smp_data.pos_node, &z, &id);
    if (is_voltage)
        ns_bridge_extract_current(w, out->smp_data.branch, id);
    o->p = out->smp_data.pos_node;
    o->n = out->smp_data.neg_node;
    o->input = status == NS_OK ? ns_circuit_input(w->ex->circuit, id) : -1;
    return status;
}

static int add_output(ns_extract_walk *w, MIFinstance *inst, int k) {
    ns_digital *d = &w->ex->digital;
    ns_digital_output o = levels_of(inst, inst->conn[0]->port[k]);
    ns_digital_output *more = realloc(d->output, (size_t)(d->noutputs + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    d->output = more;
    if (!(o.rise >= 0.0 && o.fall >= 0.0))
        return ns_bridge_extract_refuse(w, &inst->gen, "t_rise and t_fall must be at least 0");
    const double numbers[] = {o.level[ZERO], o.level[ONE], o.level[UNKNOWN], o.rise, o.fall};
    ns_bridge_extract_mix(w, numbers, sizeof numbers);
    const int status = add_source(w, inst, inst->conn[1]->port[k], &o);
    if (status == NS_OK)
        d->output[d->noutputs++] = o;
    return status;
}

/* --- instances --- */

/* 1 if inst has a terminal in the circuit, or (of_output) puts something out there. */
static int has_analog(const MIFinstance *inst, int of_output) {
    for (int i = 0; i < inst->num_conn; i++) {
        const Mif_Conn_Data_t *c = inst->conn[i];
        for (int k = 0; !c->is_null && (c->is_output || !of_output) && k < c->size; k++)
            if (!c->port[k]->is_null && !is_digital(c->port[k]))
                return 1;
    }
    return 0;
}

/* What only puts out digital values runs in ngspice; it is given the values of its analog inputs. */
static int read_inputs(ns_extract_walk *w, MIFinstance *inst, const char *model) {
    int status = NS_OK;
    for (int i = 0; i < inst->num_conn && status == NS_OK; i++)
        for (int k = 0; !inst->conn[i]->is_null && k < inst->conn[i]->size && status == NS_OK; k++)
            if (!inst->conn[i]->port[k]->is_null && !is_digital(inst->conn[i]->port[k]))
                status = add_input(w, inst, inst->conn[i]->port[k], model);
    return status;
}

int ns_bridge_digital_read(ns_extract_walk *w, MIFinstance *inst, const char *model) {
    int status = NS_OK;
    if (!has_analog(inst, 0)) /* events alone: ngspice has them all */
        return ns_bridge_digital_note_delay(&w->ex->digital, inst, model);
    if (strcmp(model, "dac_bridge") == 0) {
        for (int k = 0; k < inst->conn[0]->size && status == NS_OK; k++)
            status = add_output(w, inst, k);
        return status;
    }
    if (status == NS_OK && has_analog(inst, 1))
        return refuse(w, inst, model,
                      "of those that put out analog values of digital ones, dac_bridge alone is");
    return status ? status : read_inputs(w, inst, model);
}

int ns_bridge_digital_state(const Mif_Port_Data_t *port) {
    const Digital_t *value = port->input.pvalue;
    return value && value->state >= ZERO && value->state <= UNKNOWN ? (int)value->state : (int)UNKNOWN;
}

int ns_bridge_digital_is_undefined(const ns_digital *d, int node) {
    int any = 0;
    for (int k = 0; k < d->noutputs; k++) {
        const ns_digital_output *o = &d->output[k];
        any |= o->state == UNKNOWN && node > 0 && (o->p == node || o->n == node);
    }
    return any;
}

int ns_bridge_digital_has_controls(const ns_digital *d) {
    int any = 0;
    for (int k = 0; k < d->ninputs; k++)
        any = any || d->input[k].control;
    return any;
}

int ns_bridge_digital_has_others(const ns_digital *d) {
    int others = 0;
    for (int k = 0; k < d->ninputs; k++)
        others = others || !d->input[k].is_bridge;
    return others;
}

int ns_bridge_digital_is_at_rest(const ns_digital *d) {
    int rests = 1;
    for (int k = 0; k < d->ninputs; k++)
        rests = rests && (d->input[k].is_bridge ||
                          (d->input[k].control && ns_bridge_digital_control_rests(d->input[k].control)));
    return rests;
}

void ns_bridge_digital_clear(ns_digital *d) {
    for (int k = 0; k < d->ninputs; k++)
        ns_bridge_digital_control_free(d->input[k].control);
    free(d->input);
    free(d->output);
    free(d->threshold);
    free(d->part);
    free(d->lag);
    memset(d, 0, sizeof *d);
}
