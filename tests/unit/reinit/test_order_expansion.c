/* tests/unit/reinit/test_order_expansion.c - the step of a mode by powers of h: against steps of small h, and
 * what it does where equations leave something open or contradict each other.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <float.h>

#include "dice.h"
#include "net.h"
#include "reinit/order_expansion.h"

enum { NODES = 5, ELEMENTS = 9, MOST = 2 * NET_MOST };

/* Resistors, capacitors, inductors and switches, open and closed: some jump. */
static net random_net(dice *d) {
    net k = net_begin();
    net_voltage(&k, "v", 1, 0, 3);
    for (int i = 0; i < ELEMENTS; i++) {
        const int p = dice_below(d, NODES), n = (p + 1 + dice_below(d, NODES - 1)) % NODES;
        char name[8] = {(char)('a' + i)};
        const double size = dice_decades(d, -1, 1);
        switch (i < 2 ? i : dice_below(d, 4)) {
        case 0:
            net_capacitor(&k, name, p, n, size, 5 * dice_either(d));
            break;
        case 1:
            net_inductor(&k, name, p, n, size, dice_either(d));
            break;
        case 2:
            net_contact(&k, name, p, n, dice_below(d, 2));
            break;
        default:
            net_resistor(&k, name, p, n, size);
        }
    }
    for (int p = 1; p < NODES; p++) {
        const char name[3] = {'r', (char)('0' + p)};
        net_resistor(&k, name, p, 0, 10);
    }
    net_prepare(&k);
    return k;
}

/* (K0 + h K1) Z = R0 + h R1; 0 if that is singular. */
static int solve_at(const ns_order_expansion *e, double h, double *Z) {
    const int size = e->size;
    double K[MOST * MOST], rcond;
    ns_lu *lu;
    for (int i = 0; i < size * size; i++)
        K[i] = e->K0[i] + h * e->K1[i];
    for (int i = 0; i < size; i++)
        Z[i] = e->R0[i] + h * e->R1[i];
    assert_int_equal(ns_linalg_lu_create(size, &lu), NS_OK);
    const int status = ns_linalg_lu_factor(lu, size, K, &rcond);
    if (status == NS_OK)
        ns_linalg_lu_solve(lu, 1, Z);
    ns_linalg_lu_free(lu);
    return status == NS_OK && rcond > 1e-9;
}

/* How far Z1/h + Z0 + h Z2 is from the step, at most. */
static double distance(const ns_order_expansion *e, double h, double *largest) {
    double Z[MOST], worst = 0;
    *largest = 1;
    if (!solve_at(e, h, Z))
        return -1;
    for (int i = 0; i < e->size; i++) {
        worst = fmax(worst, fabs(Z[i] - (e->Z1[i] / h + e->Z0[i] + h * e->Z2[i])));
        *largest = fmax(*largest, fabs(Z[i]));
    }
    return worst;
}

/* What is left over goes with h^2: the ratio at h and h/2 is 4. */
static void steps_tend_to_it(void **state) {
    (void)state;
    int compared = 0, jumped = 0;
    for (int run = 0; run < 400; run++) {
        dice d = dice_make(19, (unsigned)run);
        net k = random_net(&d);
        ns_order_expansion e;
        assert_int_equal(ns_reinit_orders_create(k.step, k.step->past.w, &e), NS_OK);
        memcpy(e.mode, ns_theta_mode(k.step), (size_t)k.s->m);
        const int status = ns_reinit_orders_expand(&e, k.z, NULL);
        if (status == NS_OK) {
            const double rate = fmax(ns_reinit_orders_rate(&e), 1e-3);
            memcpy(e.mode, ns_theta_mode(k.step), (size_t)k.s->m);
            assert_int_equal(ns_reinit_orders_expand(&e, k.z, NULL), NS_OK);
            double h = 1 / rate, largest, whole = distance(&e, h, &largest);
            for (int i = 0; i < 30 && whole > 1e-5 * largest; i++) {
                h /= 2;
                whole = distance(&e, h, &largest);
            }
            const double half = distance(&e, h / 2, &largest);
            if (whole > 1e-8 * largest && half > 0) {
                assert_true(fabs(whole / half - 4) < 0.5);
                compared++;
                for (int i = 0; i < e.size; i++)
                    if (e.Z1[i] != 0) {
                        jumped++;
                        break;
                    }
            }
        } else {
            assert_int_equal(status, NS_E_SINGULAR);
        }
        ns_reinit_orders_free(&e);
        net_end(&k);
    }
    assert_true(compared >= 250 && jumped >= 100);
}

/* K0 Z1 = 0, K0 Z0 + K1 Z1 = R0, K0 Z2 + K1 Z0 = R1, to some eps of the terms, on the rows that have the next
 * order. */
static void levels_obey_their_equations(void **state) {
    (void)state;
    for (int run = 0; run < 200; run++) {
        dice d = dice_make(23, (unsigned)run);
        net k = random_net(&d);
        ns_order_expansion e;
        assert_int_equal(ns_reinit_orders_create(k.step, k.step->past.w, &e), NS_OK);
        memcpy(e.mode, ns_theta_mode(k.step), (size_t)k.s->m);
        if (ns_reinit_orders_expand(&e, k.z, NULL) == NS_OK)
            for (int i = 0; i < e.size; i++) {
                double none = 0, zero = -e.R0[i], none_terms = 1e-300, zero_terms = fabs(e.R0[i]) + 1e-300;
                for (int j = 0; j < e.size; j++) {
                    const double held = e.K0[i + j * e.size], moved = e.K1[i + j * e.size];
                    none += held * e.Z1[j];
                    none_terms += fabs(held) * (fabs(e.Z1[j]) + e.E1[j]);
                    zero += held * e.Z0[j] + moved * e.Z1[j];
                    zero_terms += fabs(held) * (fabs(e.Z0[j]) + e.E0[j] / DBL_EPSILON) +
                                  fabs(moved) * (fabs(e.Z1[j]) + e.E1[j] / DBL_EPSILON);
                }
                assert_true(fabs(none) <= 64 * DBL_EPSILON * none_terms);
                assert_true(fabs(zero) <= 64 * DBL_EPSILON * zero_terms);
            }
        ns_reinit_orders_free(&e);
        net_end(&k);
    }
}

static int expand(net *k, ns_order_expansion *e, const double *near) {
    assert_int_equal(ns_reinit_orders_create(k->step, k->step->past.w, e), NS_OK);
    memcpy(e->mode, ns_theta_mode(k->step), (size_t)k->s->m);
    e->near = near;
    return ns_reinit_orders_expand(e, k->z, NULL);
}

/* A capacitor of 2 F at 3 V, shorted by a switch: its charge, -6 C, and 0 V. */
static void a_shorted_capacitor(void **state) {
    (void)state;
    net k = net_begin();
    ns_order_expansion e;
    net_capacitor(&k, "c", 1, 0, 2, 3);
    const int contact = net_contact(&k, "s", 1, 0, 1);
    net_prepare(&k);
    assert_int_equal(expand(&k, &e, NULL), NS_OK);
    assert_true(fabs(fabs(net_device_of(&k, e.at[NS_IMPULSE], e.at[NS_IMPULSE] + k.s->n, contact)) - 6) <
                1e-14);
    assert_true(net_voltage_of(&k, e.at[NS_VALUE], 1) == 0);
    ns_reinit_orders_free(&e);
    net_end(&k);
}

/* 1 A through two closed switches in parallel: 0.5 A each, or the shares nearest to those given. */
static void what_is_open_is_nearest(void **state) {
    (void)state;
    net k = net_begin();
    ns_order_expansion e;
    double near[MOST] = {0};
    net_voltage(&k, "v", 1, 0, 1);
    const int a = net_contact(&k, "a", 1, 2, 1), b = net_contact(&k, "b", 1, 2, 1);
    net_resistor(&k, "r", 2, 0, 1);
    net_prepare(&k);
    for (int given = 0; given < 2; given++) {
        near[k.s->n] = 0.9;
        near[k.s->n + 1] = 0.1;
        assert_int_equal(expand(&k, &e, given ? near : NULL), NS_OK);
        const double *x = e.at[NS_VALUE], *lambda = x + k.s->n;
        assert_true(fabs(fabs(lambda[0]) - (given ? 0.9 : 0.5)) < 1e-14);
        assert_true(fabs(fabs(net_device_of(&k, x, lambda, a) + net_device_of(&k, x, lambda, b)) - 1) <
                    1e-14);
        ns_reinit_orders_free(&e);
    }
    net_end(&k);
}

/* A pair at a bound that is not 0 enters the rows of x and those of pairs inside:  2 x1' = -x1 + 3 lambda0,
 * 0 = -x2 + 5 lambda0,  0 = y1 = 4 x1 + 7 lambda0 + lambda1,  lambda0 in [-1,2]. */
static void bounds_enter_all_rows(void **state) {
    (void)state;
    for (int upper = 0; upper < 2; upper++) {
        const ns_theta_options o = {1, 1, 0};
        const double x1 = 0.75, w0[2] = {2 * x1, 0}, lambda0 = upper ? 2 : -1;
        ns_order_expansion e;
        ns_theta *t;
        ns_system *s;
        assert_int_equal(ns_system_create(2, 2, 0, 0, &s), NS_OK);
        s->M[0] = 2;
        s->A[0] = s->A[3] = -1;
        s->B[0] = 3;
        s->B[1] = 5;
        s->C[1] = 4;
        s->D[1] = 7;
        s->D[3] = 1;
        s->l[0] = -1;
        s->u[0] = 2;
        s->l[1] = -INFINITY;
        s->u[1] = INFINITY;
        assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
        assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
        assert_int_equal(ns_reinit_orders_create(t, t->past.w, &e), NS_OK);
        e.mode[0] = upper ? NS_UPPER : NS_LOWER;
        e.mode[1] = NS_INSIDE;
        assert_int_equal(ns_reinit_orders_expand(&e, NULL, NULL), NS_OK);
        assert_int_equal(e.size, 3);
        for (int i = 0; i < 3; i++)
            assert_true(e.Z1[i] == 0);
        assert_true(fabs(e.Z0[0] - x1) < 1e-15);
        assert_true(fabs(e.Z0[1] - 5 * lambda0) < 1e-14);
        assert_true(fabs(e.Z0[2] + 4 * x1 + 7 * lambda0) < 1e-14);
        assert_true(fabs(e.Z2[0] - (3 * lambda0 - x1) / 2) < 1e-14);
        assert_true(fabs(e.Z2[2] + 4 * e.Z2[0]) < 1e-14);
        ns_reinit_orders_free(&e);
        ns_theta_free(t);
        ns_system_free(s);
    }
}

/* x1' = (x1 - 1.3)/3 + lambda0 + lambda1, x2' = x1/10 + (1/3 - 1/10) x2 - 1.3/3 + lambda0 + lambda1, from 3
 * to y = (x1 - 1.3, x2 - 1.3) = 0: an impulse of -1.7 moves both, 0 keeps both there, and the two shares are
 * of least norm.  That the rates of both agree shows only to the rounding of their terms. */
static void rows_that_agree_but_for_rounding(void **state) {
    (void)state;
    const ns_theta_options o = {1, 1, 0};
    const double w0[2] = {3, 3};
    ns_order_expansion e;
    ns_theta *t;
    ns_system *s;
    assert_int_equal(ns_system_create(2, 2, 0, 0, &s), NS_OK);
    s->A[0] = 1.0 / 3, s->A[1] = 0.1, s->A[3] = 1.0 / 3 - 0.1;
    s->M[0] = s->M[3] = s->C[0] = s->C[3] = 1;
    s->B[0] = s->B[1] = s->B[2] = s->B[3] = 1;
    s->e[0] = s->e[1] = -1.3;
    s->b[0] = s->b[1] = -1.3 / 3;
    for (int j = 0; j < 2; j++)
        s->l[j] = -INFINITY, s->u[j] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_reinit_orders_create(t, t->past.w, &e), NS_OK);
    e.mode[0] = e.mode[1] = NS_INSIDE;
    assert_int_equal(ns_reinit_orders_expand(&e, NULL, NULL), NS_OK);
    for (int i = 0; i < 2; i++) {
        assert_true(fabs(e.Z0[i] - 1.3) < 1e-14 && fabs(e.Z1[i]) < 1e-14);
        assert_true(fabs(e.Z1[2 + i] + 0.85) < 1e-14);
        assert_true(fabs(e.Z0[2 + i]) < 1e-14);
    }
    ns_reinit_orders_free(&e);
    ns_theta_free(t);
    ns_system_free(s);
}

/* 1 V and 2 V in parallel. */
static void a_contradiction_is_singular(void **state) {
    (void)state;
    net k = net_begin();
    ns_order_expansion e;
    net_voltage(&k, "v", 1, 0, 1);
    net_voltage(&k, "w", 2, 0, 2);
    net_contact(&k, "s", 1, 2, 1);
    net_prepare(&k);
    assert_int_equal(expand(&k, &e, NULL), NS_E_SINGULAR);
    ns_reinit_orders_free(&e);
    net_end(&k);
}

/* x1' = 2 z1 + 3 z2, x2' = 5 z1 + 7 z2; y1 = lambda1 + 11 z1 + 13 z2, y2 = lambda2 + 17 z1 + 19 z2, both 0:
 * with z = (1, 10) rates of 32 and 75, lambda = -141 and -207, which go on with z' = (1, -1) by 2 and 2. */
static void inputs_enter_all_rows(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double z[] = {1, 10}, slope[] = {1, -1}, w0[2] = {0, 0};
    const double rates[] = {32, 75, 2, 2}, lambda[] = {-141, -207};
    ns_order_expansion e;
    ns_theta *t;
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(2, 2, 2, 0, &s), NS_OK);
    s->M[0] = s->M[3] = s->D[0] = s->D[3] = 1;
    s->E[0] = 2, s->E[2] = 3, s->E[1] = 5, s->E[3] = 7;
    s->F[0] = 11, s->F[2] = 13, s->F[1] = 17, s->F[3] = 19;
    for (int j = 0; j < 2; j++)
        s->l[j] = -INFINITY, s->u[j] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_reinit_orders_create(t, t->past.w, &e), NS_OK);
    e.mode[0] = e.mode[1] = NS_INSIDE;
    assert_int_equal(ns_reinit_orders_expand(&e, z, slope), NS_OK);
    for (int i = 0; i < 4; i++) {
        assert_true(e.Z1[i] == 0 && fabs(e.Z2[i] - rates[i]) < 1e-12);
        assert_true(fabs(e.Z0[i] - (i < 2 ? 0 : lambda[i - 2])) < 1e-12);
        assert_true(e.at[0][i] == e.Z1[i] && e.at[1][i] == e.Z0[i] && e.at[2][i] == e.Z2[i]);
        assert_true(e.error[0][i] == e.E1[i] && e.error[1][i] == e.E0[i] && e.error[2][i] == e.E2[i]);
        assert_true(i < 2 || (e.E2[i] > 0 && e.E2[i] != e.E0[i]));
    }
    ns_reinit_orders_free(&e);
    ns_theta_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inputs_enter_all_rows),       cmocka_unit_test(steps_tend_to_it),
        cmocka_unit_test(levels_obey_their_equations), cmocka_unit_test(a_shorted_capacitor),
        cmocka_unit_test(what_is_open_is_nearest),     cmocka_unit_test(bounds_enter_all_rows),
        cmocka_unit_test(a_contradiction_is_singular), cmocka_unit_test(rows_that_agree_but_for_rounding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
