/* tests/property/test_balance.c - charge and energy of a buck converter over some periods, integrated
 * outside.
 *
 * 12 V, 100 kHz, D = 0.4, L = 100 uH, C = 10 uF, R = 5 ohm; ideal switch and diode, then with resistances and
 * a forward drop.  From values at every output time and at both sides of every event, by the trapezoidal
 * rule: C dv   = integral (i_L - v/R) dt              L di = integral (v_x - v) dt energy from the source =
 * heat in R, switch, diode + change of C v^2/2 + L i^2/2 and at every point i_S + i_D = i_L (charge in no
 * node).  The rule errs by dt^2/12 times the change of slope; at dt = 10 ns a ripple of 0.3 A in 4 us leaves
 * 1e-8 of it, a ripple of v that is itself a parabola less.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double vin = 12, L = 100e-6, C = 10e-6, R = 5, period = 10e-6, dt = 10e-9;

typedef struct buck {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    int l, sw, d;
} buck;

typedef struct point {
    double t, vx, vo, il, is, id, vs, vd;
} point;

static buck make(const ns_switch *sw, const ns_diode *d) {
    buck b = {0};
    ns_signal supply = {.kind = NS_DC}, gate = {.kind = NS_PULSE};
    supply.u.dc = vin;
    gate.u.pulse.v2 = 1;
    gate.u.pulse.tr = gate.u.pulse.tf = 1e-9;
    gate.u.pulse.pw = 3.999e-6;
    gate.u.pulse.per = period;
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "vg", NS_VOLTAGE, 4, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 2, 4, 0, sw, &b.sw), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d1", 0, 2, d, &b.d), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", 2, 3, L, 0.8, &b.l), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 3, 0, C, 4.7, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 3, 0, R, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    const ns_march_options o = {.theta = 0.5, .gamma = 0.5, .h = dt};
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    double w0[16];
    assert_int_equal(ns_circuit_rest(b.c, w0), NS_OK);
    assert_int_equal(ns_march_start(b.m, 0, w0), NS_OK);
    return b;
}

static point look(const buck *b) {
    point p;
    double x[16], lambda[4];
    assert_int_equal(ns_march_read(b->m, &p.t, x, lambda, NULL), NS_OK);
    const ns_mode *mode = ns_march_mode(b->m);
    assert_int_equal(ns_circuit_device(b->c, b->sw, x, lambda, mode, &p.is, &p.vs, NULL), NS_OK);
    assert_int_equal(ns_circuit_device(b->c, b->d, x, lambda, mode, &p.id, &p.vd, NULL), NS_OK);
    p.vx = x[ns_circuit_node_unknown(b->c, 2)];
    p.vo = x[ns_circuit_node_unknown(b->c, 3)];
    p.il = x[ns_circuit_current_unknown(b->c, b->l)];
    return p;
}

static double mean(double a, double b) {
    return (a + b) / 2;
}

static void run(const ns_switch *sw, const ns_diode *d) {
    buck b = make(sw, d);
    point p = look(&b);
    const point first = p;
    double charge = 0, flux = 0, in = 0, heat = 0;
    for (long k = 1; p.t < 4 * period && k < 20000;) {
        double reached;
        const double to = (double)k * dt;
        if (to <= p.t) {
            k++;
            continue;
        }
        assert_int_equal(ns_march_try(b.m, to, NS_TO_EVENT, &reached), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        const point q = look(&b);
        const double h = q.t - p.t;
        charge += h * (mean(p.il, q.il) - mean(p.vo, q.vo) / R);
        flux += h * (mean(p.vx, q.vx) - mean(p.vo, q.vo));
        in += h * vin * mean(p.is, q.is);
        heat += h * mean(p.vo * p.vo / R, q.vo * q.vo / R);
        heat += h * mean(p.vs * p.is + p.vd * p.id, q.vs * q.is + q.vd * q.id);
        assert_true(fabs(q.is + q.id - q.il) < 1e-12 * (1 + fabs(q.il)));
        p = q;
    }
    const double stored =
        C / 2 * (p.vo * p.vo - first.vo * first.vo) + L / 2 * (p.il * p.il - first.il * first.il);
    print_message("off: charge %.1e of %.1e C, flux %.1e of %.1e Vs, energy %.1e of %.1e J\n",
                  charge - C * (p.vo - first.vo), C * p.vo, flux - L * (p.il - first.il), L * p.il,
                  in - heat - stored, in);
    assert_true(ns_march_counts(b.m)->events >= 8);
    assert_true(fabs(charge - C * (p.vo - first.vo)) < 1e-7 * C * p.vo);
    assert_true(fabs(flux - L * (p.il - first.il)) < 1e-7 * L * p.il);
    assert_true(fabs(in - heat - stored) < 1e-7 * in);
    ns_march_free(b.m);
    ns_system_free(b.s);
    ns_circuit_free(b.c);
}

static void ideal_devices_keep_the_balance(void **state) {
    (void)state;
    const ns_switch sw = {0.5, 0, 0, INFINITY};
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    run(&sw, &d);
}

static void lossy_devices_keep_the_balance(void **state) {
    (void)state;
    const ns_switch sw = {0.5, 0, 0.1, 1e6};
    const ns_diode d = {0.7, 0.05, 1e6, INFINITY, 0};
    run(&sw, &d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ideal_devices_keep_the_balance),
        cmocka_unit_test(lossy_devices_keep_the_balance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
