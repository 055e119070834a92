/* bridge/own_dc.c - .op and .dc, which have no first pass: are the currents of D far from the one at which
 * their curves were read?  In .dc their largest ones count, at its last point. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ngspice/trcvdefs.h"
#include "own_show.h"
#include "session.h"

#include "spicelib/devices/isrc/isrcdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

/* NAN: of another element than V and I. */
static double swept_value(const GENinstance *inst) {
    switch (ns_bridge_models_letter(inst)) {
    case 'v':
        return ((const VSRCinstance *)inst)->VSRCdcValue;
    case 'i':
        return ((const ISRCinstance *)inst)->ISRCdcValue;
    default:
        return NAN;
    }
}

static int is_last(const CKTcircuit *ckt) {
    static const double nearly = 1.0 - 1e-6;
    const TRCV *job = (const TRCV *)ckt->CKTcurJob;
    int last = 1;
    for (int k = 0; (ckt->CKTmode & MODEDCTRANCURVE) && k <= job->TRCVnestLevel; k++)
        last = last && job->TRCVvElt[k] &&
               fabs(job->TRCVvStop[k] - swept_value(job->TRCVvElt[k])) < nearly * fabs(job->TRCVvStep[k]);
    return last;
}

int ns_bridge_own_dc_point(ns_session *s) {
    const ns_analysis *a = &s->analysis;
    const size_t count = (size_t)a->ex.nowns;
    if (count == 0 || s->once.dc_noted)
        return OK;
    if (s->dc.count != count) {
        free(s->dc.most);
        s->dc.most = calloc(count, sizeof *s->dc.most);
        s->dc.count = s->dc.most ? count : 0;
    }
    if (!s->dc.most)
        return E_NOMEM;
    ns_bridge_own_count_dc(a, s->dc.most);
    if (is_last(s->ckt)) {
        s->once.dc_noted = ns_bridge_own_note_guess(a, s->dc.most);
        memset(s->dc.most, 0, count * sizeof *s->dc.most);
    }
    return OK;
}

void ns_bridge_own_dc_clear(ns_session *s) {
    free(s->dc.most);
    s->dc.most = NULL;
    s->dc.count = 0;
}
