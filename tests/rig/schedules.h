/* tests/rig/schedules.h - small systems with a schedule each, and what it says next. */
#ifndef SCHEDULES_H
#define SCHEDULES_H

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "inputs/time_events.h"
#include "nonsmooth.h"
#include "signals.h"
#include "system/active_inputs.h"

static const double eps = DBL_EPSILON, pi = 3.14159265358979323846;

static inline void assert_near(double is, double should, double tol) {
    if (!(fabs(is - should) <= tol))
        print_message("%.17g is not %.17g\n", is, should);
    assert_true(fabs(is - should) <= tol);
}

static inline ns_signal sine(double vo, double va, double freq, double td, double phase) {
    return (ns_signal){.kind = NS_SIN, .u.sin = {vo, va, freq, td, 0, phase}};
}

/* One unknown, nz inputs that do not enter, nc commands of no input. */
static inline ns_system *bare(int nz, int nc) {
    ns_system *s;
    assert_int_equal(ns_system_create(1, nc, nz, nc, &s), NS_OK);
    s->M[0] = 1;
    for (int c = 0; c < nc; c++) {
        s->command[c].pair = c;
        s->command[c].gz = calloc((size_t)nz + 1, sizeof(double));
        assert_non_null(s->command[c].gz);
    }
    return s;
}

static inline void input(ns_system *s, int i, ns_signal z) {
    assert_int_equal(ns_system_set_input(s, i, &z), NS_OK);
}

static inline void thresholds(ns_system *s, int c, double on, double off) {
    s->command[c].on = on;
    s->command[c].off = off;
}

static inline ns_time_events *schedule(const ns_system *s) {
    unsigned char *active = calloc((size_t)s->nz + 1, 1);
    ns_time_events *made;
    assert_non_null(active);
    assert_int_equal(ns_system_active_inputs(s, active), NS_OK);
    assert_int_equal(ns_inputs_events_create(s, active, &made), NS_OK);
    free(active);
    return made;
}

static inline void done(ns_time_events *s, ns_system *system) {
    ns_inputs_events_free(s);
    ns_system_free(system);
}

/* The next instant is at t, and flips commands as the bits of which say; NULL if it does not. */
static inline const ns_time_event *expect(ns_time_events *s, double t, double tol, unsigned which) {
    unsigned bits = 0;
    assert_near(ns_inputs_events_next(s, INFINITY), t, tol);
    const ns_time_event *what = ns_inputs_events_pass(s);
    for (int i = 0; i < what->flips; i++)
        bits |= 1u << what->flip[i];
    assert_int_equal(bits, which);
    return what;
}

#endif
