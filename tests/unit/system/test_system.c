/* tests/unit/system/test_system.c - systems made and checked. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/system.h"

static ns_system *make(int n, int m, int nz, int nc) {
    ns_system *s = NULL;
    assert_int_equal(ns_system_create(n, m, nz, nc, &s), NS_OK);
    return s;
}

static void starts_zero_and_complementary(void **state) {
    ns_system *s = make(3, 2, 1, 1);
    (void)state;
    for (int i = 0; i < 9; i++) {
        assert_true(s->M[i] == 0 && s->A[i] == 0);
    }
    for (int i = 0; i < 2; i++) {
        assert_true(s->l[i] == 0 && isinf(s->u[i]) && s->u[i] > 0);
    }
    assert_true(s->command[0].gx == NULL && s->command[0].gz == NULL);
    assert_int_equal(ns_system_check(s, NULL), NS_OK);
    ns_system_free(s);
    s = make(0, 0, 0, 0);
    assert_true(s->M == NULL && s->D == NULL && s->z == NULL && s->command == NULL);
    assert_int_equal(ns_system_check(s, NULL), NS_OK);
    ns_system_free(s);
    ns_system_free(NULL);
}

static void bad_sizes_are_refused(void **state) {
    ns_system *s = (ns_system *)1;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 1, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_system_create(-1, 1, 1, 1, &s), NS_E_SIZE);
    assert_null(s);
    assert_int_equal(ns_system_create(1, 1, 1, -1, &s), NS_E_SIZE);
    assert_int_equal(ns_system_create(2147483647, 1, 1, 1, &s), NS_E_MEMORY); /* 2^65 bytes */
    assert_null(s);
}

static void inputs_are_copied(void **state) {
    double t[] = {0, 1}, v[] = {0, 4}, z[2];
    ns_system *s = make(1, 0, 2, 0);
    ns_signal in = {.kind = NS_PWL};
    in.u.pwl.n = 2;
    in.u.pwl.t = t;
    in.u.pwl.v = v;
    in.u.pwl.repeat = NAN;
    (void)state;
    assert_int_equal(ns_system_set_input(s, 1, &in), NS_OK);
    assert_int_equal(ns_system_set_input(s, 1, &in), NS_OK); /* in place of the first */
    v[1] = 100;
    ns_system_inputs(s, 0.5, NS_RIGHT, z);
    assert_true(z[0] == 0 && z[1] == 2);
    in.u.pwl.n = 0;
    assert_int_equal(ns_system_set_input(s, 1, &in), NS_E_SIZE);
    assert_int_equal(ns_system_set_input(s, 2, &in), NS_E_SIZE);
    assert_int_equal(ns_system_set_input(s, -1, &in), NS_E_SIZE);
    assert_int_equal(ns_system_set_input(s, 0, NULL), NS_E_NULL);
    assert_int_equal(ns_system_set_input(NULL, 0, &in), NS_E_NULL);
    ns_system_inputs(s, 0.5, NS_RIGHT, z);
    assert_true(z[1] == 2); /* a refusal leaves the input alone */
    ns_system_free(s);
}

/* Puts a value at one place, expects a refusal that names it, puts the old value back. */
static void expect(ns_system *s, double *at, double bad, int status, int pair, int unknown) {
    double old = *at;
    ns_fault f;
    *at = bad;
    assert_int_equal(ns_system_check(s, &f), status);
    assert_int_equal(f.status, status);
    assert_true(isnan(f.t));
    assert_int_equal(f.npairs, pair >= 0);
    assert_int_equal(f.nunknowns, unknown >= 0);
    if (pair >= 0) {
        assert_int_equal(f.pair[0], pair);
    }
    if (unknown >= 0) {
        assert_int_equal(f.unknown[0], unknown);
    }
    *at = old;
    assert_int_equal(ns_system_check(s, NULL), NS_OK);
}

static void check_names_the_place(void **state) {
    ns_system *s = make(3, 2, 1, 0);
    (void)state;
    expect(s, &s->M[2 + 3 * 1], NAN, NS_E_NUMBER, -1, 1);
    expect(s, &s->A[0 + 3 * 2], INFINITY, NS_E_NUMBER, -1, 2);
    expect(s, &s->B[2 + 3 * 1], NAN, NS_E_NUMBER, 1, -1);
    expect(s, &s->C[1 + 2 * 2], NAN, NS_E_NUMBER, -1, 2);
    expect(s, &s->D[1], NAN, NS_E_NUMBER, 0, -1);
    expect(s, &s->b[1], NAN, NS_E_NUMBER, -1, 1);
    expect(s, &s->E[2], NAN, NS_E_NUMBER, -1, 2);
    expect(s, &s->e[1], NAN, NS_E_NUMBER, 1, -1);
    expect(s, &s->F[1], NAN, NS_E_NUMBER, 1, -1);
    expect(s, &s->l[1], NAN, NS_E_NUMBER, 1, -1);
    expect(s, &s->l[1], INFINITY, NS_E_NUMBER, 1, -1);
    expect(s, &s->u[0], -1, NS_E_BOUNDS, 0, -1);
    expect(s, &s->z[0].u.dc, NAN, NS_E_NUMBER, -1, -1);
    assert_int_equal(ns_system_check(NULL, NULL), NS_E_NULL);
    double *ground = s->ground;
    s->ground = NULL; /* as in a system that ns_system_create() did not make */
    assert_int_equal(ns_system_check(s, NULL), NS_E_NULL);
    s->ground = ground;
    free(s->balance);
    s->balance = NULL; /* the same */
    assert_int_equal(ns_system_check(s, NULL), NS_E_NULL);
    ns_system_free(s);
}

static void commands_are_checked(void **state) {
    ns_system *s = make(1, 2, 0, 2);
    ns_fault f;
    (void)state;
    s->command[1].pair = 1;
    s->l[1] = 5; /* bounds of a commanded pair mean nothing */
    s->u[1] = 2;
    assert_int_equal(ns_system_check(s, NULL), NS_OK);
    s->l[0] = NAN;
    assert_int_equal(ns_system_check(s, NULL), NS_OK);
    expect(s, &s->command[1].off, 1, NS_E_RANGE, 1, -1);
    expect(s, &s->command[0].on, NAN, NS_E_NUMBER, 0, -1);
    expect(s, &s->command[0].g0, INFINITY, NS_E_NUMBER, 0, -1);
    s->command[0].gx = calloc(1, sizeof(double));
    expect(s, s->command[0].gx, NAN, NS_E_NUMBER, 0, -1);
    s->command[0].pair = 1;
    assert_int_equal(ns_system_check(s, &f), NS_E_RANGE);
    assert_int_equal(f.pair[0], 1);
    s->command[0].pair = 2;
    assert_int_equal(ns_system_check(s, NULL), NS_E_SIZE);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(starts_zero_and_complementary),
        cmocka_unit_test(bad_sizes_are_refused),
        cmocka_unit_test(inputs_are_copied),
        cmocka_unit_test(check_names_the_place),
        cmocka_unit_test(commands_are_checked),
    };
    return cmocka_run_group_tests_name("system", tests, NULL, NULL);
}
