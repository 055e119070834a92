/* bridge/single_load.c - one load a timepoint.
 *
 * ngspice's Newton loop takes two rounds of load, factorisation and solve at least, and a test.  Where
 * the mode says MODETRANOP and MODEUIC (its way to skip the operating point) it loads once and returns, and
 * what CKTrhsOld holds then is the solution.  So between a point that is shown and the next load the mode
 * says that; our load, which runs last, restores the mode and writes the solution there.  What the loads of C
 * and L do for a solution in any other mode, the states behind @c1[i] and @l1[flux], is done here.
 *
 * Without CIDER ngspice does not say when a point was shown: then it is made ready at the accept before. What
 * is shown is read in between.  C and M have a current in any mode, if the analysis is not said to be .tran;
 * a MOS1 or MOS3 whose parameters are shown has no gate current in that mode, so such a circuit is loaded
 * twice.
 *
 * The run may be stopped in between, and C shows no current in that mode.  A code model is not informed of a
 * stop; but every command that asks for a device by its name, or alters one, looks it up in ngspice's table
 * of names. Until the next load the comparison of keys of this table is ours, and takes the mode back. */
#include "session.h"

#include <string.h>

#include "versions.h"

#include "spicelib/devices/cap/capdefs.h"
#include "spicelib/devices/ind/inddefs.h"
#include "spicelib/devices/isrc/isrcdefs.h"

static const long skip = MODETRANOP | MODEUIC | MODEINITFLOAT; /* without MODETRAN C and L do not integrate */

static ns_session *armed; /* the one whose next point is to be loaded once, or NULL */

/* 0 for the same names. */
static int compare_keys(const void *key, const void *wanted) {
    if (armed)
        ns_bridge_single_load_forget(armed);
    return ns_bridge_versions_names_differ(key, wanted);
}

/* 1 if look-ups of devices are seen. */
static int watch_names(const CKTcircuit *ckt) {
    NGHASHPTR names = ckt->DEVnameHash;
    if (names->compare_func == ns_bridge_versions_compare_names())
        names->compare_func = compare_keys;
    return names->compare_func == compare_keys;
}

/* At the first load of a point the new states of a code model should hold those of the point before.  In that
 * mode they hold older ones, as ngspice rotates the states before it loads: they are copied here. */
static void keep_states(const CKTcircuit *ckt) {
    memcpy(ckt->CKTstates[ckt->CKTmaxOrder + 1], ckt->CKTstate0,
           (size_t)ckt->CKTnumStates * sizeof *ckt->CKTstate0);
}

void ns_bridge_single_load_arm(ns_session *s) {
    CKTcircuit *ckt = s->ckt;
    /* at t = 0 the first load makes the matrix ready, and the states */
    if (!s->analysis.march || !s->trial.made || s->failed ||
        ns_bridge_digital_has_others(&s->analysis.ex.digital) || s->source_check.pending ||
        !(ckt->CKTtime > 0.0) || !watch_names(ckt))
        return;
    if (armed) /* another circuit, stopped */
        ns_bridge_single_load_forget(armed);
    s->single_load.mode = ckt->CKTmode;
    s->single_load.armed = 1;
    armed = s;
    ckt->CKTmode = skip;
    if (!ns_bridge_versions_hooks_shown())
        ckt->CKTcurrentAnalysis = 0; /* ngspice sets it before the next load */
    if (ns_bridge_digital_is(&s->analysis.ex.digital))
        keep_states(ckt);
}

int ns_bridge_single_load_begin(ns_session *s) {
    const int skips = s->single_load.armed && s->ckt->CKTmode == skip; /* else it was stopped and resumed */
    ns_bridge_single_load_forget(s);
    return skips;
}

/* As integrated by backward Euler: CKTorder is 1 throughout. */
static void set_state(CKTcircuit *ckt, int at, double value) {
    ckt->CKTstate0[at] = value;
    ckt->CKTstate0[at + 1] = ckt->CKTag[0] * value + ckt->CKTag[1] * ckt->CKTstate1[at];
}

static void set_charges(CKTcircuit *ckt, GENmodel *models, const double *x) {
    for (CAPmodel *model = (CAPmodel *)models; model; model = CAPnextModel(model))
        for (const CAPinstance *c = CAPinstances(model); c; c = CAPnextInstance(c))
            set_state(ckt, c->CAPqcap, c->CAPcapac * (x[c->CAPposNode] - x[c->CAPnegNode]));
}

static void set_fluxes(CKTcircuit *ckt, GENmodel *models, GENmodel *couplings, const double *x) {
    double *state = ckt->CKTstate0;
    for (INDmodel *model = (INDmodel *)models; model; model = INDnextModel(model))
        for (const INDinstance *l = INDinstances(model); l; l = INDnextInstance(l))
            state[l->INDflux] = l->INDinduct / l->INDm * x[l->INDbrEq];
    for (MUTmodel *model = (MUTmodel *)couplings; model; model = MUTnextModel(model)) {
        for (const MUTinstance *k = MUTinstances(model); k; k = MUTnextInstance(k)) {
            state[k->MUTind1->INDflux] += k->MUTfactor * x[k->MUTind2->INDbrEq];
            state[k->MUTind2->INDflux] += k->MUTfactor * x[k->MUTind1->INDbrEq];
        }
    }
    for (INDmodel *model = (INDmodel *)models; model; model = INDnextModel(model))
        for (const INDinstance *l = INDinstances(model); l; l = INDnextInstance(l))
            set_state(ckt, l->INDflux, state[l->INDflux]);
}

/* @i1[current]: in that mode ngspice's load takes I for what they are at t = 0. */
static void set_waves(const ns_session *s) {
    const ns_extract *ex = &s->analysis.ex;
    for (int k = 0; k < ex->nwaves; k++)
        ((ISRCinstance *)ex->wave[k].inst)->ISRCcurrent =
            ns_signal_value(&s->analysis.system->z[ex->wave[k].input], s->ckt->CKTtime, NS_LEFT);
}

static GENmodel *models_of(const CKTcircuit *ckt, int type) {
    return type < 0 ? NULL : ckt->CKThead[type];
}

void ns_bridge_single_load_end(ns_session *s) {
    CKTcircuit *ckt = s->ckt;
    const ns_extract *ex = &s->analysis.ex;
    const size_t size = (size_t)ex->neq * sizeof *s->force.value;
    memcpy(ckt->CKTrhsOld, s->force.value, size);
    memcpy(ckt->CKTrhs, s->force.value, size);
    set_charges(ckt, models_of(ckt, ex->capacitors), s->force.value);
    set_fluxes(ckt, models_of(ckt, ex->inductors), models_of(ckt, ex->couplings), s->force.value);
    set_waves(s);
}

void ns_bridge_single_load_forget(ns_session *s) {
    if (s->single_load.armed) {
        s->ckt->CKTmode = s->single_load.mode;
        if (!s->ckt->CKTcurrentAnalysis)
            s->ckt->CKTcurrentAnalysis = DOING_TRAN;
        armed = NULL;
    }
    s->single_load.armed = 0;
}
