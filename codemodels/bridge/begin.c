/* bridge/begin.c - the begin of an analysis, and of one that is resumed. */
#include <string.h>

#include "abi.h"
#include "native.h"
#include "ngspice/enh.h"
#include "ngspice/jobdefs.h"
#include "report.h"
#include "show.h"

static int look_at_ngspice(native *b) {
    const char *wrong = b->checked ? NULL : abi_check(b->ckt);
    b->checked = 1;
    if (!wrong) {
        return OK;
    }
    report_error("this nonsmooth.cm was made for another version of ngspice: %s not as expected", wrong);
    return E_UNSUPP;
}

/* ngspice would add these conductances to the matrix that we fill. */
static int look_at_options(const native *b) {
    if (b->ckt->enh->rshunt_data.enabled || b->ckt->CKTgshunt != 0.0) {
        report_error("options rshunt and gshunt cannot be taken yet");
        return E_UNSUPP;
    }
    return OK;
}

int native_check(native *b) {
    extract ex;
    int error;
    rows_show(b);
    error = look_at_ngspice(b);
    if (error) {
        b->checked = 0;
    }
    error = error ? error : look_at_options(b);
    if (error) {
        return error;
    }
    error = extract_read(b->ckt, SOURCES_TRAN, &ex);
    if (error) {
        report_error("%s", ex.line);
    }
    extract_clear(&ex);
    return error;
}

/* Analyses that solve with the matrix that we fill, and would show nonsense.  Those that load it anew for
 * small signals (.ac, .disto) are refused there. */
static int is_refused(const native *b) {
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

static int make_room(native *b) {
    const size_t neq = (size_t)b->ckt->CKTmaxEqNum;
    if (!b->value) {
        b->value = calloc(neq, sizeof *b->value);
        b->held = calloc(neq, sizeof *b->held);
    }
    if (!b->value || !b->held) {
        report_error("out of memory");
        return E_NOMEM;
    }
    return OK;
}

static int prepare_force(native *b) {
    const int error = b->force.entry ? OK : force_prepare(&b->force, b->ckt->CKTmatrix);
    if (error == E_NOMEM) {
        report_error("out of memory");
    } else if (error) {
        report_error("ngspice's matrix lacks equations: is every node connected?");
    }
    return error;
}

/* .tf goes on, and aborts ngspice, if it finds no operating point: it gets zeros. */
static int refuse(native *b) {
    const int error = make_room(b);
    report_error("%s cannot be done yet; .op, .dc and .tran can", b->ckt->CKTcurJob->JOBname);
    if (error || strcmp(b->ckt->CKTcurJob->JOBname, "Transfer Function") != 0) {
        return E_UNSUPP;
    }
    memset(b->value, 0, (size_t)b->ckt->CKTmaxEqNum * sizeof *b->value);
    return prepare_force(b);
}

static void announce(native *b) {
    const engine *e = &b->engine;
    if (!b->announced) {
        report_note("takes this circuit: %d unknown%s, %d ideal device%s", e->system->n,
                    e->system->n == 1 ? "" : "s", e->ex.ndevices, e->ex.ndevices == 1 ? "" : "s");
    }
    b->announced = 1;
    if (e->ex.options.reltol > 0.0 && e->ex.options.method == NS_THETA && !b->no_reltol) {
        report_note("reltol = %g has no effect: theta has a fixed step, h", e->ex.options.reltol);
        b->no_reltol = 1;
    }
}

/* From charges and fluxes as SPICE's uic gives them. */
static int start_from_rest(engine *e) {
    double *w0 = calloc((size_t)e->system->n + 1, sizeof *w0);
    int status = w0 ? ns_circuit_rest(e->ex.circuit, w0) : NS_E_MEMORY;
    status = status ? status : ns_march_start(e->march, 0.0, w0);
    free(w0);
    return status;
}

/* From the operating point, which is left in e->x; held: the .ic of nodes count. */
static int start_from_dc(engine *e, int held) {
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

void native_take_loop(native *b) {
    CKTcircuit *ckt = b->ckt;
    ckt->CKTtrtol = NATIVE_MARK;
    b->plan = (points_plan){
        .step = ckt->CKTmaxStep, .near = ckt->CKTminBreak, .corners = b->engine.ex.options.corners};
    if (ckt->CKTmaxOrder == 2) { /* else every point is asked twice for its truncation error */
        b->max_order = ckt->CKTmaxOrder;
        ckt->CKTmaxOrder = 1;
    }
}

void native_release_loop(native *b) {
    if (b->max_order) { /* by it ngspice frees what it allocated */
        b->ckt->CKTmaxOrder = b->max_order;
    }
    b->max_order = 0;
}

static int begin(native *b) {
    const long mode = b->ckt->CKTmode;
    const int tran = (mode & MODETRANOP) != 0;
    const int uic = tran && (mode & MODEUIC) != 0;
    int status;
    int error;
    engine_clear(&b->engine);
    b->fresh = b->tried = b->loaded = b->failed = 0;
    b->refused = is_refused(b);
    if (b->refused) {
        return refuse(b);
    }
    error = make_room(b);
    error = error ? error : engine_make(b->ckt, tran ? SOURCES_TRAN : SOURCES_DC, &b->engine);
    if (error) {
        return error;
    }
    announce(b);
    status = uic ? start_from_rest(&b->engine) : start_from_dc(&b->engine, tran);
    error = status ? native_fail(b, status) : prepare_force(b);
    if (error) {
        return error;
    }
    native_take_loop(b);
    b->fresh = 1;
    if (!uic) {
        show_values(&b->engine, b->engine.x, b->value);
    }
    error = native_read(b, &b->t); /* t: the start took a while, with a jump or without */
    if (error) {
        return error;
    }
    if (uic) {
        show_values(&b->engine, b->engine.x, b->value);
    }
    show_later(&b->engine);
    return OK;
}

int native_begin(native *b) {
    const clock_t since = clock();
    const int error = begin(b);
    b->cpu = clock() - since;
    return error;
}

/* M x of the accepted point, for a system that was altered since. */
static int restart(native *b, engine *e) {
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

int native_go_on(native *b) {
    engine altered;
    int status;
    int error = engine_make(b->ckt, SOURCES_TRAN, &altered);
    if (error) {
        return error;
    }
    b->engine.ex.options = altered.ex.options;
    b->ckt->CKTminBreak = b->plan.near;
    native_take_loop(b);
    if (altered.ex.hash == b->engine.ex.hash) {
        engine_clear(&altered);
        return OK;
    }
    if (altered.system->n != b->engine.system->n) {
        engine_clear(&altered);
        report_error("the circuit was altered too much to go on: run it anew");
        return E_UNSUPP;
    }
    status = restart(b, &altered);
    engine_clear(&b->engine);
    b->engine = altered;
    b->tried = 0;
    if (status) {
        return native_fail(b, status);
    }
    error = native_read(b, &b->t); /* t: jumps took a while */
    if (!error) {
        show_values(&b->engine, b->engine.x, b->value);
        show_later(&b->engine);
    }
    return error;
}
