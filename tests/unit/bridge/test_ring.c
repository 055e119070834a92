/* tests/unit/bridge/test_ring.c - the period of a signal and the elements that make it ring, of waveforms in
 * closed form. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "ring.h"
#include "wrap_alloc.h"

enum { PER_PERIOD = 120, UNKNOWNS = 6 };

static const double pi = 3.14159265358979323846;

/* l1 from node 2, where the voltage is constant, to node 1; c1 from there to ground and c2 to node 2.  c3 at
 * 400 V and l2 with a current that rises have no part in it. */
typedef struct rig {
    ns_circuit *c;
    ns_ring *ring;
    double c1, c2, period;
    int v1, v2, v3, i1, i2;
    double x[UNKNOWNS];
} rig;

static void set_up(rig *r, double c1, double c2) {
    const double henries = 1e-5;
    int l1, l2;
    *r = (rig){.c1 = c1, .c2 = c2, .period = 2 * pi * sqrt(henries * (c1 + c2))};
    assert_int_equal(ns_circuit_create(&r->c), NS_OK);
    assert_int_equal(ns_circuit_capacitor(r->c, "c3", 3, 0, 1e-3, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(r->c, "l2", 3, 0, 1e-2, NAN, &l2), NS_OK);
    assert_int_equal(ns_circuit_capacitor(r->c, "c2", 1, 2, c2, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(r->c, "c1", 1, 0, c1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(r->c, "l1", 2, 1, henries, NAN, &l1), NS_OK);
    r->v1 = ns_circuit_node_unknown(r->c, 1);
    r->v2 = ns_circuit_node_unknown(r->c, 2);
    r->v3 = ns_circuit_node_unknown(r->c, 3);
    r->i1 = ns_circuit_current_unknown(r->c, l1);
    r->i2 = ns_circuit_current_unknown(r->c, l2);
    assert_int_equal(ns_bridge_ring_create(UNKNOWNS, &r->ring), NS_OK);
}

static void tear_down(rig *r) {
    ns_bridge_ring_free(r->ring);
    ns_circuit_free(r->c);
}

/* v1 = 12 V + 3 V cos, i1 = 2 A + C dv1/dt, after so many periods; swing: of the 3 V.  The others drift by
 * more than that in a period. */
static void add(rig *r, double periods, double swing) {
    const double phase = 2 * pi * periods;
    r->x[r->v1] = 12 + swing * 3 * cos(phase);
    r->x[r->v2] = 12;
    r->x[r->v3] = 400 - 0.1 * periods;
    r->x[r->i1] = 2 + 0.3 * periods - swing * (r->c1 + r->c2) * 3 * 2 * pi / r->period * sin(phase);
    r->x[r->i2] = 5 + 2 * periods;
    ns_bridge_ring_add(r->ring, 1e-3 + periods * r->period, r->x[r->v1], r->x);
}

static void assert_elements(const rig *r, const char *wanted) {
    char line[60];
    assert_int_equal(ns_bridge_ring_elements(r->ring, r->c, line, sizeof line), NS_OK);
    assert_string_equal(line, wanted);
}

/* Two periods alike, of which the second one is taken apart; the third turn is needed to begin. */
static void a_ring_has_a_period_and_elements(void **state) {
    rig r;
    (void)state;
    set_up(&r, 2e-9, 1e-9);
    for (int k = 0; k < 4 * PER_PERIOD; k++)
        add(&r, (double)k / PER_PERIOD, 1);
    const double period = ns_bridge_ring_period(r.ring);
    assert_true(fabs(period / r.period - 1) < 1e-9); /* rounding: peaks are among the points */
    assert_elements(&r, "l1, c1, c2");
    char line[8];
    assert_int_equal(ns_bridge_ring_elements(r.ring, r.c, line, sizeof line), NS_OK);
    assert_true(strlen(line) < sizeof line);
    tear_down(&r);
}

/* c2 takes 1/41 of the energy: less than a tenth. */
static void small_parts_have_no_name(void **state) {
    rig r;
    (void)state;
    set_up(&r, 4e-9, 0.1e-9);
    for (int k = 0; k < 4 * PER_PERIOD; k++)
        add(&r, (double)k / PER_PERIOD, 1);
    assert_elements(&r, "l1, c1");
    tear_down(&r);
}

/* Each time two and a half periods, then none for four: the turns between two bursts are no period. */
static void bursts_have_the_period_of_the_ring(void **state) {
    rig r;
    (void)state;
    set_up(&r, 1e-9, 1e-9);
    for (int k = 0; k < 40 * PER_PERIOD; k++) {
        const double periods = (double)k / PER_PERIOD, burst = fmod(periods + 0.25, 6.5);
        add(&r, periods, burst < 2.5);
    }
    assert_true(fabs(ns_bridge_ring_period(r.ring) / r.period - 1) < 1e-9);
    assert_elements(&r, "l1, c2, c1");
    tear_down(&r);
}

/* What is driven: the inductor swings by a ninth of its part in a ring. */
static void what_is_driven_does_not_ring(void **state) {
    rig r;
    (void)state;
    set_up(&r, 1e-9, 1e-9);
    for (int k = 0; k < 4 * PER_PERIOD; k++) {
        const double phase = 2 * pi * k / PER_PERIOD;
        r.x[r.v1] = 3 * cos(phase);
        r.x[r.i1] = -(r.c1 + r.c2) * 3 * 2 * pi / (3 * r.period) * sin(phase);
        ns_bridge_ring_add(r.ring, 3 * r.period * k / PER_PERIOD, r.x[r.v1], r.x);
    }
    assert_true(fabs(ns_bridge_ring_period(r.ring) / (3 * r.period) - 1) < 1e-9);
    assert_elements(&r, "");
    tear_down(&r);
}

/* Each period is a tenth longer than the one before; rounding on a straight line is no turn. */
static void other_signals_have_no_period(void **state) {
    rig r;
    (void)state;
    set_up(&r, 1e-9, 1e-9);
    for (int k = 0; k < 20 * PER_PERIOD; k++) {
        const double periods = (double)k / PER_PERIOD;
        r.x[r.v1] = cos(2 * pi * periods);
        ns_bridge_ring_add(r.ring, exp(0.0953 * periods), r.x[r.v1], r.x);
    }
    assert_true(ns_bridge_ring_period(r.ring) == 0);
    for (int k = 0; k < 1000; k++)
        ns_bridge_ring_add(r.ring, 100 + k, 0.5 + 1e-9 * (k % 2), r.x);
    assert_true(ns_bridge_ring_period(r.ring) == 0);
    tear_down(&r);
}

static void memory_fails(void **state) {
    rig r;
    char line[60];
    int status = NS_E_MEMORY;
    (void)state;
    set_up(&r, 2e-9, 1e-9);
    for (long k = 1; status; k++) {
        ns_ring *ring;
        fail_alloc_at(k);
        status = ns_bridge_ring_create(UNKNOWNS, &ring);
        fail_alloc_off();
        assert_int_equal(status, k <= 2 ? NS_E_MEMORY : NS_OK);
        assert_true((status == NS_OK) == (ring != NULL));
        ns_bridge_ring_free(ring);
    }
    for (int k = 0; k < 4 * PER_PERIOD; k++)
        add(&r, (double)k / PER_PERIOD, 1);
    fail_alloc_at(1);
    status = ns_bridge_ring_elements(r.ring, r.c, line, sizeof line);
    fail_alloc_off();
    assert_int_equal(status, NS_E_MEMORY);
    assert_string_equal(line, "");
    assert_elements(&r, "l1, c1, c2");
    tear_down(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ring_has_a_period_and_elements),   cmocka_unit_test(small_parts_have_no_name),
        cmocka_unit_test(bursts_have_the_period_of_the_ring), cmocka_unit_test(what_is_driven_does_not_ring),
        cmocka_unit_test(other_signals_have_no_period),       cmocka_unit_test(memory_fails),
    };
    return cmocka_run_group_tests_name("ring", tests, NULL, NULL);
}
