/* bridge/own_open.c - a switch whose control is connected to nothing, as one that a drawing has left over:
 * ngspice has such a node at 0 V.  A resistor to ground does not carry a current there, and says the same. */
#include "own_open.h"

#include "models.h"
#include "own_touch.h"
#include "report.h"

/* NULL: ground, or something may carry a current into it. */
static const char *open_name(const CKTcircuit *ckt, int number) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; number > 0 && box; box = box->thread_next)
        if (ns_bridge_own_touches(box->data, number))
            return NULL;
    for (const CKTnode *node = ckt->CKTnodes; number > 0 && node; node = node->next)
        if (node->number == number)
            return node->name;
    return NULL;
}

int ns_bridge_own_hold_open(const ns_extract_walk *w, int cp, int cn, ns_own_taken *taken) {
    const int node[2] = {cp, cn};
    int status = NS_OK;
    for (int k = 0; k < 2 && status == NS_OK; k++) {
        char name[EXTRACT_NAME];
        taken->open[k] = open_name(w->ckt, node[k]);
        snprintf(name, sizeof name, "%.140s: control %d", taken->inst->GENname, k);
        if (taken->open[k])
            status = ns_circuit_resistor(w->ex->circuit, name, node[k], 0, 1.0, NULL);
    }
    return status;
}

/* 1 if a line about this node was written for a switch before the k-th, or for the other end of its control.
 */
static int is_known(const ns_extract *ex, int k, int end) {
    const char *name = ex->own[k].open[end];
    for (int j = 0; j < k; j++)
        if (ex->own[j].open[0] == name || ex->own[j].open[1] == name)
            return 1;
    return end == 1 && ex->own[k].open[0] == name;
}

/* As the user wrote it. */
static void name_of(const ns_own_taken *o, char *name, size_t size) {
    if (o->kind == OWN_PSWITCH)
        ns_bridge_models_own_name((const MIFinstance *)o->inst, name, size);
    else
        snprintf(name, size, "%s", o->inst->GENname);
}

void ns_bridge_own_announce_open(const ns_extract *ex) {
    for (int k = 0; k < ex->nowns; k++)
        for (int end = 0; end < 2; end++) {
            char name[EXTRACT_NAME];
            if (!ex->own[k].open[end] || is_known(ex, k, end))
                continue;
            name_of(&ex->own[k], name, sizeof name);
            ns_bridge_report_note("node %s: the control of %s is connected to nothing else there: it is at "
                                  "0 V, as ngspice has it",
                                  ex->own[k].open[end], name);
        }
}
