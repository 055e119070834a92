/* bridge/display.c - B, E and G that act on nothing: what they show of a point. */
#include "display.h"

#include <math.h>

#include "report.h"

#include "spicelib/devices/asrc/asrcdefs.h"
#include "spicelib/devices/vccs/vccsdefs.h"
#include "spicelib/devices/vcvs/vcvsdefs.h"

/* Of the expression of a B, which ngspice itself evaluates. */
static double evaluate(const ASRCinstance *b, double gmin, const double *value) {
    enum { MOST = 64 };
    double room[2 * MOST], result = NAN;
    const int count = b->ASRCtree->numVars;
    double *in = count <= MOST ? room : calloc(2 * (size_t)count, sizeof *in);
    for (int i = 0; in && i < count; i++)
        in[i] = value[b->ASRCvars[i]];
    if (in && b->ASRCtree->IFeval(b->ASRCtree, gmin, &result, in, in + count) != OK)
        result = NAN;
    if (in != room)
        free(in);
    return result;
}

static double output_of(const GENinstance *inst, double gmin, const double *value) {
    const ASRCinstance *b = (const ASRCinstance *)inst;
    switch (ns_bridge_models_letter(inst)) {
    case 'e': {
        const VCVSinstance *e = (const VCVSinstance *)inst;
        return e->VCVScoeff * (value[e->VCVScontPosNode] - value[e->VCVScontNegNode]);
    }
    case 'g': {
        const VCCSinstance *g = (const VCCSinstance *)inst;
        return g->VCCScoeff * (value[g->VCCScontPosNode] - value[g->VCCScontNegNode]);
    }
    default:
        return evaluate(b, gmin, value);
    }
}

void ns_bridge_display_values(const ns_extract *ex, double *value) {
    for (int k = 0; k < ex->ndisplays; k++) {
        const ns_extract_display *d = &ex->display[k];
        const double v = d->gain * output_of(d->inst, d->gmin, value);
        value[d->node] = isfinite(v) ? v : 0.0;
        if (d->branch)
            value[d->branch] = d->siemens * value[d->node];
    }
}

void ns_bridge_display_mark(const ns_extract *ex, unsigned char *shown) {
    for (int k = ex->ndisplays - 1; k >= 0; k--) { /* those that read others are later */
        const ns_extract_display *d = &ex->display[k];
        const ASRCinstance *b = (const ASRCinstance *)d->inst;
        const int *at = (const int *)(const void *)(d->inst + 1);
        if (!shown[d->node])
            continue;
        if (ns_bridge_models_letter(d->inst) != 'b')
            shown[at[2]] = shown[at[3]] = 1;
        for (int i = 0; ns_bridge_models_letter(d->inst) == 'b' && i < b->ASRCtree->numVars; i++)
            shown[b->ASRCvars[i]] = 1;
    }
}

void ns_bridge_display_announce(const ns_extract *ex) {
    if (ex->ndisplays == 0)
        return;
    ns_bridge_report_note("%s%s not piecewise linear, and acts on nothing: its value is computed at each "
                          "point from what it reads there",
                          ex->display[0].name,
                          ex->ndisplays > 1 ? " and other such sources: the expression is" : " is");
}
