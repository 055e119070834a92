/* tests/rig/periods.h - circuits at a drive of 100 kHz, flown to a time or from event to event. */
#ifndef PERIODS_H
#define PERIODS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"

enum { MOST = 16 };

static const double period = 10e-6;

/* 0 and v in turn, edges of 10 ns, v half the time. */
static inline ns_signal square(double v, double every) {
    ns_signal s = {.kind = NS_PULSE};
    s.u.pulse.v2 = v;
    s.u.pulse.tr = s.u.pulse.tf = 10e-9;
    s.u.pulse.pw = every / 2 - 10e-9;
    s.u.pulse.per = every;
    return s;
}

typedef struct scene {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    int watched; /* an unknown */
} scene;

static inline void begin(scene *z, size_t bytes) {
    double w0[MOST] = {0};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .map_bytes = bytes, .method = NS_EXACT};
    assert_int_equal(ns_circuit_system(z->c, &z->s), NS_OK);
    assert_true(z->s->n <= MOST);
    assert_int_equal(ns_circuit_rest(z->c, w0), NS_OK);
    assert_int_equal(ns_march_create(z->s, &o, &z->m, NULL), NS_OK);
    assert_int_equal(ns_march_start(z->m, 0, w0), NS_OK);
}

static inline void end(scene *z) {
    ns_march_free(z->m);
    ns_system_free(z->s);
    ns_circuit_free(z->c);
}

static inline void put(scene *z, const char *name, int p, int n, ns_signal s) {
    assert_int_equal(ns_circuit_source(z->c, name, NS_VOLTAGE, p, n, &s, NULL), NS_OK);
}

static inline double value(scene *z) {
    double x[MOST];
    assert_int_equal(ns_march_read(z->m, NULL, x, NULL, NULL), NS_OK);
    return x[z->watched];
}

static inline void go(scene *z, double t, ns_until until) {
    double reached = 0;
    while (reached < t) {
        assert_int_equal(ns_march_try(z->m, t, until, &reached), NS_OK);
        assert_int_equal(ns_march_accept(z->m), NS_OK);
    }
}

#endif
