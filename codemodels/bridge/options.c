/* bridge/options.c - the options of a run, from the instance of model `nonsmooth`. */
#include "options.h"

#include <math.h>
#include <string.h>

void ns_bridge_options_default(ns_bridge_options *o) {
    *o = (ns_bridge_options){.method = NS_AUTO, .theta = 1.0, .gamma = 1.0, .corners = 1};
}

static const struct {
    const char *word;
    ns_method method;
} methods[] = {{"auto", NS_AUTO}, {"theta", NS_THETA}, {"exact", NS_EXACT}, {"sparse", NS_SPARSE}};

const char *ns_bridge_options_method(ns_method method) {
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        if (methods[i].method == method) {
            return methods[i].word;
        }
    }
    return "?";
}

static int read_method(const MIFinstance *inst, ns_method *method, char *line, size_t size) {
    const char *word = inst->param[OPTION_METHOD]->element[0].svalue;
    if (!word) {
        return OK;
    }
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        if (strcmp(word, methods[i].word) == 0) {
            *method = methods[i].method;
            return OK;
        }
    }
    snprintf(line, size, "%s: method=%s is %s; auto, theta, exact and sparse are there", inst->MIFname, word,
             strcmp(word, "hosted") == 0 ? "not there yet" : "unknown");
    return strcmp(word, "hosted") == 0 ? E_UNSUPP : E_PARMVAL;
}

static int check_weight(const MIFinstance *inst, const char *name, double value, char *line, size_t size) {
    if (value > 0.0 && value <= 1.0) {
        return OK;
    }
    snprintf(line, size, "%s: %s = %g is outside (0, 1]", inst->MIFname, name, value);
    return E_PARMVAL;
}

/* 0 if it was not given. */
static double given(const MIFinstance *inst, int parameter) {
    return inst->param[parameter]->is_null ? 0.0 : ns_bridge_models_real(inst, parameter);
}

static int check_reltol(const MIFinstance *inst, double value, char *line, size_t size) {
    if (inst->param[OPTION_RELTOL]->is_null || (value > 0.0 && value < 1.0)) {
        return OK;
    }
    snprintf(line, size, "%s: reltol = %g is outside (0, 1)", inst->MIFname, value);
    return E_PARMVAL;
}

static int check_flag(const MIFinstance *inst, const char *name, int value, char *line, size_t size) {
    if (value == 0 || value == 1) {
        return OK;
    }
    snprintf(line, size, "%s: %s = %d is neither 0 nor 1", inst->MIFname, name, value);
    return E_PARMVAL;
}

int ns_bridge_options_read(const MIFinstance *inst, ns_bridge_options *o, char *line, size_t size) {
    int error = read_method(inst, &o->method, line, size);
    o->given = inst;
    o->h = ns_bridge_models_real(inst, OPTION_H);
    o->theta = ns_bridge_models_real(inst, OPTION_THETA);
    o->gamma = ns_bridge_models_real(inst, OPTION_GAMMA);
    o->reltol = given(inst, OPTION_RELTOL);
    o->verbose = inst->param[OPTION_VERBOSE]->element[0].ivalue;
    o->corners = inst->param[OPTION_CORNERS]->element[0].ivalue;
    if (!error && !inst->param[OPTION_H]->is_null && !(o->h > 0.0 && isfinite(o->h))) {
        snprintf(line, size, "%s: h = %g s is not above 0", inst->MIFname, o->h);
        error = E_PARMVAL;
    }
    error = error ? error : check_weight(inst, "theta", o->theta, line, size);
    error = error ? error : check_weight(inst, "gamma", o->gamma, line, size);
    error = error ? error : check_flag(inst, "verbose", o->verbose, line, size);
    error = error ? error : check_flag(inst, "corners", o->corners, line, size);
    return error ? error : check_reltol(inst, o->reltol, line, size);
}

const char *ns_bridge_options_dump(const ns_bridge_options *o) {
    const char *file = NULL;
    if (o->given && !o->given->param[OPTION_DUMP]->is_null) {
        file = o->given->param[OPTION_DUMP]->element[0].svalue;
    }
    return file && *file ? file : NULL;
}
