/* bridge/branches.c - the names of our devices' branch currents.
 *
 * ngspice names the current of a code model's port ad1#branch_1_0; that of a source is v1#branch, which i(v1)
 * stands for.  The name is a string of ngspice's that it frees, and finds by its address among those of equal
 * hash: it is cut where it lies, and made whole before ngspice deletes it. */
#include "branches.h"

#include <string.h>

#include "models.h"

static void rename_node(const CKTnode *node, ns_branch_name name) {
    static const char branch[] = "#branch";
    const char was = name == BRANCH_AS_MADE ? '\0' : '_';
    char *suffix = strrchr(node->name, '#');
    if (suffix && strncmp(suffix, branch, sizeof branch - 1) == 0 && suffix[sizeof branch - 1] == was)
        suffix[sizeof branch - 1] = name == BRANCH_AS_MADE ? '_' : '\0';
}

/* Equations were numbered in the order of the instances, and nodes are listed by their numbers. */
void ns_bridge_branches_rename(CKTcircuit *ckt, GENmodel *models, ns_branch_name name) {
    const CKTnode *node = ckt->CKTnodes;
    for (GENmodel *model = models; model; model = model->GENnextModel) {
        for (GENinstance *inst = model->GENinstances; inst; inst = inst->GENnextInstance) {
            const model_kind kind = ns_bridge_models_kind(inst);
            if (kind != KIND_DIODE && kind != KIND_SWITCH)
                continue;
            while (node && node->number != ns_bridge_models_branch((MIFinstance *)inst))
                node = node->next;
            if (node)
                rename_node(node, name);
        }
    }
}
