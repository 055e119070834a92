/* tests/unit/sparse/test_switched.c - the sparse marcher on circuits that switch, against closed forms. */
#include "parts.h"

#include <stdio.h>

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

/* NS_AUTO takes the sparse engine for s, the scheme its own steps, if theta = gamma; exact takes it not. */
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
    o.method = NS_EXACT;
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
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_EXACT};
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
    assert_int_equal(ns_march_engine(k.m), NS_EXACT);
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

/* 20 V through a switch that closes while ref > out, 2.5 ohm to ground, 100 uH, 10 ohm, no hysteresis. */
static rig sliding(const ns_signal *ref) {
    static const ns_switch sw = {0, 0, 0, INFINITY};
    rig k = begin();
    constant(&k, "vin", 1, 20);
    source(&k, "vr", 4, ref);
    assert_int_equal(ns_circuit_switch(k.c, "s", 1, 2, 4, 3, &sw, NULL), NS_OK);
    resistor(&k, "rf", 2, 0, 2.5);
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

/* ref falls from 5 V to 2 V in 1 ns at 1 ms: out cannot follow, it falls with 8 us, and slides again from
 * 8 us ln 2.5 on.  Then ref rises to 8 V at 2 ms: out rises towards 20 V and meets it after 10 us ln 1.5. */
static void test_slides_again(void **state) {
    (void)state;
    const double at[] = {0, 1e-3, 1.000001e-3, 2e-3, 2.000001e-3}, volts[] = {5, 5, 2, 2, 8}, tau = 8e-6;
    ns_signal ref = {.kind = NS_PWL};
    ref.u.pwl.n = 5;
    ref.u.pwl.t = at;
    ref.u.pwl.v = volts;
    ref.u.pwl.repeat = NAN;
    rig k = sliding(&ref);
    go(&k, 0.9e-3);
    near(voltage(&k, 3), 5, 1);
    /* the ramps delay it by 1 ns at most: of 5 V, falling with 8 us, 6e-4 V; of 18 V 2e-3 V */
    for (int i = 1; i < 8; i++) {
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

/* y = z and nothing else, by (S3): y falls from 1 to -1 in 1 s, so lambda, 0 until 0.5 s, is 2 (t - 0.5)
 * then, as D = 1.  The charge follows: w' = lambda. */
static void a_source_alone_breaks_a_guard(void **state) {
    (void)state;
    const double t[] = {0, 1}, v[] = {1, -1};
    const ns_signal ramp = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = v, .repeat = NAN}};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-2, .method = NS_SPARSE, .reltol = 1e-9};
    ns_system *s;
    ns_march *m;
    double reached, x, lambda;
    const double w0 = 0;
    assert_int_equal(ns_system_create(1, 1, 1, 0, &s), NS_OK);
    assert_int_equal(ns_system_set_input(s, 0, &ramp), NS_OK);
    s->M[0] = s->B[0] = s->D[0] = s->F[0] = 1;
    s->l[0] = 0;
    s->u[0] = INFINITY;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, &w0), NS_OK);
    assert_int_equal(ns_march_try(m, 1, NS_TO_EVENT, &reached), NS_OK);
    near(reached, 0.5, 1);
    assert_int_equal(ns_march_accept(m), NS_OK);
    assert_int_equal(ns_march_try(m, 1, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, &x, &lambda, NULL), NS_OK);
    near(lambda, 1, 1);
    near(x, 0.25, 1);
    ns_march_free(m);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_chopper),       cmocka_unit_test(a_source_alone_breaks_a_guard),
        cmocka_unit_test(test_many_choppers), cmocka_unit_test(test_some_choppers),
        cmocka_unit_test(test_discontinuous), cmocka_unit_test(test_slides),
        cmocka_unit_test(test_slides_again),  cmocka_unit_test(test_relaxation),
        cmocka_unit_test(test_jump),          cmocka_unit_test(test_redundant),
        cmocka_unit_test(test_trials),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
