/* bridge/analysis_start.c - the begin of an analysis, and of one that is resumed. */
#include <string.h>

#include "abi.h"
#include "ngspice/enh.h"
#include "ngspice/jobdefs.h"
#include "report.h"
#include "session.h"
#include "show.h"

static int look_at_ngspice(ns_session *b) {
    const char *wrong = b->checked ? NULL : ns_bridge_abi_check(b->ckt);
    b->checked = 1;
    if (!wrong) {
        return OK;
    }
    ns_bridge_report_error("this nonsmooth.cm was made for another version of ngspice: %s not as expected",
                           wrong);
    return E_UNSUPP;
}

/* ngspice would add these conductances to the matrix that we fill. */
static int look_at_options(const ns_session *b) {
    if (b->ckt->enh->rshunt_data.enabled || b->ckt->CKTgshunt != 0.0) {
        ns_bridge_report_error("options rshunt and gshunt cannot be taken yet");
        return E_UNSUPP;
    }
    return OK;
}

int ns_bridge_analysis_check(ns_session *b) {
    ns_extract ex;
    int error;
    ns_bridge_dc_rows_show(b);
    error = look_at_ngspice(b);
    if (error) {
        b->checked = 0;
    }
    error = error ? error : look_at_options(b);
    if (error) {
        return error;
    }
    error = ns_bridge_extract_read(b->ckt, SOURCES_TRAN, &ex);
    if (error) {
        ns_bridge_report_error("%s", ex.line);
    }
    ns_bridge_extract_clear(&ex);
    return error;
}

/* Analyses that solve with the matrix that we fill, and would show nonsense.  Those that load it anew for
 * small signals (.ac, .disto) are refused there. */
static int is_refused(const ns_session *b) {
    static const char *const refused[] = {"Transfer Function", "Sensitivity Analysis", "Pole-Zero Analysis",
                                          "Noise Analysis", "Periodic Steady State Analysis"};
    const JOB *job = b->ckt->CKTcurJob;
    for (size_t i = 0; job && job->JOBname && i < sizeof refused / sizeof refused[0]; i++) {
        if (strcmp(job->JOBname, refused[i]) == 0) {
            return 1;
        }
    }
    return 0;
}

static int make_room(ns_session *b) {
    const size_t neq = (size_t)b->ckt->CKTmaxEqNum;
    if (!b->value) {
        b->value = calloc(neq, sizeof *b->value);
        b->held = calloc(neq, sizeof *b->held);
    }
    if (!b->value || !b->held) {
        ns_bridge_report_error("out of memory");
        return E_NOMEM;
    }
    return OK;
}

static int prepare_force(ns_session *b) {
    const int error = b->force.entry ? OK : ns_bridge_force_prepare(&b->force, b->ckt->CKTmatrix);
    if (error == E_NOMEM) {
        ns_bridge_report_error("out of memory");
    } else if (error) {
        ns_bridge_report_error("ngspice's matrix lacks equations: is every node connected?");
    }
    return error;
}

/* .tf goes on, and aborts ngspice, if it finds no operating point: it gets zeros. */
static int refuse(ns_session *b) {
    const int error = make_room(b);
    ns_bridge_report_error("%s cannot be done yet; .op, .dc and .tran can", b->ckt->CKTcurJob->JOBname);
    if (error || strcmp(b->ckt->CKTcurJob->JOBname, "Transfer Function") != 0) {
        return E_UNSUPP;
    }
    memset(b->value, 0, (size_t)b->ckt->CKTmaxEqNum * sizeof *b->value);
    return prepare_force(b);
}

static void announce(ns_session *b) {
    const ns_analysis *e = &b->engine;
    if (!b->announced) {
        ns_bridge_report_note("takes this circuit: %d unknown%s, %d ideal device%s", e->system->n,
                              e->system->n == 1 ? "" : "s", e->ex.ndevices, e->ex.ndevices == 1 ? "" : "s");
    }
    b->announced = 1;
    if (e->ex.options.reltol > 0.0 && e->ex.options.method == NS_THETA && !b->no_reltol) {
        ns_bridge_report_note("reltol = %g has no effect: theta has a fixed step, h", e->ex.options.reltol);
        b->no_reltol = 1;
    }
}

/* From charges and fluxes as SPICE's uic gives them. */
static int start_from_rest(ns_analysis *e) {
    double *w0 = calloc((size_t)e->system->n + 1, sizeof *w0);
    int status = w0 ? ns_circuit_rest(e->ex.circuit, w0) : NS_E_MEMORY;
    status = status ? status : ns_march_start(e->march, 0.0, w0);
    free(w0);
    return status;
}

/* From the operating point, which is left in e->x; held: the .ic of nodes count. */
static int start_from_dc(ns_analysis *e, int held) {
    const int room = held ? ns_circuit_node_ic_count(e->ex.circuit) : 0;
    int *hold = calloc((size_t)room + 1, sizeof *hold);
    double *hold_x = calloc((size_t)room + 1, sizeof *hold_x);
    int n = 0;
    int status = hold && hold_x ? NS_OK : NS_E_MEMORY;
    if (!status && held) {
        n = ns_circuit_hold(e->ex.circuit, hold, hold_x);
    }
    status = status ? status : ns_march_start_dc(e->march, 0.0, n, hold, hold_x, e->x);
    free(hold);
    free(hold_x);
    return status;
}

void ns_bridge_session_take_loop(ns_session *b) {
    CKTcircuit *ckt = b->ckt;
    ckt->CKTtrtol = NS_BRIDGE_TRTOL;
    b->plan = (ns_timepoints_plan){
        .step = ckt->CKTmaxStep, .near = ckt->CKTminBreak, .corners = b->engine.ex.options.corners};
    if (ckt->CKTmaxOrder == 2) { /* else every point is asked twice for its truncation error */
        b->max_order = ckt->CKTmaxOrder;
        ckt->CKTmaxOrder = 1;
    }
}

void ns_bridge_session_release_loop(ns_session *b) {
    if (b->max_order) { /* by it ngspice frees what it allocated */
        b->ckt->CKTmaxOrder = b->max_order;
    }
    b->max_order = 0;
}

static int begin(ns_session *b) {
    const long mode = b->ckt->CKTmode;
    const int tran = (mode & MODETRANOP) != 0;
    const int uic = tran && (mode & MODEUIC) != 0;
    int status;
    int error;
    ns_bridge_analysis_clear(&b->engine);
    b->fresh = b->tried = b->loaded = b->failed = 0;
    b->refused = is_refused(b);
    if (b->refused) {
        return refuse(b);
    }
    error = make_room(b);
    error = error ? error : ns_bridge_analysis_make(b->ckt, tran ? SOURCES_TRAN : SOURCES_DC, &b->engine);
    if (error) {
        return error;
    }
    announce(b);
    status = uic ? start_from_rest(&b->engine) : start_from_dc(&b->engine, tran);
    error = status ? ns_bridge_session_fail(b, status) : prepare_force(b);
    if (error) {
        return error;
    }
    ns_bridge_session_take_loop(b);
    b->fresh = 1;
    if (!uic) {
        ns_bridge_show_values(&b->engine, b->engine.x, b->value);
    }
    error = ns_bridge_session_read(b, &b->t); /* t: the start took a while, with a jump or without */
    if (error) {
        return error;
    }
    if (uic) {
        ns_bridge_show_values(&b->engine, b->engine.x, b->value);
    }
    ns_bridge_show_later(&b->engine);
    return OK;
}

int ns_bridge_analysis_start(ns_session *b) {
    const clock_t since = clock();
    const int error = begin(b);
    b->cpu = clock() - since;
    return error;
}

/* M x of the accepted point, for a system that was altered since. */
static int restart(ns_session *b, ns_analysis *e) {
    const ns_system *s = b->engine.system;
    double *w0 = calloc((size_t)s->n + 1, sizeof *w0);
    int status = NS_E_MEMORY;
    if (w0) {
        ns_system_charges(s, b->engine.x, w0);
        status = ns_march_start(e->march, b->t, w0);
    }
    free(w0);
    return status;
}

int ns_bridge_analysis_resume(ns_session *b) {
    ns_analysis altered;
    int status;
    int error = ns_bridge_analysis_make(b->ckt, SOURCES_TRAN, &altered);
    if (error) {
        return error;
    }
    b->engine.ex.options = altered.ex.options;
    b->ckt->CKTminBreak = b->plan.near;
    ns_bridge_session_take_loop(b);
    if (altered.ex.hash == b->engine.ex.hash) {
        ns_bridge_analysis_clear(&altered);
        return OK;
    }
    if (altered.system->n != b->engine.system->n) {
        ns_bridge_analysis_clear(&altered);
        ns_bridge_report_error("the circuit was altered too much to go on: run it anew");
        return E_UNSUPP;
    }
    status = restart(b, &altered);
    ns_bridge_analysis_clear(&b->engine);
    b->engine = altered;
    b->tried = 0;
    if (status) {
        return ns_bridge_session_fail(b, status);
    }
    error = ns_bridge_session_read(b, &b->t); /* t: jumps took a while */
    if (!error) {
        ns_bridge_show_values(&b->engine, b->engine.x, b->value);
        ns_bridge_show_later(&b->engine);
    }
    return error;
}
