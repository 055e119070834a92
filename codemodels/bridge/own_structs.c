/* bridge/own_structs.c - ngspice's own D, S and W as plain numbers: the only file that sees their structs. */
#include "own_structs.h"

#include <math.h>

#include "models.h"
#include "ngspice/const.h"
#include "versions.h"

#include "spicelib/devices/csw/cswdefs.h"
#include "spicelib/devices/dio/diodefs.h"
#include "spicelib/devices/sw/swdefs.h"

ns_own_kind ns_bridge_own_kind(const GENinstance *inst) {
    static const struct {
        char letter;
        int first, last;
        ns_own_kind kind;
    } types[] = {{'d', TYPE_DIO, TYPE_DIO, OWN_DIODE},          {'s', TYPE_SW, TYPE_SW, OWN_SWITCH},
                 {'w', TYPE_CSW, TYPE_CSW, OWN_CURRENT_SWITCH}, {'m', TYPE_MOS1, TYPE_MOS1, OWN_MOSFET},
                 {'m', TYPE_MOS3, TYPE_MOS3, OWN_MOSFET},       {'m', TYPE_VDMOS, TYPE_VDMOS, OWN_MOSFET}};
    const char letter = ns_bridge_models_letter(inst);
    const int type = inst->GENmodPtr->GENmodType;
    for (size_t k = 0; k < sizeof types / sizeof types[0]; k++)
        if (types[k].letter == letter && type >= types[k].first && type <= types[k].last)
            return types[k].kind;
    return OWN_NONE;
}

/* A negative one stays negative, and is refused. */
static double ohms_of(double siemens) {
    return isinf(siemens) ? 0.0 : siemens != 0.0 ? 1.0 / siemens : INFINITY;
}

/* As ngspice's load has it where the control lies inside the hysteresis; its state is 1 or 3 if closed. */
static int is_closed_inside(const CKTcircuit *dc, int state, int given) {
    if (!dc || !(dc->CKTmode & MODEDCTRANCURVE) || (dc->CKTmode & (MODEINITJCT | MODEINITFIX)))
        return given;
    const double *from = dc->CKTmode & MODEINITPRED ? dc->CKTstate1 : dc->CKTstate0;
    return from[state] == 1.0 || from[state] == 3.0;
}

/* The same of a negative vh: what counts is the side that the control came from, the lower one if it was
 * nowhere else; with uic (in .tran) `given`. */
static int is_closed_early(const CKTcircuit *dc, int state, int control, const ns_own_switch *s, int given) {
    static const double edge = 1e-9; /* of |vh|: a point there, but for rounding, is still on its side */
    if (!dc)
        return given;
    if (!(dc->CKTmode & MODEDCTRANCURVE) || (dc->CKTmode & (MODEINITJCT | MODEINITFIX)))
        return 1;
    const double *from = dc->CKTmode & MODEINITPRED ? dc->CKTstate1 : dc->CKTstate0;
    const int inside = fabs(from[control] - s->vt) < (1.0 - edge) * s->early;
    return inside ? is_closed_inside(dc, state, given) : from[control] < s->vt;
}

void ns_bridge_own_read_switch(const GENinstance *inst, const CKTcircuit *dc, ns_own_switch *s) {
    const SWinstance *sw = (const SWinstance *)inst;
    const SWmodel *model = SWmodPtr(sw);
    *s = (ns_own_switch){.p = sw->SWposNode,
                         .n = sw->SWnegNode,
                         .cp = sw->SWposCntrlNode,
                         .cn = sw->SWnegCntrlNode,
                         .vt = model->SWvThreshold,
                         .vh = fmax(model->SWvHysteresis, 0.0),
                         .early = fmax(-model->SWvHysteresis, 0.0),
                         .ron = ohms_of(model->SWonConduct),
                         .roff = ohms_of(model->SWoffConduct),
                         .closed = is_closed_inside(dc, sw->SWswitchstate, sw->SWzero_stateGiven)};
    if (s->early > 0.0)
        s->closed = is_closed_early(dc, sw->SWswitchstate, sw->SWctrlvalue, s, sw->SWzero_stateGiven);
}

/* Where the current lies inside the hysteresis, the second iteration takes the state of the point before, not
 * that of the first iteration (as an S does): before the first point that is open, so ON counts with uic
 * only. */
void ns_bridge_own_read_current_switch(const GENinstance *inst, const CKTcircuit *dc, int uic,
                                       ns_own_switch *s) {
    const CSWinstance *w = (const CSWinstance *)inst;
    const CSWmodel *model = CSWmodPtr(w);
    *s = (ns_own_switch){.p = w->CSWposNode,
                         .n = w->CSWnegNode,
                         .branch = w->CSWcontBranch,
                         .vt = model->CSWiThreshold,
                         .vh = fmax(model->CSWiHysteresis, 0.0),
                         .early = fmax(-model->CSWiHysteresis, 0.0),
                         .ron = ohms_of(model->CSWonConduct),
                         .roff = ohms_of(model->CSWoffConduct),
                         .closed = is_closed_inside(dc, w->CSWswitchstate, uic && w->CSWzero_stateGiven)};
    if (s->early > 0.0)
        s->closed = is_closed_early(dc, w->CSWswitchstate, w->CSWctrlvalue, s, w->CSWzero_stateGiven);
}

/* As in ngspice's load: the sidewall has a law of its own only if its emission coefficient was given. */
static void read_law(const DIOinstance *d, const DIOmodel *model, ns_diode_law *law) {
    const double vt = CONSTboltz / CHARGE * d->DIOtemp;
    *law = (ns_diode_law){.bottom = {d->DIOtSatCur, model->DIOemissionCoeff * vt},
                          .knee = model->DIOforwardKneeCurrentGiven ? d->DIOforwardKneeCurrent : 0.0};
    if (model->DIOsatSWCurGiven && model->DIOswEmissionCoeffGiven)
        law->side = (ns_diode_exponential){d->DIOtSatSWCur, model->DIOswEmissionCoeff * vt};
    else if (model->DIOsatSWCurGiven)
        law->bottom.amperes += d->DIOtSatSWCur;
    if (model->DIOrecSatCurGiven) {
        law->recombination = (ns_diode_exponential){d->DIOtRecSatCur, model->DIOrecEmissionCoeff * vt};
        law->vj = d->DIOtJctPot;
        law->m = d->DIOtGradingCoeff;
    }
}

/* DIOtBrkdwnV is shifted by IBV, so the given voltage is taken to the temperature here. */
static double breakdown_of(const DIOinstance *d, const DIOmodel *model) {
    const double dt = d->DIOtemp - model->DIOnomTemp;
    if (!model->DIObreakdownVoltageGiven)
        return INFINITY;
    return model->DIOtlev == 0 ? model->DIObreakdownVoltage - model->DIOtcv * dt
                               : model->DIObreakdownVoltage * (1.0 - model->DIOtcv * dt);
}

/* At its temperature.  Where none is given, some versions take one that only helps them converge. */
static double series_of(const DIOinstance *d, const DIOmodel *model) {
    const int given = model->DIOresistGiven && model->DIOresist != 0.0;
    return given && d->DIOtConductance != 0.0 ? 1.0 / d->DIOtConductance : 0.0;
}

void ns_bridge_own_read_diode(const GENinstance *inst, ns_own_diode *d) {
    const DIOinstance *dio = (const DIOinstance *)inst;
    const DIOmodel *model = DIOmodPtr(dio);
    *d = (ns_own_diode){.anode = dio->DIOposNode,
                        .cathode = dio->DIOnegNode,
                        .inside = dio->DIOposPrimeNode,
                        .rs = series_of(dio, model),
                        .bv = breakdown_of(dio, model),
                        .farads = dio->DIOtJctCap + dio->DIOtJctSWCap,
                        .built_in = dio->DIOtJctPot,
                        .grading = dio->DIOtGradingCoeff,
                        .tt = model->DIOtransitTime,
                        .is_default =
                            !model->DIOsatCurGiven && !model->DIOemissionCoeffGiven && !model->DIOresistGiven,
                        .heats = dio->DIOtempNode > 0 && dio->DIOthermal && model->DIOrth0Given};
    read_law(dio, model, &d->law);
    if (isfinite(d->bv))
        d->breakdown = (ns_breakdown_law){dio->DIOtBrkdwnV, d->law.bottom.amperes + d->law.side.amperes,
                                          model->DIObrkdEmissionCoeff * CONSTboltz / CHARGE * dio->DIOtemp};
}

double ns_bridge_own_junction(const ns_own_diode *d, double v) {
    return d->built_in > 0.0 ? d->farads * pow(1.0 + v / d->built_in, -d->grading) : d->farads;
}

static double conductance_at(double v, double i, double on, double off, int is_on) {
    const double siemens = i / v;
    return siemens > 0.0 && isfinite(siemens) ? siemens : is_on && isfinite(on) ? on : off;
}

void ns_bridge_own_write_switch(GENinstance *inst, CKTcircuit *ckt, double v, double i, int on) {
    if (inst->GENmodPtr->GENmodType == TYPE_SW) {
        SWinstance *s = (SWinstance *)inst;
        s->SWcond = conductance_at(v, i, SWmodPtr(s)->SWonConduct, SWmodPtr(s)->SWoffConduct, on);
        ckt->CKTstate0[s->SWswitchstate] = on;
    } else {
        CSWinstance *w = (CSWinstance *)inst;
        w->CSWcond = conductance_at(v, i, CSWmodPtr(w)->CSWonConduct, CSWmodPtr(w)->CSWoffConduct, on);
        ckt->CKTstate0[w->CSWswitchstate] = on;
        if (ckt->CKTmode & MODEDCTRANCURVE) /* ngspice itself keeps it for S only */
            ckt->CKTstate0[w->CSWctrlvalue] = ckt->CKTrhsOld[w->CSWcontBranch];
    }
}

void ns_bridge_own_write_diode(GENinstance *inst, CKTcircuit *ckt, double v, double i) {
    const DIOinstance *d = (const DIOinstance *)inst;
    ckt->CKTstate0[d->DIOvoltage] = v;
    ckt->CKTstate0[d->DIOcurrent] = i;
}
