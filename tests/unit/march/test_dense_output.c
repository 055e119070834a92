/* tests/unit/march/test_dense_output.c - points on the way of a trial: closed forms, the same as a trial that
 * ends there, and the trial stays as it is. */
#include "dense_output.h"

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

/* Of two_rates(). */
static double since_step(double t, double tau) {
    return t > 10e-6 ? 1 - exp(-(t - 10e-6) / tau) : 0;
}

static double slow_of_two(double t) {
    return since_step(t, 1e-3);
}

static double fast_of_two(double t) {
    return since_step(t, 1e-9);
}

/* Half of a source that rises from 10 to 15 us to 4 V, falls from 1 ms to 1.1 ms and rises again at 2.01 ms.
 */
static double half_of_edges(double t) {
    const double after = fmod(t, 2e-3) - 10e-6;
    return after < 0 ? 0 : 2 * fmin(after / 5e-6, fmax(0, fmin(1, (1.09e-3 - after) / 0.1e-3)));
}

static scene divided_edges(void) {
    scene z = {0};
    ok(ns_circuit_create(&z.c));
    put(&z, "v", 2, 0, pulse(0, 4, 10e-6, 5e-6, 0.1e-3, 0.985e-3, 2e-3));
    ok(ns_circuit_resistor(z.c, "r1", 2, 1, 1e3, NULL));
    ok(ns_circuit_resistor(z.c, "r2", 1, 0, 1e3, NULL));
    return z;
}

/* Half of a sine: what follows it holds no charge, and is no straight line. */
static double half_of_sine(double t) {
    return 5 * sin(2 * pi * 500 * t);
}

static scene divided_sine(void) {
    scene z = {0};
    ok(ns_circuit_create(&z.c));
    put(&z, "v", 2, 0, sine(10, 500));
    ok(ns_circuit_resistor(z.c, "r1", 2, 1, 1e3, NULL));
    ok(ns_circuit_resistor(z.c, "r2", 1, 0, 1e3, NULL));
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

/* Without charges. */
static const form resting[] = {
    {"divided edges", divided_edges, half_of_edges, 1, 3e-3},
    {"divided sine", divided_sine, half_of_sine, 1, 5e-3},
};

static void equals_closed_form(const form *f, ns_method method, double tolerance, double as_trial) {
    scene z = f->build();
    begin(&z, method, 1);
    check c = {.unknown = ns_circuit_node_unknown(z.c, f->node),
               .form = f->form,
               .tolerance = tolerance,
               .as_trial = as_trial};
    walk(&z, &c, f->end);
    print_message("%s, method %d: %ld trials, %.1e from the closed form, %.1e from trials\n", f->name,
                  (int)method, c.trials, c.worst, c.worst_as_trial);
    end(&z);
}

static void closed_forms_exact(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++)
        equals_closed_form(&forms[k], NS_EXACT, 1e-10, 1e-12);
    for (size_t k = 0; k < sizeof resting / sizeof *resting; k++)
        equals_closed_form(&resting[k], NS_EXACT, 1e-12, 1e-12);
}

static void closed_forms_sparse(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof forms / sizeof *forms; k++)
        equals_closed_form(&forms[k], NS_SPARSE, 1e-8, 1e-8); /* steps of 1e-9 */
}

/* --- with events --- */

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

/* By trials with NS_TO_STEP alone, read before and after they are accepted, as the other marcher has it. */
static void islands_by(ns_method method, double tolerance, double same) {
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
        assert_true(accepted.t == reached && apart(&z, &accepted, &end) <= same);
        worst = fmax(worst, between ? apart_from(&other, &accepted, y) : 0);
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
    islands_by(NS_EXACT, 1e-9, 0);
    /* read twice, a point inside of a sparse step is another one by less than reltol */
    islands_by(NS_SPARSE, 1e-6, 1e-8);
    islands_by(NS_AUTO, 1e-9, 0);
}

static void islands_equal_trials(void **state) {
    (void)state;
    check c = {.unknown = -1, .as_trial = 1e-9};
    scene z = three_islands();
    begin(&z, NS_EXACT, 0);
    walk(&z, &c, 100e-6);
    end(&z);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(closed_forms_exact),
                                       cmocka_unit_test(closed_forms_sparse),
                                       cmocka_unit_test(events_exact),
                                       cmocka_unit_test(events_sparse),
                                       cmocka_unit_test(islands_keep_their_trials),
                                       cmocka_unit_test(islands_equal_trials)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
