/* tests/unit/march/test_jump.c - jumps of the marcher: at the same instant, charge and flux conserved.
 *
 * Resistors carry charge all the time; through a jump, which takes none, they carry nothing.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "wrap_alloc.h"

enum { MOST = 40 };

static const double conserved = 1e-12;
static const ns_switch contact = {0.5, 0, 0, INFINITY};
static const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double t, x[MOST], lambda[MOST], y[MOST];
} bench;

static bench open_bench(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

static void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static void capacitor(bench *b, const char *name, int p, int n, double c, double v) {
    assert_int_equal(ns_circuit_capacitor(b->c, name, p, n, c, v, NULL), NS_OK);
}

static int inductor(bench *b, const char *name, int p, int n, double l, double i) {
    int id;
    assert_int_equal(ns_circuit_inductor(b->c, name, p, n, l, i, &id), NS_OK);
    return id;
}

static void resistor(bench *b, const char *name, int p, int n, double r) {
    assert_int_equal(ns_circuit_resistor(b->c, name, p, n, r, NULL), NS_OK);
}

/* A voltage that goes from v0 at 0 to v1 at t1 and there to v2. */
static int source(bench *b, const char *name, int p, int n, double v0, double v1, double v2, double t1) {
    const double t[3] = {0, t1, t1}, v[3] = {v0, v1, v2};
    ns_signal s = {.kind = NS_PWL};
    int id;
    s.u.pwl.n = 3;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, n, &s, &id), NS_OK);
    return id;
}

static const double instant = 1e-6, step = 1e-7;

/* A switch from p to n that closes (or opens) at the instant; its gate is node 90 + k. */
static int switch_at(bench *b, const char *name, int p, int n, int closes, int k) {
    int id;
    char gate[8] = "vg0";
    gate[2] = (char)('0' + k);
    source(b, gate, 90 + k, 0, !closes, !closes, closes, instant);
    assert_int_equal(ns_circuit_switch(b->c, name, p, n, 90 + k, 0, &contact, &id), NS_OK);
    return id;
}

static int diode_on(bench *b, const char *name, int p, int n) {
    int id;
    assert_int_equal(ns_circuit_diode(b->c, name, p, n, &diode, &id), NS_OK);
    return id;
}

static void look(bench *b) {
    assert_int_equal(ns_march_read(b->m, &b->t, b->x, b->lambda, b->y), NS_OK);
}

static void start(bench *b, double theta) {
    double w0[MOST];
    const ns_march_options o = {.theta = theta, .gamma = theta, .h = step, .method = NS_THETA};
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= MOST && b->s->m <= MOST);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
    look(b);
}

/* On to one side of the next event. */
static void to_side(bench *b) {
    double reached;
    assert_int_equal(ns_march_try(b->m, 1, NS_TO_EVENT, &reached), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    look(b);
    assert_true(reached == b->t);
}

static void to_time(bench *b, double t) {
    double reached;
    assert_int_equal(ns_march_try(b->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    look(b);
}

/* The jump at the instant: its left side is left in *b, its right side in *right. */
static void jump(bench *b, bench *right) {
    to_side(b);
    assert_true(b->t == instant && ns_march_at_event(b->m));
    *right = *b;
    to_side(right);
    assert_true(right->t == instant && !ns_march_at_event(b->m));
}

static double v_of(const bench *b, int node) {
    return b->x[ns_circuit_node_unknown(b->c, node)];
}

static double i_of(const bench *b, int id) {
    return b->x[ns_circuit_current_unknown(b->c, id)];
}

static double through(const bench *b, int id) {
    double i;
    assert_int_equal(ns_circuit_device(b->c, id, b->x, b->lambda, ns_march_mode(b->m), &i, NULL, NULL),
                     NS_OK);
    return i;
}

static void near(double got, double expected, double scale) {
    if (!(fabs(got - expected) <= conserved * scale))
        print_message("got %.17g, expected %.17g\n", got, expected);
    assert_true(fabs(got - expected) <= conserved * scale);
}

static const double thetas[2] = {1, 0.5};

/* 1 uF at 10 V and 3 uF at 2 V, 1 ohm across each, joined: q = C1 v1 + C2 v2 on both sides, v = q/(C1 + C2),
 * and 3 uF at v/R in the switch then is C2's share of 2 v/R less its own: C2 v' = -2 v/R C2/(C1+C2), i = C2
 * v' + v/R = -v/(2 R). */
static void capacitor_onto_capacitor(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        bench b = open_bench(), r;
        capacitor(&b, "c1", 1, 0, 1e-6, 10);
        capacitor(&b, "c2", 2, 0, 3e-6, 2);
        resistor(&b, "r1", 1, 0, 1);
        resistor(&b, "r2", 2, 0, 1);
        const int s = switch_at(&b, "s1", 1, 2, 1, 0);
        start(&b, thetas[k]);
        jump(&b, &r);
        const double v = (v_of(&b, 1) + 3 * v_of(&b, 2)) / 4;
        assert_true(v_of(&b, 1) > 3 && v_of(&b, 2) > 1); /* 10/e, 2 e^(-1/3) */
        near(v_of(&r, 1), v, v);
        near(v_of(&r, 2), v, v);
        assert_true(fabs(through(&r, s) / (-v / 2) - 1) < 1e-6); /* read off steps of h/2^20 */
        to_time(&r, instant + 1e-6);
        /* tau = R/2 (C1 + C2) = 2 us, by implicit steps of 0.1 us: 1/(1.05)^10 or ((1-.025)/(1+.025))^10 */
        const double factor = k ? pow(0.975 / 1.025, 10) : pow(1.05, -10);
        assert_true(fabs(v_of(&r, 1) / (v * factor) - 1) < 1e-6);
        close_bench(&b);
    }
}

/* 2 uF at 1 V onto a ramp that is at 5 V then and rises by 1 V/us: 5 V at once, 2 A from then on.  1 uF
 * behind 1 ohm keeps what it has. */
static void capacitor_onto_source(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        bench b = open_bench(), r;
        source(&b, "v1", 1, 0, 4, 14, 14, 10 * instant);
        const int s = switch_at(&b, "s1", 1, 2, 1, 0);
        capacitor(&b, "c1", 2, 0, 2e-6, 1);
        resistor(&b, "r1", 2, 3, 1);
        capacitor(&b, "c2", 3, 0, 1e-6, 0);
        start(&b, thetas[k]);
        jump(&b, &r);
        near(v_of(&r, 2), 5, 5);
        near(v_of(&r, 3), v_of(&b, 3), v_of(&b, 3));
        assert_true(fabs(through(&r, s) / (2 + 5 - v_of(&b, 3)) - 1) < 1e-6);
        close_bench(&b);
    }
}

/* L1 i1 = (L1 + L2) i: 1 mH, interrupted into 3 mH at rest, with 1 kohm in their way. */
static void inductor_into_inductor(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        bench b = open_bench(), r;
        const int l1 = inductor(&b, "l1", 0, 1, 1e-3, 2), l2 = inductor(&b, "l2", 1, 2, 3e-3, 0);
        resistor(&b, "r", 2, 0, 1e3);
        switch_at(&b, "s1", 1, 0, 0, 0);
        start(&b, thetas[k]);
        jump(&b, &r);
        near(i_of(&b, l1), 2, 2);
        near(i_of(&b, l2), 0, 2);
        near(i_of(&r, l1), 0.5, 0.5);
        near(i_of(&r, l2), 0.5, 0.5);
        /* L2 di/dt = v1 - R i, L1 di/dt = -v1: v1 = R i L1/(L1 + L2) = 125 V */
        assert_true(fabs(v_of(&r, 1) / 125 - 1) < 1e-6);
        close_bench(&b);
    }
}

/* 1 uF at 10 V through a diode onto an empty one of 3 uF: 2.5 V, at a start and at an event.  1 ohm at the
 * second one: the diode carries on with C1's share, v C1/(C1 + C2)/R; at the first one it blocks. */
static void through_a_diode(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        const int event = k & 1, load = k & 2 ? 1 : 3;
        bench b = open_bench(), r;
        capacitor(&b, "c1", 1, 0, 1e-6, 10);
        capacitor(&b, "c2", 3, 0, 3e-6, 0);
        resistor(&b, "r", load, 0, 1);
        const int d = diode_on(&b, "d1", event ? 2 : 1, 3);
        if (event)
            switch_at(&b, "s1", 1, 2, 1, 0);
        start(&b, thetas[k / 4]);
        r = b;
        if (event)
            jump(&b, &r);
        assert_true(r.t == (event ? instant : 0));
        const double v = event ? v_of(&b, 1) / 4 : 2.5;
        near(v_of(&r, 1), v, v);
        near(v_of(&r, 3), v, v);
        assert_true(fabs(through(&r, d) - (load == 1 ? 0 : v / 4)) < 1e-6);
        close_bench(&b);
    }
}

/* What is consistent does not jump: a switch closes between two capacitors at the same voltage, with 1 ohm
 * across one of them; time goes on by short steps, and no impulse problem is solved. */
static void what_is_consistent_does_not_jump(void **state) {
    (void)state;
    bench b = open_bench();
    source(&b, "v1", 1, 0, 5, 5, 5, 1);
    resistor(&b, "r1", 1, 2, 1);
    capacitor(&b, "c1", 2, 0, 1e-6, 5);
    capacitor(&b, "c2", 3, 0, 1e-6, 5);
    switch_at(&b, "s1", 2, 3, 1, 0);
    start(&b, 1);
    to_side(&b);
    assert_true(b.t == instant);
    to_side(&b);
    assert_true(b.t > instant && b.t < instant + step / 1e5);
    near(v_of(&b, 2), 5, 5);
    near(v_of(&b, 3), 5, 5);
    assert_int_equal(ns_march_counts(b.m)->jumps, 0);
    close_bench(&b);
}

/* A jump that makes its own switch open again: 1 V, 1 kohm, 1 uF, shorted above 0.6 V until below 0.4 V. From
 * 0 to 0.6 V takes RC ln(1/0.4). */
static void a_jump_opens_its_switch(void **state) {
    (void)state;
    const ns_switch own = {0.5, 0.1, 0, INFINITY};
    bench b = open_bench();
    source(&b, "v1", 2, 0, 1, 1, 1, 1);
    resistor(&b, "r1", 2, 1, 1e3);
    capacitor(&b, "c1", 1, 0, 1e-6, 0);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 0, 1, 0, &own, NULL), NS_OK);
    start(&b, 0.5);
    for (int k = 1; k < 4; k++) {
        to_side(&b);
        const double left = b.t;
        assert_true(fabs(left / (k * 1e-3 * log(1 / 0.4)) - 1) < 1e-6);
        assert_true(fabs(v_of(&b, 1) - 0.6) < 1e-6);
        to_side(&b);
        /* two short steps for the switch that opens; the capacitor charges from 0 meanwhile, at 1 kV/s */
        assert_true(b.t > left && b.t < left + 8 * step / (1 << 20));
        near(v_of(&b, 1), 1e3 * (b.t - left), 1);
        assert_int_equal(ns_march_counts(b.m)->jumps, k);
    }
    close_bench(&b);
}

/* Whatever allocation fails on the way through a jump: told, the accepted point stays, the next try arrives.
 */
static void memory_fails(void **state) {
    (void)state;
    long at = 1;
    for (;; at++) {
        double reached;
        bench b = open_bench();
        capacitor(&b, "c1", 1, 0, 1e-6, 10);
        capacitor(&b, "c2", 3, 0, 3e-6, 2);
        diode_on(&b, "d1", 2, 3);
        switch_at(&b, "s1", 1, 2, 1, 0);
        start(&b, 1);
        to_side(&b);
        fail_alloc_at(at);
        const int status = ns_march_try(b.m, 1, NS_TO_EVENT, &reached);
        const long made = allocs_made();
        fail_alloc_off();
        if (made >= at) {
            assert_int_equal(status, NS_E_MEMORY);
            assert_int_equal(ns_march_fault(b.m)->status, NS_E_MEMORY);
            look(&b);
            assert_true(b.t == instant);
            near(v_of(&b, 1), 10, 10);
            near(v_of(&b, 3), 2, 10);
        }
        to_side(&b);
        near(v_of(&b, 1), 4, 4);
        near(v_of(&b, 3), 4, 4);
        close_bench(&b);
        if (made < at)
            break;
    }
    assert_true(at > 20); /* maps, and the impulse problem */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(capacitor_onto_capacitor),
        cmocka_unit_test(capacitor_onto_source),
        cmocka_unit_test(inductor_into_inductor),
        cmocka_unit_test(through_a_diode),
        cmocka_unit_test(what_is_consistent_does_not_jump),
        cmocka_unit_test(a_jump_opens_its_switch),
        cmocka_unit_test(memory_fails),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
