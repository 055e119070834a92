/* tests/unit/mlcp/test_pivot.c - principal pivoting: on the kept transform, and by blocks. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "generators.h"

#define INF INFINITY

typedef struct rig {
    ns_mlcp_solver *s;
    ns_mode mode[200];
    double lambda[200], y[200];
    ns_mlcp_info info;
} rig;

static void begin(rig *r, int m, ns_mlcp_method method) {
    memset(r, 0, sizeof *r);
    assert_int_equal(ns_mlcp_create(m, &r->s), NS_OK);
    assert_int_equal(ns_mlcp_use(r->s, method), NS_OK);
}

static int run(rig *r, const ns_mlcp *p) {
    return ns_mlcp_solve(r->s, p, r->mode, r->lambda, r->y, &r->info);
}

/* y = (l2 - 1, 3 - l1 + l2): diagonal entry 0, so the first pair needs the second as partner.
 * l2 = 1 makes y1 = 0;  y2 = 3 - l1 + 1 = 0 makes l1 = 4. */
static void a_zero_on_the_diagonal_takes_a_partner(void **state) {
    (void)state;
    const double W[] = {0, -1, 1, 1}, q[] = {-1, 3}, l[] = {0, 0}, u[] = {INF, INF};
    const ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u};
    rig r;
    begin(&r, 2, NS_MLCP_AUTO);
    r.mode[0] = r.mode[1] = NS_LOWER;
    assert_int_equal(run(&r, &p), NS_OK);
    assert_true(fabs(r.lambda[0] - 4) < 1e-14 && fabs(r.lambda[1] - 1) < 1e-14);
    assert_int_equal(r.info.method, NS_MLCP_PIVOT);
    ns_mlcp_free(r.s);
}

/* y1 = l1 + a l2 - 3, y2 = a (l1 + a l2 - 1), l2 inside at 1/a: y1 = -2 whatever l1 is, until l2 is at its
 * bound 0: l1 = 3, by one exchange of both.  Where a is negative 0 is the upper bound. */
static void a_partner_stops_at_the_bound_it_moves_to(void **state) {
    (void)state;
    const double factor[] = {1, -1, 0.25, -0.25, 4, -4};
    for (int k = 0; k < 6; k++) {
        const double a = factor[k], W[] = {1, a, a, a * a}, q[] = {-3, -a};
        const double l[] = {0, a > 0 ? 0 : -INF}, u[] = {INF, a > 0 ? INF : 0};
        const ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u};
        rig r;
        begin(&r, 2, NS_MLCP_PIVOT);
        r.mode[0] = NS_LOWER;
        r.mode[1] = NS_INSIDE;
        assert_int_equal(run(&r, &p), NS_OK);
        assert_true(fabs(r.lambda[0] - 3) < 1e-14 && r.lambda[1] == 0);
        assert_int_equal(r.mode[1], a > 0 ? NS_LOWER : NS_UPPER);
        assert_int_equal(r.info.pivots, 2);
        assert_int_equal(r.info.factors, 1); /* it does not begin anew */
        ns_mlcp_free(r.s);
    }
}

/* y = lambda + q in a box [-1, 2]: lambda = -q put into it. */
static void boxes_have_three_modes(void **state) {
    (void)state;
    const double W[] = {1}, l[] = {-1}, u[] = {2}, q[] = {-5, -1, 0.5, 3}, is[] = {2, 1, -0.5, -1};
    const int mode[] = {NS_UPPER, NS_INSIDE, NS_INSIDE, NS_LOWER};
    rig r;
    begin(&r, 1, NS_MLCP_PIVOT);
    for (int k = 0; k < 16; k++) {
        const ns_mlcp p = {.m = 1, .W = W, .q = q + k * 5 % 4, .l = l, .u = u};
        assert_int_equal(run(&r, &p), NS_OK);
        assert_true(r.lambda[0] == is[k * 5 % 4]);
        assert_int_equal(r.mode[0], mode[k * 5 % 4]);
    }
    ns_mlcp_free(r.s);
}

/* A difference that rounding alone has made is no pivot: 0.1 a + 0.2 b = 1 and 0.3 a + 0.6 b = 2. */
static void a_pivot_of_rounding_is_refused(void **state) {
    (void)state;
    const double W[] = {0.1, 0.3, 0.2, 0.6}, q[] = {-1, -2}, l[] = {-INF, -INF}, u[] = {INF, INF};
    const ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u};
    rig r;
    begin(&r, 2, NS_MLCP_PIVOT);
    assert_int_not_equal(run(&r, &p), NS_OK);
    ns_mlcp_free(r.s);
}

/* P-matrices have one answer; from its mode, nothing is exchanged and nothing factored. */
static void the_last_mode_costs_nothing(int most) {
    sample s;
    rig r;
    int solved = 0;
    assert_int_equal(sample_create(most, &s), 0);
    begin(&r, most, NS_MLCP_PIVOT);
    for (unsigned k = 0; k < 200; k++) {
        generate(&s, CLASS_P, k, most);
        const ns_mlcp p = sample_problem(&s);
        memset(r.mode, NS_LOWER, (size_t)s.m);
        if (run(&r, &p) != NS_OK)
            continue;
        solved++;
        assert_true(r.info.residual <= 1e-10);
        assert_true(sample_residual(&s, r.lambda) <= 1e-10);
        assert_int_equal(run(&r, &p), NS_OK);
        assert_int_equal(r.info.pivots, 0);
        assert_int_equal(r.info.factors, 0);
    }
    print_message("up to %d pairs: %d of 200 solved by pivoting alone\n", most, solved);
    assert_true(solved >= 180); /* alone it need not solve all */
    ns_mlcp_free(r.s);
    sample_free(&s);
}

static void warm_small(void **state) {
    (void)state;
    the_last_mode_costs_nothing(30);
}

static void warm_large(void **state) {
    (void)state;
    the_last_mode_costs_nothing(150);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_zero_on_the_diagonal_takes_a_partner),
        cmocka_unit_test(a_partner_stops_at_the_bound_it_moves_to),
        cmocka_unit_test(boxes_have_three_modes),
        cmocka_unit_test(a_pivot_of_rounding_is_refused),
        cmocka_unit_test(warm_small),
        cmocka_unit_test(warm_large),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
