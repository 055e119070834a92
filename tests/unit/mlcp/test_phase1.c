/* tests/unit/mlcp/test_phase1.c - the simplex tableau, entry by entry against the equations it stands for,
 * solved by Gauss-Jordan elimination in long double; where it ends: within all bounds, or with a proof that
 * none is. */
#include "mlcp/infeasible/phase1.h"
#include "prepared.h"

enum { PROBLEMS = 400 };

typedef struct tally {
    int met, proved, entries;
} tally;

/* Of s->q, which holds the given lambda, in the units of the tableau. */
static double scaled_W(const ns_mlcp_solver *s, int i, int j) {
    return ldexp(s->p->W[i + j * s->m], s->elim.row_exp[i] + s->elim.col_exp[j]);
}

/* Pivots above 1e-3 of entries of about 1: errors far below 1e-9. */
static int assert_columns(const ns_phase1 *z) {
    const ns_mlcp_solver *s = z->s;
    const int m = s->m;
    double W[MAX * MAX], lambda[MAX], y[MAX];
    unsigned char in[MAX] = {0}, held[MAX] = {0};
    int count = 0;
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++)
            W[i + j * m] = scaled_W(s, i, j);
    for (int r = 0; r < z->rows; r++)
        in[s->tab.rowvar[r] / 2] |= s->tab.rowvar[r] % 2 == 0;
    for (int c = 0; c < z->cols; c++)
        held[s->tab.colvar[c] / 2] |= s->tab.colvar[c] % 2 == 1;
    for (int c = 0; c < z->cols; c++) {
        memset(lambda, 0, sizeof lambda);
        memset(y, 0, sizeof y);
        (s->tab.colvar[c] % 2 ? y : lambda)[s->tab.colvar[c] / 2] = 1;
        if (!solve_for(m, W, NULL, in, held, lambda, y))
            return 0;
        for (int r = 0; r < z->rows; r++, count++) {
            const int var = s->tab.rowvar[r];
            const double should = (var % 2 ? y : lambda)[var / 2], got = s->elim.A[r + c * m];
            assert_true(fabs(got - should) <= 1e-9 * (1 + fabs(should)));
            assert_true(64 * s->elim.mag[r + c * m] >= fabs(got));
        }
    }
    return count;
}

/* All values: y = W lambda + q, the nonbasic at a bound (y: at 0). */
static void assert_values(const ns_phase1 *z, const double *value, const int *basic) {
    const ns_mlcp_solver *s = z->s;
    for (int i = 0; i < s->m; i++) {
        const int has_row = isinf(s->p->l[i]) || isinf(s->p->u[i]) || (z->boxes && s->p->l[i] != s->p->u[i]);
        double y = ldexp(s->q[i], s->elim.row_exp[i]), terms = fabs(y);
        for (int j = 0; j < s->m; j++) {
            y += scaled_W(s, i, j) * value[2 * j];
            terms += fabs(scaled_W(s, i, j) * value[2 * j]);
        }
        if (has_row)
            assert_true(fabs(value[2 * i + 1] - y) <= 1e-9 * (1 + terms));
        if (!basic[2 * i + 1])
            assert_true(value[2 * i + 1] == 0);
        if (!basic[2 * i] && s->p->l[i] != s->p->u[i] && !(isinf(s->p->l[i]) && isinf(s->p->u[i])))
            assert_true(value[2 * i] == s->tab.lo[i] || value[2 * i] == s->tab.hi[i]);
    }
}

/* Within bounds and signs of the modes, but for 1e-9. */
static void assert_met(const ns_phase1 *z, const double *value) {
    const ns_mlcp_solver *s = z->s;
    for (int i = 0; i < s->m; i++) {
        const double l = s->tab.lo[i], u = s->tab.hi[i], near = 1e-9 * (1 + fabs(value[2 * i]));
        if (s->p->l[i] == s->p->u[i])
            continue;
        assert_true(value[2 * i] >= (z->mode[i] == NS_UPPER ? u : l) - near);
        assert_true(value[2 * i] <= (z->mode[i] == NS_LOWER ? l : u) + near);
        if (isinf(s->p->l[i]) || z->mode[i] == NS_INSIDE || z->mode[i] == NS_UPPER)
            assert_true(value[2 * i + 1] <= 1e-9 * (1 + fabs(value[2 * i + 1])));
        if (isinf(s->p->u[i]) || z->mode[i] == NS_INSIDE || z->mode[i] == NS_LOWER)
            assert_true(value[2 * i + 1] >= -1e-9 * (1 + fabs(value[2 * i + 1])));
    }
}

static void run(ns_phase1 *z, tally *t) {
    double value[2 * MAX], v[MAX];
    int basic[2 * MAX];
    const int status = ns_mlcp_phase1_run(z);
    t->entries += assert_columns(z);
    ns_mlcp_phase1_read(z, value, basic);
    assert_values(z, value, basic);
    assert_true(status == NS_OK || status == NS_E_INFEASIBLE);
    if (status == NS_OK) {
        assert_met(z, value);
        t->met++;
    } else {
        assert_true(ns_mlcp_farkas_proves(z, v));
        assert_true(ns_mlcp_certify_modes(z->s->p, z->mode, v) > 1e-9);
        t->proved++;
    }
}

/* Random problems, then with a few pairs put into modes, one after another, and taken out again. */
static void ends_within_bounds_or_with_a_proof(void **state) {
    (void)state;
    tally t = {0, 0, 0};
    for (unsigned number = 0; number < PROBLEMS; number++) {
        dice d = dice_make(97, number);
        rig r = {0};
        draw(&r, &d);
        for (int i = 0; i < r.m; i++)
            r.q[i] -= number % 2 ? 6 * dice_uniform(&d) : 0;
        ns_mlcp_solver *s = begin(&r);
        ns_phase1 z;
        ns_mlcp_phase1_start(&z, s, 1, 0);
        t.entries += assert_columns(&z);
        run(&z, &t);
        for (int k = 0; k < 6 && s->np > 0; k++) {
            const int i = s->pair[dice_below(&d, s->np)];
            const ns_mode to = ns_mlcp_fit_mode(s, i, (ns_mode)(dice_below(&d, 3) - 1));
            ns_mlcp_phase1_put(&z, i, k % 3 == 2 ? NS_OPEN : to);
            run(&z, &t);
        }
        ns_mlcp_free(s);
    }
    print_message("%d met, %d proved, %d entries\n", t.met, t.proved, t.entries);
    assert_true(t.met > PROBLEMS && t.proved > PROBLEMS && t.entries > 100 * PROBLEMS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_within_bounds_or_with_a_proof),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
