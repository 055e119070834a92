/* tests/unit/mlcp/test_columns.c - columns of W on demand. */
#include "proofs.h"
#include "wrap_alloc.h"

typedef struct columns {
    const trial *t;
    int asked[MAX], fails;
} columns;

static int column(void *data, int j, double *w) {
    columns *c = data;
    c->asked[j]++;
    memcpy(w, c->t->W + (size_t)j * (size_t)c->t->m, (size_t)c->t->m * sizeof *w);
    return j == c->fails;
}

/* The answers of the whole W, each column asked for once; that of the lambda that is given as 0 never. */
static void columns_on_demand(void **state) {
    (void)state;
    const double rows[16] = {2, 1, 0, 5, 1, 3, 1, 6, 0, 1, 4, 7, 8, 9, 1, 2};
    trial t = {.m = 4, .q = {-3, 1, -2, -1}, .l = {0, -INF, -1, 0}, .u = {INF, INF, 1, 0}};
    by_rows(&t, rows);
    assert_int_equal(solve(&t, NS_MLCP_AUTO), NS_OK);
    for (int method = NS_MLCP_AUTO; method <= NS_MLCP_LEMKE; method++) {
        columns c = {.t = &t, .fails = -1};
        ns_mlcp p = {.m = 4, .q = t.q, .l = t.l, .u = t.u, .column = column, .data = &c};
        ns_mode mode[4] = {0};
        double lambda[4], y[4];
        ns_mlcp_solver *s;
        assert_int_equal(ns_mlcp_create(4, &s), NS_OK);
        assert_int_equal(ns_mlcp_use(s, (ns_mlcp_method)method), NS_OK);
        assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, NULL), NS_OK);
        for (int j = 0; j < 4; j++) {
            assert_int_equal(c.asked[j], j < 3);
            close_to(lambda[j], t.lambda[j]);
            close_to(y[j], j == 3 ? 8 * lambda[0] + 9 * lambda[1] + lambda[2] - 1 : t.y[j]);
        }
        c.fails = 1;
        assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, NULL), NS_E_NUMBER);
        c.fails = 3; /* not asked for */
        assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, NULL), NS_OK);
        ns_mlcp_free(s);
    }
}

static void residual_and_margin_of_columns_on_demand(void **state) {
    (void)state;
    trial t = {.m = 2, .W = {-2, -1, 1, -1}, .q = {3, -1}, .u = {INF, INF}};
    const double lambda[2] = {0.5, 2}, v[2] = {0, 1};
    columns c = {.t = &t, .fails = -1};
    ns_mlcp whole = problem(&t), p = whole;
    p.W = NULL;
    p.column = column;
    p.data = &c;
    int worst[2];
    assert_true(ns_mlcp_residual(&whole, lambda, &worst[0]) > 0.1);
    assert_true(ns_mlcp_residual(&p, lambda, &worst[1]) == ns_mlcp_residual(&whole, lambda, NULL));
    assert_int_equal(worst[0], worst[1]);
    assert_true(c.asked[0] == 1 && c.asked[1] == 1);
    assert_true(ns_mlcp_certify(&p, v) == 1.0); /* y2 + 1 + lambda1 + lambda2 >= 1 of 1 */
    assert_true(c.asked[0] == 2 && c.asked[1] == 2);
    c.fails = 1;
    assert_true(isnan(ns_mlcp_residual(&p, lambda, NULL)));
    assert_true(isnan(ns_mlcp_certify(&p, v)));
    p.column = NULL;
    assert_true(isnan(ns_mlcp_residual(&p, lambda, NULL)));
}

/* The identity, of 129 columns. */
static int unit_column(void *data, int j, double *w) {
    const int m = *(const int *)data;
    for (int i = 0; i < m; i++)
        w[i] = i == j;
    return 0;
}

static void without_memory_there_is_no_number(void **state) {
    (void)state;
    enum { LARGE = 129 };
    static double W[LARGE * LARGE], q[LARGE], l[LARGE], u[LARGE], x[LARGE];
    int m = LARGE;
    for (int i = 0; i < m; i++) {
        (void)unit_column(&m, i, W + (size_t)i * LARGE);
        u[i] = INF;
    }
    ns_mlcp p = {.m = m, .W = W, .q = q, .l = l, .u = u}, few = {.m = m, .q = q, .l = l, .u = u};
    few.column = unit_column;
    few.data = &m;
    assert_true(ns_mlcp_residual(&p, x, NULL) == 0.0);
    assert_true(ns_mlcp_residual(&few, x, NULL) == 0.0);
    assert_true(ns_mlcp_certify(&few, x) == -1.0);
    double got[4];
    for (long k = 1; k <= 2; k++) {
        fail_alloc_at(k);
        got[k] = ns_mlcp_residual(&few, x, NULL);
        fail_alloc_off();
        assert_true(isnan(got[k]));
    }
    fail_alloc_at(1);
    got[0] = ns_mlcp_residual(&p, x, NULL);
    fail_alloc_at(1);
    got[1] = ns_mlcp_certify(&few, x);
    fail_alloc_at(1);
    got[2] = ns_mlcp_certify(&p, x);
    fail_alloc_off();
    assert_true(isnan(got[0]) && isnan(got[1]));
    assert_true(got[2] == -1.0); /* needs none */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_on_demand),
        cmocka_unit_test(residual_and_margin_of_columns_on_demand),
        cmocka_unit_test(without_memory_there_is_no_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
