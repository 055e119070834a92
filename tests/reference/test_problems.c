/* tests/reference/test_problems.c - the problems of tests/problems/, each by AUTO and by every method alone.
 *
 * Expected: AUTO solves each, or says that the one marked "no solution" has none (its three pairs leave eight
 * modes, none of which has an answer).  A method alone may give up; it may not contradict that.
 */
#define _DEFAULT_SOURCE /* scandir */
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/text.h"

enum { SIZE = 1 << 16, EXPECTED = 17 };

/* Reads file and tells whether its first line says that there is no solution. */
static ns_mlcp *load(const char *name, int *none) {
    static char text[SIZE];
    char path[512];
    ns_mlcp *p = NULL;
    ns_text_fault fault;
    snprintf(path, sizeof path, "tests/problems/%s", name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t length = fread(text, 1, SIZE - 1, file);
    fclose(file);
    text[length] = '\0';
    if (ns_mlcp_read(text, length, &p, &fault) != NS_OK)
        fail_msg("%s: line %ld: %s", name, fault.line, fault.cause);
    const char *end = strchr(text, '\n'), *mark = strstr(text, "no solution");
    *none = mark && mark < end;
    return p;
}

/* Solves p by one method and prints a field of the table. */
static int solve(const ns_mlcp *p, int method, ns_mlcp_info *info) {
    ns_mlcp_solver *s;
    ns_mode mode[64] = {0};
    double lambda[64], y[64];
    assert_true(p->m <= 64);
    assert_int_equal(ns_mlcp_create(p->m, &s), NS_OK);
    assert_int_equal(ns_mlcp_use(s, (ns_mlcp_method)method), NS_OK);
    int status = ns_mlcp_solve(s, p, mode, lambda, y, info);
    double residual = status == NS_OK ? ns_mlcp_residual(p, lambda, NULL) : NAN;
    printf(" %9s", status == NS_OK ? "solved" : status == NS_E_INFEASIBLE ? "none" : "-");
    ns_mlcp_free(s);
    if (status == NS_OK && !(residual <= 1e-10)) /* what ns_mlcp_solve() accepts at most */
        fail_msg("residual %g", residual);
    return status;
}

static void one(const char *name) {
    int none;
    ns_mlcp *p = load(name, &none);
    ns_mlcp_info info;
    printf("%-38s %3d", name, p->m);
    int status = solve(p, NS_MLCP_AUTO, &info);
    assert_int_equal(status, none ? NS_E_INFEASIBLE : NS_OK);
    double residual = info.residual;
    const char *by = ns_mlcp_method_name(info.method);
    for (int method = NS_MLCP_AUTO + 1; method < NS_MLCP_METHODS; method++) {
        status = solve(p, method, &info);
        if (status == NS_OK)
            assert_false(none);
        if (status == NS_E_INFEASIBLE)
            assert_true(none);
    }
    printf("  %-9s %.1e\n", by, residual);
    ns_mlcp_discard(p);
}

static int is_problem(const struct dirent *entry) {
    const char *dot = strrchr(entry->d_name, '.');
    return dot && strcmp(dot, ".txt") == 0;
}

static void every_problem_of_the_collection(void **state) {
    (void)state;
    struct dirent **list;
    int n = scandir("tests/problems", &list, is_problem, alphasort);
    printf("%-38s %3s", "problem", "m");
    for (int method = NS_MLCP_AUTO; method < NS_MLCP_METHODS; method++)
        printf(" %9s", ns_mlcp_method_name(method));
    printf("  %-9s %s\n", "auto by", "residual");
    assert_int_equal(n, EXPECTED);
    for (int i = 0; i < n; i++) {
        one(list[i]->d_name);
        free(list[i]);
    }
    free(list);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_problem_of_the_collection)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
