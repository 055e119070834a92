/* bridge/digital_ahead.c - how long after an event of ngspice's queue a dac_bridge may change at the
 * earliest.
 *
 * ngspice itself takes the events on its way to the next timepoint, each at its time.  So a timepoint is
 * needed only where the circuit may change: an event at a node from which no dac_bridge is reached but
 * through parts with delays needs none for as long as the shortest way takes. */
#include "digital_control.h"
#include "digital_run.h"
#include "foreign.h"

#include <math.h>
#include <string.h>

#include "ngspice/evt.h"
#include "ngspice/mifparse.h"

/* Delays of these are those of their parameters. */
static const char *const known[] = {"d_and",  "d_buffer", "d_dff", "d_dlatch", "d_fdiv",     "d_inverter",
                                    "d_jkff", "d_nand",   "d_nor", "d_or",     "d_srff",     "d_srlatch",
                                    "d_tff",  "d_xnor",   "d_xor", "d_state",  "d_tristate", "d_ram"};

static int ends_with(const char *text, const char *end) {
    const size_t length = strlen(text), of_end = strlen(end);
    return length >= of_end && strcmp(text + length - of_end, end) == 0;
}

/* The shortest time from an input to an output of an instance of this model: the shortest of its edges, and
 * of what comes before; 0: it is not known. */
static double delay_of(const MIFinstance *inst, const char *model) {
    double edge = INFINITY, before = INFINITY;
    size_t k = 0;
    while (k < sizeof known / sizeof *known && strcmp(known[k], model) != 0)
        k++;
    if (k == sizeof known / sizeof *known)
        return 0.0;
    const IFdevice *type = ns_bridge_foreign_type(inst);
    for (int i = 0; type && i < inst->num_param; i++) {
        const char *name = type->param[i].name;
        if (type->param[i].type != MIF_REAL || inst->param[i]->size < 1 || !ends_with(name, "delay"))
            continue;
        const double seconds = inst->param[i]->element[0].rvalue;
        if (strcmp(name, "rise_delay") == 0 || strcmp(name, "fall_delay") == 0)
            edge = fmin(edge, seconds);
        else
            before = fmin(before, seconds);
    }
    const double all = (isinf(edge) ? 0.0 : edge) + (isinf(before) ? 0.0 : before);
    return all > 0.0 ? all : 0.0;
}

int ns_bridge_digital_note_delay(ns_digital *d, MIFinstance *inst, const char *model) {
    const double seconds = delay_of(inst, model);
    if (seconds == 0.0)
        return NS_OK;
    ns_digital_part *more = realloc(d->part, (size_t)(d->nparts + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    d->part = more;
    d->part[d->nparts++] = (ns_digital_part){inst, seconds};
    return NS_OK;
}

/* --- nodes --- */

static double delay_of_part(const ns_digital *d, const MIFinstance *inst) {
    for (int k = 0; k < d->nparts; k++)
        if (d->part[k].inst == inst)
            return d->part[k].seconds;
    return 0.0;
}

/* The shortest of the lags of the nodes that inst puts out. */
static double lag_behind(const ns_digital *d, const MIFinstance *inst) {
    double least = INFINITY;
    for (int i = 0; i < inst->num_conn; i++) {
        const Mif_Conn_Data_t *c = inst->conn[i];
        for (int k = 0; !c->is_null && c->is_output && k < c->size; k++)
            if (!c->port[k]->is_null)
                least = fmin(least, d->lag[c->port[k]->evt_data.node_index].seconds);
    }
    return least;
}

/* The lag of a node by the present ones of the nodes behind it. */
static ns_digital_lag lag_of(const ns_digital *d, const CKTcircuit *ckt, const double *delay, int node) {
    ns_digital_lag lag = {INFINITY, 0};
    for (const Evt_Inst_Index_t *at = ckt->evt->info.node_table[node]->inst_list; at; at = at->next) {
        const MIFinstance *inst = ckt->evt->info.inst_table[at->index]->inst_ptr;
        const double behind = delay[at->index] > 0.0 ? lag_behind(d, inst) : 0.0;
        if (delay[at->index] + behind < lag.seconds)
            lag = (ns_digital_lag){delay[at->index] + behind, behind > 0.0};
    }
    return lag;
}

/* From nothing that reaches a dac_bridge on: each round finds ways of one part more. */
static void find_lags(ns_digital *d, const CKTcircuit *ckt, const double *delay) {
    int changed = 1;
    for (int n = 0; n < d->nlags; n++)
        d->lag[n] = (ns_digital_lag){INFINITY, 0};
    for (int round = 0; round <= d->nlags && changed; round++) {
        changed = 0;
        for (int n = 0; n < d->nlags; n++) {
            const ns_digital_lag lag = lag_of(d, ckt, delay, n);
            changed |= lag.seconds < d->lag[n].seconds;
            if (lag.seconds < d->lag[n].seconds)
                d->lag[n] = lag;
        }
    }
}

int ns_bridge_digital_look_ahead(ns_digital *d, const CKTcircuit *ckt) {
    const int ninsts = ckt->evt->counts.num_insts;
    double *delay = calloc((size_t)ninsts + 1, sizeof *delay);
    free(d->lag);
    d->nlags = ckt->evt->counts.num_nodes;
    d->lag = calloc((size_t)d->nlags + 1, sizeof *d->lag);
    if (!delay || !d->lag) {
        free(delay);
        return NS_E_MEMORY;
    }
    for (int i = 0; i < ninsts; i++)
        delay[i] = delay_of_part(d, ckt->evt->info.inst_table[i]->inst_ptr);
    find_lags(d, ckt, delay);
    free(delay);
    return NS_OK;
}

/* --- the queue --- */

/* The time at which an event at a node matters.  Where delays of several parts are added, ngspice rounds
 * otherwise: it is asked somewhat before. */
static double matters_at(const ns_digital *d, int node, double t) {
    static const double before = 0.95;
    const ns_digital_lag lag = node < d->nlags ? d->lag[node] : (ns_digital_lag){0.0, 0};
    return t + (lag.by_several ? before : 1.0) * lag.seconds;
}

/* The control of an instance, if that is one of d_osc or d_pwm. */
static const ns_digital_control *control_of(const ns_digital *d, const MIFinstance *inst) {
    for (int k = 0; k < d->ninputs; k++)
        if (d->input[k].inst == inst && d->input[k].control)
            return d->input[k].control;
    return NULL;
}

/* The next call of an instance that asked for one.  d_osc and d_pwm ask at each point; of these calls the one
 * at their present edge matters. */
static double next_call(const ns_digital *d, const CKTcircuit *ckt) {
    const Evt_Inst_Queue_t *queue = &ckt->evt->queue.inst;
    double t = INFINITY;
    for (int k = 0; k < queue->num_pending; k++) {
        const int index = queue->pending_index[k];
        const Evt_Inst_Event_t *e = *queue->current[index];
        const ns_digital_control *c = control_of(d, ckt->evt->info.inst_table[index]->inst_ptr);
        const double queued = e ? e->event_time : INFINITY;
        t = fmin(t, c ? ns_bridge_digital_control_edge(c, queued) : queued);
    }
    return t;
}

double ns_bridge_digital_next_event(const ns_digital *d, const CKTcircuit *ckt) {
    const Evt_Output_Queue_t *out = &ckt->evt->queue.output;
    double t = next_call(d, ckt);
    for (int k = 0; k < out->num_pending; k++) {
        const int index = out->pending_index[k];
        const Evt_Output_Event_t *e = *out->current[index];
        if (e)
            t = fmin(t, matters_at(d, ckt->evt->info.output_table[index]->node_index, e->event_time));
    }
    return t;
}
