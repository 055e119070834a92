/* bridge/climits.c - the limits of code models climit, at each point. */
#include "climits.h"

#include <math.h>
#include <stdlib.h>

#include "report.h"

int ns_bridge_climits_keep(ns_extract *ex, const MIFinstance *inst) {
    ns_extract_climit *more = realloc(ex->climit, (size_t)(ex->nclimits + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    ex->climit = more;
    ex->climit[ex->nclimits++].inst = inst;
    return NS_OK;
}

static double limit_at(const MIFinstance *inst, int connection, const double *value) {
    const Mif_Port_Data_t *port = inst->conn[connection]->port[0];
    const Mif_Smp_Ptr_t *at = &port->smp_data;
    return port->type == MIF_VOLTAGE || port->type == MIF_DIFF_VOLTAGE
               ? value[at->pos_node] - (port->type == MIF_DIFF_VOLTAGE ? value[at->neg_node] : 0.0)
               : value[at->ibranch];
}

int ns_bridge_climits_check(const ns_extract *ex, const double *value) {
    static const double rounding = 1e-9;
    for (int k = 0; k < ex->nclimits; k++) {
        const MIFinstance *inst = ex->climit[k].inst;
        const double upper =
            limit_at(inst, CLIMIT_UPPER, value) - ns_bridge_models_real(inst, CLIMIT_UPPER_DELTA);
        const double lower =
            limit_at(inst, CLIMIT_LOWER, value) + ns_bridge_models_real(inst, CLIMIT_LOWER_DELTA);
        if (upper >= lower - rounding * (fabs(upper) + fabs(lower) + 1e-3))
            continue;
        ns_bridge_report_error(
            "%s: climit with its upper limit, %.4g, below its lower one, %.4g, has no value", inst->MIFname,
            upper, lower);
        return E_UNSUPP;
    }
    return OK;
}
