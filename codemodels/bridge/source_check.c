/* bridge/source_check.c - are ngspice's sources what they were read as?
 *
 * A new version of ngspice may mean something else by the same PULSE.  So, once an analysis, each source is
 * compared with the value that ngspice's own load gives it: a voltage on the right side of its branch's
 * equation, where nothing else is added, a current in its instance.  Our device types load last: both are
 * there.
 *
 * In DC loads time is 0.  For .tran the first timepoint is loaded at other instants as well: after each load
 * ngspice's time is set to the next of them, and it loads again, as after any iteration that has not
 * converged. The mode then says none of DC, AC and .tran: sources are loaded for ngspice's time, C not at
 * all; the state of L is made anew by the load that follows. */
#include "source_check.h"

#include <string.h>

#include "models.h"
#include "report.h"
#include "sources.h"
#include "versions.h"

#include "ngspice/optdefs.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

struct ns_checked_source {
    const GENinstance *inst;
    double *points; /* of a PWL */
};

static int is_source(const GENinstance *inst) {
    const char letter = ns_bridge_models_letter(inst);
    return letter == 'v' || letter == 'i';
}

/* The value that the present load gave it. */
static double loaded(const CKTcircuit *ckt, const GENinstance *inst) {
    return ns_bridge_models_letter(inst) == 'v' ? ckt->CKTrhs[((const VSRCinstance *)inst)->VSRCbranch]
                                                : ((const ISRCinstance *)inst)->ISRCcurrent;
}

static int compare(const CKTcircuit *ckt, const GENinstance *inst, const ns_signal *z, double t) {
    const char *unit = ns_bridge_models_letter(inst) == 'v' ? "V" : "A";
    const double got = loaded(ckt, inst);
    double wanted;
    if (ns_bridge_source_agrees(z, t, ckt->CKTfinalTime, got, &wanted))
        return OK;
    ns_bridge_report_error(
        "%s: at t = %g s ngspice gives this source %g %s; nonsmooth.cm, made for ngspice %d, "
        "expected %g %s: write all parameters of its function",
        inst->GENname, t, got, unit, NGSPICE_MAJOR, wanted, unit);
    return E_UNSUPP;
}

/* --- DC --- */

int ns_bridge_source_check_dc(CKTcircuit *ckt) {
    const int as_dc = !(ckt->CKTmode & MODETRANOP);
    int error = OK;
    if (ckt->CKTsrcFact != 1.0) /* ngspice searches for an operating point */
        return OK;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box && !error; box = box->thread_next) {
        const GENinstance *inst = box->data;
        ns_signal z;
        double *points;
        if (!is_source(inst) || ns_bridge_sources_signal(ckt, inst, as_dc, &z, &points))
            continue;
        error = compare(ckt, inst, &z, 0.0);
        free(points);
    }
    return error;
}

/* --- .tran --- */

void ns_bridge_source_check_clear(ns_source_check *check) {
    for (int i = 0; i < check->n; i++)
        free(check->source[i].points);
    free(check->source);
    free(check->signal);
    memset(check, 0, sizeof *check);
}

/* All sources into `check`, for which there is room. */
static void read_sources(ns_source_check *check, const CKTcircuit *ckt) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        const int i = check->n;
        if (!is_source(inst) ||
            ns_bridge_sources_signal(ckt, inst, 0, &check->signal[i], &check->source[i].points))
            continue;
        check->source[i].inst = inst;
        check->n++;
    }
}

static int collect(ns_source_check *check, const CKTcircuit *ckt) {
    const size_t most = (size_t)ckt->DEVnameHash->num_entries + 1;
    check->source = calloc(most, sizeof *check->source);
    check->signal = calloc(most, sizeof *check->signal);
    if (!check->source || !check->signal) {
        ns_bridge_source_check_clear(check);
        ns_bridge_report_error("out of memory");
        return E_NOMEM;
    }
    read_sources(check, ckt);
    check->instants = ns_bridge_source_instants(check->signal, check->n, ckt->CKTfinalTime, check->instant);
    return OK;
}

/* ngspice loads again, at the next instant; at the last, at its own time, as it would have. */
static void load_again(ns_source_check *check, CKTcircuit *ckt) {
    const long none = MODEDC | MODEAC | MODETRAN | INITF;
    const int over = check->at == check->instants;
    ckt->CKTstat->STATnumIter--; /* rusage counts the others */
    ckt->CKTtime = over ? check->time : check->instant[check->at];
    ckt->CKTmode = over ? check->mode : (check->mode & ~none) | MODEINITFLOAT;
    ckt->CKTnoncon++;
}

int ns_bridge_source_check_begin(ns_source_check *check, CKTcircuit *ckt) {
    ns_bridge_source_check_clear(check);
    const int error = collect(check, ckt);
    if (error)
        return error;
    check->time = ckt->CKTtime;
    check->mode = ckt->CKTmode;
    load_again(check, ckt);
    return OK;
}

int ns_bridge_source_check_is_on(const ns_source_check *check) {
    return check->source != NULL;
}

int ns_bridge_source_check_load(ns_source_check *check, CKTcircuit *ckt) {
    int error = OK;
    for (int i = 0; i < check->n && !error; i++)
        error = compare(ckt, check->source[i].inst, &check->signal[i], ckt->CKTtime);
    check->at = error ? check->instants : check->at + 1;
    load_again(check, ckt);
    if (check->at == check->instants)
        ns_bridge_source_check_clear(check);
    return error;
}
