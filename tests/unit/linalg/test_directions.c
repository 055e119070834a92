/* tests/unit/linalg/test_directions.c - directions at right angles, and turned within the space they span. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "linalg/directions.h"

enum { MOST = 24 };

static double dot(int n, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* count directions of any kind. */
static void make_directions(dice *d, int size, int count, double *Q) {
    double along[MOST];
    for (int c = 0; c < count; c++) {
        for (int i = 0; i < size; i++)
            Q[c * size + i] = dice_either(d);
        (void)ns_linalg_straighten(size, c, Q, Q + c * size, along);
    }
}

static void are_at_right_angles(int size, int count, const double *Q) {
    for (int a = 0; a < count; a++)
        for (int b = 0; b < count; b++)
            assert_true(fabs(dot(size, Q + a * size, Q + b * size) - (a == b)) < 1e-14);
}

/* What is taken out, and how long the rest is; sizes that fill registers, and that do not. */
static void nothing_is_left_along(void **state) {
    (void)state;
    for (int size = 1; size <= MOST; size++) {
        dice d = dice_make(71, (unsigned)size);
        const int count = size - 1;
        double Q[MOST * MOST], x[MOST], was[MOST], along[MOST];
        make_directions(&d, size, count, Q);
        are_at_right_angles(size, count, Q);
        for (int i = 0; i < size; i++)
            was[i] = x[i] = dice_either(&d);
        ns_linalg_leave(size, count, Q, x, along);
        for (int c = 0; c < count; c++) {
            assert_true(fabs(along[c] + dot(size, Q + c * size, was)) < 1e-14);
            assert_true(fabs(dot(size, Q + c * size, x)) < 1e-14);
        }
        const double length = sqrt(dot(size, x, x));
        assert_true(fabs(ns_linalg_straighten(size, count, Q, x, along) - length) < 1e-14);
        assert_true(fabs(dot(size, x, x) - 1) < 1e-14);
    }
}

/* Images: `large` of any length, mixed with `none` of them that a matrix takes to nothing; scale: of the
 * large ones, decades apart. */
static void finds_what_vanishes(int size, int large, int none, double decades) {
    dice d = dice_make(72, (unsigned)(size * 100 + none));
    const int count = large + none;
    double Q[MOST * MOST], mixed[MOST * MOST], image[MOST * MOST] = {0}, of[MOST * MOST], mix[MOST * MOST],
                                                            length[MOST], room[3 * MOST * MOST];
    assert_true(ns_linalg_turn_room(size, count) <= sizeof room / sizeof *room);
    make_directions(&d, size, count, Q);
    make_directions(&d, size, large, of);
    make_directions(&d, count, count, mix);
    memset(mixed, 0, sizeof mixed);
    for (int c = 0; c < count; c++)
        for (int k = 0; k < count; k++)
            for (int i = 0; i < size; i++) {
                mixed[c * size + i] += mix[c * count + k] * Q[k * size + i];
                if (k < large)
                    image[c * size + i] += mix[c * count + k] * pow(10, -decades * k) * of[k * size + i];
            }
    ns_linalg_turn(size, count, mixed, image, length, room);
    are_at_right_angles(size, count, mixed);
    int vanish = 0;
    for (int c = 0; c < count; c++) {
        if (length[c] > 1e-14)
            continue;
        vanish++;
        for (int k = 0; k < large; k++) /* off by its rounding, beside what an image is */
            assert_true(fabs(dot(size, mixed + c * size, Q + k * size)) * pow(10, -decades * k) < 1e-13);
    }
    assert_int_equal(vanish, none);
}

static void what_vanishes_stands_alone(void **state) {
    (void)state;
    finds_what_vanishes(9, 5, 0, 1);
    finds_what_vanishes(9, 0, 3, 1);
    finds_what_vanishes(9, 5, 3, 1);
    finds_what_vanishes(24, 12, 8, 1);
    finds_what_vanishes(23, 6, 5, 2);
    finds_what_vanishes(1, 0, 1, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_left_along),
        cmocka_unit_test(what_vanishes_stands_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
