/* bridge/sources.c - V and I of ngspice: function codes and coefficients -> signals, with ngspice's defaults.
 */
#include "elements.h"

#include <math.h>
#include <string.h>

#include "spicelib/devices/isrc/isrcdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

/* What both kinds of source share. */
typedef struct source {
    int function, order;
    const double *coeffs; /* order */
    int dc_given;
    double dc;
    int repeats;      /* PWL: r= was given */
    int repeat_index; /* in coeffs, of the time to go back to */
    double delay;     /* PWL: td= */
} source;

/* Coefficient k, or instead if there are fewer or, for zero_too, it is zero. */
static double coeff(const source *s, int k, int zero_too, double instead) {
    return k < s->order && (s->coeffs[k] != 0.0 || !zero_too) ? s->coeffs[k] : instead;
}

static const char *pulse(const source *s, const ns_extract_walk *w, ns_signal *z) {
    const double cycles = coeff(s, 7, 0, 0.0);
    z->kind = NS_PULSE;
    z->u.pulse.v1 = coeff(s, 0, 0, 0.0);
    z->u.pulse.v2 = coeff(s, 1, 0, 0.0);
    z->u.pulse.td = coeff(s, 2, 0, 0.0);
    z->u.pulse.tr = coeff(s, 3, 1, w->tstep);
    z->u.pulse.tf = coeff(s, 4, 1, w->tstep);
    z->u.pulse.pw = coeff(s, 5, 1, w->tstop);
    z->u.pulse.per = coeff(s, 6, 1, w->tstop);
    if (cycles > 0.0) {
        if (cycles != floor(cycles) || cycles > 1e9) {
            return "the number of pulses must be a whole number";
        }
        z->u.pulse.cycles = (int)cycles;
    }
    return NULL;
}

static const char *sine(const source *s, const ns_extract_walk *w, ns_signal *z) {
    z->kind = NS_SIN;
    z->u.sin.vo = coeff(s, 0, 0, 0.0);
    z->u.sin.va = coeff(s, 1, 0, 0.0);
    z->u.sin.freq = coeff(s, 2, 1, 1.0 / w->tstop);
    z->u.sin.td = coeff(s, 3, 0, 0.0);
    z->u.sin.theta = coeff(s, 4, 0, 0.0);
    z->u.sin.phase = coeff(s, 5, 0, 0.0);
    return NULL;
}

static const char *exponential(const source *s, const ns_extract_walk *w, ns_signal *z) {
    z->kind = NS_EXP;
    z->u.exp.v1 = coeff(s, 0, 0, 0.0);
    z->u.exp.v2 = coeff(s, 1, 0, 0.0);
    z->u.exp.td1 = coeff(s, 2, 1, w->tstep);
    z->u.exp.tau1 = coeff(s, 3, 1, w->tstep);
    z->u.exp.td2 = coeff(s, 4, 1, z->u.exp.td1 + w->tstep);
    z->u.exp.tau2 = coeff(s, 5, 1, w->tstep);
    return NULL;
}

/* Times and values of a PWL lie one after the other in *points, which the caller frees. */
static const char *piecewise(const source *s, ns_signal *z, double **points) {
    const int n = s->order / 2;
    double *t = n > 0 ? malloc(2 * (size_t)n * sizeof *t) : NULL;
    if (!t) {
        return n > 0 ? "out of memory" : "PWL without points";
    }
    for (int i = 0; i < n; i++) {
        t[i] = s->coeffs[2 * i];
        t[n + i] = s->coeffs[2 * i + 1];
    }
    *points = t;
    z->kind = NS_PWL;
    z->u.pwl.n = n;
    z->u.pwl.t = t;
    z->u.pwl.v = t + n;
    z->u.pwl.td = s->delay;
    z->u.pwl.repeat = s->repeats ? s->coeffs[s->repeat_index] : NAN;
    return NULL;
}

/* Makes the signal; returns why not, or NULL. */
static const char *make_signal(const source *s, const ns_extract_walk *w, ns_signal *z, double **points) {
    memset(z, 0, sizeof *z);
    switch (w->dc && s->dc_given ? 0 : s->function) {
    case 0:
        z->kind = NS_DC;
        z->u.dc = s->dc;
        return NULL;
    case PULSE:
        return pulse(s, w, z);
    case SINE:
        return sine(s, w, z);
    case EXP:
        return exponential(s, w, z);
    case PWL:
        return piecewise(s, z, points);
    case SFFM:
        return "an SFFM source cannot be taken yet; DC, PULSE, SIN, EXP and PWL can";
    case AM:
        return "an AM source cannot be taken yet; DC, PULSE, SIN, EXP and PWL can";
    case TRNOISE:
    case TRRANDOM:
        return "a random source cannot be taken; DC, PULSE, SIN, EXP and PWL can";
    default:
        return "this kind of source cannot be taken; DC, PULSE, SIN, EXP and PWL can";
    }
}

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

/* m equal sources side by side. */
static void side_by_side(ns_signal *z, double *points, double m) {
    switch (z->kind) {
    case NS_DC:
        z->u.dc *= m;
        break;
    case NS_PULSE:
        z->u.pulse.v1 *= m;
        z->u.pulse.v2 *= m;
        break;
    case NS_SIN:
        z->u.sin.vo *= m;
        z->u.sin.va *= m;
        break;
    case NS_EXP:
        z->u.exp.v1 *= m;
        z->u.exp.v2 *= m;
        break;
    case NS_PWL:
        for (int i = 0; i < z->u.pwl.n; i++) {
            points[z->u.pwl.n + i] *= m;
        }
        break;
    }
}

/* .probe's sources bear the name of what they measure: they get back the prefix that ngspice took away. */
static int add_named(ns_extract_walk *w, const GENinstance *inst, ns_output kind, int p, int n,
                     const ns_signal *z, int *id) {
    static const char prefix[] = "vcurr_";
    const size_t size = strlen(inst->GENname) + sizeof prefix;
    char *name;
    int status;
    if (ns_bridge_models_letter(inst) == inst->GENname[0]) {
        return ns_circuit_source(w->ex->circuit, inst->GENname, kind, p, n, z, id);
    }
    name = malloc(size);
    if (!name) {
        return NS_E_MEMORY;
    }
    snprintf(name, size, "%s%s", prefix, inst->GENname);
    status = ns_circuit_source(w->ex->circuit, name, kind, p, n, z, id);
    free(name);
    return status;
}

/* Adds the source; branch is the equation of its current, 0 if it has none. */
static int add(ns_extract_walk *w, GENinstance *inst, ns_output kind, int p, int n, const source *s, double m,
               int branch) {
    ns_signal z;
    double *points = NULL;
    int id = -1;
    int status;
    const char *why = make_signal(s, w, &z, &points);
    if (why) {
        return ns_bridge_extract_refuse(w, inst, why);
    }
    if (m != 1.0) {
        side_by_side(&z, points, m);
    }
    if (w->dc && z.kind != NS_DC) { /* ngspice's DC value is the function's at t = 0 */
        const double value = ns_signal_value(&z, 0.0, NS_LEFT);
        memset(&z, 0, sizeof z);
        z.kind = NS_DC;
        z.u.dc = value;
    }
    mix_signal(w, &z);
    status = add_named(w, inst, kind, p, n, &z, &id);
    ns_bridge_extract_current(w, branch, id);
    free(points);
    return status;
}

int ns_bridge_sources_vsource(ns_extract_walk *w, GENinstance *inst) {
    const VSRCinstance *v = (const VSRCinstance *)inst;
    const source s = {v->VSRCfunctionType, v->VSRCfunctionOrder, v->VSRCcoeffs,   v->VSRCdcGiven,
                      v->VSRCdcValue,      v->VSRCrGiven,        v->VSRCrBreakpt, v->VSRCrdelay};
#ifdef RFSPICE
    if (v->VSRCisPort) {
        return ns_bridge_extract_refuse(w, inst, "an RF port cannot be taken");
    }
#endif
    return add(w, inst, NS_VOLTAGE, v->VSRCposNode, v->VSRCnegNode, &s, 1.0, v->VSRCbranch);
}

int ns_bridge_sources_isource(ns_extract_walk *w, GENinstance *inst) {
    const ISRCinstance *i = (const ISRCinstance *)inst;
    const source s = {
        i->ISRCfunctionType, i->ISRCfunctionOrder, i->ISRCcoeffs, i->ISRCdcGiven, i->ISRCdcValue, 0, 0, 0.0};
    const double m = i->ISRCmGiven ? i->ISRCmValue : 1.0;
    w->ex->restless = w->ex->restless || i->ISRCfunctionType != 0;
    /* ngspice calls the second node of the line positive: it is where the current comes out */
    return add(w, inst, NS_CURRENT, i->ISRCnegNode, i->ISRCposNode, &s, m, 0);
}
