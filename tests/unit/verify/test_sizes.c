/* tests/unit/verify/test_sizes.c - what each number may be off by, term by term, against "What counts as an
 * error" of src/verify/README.md; times and weights of the integrals against Lobatto's rule. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"
#include "verify/verify_internal.h"

static const double reltol = 1e-9;

static void assert_close(double is, double should) {
    if (!(fabs(is - should) <= 1e-12 * fabs(should)))
        print_message("%.17g is not %.17g\n", is, should);
    assert_true(fabs(is - should) <= 1e-12 * fabs(should));
}

/* 0 = x_0 - 2 x_1 + 3 lambda + z - 4, 5 x_1' = x_0 (row 1), y = 6 x_0 - x_1 + 1; its pair is a switch, closed
 * above 7, open below -3, by 2 x_1 + x_0. */
typedef struct bench {
    ns_system *s;
    ns_verify *v;
} bench;

static bench open_bench(void) {
    const ns_verify_options o = {.reltol = reltol, .instant = 1e-11};
    bench b;
    assert_int_equal(ns_system_create(2, 1, 1, 1, &b.s), NS_OK);
    b.s->A[0] = 1;
    b.s->A[0 + 1 * 2] = -2;
    b.s->B[0] = 3;
    b.s->E[0] = 1;
    b.s->b[0] = -4;
    b.s->M[1 + 1 * 2] = 5;
    b.s->A[1] = 1;
    b.s->C[0] = 6;
    b.s->C[1] = -1;
    b.s->e[0] = 1;
    b.s->command[0] = (ns_command){.pair = 0, .on = 7, .off = -3};
    b.s->command[0].gx = calloc(2, sizeof(double));
    assert_non_null(b.s->command[0].gx);
    b.s->command[0].gx[0] = 1;
    b.s->command[0].gx[1] = 2;
    assert_int_equal(ns_verify_create(b.s, &o, &b.v), NS_OK);
    memset(b.v->most_law, 0, sizeof *b.v->most_law * ns_verify_sizes(b.s)); /* nothing was seen */
    return b;
}

static void close_bench(bench *b) {
    ns_verify_free(b->v);
    ns_system_free(b->s);
}

/* 1e-5 of the largest terms of a row; 1e-12 of the largest number times what a row multiplies it by. */
static void rows(void **state) {
    bench b = open_bench();
    (void)state;
    b.v->most_law[0] = 8;
    assert_close(ns_verify_sizes_law_off(b.v, 0), 8e-5);
    b.v->most_any[NS_VERIFY_ANY_NUMBER] = 1e9;
    const double size = 1 + 2 + 3 + 1; /* of row 0, without its constant */
    assert_close(ns_verify_sizes_law_off(b.v, 0), 8e-5 + 1e-12 * 1e9 * size);
    assert_close(ns_verify_sizes_leak(b.v, &b.v->law, 0), 1e-10 * 1e9 * size);
    assert_close(ns_verify_sizes_held_off(b.v, -20), 20e-5 + 1e-12 * 1e9);
    b.v->times_row[0] = 2;
    ns_verify_scale(b.v, 10, 1e-11, 0);
    assert_close(ns_verify_sizes_law_off(b.v, 0), 20 * (8e-5 + 1e-12 * 1e9 * size));
    close_bench(&b);
}

/* Before anything is seen the largest number is that of the sources, wherever it stands in them. */
static void sources(void **state) {
    const double t[] = {0, 1, 2}, first[] = {-8, 3, 2}, second[] = {1, 9, -2};
    const struct {
        ns_signal z;
        double largest;
    } of[] = {
        {{.kind = NS_DC, .u.dc = -3}, 3},
        {{.kind = NS_PULSE, .u.pulse = {.v1 = -4, .v2 = 2, .tr = 1, .tf = 1, .pw = 1, .per = 5}}, 4},
        {{.kind = NS_SIN, .u.sin = {.vo = -1, .va = -2, .freq = 1}}, 3},
        {{.kind = NS_EXP, .u.exp = {.v1 = 2, .v2 = -5, .tau1 = 1, .td2 = 1, .tau2 = 1}}, 5},
        {{.kind = NS_PWL, .u.pwl = {.n = 3, .t = (double *)t, .v = (double *)first, .repeat = NAN}}, 8},
        {{.kind = NS_PWL, .u.pwl = {.n = 3, .t = (double *)t, .v = (double *)second, .repeat = NAN}}, 9}};
    (void)state;
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const ns_verify_options o = {.reltol = reltol, .instant = 1e-11};
        bench b = open_bench();
        ns_verify_free(b.v);
        assert_int_equal(ns_system_set_input(b.s, 0, &of[k].z), NS_OK);
        assert_int_equal(ns_verify_create(b.s, &o, &b.v), NS_OK);
        assert_close(b.v->most_any[NS_VERIFY_ANY_NUMBER], of[k].largest);
        close_bench(&b);
    }
}

/* 1e-5 of the largest terms and 100 reltol of them; 1e-9 of the largest energy's root, in units of the row
 * (the root of 5); 1e-10 of the largest number. */
static void charges(void **state) {
    bench b = open_bench();
    (void)state;
    ns_verify_sizes_charge(b.v, 1, 32);
    assert_close(ns_verify_most_charge(b.v, 1), 40); /* what grows does so by a quarter more than it must */
    assert_close(b.v->most_any[NS_VERIFY_ANY_ENERGY], 40 / sqrt(5));
    ns_verify_sizes_charge(b.v, 1, 39); /* no larger */
    assert_close(ns_verify_most_charge(b.v, 1), 40);
    const double own = 40e-5 + 100 * reltol * 40;
    assert_close(ns_verify_sizes_charge_off(b.v, 1), own + 1e-9 * 40);
    b.v->most_any[NS_VERIFY_ANY_ENERGY] = 1e6;
    b.v->most_any[NS_VERIFY_ANY_NUMBER] = 1e9;
    const double all = own + 1e-9 * 1e6 * sqrt(5) + 1e-10 * 1e9 * 5;
    assert_close(ns_verify_sizes_charge_off(b.v, 1), all);
    b.v->times_row[1] = 3;
    ns_verify_scale(b.v, 10, 1e-11, 0);
    assert_close(ns_verify_sizes_charge_off(b.v, 1), 30 * all);
    close_bench(&b);
}

/* 1e-4 of the largest of its own, 1e-5 of that of all pairs, what nobody looks at; y: 1e-10 of the largest
 * number times what (S3) multiplies it by. */
static void pairs(void **state) {
    bench b = open_bench();
    (void)state;
    assert_close(ns_verify_off_y(b.v, 0), 1e-12);
    assert_close(ns_verify_off_lambda(b.v, 0), 1e-15);
    b.v->most_y[0] = 3;
    b.v->most_lambda[0] = 2;
    assert_close(ns_verify_off_y(b.v, 0), 3e-4 + 1e-12);
    assert_close(ns_verify_off_lambda(b.v, 0), 2e-4 + 1e-15);
    b.v->most_any[NS_VERIFY_ANY_Y] = 500;
    b.v->most_any[NS_VERIFY_ANY_LAMBDA] = 700;
    assert_close(ns_verify_off_lambda(b.v, 0), 2e-4 + 700e-5 + 1e-15);
    b.v->most_any[NS_VERIFY_ANY_NUMBER] = 1e9;
    const double y = 3e-4 + 500e-5 + 1e-10 * 1e9 * (6 + 1) + 1e-12;
    assert_close(ns_verify_off_y(b.v, 0), y);
    b.v->times_pair[0] = 4;
    ns_verify_scale(b.v, 10, 1e-11, 0);
    assert_close(ns_verify_off_y(b.v, 0), 40 * y);
    assert_close(ns_verify_off_lambda(b.v, 0), 40 * (2e-4 + 700e-5 + 1e-15));
    close_bench(&b);
}

/* lambda enters row 0 alone, by 3: 1e-10 of the largest number, by the sum of the sizes of that row, over 3.
 */
static void rounding_around_a_pair(void **state) {
    bench b = open_bench();
    (void)state;
    assert_true(ns_verify_sizes_rounding_around(b.v, 0) == 0);
    b.v->most_any[NS_VERIFY_ANY_NUMBER] = 1e9;
    b.v->times_pair[0] = 2;
    assert_close(ns_verify_sizes_rounding_around(b.v, 0), 2 * 1e-10 * 1e9 * 7 / 3);
    close_bench(&b);
}

/* 1e-3 of the largest that it was, and of either threshold; 1e-12 of the largest number by 1 + 2. */
static void controls(void **state) {
    bench b = open_bench();
    (void)state;
    assert_close(ns_verify_off_control(b.v, 0), 7e-3);
    b.s->command[0].off = -8;
    assert_close(ns_verify_off_control(b.v, 0), 8e-3);
    b.v->most_control[0] = 9;
    assert_close(ns_verify_off_control(b.v, 0), 9e-3);
    b.v->most_any[NS_VERIFY_ANY_NUMBER] = 1e9;
    assert_close(ns_verify_off_control(b.v, 0), 9e-3 + 1e-12 * 1e9 * 3);
    close_bench(&b);
}

/* The largest number of x, lambda, z, wherever it is; the one, which is no number of the circuit, and u
 * beyond it are not among them. */
static void the_largest_number(void **state) {
    bench b = open_bench();
    double *largest = &b.v->most_any[NS_VERIFY_ANY_NUMBER];
    (void)state;
    for (int at = 0; at < 4; at++) {
        double u[] = {0.1, 0.1, 0.1, 0.1, 1, 0};
        *largest = 0;
        u[at] = at % 2 ? -0.4 : 0.4;
        ns_verify_sizes_numbers(b.v, u);
        assert_close(*largest, 0.5); /* and a quarter more */
    }
    close_bench(&b);
}

/* What was found after the first, by an error of so much: sizes that grew in between stay where it may be
 * rounding, and what was found is loose from then on; else they are what they were. */
static void what_was_found(void **state) {
    (void)state;
    for (int is_pair = 0; is_pair < 2; is_pair++)
        for (int wrong = 0; wrong < 2; wrong++) {
            bench b = open_bench();
            ns_verify_finding f = ns_verify_nothing(0);
            b.v->grew = 1;
            assert_int_equal(ns_verify_sizes_end(b.v, &f), 1);
            b.v->quick.is_old = 0;
            b.v->most_any[NS_VERIFY_ANY_LAMBDA] = 0;
            b.v->is_loose_row[0] = b.v->is_loose_row[1] = b.v->is_loose_pair[0] = 0;
            ns_verify_grow(b.v, &b.v->most_any[NS_VERIFY_ANY_LAMBDA], 8);
            ns_verify_note(&f, NS_VERIFY_LAW, is_pair ? 0 : -1, is_pair ? -1 : 0,
                           wrong ? ns_verify_wrong * 1.001 : ns_verify_wrong * 0.999);
            assert_int_equal(ns_verify_sizes_end(b.v, &f), !wrong);
            assert_int_equal(f.cause, wrong ? NS_VERIFY_LAW : NS_VERIFY_RIGHT);
            assert_close(b.v->most_any[NS_VERIFY_ANY_LAMBDA], wrong ? 0 : 10);
            assert_int_equal(b.v->quick.is_old != 0, !wrong);
            assert_int_equal(b.v->is_loose_pair[0] != 0, is_pair && !wrong);
            assert_int_equal(b.v->is_loose_row[0] != 0, !is_pair && !wrong);
            assert_int_equal(b.v->is_loose_row[1], 0);
            f = ns_verify_nothing(0);
            ns_verify_grow(b.v, &b.v->most_any[NS_VERIFY_ANY_LAMBDA], 80);
            ns_verify_note(&f, NS_VERIFY_LAW, 0, -1, 2 * ns_verify_wrong);
            assert_int_equal(ns_verify_sizes_end(b.v, &f), 0);
            assert_close(b.v->most_any[NS_VERIFY_ANY_LAMBDA], wrong ? 0 : 10);
            b.v->quick.is_old = 0;
            f = ns_verify_nothing(0); /* nothing grew since: what changed otherwise stays */
            b.v->most_any[NS_VERIFY_ANY_LAMBDA] = 3;
            ns_verify_note(&f, NS_VERIFY_LAW, 0, -1, 2 * ns_verify_wrong);
            assert_int_equal(ns_verify_sizes_end(b.v, &f), 0);
            assert_close(b.v->most_any[NS_VERIFY_ANY_LAMBDA], 3);
            assert_int_equal(b.v->quick.is_old, 0);
            f = ns_verify_nothing(0);
            ns_verify_note(&f, NS_VERIFY_LAW, 0, -1, 0.5 * ns_verify_wrong);
            assert_int_equal(ns_verify_sizes_end(b.v, &f), 1);
            assert_true(b.v->quick.is_old);
            close_bench(&b);
        }
}

/* What is ten times too much may be rounding: from then on ten times as much passes in a hurry too. */
static void what_may_be_rounding_is_loose(void **state) {
    bench b = open_bench();
    (void)state;
    double x[2] = {-10, 3}, lambda[1] = {0}, y[1]; /* the control is -4: open */
    const ns_signal z = dc(20);
    assert_int_equal(ns_system_set_input(b.s, 0, &z), NS_OK);
    ns_verify_renew(b.v);
    y[0] = 6 * x[0] - x[1] + 1;
    const ns_verify_state at = {0, NS_RIGHT, x, lambda, y, 0};
    ns_verify_finding f;
    assert_true(ns_verify_point(b.v, &at, &f)); /* -10 - 6 + 20 - 4 = 0 */
    const double law = ns_verify_sizes_law_off(b.v, 0);
    for (int times = 2; times <= 12; times += 10) {
        x[0] = -10 + times * law; /* the row is off by so many times what it may be */
        y[0] = 6 * x[0] - x[1] + 1;
        b.v->is_loose_row[0] = 0;
        b.v->quick.is_ready = 0;
        assert_int_equal(ns_verify_quick_point(b.v, &at), 0);
        b.v->is_loose_row[0] = 1;
        b.v->quick.is_ready = 0; /* weights are from 1 to 2 */
        assert_int_equal(ns_verify_quick_point(b.v, &at), times * 2 < ns_verify_wrong);
    }
    close_bench(&b);
}

/* Lobatto's rule of five points is exact to degree 7 (Abramowitz and Stegun, 25.4.32). */
static void nodes_of_a_way(void **state) {
    static const double weight[] = {0.1, 49.0 / 90, 32.0 / 45, 49.0 / 90, 0.1};
    double t[NS_VERIFY_NODES];
    (void)state;
    ns_verify_flow_times(2, 6, t);
    assert_true(t[0] == 2 && t[2] == 4 && t[4] == 6);
    for (int degree = 0; degree <= 7; degree++) {
        double sum = 0;
        for (int k = 0; k < NS_VERIFY_NODES; k++)
            sum += 2 * weight[k] * pow(t[k], degree);
        assert_close(sum, (pow(6, degree + 1) - pow(2, degree + 1)) / (degree + 1));
    }
    for (int k = 0; k + 1 < NS_VERIFY_NODES; k++)
        assert_true(t[k] < t[k + 1]);
}

/* x_0' = x_1 = unit t^degree from 0 to 1, the integral is unit/(degree+1): 1 if x_0 at the end may be off by
 * this part of it. */
static int flow_is_right(double unit, int degree, double off) {
    const ns_verify_options o = {.reltol = reltol, .instant = 1e-11};
    ns_system *s;
    ns_verify *v;
    ns_verify_finding f;
    double t[NS_VERIFY_NODES], x[2 * NS_VERIFY_NODES];
    assert_int_equal(ns_system_create(2, 0, 0, 0, &s), NS_OK);
    s->M[0] = 1;
    s->A[0 + 1 * 2] = 1;
    assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
    ns_verify_flow_times(0, 1, t);
    for (int k = 0; k < NS_VERIFY_NODES; k++) {
        x[2 * k] = unit * pow(t[k], degree + 1) / (degree + 1) * (1 + (k == NS_VERIFY_NODES - 1 ? off : 0));
        x[2 * k + 1] = unit * pow(t[k], degree);
    }
    const int right = ns_verify_flow(v, t, x, &f);
    assert_true(right || (f.cause == NS_VERIFY_FLOW && f.pair == -1 && f.unknown == 0));
    ns_verify_free(v);
    ns_system_free(s);
    return right;
}

/* Simpson's rule, by which the error is judged, is exact to degree 3; Lobatto's to 7. */
static void integrals_of_a_way(void **state) {
    (void)state;
    for (int degree = 0; degree <= 3; degree++) {
        assert_true(flow_is_right(1, degree, 0));
        assert_false(flow_is_right(1, degree, 1e-3));
        assert_false(flow_is_right(1, degree, -1e-3));
    }
    assert_true(flow_is_right(1e-6, 1, 0));
    assert_false(flow_is_right(1e-6, 1, 1e-3)); /* small numbers have errors that are small too */
    for (int degree = 4; degree <= 7; degree++)
        assert_true(flow_is_right(1, degree, 0));
}

/* x' = z, which is 1 from 0 to 1 s and jumps at both: on the way from 0 to 1 s it is 1 at either end. */
static void a_way_between_jumps(void **state) {
    static const double at[] = {0, 0, 1, 1}, volts[] = {0, 1, 1, 3};
    const ns_signal z = {.kind = NS_PWL, .u.pwl = {.n = 4, .t = at, .v = volts, .repeat = NAN}};
    const ns_verify_options o = {.reltol = reltol, .instant = 1e-11};
    const double rate[] = {1, 0.96, 1.04, 1.1, 0.9};
    (void)state;
    for (int n = 0; n < 5; n++) {
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        double t[NS_VERIFY_NODES], x[NS_VERIFY_NODES];
        assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
        s->M[0] = s->E[0] = 1;
        assert_int_equal(ns_system_set_input(s, 0, &z), NS_OK);
        assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
        ns_verify_flow_times(0, 1, t);
        for (int k = 0; k < NS_VERIFY_NODES; k++)
            x[k] = rate[n] * t[k];
        assert_int_equal(ns_verify_flow(v, t, x, &f), n == 0);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sources),
        cmocka_unit_test(rows),
        cmocka_unit_test(charges),
        cmocka_unit_test(pairs),
        cmocka_unit_test(rounding_around_a_pair),
        cmocka_unit_test(controls),
        cmocka_unit_test(the_largest_number),
        cmocka_unit_test(what_was_found),
        cmocka_unit_test(what_may_be_rounding_is_loose),
        cmocka_unit_test(nodes_of_a_way),
        cmocka_unit_test(integrals_of_a_way),
        cmocka_unit_test(a_way_between_jumps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
