/* tests/unit/march/test_partition.c - converters at one stiff supply, each on its own way: as right as all in
 * one (option `whole`), to what both promise, and at the cost of each alone.
 */
#include "converters.h"
#include "large_copy.h"
#include "linalg/sparse.h"

static double go(scene *z, double t, ns_until until) {
    double reached;
    assert_int_equal(ns_march_try(z->m, t, until, &reached), NS_OK);
    assert_int_equal(ns_march_accept(z->m), NS_OK);
    return reached;
}

static void go_to(scene *z, double t, ns_until until) {
    while (go(z, t, until) < t)
        ;
}

static void same_values(int n, const double *a, const double *b, double tolerance) {
    double most = 1; /* V, A */
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(b[i]));
    for (int i = 0; i < n; i++)
        assert_true(fabs(a[i] - b[i]) <= tolerance * most);
}

/* All that can be read, of both. */
static void same_point(scene *a, scene *b, double tolerance) {
    double x[2][MOST], lambda[2][MOST], y[2][MOST], t[2];
    assert_int_equal(ns_march_read(a->m, &t[0], x[0], lambda[0], y[0]), NS_OK);
    assert_int_equal(ns_march_read(b->m, &t[1], x[1], lambda[1], y[1]), NS_OK);
    assert_true(fabs(t[0] - t[1]) <= 1e-15);
    same_values(a->s->n, x[0], x[1], tolerance);
    same_values(a->s->m, lambda[0], lambda[1], tolerance);
    same_values(a->s->m, y[0], y[1], tolerance);
    const ns_mode *mode = ns_march_mode(a->m), *expected = ns_march_mode(b->m);
    for (int k = 0; k < a->s->m; k++) /* where both are 0, both modes are right */
        assert_true(mode[k] == expected[k] || fabs(lambda[1][k]) + fabs(y[1][k]) < 1e-12);
}

static void bucks_side_by_side(ns_method method, ns_until until, double tolerance) {
    scene a = two_bucks(), b = two_bucks();
    begin(&a, method, 0);
    begin(&b, method, 1);
    assert_int_equal(islands(&a), 2);
    assert_int_equal(islands(&b), 0);
    for (int k = 1; k <= 100; k++) {
        go_to(&a, k * 3.1e-6, until);
        go_to(&b, k * 3.1e-6, until);
        same_point(&a, &b, tolerance);
    }
    end(&a);
    end(&b);
}

static void by_exact(void **state) {
    (void)state;
    bucks_side_by_side(NS_EXACT, NS_TO_TIME, 1e-12);
    bucks_side_by_side(NS_EXACT, NS_TO_EVENT, 1e-12);
}

static void by_sparse(void **state) {
    (void)state;
    bucks_side_by_side(NS_SPARSE, NS_TO_TIME, 1e-7);
    bucks_side_by_side(NS_SPARSE, NS_TO_EVENT, 1e-7);
}

/* A buck whose switch closes while its own output is 50 mV below v and opens 50 mV above. */
static void hysteretic_buck(scene *z, const char *name, int node, double v, double load) {
    const ns_switch contact = {0, 0.05, 0, INFINITY};
    char part[16];
    const int x = node, out = node + 1, reference = node + 2;
    put(z, PART("v"), reference, 0, dc(v));
    assert_int_equal(ns_circuit_switch(z->c, PART("s"), SUPPLY, x, reference, out, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(z->c, PART("d"), 0, x, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(z->c, PART("l"), x, out, 100e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(z->c, PART("c"), out, 0, 22e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, PART("r"), out, 0, load, NULL), NS_OK);
}

static void controlled_by_their_own_states(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    static const double tolerance[] = {1e-9, 1e-6};
    (void)state;
    for (int k = 0; k < 2; k++) {
        scene both[2];
        for (int whole = 0; whole < 2; whole++) {
            both[whole] = supplied(dc(24));
            hysteretic_buck(&both[whole], "1", FIRST, 12, 4);
            hysteretic_buck(&both[whole], "2", FIRST + EACH, 7, 3);
            begin(&both[whole], methods[k], whole);
            assert_int_equal(islands(&both[whole]), whole ? 0 : 2);
        }
        for (int i = 1; i <= 50; i++) {
            go_to(&both[0], i * 1.37e-5, NS_TO_TIME);
            go_to(&both[1], i * 1.37e-5, NS_TO_TIME);
            same_point(&both[0], &both[1], tolerance[k]);
        }
        assert_true(ns_march_counts(both[0].m)->events > 10);
        end(&both[0]);
        end(&both[1]);
    }
}

/* From event to event: the same instants, the same values on both sides of each. */
static void the_same_events(void **state) {
    (void)state;
    scene a = two_bucks(), b = two_bucks();
    begin(&a, NS_EXACT, 0);
    begin(&b, NS_EXACT, 1);
    for (double t = 0; t < 200e-6;) {
        t = go(&a, 1, NS_TO_EVENT);
        assert_true(fabs(go(&b, 1, NS_TO_EVENT) - t) <= 1e-15);
        assert_int_equal(ns_march_at_event(a.m), ns_march_at_event(b.m));
        same_point(&a, &b, 1e-12);
    }
    end(&a);
    end(&b);
}

/* Modes and maps of two are those of one and of the other; in one they multiply. */
static void each_costs_what_it_costs_alone(void **state) {
    (void)state;
    scene both = two_bucks(), whole = two_bucks(), one = supplied(dc(24)), other = supplied(dc(24));
    buck(&one, "1", FIRST, 10e-6, 4);
    buck(&other, "2", FIRST, 7.3e-6, 300);
    scene *const all[] = {&both, &whole, &one, &other};
    ns_counts c[4];
    for (int k = 0; k < 4; k++) {
        begin(all[k], NS_EXACT, k == 1);
        go_to(all[k], 1e-3, NS_TO_TIME);
        c[k] = *ns_march_counts(all[k]->m);
        end(all[k]);
    }
    assert_int_equal(c[0].events, c[2].events + c[3].events);
    assert_int_equal(c[0].steps, c[2].steps + c[3].steps);
    assert_int_equal(c[0].modes, c[2].modes + c[3].modes);
    assert_int_equal(c[0].maps, c[2].maps + c[3].maps);
    assert_true(c[0].pivots <= c[2].pivots + c[3].pivots);
    assert_int_equal(c[0].periods, c[2].periods + c[3].periods);
    assert_true(c[1].modes > c[0].modes && c[1].steps > c[0].steps);
}

/* A detector between two others does not look for events when they have theirs. */
static void events_of_others_are_not_searched_for(void **state) {
    (void)state;
    scene both = two_bucks(), three = two_bucks();
    detector(&three, "3", FIRST + 2 * EACH);
    begin(&both, NS_EXACT, 0);
    begin(&three, NS_EXACT, 0);
    assert_int_equal(islands(&three), 3);
    go_to(&both, 1e-3, NS_TO_EVENT);
    go_to(&three, 1e-3, NS_TO_EVENT);
    const ns_counts *two = ns_march_counts(both.m), *all = ns_march_counts(three.m);
    assert_true(two->events > 300 && all->events - two->events <= 2);
    assert_true(all->searches - two->searches <= 4);
    end(&both);
    end(&three);
}

/* The supply gives each its current, and its own resistor. */
static void currents_of_the_supply_add_up(void **state) {
    (void)state;
    scene z = two_bucks();
    double x[MOST], lambda[MOST];
    detector(&z, "3", FIRST + 2 * EACH);
    begin(&z, NS_EXACT, 0);
    go_to(&z, 61e-6, NS_TO_TIME); /* both switches closed: 1 of 10 us, 2.6 of 7.3 */
    assert_int_equal(ns_march_read(z.m, NULL, x, lambda, NULL), NS_OK);
    const int il1 = ns_circuit_current_unknown(z.c, 5); /* in, rin, v1, s1, d1, l1 */
    const int il2 = ns_circuit_current_unknown(z.c, 11);
    const double v3 = x[ns_circuit_node_unknown(z.c, FIRST + 2 * EACH)];
    const double all = 24.0 / 100 + x[il1] + x[il2] + (24 - v3) / 1;
    assert_true(x[il1] > 0.1 && x[il2] > 0.01);
    assert_true(fabs(x[ns_circuit_current_unknown(z.c, 0)] + all) <= 1e-12);
    end(&z);
}

/* The operating point, and one that holds a node and a supply as it is. */
static void from_the_operating_point(void **state) {
    (void)state;
    for (int held = 0; held < 3; held++) {
        scene a = two_bucks(), b = two_bucks();
        double x[2][MOST];
        make(&a, NS_EXACT, 0);
        make(&b, NS_EXACT, 1);
        const int hold[] = {ns_circuit_node_unknown(a.c, FIRST + EACH + 1),
                            ns_circuit_node_unknown(a.c, FIRST + 1)};
        const double at[] = {5, 3};
        assert_int_equal(ns_march_start_dc(a.m, 0, held, hold, at, x[0]), NS_OK);
        assert_int_equal(ns_march_start_dc(b.m, 0, held, hold, at, x[1]), NS_OK);
        same_values(a.s->n, x[0], x[1], 1e-12);
        same_point(&a, &b, 1e-12);
        go_to(&a, 100e-6, NS_TO_TIME);
        go_to(&b, 100e-6, NS_TO_TIME);
        same_point(&a, &b, 1e-12);
        end(&a);
        end(&b);
    }
}

/* What ties them: a capacitor from the supply into one (its charge would have to be told apart), a resistor
 * between them, a switch that the supply's current commands, a supply with a resistance. */
static void tied_together(void **state) {
    (void)state;
    const ns_switch contact = {0.5, 0, 0, INFINITY};
    for (int tie = 0; tie < 5; tie++) {
        scene z = {0};
        if (tie != 4)
            z = two_bucks();
        if (tie == 0)
            assert_int_equal(ns_circuit_capacitor(z.c, "ct", SUPPLY, FIRST, 1e-9, NAN, NULL), NS_OK);
        if (tie == 1)
            assert_int_equal(ns_circuit_resistor(z.c, "rt", FIRST, FIRST + EACH, 1e3, NULL), NS_OK);
        if (tie == 2) {
            assert_int_equal(ns_circuit_icontrolled(z.c, "h", NS_VOLTAGE, 20, 0, 0, 1, NULL), NS_OK);
            assert_int_equal(ns_circuit_switch(z.c, "st", 21, 0, 20, 0, &contact, NULL), NS_OK);
            assert_int_equal(ns_circuit_resistor(z.c, "rt", 21, 0, 1, NULL), NS_OK);
        }
        if (tie == 4) {
            assert_int_equal(ns_circuit_create(&z.c), NS_OK);
            put(&z, "vr", 30, 0, dc(24));
            assert_int_equal(ns_circuit_resistor(z.c, "ri", 30, SUPPLY, 0.1, NULL), NS_OK);
            buck(&z, "1", FIRST, 10e-6, 4);
            buck(&z, "2", FIRST + EACH, 7.3e-6, 300);
        }
        begin(&z, tie == 3 ? NS_THETA : NS_EXACT, 0);
        assert_int_equal(islands(&z), 0);
        go_to(&z, 20e-6, NS_TO_TIME);
        end(&z);
    }
}

/* Trials that are not accepted leave nothing behind. */
static void trials_are_forgotten(void **state) {
    (void)state;
    scene a = two_bucks(), b = two_bucks();
    double reached;
    begin(&a, NS_EXACT, 0);
    begin(&b, NS_EXACT, 0);
    for (double t = 0; t < 100e-6;) {
        assert_int_equal(ns_march_try(a.m, t + 13e-6, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_try(a.m, t + 1e-7, NS_TO_EVENT, &reached), NS_OK);
        t = go(&a, t + 30e-6, NS_TO_EVENT);
        assert_true(t == go(&b, t + 30e-6, NS_TO_EVENT) || t >= 100e-6);
        same_point(&a, &b, 1e-13);
    }
    end(&a);
    end(&b);
}

/* Chains of hundred sections, as sparse matrices: taken apart as well. */
static scene two_chains(void) {
    enum { SECTIONS = 45 };
    scene z = supplied(sine(10, 1e4));
    for (int chain = 0, node = FIRST; chain < 2; chain++) {
        int from = SUPPLY;
        for (int k = 0; k < SECTIONS; k++, node += 2) {
            char part[16], name[8];
            snprintf(name, sizeof name, "%d_%d", chain, k);
            assert_int_equal(ns_circuit_resistor(z.c, PART("r"), from, node, 1 + chain, NULL), NS_OK);
            assert_int_equal(ns_circuit_diode(z.c, PART("d"), node, node + 1, &ideal, NULL), NS_OK);
            assert_int_equal(ns_circuit_capacitor(z.c, PART("c"), node + 1, 0, 1e-7, NAN, NULL), NS_OK);
            assert_int_equal(ns_circuit_resistor(z.c, PART("l"), node + 1, 0, 50, NULL), NS_OK);
            from = node;
        }
    }
    return z;
}

static void large_ones(void **state) {
    (void)state;
    scene a = two_chains(), b = two_chains();
    begin(&a, NS_SPARSE, 0);
    begin(&b, NS_SPARSE, 1);
    assert_int_equal(islands(&a), 2);
    for (int k = 1; k <= 10; k++) {
        go_to(&a, k * 2e-5, NS_TO_TIME);
        go_to(&b, k * 2e-5, NS_TO_TIME);
        same_point(&a, &b, 1e-6);
    }
    end(&a);
    end(&b);
}

/* Of large ones at the end of each step of one of them, while the other is beyond it and read on its way: y
 * is that of (S3). */
static void outputs_on_the_way_of_large_ones(void **state) {
    (void)state;
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE, .reltol = 1e-9};
    scene z = two_chains();
    ns_system *arrays;
    assert_int_equal(ns_circuit_system(z.c, &arrays), NS_OK);
    z.s = large_copy(arrays);
    ns_system_free(arrays);
    assert_int_equal(ns_circuit_rest(z.c, z.w0), NS_OK);
    assert_int_equal(ns_march_create(z.s, &o, &z.m, NULL), NS_OK);
    assert_int_equal(ns_march_start(z.m, 0, z.w0), NS_OK);
    assert_int_equal(islands(&z), 2);
    go_to(&z, 40e-6, NS_TO_TIME); /* the sine falls: diodes block */
    for (int k = 0; k < 60; k++) {
        double x[MOST], lambda[MOST], y[MOST], expected[MOST], in[1], t;
        (void)go(&z, 1, NS_TO_STEP);
        assert_int_equal(ns_march_read(z.m, &t, x, lambda, y), NS_OK);
        ns_system_inputs(z.s, t, NS_LEFT, in);
        memcpy(expected, z.s->e, sizeof(double) * (size_t)z.s->m);
        ns_linalg_csc_times_add(&z.s->large->C, x, expected);
        ns_linalg_csc_times_add(&z.s->large->D, lambda, expected);
        ns_linalg_csc_times_add(&z.s->large->F, in, expected);
        same_values(z.s->m, y, expected, 1e-12);
    }
    end(&z);
}

/* A supply of three sources, one on top of the other and named from the top: each gives the next its node. */
static void at_stacked_sources(void **state) {
    enum { MIDDLE = 20, LOW };
    scene z = {0};
    (void)state;
    assert_int_equal(ns_circuit_create(&z.c), NS_OK);
    put(&z, "top", SUPPLY, MIDDLE, dc(8));
    put(&z, "middle", MIDDLE, LOW, dc(9));
    put(&z, "low", LOW, 0, dc(7));
    buck(&z, "1", FIRST, 10e-6, 4);
    buck(&z, "2", FIRST + EACH, 7.3e-6, 300);
    begin(&z, NS_EXACT, 0);
    assert_int_equal(islands(&z), 2);
    scene same = two_bucks(); /* at 24 V */
    begin(&same, NS_EXACT, 0);
    go_to(&z, 1e-4, NS_TO_TIME);
    go_to(&same, 1e-4, NS_TO_TIME);
    double x[2][MOST];
    assert_int_equal(ns_march_read(z.m, NULL, x[0], NULL, NULL), NS_OK);
    assert_int_equal(ns_march_read(same.m, NULL, x[1], NULL, NULL), NS_OK);
    for (int node = FIRST; node < FIRST + 2 * EACH; node++)
        assert_true(fabs(x[0][ns_circuit_node_unknown(z.c, node)] -
                         x[1][ns_circuit_node_unknown(same.c, node)]) < 24e-12);
    end(&z);
    end(&same);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_exact),
        cmocka_unit_test(by_sparse),
        cmocka_unit_test(controlled_by_their_own_states),
        cmocka_unit_test(the_same_events),
        cmocka_unit_test(each_costs_what_it_costs_alone),
        cmocka_unit_test(events_of_others_are_not_searched_for),
        cmocka_unit_test(currents_of_the_supply_add_up),
        cmocka_unit_test(from_the_operating_point),
        cmocka_unit_test(tied_together),
        cmocka_unit_test(trials_are_forgotten),
        cmocka_unit_test(large_ones),
        cmocka_unit_test(outputs_on_the_way_of_large_ones),
        cmocka_unit_test(at_stacked_sources),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
