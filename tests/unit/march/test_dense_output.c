/* tests/unit/march/test_dense_output.c - points on the way of a trial: closed forms, the same as a trial that
 * ends there, and the trial stays as it is. */
#include <string.h>

#include "converters.h"
#include "dice.h"

static const double pi = 3.14159265358979323846;
static const ns_switch comparator = {0, 0, 0, INFINITY};
static const double fractions[] = {0, 0.011, 0.1, 0.37, 0.5, 0.77, 0.95, 1};
enum { SAMPLES = sizeof fractions / sizeof *fractions, PAIRS = 64 };

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

typedef struct point {
    double t, x[MOST], lambda[PAIRS];
} point;

static point sampled(scene *z, double t) {
    point p = {.t = t};
    ok(ns_march_sample(z->m, t, p.x, p.lambda));
    return p;
}

static point shown(scene *z) {
    point p = {0};
    ok(ns_march_read(z->m, &p.t, p.x, p.lambda, NULL));
    return p;
}

/* The largest difference, relative to 1 and to the largest value of each kind. */
static double apart(const scene *z, const point *a, const point *b) {
    double worst = 0, x = 1, lambda = 1;
    for (int i = 0; i < z->s->n; i++)
        x = fmax(x, fabs(b->x[i]));
    for (int j = 0; j < z->s->m; j++)
        lambda = fmax(lambda, fabs(b->lambda[j]));
    for (int i = 0; i < z->s->n; i++)
        worst = fmax(worst, fabs(a->x[i] - b->x[i]) / x);
    for (int j = 0; j < z->s->m; j++)
        worst = fmax(worst, fabs(a->lambda[j] - b->lambda[j]) / lambda);
    return worst;
}

/* --- the way of one trial --- */

typedef struct way {
    double from, to;
    point p[SAMPLES];
} way;

static double time_at(const way *w, int i) {
    return i == SAMPLES - 1 ? w->to : w->from + fractions[i] * (w->to - w->from);
}

static way look(scene *z, double from, double to) {
    way w = {.from = from, .to = to};
    for (int i = 0; i < SAMPLES; i++)
        w.p[i] = sampled(z, time_at(&w, i));
    return w;
}

/* In any order they are the same but for rounding. */
static void any_order(scene *z, const way *w, dice *d) {
    for (int k = 0; k < SAMPLES; k++) {
        const int i = dice_below(d, SAMPLES);
        const point p = sampled(z, time_at(w, i));
        assert_true(apart(z, &p, &w->p[i]) == 0);
    }
}

/* Trials that end there. */
static double apart_from_trials(scene *z, const way *w) {
    double worst = 0, reached;
    for (int i = 1; i < SAMPLES; i++) {
        ok(ns_march_try(z->m, time_at(w, i), NS_TO_TIME, &reached));
        const point p = shown(z);
        worst = fmax(worst, reached == time_at(w, i) ? apart(z, &w->p[i], &p) : 0);
    }
    return worst;
}

static double shortest_is_sensible(scene *z, const way *w) {
    double until, shortest = ns_march_shortest(z->m, w->from, &until);
    assert_true(shortest > 0 && until > w->from);
    assert_true(ns_march_shortest(z->m, w->to, NULL) > 0);
    return shortest;
}

typedef double closed_form(double t);

typedef struct check {
    int unknown;       /* the closed form is of this one; -1: there is none */
    closed_form *form; /* NULL: there is none */
    double tolerance;  /* relative to 1, or the largest value */
    double as_trial;   /* how far from trials that end there */
    /* what was found */
    double worst, worst_as_trial;
    long trials, events, rights;
} check;

/* Where the same trial, made again, ends: the same but for rounding. */
static double check_way(scene *z, check *c, double from, double to, double asked, dice *d) {
    const point end = shown(z);
    const way w = look(z, from, to);
    double reached;
    any_order(z, &w, d);
    (void)shortest_is_sensible(z, &w);
    const point after = shown(z);
    assert_memory_equal(&end, &after, sizeof end);
    for (int i = 0; i < SAMPLES && c->form; i++)
        c->worst = fmax(c->worst, fabs(w.p[i].x[c->unknown] - c->form(time_at(&w, i))));
    c->worst_as_trial = fmax(c->worst_as_trial, apart_from_trials(z, &w));
    ok(ns_march_try(z->m, asked, NS_TO_STEP, &reached));
    const point again = shown(z);
    assert_true(apart(z, &again, &end) < 1e-9 && fabs(reached - to) <= 1e-15 * to);
    return reached;
}

/* From the point to the end, by trials with NS_TO_STEP. */
static void walk(scene *z, check *c, double end) {
    double now, reached;
    dice d = dice_make(1, 1);
    ok(ns_march_read(z->m, &now, NULL, NULL, NULL));
    while (now < end) {
        ok(ns_march_try(z->m, end, NS_TO_STEP, &reached));
        assert_true(reached >= now && reached <= end);
        if (reached > now)
            reached = check_way(z, c, now, reached, end, &d);
        else
            assert_int_equal(ns_march_sample(z->m, now, NULL, NULL), NS_E_STATE);
        c->rights += !(reached > now);
        c->events += ns_march_at_event(z->m);
        ok(ns_march_accept(z->m));
        assert_int_equal(ns_march_sample(z->m, reached, NULL, NULL), NS_E_STATE);
        now = reached;
        assert_true(++c->trials < 1000000);
    }
    if (c->form)
        assert_true(c->worst < c->tolerance);
    assert_true(c->worst_as_trial < c->as_trial);
}

/* --- closed forms --- */

static double decay(double t) {
    return 10 * exp(-t / 1e-3);
}

static scene rc_decay(void) {
    scene z = {0};
    ok(ns_circuit_create(&z.c));
    ok(ns_circuit_resistor(z.c, "r", 1, 0, 1e3, NULL));
    ok(ns_circuit_capacitor(z.c, "c", 1, 0, 1e-6, 10, NULL));
    return z;
}

static double ring(double t) {
    return 10 * cos(t / sqrt(1e-3 * 1e-6));
}

static scene lc_ring(void) {
    scene z = {0};
    ok(ns_circuit_create(&z.c));
    ok(ns_circuit_inductor(z.c, "l", 1, 0, 1e-3, 0, NULL));
    ok(ns_circuit_capacitor(z.c, "c", 1, 0, 1e-6, 10, NULL));
    return z;
}

/* v' = (10 sin wt - v)/tau. */
static double driven(double t) {
    const double tau = 1e-3, w = 2 * pi * 500, a = w * tau;
    return 10 / (1 + a * a) * (sin(w * t) - a * cos(w * t) + a * exp(-t / tau));
}

static scene sine_rc(void) {
    scene z = {0};
    ok(ns_circuit_create(&z.c));
    put(&z, "v", 2, 0, sine(10, 500));
    ok(ns_circuit_resistor(z.c, "r", 2, 1, 1e3, NULL));
    ok(ns_circuit_capacitor(z.c, "c", 1, 0, 1e-6, 0, NULL));
    return z;
}

/* 1 V steps on at 10 us: into L = 1 mH, R = 1 ohm (1 ms) and, behind another resistor, 1 ns. */
static double since_step(double t, double tau) {
    return t > 10e-6 ? 1 - exp(-(t - 10e-6) / tau) : 0;
}

static double slow_of_two(double t) {
    return since_step(t, 1e-3);
}

static double fast_of_two(double t) {
    return since_step(t, 1e-9);
}

static scene two_rates(void) {
    scene z = {0};
    ok(ns_circuit_create(&z.c));
    put(&z, "v", 3, 0, pulse(0, 1, 10e-6, 0, 0, 1, INFINITY));
    ok(ns_circuit_inductor(z.c, "l", 3, 1, 1e-3, 0, NULL));
    ok(ns_circuit_resistor(z.c, "r1", 1, 0, 1, NULL));
    ok(ns_circuit_resistor(z.c, "r2", 3, 2, 1e3, NULL));
    ok(ns_circuit_capacitor(z.c, "c", 2, 0, 1e-12, 0, NULL));
    return z;
}

typedef struct form {
    const char *name;
    scene (*build)(void);
    closed_form *form;
    int node;
    double end;
} form;

static const form forms[] = {
    {"rc decay", rc_decay, decay, 1, 5e-3},
    {"lc ring", lc_ring, ring, 1, 1e-3},
    {"sine-driven rc", sine_rc, driven, 1, 5e-3},
    {"slow of two rates", two_rates, slow_of_two, 1, 2e-3},
    {"fast of two rates", two_rates, fast_of_two, 2, 2e-3},
};

static void equals_closed_form(const form *f, ns_method method, double tolerance) {
    scene z = f->build();
    begin(&z, method, 1);
    check c = {.unknown = ns_circuit_node_unknown(z.c, f->node),
               .form = f->form,
               .tolerance = tolerance,
               .as_trial = method == NS_THETA ? INFINITY : 1e-12};
    walk(&z, &c, f->end);
    print_message("%s, method %d: %ld trials, %.1e from the closed form, %.1e from trials\n", f->name,
                  (int)method, c.trials, c.worst, c.worst_as_trial);
    end(&z);
}

static void closed_forms_exact(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++)
        equals_closed_form(&forms[k], NS_EXACT, 1e-10);
}

static void closed_forms_sparse(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++)
        equals_closed_form(&forms[k], NS_SPARSE, 1e-8);
}

/* --- with events --- */

static scene one_buck(void) {
    scene z = supplied(dc(24));
    buck(&z, "1", FIRST, 10e-6, 300); /* discontinuous */
    return z;
}

/* 20 V at 1, a switch to 2 while v(4) > v(3), a freewheeling diode, 100 uH to 3, 10 ohm: from 4.7 us on it
 * slides along v(3) = v(4). */
static scene chopper(void) {
    scene z = {0};
    ns_signal reference = sine(2, 1e3);
    reference.u.sin.vo = 7.5;
    ok(ns_circuit_create(&z.c));
    put(&z, "v1", 1, 0, dc(20));
    put(&z, "vr", 4, 0, reference);
    ok(ns_circuit_switch(z.c, "s1", 1, 2, 4, 3, &comparator, NULL));
    ok(ns_circuit_diode(z.c, "d1", 0, 2, &ideal, NULL));
    ok(ns_circuit_inductor(z.c, "l1", 2, 3, 100e-6, NAN, NULL));
    ok(ns_circuit_resistor(z.c, "r1", 3, 0, 10, NULL));
    return z;
}

/* A peak detector at a sine: the diode's current jumps to and from zero, in one trial it does not. */
static scene rectifier(void) {
    scene z = supplied(sine(10, 1e3));
    detector(&z, "1", FIRST);
    return z;
}

static void equals_trials(const char *name, scene z, ns_method method, double end_t, double as_trial) {
    check c = {.unknown = -1, .as_trial = as_trial};
    begin(&z, method, 1);
    walk(&z, &c, end_t);
    print_message("%s, method %d: %ld trials, %ld left sides, %ld right sides, %.1e from trials\n", name,
                  (int)method, c.trials, c.events, c.rights, c.worst_as_trial);
    assert_true(c.events > 0 && c.rights == c.events);
    end(&z);
}

static void events_exact(void **state) {
    (void)state;
    equals_trials("buck", one_buck(), NS_EXACT, 200e-6, 1e-9);
    equals_trials("rectifier", rectifier(), NS_EXACT, 5e-3, 1e-9);
    equals_trials("chopper", chopper(), NS_EXACT, 1e-3, 1e-9);
}

static void events_sparse(void **state) {
    (void)state;
    equals_trials("buck", one_buck(), NS_SPARSE, 200e-6, 1e-7);
    equals_trials("rectifier", rectifier(), NS_SPARSE, 5e-3, 1e-7);
    equals_trials("chopper", chopper(), NS_SPARSE, 1e-4, 1e-7);
}

/* --- islands: each keeps its own trial, and the whole ends where the first one does --- */

static scene three_islands(void) {
    scene z = two_bucks();
    detector(&z, "3", FIRST + 2 * EACH);
    return z;
}

/* Another marcher, of the whole, comes to t: the largest difference of x, lambda (and y, if there is one). */
static double apart_from(scene *z, const point *p, const double *y) {
    point q = {0};
    double own_y[PAIRS], reached, worst = 0;
    ok(ns_march_try(z->m, p->t, NS_TO_TIME, &reached));
    ok(ns_march_read(z->m, &q.t, q.x, q.lambda, own_y));
    for (int j = 0; y && j < z->s->m; j++)
        worst = fmax(worst, fabs(y[j] - own_y[j]) / 24);
    return fmax(worst, apart(z, p, &q));
}

/* By trials with NS_TO_STEP alone, read before and after they are accepted, as the other marcher has it. */
static void islands_by(ns_method method, double tolerance) {
    scene z = three_islands(), other = three_islands();
    double now = 0, reached, worst = 0, y[PAIRS];
    long trials = 0;
    begin(&z, method, 0);
    begin(&other, NS_EXACT, 1);
    assert_true(islands(&z) >= 3);
    for (int k = 1; now < 200e-6; trials++) {
        const double to = k * 3.7e-6;
        ok(ns_march_try(z.m, to, NS_TO_STEP, &reached));
        assert_true(reached >= now && reached <= to);
        const point middle = reached > now ? sampled(&z, now + (reached - now) / 3) : (point){0};
        const point end = shown(&z);
        worst = fmax(worst, middle.t > now ? apart_from(&other, &middle, NULL) : 0);
        const int between = reached > now && !ns_march_at_event(z.m);
        ok(ns_march_accept(z.m));
        point accepted = {0};
        ok(ns_march_read(z.m, &accepted.t, accepted.x, accepted.lambda, y));
        assert_true(accepted.t == reached && apart(&z, &accepted, &end) == 0);
        worst = fmax(worst, between ? apart_from(&other, &accepted, y) : 0);
        if (between && accepted.t < to) /* the next trial goes on from here */
            assert_true(accepted.t > now);
        now = reached;
        k += reached >= to;
    }
    print_message("islands, method %d: %ld trials, %.1e from a marcher of the whole\n", (int)method, trials,
                  worst);
    assert_true(worst < tolerance);
    end(&z);
    end(&other);
}

static void islands_keep_their_trials(void **state) {
    (void)state;
    islands_by(NS_EXACT, 1e-9);
    islands_by(NS_SPARSE, 1e-6);
    islands_by(NS_AUTO, 1e-9);
}

static void islands_equal_trials(void **state) {
    (void)state;
    check c = {.unknown = -1, .as_trial = 1e-9};
    scene z = three_islands();
    begin(&z, NS_EXACT, 0);
    walk(&z, &c, 100e-6);
    end(&z);
}

/* --- steps of the scheme --- */

/* A trial is one step of h at most, and a straight line: the chord of its ends. */
static void a_step_of_the_ladder_is_a_chord(void **state) {
    const double h = 1e-6;
    double reached;
    point begin_at;
    scene z = rectifier();
    (void)state;
    begin(&z, NS_THETA, 1);
    begin_at = shown(&z);
    long events = 0, lines = 0, trials = 0;
    for (; begin_at.t < 2e-3 && trials < 100000; trials++) {
        const int from_event = ns_march_at_event(z.m);
        ok(ns_march_try(z.m, 1, NS_TO_STEP, &reached));
        assert_true(reached >= begin_at.t && reached - begin_at.t < h * (1 + 1e-9));
        const point end_at = shown(&z);
        if (reached > begin_at.t) {
            const double third = begin_at.t + (reached - begin_at.t) / 3,
                         part = (third - begin_at.t) / (reached - begin_at.t);
            const point p = sampled(&z, third), last = sampled(&z, reached);
            assert_true(apart(&z, &last, &end_at) == 0);
            for (int i = 0; i < z.s->n; i++) { /* right after an event all of it is as its end */
                const double from = from_event ? end_at.x[i] : begin_at.x[i];
                assert_true(fabs(p.x[i] - (from + part * (end_at.x[i] - from))) < 1e-13);
            }
            assert_true(isinf(ns_march_shortest(z.m, third, NULL)));
            lines++;
        }
        events += ns_march_at_event(z.m);
        ok(ns_march_accept(z.m));
        begin_at = shown(&z);
    }
    assert_true(events == 3 && lines >= 2000); /* off at the peak at 0.25 ms, on, off at 1.25 ms */
    end(&z);
}

static scene captured(void) {
    const ns_march_options o = {.theta = 0.5, .gamma = 0.5, .h = 1e-6, .method = NS_THETA, .capture = 1};
    scene z = rectifier();
    begin(&z, NS_EXACT, 1);
    ns_march_free(z.m);
    ok(ns_march_create(z.s, &o, &z.m, NULL));
    ok(ns_march_start(z.m, 0, z.w0));
    return z;
}

/* Of steps in which no event is located a sample is what another marcher reads that stops there. */
static void a_step_of_the_captured_scheme(void **state) {
    scene z = captured(), other = captured();
    double now = 0, reached;
    (void)state;
    for (int k = 0; k < 2000; k++) {
        ok(ns_march_try(z.m, 1, NS_TO_STEP, &reached));
        assert_true(reached > now && reached - now < 1e-6 * (1 + 1e-9));
        const point third = sampled(&z, now + (reached - now) / 3), last = sampled(&z, reached),
                    end_at = shown(&z);
        assert_true(apart(&z, &last, &end_at) < 1e-14);
        assert_true(apart_from(&other, &third, NULL) < 1e-14);
        ok(ns_march_accept(other.m));
        assert_true(apart_from(&other, &end_at, NULL) < 1e-14);
        ok(ns_march_accept(other.m));
        ok(ns_march_accept(z.m));
        now = reached;
    }
    assert_true(ns_march_counts(z.m)->events >= 3);
    end(&z);
    end(&other);
}

/* --- what is refused, and what ends a trial --- */

static void other_trials_have_no_way(void **state) {
    double reached;
    scene z = rectifier();
    (void)state;
    begin(&z, NS_EXACT, 1);
    assert_int_equal(ns_march_sample(NULL, 0, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_sample(z.m, 0, NULL, NULL), NS_E_STATE);
    ok(ns_march_try(z.m, 1e-5, NS_TO_EVENT, &reached));
    assert_int_equal(ns_march_sample(z.m, 1e-6, NULL, NULL), NS_E_STATE);
    assert_true(isnan(ns_march_shortest(z.m, 1e-6, NULL)));
    ok(ns_march_try(z.m, 1e-5, NS_TO_STEP, &reached));
    assert_int_equal(ns_march_sample(z.m, -1e-9, NULL, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_sample(z.m, 1.1e-5, NULL, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_sample(z.m, NAN, NULL, NULL), NS_E_RANGE);
    ok(ns_march_sample(z.m, 0.9e-5, NULL, NULL));
    ok(ns_march_try(z.m, 1e-5, NS_TO_TIME, &reached)); /* the same trial */
    ok(ns_march_sample(z.m, 0.9e-5, NULL, NULL));
    end(&z);
}

/* Every corner of every input ends one, of those that drive only a switch too: of a pulse of 10 us with edges
 * four a period. */
static void corners_end_trials(void **state) {
    (void)state;
    const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_AUTO};
    for (int k = 0; k < 3; k++) {
        scene z = one_buck();
        double now = 0, reached;
        begin(&z, methods[k], 1);
        while (now < 100e-6) {
            const double corner = ns_signal_next_corner(&z.s->z[0], now);
            ok(ns_march_try(z.m, 100e-6, NS_TO_STEP, &reached));
            assert_true(reached <= corner);
            ok(ns_march_accept(z.m));
            now = reached;
        }
        end(&z);
    }
}

/* The fast of two rates is looked for until it has died out: 40 times 1 ns, to exp(-40); the slow one then.
 */
static void shortest_follows_what_dies_out(void **state) {
    double reached, until;
    scene z = two_rates();
    (void)state;
    begin(&z, NS_EXACT, 1);
    for (int k = 0; k < 2; k++) { /* to the step, and across it */
        ok(ns_march_try(z.m, 1, NS_TO_STEP, &reached));
        ok(ns_march_accept(z.m));
    }
    ok(ns_march_try(z.m, 1e-3, NS_TO_STEP, &reached));
    const double fast = ns_march_shortest(z.m, 10e-6, &until);
    assert_true(fast > 0.02e-9 && fast < 0.1e-9); /* between h |rate| = 0.025 and 0.05, and a margin */
    assert_true(fabs(until - (10e-6 + 40e-9)) < 1e-9);
    const double slow = ns_march_shortest(z.m, until, &until);
    assert_true(slow > 0.02e-3 && slow < 0.1e-3 && isinf(until));
    end(&z);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(closed_forms_exact),
                                       cmocka_unit_test(closed_forms_sparse),
                                       cmocka_unit_test(events_exact),
                                       cmocka_unit_test(events_sparse),
                                       cmocka_unit_test(islands_keep_their_trials),
                                       cmocka_unit_test(islands_equal_trials),
                                       cmocka_unit_test(a_step_of_the_ladder_is_a_chord),
                                       cmocka_unit_test(a_step_of_the_captured_scheme),
                                       cmocka_unit_test(other_trials_have_no_way),
                                       cmocka_unit_test(corners_end_trials),
                                       cmocka_unit_test(shortest_follows_what_dies_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
