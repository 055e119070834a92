/* bridge/expression_sources.c - sources that expressions share: the time, and functions of it. */
#include "expression.h"

#include <math.h>
#include <stdlib.h>

#include "models.h"
#include "pure/timepoints.h"
#include "sources.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

/* Of the run, s. */
static double stop_of(const ns_extract_walk *w) {
    return w->ckt->CKTfinalTime > 0.0 ? w->ckt->CKTfinalTime : 1.0;
}

int ns_bridge_expression_wave(ns_extract_walk *w, const char *kind, const ns_signal *z, int *node) {
    char name[EXTRACT_NAME];
    const ns_signal dc = {.kind = NS_DC, .u.dc = ns_signal_value(z, 0.0, NS_RIGHT)};
    *node = ns_bridge_extract_new_node(w);
    snprintf(name, sizeof name, "%s (%d)", kind, *node);
    const int status = ns_circuit_source(w->ex->circuit, name, NS_VOLTAGE, *node, 0, w->dc ? &dc : z, NULL);
    return status ? status : ns_circuit_name_node(w->ex->circuit, *node, name);
}

int ns_bridge_expression_time(ns_extract_walk *w, int *node) {
    const double t[2] = {0.0, 2.0 * stop_of(w)};
    ns_signal z = {.kind = NS_PWL};
    z.u.pwl.n = 2;
    z.u.pwl.t = z.u.pwl.v = t;
    z.u.pwl.repeat = NAN;
    const int status = w->time_node > 0 ? NS_OK : ns_bridge_expression_wave(w, "time", &z, &w->time_node);
    *node = w->time_node;
    return status;
}

const GENinstance *ns_bridge_expression_holder(const ns_extract_walk *w, int node, int constant, int *sign) {
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        if (ns_bridge_models_letter(box->data) != 'v')
            continue;
        const VSRCinstance *v = box->data;
        *sign = v->VSRCposNode == node && v->VSRCnegNode == 0 ? 1 : -1;
        if ((*sign > 0 || (v->VSRCnegNode == node && v->VSRCposNode == 0)) &&
            !(constant && v->VSRCfunctionType))
            return box->data;
    }
    return NULL;
}

int ns_bridge_expression_supply(const ns_extract_walk *w, int node, double *volts) {
    int sign;
    const GENinstance *inst = ns_bridge_expression_holder(w, node, !w->dc, &sign);
    const VSRCinstance *v = (const VSRCinstance *)inst;
    ns_signal z = {.kind = NS_DC, .u.dc = v ? v->VSRCdcValue : 0.0};
    double *points = NULL;
    if (!v || (v->VSRCfunctionType && ns_bridge_sources_signal(w->ckt, inst, 1, &z, &points)))
        return 0;
    free(points);
    *volts = sign * z.u.dc;
    return 1;
}

int ns_bridge_expression_sawtooth(ns_extract_walk *w, double slope, double offset, int late, int *node) {
    const double period = 1.0 / fabs(slope), lag = ns_bridge_timepoints_closest(stop_of(w));
    ns_signal z = {.kind = NS_PULSE};
    z.u.pulse.v2 = 1.0;
    z.u.pulse.td = ((slope > 0.0 ? floor(offset) : ceil(offset)) - offset) / slope;
    z.u.pulse.tr = slope > 0.0 ? period : 0.0;
    z.u.pulse.tf = period - z.u.pulse.tr;
    z.u.pulse.per = period;
    if (late) /* a pulse of td = 0 is already high at t = 0 */
        z.u.pulse.td = slope > 0.0 ? lag - period : lag;
    return ns_bridge_expression_wave(w, "sawtooth", &z, node);
}

/* y(x) on the line through points a and b (x, y each). */
static double on_line(const double *a, const double *b, double x) {
    return a[1] + (b[1] - a[1]) * ((x - a[0]) / (b[0] - a[0]));
}

/* The first and the last piece go on for ever. */
static double line_at(int n, const double *xy, double x) {
    int k = 0;
    while (k + 2 < n && x >= xy[2 * (k + 1)])
        k++;
    return on_line(xy + 2 * k, xy + 2 * (k + 1), x);
}

/* The corners between t = 0 and the end, by ascending t; t[0] and the last one are 0 and the end. */
static int line_points(double slope, double offset, int n, const double *xy, double end, double *t,
                       double *v) {
    int m = 0;
    t[m] = 0.0;
    v[m++] = line_at(n, xy, offset);
    for (int k = 0; k < n; k++) {
        const double *at = xy + 2 * (slope > 0.0 ? k : n - 1 - k);
        const double when = (at[0] - offset) / slope;
        if (when > 0.0 && when < end) {
            t[m] = when;
            v[m++] = at[1];
        }
    }
    t[m] = end;
    v[m++] = line_at(n, xy, slope * end + offset);
    return m;
}

int ns_bridge_expression_line(ns_extract_walk *w, double slope, double offset, int n, const double *xy,
                              int *node) {
    double *t = calloc(2 * ((size_t)n + 2), sizeof *t);
    ns_signal z = {.kind = NS_PWL};
    if (!t)
        return NS_E_MEMORY;
    z.u.pwl.n = line_points(slope, offset, n, xy, 2.0 * stop_of(w), t, t + n + 2);
    z.u.pwl.t = t;
    z.u.pwl.v = t + n + 2;
    z.u.pwl.repeat = NAN;
    const int status = ns_bridge_expression_wave(w, "line", &z, node);
    free(t);
    return status;
}
