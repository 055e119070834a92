/* bridge/analysis.c - from ngspice's circuit to a marcher. */
#include "session.h"

#include <string.h>

#include "report.h"

enum { STEPS_A_POINT = 16 }; /* of ours in ngspice's longest step, unless option h says otherwise */
enum { POINTS_A_LEG = 4 };   /* of the sparse engine, which knows its errors and what is between */

static double longest_step(const ns_analysis *e, const CKTcircuit *ckt) {
    if (e->ex.options.h > 0.0) {
        return e->ex.options.h;
    }
    if (!(ckt->CKTmaxStep > 0.0)) { /* .op: any will do */
        return 1e-6;
    }
    return e->ex.options.method == NS_SPARSE ? POINTS_A_LEG * ckt->CKTmaxStep
                                             : ckt->CKTmaxStep / STEPS_A_POINT;
}

static int map_unknowns(ns_analysis *e) {
    e->count = (size_t)e->system->n + (size_t)e->system->m;
    e->unknown = malloc((size_t)e->ex.neq * sizeof *e->unknown);
    e->room = calloc(3 * e->count + 1, sizeof(double));
    e->mode = calloc((size_t)e->system->m + 1, sizeof *e->mode);
    if (!e->unknown || !e->room || !e->mode) {
        return NS_E_MEMORY;
    }
    e->x = e->room;
    e->lambda = e->x + e->system->n;
    e->before = e->x + e->count;
    e->most = e->before + e->count;
    e->shown = 1; /* there is nothing yet */
    for (int eq = 0; eq < e->ex.neq; eq++) {
        e->unknown[eq] = eq == 0 ? -1
                         : e->ex.element[eq] >= 0
                             ? ns_circuit_current_unknown(e->ex.circuit, e->ex.element[eq])
                             : ns_circuit_node_unknown(e->ex.circuit, eq);
    }
    return NS_OK;
}

/* Says why, returns the code. */
static int fail(ns_analysis *e, int status, const ns_fault *fault) {
    const char *message = ns_circuit_message(e->ex.circuit);
    char line[320];
    if (fault && fault->status) {
        ns_circuit_explain(e->ex.circuit, fault, line, sizeof line);
        ns_bridge_report_error("%s", line);
    } else {
        ns_bridge_report_error("%s", message && *message ? message : ns_status_text(status));
    }
    return ns_bridge_report_code(status);
}

static int build(CKTcircuit *ckt, ns_analysis *e) {
    ns_march_options o;
    ns_fault fault;
    int status = ns_circuit_system(e->ex.circuit, &e->system);
    memset(&fault, 0, sizeof fault);
    memset(&o, 0, sizeof o);
    o.theta = e->ex.options.theta;
    o.gamma = e->ex.options.gamma;
    o.h = e->h = longest_step(e, ckt);
    o.method = e->ex.options.method;
    o.reltol = e->ex.options.reltol;
    status = status ? status : map_unknowns(e);
    status = status ? status : ns_march_create(e->system, &o, &e->march, &fault);
    return status ? fail(e, status, &fault) : OK;
}

int ns_bridge_analysis_make(CKTcircuit *ckt, ns_extract_sources sources, ns_analysis *e) {
    int error;
    memset(e, 0, sizeof *e);
    error = ns_bridge_extract_read(ckt, sources, &e->ex);
    if (error) {
        ns_bridge_report_error("%s", e->ex.line);
    } else {
        error = build(ckt, e);
    }
    if (error) {
        ns_bridge_analysis_clear(e);
    }
    return error;
}

void ns_bridge_analysis_clear(ns_analysis *e) {
    ns_march_free(e->march);
    ns_system_free(e->system);
    ns_bridge_extract_clear(&e->ex);
    free(e->unknown);
    free(e->room);
    free(e->mode);
    memset(e, 0, sizeof *e);
}
