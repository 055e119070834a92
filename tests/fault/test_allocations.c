/* tests/fault/test_allocations.c - every public call that takes memory, with each of its allocations failing
 * once.
 *
 * A call that failed says so (NS_E_MEMORY, or NAN from those that return a number), and made again it gives
 * what it gives when nothing ever failed.  Leaks are the sanitizers' to find.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "retry.h"
#include "systems.h"
#include "wrap_alloc.h"

enum { ROOM = 64, TIMES_MAX = 4000 };

/* What a scenario came to. */
typedef struct outcome {
    int n;
    double v[ROOM];
} outcome;

static void note(outcome *o, int n, const double *v) {
    for (int i = 0; i < n && o->n < ROOM; i++)
        o->v[o->n++] = v[i];
}

/* Runs the scenario with allocation 1, 2, ... failing until none is left: how many there are.  Steps from
 * another map than before (the old one is kept) are the same to the last bit, so all outcomes are. */
static long sweep(void (*scenario)(outcome *)) {
    outcome whole = {0};
    fails = 0;
    scenario(&whole);
    assert_int_equal(fails, 0);
    for (long k = 1;; k++) {
        outcome now = {0};
        fails = 0;
        fail_alloc_at(k);
        scenario(&now);
        fail_alloc_off();
        if (fails == 0)
            return k - 1;
        assert_int_equal(fails, 1);
        assert_int_equal(now.n, whole.n);
        for (int i = 0; i < now.n; i++)
            assert_true(now.v[i] == whole.v[i]);
        assert_true(k < TIMES_MAX);
    }
}

/* --- circuits and systems --- */

static const ns_diode diode = {.vf = 0, .ron = 0, .roff = INFINITY, .vz = INFINITY, .rz = 0};
static const ns_switch gate = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
static const ns_switch guard = {.vt = 3, .vh = 1, .ron = 0, .roff = INFINITY};

/* A source through two diodes in series (between them a node that floats while both block) onto a capacitor;
 * two switches in parallel, commanded by a source, take it down; a third one by the capacitor's own voltage.
 * Coupled inductors between. */
static int build(ns_circuit *c) {
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {.vo = 0, .va = 10, .freq = 1e3}};
    const ns_signal pulse = {
        .kind = NS_PULSE,
        .u.pulse = {.v1 = 0, .v2 = 1, .td = 2e-4, .pw = 2e-4, .per = INFINITY},
    };
    int l1, l2;
    const int status[] = {
        ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &sine, NULL),
        ns_circuit_source(c, "vg", NS_VOLTAGE, 7, 0, &pulse, NULL),
        ns_circuit_resistor(c, "r1", 1, 2, 1, NULL),
        ns_circuit_inductor(c, "l1", 2, 3, 1e-4, NAN, &l1),
        ns_circuit_diode(c, "d1", 3, 4, &diode, NULL),
        ns_circuit_diode(c, "d2", 4, 5, &diode, NULL),
        ns_circuit_capacitor(c, "c1", 5, 0, 1e-5, NAN, NULL),
        ns_circuit_resistor(c, "r2", 5, 6, 10, NULL),
        ns_circuit_switch(c, "s1", 6, 0, 7, 0, &gate, NULL),
        ns_circuit_switch(c, "s2", 6, 0, 7, 0, &gate, NULL),
        ns_circuit_resistor(c, "r3", 5, 8, 100, NULL),
        ns_circuit_switch(c, "s3", 8, 0, 5, 0, &guard, NULL),
        ns_circuit_inductor(c, "l2", 9, 0, 1e-4, NAN, &l2),
        ns_circuit_resistor(c, "r4", 9, 0, 5, NULL),
        ns_circuit_coupling(c, "k1", l1, l2, 0.5, NULL),
        ns_circuit_name_node(c, 9, "coil"),
    };
    int worst = NS_OK;
    for (size_t i = 0; i < sizeof status / sizeof *status; i++)
        worst = worst == NS_OK ? status[i] : worst;
    return worst;
}

/* A circuit that lacks an element is not the same again: it is made anew from nothing. */
static int make_circuit(ns_circuit **out) {
    int status = ns_circuit_create(out);
    if (status == NS_OK && (status = build(*out)) != NS_OK) {
        ns_circuit_free(*out);
        *out = NULL;
    }
    return status;
}

/* From rest, an LC loop that floats until the bridge around it conducts: what each diode blocks is lost in
 * rounding, and only together they tell. */
static ns_system *floating_bridge(void) {
    const ns_signal one = {.kind = NS_DC, .u.dc = 1};
    ns_circuit *c;
    ns_system *s;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 4, 2, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 4, 1, 150e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 1, 2, 68e-9, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 1, 3, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d2", 2, 3, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d3", 0, 2, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d4", 0, 1, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", 3, 0, 400e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    ns_circuit_free(c);
    return s;
}

/* A sine through a diode onto a capacitor and a load, twice: two islands. */
static ns_system *two_rectifiers(void) {
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {.va = 10, .freq = 1e3}};
    ns_circuit *c;
    ns_system *s;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &sine, NULL), NS_OK);
    for (int k = 0; k < 2; k++) {
        const int out = 2 + k;
        assert_int_equal(ns_circuit_diode(c, k ? "d2" : "d1", 1, out, &diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(c, k ? "c2" : "c1", out, 0, 1e-5, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, k ? "r2" : "r1", out, 0, 10 + k, NULL), NS_OK);
    }
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    ns_circuit_free(c);
    return s;
}

static ns_system *rectifier(void) {
    ns_circuit *c;
    ns_system *s;
    assert_int_equal(make_circuit(&c), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    ns_circuit_free(c);
    return s;
}

static void a_circuit(outcome *o) {
    ns_circuit *c;
    ns_system *s;
    TRY(make_circuit(&c));
    TRY(ns_circuit_system(c, &s));
    const double sizes[] = {s->n, s->m, s->nz, s->nc};
    note(o, 4, sizes);
    ns_system_free(s);
    ns_circuit_free(c);
}

static void a_system(outcome *o) {
    const double t[] = {0, 1}, v[] = {0, 5};
    const ns_signal ramp = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = v, .repeat = NAN}};
    double T[4], z;
    int rank;
    ns_system *s;
    TRY(ns_system_create(2, 1, 1, 1, &s));
    TRY(ns_system_set_input(s, 0, &ramp));
    s->M[0] = s->M[2] = 1; /* of rank 1 */
    TRY(ns_system_split(s, T, &rank));
    ns_system_inputs(s, 0.5, NS_RIGHT, &z);
    const double found = rank;
    note(o, 1, &z);
    note(o, 1, &found);
    note(o, 4, T);
    ns_system_free(s);
}

/* --- engines --- */

static ns_system *subject; /* of the engines */

static void march_by(outcome *o, ns_method method, double h, double until) {
    const ns_march_options options = {.theta = 0.5, .gamma = 0.5, .h = h, .method = method, .reltol = 1e-6};
    double t, reached, x[ROOM], lambda[ROOM];
    ns_march *m;
    assert_true(subject->n <= ROOM && subject->m <= ROOM);
    TRY(ns_march_create(subject, &options, &m, NULL));
    memset(x, 0, sizeof x);
    TRY(ns_march_start(m, 0, x));
    TRY(ns_march_try(m, until, NS_TO_TIME, &reached));
    assert_int_equal(ns_march_accept(m), NS_OK);
    TRY(ns_march_read(m, &t, x, lambda, NULL));
    note(o, 1, &t);
    note(o, subject->n, x);
    note(o, subject->m, lambda);
    ns_march_free(m);
}

static void a_march(outcome *o) {
    march_by(o, NS_THETA, 1e-5, 6e-4);
}

static void a_short_march(outcome *o) {
    march_by(o, NS_THETA, 1e-8, 1e-7);
}

static void an_exact(outcome *o) {
    march_by(o, NS_EXACT, 1e-5, 6e-4);
}

static void a_sparse_march(outcome *o) {
    march_by(o, NS_SPARSE, 1e-5, 6e-4);
}

/* By trials with NS_TO_STEP, looked at on their way. */
static void steps_by(outcome *o, ns_method method, double h, double until) {
    const ns_march_options options = {.theta = 0.5, .gamma = 0.5, .h = h, .method = method, .reltol = 1e-6};
    double now = 0, reached, x[ROOM] = {0}, lambda[ROOM];
    ns_march *m;
    TRY(ns_march_create(subject, &options, &m, NULL));
    TRY(ns_march_start(m, 0, x));
    TRY(ns_march_read(m, &now, NULL, NULL, NULL));
    while (now < until) {
        TRY(ns_march_try(m, until, NS_TO_STEP, &reached));
        if (reached > now)
            TRY(ns_march_sample(m, now + (reached - now) / 3, x, lambda));
        assert_int_equal(ns_march_accept(m), NS_OK);
        TRY(ns_march_read(m, &now, NULL, NULL, NULL));
    }
    note(o, 1, &now);
    note(o, subject->n, x);
    note(o, subject->m, lambda);
    ns_march_free(m);
}

static void exact_steps(outcome *o) {
    steps_by(o, NS_EXACT, 1e-5, 6e-4);
}

static void sparse_steps(outcome *o) {
    steps_by(o, NS_SPARSE, 1e-5, 3e-4);
}

static void ladder_steps(outcome *o) {
    steps_by(o, NS_THETA, 1e-5, 1e-4);
}

static void an_operating_point(outcome *o) {
    const ns_march_options options = {.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_THETA};
    const int hold = 4; /* node 5: the capacitor */
    const double volts = 3.5;
    double t, x[ROOM];
    ns_march *m;
    TRY(ns_march_create(subject, &options, &m, NULL));
    TRY(ns_march_start_dc(m, 0, 1, &hold, &volts, x));
    note(o, subject->n, x);
    TRY(ns_march_read(m, &t, x, NULL, NULL));
    note(o, subject->n, x);
    ns_march_free(m);
}

/* 1 V on c1 behind a closed switch and an empty c2: the charge is shared. */
static ns_system *two_capacitors(void) {
    ns_system *s;
    assert_int_equal(ns_system_create(2, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->M[3] = 1;
    s->B[0] = -1, s->B[1] = 1;
    s->C[0] = -1, s->C[1] = 1;
    return s;
}

static void an_impulse(outcome *o) {
    const ns_theta_options options = {1, 1, 0};
    const double w0[] = {1, 0};
    double x[2], lambda, charge;
    ns_theta *t;
    const ns_impulse out = {.x = x, .lambda = &lambda, .Lambda = &charge};
    TRY(ns_theta_create(subject, &options, &t, NULL));
    TRY(ns_theta_start(t, w0, NULL));
    TRY(ns_theta_impulse(t, NULL, NULL, &out));
    note(o, 2, x);
    note(o, 1, &charge);
    TRY(ns_theta_try(t, 1e-3, NULL, 0, NS_RESOLVE));
    assert_int_equal(ns_theta_accept(t), NS_OK);
    TRY(ns_theta_read(t, x, &lambda, NULL));
    note(o, 2, x);
    ns_theta_free(t);
}

static void a_newton_march(outcome *o) {
    const ns_newton_options options = {.theta = 0.5, .gamma = 0.5};
    const double x0[2] = {10, 0};
    double x[2], lambda[4];
    ns_model model;
    ns_jacobian_error worst;
    ns_newton *s;
    assert_int_equal(ns_model_of_system(subject, &model), NS_OK);
    TRY(ns_model_check_jacobians(&model, 0, x0, (const double[4]){0}, &worst));
    note(o, 1, &worst.error);
    TRY(ns_newton_create(&model, &options, &s, NULL));
    TRY(ns_newton_start(s, 0, x0, NULL));
    TRY(ns_newton_jump(s));
    assert_int_equal(ns_newton_accept(s), NS_OK);
    TRY(ns_newton_try(s, 1e-6));
    assert_int_equal(ns_newton_accept(s), NS_OK);
    TRY(ns_newton_advance(s, 300e-6, 5e-6));
    TRY(ns_newton_read(s, NULL, x, lambda, NULL, NULL));
    note(o, 2, x);
    note(o, 4, lambda);
    ns_newton_free(s);
}

/* --- problems --- */

enum { MANY = 130 }; /* more than are judged on the stack */

static int identity_column(void *data, int j, double *w) {
    (void)data;
    memset(w, 0, sizeof(double) * MANY);
    w[j] = 1;
    return 0;
}

static int number_of(double value) {
    return isnan(value) ? NS_E_MEMORY : NS_OK;
}

/* y = lambda - 1, W by columns: lambda = 1. */
static void a_problem(outcome *o) {
    static double q[MANY], l[MANY], u[MANY], lambda[MANY], y[MANY];
    static ns_mode mode[MANY];
    const ns_mlcp p = {.m = MANY, .q = q, .l = l, .u = u, .column = identity_column};
    ns_mlcp_solver *s;
    for (int i = 0; i < MANY; i++) {
        q[i] = -1;
        u[i] = INFINITY;
        mode[i] = NS_LOWER;
    }
    TRY(ns_mlcp_create(MANY, &s));
    TRY(ns_mlcp_solve(s, &p, mode, lambda, y, NULL));
    note(o, 4, lambda);
    TRY(number_of(ns_mlcp_residual(&p, lambda, NULL)));
    TRY(number_of(ns_mlcp_certify(&p, q)));
    ns_mlcp_free(s);
}

/* All numbers 1, so many that the first room is too small. */
static void a_text(outcome *o) {
    char text[150] = "7", back[256];
    size_t length = 1;
    ns_mlcp *p;
    for (int k = 0; k < 7 * 7 + 3 * 7; k++) {
        text[length++] = ' ';
        text[length++] = '1';
    }
    TRY(ns_mlcp_read(text, length, &p, NULL));
    TRY(ns_mlcp_write(p, back, sizeof back, &length));
    const double characters = (double)length;
    note(o, 1, &characters);
    note(o, 4, p->W);
    ns_mlcp_discard(p);
}

/* --- all of them --- */

static void on(ns_system *s, void (*scenario)(outcome *), long least) {
    subject = s;
    assert_true(sweep(scenario) >= least);
    ns_system_free(s);
}

/* Objects and maps, the fewest that the scenarios can make do with: that a sweep is one. */
static void circuits_and_systems(void **state) {
    (void)state;
    assert_true(sweep(a_circuit) > 30);
    assert_true(sweep(a_system) > 15);
}

static void marches(void **state) {
    (void)state;
    on(rectifier(), a_march, 38);
    on(rectifier(), an_operating_point, 40);
    on(floating_bridge(), a_short_march, 37);
    on(rectifier(), an_exact, 50);
    on(rectifier(), a_sparse_march, 50);
    on(two_rectifiers(), an_exact, 100);
    on(two_rectifiers(), a_sparse_march, 100);
}

static void steps(void **state) {
    (void)state;
    on(rectifier(), exact_steps, 50);
    on(rectifier(), sparse_steps, 50);
    on(rectifier(), ladder_steps, 39); /* one more than a march: x, lambda where a step begins */
    on(two_rectifiers(), exact_steps, 100);
    on(two_rectifiers(), sparse_steps, 100);
}

static void impulses(void **state) {
    (void)state;
    on(two_capacitors(), an_impulse, 30);
}

static void newton(void **state) {
    (void)state;
    on(system_lc_bridge(), a_newton_march, 30);
}

static void problems(void **state) {
    (void)state;
    assert_true(sweep(a_problem) >= 8);
    assert_true(sweep(a_text) >= 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circuits_and_systems),
        cmocka_unit_test(marches),
        cmocka_unit_test(steps),
        cmocka_unit_test(impulses),
        cmocka_unit_test(newton),
        cmocka_unit_test(problems),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
