/* tests/unit/verify/test_event.c - a jump that takes time: what flows in it belongs to the balance (J1). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"
#include "verify/verify_internal.h"

/* x_0' = z_0 + 2 z_1 + 4 with z = (1, 3): 11 per second. */
static ns_system *integrator(void) {
    const ns_signal z[] = {dc(1), dc(3)};
    ns_system *s;
    assert_int_equal(ns_system_create(1, 0, 2, 0, &s), NS_OK);
    s->M[0] = 1;
    s->E[0] = 1;
    s->E[1] = 2;
    s->b[0] = 4;
    for (int k = 0; k < 2; k++)
        assert_int_equal(ns_system_set_input(s, k, &z[k]), NS_OK);
    return s;
}

/* A check of s that saw both sides of an event, which are right as points. */
static ns_verify *from_left_to_right(const ns_system *s, const ns_verify_options *o,
                                     const ns_verify_state *left, const ns_verify_state *right) {
    ns_verify *v;
    ns_verify_finding f;
    assert_int_equal(ns_verify_create(s, o, &v), NS_OK);
    assert_true(ns_verify_point(v, left, &f));
    ns_verify_left(v);
    assert_true(ns_verify_point(v, right, &f));
    return v;
}

/* 1 if x_0 may move from 5 by that much within 0.5 s, without an impulse. */
static int passes(double by) {
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    ns_system *s = integrator();
    ns_verify *v;
    ns_verify_finding f;
    const double before = 5, after = before + by, X = 0.5 * (before + after) / 2;
    const ns_verify_state left = {1, NS_LEFT, &before, NULL, NULL, 0},
                          right = {1.5, NS_RIGHT, &after, NULL, NULL, 0};
    v = from_left_to_right(s, &o, &left, &right);
    const int is_right = ns_verify_event(v, &X, NULL, &f);
    assert_true(is_right || f.cause == NS_VERIFY_JUMP);
    ns_verify_free(v);
    ns_system_free(s);
    return is_right;
}

static void what_flows_in_the_time_of_a_jump(void **state) {
    (void)state;
    assert_true(passes(0.5 * 11));
    assert_false(passes(0.5 * (1 + 4)));     /* without z_1 */
    assert_false(passes(0.5 * (1 + 2 * 3))); /* without the constant */
    assert_false(passes(0.5 * 11 * 1.001));
}

/* In no time nothing flows but in transients, here of 1e-9 s, that die out: not what flows in the 0.5 s that
 * an event may take from one time to another. */
static void nothing_flows_in_no_time(void **state) {
    static const double by[] = {11 * 1e-9, 11 * 1e-3};
    const ns_verify_options o = {.reltol = 1e-14, .instant = 0.5, .transient = 1e-9};
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double before = 5, after = before + by[k], X = 0;
        const ns_verify_state left = {1, NS_LEFT, &before, NULL, NULL, 0},
                              right = {1, NS_RIGHT, &after, NULL, NULL, 0};
        ns_system *s = integrator();
        ns_verify *v;
        ns_verify_finding f;
        v = from_left_to_right(s, &o, &left, &right);
        assert_int_equal(ns_verify_event(v, &X, NULL, &f), k == 0);
        assert_int_equal(f.cause, k == 0 ? NS_VERIFY_RIGHT : NS_VERIFY_JUMP);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* An input that jumps from 0 to 5 at 1 s and rises by 2 a second from there to 3 s, on either side, whatever
 * was asked for before. */
static void sides_of_an_input(void **state) {
    static const double t[] = {0, 1, 1, 3}, volts[] = {0, 0, 5, 9};
    const ns_signal line = {.kind = NS_PWL, .u.pwl = {.n = 4, .t = t, .v = volts, .repeat = NAN}};
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    ns_system *s;
    ns_verify *v;
    double z;
    (void)state;
    assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
    s->M[0] = s->E[0] = 1;
    assert_int_equal(ns_system_set_input(s, 0, &line), NS_OK);
    assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
    for (int again = 0; again < 2; again++) {
        ns_verify_inputs_at(v, 1, NS_LEFT, &z);
        assert_true(z == 0);
        ns_verify_inputs_at(v, 1, NS_RIGHT, &z);
        assert_true(z == 5);
    }
    ns_verify_inputs_at(v, 2, NS_LEFT, &z);
    assert_true(fabs(z - 7) < 1e-14);
    ns_verify_free(v);
    ns_system_free(s);
}

/* x' = - sum of lambda_j, y_j = lambda_j, both 0 or more and one of them 0: no pair carries the impulse that
 * takes x from 5 to 4, whichever it is. */
static void no_pair_carries_an_impulse(void **state) {
    enum { PAIRS = 3 };
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    (void)state;
    for (int pair = -1; pair < PAIRS; pair++) {
        const double x = 5, after = pair < 0 ? 5 : 4, X = 0, none[PAIRS] = {0};
        const ns_verify_state left = {1, NS_LEFT, &x, none, none, 0},
                              right = {1, NS_RIGHT, &after, none, none, 0};
        double Lambda[PAIRS] = {0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, PAIRS, 0, 0, &s), NS_OK);
        s->M[0] = 1;
        for (int j = 0; j < PAIRS; j++)
            s->B[j] = -1, s->D[j + PAIRS * j] = 1;
        v = from_left_to_right(s, &o, &left, &right);
        if (pair >= 0)
            Lambda[pair] = 1;
        assert_int_equal(ns_verify_event(v, &X, Lambda, &f), pair < 0);
        assert_int_equal(f.cause, pair < 0 ? NS_VERIFY_RIGHT : NS_VERIFY_IMPULSE);
        assert_int_equal(f.pair, pair);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x0' = -lambda, y = x0, both 0 or more and one of them 0; x1 is stored, too.  An impulse of 5 A s takes x0
 * from 5 to 0.  The integral of x1 over that instant is nothing, or 1e-3, as over an Euler step of some time.
 */
static void nothing_stored_has_an_integral(void **state) {
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    (void)state;
    for (int lasts = 0; lasts < 2; lasts++) {
        const double x[] = {5, 2}, after[] = {0, 2}, X[] = {0, lasts ? 1e-3 : 0}, none = 0, Lambda = 5;
        const ns_verify_state left = {1, NS_LEFT, x, &none, NULL, 0},
                              right = {1, NS_RIGHT, after, &none, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(2, 1, 0, 0, &s), NS_OK);
        s->M[0] = s->M[3] = s->C[0] = 1;
        s->B[0] = -1;
        s->u[0] = INFINITY;
        v = from_left_to_right(s, &o, &left, &right);
        assert_int_equal(ns_verify_event(v, X, &Lambda, &f), !lasts);
        assert_int_equal(f.cause, lasts ? NS_VERIFY_JUMP : NS_VERIFY_RIGHT);
        assert_int_equal(f.unknown, lasts ? 1 : -1);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x' = 1 - lambda, 0 <= lambda, y = lambda: 0.5 A s backward through it within the 1 s that an event may
 * take.  What flows in that time does not excuse the direction: the pair is told, and no unknown. */
static void an_impulse_backward(void **state) {
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1, .transient = 1 / ns_verify_dies_out};
    (void)state;
    for (int backward = 0; backward < 2; backward++) {
        const double x = 5, after = backward ? 5.5 : 4.5, X = 0, none = 0, Lambda = backward ? -0.5 : 0.5;
        const ns_verify_state left = {1, NS_LEFT, &x, &none, NULL, 0},
                              right = {1, NS_RIGHT, &after, &none, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
        s->M[0] = s->b[0] = s->D[0] = 1;
        s->B[0] = -1;
        s->u[0] = INFINITY;
        v = from_left_to_right(s, &o, &left, &right);
        assert_int_equal(ns_verify_event(v, &X, &Lambda, &f), !backward);
        assert_int_equal(f.cause, backward ? NS_VERIFY_IMPULSE : NS_VERIFY_RIGHT);
        assert_int_equal(f.pair, backward ? 0 : -1);
        assert_int_equal(f.unknown, -1);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x0 = 0, 2 x1' = 3 x2' = 4 x3' = 0: x1 from 5 to 6 is 11 J more, to 5.001 it is 0.01 J, of nothing; to 4 it
 * is 9 J less, which is right.  In units 1e-6 of that, too. */
static void energy_of_nothing(void **state) {
    enum { N = 4 };
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    const double after[] = {6, 5.001, 4, 6e-6};
    (void)state;
    for (int k = 0; k < 4; k++) {
        const double unit = k == 3 ? 1e-6 : 1, x[N] = {0, 5 * unit, 3 * unit},
                     to[N] = {0, after[k], 3 * unit};
        const int grows = k != 2;
        const ns_verify_state left = {1, NS_LEFT, x, NULL, NULL, 0}, right = {2, NS_RIGHT, to, NULL, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(N, 0, 0, 0, &s), NS_OK);
        s->A[0] = -1;
        for (int i = 1; i < N; i++)
            s->M[i + N * i] = i + 1;
        v = from_left_to_right(s, &o, &left, &right);
        assert_true(v->is_passive);
        f = ns_verify_nothing(2);
        ns_verify_energy_over(v, 1, &f);
        assert_int_equal(f.cause, grows ? NS_VERIFY_ENERGY : NS_VERIFY_RIGHT);
        assert_int_equal(f.pair, -1);
        assert_int_equal(f.unknown, grows ? 1 : -1); /* the first that stores any */
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* Six unknowns: x0 nothing depends on; x1 a pair's voltage does; x2 a charge does; x3 a control does; a
 * pair's current is in the row of x4; x5 is in one row with x1. */
static void what_is_aside(void **state) {
    enum { N = 6 };
    const int aside[N] = {1, 0, 0, 0, 0, 0};
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    ns_system *s;
    ns_verify *v;
    (void)state;
    assert_int_equal(ns_system_create(N, 2, 0, 1, &s), NS_OK);
    for (int i = 0; i < N; i++)
        s->A[i + N * i] = -1;
    s->C[1 + 2 * 1] = 1;
    s->D[1 + 2 * 1] = 1;
    s->M[2 + N * 2] = 1;
    s->B[4 + N * 1] = 1;
    s->A[5 + N * 1] = 1;
    for (int j = 0; j < 2; j++)
        s->l[j] = -INFINITY, s->u[j] = INFINITY;
    s->command[0] = (ns_command){.pair = 0, .on = 0.5, .off = 0.5, .gx = calloc(N, sizeof(double))};
    assert_non_null(s->command[0].gx);
    s->command[0].gx[3] = 1;
    assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
    for (int i = 0; i < N; i++)
        assert_int_equal(v->is_aside[i], aside[i]);
    ns_verify_free(v);
    ns_system_free(s);
}

/* 0 = 1000 z - x, where z rises by 1 in 1e-13 s, and y = x - x_0, lambda = 1: x moves by 8.9 in 4 eps of 1 s,
 * so y is zero to twice that: 5 is nothing, 300 is no zero. */
static void a_steep_input(void **state) {
    static const double t[] = {1, 1 + 1e-13}, volts[] = {0, 1};
    const ns_signal edge = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = volts, .repeat = NAN}};
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    const double at_t = 1 + 0.5e-13, x = 1000 * ns_signal_value(&edge, at_t, NS_LEFT), lambda = 1;
    const double y[] = {0, 5, -5, 300, -300};
    (void)state;
    for (int k = 0; k < 5; k++) {
        const ns_verify_state at = {at_t, NS_LEFT, &x, &lambda, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 1, 1, 0, &s), NS_OK);
        s->A[0] = -1;
        s->E[0] = 1000;
        s->C[0] = 1;
        s->e[0] = y[k] - x;
        s->u[0] = INFINITY;
        assert_int_equal(ns_system_set_input(s, 0, &edge), NS_OK);
        assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
        assert_int_equal(ns_verify_point(v, &at, &f), k < 3);
        assert_int_equal(f.cause, k < 3 ? NS_VERIFY_RIGHT : NS_VERIFY_LAW);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* A diode carries no charge backwards, a switch may; only what goes beyond `before` counts. */
static void directions_in_a_hurry(void **state) {
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    const double back[] = {-0.5}, forth[] = {0.5}, more[] = {0.75};
    (void)state;
    for (int commands = 0; commands < 2; commands++) {
        ns_system *s;
        ns_verify *v;
        assert_int_equal(ns_system_create(1, 1, 0, commands, &s), NS_OK);
        s->M[0] = s->D[0] = 1;
        s->u[0] = INFINITY;
        if (commands) {
            s->command[0] = (ns_command){.pair = 0, .on = 0.5, .off = 0.5, .gx = calloc(1, sizeof(double))};
            assert_non_null(s->command[0].gx);
            s->command[0].gx[0] = 1;
        }
        assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
        assert_int_equal(ns_verify_quick_directions(v, forth, NULL), 1);
        assert_int_equal(ns_verify_quick_directions(v, back, NULL), commands);
        assert_int_equal(ns_verify_quick_directions(v, more, forth), 1);
        assert_int_equal(ns_verify_quick_directions(v, forth, more), commands);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x' = z, which is 0 before a step of 1 s and 2 after it: a step of a scheme charges by 0 to 2, and by half
 * of that difference less or more where it is several. */
static void charge_of_a_step(void **state) {
    const double x = 0, after[] = {2.9, -0.9, 3.1, -1.1};
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    static const double t[] = {0, 1}, volts[] = {0, 2};
    const ns_signal ramp = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = volts, .repeat = NAN}};
    (void)state;
    for (int k = 0; k < 4; k++) {
        const ns_verify_state from = {0, NS_RIGHT, &x, NULL, NULL, 0},
                              to = {1, NS_LEFT, &after[k], NULL, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
        s->M[0] = s->E[0] = 1;
        assert_int_equal(ns_system_set_input(s, 0, &ramp), NS_OK);
        assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
        assert_int_equal(ns_verify_step(v, &from, &to, &f), k < 2);
        assert_int_equal(f.cause, k < 2 ? NS_VERIFY_RIGHT : NS_VERIFY_FLOW);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* A charge of 1 F, a diode y = x + lambda, which carried 1 A and blocked 2 V.  A flux that would drive it
 * open backwards, or a charge backwards through it, is seen without the left side; what is below a millionth
 * of the energy (2 J) may be rounding. */
static void impulses_of_the_wrong_sign_need_no_left_side(void **state) {
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    static const double x[] = {-1, 2}, lambda[] = {1, 0};
    static const struct {
        double X, Lambda;
        int right;
    } of[] = {{0.5, 0, 1}, {-0.5, 0, 0}, {0.5, -0.5, 0}, {-0.5, 0.5, 1}, {-1e-6, 0, 1}, {5e-7, -5e-7, 1}};
    ns_system *s;
    ns_verify *v;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->C[0] = s->D[0] = 1;
    s->u[0] = INFINITY;
    assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
    for (int i = 0; i < 2; i++) {
        const ns_verify_state at = {1e-3 * i, NS_RIGHT, &x[i], &lambda[i], NULL, 0};
        ns_verify_finding f;
        assert_true(ns_verify_point(v, &at, &f));
    }
    for (size_t i = 0; i < sizeof of / sizeof *of; i++)
        assert_int_equal(ns_verify_quick_impulses(v, &of[i].X, &of[i].Lambda), of[i].right);
    ns_verify_free(v);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_flows_in_the_time_of_a_jump),
                                       cmocka_unit_test(nothing_flows_in_no_time),
                                       cmocka_unit_test(nothing_stored_has_an_integral),
                                       cmocka_unit_test(sides_of_an_input),
                                       cmocka_unit_test(no_pair_carries_an_impulse),
                                       cmocka_unit_test(an_impulse_backward),
                                       cmocka_unit_test(energy_of_nothing),
                                       cmocka_unit_test(what_is_aside),
                                       cmocka_unit_test(directions_in_a_hurry),
                                       cmocka_unit_test(charge_of_a_step),
                                       cmocka_unit_test(a_steep_input),
                                       cmocka_unit_test(impulses_of_the_wrong_sign_need_no_left_side)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
