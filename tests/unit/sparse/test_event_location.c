/* tests/unit/sparse/test_event_location.c - the first guard that breaks in a step, of steps written by hand
 * whose guards are known polynomials: the sum of (-1)^i L_i(x) G_i, x = tau/g, L_i those of Laguerre. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/guards.h"

static const double h = 1e-6;
/* Large enough that what it allows is no rounding: these steps do not solve the circuit. */
static const double reltol = 1e-6;

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_sparse *m;
    ns_dense_step *step;
    size_t place; /* of the guard in the images */
} bench;

/* 1 V, and node 2, 1 ohm from ground. */
static bench begin_bench(void) {
    const ns_signal volt = {.kind = NS_DC, .u.dc = 1};
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 1, 0, &volt, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1, NULL), NS_OK);
    return b;
}

/* The step from 0 to h holds zeros. */
static void start_system(bench *k) {
    const ns_sparse_options o = {.h = h, .reltol = reltol};
    double w[32] = {0};
    ns_engine *e;
    assert_int_equal(ns_sparse_create(k->s, &o, &e, NULL), NS_OK);
    k->m = ns_sparse_of(e);
    assert_int_equal(ns_sparse_start(e, 0, w, NULL), NS_OK);
    ns_dense_step *step = k->step = &k->m->steps[1];
    const bench b = *k;
    const size_t n = (size_t)b.m->f->n, size = (size_t)b.m->f->size;
    memset(step->images, 0, sizeof(double) * NS_STAGES * size);
    memset(step->powers, 0, sizeof(double) * (NS_STAGES + 1) * n);
    memset(step->z, 0, sizeof(double) * NS_STAGES * (size_t)b.m->f->nz);
    step->t = step->time_lost = 0;
    step->end_t = step->length = h;
    step->g = h / NS_POLE;
    step->stages = step->shown = NS_ORDER;
    step->at_event = step->after_event = step->is_euler = 0;
    step->pair = step->command = -1;
    b.m->largest.y = b.m->largest.lambda = 1;
}

static void start_bench(bench *k) {
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    start_system(k);
    k->place = (size_t)k->m->output_only->place[ns_circuit_node_unknown(k->c, 2)];
}

/* A diode from ground to node 2: while it blocks its guard is the voltage of its cathode, while it conducts
 * its current. */
static bench open_bench(ns_mode mode) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    bench b = begin_bench();
    assert_int_equal(ns_circuit_diode(b.c, "d", 0, 2, &ideal, NULL), NS_OK);
    start_bench(&b);
    ns_sparse_guard_set_mode(b.m, &mode);
    b.step->mode[0] = mode;
    if (mode == NS_INSIDE)
        b.place = (size_t)b.m->f->n;
    return b;
}

static void close_bench(bench *b) {
    ns_sparse_free(&b->m->engine);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static void set(const bench *b, int i, double G) {
    b->step->images[(size_t)i * (size_t)b->m->f->size + b->place] = G;
}

static void locate(const bench *b) {
    assert_int_equal(ns_sparse_location_first(b->m, b->step), NS_OK);
}

/* In both modes: G_0 = 1 and one other.  At x (below NS_POLE, the end of the step) there is an event; 0:
 * there is none. */
static void breaks_at(int i, double G, double x) {
    static const ns_mode modes[] = {NS_LOWER, NS_INSIDE};
    for (int k = 0; k < 2; k++) {
        bench b = open_bench(modes[k]);
        set(&b, 0, 1);
        set(&b, i, G);
        locate(&b);
        assert_int_equal(b.step->at_event, x > 0);
        assert_int_equal(b.step->pair, x > 0 ? 0 : -1);
        assert_int_equal(b.step->command, -1);
        const double length = x > 0 ? x / NS_POLE * h : h;
        assert_true(fabs(b.step->length - length) < 4 * reltol * h);
        assert_true(fabs(b.step->end_t - length) < 4 * reltol * h);
        close_bench(&b);
    }
}

/* 1 - (1 - x) G, which is 1 - G at first and 1 + 3.2667 G at the end. */
static void straight_lines(void **state) {
    (void)state;
    breaks_at(1, -0.6, 1 + 1 / 0.6);
    breaks_at(1, -0.31, 1 + 1 / 0.31);
    breaks_at(1, -0.30, 0); /* 0.02 at the end */
    breaks_at(1, 0.99, 0);
    breaks_at(1, 0, 0);
}

/* 1 + (1 - 2 x + x^2/2) G, least at x = 2: 1 - G; at the end 1 + 1.569 G. */
static void parabolas(void **state) {
    (void)state;
    breaks_at(2, 1.1, 2 - sqrt(4 - 2 * (1 + 1 / 1.1)));
    breaks_at(2, 1.001, 2 - sqrt(4 - 2 * (1 + 1 / 1.001)));
    breaks_at(2, 0.999, 0);
    breaks_at(2, -0.63, 0);
    breaks_at(2, -0.65, 2 + sqrt(4 - 2 * (1 - 1 / 0.65)));
    breaks_at(2, -0.9, 2 + sqrt(4 - 2 * (1 - 1 / 0.9)));
}

/* 1 - L_3(x) G with L_3 = 1 - 3 x + 3 x^2/2 - x^3/6, least where its slope is zero, largest at the end of the
 * step. */
static void cubics(void **state) {
    static const double top = 3 - 1.7320508075688772; /* L_3' = 0: x^2 - 6 x + 6 = 0 */
    (void)state;
    const double least = 1 - 3 * top + 1.5 * top * top - top * top * top / 6;
    const double end = 1 - 3 * NS_POLE + 1.5 * NS_POLE * NS_POLE - NS_POLE * NS_POLE * NS_POLE / 6;
    assert_true(least < 0 && end > 0);
    breaks_at(3, 1 / least * 0.999, 0);
    for (double G = -1.001 / -least;; G = 1.001 / end) { /* 1 - L_3 G = 0 by bisection, before the extreme */
        double low = G < 0 ? 0 : top, high = G < 0 ? top : NS_POLE;
        for (int k = 0; k < 100; k++) {
            const double x = (low + high) / 2, L = 1 - 3 * x + 1.5 * x * x - x * x * x / 6;
            *(1 - L * G > 0 ? &low : &high) = x;
        }
        if (G < 1)
            breaks_at(3, G, low);
        if (G > 0)
            break;
    }
}

/* The sum at x, by the recurrence of Laguerre's polynomials. */
static double sum_at(const double *G, double x) {
    double before = 1, L = 1 - x, sum = G[0] - L * G[1];
    for (int i = 1; i + 1 < NS_ORDER; i++) {
        const double next = ((2 * i + 1 - x) * L - i * before) / (i + 1);
        before = L;
        L = next;
        sum += i % 2 ? L * G[i + 1] : -L * G[i + 1];
    }
    return sum;
}

/* All coefficients, large and small in V and A: the root is that of the sum; a fifth of what moves breaks
 * nothing. */
static void all_coefficients(void **state) {
    static const double part[NS_ORDER] = {1, -0.6, 0.05, 0.04, -0.03, 0.02, -0.002, 1e-4};
    static const ns_mode modes[] = {NS_LOWER, NS_INSIDE};
    (void)state;
    for (int k = 0; k < 2; k++)
        for (int exponent = -6; exponent <= 6; exponent += 12)
            for (int less = 0; less < 2; less++) {
                double G[NS_ORDER], low = 0, high = NS_POLE;
                bench b = open_bench(modes[k]);
                for (int i = 0; i < NS_ORDER; i++) {
                    G[i] = pow(10, exponent) * part[i] * (less && i > 0 ? 0.2 : 1);
                    set(&b, i, G[i]);
                }
                b.m->largest.y = b.m->largest.lambda = G[0];
                assert_true((sum_at(G, high) < 0) == !less);
                for (int round = 0; round < 100; round++) {
                    const double x = (low + high) / 2;
                    *(sum_at(G, x) > 0 ? &low : &high) = x;
                }
                locate(&b);
                assert_int_equal(b.step->at_event, !less);
                const double length = less ? h : low / NS_POLE * h;
                assert_true(fabs(b.step->length - length) < 4 * reltol * h);
                close_bench(&b);
            }
}

/* x - a: below zero at first, and it rises.  1 if an event ends the step there. */
static int breaks_at_once(double a, int after_event) {
    bench b = open_bench(NS_LOWER);
    set(&b, 0, 1 - a);
    set(&b, 1, 1);
    b.step->after_event = after_event;
    locate(&b);
    const int breaks = b.step->at_event;
    assert_true(!breaks || b.step->length == 0);
    close_bench(&b);
    return breaks;
}

/* Right after an event that may be off by as much as events are located to, 16 reltol of the terms (1 V
 * here); elsewhere a guard may be below zero by a small part of reltol alone. */
static void what_rises_after_an_event_holds(void **state) {
    (void)state;
    assert_false(breaks_at_once(0.9 * NS_LOCATION_ERROR * reltol, 1));
    assert_true(breaks_at_once(1.1 * NS_LOCATION_ERROR * reltol, 1));
    assert_true(breaks_at_once(0.9 * NS_LOCATION_ERROR * reltol, 0));
    assert_true(breaks_at_once(0.3 * reltol, 0));
    assert_false(breaks_at_once(0.03 * reltol, 0));
}

/* v(2) rises by `rise` in a step, at the end of which S1 meets its threshold of 1 V, which is that of S2 but
 * for `off`; sources turn so long after it.  1 if S2 changes with S1. */
static int changes_too(double rise, double off, double corner, double *apart) {
    const ns_switch s1 = {.vt = 1, .roff = INFINITY}, s2 = {.vt = 1 + off, .roff = INFINITY};
    bench b = begin_bench();
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 3, 2, 0, &s1, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s2", 1, 3, 2, 0, &s2, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r3", 3, 0, 1, NULL), NS_OK);
    start_bench(&b);
    set(&b, 0, 1 - rise + rise / NS_POLE); /* of 1 - rise + rise x / NS_POLE */
    set(&b, 1, rise / NS_POLE);
    b.step->command = 0;
    b.m->in->first = INFINITY;
    b.m->in->corner = h + corner;
    const int same = ns_sparse_location_is_same(b.m, b.step, 1, apart);
    close_bench(&b);
    return same;
}

/* It does if its threshold is the same, or is met within h/1024 and before sources turn and is no more than
 * 1e4 roundings of 1e-12 of its term, v(2) in the first stage, away: that far it is apart then. */
static void thresholds_beside_that_of_an_event(void **state) {
    const double beside = 1e4 * 1e-12 * (1 - 0.5 + 0.5 / NS_POLE), off = 0.9 * beside,
                 least = 1024 * off; /* delay: h off/rise */
    double apart = NAN;
    (void)state;
    assert_true(changes_too(0.5, 0, h, &apart) && apart == 0);
    assert_true(changes_too(0.5, off, h, &apart) && apart > off && apart < off * (1 + 2e-6));
    assert_false(changes_too(0.5, 1.1 * beside, h, &apart));
    assert_true(apart == 0);
    assert_false(changes_too(0.5, -off, h, &apart)); /* it was met before */
    assert_false(changes_too(-0.5, off, h, &apart)); /* it is left */
    assert_true(changes_too(1.1 * least, off, h, &apart));
    assert_false(changes_too(0.9 * least, off, h, &apart));
    assert_true(changes_too(0.5, off, 1.1 * h * off / 0.5, &apart));
    assert_false(changes_too(0.5, off, 0.9 * h * off / 0.5, &apart));
}

/* With v(2) = 3 V, a current of -5 A and 2 V elsewhere: blocking, y = v(2) is one term of 3.  Conducting, the
 * current's row, the only one, has 3 A through 1 ohm and its own 5 A.  64 eps of that and eps of the largest
 * so far are rounding. */
static void rounding_of_a_guard(void **state) {
    static const ns_mode modes[] = {NS_LOWER, NS_INSIDE};
    (void)state;
    for (int k = 0; k < 2; k++) {
        bench b = open_bench(modes[k]);
        double v[32], w[32] = {0};
        for (int i = 0; i < b.m->f->n; i++)
            v[i] = 2;
        v[b.m->output_only->place[ns_circuit_node_unknown(b.c, 2)]] = 3;
        v[b.m->f->n] = -5;
        b.m->largest.y = 700;
        b.m->largest.lambda = 1100;
        const double terms = ns_sparse_guard_terms(b.m, 0, v, w, 1e-9);
        const double largest = modes[k] == NS_INSIDE ? 1100 : 700;
        assert_true(fabs(terms - (modes[k] == NS_INSIDE ? 3 + 5 : 3)) < 1e-12);
        const double rounding = DBL_EPSILON * (64 * terms + largest);
        assert_true(fabs(ns_sparse_guard_rounding(b.m, 0, v, w, 1e-9) - rounding) < 1e-12 * rounding);
        assert_true(fabs(ns_sparse_guard_least_rounding(b.m, 0, v, w, 1e-9) - rounding) < 1e-12 * rounding);
        close_bench(&b);
    }
}

/* 0 = -4 x_0 + 2 lambda + 8, 0 = 1.5 x_1 - 5 lambda, y = x_0 + x_1 + z. */
static bench equations(ns_mode mode) {
    bench b = {0};
    const ns_signal none = {.kind = NS_DC};
    assert_int_equal(ns_system_create(2, 1, 1, 0, &b.s), NS_OK);
    b.s->A[0] = -4, b.s->B[0] = 2, b.s->b[0] = 8;
    b.s->A[1 + 1 * 2] = 1.5, b.s->B[1] = -5;
    b.s->C[0] = b.s->C[1] = b.s->F[0] = 1;
    assert_int_equal(ns_system_set_input(b.s, 0, &none), NS_OK);
    start_system(&b);
    ns_sparse_guard_set_mode(b.m, &mode);
    return b;
}

/* At x = (3, 7), lambda = -5: of the terms 12, 10 and 8 by 2, and 10.5 and 25 by 5; the least is 7.1. */
static void lambda_enters_two_rows(void **state) {
    bench b = equations(NS_INSIDE);
    const double v[] = {3, 7, -5}, w[2] = {0};
    (void)state;
    assert_true(fabs(ns_sparse_guard_terms(b.m, 0, v, w, 1e-9) - 15) < 1e-12);
    b.m->largest.lambda = 1100;
    const double least = DBL_EPSILON * (64 * 7.1 + 1100);
    assert_true(fabs(ns_sparse_guard_least_rounding(b.m, 0, v, w, 1e-9) - least) < 1e-12 * least);
    close_bench(&b);
}

/* y of the last stage: 5 from x_0 and -5 from z leave `off`, of at most 0.3 reltol of the largest y while
 * there are few stages, of 3 reltol when there are all. */
static void the_last_stage_is_small(void **state) {
    static const int stages[] = {2, NS_ORDER};
    bench b = equations(NS_LOWER);
    (void)state;
    for (int k = 0; k < 2; k++) {
        const int last = stages[k] - 1;
        b.step->images[last * b.m->f->size] = 5;
        for (int sign = -1; sign <= 1; sign += 2)
            for (int times = 9; times <= 11; times += 2) {
                b.step->z[last] = -5 + sign * 0.1 * times * (k == 0 ? 0.3 : 3) * reltol;
                assert_int_equal(ns_sparse_guard_enough(b.m, b.step, stages[k]), times < 10);
            }
    }
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_lines),
        cmocka_unit_test(parabolas),
        cmocka_unit_test(cubics),
        cmocka_unit_test(all_coefficients),
        cmocka_unit_test(rounding_of_a_guard),
        cmocka_unit_test(lambda_enters_two_rows),
        cmocka_unit_test(the_last_stage_is_small),
        cmocka_unit_test(thresholds_beside_that_of_an_event),
        cmocka_unit_test(what_rises_after_an_event_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
