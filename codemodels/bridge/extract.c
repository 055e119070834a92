/* bridge/extract.c - ngspice's circuit read into a circuit of the library: the walk over its instances. */
#include "extract.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "ngspice/enh.h"

#include "analog.h"
#include "display.h"
#include "elements.h"
#include "foreign.h"
#include "own_elements.h"
#include "own_models.h"
#include "report.h"

/* --- our own --- */

static int add_device(ns_extract_walk *w, MIFinstance *inst, int id) {
    ns_extract_device *more = realloc(w->ex->device, (size_t)(w->ex->ndevices + 1) * sizeof *more);
    if (!more)
        return NS_E_MEMORY;
    w->ex->device = more;
    w->ex->device[w->ex->ndevices++] = (ns_extract_device){inst, id};
    return NS_OK;
}

static int read_diode(ns_extract_walk *w, MIFinstance *inst) {
    const ns_diode d = {.vf = ns_bridge_models_real(inst, DIODE_VF),
                        .ron = ns_bridge_models_real(inst, DIODE_RON),
                        .roff = ns_bridge_models_ohms(inst, DIODE_ROFF),
                        .vz = ns_bridge_models_ohms(inst, DIODE_VZ),
                        .rz = ns_bridge_models_real(inst, DIODE_RZ)};
    int id = -1;
    int status = ns_circuit_diode(w->ex->circuit, inst->MIFname, ns_bridge_models_node(inst, DIODE_ANODE),
                                  ns_bridge_models_node(inst, DIODE_CATHODE), &d, &id);
    ns_bridge_extract_mix(w, &d, sizeof d);
    return status ? status : add_device(w, inst, id);
}

static int read_switch(ns_extract_walk *w, MIFinstance *inst) {
    const ns_switch s = {.vt = ns_bridge_models_real(inst, SWITCH_VT),
                         .vh = ns_bridge_models_real(inst, SWITCH_VH),
                         .ron = ns_bridge_models_real(inst, SWITCH_RON),
                         .roff = ns_bridge_models_ohms(inst, SWITCH_ROFF)};
    int id = -1;
    int status =
        ns_circuit_switch(w->ex->circuit, inst->MIFname, ns_bridge_models_node(inst, SWITCH_P),
                          ns_bridge_models_node(inst, SWITCH_N), ns_bridge_models_node(inst, SWITCH_CP),
                          ns_bridge_models_node(inst, SWITCH_CN), &s, &id);
    ns_bridge_extract_mix(w, &s, sizeof s);
    return status ? status : add_device(w, inst, id);
}

static int read_options(ns_extract_walk *w, MIFinstance *inst) {
    ns_extract *ex = w->ex;
    if (ex->options_inst) {
        char what[160];
        snprintf(what, sizeof what, "a circuit has one instance of model nonsmooth, and %.80s is one already",
                 ex->options_inst->MIFname);
        return ns_bridge_extract_refuse(w, &inst->gen, what);
    }
    ex->options_inst = inst;
    const ns_options_given given = {.name = inst->MIFname,
                                    .method = ns_bridge_models_text(inst, OPTION_METHOD),
                                    .h = ns_bridge_models_given(inst, OPTION_H),
                                    .reltol = ns_bridge_models_given(inst, OPTION_RELTOL),
                                    .theta = ns_bridge_models_real(inst, OPTION_THETA),
                                    .gamma = ns_bridge_models_real(inst, OPTION_GAMMA),
                                    .verbose = inst->param[OPTION_VERBOSE]->element[0].ivalue,
                                    .points = ns_bridge_models_text(inst, OPTION_POINTS),
                                    .lines = ns_bridge_models_real(inst, OPTION_LINES),
                                    .squares = ns_bridge_models_real(inst, OPTION_SQUARES),
                                    .take = ns_bridge_models_text(inst, OPTION_TAKE),
                                    .diode = ns_bridge_models_text(inst, OPTION_DIODE),
                                    .id = ns_bridge_models_given(inst, OPTION_ID),
                                    .mosfet = ns_bridge_models_text(inst, OPTION_MOSFET),
                                    .vgs = ns_bridge_models_given(inst, OPTION_VGS),
                                    .cjo = inst->param[OPTION_CJO]->element[0].ivalue,
                                    .corners = inst->param[OPTION_CORNERS]->element[0].ivalue};
    ex->error =
        ns_bridge_report_code(ns_bridge_options_check(&given, &ex->options, ex->line, sizeof ex->line));
    const double numbers[] = {
        ex->options.h,     ex->options.theta,   ex->options.gamma,       (double)ex->options.method,
        ex->options.lines, ex->options.squares, (double)ex->options.grid};
    ns_bridge_extract_mix(w, numbers, sizeof numbers);
    return ex->error ? EXTRACT_REFUSED : NS_OK;
}

static int read_foreign(ns_extract_walk *w, GENinstance *inst) {
    MIFinstance *mif = (MIFinstance *)inst;
    const char *model = ns_bridge_foreign_model(mif);
    int status;
    if (model && ns_bridge_own_models(w, mif, model, &status))
        return status;
    if (!model)
        return ns_bridge_extract_refuse(w, inst,
                                        "which code model it is of cannot be told: a library of code models "
                                        "was loaded twice, leave its second line codemodel out");
    if (mif->analog && inst->GENmodPtr->GENmodType > ns_bridge_models_any(NULL))
        return ns_bridge_extract_refuse(
            w, inst,
            "its code models were loaded after nonsmooth.cm: put the line codemodel .../nonsmooth.cm last");
    return mif->event_driven ? ns_bridge_digital_read(w, mif, model) : ns_bridge_analog_read(w, mif, model);
}

static int read_ours(ns_extract_walk *w, GENinstance *inst) {
    MIFinstance *mif = (MIFinstance *)inst;
    switch (ns_bridge_models_kind(inst)) {
    case KIND_DIODE:
        return read_diode(w, mif);
    case KIND_SWITCH:
        return read_switch(w, mif);
    case KIND_OPTIONS:
        return NS_OK; /* was read first */
    default:
        return read_foreign(w, inst);
    }
}

/* --- the walk --- */

static const struct element_reader {
    char letter;
    ns_extract_reader *read;
} readers[] = {{'r', ns_bridge_elements_resistor},  {'c', ns_bridge_elements_capacitor},
               {'l', ns_bridge_elements_inductor},  {'k', ns_bridge_elements_coupling},
               {'v', ns_bridge_sources_vsource},    {'i', ns_bridge_sources_isource},
               {'e', ns_bridge_elements_vcvs},      {'g', ns_bridge_elements_vccs},
               {'f', ns_bridge_elements_cccs},      {'h', ns_bridge_elements_ccvs},
               {'b', ns_bridge_behavioural},        {'a', read_ours},
               {'d', ns_bridge_own_diode},          {'s', ns_bridge_own_switch},
               {'w', ns_bridge_own_current_switch}, {'m', ns_bridge_own_mosfet}};

static int read_instance(ns_extract_walk *w, GENinstance *inst) {
    const char letter = ns_bridge_models_letter(inst);
    char what[160];
    int status;
    if (ns_bridge_display_takes(w, inst, &status))
        return status;
    for (size_t i = 0; i < sizeof readers / sizeof readers[0]; i++)
        if (readers[i].letter == letter)
            return readers[i].read(w, inst);
    snprintf(what, sizeof what, "%c elements are not supported; %s and ideal devices are",
             toupper((unsigned char)letter), "R, C, L, K, V, I, E, F, G, H, piecewise linear B, D, S, W, M");
    return ns_bridge_extract_refuse(w, inst, what);
}

/* Why a call of the library failed, in words. */
static int refuse_status(ns_extract_walk *w, const char *name, int status) {
    const char *message = w->ex->circuit ? ns_circuit_message(w->ex->circuit) : "";
    if (*message)
        ns_bridge_extract_line(w->ex, ns_bridge_report_code(status), "", message);
    else
        ns_bridge_extract_line(w->ex, ns_bridge_report_code(status), name, ns_status_text(status));
    return w->ex->error;
}

/* One pass over all instances; *later counts those that wait, *waits names one of them. */
static int read_pass(ns_extract_walk *w, unsigned char *done, int *read, int *later,
                     const GENinstance **waits) {
    int k = 0;
    *read = *later = 0;
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next, k++) {
        GENinstance *inst = box->data;
        int status = done[k] ? NS_OK : read_instance(w, inst);
        if (status == EXTRACT_LATER) {
            ++*later;
            *waits = inst;
        } else if (status == EXTRACT_REFUSED) {
            return w->ex->error;
        } else if (status) {
            return refuse_status(w, inst->GENname, status);
        } else {
            *read += !done[k];
            done[k] = 1;
        }
    }
    return OK;
}

/* Options say which elements are taken, so they are read before all others. */
static int read_all_options(ns_extract_walk *w) {
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next)
        if (ns_bridge_models_kind(box->data) == KIND_OPTIONS && read_options(w, box->data) != NS_OK)
            return w->ex->error;
    return OK;
}

/* Passes until nothing waits for another element any more. */
static int read_all(ns_extract_walk *w) {
    unsigned char *done = calloc((size_t)w->ckt->DEVnameHash->num_entries + 1, 1);
    const GENinstance *waits = NULL;
    int read = 0;
    int later = 1;
    int error = OK;
    if (!done)
        return refuse_status(w, "", NS_E_MEMORY);
    while (!error && later > 0) { /* ends: each round reads one at least */
        error = read_pass(w, done, &read, &later, &waits);
        if (!error && later > 0 && read == 0) {
            ns_bridge_extract_refuse(w, waits,
                                     "is controlled by its own current, or by one that this controls: use E, "
                                     "by the voltage of a resistor that carries it");
            error = w->ex->error;
        }
    }
    free(done);
    return error;
}

/* Names of nodes and their .ic. */
static int read_nodes(ns_extract_walk *w) {
    for (const CKTnode *node = w->ckt->CKTnodes; node; node = node->next) {
        int status = NS_OK;
        if (node->type != SP_VOLTAGE || node->number <= 0)
            continue;
        status = ns_circuit_name_node(w->ex->circuit, node->number, node->name);
        if (!status && node->icGiven) {
            ns_bridge_extract_mix(w, &node->ic, sizeof node->ic);
            status = ns_circuit_node_ic(w->ex->circuit, node->number, node->ic);
        }
        if (status && status != NS_E_SIZE) /* SIZE: no element is there */
            return refuse_status(w, node->name, status);
    }
    return OK;
}

/* .options rshunt: a resistor from each node to ground.  ngspice would add them to the matrix that we fill,
 * were there nodes to do so.  It counts the nodes anew before each analysis, unless there is no option: then
 * KLU looks for what the last count left. */
static int read_shunts(ns_extract_walk *w) {
    CKTcircuit *ckt = w->ckt;
    char name[160];
    int status = NS_OK;
    ckt->enh->rshunt_data.num_nodes = 0;
    if (!(ckt->enh->rshunt_data.gshunt > 0.0))
        return OK;
    for (const CKTnode *node = ckt->CKTnodes; node && !status; node = node->next) {
        if (node->type != SP_VOLTAGE || ns_circuit_node_unknown(w->ex->circuit, node->number) < 0)
            continue;
        snprintf(name, sizeof name, "rshunt of node %.120s", node->name);
        status = ns_circuit_resistor(w->ex->circuit, name, node->number, 0,
                                     1.0 / ckt->enh->rshunt_data.gshunt, NULL);
    }
    ns_bridge_extract_mix(w, &ckt->enh->rshunt_data.gshunt, sizeof ckt->enh->rshunt_data.gshunt);
    return status ? refuse_status(w, "rshunt", status) : OK;
}

/* reltol of .options, where the model has none and it asks for less than the default: netlists say
 * 1e-4 to make ngspice more accurate, or 3e-3 to make it faster; neither is meant to loosen 1e-9. */
static void choose_reltol(ns_extract_walk *w) {
    static const double by_default = 1e-9;
    const double global = w->ckt->CKTreltol;
    if (w->ex->options.reltol == 0.0 && global > 0.0 && global < by_default)
        w->ex->options.reltol = global;
    ns_bridge_extract_mix(w, &w->ex->options.reltol, sizeof w->ex->options.reltol);
}

/* *again: sources that act on nothing were added to *displays, and it is to be read anew. */
static int read_circuit(CKTcircuit *ckt, ns_extract_sources sources, const ns_own_found *found,
                        ns_display_list *displays, ns_extract *ex, int *again) {
    ns_extract_walk w = {
        .ckt = ckt, .ex = ex, .found = found, .dc = sources == SOURCES_DC, .displays = displays};
    int status;
    memset(ex, 0, sizeof *ex);
    ex->options = ns_bridge_options_default;
    ex->hash = 14695981039346656037ULL;
    ex->neq = ckt->CKTmaxEqNum;
    ex->capacitors = ex->inductors = ex->couplings = -1;
    ex->element = malloc((size_t)ex->neq * sizeof *ex->element);
    status = ex->element ? ns_circuit_create(&ex->circuit) : NS_E_MEMORY;
    if (status)
        return refuse_status(&w, "", status);
    for (int eq = 0; eq < ex->neq; eq++)
        ex->element[eq] = -1;
    if (!read_all_options(&w) && !read_all(&w) && !read_nodes(&w) && !read_shunts(&w))
        choose_reltol(&w);
    *again = w.again;
    return ex->error;
}

int ns_bridge_extract_read(CKTcircuit *ckt, ns_extract_sources sources, const ns_own_found *found,
                           ns_extract *ex) {
    ns_display_list displays = {0, NULL};
    int again = 0;
    int error = read_circuit(ckt, sources, found, &displays, ex, &again);
    while (again) { /* ends: each reading finds one more at least */
        ns_bridge_extract_clear(ex);
        error = read_circuit(ckt, sources, found, &displays, ex, &again);
    }
    free(displays.inst);
    return error;
}

void ns_bridge_extract_clear(ns_extract *ex) {
    ns_circuit_free(ex->circuit);
    free(ex->element);
    free(ex->device);
    free(ex->own);
    free(ex->climit);
    free(ex->display);
    free(ex->wave);
    ns_bridge_digital_clear(&ex->digital);
    memset(ex, 0, sizeof *ex);
}
