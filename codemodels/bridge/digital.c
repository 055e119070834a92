/* bridge/digital.c - XSPICE's digital parts while an analysis runs. */
#include "digital_control.h"
#include "digital_run.h"
#include "pure/late_text.h"
#include "report.h"

#include <math.h>
#include <string.h>

#include "ngspice/cmtypes.h"

static const double short_step = 4.0; /* of what ngspice can tell apart */

static ns_digital *digital_of(ns_session *s) {
    return &s->analysis.ex.digital;
}

/* --- thresholds --- */

static int unknown_at(const ns_analysis *a, int eq) {
    return eq > 0 ? a->unknown[eq] : -1;
}

/* Tells the marcher on which side of its thresholds each adc_bridge is. */
static int watch(ns_session *s) {
    ns_digital *d = digital_of(s);
    int count = 0;
    for (int k = 0; k < d->ninputs; k++) {
        const ns_digital_input *in = &d->input[k];
        if (!in->is_bridge)
            continue;
        const int p = unknown_at(&s->analysis, in->p), n = unknown_at(&s->analysis, in->n);
        d->threshold[count++] = (ns_threshold){p, n, in->low, in->above_low, 0};
        d->threshold[count++] = (ns_threshold){p, n, in->high, in->above_high, in->high > in->low};
    }
    return ns_march_watch(s->analysis.march, count, d->threshold);
}

/* What was crossed changes sides. */
static void change_sides(ns_digital *d, const unsigned char *crossed) {
    for (int k = 0, at = 0; k < d->ninputs; k++) {
        ns_digital_input *in = &d->input[k];
        if (!in->is_bridge)
            continue;
        in->above_low ^= crossed[at++];
        in->above_high ^= crossed[at++];
    }
}

/* The value of an input at force.value, at the right side of its thresholds, where rounding decides nothing.
 */
static double value_of(const ns_session *s, const ns_digital_input *in) {
    const double *value = s->force.value;
    double v = (in->p > 0 ? value[in->p] : 0.0) - (in->n > 0 ? value[in->n] : 0.0);
    if (!in->is_bridge)
        return v;
    v = in->above_low ? fmax(v, nextafter(in->low, INFINITY)) : fmin(v, in->low);
    return in->above_high ? fmax(v, fmax(in->high, nextafter(in->low, INFINITY)))
                          : fmin(v, nextafter(in->high, -INFINITY));
}

/* --- start --- */

int ns_bridge_digital_begin(ns_session *s) {
    static const double near = 1e-13; /* rounding */
    enum { FIRST_POINTS = 2 };        /* some versions of ngspice do not show the first one to its parts */
    ns_digital *d = digital_of(s);
    if (!ns_bridge_digital_is(d))
        return NS_OK;
    if (!d->threshold && !(d->threshold = calloc(2 * (size_t)d->ninputs + 1, sizeof *d->threshold)))
        return NS_E_MEMORY;
    for (int k = 0; k < d->ninputs; k++) {
        ns_digital_input *in = &d->input[k];
        const double v = ns_bridge_digital_plain(s, in), at = near * fmax(fabs(in->low), fabs(in->high));
        in->above_low = v > in->low + at;
        in->above_high = in->above_low && v >= in->high - at;
        if (in->control)
            ns_bridge_digital_control_begin(in->control, s->ckt, s->trial.t, v);
    }
    d->short_steps = FIRST_POINTS;
    d->reach = short_step;
    const int status = ns_bridge_digital_look_ahead(d, s->ckt);
    return status ? status : watch(s);
}

double ns_bridge_digital_plain(const ns_session *s, const ns_digital_input *in) {
    const ns_analysis *a = &s->analysis;
    const int p = unknown_at(a, in->p), n = unknown_at(a, in->n);
    return (p >= 0 ? a->x[p] : 0.0) - (n >= 0 ? a->x[n] : 0.0);
}

int ns_bridge_digital_is_stale(const ns_session *s) {
    const ns_digital *d = &s->analysis.ex.digital;
    for (int k = 0; k < d->noutputs; k++)
        if (ns_bridge_digital_state(d->output[k].port) != d->output[k].state)
            return 1;
    return 0;
}

/* --- loads --- */

void ns_bridge_digital_load(ns_session *s) {
    ns_digital *d = digital_of(s);
    double t = 0.0;
    if (!ns_bridge_digital_is(d))
        return;
    const unsigned char *crossed = ns_march_crossed(s->analysis.march);
    if (crossed && !d->crossed && ns_march_read(s->analysis.march, &t, NULL, NULL, NULL) == NS_OK &&
        (s->ckt->CKTtime >= t || ns_bridge_timepoints_same(s->ckt->CKTtime, t))) {
        change_sides(d, crossed);
        d->crossed = 1;
    }
    for (int k = 0; k < d->ninputs; k++) {
        ns_digital_input *in = &d->input[k];
        in->port->input.rvalue = value_of(s, in);
    }
    s->ckt->CKTnoncon = 0;
}

/* --- accepts --- */

/* The output goes to the level of a state from the time t on, at which it is at v. */
static int set_output(ns_session *s, ns_digital_output *o, int state, double t) {
    const double v = ns_signal_value(&s->analysis.system->z[o->input], t, NS_LEFT), to = o->level[state];
    const double swing = o->level[ONE] - o->level[ZERO];
    const int rises = state == ONE || (state == UNKNOWN && (to - v) * swing > 0.0);
    const double length = swing != 0.0 ? fabs((to - v) / swing) * (rises ? o->rise : o->fall) : 0.0;
    const double time[2] = {t, t + length}, level[2] = {v, to};
    ns_signal z = {.kind = NS_PWL};
    z.u.pwl.n = 2;
    z.u.pwl.t = time;
    z.u.pwl.v = level;
    z.u.pwl.repeat = NAN;
    o->state = state;
    return ns_march_set_input(s->analysis.march, o->input, &z);
}

/* The march is at t, beyond ngspice's time, and an output changes at that.  An event of d_osc or d_pwm moves
 * as their inputs do, and may come earlier than it was to come when the march was sent there: then the output
 * changes at t, if that is hardly later. */
static int is_too_late(const ns_session *s, double t) {
    static const double hardly = 0.01; /* of the time since an output changed */
    const ns_digital *d = &s->analysis.ex.digital;
    const double late = t - s->ckt->CKTtime;
    if (late <= 16.0 * ns_bridge_timepoints_closest(s->ckt->CKTfinalTime))
        return 0;
    return !ns_bridge_digital_has_others(d) || late > hardly * (t - d->changed);
}

/* Outputs whose event came are set; *any: some are. */
static int set_outputs(ns_session *s, int *any) {
    ns_digital *d = digital_of(s);
    double t = 0.0;
    int status = NS_OK;
    *any = 0;
    for (int k = 0; k < d->noutputs && status == NS_OK; k++) {
        ns_digital_output *o = &d->output[k];
        const int state = ns_bridge_digital_state(o->port);
        if (state == o->state)
            continue;
        *any = 1;
        status = ns_march_read(s->analysis.march, &t, NULL, NULL, NULL);
        if (status == NS_OK && is_too_late(s, t))
            status = NS_E_STATE;
        if (status == NS_OK)
            status = set_output(s, o, state, t);
    }
    if (*any && status == NS_OK)
        d->changed = t;
    return status;
}

int ns_bridge_digital_accept(ns_session *s) {
    ns_digital *d = digital_of(s);
    int any, status;
    if (!ns_bridge_digital_is(d))
        return NS_OK;
    for (int k = 0; k < d->ninputs; k++)
        if (d->input[k].control)
            ns_bridge_digital_control_accept(d->input[k].control, s->ckt->CKTtime);
    status = set_outputs(s, &any);
    if (status == NS_OK && (any || d->crossed)) {
        status = watch(s);
        if (status == NS_OK)
            status = ns_waveform_resume(s->analysis.waveform);
    }
    d->crossed = 0;
    d->reach = short_step;
    return status;
}

int ns_bridge_digital_fail_late(const ns_session *s) {
    enum { TEXT = 400 };
    const ns_digital *d = &s->analysis.ex.digital;
    const char *output = "a", *name = NULL, *model = NULL, *of, *is;
    char text[TEXT];
    double last = -INFINITY;
    for (int k = 0; k < d->noutputs; k++)
        if (ns_bridge_digital_state(d->output[k].port) != d->output[k].state)
            output = d->output[k].name;
    for (int k = 0; k < d->ninputs; k++) {
        if (!d->input[k].control || ns_bridge_digital_control_rests(d->input[k].control))
            continue;
        const double t = ns_bridge_digital_control_last(d->input[k].control, &of, &is);
        if (name && t <= last)
            continue;
        last = t;
        name = of;
        model = is;
    }
    ns_bridge_late_text(text, sizeof text, s->ckt->CKTtime, output, name, model);
    ns_bridge_report_error("%s", text);
    return ns_bridge_report_code(NS_E_STATE);
}

/* The marcher may be later than ngspice by more than a short step, after a jump: a longer one is asked for.
 */
static int ask_for_more(ns_session *s) {
    static const double most = 1e6;
    ns_digital *d = digital_of(s);
    if (!(d->reach < most) || ns_waveform_resume(s->analysis.waveform) != NS_OK)
        return 0;
    d->reach *= 4.0;
    d->short_steps = 1;
    return 1;
}

int ns_bridge_digital_goes_on(ns_session *s, int status) {
    ns_digital *d = digital_of(s);
    const unsigned char *crossed = ns_march_crossed(s->analysis.march);
    if (!ns_bridge_digital_is(d))
        return 0;
    if (!crossed)
        return status == NS_E_RANGE && ask_for_more(s);
    change_sides(d, crossed);
    if (watch(s) != NS_OK || ns_waveform_resume(s->analysis.waveform) != NS_OK)
        return 0;
    d->short_steps = d->short_steps > 0 ? d->short_steps : 1;
    return 1;
}

/* --- ngspice's queue of events --- */

/* d_osc and d_pwm foresee their next edges by their controls, which may go elsewhere at a corner. */
static double until_controls(const ns_session *s, double t, double closest) {
    const ns_digital *d = &s->analysis.ex.digital;
    const ns_system *system = s->analysis.system;
    if (!ns_bridge_digital_has_controls(d))
        return INFINITY;
    const int at_corner = ns_bridge_timepoints_corner(system, t - closest) <= t;
    const int is_near = s->analysis.many.tmax > 0.0 && !ns_bridge_digital_is_at_rest(d);
    const double tmax = is_near ? s->analysis.many.tmax : INFINITY;
    double until = fmin(t + tmax, ns_bridge_timepoints_corner(system, t));
    for (int k = 0; k < d->ninputs; k++)
        if (d->input[k].control)
            until = fmin(until, ns_bridge_digital_control_until(d->input[k].control, t, at_corner));
    return fmax(until, t + closest);
}

double ns_bridge_digital_until(ns_session *s, double until, double closest) {
    ns_digital *d = digital_of(s);
    const double t = s->ckt->CKTtime;
    if (!ns_bridge_digital_is(d))
        return until;
    if (d->short_steps > 0) {
        until = fmin(until, t + d->reach * closest);
        d->short_steps--;
    }
    if (d->reach <= short_step)
        until = fmin(until, until_controls(s, t, closest));
    return fmin(until, fmax(ns_bridge_digital_next_event(d, s->ckt), t + closest));
}
