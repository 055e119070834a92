/* bridge/trial.c - what the marcher is asked to try for ngspice's next timepoint, and accepts with it. */
#include "session.h"

#include <math.h>
#include <string.h>

#include "dump.h"
#include "report.h"
#include "show.h"

int ns_bridge_trial_fail_with(const ns_session *s, int status, const char *hint) {
    char line[320];
    char more[320];
    ns_bridge_analysis_explain(&s->analysis, ns_march_fault(s->analysis.march), status, line, sizeof line);
    ns_bridge_dump_failed_step(&s->analysis, more, sizeof more);
    ns_bridge_report_error("%s%s%s", line, hint, more);
    return ns_bridge_report_code(status);
}

int ns_bridge_trial_fail(const ns_session *s, int status) {
    return ns_bridge_trial_fail_with(s, status, "");
}

void ns_bridge_trial_clear(ns_session *s) {
    memset(&s->trial, 0, sizeof s->trial);
}

int ns_bridge_trial_begin(ns_session *s) {
    const int status = ns_bridge_analysis_read(&s->analysis, &s->trial.t);
    ns_bridge_trial_drop(s);
    return status ? ns_bridge_trial_fail(s, status) : OK;
}

double ns_bridge_trial_right_side(const ns_session *s, double t) {
    const double shortest =
        fmax(ldexp(s->analysis.h, -19), 2.0 * ns_bridge_timepoints_closeness(&s->loop.points));
    return s->trial.t + fmin(shortest, (t - s->trial.t) / 8.0);
}

int ns_bridge_trial_to(ns_session *s, double t, ns_until until) {
    ns_bridge_trial *trial = &s->trial;
    const int timed = s->analysis.ex.options.verbose; /* clock() takes as long as a short step */
    const clock_t since = timed ? clock() : 0;
    const int status = ns_march_try(s->analysis.march, t, until, &trial->t_end);
    trial->cpu += timed ? clock() - since : 0;
    trial->made = !status;
    trial->at_right_side = trial->made && trial->t_end <= trial->t;
    if (trial->at_right_side)
        trial->t_end = ns_bridge_trial_right_side(s, t);
    return status ? ns_bridge_trial_fail(s, status) : OK;
}

int ns_bridge_trial_read(ns_session *s) {
    const int status = ns_bridge_analysis_read(&s->analysis, NULL);
    return status ? ns_bridge_trial_fail(s, status) : OK;
}

int ns_bridge_trial_read_values(ns_session *s) {
    const int error = ns_bridge_trial_read(s);
    if (!error)
        ns_bridge_show_values(&s->analysis, s->force.value);
    return error;
}

int ns_bridge_trial_load(ns_session *s, int anew) {
    ns_bridge_trial *trial = &s->trial;
    const double t = s->ckt->CKTtime;
    int error = OK;
    if (trial->loaded && !anew && ns_bridge_timepoints_same(t, trial->t_end))
        return OK; /* ngspice solves twice at each point */
    trial->loaded = 0;
    /* the accepted time may be slightly later: a jump takes some time, and ngspice's times are rounded */
    if (t <= trial->t || ns_bridge_timepoints_same(t, trial->t))
        return OK;
    if (!trial->made || !ns_bridge_timepoints_same(t, trial->t_end))
        error = ns_bridge_trial_to(s, t, NS_TO_TIME);
    error = error ? error : ns_bridge_trial_read_values(s);
    trial->loaded = !error;
    return error;
}

void ns_bridge_trial_accept(ns_session *s, double t) {
    ns_march_accept(s->analysis.march);
    s->trial.t = t;
    ns_bridge_trial_drop(s);
}

void ns_bridge_trial_drop(ns_session *s) {
    s->trial.made = s->trial.loaded = 0;
}

int ns_bridge_trial_accept_loaded(ns_session *s) {
    const int first = !s->trial.start_accepted;
    s->trial.start_accepted = 1;
    if (s->trial.loaded && s->analysis.waveform)
        s->trial.t = s->trial.t_end;
    else if (s->trial.loaded)
        ns_bridge_trial_accept(s, s->trial.t_end);
    ns_bridge_trial_drop(s);
    return first;
}

void ns_bridge_trial_show(ns_session *s, double t) {
    s->trial.t_end = t;
    s->trial.loaded = 1;
}
