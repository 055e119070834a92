/* bridge/own_touch.c - which elements may carry a current into a node. */
#include "own_touch.h"

#include <string.h>

#include "foreign.h"
#include "models.h"
#include "own_mosfet.h"

enum { MOST_TERMINALS = 4 };

/* A port of a code model: what reads a voltage carries no current. */
static int port_touches(const Mif_Conn_Data_t *conn, const Mif_Port_Data_t *port, int node) {
    const int is_voltage = port->type == MIF_VOLTAGE || port->type == MIF_DIFF_VOLTAGE;
    const int carries =
        port->type != MIF_DIGITAL && port->type != MIF_USER_DEFINED && (conn->is_output || !is_voltage);
    return carries && !port->is_null && (port->smp_data.pos_node == node || port->smp_data.neg_node == node);
}

/* 1 if its first port is the control of a switch with VON, VOFF: an output, but of no current. */
static int has_control(const MIFinstance *inst) {
    const char *model = ns_bridge_foreign_model(inst);
    return model && strcmp(model, "pswitch") == 0;
}

static int model_touches(const MIFinstance *inst, int node) {
    for (int c = has_control(inst) ? 1 : 0; c < inst->num_conn; c++)
        for (int k = 0; k < inst->conn[c]->size && !inst->conn[c]->is_null; k++)
            if (port_touches(inst->conn[c], inst->conn[c]->port[k], node))
                return 1;
    return 0;
}

static int mosfet_touches(const GENinstance *inst, int node) {
    ns_own_mosfet m;
    ns_bridge_own_read_mosfet(inst, &m);
    return m.drain == node || m.source == node || m.bulk == node;
}

int ns_bridge_own_touches(const GENinstance *inst, int node) {
    const int *at = (const int *)(const void *)(inst + 1); /* as GENnode() has it */
    int terminals = 2;
    switch (ns_bridge_models_letter(inst)) {
    case 'k':
        return 0;
    case 'a':
        return model_touches((const MIFinstance *)inst, node);
    case 'm':
        if (ns_bridge_own_kind(inst) == OWN_MOSFET)
            return mosfet_touches(inst, node);
        terminals = MOST_TERMINALS;
        break;
    case 'j':
    case 'o':
    case 'p':
    case 'q':
    case 't':
    case 'u':
    case 'y':
    case 'z':
        terminals = MOST_TERMINALS;
        break;
    default:
        break;
    }
    for (int k = 0; k < terminals; k++)
        if (at[k] == node)
            return 1;
    return 0;
}

int ns_bridge_own_joined_by_r(const CKTcircuit *ckt, int a, int b) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next)
        if (ns_bridge_models_letter(box->data) == 'r' && ns_bridge_own_touches(box->data, a) &&
            ns_bridge_own_touches(box->data, b))
            return 1;
    return 0;
}

/* 1 if all that touches a node are D with this side there, and more than one. */
static int are_alone(const CKTcircuit *ckt, int node, int by_anode) {
    int count = 0;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; node > 0 && box; box = box->thread_next) {
        ns_own_diode d;
        if (!ns_bridge_own_touches(box->data, node))
            continue;
        if (ns_bridge_own_kind(box->data) != OWN_DIODE)
            return 0;
        ns_bridge_own_read_diode(box->data, &d);
        if ((by_anode ? d.anode : d.cathode) != node)
            return 0;
        count++;
    }
    return count > 1;
}

int ns_bridge_own_is_opposed(const CKTcircuit *ckt, const GENinstance *diode) {
    ns_own_diode d;
    ns_bridge_own_read_diode(diode, &d);
    return are_alone(ckt, d.anode, 1) || are_alone(ckt, d.cathode, 0);
}
