/* bridge/native.c - the native way: the library integrates, ngspice shows.
 *
 * At every load the solution x(t) is asked of the marcher and forced, so that ngspice's solve returns it.
 * When ngspice accepts a point, the marcher accepts it too and tries the way to the next event or output
 * time; that is made ngspice's next timepoint. */
#include "native.h"

#include <math.h>
#include <string.h>

#include "abi.h"
#include "ngspice/enh.h"
#include "report.h"
#include "show.h"

/* Every analysis and every `resume` sets ckt->CKTtrtol anew: this value tells that neither happened since. */
static const double MARK = 1e30;

static int is_dc(const CKTcircuit *ckt) {
    return (ckt->CKTmode & MODEDC) != 0;
}

/* Does t1 differ from t2 only by the rounding of a sum? */
static int same_time(double t1, double t2) {
    return fabs(t1 - t2) <= 4.0 * 2.3e-16 * fmax(fabs(t1), fabs(t2));
}

/* --- failures --- */

static int fail(native *b, int status) {
    const ns_fault *fault = ns_march_fault(b->engine.march);
    char line[320];
    if (fault && fault->status) {
        ns_circuit_explain(b->engine.ex.circuit, fault, line, sizeof line);
    } else {
        snprintf(line, sizeof line, "%s", ns_status_text(status));
    }
    report_error("%s", line);
    b->failed = report_code(status);
    return b->failed;
}

/* An operating point that does not exist: no gmin, no source stepping would help. */
static int end_dc(CKTcircuit *ckt, int error) {
    ckt->CKTnumGminSteps = 0;
    ckt->CKTnumSrcSteps = 0;
    return error;
}

/* --- the .ic and .nodeset rows that ngspice would write over ours in DC loads --- */

static void hide_rows(native *b) {
    int k = 0;
    for (CKTnode *node = b->ckt->CKTnodes; node; node = node->next, k++) {
        b->held[k] = (int)(node->icGiven | (node->nsGiven << 1));
        node->icGiven = node->nsGiven = 0;
    }
    b->hidden = 1;
}

static void unhide_rows(native *b) {
    int k = 0;
    for (CKTnode *node = b->ckt->CKTnodes; b->hidden && node; node = node->next, k++) {
        node->icGiven = (unsigned)b->held[k] & 1U;
        node->nsGiven = (unsigned)b->held[k] >> 1 & 1U;
    }
    b->hidden = 0;
}

/* --- one analysis --- */

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
    unhide_rows(b);
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

static int make_room(native *b) {
    const size_t neq = (size_t)b->ckt->CKTmaxEqNum;
    if (!b->value) {
        b->value = calloc(neq, sizeof *b->value);
        b->held = calloc(neq, sizeof *b->held);
    }
    return b->value && b->held ? OK : E_NOMEM;
}

static int prepare_force(native *b) {
    const int error = b->force.entry ? OK : force_prepare(&b->force, b->ckt->CKTmatrix);
    if (error) {
        report_error("ngspice's matrix lacks equations: is every node connected?");
    }
    return error;
}

static void announce(native *b) {
    const engine *e = &b->engine;
    if (!b->announced) {
        report_note("native way: %d unknowns, %d ideal devices", e->system->n, e->ex.ndevices);
    }
    b->announced = 1;
}

static void read_point(native *b) {
    ns_march_read(b->engine.march, NULL, b->engine.x, b->engine.lambda, NULL);
    show_values(&b->engine, b->engine.x, b->value);
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

/* Builds and starts; leaves the operating point, or the start from rest, in b->value. */
static int begin(native *b) {
    const long mode = b->ckt->CKTmode;
    const int tran = (mode & MODETRANOP) != 0;
    const int uic = tran && (mode & MODEUIC) != 0;
    int status;
    int error;
    engine_clear(&b->engine);
    b->fresh = b->tried = b->failed = 0;
    error = make_room(b);
    error = error ? error : engine_make(b->ckt, tran ? SOURCES_TRAN : SOURCES_DC, &b->engine);
    if (error) {
        return error;
    }
    announce(b);
    b->cpu = clock();
    status = uic ? start_from_rest(&b->engine) : start_from_dc(&b->engine, tran);
    error = status ? fail(b, status) : prepare_force(b);
    if (error) {
        return error;
    }
    b->t = 0.0;
    b->fresh = 1;
    if (uic) {
        read_point(b);
    } else {
        double *dc = b->engine.x;
        show_values(&b->engine, dc, b->value);
        ns_march_read(b->engine.march, NULL, dc, b->engine.lambda, NULL);
        show_devices(&b->engine);
    }
    return OK;
}

/* --- loads --- */

/* M x of the accepted point, for a system that was altered since. */
static int restart(native *b, engine *e) {
    const ns_system *s = b->engine.system;
    const size_t n = (size_t)s->n;
    double *w0 = calloc(n + 1, sizeof *w0);
    int status = w0 ? NS_OK : NS_E_MEMORY;
    for (size_t j = 0; j < n && !status; j++) {
        for (size_t i = 0; i < n; i++) {
            w0[i] += s->M[i + j * n] * b->engine.x[j];
        }
    }
    status = status ? status : ns_march_start(e->march, b->t, w0);
    free(w0);
    return status;
}

/* After `resume`: was something altered?  Then goes on from the present charges and fluxes. */
static int look_for_alterations(native *b) {
    engine altered;
    int status;
    int error = engine_make(b->ckt, SOURCES_TRAN, &altered);
    if (error) {
        return error;
    }
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
    return status ? fail(b, status) : OK;
}

static int try_to(native *b, double t, ns_until until) {
    const int status = ns_march_try(b->engine.march, t, until, &b->t_trial);
    b->tried = !status;
    return status ? fail(b, status) : OK;
}

/* Leaves x(t) in b->value; a failure waits for the accept, which ends the analysis without a false point. */
static void load_tran(native *b) {
    CKTcircuit *ckt = b->ckt;
    if (ckt->CKTtrtol != MARK) {
        ckt->CKTtrtol = MARK;
        if (!b->failed && b->t > 0.0) {
            b->failed = look_for_alterations(b);
        }
    }
    if (b->failed || same_time(ckt->CKTtime, b->t)) {
        return;
    }
    if ((!b->tried || !same_time(ckt->CKTtime, b->t_trial)) && try_to(b, ckt->CKTtime, NS_TO_TIME)) {
        return;
    }
    read_point(b);
}

/* Leaves the operating point in b->value. */
static int load_dc(native *b) {
    const int first = (b->ckt->CKTmode & (MODEINITJCT | MODEINITPRED)) != 0;
    int error = OK;
    if (first || !b->engine.march) {
        error = b->failed = begin(b);
    }
    return b->ckt->CKTmode & MODEUIC ? OK : error; /* with uic there is no solve: the first accept ends it */
}

int native_load(native *b) {
    int error = OK;
    unhide_rows(b);
    if (is_dc(b->ckt)) {
        error = load_dc(b);
    } else if (b->engine.march) {
        load_tran(b);
    }
    if (error || !b->force.entry) {
        return end_dc(b->ckt, error ? error : E_UNSUPP);
    }
    if (is_dc(b->ckt)) {
        hide_rows(b);
    }
    force_apply(&b->force, b->ckt->CKTrhs, b->value);
    return OK;
}

/* --- accepts --- */

/* Times closer than this are one to ngspice: it compares breakpoints to 100 ulps. */
static double closeness(const CKTcircuit *ckt) {
    return fmax(ckt->CKTminBreak, 200.0 * 2.3e-16 * ckt->CKTfinalTime);
}

/* Forgets breakpoints that are reached: ngspice would cut its step after each to a tenth. */
static void drop_breaks(CKTcircuit *ckt) {
    int passed = 0;
    while (passed < ckt->CKTbreakSize - 1 && ckt->CKTbreaks[passed] <= ckt->CKTtime + closeness(ckt)) {
        passed++;
    }
    if (ckt->CKTbreakSize - passed < 2) { /* ngspice looks at two */
        ckt->CKTbreaks[0] = ckt->CKTbreaks[1] = ckt->CKTfinalTime;
        ckt->CKTbreakSize = 2;
        return;
    }
    memmove(ckt->CKTbreaks, ckt->CKTbreaks + passed,
            (size_t)(ckt->CKTbreakSize - passed) * sizeof *ckt->CKTbreaks);
    ckt->CKTbreakSize -= passed;
}

/* Where the next point should be if no event comes before: on the grid of ngspice's longest step, beyond
 * which ngspice does not go, or on a breakpoint. */
static double next_time(const native *b, int first) {
    const CKTcircuit *ckt = b->ckt;
    const double now = ckt->CKTtime;
    const double step = ckt->CKTmaxStep;
    const double stop = ckt->CKTbreaks[0];
    double t = fmin(now + step, (floor(now / step + 1e-3) + 1.0) * step);
    if (first && (ckt->CKTmode & MODEUIC)) {
        t = now + step / 1048576.0; /* ngspice does not show t = 0 then: shows 0+ */
    } else if (stop < t + 1e-3 * step) {
        t = stop <= now + step ? stop : now + 0.5 * step; /* in two, rather than leave a sliver */
    }
    return fmax(t, b->t + 2.0 * ckt->CKTdelmin); /* whatever rounding did, ahead */
}

static void look_ahead(native *b, int first) {
    CKTcircuit *ckt = b->ckt;
    int error;
    drop_breaks(ckt);
    error = try_to(b, next_time(b, first), NS_TO_EVENT);
    if (!error && b->t_trial != ckt->CKTfinalTime && ckt->CKTfinalTime - b->t_trial < closeness(ckt)) {
        error = try_to(b, ckt->CKTfinalTime, NS_TO_TIME);
    }
    if (!error) { /* otherwise the next accept ends the analysis: the present point is good */
        ckt->CKTdelta = fmax(b->t_trial - ckt->CKTtime, 2.0 * ckt->CKTdelmin);
    }
    ckt->CKTorder = 1; /* so that ngspice's own currents of capacitors do not ring after a jump */
}

int native_accept(native *b) {
    CKTcircuit *ckt = b->ckt;
    const int first = b->fresh;
    if (b->failed) {
        return b->failed;
    }
    if (!b->engine.march || is_dc(ckt)) {
        return OK;
    }
    if (b->tried && same_time(ckt->CKTtime, b->t_trial)) {
        ns_march_accept(b->engine.march);
        b->t = b->t_trial;
    }
    b->tried = b->fresh = 0;
    if (first) { /* the consistent start, not the operating point under .ic */
        read_point(b);
        memcpy(ckt->CKTrhsOld, b->value, (size_t)b->engine.ex.neq * sizeof *b->value);
    }
    show_devices(&b->engine);
    if (ckt->CKTfinalTime - ckt->CKTtime < ckt->CKTminBreak) {
        if (b->engine.ex.options.verbose) {
            show_summary(&b->engine, (double)(clock() - b->cpu) / CLOCKS_PER_SEC);
        }
        return OK;
    }
    look_ahead(b, first);
    return OK;
}

void native_reset(native *b) {
    unhide_rows(b);
    engine_clear(&b->engine);
    force_clear(&b->force);
    free(b->value);
    free(b->held);
    b->value = NULL;
    b->held = NULL;
    b->fresh = b->tried = b->failed = 0;
}

void native_clear(native *b) {
    b->hidden = 0; /* the nodes may be gone */
    native_reset(b);
    memset(b, 0, sizeof *b);
}
