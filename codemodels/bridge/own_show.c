/* bridge/own_show.c - ngspice's own devices that were taken: what they show of a point, and what they were
 * taken for. */
#include "own_show.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "own_current.h"
#include "own_open.h"
#include "own_structs.h"
#include "report.h"

static void read_device(const ns_analysis *a, const ns_own_taken *o, double *i, double *v, int *on) {
    *i = *v = 0.0;
    *on = 0;
    if (o->id >= 0)
        ns_circuit_device(a->ex.circuit, o->id, a->x, a->lambda, a->mode, i, v, on);
    ns_bridge_own_add_beyond(a, o, a->mode, i);
    ns_bridge_own_add_beside_early(a, o, i, on);
}

void ns_bridge_own_show_values(const ns_analysis *a, double *value) {
    double i, v;
    int on;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        for (int h = 0; h < OWN_HIDDEN && o->kind == OWN_MOSFET; h++)
            if (o->mosfet.hidden[h].inside)
                value[o->mosfet.hidden[h].inside] = value[o->mosfet.hidden[h].outside];
        if (!o->inside)
            continue;
        read_device(a, o, &i, &v, &on);
        value[o->inside] = value[o->anode] - o->rs * i;
    }
}

/* The current into the drain: of the channel, less that of an n channel's body diode, and what a follower
 * carries backwards. */
static void show_mosfet(const ns_analysis *a, const ns_own_taken *o, CKTcircuit *ckt, double i) {
    double body = 0.0, back = 0.0;
    ns_circuit_device(a->ex.circuit, o->body, a->x, a->lambda, a->mode, &body, NULL, NULL);
    if (o->back >= 0)
        ns_circuit_device(a->ex.circuit, o->back, a->x, a->lambda, a->mode, &back, NULL, NULL);
    const double channel = o->follows ? o->mosfet.sign * (i - back) : i;
    ns_bridge_own_write_mosfet(o->inst, ckt, channel - o->mosfet.sign * body, ckt->CKTrhsOld);
}

void ns_bridge_own_show_states(const ns_analysis *a, CKTcircuit *ckt) {
    double i, v;
    int on;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (o->id < 0 || o->kind == OWN_SIDIODE || o->kind == OWN_PSWITCH) /* they show nothing */
            continue;
        read_device(a, o, &i, &v, &on);
        if (o->kind == OWN_MOSFET)
            show_mosfet(a, o, ckt, i);
        else if (o->kind == OWN_DIODE)
            ns_bridge_own_write_diode(o->inst, ckt, v - (o->inside ? o->rs * i : 0.0), i);
        else
            ns_bridge_own_write_switch(o->inst, ckt, v, i, on != o->inverted);
    }
}

/* --- what was taken, once --- */

static int are_same_diode(const ns_diode *a, const ns_diode *b) {
    return a->vf == b->vf && a->ron == b->ron && a->vz == b->vz && a->rz == b->rz;
}

/* Of one model, and taken for the same. */
static int are_alike(const ns_own_taken *a, const ns_own_taken *b) {
    return a->inst->GENmodPtr == b->inst->GENmodPtr && a->ron == b->ron && a->vt == b->vt &&
           are_same_diode(&a->diode, &b->diode) && are_same_diode(&a->beyond, &b->beyond) &&
           a->pass.idle == b->pass.idle && a->pass.faint == b->pass.faint;
}

/* How many are like the k-th; 0: one before it is. */
static int count_alike(const ns_extract *ex, int k) {
    int count = 0;
    for (int other = 0; other < ex->nowns; other++) {
        const int alike = are_alike(&ex->own[k], &ex->own[other]);
        if (alike && other < k)
            return 0;
        count += alike;
    }
    return count;
}

/* As the user wrote it: ngspice puts an `a` before the names of models that it made code models of, and
 * before those of their instances. */
static const char *model_name(const ns_own_taken *o) {
    const char *name = o->inst->GENmodPtr->GENmodName, *dot = strrchr(o->inst->GENname, '.');
    const char *own = dot ? dot + 1 : o->inst->GENname;
    const int made = (o->kind == OWN_SIDIODE || o->kind == OWN_PSWITCH) && own[0] == 'a' && own[1] &&
                     strchr("dsw", own[1]);
    return made && name[0] == 'a' && name[1] ? name + 1 : name;
}

static int are_of_one_model(const ns_own_taken *a, const ns_own_taken *b) {
    return a->inst->GENmodPtr == b->inst->GENmodPtr;
}

/* Those of a model: how many, or their names, where others of it were taken otherwise. */
static void name_diodes(const ns_extract *ex, const ns_own_taken *o, int count, char *names, size_t size) {
    int others = 0;
    size_t used = 0;
    for (int k = 0; k < ex->nowns; k++)
        others |= are_of_one_model(&ex->own[k], o) && !are_alike(&ex->own[k], o);
    snprintf(names, size, "%d", count);
    for (int k = 0; others && k < ex->nowns; k++) {
        const char *name = ex->own[k].inst->GENname;
        if (!are_alike(&ex->own[k], o))
            continue;
        if (used + strlen(name) + 40 > size) {
            snprintf(names + used, size - used, " and %d more", count);
            return;
        }
        used += (size_t)snprintf(names + used, size - used, "%s%s", used > 0 ? ", " : "", name);
        count--;
    }
}

/* Where its vf comes from. */
static void write_at(const ns_own_taken *o, char *line, size_t size) {
    const char *how = o->pass.idle    ? ": it did not conduct in"
                      : o->pass.faint ? ": it carried less than 1 nA in"
                                      : ", its current in";
    const char *what = o->beyond_id       ? "two lines"
                       : o->pass.to > 0.0 ? "a line"
                       : o->pass.tangent  ? "the tangent"
                                          : "that";
    size_t used = (size_t)snprintf(line, size, " (%s of its model at %.4g A", what, o->at);
    if (o->pass.to > 0.0)
        used += (size_t)snprintf(line + used, size - used, " to %.4g A", o->pass.to);
    if (o->pass.seconds > 0.0 && (o->pass.idle || o->pass.faint || !o->pass.whole))
        snprintf(line + used, size - used, "%s the first %.4g s)", how, o->pass.seconds);
    else
        snprintf(line + used, size - used, ")");
}

/* ngspice left such parameters of LTspice's out, with a line of its own for each. */
static void announce_default(const ns_analysis *a, int k) {
    const ns_own_taken *o = &a->ex.own[k];
    ns_own_diode d;
    for (int before = 0; before < k; before++)
        if (are_of_one_model(&a->ex.own[before], o))
            return;
    ns_bridge_own_read_diode(o->inst, &d);
    if (d.is_default)
        ns_bridge_report_note(
            "D of model %s: none of is, n, rs is given, so it is ngspice's default diode "
            "(which leaves out Ron, Roff, Vfwd, Vrev without a line `set ngbehavior=ltpsa` in .spiceinit)",
            model_name(o));
}

static void announce_diodes(const ns_analysis *a, int k, int count) {
    const ns_own_taken *o = &a->ex.own[k];
    const ns_diode *d = &o->diode;
    char breakdown[120] = "", beyond[80] = "", at[120] = "", names[120];
    name_diodes(&a->ex, o, count, names, sizeof names);
    if (isfinite(d->vz) && o->pass.broken > 0.0)
        snprintf(breakdown, sizeof breakdown, ", breakdown at %.4g V with %.4g ohm (of its model at %.4g A)",
                 d->vz, d->rz, o->pass.broken);
    else if (isfinite(d->vz))
        snprintf(breakdown, sizeof breakdown, ", breakdown at %.4g V", d->vz);
    if (o->kind == OWN_DIODE && !a->ex.options.zero_diodes)
        write_at(o, at, sizeof at);
    if (o->beyond_id)
        snprintf(beyond, sizeof beyond, ", above %.4g V %.4g ohm", o->beyond.vf,
                 ns_bridge_own_slope_beyond(o));
    ns_bridge_report_note("D of model %s: %s taken as ideal, vf = %.4g V%s, ron = %.4g ohm%s%s%s%s",
                          model_name(o), names, d->vf, o->pass.tangent ? "" : at, d->ron, beyond,
                          o->pass.tangent ? at : "", breakdown, o->smoothed ? ", its epsilon left out" : "");
    if (o->kind == OWN_DIODE)
        announce_default(a, k);
}

static void announce_mosfets(const ns_own_taken *o, int count) {
    char overdrive[100] = "", closed[100];
    if (!o->follows && !(o->drive > o->mosfet.vth)) {
        ns_bridge_report_note(
            "%s of model %s%s: taken as open, as its gate rests at %.4g V, not above %.4g V, with a body "
            "diode, vf = %.4g V, ron = %.4g ohm",
            o->inst->GENname, o->inst->GENmodPtr->GENmodName, count > 1 ? " and others of it" : "", o->drive,
            o->mosfet.vth, o->diode.vf, o->diode.ron);
        return;
    }
    snprintf(closed, sizeof closed, "ron = %.4g ohm (of its model at %.4g V", o->ron, o->drive);
    if (o->closed.volts > 1e-3 * o->ron * o->closed.at)
        snprintf(closed, sizeof closed, "%.4g V and ron = %.4g ohm (of its model at %.4g V, %.4g A",
                 o->closed.volts, o->ron, o->drive, o->closed.at);
    if (o->overdrive.at > 0.0)
        snprintf(overdrive, sizeof overdrive, " (by %.4g V and %.4g ohm beyond that, as its model at %.4g A)",
                 o->overdrive.volts, o->overdrive.ohm, o->overdrive.at);
    ns_bridge_report_note(
        "%s of model %s%s: taken as a switch, closed above %.4g V with %s)%s%s, and a body "
        "diode, vf = %.4g V, ron = %.4g ohm",
        o->inst->GENname, o->inst->GENmodPtr->GENmodName, count > 1 ? " and others of it" : "", o->mosfet.vth,
        closed,
        o->follows == FOLLOWS_DRAIN ? ", which holds its gate there while its drain swings"
        : o->follows == FOLLOWS_SHUNT
            ? ", its current limited where the voltage of its shunt takes v(gate,source) back to that"
        : o->follows ? ", as a source follower where its gate is lower"
                     : "",
        overdrive, o->diode.vf, o->diode.ron);
}

/* --- is it what was announced? --- */

static void mix_number(unsigned long long *hash, double number) {
    unsigned long long bits;
    memcpy(&bits, &number, sizeof bits);
    *hash = (*hash ^ bits) * 1099511628211ULL; /* FNV-1a, by words */
}

/* Of models, not of currents that D are read at: these are others in each step of a sweep. */
unsigned long long ns_bridge_own_hash(const ns_analysis *a) {
    unsigned long long hash = 14695981039346656037ULL;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        ns_own_diode d = {0};
        if (o->kind == OWN_DIODE)
            ns_bridge_own_read_diode(o->inst, &d);
        const double numbers[] = {o->sw.vt,
                                  o->sw.vh,
                                  o->sw.ron,
                                  o->sw.roff,
                                  o->mosfet.vth,
                                  o->mosfet.beta,
                                  o->mosfet.theta,
                                  o->mosfet.triode,
                                  o->mosfet.shift,
                                  o->mosfet.slope,
                                  o->mosfet.series,
                                  d.rs,
                                  d.bv,
                                  d.law.bottom.amperes,
                                  d.law.bottom.volts};
        for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
            mix_number(&hash, numbers[i]);
    }
    return hash;
}

void ns_bridge_own_announce(const ns_analysis *a) {
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        const int count = count_alike(&a->ex, k);
        if (count > 0 && o->kind == OWN_MOSFET)
            announce_mosfets(o, count);
        else if (count > 0 && (o->kind == OWN_DIODE || o->kind == OWN_SIDIODE))
            announce_diodes(a, k, count);
        else if (count > 0 && o->kind == OWN_PSWITCH)
            ns_bridge_report_note(
                "switch of model %s: %d taken as ideal, changing at %.4g, the middle of on and off",
                model_name(o), count, o->vt);
        else if (count > 0)
            ns_bridge_report_note("%c of model %s: %d taken as %s",
                                  toupper((unsigned char)o->inst->GENname[0]), o->inst->GENmodPtr->GENmodName,
                                  count, count == 1 ? "it is" : "they are");
    }
    ns_bridge_own_announce_open(&a->ex);
}
