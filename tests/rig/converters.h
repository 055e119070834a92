/* tests/rig/converters.h - converters and a detector at one stiff supply. */
#ifndef CONVERTERS_H
#define CONVERTERS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"

enum { MOST = 400, SUPPLY = 1, FIRST = 2, EACH = 3 };

static const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};

typedef struct scene {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double w0[MOST];
} scene;

static inline void put(scene *z, const char *name, int p, int n, ns_signal s) {
    assert_int_equal(ns_circuit_source(z->c, name, NS_VOLTAGE, p, n, &s, NULL), NS_OK);
}

static inline ns_signal sine(double v, double hz) {
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.va = v;
    s.u.sin.freq = hz;
    return s;
}

static inline ns_signal square(double every, double on) {
    return pulse(0, 1, 0, 10e-9, 10e-9, on * every, every);
}

/* With a supply of v, behind whose terminals a resistor hangs. */
static inline scene supplied(ns_signal v) {
    scene z = {0};
    assert_int_equal(ns_circuit_create(&z.c), NS_OK);
    put(&z, "in", SUPPLY, 0, v);
    assert_int_equal(ns_circuit_resistor(z.c, "rin", SUPPLY, 0, 100, NULL), NS_OK);
    return z;
}

/* Diode, inductor, capacitor and load behind a switch at the supply: nodes of its own from `node` on. */
static inline void buck(scene *z, const char *name, int node, double every, double load) {
    const ns_switch contact = {0.5, 0, 0, INFINITY};
    char part[16];
    const int x = node, out = node + 1, gate = node + 2;
#define PART(what) (snprintf(part, sizeof part, "%s%s", what, name), part)
    put(z, PART("v"), gate, 0, square(every, 0.4));
    assert_int_equal(ns_circuit_switch(z->c, PART("s"), SUPPLY, x, gate, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(z->c, PART("d"), 0, x, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(z->c, PART("l"), x, out, 100e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(z->c, PART("c"), out, 0, 22e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, PART("r"), out, 0, load, NULL), NS_OK);
}

/* A peak detector at the supply, nodes from `node` on. */
static inline void detector(scene *z, const char *name, int node) {
    char part[16];
    assert_int_equal(ns_circuit_resistor(z->c, PART("a"), SUPPLY, node, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(z->c, PART("d"), node, node + 1, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(z->c, PART("c"), node + 1, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, PART("r"), node + 1, 0, 1e3, NULL), NS_OK);
}

static inline void make(scene *z, ns_method method, int whole) {
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .h = 1e-6, .method = method, .reltol = 1e-9, .whole = whole};
    assert_int_equal(ns_circuit_system(z->c, &z->s), NS_OK);
    assert_true(z->s->n <= MOST && z->s->m <= MOST);
    assert_int_equal(ns_circuit_rest(z->c, z->w0), NS_OK);
    assert_int_equal(ns_march_create(z->s, &o, &z->m, NULL), NS_OK);
}

static inline void begin(scene *z, ns_method method, int whole) {
    make(z, method, whole);
    assert_int_equal(ns_march_start(z->m, 0, z->w0), NS_OK);
}

static inline void end(scene *z) {
    ns_march_free(z->m);
    ns_system_free(z->s);
    ns_circuit_free(z->c);
}

static inline long islands(scene *z) {
    return ns_march_counts(z->m)->islands;
}

static inline scene two_bucks(void) {
    scene z = supplied(dc(24));
    buck(&z, "1", FIRST, 10e-6, 4);
    buck(&z, "2", FIRST + EACH, 7.3e-6, 300); /* discontinuous */
    return z;
}

#endif
