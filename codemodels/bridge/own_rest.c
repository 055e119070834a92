/* bridge/own_rest.c - S and W of vh = 0 whose control is at its threshold from the start on.
 *
 * ngspice's swload.c and cswload.c have them closed in the operating point (with uic: as they came there) and
 * until the control first leaves.  Where that is known of a source, own_start.c holds them; the others are
 * found here, by a pass that goes on until all have left.
 */
#include "own_rest.h"

#include <math.h>
#include <stdlib.h>

#include "own_elements.h"
#include "report.h"

/* In steps times unknowns and devices: how far the pass goes. */
static const double most_work = 30e6;

static double at(const ns_analysis *a, const double *x, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? x[a->unknown[eq]] : 0.0;
}

/* V or A: how far its control is above its threshold. */
static double above(const ns_analysis *a, const double *x, const ns_own_switch *s) {
    return (s->branch > 0 ? at(a, x, s->branch) : at(a, x, s->cp) - at(a, x, s->cn)) - s->vt;
}

/* V or A: how large what it is the difference of is. */
static double size_of(const ns_analysis *a, const double *x, const ns_own_switch *s) {
    return s->branch > 0 ? fabs(at(a, x, s->branch)) : fabs(at(a, x, s->cp)) + fabs(at(a, x, s->cn));
}

static int is_at_threshold(const ns_analysis *a, const double *x, const ns_own_switch *s) {
    static const double rounding = 0.25; /* less than what own_start.c holds it by */
    return fabs(above(a, x, s)) <= rounding * ns_circuit_switch_shift(s->vt, 0.0);
}

/* Its state at its threshold is not known yet. */
static int is_open_question(const ns_own_taken *o) {
    return (o->kind == OWN_SWITCH || o->kind == OWN_CURRENT_SWITCH) && o->id >= 0 && o->sw.vh == 0.0 &&
           o->sw.early == 0.0 && !o->sw.held;
}

static int find(const CKTcircuit *ckt, const ns_analysis *a, const double *x, ns_own_found *found) {
    const int uic = (ckt->CKTmode & MODEUIC) != 0;
    found->start = calloc((size_t)a->ex.nowns + 1, sizeof *found->start);
    if (!found->start)
        return NS_E_MEMORY;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (is_open_question(o) && is_at_threshold(a, x, &o->sw))
            found->start[found->nstarts++] =
                (ns_own_start){.inst = o->inst,
                               .size = size_of(a, x, &o->sw),
                               .closed = ns_bridge_own_is_closed_at_rest(ckt, uic, &o->sw),
                               .until = {INFINITY, INFINITY}};
    }
    return NS_OK;
}

int ns_bridge_own_find_resting(const CKTcircuit *ckt, const ns_analysis *a, ns_own_found *found, int *any) {
    int count = 0;
    for (int k = 0; k < a->ex.nowns && !ns_bridge_digital_is(&a->ex.digital); k++)
        count += is_open_question(&a->ex.own[k]);
    *any = 0;
    if (count == 0 || found->start)
        return NS_OK;
    double *x = calloc(a->count + 1, sizeof *x);
    int status = x ? ns_march_read(a->march, NULL, x, NULL, NULL) : NS_E_MEMORY;
    status = status ? status : find(ckt, a, x, found);
    *any = found->nstarts > 0;
    free(x);
    return status;
}

static const ns_own_switch *switch_of(const ns_analysis *a, const GENinstance *inst) {
    for (int k = 0; k < a->ex.nowns; k++)
        if (a->ex.own[k].inst == inst)
            return &a->ex.own[k].sw;
    return NULL;
}

/* At x, from the accepted time t to t_end: those that left since are marked.  The number of the others. */
static int mark(const ns_analysis *a, const double *x, double t, double t_end, ns_own_found *found) {
    int resting = 0;
    for (int k = 0; k < found->nstarts; k++) {
        ns_own_start *start = &found->start[k];
        const ns_own_switch *s = switch_of(a, start->inst);
        if (!s || isfinite(start->until[1]))
            continue;
        if (is_at_threshold(a, x, s)) {
            resting++;
            continue;
        }
        start->falls = above(a, x, s) < 0.0;
        start->until[0] = t;
        start->until[1] = fmax(t_end, nextafter(t, INFINITY));
    }
    return resting;
}

int ns_bridge_own_find_leaving(const ns_analysis *a, ns_march *march, double stop, ns_own_found *found) {
    double *x = calloc(a->count + 1, sizeof *x), t = 0.0, t_end = 0.0;
    int status = x ? NS_OK : NS_E_MEMORY, resting = found->nstarts;
    for (double work = 0.0; status == NS_OK && resting > 0 && t < stop && work < most_work;
         work += (double)a->count + 1.0) {
        status = ns_march_try(march, stop, NS_TO_STEP, &t_end);
        status = status ? status : ns_march_read(march, &t_end, x, NULL, NULL);
        if (status == NS_OK)
            resting = mark(a, x, t, t_end, found);
        status = status ? status : ns_march_accept(march);
        t = t_end;
    }
    free(x);
    return status == NS_E_MEMORY ? status : NS_OK;
}

/* --- every point --- */

static int refuse_resting(const ns_analysis *a, const ns_own_taken *o, double t) {
    const ns_digital *d = &a->ex.digital;
    const int undefined = o->sw.branch <= 0 && (ns_bridge_digital_is_undefined(d, o->sw.cp) ||
                                                ns_bridge_digital_is_undefined(d, o->sw.cn));
    ns_bridge_report_error(
        "%s: at t = %.6g s: its control comes to rest at its threshold, %g, from %s: ngspice "
        "%s it there, which is not supported of such a control; %s",
        o->inst->GENname, t, o->sw.vt, o->rest.side > 0 ? "above" : "below",
        o->rest.side > 0 ? "opens" : "closes",
        undefined ? "that is the out_undef of a dac_bridge, give it another one" : "shift vt by a little");
    return E_UNSUPP;
}

/* Whether ngspice has the switch in the other state at a point, where its control is at the threshold: it
 * opens what comes from above, and closes what comes from below. */
static int differs(const ns_analysis *a, ns_own_taken *o, double above_by) {
    static const double rounding = 0.25;
    int on;
    if (!(fabs(above_by) <= rounding * ns_circuit_switch_shift(o->sw.vt, 0.0))) {
        o->rest.side = above_by > 0.0 ? 1 : -1;
        return 0;
    }
    ns_circuit_device(a->ex.circuit, o->id, a->x, a->lambda, a->mode, NULL, NULL, &on);
    return o->rest.side != 0 && (on != o->inverted) != (o->rest.side < 0);
}

int ns_bridge_own_check_resting(ns_analysis *a, const double *value, double t, double least) {
    for (int k = 0; k < a->ex.nowns; k++) {
        ns_own_taken *o = &a->ex.own[k];
        const ns_own_switch *s = &o->sw;
        if ((o->kind != OWN_SWITCH && o->kind != OWN_CURRENT_SWITCH) || o->id < 0 || s->vh != 0.0 ||
            s->early != 0.0)
            continue;
        const double control = s->branch > 0 ? value[s->branch] : value[s->cp] - value[s->cn];
        const int first = !(o->rest.differs <= t); /* where it leaves, the switch may have changed already */
        if (!differs(a, o, control - s->vt))
            o->rest.differs = NAN;
        else if (first)
            o->rest.differs = t;
        else if (t - o->rest.differs > least)
            return refuse_resting(a, o, o->rest.differs);
    }
    return OK;
}
