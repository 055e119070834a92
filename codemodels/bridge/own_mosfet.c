/* bridge/own_mosfet.c - ngspice's own M, of a model VDMOS or of level 1 or 3, as plain numbers: the only file
 * that sees their structs. */
#include "own_mosfet.h"

#include <math.h>

#include "ngspice/const.h"
#include "versions.h"

#include "spicelib/devices/mos1/mos1defs.h"
#include "spicelib/devices/mos3/mos3defs.h"
#include "spicelib/devices/vdmos/vdmosdefs.h"

static int type_of(const GENinstance *inst) {
    return inst->GENmodPtr->GENmodType;
}

static void hide(ns_own_mosfet *m, int k, int inside, int outside) {
    m->hidden[k].inside = inside != outside ? inside : 0;
    m->hidden[k].outside = outside;
}

static double ohms(double siemens) {
    return siemens > 0.0 ? 1.0 / siemens : 0.0;
}

static void read_vdmos(const VDMOSinstance *v, ns_own_mosfet *m) {
    const VDMOSmodel *model = VDMOSmodPtr(v);
    *m = (ns_own_mosfet){.sign = model->VDMOStype,
                         .drain = v->VDMOSdNode,
                         .gate = v->VDMOSgNode,
                         .source = v->VDMOSsNode,
                         .bulk = v->VDMOSsNode,
                         .vth = model->VDMOStype * v->VDMOStVth,
                         .beta = v->VDMOStTransconductance,
                         .theta = model->VDMOStheta,
                         .bends_from = -model->VDMOStype * v->VDMOStVth,
                         .critical = INFINITY,
                         .triode = model->VDMOSmtr,
                         .shift = model->VDMOSsubshift,
                         .slope = v->VDMOStksubthres,
                         .series = v->VDMOSdrainResistance + ohms(v->VDMOSsourceConductance),
                         .leak = model->VDMOSrdsGiven ? ohms(v->VDMOSdsConductance) : INFINITY,
                         .heats = v->VDMOSthermal && model->VDMOSrthjcGiven};
    m->leak = m->leak > 0.0 ? m->leak : INFINITY;
    m->charge.ohm = ohms(v->VDMOSgateConductance);
    m->charge.source = model->VDMOScgs;
    m->charge.drain = model->VDMOScgdmin;
    m->charge.more = (model->VDMOScgdmax - model->VDMOScgdmin) / (1.0 + CONSTpi / 2.0); /* devsup.c */
    m->charge.bend = model->VDMOSa;
    m->body = (ns_own_diode){
        .rs = ohms(v->VDIOtConductance),
        .bv = model->VDIObvGiven ? model->VDIObv : INFINITY,
        .farads = v->VDIOtJctCap,
        .built_in = v->VDIOtJctPot,
        .grading = v->VDIOtGradingCoeff,
        .tt = model->VDIOtransitTime,
        .law = {.bottom = {v->VDIOtSatCur, model->VDIOn * CONSTboltz / CHARGE * v->VDMOStemp}}};
    if (model->VDIObvGiven)
        m->body.breakdown =
            (ns_breakdown_law){v->VDIOtBrkdwnV, v->VDIOtSatCur,
                               model->VDIObrkdEmissionCoeff * CONSTboltz / CHARGE * v->VDMOStemp};
    hide(m, 0, v->VDMOSdNodePrime, v->VDMOSdNode);
    hide(m, 1, v->VDMOSgNodePrime, v->VDMOSgNode);
    hide(m, 2, v->VDMOSsNodePrime, v->VDMOSsNode);
    hide(m, 3, v->VDIOposPrimeNode, v->VDMOSsNode);
}

/* Of the oxide's capacitance, what lies between gate and source beyond the threshold. */
static const double of_oxide = 2.0 / 3.0;

/* Its body diode: the current of saturation, A; K; of its junction F, V and exponent. */
static void set_body(ns_own_mosfet *m, double amperes, double kelvin, double farads, double built_in,
                     double grading) {
    m->body = (ns_own_diode){.bv = INFINITY,
                             .farads = farads,
                             .built_in = built_in,
                             .grading = grading,
                             .law = {.bottom = {amperes, CONSTboltz / CHARGE * kelvin}}};
}

static void read_mos1(const MOS1instance *v, ns_own_mosfet *m) {
    const MOS1model *model = MOS1modPtr(v);
    const int by_area = v->MOS1tSatCurDens != 0.0 && v->MOS1drainArea != 0.0;
    const double amperes = by_area ? v->MOS1tSatCurDens * v->MOS1drainArea : v->MOS1tSatCur;
    *m = (ns_own_mosfet){.sign = model->MOS1type,
                         .drain = v->MOS1dNode,
                         .gate = v->MOS1gNode,
                         .source = v->MOS1sNode,
                         .bulk = v->MOS1bNode,
                         .vth = model->MOS1type * v->MOS1tVto,
                         .beta = v->MOS1tTransconductance * v->MOS1m * v->MOS1w /
                                 (v->MOS1l - 2.0 * model->MOS1latDiff),
                         .triode = 1.0,
                         .critical = INFINITY,
                         .series = ohms(v->MOS1drainConductance) + ohms(v->MOS1sourceConductance),
                         .leak = INFINITY,
                         .gamma = model->MOS1gamma};
    set_body(m, v->MOS1m * amperes, v->MOS1temp, v->MOS1tCbd, v->MOS1tBulkPot,
             model->MOS1bulkJctBotGradingCoeff);
    hide(m, 0, v->MOS1dNodePrime, v->MOS1dNode);
    hide(m, 1, v->MOS1sNodePrime, v->MOS1sNode);
    const double width = v->MOS1m * v->MOS1w;
    m->charge.source = width * (model->MOS1gateSourceOverlapCapFactor +
                                of_oxide * model->MOS1oxideCapFactor * (v->MOS1l - 2.0 * model->MOS1latDiff));
    m->charge.drain = width * model->MOS1gateDrainOverlapCapFactor;
}

/* By how much a short channel leaves less to the bulk. */
static double share_of_bulk(const MOS3model *model, double root, double length) {
    const double xj = model->MOS3junctionDepth, depth = model->MOS3coeffDepLayWidth * root;
    if (xj == 0.0 || depth == 0.0)
        return 1.0;
    const double w = depth / xj, ld = model->MOS3latDiff / xj, part = w / (1.0 + w);
    const double wc = 0.0631353 + 0.8013292 * w - 0.01110777 * w * w;
    return 1.0 - xj / length * ((wc + ld) * sqrt(1.0 - part * part) - ld);
}

/* As mos3load.c has it at v(bulk,source) = 0. */
static void read_mos3(const MOS3instance *v, ns_own_mosfet *m) {
    const MOS3model *model = MOS3modPtr(v);
    const double length = v->MOS3l - 2.0 * model->MOS3latDiff + model->MOS3lengthAdjust;
    const double width = v->MOS3w - 2.0 * model->MOS3widthNarrow + model->MOS3widthAdjust;
    const double root = sqrt(v->MOS3tPhi), narrow = model->MOS3narrowFactor / width;
    const double gamma = model->MOS3gamma * share_of_bulk(model, root, length);
    const double by_bulk = 1.0 + 0.25 * gamma / root + narrow;
    const int by_area = v->MOS3tSatCurDens != 0.0 && v->MOS3drainArea != 0.0 && v->MOS3sourceArea != 0.0;
    const double amperes = by_area ? v->MOS3tSatCurDens * v->MOS3drainArea : v->MOS3tSatCur;
    const double drift = model->MOS3maxDriftVel, mobility = 1e-4 * v->MOS3tSurfMob;
    *m = (ns_own_mosfet){.sign = model->MOS3type,
                         .drain = v->MOS3dNode,
                         .gate = v->MOS3gNode,
                         .source = v->MOS3sNode,
                         .bulk = v->MOS3bNode,
                         .vth = model->MOS3type * v->MOS3tVbi + gamma * root + narrow * v->MOS3tPhi,
                         .beta = v->MOS3tTransconductance * v->MOS3m * width / length / by_bulk,
                         .theta = model->MOS3theta,
                         .triode = by_bulk,
                         .critical = drift > 0.0 ? by_bulk * length * drift / mobility : INFINITY,
                         .series = ohms(v->MOS3drainConductance) + ohms(v->MOS3sourceConductance),
                         .leak = INFINITY,
                         .gamma = model->MOS3gamma};
    set_body(m, v->MOS3m * amperes, v->MOS3temp, v->MOS3tCbd, v->MOS3tBulkPot,
             model->MOS3bulkJctBotGradingCoeff);
    hide(m, 0, v->MOS3dNodePrime, v->MOS3dNode);
    hide(m, 1, v->MOS3sNodePrime, v->MOS3sNode);
    m->charge.source =
        v->MOS3m * width *
        (model->MOS3gateSourceOverlapCapFactor + of_oxide * model->MOS3oxideCapFactor * length);
    m->charge.drain = v->MOS3m * width * model->MOS3gateDrainOverlapCapFactor;
}

void ns_bridge_own_read_mosfet(const GENinstance *inst, ns_own_mosfet *m) {
    if (type_of(inst) == TYPE_VDMOS)
        read_vdmos((const VDMOSinstance *)inst, m);
    else if (type_of(inst) == TYPE_MOS3)
        read_mos3((const MOS3instance *)inst, m);
    else
        read_mos1((const MOS1instance *)inst, m);
    m->vth += 0.0; /* -0 of a p channel without vto is 0 in a line */
    m->body.anode = m->sign > 0 ? m->bulk : m->drain;
    m->body.cathode = m->sign > 0 ? m->drain : m->bulk;
    m->at_source.anode = m->sign > 0 ? m->bulk : m->source;
    m->at_source.cathode = m->sign > 0 ? m->source : m->bulk;
}

static void write_vdmos(VDMOSinstance *v, CKTcircuit *ckt, double amperes, const double *value) {
    const int sign = VDMOSmodPtr(v)->VDMOStype;
    double *state = ckt->CKTstate0;
    state[v->VDMOSvgs] = sign * (value[v->VDMOSgNode] - value[v->VDMOSsNode]);
    state[v->VDMOSvds] = sign * (value[v->VDMOSdNode] - value[v->VDMOSsNode]);
    state[v->VDIOvoltage] = sign * (value[v->VDMOSsNode] - value[v->VDMOSdNode]); /* some ngspices ask */
    v->VDMOScd = sign * amperes;
}

static void write_mos1(MOS1instance *v, CKTcircuit *ckt, double amperes, const double *value) {
    const int sign = MOS1modPtr(v)->MOS1type;
    double *state = ckt->CKTstate0;
    state[v->MOS1vgs] = sign * (value[v->MOS1gNode] - value[v->MOS1sNode]);
    state[v->MOS1vds] = sign * (value[v->MOS1dNode] - value[v->MOS1sNode]);
    state[v->MOS1vbs] = sign * (value[v->MOS1bNode] - value[v->MOS1sNode]);
    state[v->MOS1vbd] = state[v->MOS1vbs] - state[v->MOS1vds];
    v->MOS1cd = sign * amperes;
}

static void write_mos3(MOS3instance *v, CKTcircuit *ckt, double amperes, const double *value) {
    const int sign = MOS3modPtr(v)->MOS3type;
    double *state = ckt->CKTstate0;
    state[v->MOS3vgs] = sign * (value[v->MOS3gNode] - value[v->MOS3sNode]);
    state[v->MOS3vds] = sign * (value[v->MOS3dNode] - value[v->MOS3sNode]);
    state[v->MOS3vbs] = sign * (value[v->MOS3bNode] - value[v->MOS3sNode]);
    state[v->MOS3vbd] = state[v->MOS3vbs] - state[v->MOS3vds];
    v->MOS3cd = sign * amperes;
}

void ns_bridge_own_write_mosfet(GENinstance *inst, CKTcircuit *ckt, double amperes, const double *value) {
    if (type_of(inst) == TYPE_VDMOS)
        write_vdmos((VDMOSinstance *)inst, ckt, amperes, value);
    else if (type_of(inst) == TYPE_MOS3)
        write_mos3((MOS3instance *)inst, ckt, amperes, value);
    else
        write_mos1((MOS1instance *)inst, ckt, amperes, value);
}
