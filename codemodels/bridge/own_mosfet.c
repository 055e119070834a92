/* bridge/own_mosfet.c - ngspice's own M, of a model VDMOS or of level 1, as plain numbers: the only file that
 * sees their structs. */
#include "own_mosfet.h"

#include <math.h>

#include "ngspice/const.h"
#include "versions.h"

#include "spicelib/devices/mos1/mos1defs.h"
#include "spicelib/devices/vdmos/vdmosdefs.h"

static int is_vdmos(const GENinstance *inst) {
    return inst->GENmodPtr->GENmodType == TYPE_VDMOS;
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
                         .series = ohms(v->MOS1drainConductance) + ohms(v->MOS1sourceConductance),
                         .leak = INFINITY,
                         .gamma = model->MOS1gamma};
    m->body = (ns_own_diode){.bv = INFINITY,
                             .farads = v->MOS1tCbd,
                             .law = {.bottom = {v->MOS1m * amperes, CONSTboltz / CHARGE * v->MOS1temp}}};
    hide(m, 0, v->MOS1dNodePrime, v->MOS1dNode);
    hide(m, 1, v->MOS1sNodePrime, v->MOS1sNode);
}

void ns_bridge_own_read_mosfet(const GENinstance *inst, ns_own_mosfet *m) {
    if (is_vdmos(inst))
        read_vdmos((const VDMOSinstance *)inst, m);
    else
        read_mos1((const MOS1instance *)inst, m);
    m->body.anode = m->sign > 0 ? m->bulk : m->drain;
    m->body.cathode = m->sign > 0 ? m->drain : m->bulk;
    m->at_source.anode = m->sign > 0 ? m->bulk : m->source;
    m->at_source.cathode = m->sign > 0 ? m->source : m->bulk;
}

double ns_bridge_own_gain(const ns_own_mosfet *m, double above) {
    return m->beta / (1.0 + m->theta * (m->vth + above));
}

double ns_bridge_own_overdrive(const ns_own_mosfet *m, double above) {
    const double v = above - m->shift;
    return m->slope > 0.0 && v < 30.0 * m->slope ? m->slope * log1p(exp(v / m->slope)) : v;
}

double ns_bridge_own_saturation(const ns_own_mosfet *m, double above) {
    const double over = fmax(ns_bridge_own_overdrive(m, above), 0.0);
    return 0.5 * ns_bridge_own_gain(m, above) * over * over;
}

/* What ns_bridge_own_overdrive() makes `over` of. */
static double above_of(const ns_own_mosfet *m, double over) {
    const int is_weak = m->slope > 0.0 && over < 30.0 * m->slope;
    return m->shift + (is_weak ? m->slope * log(expm1(over / m->slope)) : over);
}

double ns_bridge_own_needs(const ns_own_mosfet *m, double amperes) {
    enum { ROUNDS = 4 }; /* the gain hardly depends on what is sought */
    double above = 0.0;
    for (int k = 0; k < ROUNDS; k++)
        above = above_of(m, sqrt(2.0 * amperes / ns_bridge_own_gain(m, fmax(above, 0.0))));
    return above;
}

double ns_bridge_own_channel(const ns_own_mosfet *m, double above, double volts) {
    const double over = fmax(ns_bridge_own_overdrive(m, above), 0.0), v = fmin(m->triode * volts, over);
    return ns_bridge_own_gain(m, above) * v * (over - 0.5 * v);
}

double ns_bridge_own_resistance(const ns_own_mosfet *m, double above) {
    return m->series + 1.0 / (ns_bridge_own_gain(m, above) * m->triode * ns_bridge_own_overdrive(m, above));
}

double ns_bridge_own_late(const ns_own_mosfet *m, const ns_own_drive *drive, double volts, double *ohm) {
    const double opens_by = drive->opens + m->charge.ohm, closes_by = drive->closes + m->charge.ohm;
    const double low = m->vth - drive->low, high = drive->high - m->vth, bend = m->charge.bend;
    *ohm = 0.0;
    if (!(low > 0.0 && high > 0.0))
        return 0.0;
    const double all = m->charge.source + m->charge.drain + m->charge.more;
    const double swings =
        m->charge.drain * volts + (bend > 0.0 ? m->charge.more * (1.0 + log1p(bend * volts)) / bend : 0.0);
    const double opens = isnan(opens_by) ? 0.0 : opens_by * (all * log((low + high) / low) + swings / low);
    const double closes =
        isnan(closes_by) ? 0.0 : closes_by * (m->charge.source * log((low + high) / high) + swings / high);
    *ohm = opens > closes ? opens_by : closes_by;
    return opens - closes;
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

void ns_bridge_own_write_mosfet(GENinstance *inst, CKTcircuit *ckt, double amperes, const double *value) {
    if (is_vdmos(inst))
        write_vdmos((VDMOSinstance *)inst, ckt, amperes, value);
    else
        write_mos1((MOS1instance *)inst, ckt, amperes, value);
}
