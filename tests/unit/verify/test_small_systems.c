/* tests/unit/verify/test_small_systems.c - systems of one or two rows, in which every number that decides is
 * known. */
#include "small_system.h"

/* x' = 0, y = 1 - lambda; lambda 0.5: neither open nor closed.  1 if it counts as sliding. */
static int slides(int by_state, double on, double lambda) {
    const double x = 0.5;
    const ns_verify_state at = {0, NS_RIGHT, &x, &lambda, NULL, 0};
    const ns_signal half = dc(0.5);
    ns_system *s;
    ns_verify *v;
    ns_verify_finding f;
    assert_int_equal(ns_system_create(1, 1, 1, 1, &s), NS_OK);
    s->M[0] = s->e[0] = 1;
    s->D[0] = -1;
    command(s, by_state, on, 0.5);
    assert_int_equal(ns_system_set_input(s, 0, &half), NS_OK);
    assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
    (void)ns_verify_point(v, &at, &f);
    const int it_slides = ns_verify_slides(v, 0);
    assert_int_equal(ns_verify_slidings(v), it_slides);
    const double open = 0, low = 0.25;
    const ns_verify_state later = {0, NS_RIGHT, by_state ? &low : &x, &open, NULL, 0};
    assert_int_equal(ns_verify_point(v, &later, &f), 1); /* open below the threshold, or at it */
    assert_int_equal(ns_verify_slides(v, 0), 0);
    assert_int_equal(ns_verify_slidings(v), 0);
    ns_verify_free(v);
    ns_system_free(s);
    return it_slides;
}

static void which_switches_slide(void **state) {
    (void)state;
    assert_int_equal(slides(1, 0.5, 0.5), 1);
    assert_int_equal(slides(0, 0.5, 0.5), 0);   /* by a source */
    assert_int_equal(slides(1, 0.6, 0.5), 0);   /* with hysteresis */
    assert_int_equal(slides(1, 0.5, 1e-15), 0); /* open: so little is nothing (1e-15 A) */
}

/* Of the second of three controls: x_0 alone is in the first one, z in the second, x_0 in the third. */
static void each_control_has_its_own_row(void **state) {
    const double x = 0.5, lambda[3] = {0.5, 0.5, 0.5};
    const ns_verify_state at = {0, NS_RIGHT, &x, lambda, NULL, 0};
    const ns_signal half = dc(0.5);
    ns_system *s;
    ns_verify *v;
    ns_verify_finding f;
    (void)state;
    assert_int_equal(ns_system_create(1, 3, 1, 3, &s), NS_OK);
    s->M[0] = 1;
    for (int j = 0; j < 3; j++) {
        double *gain = calloc(1, sizeof *gain);
        assert_non_null(gain);
        gain[0] = 1;
        s->e[j] = 1;
        s->D[j + 3 * j] = -1;
        s->l[j] = -INFINITY;
        s->u[j] = INFINITY;
        s->command[j] = (ns_command){.pair = j, .on = 0.5, .off = 0.5};
        *(j == 1 ? &s->command[j].gz : &s->command[j].gx) = gain;
    }
    assert_int_equal(ns_system_set_input(s, 0, &half), NS_OK);
    assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
    (void)ns_verify_point(v, &at, &f);
    for (int j = 0; j < 3; j++)
        assert_int_equal(ns_verify_slides(v, j), j != 1);
    assert_int_equal(ns_verify_slidings(v), 2);
    ns_verify_free(v);
    ns_system_free(s);
}

/* In a hurry a diode is a pair of 0 <= lambda without an upper bound, y a difference; others: with a lower
 * bound that is not 0, an upper one, a command, a y that is twice an unknown. */
static void plain_pairs(void **state) {
    enum { M = 5 };
    ns_system *s;
    ns_verify *v;
    (void)state;
    assert_int_equal(ns_system_create(2, M, 0, 1, &s), NS_OK);
    s->M[0] = s->M[3] = 1;
    command(s, 1, 0.5, 0.5); /* pair 0 */
    for (int j = 0; j < M; j++) {
        s->C[j] = j == 4 ? 2 : 1;
        s->C[j + M] = -1;
        s->u[j] = j == 2 ? 3 : INFINITY;
    }
    s->l[3] = -1;
    assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
    assert_int_equal(v->quick.plains, 1);
    assert_int_equal(v->quick.plain[0], 1);
    assert_int_equal(v->quick.others, M - 1);
    ns_verify_free(v);
    ns_system_free(s);
}

/* x' = 0 from 5: in a hurry a charge stays if it moves by what it may be off by over its weight, and not by
 * 1.5 times as much; after twice the charge was seen, by that too. */
static void a_charge_that_moves_in_a_hurry(void **state) {
    const double x = 5;
    const ns_verify_state at = {0, NS_RIGHT, &x, NULL, NULL, 0};
    ns_system *s;
    ns_verify *v;
    ns_verify_finding f;
    (void)state;
    assert_int_equal(ns_system_create(1, 0, 0, 0, &s), NS_OK);
    s->M[0] = 1;
    assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
    assert_true(ns_verify_point(v, &at, &f));
    ns_verify_sizes_charge(v, 0, 5);
    assert_true(ns_verify_quick_point(v, &at));
    const double times = fabs(v->quick.charge[0]) * ns_verify_sizes_charge_off(v, 0);
    assert_true(times >= 1 - 1e-12 && times <= 2);
    for (int k = 0; k < 2; k++) {
        const double after = 5 + (k ? 1.5 : 0.75) / fabs(v->quick.charge[0]);
        const ns_verify_state right = {0, NS_RIGHT, &after, NULL, NULL, 0};
        ns_verify_quick_left(v, &at);
        assert_true(ns_verify_quick_point(v, &right));
        v->quick.is_old = 0;
        assert_int_equal(ns_verify_quick_stays(v), !k);
    }
    ns_verify_sizes_charge(v, 0, 10);
    v->quick.is_old = 1;
    assert_true(ns_verify_quick_stays(v));
    ns_verify_free(v);
    ns_system_free(s);
}

/* 0 = z - x, where z jumps from 0 to 5 V at 1 s: at that instant x may be between, and beyond it may not. */
static void between_the_sides_of_a_jump(void **state) {
    static const double t[] = {1, 1}, volts[] = {0, 5};
    const ns_signal step = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = volts, .repeat = NAN}};
    const double x = 2;
    (void)state;
    for (int k = 0; k < 4; k++) {
        const ns_verify_state at = {
            k < 2 ? 1 : k == 2 ? 0.5 : 2, k == 1 ? NS_LEFT : NS_RIGHT, &x, NULL, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
        s->A[0] = -1;
        s->E[0] = 1;
        assert_int_equal(ns_system_set_input(s, 0, &step), NS_OK);
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_int_equal(ns_verify_point(v, &at, &f), k < 2);
        assert_int_equal(f.cause, k < 2 ? NS_VERIFY_RIGHT : NS_VERIFY_ROW);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x' = 0 at 0.5 V, y = 1 + 0 z - lambda; the switch closes above 0.6 V and opens below 0.4 V.  It opens or
 * closes at 1 s, where z jumps, or stays. */
static int changes(int closes, int jumps, ns_verify_finding *f) {
    static const double t[] = {1, 1};
    const double volts[] = {0, jumps ? 1 : 0}, x = 0.5, open = 0, closed = 1, X = 0, Lambda = 0;
    const ns_signal step = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = volts, .repeat = NAN}};
    const ns_verify_state left = {1, NS_LEFT, &x, closes ? &open : &closed, NULL, 0},
                          right = {1, NS_RIGHT, &x, closes ? &closed : &open, NULL, 0};
    ns_system *s;
    ns_verify *v;
    assert_int_equal(ns_system_create(1, 1, 1, 1, &s), NS_OK);
    s->M[0] = s->e[0] = 1;
    s->D[0] = -1;
    command(s, 1, 0.6, 0.4);
    assert_int_equal(ns_system_set_input(s, 0, &step), NS_OK);
    assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
    assert_true(ns_verify_point(v, &left, f));
    ns_verify_left(v);
    assert_true(ns_verify_point(v, &right, f));
    const int is_right = ns_verify_event(v, &X, &Lambda, f);
    ns_verify_free(v);
    ns_system_free(s);
    return is_right;
}

static void a_change_without_a_cause(void **state) {
    ns_verify_finding f;
    (void)state;
    for (int closes = 0; closes < 2; closes++) {
        assert_false(changes(closes, 0, &f));
        assert_int_equal(f.cause, NS_VERIFY_COMMAND);
        assert_int_equal(f.pair, 0);
        assert_int_equal(f.unknown, -1);
        assert_true(changes(closes, 1, &f)); /* the source may be the cause */
    }
}

/* The same, beside a second switch that is open on the left side and carries and blocks nothing on the right
 * one, as unknown 2 falls from 1 V to 0.  That may have closed where its control is at 0.6 V, not at 0.4 V,
 * where it would open. */
static void a_change_beside_an_unloaded_switch(void **state) {
    const double at[] = {0.6, 0.4};
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double before[3] = {0.5, at[k], 1}, after[3] = {0.5, at[k], 0}, open[2] = {0, 0},
                     closed[2] = {1, 0};
        const double none[3] = {0, 0, 0};
        const ns_verify_state left = {1, NS_LEFT, before, open, NULL, 0},
                              right = {1, NS_RIGHT, after, closed, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(3, 2, 0, 2, &s), NS_OK);
        s->M[0] = s->M[4] = s->e[0] = 1;
        s->D[0] = -1;
        s->C[1 + 2 * 2] = 1;
        for (int c = 0; c < 2; c++) {
            s->l[c] = -INFINITY;
            s->u[c] = INFINITY;
            s->command[c] = (ns_command){.pair = c, .on = 0.6, .off = 0.4, .gx = calloc(3, sizeof(double))};
            assert_non_null(s->command[c].gx);
            s->command[c].gx[c] = 1;
        }
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_true(ns_verify_point(v, &left, &f));
        ns_verify_left(v);
        assert_true(ns_verify_point(v, &right, &f));
        assert_int_equal(ns_verify_event(v, none, none, &f), k == 0);
        assert_int_equal(f.cause, k == 0 ? NS_VERIFY_RIGHT : NS_VERIFY_COMMAND);
        assert_int_equal(f.pair, k == 0 ? -1 : 0);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* A line that ends with 9 V at 3 s stays there, however often it is asked for. */
static void an_input_after_its_last_corner(void **state) {
    static const double t[] = {0, 3}, volts[] = {0, 9};
    const ns_signal line = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = volts, .repeat = NAN}};
    ns_system *s;
    ns_verify *v;
    double z;
    (void)state;
    assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
    s->M[0] = s->E[0] = 1;
    assert_int_equal(ns_system_set_input(s, 0, &line), NS_OK);
    assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
    for (int k = 0; k < 5; k++) {
        ns_verify_inputs_at(v, 4 + k, k % 2 ? NS_LEFT : NS_RIGHT, &z);
        assert_true(z == 9);
    }
    ns_verify_free(v);
    ns_system_free(s);
}

/* y_0 = x, y_1 = x + 2 z_0 + 3 z_1 with z = (5, 7), x = 1: 1 and 32. */
static void outputs_of_inputs(void **state) {
    const ns_signal z[] = {dc(5), dc(7)};
    const double x = 1, lambda[2] = {0, 0}, shown[][2] = {{1, 32}, {1, 22}, {1, 11}, {2, 32}};
    (void)state;
    for (int k = 0; k < 4; k++) {
        const ns_verify_state at = {0, NS_RIGHT, &x, lambda, shown[k], 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 2, 2, 0, &s), NS_OK);
        s->M[0] = s->C[0] = s->C[1] = 1;
        s->F[1] = 2;
        s->F[3] = 3;
        for (int j = 0; j < 2; j++) {
            s->u[j] = INFINITY;
            assert_int_equal(ns_system_set_input(s, j, &z[j]), NS_OK);
        }
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_int_equal(ns_verify_point(v, &at, &f), k == 0);
        assert_int_equal(f.cause, k == 0 ? NS_VERIFY_RIGHT : NS_VERIFY_OUTPUT);
        assert_int_equal(f.pair, k == 0 ? -1 : k < 3);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* Which of two unknowns and two currents is no number. */
static void which_is_no_number(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        double u[4] = {1, 1, 1, 1};
        const ns_verify_state at = {0, NS_RIGHT, u, u + 2, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(2, 2, 0, 0, &s), NS_OK);
        s->M[0] = s->M[3] = 1;
        s->u[0] = s->u[1] = INFINITY;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_true(ns_verify_point(v, &at, &f));
        u[k] = NAN;
        assert_false(ns_verify_point(v, &at, &f));
        assert_int_equal(f.cause, NS_VERIFY_NUMBER);
        assert_int_equal(f.unknown, k < 2 ? k : -1);
        assert_int_equal(f.pair, k < 2 ? -1 : k - 2);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* A step of 2e-16 s after an event, or of 0.1 s: 1 at its left side is 1e18 or 1e20 after it.  Beside 1e20 a
 * double keeps no digit of 1. */
static void digits_are_kept(void **state) {
    const double left[2] = {1, 1}, after[] = {1e18, 1e20, 1e20}, time[] = {1 + 2e-16, 1 + 2e-16, 1.1};
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double u[2] = {1, -after[k]};
        const ns_verify_state before = {1, NS_LEFT, left, NULL, NULL, 0},
                              at = {time[k], NS_RIGHT, u, NULL, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(2, 0, 0, 0, &s), NS_OK);
        s->M[0] = s->M[3] = 1;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_true(ns_verify_point(v, &before, &f));
        ns_verify_left(v);
        assert_true(ns_verify_point(v, &at, &f));
        assert_int_equal(ns_verify_keeps_digits(v, &f), k != 1);
        assert_int_equal(f.cause == NS_VERIFY_NUMBER && f.unknown == 1, k == 1);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x_0' = -x_1, y_0 = y_1 = x_1 = 0 on both sides.  x_0 falls from 6 to 5 by an impulse of 1 of x_1, so that y
 * has one: after it lambda is 0, of both pairs.  `which` has 2. */
static void what_follows_an_impulse(void **state) {
    (void)state;
    for (int which = -1; which < 2; which++) {
        const double before[2] = {6, 0}, after[2] = {5, 0}, none[2] = {0, 0}, X[2] = {0, 1};
        double lambda[2] = {0, 0};
        if (which >= 0)
            lambda[which] = 2;
        const ns_verify_state left = {1, NS_LEFT, before, none, NULL, 0},
                              right = {1, NS_RIGHT, after, lambda, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(2, 2, 0, 0, &s), NS_OK);
        s->M[0] = 1;
        s->A[0 + 2 * 1] = -1;
        s->C[0 + 2 * 1] = s->C[1 + 2 * 1] = 1;
        s->u[0] = s->u[1] = INFINITY;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_true(ns_verify_point(v, &left, &f));
        ns_verify_left(v);
        assert_true(ns_verify_point(v, &right, &f));
        assert_int_equal(ns_verify_event(v, X, none, &f), which < 0);
        assert_int_equal(f.cause, which < 0 ? NS_VERIFY_RIGHT : NS_VERIFY_IMPULSE);
        assert_int_equal(f.pair, which);
        assert_int_equal(f.unknown, -1);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x' = z_0 - z_1, both 1 kV: a step of 1 s may be off by 1e-8 of these terms, 2e-5, as x stays. */
static void rounding_in_a_step(void **state) {
    const ns_signal z = dc(1000);
    const double before = 0, after[] = {1e-5, -1e-5, 1e-3, -1e-3};
    (void)state;
    for (int k = 0; k < 4; k++) {
        const ns_verify_state from = {0, NS_RIGHT, &before, NULL, NULL, 0},
                              to = {1, NS_LEFT, &after[k], NULL, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 0, 2, 0, &s), NS_OK);
        s->M[0] = s->E[0] = 1;
        s->E[1] = -1;
        assert_int_equal(ns_system_set_input(s, 0, &z), NS_OK);
        assert_int_equal(ns_system_set_input(s, 1, &z), NS_OK);
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_int_equal(ns_verify_step(v, &from, &to, &f), k < 2);
        assert_int_equal(f.cause, k < 2 ? NS_VERIFY_RIGHT : NS_VERIFY_FLOW);
        assert_int_equal(f.unknown, k < 2 ? -1 : 0);
        assert_int_equal(f.pair, -1);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(which_switches_slide),
        cmocka_unit_test(each_control_has_its_own_row),
        cmocka_unit_test(plain_pairs),
        cmocka_unit_test(a_charge_that_moves_in_a_hurry),
        cmocka_unit_test(between_the_sides_of_a_jump),
        cmocka_unit_test(a_change_without_a_cause),
        cmocka_unit_test(a_change_beside_an_unloaded_switch),
        cmocka_unit_test(an_input_after_its_last_corner),
        cmocka_unit_test(outputs_of_inputs),
        cmocka_unit_test(which_is_no_number),
        cmocka_unit_test(digits_are_kept),
        cmocka_unit_test(what_follows_an_impulse),
        cmocka_unit_test(rounding_in_a_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
