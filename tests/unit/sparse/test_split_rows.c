/* tests/unit/sparse/test_split_rows.c - more nodes joined by capacitors than one part may have for its rows
 * to be split as a dense matrix: a chain that floats, and one with a capacitor to ground; against the exact
 * engine. */
#include <stdio.h>

#include "parts.h"

enum { FIRST = 2, NODES = 60, POINTS = 20 };

static void build(rig *k, int grounded) {
    char name[16];
    *k = begin();
    source(k, "vin", 1, &(ns_signal){.kind = NS_SIN, .u.sin = {.va = 10, .freq = 1e3}});
    resistor(k, "rin", 1, FIRST, 100);
    for (int i = 0; i < NODES; i++) {
        (void)snprintf(name, sizeof name, "r%d", i);
        resistor(k, name, FIRST + i, 0, 1e3 * (1 + i % 7));
        (void)snprintf(name, sizeof name, "c%d", i);
        if (i > 0)
            capacitor(k, name, FIRST + i - 1, FIRST + i, 1e-6 * (1 + i % 3), 0);
    }
    if (grounded)
        capacitor(k, "cg", FIRST + NODES / 2, 0, 1e-7, 0);
    diode(k, "d", FIRST + 3, 0);
}

static void same_by_both(int grounded) {
    rig exact, sparse;
    double most = 0;
    build(&exact, grounded);
    build(&sparse, grounded);
    make_by(&exact, &(ns_march_options){.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_EXACT});
    start_at_rest(&exact);
    ready(&sparse, 1e-5);
    for (int p = 1; p <= POINTS; p++) {
        go(&exact, p * 1e-4);
        go(&sparse, p * 1e-4);
        for (int i = 0; i < NODES; i++) {
            near(voltage(&sparse, FIRST + i), voltage(&exact, FIRST + i), 10);
            most = fmax(most, fabs(voltage(&sparse, FIRST + i)));
        }
    }
    assert_true(most > 1 && ns_march_counts(sparse.m)->events > 2);
    end(&exact);
    end(&sparse);
}

static void a_long_chain_that_floats(void **state) {
    (void)state;
    same_by_both(0);
}

static void a_long_chain_with_ground(void **state) {
    (void)state;
    same_by_both(1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_long_chain_that_floats),
                                       cmocka_unit_test(a_long_chain_with_ground)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
