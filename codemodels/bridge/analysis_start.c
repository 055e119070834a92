/* bridge/analysis_start.c - the start of an analysis, its resumption, its end. */
#include "session.h"

#include <string.h>

#include "abi.h"
#include "ngspice/enh.h"
#include "refused.h"
#include "report.h"
#include "show.h"

/* --- checks --- */

static int check_version(ns_session *s) {
    const char *wrong = s->once.version_checked ? NULL : ns_bridge_abi_check(s->ckt);
    s->once.version_checked = !wrong;
    if (!wrong)
        return OK;
    ns_bridge_report_error(
        "this nonsmooth.cm was built for another version of ngspice: %s is not as expected", wrong);
    return E_UNSUPP;
}

/* ngspice would add these conductances to the matrix that we fill. */
static int check_options(const ns_session *s) {
    if (s->ckt->enh->rshunt_data.enabled || s->ckt->CKTgshunt != 0.0) {
        ns_bridge_report_error("options rshunt and gshunt are not supported");
        return E_UNSUPP;
    }
    return OK;
}

int ns_bridge_analysis_check(ns_session *s) {
    ns_extract ex;
    int error;
    ns_bridge_dc_rows_show(&s->dc_rows, s->ckt);
    error = check_version(s);
    error = error ? error : check_options(s);
    if (error)
        return error;
    error = ns_bridge_extract_read(s->ckt, SOURCES_TRAN, &ex);
    if (error)
        ns_bridge_report_error("%s", ex.line);
    ns_bridge_extract_clear(&ex);
    return error;
}

/* --- starts --- */

static int prepare_force(ns_session *s) {
    const int error =
        s->force.entry ? OK : ns_bridge_force_prepare(&s->force, s->ckt->CKTmatrix, s->ckt->CKTmaxEqNum);
    if (error == E_NOMEM)
        ns_bridge_report_error("out of memory");
    else if (error)
        ns_bridge_report_error("ngspice's matrix is structurally singular: is every node connected?");
    return error;
}

static void announce_circuit(ns_session *s) {
    const ns_analysis *a = &s->analysis;
    if (!s->once.circuit_announced) {
        ns_bridge_report_note("simulates this circuit: %d unknown%s, %d ideal device%s", a->system->n,
                              a->system->n == 1 ? "" : "s", a->ex.ndevices, a->ex.ndevices == 1 ? "" : "s");
    }
    s->once.circuit_announced = 1;
    if (a->ex.options.reltol > 0.0 && a->ex.options.method == NS_THETA && !s->once.reltol_noted) {
        ns_bridge_report_note("reltol = %g has no effect: method \"theta\" uses steps of the fixed length h",
                              a->ex.options.reltol);
        s->once.reltol_noted = 1;
    }
}

/* Starts a at time t from the charges and fluxes of x of system s, or, without that, as SPICE's uic gives
 * them. */
static int start_from_charges(ns_analysis *a, double t, const ns_system *s, const double *x) {
    double *w0 = calloc((size_t)a->system->n + 1, sizeof *w0);
    int status = w0 ? NS_OK : NS_E_MEMORY;
    if (!status && s)
        ns_system_charges(s, x, w0);
    else if (!status)
        status = ns_circuit_rest(a->ex.circuit, w0);
    status = status ? status : ns_march_start(a->march, t, w0);
    free(w0);
    return status;
}

/* Charges and fluxes of uic, or the operating point (in .tran: under the .ic of nodes), which is left in
 * a->x. */
static int start_march(ns_analysis *a, int tran, int uic) {
    return uic ? start_from_charges(a, 0.0, NULL, NULL)
               : ns_march_start_dc(a->march, 0.0, tran ? a->held.n : 0, a->held.unknown, a->held.value, a->x);
}

static int start_analysis(ns_session *s) {
    const int tran = (s->ckt->CKTmode & MODETRANOP) != 0;
    const int uic = tran && (s->ckt->CKTmode & MODEUIC) != 0;
    ns_analysis *a = &s->analysis;
    int status;
    int error;
    ns_bridge_analysis_clear(a);
    ns_bridge_trial_clear(s);
    if (ns_bridge_refused_is(s->ckt))
        return ns_bridge_refused_end(s->ckt);
    error = ns_bridge_analysis_make(s->ckt, tran ? SOURCES_TRAN : SOURCES_DC, a);
    if (error)
        return error;
    announce_circuit(s);
    status = start_march(a, tran, uic);
    error = status ? ns_bridge_trial_fail(s, status) : prepare_force(s);
    if (error)
        return error;
    ns_bridge_loop_take(s->ckt, &s->loop, a->ex.options.corners, 0);
    if (!uic) /* under .ic the march starts from other voltages */
        ns_bridge_show_values(a, s->force.value);
    error = ns_bridge_trial_begin(s);
    if (!error && a->waveform)
        error = ns_bridge_waveform_begin(s, 0.0);
    if (error)
        return error;
    if (uic)
        ns_bridge_show_values(a, s->force.value);
    else
        ns_bridge_show_currents(a, s->force.value);
    ns_bridge_show_later(a);
    return OK;
}

int ns_bridge_analysis_start(ns_session *s) {
    const clock_t since = clock();
    const int error = start_analysis(s);
    s->start_cpu = clock() - since;
    return error;
}

/* --- resumption --- */

/* Puts `altered` in the place of the present analysis, at its charges and fluxes. */
static int replace_analysis(ns_session *s, ns_analysis *altered) {
    ns_analysis *a = &s->analysis;
    const double t = s->trial.t;
    const int status = start_from_charges(altered, t, a->system, a->x);
    int error;
    ns_bridge_analysis_clear(a);
    *a = *altered;
    error = status ? ns_bridge_trial_fail(s, status) : ns_bridge_trial_begin(s);
    if (!error && a->waveform)
        error = ns_bridge_waveform_begin(s, t);
    if (!error) {
        ns_bridge_show_values(a, s->force.value);
        ns_bridge_show_later(a);
    }
    return error;
}

int ns_bridge_analysis_resume(ns_session *s) {
    ns_analysis *a = &s->analysis;
    ns_analysis now;
    int error = ns_bridge_analysis_make(s->ckt, SOURCES_TRAN, &now);
    if (error)
        return error;
    a->ex.options = now.ex.options;
    ns_bridge_loop_take(s->ckt, &s->loop, now.ex.options.corners, 1);
    if (a->waveform)
        ns_bridge_loop_take_close(s->ckt, &s->loop);
    if (now.ex.hash != a->ex.hash && now.system->n == a->system->n)
        return replace_analysis(s, &now);
    if (now.ex.hash != a->ex.hash) {
        ns_bridge_report_error("the altered circuit has %d unknowns, not %d: use run, it cannot be resumed",
                               now.system->n, a->system->n);
        error = E_UNSUPP;
    }
    ns_bridge_analysis_clear(&now);
    return error;
}

void ns_bridge_analysis_end(ns_session *s) {
    ns_bridge_loop_release(s->ckt, &s->loop);
    ns_bridge_analysis_clear(&s->analysis);
    ns_bridge_trial_clear(s);
    ns_bridge_force_clear(&s->force);
}
