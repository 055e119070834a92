/* tests/unit/theta/test_open_inductor.c - (P2) of a step so short that its condition is 1e14: what an open
 * switch and a diode that is off interrupt is exactly zero.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"
#include "theta/theta_internal.h"

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static void contact(ns_circuit *c, const char *name, int p, int n, int gate) {
    const ns_switch s = {.vt = 8, .ron = 0.4927e-3, .roff = INFINITY};
    ok(ns_circuit_switch(c, name, p, n, gate, 0, &s, NULL));
}

static void diode(ns_circuit *c, const char *name, int anode, int cathode) {
    const ns_diode d = {.vf = 1.198, .roff = INFINITY, .vz = INFINITY};
    ok(ns_circuit_diode(c, name, anode, cathode, &d, NULL));
}

static void resistor(ns_circuit *c, const char *name, int p, int n, double ohms) {
    ok(ns_circuit_resistor(c, name, p, n, ohms, NULL));
}

static int inductor(ns_circuit *c, const char *name, int p, int n, double henries) {
    int id;
    ok(ns_circuit_inductor(c, name, p, n, henries, NAN, &id));
    return id;
}

/* Two buck converters at one input with stray inductances of 0.5 nH and 0.7 pH; *l: the output inductor of
 * the first one, from node 4. */
static ns_circuit *two_bucks(int *l) {
    const ns_signal supply = dc(18.31), off = dc(0), on = dc(15);
    ns_circuit *c;
    ok(ns_circuit_create(&c));
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &supply, NULL));
    ok(ns_circuit_source(c, "ga", NS_VOLTAGE, 20, 0, &off, NULL));
    ok(ns_circuit_source(c, "gb", NS_VOLTAGE, 21, 0, &on, NULL));
    resistor(c, "r1", 1, 2, 1.123e-3);
    (void)inductor(c, "l1", 2, 3, 0.466e-9);
    resistor(c, "r2", 3, 6, 0.1164e-3);
    (void)inductor(c, "l2", 6, 7, 0.7101e-12);
    ok(ns_circuit_capacitor(c, "c1", 7, 0, 0.5492e-3, NAN, NULL));
    contact(c, "sa", 3, 4, 20);
    contact(c, "sb", 3, 5, 21);
    diode(c, "da", 0, 4);
    diode(c, "db", 0, 5);
    resistor(c, "rs", 0, 8, 510.3);
    ok(ns_circuit_capacitor(c, "cs", 8, 5, 0.1043e-9, NAN, NULL));
    resistor(c, "ra", 4, 9, 0.07449);
    *l = inductor(c, "la", 9, 10, 23.13e-6);
    resistor(c, "rb", 5, 11, 0.2344);
    (void)inductor(c, "lb", 11, 10, 26.17e-6);
    resistor(c, "r3", 10, 12, 0.01181);
    (void)inductor(c, "l3", 12, 13, 22.9e-12);
    ok(ns_circuit_capacitor(c, "c2", 13, 0, 70.55e-6, NAN, NULL));
    resistor(c, "load", 10, 0, 2.19);
    return c;
}

/* No flux of any inductor drives a current through the open end.  Up to issue 20 0.04 of the inductor's own
 * flux stayed, as leaks stood in for the open end, and the exact engine opened the diode while it conducted.
 */
static void what_is_interrupted_is_zero(void **state) {
    static const unsigned char closed[] = {0, 1};
    const ns_theta_options o = {1, 1, 0};
    int l;
    ns_circuit *c = two_bucks(&l);
    ns_system *system;
    ns_theta *s;
    ns_map *map;
    (void)state;
    ok(ns_circuit_system(c, &system));
    double *w0 = calloc((size_t)system->n, sizeof *w0);
    const int current = ns_circuit_current_unknown(c, l);
    assert_non_null(w0);
    ok(ns_theta_create(system, &o, &s, NULL));
    for (int halvings = 0; halvings < 38; halvings++) {
        const double h = ldexp(1e-6, -halvings); /* to 7.3e-18 s */
        ok(ns_theta_start(s, w0, closed));       /* both diodes are off */
        ok(ns_theta_map_build(s, h, 1, s->past.mode, 1e-9, &map));
        for (int k = 0; k < s->r; k++) {
            const double i = map->full[current + k * (system->n + system->m)];
            assert_true(fabs(i) * 23.13e-6 < 1e-9);
        }
        ns_theta_map_free(map);
    }
    free(w0);
    ns_theta_free(s);
    ns_system_free(system);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_interrupted_is_zero)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
