/* bridge/session.c - the native way: the library integrates, ngspice shows.
 *
 * At every load the solution x(t) is asked of the marcher and forced, so that ngspice's solve returns it.
 * When ngspice accepts a point, the marcher accepts it too and tries the way to the next event or output
 * time; that is made ngspice's next timepoint. */
#include "session.h"

#include <math.h>
#include <string.h>

#include "dump.h"
#include "report.h"
#include "show.h"
#include "single_load.h"
#include "timepoints.h"

enum { EVENTS_NEAR = 8 }; /* before ngspice can step */

static int is_dc(const CKTcircuit *ckt) {
    return (ckt->CKTmode & MODEDC) != 0;
}

/* Does t1 differ from t2 only by the rounding of a sum? */
static int same_time(double t1, double t2) {
    return fabs(t1 - t2) <= 4.0 * 2.3e-16 * fmax(fabs(t1), fabs(t2));
}

int ns_bridge_session_fail(ns_session *b, int status) {
    const ns_fault *fault = ns_march_fault(b->engine.march);
    char line[320];
    char more[320];
    if (fault && fault->status) {
        ns_circuit_explain(b->engine.ex.circuit, fault, line, sizeof line);
    } else {
        snprintf(line, sizeof line, "%s", ns_status_text(status));
    }
    ns_bridge_dump_failed_step(&b->engine, more, sizeof more);
    ns_bridge_report_error("%s%s", line, more);
    b->failed = ns_bridge_report_code(status);
    return b->failed;
}

/* An operating point that does not exist: no gmin, no source stepping would help. */
static int end_dc(CKTcircuit *ckt, int error) {
    ckt->CKTnumGminSteps = 0;
    ckt->CKTnumSrcSteps = 0;
    return error;
}

/* --- loads --- */

static void exchange(ns_analysis *e) {
    double *x = e->before;
    e->before = e->x;
    e->x = x;
    e->lambda = x + e->system->n;
}

int ns_bridge_session_read(ns_session *b, double *t) {
    ns_analysis *e = &b->engine;
    double *x = e->before;
    int status = ns_march_read(e->march, t, x, x + e->system->n, NULL);
    for (size_t k = 0; k < e->count && !status; k++) {
        e->most[k] = fabs(x[k]) > e->most[k] ? fabs(x[k]) : e->most[k];
        status = isfinite(x[k]) ? NS_OK : NS_E_OVERFLOW; /* no number for ngspice */
    }
    if (status) {
        return ns_bridge_session_fail(b, status);
    }
    exchange(e);
    return OK;
}

static int read_point(ns_session *b) {
    if (ns_bridge_session_read(b, NULL)) {
        return b->failed;
    }
    ns_bridge_show_values(&b->engine, b->engine.x, b->value);
    return OK;
}

/* The right side of a jump has the time of the left one: it is shown that much later, as a point that ngspice
 * takes for another one, well before t. */
static double shown_after(const ns_session *b, double t) {
    return fmin(fmax(ldexp(b->engine.h, -19), 2.0 * ns_bridge_timepoints_closeness(b->ckt)),
                (t - b->t) / 8.0);
}

static int try_to(ns_session *b, double t, ns_until until) {
    const int timed = b->engine.ex.options.verbose; /* to ask for the time takes as long as a short way */
    const clock_t since = timed ? clock() : 0;
    const int status = ns_march_try(b->engine.march, t, until, &b->t_trial);
    b->cpu += timed ? clock() - since : 0;
    b->tried = !status;
    b->beside = b->tried && b->t_trial <= b->t;
    if (b->beside) {
        b->t_trial = b->t + shown_after(b, t);
    }
    return status ? ns_bridge_session_fail(b, status) : OK;
}

/* Leaves x(t) in b->value; a failure waits for the accept, which ends the analysis without a false point. */
static void load_tran(ns_session *b) {
    CKTcircuit *ckt = b->ckt;
    if (ckt->CKTtrtol != NS_BRIDGE_TRTOL && !b->failed) {
        b->loaded = 0;
        b->failed = ns_bridge_analysis_resume(b);
        ckt->CKTtrtol = NS_BRIDGE_TRTOL;
    }
    if (b->loaded && same_time(ckt->CKTtime, b->t_trial)) { /* ngspice solves twice at each point */
        return;
    }
    b->loaded = 0;
    /* what was accepted may lie a little beyond: a jump takes a while, and ngspice's times are rounded */
    if (b->failed || ckt->CKTtime <= b->t || same_time(ckt->CKTtime, b->t)) {
        return;
    }
    if ((!b->tried || !same_time(ckt->CKTtime, b->t_trial)) && try_to(b, ckt->CKTtime, NS_TO_TIME)) {
        return;
    }
    b->loaded = !read_point(b);
}

/* Leaves the operating point in b->value. */
static int load_dc(ns_session *b) {
    const int first = (b->ckt->CKTmode & (MODEINITJCT | MODEINITPRED)) != 0;
    int error = OK;
    if (first || !(b->engine.march || b->refused)) {
        error = b->failed = ns_bridge_analysis_start(b);
    }
    return b->ckt->CKTmode & MODEUIC ? OK : error; /* with uic there is no solve: the first accept ends it */
}

int ns_bridge_session_load(ns_session *b) {
    int error = OK;
    if (ns_bridge_single_load_begin(b)) {
        load_tran(b);
        ns_bridge_single_load_end(b);
        return OK;
    }
    ns_bridge_dc_rows_show(b);
    if (is_dc(b->ckt)) {
        error = load_dc(b);
    } else if (b->engine.march) {
        load_tran(b);
    }
    if (error || !b->force.entry) {
        return end_dc(b->ckt, error ? error : E_UNSUPP);
    }
    if (is_dc(b->ckt)) {
        ns_bridge_dc_rows_hide(b);
    }
    ns_bridge_force_apply(&b->force, b->refused ? 1e200 : 1.0, b->ckt->CKTrhs, b->value);
    return OK;
}

/* --- accepts --- */

static void accept_trial(ns_session *b) {
    ns_march_accept(b->engine.march);
    b->t = b->t_trial;
}

/* The next point that is not an event. */
static double next_point(ns_session *b, int first) {
    return ns_bridge_timepoints_next(b->ckt, &b->plan, b->engine.system, b->t, first);
}

/* The right side of an event that only bends waveforms needs no point of its own: it is accepted, and the
 * devices are shown as they are there.  1 if so. */
static int take_right_side(ns_session *b) {
    ns_analysis *e = &b->engine;
    const double t = b->t;
    int same = b->beside;
    if (!same) {
        return 0;
    }
    if (ns_bridge_session_read(b, NULL)) {
        return 0;
    }
    for (size_t k = 0; k < e->count && same; k++) {
        same =
            fabs(e->x[k] - e->before[k]) <= 1e-9 * e->most[k]; /* rounding is far below, what is seen above */
    }
    if (same) {
        accept_trial(b);
        b->t = t;
        ns_bridge_show_later(e);
    } else {
        exchange(e);
    }
    return same;
}

/* Where an input only turns, currents that are its rate jump (a capacitor straight across a source): exact
 * has an event there, others go on.  1 if so: the right side is tried. */
static int turns_here(ns_session *b, double t) {
    static const double seen = 1e-4; /* far above what a steep waveform does meanwhile */
    const ns_analysis *e = &b->engine;
    if (try_to(b, b->t + shown_after(b, t), NS_TO_TIME) || ns_bridge_session_read(b, NULL)) {
        return 0;
    }
    for (size_t k = 0; k < e->count; k++) {
        if (fabs(e->x[k] - e->before[k]) > seen * e->most[k]) {
            return 1;
        }
    }
    exchange(&b->engine);
    if (ns_march_engine(e->march) == NS_SPARSE) { /* goes on in the leg that begins here */
        const double here = b->t;
        accept_trial(b);
        b->t = here;
    }
    b->tried = 0;
    return 0;
}

/* 1 if the accepted point is a corner of an input that was no event. */
static int at_mere_corner(const ns_session *b) {
    return ns_bridge_timepoints_at_events(b->ckt, &b->plan) && same_time(b->t, b->plan.next) &&
           ns_march_engine(b->engine.march) != NS_EXACT && !ns_march_at_event(b->engine.march);
}

/* An event that is as good as here (ngspice cannot step there) is accepted, and the way after it tried. */
static int try_next(ns_session *b, int first) {
    CKTcircuit *ckt = b->ckt;
    const int corner = !first && at_mere_corner(b);
    int error = OK;
    if (corner && (turns_here(b, next_point(b, first)) || b->failed)) {
        return b->failed;
    }
    for (int near = 0; near < EVENTS_NEAR && !error && ns_bridge_timepoints_at_events(ckt, &b->plan);
         near++) {
        error = try_to(b, next_point(b, first), NS_TO_EVENT);
        if (error) {
            break;
        }
        if (!take_right_side(b)) {
            if (b->t_trial - ckt->CKTtime >= ns_bridge_timepoints_closeness(ckt)) {
                break;
            }
            accept_trial(b);
        }
        b->tried = 0;
    }
    return error || b->tried ? error : try_to(b, next_point(b, first), NS_TO_TIME);
}

static void look_ahead(ns_session *b, int first) {
    CKTcircuit *ckt = b->ckt;
    int error = try_next(b, first);
    if (!error && b->t_trial != ckt->CKTfinalTime &&
        ckt->CKTfinalTime - b->t_trial < ns_bridge_timepoints_closeness(ckt)) {
        error = try_to(b, ckt->CKTfinalTime, NS_TO_TIME);
    }
    if (!error) { /* otherwise the next accept ends the analysis: the present point is good */
        ckt->CKTdelta = fmax(b->t_trial - ckt->CKTtime, 2.0 * ckt->CKTdelmin);
    }
    ckt->CKTorder = 1; /* so that ngspice's own currents of capacitors do not ring after a jump */
}

int ns_bridge_session_accept(ns_session *b) {
    CKTcircuit *ckt = b->ckt;
    const int first = b->fresh;
    if (b->failed) {
        return b->failed;
    }
    if (!b->engine.march || is_dc(ckt) ||
        !ckt->CKTbreaks) { /* no breakpoints: a search for an operating point */
        return OK;
    }
    if (b->loaded) {
        accept_trial(b);
    }
    b->tried = b->loaded = b->fresh = 0;
    if (first) { /* the consistent start, not the operating point under .ic */
        if (read_point(b)) {
            return b->failed;
        }
        memcpy(ckt->CKTrhsOld, b->value, (size_t)b->engine.ex.neq * sizeof *b->value);
    }
    ns_bridge_show_later(&b->engine);
    if (ckt->CKTfinalTime - ckt->CKTtime < ckt->CKTminBreak) {
        if (b->engine.ex.options.verbose) {
            ns_bridge_show_summary(&b->engine, (double)b->cpu / CLOCKS_PER_SEC);
        }
        ns_bridge_session_release_loop(b);
        return OK;
    }
    look_ahead(b, first);
    return OK;
}

void ns_bridge_session_reset(ns_session *b) {
    ns_bridge_dc_rows_show(b);
    ns_bridge_single_load_forget(b);
    ns_bridge_session_release_loop(b);
    ns_bridge_analysis_clear(&b->engine);
    ns_bridge_force_clear(&b->force);
    free(b->value);
    free(b->held);
    b->value = NULL;
    b->held = NULL;
    b->fresh = b->tried = b->loaded = b->failed = 0;
}

void ns_bridge_session_clear(ns_session *b) {
    b->hidden = 0; /* the nodes may be gone */
    ns_bridge_session_reset(b);
    memset(b, 0, sizeof *b);
}
