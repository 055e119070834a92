/* bridge/elements.c - R, C, L, K, E, F, G, H of ngspice: effective values after temperature, m and scale. */
#include "elements.h"

#include <math.h>

#include "spicelib/devices/cap/capdefs.h"
#include "spicelib/devices/cccs/cccsdefs.h"
#include "spicelib/devices/ccvs/ccvsdefs.h"
#include "spicelib/devices/ind/inddefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vccs/vccsdefs.h"
#include "spicelib/devices/vcvs/vcvsdefs.h"

int ns_bridge_elements_resistor(ns_extract_walk *w, GENinstance *inst) {
    const RESinstance *r = (const RESinstance *)inst;
    const double ohms = 1.0 / r->RESconduct; /* m, scale and temperature are in it */
    ns_bridge_extract_mix(w, &ohms, sizeof ohms);
    return ns_circuit_resistor(w->ex->circuit, inst->GENname, r->RESposNode, r->RESnegNode, ohms, NULL);
}

int ns_bridge_elements_capacitor(ns_extract_walk *w, GENinstance *inst) {
    const CAPinstance *c = (const CAPinstance *)inst;
    const double farads = c->CAPcapac * c->CAPm;
    const double ic = c->CAPicGiven ? c->CAPinitCond : NAN;
    w->ex->capacitors = inst->GENmodPtr->GENmodType;
    ns_bridge_extract_mix(w, &farads, sizeof farads);
    return ns_circuit_capacitor(w->ex->circuit, inst->GENname, c->CAPposNode, c->CAPnegNode, farads, ic,
                                NULL);
}

/* Of what stores energy; a transformer's T model may have such a coil. */
static int refuse_negative_coil(ns_extract_walk *w, const GENinstance *inst, double henries) {
    char what[200];
    snprintf(what, sizeof what,
             "inductance = %g H is negative, which is not supported; write a transformer's T model as coils "
             "with a coupling K",
             henries);
    return ns_bridge_extract_refuse(w, inst, what);
}

int ns_bridge_elements_inductor(ns_extract_walk *w, GENinstance *inst) {
    const INDinstance *l = (const INDinstance *)inst;
    const double henries = l->INDinduct / l->INDm;
    const double ic = l->INDicGiven ? l->INDinitCond : NAN;
    int id = -1;
    if (henries < 0.0)
        return refuse_negative_coil(w, inst, henries);
    int status =
        ns_circuit_inductor(w->ex->circuit, inst->GENname, l->INDposNode, l->INDnegNode, henries, ic, &id);
    w->ex->inductors = inst->GENmodPtr->GENmodType;
    ns_bridge_extract_mix(w, &henries, sizeof henries);
    ns_bridge_extract_current(w, l->INDbrEq, id);
    return status;
}

/* ngspice divides coils by m, but not what couples them. */
static int refuse_coupling(ns_extract_walk *w, const MUTinstance *k, double coupling) {
    char what[400];
    snprintf(what, sizeof what,
             "ngspice divides %.60s and %.60s by their m=, but not their mutual inductance: the coupling %g "
             "counts as %g, and must lie between -1 and 1; write inductances divided by m in place of m=",
             k->MUTind1->INDname, k->MUTind2->INDname, k->MUTcoupling, coupling);
    return ns_bridge_extract_refuse(w, &k->gen, what);
}

int ns_bridge_elements_coupling(ns_extract_walk *w, GENinstance *inst) {
    const MUTinstance *k = (const MUTinstance *)inst;
    const INDinstance *l1 = k->MUTind1;
    const INDinstance *l2 = k->MUTind2;
    const int id1 = ns_bridge_extract_element(w, l1->INDbrEq);
    const int id2 = ns_bridge_extract_element(w, l2->INDbrEq);
    double coupling;
    w->ex->couplings = inst->GENmodPtr->GENmodType;
    if (id1 < 0 || id2 < 0)
        return EXTRACT_LATER;
    /* ngspice's mutual inductance does not know m */
    coupling = l1->INDm == 1.0 && l2->INDm == 1.0
                   ? k->MUTcoupling
                   : k->MUTfactor / sqrt(fabs(l1->INDinduct / l1->INDm * l2->INDinduct / l2->INDm));
    ns_bridge_extract_mix(w, &coupling, sizeof coupling);
    if (fabs(coupling) > 1.0 && fabs(k->MUTcoupling) <= 1.0)
        return refuse_coupling(w, k, coupling);
    return ns_circuit_coupling(w->ex->circuit, inst->GENname, id1, id2, coupling, NULL);
}

int ns_bridge_elements_vcvs(ns_extract_walk *w, GENinstance *inst) {
    const VCVSinstance *e = (const VCVSinstance *)inst;
    int id = -1;
    int status =
        ns_circuit_vcontrolled(w->ex->circuit, inst->GENname, NS_VOLTAGE, e->VCVSposNode, e->VCVSnegNode,
                               e->VCVScontPosNode, e->VCVScontNegNode, e->VCVScoeff, &id);
    ns_bridge_extract_mix(w, &e->VCVScoeff, sizeof e->VCVScoeff);
    ns_bridge_extract_current(w, e->VCVSbranch, id);
    return status;
}

int ns_bridge_elements_vccs(ns_extract_walk *w, GENinstance *inst) {
    const VCCSinstance *g = (const VCCSinstance *)inst;
    ns_bridge_extract_mix(w, &g->VCCScoeff, sizeof g->VCCScoeff);
    return ns_circuit_vcontrolled(w->ex->circuit, inst->GENname, NS_CURRENT, g->VCCSposNode, g->VCCSnegNode,
                                  g->VCCScontPosNode, g->VCCScontNegNode, g->VCCScoeff, NULL);
}

int ns_bridge_elements_cccs(ns_extract_walk *w, GENinstance *inst) {
    const CCCSinstance *f = (const CCCSinstance *)inst;
    const int by = ns_bridge_extract_element(w, f->CCCScontBranch);
    if (by < 0)
        return EXTRACT_LATER;
    ns_bridge_extract_mix(w, &f->CCCScoeff, sizeof f->CCCScoeff);
    return ns_circuit_icontrolled(w->ex->circuit, inst->GENname, NS_CURRENT, f->CCCSposNode, f->CCCSnegNode,
                                  by, f->CCCScoeff, NULL);
}

int ns_bridge_elements_ccvs(ns_extract_walk *w, GENinstance *inst) {
    const CCVSinstance *h = (const CCVSinstance *)inst;
    const int by = ns_bridge_extract_element(w, h->CCVScontBranch);
    int id = -1;
    int status;
    if (by < 0)
        return EXTRACT_LATER;
    status = ns_circuit_icontrolled(w->ex->circuit, inst->GENname, NS_VOLTAGE, h->CCVSposNode, h->CCVSnegNode,
                                    by, h->CCVScoeff, &id);
    ns_bridge_extract_mix(w, &h->CCVScoeff, sizeof h->CCVScoeff);
    ns_bridge_extract_current(w, h->CCVSbranch, id);
    return status;
}
