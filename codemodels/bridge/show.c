/* bridge/show.c - what a user sees of a point: node voltages, branch currents, @ad1[i], the summary. */
#include "show.h"

#include <stdio.h>
#include <string.h>

#include "report.h"

void ns_bridge_show_values(const ns_analysis *e, const double *x, double *value) {
    for (int eq = 0; eq < e->ex.neq; eq++) {
        value[eq] = e->unknown[eq] >= 0 ? x[e->unknown[eq]] : 0.0;
    }
}

void ns_bridge_show_later(ns_analysis *e) {
    memcpy(e->mode, ns_march_mode(e->march), (size_t)e->system->m * sizeof *e->mode);
    e->shown = 0;
}

void ns_bridge_show_devices(ns_analysis *e) {
    for (int k = 0; k < e->ex.ndevices && !e->shown; k++) {
        Mif_Inst_Var_Data_t **show = e->ex.device[k].inst->inst_var;
        double i = 0.0;
        double v = 0.0;
        int on = 0;
        ns_circuit_device(e->ex.circuit, e->ex.device[k].id, e->x, e->lambda, e->mode, &i, &v, &on);
        show[SHOW_I]->element[0].rvalue = i;
        show[SHOW_V]->element[0].rvalue = v;
        show[SHOW_ON]->element[0].rvalue = on; /* ngspice saves reals only */
    }
    e->shown = 1;
}

void ns_bridge_show_summary(const ns_analysis *e, double cpu) {
    const ns_counts *c = ns_march_counts(e->march);
    char modes[40] = "", islands[40] = ""; /* of those who count them, where there are some */
    if (c->modes > 0) {
        snprintf(modes, sizeof modes, " %ld modes,", c->modes);
    }
    if (c->islands > 0) {
        snprintf(islands, sizeof islands, " %ld islands,", c->islands);
    }
    ns_bridge_report_note("%s: %ld steps, %ld events,%s %ld pivots, %ld factors, %ld maps,%s %.3g ms",
                          ns_bridge_options_method(ns_march_engine(e->march)), c->steps, c->events, modes,
                          c->pivots, c->factors, c->maps, islands, 1e3 * cpu);
}
