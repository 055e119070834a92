/* tests/unit/bridge/test_options.c - the options of a run: what is refused, and in which words. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "options.h"

/* What ngspice has of a model without parameters. */
static ns_options_given nothing_given(void) {
    return (ns_options_given){.name = "aopt",
                              .method = "auto",
                              .h = NAN,
                              .reltol = NAN,
                              .theta = 1.0,
                              .gamma = 1.0,
                              .corners = 1,
                              .points = "auto",
                              .lines = 1e-4,
                              .id = NAN,
                              .vgs = NAN};
}

static void assert_refused(const ns_options_given *given, const char *wanted) {
    ns_bridge_options o = ns_bridge_options_default;
    char line[200] = "";
    assert_int_equal(ns_bridge_options_check(given, &o, line, sizeof line), NS_E_RANGE);
    assert_string_equal(line, wanted);
}

static void assert_taken(const ns_options_given *given, ns_bridge_options *o) {
    char line[200] = "";
    *o = ns_bridge_options_default;
    assert_int_equal(ns_bridge_options_check(given, o, line, sizeof line), NS_OK);
    assert_string_equal(line, "");
}

static void no_parameters_are_the_defaults(void **state) {
    const ns_options_given given = nothing_given();
    const ns_bridge_options *d = &ns_bridge_options_default;
    ns_bridge_options o;
    (void)state;
    assert_taken(&given, &o);
    assert_int_equal(o.method, NS_AUTO);
    assert_true(o.h == 0.0 && o.reltol == 0.0 && o.theta == 1.0 && o.gamma == 1.0);
    assert_true(o.verbose == 0 && o.corners == 1 && o.grid == 0 && o.lines == 1e-4);
    assert_true(o.method == d->method && o.h == d->h && o.theta == d->theta && o.gamma == d->gamma &&
                o.reltol == d->reltol && o.verbose == d->verbose && o.corners == d->corners &&
                o.grid == d->grid && o.lines == d->lines && isnan(o.id) && isnan(d->id) && o.cjo == d->cjo);
    assert_true(!o.take_switches && !o.take_diodes && !o.zero_diodes);
}

static void all_parameters_are_taken(void **state) {
    const ns_options_given given = {.name = "aopt",
                                    .method = "theta",
                                    .h = 1e-6,
                                    .reltol = 1e-4,
                                    .theta = 0.5,
                                    .gamma = 0.75,
                                    .points = "grid",
                                    .lines = 1e-3,
                                    .take = "all",
                                    .diode = "zero",
                                    .id = 2,
                                    .cjo = 1,
                                    .mosfet = "switch",
                                    .vgs = 5,
                                    .verbose = 1};
    ns_bridge_options o;
    (void)state;
    assert_taken(&given, &o);
    assert_int_equal(o.method, NS_THETA);
    assert_true(o.h == 1e-6 && o.reltol == 1e-4 && o.theta == 0.5 && o.gamma == 0.75);
    assert_true(o.verbose == 1 && o.corners == 0 && o.grid == 1 && o.lines == 1e-3);
    assert_true(o.take_switches && o.take_diodes && o.zero_diodes && o.id == 2 && o.cjo == 1);
    assert_true(o.mosfets == NS_MOSFETS_ALL && o.vgs == 5);
}

static void part_of_the_devices_is_taken(void **state) {
    static const char *const words[] = {"none", "switches", "diodes", "all"};
    ns_options_given given = nothing_given();
    ns_bridge_options o;
    (void)state;
    for (int k = 0; k < 4; k++) {
        given.take = words[k];
        assert_taken(&given, &o);
        assert_true(o.take_switches == (k == 1 || k == 3) && o.take_diodes == (k >= 2));
    }
    given.take = "most";
    assert_refused(&given, "aopt: take = \"most\" must be \"none\", \"switches\", \"diodes\" or \"all\"");
    given.take = NULL;
    given.diode = "ideal";
    assert_refused(&given, "aopt: diode = \"ideal\" must be \"model\" or \"zero\"");
    given.diode = NULL;
    given.mosfet = "none";
    assert_taken(&given, &o);
    assert_true(o.mosfets == NS_MOSFETS_NONE && isnan(o.vgs));
    given.mosfet = "driven";
    assert_taken(&given, &o);
    assert_true(o.mosfets == NS_MOSFETS_DRIVEN);
    given.mosfet = "on";
    assert_refused(&given, "aopt: mosfet = \"on\" must be \"none\", \"driven\" or \"switch\"");
}

static void every_method_has_its_word(void **state) {
    static const ns_method methods[] = {NS_AUTO, NS_THETA, NS_EXACT, NS_SPARSE};
    ns_options_given given = nothing_given();
    ns_bridge_options o;
    (void)state;
    for (size_t k = 0; k < sizeof methods / sizeof methods[0]; k++) {
        given.method = ns_bridge_options_method(methods[k]);
        assert_taken(&given, &o);
        assert_int_equal(o.method, methods[k]);
    }
    given.method = NULL;
    assert_taken(&given, &o);
    assert_int_equal(o.method, NS_AUTO);
}

static void unknown_methods_are_refused(void **state) {
    static const char *const words[] = {"gear", "Exact", "", "exact "};
    ns_options_given given = nothing_given();
    char wanted[200];
    (void)state;
    for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
        given.method = words[k];
        snprintf(wanted, sizeof wanted,
                 "aopt: method = \"%s\" must be \"auto\", \"exact\", \"sparse\" or \"theta\"", words[k]);
        assert_refused(&given, wanted);
    }
}

/* Sets one number of `given` to value and looks at the message; NULL: it is taken. */
static void assert_number(ns_options_given *given, double *number, double value, const char *wanted) {
    const double before = *number;
    ns_bridge_options o;
    *number = value;
    if (wanted) {
        assert_refused(given, wanted);
    } else {
        assert_taken(given, &o);
    }
    *number = before;
}

static void numbers_have_ranges(void **state) {
    ns_options_given g = nothing_given();
    (void)state;
    assert_number(&g, &g.h, 0.0, "aopt: h = 0 s must be above 0");
    assert_number(&g, &g.h, -1e-6, "aopt: h = -1e-06 s must be above 0");
    assert_number(&g, &g.h, INFINITY, "aopt: h = inf s must be above 0");
    assert_number(&g, &g.h, 5e-324, NULL);
    assert_number(&g, &g.theta, 0.0, "aopt: theta = 0 must be above 0 and at most 1");
    assert_number(&g, &g.theta, nextafter(1.0, 2.0), "aopt: theta = 1 must be above 0 and at most 1");
    assert_number(&g, &g.theta, 5e-324, NULL);
    assert_number(&g, &g.gamma, 0.0, "aopt: gamma = 0 must be above 0 and at most 1");
    assert_number(&g, &g.gamma, 1.5, "aopt: gamma = 1.5 must be above 0 and at most 1");
    assert_number(&g, &g.gamma, NAN, "aopt: gamma = nan must be above 0 and at most 1");
    assert_number(&g, &g.reltol, 0.0, "aopt: reltol = 0 must be above 0 and below 1");
    assert_number(&g, &g.reltol, 1.0, "aopt: reltol = 1 must be above 0 and below 1");
    assert_number(&g, &g.reltol, nextafter(1.0, 0.0), NULL);
    assert_number(&g, &g.id, 0.0, "aopt: id = 0 A must be above 0");
    assert_number(&g, &g.vgs, 0.0, "aopt: vgs = 0 V must be above 0");
    assert_number(&g, &g.id, INFINITY, "aopt: id = inf A must be above 0");
}

static void flags_are_0_or_1(void **state) {
    ns_options_given given = nothing_given();
    ns_bridge_options o;
    (void)state;
    given.verbose = 2;
    assert_refused(&given, "aopt: verbose = 2 must be 0 or 1");
    given.verbose = 1;
    assert_taken(&given, &o);
    given.corners = -1;
    assert_refused(&given, "aopt: corners = -1 must be 0 or 1");
    given.corners = 1;
    given.cjo = 2;
    assert_refused(&given, "aopt: cjo = 2 must be 0 or 1");
}

static void the_line_is_cut_at_its_size(void **state) {
    ns_options_given given = nothing_given();
    ns_bridge_options o;
    char line[12];
    (void)state;
    given.method = "gear";
    assert_int_equal(ns_bridge_options_check(&given, &o, line, sizeof line), NS_E_RANGE);
    assert_string_equal(line, "aopt: metho");
}

static void points_and_lines_are_checked(void **state) {
    ns_options_given given = nothing_given();
    (void)state;
    given.points = "few";
    assert_refused(&given, "aopt: points = \"few\" must be \"auto\" or \"grid\"");
    given = nothing_given();
    given.lines = 0.0;
    assert_refused(&given, "aopt: lines = 0 must be above 0 and at most 0.1");
    given.lines = 0.2;
    assert_refused(&given, "aopt: lines = 0.2 must be above 0 and at most 0.1");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_and_lines_are_checked), cmocka_unit_test(no_parameters_are_the_defaults),
        cmocka_unit_test(all_parameters_are_taken),     cmocka_unit_test(part_of_the_devices_is_taken),
        cmocka_unit_test(every_method_has_its_word),    cmocka_unit_test(unknown_methods_are_refused),
        cmocka_unit_test(numbers_have_ranges),          cmocka_unit_test(flags_are_0_or_1),
        cmocka_unit_test(the_line_is_cut_at_its_size),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
