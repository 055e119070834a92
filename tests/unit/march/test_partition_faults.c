/* tests/unit/march/test_partition_faults.c - what fails in an island is told of the whole; calls that cannot
 * be. */
#include "converters.h"

/* Two converters, a detector, and a diode from a source of v sin to one of -v sin: a short while v > 0. */
static scene with_a_short(double v) {
    scene z = two_bucks();
    detector(&z, "3", FIRST + 2 * EACH);
    assert_int_equal(ns_circuit_diode(z.c, "dx", 40, 41, &ideal, NULL), NS_OK);
    put(&z, "vx", 40, 0, sine(v, 1e3));
    put(&z, "vy", 41, 0, sine(-v, 1e3));
    return z;
}

static void names_the_short(const scene *z) {
    char line[200];
    ns_circuit_explain(z->c, ns_march_fault(z->m), line, sizeof line);
    assert_non_null(strstr(line, "dx"));
}

/* What fails in one is told with its name in all, and loses nothing. */
static void a_fault_has_its_own_name(void **state) {
    (void)state;
    ns_mlcp p;
    double reached, t, h;
    for (int whole = 0; whole < 2; whole++) { /* at half a period */
        scene z = with_a_short(-1);
        begin(&z, NS_EXACT, whole);
        assert_int_equal(islands(&z), whole ? 0 : 4);
        assert_int_equal(ns_march_try(z.m, 1e-3, NS_TO_TIME, &reached), NS_E_INFEASIBLE);
        names_the_short(&z);
        assert_true(fabs(ns_march_fault(z.m)->t - 0.5e-3) < 1e-6);
        assert_int_equal(ns_march_problem(z.m, &p, &h), NS_OK);
        assert_true(p.m >= 1 && h > 0);
        assert_int_equal(ns_march_read(z.m, &t, NULL, NULL, NULL), NS_OK);
        assert_true(t == 0);
        end(&z);
    }
    for (int dc = 0; dc < 2; dc++) { /* at once; of 0 V and 0 V an operating point is none the worse */
        scene z = with_a_short(1);
        make(&z, NS_EXACT, 0);
        const int status =
            dc ? ns_march_start_dc(z.m, 0.1e-3, 0, NULL, NULL, NULL) : ns_march_start(z.m, 0.1e-3, z.w0);
        assert_int_equal(status, NS_E_INFEASIBLE);
        names_the_short(&z);
        end(&z);
    }
}

/* Calls out of order, and with numbers that cannot be. */
static void bad_calls(void **state) {
    (void)state;
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE, .reltol = -1};
    const int wrong = MOST;
    const double volts = 1;
    double reached;
    ns_march *m;
    ns_mlcp p;
    scene z = two_bucks();
    make(&z, NS_EXACT, 0);
    assert_int_equal(ns_march_try(z.m, 1, NS_TO_TIME, &reached), NS_E_STATE);
    assert_int_equal(ns_march_read(z.m, NULL, NULL, NULL, NULL), NS_E_STATE);
    assert_int_equal(ns_march_accept(z.m), NS_E_STATE);
    assert_int_equal(ns_march_start(z.m, NAN, z.w0), NS_E_NUMBER);
    assert_int_equal(ns_march_start_dc(z.m, 0, -1, NULL, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_march_start_dc(z.m, 0, 1, &wrong, &volts, NULL), NS_E_SIZE);
    assert_int_equal(ns_march_start(z.m, 0, z.w0), NS_OK);
    assert_int_equal(ns_march_try(z.m, 0, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_fault(z.m)->status, NS_E_RANGE);
    assert_int_equal(ns_march_try(z.m, INFINITY, NS_TO_TIME, &reached), NS_E_RANGE);
    assert_int_equal(ns_march_problem(z.m, &p, &reached), NS_E_STATE);
    assert_int_equal(ns_march_accept(z.m), NS_E_STATE);
    ns_fault before = {.npairs = 1, .pair = {MOST}};
    assert_int_equal(ns_march_create(z.s, &o, &m, &before), NS_E_RANGE);
    assert_null(m);
    assert_true(before.status == NS_E_RANGE && before.npairs == 0); /* of no pair */
    end(&z);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fault_has_its_own_name),
        cmocka_unit_test(bad_calls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
