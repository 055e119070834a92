/* tests/unit/base/test_status.c - every status has its own name and text. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/status.h"

static const int values[] = {
#define VALUE(name, value, text) value,
    NS_STATUS_TABLE(VALUE)
#undef VALUE
};
enum { COUNT = (int)(sizeof values / sizeof *values) };

static void names_and_texts_are_those_of_the_table(void **state) {
    (void)state;
    assert_string_equal(ns_status_name(NS_OK), "NS_OK");
    assert_string_equal(ns_status_text(NS_OK), "ok");
    assert_string_equal(ns_status_name(NS_E_INFEASIBLE), "NS_E_INFEASIBLE");
    assert_string_equal(ns_status_text(NS_E_INFEASIBLE), "no solution exists");
}

static void no_two_are_alike(void **state) {
    (void)state;
    for (int a = 0; a < COUNT; a++)
        for (int b = 0; b < a; b++) {
            assert_string_not_equal(ns_status_name(values[a]), ns_status_name(values[b]));
            assert_string_not_equal(ns_status_text(values[a]), ns_status_text(values[b]));
        }
}

static void values_outside_the_table_are_said_to_be_unknown(void **state) {
    (void)state;
    const int odd[] = {3, 1000, -15, -1000000};
    for (int k = 0; k < 4; k++) {
        assert_string_equal(ns_status_name(odd[k]), "?");
        assert_string_equal(ns_status_text(odd[k]), "unknown status");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_texts_are_those_of_the_table),
        cmocka_unit_test(no_two_are_alike),
        cmocka_unit_test(values_outside_the_table_are_said_to_be_unknown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
