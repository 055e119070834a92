/* bridge/analysis_start.c - the start of an analysis, its resumption, its end. */
#include "session.h"

#include <math.h>
#include <string.h>

#include "abi.h"
#include "announce.h"
#include "digital_run.h"
#include "interrupt.h"
#include "loaded.h"
#include "many_points.h"
#include "ngspice/enh.h"
#include "own_current.h"
#include "own_rest.h"
#include "own_show.h"
#include "own_supply.h"
#include "refused.h"
#include "report.h"
#include "show.h"
#include "taken.h"

/* --- checks --- */

static int refuse_version(const char *wrong) {
    if (!wrong)
        return OK;
    ns_bridge_report_error("nonsmooth.cm was loaded by another ngspice than it was made for: %s is not as "
                           "expected; see codemodels/README.md",
                           wrong);
    return E_UNSUPP;
}

int ns_bridge_analysis_check_setup(const CKTcircuit *ckt) {
    return ns_bridge_loaded_is_other() ? E_UNSUPP : refuse_version(ns_bridge_abi_check_setup(ckt));
}

static int check_version(ns_session *s) {
    const int error = s->once.version_checked ? OK : refuse_version(ns_bridge_abi_check(s->ckt));
    s->once.version_checked = !error;
    return error;
}

/* ngspice would add this conductance to the matrix that we fill. */
static int check_options(const ns_session *s) {
    if (s->ckt->CKTgshunt != 0.0) {
        ns_bridge_report_error("option gshunt = %g is not supported: write rshunt = %g", s->ckt->CKTgshunt,
                               1.0 / s->ckt->CKTgshunt);
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
    error = ns_bridge_extract_read(s->ckt, SOURCES_TRAN, NULL, &ex);
    if (error)
        ns_bridge_report_error("%s", ex.line);
    ns_bridge_extract_clear(&ex);
    return error;
}

/* --- starts --- */

static int prepare_force(ns_session *s) {
    char name[160];
    int unserved = 0;
    const int error = s->force.entry ? OK
                                     : ns_bridge_force_prepare(&s->force, s->ckt->CKTmatrix,
                                                               s->ckt->CKTmaxEqNum, &unserved);
    if (error == E_NOMEM)
        ns_bridge_report_error("out of memory");
    if (error != E_SINGULAR)
        return error;
    ns_circuit_name_unknown(s->analysis.ex.circuit, s->analysis.unknown[unserved], name, sizeof name);
    ns_bridge_report_error(
        "ngspice's matrix is structurally singular: look at the %s: it needs a path to ground, "
        "1e12 ohm will do",
        name);
    return ns_bridge_report_code(NS_E_SINGULAR);
}

/* What the held voltages add to the control of a command; *any: there are some. */
static double held_control(const ns_analysis *a, int c, int *any) {
    const ns_system *s = a->system;
    double g = 0.0;
    for (int k = 0; k < a->held.n; k++) {
        double weight = s->command[c].gx ? s->command[c].gx[a->held.unknown[k]] : 0.0;
        for (int p = s->large ? s->large->gx.start[c] : 0; s->large && p < s->large->gx.start[c + 1]; p++)
            weight += s->large->gx.row[p] == a->held.unknown[k] ? s->large->gx.value[p] : 0.0;
        g += weight * a->held.value[k];
        *any |= weight != 0.0;
    }
    return g;
}

/* Under uic the .ic of nodes decide which of several states a circuit is in that keeps them without charge,
 * as a latch of sources does: a comparator of such nodes begins as it is at these voltages, where other nodes
 * have none, as ngspice's do.  NULL: there is no such comparator. */
static const ns_mode *find_first_mode(const ns_analysis *a) {
    int any = 0;
    memset(a->mode, 0, (size_t)a->system->m * sizeof *a->mode);
    for (int c = 0; c < a->system->nc; c++) {
        const ns_command *command = &a->system->command[c];
        int is_held = 0;
        const double g = held_control(a, c, &is_held) + command->g0;
        const int closed = is_held && command->off >= command->on ? g > command->on : command->closed;
        a->mode[command->pair] = closed ? NS_INSIDE : NS_LOWER;
        any |= is_held;
    }
    return any ? a->mode : NULL;
}

/* Charges and fluxes of SPICE's uic. */
static int start_from_rest(const ns_analysis *a, ns_march *march) {
    double *w0 = calloc((size_t)a->system->n + 1, sizeof *w0);
    int status = w0 ? ns_circuit_rest(a->ex.circuit, w0) : NS_E_MEMORY;
    status = status ? status : ns_march_start_as(march, 0.0, w0, find_first_mode(a));
    free(w0);
    return status;
}

/* Charges and fluxes of uic, or the operating point (in .tran: under the .ic of nodes), which is left in
 * a->x. */
static int start_march(ns_analysis *a, ns_march *march, int tran, int uic) {
    return uic ? start_from_rest(a, march)
               : ns_march_start_dc(march, 0.0, tran ? a->held.n : 0, a->held.unknown, a->held.value, a->x);
}

/* a->march, and the one that charges and energies of devices are integrated along. */
static int start_marches(ns_session *s, int tran, int uic) {
    ns_analysis *a = &s->analysis;
    ns_march *taken = s->ckt->CKTinitTime > 0.0 ? NULL : ns_bridge_taken_march(a);
    int status = start_march(a, a->march, tran, uic);
    if (!status && taken)
        status = start_march(a, taken, tran, uic);
    return status || !taken ? status : ns_bridge_taken_begin(a);
}

static int find_currents(ns_session *s, int uic, double stop) {
    ns_analysis *a = &s->analysis;
    ns_march *march = NULL;
    int status = ns_bridge_own_pass_march(a, s->ckt->CKTfinalTime, &march);
    status = status ? status : start_march(a, march, 1, uic);
    status = status ? status
                    : ns_bridge_own_find_currents(a, march, s->ckt->CKTinitTime, stop,
                                                  stop < s->ckt->CKTfinalTime, &s->found);
    ns_march_free(march);
    return status;
}

/* After one line: ngspice would run .meas if it were only told to pause, and some crash where there is no
 * point. */
static int report_interrupt(const ns_session *s) {
    ns_bridge_report_error(
        "interrupted at t = %.4g s of the first pass, which finds the current of each D (the "
        "option id spares it): no point was computed",
        s->found.seconds);
    return E_NOTFOUND;
}

static int run_pass(ns_session *s, int uic, double stop) {
    ns_bridge_interrupt_watch();
    const int status = find_currents(s, uic, stop), came = ns_bridge_interrupt_came();
    ns_bridge_interrupt_leave();
    if (status == NS_E_MEMORY)
        ns_bridge_report_error("out of memory");
    return status == NS_E_MEMORY ? E_NOMEM : came ? report_interrupt(s) : OK;
}

/* What a D carries depends on the line it is taken for: a brief pass finds that of the long one. */
static int run_passes(ns_session *s, int uic) {
    ns_analysis *a = &s->analysis;
    const double stop = s->ckt->CKTfinalTime, brief = ns_bridge_own_brief_stop(a, stop);
    int error = brief < stop ? run_pass(s, uic, brief) : OK;
    if (!error && brief < stop) {
        ns_bridge_analysis_clear(a);
        error = ns_bridge_analysis_make(s->ckt, SOURCES_TRAN, &s->found, a);
    }
    return error ? error : run_pass(s, uic, stop);
}

/* Makes the analysis; first passes find at which current the curve of each D is to be read. */
static int make_analysis(ns_session *s, int tran, int uic) {
    static const double first_id = 1e-3; /* A: so that D of small currents conduct too */
    ns_analysis *a = &s->analysis;
    ns_bridge_own_forget_currents(&s->found);
    s->found.otherwise = tran ? first_id : NS_OWN_CURRENT;
    s->found.is_first = tran;
    int error = ns_bridge_analysis_make(s->ckt, tran ? SOURCES_TRAN : SOURCES_DC, &s->found, a);
    const int known = !tran || !isnan(a->ex.options.id) || a->ex.nowns == 0;
    if (!error && !known && ns_bridge_own_wants_currents(a))
        error = run_passes(s, uic);
    s->found.otherwise = NS_OWN_CURRENT;
    s->found.is_first = 0;
    if (error || known)
        return error;
    ns_bridge_analysis_clear(a);
    return ns_bridge_analysis_make(s->ckt, SOURCES_TRAN, &s->found, a);
}

/* Where S or W are held at the start: the analysis is made anew, with them. */
static int hold_resting(ns_session *s, int uic) {
    ns_analysis *a = &s->analysis;
    ns_march *march = NULL;
    const double stop = s->ckt->CKTfinalTime;
    ns_bridge_analysis_clear(a);
    int error = ns_bridge_analysis_make(s->ckt, SOURCES_TRAN, &s->found, a);
    if (error)
        return error;
    int status = ns_bridge_own_pass_march(a, stop, &march);
    status = status ? status : start_march(a, march, 1, uic);
    status = status ? status : ns_bridge_own_find_leaving(a, march, stop, &s->found);
    ns_march_free(march);
    if (status)
        return ns_bridge_trial_fail(s, status);
    ns_bridge_analysis_clear(a);
    error = ns_bridge_analysis_make(s->ckt, SOURCES_TRAN, &s->found, a);
    status = error ? NS_OK : start_marches(s, 1, uic);
    return status ? ns_bridge_trial_fail(s, status) : error;
}

/* Starts it; S and W that rest at their threshold are as ngspice has them there. */
static int start_all(ns_session *s, int tran, int uic) {
    int any = 0, status = start_marches(s, tran, uic);
    if (!status && tran)
        status = ns_bridge_own_find_resting(s->ckt, &s->analysis, &s->found, &any);
    if (status && !uic && ns_bridge_start_check_uic(&s->analysis))
        return ns_bridge_trial_fail_with(s, status, "; .tran with uic starts: it needs no operating point");
    if (status)
        return ns_bridge_trial_fail(s, status);
    return any ? hold_resting(s, uic) : OK;
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
    error = make_analysis(s, tran, uic);
    if (error)
        return error;
    if (tran)
        ns_bridge_own_find_supplies(s->ckt, &s->analysis.ex);
    error = ns_bridge_announce(s);
    error = error ? error : start_all(s, tran, uic);
    error = error ? error : prepare_force(s);
    if (error)
        return error;
    ns_bridge_loop_take(s->ckt, &s->loop, a->ex.options.corners, 0);
    const int may_rest_between = (s->ckt->CKTmode & MODEDCTRANCURVE) || ns_bridge_start_check_latches(s);
    if (!uic) { /* under .ic the march starts from other voltages */
        ns_bridge_show_values(a, s->force.value);
        ns_bridge_start_check(s, may_rest_between);
    }
    error = ns_bridge_trial_begin(s);
    if (!error && a->waveform)
        error = ns_bridge_waveform_begin(s, 0.0, NULL);
    if (error)
        return error;
    if (uic)
        ns_bridge_show_values(a, s->force.value);
    else
        ns_bridge_show_currents(a, s->force.value);
    ns_bridge_show_later(a);
    status = ns_bridge_digital_begin(s);
    if (status)
        return ns_bridge_trial_fail(s, status);
    return tran ? OK : ns_bridge_own_dc_point(s);
}

int ns_bridge_analysis_start(ns_session *s) {
    const clock_t since = clock();
    const int error = start_analysis(s);
    s->start_cpu = clock() - since;
    return error;
}

/* --- resumption --- */

/* Starts a where `from` is, at its charges and fluxes; switches are as they were. */
static int start_from(ns_analysis *a, ns_march *march, double t, const ns_analysis *from) {
    double *w0 = calloc((size_t)a->system->n + 1, sizeof *w0);
    int status = w0 ? NS_OK : NS_E_MEMORY;
    if (!status) {
        ns_system_charges(from->system, from->x, w0);
        status = ns_march_start_as(march, t, w0, a->system->m == from->system->m ? from->mode : NULL);
    }
    free(w0);
    return status;
}

static int restart(ns_session *s, const ns_analysis *from) {
    ns_analysis *a = &s->analysis;
    const double t = s->trial.t;
    ns_bridge_taken_continue(a, from);
    ns_bridge_many_points_continue(a, from);
    ns_march *taken = t < s->ckt->CKTinitTime ? NULL : ns_bridge_taken_march(a);
    int status = start_from(a, a->march, t, from);
    if (!status && taken)
        status = start_from(a, taken, t, from);
    if (!status && taken)
        status = ns_bridge_taken_begin(a);
    int error = status ? ns_bridge_trial_fail(s, status) : ns_bridge_trial_begin(s);
    if (!error && (status = ns_bridge_digital_begin(s)))
        error = ns_bridge_trial_fail(s, status);
    return error || !a->waveform ? error : ns_bridge_waveform_begin(s, t, from->waveform);
}

/* Puts `altered` in the place of the present analysis. */
static int replace_analysis(ns_session *s, const ns_analysis *altered) {
    ns_analysis *a = &s->analysis;
    ns_analysis before = *a;
    *a = *altered;
    const int error = restart(s, &before);
    ns_bridge_analysis_clear(&before);
    if (!error) {
        ns_bridge_show_values(a, s->force.value);
        ns_bridge_show_later(a);
    }
    return error;
}

int ns_bridge_analysis_resume(ns_session *s) {
    ns_analysis *a = &s->analysis;
    ns_analysis now;
    int error = ns_bridge_analysis_make(s->ckt, SOURCES_TRAN, &s->found, &now);
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
    ns_bridge_own_forget_currents(&s->found);
    ns_bridge_analysis_clear(&s->analysis);
    ns_bridge_trial_clear(s);
    ns_bridge_force_clear(&s->force);
}
