/* tests/unit/bridge/test_version_text.c - the version of ngspice found in bytes as its data has them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "version_text.h"

#define NOTICE "Please file your bug-reports at http://ngspice.sourceforge.net/bugrep.html"

/* The array without the 0 that C adds. */
#define FOUND(bytes, version) ns_bridge_version_text(bytes, sizeof(bytes) - 1, version)

/* As 39.3 and 44.2 have it (conf.c by gcc 12 and 14), and the other way round. */
static void as_ngspice_has_it(void **state) {
    char version[VERSION_TEXT];
    (void)state;
    assert_true(FOUND("39\0Sun Feb  5 13:44:35 UTC 2023\0\0\0\0" NOTICE "\0"
                      "39\0\0\0\265T",
                      version));
    assert_string_equal(version, "39");
    assert_true(FOUND(NOTICE "\0\0\0\0"
                             "44.2\0Not\0",
                      version));
    assert_string_equal(version, "44.2");
    assert_true(FOUND("xx\0"
                      "46+\0\0\0\0" NOTICE "\0\0\0\0x",
                      version));
    assert_string_equal(version, "46+");
}

static void nothing_else_is_a_version(void **state) {
    char version[VERSION_TEXT] = "none";
    (void)state;
    assert_false(FOUND("44.2\0", version));
    assert_false(FOUND(NOTICE, version));
    assert_false(FOUND(NOTICE "\0", version));
    assert_false(FOUND("Please file your bug", version));
    assert_false(FOUND(NOTICE "\0"
                              "4\0"
                              "442\0"
                              "44x\0"
                              "44.2.x\0"
                              "44.22222222222222222222\0",
                       version));
    assert_false(FOUND(NOTICE "\0"
                              "44\0"
                              "45\0",
                       version)); /* two: which? */
    assert_false(FOUND(NOTICE "\0"
                              "44",
                       version)); /* no end */
    assert_false(ns_bridge_version_text("", 0, version));
}

/* The text begins again in its own beginning. */
static void false_starts(void **state) {
    char version[VERSION_TEXT];
    (void)state;
    assert_true(FOUND("PPlease fPlease file your PPP" NOTICE "\0"
                      "47\0",
                      version));
    assert_string_equal(version, "47");
}

static void majors(void **state) {
    (void)state;
    assert_int_equal(ns_bridge_version_major("39"), 39);
    assert_int_equal(ns_bridge_version_major("44.2"), 44);
    assert_int_equal(ns_bridge_version_major("46+"), 47);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(as_ngspice_has_it),
                                       cmocka_unit_test(nothing_else_is_a_version),
                                       cmocka_unit_test(false_starts), cmocka_unit_test(majors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
