/* tests/unit/system/test_broken_line.c - broken lines piece by piece against ns_signal_value(). */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dice_signals.h"
#include "signals.h"
#include "system/broken_line.h"

enum { LINES = 500 };
static const double end = 30, tol = 1e-10; /* slopes are below 200 V/s, times off by some eps of 30 */

static void assert_near(double is, double should, double within) {
    if (!(fabs(is - should) <= within))
        fail_msg("%.17g, expected %.17g", is, should);
}

static ns_broken_line line_of(const ns_signal *s) {
    ns_broken_line p;
    assert_int_equal(ns_system_line_create(s, &p), NS_OK);
    return p;
}

/* Between corners, and on both sides of each. */
static void a_line_is_its_signal(void **state) {
    (void)state;
    for (unsigned k = 0; k < LINES; k++) {
        dice d = dice_make(91, k);
        double room[DICE_SIGNAL_ROOM];
        const ns_signal s = dice_line(&d, room);
        ns_broken_line p = line_of(&s);
        ns_line_cursor r = {.line = &p};
        ns_system_line_seek(&r, 0);
        for (double t = 0; t < end;) {
            const double next = fmin(end, r.next), inside = t + (next - t) * dice_uniform(&d);
            assert_near(ns_system_line_value(&r, inside), ns_signal_value(&s, inside, NS_LEFT), tol);
            assert_near(ns_system_line_value(&r, next), ns_signal_value(&s, next, NS_LEFT), tol);
            if (next < end) {
                assert_near(ns_system_line_piece(&r)->end, ns_signal_value(&s, next, NS_LEFT), tol);
                ns_system_line_pass(&r, next);
                assert_true(r.t == next && r.next > next);
                assert_near(ns_system_line_value(&r, next), ns_signal_value(&s, next, NS_RIGHT), tol);
            }
            t = next;
        }
        ns_system_line_free(&p);
    }
}

/* Anywhere, at once; and whole periods on. */
static void seek_and_skip(void **state) {
    (void)state;
    int repeating = 0;
    for (unsigned k = 0; k < LINES; k++) {
        dice d = dice_make(92, k);
        double room[DICE_SIGNAL_ROOM];
        const ns_signal s = dice_line(&d, room);
        ns_broken_line p = line_of(&s);
        ns_line_cursor r = {.line = &p}, later = r;
        for (int i = 0; i < 20; i++) {
            const double t = end * dice_uniform(&d);
            ns_system_line_seek(&r, t);
            assert_true(r.next > t);
            assert_near(ns_system_line_value(&r, t), ns_signal_value(&s, t, NS_RIGHT), tol);
            if (!ns_system_line_repeats(&r))
                continue;
            repeating++;
            ns_system_line_seek(&later, t + 1000 * p.period);
            ns_system_line_skip(&r, 1000);
            assert_true(r.k == later.k && r.i == later.i);
            assert_near(r.next, later.next, 0);
        }
        ns_system_line_free(&p);
    }
    assert_true(repeating > LINES);
}

/* A cursor that is sent to the very time of a corner, or to the number before it, is where one is that went
 * there corner by corner: periods of a third and a tenth have no exact multiples. */
static void seek_to_corners(void **state) {
    (void)state;
    const ns_signal tenth = pulse(0, 4, 0.3, 0.01, 0.02, 0.03, 0.1),
                    third = pulse(0, 4, 0, 0.1, 0.1, 0.05, 1.0 / 3), *signal[] = {&tenth, &third};
    for (int s = 0; s < 2; s++) {
        ns_broken_line p = line_of(signal[s]);
        ns_line_cursor r = {.line = &p}, at = r;
        ns_system_line_seek(&r, 0);
        for (int k = 0; k < 4000; k++) {
            const ns_line_cursor before = r;
            ns_system_line_pass(&r, r.next);
            ns_system_line_seek(&at, r.t);
            assert_true(at.k == r.k && at.i == r.i && at.t == r.t && at.next == r.next);
            ns_system_line_seek(&at, nextafter(r.t, 0));
            assert_true(at.k == before.k && at.i == before.i && at.next == r.t);
        }
        assert_true(r.k > 900); /* four corners a period */
        ns_system_line_free(&p);
    }
}

/* The last period ends with the value of its last point. */
static void a_counted_pulse(void **state) {
    ns_signal s = pulse(0, 4, 1, 1, 1, 1, 5);
    (void)state;
    s.u.pulse.cycles = 2;
    ns_broken_line p = line_of(&s);
    ns_line_cursor r = {.line = &p};
    static const double corner[] = {1, 2, 3, 4, 6, 7, 8, 9};
    ns_system_line_seek(&r, 0);
    for (int i = 0; i < 8; i++) {
        assert_near(r.next, corner[i], 0);
        assert_int_equal(ns_system_line_repeats(&r), 0);
        ns_system_line_pass(&r, r.next);
    }
    while (r.next < INFINITY)
        ns_system_line_pass(&r, r.next);
    assert_near(ns_system_line_value(&r, 100), 0, 0);
    ns_system_line_seek(&r, 7);
    assert_near(ns_system_line_value(&r, 7.5), 4, 0);
    ns_system_line_seek(&r, 70);
    assert_near(ns_system_line_value(&r, 70), 0, 0);
    ns_system_line_free(&p);
}

/* What does not change has no period, what is too steep for a number jumps. */
static void constants_and_jumps(void **state) {
    const double t[] = {0, 5e-324, 1}, v[] = {0, 1, 1};
    const ns_signal still = pulse(2, 2, 0, 1, 1, 1, 4), level = dc(7),
                    steep = {.kind = NS_PWL, .u.pwl = {3, t, v, NAN, 0}};
    ns_broken_line p = line_of(&still);
    ns_line_cursor r = {.line = &p};
    (void)state;
    assert_near(p.period, 0, 0);
    ns_system_line_free(&p);
    p = line_of(&level);
    ns_system_line_seek(&r, 3);
    assert_near(ns_system_line_value(&r, 3), 7, 0);
    assert_true(isinf(r.next));
    ns_system_line_free(&p);
    p = line_of(&steep);
    ns_system_line_seek(&r, 0);
    assert_near(ns_system_line_piece(&r)->slope, 0, 0);
    assert_near(ns_system_line_piece(&r)->end, 0, 0);
    ns_system_line_pass(&r, r.next);
    assert_near(ns_system_line_value(&r, 0.5), 1, 0);
    ns_system_line_free(&p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_is_its_signal), cmocka_unit_test(seek_and_skip),
        cmocka_unit_test(seek_to_corners),      cmocka_unit_test(a_counted_pulse),
        cmocka_unit_test(constants_and_jumps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
