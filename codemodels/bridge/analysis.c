/* bridge/analysis.c - from ngspice's circuit to a marcher, and the points read from it. */
#include "analysis.h"

#include <math.h>
#include <string.h>

#include "chattering.h"
#include "display.h"
#include "many_points.h"
#include "pure/timepoints.h"
#include "report.h"
#include "shown.h"
#include "taken.h"

/* Steps of the sparse engine, which controls its error and knows what is between, in those of the scheme. */
enum { SPARSE_STEP = 64 };

static double longest_step(const ns_analysis *a, const CKTcircuit *ckt) {
    const double given = a->ex.options.h;
    if (!(ckt->CKTfinalTime > 0.0)) /* .op: any will do */
        return given > 0.0 ? given : 1e-6;
    if (given > 0.0) /* no step is longer than the run */
        return fmin(given, ckt->CKTfinalTime);
    const double h = ns_bridge_timepoints_longest_step(a->system, ckt->CKTfinalTime);
    return a->ex.options.method == NS_SPARSE ? SPARSE_STEP * h : h;
}

/* The unknown that equation eq stands for, or -1. */
static int unknown_of(const ns_extract *ex, int eq) {
    if (eq == 0)
        return -1;
    return ex->element[eq] >= 0 ? ns_circuit_current_unknown(ex->circuit, ex->element[eq])
                                : ns_circuit_node_unknown(ex->circuit, eq);
}

static int allocate_points(ns_analysis *a) {
    const size_t held = (size_t)ns_circuit_node_ic_count(a->ex.circuit) + 1;
    a->count = (size_t)a->system->n + (size_t)a->system->m;
    a->unknown = malloc((size_t)a->ex.neq * sizeof *a->unknown);
    a->held.unknown = malloc(held * sizeof *a->held.unknown);
    a->held.value = malloc(held * sizeof *a->held.value);
    a->buffers = calloc(3 * a->count + 1, sizeof(double));
    a->mode = calloc((size_t)a->system->m + 1, sizeof *a->mode);
    return a->unknown && a->held.unknown && a->held.value && a->buffers && a->mode ? NS_OK : NS_E_MEMORY;
}

static int prepare_points(ns_analysis *a) {
    const int status = allocate_points(a);
    if (status)
        return status;
    a->x = a->buffers;
    a->lambda = a->x + a->system->n;
    a->before = a->x + a->count;
    a->max_abs = a->before + a->count;
    for (int eq = 0; eq < a->ex.neq; eq++)
        a->unknown[eq] = unknown_of(&a->ex, eq);
    a->held.n = ns_circuit_hold(a->ex.circuit, a->held.unknown, a->held.value);
    return a->held.n < 0 ? NS_E_MEMORY : NS_OK;
}

void ns_bridge_analysis_take_mode(ns_analysis *a, const ns_mode *mode) {
    for (int k = 0; k < a->system->m; k++) {
        a->changed = a->mode[k] == mode[k] ? a->changed : k + 1;
        a->mode[k] = mode[k];
    }
}

/* Of a failure that names nothing: the device that changed last before it. */
static void add_changed(const ns_analysis *a, char *line, size_t size) {
    const size_t length = strlen(line);
    char name[200];
    if (a->changed && ns_circuit_name_pair(a->ex.circuit, a->changed - 1, name, sizeof name) > 0)
        snprintf(line + length, size - length,
                 "; before that %s changed: if it is controlled by what it switches, delay its control by "
                 "R and C, or give it hysteresis",
                 name);
}

void ns_bridge_analysis_explain(const ns_analysis *a, const ns_fault *fault, int status, char *line,
                                size_t size) {
    const char *message = a->system ? "" : ns_circuit_message(a->ex.circuit);
    if (fault && fault->status)
        ns_circuit_explain(a->ex.circuit, fault, line, size);
    if (fault && fault->status == NS_E_RESIDUAL && fault->npairs + fault->nunknowns == 0)
        add_changed(a, line, size);
    else if (!fault || !fault->status)
        snprintf(line, size, "%s", *message ? message : ns_status_text(status));
}

static int make_march(const ns_analysis *a, ns_march **out, ns_fault *fault) {
    const ns_march_options o = {.theta = a->ex.options.theta,
                                .gamma = a->ex.options.gamma,
                                .h = a->h,
                                .method = a->ex.options.method,
                                .reltol = a->ex.options.reltol};
    return ns_march_create(a->system, &o, out, fault);
}

enum { NOT_SHOWN, VOLTAGE, CURRENT };

/* own_curve.c judges D and M by the points: the pulses of a D ask for points, so that none is missed, and so
 * does what two M do for an instant.  Such a current flows through one with its source at ground, whose gate
 * and channel ask for points too: a gate that moves with its source would ask for all that rings there. */
static void choose_judged(const ns_analysis *a, unsigned char *shown, unsigned char *kind) {
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        const int pair = ns_circuit_pair(a->ex.circuit, o->id);
        const int is_at_ground = o->kind == OWN_MOSFET && o->mosfet.source == 0;
        if (pair < 0 || !(is_at_ground || (o->kind == OWN_DIODE && !a->ex.options.zero_diodes)))
            continue;
        if (is_at_ground)
            shown[o->mosfet.gate] = 1;
        kind[a->system->n + pair] = CURRENT;
    }
    for (int k = 0; k < a->ex.digital.ninputs; k++) {
        const ns_digital_input *in = &a->ex.digital.input[k];
        if (in->control) /* its phase is that of the lines between points */
            shown[in->p] = shown[in->n] = 1;
    }
}

/* Voltages and currents that are in the plot; of devices all currents, if one is. */
static int choose_shown(const CKTcircuit *ckt, ns_analysis *a, unsigned char *kind) {
    unsigned char *shown = calloc((size_t)a->ex.neq + 1, 1);
    if (!shown)
        return NS_E_MEMORY;
    const int known = ns_bridge_shown_read(ckt, a->ex.neq, shown);
    int devices = !known;
    ns_bridge_display_mark(&a->ex, shown);
    choose_judged(a, shown, kind);
    for (int eq = 0; eq < a->ex.neq; eq++)
        if (a->unknown[eq] >= 0 && (!known || shown[eq]))
            kind[a->unknown[eq]] = a->ex.element[eq] >= 0 ? CURRENT : VOLTAGE;
    for (int k = 0; k < a->ex.ndevices; k++)
        devices |= shown[ns_bridge_models_branch(a->ex.device[k].inst)];
    for (size_t k = (size_t)a->system->n; devices && k < a->count; k++)
        kind[k] = CURRENT;
    for (int k = 0; k < a->ex.nowns; k++)
        a->ex.own[k].gate_is_shown = !known || shown[a->ex.own[k].mosfet.gate];
    a->edges_are_shown = !known || ns_bridge_shown_edges(ckt, shown);
    free(shown);
    return NS_OK;
}

static int make_waveform(CKTcircuit *ckt, ns_analysis *a, const ns_waveform_integrals *taken) {
    unsigned char *kind = calloc(a->count + 1, 1);
    const ns_waveform_options o = {.lines = a->ex.options.lines,
                                   .squares = a->ex.options.squares,
                                   .longest = ns_bridge_shown_tmax(ckt),
                                   .every = ns_bridge_timepoints_round(ckt->CKTfinalTime),
                                   .closest = ns_bridge_timepoints_closest(ckt->CKTfinalTime),
                                   .floor = {[VOLTAGE] = 1e-12, [CURRENT] = 1e-15},
                                   .kind = kind,
                                   .integrals = taken};
    a->many.tmax = o.longest;
    int status = kind ? choose_shown(ckt, a, kind) : NS_E_MEMORY;
    status = status ? status : ns_waveform_create(a->system, a->march, &o, &a->waveform);
    free(kind);
    return status;
}

static int make_tran(CKTcircuit *ckt, ns_analysis *a) {
    ns_waveform_integrals taken;
    ns_march *own = NULL;
    if (ns_bridge_digital_is(&a->ex.digital) && a->ex.options.grid) {
        ns_bridge_report_note("points = \"grid\" has no effect on a circuit with XSPICE's digital parts");
        a->ex.options.grid = 0;
    }
    int status = a->ex.options.grid ? make_march(a, &own, NULL) : NS_OK;
    if (!status)
        status = ns_bridge_taken_make(a, own, &taken);
    return status || own ? status : make_waveform(ckt, a, &taken);
}

static int build_march(CKTcircuit *ckt, ns_extract_sources sources, ns_analysis *a) {
    ns_fault fault = {.status = NS_OK};
    char line[320];
    int status = ns_circuit_system(a->ex.circuit, &a->system);
    status = status ? status : prepare_points(a);
    if (!status) {
        a->h = longest_step(a, ckt);
        status = make_march(a, &a->march, &fault);
    }
    if (!status && sources == SOURCES_TRAN)
        status = make_tran(ckt, a);
    if (!status)
        return OK;
    ns_bridge_analysis_explain(a, &fault, status, line, sizeof line);
    ns_bridge_report_error("%s", line);
    return ns_bridge_report_code(status);
}

int ns_bridge_analysis_make(CKTcircuit *ckt, ns_extract_sources sources, const ns_own_found *found,
                            ns_analysis *a) {
    int error;
    memset(a, 0, sizeof *a);
    error = ns_bridge_extract_read(ckt, sources, found, &a->ex);
    if (error)
        ns_bridge_report_error("%s", a->ex.line);
    else
        error = build_march(ckt, sources, a);
    if (error)
        ns_bridge_analysis_clear(a);
    return error;
}

void ns_bridge_analysis_clear(ns_analysis *a) {
    ns_waveform_free(a->waveform);
    ns_bridge_taken_clear(a);
    ns_bridge_many_points_clear(a);
    ns_bridge_chattering_clear(a);
    ns_march_free(a->march);
    ns_system_free(a->system);
    ns_bridge_extract_clear(&a->ex);
    free(a->unknown);
    free(a->held.unknown);
    free(a->held.value);
    free(a->buffers);
    free(a->mode);
    memset(a, 0, sizeof *a);
}

/* --- points --- */

void ns_bridge_analysis_unread(ns_analysis *a) {
    double *x = a->before;
    a->before = a->x;
    a->x = x;
    a->lambda = x + a->system->n;
}

int ns_bridge_analysis_read(ns_analysis *a, double *t) {
    double *x = a->before;
    int status = ns_march_read(a->march, t, x, x + a->system->n, NULL);
    for (size_t k = 0; k < a->count && !status; k++) {
        a->max_abs[k] = fabs(x[k]) > a->max_abs[k] ? fabs(x[k]) : a->max_abs[k];
        status = isfinite(x[k]) ? NS_OK : NS_E_OVERFLOW; /* no number for ngspice */
    }
    if (!status)
        ns_bridge_analysis_unread(a); /* swaps the two */
    return status;
}

int ns_bridge_analysis_take(ns_analysis *a, const ns_waveform_point *p, double part) {
    const size_t n = (size_t)a->system->n;
    double *to = a->before;
    memcpy(to, p->x, n * sizeof *to);
    memcpy(to + n, p->lambda, (a->count - n) * sizeof *to);
    for (size_t k = 0; part < 1.0 && k < a->count; k++)
        to[k] = a->x[k] + part * (to[k] - a->x[k]);
    for (size_t k = 0; k < a->count; k++) {
        const double size = fabs(to[k]);
        if (!isfinite(size))
            return NS_E_OVERFLOW;
        a->max_abs[k] = size > a->max_abs[k] ? size : a->max_abs[k];
    }
    ns_bridge_analysis_take_mode(a, p->mode);
    ns_bridge_taken_at(a, p->sums, part);
    ns_bridge_analysis_unread(a);
    return NS_OK;
}

int ns_bridge_analysis_moved(const ns_analysis *a, double fraction) {
    for (size_t k = 0; k < a->count; k++)
        if (fabs(a->x[k] - a->before[k]) > fraction * a->max_abs[k])
            return 1;
    return 0;
}
