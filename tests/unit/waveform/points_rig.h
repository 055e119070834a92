/* tests/unit/waveform/points_rig.h - a circuit, its marcher and its waveform, and the points that were given
 * out. */
#ifndef POINTS_RIG_H
#define POINTS_RIG_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"

enum { MOST_POINTS = 100000 };

typedef struct rig {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    ns_waveform *w;
    int unknown, count; /* the signal; points */
    double *t, *v;      /* MOST_POINTS */
} rig;

static inline rig rig_begin(void) {
    rig r = {.t = calloc(MOST_POINTS, sizeof(double)), .v = calloc(MOST_POINTS, sizeof(double))};
    assert_int_equal(ns_circuit_create(&r.c), NS_OK);
    assert_true(r.t && r.v);
    return r;
}

static inline void rig_end(rig *r) {
    ns_waveform_free(r->w);
    ns_march_free(r->m);
    ns_system_free(r->s);
    ns_circuit_free(r->c);
    free(r->t);
    free(r->v);
}

/* Marcher and waveform, at rest at t = 0; a status of either. */
static inline int rig_prepare(rig *r, ns_method method, double h, const ns_waveform_options *o) {
    const ns_march_options march = {.theta = 0.5, .gamma = 0.5, .h = h, .method = method};
    double *w0 = NULL;
    int status = ns_circuit_system(r->c, &r->s);
    status = status ? status : ns_march_create(r->s, &march, &r->m, NULL);
    status = status ? status : ns_waveform_create(r->s, r->m, o, &r->w);
    w0 = status ? NULL : calloc((size_t)r->s->n + 1, sizeof *w0);
    status = status || w0 ? status : NS_E_MEMORY;
    status = status ? status : ns_circuit_rest(r->c, w0);
    status = status ? status : ns_march_start(r->m, 0, w0);
    free(w0);
    return status;
}

static inline void rig_keep(rig *r, const ns_waveform_point *p) {
    assert_true(r->count < MOST_POINTS);
    assert_true(r->count == 0 || p->t > r->t[r->count - 1]);
    r->v[r->count] = p->x[r->unknown];
    r->t[r->count++] = p->t;
}

/* From the first point, or what is there, to stop; the status of the first call that fails. */
static inline int rig_run(rig *r, double stop) {
    ns_waveform_point p;
    int status = NS_OK;
    if (r->count == 0) {
        status = ns_waveform_start(r->w, &p);
        if (status == NS_OK)
            rig_keep(r, &p);
    }
    while (status == NS_OK && r->t[r->count - 1] < stop) {
        status = ns_waveform_next(r->w, stop, &p);
        if (status == NS_OK)
            rig_keep(r, &p);
    }
    return status;
}

/* The largest distance between the lines and f, at parts of each line. */
static inline double rig_off(const rig *r, double (*f)(double t)) {
    double most = 0;
    for (int i = 1; i < r->count; i++)
        for (int k = 0; k <= 8; k++) {
            const double part = k / 8.0, t = r->t[i - 1] + part * (r->t[i] - r->t[i - 1]);
            most = fmax(most, fabs(r->v[i - 1] + part * (r->v[i] - r->v[i - 1]) - f(t)));
        }
    return most;
}

/* The integral of the lines. */
static inline double rig_integral(const rig *r) {
    double sum = 0;
    for (int i = 1; i < r->count; i++)
        sum += 0.5 * (r->t[i] - r->t[i - 1]) * (r->v[i] + r->v[i - 1]);
    return sum;
}

static inline double rig_largest(const rig *r) {
    double most = 0;
    for (int i = 0; i < r->count; i++)
        most = fmax(most, fabs(r->v[i]));
    return most;
}

/* 1 V through 1 ohm onto 1 F: v = 1 - e^-t at node `out`. */
static inline void rig_add_rc(rig *r, const char *const names[2], int in, int out, double farads) {
    assert_int_equal(ns_circuit_resistor(r->c, names[0], in, out, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(r->c, names[1], out, 0, farads, 0, NULL), NS_OK);
}

static inline void rig_make_rc(rig *r) {
    const ns_signal one = dc(1);
    assert_int_equal(ns_circuit_source(r->c, "v", NS_VOLTAGE, 1, 0, &one, NULL), NS_OK);
    rig_add_rc(r, (const char *const[]){"r", "c"}, 1, 2, 1);
    r->unknown = ns_circuit_node_unknown(r->c, 2);
}

static inline double rig_rc(double t) {
    return 1 - exp(-t);
}

#endif
