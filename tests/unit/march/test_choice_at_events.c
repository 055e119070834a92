/* tests/unit/march/test_choice_at_events.c - where one event follows another without a step between them, the
 * engine that costs less is asked for, too.
 *
 * The exact engine goes from event to event: by NS_TO_STEP each accepted point is the left or the right side
 * of one.  Where a switch without hysteresis is commanded by the state no right side counted as a point at
 * which engines may change, whether that switch had changed or not.  A Cockcroft-Walton multiplier of 10
 * stages, 1 ohm in each diode, costs the exact engine several times what it costs the sparse one, since 1700
 * modes have matrices of their own; its 180 events in a period of 100 us are no reason to stay.
 */
#include <stdio.h>

#include "rig.h"

#include "march/run_internal.h"
#include "signals.h"

enum { STAGES = 10, SUPPLY = 1, FIRST = 2 };

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static void add_multiplier(ns_circuit *c) {
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {.va = 100, .freq = 1e4}};
    const ns_diode diode = {.ron = 1, .roff = INFINITY, .vz = INFINITY};
    char name[32];
    int below = 0, push = SUPPLY;
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, SUPPLY, 0, &sine, NULL));
    for (int i = 0; i < 2 * STAGES; i++) {
        const int node = FIRST + i, *from = i % 2 ? &below : &push;
        (void)snprintf(name, sizeof name, "c%d", i);
        ok(ns_circuit_capacitor(c, name, *from, node, 100e-9, 0, NULL));
        (void)snprintf(name, sizeof name, "d%d", i);
        ok(ns_circuit_diode(c, name, i % 2 ? node - 1 : below, node, &diode, NULL));
        *(i % 2 ? &below : &push) = node;
    }
    ok(ns_circuit_resistor(c, "r", below, 0, 10e6, NULL));
}

/* 3 kV at most: it stays open. */
static void add_switch_of_the_state(ns_circuit *c) {
    const ns_switch contact = {.vt = 1e6, .roff = INFINITY};
    const int control = FIRST + 2 * STAGES - 1, p = FIRST + 2 * STAGES;
    ok(ns_circuit_switch(c, "s", p, 0, control, 0, &contact, NULL));
    ok(ns_circuit_resistor(c, "rs", p, control, 1e9, NULL));
}

static void engines_change_at_right_sides(void **state) {
    const double stop = 1e-3;
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-3 / 65536, .method = NS_AUTO, .whole = 1};
    rig k = begin();
    double reached = 0;
    int left = 0;
    (void)state;
    add_multiplier(k.c);
    add_switch_of_the_state(k.c);
    make_by(&k, &o);
    start_at_rest(&k);
    const ns_run *r = (const ns_run *)(void *)k.m->engine;
    assert_int_equal(r->kind, NS_RUN_DENSE);
    for (int trial = 0; trial < 100000 && reached < stop && !left; trial++) {
        ok(ns_march_try(k.m, stop, NS_TO_STEP, &reached));
        ok(ns_march_accept(k.m));
        left = r->kind == NS_RUN_SPARSE;
    }
    assert_true(left);
    end(&k);
}

/* By sparse, after 0.8 of what comes before the first question, with so many events; 1: exact was asked. */
static int is_asked_after(double events) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-3 / 65536, .method = NS_AUTO, .whole = 1};
    rig k = begin();
    double reached;
    add_multiplier(k.c);
    make_by(&k, &o);
    start_at_rest(&k);
    ns_run *r = (ns_run *)(void *)k.m->engine;
    ok(ns_march_run_leave_for(r, NS_RUN_SPARSE, 0));
    r->work_before = (ns_work){0};
    r->choice = (ns_choice){0};
    ns_march_run_begin_choice(r, 0);
    r->work_before = (ns_work){.all = 0.8 * ns_march_first_question(r->s, 0), .events = events};
    for (int i = 0; i < 2; i++) {
        ok(ns_march_try(k.m, (i + 1) * 1e-7, NS_TO_TIME, &reached));
        ok(ns_march_accept(k.m));
    }
    const int is_asked = r->kind == NS_RUN_DENSE;
    end(&k);
    return is_asked;
}

/* Where sparse took more for each event than exact does to make matrices of a new mode. */
static void exact_is_asked_early_where_events_are_dear(void **state) {
    (void)state;
    assert_true(is_asked_after(2));
    assert_false(is_asked_after(1000));
}

/* What is right by sparse is right by exact: no (P1) is solved where it goes on. */
static void exact_begins_in_the_mode_of_sparse(void **state) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-3 / 65536, .method = NS_AUTO, .whole = 1};
    rig k = begin();
    (void)state;
    add_multiplier(k.c);
    make_by(&k, &o);
    start_at_rest(&k);
    ns_run *r = (ns_run *)(void *)k.m->engine;
    ok(ns_march_run_leave_for(r, NS_RUN_SPARSE, 0));
    r->chooses = 0;
    go(&k, 1.7e-4);
    assert_int_equal(r->kind, NS_RUN_SPARSE);
    ok(ns_march_run_leave_for(r, NS_RUN_DENSE, 0));
    assert_int_equal(r->at_work->table->counts(r->at_work)->problems, 0);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(engines_change_at_right_sides),
                                       cmocka_unit_test(exact_is_asked_early_where_events_are_dear),
                                       cmocka_unit_test(exact_begins_in_the_mode_of_sparse)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
