/* tests/unit/theta/test_step_lcp.c - (P1) of a step and of the operating point, and the names of what a mode
 * does not determine.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formula.h"
#include "net.h"
#include "theta/theta_internal.h"

enum { N = FORMULA_N, P = FORMULA_P, Z = FORMULA_Z };

/* A proposal is the mode of the step that it stands for, whatever mode it begins with, and moves nothing. */
static void proposals_are_modes_of_steps(void **state) {
    (void)state;
    const double h = 0.1, fractions[] = {0, 1e-9};
    for (int run = 0; run < 100; run++) {
        dice d = dice_make(17, (unsigned)run);
        ns_system *s = formula_system(&d);
        const ns_theta_options o = {1, 1, 0};
        ns_theta *t;
        double w0[N], z[Z] = {1, -1}, slope[Z], end[Z], w[N];
        ns_mode mode[P];
        assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
        for (int i = 0; i < N; i++)
            w0[i] = 5 * dice_either(&d);
        for (int i = 0; i < Z; i++) {
            slope[i] = 20 * dice_either(&d);
            end[i] = z[i] + h * slope[i];
        }
        assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
        memcpy(w, t->past.w, sizeof *w * (size_t)t->r);
        for (int k = 0; k < 2; k++) {
            for (int j = 0; j < P; j++)
                mode[j] = dice_below(&d, 2) ? NS_INSIDE : NS_LOWER;
            assert_int_equal(ns_theta_lcp_propose(t, h, fractions[k], w, z, slope, mode), NS_OK);
            assert_memory_equal(t->past.w, w, sizeof *w * (size_t)t->r);
            assert_int_equal(ns_theta_try(t, h, end, 1, NS_RESOLVE), NS_OK);
            assert_memory_equal(mode, t->trial.same_mode ? t->past.mode : t->trial.mode, P);
        }
        ns_theta_free(t);
        ns_system_free(s);
    }
}

static int unknown_of(const net *k, int node) {
    return ns_circuit_node_unknown(k->c, node);
}

static int operating_point(net *k, int nhold, const int *hold, const double *volts) {
    memcpy(k->mode, ns_theta_mode(k->step), (size_t)k->s->m);
    return ns_theta_lcp_dc(k->step, k->z, nhold, hold, volts, k->mode, k->x);
}

/* 10 V, 1 ohm, a diode, 4 ohm: 2 A; then the diode's cathode held at 12 V, which blocks it. */
static void an_operating_point_by_hand(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 10);
    net_resistor(&k, "r1", 1, 2, 1);
    net_diode(&k, "d", 2, 3);
    net_resistor(&k, "r2", 3, 0, 4);
    net_prepare(&k);
    assert_int_equal(operating_point(&k, 0, NULL, NULL), NS_OK);
    assert_true(fabs(net_voltage_of(&k, k.x, 3) - 8) < 1e-13);
    const int hold = unknown_of(&k, 3);
    const double volts = 12;
    assert_int_equal(operating_point(&k, 1, &hold, &volts), NS_OK);
    assert_true(fabs(net_voltage_of(&k, k.x, 3) - 12) < 1e-13);
    assert_true(fabs(net_voltage_of(&k, k.x, 2) - 10) < 1e-13);
    net_end(&k);
}

/* 10 V through 1 uF to a node with 1 uF to ground: by itself it has no charge, so 5 V; held at 3 V, 3 V.
 * Either way 10 A beside it flow in the inductor, not in the closed switch across it, and another such node,
 * with 3 uF to ground, is at 2.5 V. */
static void a_part_without_ground_is_held(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 10);
    net_capacitor(&k, "c1", 1, 2, 1e-6, 0);
    net_capacitor(&k, "c2", 2, 0, 1e-6, 0);
    net_resistor(&k, "r", 1, 3, 1);
    net_contact(&k, "s", 3, 0, 1);
    const int coil = net_inductor(&k, "l", 3, 0, 1e-3, 0);
    net_capacitor(&k, "c3", 1, 4, 1e-6, 0);
    net_capacitor(&k, "c4", 4, 0, 3e-6, 0);
    net_prepare(&k);
    assert_int_equal(operating_point(&k, 0, NULL, NULL), NS_OK);
    assert_true(fabs(net_voltage_of(&k, k.x, 2) - 5) < 1e-12);
    assert_true(fabs(net_current_of(&k, k.x, coil) - 10) < 1e-11);
    const int hold = unknown_of(&k, 2);
    const double volts = 3;
    assert_int_equal(operating_point(&k, 1, &hold, &volts), NS_OK);
    assert_true(fabs(net_voltage_of(&k, k.x, 2) - 3) < 1e-12);
    assert_true(fabs(net_voltage_of(&k, k.x, 4) - 2.5) < 1e-12);
    assert_true(fabs(net_current_of(&k, k.x, coil) - 10) < 1e-11);
    net_end(&k);
}

/* The same where the part is the last node, whose row is the last: 10 V by 1 A in 10 ohm. */
static void a_part_at_the_last_node_has_no_charge(void **state) {
    (void)state;
    const ns_signal ampere = {.kind = NS_DC, .u.dc = 1};
    net k = net_begin();
    assert_int_equal(ns_circuit_source(k.c, "i", NS_CURRENT, 0, 1, &ampere, NULL), NS_OK);
    net_resistor(&k, "r", 1, 0, 10);
    net_capacitor(&k, "c1", 1, 2, 3e-6, 0);
    net_capacitor(&k, "c2", 2, 0, 1e-6, 0);
    net_prepare(&k);
    assert_int_equal(unknown_of(&k, 2), k.s->n - 1);
    assert_int_equal(operating_point(&k, 0, NULL, NULL), NS_OK);
    assert_true(fabs(net_voltage_of(&k, k.x, 1) - 10) < 1e-12);
    assert_true(fabs(net_voltage_of(&k, k.x, 2) - 7.5) < 1e-12);
    net_end(&k);
}

/* 1 A beside a closed switch and an inductor, in parallel: at rest any share of each obeys the laws, and that
 * of real switches is taken: all of it in the inductor. */
static void an_inductor_carries_all_beside_a_switch(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 1);
    net_resistor(&k, "r", 1, 2, 1);
    const int contact = net_contact(&k, "s", 2, 0, 1), coil = net_inductor(&k, "l", 2, 0, 1e-3, 0);
    net_prepare(&k);
    assert_int_equal(operating_point(&k, 0, NULL, NULL), NS_OK);
    assert_true(fabs(net_current_of(&k, k.x, coil) - 1) < 1e-12);
    (void)contact;
    net_end(&k);
}

/* A node that a source holds at 10 V cannot be held at 5 V: refused, and the problem is kept, one row longer.
 */
static void a_contradiction_is_kept(void **state) {
    (void)state;
    net k = net_begin();
    ns_mlcp p;
    double h = 1;
    net_voltage(&k, "v", 1, 0, 10);
    net_resistor(&k, "r", 1, 0, 1);
    net_prepare(&k);
    const int hold = unknown_of(&k, 1);
    const double volts = 5;
    assert_true(operating_point(&k, 1, &hold, &volts) < 0);
    assert_int_equal(ns_theta_problem(k.step, &p, &h), NS_OK);
    assert_int_equal(p.m, k.s->n + k.s->m + 1);
    assert_true(h == 0);
    assert_int_equal(operating_point(&k, 0, NULL, NULL), NS_OK);
    assert_int_equal(ns_theta_problem(k.step, &p, &h), NS_E_STATE);
    net_end(&k);
}

static void name_undetermined(net *k) {
    memcpy(k->step->trial.mode, k->step->past.mode, (size_t)k->s->m);
    ns_theta_name_undetermined(k->step, 1e-6, 1);
}

/* Two closed switches in parallel: their currents, and nothing else. */
static void switches_in_parallel_are_named(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 1);
    net_contact(&k, "a", 1, 2, 1);
    net_contact(&k, "b", 1, 2, 1);
    net_resistor(&k, "r", 2, 0, 1);
    net_prepare(&k);
    name_undetermined(&k);
    const ns_fault *f = ns_theta_fault(k.step);
    assert_int_equal(f->nunknowns, 0);
    assert_int_equal(f->npairs, 2);
    assert_true(f->pair[0] + f->pair[1] == 1); /* pairs 0 and 1 */
    net_end(&k);
}

/* Two nodes joined by a resistor, between open switches: their voltages. */
static void a_floating_part_is_named(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 1);
    net_contact(&k, "a", 1, 2, 0);
    net_resistor(&k, "r", 2, 3, 1);
    net_contact(&k, "b", 3, 0, 0);
    net_prepare(&k);
    name_undetermined(&k);
    const ns_fault *f = ns_theta_fault(k.step);
    assert_int_equal(f->npairs, 0);
    assert_int_equal(f->nunknowns, 2);
    const int a = unknown_of(&k, 2), b = unknown_of(&k, 3);
    assert_true((f->unknown[0] == a && f->unknown[1] == b) || (f->unknown[0] == b && f->unknown[1] == a));
    net_end(&k);
}

/* A mode that determines everything names nothing. */
static void nothing_is_named_where_all_is_determined(void **state) {
    (void)state;
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 1);
    net_contact(&k, "a", 1, 2, 1);
    net_resistor(&k, "r", 2, 0, 1);
    net_prepare(&k);
    name_undetermined(&k);
    assert_int_equal(ns_theta_fault(k.step)->npairs + ns_theta_fault(k.step)->nunknowns, 0);
    net_end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(proposals_are_modes_of_steps),
        cmocka_unit_test(an_operating_point_by_hand),
        cmocka_unit_test(a_part_without_ground_is_held),
        cmocka_unit_test(a_part_at_the_last_node_has_no_charge),
        cmocka_unit_test(an_inductor_carries_all_beside_a_switch),
        cmocka_unit_test(a_contradiction_is_kept),
        cmocka_unit_test(switches_in_parallel_are_named),
        cmocka_unit_test(a_floating_part_is_named),
        cmocka_unit_test(nothing_is_named_where_all_is_determined),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
