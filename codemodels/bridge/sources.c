/* bridge/sources.c - V and I of ngspice. */
#include "sources.h"

#include <string.h>

#include "elements.h"
#include "versions.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

_Static_assert((int)SOURCE_PULSE == PULSE && (int)SOURCE_SINE == SINE && (int)SOURCE_EXP == EXP &&
                   (int)SOURCE_PWL == PWL,
               "ngspice's function codes");

/* Signals as bytes without padding or pointers. */
static void mix_signal(ns_extract_walk *w, const ns_signal *z) {
    ns_signal plain;
    memcpy(&plain, z, sizeof plain);
    if (z->kind == NS_PWL) {
        ns_bridge_extract_mix(w, z->u.pwl.t, 2 * (size_t)z->u.pwl.n * sizeof(double));
        plain.u.pwl.t = plain.u.pwl.v = NULL;
    }
    ns_bridge_extract_mix(w, &plain, sizeof plain);
}

/* The name of inst after prefix. */
static int add_as(ns_extract_walk *w, const char *prefix, const GENinstance *inst, ns_output kind, int p,
                  int n, const ns_signal *z, int *id) {
    const size_t size = strlen(prefix) + strlen(inst->GENname) + 1;
    char *name = malloc(size);
    int status = NS_E_MEMORY;
    if (name) {
        snprintf(name, size, "%s%s", prefix, inst->GENname);
        status = ns_circuit_source(w->ex->circuit, name, kind, p, n, z, id);
    }
    free(name);
    return status;
}

/* .probe's sources bear the name of what they measure, which may be a source too: they get back the prefix
 * that ngspice took away. */
static int add_named(ns_extract_walk *w, const GENinstance *inst, ns_output kind, int p, int n,
                     const ns_signal *z, int *id) {
    static const char of_probe[] = "vcurr_";
    const int plain = ns_bridge_models_letter(inst) == inst->GENname[0];
    const int status = add_as(w, plain ? "" : of_probe, inst, kind, p, n, z, id);
    return plain && status == NS_E_NAME ? add_as(w, of_probe, inst, kind, p, n, z, id) : status;
}

static ns_source read_vsource(const VSRCinstance *v) {
    return (ns_source){.function = v->VSRCfunctionType,
                       .order = v->VSRCfunctionOrder,
                       .coeffs = v->VSRCcoeffs,
                       .dc_given = v->VSRCdcGiven,
                       .dc = v->VSRCdcValue,
                       .m = 1.0,
                       .pulse = ns_bridge_versions_pulse(0),
                       .repeats = v->VSRCrGiven,
                       .repeat_index = v->VSRCrBreakpt,
                       .delay = v->VSRCrdelay};
}

static ns_source read_isource(const ISRCinstance *i) {
    ns_source s = {.function = i->ISRCfunctionType,
                   .order = i->ISRCfunctionOrder,
                   .coeffs = i->ISRCcoeffs,
                   .dc_given = i->ISRCdcGiven,
                   .dc = i->ISRCdcValue,
                   .m = i->ISRCmGiven ? i->ISRCmValue : 1.0,
                   .pulse = ns_bridge_versions_pulse(1)};
    ns_bridge_versions_pwl_of_current(i, &s);
    return s;
}

const char *ns_bridge_sources_signal(const CKTcircuit *ckt, const GENinstance *inst, int as_dc, ns_signal *z,
                                     double **points) {
    ns_source s = ns_bridge_models_letter(inst) == 'v' ? read_vsource((const VSRCinstance *)inst)
                                                       : read_isource((const ISRCinstance *)inst);
    s.as_dc = as_dc;
    s.tstep = ckt->CKTstep > 0.0 ? ckt->CKTstep : 1.0; /* before the first .tran: any */
    s.tstop = ckt->CKTfinalTime > 0.0 ? ckt->CKTfinalTime : 1.0;
    return ns_bridge_source_signal(&s, z, points);
}

/* Adds the source from node p to n as *id; branch is the equation of its current, 0 if it has none. */
static int add_source(ns_extract_walk *w, GENinstance *inst, ns_output kind, int p, int n, int branch,
                      int *id) {
    ns_signal z;
    double *points;
    int status;
    const char *why = ns_bridge_sources_signal(w->ckt, inst, w->dc, &z, &points);
    if (why)
        return ns_bridge_extract_refuse(w, inst, why);
    mix_signal(w, &z);
    status = add_named(w, inst, kind, p, n, &z, id);
    ns_bridge_extract_current(w, branch, *id);
    free(points);
    return status;
}

int ns_bridge_sources_vsource(ns_extract_walk *w, GENinstance *inst) {
    const VSRCinstance *v = (const VSRCinstance *)inst;
    if (ns_bridge_versions_is_port(v))
        return ns_bridge_extract_refuse(w, inst, "an RF port is not supported");
    int id = -1;
    return add_source(w, inst, NS_VOLTAGE, v->VSRCposNode, v->VSRCnegNode, v->VSRCbranch, &id);
}

/* Its wave is kept. */
static int keep_wave(ns_extract *ex, GENinstance *inst, int id) {
    const int input = ns_circuit_input(ex->circuit, id);
    if (input < 0)
        return NS_OK;
    ns_extract_wave *more = realloc(ex->wave, (size_t)(ex->nwaves + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    ex->wave = more;
    ex->wave[ex->nwaves++] = (ns_extract_wave){inst, input};
    return NS_OK;
}

int ns_bridge_sources_isource(ns_extract_walk *w, GENinstance *inst) {
    const ISRCinstance *i = (const ISRCinstance *)inst;
    int id = -1;
    /* ngspice calls the second node of the line positive: it is where the current comes out */
    const int status = add_source(w, inst, NS_CURRENT, i->ISRCnegNode, i->ISRCposNode, 0, &id);
    return status ? status : keep_wave(w->ex, inst, id);
}
