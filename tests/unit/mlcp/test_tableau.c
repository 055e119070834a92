/* tests/unit/mlcp/test_tableau.c - the tableau of the pairs, entry by entry against the equations it stands
 * for, solved by Gauss-Jordan elimination in long double; Lemke's method on problems whose paths are known.
 */
#include "generators.h"
#include "prepared.h"

enum { MODES = 400 };

static const double *column_of(const ns_mlcp_solver *s, int var) {
    return var == 2 * s->np ? s->tab.cover : s->W + (size_t)s->pair[var / 2] * (size_t)s->m;
}

/* The basic variables, out[row], where nonbasic variable `one` (-1: none) is 1 more than at rest: lambda at
 * its bound, y and t at 0.  0: the equations are nearly singular. */
static int expect(const ns_mlcp_solver *s, int one, double *out) {
    const int n = s->np;
    long double y[MAX], A[MAX + 1][MAX + 1], x[MAX + 1] = {0}, zero[MAX] = {0};
    int var[MAX + 1], row[MAX + 1], k = 0, rows = 0;
    for (int i = 0; i < s->m; i++)
        y[i] = s->q[i];
    for (int v = 0; v <= 2 * n; v++) {
        const int is_y = v % 2 == 1, basic = s->tab.where[v] >= 0;
        if (basic && !is_y)
            var[k++] = v;
        if (!basic && is_y) {
            zero[s->pair[v / 2]] = v == one;
            row[rows++] = s->pair[v / 2];
        }
        if (basic || is_y)
            continue;
        const int a = v / 2;
        const double rest = v == 2 * n ? 0 : s->tab.at_upper[a] ? s->p->u[s->pair[a]] : s->p->l[s->pair[a]];
        for (int i = 0; i < s->m; i++)
            y[i] += (long double)column_of(s, v)[i] * ((long double)rest + (v == one));
    }
    for (int f = 0; f < s->nf; f++)
        row[rows++] = s->free[f];
    assert_int_equal(rows, k + s->nf);
    for (int i = 0; i < rows; i++) {
        x[i] = zero[row[i]] - y[row[i]];
        for (int j = 0; j < rows; j++)
            A[i][j] = j < k ? column_of(s, var[j])[row[i]] : s->W[row[i] + s->free[j - k] * s->m];
    }
    if (!solve(rows, A, x))
        return 0;
    for (int i = 0; i < s->m; i++)
        for (int j = 0; j < rows; j++)
            y[i] += x[j] * (j < k ? column_of(s, var[j])[i] : s->W[i + s->free[j - k] * s->m]);
    for (int j = 0; j < k; j++)
        out[s->tab.where[var[j]]] = (double)x[j];
    for (int a = 0; a < n; a++)
        if (s->tab.where[2 * a + 1] >= 0)
            out[s->tab.where[2 * a + 1]] = (double)y[s->pair[a]];
    return 1;
}

/* Pivots above 1e-3 of entries below 8: errors of some hundred operations below 1e-10.  What is 0 in exact
 * arithmetic is 0. */
static int assert_tableau(const ns_mlcp_solver *s, int with_values) {
    const ns_mlcp_tableau *t = &s->tab;
    double rest[MAX + 1] = {0}, moved[MAX + 1] = {0};
    if (!expect(s, -1, rest))
        return 0;
    for (int r = 0; r < s->np && with_values; r++)
        assert_true(fabs(t->beta[r] * t->unit[t->rowvar[r]] - rest[r]) <= 1e-10 * (1 + fabs(rest[r])));
    for (int c = 0; c < t->ncol; c++) {
        assert_true(expect(s, t->colvar[c], moved));
        for (int r = 0; r < s->np; r++) {
            const double got = t->T[r + c * s->np] * t->unit[t->rowvar[r]] / t->unit[t->colvar[c]],
                         should = moved[r] - rest[r];
            assert_true(fabs(got - should) <= 1e-10 * (1 + fabs(rest[r]) + fabs(moved[r])));
            if (with_values && fabs(should) < 1e-15)
                assert_true(t->T[r + c * s->np] == 0);
        }
    }
    return 1;
}

static void assert_labels(const ns_mlcp_solver *s) {
    for (int a = 0; a < s->np; a++) {
        const int i = s->pair[a];
        assert_int_equal(s->tab.rowvar[a] % 2 == 0, s->mode[i] == NS_INSIDE);
        assert_int_equal(s->tab.first_y[a], s->mode[i] != NS_INSIDE);
        assert_int_equal(s->tab.at_upper[a], s->mode[i] == NS_UPPER);
        assert_true(s->tab.lo[a] * s->tab.unit[2 * a] == s->p->l[i] ||
                    fabs(s->tab.lo[a] * s->tab.unit[2 * a] - s->p->l[i]) < 1e-15);
        assert_true(s->tab.hi[a] * s->tab.unit[2 * a] == s->p->u[i] ||
                    fabs(s->tab.hi[a] * s->tab.unit[2 * a] - s->p->u[i]) < 1e-15);
    }
    for (int v = 0; v <= 2 * s->np; v++) {
        const int at = s->tab.where[v];
        if (at >= 0)
            assert_int_equal(s->tab.rowvar[at], v);
        else if (v < 2 * s->np || s->tab.ncol > s->np)
            assert_int_equal(s->tab.colvar[-1 - at], v);
    }
}

/* Any exchange with a pivot of some size, t among the columns. */
static void exchange(ns_mlcp_solver *s, dice *d) {
    for (int k = 0; k < 20; k++) {
        const int r = dice_below(d, s->np), c = dice_below(d, s->tab.ncol), out = s->tab.rowvar[r];
        const double v = s->tab.T[r + c * s->np];
        if (fabs(v) < 0.1 || fabs(v) > 10)
            continue;
        if (out % 2 == 0 && out < 2 * s->np)
            s->tab.at_upper[out / 2] = isinf(s->tab.lo[out / 2]) || (isfinite(s->tab.hi[out / 2]) && k % 2);
        ns_mlcp_tableau_exchange(s, r, c);
        return;
    }
}

static void is_the_equations_solved(void **state) {
    (void)state;
    int seen = 0, with_t = 0;
    for (unsigned number = 0; number < MODES; number++) {
        dice d = dice_make(91, number);
        rig r = {0};
        draw(&r, &d);
        ns_mlcp_solver *s = begin(&r);
        for (int i = 0; i < s->m; i++)
            s->mode[i] = ns_mlcp_fit_mode(s, i, (ns_mode)(dice_below(&d, 3) - 1));
        double rcond = 0;
        if (ns_mlcp_basis_factor(s, &rcond) == NS_OK && rcond > 1e-3 && s->np > 0) {
            ns_mlcp_basis_values(s, 1);
            ns_mlcp_basis_sizes(s);
            ns_mlcp_tableau_start(s);
            assert_labels(s);
            seen += assert_tableau(s, 1);
            for (int i = 0; i < s->m; i++)
                s->tab.cover[i] = dice_eighths(&d, 2);
            s->tab.colvar[s->np] = 2 * s->np;
            s->tab.ncol = s->np + 1;
            if (ns_mlcp_tableau_refresh(s) == NS_OK)
                (void)assert_tableau(s, 1);
            for (int k = 0; k < 6; k++) {
                exchange(s, &d);
                assert_tableau(s, 0);
                if (k % 3 == 2 && ns_mlcp_tableau_refresh(s) == NS_OK)
                    (void)assert_tableau(s, 1);
                with_t += s->tab.where[2 * s->np] >= 0;
            }
        }
        ns_mlcp_free(s);
    }
    print_message("%d modes, t basic %d times\n", seen, with_t);
    assert_true(seen > MODES / 2 && with_t > MODES / 2);
}

/* Murty's problem, M_ii = 1, M_ij = 2 for j < i, q_i = -(2^(n-i) + ... + 2^n): with the covering vector of
 * ones Lemke's method makes 2^n pivots, that of t included (K. G. Murty, Math. Programming Study 7, 1978). No
 * more than times (50 + 20 n) are made. */
static void a_path_through_all_modes(void **state) {
    (void)state;
    for (int n = 1; n <= 8; n++) {
        rig r = {.m = n};
        for (int i = 0; i < n; i++) {
            r.u[i] = INF;
            for (int j = 0; j <= i; j++) {
                r.W[i + j * n] = i == j ? 1 : 2;
                r.q[i] -= ldexp(1, n - j);
            }
        }
        ns_mlcp_solver *s = begin(&r);
        for (int times = 1; times <= 2; times++) {
            ns_mlcp_start_from(s, NULL);
            assert_int_equal(ns_mlcp_basis_factor(s, NULL), NS_OK);
            ns_mlcp_basis_values(s, 0);
            for (int i = 0; i < n; i++)
                s->ysize[i] = s->lsize[i] = 1;
            ns_mlcp_tableau_start(s);
            s->pivots = 0;
            const int status = ns_mlcp_lemke(s, 0, times);
            const int most = times * (50 + 20 * n), needed = (1 << n) - 1;
            assert_int_equal(status, needed <= most ? NS_OK : NS_E_LIMIT);
            assert_int_equal(s->pivots, needed <= most ? needed : most);
            for (int i = 0; i < n && status == NS_OK; i++) /* lambda_0 = 2^n: y_i = q_i + 2^(n+1) > 0 */
                assert_int_equal(s->mode[i], i == 0 ? NS_INSIDE : NS_LOWER);
        }
        ns_mlcp_free(s);
    }
}

/* Ties and nonmonotone matrices: with the right row among those that tie a path is about as long as there are
 * pairs, here 0.5 times (degenerate) and 1.4 times (copositive); with any of them 3 and 18 times. */
static void paths_stay_short_through_ties(void **state) {
    (void)state;
    static const struct {
        int class, most; /* pivots a pair */
    } c[] = {{CLASS_DEGENERATE, 1}, {CLASS_COPOSITIVE, 3}};
    sample z;
    ns_mlcp_solver *s;
    ns_mode mode[40];
    double lambda[40], y[40];
    assert_int_equal(sample_create(40, &z), 0);
    assert_int_equal(ns_mlcp_create(40, &s), NS_OK);
    assert_int_equal(ns_mlcp_use(s, NS_MLCP_LEMKE), NS_OK);
    for (int k = 0; k < 2; k++) {
        long pivots = 0, pairs = 0;
        for (unsigned number = 0; number < 300; number++) {
            generate(&z, c[k].class, number, 40);
            const ns_mlcp p = sample_problem(&z);
            ns_mlcp_info info;
            memset(mode, NS_LOWER, sizeof mode);
            assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, &info), NS_OK);
            pivots += info.pivots;
            pairs += z.m;
        }
        print_message("%s: %ld pivots, %ld pairs\n", generator_name(c[k].class), pivots, pairs);
        assert_true(pivots <= c[k].most * pairs);
    }
    ns_mlcp_free(s);
    sample_free(&z);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_the_equations_solved),
        cmocka_unit_test(a_path_through_all_modes),
        cmocka_unit_test(paths_stay_short_through_ties),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
