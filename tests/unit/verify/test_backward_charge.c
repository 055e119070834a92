/* tests/unit/verify/test_backward_charge.c - charge that goes backwards through a diode is found, however
 * little it is beside what flows in the time that an event may take.
 *
 * In tests/rig/hysteretic_pump.h the diode carries 95 kA: in 5e-13 s, which an event may take, 50 nC.  Where
 * it conducts as soon as the switch opens C1 at 0 V takes 120 nF (0.5 V - 0.4918 V) = 0.98 nC from C2.
 */
#include "hysteretic_pump.h"

#include <string.h>

#include "verify/verify.h"

enum { MOST = 8 };

typedef struct point {
    double x[MOST], lambda[MOST];
} point;

static point read_point(const rig *k) {
    point p = {0};
    assert_int_equal(ns_march_read(k->m, NULL, p.x, p.lambda, NULL), NS_OK);
    return p;
}

/* The next event: its left side, then its right side. */
static double next_event(const rig *k, point *left, point *right) {
    double t;
    do {
        assert_int_equal(ns_march_try(k->m, 1, NS_TO_EVENT, &t), NS_OK);
        assert_int_equal(ns_march_accept(k->m), NS_OK);
    } while (!ns_march_at_event(k->m));
    *left = read_point(k);
    assert_int_equal(ns_march_try(k->m, 1, NS_TO_EVENT, &t), NS_OK);
    *right = read_point(k);
    assert_int_equal(ns_march_accept(k->m), NS_OK);
    return t;
}

/* What is found if the one follows the other at once, with that charge through the diode. */
static ns_verify_finding judge(const rig *k, int pair, double t, const point *left, const point *right,
                               double charge) {
    const ns_verify_options o = {.reltol = 1e-9, .instant = 5e-13, .transient = 2.4e-17};
    const ns_verify_state before = {t, NS_LEFT, left->x, left->lambda, NULL, 0},
                          after = {t, NS_RIGHT, right->x, right->lambda, NULL, 0};
    double X[MOST] = {0}, Lambda[MOST] = {0};
    ns_verify *v;
    ns_verify_finding f;
    Lambda[pair] = charge;
    assert_int_equal(ns_verify_create(k->s, &o, &v), NS_OK);
    assert_true(ns_verify_point(v, &before, &f));
    ns_verify_left(v);
    assert_true(ns_verify_point(v, &after, &f));
    const int forwards = ns_verify_quick_directions(v, Lambda, NULL);
    const int right_too = ns_verify_event(v, X, Lambda, &f);
    assert_int_equal(forwards, right_too);
    assert_int_equal(ns_verify_quick_directions(v, Lambda, Lambda), 1); /* all of it before this event */
    ns_verify_free(v);
    return f;
}

static void from_one_capacitor_to_the_other(void **state) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-10, .method = NS_EXACT, .reltol = 1e-9};
    int diode, pair = 0;
    point opens, open, closed, conducts;
    (void)state;
    rig k = build_pump(100e-6, 10, 0, &diode);
    make_by(&k, &o);
    assert_true(k.s->n <= MOST && k.s->m == 2);
    while (k.s->command[0].pair == pair)
        pair++;
    start_at_rest(&k);
    double t = next_event(&k, &opens, &open);
    while (fabs(opens.x[ns_circuit_node_unknown(k.c, PUMP_OUT)] - 0.5) > 1e-6)
        t = next_event(&k, &opens, &open);
    next_event(&k, &closed, &conducts);
    assert_true(fabs(conducts.x[ns_circuit_node_unknown(k.c, PUMP_FED)] - 0.5) < 1e-6);
    assert_int_equal(judge(&k, pair, t, &opens, &open, 0).cause, NS_VERIFY_RIGHT);

    point joined = conducts;
    const double volts = 0.5 * 120 / 122, amperes = (10 - volts) / 100e-6;
    for (int i = 0; i < k.s->n; i++)
        if (fabs(fabs(joined.x[i]) - 95e3) < 1) /* of the source and of R1 */
            joined.x[i] = copysign(amperes, joined.x[i]);
    joined.x[ns_circuit_node_unknown(k.c, PUMP_FED)] = volts;
    joined.x[ns_circuit_node_unknown(k.c, PUMP_OUT)] = volts;
    const ns_verify_finding f = judge(&k, pair, t, &opens, &joined, -120e-9 * (0.5 - volts));
    assert_int_equal(f.cause, NS_VERIFY_IMPULSE);
    assert_int_equal(f.pair, pair);
    assert_true(f.error > ns_verify_wrong);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(from_one_capacitor_to_the_other)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
