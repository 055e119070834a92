/* bridge/show.c - what a user sees of a point: node voltages, branch currents, @ad1[on], the summary. */
#include "show.h"

#include <stdio.h>
#include <string.h>

#include "display.h"
#include "own_show.h"
#include "report.h"
#include "taken.h"

void ns_bridge_show_currents(const ns_analysis *a, double *value) {
    for (int k = 0; k < a->ex.ndevices; k++) {
        const ns_extract_device *d = &a->ex.device[k];
        ns_circuit_device(a->ex.circuit, d->id, a->x, a->lambda, a->mode,
                          &value[ns_bridge_models_branch(d->inst)], NULL, NULL);
    }
    ns_bridge_own_show_values(a, value);
    ns_bridge_display_values(&a->ex, value);
}

void ns_bridge_show_values(const ns_analysis *a, double *value) {
    for (int eq = 0; eq < a->ex.neq; eq++)
        value[eq] = a->unknown[eq] >= 0 ? a->x[a->unknown[eq]] : 0.0;
    ns_bridge_show_currents(a, value);
}

void ns_bridge_show_later(ns_analysis *a) {
    if (!a->waveform) /* else it came with the point */
        ns_bridge_analysis_take_mode(a, ns_march_mode(a->march));
    a->devices_stale = 1;
}

void ns_bridge_show_devices(ns_analysis *a) {
    for (int k = 0; k < a->ex.ndevices && a->devices_stale; k++) {
        Mif_Inst_Var_Data_t **show = a->ex.device[k].inst->inst_var;
        double i = 0.0;
        double v = 0.0;
        int on = 0;
        ns_circuit_device(a->ex.circuit, a->ex.device[k].id, a->x, a->lambda, a->mode, &i, &v, &on);
        show[SHOW_I]->element[0].rvalue = i;
        show[SHOW_V]->element[0].rvalue = v;
        show[SHOW_ON]->element[0].rvalue = on; /* ngspice saves reals only */
        show[SHOW_P]->element[0].rvalue = v * i;
        ns_bridge_taken_show(a, k, &show[SHOW_Q]->element[0].rvalue, &show[SHOW_E]->element[0].rvalue);
    }
    a->devices_stale = 0;
}

static void add_count(char *line, size_t size, long n, const char *one, const char *many) {
    const size_t length = strlen(line);
    snprintf(line + length, size - length, " %ld %s,", n, n == 1 ? one : many);
}

void ns_bridge_show_summary(const ns_analysis *a, double cpu) {
    const ns_counts *c = ns_march_counts(a->march);
    char line[300] = "";
    add_count(line, sizeof line, c->steps, "step", "steps");
    add_count(line, sizeof line, c->events, "event", "events");
    if (c->modes > 0)
        add_count(line, sizeof line, c->modes, "mode", "modes");
    add_count(line, sizeof line, c->pivots, "pivot", "pivots");
    add_count(line, sizeof line, c->factors, "factorisation", "factorisations");
    add_count(line, sizeof line, c->maps, "step matrix", "step matrices");
    if (c->islands > 0)
        add_count(line, sizeof line, c->islands, "island", "islands");
    add_count(line, sizeof line, c->checks, "check", "checks");
    if (c->retries > 0)
        add_count(line, sizeof line, c->retries, "retry", "retries");
    if (c->looks > 0)
        add_count(line, sizeof line, c->looks, "look at thresholds", "looks at thresholds");
    ns_bridge_report_note("%s:%s %.3g ms CPU time", ns_bridge_options_method(ns_march_engine(a->march)), line,
                          1e3 * cpu);
}
