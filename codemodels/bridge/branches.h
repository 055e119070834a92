/* bridge/branches.h - the names of our devices' branch currents. */
#ifndef BRIDGE_BRANCHES_H
#define BRIDGE_BRANCHES_H

#include "ngspice.h"

typedef enum ns_branch_name {
    BRANCH_AS_MADE,       /* ad1#branch_1_0, of a code model's port */
    BRANCH_AS_OF_A_SOURCE /* ad1#branch, which i(ad1) stands for */
} ns_branch_name;

/* Renames the branch currents of all diodes and switches of models (NULL: none); what has the name already
 * is left alone. */
void ns_bridge_branches_rename(CKTcircuit *ckt, GENmodel *models, ns_branch_name name);

#endif
