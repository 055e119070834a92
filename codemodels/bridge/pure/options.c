/* bridge/pure/options.c - the options of a run. */
#include "options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const ns_bridge_options ns_bridge_options_default = {
    .method = NS_AUTO, .theta = 1.0, .gamma = 1.0, .lines = 1e-4, .corners = 1, .id = NAN, .vgs = NAN};

static const char *const methods[] = {
    [NS_AUTO] = "auto", [NS_THETA] = "theta", [NS_EXACT] = "exact", [NS_SPARSE] = "sparse"};
enum { METHODS = sizeof methods / sizeof methods[0] };

const char *ns_bridge_options_method(ns_method method) {
    return methods[method];
}

static int read_method(const ns_options_given *given, ns_method *method, char *line, size_t size) {
    if (!given->method)
        return NS_OK;
    for (int k = 0; k < METHODS; k++) {
        if (strcmp(given->method, methods[k]) == 0) {
            *method = (ns_method)k;
            return NS_OK;
        }
    }
    snprintf(line, size, "%s: method = \"%s\" must be \"auto\", \"exact\", \"sparse\" or \"theta\"",
             given->name, given->method);
    return NS_E_RANGE;
}

static int read_points(const ns_options_given *given, int *grid, char *line, size_t size) {
    *grid = given->points && strcmp(given->points, "grid") == 0;
    if (!given->points || *grid || strcmp(given->points, "auto") == 0)
        return NS_OK;
    snprintf(line, size, "%s: points = \"%s\" must be \"auto\" or \"grid\"", given->name, given->points);
    return NS_E_RANGE;
}

static int read_take(const ns_options_given *given, ns_bridge_options *o, char *line, size_t size) {
    static const char *const words[] = {"none", "switches", "diodes", "all"};
    for (int k = 0; k < 4; k++) {
        if (strcmp(given->take ? given->take : "none", words[k]) == 0) {
            o->take_switches = k & 1;
            o->take_diodes = k >= 2;
            return NS_OK;
        }
    }
    snprintf(line, size, "%s: take = \"%s\" must be \"none\", \"switches\", \"diodes\" or \"all\"",
             given->name, given->take);
    return NS_E_RANGE;
}

static int read_diode(const ns_options_given *given, ns_bridge_options *o, char *line, size_t size) {
    o->zero_diodes = given->diode && strcmp(given->diode, "zero") == 0;
    if (!given->diode || o->zero_diodes || strcmp(given->diode, "model") == 0)
        return NS_OK;
    snprintf(line, size, "%s: diode = \"%s\" must be \"model\" or \"zero\"", given->name, given->diode);
    return NS_E_RANGE;
}

static int read_mosfet(const ns_options_given *given, ns_bridge_options *o, char *line, size_t size) {
    static const char *const words[] = {
        [NS_MOSFETS_NONE] = "none", [NS_MOSFETS_DRIVEN] = "driven", [NS_MOSFETS_ALL] = "switch"};
    for (int k = 0; k < 3; k++) {
        if (strcmp(given->mosfet ? given->mosfet : "none", words[k]) == 0) {
            o->mosfets = (ns_mosfets)k;
            return NS_OK;
        }
    }
    snprintf(line, size, "%s: mosfet = \"%s\" must be \"none\", \"driven\" or \"switch\"", given->name,
             given->mosfet);
    return NS_E_RANGE;
}

static int check_numbers(const ns_options_given *g, char *line, size_t size) {
    static const char weight[] = "must be above 0 and at most 1", flag[] = "must be 0 or 1";
    const struct {
        const char *name;
        double value;
        int is_right;
        const char *rule;
    } checks[] = {{"h", g->h, isnan(g->h) || (g->h > 0.0 && isfinite(g->h)), "s must be above 0"},
                  {"theta", g->theta, g->theta > 0.0 && g->theta <= 1.0, weight},
                  {"gamma", g->gamma, g->gamma > 0.0 && g->gamma <= 1.0, weight},
                  {"verbose", g->verbose, g->verbose == 0 || g->verbose == 1, flag},
                  {"corners", g->corners, g->corners == 0 || g->corners == 1, flag},
                  {"lines", g->lines, g->lines > 0.0 && g->lines <= 0.1, "must be above 0 and at most 0.1"},
                  {"id", g->id, isnan(g->id) || (g->id > 0.0 && isfinite(g->id)), "A must be above 0"},
                  {"vgs", g->vgs, isnan(g->vgs) || (g->vgs > 0.0 && isfinite(g->vgs)), "V must be above 0"},
                  {"cjo", g->cjo, g->cjo == 0 || g->cjo == 1, flag},
                  {"squares", g->squares, g->squares >= 0.0 && g->squares <= 0.1, "must be 0 to 0.1"},
                  {"reltol", g->reltol, isnan(g->reltol) || (g->reltol > 0.0 && g->reltol < 1.0),
                   "must be above 0 and below 1"}};
    for (size_t k = 0; k < sizeof checks / sizeof checks[0]; k++) {
        if (!checks[k].is_right) {
            snprintf(line, size, "%s: %s = %g %s", g->name, checks[k].name, checks[k].value, checks[k].rule);
            return NS_E_RANGE;
        }
    }
    return NS_OK;
}

int ns_bridge_options_check(const ns_options_given *given, ns_bridge_options *o, char *line, size_t size) {
    int status = read_method(given, &o->method, line, size);
    status = status ? status : read_points(given, &o->grid, line, size);
    status = status ? status : read_take(given, o, line, size);
    status = status ? status : read_diode(given, o, line, size);
    status = status ? status : read_mosfet(given, o, line, size);
    o->h = isnan(given->h) ? 0.0 : given->h;
    o->theta = given->theta;
    o->gamma = given->gamma;
    o->reltol = isnan(given->reltol) ? 0.0 : given->reltol;
    o->verbose = given->verbose;
    o->corners = given->corners;
    o->id = given->id;
    o->vgs = given->vgs;
    o->cjo = given->cjo;
    o->lines = given->lines;
    o->squares = given->squares;
    return status ? status : check_numbers(given, line, size);
}
