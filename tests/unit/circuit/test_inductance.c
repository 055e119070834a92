/* tests/unit/circuit/test_inductance.c - coupling factors that windings can have, and those that none can.
 *
 * The energy i'Li/2 of any currents is never negative: the matrix of the factors, with unit diagonal, has no
 * negative eigenvalue.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/circuit.h"
#include "wrap_alloc.h"

/* Inductors l0, l1, ... of 1, 100, 1e4 ... uH, each between a node of its own and ground. */
static ns_circuit *make(int inductors) {
    ns_circuit *c = NULL;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    for (int i = 0; i < inductors; i++) {
        char name[] = {'l', (char)('0' + i), '\0'};
        assert_int_equal(ns_circuit_inductor(c, name, 1 + i, 0, pow(100, i) * 1e-6, NAN, NULL), NS_OK);
    }
    return c;
}

static void couple(ns_circuit *c, int a, int b, double k) {
    char name[] = {'k', (char)('0' + a), (char)('0' + b), '\0'};
    assert_int_equal(ns_circuit_coupling(c, name, a, b, k, NULL), NS_OK);
}

static int status_of(ns_circuit *c) {
    ns_system *s = NULL;
    int status = ns_circuit_system(c, &s);
    assert_true((status == NS_OK) == (s != NULL));
    ns_system_free(s);
    return status;
}

/* 0.99, 0.99 and nothing: determinant 1 - 2 0.99^2 < 0.  With 0.97 for the third: 1 + 2 0.99^2 0.97 - 2
 * 0.99^2
 * - 0.97^2 = 2e-4 > 0. */
static void a_factor_forgotten(void **state) {
    ns_circuit *c = make(4);
    (void)state;
    couple(c, 1, 2, 0.99);
    couple(c, 2, 3, 0.99);
    assert_int_equal(status_of(c), NS_E_RANGE);
    assert_non_null(strstr(ns_circuit_message(c), ": its coupling factors and those of the inductors"));
    couple(c, 3, 1, 0.97);
    assert_int_equal(status_of(c), NS_OK);
    ns_circuit_free(c);
}

/* All factors 1: one flux; one sign turned round: determinant 1 - 2 - 3 < 0; two turned: one winding
 * reversed. */
static void perfect_coupling(void **state) {
    const double sign[4][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, -1}, {-1, -1, -1}};
    const int want[] = {NS_OK, NS_E_RANGE, NS_OK, NS_E_RANGE};
    (void)state;
    for (int i = 0; i < 4; i++) {
        ns_circuit *c = make(3);
        couple(c, 0, 1, sign[i][0]);
        couple(c, 1, 2, sign[i][1]);
        couple(c, 2, 0, sign[i][2]);
        assert_int_equal(status_of(c), want[i]);
        ns_circuit_free(c);
    }
}

/* Two couplings of the same windings add up. */
static void given_twice(void **state) {
    ns_circuit *c = make(2);
    (void)state;
    couple(c, 0, 1, 0.6);
    assert_int_equal(status_of(c), NS_OK);
    couple(c, 1, 0, 0.6);
    assert_int_equal(status_of(c), NS_E_RANGE);
    ns_circuit_free(c);
}

/* Windings as unit vectors of a plane at angles 0, a, a + b: factors cos a, cos b, cos(a+b) are those of two
 * fluxes, with determinant 0 but for rounding.  A factor 1e-6 beyond either end of what the others allow,
 * cos(a+b) <= k <= cos(a-b), is refused. */
static void windings_in_a_plane(void **state) {
    (void)state;
    for (int i = 1; i < 40; i++) {
        double a = 0.037 * i, b = 1.5 - 0.031 * i, k[] = {cos(a + b), cos(a - b)};
        for (int j = 0; j < 4; j++) {
            ns_circuit *c = make(3);
            double beyond = j < 2 ? 0 : j == 2 ? -1e-6 : 1e-6;
            if (fabs(k[j % 2] + beyond) > 1) {
                ns_circuit_free(c);
                continue;
            }
            couple(c, 0, 1, cos(a));
            couple(c, 1, 2, cos(b));
            couple(c, 2, 0, k[j % 2] + beyond);
            assert_int_equal(status_of(c), j < 2 ? NS_OK : NS_E_RANGE);
            ns_circuit_free(c);
        }
    }
}

static void allocations_fail(void **state) {
    ns_circuit *c = make(2);
    (void)state;
    couple(c, 0, 1, 1);
    for (long k = 1; k <= 2; k++) {
        fail_alloc_at(k);
        assert_int_equal(status_of(c), NS_E_MEMORY);
        fail_alloc_off();
        assert_string_equal(ns_circuit_message(c), "out of memory");
    }
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_factor_forgotten), cmocka_unit_test(perfect_coupling),
        cmocka_unit_test(given_twice),        cmocka_unit_test(windings_in_a_plane),
        cmocka_unit_test(allocations_fail),
    };
    return cmocka_run_group_tests_name("inductance", tests, NULL, NULL);
}
