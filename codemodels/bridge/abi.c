/* bridge/abi.c - is the running ngspice the one whose headers this was compiled with?
 *
 * A code model is not given the version of the running ngspice, and its loader checks nothing.  So the fields
 * that are read are checked once: marks, list ends, ranges, and a number that is known twice. */
#include "abi.h"

#include <math.h>

#include "models.h"
#include "versions.h"

#include "spicelib/devices/res/resdefs.h"

enum { EQUATIONS_MAX = 10000000 };

static int nodes_fit(const CKTcircuit *ckt) {
    const CKTnode *last = NULL;
    int n = 0;
    for (const CKTnode *node = ckt->CKTnodes; node && n <= ckt->CKTmaxEqNum; node = node->next, n++) {
        if (node->number < 0 || node->number >= ckt->CKTmaxEqNum ||
            (node->type != SP_VOLTAGE && node->type != SP_CURRENT))
            return 0;
        last = node;
    }
    return n == ckt->CKTmaxEqNum && last == ckt->CKTlastNode;
}

static int matrix_fits(const CKTcircuit *ckt) {
    ns_versions_klu klu;
    if (!ckt->CKTmatrix)
        return 0;
    if (ckt->CKTmaxEqNum == 1)
        return 1; /* ground alone: it is empty */
    if (ns_bridge_versions_klu(ckt->CKTmatrix, &klu))
        return klu.n > 0 && klu.n < ckt->CKTmaxEqNum && klu.column && klu.row && klu.element && klu.number;
    const struct MatrixFrame *m = ns_bridge_versions_sparse(ckt->CKTmatrix);
    return m && m->ID == SPARSE_ID && m->Size > 0 && m->Size <= m->ExtSize && m->ExtSize < ckt->CKTmaxEqNum;
}

static int instances_fit(const CKTcircuit *ckt) {
    const struct nghashbox *names = ckt->DEVnameHash;
    int n = 0;
    for (const struct ngtable_rec *box = names->thread; box && n <= names->num_entries;
         box = box->thread_next, n++) {
        const GENinstance *inst = box->data;
        if (!inst || !inst->GENname || !inst->GENmodPtr || inst->GENmodPtr->GENmodType < 0 ||
            ckt->CKThead[inst->GENmodPtr->GENmodType] == NULL)
            return 0;
    }
    return n == names->num_entries;
}

/* R*G = 1 where no temperature coefficient stands between. */
static int resistors_fit(const CKTcircuit *ckt) {
    for (const struct ngtable_rec *box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        const RESinstance *r = (const RESinstance *)inst;
        const RESmodel *model = (const RESmodel *)inst->GENmodPtr;
        if (ns_bridge_models_letter(inst) == 'r' && !r->REStc1Given && !r->REStc2Given && !r->REStceGiven &&
            model->REStempCoeff1 == 0.0 && model->REStempCoeff2 == 0.0 && !model->REStceGiven &&
            r->RESresist != 0.0 && isfinite(r->RESresist) &&
            !(fabs(r->RESconduct * r->RESresist * r->RESscale / r->RESm - 1.0) < 1e-9 /* rounding */))
            return 0;
    }
    return 1;
}

const char *ns_bridge_abi_check_setup(const CKTcircuit *ckt) {
    if (!(ckt->CKTmaxEqNum > 0 && ckt->CKTmaxEqNum < EQUATIONS_MAX) || !nodes_fit(ckt))
        return "the list of nodes";
    if (!(ckt->CKTtemp > 0.0 && ckt->CKTtemp < 1e4) || !ckt->enh || !ckt->CKThead || !ckt->DEVnameHash)
        return "the circuit";
    return instances_fit(ckt) ? NULL : "the table of instances";
}

const char *ns_bridge_abi_check(const CKTcircuit *ckt) {
    const char *wrong = ns_bridge_abi_check_setup(ckt);
    if (wrong)
        return wrong;
    if (!matrix_fits(ckt))
        return "the matrix";
    return resistors_fit(ckt) ? NULL : "a resistor";
}
