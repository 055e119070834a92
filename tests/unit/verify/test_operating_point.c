/* tests/unit/verify/test_operating_point.c - what rests, and what was held, at an operating point;
 * a pair between bounds, in a hurry; no memory. */
#include "small_system.h"
#include "wrap_alloc.h"

/* x' = -x + z_0 + z_1 with z_0 = 2 V, and z_1 = 0 V, or 1 V from 1 us on; a switch by the state, or none: 1
 * if x = `volts` at 0 is at rest. */
static int rests(double volts, int moves, int by_state, ns_verify_finding *f) {
    const ns_signal two = dc(2), step = pulse(0, moves ? 1 : 0, 0, 1e-6, 1e-6, 1, 3);
    const double lambda = 0;
    const ns_verify_state at = {0, NS_RIGHT, &volts, &lambda, NULL, 0};
    ns_system *s;
    ns_verify *v;
    assert_int_equal(ns_system_create(1, 1, 2, 1, &s), NS_OK);
    s->M[0] = s->E[0] = s->E[1] = s->D[0] = 1;
    s->A[0] = -1;
    command(s, by_state, 50, 50);
    assert_int_equal(ns_system_set_input(s, 0, &two), NS_OK);
    assert_int_equal(ns_system_set_input(s, 1, &step), NS_OK);
    assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
    assert_true(ns_verify_point(v, &at, f));
    const int right = ns_verify_operating_point(v, &volts, 0, NULL, NULL, f);
    ns_verify_free(v);
    ns_system_free(s);
    return right;
}

static void operating_points(void **state) {
    ns_verify_finding f;
    (void)state;
    assert_true(rests(2, 0, 0, &f));
    assert_false(rests(3, 0, 0, &f));
    assert_int_equal(f.cause, NS_VERIFY_FLOW);
    assert_int_equal(f.unknown, 0);
    assert_int_equal(f.pair, -1);
    assert_true(rests(3, 1, 0, &f)); /* a source moves: nothing is known */
    assert_true(rests(3, 0, 1, &f)); /* what depends on the state may oscillate */
}

/* x_1 is to be held at 3 V, x_0 is not. */
static void held_at_an_operating_point(void **state) {
    const int hold = 1;
    const double volts = 3;
    (void)state;
    for (int wrong = 0; wrong < 2; wrong++) {
        const double x[2] = {5, wrong ? 3.1 : 3};
        const ns_verify_state at = {0, NS_RIGHT, x, NULL, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(2, 0, 0, 0, &s), NS_OK);
        s->M[0] = s->M[3] = 1;
        s->A[0] = s->A[3] = -1;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_true(ns_verify_point(v, &at, &f));
        assert_int_equal(ns_verify_operating_point(v, x, 1, &hold, &volts, &f), !wrong);
        assert_int_equal(f.cause, wrong ? NS_VERIFY_ROW : NS_VERIFY_RIGHT);
        assert_int_equal(f.unknown, wrong ? 1 : -1);
        assert_int_equal(f.pair, -1);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* y = e, lambda from 1 to 3. */
static void between_bounds_in_a_hurry(void **state) {
    const struct {
        double y, lambda;
        int holds;
    } of[] = {{-1, 3, 1}, {-1, 2, 0}, {-1, 1, 0},  {1, 1, 1},   {1, 2, 0},    {1, 3, 0},  {0, 2, 1},
              {0, 1, 1},  {0, 3, 1},  {0, 3.1, 0}, {0, 0.9, 0}, {-1, 3.1, 0}, {1, 0.9, 0}};
    (void)state;
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const double x = 0, right = of[k].y > 0 ? 1 : 3;
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
        s->M[0] = 1;
        s->e[0] = of[k].y;
        s->l[0] = 1;
        s->u[0] = 3;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        const ns_verify_state first = {0, NS_RIGHT, &x, &right, NULL, 0},
                              at = {0, NS_RIGHT, &x, &of[k].lambda, NULL, 0};
        assert_true(ns_verify_point(v, &first, &f)); /* sizes are learnt */
        assert_int_equal(ns_verify_quick_point(v, &at), of[k].holds);
        assert_int_equal(ns_verify_point(v, &at, &f), of[k].holds);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* A diode beside another one that is right, y = e: in a hurry neither both, nor either of them negative. */
static void diodes_in_a_hurry(void **state) {
    const struct {
        double y, lambda;
        int holds;
    } of[] = {{1, 0, 1},  {0, 2, 1},  {0, 0, 1},  {-1, 0, 0}, {1, 2, 0},
              {0, -2, 0}, {-1, 2, 0}, {1, -2, 0}, {-1, -2, 0}};
    (void)state;
    for (size_t k = 0; k < 2 * sizeof of / sizeof *of; k++) {
        const int own = k % 2, other = !own;
        const double x = 0, sizes[2] = {2, 2};
        double lambda[2];
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 2, 0, 0, &s), NS_OK);
        s->M[0] = 1;
        s->u[0] = s->u[1] = INFINITY;
        lambda[other] = 2;
        lambda[own] = of[k / 2].lambda;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        const ns_verify_state first = {0, NS_RIGHT, &x, sizes, NULL, 0},
                              at = {0, NS_RIGHT, &x, lambda, NULL, 0};
        assert_true(ns_verify_point(v, &first, &f)); /* sizes of lambda are learnt, with y = 0 */
        v->quick.pair[own].y.constant = of[k / 2].y;
        assert_int_equal(v->quick.plains, 2);
        assert_int_equal(ns_verify_quick_point(v, &at), of[k / 2].holds);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* Whichever array there is no memory for. */
/* A switch that any one of three unknowns closes, y = 1 - lambda: in a hurry it is right if it is shut. */
static void a_control_of_any_unknown_in_a_hurry(void **state) {
    enum { N = 3 };
    (void)state;
    for (int k = 0; k < N; k++) {
        double x[N] = {0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(N, 1, 0, 1, &s), NS_OK);
        for (int i = 0; i < N; i++)
            s->M[i + N * i] = 1;
        s->e[0] = x[k] = 1;
        s->D[0] = -1;
        command(s, 1, 0.5, 0.5);
        s->command[0].gx[0] = 0;
        s->command[0].gx[k] = 1;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        for (int shut = 1; shut >= 0; shut--) {
            const double lambda = shut;
            const ns_verify_state at = {0, NS_RIGHT, x, &lambda, NULL, 0};
            assert_int_equal(ns_verify_point(v, &at, &f), shut);
            assert_int_equal(ns_verify_quick_point(v, &at), shut);
        }
        ns_verify_free(v);
        ns_system_free(s);
    }
}

static void no_memory(void **state) {
    ns_system *s;
    long k = 1;
    (void)state;
    assert_int_equal(ns_system_create(2, 1, 1, 1, &s), NS_OK);
    s->M[0] = s->D[0] = 1;
    command(s, 1, 0.5, 0.5);
    for (;; k++) {
        ns_verify *v;
        fail_alloc_at(k);
        const int status = ns_verify_create(s, &options, &v);
        const long tried = allocs_made();
        fail_alloc_off();
        if (tried < k) {
            assert_int_equal(status, NS_OK);
            ns_verify_free(v);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
    }
    assert_true(
        k > 20); /* the object, six arrays, four for each of four matrices, two to look for what is aside */
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(operating_points),
                                       cmocka_unit_test(held_at_an_operating_point),
                                       cmocka_unit_test(between_bounds_in_a_hurry),
                                       cmocka_unit_test(diodes_in_a_hurry),
                                       cmocka_unit_test(a_control_of_any_unknown_in_a_hurry),
                                       cmocka_unit_test(no_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
