/* tests/unit/sparse/test_charges.c - an engine that goes on from a point of the sparse one gets its charges:
 * M x of what is shown there.
 */
#include "rig.h"

#include "march/run_internal.h"
#include "signals.h"

#include <string.h>

enum { MOST = 40 };

/* 142.4 V at 59 nF and the primary of a transformer; a rectifier of four diodes with 55 pF, 1.3 mH, 0.6 uF
 * and a load, 120 us after its start: the secondary's current is by 16 mA above that of 1.3 mH, and 55 pF
 * ring. */
static rig bridge(void) {
    static const int from[] = {3, 4, 6, 6}, to[] = {5, 5, 3, 4};
    static const char *const name[] = {"d1", "d2", "d3", "d4"};
    const ns_diode d = {.ron = 0.003458, .roff = INFINITY, .vz = INFINITY};
    const ns_signal supply = dc(142.4);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1.05618e-8, .method = NS_AUTO, .whole = 1};
    rig k = begin();
    int l1, l2;
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c18", 0, 2, 5.929e-8, 10.9973, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l19", 2, 1, 0.236351, -0.0757529, &l1), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l20", 3, 4, 0.00955831, 0.398496, &l2), NS_OK);
    assert_int_equal(ns_circuit_coupling(k.c, "k", l1, l2, 0.999503, NULL), NS_OK);
    for (int i = 0; i < 4; i++)
        assert_int_equal(ns_circuit_diode(k.c, name[i], from[i], to[i], &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c26", 6, 4, 5.527e-11, -0.720968, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l27", 5, 7, 0.00133, 0.382446, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c28", 7, 6, 6.256e-7, 32.6763, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r30", 7, 6, 72.9, NULL), NS_OK);
    make_by(&k, &o);
    assert_true(k.s->n <= MOST);
    start_at_rest(&k);
    return k;
}

/* w (n): charges that another engine would get; shown: M x of what is shown. */
static void read_charges(rig *k, double *w, double *shown) {
    double *own, t;
    unsigned char *closed;
    ns_run *r = (ns_run *)(void *)k->m->engine;
    assert_int_equal(ns_march_run_read_accepted(r, &t, &own, &closed), NS_OK);
    memcpy(w, own, sizeof *w * (size_t)k->s->n);
    free(own);
    free(closed);
    assert_int_equal(ns_march_read(k->m, NULL, k->x, NULL, NULL), NS_OK);
    ns_system_charges(k->s, k->x, shown);
}

/* The largest difference of a charge or flux, as the current of the secondary's leakage inductance, 9.5 uH,
 * or of 1 V at 55 pF: A, V. */
static double farthest(const rig *k, const double *a, const double *b) {
    double most = 0;
    for (int i = 0; i < k->s->n; i++)
        most = fmax(most, fabs(a[i] - b[i]) / 9.5e-6);
    return most;
}

/* The diodes have a resistance, so no flux jumps where one of them begins to conduct: both sides of an event
 * have the same.
 *
 * From circuit full-bridge 24001000026 of the stress set: there the dense engine was put to work at the right
 * side of such an event, where a stretch of crowded events begins, and got M x of what was shown, the end of
 * an Euler step as long as the stretch: 3.5 mA of 0.38 A too much, and a ring of another size for good. */
static void no_flux_jumps_where_another_engine_goes_on(void **state) {
    rig k = bridge();
    double left[MOST], w[MOST], shown[MOST], t = 0, before = 0;
    int events = 0;
    (void)state;
    assert_int_equal(ns_march_run_leave_for((ns_run *)(void *)k.m->engine, NS_RUN_SPARSE, 0), NS_OK);
    read_charges(&k, left, shown);
    while (t < 1e-6) {
        assert_int_equal(ns_march_try(k.m, 1e-6, NS_TO_STEP, &t), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        read_charges(&k, w, shown);
        if (t == before) {
            assert_true(farthest(&k, w, left) < 1e-6);
            assert_true(farthest(&k, shown, left) < 1e-6);
            events++;
        }
        before = t;
        memcpy(left, w, sizeof left);
    }
    assert_true(events > 0);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_flux_jumps_where_another_engine_goes_on)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
