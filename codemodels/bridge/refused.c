/* bridge/refused.c - analyses that are not supported, and what to do instead. */
#include "refused.h"

#include <string.h>

#include "ngspice/jobdefs.h"
#include "ngspice/tfdefs.h"
#include "report.h"

static const char transfer[] = "Transfer Function";

/* As ngspice names analyses. */
static const struct analysis {
    const char *name;
    int passes_start; /* is supported, or refused later */
    const char *instead;
} known[] = {{"Operating Point", 1, ""},
             {"DC transfer characteristic", 1, ""},
             {"Transient Analysis", 1, ""},
             {"AC Analysis", 1, ": use .tran with a SIN source, then fourier or fft"},
             {"Distortion Analysis", 1, ": use .tran with a SIN source, then fourier or fft"},
             {transfer, 0, ": use .dc with two values of the source"},
             {"Sensitivity Analysis", 0, ": use two runs with the value changed by alter"},
             {"Periodic Steady State Analysis", 0, ": use .tran with a late tstart"}};

static const struct analysis *find(const CKTcircuit *ckt) {
    static const struct analysis other = {"this analysis", 0, ": replace the devices by resistors"};
    const JOB *job = ckt->CKTcurJob;
    for (size_t k = 0; job && job->JOBname && k < sizeof known / sizeof known[0]; k++)
        if (strcmp(job->JOBname, known[k].name) == 0)
            return &known[k];
    return &other;
}

int ns_bridge_refused_is(const CKTcircuit *ckt) {
    return ckt->CKTcurJob && !find(ckt)->passes_start;
}

/* .tf goes on without an operating point, to numbers or to an abort, unless its source cannot be found.  It
 * is looked for by this name, which ngspice writes. */
static void hide_source(TFan *job) {
    static char none[] = "(none: .tf was refused)";
    job->TFinSrc = none;
}

int ns_bridge_refused_end(const CKTcircuit *ckt) {
    const struct analysis *a = find(ckt);
    const JOB *job = ckt->CKTcurJob;
    ns_bridge_report_error("%s is not supported; .op, .dc and .tran are%s",
                           job && job->JOBname ? job->JOBname : a->name, a->instead);
    if (job && a->name == transfer)
        hide_source((TFan *)ckt->CKTcurJob);
    return E_UNSUPP;
}
