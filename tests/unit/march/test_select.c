/* tests/unit/march/test_select.c - one engine hands over to another: the state goes on, switches stay as they
 * are.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "march/run_internal.h"
#include "nonsmooth.h"

/* 1 V, 1 kohm, 1 uF; across it a switch of 100 ohm that closes above 0.8 V and opens below 0.2 V.  From 0 it
 * charges as 1 - exp(-t/1 ms), to 0.8 V at t1 = ln 5 ms, then falls from there to 1/11 V with 1/11 ms. */
static const double t1 = 1.6094379124341003e-3, tau = 1e-3 / 11, end = 1. / 11;

static double falling(double since) {
    return end + (0.8 - end) * exp(-since / tau);
}

static ns_circuit *oscillator(void) {
    ns_circuit *c;
    ns_signal one = {.kind = NS_DC};
    const ns_switch contact = {0.5, 0.3, 100, INFINITY};
    one.u.dc = 1;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c", 2, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s", 2, 0, 2, 0, &contact, NULL), NS_OK);
    return c;
}

/* The circuit is one part: its march is one run. */
static ns_run *run_of(ns_march *m) {
    return (ns_run *)(void *)m->engine;
}

static void go(ns_march *m, double t) {
    double reached;
    assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
}

static void near(const ns_circuit *c, ns_march *m, double expected) {
    double x[8];
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    assert_true(fabs(x[ns_circuit_node_unknown(c, 2)] - expected) < 1e-7); /* legs good to 1e-9 */
}

/* Between its thresholds, closed: nothing but its past tells that. */
static void a_closed_switch_stays_closed(void **state) {
    (void)state;
    ns_circuit *c = oscillator();
    ns_system *s;
    ns_march *m;
    double w0[8] = {0};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_SPARSE};
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 8);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    go(m, t1 + 0.5 * tau);
    near(c, m, falling(0.5 * tau));
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    assert_int_equal(ns_march_run_leave_sparse(run_of(m)), NS_OK);
    assert_int_equal(ns_march_engine(m), NS_EXACT);
    go(m, t1 + tau);
    near(c, m, falling(tau));
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* What left the sparse engine comes back to it, with its switches as they are, after 64 h. */
static void it_comes_back(void **state) {
    (void)state;
    ns_circuit *c = oscillator();
    ns_system *s;
    ns_march *m;
    double w0[8] = {0};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_SPARSE, .reltol = 1e-11};
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    run_of(m)->options.method = NS_AUTO; /* which would not take it for so small a circuit */
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    go(m, t1 + 0.3 * tau);
    const long events = ns_march_counts(m)->events;
    const ns_work work = ns_engine_work(run_of(m)->at_work), *before = &run_of(m)->work_before;
    assert_int_equal(ns_march_run_leave_sparse(run_of(m)), NS_OK);
    assert_true(work.all > work.once && work.once > 0 && work.events > 0); /* it stays known */
    assert_true(before->all >= work.all && before->all < 1.01 * work.all); /* it is read once more */
    assert_true(before->once == work.once && before->events == work.events);
    go(m, t1 + 0.3 * tau + 63e-7);
    assert_int_equal(ns_march_engine(m), NS_EXACT);
    go(m, t1 + 0.3 * tau + 65e-7);
    assert_int_equal(ns_march_engine(m), NS_EXACT); /* to there */
    go(m, t1 + tau);
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    near(c, m, falling(tau)); /* it is still closed */
    assert_int_equal(ns_march_counts(m)->events, events);
    assert_int_equal(ns_march_run_leave_sparse(run_of(m)), NS_OK); /* now for four times as long */
    go(m, t1 + tau + 255e-7);
    go(m, t1 + 1.3 * tau);
    assert_int_equal(ns_march_engine(m), NS_EXACT);
    near(c, m, falling(1.3 * tau));
    go(m, t1 + 1.4 * tau);
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

static const char *named(char kind, char *name) {
    name[0] = kind;
    return name;
}

/* Ten cells of 100 ohm and 10 nF, a load of 1 kohm behind a switch at each.  Gates of periods without a
 * common one, so that modes hardly ever come again; or (common) of periods of 20, 40 and 80 us, begun at odd
 * times, so that each of the first 50 events, 80 us, comes to a new one and those after to the same again. */
static ns_circuit *ladder(int common) {
    enum { CELLS = 10, GATE = 21 };
    ns_circuit *c;
    ns_signal s = {.kind = NS_DC};
    const ns_switch contact = {0.5, 0, 0, INFINITY};
    s.u.dc = 10;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, GATE, 0, &s, NULL), NS_OK);
    s.kind = NS_PULSE;
    s.u.pulse.v1 = s.u.pulse.td = s.u.pulse.tr = s.u.pulse.tf = s.u.pulse.cycles = 0;
    s.u.pulse.v2 = 1;
    for (int k = 1; k <= CELLS; k++) {
        char name[] = "va";
        name[1] = (char)('a' + k);
        s.u.pulse.per = common ? 20e-6 * (1 << k % 3) : 20e-6 * sqrt(k + 1.5);
        s.u.pulse.td = common ? -s.u.pulse.per * fmod(0.618 * k, 1) : 0;
        s.u.pulse.pw = s.u.pulse.per / 2;
        assert_int_equal(ns_circuit_source(c, named('v', name), NS_VOLTAGE, GATE + k, 0, &s, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, named('r', name), k == 1 ? GATE : k - 1, k, 100, NULL),
                         NS_OK);
        assert_int_equal(ns_circuit_capacitor(c, named('c', name), k, 0, 10e-9, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, named('l', name), k, CELLS + k, 1e3, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(c, named('s', name), CELLS + k, 0, GATE + k, 0, &contact, NULL),
                         NS_OK);
    }
    return c;
}

/* Matrices of modes that do not recur are not worth their while: auto, which took exact, turns to sparse. */
static void modes_that_do_not_recur(void **state) {
    (void)state;
    ns_circuit *c = ladder(0);
    ns_system *s;
    ns_march *m[2];
    double x[2][80], w0[80] = {0};
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 80);
    for (int k = 0; k < 2; k++) {
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = k ? NS_AUTO : NS_EXACT};
        assert_int_equal(ns_march_create(s, &o, &m[k], NULL), NS_OK);
        assert_int_equal(ns_march_start(m[k], 0, w0), NS_OK);
        assert_int_equal(ns_march_engine(m[k]), NS_EXACT);
        for (int i = 1; i <= 80; i++) /* 8 events each */
            go(m[k], i * 20e-6);
        assert_int_equal(ns_march_read(m[k], NULL, x[k], NULL, NULL), NS_OK);
    }
    assert_int_equal(ns_march_engine(m[0]), NS_EXACT);
    assert_int_equal(ns_march_engine(m[1]), NS_SPARSE);
    for (int k = 1; k <= 10; k++) {
        const int at = ns_circuit_node_unknown(c, k);
        assert_true(fabs(x[0][at] - x[1][at]) < 1e-7); /* of 10 V, by legs good to 1e-9 */
    }
    assert_int_equal(ns_march_counts(m[0])->events, ns_march_counts(m[1])->events);
    for (int k = 0; k < 2; k++)
        ns_march_free(m[k]);
    ns_system_free(s);
    ns_circuit_free(c);
}

static double work_of_ladder(ns_method method, int steps, ns_method ends_by) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    ns_circuit *c = ladder(1);
    ns_system *s;
    ns_march *m;
    const double w0[80] = {0};
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    for (int i = 1; i <= steps; i++)
        go(m, i * 20e-6);
    assert_int_equal(ns_march_engine(m), ends_by);
    if (method == NS_EXACT)
        assert_true(ns_march_counts(m)->modes > 32);
    const double work = ns_march_run_work((ns_run *)(void *)m->engine).all;
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    return work;
}

/* That the first events come to modes never seen before says nothing: 42 modes recur for good.  To find that
 * out, and to make their matrices late, costs less than the better engine alone, or half of it where the run
 * is longer. */
static void modes_that_recur_later(void **state) {
    (void)state;
    const double exact = work_of_ladder(NS_EXACT, 40, NS_EXACT),
                 sparse = work_of_ladder(NS_SPARSE, 40, NS_SPARSE);
    assert_true(work_of_ladder(NS_AUTO, 40, NS_EXACT) < 2 * fmin(exact, sparse));
    assert_true(work_of_ladder(NS_AUTO, 160, NS_EXACT) < 1.5 * work_of_ladder(NS_EXACT, 160, NS_EXACT));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_closed_switch_stays_closed), cmocka_unit_test(it_comes_back),
        cmocka_unit_test(modes_that_do_not_recur), cmocka_unit_test(modes_that_recur_later)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
