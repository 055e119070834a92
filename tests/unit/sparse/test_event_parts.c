/* tests/unit/sparse/test_event_parts.c - what an event is made of, below the engine: charges that jump, (P1)
 * of a few pairs, counts of chatter, the largest values so far. */
#include "sparse/step.h"
#include "sparse_bench.h"

#include "sparse/largest.h"

static void add_source(bench *b, int p, double volts) {
    const ns_signal dc = {.kind = NS_DC, .u.dc = volts};
    assert_int_equal(ns_circuit_source(b->c, p == 9 ? "gate" : "v", NS_VOLTAGE, p, 0, &dc, NULL), NS_OK);
}

/* 1 nF at 3 V and 2 nF at 0 V, joined by an open switch and so many ohm. */
static void add_two_capacitors(bench *b, double ohm) {
    const ns_switch ideal = {0.5, 0, 0, INFINITY};
    add_source(b, 9, 0);
    assert_int_equal(ns_circuit_capacitor(b->c, "c1", 1, 0, 1e-9, 3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b->c, "c2", 3, 0, 2e-9, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b->c, "s", 1, ohm > 0 ? 2 : 3, 9, 0, &ideal, NULL), NS_OK);
    if (ohm > 0)
        assert_int_equal(ns_circuit_resistor(b->c, "r", 2, 3, ohm, NULL), NS_OK);
}

static bench two_capacitors(double ohm) {
    bench b = open_bench();
    add_two_capacitors(&b, ohm);
    start_bench(&b);
    return b;
}

/* The voltages of both after the switch closes, by steps of length g. */
static ns_jump_kind close_switch(bench *b, double g, double *v1, double *v2) {
    const ns_mode closed[1] = {NS_INSIDE};
    ns_jump_kind jump;
    ns_sparse_guard_set_mode(b->m, closed);
    assert_int_equal(ns_sparse_project_consistent(b->m, 0, g, NULL, &jump), NS_OK);
    assert_int_equal(ns_sparse_step_euler(b->m, 0, ldexp(g, -40), b->m->w, 1, b->m->v, NULL), NS_OK);
    *v1 = b->m->v[ns_circuit_node_unknown(b->c, 1)];
    *v2 = b->m->v[ns_circuit_node_unknown(b->c, 3)];
    return jump;
}

/* Without a resistance their 3 nC spread over 3 nF: 1 V.  Once more nothing jumps. */
static void charges_are_shared_at_once(void **state) {
    bench b = two_capacitors(0);
    double v1, v2;
    (void)state;
    assert_int_equal(close_switch(&b, ldexp(h, -16), &v1, &v2), NS_JUMPS);
    assert_true(fabs(v1 - 1) < 1e-12 && fabs(v2 - 1) < 1e-12);
    assert_int_equal(close_switch(&b, ldexp(h, -16), &v1, &v2), NS_NO_JUMP);
    assert_true(fabs(v1 - 1) < 1e-12 && fabs(v2 - 1) < 1e-12);
    close_bench(&b);
}

/* Without a resistance, beside 1 nF at 3 V that 0.46 ohm discharge in 0.46 ns, 30 steps g: D^8 of such a step
 * takes 31^-8 = 1.2e-12 of that, which lasts, but is too little to count. */
static void charges_jump_beside_a_transient(void **state) {
    bench b = open_bench();
    double v1, v2;
    (void)state;
    add_two_capacitors(&b, 0);
    assert_int_equal(ns_circuit_capacitor(b.c, "c3", 4, 0, 1e-9, 3, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r3", 4, 0, 0.46, NULL), NS_OK);
    start_bench(&b);
    assert_int_equal(close_switch(&b, ldexp(h, -16), &v1, &v2), NS_JUMPS);
    assert_true(fabs(v1 - 1) < 1e-12 && fabs(v2 - 1) < 1e-12);
    assert_true(fabs(b.m->v[ns_circuit_node_unknown(b.c, 4)] - 3) < 1e-11);
    close_bench(&b);
}

/* By 1.5e-4 ohm they take 1e-13 s for it: shorter than a step of h 2^-16, 1.5e-11 s, but not instantaneous.
 */
static void short_transients_last(void **state) {
    bench b = two_capacitors(1.5e-4);
    double v1, v2;
    (void)state;
    assert_int_equal(close_switch(&b, ldexp(h, -16), &v1, &v2), NS_LASTS);
    assert_true(fabs(v1 - 3) < 1e-9 && fabs(v2) < 1e-9); /* as they were */
    close_bench(&b);
}

/* 10 ohm: they take 7 ns, nothing jumps. */
static void slow_charges_stay(void **state) {
    bench b = two_capacitors(10);
    double v1, v2;
    (void)state;
    assert_int_equal(close_switch(&b, ldexp(h, -16), &v1, &v2), NS_NO_JUMP);
    assert_true(fabs(v1 - 3) < 1e-9 && fabs(v2) < 1e-9);
    close_bench(&b);
}

/* 0.75 ohm: they take 0.5 ns, of which D^8 of such a step takes 5e-13, too little for a jump.  It is not
 * taken away either, as charges off by that begin a transient of 0.5 ns. */
static void what_is_no_jump_is_left(void **state) {
    bench b = two_capacitors(0.75);
    double v1, v2, w[32];
    (void)state;
    memcpy(w, b.m->w, sizeof(double) * (size_t)b.m->f->n);
    assert_int_equal(close_switch(&b, ldexp(h, -16), &v1, &v2), NS_NO_JUMP);
    assert_memory_equal(w, b.m->w, sizeof(double) * (size_t)b.m->f->n);
    close_bench(&b);
}

/* 5 V through a bridge of diodes into 10 ohm: two of them conduct, from whatever mode it begins with. */
static void a_local_problem_finds_the_mode(void **state) {
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    const int from[] = {1, 0, 3, 3}, to[] = {2, 2, 1, 0};
    const char *const names[] = {"d1", "d2", "d3", "d4"};
    bench b = open_bench();
    (void)state;
    add_source(&b, 1, 5);
    for (int k = 0; k < 4; k++)
        assert_int_equal(ns_circuit_diode(b.c, names[k], from[k], to[k], &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 3, 10, NULL), NS_OK);
    start_bench(&b);
    for (int code = 0; code < 16; code++) {
        ns_mode mode[4];
        for (int j = 0; j < 4; j++)
            mode[j] = code >> j & 1 ? NS_INSIDE : NS_LOWER;
        ns_sparse_guard_set_mode(b.m, mode);
        memset(b.m->touched, 0, 4);
        assert_int_equal(ns_sparse_local_lcp(b.m, 0, 1e-9, b.m->w, b.m->v, NULL), NS_OK);
        for (int j = 0; j < 4; j++)
            assert_int_equal(b.m->mode[j], j == 0 || j == 3 ? NS_INSIDE : NS_LOWER);
        assert_true(fabs(b.m->v[b.m->f->n] - 0.5) < 1e-12);
    }
    close_bench(&b);
}

/* Of the broken pairs so many are left as are asked for, by the bound that is marked, and are known as
 * touched. */
static void the_first_broken_pairs_change(void **state) {
    bench b = open_bench();
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    const ns_mode from[] = {NS_LOWER, NS_INSIDE, NS_INSIDE};
    (void)state;
    add_source(&b, 1, 5);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 10, NULL), NS_OK);
    for (int k = 0; k < 3; k++)
        assert_int_equal(ns_circuit_diode(b.c,
                                          k == 0   ? "d1"
                                          : k == 1 ? "d2"
                                                   : "d3",
                                          2 + k, 2 + (k + 1) % 3, &diode, NULL),
                         NS_OK);
    start_bench(&b);
    for (int most = 1; most <= 3; most++) {
        ns_sparse_guard_set_mode(b.m, from);
        memset(b.m->touched, 0, 3);
        memcpy(b.m->flip, (unsigned char[]){1, 0, 1}, 3);
        assert_int_equal(ns_sparse_guard_flip(b.m, most), most < 2 ? 1 : 2);
        assert_true(b.m->mode[0] == NS_INSIDE && b.m->mode[1] == NS_INSIDE);
        assert_int_equal(b.m->mode[2], most < 2 ? NS_INSIDE : NS_LOWER);
        assert_true(b.m->touched[0] == 1 && b.m->touched[1] == 0 && b.m->touched[2] == (most >= 2));
    }
    close_bench(&b);
}

/* A pair may change 1000 times within the length of a step, and 64 Euler steps may be taken; then it is
 * chatter.  What is dropped does not count, later the count begins anew. */
static void chatter_is_counted(void **state) {
    bench b = two_capacitors(10);
    ns_sparse *m = b.m;
    ns_dense_step *step = m->trial.step;
    const ns_mode closed[1] = {NS_INSIDE};
    (void)state;
    step->next_exponent = step->length_exponent = 3;
    step->mode[0] = NS_LOWER;
    ns_sparse_guard_set_mode(m, closed);
    for (int round = 0; round < 2; round++) {
        for (int k = 0; k < 1000; k++)
            assert_int_equal(ns_sparse_chatter_event(m, step, 1e-3), NS_OK);
        assert_int_equal(ns_sparse_chatter_event(m, step, 1e-3 + h / 8.1), NS_E_LIMIT);
        ns_sparse_chatter_drop(m);
    }
    ns_sparse_chatter_reset(m);
    for (int k = 0; k < 1000; k++)
        assert_int_equal(ns_sparse_chatter_event(m, step, 1e-3), NS_OK);
    ns_sparse_chatter_accept(m);
    assert_int_equal(ns_sparse_chatter_event(m, step, 1e-3), NS_E_LIMIT);
    assert_int_equal(ns_sparse_chatter_event(m, step, 1e-3 + h / 7.9), NS_OK);
    step->mode[0] = NS_INSIDE; /* nothing changed: not counted */
    for (int k = 0; k < 2000; k++)
        assert_int_equal(ns_sparse_chatter_event(m, step, 2e-3), NS_OK);
    for (int k = 0; k < 64; k++)
        assert_int_equal(ns_sparse_chatter_euler(m, step, 1e-3), NS_OK);
    assert_int_equal(ns_sparse_chatter_euler(m, step, 1e-3 + h / 8.1), NS_E_LIMIT);
    assert_int_equal(ns_sparse_chatter_euler(m, step, 1e-3 + h / 7.9), NS_OK);
    close_bench(&b);
}

/* lambda counts for steps as long as the one it was seen in, and shorter ones; a saved state comes back
 * whole. */
static void largest_values_by_length(void **state) {
    bench b = two_capacitors(10);
    ns_sparse *m = b.m;
    double v[32] = {0};
    (void)state;
    assert_true(m->f->size <= 32);
    ns_sparse_largest_reset(m);
    v[m->f->n] = -7;
    ns_sparse_largest_guards(m, v, 5);
    assert_true(m->largest.lambda == 7);
    ns_sparse_largest_accept(m, 5, 1);
    v[m->f->n] = 2;
    ns_sparse_largest_save(m, &m->saved_largest);
    ns_sparse_largest_guards(m, v, 4); /* a longer step */
    assert_true(m->largest.lambda == 2);
    ns_sparse_largest_accept(m, 4, 1);
    ns_sparse_largest_guards(m, v, 5);
    assert_true(m->largest.lambda == 7);
    m->largest.w[0] = 3;
    ns_sparse_largest_restore(m, &m->saved_largest);
    assert_true(m->largest.lambda == 7 && m->largest.lambda_of[4] == 0 && m->largest.w[0] == 0);
    v[m->f->n] = 1e18;
    ns_sparse_largest_guards(m, v, 5);
    ns_sparse_largest_accept(m, 5, 0); /* in no time: a thousand times at most */
    assert_true(m->largest.lambda_of[5] == 7e3);
    ns_sparse_largest_guards(m, v, 5);
    ns_sparse_largest_accept(m, 5, 1);
    assert_true(m->largest.lambda_of[5] == 1e18);
    close_bench(&b);
}

/* A step in which the voltage of a blocking diode is c, -c, c, ... in its stages: that of a transient far
 * faster than the step, which (E1) shows as 8 c at its beginning and down to -2.7 c within it.  1 if an event
 * ends it. */
static int ends_at_event(double c) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const ns_mode blocks[1] = {NS_LOWER};
    bench b = open_bench();
    add_source(&b, 1, 1);
    assert_int_equal(ns_circuit_diode(b.c, "d", 0, 2, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1, NULL), NS_OK);
    start_bench(&b);
    ns_dense_step *step = &b.m->steps[1];
    const size_t n = (size_t)b.m->f->n, size = (size_t)b.m->f->size;
    const int at = b.m->output_only->place[ns_circuit_node_unknown(b.c, 2)];
    ns_sparse_guard_set_mode(b.m, blocks);
    memcpy(step->mode, blocks, sizeof blocks);
    memset(step->images, 0, sizeof(double) * NS_STAGES * size);
    memset(step->powers, 0, sizeof(double) * (NS_STAGES + 1) * n);
    memset(step->z, 0, sizeof(double) * NS_STAGES * (size_t)b.m->f->nz);
    for (size_t i = 0; i < NS_ORDER; i++)
        step->images[i * size + (size_t)at] = i % 2 ? -c : c;
    step->t = 0;
    step->end_t = step->length = h;
    step->g = h / NS_POLE;
    step->stages = step->shown = NS_ORDER;
    step->at_event = step->after_event = step->is_euler = 0;
    step->pair = step->command = -1;
    assert_int_equal(ns_sparse_location_first(b.m, step), NS_OK);
    const int event = step->at_event;
    close_bench(&b);
    return event;
}

/* What is left of it breaks no guard, whatever its sign. */
static void unresolved_transients_are_no_events(void **state) {
    (void)state;
    assert_false(ends_at_event(1e-3));
    assert_false(ends_at_event(-1e-3));
}

/* The integrals of jumps are again what they were when they were saved: 0, or what was added before. */
static void integrals_of_jumps_are_restored(void **state) {
    (void)state;
    for (int before = 0; before < 2; before++) {
        bench b = two_capacitors(0);
        const double by = 3;
        if (before)
            ns_instant_add(&b.m->instant, 1, 1, 2, &by);
        ns_sparse_instant_save(b.m);
        ns_instant_add(&b.m->instant, 0, 1, 1, &by);
        ns_instant_add(&b.m->instant, 1, 1, 1, &by);
        ns_sparse_instant_restore(b.m);
        assert_int_equal(b.m->instant.any != 0, before);
        assert_true(b.m->instant.sum[0] == 0 && b.m->instant.sum[1] == (before ? 6 : 0));
        close_bench(&b);
    }
}

/* A control 2 x - 3 z + 5 with x = 7 and z = 11: 14 - 33 + 5, of terms that are 52 together; its rounding is
 * 1e-12 of that.  The open switch closes where the control is beyond its threshold by more. */
static void terms_of_a_control(void **state) {
    static const struct {
        double beyond;
        int closes;
    } of[] = {{-26e-12, 0}, {26e-12, 0}, {104e-12, 1}};
    (void)state;
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const ns_sparse_options o = {.h = h};
        const double v[] = {7, 0}, z[] = {11};
        ns_system *s;
        ns_engine *e;
        assert_int_equal(ns_system_create(1, 1, 1, 1, &s), NS_OK);
        s->M[0] = s->B[0] = s->C[0] = 1;
        s->l[0] = -INFINITY;
        s->u[0] = INFINITY;
        s->command[0] = (ns_command){.pair = 0, .g0 = 5, .on = -14 - of[k].beyond, .off = -14 - of[k].beyond};
        s->command[0].gx = calloc(1, sizeof(double));
        s->command[0].gz = calloc(1, sizeof(double));
        assert_true(s->command[0].gx && s->command[0].gz);
        s->command[0].gx[0] = 2;
        s->command[0].gz[0] = -3;
        assert_int_equal(ns_sparse_create(s, &o, &e, NULL), NS_OK);
        ns_sparse *m = ns_sparse_of(e);
        assert_true(ns_sparse_guard_control_terms(m, 0, v, z) == 52);
        assert_true(ns_sparse_guard_control_rounding(m, 0, v, z) == 52e-12);
        m->z[0] = z[0];
        m->mode[0] = NS_LOWER;
        assert_int_equal(ns_sparse_guard_commands(m, v, NULL, NULL), of[k].closes);
        assert_int_equal(m->mode[0] == NS_INSIDE, of[k].closes);
        ns_sparse_free(e);
        ns_system_free(s);
    }
}

/* 1 V behind 1 ohm charges 1 uF; a switch without hysteresis closes at 0.5 V.  There no step is left (a
 * negative h makes their number negative): the fault names the switch, which is the first command. */
static void the_first_command_is_named(void **state) {
    const ns_switch half = {0.5, 0, 0, INFINITY};
    bench b = open_bench();
    double reached;
    (void)state;
    add_source(&b, 1, 1);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s", 1, 3, 2, 0, &half, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 3, 0, 1, NULL), NS_OK);
    start_bench(&b);
    assert_int_equal(ns_sparse_try(&b.m->engine, 1, NS_TO_EVENT, &reached), NS_OK);
    assert_int_equal(ns_sparse_accept(&b.m->engine), NS_OK);
    assert_int_equal(b.m->accepted.step->command, 0);
    b.m->o.h = -h;
    assert_int_equal(ns_sparse_try(&b.m->engine, 1, NS_TO_EVENT, &reached), NS_E_LIMIT);
    assert_int_equal(b.m->fault.npairs, 1);
    assert_int_equal(b.m->fault.pair[0], 0);
    close_bench(&b);
}

/* 1 nF at 1 V discharges by a diode and 0.1 mohm into 1 nF at rest, in 0.1 ps: a stretch is passed, unless
 * the engine has done as much as it may: then nothing is. */
static void a_stretch_is_bound_by_work(void **state) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    bench b = open_bench();
    (void)state;
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-9, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e-4, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 2, 3, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", 3, 0, 1e-9, 0, NULL), NS_OK);
    start_bench(&b);
    ns_sparse *m = b.m;
    for (int bound = 1; bound >= 0; bound--) {
        ns_dense_step *step = m->trial.step;
        const double before = ns_engine_work(&m->engine).all;
        ns_sparse_event_restore(m);
        m->engine.most_work = bound ? before / 2 : 0;
        step->length = 1e-14;
        step->usual_length = h;
        assert_int_equal(ns_sparse_transient_pass(m, 0, NULL, step), !bound);
        assert_true(bound == (ns_engine_work(&m->engine).all == before));
    }
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unresolved_transients_are_no_events),
        cmocka_unit_test(charges_are_shared_at_once),
        cmocka_unit_test(charges_jump_beside_a_transient),
        cmocka_unit_test(short_transients_last),
        cmocka_unit_test(slow_charges_stay),
        cmocka_unit_test(what_is_no_jump_is_left),
        cmocka_unit_test(a_local_problem_finds_the_mode),
        cmocka_unit_test(the_first_broken_pairs_change),
        cmocka_unit_test(chatter_is_counted),
        cmocka_unit_test(largest_values_by_length),
        cmocka_unit_test(integrals_of_jumps_are_restored),
        cmocka_unit_test(terms_of_a_control),
        cmocka_unit_test(the_first_command_is_named),
        cmocka_unit_test(a_stretch_is_bound_by_work),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
