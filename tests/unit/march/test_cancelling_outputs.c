/* tests/unit/march/test_cancelling_outputs.c - voltages and currents that hang on the rates of charges,
 * beside a leg whose capacitor of 50 pF is charged through 2 mohm: right after each of its events steps are
 * as short as 1e-15 s.  In closed form, by elimination from Kirchhoff's laws:
 *
 *     a floating star of coils     sum of i_k = 0, L_k i_k' = v_k - R_k i_k - v_star:
 *                                  v_star = sum of (v_k - R_k i_k)/L_k, divided by the sum of 1/L_k
 *     a capacitor at a source      i = C v'
 *     sources joined by diodes     i_k alike
 *
 * To 1e-9 of the largest number of the circuit by exact, the rounding that is allowed for.  Sparse solves for
 * all at once, also for the 1e5 A of that capacitor: their rounding is 1e-3 of the voltage of a star.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double pi = 3.14159265358979323846;

/* Nodes of the leg: its rails and its middle; free ones begin at OWN. */
enum { P = 1, N, GATE, LEG, OWN };

enum { LEGS = 3, ALL = 40 };

static const double small = 5e-11, rounding = 1e-9;
static const double volts = 320, ohm[LEGS] = {439, 200, 610}, henry[LEGS] = {0.8362, 0.2401, 0.1595};

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[ALL], lambda[ALL], t;
} bench;

static ns_signal constant(double v) {
    return (ns_signal){.kind = NS_DC, .u.dc = v};
}

static ns_signal sine(double v, double hertz, double degrees) {
    return (ns_signal){.kind = NS_SIN, .u.sin = {.va = v, .freq = hertz, .phase = degrees}};
}

static void source(bench *b, const char *name, int p, int n, ns_signal v, int *id) {
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, n, &v, id), NS_OK);
}

static void diode(bench *b, const char *name, int anode, int cathode, double ron, int *id) {
    const ns_diode d = {.vf = 0, .ron = ron, .roff = INFINITY, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(b->c, name, anode, cathode, &d, id), NS_OK);
}

static void snubber(bench *b, const char *name, int p, int n, double farad) {
    assert_int_equal(ns_circuit_capacitor(b->c, name, p, n, farad, 0, NULL), NS_OK);
}

/* A half bridge between P and N with its gate, 1 kHz. */
static void add_leg(bench *b, double farad) {
    const ns_switch s = {.vt = 0.5, .ron = 2e-3, .roff = INFINITY};
    const ns_signal gate = {
        .kind = NS_PULSE,
        .u.pulse = {.v1 = 0, .v2 = 1, .td = 1.3e-4, .tr = 1e-6, .tf = 1e-6, .pw = 4e-4, .per = 1e-3}};
    source(b, "vp", P, 0, constant(volts), NULL);
    source(b, "vn", 0, N, constant(volts), NULL);
    source(b, "vg", GATE, 0, gate, NULL);
    assert_int_equal(ns_circuit_switch(b->c, "s", P, LEG, GATE, 0, &s, NULL), NS_OK);
    diode(b, "d", N, LEG, 2e-3, NULL);
    snubber(b, "c", P, LEG, farad);
}

static bench begin(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

static void start(bench *b, ns_method method) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= ALL && b->s->m <= ALL);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(b->c, b->x), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, b->x), NS_OK);
}

static void end(bench *b) {
    assert_int_equal(ns_march_counts(b->m)->retries, 0);
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static double v_of(const bench *b, int node) {
    return node ? b->x[ns_circuit_node_unknown(b->c, node)] : 0;
}

static double i_of(const bench *b, int id) {
    return b->x[ns_circuit_current_unknown(b->c, id)];
}

/* The next point: of events both sides. */
static void go(bench *b) {
    assert_int_equal(ns_march_try(b->m, 4e-3, NS_TO_EVENT, &b->t), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, b->x, b->lambda, NULL), NS_OK);
}

static void near(const bench *b, double got, double expected, double of, double tol) {
    if (!(fabs(got - expected) <= tol * of))
        fail_msg("t = %.15g: %.12g, expected %.12g: off by %.3g", b->t, got, expected, (got - expected) / of);
}

/* --- stars --- */

typedef struct star {
    int at[LEGS], coil[LEGS], point;
} star;

static void add_star(bench *b, star *s, int from) {
    static const char *const coils[] = {"l0", "l1", "l2"}, *const resistors[] = {"r0", "r1", "r2"};
    s->point = from;
    for (int k = 0; k < LEGS; k++) {
        const int middle = from + 1 + k;
        assert_int_equal(ns_circuit_inductor(b->c, coils[k], s->at[k], middle, henry[k], 0, &s->coil[k]),
                         NS_OK);
        assert_int_equal(ns_circuit_resistor(b->c, resistors[k], middle, s->point, ohm[k], NULL), NS_OK);
    }
}

static void check_star(const bench *b, const star *s, double tol) {
    double sum = 0, of = 0;
    for (int k = 0; k < LEGS; k++) {
        sum += (v_of(b, s->at[k]) - ohm[k] * i_of(b, s->coil[k])) / henry[k];
        of += 1 / henry[k];
    }
    near(b, v_of(b, s->point), sum / of, volts, tol);
}

/* One leg of the star at the half bridge, two at its rails.  guarded: a diode that never conducts leads to
 * the star point, so that the currents add up to zero in the modes that occur, but not in all
 * (inductor_cuts.c). */
static void at_steps(ns_method method, double farad, int guarded, double tol) {
    bench b = begin();
    star s = {.at = {LEG, P, N}};
    int events = 0;
    add_leg(&b, farad);
    add_star(&b, &s, OWN);
    if (guarded)
        diode(&b, "dg", s.point, P, 2e-3, NULL);
    start(&b, method);
    for (; b.t < 4e-3; events++) {
        go(&b);
        check_star(&b, &s, tol);
    }
    assert_true(events > 16);
    end(&b);
}

static void star_at_steps(void **state) {
    (void)state;
    at_steps(NS_EXACT, small, 0, rounding);
    at_steps(NS_EXACT, small, 1, rounding);
}

static void star_at_steps_by_sparse(void **state) {
    (void)state;
    at_steps(NS_SPARSE, 5e-9, 0, rounding);
    at_steps(NS_SPARSE, 5e-9, 1, 2e-3);
}

/* The same between events: of many samples in one mode all but the first ones are one product. */
static void star_between_events(void **state) {
    (void)state;
    bench b = begin();
    star s = {.at = {LEG, P, N}};
    double from = 0, to;
    int samples = 0;
    add_leg(&b, small);
    add_star(&b, &s, OWN);
    start(&b, NS_EXACT);
    for (int trial = 0; trial < 2000 && from < 4e-3; trial++, from = to) {
        assert_int_equal(ns_march_try(b.m, 4e-3, NS_TO_STEP, &to), NS_OK);
        for (int k = 0; k < 256 && to > from; k++, samples++) {
            b.t = from + (to - from) * exp2(-0.2 * k); /* from all of the trial down to 4e-16 of it */
            assert_int_equal(ns_march_sample(b.m, b.t, b.x, b.lambda), NS_OK);
            check_star(&b, &s, rounding);
        }
        assert_int_equal(ns_march_accept(b.m), NS_OK);
    }
    assert_true(from >= 4e-3 && samples > 500);
    end(&b);
}

/* At a bridge of diodes, each with a capacitor, between P and 0: three sources end in the star point, which
 * floats. */
static void star_at_a_bridge(void **state) {
    static const char *const sources[] = {"u0", "u1", "u2"}, *const up[] = {"d0", "d1", "d2"},
                             *const down[] = {"d3", "d4", "d5"}, *const c[] = {"c0", "c1", "c2"};
    (void)state;
    bench b = begin();
    star s;
    enum { RAIL = OWN, AC, SOURCE = AC + LEGS, STAR = SOURCE + LEGS };
    assert_int_equal(ns_circuit_resistor(b.c, "load", RAIL, 0, 300, NULL), NS_OK);
    for (int k = 0; k < LEGS; k++) {
        diode(&b, up[k], AC + k, RAIL, 2e-3, NULL);
        diode(&b, down[k], 0, AC + k, 2e-3, NULL);
        snubber(&b, c[k], AC + k, 0, small);
        source(&b, sources[k], SOURCE + k, AC + k, sine(volts, 400, 50 + 120 * k), NULL);
        s.at[k] = SOURCE + k;
    }
    add_star(&b, &s, STAR);
    start(&b, NS_EXACT);
    int events = 0;
    for (; b.t < 4e-3; events++) {
        go(&b);
        check_star(&b, &s, rounding);
    }
    assert_true(events > 16);
    end(&b);
}

/* --- a loop of a capacitor and a source --- */

static void capacitor_at_a_source(void **state) {
    static const double farad = 1e-6, hertz = 400;
    (void)state;
    bench b = begin();
    int u, events = 0;
    add_leg(&b, small);
    source(&b, "u", OWN, 0, sine(volts, hertz, 50), &u);
    assert_int_equal(ns_circuit_capacitor(b.c, "cu", OWN, 0, farad, volts * sin(50 * pi / 180), NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "ru", OWN, LEG, 1e3, NULL), NS_OK);
    start(&b, NS_EXACT);
    for (; b.t < 4e-3; events++) {
        go(&b);
        const double w = 2 * pi * hertz, i = farad * volts * w * cos(w * b.t + 50 * pi / 180);
        near(&b, -i_of(&b, u), i + (v_of(&b, OWN) - v_of(&b, LEG)) / 1e3, volts, rounding);
    }
    assert_true(events > 16);
    end(&b);
}

/* --- sources that little joins --- */

static void sources_share(void **state) {
    static const char *const sources[] = {"u0", "u1", "u2"}, *const diodes[] = {"d0", "d1", "d2"};
    const ns_signal trapezoid = {
        .kind = NS_PULSE,
        .u.pulse = {.v1 = -volts, .v2 = volts, .tr = 1e-4, .tf = 1e-4, .pw = 1e-4, .per = 1e-3}};
    (void)state;
    bench b = begin();
    int d[LEGS];
    for (int k = 0; k < LEGS; k++) {
        source(&b, sources[k], 1 + k, 0, trapezoid, NULL);
        diode(&b, diodes[k], 1 + k, 1 + LEGS, 4e-11, &d[k]);
    }
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1 + LEGS, 0, 719, NULL), NS_OK);
    start(&b, NS_EXACT);
    for (int points = 0; points < 12 && b.t < 4e-3; points++) {
        go(&b);
        const double v = fmax(0, v_of(&b, 1)), i = v / (LEGS * 719 + 4e-11);
        for (int k = 0; k < LEGS; k++)
            near(&b, b.lambda[ns_circuit_pair(b.c, d[k])], i, volts / 719, rounding);
    }
    end(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(star_at_steps),           cmocka_unit_test(star_between_events),
        cmocka_unit_test(star_at_steps_by_sparse), cmocka_unit_test(star_at_a_bridge),
        cmocka_unit_test(capacitor_at_a_source),   cmocka_unit_test(sources_share)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
