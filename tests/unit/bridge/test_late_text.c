/* tests/unit/bridge/test_late_text.c - the line for a late output names what is in the circuit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "late_text.h"

static void an_oscillator_is_named(void **state) {
    char text[400];
    (void)state;
    ns_bridge_late_text(text, sizeof text, 0.25, "adac", "aosc", "d_osc");
    assert_non_null(strstr(text, "at t = 0.25 s: aosc (d_osc) changed its output"));
    assert_non_null(strstr(text, "frequency"));
    assert_null(strstr(text, "adac"));
}

static void without_one_the_bridge_is(void **state) {
    char text[400];
    (void)state;
    ns_bridge_late_text(text, sizeof text, 0.25, "adac", NULL, NULL);
    assert_non_null(strstr(text, "at t = 0.25 s: the digital input of adac (dac_bridge) changed"));
    assert_null(strstr(text, "frequency"));
}

static void long_names_are_cut(void **state) {
    char text[40], name[500];
    (void)state;
    memset(name, 'x', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    ns_bridge_late_text(text, sizeof text, 0.25, name, NULL, NULL);
    assert_int_equal(strlen(text), sizeof text - 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_oscillator_is_named),
        cmocka_unit_test(without_one_the_bridge_is),
        cmocka_unit_test(long_names_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
