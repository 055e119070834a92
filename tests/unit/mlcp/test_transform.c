/* tests/unit/mlcp/test_transform.c - the principal pivot transform, entry by entry against the equations it
 * stands for, solved by Gauss-Jordan elimination in long double. */
#include "mlcp/pivoting/transform.h"
#include "prepared.h"

enum { PROBLEMS = 300, EXCHANGES = 12 };

/* lambda of the basic pairs and y of all where y_i - q_i of the basic pair `one` is 1 (basic), or lambda_one
 * is 1 (else), and every other nonbasic variable is 0.  0: nearly singular. */
static int expect(const ns_mlcp_solver *s, int one, double *lambda, double *y) {
    const unsigned char *basic = s->transform.basic;
    for (int i = 0; i < s->m; i++) {
        lambda[i] = i == one;
        y[i] = i == one;
    }
    return solve_for(s->m, s->W, NULL, basic, basic, lambda, y);
}

/* Entries of pairs that are looked at.  Pivots above 1e-3 of entries below 8: errors below 1e-10. */
static void assert_transform(ns_mlcp_solver *s) {
    const ns_mlcp_transform *t = &s->transform;
    const size_t ld = ((size_t)s->m + 3) / 4 * 4;
    double lambda[MAX] = {0}, y[MAX] = {0}, rate[MAX];
    for (int b = 0; b < t->count; b++) {
        assert_int_equal(t->place[t->pair[b]], b);
        if (!expect(s, t->pair[b], lambda, y))
            return;
        for (int a = 0; a < t->count; a++) {
            const int i = t->pair[a];
            const double should = t->basic[i] ? lambda[i] : y[i];
            assert_true(fabs(t->P[(size_t)a + (size_t)b * ld] - should) <= 1e-10 * (1 + fabs(should)));
        }
    }
    for (int i = 0; i < s->m; i++) { /* which looks at i */
        if (!expect(s, i, lambda, y))
            return;
        ns_mlcp_transform_column(s, i, rate);
        for (int j = 0; j < s->m; j++) {
            const double should = t->basic[j] ? lambda[j] : y[j];
            assert_true(fabs(rate[j] - should) <= 1e-10 * (1 + fabs(should)));
        }
    }
}

/* The determinant of the pairs i and j (or i alone) in P: det of the block of W without them and with them.
 */
static double pivot_of(const ns_mlcp_solver *s, int i, int j) {
    const ns_mlcp_transform *t = &s->transform;
    const size_t ld = ((size_t)s->m + 3) / 4 * 4;
    const size_t a = (size_t)t->place[i], b = (size_t)t->place[j];
    return i == j ? t->P[a + a * ld]
                  : t->P[a + a * ld] * t->P[b + b * ld] - t->P[a + b * ld] * t->P[b + a * ld];
}

/* One or two pairs whose pivot is of some size. */
static void exchange(ns_mlcp_solver *s, dice *d) {
    const int i = dice_below(d, s->m), j = dice_below(d, s->m);
    const double trust = i == j ? ns_mlcp_transform_trust(s, i) : ns_mlcp_transform_trust2(s, i, j);
    const double pivot = fabs(pivot_of(s, i, j));
    assert_true(trust >= 0 && (trust > 0) == (pivot > 0));
    if (trust < 0.02 || pivot < 0.1 || pivot > 10)
        return;
    if (i == j)
        ns_mlcp_transform_pivot(s, i);
    else
        ns_mlcp_transform_pivot2(s, i, j);
}

static void is_the_equations_solved(void **state) {
    (void)state;
    long pivots = 0;
    for (unsigned number = 0; number < PROBLEMS; number++) {
        dice d = dice_make(92, number);
        rig r = {0};
        draw(&r, &d);
        ns_mlcp_solver *s = begin(&r);
        ns_mlcp_transform_start(s);
        for (int k = 0; k < EXCHANGES; k++) {
            exchange(s, &d);
            if (k % 3 == 0) {
                ns_mlcp_transform_tidy(s);
                for (int a = 0; a < s->transform.count; a++)
                    assert_true(s->transform.basic[s->transform.pair[a]]);
            }
            assert_transform(s);
        }
        pivots += s->pivots;
        ns_mlcp_free(s);
    }
    print_message("%ld exchanges\n", pivots);
    assert_true(pivots > 4 * PROBLEMS);
}

/* Any modes that the transform's basic pairs allow; lambda and y of them, with lterms. */
static void take_values(ns_mlcp_solver *s, dice *d) {
    for (int i = 0; i < s->m; i++) {
        const ns_mode side = dice_chance(d, 0.5) ? NS_LOWER : NS_UPPER;
        s->mode[i] = s->transform.basic[i] ? NS_INSIDE : ns_mlcp_fit_mode(s, i, side);
    }
    ns_mlcp_transform_tidy(s);
    ns_mlcp_transform_values(s);
    ns_mlcp_sum_terms(s->p, &s->own.nonzeros, s->lambda, s->y, s->transform.yterms);
}

/* lambda at its bounds, but for the basic, whose y is 0; y is W lambda + q. */
static void assert_values(const ns_mlcp_solver *s, double tol) {
    for (int i = 0; i < s->m; i++) {
        long double y = s->p->q[i];
        for (int j = 0; j < s->m; j++)
            y += (long double)s->W[i + j * s->m] * s->lambda[j];
        assert_true(fabs(s->y[i] - (double)y) <= tol);
        if (s->transform.basic[i])
            assert_true(fabs(s->y[i]) <= tol);
        else
            assert_true(fabs(s->lambda[i] - (s->mode[i] == NS_UPPER ? s->p->u[i] : s->p->l[i])) <= tol);
    }
}

/* Moves a pair to the other mode, exchanges it, and computes the values of that mode anew: they are those
 * that the move led to. */
static int move_one(ns_mlcp_solver *s, dice *d) {
    const int i = dice_below(d, s->m);
    int all[MAX];
    const double trust = ns_mlcp_transform_trust(s, i), pivot = fabs(pivot_of(s, i, i));
    if (s->p->l[i] == s->p->u[i] || trust < 0.02 || pivot < 0.1 || pivot > 10)
        return 0;
    for (int j = 0; j < s->m; j++)
        all[j] = j;
    s->mode[i] = s->transform.basic[i] ? ns_mlcp_fit_mode(s, i, NS_UPPER) : NS_INSIDE;
    s->transform.carried = 1;
    ns_mlcp_transform_move(s, i, s->m, all);
    assert_int_equal(s->transform.carried, s->own.nonzeros.few); /* y of all, with its terms */
    ns_mlcp_transform_pivot(s, i);
    assert_values(s, 1e-8);
    return 1;
}

/* From a basis of well-conditioned equations (pivots 0.1 .. 10): errors far below 1e-8. */
static void values_corrections_and_moves(void **state) {
    (void)state;
    int moved = 0, few = 0;
    for (unsigned number = 0; number < PROBLEMS; number++) {
        dice d = dice_make(93, number);
        rig r = {0};
        draw(&r, &d);
        for (int i = 0; i < r.m; i++)
            if (isinf(r.l[i]) && isinf(r.u[i]))
                r.l[i] = 0;
        for (int k = 0; k < r.m * r.m && number % 3 == 0; k++) /* few entries are listed */
            if (k % (r.m + 1) != 0 && !dice_chance(&d, 0.3))
                r.W[k] = 0;
        ns_mlcp_solver *s = begin(&r);
        ns_mlcp_transform_start(s);
        for (int k = 0; k < EXCHANGES; k++)
            exchange(s, &d);
        take_values(s, &d);
        assert_values(s, 1e-8);
        few += s->own.nonzeros.few;
        for (int i = 0; i < s->m; i++)
            s->lambda[i] += s->transform.basic[i] ? 1e-3 * (i + 1) : 0;
        ns_mlcp_sum_terms(s->p, &s->own.nonzeros, s->lambda, s->y, s->transform.yterms);
        ns_mlcp_transform_correct(s);
        ns_mlcp_sum_terms(s->p, &s->own.nonzeros, s->lambda, s->y, s->transform.yterms);
        assert_values(s, 1e-8);
        moved += move_one(s, &d);
        ns_mlcp_free(s);
    }
    print_message("%d moves, %d with few entries\n", moved, few);
    assert_true(moved > PROBLEMS / 4 && few > PROBLEMS / 10);
}

/* lterms of basic pairs: |P| times the terms that y - q at the bounds is summed from. */
static void terms_are_those_of_the_sums(void **state) {
    (void)state;
    for (unsigned number = 0; number < PROBLEMS; number++) {
        dice d = dice_make(94, number);
        rig r = {0};
        draw(&r, &d);
        for (int i = 0; i < r.m; i++) { /* all at 0, or not */
            r.l[i] = number % 2 ? -1 : 0;
            r.u[i] = number % 2 ? 1 : INF;
        }
        ns_mlcp_solver *s = begin(&r);
        ns_mlcp_transform_start(s);
        for (int k = 0; k < EXCHANGES; k++)
            exchange(s, &d);
        take_values(s, &d);
        const size_t n = (size_t)s->transform.count, ld = ((size_t)s->m + 3) / 4 * 4;
        for (size_t a = 0; a < n; a++) {
            double sum = 0;
            for (size_t b = 0; b < n; b++) {
                const int i = s->transform.pair[b];
                double terms = fabs(s->q[i]);
                for (int j = 0; j < s->m; j++)
                    terms += s->transform.basic[j] ? 0 : fabs(s->W[i + j * s->m] * s->lambda[j]);
                sum += fabs(s->transform.P[a + b * ld]) * terms;
            }
            assert_true(fabs(s->transform.lterms[s->transform.pair[a]] - sum) <= 1e-12 * sum);
        }
        ns_mlcp_free(s);
    }
}

/* Powers of two as units of rows and columns change no digit of what is left of a pivot. */
static void trust_has_no_units(void **state) {
    (void)state;
    for (unsigned number = 0; number < PROBLEMS; number++) {
        dice d = dice_make(95, number);
        rig r = {0}, scaled;
        draw(&r, &d);
        scaled = r;
        for (int j = 0; j < r.m; j++)
            for (int i = 0; i < r.m; i++)
                scaled.W[i + j * r.m] = ldexp(r.W[i + j * r.m], (7 * i + 3) % 11 - 5 + (5 * j + 1) % 13 - 6);
        ns_mlcp_solver *s[] = {begin(&r), begin(&scaled)};
        for (int k = 0; k < 2; k++)
            ns_mlcp_transform_start(s[k]);
        for (int k = 0; k < EXCHANGES; k++) {
            const int i = dice_below(&d, r.m), j = dice_below(&d, r.m);
            double trust[2];
            for (int c = 0; c < 2; c++) {
                trust[c] = i == j ? ns_mlcp_transform_trust(s[c], i) : ns_mlcp_transform_trust2(s[c], i, j);
                if (trust[c] > 1e-3 && i == j)
                    ns_mlcp_transform_pivot(s[c], i);
                else if (trust[c] > 1e-3)
                    ns_mlcp_transform_pivot2(s[c], i, j);
            }
            assert_true(trust[0] == trust[1]);
        }
        for (int c = 0; c < 2; c++)
            ns_mlcp_free(s[c]);
    }
}

/* A list of pairs is exchanged, whatever their order, as far as their pivots can be trusted. */
static void lists_are_exchanged(void **state) {
    (void)state;
    int whole = 0;
    for (unsigned number = 0; number < PROBLEMS; number++) {
        dice d = dice_make(96, number);
        rig r = {0};
        draw(&r, &d);
        ns_mlcp_solver *s = begin(&r);
        int list[MAX], basic = 0;
        for (int i = 0; i < r.m; i++)
            list[i] = (i + (int)number) % r.m;
        ns_mlcp_transform_start(s);
        const int left = ns_mlcp_transform_exchange(s, r.m, list);
        for (int i = 0; i < r.m; i++)
            basic += s->transform.basic[i];
        assert_int_equal(left + basic, r.m);
        for (int k = 0; k < left; k++)
            assert_false(s->transform.basic[list[k]]);
        whole += left == 0;
        ns_mlcp_free(s);
    }
    assert_true(whole > PROBLEMS / 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_the_equations_solved),     cmocka_unit_test(values_corrections_and_moves),
        cmocka_unit_test(terms_are_those_of_the_sums), cmocka_unit_test(trust_has_no_units),
        cmocka_unit_test(lists_are_exchanged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
