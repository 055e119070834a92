/* tests/unit/engine/test_kernel.c - what both kernels answer, against closed forms. */
#include "rig.h"

#include "exact/exact.h"
#include "sparse/sparse.h"

static const double ohms = 1e3, farads = 1e-6, tau = 1e-3, drop = 0.7, supply = 5;

static void close_to(double got, double expected, double allowed) {
    if (!(fabs(got - expected) <= allowed))
        fail_msg("%.17g for %.17g, more than %g off", got, expected, allowed);
}

/* Both kernels of a system, one after the other; 1e-9: the sparse engine's reltol. */
static ns_kernel *make_kernel(const ns_system *s, int which) {
    ns_kernel *k = NULL;
    const ns_sparse_options o = {.h = 1e-4, .reltol = 1e-12};
    assert_int_equal(which == 0 ? ns_exact_kernel_create(s, 1e-4, &k) : ns_sparse_kernel_create(s, &o, &k),
                     NS_OK);
    assert_non_null(k);
    return k;
}

static ns_signal constant(double volts) {
    ns_signal s = {.kind = NS_DC};
    s.u.dc = volts;
    return s;
}

/* 5 V, 1 kohm, a diode of 0.7 V, 1 uF. */
static rig charging(void) {
    rig k = begin();
    const ns_signal v = constant(supply);
    const ns_diode d = {.vf = drop, .ron = 0, .roff = INFINITY, .vz = INFINITY, .rz = 0};
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &v, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r", 1, 2, ohms, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d", 2, 3, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c", 3, 0, farads, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(k.c, &k.s), NS_OK);
    return k;
}

/* M x where the capacitor has v. */
static void charged(const rig *k, double v, double *w) {
    double x[8] = {0};
    assert_true(k->s->n <= 8);
    x[ns_circuit_node_unknown(k->c, 3)] = v;
    ns_system_charges(k->s, x, w);
}

/* The diode conducts: i = 4.3 V/R exp(-t/RC); its lower guard is i, its upper one is not there. */
static void a_conducting_diode(void **state) {
    (void)state;
    rig k = charging();
    const ns_mode inside = NS_INSIDE;
    for (int which = 0; which < 2; which++) {
        ns_kernel *q = make_kernel(k.s, which);
        double w[8], x[8], lambda[1], charge[8], through[1], ahead;
        ns_guard g[2];
        charged(&k, 0, w);
        assert_int_equal(q->table->place(q, 0, w, &inside), NS_OK);
        assert_int_equal(q->table->prepare(q, 1e-5, &ahead), NS_OK);
        assert_true(ahead > 0 && ahead <= 1e-5);
        for (int i = 0; i <= 4; i++) {
            const double t = i * ahead / 4, current = (supply - drop) / ohms * exp(-t / tau);
            assert_int_equal(q->table->outputs(q, t, x, lambda), NS_OK);
            close_to(x[ns_circuit_node_unknown(k.c, 3)], (supply - drop) * (1 - exp(-t / tau)), 1e-11);
            close_to(lambda[0], current, 1e-13);
            assert_int_equal(q->table->guards(q, t, g), NS_OK);
            close_to(g[0].value, current, 1e-13);
            close_to(g[0].rate, -current / tau, 1e-8);
            close_to(g[0].second_rate, current / tau / tau,
                     1e-2); /* 4300 A/s^2, two differences less exact */
            assert_true(g[0].rounding > 0 && g[0].rounding < 1e-10);
            assert_true(g[1].value == INFINITY);
            assert_int_equal(q->table->state(q, t, charge), NS_OK);
            ns_system_charges(k.s, x, w);
            for (int j = 0; j < k.s->n; j++)
                close_to(charge[j], w[j], 1e-20);
        }
        assert_int_equal(ns_engine_kernel_integrals(q, 0, ahead, charge, through), NS_OK);
        close_to(through[0], farads * (supply - drop) * (1 - exp(-ahead / tau)), 1e-18);
        assert_true(q->table->cost(q)->factors > 0);
        q->table->free(q);
    }
    end(&k);
}

/* The diode blocks: y = v(cathode) + vf - v(anode), and stays; at 2 V on the capacitor it is negative. */
static void a_blocking_diode(void **state) {
    (void)state;
    rig k = charging();
    const ns_mode lower = NS_LOWER;
    for (int which = 0; which < 2; which++) {
        ns_kernel *q = make_kernel(k.s, which);
        double w[8], ahead;
        ns_guard g[2];
        for (int v = 2; v <= 6; v += 4) {
            charged(&k, v, w);
            assert_int_equal(q->table->place(q, 0, w, &lower), NS_OK);
            assert_int_equal(q->table->prepare(q, 1e-5, &ahead), NS_OK);
            assert_int_equal(q->table->guards(q, ahead / 2, g), NS_OK);
            close_to(g[0].value, v + drop - supply, 1e-12);
            close_to(g[0].rate, 0, 1e-6);
            assert_true(g[1].value == INFINITY);
        }
        q->table->free(q);
    }
    end(&k);
}

/* Two capacitors of 1 uF, at 10 V and 0 V, are joined by an ideal switch: 5 uC go through it at once. */
static void a_jump(void **state) {
    (void)state;
    rig k = begin();
    const ns_signal on = constant(1);
    const ns_switch s = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_mode inside = NS_INSIDE;
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, 9, 0, &on, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 1, 0, farads, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", 2, 0, farads, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r", 2, 0, 1e6, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s", 1, 2, 9, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(k.c, &k.s), NS_OK);
    for (int which = 0; which < 2; which++) {
        ns_kernel *q = make_kernel(k.s, which);
        double x[8] = {0}, w[8], moved[8], impulse[1], lambda[1], ahead;
        int jumps = 0;
        assert_true(k.s->n <= 8);
        const int one = ns_circuit_node_unknown(k.c, 1), two = ns_circuit_node_unknown(k.c, 2);
        x[one] = 10;
        ns_system_charges(k.s, x, w);
        assert_int_equal(q->table->place(q, 0, w, &inside), NS_OK);
        assert_int_equal(q->table->make_consistent(q, moved, impulse, &jumps), NS_OK);
        assert_int_equal(jumps, 1);
        close_to(fabs(impulse[0]), 5e-6,
                 5e-11); /* over a step that is short, not none: the resistor's part is in it */
        double out = 0, in = 0;
        for (int i = 0; i < k.s->n; i++) {
            out = fmin(out, moved[i]);
            in = fmax(in, moved[i]);
        }
        close_to(out, -5e-6, 5e-11);
        close_to(in, 5e-6, 5e-11);
        assert_int_equal(q->table->prepare(q, 1e-6, &ahead), NS_OK);
        assert_int_equal(q->table->outputs(q, 0, x, lambda), NS_OK);
        close_to(x[one], 5, 5e-5);
        close_to(x[two], x[one], 1e-9);
        assert_int_equal(q->table->place(q, 0, w, &inside), NS_OK); /* the same again */
        ns_system_charges(k.s, x, w);
        assert_int_equal(q->table->place(q, 0, w, &inside), NS_OK);
        assert_int_equal(q->table->make_consistent(q, moved, impulse, &jumps), NS_OK);
        assert_int_equal(jumps, 0); /* it is consistent */
        q->table->free(q);
    }
    end(&k);
}

/* 1 V to 1.5 ms, then up by 2 V a ms, charges 1 uF through 1 kohm: at 1 ms the answers hold to the corner at
 * most, and to their end; a longer time does not make them hold longer.  A switch to ground, off above 4 V,
 * looks at the capacitor. */
static void until_what_is_known_ahead(void **state) {
    (void)state;
    rig k = begin();
    const double at[] = {0, 1.5e-3, 2.5e-3}, volts[] = {1, 1, 3}, v0 = 0.25;
    const ns_signal ramp = {.kind = NS_PWL, .u.pwl = {.n = 3, .t = at, .v = volts, .repeat = NAN}};
    const ns_switch s = {.vt = 3, .vh = 1, .ron = 0, .roff = INFINITY};
    const ns_mode open = NS_LOWER;
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &ramp, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r", 1, 3, ohms, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c", 3, 0, farads, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", 1, 4, ohms, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s", 4, 0, 3, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(k.c, &k.s), NS_OK);
    for (int which = 0; which < 2; which++) {
        ns_kernel *q = make_kernel(k.s, which);
        double w[8], x[8], lambda[1], ahead;
        ns_guard g[3];
        charged(&k, v0, w);
        const double from[] = {1e-3, 1.4999e-3,
                               1.6e-3}; /* s; the corner is 0.5 ms and 0.1 us ahead, and past */
        for (int i = 0; i < 3; i++) {
            assert_int_equal(q->table->place(q, from[i], w, &open), NS_OK);
            assert_int_equal(q->table->prepare(q, 1e-8, &ahead), NS_OK);
            assert_true(ahead > 0 && ahead <= 1e-8 * (1 + 1e-6));
            assert_int_equal(q->table->place(q, from[i], w, &open), NS_OK);
            assert_int_equal(q->table->prepare(q, 1, &ahead), NS_OK);
            if (i == 1)
                close_to(ahead, 1e-7, 1e-12);
            for (int part = 0; part <= 2; part++) { /* C v' = (u - v)/R, u = u0 + slope t */
                const double t = ahead * part / 2, slope = i == 2 ? 2e3 : 0, u0 = i == 2 ? 1.2 : 1;
                const double v = u0 - slope * tau + slope * t + (v0 - u0 + slope * tau) * exp(-t / tau);
                assert_int_equal(q->table->outputs(q, t, x, lambda), NS_OK);
                close_to(x[ns_circuit_node_unknown(k.c, 3)], v, 1e-9);
                close_to(x[ns_circuit_node_unknown(k.c, 1)], u0 + slope * t, 1e-12);
                assert_int_equal(q->table->guards(q, t, g), NS_OK);
                close_to(g[2].value, 4 - v, 1e-9);
                close_to(g[2].rate, -(u0 + slope * t - v) / tau, 1e-4);
                assert_true(g[0].value == INFINITY && g[1].value == INFINITY);
            }
        }
        q->table->free(q);
    }
    end(&k);
}

/* Three pairs with lambda in [-1, 1]: x1' = lambda1, y1 = x1 at the upper bound; x2' = 2 lambda2, y2 = x2 at
 * the lower one; x3' = lambda3, y3 = x3 + lambda3 inside.  So x1 = -1 + t, x2 = 3 - 2 t, x3 = 0.5 exp(-t). */
static void bounds_on_both_sides(void **state) {
    (void)state;
    ns_system *s;
    const ns_mode mode[] = {NS_UPPER, NS_LOWER, NS_INSIDE};
    const double w[] = {-1, 3, 0.5}, gain[] = {1, 2, 1};
    assert_int_equal(ns_system_create(3, 3, 0, 0, &s), NS_OK);
    for (int i = 0; i < 3; i++) {
        s->M[4 * i] = s->C[4 * i] = 1;
        s->B[4 * i] = gain[i];
        s->l[i] = -1;
        s->u[i] = 1;
    }
    s->D[8] = 1;
    for (int which = 0; which < 2; which++) {
        ns_kernel *q = make_kernel(s, which);
        double ahead;
        ns_guard g[6];
        assert_int_equal(q->table->place(q, 0, w, mode), NS_OK);
        assert_int_equal(q->table->prepare(q, 1e-5, &ahead), NS_OK);
        for (int i = 0; i <= 2; i++) {
            const double t = i * ahead / 2, x3 = 0.5 * exp(-t);
            const double value[] = {INFINITY, 1 - t, 3 - 2 * t, INFINITY, 1 - x3, 1 + x3};
            const double rate[] = {0, -1, -2, 0, x3, -x3};
            assert_int_equal(q->table->guards(q, t, g), NS_OK);
            for (int k = 0; k < 6; k++)
                if (isinf(value[k]))
                    assert_true(g[k].value == INFINITY);
                else {
                    close_to(g[k].value, value[k], 1e-12);
                    close_to(g[k].rate, rate[k], 1e-7);
                }
        }
        q->table->free(q);
    }
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_on_both_sides),
                                       cmocka_unit_test(a_conducting_diode),
                                       cmocka_unit_test(a_blocking_diode), cmocka_unit_test(a_jump),
                                       cmocka_unit_test(until_what_is_known_ahead)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
