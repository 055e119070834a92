/* tests/unit/exact/test_samples.c - whether guards surely hold all through a step, by their samples: the
 * smallest sample against a quarter of the largest second difference, of few guards and of more than a
 * register holds.
 */
#include "exact/guards.h"
#include "rig.h"

enum { SAMPLES = 4, ROWS = 7 };

/* All guards are 1 but one: 1, 1, 1 - dip, 1, 1, of the second differences -dip, 2 dip, -dip. */
static int holds_with_dip(int rows, int guard, double dip) {
    double s[(SAMPLES + 1) * ROWS];
    for (int i = 0; i < (SAMPLES + 1) * rows; i++)
        s[i] = 1;
    s[2 * rows + guard] = 1 - dip;
    return ns_exact_event_samples_hold(s, rows, SAMPLES);
}

/* 1 - dip > 2 dip / 4 while dip < 2/3. */
static void dips(void **state) {
    (void)state;
    for (int rows = 1; rows <= ROWS; rows++)
        for (int guard = 0; guard < rows; guard++) {
            assert_true(holds_with_dip(rows, guard, 0.66));
            assert_false(holds_with_dip(rows, guard, 0.67));
        }
}

/* A straight line has no second difference: it holds while its lowest sample, the first or the last, is above
 * zero. */
static void lines(void **state) {
    (void)state;
    for (int rows = 1; rows <= ROWS; rows++)
        for (int guard = 0; guard < rows; guard++)
            for (int sign = -1; sign <= 1; sign += 2)
                for (int above = 0; above <= 1; above++) {
                    double s[(SAMPLES + 1) * ROWS];
                    for (int i = 0; i <= SAMPLES; i++)
                        for (int g = 0; g < rows; g++)
                            s[i * rows + g] = g == guard ? 2 + sign * (i - 2) - (above ? 0 : 0.5) + 0.25 : 5;
                    assert_int_equal(ns_exact_event_samples_hold(s, rows, SAMPLES), above);
                }
}

static void no_guards(void **state) {
    (void)state;
    const double s = 0;
    assert_true(ns_exact_event_samples_hold(&s, 0, SAMPLES));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dips),
        cmocka_unit_test(lines),
        cmocka_unit_test(no_guards),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
