/* tests/unit/circuit/test_tiny_resistor.c - which resistors get a row and a current of their own. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/circuit.h"
#include "wrap_alloc.h"

static ns_circuit *made;

static int resistor(const char *name, int p, int n, double ohm) {
    int id;
    assert_int_equal(ns_circuit_resistor(made, name, p, n, ohm, &id), NS_OK);
    return id;
}

/* Each test: the resistors first, then how many of them have currents among the unknowns. */
static void begin(void) {
    assert_int_equal(ns_circuit_create(&made), NS_OK);
}

static void expect(int nodes, int currents) {
    ns_system *s;
    assert_int_equal(ns_circuit_system(made, &s), NS_OK);
    assert_int_equal(s->n, nodes + currents);
    ns_system_free(s);
}

static void end(void) {
    ns_circuit_free(made);
}

static void beside_another_resistor(void **state) {
    static const double other[] = {0.9e6, 1.1e6, -1.1e6};
    (void)state;
    for (int k = 0; k < 3; k++) {
        begin();
        const int one = resistor("r1", 1, 2, 1), high = resistor("r2", 2, 0, other[k]);
        expect(2, k > 0);
        assert_int_equal(ns_circuit_current_unknown(made, one), k > 0 ? 2 : -1);
        assert_int_equal(ns_circuit_current_unknown(made, high), -1);
        end();
    }
}

/* At ground nothing is summed up; at either other end it is. */
static void at_one_end(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        begin();
        (void)resistor("r1", k ? 0 : 1, k ? 1 : 0, 1e-3);
        (void)resistor("r2", 2, 0, 1e9);
        expect(2, 0);
        (void)resistor("r3", k ? 2 : 1, k ? 1 : 2, 1);
        expect(2, 2); /* r3 beside r2; and r1, which is smaller than it */
        end();
    }
}

/* 0.9e-6 S beside 1 S makes that one tiny; with it all down to 1e-3 S are, anywhere. */
static void others_of_that_size(void **state) {
    static const double elsewhere[] = {0.99e3, 1.01e3};
    (void)state;
    for (int k = 0; k < 2; k++) {
        begin();
        (void)resistor("r1", 1, 2, 1);
        (void)resistor("r2", 2, 0, 1.2e6);
        (void)resistor("r3", 3, 0, elsewhere[k]);
        expect(3, k == 0 ? 2 : 1);
        end();
    }
}

/* A leak counts a million times as much; the resistance of what conducts counts as it is. */
static void beside_devices(void **state) {
    static const struct {
        double ron, roff;
        int currents;
    } of[] = {{0, INFINITY, 0}, {0, 1.2e6, 0},        {0, 0.9e12, 0},
              {0, 1.1e12, 1},   {0.9e6, INFINITY, 0}, {1.1e6, INFINITY, 1}};
    (void)state;
    for (int k = 0; k < 12; k++) {
        const ns_diode d = {.ron = of[k / 2].ron, .roff = of[k / 2].roff, .vz = INFINITY};
        const ns_switch s = {.ron = of[k / 2].ron, .roff = of[k / 2].roff, .vt = 1};
        begin();
        (void)resistor("r1", 1, 2, 1);
        (void)resistor("r2", 1, 0, 1);
        if (k % 2)
            assert_int_equal(ns_circuit_diode(made, "d1", 2, 0, &d, NULL), NS_OK);
        else
            assert_int_equal(ns_circuit_switch(made, "s1", 2, 0, 1, 0, &s, NULL), NS_OK);
        expect(2, of[k / 2].currents * 2);
        end();
    }
}

/* Two nodes between which something gives the voltage, whatever the current, count as one; so do those
 * between which a device conducts well when it conducts. */
static void behind_what_has_no_resistance(void **state) {
    enum { IDEAL_DIODE, IDEAL_SWITCH, SOURCE, ZERO_OHM, SOME_DIODE, SOME_SWITCH, COIL, KINDS };
    static const int own[KINDS] = {0, 0, 1, 1, 0, 0, 1}; /* currents among the unknowns */
    const ns_signal one = {.kind = NS_DC, .u.dc = 1};
    (void)state;
    for (int k = 0; k < 2 * KINDS; k++) {
        const int kind = k / 2, p = k % 2 ? 3 : 2, n = k % 2 ? 2 : 3;
        const ns_diode d = {.ron = kind == SOME_DIODE ? 1 : 0, .roff = INFINITY, .vz = INFINITY};
        const ns_switch s = {.ron = kind == SOME_SWITCH ? 1 : 0, .roff = INFINITY, .vt = 1};
        begin();
        (void)resistor("r1", 1, 2, 1);
        if (kind == IDEAL_DIODE || kind == SOME_DIODE)
            assert_int_equal(ns_circuit_diode(made, "d1", p, n, &d, NULL), NS_OK);
        else if (kind == IDEAL_SWITCH || kind == SOME_SWITCH)
            assert_int_equal(ns_circuit_switch(made, "s1", p, n, 1, 0, &s, NULL), NS_OK);
        else if (kind == SOURCE)
            assert_int_equal(ns_circuit_source(made, "v1", NS_VOLTAGE, p, n, &one, NULL), NS_OK);
        else if (kind == ZERO_OHM)
            (void)resistor("r3", p, n, 0);
        else
            assert_int_equal(ns_circuit_inductor(made, "l1", p, n, 1, 0, NULL), NS_OK);
        (void)resistor("r2", 3, 0, 1.1e6);
        expect(3, own[kind] + (kind != COIL)); /* 1 S is large beside 1 / 1.1e6 S */
        end();
    }
}

/* Of three in a row none is a million times its neighbour; the first is that of the third, and of both others
 * where these are as small. */
static void behind_one_of_a_size_between(void **state) {
    static const struct {
        double between, last;
        int currents;
    } of[] = {
        {1.01e3, 0.9e6, 0}, {1.01e3, 1.1e6, 1}, {0.99e3, 1.1e6, 2}, {0.9e6, 1.1e6, 1}, {0.9e6, 0.9e12, 1}};
    (void)state;
    for (int k = 0; k < 5; k++) {
        begin();
        (void)resistor("r3", 3, 0, of[k].last);
        (void)resistor("r1", 1, 2, 1);
        (void)resistor("r2", 2, 3, of[k].between);
        expect(3, of[k].currents);
        end();
    }
}

/* Tiny is not zero: the gate behind 1 ohm follows its driver by 1 us (R C), and a pull-down of 1 ohm at the
 * driver does not hold it at 0 V. */
static void is_no_short_to_a_control(void **state) {
    static const ns_switch contact = {0.5, 0, 0, INFINITY};
    const ns_signal pulse = {.kind = NS_PULSE, .u.pulse = {0, 1, 0, 1e-6, 1e-6, 4e-6, 1e-5, 0}};
    (void)state;
    for (int order = 0; order < 2; order++) {
        ns_system *s;
        begin();
        for (int k = 0; k < 2; k++)
            if (k == order)
                assert_int_equal(ns_circuit_source(made, "v1", NS_VOLTAGE, 1, 0, &pulse, NULL), NS_OK);
            else
                (void)resistor("r1", 1, 0, 1);
        (void)resistor("r2", 1, 2, 1);
        (void)resistor("r3", 3, 4, 1e-3);
        (void)resistor("r4", 4, 0, 1e6);
        assert_int_equal(ns_circuit_capacitor(made, "c1", 2, 0, 1e-6, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(made, "as1", 3, 0, 1, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(made, "as2", 3, 0, 2, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(made, &s), NS_OK);
        assert_int_equal(s->n, 4 + 1 + 3); /* nodes, v1, tiny resistors */
        assert_true(!s->command[0].gx && s->command[0].gz && s->command[0].gz[0] == 1);
        assert_true(s->command[1].gx && s->command[1].gx[1] == 1 && !s->command[1].gz);
        ns_system_free(s);
        end();
    }
}

static void no_memory(void **state) {
    ns_system *s;
    (void)state;
    begin();
    (void)resistor("r1", 1, 2, 1);
    (void)resistor("r2", 2, 0, 1e9);
    for (long k = 1;; k++) {
        fail_alloc_at(k);
        const int status = ns_circuit_system(made, &s);
        const long tried = allocs_made();
        fail_alloc_off();
        if (tried < k)
            break;
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(s);
    }
    assert_int_equal(s->n, 3);
    ns_system_free(s);
    end();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beside_another_resistor),       cmocka_unit_test(at_one_end),
        cmocka_unit_test(others_of_that_size),           cmocka_unit_test(beside_devices),
        cmocka_unit_test(behind_what_has_no_resistance), cmocka_unit_test(behind_one_of_a_size_between),
        cmocka_unit_test(is_no_short_to_a_control),      cmocka_unit_test(no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
