/* tests/unit/mlcp/test_solve.c - the MLCP solver on problems whose answers are known in closed form. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "trials.h"

#define INF INFINITY

/* What the driver says of it must agree; its answers are better than it asks for. */
static int run(trial *t) {
    const int status = trial_run(t, NS_MLCP_AUTO);
    assert_int_equal(t->info.fault.status, status);
    if (status == NS_OK) {
        assert_true(t->residual < 1e-12);
        assert_int_equal(t->info.fault.npairs, 0);
    }
    return status;
}

/* Laws in which W may be 0, beside those that every method solves. */
static void one_pair_of_each_law(void **state) {
    (void)state;
    static const trial_pair ideal[] = {
        {0, 3, 0, INF, 0, 3, NS_LOWER}, /* an ideal device */
        {0, -3, -1, 1, 1, -3, NS_UPPER},
    };
    trial_pairs(ideal, 2, NS_MLCP_AUTO);
    trial_closed_forms(NS_MLCP_AUTO);
}

/* 2 l1 + l2 = 5, l1 + 2 l2 = 6: l = (4/3, 7/3), both inside. */
static void two_coupled_pairs(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {2, 1, 1, 2}, .q = {-5, -6}};
    trial_complementary(&t);
    assert_int_equal(run(&t), NS_OK);
    trial_close(t.lambda[0], 4.0 / 3.0);
    trial_close(t.lambda[1], 7.0 / 3.0);
    assert_true(t.y[0] == 0.0 && t.y[1] == 0.0);
    assert_true(t.info.pivots >= 2); /* two pairs must change */
}

/* All laws at once, triangular so that it is solved from the top: equality 2 a + 4 = 0 -> a = -2; given
 * b = 3; box c in [-1,1]: y = c + a + b - 4 = c - 3 -> c = 1, y = -2; pair d: y = d - c - 1 -> d = 2;
 * pair e: y = e + d = e + 2 -> e = 0, y = 2. */
static void all_laws_together(void **state) {
    (void)state;
    for (int start = -1; start <= 1; start++) {
        trial t = {.m = 5,
                   .rows = {2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, -1, 1, 0, 0, 0, 0, 1, 1},
                   .q = {4, 0, -4, -1, 0},
                   .l = {-INF, 3, -1, 0, 0},
                   .u = {INF, 3, 1, INF, INF}};
        const double lambda[5] = {-2, 3, 1, 2, 0}, y[5] = {0, 3, -2, 0, 2};
        memset(t.mode, start, sizeof t.mode);
        assert_int_equal(run(&t), NS_OK);
        for (int i = 0; i < 5; i++) {
            trial_close(t.lambda[i], lambda[i]);
            trial_close(t.y[i], y[i]);
        }
    }
}

/* Source E through R into a node, ideal diode to ground: x = (v), KCL (v - E)/R + i = 0, y = -v.  E > 0
 * conducts: v = 0, i = E/R.  E < 0 blocks: v = E, y = -E. */
static void diode_clamp(void **state) {
    (void)state;
    const double R = 1e3;
    for (int sign = -1; sign <= 1; sign += 2) {
        double E = 5.0 * sign;
        trial t = {.m = 2, .rows = {1 / R, 1, -1, 0}, .q = {-E / R, 0}, .l = {-INF, 0}, .u = {INF, INF}};
        t.mode[1] = NS_LOWER;
        assert_int_equal(run(&t), NS_OK);
        trial_close(t.lambda[0], sign > 0 ? 0 : E);
        trial_close(t.lambda[1], sign > 0 ? E / R : 0);
        trial_close(t.y[1], sign > 0 ? 0 : -E);
    }
}

/* A node between two diodes in series, nothing else on it: with both blocking its voltage is open, the free
 * block is [0].  From 5 V forward through 1 ohm: x = (a, b), diodes a->b, b->ground: i = 5, a = b = 0.
 * Backward: nothing flows and 0 >= b >= a = -5. */
static void a_node_that_only_diodes_hold(void **state) {
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2)
        for (int start = -1; start <= 0; start++) {
            trial t = {.m = 4,
                       .rows = {1, 0, 1, 0, 0, 0, -1, 1, -1, 1, 0, 0, 0, -1, 0, 0},
                       .q = {-5.0 * sign, 0, 0, 0},
                       .l = {-INF, -INF, 0, 0},
                       .u = {INF, INF, INF, INF}};
            t.mode[2] = t.mode[3] = (ns_mode)start;
            assert_int_equal(run(&t), NS_OK);
            for (int d = 2; d < 4; d++)
                trial_close(t.lambda[d], sign > 0 ? 5 : 0);
            trial_close(t.lambda[0], sign > 0 ? 0 : -5);
            if (sign < 0)
                assert_true(t.lambda[1] <= 1e-14 && t.lambda[1] >= -5 - 1e-14);
            assert_int_equal(run(&t), NS_OK);
            assert_int_equal(t.info.pivots, 0); /* its mode is a basis: no detour the second time */
            assert_int_equal(t.info.factors, 1);
        }
}

/* Two closed ideal switches in parallel carry 1 A: v = 0 twice; only i1 + i2 = 1 is given, equal shares. */
static void redundant_equalities(void **state) {
    (void)state;
    trial t = {.m = 3,
               .rows = {0, 1, 1, -1, 0, 0, -1, 0, 0},
               .q = {-1, 0, 0},
               .l = {-INF, -INF, -INF},
               .u = {INF, INF, INF}};
    assert_int_equal(run(&t), NS_OK);
    trial_close(t.lambda[0], 0);
    trial_close(t.lambda[1], 0.5);
    trial_close(t.lambda[2], 0.5);
}

/* A resistor with both ends floating: v1 - v2 = R * 0 is all that is known; the answer nearest to 0 is 0. */
static void floating_part(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {1e-3, -1e-3, -1e-3, 1e-3}, .l = {-INF, -INF}, .u = {INF, INF}};
    assert_int_equal(run(&t), NS_OK);
    trial_close(t.lambda[0], t.lambda[1]);
    t.q[0] = 1e-3; /* 1 mA driven through it from one end to the other: v2 - v1 = 1 */
    t.q[1] = -1e-3;
    assert_int_equal(run(&t), NS_OK);
    assert_true(fabs(t.lambda[1] - t.lambda[0] - 1.0) < 1e-10); /* residual bound of the solver */
}

/* A capacitor of 10 V is switched onto an empty one by a diode bridge within a step of 1e-14 s: unknowns
 * (vp, vn, vt, iL, i of p->t, n->t, g->p, g->n), C1 and L between p and n, C2 and R at t.  p->t and g->n
 * carry 2e8 A, twenty decades above what any start suggests: vn = 0, vp = vt = C1 10 V / (C1 + C2 + h/R) but
 * for h^2/L against C1, which is 1e-20. */
static void a_jump_by_a_huge_current(void **state) {
    (void)state;
    const double C1 = 1e-6, C2 = 3e-7, L = 1e-2, R = 1e3, h = 1e-14;
    trial t = {.m = 8,
               .rows = {C1, -C1, 0,          h, h,  0,  -h, 0,  /* p */
                        0,  0,   C2 + h / R, 0, -h, -h, 0,  0,  /* t */
                        -h, h,   0,          L, 0,  0,  0,  0,  /* L */
                        0,  0,   0,          0, 1,  1,  -1, -1, /* p, n, t together */
                        -1, 0,   1,          0, 0,  0,  0,  0,  0, -1, 1, 0, 0, 0, 0, 0,
                        1,  0,   0,          0, 0,  0,  0,  0,  0, 1,  0, 0, 0, 0, 0, 0},
               .q = {-C1 * 10}};
    trial_complementary(&t);
    for (int i = 0; i < 4; i++)
        t.l[i] = -INF;
    assert_int_equal(run(&t), NS_OK);
    double v = C1 * 10 / (C1 + C2 + h / R);
    trial_close(t.lambda[0], v);
    trial_close(t.lambda[1], 0);
    trial_close(t.lambda[2], v);
    trial_close(t.lambda[4], (C2 + h / R) * v / h);
    assert_int_equal(t.mode[5], NS_LOWER);
    assert_int_equal(t.mode[6], NS_LOWER);
}

static int named(const ns_fault *f, int pair) {
    for (int k = 0; k < f->npairs; k++)
        if (f->pair[k] == pair)
            return 1;
    return 0;
}

/* Sources of 5 V and 6 V in parallel: v = 5 and v = 6. */
static void contradicting_equalities(void **state) {
    (void)state;
    trial t = {.m = 3,
               .rows = {1e-3, 1, 1, -1, 0, 0, -1, 0, 0},
               .q = {0, 5, 6},
               .l = {-INF, -INF, -INF},
               .u = {INF, INF, INF}};
    assert_int_equal(run(&t), NS_E_INFEASIBLE);
    assert_true(named(&t.info.fault, 1) && named(&t.info.fault, 2) && !named(&t.info.fault, 0));
}

/* An ideal diode (pair 2) straight across a source of 5 V: y = -v = -5.  A healthy clamp (nodes 3, 4)
 * stands beside it and must not be blamed. */
static void diode_across_a_source(void **state) {
    (void)state;
    trial t = {.m = 5,
               .rows = {0, 1, 1, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, -1, 0},
               .q = {0, 5, 0, -1, 0},
               .l = {-INF, -INF, 0, -INF, 0},
               .u = {INF, INF, INF, INF, INF}};
    for (int start = -1; start <= 0; start++) {
        memset(t.mode, start, sizeof t.mode);
        assert_int_equal(run(&t), NS_E_INFEASIBLE);
        assert_true(named(&t.info.fault, 2));
        assert_false(named(&t.info.fault, 4));
        assert_true(t.info.factors <= 4); /* two of pivoting; proved by the first ray: no other start */
    }
}

/* y2 = -l1 - l2 - 1 is negative for all l >= 0. */
static void no_complementary_solution(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {0, 1, -1, -1}, .q = {-1, -1}};
    trial_complementary(&t);
    assert_int_equal(run(&t), NS_E_INFEASIBLE);
    assert_true(named(&t.info.fault, 1));
}

/* Not monotone: y = -lambda + 1 has the two solutions 0 and 1. */
static void more_than_one_solution(void **state) {
    (void)state;
    for (int start = -1; start <= 0; start++) {
        trial t = {.m = 1, .rows = {-1}, .q = {1}, .l = {0}, .u = {INF}};
        t.mode[0] = (ns_mode)start;
        assert_int_equal(run(&t), NS_OK);
        assert_true(t.lambda[0] == (start == NS_INSIDE ? 1.0 : 0.0)); /* keeps to the start */
        assert_int_equal(t.info.pivots, 0);
    }
}

/* y = (l2 - 1, 1 - l1): l = (1,1) only, as l2 = 0 makes y1 = -1.  Each y depends on the other pair alone. */
static void a_skew_matrix(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {0, 1, -1, 0}, .q = {-1, 1}};
    trial_complementary(&t);
    assert_int_equal(run(&t), NS_OK);
    assert_true(fabs(t.lambda[0] - 1) < 1e-14 && fabs(t.lambda[1] - 1) < 1e-14);
}

/* W = I, q = (0, 0, -1): two pairs have lambda = y = 0, at the start and in the answer. */
static void a_start_at_the_kink(void **state) {
    (void)state;
    trial t = {.m = 3, .rows = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .q = {0, 0, -1}};
    trial_complementary(&t);
    t.u[1] = 1;
    assert_int_equal(run(&t), NS_OK);
    assert_true(t.lambda[0] == 0 && t.lambda[1] == 0 && t.lambda[2] == 1);
}

/* The discrete Laplacian of n points between walls, pushed by q = -1: W = tridiag(-1, 2, -1), lambda_i =
 * i (n+1-i) / 2 > 0. */
static void obstacle(void **state) {
    (void)state;
    trial t = {.m = 19};
    for (int i = 0; i < t.m; i++) {
        t.q[i] = -1;
        t.rows[i * t.m + i] = 2;
        if (i > 0)
            t.rows[i * t.m + i - 1] = t.rows[(i - 1) * t.m + i] = -1;
    }
    trial_complementary(&t);
    assert_int_equal(run(&t), NS_OK);
    for (int i = 0; i < t.m; i++) /* 50: the largest; condition 160 */
        assert_true(fabs(t.lambda[i] - (i + 1) * (t.m - i) / 2.0) <= 50 * 160 * 1e-15);
}

static void nothing_to_solve(void **state) {
    (void)state;
    trial t = {.m = 0};
    assert_int_equal(run(&t), NS_OK);
    ns_mlcp p = {.m = 0, .W = NULL, .q = NULL, .l = NULL, .u = NULL};
    assert_true(ns_mlcp_residual(&p, NULL, NULL) == 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_pair_of_each_law),
        cmocka_unit_test(two_coupled_pairs),
        cmocka_unit_test(all_laws_together),
        cmocka_unit_test(diode_clamp),
        cmocka_unit_test(a_node_that_only_diodes_hold),
        cmocka_unit_test(redundant_equalities),
        cmocka_unit_test(floating_part),
        cmocka_unit_test(a_jump_by_a_huge_current),
        cmocka_unit_test(contradicting_equalities),
        cmocka_unit_test(diode_across_a_source),
        cmocka_unit_test(no_complementary_solution),
        cmocka_unit_test(more_than_one_solution),
        cmocka_unit_test(a_skew_matrix),
        cmocka_unit_test(a_start_at_the_kink),
        cmocka_unit_test(obstacle),
        cmocka_unit_test(nothing_to_solve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
