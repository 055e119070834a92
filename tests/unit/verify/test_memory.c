/* tests/unit/verify/test_memory.c - a switch with hysteresis between its thresholds is as what happened
 * before says. */
#include "rig.h"

#include <string.h>

#include "signals.h"
#include "verify/verify_internal.h"

enum { MOST = 16 };

/* 12 V through a switch into 5 ohm.  Its control is node 3: a source that comes to 0.5 V at 1 us, from
 * `before`, or the voltage of 1 uF behind 1 kohm at 1 V.  It closes at 0.6 V and opens at 0.4 V. */
typedef struct scene {
    rig k;
    ns_verify *v;
    double t, x[MOST], lambda[MOST], y[MOST];
    int pair;
} scene;

static scene begin_scene(int by_source, double before) {
    static double t[] = {0, 1e-6}, v[4][2];
    static int used;
    scene z = {.k = begin()};
    ns_circuit *c = z.k.c;
    const ns_switch contact = {.vt = 0.5, .vh = 0.1, .ron = 0, .roff = INFINITY};
    const ns_signal supply = dc(12), one = dc(1);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT, .reltol = 1e-9};
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 1e-11};
    double *values = v[used++ % 4];
    values[0] = before;
    values[1] = 0.5;
    const ns_signal gate = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = values, .repeat = NAN}};
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "as1", 1, 2, 3, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 2, 0, 5, NULL), NS_OK);
    if (by_source)
        assert_int_equal(ns_circuit_source(c, "v3", NS_VOLTAGE, 3, 0, &gate, NULL), NS_OK);
    else {
        assert_int_equal(ns_circuit_source(c, "v4", NS_VOLTAGE, 4, 0, &one, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, "r4", 4, 3, 1e3, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(c, "c3", 3, 0, 1e-6, before, NULL), NS_OK);
    }
    make_by(&z.k, &o);
    assert_true(z.k.s->n <= MOST && z.k.s->m <= MOST && z.k.s->nc == 1);
    z.pair = z.k.s->command[0].pair;
    assert_int_equal(ns_verify_create(z.k.s, &vo, &z.v), NS_OK);
    ns_verify_start_switches(z.v, 0, NULL);
    return z;
}

static void end_scene(scene *z) {
    ns_verify_free(z->v);
    end(&z->k);
}

static void look(scene *z) {
    assert_int_equal(ns_march_read(z->k.m, &z->t, z->x, z->lambda, z->y), NS_OK);
}

/* In a hurry, then in full; what passes in a hurry is right. */
static int is_right(const scene *judge, const scene *shown, ns_verify_finding *f) {
    const ns_verify_state at = {shown->t, NS_RIGHT, shown->x, shown->lambda, shown->y, 0};
    const int quickly = ns_verify_quick_point(judge->v, &at), right = ns_verify_point(judge->v, &at, f);
    assert_true(right || !quickly);
    return right;
}

static void sources_decide(void **state) {
    scene was_open = begin_scene(1, 0), was_closed = begin_scene(1, 1), *both[] = {&was_open, &was_closed};
    ns_verify_finding f;
    (void)state;
    for (int k = 0; k < 2; k++) {
        start_at_rest(&both[k]->k);
        look(both[k]);
        assert_true(is_right(both[k], both[k], &f));
        go(&both[k]->k, 2e-6);
        look(both[k]);
    }
    assert_true(was_open.lambda[was_open.pair] == 0 &&
                was_closed.lambda[was_closed.pair] > 2.3); /* 12 V / 5 ohm */
    for (int k = 0; k < 2; k++) {
        assert_true(is_right(both[k], both[k], &f));
        assert_false(is_right(both[k], both[1 - k], &f)); /* its control is the same 0.5 V */
        assert_int_equal(f.cause, NS_VERIFY_COMMAND);
        assert_int_equal(f.pair, both[k]->pair);
    }
    end_scene(&was_open);
    end_scene(&was_closed);
}

/* From open to closed, while the capacitor stays at v.  What passes in a hurry is right. */
static int change_is_right(double v, ns_verify_finding *f) {
    scene z = begin_scene(0, v);
    static const double nothing[MOST];
    ns_mode closed[MOST] = {0};
    start_at_rest(&z.k);
    look(&z);
    assert_true(is_right(&z, &z, f));
    const ns_verify_state left = {z.t, NS_LEFT, z.x, z.lambda, z.y, 0};
    ns_verify_quick_left(z.v, &left);
    ns_verify_left(z.v);
    closed[z.pair] = NS_INSIDE;
    assert_int_equal(ns_circuit_rest(z.k.c, z.k.x), NS_OK);
    assert_int_equal(ns_march_start_as(z.k.m, 0, z.k.x, closed), NS_OK);
    look(&z);
    assert_true(z.lambda[z.pair] > 2.3);
    assert_true(is_right(&z, &z, f)); /* either is right */
    const int quickly = ns_verify_quick_stays(z.v), right = ns_verify_event(z.v, nothing, nothing, f);
    assert_true(right || !quickly);
    end_scene(&z);
    return right;
}

static void a_change_has_a_cause(void **state) {
    ns_verify_finding f;
    (void)state;
    assert_true(change_is_right(0.5999999, &f));
    assert_false(change_is_right(0.5, &f));
    assert_int_equal(f.cause, NS_VERIFY_COMMAND);
}

/* What is known at t where the control is g: -1 nothing, 0 open, 1 closed. */
static int known_at(ns_verify *v, double t, double g) {
    v->t = t;
    return ns_verify_memory_at(v, 0, g);
}

/* A gate of 1 us that is 0.5 V, between the thresholds, and 1 V from 0.25 to 0.5 us: open until the first of
 * these, then closed for ever.  Of a point before the last one, and after more corners than are looked at,
 * one cannot tell until the control is beyond a threshold again. */
static void sources_with_many_corners(void **state) {
    rig k = begin();
    ns_verify *v;
    const double us = 1e-6;
    const ns_switch contact = {.vt = 0.5, .vh = 0.1, .ron = 0, .roff = INFINITY};
    const ns_signal gate = pulse(0.5, 1, 0.25 * us, 0.01 * us, 0.01 * us, 0.24 * us, us);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT, .reltol = 1e-9};
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 1e-11};
    (void)state;
    assert_int_equal(ns_circuit_source(k.c, "vg", NS_VOLTAGE, 1, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "as1", 1, 2, 1, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", 2, 0, 5, NULL), NS_OK);
    make_by(&k, &o);
    assert_int_equal(ns_verify_create(k.s, &vo, &v), NS_OK);
    ns_verify_start_switches(v, 0, NULL);
    assert_int_equal(known_at(v, 0.1 * us, 0.5), 0);
    assert_int_equal(known_at(v, 0.2 * us, 0.5), 0);
    assert_int_equal(known_at(v, 0.9 * us, 0.5), 1);
    assert_int_equal(known_at(v, 99.9 * us, 0.5), 1);
    assert_int_equal(known_at(v, 1e4 * us + 0.1 * us, 0.5), -1);
    assert_int_equal(known_at(v, 1e4 * us + 0.4 * us, 1), 1);
    assert_int_equal(known_at(v, 1e4 * us + 0.9 * us, 0.5), 1);
    assert_int_equal(known_at(v, 1e4 * us + 0.1 * us, 0.5), -1);
    assert_int_equal(known_at(v, 1e4 * us + 1.1 * us, 0.5), 1);
    ns_verify_free(v);
    end(&k);
}

/* A gate between the thresholds that jumps to 1 V at 1 s and falls back to 0.5 V by 2 s: only the right side
 * of its corner says that the switch is closed.  What a point shows, 1 V at 0.75 s and 0.3 V at 4 s, is kept.
 */
static void sides_of_a_corner(void **state) {
    static const double t[] = {0, 1, 1, 2}, volts[] = {0.5, 0.5, 1, 0.5};
    const ns_signal gate = {.kind = NS_PWL, .u.pwl = {.n = 4, .t = t, .v = volts, .repeat = NAN}};
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 1e-11};
    (void)state;
    for (int shown = 0; shown < 2; shown++) {
        ns_system *s;
        ns_verify *v;
        assert_int_equal(ns_system_create(0, 1, 1, 1, &s), NS_OK);
        s->D[0] = 1;
        s->l[0] = -INFINITY;
        s->u[0] = INFINITY;
        s->command[0] = (ns_command){.pair = 0, .on = 0.6, .off = 0.4, .gz = calloc(1, sizeof(double))};
        assert_non_null(s->command[0].gz);
        s->command[0].gz[0] = 1;
        assert_int_equal(ns_system_set_input(s, 0, &gate), NS_OK);
        assert_int_equal(ns_verify_create(s, &vo, &v), NS_OK);
        ns_verify_start_switches(v, 0, NULL);
        assert_int_equal(known_at(v, 0.5, 0.5), 0);
        if (shown) {
            assert_int_equal(known_at(v, 0.75, 1), 1);
            assert_int_equal(known_at(v, 0.8, 0.5), 1); /* it stays known */
        }
        assert_int_equal(known_at(v, 3, 0.5), 1);
        assert_int_equal(known_at(v, 4, 0.3), 0);
        assert_int_equal(known_at(v, 5, 0.5), 0);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* Closed above 0.6 V, open below 0.4 V, each to 1e-3 of 0.6 V: what comes near the threshold at which the
 * switch would change leaves open whether it did, the other one does not. */
static void near_a_threshold(void **state) {
    const struct {
        double first, then;
        int is;
    } of[] = {{0.7, 0.5999, 1}, {0.7, 0.4001, -1}, {0.3, 0.5999, -1}, {0.3, 0.4001, 0},
              {0.7, 0.402, 1},  {0.3, 0.598, 0},   {0.3, 0.602, 1},   {0.7, 0.398, 0}};
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 1e-11};
    const ns_signal half = dc(0.5);
    (void)state;
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        ns_system *s;
        ns_verify *v;
        assert_int_equal(ns_system_create(0, 1, 1, 1, &s), NS_OK);
        s->D[0] = 1;
        s->l[0] = -INFINITY;
        s->u[0] = INFINITY;
        s->command[0] = (ns_command){.pair = 0, .on = 0.6, .off = 0.4, .gz = calloc(1, sizeof(double))};
        assert_non_null(s->command[0].gz);
        s->command[0].gz[0] = 1;
        assert_int_equal(ns_system_set_input(s, 0, &half), NS_OK);
        assert_int_equal(ns_verify_create(s, &vo, &v), NS_OK);
        ns_verify_start_switches(v, 0, NULL);
        (void)known_at(v, 1, of[k].first);
        assert_int_equal(known_at(v, 2, of[k].then), of[k].is);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* Energy is judged where M is symmetric but for signs of rows and its own entries say the signs: of two
 * charges, each by the other's unknown alone, none does. */
static void energy_needs_signs(void **state) {
    const double all[][4] = {{2, 1, 1, 2}, {2, 1, -1, -2}, {0, 1, 1, 0}, {-2, 1, 1, 0}, {2, 1, 0, 2}};
    const int judged[] = {1, 1, 0, 0, 0};
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 1e-11};
    (void)state;
    for (int k = 0; k < 5; k++) {
        ns_system *s;
        ns_verify *v;
        assert_int_equal(ns_system_create(2, 0, 0, 0, &s), NS_OK);
        memcpy(s->M, all[k], sizeof all[k]);
        s->A[0] = s->A[3] = -1;
        assert_int_equal(ns_verify_create(s, &vo, &v), NS_OK);
        assert_int_equal(v->is_passive, judged[k]);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

static double voltage(const rig *z, int node) {
    double x[MOST];
    assert_int_equal(ns_march_read(z->m, NULL, x, NULL, NULL), NS_OK);
    return x[ns_circuit_node_unknown(z->c, node)];
}

/* A switch that closes across a charged capacitor, and carries nothing after that, opens the switch that the
 * capacitor controls: no control of the latter comes to its threshold.  The gate of the first one is 1 V
 * behind 1 kohm and 1 uF, so that it closes at 0.6 V. */
static void an_unloaded_switch_may_be_the_cause(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    const ns_switch contact = {.vt = 0.5, .vh = 0.1, .ron = 0, .roff = INFINITY};
    const ns_signal supply = dc(12), one = dc(1);
    (void)state;
    for (int k = 0; k < 2; k++) {
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = methods[k], .reltol = 1e-9};
        rig z = begin();
        int power;
        assert_int_equal(ns_circuit_source(z.c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(z.c, "as1", 1, 2, 3, 0, &contact, &power), NS_OK);
        assert_int_equal(ns_circuit_resistor(z.c, "r1", 2, 0, 5, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(z.c, "c3", 3, 0, 1e-6, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(z.c, "as2", 3, 0, 5, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_source(z.c, "v4", NS_VOLTAGE, 4, 0, &one, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(z.c, "r4", 4, 5, 1e3, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(z.c, "c5", 5, 0, 1e-6, 0, NULL), NS_OK);
        make_by(&z, &o);
        start_at_rest(&z);
        go(&z, 0.9e-3); /* 1 ms ln(1 / (1 - 0.6)) = 0.916 ms */
        assert_true(fabs(voltage(&z, 2) - 12) < 1e-9);
        go(&z, 0.93e-3);
        assert_true(fabs(voltage(&z, 2)) < 1e-9);
        assert_int_equal(ns_march_counts(z.m)->retries, 0);
        end(&z);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sources_decide),
        cmocka_unit_test(sources_with_many_corners),
        cmocka_unit_test(sides_of_a_corner),
        cmocka_unit_test(near_a_threshold),
        cmocka_unit_test(energy_needs_signs),
        cmocka_unit_test(a_change_has_a_cause),
        cmocka_unit_test(an_unloaded_switch_may_be_the_cause),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
