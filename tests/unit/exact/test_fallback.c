/* tests/unit/exact/test_fallback.c - for how long the ladder goes on, and how many failures count. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "exact/exact_internal.h"

/* An engine without pairs, h = 1 s, whose switches depend on time alone. */
typedef struct bench {
    ns_system *s;
    ns_theta *step;
    ns_mode mode[1];
    ns_exact f;
} bench;

static void open_bench(bench *b, int timed) {
    const ns_theta_options o = {1, 1, 0};
    *b = (bench){0};
    assert_int_equal(ns_system_create(1, 0, 0, 0, &b->s), NS_OK);
    b->s->M[0] = 1;
    assert_int_equal(ns_theta_create(b->s, &o, &b->step, NULL), NS_OK);
    b->f.system = b->s;
    b->f.s = b->step;
    b->f.h = 1;
    b->f.timed = timed;
    b->f.work.mode = b->mode;
}

static void close_bench(bench *b) {
    ns_theta_free(b->step);
    ns_system_free(b->s);
}

/* The exact engine fails so long after the last stretch ended: how long the next one is. */
static double stretch(bench *b, double after) {
    const double from = b->f.past.fallback_until + after;
    b->f.past.event_count = 5;
    b->f.state.now.t = from;
    ns_exact_fallback_start(&b->f);
    assert_true(b->f.past.fallback_until == from + b->f.past.fallback_length);
    assert_int_equal(b->f.past.event_count, 0);
    return b->f.past.fallback_length;
}

/* h/2^18 at first, four times as long where nothing went on between, at most h.  Those of more than h/64
 * count as 64 failures, which are halved where the engine came further than h. */
static void ever_longer(void **state) {
    bench b;
    (void)state;
    open_bench(&b, 1);
    int failures = 0;
    for (int k = 0; k <= 9; k++) {
        assert_true(stretch(&b, 0) == ldexp(1, 2 * k - 18));
        failures += k <= 6 ? 1 : 64;
        assert_int_equal(ns_exact_failures(&b.f), failures);
    }
    assert_true(stretch(&b, 0) == 1);
    failures += 64;
    assert_true(stretch(&b, 1) == 0.25); /* h further: a quarter, */
    assert_int_equal(ns_exact_failures(&b.f), failures + 64);
    failures += 64;
    assert_true(stretch(&b, 1.5) == 0.0625); /* more: failures are forgotten */
    assert_int_equal(ns_exact_failures(&b.f), failures / 2 + 64);
    close_bench(&b);
}

/* What is less than h/2^10, or than the last stretch, is not far; with 64 failures, less than 2 h/2^10; h
 * where switches depend on the state. */
static void what_is_far(void **state) {
    const double few = ldexp(1, -10);
    (void)state;
    for (int k = 0; k < 3; k++) {
        bench b;
        const double limit = k == 2 ? 1 : k == 1 ? 2 * few : few;
        open_bench(&b, k < 2);
        b.f.past.fallback_length = few / 16;
        b.f.past.failures = k == 1 ? 64 : 63;
        assert_true(stretch(&b, limit * 0.999) == few / 4);
        b.f.past.fallback_length = few / 16;
        b.f.past.failures = k == 1 ? 64 : 63;
        assert_true(stretch(&b, limit * 1.001) == few / 64);
        close_bench(&b);
    }
    bench b;
    open_bench(&b, 1);
    b.f.past.fallback_length = 0.125;
    assert_true(stretch(&b, 0.124) == 0.5);
    b.f.past.fallback_length = 0.125;
    assert_true(stretch(&b, 0.126) == 0.03125);
    b.f.state.steps_left = -1; /* it may take no more steps */
    assert_true(stretch(&b, 0.126) == 1);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(ever_longer), cmocka_unit_test(what_is_far)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
