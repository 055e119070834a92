/* tests/unit/mlcp/test_text.c - a problem as text: what is read, what is refused and where, what is written.
 */
#define _POSIX_C_SOURCE 200809L /* mkdtemp(), setenv() */
#include <float.h>
#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "nonsmooth/text.h"
#include "wrap_alloc.h"

static ns_mlcp *read_ok(const char *text) {
    ns_mlcp *p = NULL;
    ns_text_fault fault;
    const int status = ns_mlcp_read(text, strlen(text), &p, &fault);
    if (status != NS_OK)
        fail_msg("line %ld: %s", fault.line, fault.cause);
    assert_non_null(p);
    return p;
}

/* Bit for bit: -0 is not 0. */
static void assert_same(const double *a, const double *b, size_t n) {
    if (n > 0)
        assert_memory_equal(a, b, n * sizeof *a);
}

static void reads_rows_into_columns(void **state) {
    (void)state;
    const double W[4] = {1, 3, 2, 4}, q[2] = {-1, 0.5}, l[2] = {0, -INFINITY}, u[2] = {INFINITY, 7};
    ns_mlcp *p = read_ok("# two pairs\n2\n1 2 # first row\n3\t4\r\n-1 +.5\n0 -inf\nInf\v7.#end");
    assert_int_equal(p->m, 2);
    assert_same(p->W, W, 4);
    assert_same(p->q, q, 2);
    assert_same(p->l, l, 2);
    assert_same(p->u, u, 2);
    ns_mlcp_discard(p);
    ns_mlcp_discard(NULL);
}

static void no_pairs_are_a_problem_too(void **state) {
    (void)state;
    ns_mlcp *p = read_ok(" +0 # that is all");
    char text[4];
    size_t length = 0;
    assert_int_equal(p->m, 0);
    assert_int_equal(ns_mlcp_write(p, text, sizeof text, &length), NS_OK);
    assert_string_equal(text, "0\n");
    assert_int_equal(length, 2);
    ns_mlcp_discard(p);
}

/* What C calls decimal, and its nearest double. */
static void numbers_are_the_nearest_double(void **state) {
    (void)state;
    const struct {
        const char *text;
        double value;
    } some[] = {{"1e3", 1000},
                {"1E+3", 1000},
                {"-1.5e-3", -0.0015},
                {".5", 0.5},
                {"5.", 5},
                {"-0", -0.0},
                {"007", 7},
                {"1e-400", 0}, /* too small for a double */
                {"4.9406564584124654e-324", DBL_TRUE_MIN},
                {"1.7976931348623157e308", DBL_MAX},
                {"0.1000000000000000055511151231257827021181583404541015625", 0.1}};
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        char text[100];
        snprintf(text, sizeof text, "1 %s 0 0 inf", some[k].text);
        ns_mlcp *p = read_ok(text);
        assert_same(p->W, &some[k].value, 1);
        ns_mlcp_discard(p);
    }
}

static void a_number_may_have_all_its_digits(void **state) {
    (void)state;
    char text[1100];
    for (int digits = 1000; digits <= 1001; digits++) { /* the longest that is taken, and one more */
        ns_mlcp *p = NULL;
        ns_text_fault fault;
        const int before = snprintf(text, sizeof text, "1\n");
        memset(text + before, '0', (size_t)digits);
        snprintf(text + before + digits, sizeof text - (size_t)(before + digits), " 0 0 inf");
        const int status = ns_mlcp_read(text, strlen(text), &p, &fault);
        assert_int_equal(status, digits == 1000 ? NS_OK : NS_E_NUMBER);
        if (status != NS_OK) {
            assert_int_equal(fault.line, 2);
            assert_string_equal(fault.cause,
                                "W(1,1) is '000000000000000000000000'..., longer than 1000 characters");
        }
        ns_mlcp_discard(p);
    }
}

/* --- refusals --- */

static void assert_refused(const char *text, size_t length, int expected, long line, const char *cause) {
    static ns_mlcp other;
    ns_mlcp *p = &other;
    ns_text_fault fault;
    const int status = ns_mlcp_read(text, length, &p, &fault);
    if (status != expected || fault.line != line || strcmp(fault.cause, cause) != 0)
        fail_msg("'%s': %s, line %ld, '%s'; expected %s, line %ld, '%s'", text, ns_status_name(status),
                 fault.line, fault.cause, ns_status_name(expected), line, cause);
    assert_null(p);
    assert_int_equal(ns_mlcp_read(text, length, &p, NULL), expected); /* nobody asks why */
}

static void every_error_has_line_and_cause(void **state) {
    (void)state;
    const struct {
        const char *text;
        int status;
        long line;
        const char *cause;
    } bad[] = {
        {"", NS_E_SIZE, 1, "the text ends before m"},
        {"# 3\n# no more\n", NS_E_SIZE, 1, "the text ends before m"},
        {"\n-1", NS_E_SIZE, 2, "m is '-1', below 0"},
        {"2.0", NS_E_NUMBER, 1, "m is '2.0', which is no integer"},
        {"two", NS_E_NUMBER, 1, "m is 'two', which is no integer"},
        {"-", NS_E_NUMBER, 1, "m is '-', which is no number"},
        {"2147483648", NS_E_SIZE, 1, "m is '2147483648', too large"},
        {"99999999999999999999", NS_E_SIZE, 1, "m is '99999999999999999999', too large"},
        {"2147483647 1", NS_E_SIZE, 1, "the text ends before W(1,2), after 1 of 4611686020574871550 numbers"},
        {"2\n1 2\n3 4\n\n5\n\n", NS_E_SIZE, 5, "the text ends before q(2), after 5 of 10 numbers"},
        {"1\n1\n2\n0\n", NS_E_SIZE, 4, "the text ends before u(1), after 3 of 4 numbers"},
        {"1 1 2 0 inf\n# over\n9", NS_E_SIZE, 3, "'9' after the last number"},
        {"0\n\n1", NS_E_SIZE, 3, "'1' after the last number"},
        {"2\n1 2\n1..5 4", NS_E_NUMBER, 3, "W(2,1) is '1..5', which is no number"},
        {"1 1e 0 0 1", NS_E_NUMBER, 1, "W(1,1) is '1e', which is no number"},
        {"1 1e+ 0 0 1", NS_E_NUMBER, 1, "W(1,1) is '1e+', which is no number"},
        {"1 . 0 0 1", NS_E_NUMBER, 1, "W(1,1) is '.', which is no number"},
        {"1 0x10 0 0 1", NS_E_NUMBER, 1, "W(1,1) is '0x10', which is no number"},
        {"1 1,5 0 0 1", NS_E_NUMBER, 1, "W(1,1) is '1,5', which is no number"},
        {"1 1 nan 0 1", NS_E_NUMBER, 1, "q(1) is 'nan', which is no number"},
        {"1 1 0 NaN 1", NS_E_NUMBER, 1, "l(1) is 'NaN', which is no number"},
        {"1 inf 0 0 1", NS_E_NUMBER, 1, "W(1,1) is infinite; only l and u may be"},
        {"1 1\n-Infinity 0 1", NS_E_NUMBER, 2, "q(1) is infinite; only l and u may be"},
        {"1 1 0 0 infinit", NS_E_NUMBER, 1, "u(1) is 'infinit', which is no number"},
        {"1 1 0\n1e309 inf", NS_E_NUMBER, 2, "l(1) is '1e309', more than a double can hold"},
        {"1 \x1b[2J 0 0 1", NS_E_NUMBER, 1, "W(1,1) is '?[2J', which is no number"},
        {"1 1 0 2\n1", NS_E_BOUNDS, 2, "l(1) = 2 is above u(1) = 1"},
        {"2 1 0 0 1 0 0 0 0\n1\n-.5", NS_E_BOUNDS, 3, "l(2) = 0 is above u(2) = -0.5"},
        {"1 1 0 inf inf", NS_E_BOUNDS, 1, "l(1) and u(1) are both inf"},
        {"1 1 0 -inf -inf", NS_E_BOUNDS, 1, "l(1) and u(1) are both -inf"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        assert_refused(bad[k].text, strlen(bad[k].text), bad[k].status, bad[k].line, bad[k].cause);
    assert_refused("1 1\0 0 0 1", 10, NS_E_NUMBER, 1, "W(1,1) is '1?', which is no number");
    assert_refused("1 1\0", 4, NS_E_NUMBER, 1, "W(1,1) is '1?', which is no number");
}

/* The text ends where length says, whatever stands behind. */
static void length_counts(void **state) {
    (void)state;
    const char text[] = "1 1 0 0 123";
    ns_mlcp *p = NULL;
    assert_int_equal(ns_mlcp_read(text, strlen(text) - 1, &p, NULL), NS_OK);
    assert_true(p->u[0] == 12);
    ns_mlcp_discard(p);
}

static void missing_arguments_are_refused(void **state) {
    (void)state;
    double one[1] = {1}, bad[1] = {NAN}, inf[1] = {INFINITY};
    ns_mlcp *p = NULL, good = {.m = 1, .W = one, .q = one, .l = one, .u = one}, wrong = good;
    ns_text_fault fault;
    char text[8];
    size_t length = 0;
    assert_int_equal(ns_mlcp_read("0", 1, NULL, &fault), NS_E_NULL);
    assert_int_equal(ns_mlcp_read(NULL, 1, &p, &fault), NS_E_NULL);
    assert_int_equal(ns_mlcp_read(NULL, 0, &p, &fault), NS_E_SIZE); /* an empty text is one */
    assert_int_equal(ns_mlcp_write(NULL, text, sizeof text, &length), NS_E_NULL);
    assert_int_equal(ns_mlcp_write(&good, text, sizeof text, NULL), NS_E_NULL);
    assert_int_equal(ns_mlcp_write(&good, NULL, sizeof text, &length), NS_E_NULL);
    wrong.W = NULL;
    assert_int_equal(ns_mlcp_write(&wrong, text, sizeof text, &length), NS_E_NULL);
    wrong = good, wrong.m = -1;
    assert_int_equal(ns_mlcp_write(&wrong, text, sizeof text, &length), NS_E_SIZE);
    wrong = good, wrong.W = inf;
    assert_int_equal(ns_mlcp_write(&wrong, text, sizeof text, &length), NS_E_NUMBER);
    wrong = good, wrong.q = inf;
    assert_int_equal(ns_mlcp_write(&wrong, text, sizeof text, &length), NS_E_NUMBER);
    wrong = good, wrong.u = bad;
    assert_int_equal(ns_mlcp_write(&wrong, text, sizeof text, &length), NS_E_NUMBER);
    wrong = good, wrong.l = inf;
    assert_int_equal(ns_mlcp_write(&wrong, text, sizeof text, &length), NS_E_BOUNDS);
    wrong.u = inf;
    assert_int_equal(ns_mlcp_write(&wrong, text, sizeof text, &length), NS_E_BOUNDS);
}

/* --- the writer --- */

static void writes_few_digits(void **state) {
    (void)state;
    double W[4] = {1, 3, 0.1, -0.0}, q[2] = {1e300, 1.0 / 3}, l[2] = {-INFINITY, 0}, u[2] = {INFINITY, 5};
    const ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u};
    const char *expected = "2\n1 0.1\n3 -0\n1e+300 0.3333333333333333\n-inf 0\ninf 5\n";
    char text[100];
    size_t length = 0;
    assert_int_equal(ns_mlcp_write(&p, text, sizeof text, &length), NS_OK);
    assert_string_equal(text, expected);
    assert_int_equal(length, strlen(expected));
    for (size_t size = 0; size <= strlen(expected); size++) { /* cut, terminated, nothing behind */
        memset(text, '!', sizeof text);
        assert_int_equal(ns_mlcp_write(&p, size ? text : NULL, size, &length), NS_OK);
        assert_int_equal(length, strlen(expected));
        if (size > 0) {
            assert_memory_equal(text, expected, size - 1);
            assert_int_equal(text[size - 1], '\0');
        }
        assert_int_equal(text[size], '!');
    }
}

/* Any bits that are a finite number. */
static double any_double(dice *d) {
    for (;;) {
        uint64_t bits = 0;
        double v;
        for (int k = 0; k < 8; k++)
            bits = bits << 8 | (uint64_t)dice_below(d, 256);
        memcpy(&v, &bits, sizeof v);
        if (isfinite(v))
            return v;
    }
}

static void round_trip(int m, dice *d) {
    const size_t M = (size_t)m, all = M * M + 3 * M;
    double *v = malloc(all * sizeof *v);
    size_t length = 0;
    ns_mlcp *back = NULL;
    assert_non_null(v);
    for (size_t k = 0; k < all; k++)
        v[k] = any_double(d);
    double *l = v + M * M + M, *u = l + M;
    for (size_t i = 0; i < M; i++) {
        const double a = l[i], b = u[i];
        l[i] = dice_chance(d, 0.2) ? -INFINITY : fmin(a, b);
        u[i] = dice_chance(d, 0.2) ? INFINITY : fmax(a, b);
    }
    const ns_mlcp p = {.m = m, .W = v, .q = v + M * M, .l = l, .u = u};
    assert_int_equal(ns_mlcp_write(&p, NULL, 0, &length), NS_OK);
    char *text = malloc(length + 1);
    assert_non_null(text);
    assert_int_equal(ns_mlcp_write(&p, text, length + 1, &length), NS_OK);
    assert_int_equal(ns_mlcp_read(text, length, &back, NULL), NS_OK);
    assert_int_equal(back->m, m);
    assert_same(back->W, p.W, M * M);
    assert_same(back->q, p.q, M);
    assert_same(back->l, p.l, M);
    assert_same(back->u, p.u, M);
    ns_mlcp_discard(back);
    free(text);
    free(v);
}

static void what_is_written_is_read_bit_for_bit(void **state) {
    (void)state;
    for (unsigned k = 0; k < 40; k++) {
        dice d = dice_make(77, k);
        round_trip(1 + (int)k % 17, &d);
    }
}

/* --- locale, memory --- */

/* A locale whose decimal point is a comma, made in a folder of its own: whoever has none, has localedef. */
static int set_comma(char folder[32]) {
    char command[120];
    snprintf(folder, 32, "/tmp/test_text.XXXXXX");
    if (!mkdtemp(folder))
        return 0;
    snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/comma >/dev/null 2>&1", folder);
    const int made = system(command);
    return made == 0 && setenv("LOCPATH", folder, 1) == 0 && setlocale(LC_ALL, "comma") != NULL &&
           strcmp(localeconv()->decimal_point, ",") == 0;
}

static void remove_comma(const char *folder) {
    char command[60];
    setlocale(LC_ALL, "C");
    snprintf(command, sizeof command, "rm -rf %s", folder);
    assert_int_equal(system(command), 0);
}

static void the_point_is_a_point_in_any_locale(void **state) {
    (void)state;
    char folder[32];
    assert_true(set_comma(folder));
    char text[40], shown[8];
    size_t length = 0;
    ns_mlcp *p = read_ok("1 1.5 -.25 0 inf");
    assert_true(p->W[0] == 1.5 && p->q[0] == -0.25);
    assert_int_equal(ns_mlcp_write(p, text, sizeof text, &length), NS_OK);
    assert_string_equal(text, "1\n1.5\n-0.25\n0\ninf\n");
    snprintf(shown, sizeof shown, "%.1f", 1.5); /* the program's own locale is as it was */
    assert_string_equal(shown, "1,5");
    ns_mlcp_discard(p);
    remove_comma(folder);
}

/* 12 pairs are 180 numbers: their room grows three times. */
static void every_allocation_may_fail(void **state) {
    (void)state;
    char text[2000];
    size_t end = (size_t)snprintf(text, sizeof text, "12\n");
    for (int k = 0; k < 180; k++)
        end += (size_t)snprintf(text + end, sizeof text - end, k < 168 ? "0 " : "inf ");
    for (long k = 1;; k++) {
        ns_mlcp other, *p = &other;
        ns_text_fault fault;
        fail_alloc_at(k);
        const int status = ns_mlcp_read(text, strlen(text), &p, &fault);
        const long made = allocs_made();
        fail_alloc_off();
        if (made < k) {
            assert_int_equal(status, NS_OK);
            assert_int_equal(k, 1 + 1 + 3); /* the problem, 64, 128, 180 numbers, and the way out */
            ns_mlcp_discard(p);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(p);
        assert_int_equal(fault.line, 0);
        assert_string_equal(fault.cause, ns_status_text(NS_E_MEMORY));
    }
}

/* A promise of 4.6e18 numbers takes no more memory than what there is of them. */
static void a_large_m_costs_nothing(void **state) {
    (void)state;
    ns_mlcp *p = NULL;
    fail_alloc_at(3); /* the problem, a first room: no more */
    const int status = ns_mlcp_read("2000000000 1 2 3", 16, &p, NULL);
    fail_alloc_off();
    assert_int_equal(status, NS_E_SIZE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_rows_into_columns),
        cmocka_unit_test(no_pairs_are_a_problem_too),
        cmocka_unit_test(numbers_are_the_nearest_double),
        cmocka_unit_test(a_number_may_have_all_its_digits),
        cmocka_unit_test(every_error_has_line_and_cause),
        cmocka_unit_test(length_counts),
        cmocka_unit_test(missing_arguments_are_refused),
        cmocka_unit_test(writes_few_digits),
        cmocka_unit_test(what_is_written_is_read_bit_for_bit),
        cmocka_unit_test(the_point_is_a_point_in_any_locale),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(a_large_m_costs_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
