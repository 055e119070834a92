/* tests/rig/net.c - a circuit, element by element, and the jump that its initial state makes. */
#include "net.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
static const ns_switch toggle = {0.5, 0, 0, INFINITY};

net net_begin(void) {
    net k = {0};
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    return k;
}

void net_end(net *k) {
    ns_theta_free(k->step);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
}

int net_capacitor(net *k, const char *name, int p, int n, double c, double v) {
    int id;
    assert_int_equal(ns_circuit_capacitor(k->c, name, p, n, c, v, &id), NS_OK);
    return id;
}

int net_inductor(net *k, const char *name, int p, int n, double l, double i) {
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, name, p, n, l, i, &id), NS_OK);
    return id;
}

int net_resistor(net *k, const char *name, int p, int n, double r) {
    int id;
    assert_int_equal(ns_circuit_resistor(k->c, name, p, n, r, &id), NS_OK);
    return id;
}

int net_diode(net *k, const char *name, int p, int n) {
    int id;
    assert_int_equal(ns_circuit_diode(k->c, name, p, n, &ideal, &id), NS_OK);
    return id;
}

int net_voltage(net *k, const char *name, int p, int n, double v) {
    int id;
    ns_signal s = {.kind = NS_PWL}; /* an input; one that stands still would be a constant of the system */
    const double at[2] = {1, 2}, volts[2] = {v, v + 1};
    s.u.pwl.n = 2;
    s.u.pwl.t = at;
    s.u.pwl.v = volts;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, p, n, &s, &id), NS_OK);
    return id;
}

/* Its gate is a node of its own that drives nothing else. */
int net_contact(net *k, const char *name, int p, int n, int closed) {
    char gate[16];
    int id;
    snprintf(gate, sizeof gate, "g%s", name);
    net_voltage(k, gate, 100 + k->switches, 0, closed);
    assert_int_equal(ns_circuit_switch(k->c, name, p, n, 100 + k->switches, 0, &toggle, &id), NS_OK);
    k->closed[k->switches++] = (unsigned char)closed;
    return id;
}

void net_prepare(net *k) {
    static const ns_theta_options o = {1, 1, 0};
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    assert_true(k->s->n <= NET_MOST && k->s->m <= NET_MOST && k->s->nz <= NET_MOST);
    assert_int_equal(ns_theta_create(k->s, &o, &k->step, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(k->c, k->w0), NS_OK);
    assert_int_equal(ns_theta_start(k->step, k->w0, k->closed), NS_OK);
    ns_system_inputs(k->s, 0, NS_RIGHT, k->z);
}

int net_jump(net *k, const double *slope) {
    const ns_impulse out = {.w = k->w,
                            .x = k->x,
                            .lambda = k->lambda,
                            .y = k->y,
                            .X = k->X,
                            .Lambda = k->Lambda,
                            .Y = k->Y,
                            .mode = k->mode,
                            .h = &k->h};
    return ns_theta_impulse(k->step, k->z, slope, &out);
}

void net_jumps(net *k) {
    net_prepare(k);
    assert_int_equal(net_jump(k, NULL), NS_OK);
}

double net_voltage_of(const net *k, const double *x, int node) {
    const int i = ns_circuit_node_unknown(k->c, node);
    return i < 0 ? 0 : x[i];
}

double net_current_of(const net *k, const double *x, int id) {
    return x[ns_circuit_current_unknown(k->c, id)];
}

/* Current of a device in lambda, or its charge in Lambda. */
double net_device_of(const net *k, const double *x, const double *lambda, int id) {
    double i;
    assert_int_equal(ns_circuit_device(k->c, id, x, lambda, k->mode, &i, NULL, NULL), NS_OK);
    return i;
}
