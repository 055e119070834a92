/* bridge/session.c - ngspice's loads and accepts.
 *
 * At every load the solution x(t) is asked of the marcher and forced, so that ngspice's solve returns it.
 * When ngspice accepts a point, the marcher accepts it too and tries to integrate to the next event or output
 * time; that is made ngspice's next timepoint. */
#include "session.h"

#include <string.h>

#include "climits.h"
#include "digital_run.h"
#include "overvoltage.h"
#include "own_rest.h"
#include "own_show.h"
#include "report.h"
#include "show.h"
#include "shown.h"
#include "taken.h"
#include "versions.h"

static int is_dc(const CKTcircuit *ckt) {
    return (ckt->CKTmode & MODEDC) != 0;
}

/* There is no operating point: ngspice must not try gmin or source stepping. */
static int end_dc(CKTcircuit *ckt, int error) {
    ckt->CKTnumGminSteps = 0;
    ckt->CKTnumSrcSteps = 0;
    return error;
}

/* --- loads --- */

/* A failure waits for the accept, which ends the analysis without a false point. */
static void load_tran(ns_session *s) {
    int resumed = 0;
    if (!s->failed && ns_bridge_loop_began_anew(s->ckt)) {
        resumed = 1;
        s->source_check.pending = 1;
        s->failed = ns_bridge_analysis_resume(s);
    }
    ns_bridge_loop_at_no_break(s->ckt);
    if (!s->failed)
        s->failed = s->analysis.waveform ? ns_bridge_waveform_load(s) : ns_bridge_trial_load(s, resumed);
}

static int load_dc(ns_session *s) {
    const int first = (s->ckt->CKTmode & (MODEINITJCT | MODEINITPRED)) != 0;
    int error = OK;
    if (first || !s->analysis.march || ns_bridge_digital_is_stale(s)) {
        error = ns_bridge_analysis_start(s);
        error = error ? error : ns_bridge_source_check_dc(s->ckt);
        error = s->failed = error ? error : ns_bridge_climits_check(&s->analysis.ex, s->force.value);
        s->source_check.pending = 1;
    }
    return s->ckt->CKTmode & MODEUIC ? OK : error; /* with uic there is no solve: the first accept ends it */
}

static int load_values(ns_session *s) {
    int error = OK;
    if (is_dc(s->ckt))
        error = load_dc(s);
    else if (s->analysis.march)
        load_tran(s);
    return !error && !s->force.entry ? E_UNSUPP : error;
}

/* D, S and W, which loaded before, may have found that their states do not fit yet. */
static void take_back_doubts(ns_session *s) {
    if (s->analysis.ex.nowns == 0 || !s->analysis.march)
        return;
    ns_bridge_own_show_states(&s->analysis, s->ckt);
    s->ckt->CKTnoncon = 0;
}

/* The sources of .tran are compared in further loads of its first timepoint, which leave the solution. */
static void check_sources(ns_session *s) {
    ns_source_check *check = &s->source_check;
    if (ns_bridge_source_check_is_on(check)) {
        s->failed = ns_bridge_source_check_load(check, s->ckt);
    } else if (check->pending && !s->failed && s->analysis.march && !is_dc(s->ckt)) {
        s->failed = ns_bridge_source_check_begin(check, s->ckt);
    }
}

int ns_bridge_session_load(ns_session *s) {
    int error;
    if (ns_bridge_single_load_begin(s)) {
        load_tran(s);
        ns_bridge_digital_load(s);
        ns_bridge_single_load_end(s);
        return OK;
    }
    if (ns_bridge_source_check_is_on(&s->source_check)) {
        check_sources(s);
        ns_bridge_force_apply(&s->force, s->ckt->CKTrhs);
        return OK;
    }
    ns_bridge_dc_rows_show(&s->dc_rows, s->ckt);
    error = load_values(s);
    if (!error && is_dc(s->ckt))
        error = ns_bridge_dc_rows_hide(&s->dc_rows, s->ckt);
    if (error)
        return end_dc(s->ckt, error);
    take_back_doubts(s);
    check_sources(s);
    if (s->analysis.march)
        ns_bridge_digital_load(s);
    ns_bridge_force_apply(&s->force, s->ckt->CKTrhs);
    return OK;
}

/* --- accepts --- */

/* The consistent start, in place of the operating point under .ic. */
static int show_start(ns_session *s) {
    const int error = ns_bridge_trial_read_values(s);
    if (!error)
        memcpy(s->ckt->CKTrhsOld, s->force.value, (size_t)s->analysis.ex.neq * sizeof *s->force.value);
    return error;
}

static void end_analysis(ns_session *s) {
    s->once.curve_noted = s->once.curve_noted || ns_bridge_own_note_curve(s->ckt, &s->analysis);
    s->once.overvoltage_noted = s->once.overvoltage_noted || ns_bridge_overvoltage_note(s->ckt, &s->analysis);
    if (s->analysis.ex.options.verbose)
        ns_bridge_show_summary(&s->analysis, (double)(s->start_cpu + s->trial.cpu) / CLOCKS_PER_SEC);
    ns_bridge_loop_release(s->ckt, &s->loop);
}

/* ngspice writes the present point next; with uic it wrote the first one before it was accepted. */
static int is_shown(const CKTcircuit *ckt) {
    return ckt->CKTtime >= ckt->CKTinitTime && (ckt->CKTtime > 0.0 || !(ckt->CKTmode & MODEUIC));
}

int ns_bridge_session_accept(ns_session *s) {
    CKTcircuit *ckt = s->ckt;
    /* without breakpoints: a search for an operating point */
    if (s->failed || !s->analysis.march || is_dc(ckt) || !ckt->CKTbreaks)
        return s->failed;
    const int first = ns_bridge_trial_accept_loaded(s);
    s->failed = first ? show_start(s) : OK;
    s->failed = s->failed ? s->failed : ns_bridge_climits_check(&s->analysis.ex, s->force.value);
    if (s->failed)
        return s->failed;
    ns_bridge_show_later(&s->analysis);
    ns_bridge_own_show_states(&s->analysis, ckt);
    s->failed = ns_bridge_own_check_resting(&s->analysis, s->force.value, ckt->CKTtime, 0.01 * ckt->CKTstep);
    if (s->failed)
        return s->failed;
    ns_bridge_own_count_point(ckt, &s->analysis, ckt->CKTinitTime, ckt->CKTtime);
    ns_bridge_taken_accept(&s->analysis, s->trial.t, is_shown(ckt));
    if (ckt->CKTfinalTime - ckt->CKTtime < ckt->CKTminBreak) {
        end_analysis(s);
    } else {
        /* an error waits for the next accept: the present point is good */
        const int status = ns_bridge_digital_accept(s);
        if (status == NS_E_STATE)
            s->failed = ns_bridge_digital_fail_late(s);
        else if (status)
            s->failed = ns_bridge_trial_fail(s, status);
        else
            s->failed = s->analysis.waveform ? ns_bridge_waveform_look_ahead(s, first)
                                             : ns_bridge_look_ahead(s, first);
        if (!ns_bridge_versions_hooks_shown() &&
            ((!ckt->CKThead[TYPE_MOS1] && !ckt->CKThead[TYPE_MOS3]) || ns_bridge_shown_no_parameters(ckt)))
            ns_bridge_single_load_arm(s);
    }
    return OK;
}

void ns_bridge_session_reset(ns_session *s) {
    ns_bridge_dc_rows_show(&s->dc_rows, s->ckt);
    ns_bridge_dc_rows_clear(&s->dc_rows);
    ns_bridge_single_load_forget(s);
    ns_bridge_source_check_clear(&s->source_check);
    ns_bridge_analysis_end(s);
    s->failed = OK;
}

void ns_bridge_session_clear(ns_session *s) {
    ns_bridge_dc_rows_clear(&s->dc_rows);
    ns_bridge_own_again_clear(s);
    ns_bridge_own_dc_clear(s);
    ns_bridge_session_reset(s);
    memset(s, 0, sizeof *s);
}
