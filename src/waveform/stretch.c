/* src/waveform/stretch.c - the marcher's trials: smooth pieces of waveform, and jumps between them. */
#include "linalg/simd.h"
#include "waveform_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* One trial that ends after w->made begins, well enough for a point of its own; *passed: events on the way.
 */
static int try_stretch(ns_waveform *w, double until, int *passed) {
    *passed = 0;
    for (int count = 0; count < NS_CLOSE_EVENTS; count++) {
        const int status = ns_march_try(w->march, until, NS_TO_STEP, &w->end);
        if (status != NS_OK)
            return status;
        const int here = w->end <= w->accepted_t; /* the right side of an event */
        if (!here && (w->end >= until || w->end - w->made.at[0].t > w->closest))
            return NS_OK;
        *passed |= here || ns_march_at_event(w->march);
        const int taken = ns_waveform_take_integrals(w, w->end);
        if (taken != NS_OK)
            return taken;
        const int accepted = ns_march_accept(w->march);
        if (accepted != NS_OK)
            return accepted;
        w->accepted_t = w->end;
    }
    return NS_E_LIMIT;
}

/* How far from an event values are taken that are shown at its two sides: a value that is at a threshold to
 * the last digit counts as two crossings in .meas. */
static double beside_event(const ns_waveform *w) {
    static const double of_length = 1e-12, of_time = 16 * DBL_EPSILON;
    const double length = w->end - w->accepted_t;
    return fmin(fmax(of_length * length, of_time * w->end), 0.5 * length);
}

/* w->made as the jump from where it begins to the right side of the event, row.  What decays at once is shown
 * as it begins. */
static int make_jump(ns_waveform *w, double *row) {
    static const double decayed = 1e-4;
    ns_segment *g = &w->made;
    const double t = g->at[0].t, room = w->end - t, beside = beside_event(w);
    const double fast = fmin(ns_march_shortest(w->march, w->accepted_t, NULL), room);
    const double later = fmin(fmax(w->closest, 1e-7 * fmin(fast, w->before)), room / 8);
    if (beside <= decayed * fast) {
        ns_waveform_return_row(w, row);
        const int status = ns_waveform_sample(w, w->accepted_t + beside, &row);
        if (status != NS_OK)
            return status;
    }
    ns_waveform_put_integrals(w, row);
    g->at[++g->last] = (ns_probe){fmax(t, w->accepted_t) + later, row};
    g->jumps = 1;
    return NS_OK;
}

/* What comes and goes in the stretch counts too among the values at its end. */
static int look_amid(ns_waveform *w) {
    double *row;
    const double t = w->accepted_t + ns_waveform_first_part * (w->end - w->accepted_t);
    const int status = ns_waveform_sample(w, t, &row);
    if (status != NS_OK)
        return status;
    for (int i = 0; i < w->looked; i++)
        w->end_values[i] = ns_higher(fabs(w->end_values[i]), fabs(ns_waveform_seen(w, row)[i]));
    w->amid = (ns_probe){t, row};
    return NS_OK;
}

/* Values at both ends of the stretch.  A waveform that rises from zero is to be seen beside what it comes to.
 */
static int sample_ends(ns_waveform *w, double **row) {
    double *end;
    int status = ns_waveform_sample(w, w->end - (ns_march_at_event(w->march) ? beside_event(w) : 0), &end);
    if (status != NS_OK)
        return status;
    memcpy(w->at_end, end, sizeof *end * w->count);
    memcpy(w->end_values, ns_waveform_seen(w, end), sizeof *end * (size_t)w->looked);
    ns_waveform_return_row(w, end);
    if (w->squares > 0)
        status = look_amid(w);
    if (status != NS_OK)
        return status;
    return ns_waveform_sample(w, w->accepted_t, row);
}

int ns_waveform_enter_stretch(ns_waveform *w, double until) {
    double *row;
    int passed, status = try_stretch(w, until, &passed);
    ns_waveform_drop_amid(w);
    if (status == NS_OK) {
        w->mode = ns_march_mode(w->march);
        status = sample_ends(w, &row);
    }
    if (status != NS_OK)
        return status;
    w->in_stretch = w->fresh = 1;
    w->made.from_event = passed || w->after_event;
    w->after_event = 0;
    w->is_first = w->made.from_event;
    if (w->made.from_event)
        ns_waveform_begin_integrals(w, w->made.at[0].t);
    w->made.smooth = !ns_waveform_differ(w, w->made.at[0].v, row);
    if (!w->made.smooth)
        return make_jump(w, row);
    ns_waveform_return_row(w, row);
    return NS_OK;
}

int ns_waveform_leave_stretch(ns_waveform *w) {
    w->after_event = ns_march_at_event(w->march);
    const int status = ns_march_accept(w->march);
    w->before = w->end - w->accepted_t;
    w->accepted_t = w->end;
    w->in_stretch = 0;
    return status;
}
