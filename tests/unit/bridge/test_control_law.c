/* tests/unit/bridge/test_control_law.c - frequency or duty cycle by a control: straight lines between points.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "control_law.h"

/* Flat at 1 up to 0, then by 2 to 3 at 1, then by -1 on. */
static double x[] = {-1.0, 0.0, 1.0, 2.0}, y[] = {1.0, 1.0, 3.0, 2.0};
static const ns_control_law law = {4, x, y};

static void values_on_lines_and_beyond(void **state) {
    (void)state;
    assert_true(ns_bridge_control_law_value(&law, -5.0) == 1.0);
    assert_true(ns_bridge_control_law_value(&law, 0.25) == 1.5);
    assert_true(ns_bridge_control_law_value(&law, 1.5) == 2.5);
    assert_true(ns_bridge_control_law_value(&law, 3.0) == 1.0);
    assert_true(ns_bridge_control_law_value(&law, 5.0) == 0.0); /* not below 0, as d_osc has it */
    assert_true(ns_bridge_control_law_slope(&law, 0.25) == 2.0 &&
                ns_bridge_control_law_slope(&law, 9.0) == -1.0);
}

static void integral_of_a_line(void **state) {
    (void)state;
    assert_true(fabs(ns_bridge_control_law_integral(&law, 0.0, 1.0, 3.0) - 6.0) < 1e-14);
    /* over the corner at 0, which is at the end of a part: 2 s of 1 and 2 s of 1 to 3 */
    assert_true(fabs(ns_bridge_control_law_integral(&law, -1.0, 1.0, 4.0) - 6.0) < 1e-14);
}

static void nearest_control_of_a_value(void **state) {
    (void)state;
    assert_true(ns_bridge_control_law_control(&law, 2.5, 0.0) == 0.75);
    assert_true(ns_bridge_control_law_control(&law, 2.5, 2.0) == 1.5);
    assert_true(ns_bridge_control_law_control(&law, 1.0, -0.5) == -0.5); /* there already */
    assert_true(ns_bridge_control_law_control(&law, 1.5, -0.5) == 0.25); /* from where it is flat */
    assert_true(ns_bridge_control_law_control(&law, 3.5, 0.5) == 0.5);   /* nowhere */
    assert_true(ns_bridge_control_law_control(&law, 0.5, 1.9) == 3.5);   /* beyond the last point */
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(values_on_lines_and_beyond),
                                       cmocka_unit_test(integral_of_a_line),
                                       cmocka_unit_test(nearest_control_of_a_value)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
