/* bridge/waveform_points.c - timepoints that the waveform chooses (nonsmooth/waveform.h).
 *
 * The next point is computed when the one before it is accepted, and shown when ngspice comes to its time. At
 * any time in between ngspice is given what lies on the straight line. */
#include "session.h"

#include "chattering.h"
#include "digital_run.h"
#include "display.h"
#include "many_points.h"
#include "report.h"
#include "show.h"
#include "shown.h"

#include <math.h>

static int fail(const ns_session *s, int status) {
    return status ? ns_bridge_trial_fail(s, status) : OK;
}

int ns_bridge_waveform_begin(ns_session *s, double t, const ns_waveform *from) {
    s->next.held = 0;
    s->trial.t = t; /* what is consistent may be some steps of h/2^20 later */
    ns_bridge_loop_take_close(s->ckt, &s->loop);
    int status = ns_waveform_continue(s->analysis.waveform, from, &s->next.point);
    status = status ? status : ns_bridge_analysis_take(&s->analysis, &s->next.point, 1.0);
    return fail(s, status);
}

/* Where ngspice interpolates, every second point at most is at or after a multiple of tstep: it writes one
 * value for a point, however many multiples lie before it, and takes a line from the last one that it did not
 * write for.  To know whether it does, two points have to be given that way. */
static double latest_read(const ns_session *s) {
    const double start = s->ckt->CKTinitTime, stop = s->ckt->CKTfinalTime, half = 0.5 * s->ckt->CKTstep;
    const double sliver = 1e-3; /* of a half: what rounding leaves is no step */
    const double t = start + half * (floor((s->ckt->CKTtime - start) / half + sliver) + 1.0);
    const int any = !s->next.interpolated && s->next.shown >= NS_SHOWN_ENOUGH;
    const double tmax = ns_bridge_shown_tmax(s->ckt);
    const double closest = ns_bridge_timepoints_closest(stop);
    const int is_fine = (tmax > 0.0 && tmax <= half) || half < 4.0 * closest;
    if (start - s->ckt->CKTtime > closest)
        return start; /* it writes none before (beside digital parts it is shown points there, too) */
    return any || is_fine || t > stop - sliver * half ? stop : t;
}

/* Points beside times that from= and to= of .meas are likely to name, as well: .meas leaves out the line to a
 * point that is later than to= by its last digit. */
static double find_latest(const ns_session *s) {
    const double t = latest_read(s), now = s->ckt->CKTtime;
    return fmin(t, ns_bridge_timepoints_beside_mark(s->analysis.system, now, s->ckt->CKTfinalTime,
                                                    s->analysis.edges_are_shown));
}

/* A point was accepted; ngspice writes it next.  Those near the start do not count: 0+ may stand for 0 there.
 */
static void count_shown(ns_session *s, int first) {
    if (first)
        s->next.shown = s->next.interpolated = 0;
    else if (s->next.shown < NS_SHOWN_ENOUGH &&
             s->loop.points.t > s->loop.points.start + 0.25 * s->ckt->CKTstep) {
        s->next.shown++;
        if (s->next.shown == NS_SHOWN_ENOUGH)
            s->next.interpolated = ns_bridge_shown_interpolated(s->ckt, NS_SHOWN_ENOUGH);
    }
}

/* 1 where ngspice writes nothing yet, and no digital part but a bridge reads what moves in the circuit. */
static int is_unseen(const ns_session *s) {
    return s->loop.points.t < s->loop.points.start && ns_bridge_digital_is_at_rest(&s->analysis.ex.digital);
}

/* The next point, where an event of ngspice's queue is one. */
static int next_of_digital(ns_session *s, ns_waveform_point *p) {
    enum { MOST = 64 }; /* thresholds crossed right after one another */
    const double closest = ns_bridge_timepoints_closest(s->ckt->CKTfinalTime);
    int status = NS_E_LIMIT;
    for (int k = 0; k < MOST; k++) {
        const double until = ns_bridge_digital_until(s, find_latest(s), closest);
        status = is_unseen(s) ? ns_waveform_skip(s->analysis.waveform, until, p)
                              : ns_waveform_next(s->analysis.waveform, until, p);
        if (status == NS_OK || !ns_bridge_digital_goes_on(s, status))
            return status;
    }
    return status;
}

/* A point that ngspice cannot tell from the end is the end: from there it would make steps of length 0. */
static void end_at_stop(const ns_session *s, ns_waveform_point *p) {
    const double stop = s->ckt->CKTfinalTime;
    if (stop - p->t < 0.5 * ns_bridge_timepoints_closeness(&s->loop.points))
        p->t = stop;
}

/* The point after the accepted one. */
static int choose_next(ns_session *s) {
    ns_waveform_point *p = &s->next.point;
    ns_waveform *w = s->analysis.waveform;
    const double t = ns_bridge_loop_unchosen(s->ckt, &s->loop);
    int status = NS_OK;
    if (s->next.held)
        return OK;
    const int digital = ns_bridge_digital_is(&s->analysis.ex.digital);
    if (s->loop.points.t < s->loop.points.start && !digital)
        status = ns_waveform_skip(w, t, p);
    else if (t > 0.0 && !(s->loop.points.t < s->loop.points.start))
        p->t = t; /* the start, which ngspice has not shown */
    else if (digital)
        status = next_of_digital(s, p);
    else
        status = ns_waveform_next(w, find_latest(s), p);
    s->next.held = !status;
    if (s->next.held) {
        end_at_stop(s, p);
        ns_bridge_many_points_count(&s->analysis, p, s->ckt->CKTfinalTime);
        ns_bridge_chattering_count(&s->analysis, p, s->ckt->CKTfinalTime);
    }
    return fail(s, status);
}

int ns_bridge_waveform_look_ahead(ns_session *s, int first) {
    CKTcircuit *ckt = s->ckt;
    ns_bridge_loop_read(ckt, &s->loop, first);
    count_shown(s, first);
    const clock_t since = s->analysis.ex.options.verbose ? clock() : 0;
    const int error = choose_next(s);
    s->trial.cpu += s->analysis.ex.options.verbose ? clock() - since : 0;
    if (!error) { /* an event at the present time, or right after it: ngspice would step beyond the point */
        s->next.point.t = ns_bridge_loop_after(ckt, s->next.point.t);
        const double t = ns_bridge_display_until(&s->analysis, ckt, s->trial.t, &s->next.point);
        ns_bridge_loop_step_to(ckt, &s->loop, ns_bridge_loop_after(ckt, t));
    }
    ckt->CKTorder = 1; /* so that ngspice's own currents of capacitors do not ring after a jump */
    s->trial.made = !error;
    return error;
}

/* The next point is at or after ngspice's time: it is before that only where ngspice has chosen its step
 * itself, after `resume`. */
static int come_to(ns_session *s, double t) {
    int error = choose_next(s);
    while (!error && s->next.point.t < t && !ns_bridge_timepoints_same(t, s->next.point.t)) {
        error = fail(s, ns_bridge_analysis_take(&s->analysis, &s->next.point, 1.0));
        s->trial.t = s->next.point.t;
        s->next.held = 0;
        error = error ? error : choose_next(s);
    }
    return error;
}

int ns_bridge_waveform_load(ns_session *s) {
    const ns_waveform_point *p = &s->next.point;
    const double t = s->ckt->CKTtime;
    if (t <= s->trial.t || (s->trial.loaded && s->trial.t_end == t))
        return OK; /* ngspice solves twice at each point */
    const int error = come_to(s, t);
    if (error)
        return error;
    const int there = ns_bridge_timepoints_same(t, p->t);
    if (there) /* ngspice adds a step, and .meas compares times with from= and to= to the last digit */
        s->ckt->CKTtime = p->t;
    const double part = there ? 1.0 : (t - s->trial.t) / (p->t - s->trial.t);
    const int status = ns_bridge_analysis_take(&s->analysis, p, part);
    if (status)
        return fail(s, status);
    ns_bridge_show_values(&s->analysis, s->force.value);
    ns_bridge_trial_show(s, s->ckt->CKTtime);
    s->next.held = !there;
    return OK;
}
