/* bridge/options.c - the options of a run, from the instance of model `nonsmooth`. */
#include "options.h"

#include <math.h>
#include <string.h>

void options_default(options *o) {
    *o = (options){.h = 0.0, .theta = 1.0, .gamma = 1.0, .reltol = 0.0, .verbose = 0, .given = NULL};
}

static int one_of(const char *word, const char *const *words, int n) {
    for (int i = 0; i < n; i++) {
        if (strcmp(word, words[i]) == 0) {
            return 1;
        }
    }
    return 0;
}

static int check_method(const MIFinstance *inst, char *line, size_t size) {
    static const char *const here[] = {"auto", "theta"};
    static const char *const later[] = {"flight", "sparse", "hosted"};
    const char *method = inst->param[OPTION_METHOD]->element[0].svalue;
    if (!method || one_of(method, here, 2)) {
        return OK;
    }
    if (one_of(method, later, 3)) {
        snprintf(line, size, "%s: method=%s is not there yet; auto and theta are", inst->MIFname, method);
        return E_UNSUPP;
    }
    snprintf(line, size, "%s: method=%s is unknown; auto and theta are there", inst->MIFname, method);
    return E_PARMVAL;
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
    return inst->param[parameter]->is_null ? 0.0 : models_real(inst, parameter);
}

static int check_reltol(const MIFinstance *inst, double value, char *line, size_t size) {
    if (inst->param[OPTION_RELTOL]->is_null || (value > 0.0 && value < 1.0)) {
        return OK;
    }
    snprintf(line, size, "%s: reltol = %g is outside (0, 1)", inst->MIFname, value);
    return E_PARMVAL;
}

int options_read(const MIFinstance *inst, options *o, char *line, size_t size) {
    int error = check_method(inst, line, size);
    o->given = inst;
    o->h = models_real(inst, OPTION_H);
    o->theta = models_real(inst, OPTION_THETA);
    o->gamma = models_real(inst, OPTION_GAMMA);
    o->reltol = given(inst, OPTION_RELTOL);
    o->verbose = inst->param[OPTION_VERBOSE]->element[0].ivalue;
    if (!error && !inst->param[OPTION_H]->is_null && !(o->h > 0.0 && isfinite(o->h))) {
        snprintf(line, size, "%s: h = %g s is not above 0", inst->MIFname, o->h);
        error = E_PARMVAL;
    }
    error = error ? error : check_weight(inst, "theta", o->theta, line, size);
    error = error ? error : check_weight(inst, "gamma", o->gamma, line, size);
    return error ? error : check_reltol(inst, o->reltol, line, size);
}

const char *options_dump(const options *o) {
    const char *file = NULL;
    if (o->given && !o->given->param[OPTION_DUMP]->is_null) {
        file = o->given->param[OPTION_DUMP]->element[0].svalue;
    }
    return file && *file ? file : NULL;
}
