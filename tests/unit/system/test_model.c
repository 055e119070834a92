/* tests/unit/system/test_model.c - what a model is refused for; a linear system shown as a model. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "systems.h"

static int nothing(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = 0;
    return 0;
}

static double M[4], low[2], high[2];
static ns_signal z[1];

static ns_model sound(void) {
    M[0] = M[3] = 1;
    M[1] = M[2] = low[0] = low[1] = 0;
    high[0] = high[1] = INFINITY;
    z[0] = (ns_signal){.kind = NS_DC};
    return (ns_model){.n = 2,
                      .m = 2,
                      .nz = 1,
                      .M = M,
                      .l = low,
                      .u = high,
                      .z = z,
                      .f = nothing,
                      .A = nothing,
                      .g = nothing,
                      .B = nothing,
                      .h = nothing,
                      .C = nothing};
}

static void missing_parts_are_refused(void **state) {
    (void)state;
    ns_fault fault;
    ns_model p = sound();
    assert_int_equal(ns_model_check(&p, &fault), NS_OK);
    assert_int_equal(ns_model_check(NULL, &fault), NS_E_NULL);
    assert_int_equal(fault.status, NS_E_NULL);
    for (int k = 0; k < 10; k++) {
        p = sound();
        ns_function *const f[] = {&p.f, &p.A, &p.g, &p.B, &p.h, &p.C};
        if (k < 6)
            *f[k] = NULL;
        else if (k == 6)
            p.M = NULL;
        else if (k == 7)
            p.l = NULL;
        else if (k == 8)
            p.u = NULL;
        else
            p.z = NULL;
        assert_int_equal(ns_model_check(&p, NULL), NS_E_NULL);
    }
    p = (ns_model){.n = 0};
    assert_int_equal(ns_model_check(&p, NULL), NS_OK);
}

static void sizes_numbers_and_bounds_are_refused(void **state) {
    (void)state;
    ns_fault fault;
    ns_model p = sound();
    p.n = -1;
    assert_int_equal(ns_model_check(&p, &fault), NS_E_SIZE);
    p = sound();
    p.m = -1;
    assert_int_equal(ns_model_check(&p, &fault), NS_E_SIZE);
    p = sound();
    p.nz = -1;
    assert_int_equal(ns_model_check(&p, &fault), NS_E_SIZE);
    p = sound();
    M[1] = NAN;
    assert_int_equal(ns_model_check(&p, &fault), NS_E_NUMBER);
    assert_int_equal(fault.nunknowns, 1);
    p = sound();
    z[0] = (ns_signal){.kind = NS_DC, .u.dc = NAN};
    assert_int_equal(ns_model_check(&p, &fault), NS_E_NUMBER);
    const struct {
        double l, u;
        int status;
    } bounds[] = {{NAN, 1, NS_E_NUMBER},
                  {0, NAN, NS_E_NUMBER},
                  {INFINITY, INFINITY, NS_E_NUMBER},
                  {-INFINITY, -INFINITY, NS_E_NUMBER},
                  {2, 1, NS_E_BOUNDS},
                  {1, 1, NS_OK},
                  {-INFINITY, INFINITY, NS_OK},
                  {-1, 1, NS_OK}};
    for (size_t k = 0; k < sizeof bounds / sizeof *bounds; k++) {
        p = sound();
        low[1] = bounds[k].l;
        high[1] = bounds[k].u;
        assert_int_equal(ns_model_check(&p, &fault), bounds[k].status);
        if (bounds[k].status != NS_OK) {
            assert_int_equal(fault.npairs, 1);
            assert_int_equal(fault.pair[0], 1);
        }
    }
}

/* y = (v2 - v1) of the half-wave rectifier, its KCL, its source. */
static void a_system_is_a_model(void **state) {
    (void)state;
    ns_system *s = system_half_wave(10, 50, 100);
    ns_model p;
    const double x[3] = {3, 1, 0.2}, lambda[1] = {0.5}, input[1] = {4};
    const ns_point at = {0, x, lambda, input};
    double f[3], g[3], h[1], A[9];
    ns_jacobian_error e;
    assert_int_equal(ns_model_of_system(s, &p), NS_OK);
    assert_int_equal(ns_model_check(&p, NULL), NS_OK);
    assert_int_equal(p.f(&at, p.data, f), 0);
    assert_int_equal(p.g(&at, p.data, g), 0);
    assert_int_equal(p.h(&at, p.data, h), 0);
    assert_int_equal(p.A(&at, p.data, A), 0);
    assert_true(f[0] == -0.2 && f[1] == -0.01 && f[2] == 1); /* -i, -v2/R, -v1 + z */
    assert_true(g[0] == -0.5 && g[1] == 0.5 && g[2] == 0);
    assert_true(h[0] == -2);
    assert_memory_equal(A, s->A, sizeof A);
    assert_int_equal(ns_model_check_jacobians(&p, 0, x, lambda, &e), NS_OK);
    assert_true(e.error < 1e-8);
    assert_int_equal(ns_model_of_system(NULL, &p), NS_E_NULL);
    assert_int_equal(ns_model_of_system(s, NULL), NS_E_NULL);
    s->A[0] = NAN;
    assert_int_equal(ns_model_of_system(s, &p), NS_E_NUMBER);
    ns_system_free(s);
    assert_int_equal(ns_system_create(1, 1, 0, 1, &s), NS_OK);
    assert_int_equal(ns_model_of_system(s, &p), NS_E_SIZE); /* a commanded pair */
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(missing_parts_are_refused),
        cmocka_unit_test(sizes_numbers_and_bounds_are_refused),
        cmocka_unit_test(a_system_is_a_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
