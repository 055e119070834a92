/* tests/unit/test_sparse_march.c - the sparse marcher against closed forms. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "engine/marcher.h"
#include "engine/sparse_engine.h"
#include "nonsmooth.h"
#include "systems.h"

/* A circuit and its marcher; the tolerance of a step is 1e-11, what is expected is met a hundred times that.
 */
typedef struct rig {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double *x;
} rig;

static const double close_enough = 1e-9;
static const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};

static rig begin(void) {
    rig k = {0};
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    return k;
}

static void make(rig *k, double h) {
    const ns_march_options o = {.h = h, .method = NS_SPARSE, .reltol = 1e-11};
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    assert_int_equal(ns_march_create(k->s, &o, &k->m, NULL), NS_OK);
    k->x = calloc((size_t)k->s->n + 1, sizeof(double));
    assert_non_null(k->x);
}

static void ready(rig *k, double h) {
    make(k, h);
    assert_int_equal(ns_circuit_rest(k->c, k->x), NS_OK);
    assert_int_equal(ns_march_start(k->m, 0, k->x), NS_OK);
}

static void end(rig *k) {
    ns_march_free(k->m);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
    free(k->x);
}

static void go(rig *k, double t) {
    double reached;
    assert_int_equal(ns_march_try(k->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_true(reached == t);
    assert_int_equal(ns_march_accept(k->m), NS_OK);
    assert_int_equal(ns_march_read(k->m, NULL, k->x, NULL, NULL), NS_OK);
}

static void near(double got, double expected, double size) {
    if (fabs(got - expected) > close_enough * size)
        fail_msg("%.17g, expected %.17g", got, expected);
}

static void resistor(rig *k, const char *name, int p, int n, double r) {
    assert_int_equal(ns_circuit_resistor(k->c, name, p, n, r, NULL), NS_OK);
}

static void capacitor(rig *k, const char *name, int p, int n, double c, double v) {
    assert_int_equal(ns_circuit_capacitor(k->c, name, p, n, c, v, NULL), NS_OK);
}

static int inductor(rig *k, const char *name, int p, int n, double l) {
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, name, p, n, l, 0, &id), NS_OK);
    return id;
}

static void diode(rig *k, const char *name, int p, int n) {
    assert_int_equal(ns_circuit_diode(k->c, name, p, n, &ideal, NULL), NS_OK);
}

static void source(rig *k, const char *name, int p, const ns_signal *s) {
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, p, 0, s, NULL), NS_OK);
}

static void constant(rig *k, const char *name, int p, double v) {
    source(k, name, p, &(ns_signal){.kind = NS_DC, .u.dc = v});
}

/* A gate that is 1 from 0 to on, 0 up to period, and so on; edges are jumps. */
static void gate(rig *k, const char *name, int p, double on, double period) {
    ns_signal s = {.kind = NS_PULSE};
    s.u.pulse.v2 = 1;
    s.u.pulse.pw = on;
    s.u.pulse.per = period;
    source(k, name, p, &s);
}

static void contact(rig *k, const char *name, int p, int n, int control, double vt, double vh) {
    const ns_switch sw = {vt, vh, 0, INFINITY};
    assert_int_equal(ns_circuit_switch(k->c, name, p, n, control, 0, &sw, NULL), NS_OK);
}

static double voltage(const rig *k, int node) {
    return k->x[ns_circuit_node_unknown(k->c, node)];
}

static double current(const rig *k, int id) {
    return k->x[ns_circuit_current_unknown(k->c, id)];
}

/* --- linear --- */

/* v = e^-t */
static void test_decay(void **state) {
    (void)state;
    rig k = {.s = system_decay()};
    const ns_march_options o = {.h = 0.5, .method = NS_SPARSE, .reltol = 1e-11};
    const double w0[] = {1};
    double x, reached;
    assert_int_equal(ns_march_create(k.s, &o, &k.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(k.m, 0, w0), NS_OK);
    for (int i = 1; i < 40; i++) {
        assert_int_equal(ns_march_try(k.m, 0.13 * i, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        assert_int_equal(ns_march_read(k.m, NULL, &x, NULL, NULL), NS_OK);
        near(x, exp(-0.13 * i), 1);
    }
    end(&k);
}

/* RC = 1 ms behind a source.  Ramp of slope a from 0:  v = a (t - tau + tau e^(-t/tau)).  Sine sin(wt):
 *     v = (sin wt - w tau cos wt + w tau e^(-t/tau)) / (1 + (w tau)^2).
 * 1 - e^(-t/T):  v = 1 - (T e^(-t/T) - tau e^(-t/tau)) / (T - tau). */
static void test_inputs(void **state) {
    (void)state;
    const double tau = 1e-3, w = 2 * acos(-1.0) * 500, T = 3e-3;
    rig k = begin();
    ns_signal ramp = {.kind = NS_PWL}, sine = {.kind = NS_SIN}, rise = {.kind = NS_EXP};
    const double at[] = {0, 1}, volts[] = {0, 2000};
    ramp.u.pwl.n = 2;
    ramp.u.pwl.t = at;
    ramp.u.pwl.v = volts;
    ramp.u.pwl.repeat = NAN;
    sine.u.sin.va = 1;
    sine.u.sin.freq = 500;
    rise.u.exp.v2 = 1;
    rise.u.exp.tau1 = T;
    rise.u.exp.td2 = 1;
    rise.u.exp.tau2 = 1;
    const ns_signal *const all[] = {&ramp, &sine, &rise};
    for (int i = 0; i < 3; i++) {
        char name[] = "v0", r[] = "r0", c[] = "c0";
        name[1] = r[1] = c[1] = (char)('1' + i);
        source(&k, name, 1 + 2 * i, all[i]);
        resistor(&k, r, 1 + 2 * i, 2 + 2 * i, 1e3);
        capacitor(&k, c, 2 + 2 * i, 0, 1e-6, 0);
    }
    ready(&k, 1e-3);
    for (int i = 1; i <= 50; i++) {
        const double t = 1.37e-4 * i, left = exp(-t / tau);
        go(&k, t);
        near(voltage(&k, 2), 2000 * (t - tau + tau * left), 10);
        near(voltage(&k, 4), (sin(w * t) - w * tau * (cos(w * t) - left)) / (1 + w * w * tau * tau), 1);
        near(voltage(&k, 6), 1 - (T * exp(-t / T) - tau * left) / (T - tau), 1);
    }
    end(&k);
}

/* A stiff part (1 ns) that follows a slow one: damped, not resolved; few steps. */
static void test_stiff(void **state) {
    (void)state;
    rig k = begin();
    capacitor(&k, "c1", 1, 0, 1e-6, 1);
    resistor(&k, "r1", 1, 0, 1e3);
    resistor(&k, "r2", 1, 2, 1);
    capacitor(&k, "c2", 2, 0, 1e-9, 1);
    ready(&k, 1e-3);
    go(&k, 5e-3);
    /* slow eigenvalue of the two: a (1-e) with a = 1/(R1 (C1+C2)); the correction R2 C2/(R1 C1) is 1e-6 */
    const double g1 = 1e-3, g2 = 1, c1 = 1e-6, c2 = 1e-9, b = (g1 + g2) / c1 + g2 / c2;
    const double slow = 2 * (g1 * g2 / (c1 * c2)) / (b + sqrt(b * b - 4 * g1 * g2 / (c1 * c2)));
    const double fast = b - slow;
    /* v1(0) = v2(0) = 1: v1 = A e^(-slow t) + ..., with A from v1'(0) = -g1/c1 */
    near(voltage(&k, 1), (fast - g1 / c1) / (fast - slow) * exp(-slow * 5e-3), 1);
    assert_true(ns_march_counts(k.m)->steps < 250);
    end(&k);
}

/* --- devices --- */

static void test_bridge(void **state) {
    (void)state;
    rig k = {.s = system_lc_bridge()};
    const ns_march_options o = {.h = 50e-6, .method = NS_SPARSE, .reltol = 1e-11};
    const double w0[] = {10e-6, 0};
    double x[2], reached;
    assert_int_equal(ns_march_create(k.s, &o, &k.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(k.m, 0, w0), NS_OK);
    for (int i = 1; i <= 500; i++) {
        assert_int_equal(ns_march_try(k.m, 1e-5 * i, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        assert_int_equal(ns_march_read(k.m, NULL, x, NULL, NULL), NS_OK);
        near(x[0], lc_bridge_v(10, 1e-5 * i), 10);
    }
    assert_int_equal(ns_march_counts(k.m)->events, 16); /* w/pi zeros in 5 ms */
    end(&k);
}

/* 10 V through a switch, on for 3 of 10 us, onto 10 ohm and 100 uH with a freewheeling diode:
 * i tends to 1 A or to 0 with L/R = 10 us. */
static double chopper_current(double t, double on, double period) {
    const double tau = 1e-5;
    double i = 0;
    while (t > 0) {
        const double first = fmin(t, on), rest = fmin(fmax(0, t - on), period - on);
        i = 1 + (i - 1) * exp(-first / tau);
        i *= exp(-rest / tau);
        t -= period;
    }
    return i;
}

static void chopper(rig *k, int at, int number, int *l) {
    char name[5][16];
    static const char *const what[] = {"vg", "s", "d", "l", "r"};
    for (int i = 0; i < 5; i++)
        snprintf(name[i], sizeof name[i], "%s%d", what[i], number);
    gate(k, name[0], at, 3e-6, 1e-5);
    contact(k, name[1], 1, at + 1, at, 0.5, 0);
    diode(k, name[2], 0, at + 1);
    *l = inductor(k, name[3], at + 1, at + 2, 1e-4);
    resistor(k, name[4], at + 2, 0, 10);
}

static void test_chopper(void **state) {
    (void)state;
    rig k = begin();
    int l;
    constant(&k, "vin", 1, 10);
    chopper(&k, 2, 0, &l);
    ready(&k, 1e-5);
    for (int i = 1; i <= 100; i++) {
        const double t = 0.77e-6 * i;
        go(&k, t);
        near(current(&k, l), chopper_current(t, 3e-6, 1e-5), 1);
    }
    end(&k);
}

/* NS_AUTO takes the sparse engine for s, the scheme its own steps, if theta = gamma; flight takes it not. */
static void auto_is_sparse(const ns_system *s) {
    ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_AUTO};
    ns_march *m;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    ns_march_free(m);
    o.method = NS_THETA;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_engine(m), NS_THETA);
    ns_march_free(m);
    o.theta = 0.5;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_E_SIZE);
    o.method = NS_FLIGHT;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_E_SIZE);
}

/* So many of them that the system is a large one. */
static void test_many_choppers(void **state) {
    (void)state;
    enum { COUNT = 300 };
    rig k = begin();
    int l[COUNT];
    constant(&k, "vin", 1, 10);
    for (int i = 0; i < COUNT; i++)
        chopper(&k, 2 + 3 * i, i, &l[i]);
    ready(&k, 1e-5);
    assert_non_null(k.s->large);
    assert_null(k.s->A);
    auto_is_sparse(k.s);
    go(&k, 4.2e-5);
    for (int i = 0; i < COUNT; i++)
        near(current(&k, l[i]), chopper_current(4.2e-5, 3e-6, 1e-5), 1);
    end(&k);
}

/* The same of fewer: large, but the dense engines take a copy. */
static void test_some_choppers(void **state) {
    (void)state;
    enum { COUNT = 60 };
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_FLIGHT};
    rig k = begin();
    int l[COUNT];
    double reached;
    constant(&k, "vin", 1, 10);
    for (int i = 0; i < COUNT; i++)
        chopper(&k, 2 + 3 * i, i, &l[i]);
    make(&k, 1e-5);
    assert_non_null(k.s->large);
    ns_march_free(k.m);
    assert_int_equal(ns_march_create(k.s, &o, &k.m, NULL), NS_OK);
    assert_int_equal(ns_march_engine(k.m), NS_FLIGHT);
    assert_int_equal(ns_circuit_rest(k.c, k.x), NS_OK);
    assert_int_equal(ns_march_start(k.m, 0, k.x), NS_OK);
    assert_int_equal(ns_march_try(k.m, 5e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(k.m, NULL, k.x, NULL, NULL), NS_OK);
    for (int i = 0; i < COUNT; i++)
        near(current(&k, l[i]), chopper_current(5e-6, 3e-6, 1e-5), 1);
    end(&k);
}

/* 10 V, switched on for 2 of 10 us, through 10 uH into 6 V: up at 0.4 A/us to 0.8 A, down at 0.6 A/us, at
 * zero 4/3 us later; there it stays, and the diode's node at 6 V. */
static void test_discontinuous(void **state) {
    (void)state;
    rig k = begin();
    constant(&k, "vin", 1, 10);
    gate(&k, "vg", 2, 2e-6, 1e-5);
    contact(&k, "s", 1, 3, 2, 0.5, 0);
    diode(&k, "d", 0, 3);
    const int l = inductor(&k, "l", 3, 4, 1e-5);
    constant(&k, "vout", 4, 6);
    ready(&k, 1e-5);
    go(&k, 1.5e-6);
    near(current(&k, l), 0.6, 1);
    for (int i = 0; i < 5; i++) {
        const double t = 1e-5 * i;
        go(&k, t + 2.5e-6);
        near(current(&k, l), 0.5, 1);
        near(voltage(&k, 3), 0, 10);
        go(&k, t + 7e-6);
        near(current(&k, l), 0, 1);
        near(voltage(&k, 3), 6, 10);
    }
    double reached;
    assert_int_equal(ns_march_try(k.m, 1, NS_TO_EVENT, &reached), NS_OK);
    assert_int_equal(ns_march_accept(k.m), NS_OK);
    near(reached, 5e-5, 1e-5); /* the next gate */
    assert_true(ns_march_at_event(k.m));
    for (int i = 0; i < 3; i++) { /* to its right, to where the switch opens, to its right */
        assert_int_equal(ns_march_try(k.m, 1, NS_TO_EVENT, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
    }
    assert_int_equal(ns_march_try(k.m, 1, NS_TO_EVENT, &reached), NS_OK);
    near(reached, 5e-5 + 2e-6 + 4e-6 / 3, 1e-5);
    end(&k);
}

/* 20 V through a switch that closes while ref > out, a freewheel diode, 100 uH, 10 ohm, no hysteresis. */
static rig sliding(const ns_signal *ref) {
    static const ns_switch sw = {0, 0, 0, INFINITY};
    rig k = begin();
    constant(&k, "vin", 1, 20);
    source(&k, "vr", 4, ref);
    assert_int_equal(ns_circuit_switch(k.c, "s", 1, 2, 4, 3, &sw, NULL), NS_OK);
    diode(&k, "d", 0, 2);
    inductor(&k, "l", 2, 3, 1e-4);
    resistor(&k, "r", 3, 0, 10);
    ready(&k, 1e-5);
    return k;
}

/* out = 20 (1 - e^(-t/10 us)) until it meets ref, then it is ref: the coil needs no more than 0.13 V for
 * that. One event: the meeting. */
static void test_slides(void **state) {
    (void)state;
    ns_signal ref = {.kind = NS_SIN};
    ref.u.sin.vo = 7.5;
    ref.u.sin.va = 2;
    ref.u.sin.freq = 1000;
    rig k = sliding(&ref);
    go(&k, 3e-6);
    near(voltage(&k, 3), -20 * expm1(-0.3), 20);
    for (int i = 1; i <= 16; i++) {
        go(&k, 1.25e-4 * i);
        near(voltage(&k, 3), 7.5 + 2 * sin(2 * acos(-1.0) * 0.125 * i), 1);
    }
    assert_int_equal(ns_march_counts(k.m)->events, 1);
    assert_int_equal(ns_march_mode(k.m)[0], NS_INSIDE);
    end(&k);
}

/* ref falls from 5 V to 2 V in 1 ns at 1 ms: out cannot follow, it falls with 10 us, and slides again from
 * 10 us ln 2.5 on.  Then ref rises to 8 V at 2 ms: out rises towards 20 V and meets it after 10 us ln 1.5. */
static void test_slides_again(void **state) {
    (void)state;
    const double at[] = {0, 1e-3, 1.000001e-3, 2e-3, 2.000001e-3}, volts[] = {5, 5, 2, 2, 8}, tau = 1e-5;
    ns_signal ref = {.kind = NS_PWL};
    ref.u.pwl.n = 5;
    ref.u.pwl.t = at;
    ref.u.pwl.v = volts;
    ref.u.pwl.repeat = NAN;
    rig k = sliding(&ref);
    go(&k, 0.9e-3);
    near(voltage(&k, 3), 5, 1);
    /* the ramps delay it by 1 ns at most: of 5 V, falling with 10 us, 5e-4 V; of 18 V 2e-3 V */
    for (int i = 1; i < 9; i++) {
        go(&k, 1e-3 + i * 1e-6);
        assert_true(fabs(voltage(&k, 3) - 5 * exp(-i * 1e-6 / tau)) < 1e-3);
    }
    go(&k, 1e-3 + tau * log(2.5) + 1e-7);
    near(voltage(&k, 3), 2, 1);
    go(&k, 2.003e-3);
    assert_true(fabs(voltage(&k, 3) - (20 - 18 * exp(-0.3))) < 1e-2);
    go(&k, 2.2e-3);
    near(voltage(&k, 3), 8, 1);
    end(&k);
}

/* RC from 3 V, taken down by a switch over a smaller resistor from 2 V on until 1 V: up from 1 to 2 V takes
 * RC ln 2; down towards 3 r/(R+r) with RC r/(R+r). */
static void test_relaxation(void **state) {
    (void)state;
    rig k = begin();
    constant(&k, "vin", 1, 3);
    resistor(&k, "r1", 1, 2, 1e3);
    capacitor(&k, "c", 2, 0, 1e-6, 1);
    resistor(&k, "r2", 2, 3, 250);
    contact(&k, "s", 3, 0, 2, 1.5, 0.5);
    ready(&k, 1e-3);
    const double up = 1e-3 * log(2), tau = 1e-3 * 0.2, low = 3 * 0.2, down = tau * log((2 - low) / (1 - low));
    for (int i = 0; i < 4; i++) {
        const double t = i * (up + down);
        go(&k, t + up / 2);
        near(voltage(&k, 2), 3 - 2 * exp(-up / 2 / 1e-3), 3);
        go(&k, t + up + down / 2);
        near(voltage(&k, 2), low + (2 - low) * exp(-down / 2 / tau), 3);
    }
    end(&k);
}

/* 1 uF at 10 V and 3 uF at 2 V are put in parallel at 1 ms: 4 V, kept. */
static void test_jump(void **state) {
    (void)state;
    rig k = begin();
    ns_signal s = {.kind = NS_PULSE};
    s.u.pulse.v2 = 1;
    s.u.pulse.td = 1e-3;
    s.u.pulse.pw = 1;
    s.u.pulse.per = INFINITY;
    source(&k, "vg", 3, &s);
    capacitor(&k, "c1", 1, 0, 1e-6, 10);
    capacitor(&k, "c2", 2, 0, 3e-6, 2);
    contact(&k, "s", 1, 2, 3, 0.5, 0);
    ready(&k, 1e-4);
    go(&k, 0.9e-3);
    near(voltage(&k, 1), 10, 10);
    near(voltage(&k, 2), 2, 10);
    go(&k, 2e-3);
    near(voltage(&k, 1), 4, 10);
    near(voltage(&k, 2), 4, 10);
    assert_int_equal(ns_march_counts(k.m)->jumps, 1);
    end(&k);
}

/* Two closed switches side by side: each carries half; between two open ones nothing is known, and nothing
 * breaks. */
static void test_redundant(void **state) {
    (void)state;
    rig k = begin();
    constant(&k, "vin", 1, 10);
    constant(&k, "on", 5, 1);
    constant(&k, "off", 6, 0);
    contact(&k, "s1", 1, 2, 5, 0.5, 0);
    contact(&k, "s2", 1, 2, 5, 0.5, 0);
    contact(&k, "s3", 1, 3, 6, 0.5, 0);
    contact(&k, "s4", 3, 2, 6, 0.5, 0);
    resistor(&k, "r", 2, 4, 10);
    capacitor(&k, "c", 4, 0, 1e-6, 0);
    ready(&k, 1e-5);
    double lambda[4];
    go(&k, 1e-5);
    near(voltage(&k, 4), 10 * (1 - exp(-1)), 10);
    assert_int_equal(ns_march_read(k.m, NULL, NULL, lambda, NULL), NS_OK);
    near(lambda[0], exp(-1) / 2, 1);
    near(lambda[1], exp(-1) / 2, 1);
    near(lambda[2], 0, 1);
    end(&k);
}

/* --- starts, tries --- */

/* 10 V over 1 kohm onto a diode and 1 kohm: 5 V.  Held at 3 V it starts from there and goes to 5 V with
 * 500 ohm times 1 uF. */
static void test_dc(void **state) {
    (void)state;
    rig k = begin();
    constant(&k, "vin", 1, 10);
    resistor(&k, "r1", 1, 2, 1e3);
    diode(&k, "d", 2, 3);
    resistor(&k, "r2", 3, 0, 1e3);
    capacitor(&k, "c", 3, 0, 1e-6, NAN);
    make(&k, 1e-4);
    assert_int_equal(ns_march_start_dc(k.m, 0, 0, NULL, NULL, k.x), NS_OK);
    near(voltage(&k, 3), 5, 10);
    go(&k, 1e-3);
    near(voltage(&k, 3), 5, 10);
    const int hold = ns_circuit_node_unknown(k.c, 3);
    const double at = 3;
    assert_int_equal(ns_march_start_dc(k.m, 0, 1, &hold, &at, k.x), NS_OK);
    near(voltage(&k, 3), 3, 10);
    go(&k, 1e-3);
    near(voltage(&k, 3), 5 - 2 * exp(-2), 10);
    end(&k);
}

/* Times inside a long step: what is added to its begin again, t - begin, is not t for some of them. */
static void test_odd_times(void **state) {
    (void)state;
    rig k = begin();
    capacitor(&k, "c", 1, 0, 1e-6, 1);
    resistor(&k, "r", 1, 0, 1e6);
    make(&k, 1e-3);
    for (int j = 0; j < 16; j++) {
        const double from = 1e-4 / (3 + 0.01 * j);
        assert_int_equal(ns_circuit_rest(k.c, k.x), NS_OK);
        assert_int_equal(ns_march_start(k.m, from, k.x), NS_OK);
        for (int i = 0; i < 20; i++)
            go(&k, 1.7e-4 + i * 1e-6 / 7);
        near(voltage(&k, 1), exp(-(1.7e-4 + 19e-6 / 7 - from)), 1);
    }
    end(&k);
}

/* Whatever was tried and not accepted leaves no trace. */
static void test_trials(void **state) {
    (void)state;
    rig k = begin();
    int l;
    double reached, x[8], again[8];
    constant(&k, "vin", 1, 10);
    chopper(&k, 2, 0, &l);
    ready(&k, 1e-5);
    go(&k, 2e-6);
    assert_int_equal(ns_march_try(k.m, 3.5e-5, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_try(k.m, 4e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(k.m, NULL, x, NULL, NULL), NS_OK);
    assert_int_equal(ns_march_try(k.m, 2.5e-5, NS_TO_EVENT, &reached), NS_OK);
    near(reached, 3e-6, 1e-5);
    assert_int_equal(ns_march_try(k.m, 4e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(k.m, NULL, again, NULL, NULL), NS_OK);
    for (int i = 0; i < k.s->n; i++)
        near(again[i], x[i], 10);
    end(&k);
}

static void test_refused(void **state) {
    (void)state;
    rig k = begin();
    ns_march *m;
    double reached;
    const ns_march_options good = {.h = 1e-3, .method = NS_SPARSE}, zero = {.method = NS_SPARSE},
                           negative = {.h = 1, .reltol = -1, .method = NS_SPARSE};
    capacitor(&k, "c", 1, 0, 1e-6, 1);
    resistor(&k, "r", 1, 0, 1e3);
    make(&k, 1e-3);
    assert_int_equal(ns_march_create(k.s, &zero, &m, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_create(k.s, &negative, &m, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_create(NULL, &good, &m, NULL), NS_E_NULL);
    assert_null(m);
    assert_int_equal(ns_march_create(k.s, &good, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_try(k.m, 1, NS_TO_TIME, &reached), NS_E_STATE);
    assert_int_equal(ns_march_accept(k.m), NS_E_STATE);
    assert_int_equal(ns_march_read(k.m, NULL, NULL, NULL, NULL), NS_E_STATE);
    assert_int_equal(ns_march_start(k.m, NAN, k.x), NS_E_NUMBER);
    assert_int_equal(ns_march_start(k.m, 0, (const double[]){NAN}), NS_E_NUMBER);
    assert_int_equal(ns_march_start_dc(k.m, 0, 2, (const int[]){0, 1}, (const double[]){0, 0}, NULL),
                     NS_E_SIZE);
    assert_int_equal(ns_march_start_dc(k.m, 0, 1, (const int[]){1}, (const double[]){0}, NULL), NS_E_SIZE);
    assert_int_equal(ns_march_start(k.m, 0, k.x), NS_OK);
    assert_int_equal(ns_march_try(k.m, 0, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_fault(k.m)->status, NS_E_RANGE);
    ns_march_free(NULL);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decay),         cmocka_unit_test(test_inputs),
        cmocka_unit_test(test_stiff),         cmocka_unit_test(test_bridge),
        cmocka_unit_test(test_chopper),       cmocka_unit_test(test_many_choppers),
        cmocka_unit_test(test_some_choppers), cmocka_unit_test(test_discontinuous),
        cmocka_unit_test(test_slides),        cmocka_unit_test(test_slides_again),
        cmocka_unit_test(test_relaxation),    cmocka_unit_test(test_jump),
        cmocka_unit_test(test_redundant),     cmocka_unit_test(test_dc),
        cmocka_unit_test(test_odd_times),     cmocka_unit_test(test_trials),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
