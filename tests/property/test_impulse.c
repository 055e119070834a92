/* tests/property/test_impulse.c - the impulse problem: jumps with closed forms. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "net.h"
#include "wrap_alloc.h"

/* Rounding of a handful of operations. */
void near(double got, double expected, double scale) {
    if (!(fabs(got - expected) <= 1e-12 * scale))
        print_message("got %.17g, expected %.17g\n", got, expected);
    assert_true(fabs(got - expected) <= 1e-12 * scale);
}

/* 1 uF at 10 V and 3 uF at 2 V: 16 uC on 4 uF, 4 V; 6 uC have passed. */
static void capacitor_onto_capacitor(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) { /* a switch; a diode; one that blocks */
        net k = net_begin();
        net_capacitor(&k, "c1", 1, 0, 1e-6, 10);
        net_capacitor(&k, "c2", 2, 0, 3e-6, 2);
        const int id = kind == 0   ? net_contact(&k, "s", 1, 2, 1)
                       : kind == 1 ? net_diode(&k, "d", 1, 2)
                                   : net_diode(&k, "d", 2, 1);
        net_jumps(&k);
        near(net_voltage_of(&k, k.x, 1), kind < 2 ? 4 : 10, 10);
        near(net_voltage_of(&k, k.x, 2), kind < 2 ? 4 : 2, 10);
        near(net_device_of(&k, k.X, k.Lambda, id), kind < 2 ? 6e-6 : 0, 16e-6);
        near(net_device_of(&k, k.x, k.lambda, id), 0, 1);
        net_end(&k);
    }
}

/* 2 uF at 1 V pulled to 5 V by a source through a diode: 8 uC out of the source; then a rising source, 1
 * V/us, keeps driving 2 A. */
static void capacitor_onto_source(void **state) {
    (void)state;
    net k = net_begin();
    const int v = net_voltage(&k, "v", 1, 0, 5);
    const int d = net_diode(&k, "d", 1, 2);
    net_capacitor(&k, "c", 2, 0, 2e-6, 1);
    net_prepare(&k);
    const double slope[1] = {1e6};
    assert_int_equal(k.s->nz, 1);
    assert_int_equal(net_jump(&k, slope), NS_OK);
    near(net_voltage_of(&k, k.x, 2), 5, 5);
    near(net_device_of(&k, k.X, k.Lambda, d), 8e-6, 8e-6);
    near(net_current_of(&k, k.X, v), -8e-6, 8e-6);
    near(net_device_of(&k, k.x, k.lambda, d), 2, 2);
    near(net_current_of(&k, k.x, v), -2, 2);
    const double falling[1] = {-1e6}; /* and a falling one lets the diode block */
    assert_int_equal(net_jump(&k, falling), NS_OK);
    near(net_device_of(&k, k.X, k.Lambda, d), 8e-6, 8e-6);
    near(net_device_of(&k, k.x, k.lambda, d), 0, 2);
    net_end(&k);
}

/* A source of 1 V cannot charge 1 uF at 5 V through a diode, nor empty it. */
static void diode_against_the_source(void **state) {
    (void)state;
    net k = net_begin();
    const int v = net_voltage(&k, "v", 1, 0, 1), d = net_diode(&k, "d", 1, 2);
    net_capacitor(&k, "c", 2, 0, 1e-6, 5);
    net_jumps(&k);
    near(net_voltage_of(&k, k.x, 2), 5, 5);
    assert_true(net_device_of(&k, k.X, k.Lambda, d) == 0 && net_current_of(&k, k.X, v) == 0);
    net_end(&k);
}

/* At the source's voltage already: 2 uF follow a rise of 1 V/us with 2 A from the first instant on, although
 * nothing jumps and the diode carried nothing; a fall leaves them behind. */
static void capacitor_at_the_source(void **state) {
    (void)state;
    for (int sign = -1; sign < 2; sign += 2) {
        net k = net_begin();
        net_voltage(&k, "v", 1, 0, 5);
        const int d = net_diode(&k, "d", 1, 2);
        const double slope = sign * 1e6;
        net_capacitor(&k, "c", 2, 0, 2e-6, 5);
        net_prepare(&k);
        assert_int_equal(net_jump(&k, &slope), NS_OK);
        near(net_device_of(&k, k.x, k.lambda, d), sign > 0 ? 2 : 0, 2);
        near(net_device_of(&k, k.X, k.Lambda, d), 0, 1e-6);
        net_end(&k);
    }
}

/* Sources of 7 V and 4 V at once, each through a diode onto its capacitor of 1 uF (at 1 V and 2 V), a third
 * diode between these: the first goes to 7 V and takes the second along, whose own source is left behind. */
static void two_sources_at_once(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v1", 1, 0, 7);
    net_voltage(&k, "v2", 2, 0, 4);
    const int a = net_diode(&k, "d1", 1, 3), b = net_diode(&k, "d2", 2, 4), c = net_diode(&k, "d3", 3, 4);
    net_capacitor(&k, "c1", 3, 0, 1e-6, 1);
    net_capacitor(&k, "c2", 4, 0, 1e-6, 2);
    net_jumps(&k);
    near(net_voltage_of(&k, k.x, 3), 7, 7);
    near(net_voltage_of(&k, k.x, 4), 7, 7);
    near(net_device_of(&k, k.X, k.Lambda, a), 11e-6, 11e-6);
    near(net_device_of(&k, k.X, k.Lambda, b), 0, 11e-6);
    near(net_device_of(&k, k.X, k.Lambda, c), 5e-6, 11e-6);
    net_end(&k);
}

/* 1 mH at 2 A, interrupted, with a diode across: the current goes on in it, nothing jumps. */
static void freewheel(void **state) {
    (void)state;
    net k = net_begin();
    const int l = net_inductor(&k, "l", 1, 0, 1e-3, 2), d = net_diode(&k, "d", 0, 1);
    net_voltage(&k, "v", 2, 0, 10);
    net_contact(&k, "s", 2, 1, 0);
    net_jumps(&k);
    near(net_current_of(&k, k.x, l), 2, 2);
    near(net_device_of(&k, k.x, k.lambda, d), 2, 2);
    near(net_voltage_of(&k, k.X, 1), 0, 1e-3);
    near(net_voltage_of(&k, k.x, 1), 0, 10);
    net_end(&k);
}

/* 1 uF 10 V -> 1 uF 20 V -> 2 uF 0 V.  At first sight only the second diode conducts; but 20 V on 3 uF come
 * to 6.67 V, below 10 V: all three share 30 uC on 4 uF, 7.5 V; 2.5 uC and 15 uC pass.  With 4 V in place of
 * 10 V the first one blocks. */
static void chain_of_capacitors(void **state) {
    (void)state;
    for (int first = 0; first < 2; first++) {
        net k = net_begin();
        net_capacitor(&k, "c1", 1, 0, 1e-6, first ? 4 : 10);
        net_capacitor(&k, "c2", 2, 0, 1e-6, 20);
        net_capacitor(&k, "c3", 3, 0, 2e-6, 0);
        const int a = net_diode(&k, "d1", 1, 2), b = net_diode(&k, "d2", 2, 3);
        net_resistor(&k, "r", 1, 3, 1);
        net_jumps(&k);
        near(net_voltage_of(&k, k.x, 1), first ? 4 : 7.5, 20);
        near(net_voltage_of(&k, k.x, 2), first ? 20 / 3. : 7.5, 20);
        near(net_voltage_of(&k, k.x, 3), first ? 20 / 3. : 7.5, 20);
        near(net_device_of(&k, k.X, k.Lambda, a), first ? 0 : 2.5e-6, 15e-6);
        near(net_device_of(&k, k.X, k.Lambda, b), first ? 40e-6 / 3 : 15e-6, 15e-6);
        net_end(&k);
    }
}

/* 1 mH at 2 A into a node, 3 mH at 1 A out of it, the switch that carried the rest opens: 5 mWb on 4 mH. */
static void inductor_into_inductor(void **state) {
    (void)state;
    net k = net_begin();
    const int a = net_inductor(&k, "l1", 0, 1, 1e-3, 2), b = net_inductor(&k, "l2", 1, 0, 3e-3, 1);
    net_contact(&k, "s", 1, 0, 0);
    net_jumps(&k);
    near(net_current_of(&k, k.x, a), 1.25, 2);
    near(net_current_of(&k, k.x, b), 1.25, 2);
    near(net_voltage_of(&k, k.X, 1), 0.75e-3, 1e-3);
    near(net_voltage_of(&k, k.x, 1), 0, 1); /* nothing drives them on */
    net_end(&k);
}

/* An interrupted inductor finds a clamp: no jump, the diode takes the current.  With a resistor of 1 kohm in
 * its way there is none either, only 2 kV. */
static void inductor_into_clamp(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        net k = net_begin();
        const int l = net_inductor(&k, "l", 0, 1, 1e-3, 2);
        net_contact(&k, "s", 1, 0, 0);
        if (kind)
            net_resistor(&k, "r", 1, 0, 1e3);
        else
            net_diode(&k, "d", 1, 2);
        net_capacitor(&k, "c", 2, 0, 1e-6, 5);
        net_jumps(&k);
        near(net_current_of(&k, k.x, l), 2, 2);
        near(net_voltage_of(&k, k.x, 1), kind ? 2000 : 5, kind ? 2000 : 5);
        near(net_voltage_of(&k, k.x, 2), 5, 5);
        near(net_voltage_of(&k, k.X, 1), 0, 1e-3);
        near(k.lambda[k.s->m - 1], kind ? k.lambda[k.s->m - 1] : 2, 2);
        net_end(&k);
    }
}

/* 4 mH at 1 A interrupted; 1 mH with K = 0.5 (M = 1 mH) behind a diode takes M i1 = 1 mWb: 1 A.  With K = 1
 * (M = 2 mH) all of it, 2 A, and no flux is left over. */
static void transformer(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        net k = net_begin();
        const int a = net_inductor(&k, "l1", 1, 0, 4e-3, 1), b = net_inductor(&k, "l2", 0, 2, 1e-3, 0);
        assert_int_equal(ns_circuit_coupling(k.c, "k1", a, b, kind ? 1 : -0.5, NULL), NS_OK);
        net_contact(&k, "s", 1, 0, 0);
        net_diode(&k, "d", kind ? 2 : 3, kind ? 3 : 2);
        net_resistor(&k, "r", 3, 0, 50);
        net_jumps(&k);
        near(net_current_of(&k, k.x, a), 0, 1);
        near(net_current_of(&k, k.x, b), kind ? 2 : -0.5 * 4e-3 * 0.5 / 1e-3, 2);
        near(fabs(net_voltage_of(&k, k.x, 3)), kind ? 100 : 50, 100);
        net_end(&k);
    }
}

/* The bridge with filter of the literature: 1 uF at 10 V, 0.3 uF across the load: 10/1.3 V. */
static void bridge_with_filter(void **state) {
    (void)state;
    net k = net_begin();
    net_capacitor(&k, "c", 1, 2, 1e-6, 10);
    const int l = net_inductor(&k, "l", 1, 2, 1e-2, 0);
    net_resistor(&k, "r", 3, 4, 1e3);
    net_capacitor(&k, "cf", 3, 4, 0.3e-6, 0);
    net_diode(&k, "d1", 1, 3);
    net_diode(&k, "d2", 2, 3);
    net_diode(&k, "d3", 4, 2);
    net_diode(&k, "d4", 4, 1);
    net_resistor(&k, "earth", 4, 0, 1);
    net_jumps(&k);
    near(net_voltage_of(&k, k.x, 1) - net_voltage_of(&k, k.x, 2), 10 / 1.3, 10);
    near(net_voltage_of(&k, k.x, 3) - net_voltage_of(&k, k.x, 4), 10 / 1.3, 10);
    near(net_current_of(&k, k.x, l), 0, 1);
    net_end(&k);
}

/* Two closed switches in parallel: what passes is determined, how they share it is not; equal shares. */
static void parallel_switches_share(void **state) {
    (void)state;
    net k = net_begin();
    net_capacitor(&k, "c1", 1, 0, 1e-6, 10);
    net_capacitor(&k, "c2", 2, 0, 3e-6, 2);
    const int a = net_contact(&k, "s1", 1, 2, 1), b = net_contact(&k, "s2", 1, 2, 1);
    net_jumps(&k);
    near(net_voltage_of(&k, k.x, 1), 4, 10);
    near(net_device_of(&k, k.X, k.Lambda, a), 3e-6, 6e-6);
    near(net_device_of(&k, k.X, k.Lambda, b), 3e-6, 6e-6);
    net_end(&k);
}

/* What is consistent stays, to the last bits, and has no impulses at all. */
static void consistent_stays(void **state) {
    (void)state;
    net k = net_begin();
    net_capacitor(&k, "c1", 1, 0, 1e-6, 4);
    net_capacitor(&k, "c2", 2, 0, 3e-6, 4);
    net_contact(&k, "s1", 1, 2, 1);
    net_inductor(&k, "l", 1, 0, 1e-3, 0.5);
    net_jumps(&k);
    near(net_voltage_of(&k, k.x, 2), 4, 4);
    for (int i = 0; i < k.s->n; i++)
        assert_true(k.X[i] == 0);
    assert_true(k.Lambda[0] == 0);
    net_end(&k);
}

static void no_answer_is_told(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v1", 1, 0, 5);
    net_voltage(&k, "v2", 2, 0, 3);
    net_diode(&k, "d", 1, 2);
    net_capacitor(&k, "c", 2, 0, 1e-6, 0);
    net_prepare(&k);
    k.x[0] = 77;
    assert_int_equal(net_jump(&k, NULL), NS_E_INFEASIBLE);
    assert_true(k.x[0] == 77);
    const ns_fault *f = ns_theta_fault(k.step);
    assert_int_equal(f->status, NS_E_INFEASIBLE);
    assert_int_equal(f->npairs, 1);
    assert_int_equal(f->pair[0], 0);
    net_end(&k);
}

static void bad_input_is_refused(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v1", 1, 0, 5);
    net_capacitor(&k, "c", 1, 0, 1e-6, 0);
    net_prepare(&k);
    const ns_impulse out = {0};
    const double nan = NAN;
    assert_int_equal(ns_theta_impulse(NULL, k.z, NULL, &out), NS_E_NULL);
    assert_int_equal(ns_theta_impulse(k.step, NULL, NULL, &out), NS_E_NULL);
    assert_int_equal(ns_theta_impulse(k.step, k.z, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_theta_impulse(k.step, &nan, NULL, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(k.step, k.z, &nan, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(k.step, k.z, NULL, &out), NS_OK); /* nothing asked for, nothing given */
    net_end(&k);
}

/* Whatever allocation fails: told, nothing handed out, and the next call answers as if nothing had been. */
static void memory_fails(void **state) {
    (void)state;
    net k = net_begin();
    net_capacitor(&k, "c1", 1, 0, 1e-6, 10);
    net_capacitor(&k, "c2", 2, 0, 3e-6, 2);
    net_diode(&k, "d", 1, 2);
    net_resistor(&k, "r", 1, 0, 1);
    net_prepare(&k);
    long at = 1;
    for (;; at++) {
        k.x[0] = 77;
        fail_alloc_at(at);
        const int status = net_jump(&k, NULL);
        const long made = allocs_made();
        fail_alloc_off();
        if (made < at) {
            assert_int_equal(status, NS_OK);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_int_equal(ns_theta_fault(k.step)->status, NS_E_MEMORY);
        assert_true(k.x[0] == 77);
        assert_int_equal(net_jump(&k, NULL), NS_OK);
        near(net_voltage_of(&k, k.x, 1), 4, 10);
    }
    assert_true(at > 20); /* both problems were met */
    near(net_voltage_of(&k, k.x, 2), 4, 10);
    net_end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(capacitor_onto_capacitor), cmocka_unit_test(capacitor_onto_source),
        cmocka_unit_test(diode_against_the_source), cmocka_unit_test(capacitor_at_the_source),
        cmocka_unit_test(two_sources_at_once),      cmocka_unit_test(freewheel),
        cmocka_unit_test(chain_of_capacitors),      cmocka_unit_test(inductor_into_inductor),
        cmocka_unit_test(inductor_into_clamp),      cmocka_unit_test(transformer),
        cmocka_unit_test(bridge_with_filter),       cmocka_unit_test(parallel_switches_share),
        cmocka_unit_test(consistent_stays),         cmocka_unit_test(no_answer_is_told),
        cmocka_unit_test(bad_input_is_refused),     cmocka_unit_test(memory_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
