/* tests/unit/mlcp/test_parts.c - small parts of the solver alone: proofs by two rows, lists
 * of nonzeros, what counts as huge. */
#include "mlcp/verify/residual.h"
#include "prepared.h"

enum { PROBLEMS = 200 };

/* Row i is a times (1, -2, 0.5), y_i = a x + q_i with x = (1, -2, 0.5) lambda; what it asks of x is said by
 * hand. */
static void two_rows_that_are_one(void **state) {
    (void)state;
    static const struct {
        double a, qa, la, ua, b, qb, lb, ub;
        int contradict;
    } c[] = {
        {1, -5, -INF, INF, 2, -12, -INF, INF, 1}, /* x = 5, x = 6 */
        {1, -5, -INF, INF, 2, -10, -INF, INF, 0}, /* x = 5 twice */
        {1, -5, 0, INF, -1, 4, 0, INF, 1},        /* x >= 5, x <= 4 */
        {1, -5, 0, INF, -1, 6, 0, INF, 0},        /* x >= 5, x <= 6 */
        {1, -4, -INF, 0, 2, -10, 1, INF, 1},      /* x <= 4, x >= 5 */
        {1, -4, -INF, 0, -2, 10, -INF, 1, 1},     /* x <= 4, x >= 5 */
        {-1, 4, 0, INF, 2, -10, -INF, INF, 1},    /* x <= 4, x = 5 */
        {1, -5, 0, 1, 2, -12, -INF, INF, 0},      /* a box asks nothing */
    };
    for (size_t k = 0; k < sizeof c / sizeof *c; k++)
        for (int swap = 0; swap < 2; swap++) {
            rig r = {.m = 3};
            const int i = swap ? 2 : 0, j = swap ? 0 : 2;
            const double x[] = {1, -2, 0.5};
            double v[3];
            for (int n = 0; n < 3; n++) {
                r.W[i + 3 * n] = c[k].a * x[n];
                r.W[j + 3 * n] = c[k].b * x[n];
                r.W[1 + 3 * n] = n + 1;
            }
            r.q[i] = c[k].qa, r.l[i] = c[k].la, r.u[i] = c[k].ua;
            r.q[j] = c[k].qb, r.l[j] = c[k].lb, r.u[j] = c[k].ub;
            r.u[1] = INF;
            ns_mlcp_solver *s = begin(&r);
            assert_int_equal(ns_mlcp_parallel(s, v), c[k].contradict);
            if (c[k].contradict) {
                assert_true(v[1] == 0 && v[i] * c[k].a == -v[j] * c[k].b && v[i] != 0);
                assert_true(ns_mlcp_certify(s->p, v) > 0.01);
            }
            ns_mlcp_free(s);
        }
}

static void nonzeros_are_listed(void **state) {
    (void)state;
    int few = 0;
    for (unsigned number = 0; number < PROBLEMS; number++) {
        dice d = dice_make(82, number);
        ns_nonzeros z;
        const int m = 1 + dice_below(&d, NS_QUICK + 2);
        static double W[(NS_QUICK + 2) * (NS_QUICK + 2)];
        int count = 0;
        for (int k = 0; k < m * m; k++) {
            W[k] = dice_chance(&d, 0.1 + 0.3 * (number % 2)) ? 1 : 0;
            count += W[k] != 0;
        }
        ns_mlcp_nonzeros_find(m, W, &z);
        assert_int_equal(z.few, m <= NS_QUICK && 3 * count <= m * m);
        few += z.few;
        if (!z.few)
            continue;
        int at = 0;
        for (int j = 0; j < m; j++) {
            assert_int_equal(z.start[j], at);
            for (int i = 0; i < m; i++)
                if (W[i + j * m] != 0)
                    assert_int_equal(z.row[at++], i);
        }
        assert_int_equal(z.start[m], at);
        const int k = dice_below(&d, m * m);
        assert_true(ns_mlcp_nonzeros_fit(m, W, &z));
        const int fits = W[k] != 0;
        W[k] = fits ? 0 : 1; /* one less fits, one more does not */
        assert_int_equal(ns_mlcp_nonzeros_fit(m, W, &z), fits);
    }
    assert_true(few > PROBLEMS / 4);
}

/* lambda_0 = 2e8 of column 1e-3, unit 1000: 2e5 in units of W; the largest datum is q_1 / 2 = 3, or the given
 * lambda_2 = 5 of unit 1. */
static void huge_against_the_data(void **state) {
    (void)state;
    rig r = {
        .m = 3, .W = {1e-3, 0, 0, 0, 2, 0, 0, 0, 1}, .q = {0, -6, 1}, .l = {0, 0, 1}, .u = {INF, INF, 1}};
    for (int given = 1; given <= 5; given += 4) {
        r.l[2] = r.u[2] = given;
        ns_mlcp_solver *s = begin(&r);
        s->lambda[0] = 2e8;
        s->lambda[1] = 3;
        s->lambda[2] = given;
        s->mode[0] = s->mode[1] = NS_INSIDE;
        s->mode[2] = NS_LOWER;
        const double most = fabs(s->lambda[0]) / s->units.column[0];
        const double data =
            fmax(6 / s->units.rowmax[1], fmax(given / s->units.column[2], 1 / s->units.rowmax[2]));
        assert_true(ns_mlcp_huge_multipliers(s, 0.99 * most / data));
        assert_false(ns_mlcp_huge_multipliers(s, 1.01 * most / data));
        s->mode[0] = NS_UPPER; /* at a bound it is a datum */
        assert_false(ns_mlcp_huge_multipliers(s, 1));
        ns_mlcp_free(s);
    }
}

/* Bounds 1 and 2, sizes 0.5 of lambda and 4 of y: how far each guard is broken, in these units. */
static void guards_broken_by_so_much(void **state) {
    (void)state;
    static const struct {
        ns_mode mode;
        double lambda, y, broken;
    } c[] = {{NS_INSIDE, 0.5, 0, 1}, {NS_INSIDE, 1.5, 0, 0}, {NS_INSIDE, 3, 0, 2}, {NS_LOWER, 1, -2, 0.5},
             {NS_LOWER, 1, 2, 0},    {NS_UPPER, 2, 2, 0.5},  {NS_UPPER, 2, -2, 0}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        rig r = {.m = 1, .W = {1}, .q = {-5}, .l = {1}, .u = {2}};
        ns_mlcp_solver *s = begin(&r);
        s->mode[0] = c[k].mode;
        s->lambda[0] = c[k].lambda;
        s->y[0] = c[k].y;
        s->lsize[0] = 0.5;
        s->ysize[0] = 4;
        assert_true(ns_mlcp_basis_violation(s) == c[k].broken);
        ns_mlcp_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_rows_that_are_one),
        cmocka_unit_test(nonzeros_are_listed),
        cmocka_unit_test(huge_against_the_data),
        cmocka_unit_test(guards_broken_by_so_much),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
