/* bridge/look_ahead.c - the marcher's next trial, and with it ngspice's next timepoint. */
#include "session.h"

#include <math.h>

#include "show.h"

enum { EVENTS_AT_A_POINT = 8 }; /* that are accepted without a timepoint of their own */

/* The next timepoint that is no event. */
static double next_point(ns_session *s) {
    return ns_bridge_loop_next(s->ckt, &s->loop, s->analysis.system, s->trial.t);
}

/* The right side of an event that only bends waveforms needs no timepoint: it is accepted, and the devices
 * are shown as they are there.  *accepted: if so. */
static int accept_bend(ns_session *s, int *accepted) {
    static const double rounding = 1e-9; /* rounding is far below, visible jumps far above */
    *accepted = 0;
    if (!s->trial.at_right_side)
        return OK;
    const int error = ns_bridge_trial_read(s);
    if (error)
        return error;
    if (ns_bridge_analysis_moved(&s->analysis, rounding)) {
        ns_bridge_analysis_unread(&s->analysis);
        return OK;
    }
    ns_bridge_trial_accept(s, s->trial.t);
    ns_bridge_show_later(&s->analysis);
    *accepted = 1;
    return OK;
}

/* Where the slope of an input jumps, a current that is proportional to it jumps (of a capacitor straight
 * across a source).  Only the exact engine has an event there; with others the point right after the corner
 * is tried.  *jumps: something does, and the trial stays. */
static int try_corner(ns_session *s, double t, int *jumps) {
    static const double seen = 1e-4; /* far above the change of a steep waveform in that time */
    ns_analysis *a = &s->analysis;
    int error = ns_bridge_trial_to(s, ns_bridge_trial_right_side(s, t), NS_TO_TIME);
    error = error ? error : ns_bridge_trial_read(s);
    if (error)
        return error;
    *jumps = ns_bridge_analysis_moved(a, seen);
    if (*jumps)
        return OK;
    ns_bridge_analysis_unread(a);
    if (ns_march_engine(a->march) == NS_SPARSE) /* its next step then begins at the corner */
        ns_bridge_trial_accept(s, s->trial.t);
    else
        ns_bridge_trial_drop(s);
    return OK;
}

/* 1 if the accepted point is a corner of an input that was no event. */
static int is_at_mere_corner(const ns_session *s) {
    const ns_march *march = s->analysis.march;
    return ns_bridge_timepoints_at_events(&s->loop.points) &&
           ns_bridge_timepoints_same(s->trial.t, s->loop.points.next_corner) &&
           ns_march_engine(march) != NS_EXACT && !ns_march_at_event(march);
}

/* Tries to integrate to the next event.  Those that are closer than ngspice can step are accepted. */
static int try_events(ns_session *s) {
    const double closeness = ns_bridge_timepoints_closeness(&s->loop.points);
    for (int k = 0; k < EVENTS_AT_A_POINT; k++) {
        int accepted;
        int error = ns_bridge_trial_to(s, next_point(s), NS_TO_EVENT);
        error = error ? error : accept_bend(s, &accepted);
        if (error)
            return error;
        if (!accepted && s->trial.t_end - s->ckt->CKTtime >= closeness)
            return OK;
        if (!accepted)
            ns_bridge_trial_accept(s, s->trial.t_end);
    }
    return OK;
}

static int try_next(ns_session *s, int first) {
    int jumps = 0;
    int error = OK;
    if (!first && is_at_mere_corner(s))
        error = try_corner(s, next_point(s), &jumps);
    if (error || jumps)
        return error;
    if (ns_bridge_timepoints_at_events(&s->loop.points))
        error = try_events(s);
    return error || s->trial.made ? error : ns_bridge_trial_to(s, next_point(s), NS_TO_TIME);
}

int ns_bridge_look_ahead(ns_session *s, int first) {
    CKTcircuit *ckt = s->ckt;
    const double stop = ckt->CKTfinalTime;
    ns_bridge_loop_read(ckt, &s->loop, first);
    int error = try_next(s, first);
    if (!error && s->trial.t_end != stop &&
        stop - s->trial.t_end < ns_bridge_timepoints_closeness(&s->loop.points))
        error = ns_bridge_trial_to(s, stop, NS_TO_TIME);
    if (!error)
        ns_bridge_loop_step_to(ckt, &s->loop, s->trial.t_end);
    ckt->CKTorder = 1; /* so that ngspice's own currents of capacitors do not ring after a jump */
    return error;
}
