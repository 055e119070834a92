/* tests/unit/waveform/test_integrals.c - the integrals that points of a waveform carry: charge and energy, in
 * closed form, through a jump, a stretch without points, and none when they were dropped.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"

static int begin(void *data, ns_march *m, int starts) {
    return starts ? ns_energy_start(data, m) : ns_energy_begin_at(data, m);
}

static int take(void *data, ns_march *m, double t) {
    return ns_energy_take(data, m, t);
}

static void read_sums(void *data, double *sums) {
    assert_int_equal(ns_energy_read(data, 0, NULL, &sums[0], &sums[1]), NS_OK);
}

/* 1 F at 10 V into 1 ohm; at 1 s a switch joins 1 F at 0 V: half the voltage, and half the rate. */
static double volts(double t) {
    return t < 1 ? 10 * exp(-t) : 5 * exp(-1 - (t - 1) / 2);
}

static double charge(double t) {
    return t < 1 ? 10 - volts(t) : 10 - 10 * exp(-1) + 2 * (5 * exp(-1) - volts(t));
}

static double joule(double t) {
    const double before = 50 * (1 - exp(-2)), after = 5 * exp(-1) * 5 * exp(-1) - volts(t) * volts(t);
    return t < 1 ? 50 * (1 - exp(-2 * t)) : before + after;
}

static void charges_and_energies(void **state) {
    (void)state;
    static const ns_method method[] = {NS_EXACT, NS_SPARSE};
    for (int k = 0; k < 4; k++) {
        const int skips = k / 2;
        const ns_signal gate = pulse(0, 1, 1, 0, 0, 9, INFINITY);
        const ns_switch contact = {0.5, 0, 0, INFINITY};
        const ns_march_options o = {
            .theta = 1, .gamma = 1, .h = 1e-2, .method = method[k % 2], .reltol = 1e-11};
        ns_circuit *c;
        ns_system *s;
        ns_march *m;
        ns_energy *e;
        ns_waveform *w;
        int r, points = 0, jumps = 0;
        double w0[8], from = 0;
        assert_int_equal(ns_circuit_create(&c), NS_OK);
        assert_int_equal(ns_circuit_capacitor(c, "c1", 1, 0, 1, 10, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, "r", 1, 0, 1, &r), NS_OK);
        assert_int_equal(ns_circuit_capacitor(c, "c2", 2, 0, 1, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(c, "s", 1, 2, 9, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_source(c, "vg", NS_VOLTAGE, 9, 0, &gate, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(c, &s), NS_OK);
        assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
        assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
        assert_int_equal(ns_energy_create(c, 1, &r, &e), NS_OK);
        const ns_waveform_integrals integrals = {2, e, begin, take, read_sums};
        const ns_waveform_options look = {.closest = 1e-13, .integrals = &integrals};
        assert_int_equal(ns_waveform_create(s, m, &look, &w), NS_OK);
        assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
        ns_waveform_point p;
        assert_int_equal(ns_waveform_start(w, &p), NS_OK);
        assert_true(p.sums && p.sums[0] == 0 && p.sums[1] == 0);
        if (skips) {
            from = 1.25;
            assert_int_equal(ns_waveform_skip(w, from, &p), NS_OK);
            assert_true(p.sums[0] == 0 && p.sums[1] == 0);
        }
        while (p.t < 2) {
            assert_int_equal(ns_waveform_next(w, 2, &p), NS_OK);
            const double t = p.after_jump ? 1 : p.t;
            assert_true(fabs(p.sums[0] - (charge(t) - charge(from))) < 1e-9);
            assert_true(fabs(p.sums[1] - (joule(t) - joule(from))) < 1e-8);
            jumps += p.after_jump;
            points++;
        }
        assert_true(points > (skips ? 5 : 20));
        assert_int_equal(jumps, !skips);
        ns_waveform_drop_integrals(w);
        assert_int_equal(ns_waveform_next(w, 2.5, &p), NS_OK);
        assert_null(p.sums);
        ns_waveform_free(w);
        ns_energy_free(e);
        ns_march_free(m);
        ns_system_free(s);
        ns_circuit_free(c);
    }
}

/* 1 V on 1 ohm through a switch from 1 s on, and on another from 1.05 times `closest` later: from 1 s to 2 s
 * the first takes 1 C and 1 J. The jump's own piece covers all between the two events. */
static void a_jump_that_leaves_nothing_before_the_next_event(void **state) {
    (void)state;
    static const ns_method method[] = {NS_EXACT, NS_SPARSE};
    static const double closest = 1e-3;
    for (int k = 0; k < 2; k++) {
        const ns_signal gate[2] = {pulse(0, 1, 1, 0, 0, 9, INFINITY),
                                   pulse(0, 1, 1 + 1.05 * closest, 0, 0, 9, INFINITY)};
        const ns_signal volt = dc(1);
        const ns_switch contact = {0.5, 0, 0, INFINITY};
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-2, .method = method[k]};
        ns_circuit *c;
        ns_system *s;
        ns_march *m;
        ns_energy *e;
        ns_waveform *w;
        int r;
        double w0[16];
        assert_int_equal(ns_circuit_create(&c), NS_OK);
        assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &volt, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(c, "s1", 1, 2, 8, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, "r1", 2, 0, 1, &r), NS_OK);
        assert_int_equal(ns_circuit_switch(c, "s2", 1, 3, 9, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, "r2", 3, 0, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_source(c, "g1", NS_VOLTAGE, 8, 0, &gate[0], NULL), NS_OK);
        assert_int_equal(ns_circuit_source(c, "g2", NS_VOLTAGE, 9, 0, &gate[1], NULL), NS_OK);
        assert_int_equal(ns_circuit_system(c, &s), NS_OK);
        assert_true(s->n <= 16);
        assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
        assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
        assert_int_equal(ns_energy_create(c, 1, &r, &e), NS_OK);
        const ns_waveform_integrals integrals = {2, e, begin, take, read_sums};
        const ns_waveform_options look = {.closest = closest, .integrals = &integrals};
        assert_int_equal(ns_waveform_create(s, m, &look, &w), NS_OK);
        assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
        ns_waveform_point p;
        assert_int_equal(ns_waveform_start(w, &p), NS_OK);
        while (p.t < 2)
            assert_int_equal(ns_waveform_next(w, 2, &p), NS_OK);
        assert_true(fabs(p.sums[0] - 1) < 1e-12);
        assert_true(fabs(p.sums[1] - 1) < 1e-12);
        ns_waveform_free(w);
        ns_energy_free(e);
        ns_march_free(m);
        ns_system_free(s);
        ns_circuit_free(c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(charges_and_energies),
                                       cmocka_unit_test(a_jump_that_leaves_nothing_before_the_next_event)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
