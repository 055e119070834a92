/* tests/unit/sparse/test_output_only.c - unknowns that only show something are left out of the sparse
 * marcher's steps, and yet read right. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/output_only.h"

/* 1 V over a switch on 1 ohm and 4 F; its gate is a triangle between -1 and 1 of period 1, through a divider
 * of 1 ohm and 1 ohm: it closes, without hysteresis, at a quarter of each period and opens at three quarters.
 */
typedef struct rig {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[16];
} rig;

static void begin(rig *k) {
    const ns_switch sw = {0, 0, 0, INFINITY};
    const ns_signal one = {.kind = NS_DC, .u.dc = 1},
                    triangle = {.kind = NS_PULSE, .u.pulse = {-1, 1, 0, 0.5, 0.5, 0, 1, 0}};
    const ns_march_options o = {.h = 10, .method = NS_SPARSE, .reltol = 1e-11};
    assert_int_equal(ns_circuit_create(&k->c), NS_OK);
    assert_int_equal(ns_circuit_source(k->c, "v", NS_VOLTAGE, 1, 0, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k->c, "gate", NS_VOLTAGE, 2, 0, &triangle, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k->c, "a", 2, 3, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k->c, "b", 3, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k->c, "s", 1, 4, 2, 0, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k->c, "r", 4, 5, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k->c, "c", 5, 0, 4, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    assert_true(k->s->n <= 16);
    assert_int_equal(ns_march_create(k->s, &o, &k->m, NULL), NS_OK);
}

static void end(rig *k) {
    ns_march_free(k->m);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
}

/* 0 V, from 1 s on 5 V, at a node that nothing else depends on: on either side of the jump. */
static void sides_of_a_jump(void **state) {
    const ns_signal step = {.kind = NS_PULSE, .u.pulse = {0, 5, 1, 0, 0, 9, INFINITY, 0}};
    const ns_march_options o = {.h = 10, .method = NS_SPARSE, .reltol = 1e-9, .whole = 1};
    rig k;
    double w[16], reached = 0;
    (void)state;
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &step, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r", 1, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "rc", 2, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c", 2, 0, 1, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(k.c, &k.s), NS_OK);
    assert_int_equal(ns_march_create(k.s, &o, &k.m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(k.c, w), NS_OK);
    assert_int_equal(ns_march_start(k.m, 0, w), NS_OK);
    const int v = ns_circuit_node_unknown(k.c, 1);
    while (reached < 1) {
        assert_int_equal(ns_march_try(k.m, 3, NS_TO_STEP, &reached), NS_OK);
        assert_int_equal(ns_march_sample(k.m, reached, k.x, NULL), NS_OK);
        assert_true(k.x[v] == 0);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
    }
    assert_true(reached == 1);
    assert_int_equal(ns_march_try(k.m, 3, NS_TO_STEP, &reached), NS_OK);
    assert_true(reached > 1);
    assert_int_equal(ns_march_sample(k.m, 1, k.x, NULL), NS_OK);
    assert_true(k.x[v] == 5);
    end(&k);
}

static double triangle(double t) {
    const double part = t - floor(t);
    return part < 0.5 ? 4 * part - 1 : 3 - 4 * part;
}

/* 1 - v decays by e^-1/8 in each period, from a quarter of it to three quarters. */
static double charged(double t) {
    const double periods = floor(t), part = t - periods;
    return 1 - exp((-0.5 * periods - fmin(fmax(part - 0.25, 0), 0.5)) / 4);
}

static void near(const rig *k, int node, double expected) {
    const double got = k->x[ns_circuit_node_unknown(k->c, node)];
    if (!(fabs(got - expected) <= 1e-9))
        fail_msg("node %d: %.17g, expected %.17g", node, got, expected);
}

static void check(const rig *k, double t) {
    near(k, 1, 1);
    near(k, 2, triangle(t));
    near(k, 3, triangle(t) / 2);
    near(k, 5, charged(t));
}

static void test_gates(void **state) {
    (void)state;
    rig k = {0};
    double w0[16] = {0}, reached;
    begin(&k);
    assert_int_equal(ns_march_start(k.m, 0, w0), NS_OK);
    for (int i = 1; i < 150; i++) {
        const double t = 0.07 * i;
        assert_int_equal(ns_march_try(k.m, t, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        assert_int_equal(ns_march_read(k.m, NULL, k.x, NULL, NULL), NS_OK);
        check(&k, t);
    }
    end(&k);
}

/* The leg that an open switch begins holds until it closes, though its gate has a corner in between. */
static void test_corners_end_nothing(void **state) {
    (void)state;
    rig k = {0};
    double w0[16] = {0}, reached;
    long before = 0;
    begin(&k);
    assert_int_equal(ns_march_start(k.m, 0, w0), NS_OK);
    for (int i = 0; i < 10; i++) { /* from when it opens to just before it closes */
        assert_int_equal(ns_march_try(k.m, i + 0.8, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        before = ns_march_counts(k.m)->steps;
        assert_int_equal(ns_march_try(k.m, i + 1.2, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
        assert_true(i < 2 || ns_march_counts(k.m)->steps == before);
    }
    end(&k);
}

/* At rest, too: what is held there is shown, and is of no matter to others. */
static void test_dc(void **state) {
    (void)state;
    rig k = {0};
    begin(&k);
    const int hold[] = {ns_circuit_node_unknown(k.c, 3), ns_circuit_node_unknown(k.c, 5)};
    const double at[] = {7, 0.25};
    assert_int_equal(ns_march_start_dc(k.m, 0.4, 2, hold, at, k.x), NS_OK);
    near(&k, 2, triangle(0.4));
    near(&k, 3, 7);
    near(&k, 5, 0.25);
    end(&k);
}

static double at(const ns_csc *a, int i, int j) {
    double sum = 0;
    for (int k = a->start[j]; k < a->start[j + 1]; k++)
        sum += a->row[k] == i ? a->value[k] : 0;
    return sum;
}

/* x_0 and x_3 hold charges, x_1 and x_2 only show something: x_1 = 3 z_0 - 4, x_2 = x_1 / 2 - z_1 + 1.  What
 * stays has all other entries, those of D and F among them. */
static void test_what_stays(void **state) {
    (void)state;
    ns_system *s;
    ns_output_only *a;
    assert_int_equal(ns_system_create(4, 2, 2, 1, &s), NS_OK);
    const int n = 4, m = 2;
    s->M[0] = 1, s->M[3 + 3 * n] = 2, s->M[0 + 3 * n] = 0.5;
    s->A[0] = -1, s->A[3 + 3 * n] = -2, s->A[3] = 7;
    s->A[1 + 1 * n] = -1, s->E[1] = 3, s->b[1] = -4;
    s->A[2 + 2 * n] = -2, s->A[2 + 1 * n] = 1, s->E[2 + 1 * n] = -2, s->b[2] = 2;
    s->E[3 + 1 * n] = 11, s->b[0] = 12, s->b[3] = 13;
    s->B[0 + 1 * n] = 5, s->B[3] = 6;
    s->C[0 + 3 * m] = 8, s->C[1] = 9;
    s->D[0] = 14, s->D[1] = 15, s->D[1 + m] = 16;
    s->F[0 + 1 * m] = 17, s->F[1] = 18;
    s->command[0] = (ns_command){.pair = 1, .gx = calloc(4, sizeof(double)), .gz = calloc(2, sizeof(double))};
    s->command[0].gx[3] = 19, s->command[0].gz[1] = 20;
    assert_int_equal(ns_sparse_output_create(s, &a), NS_OK);
    assert_int_equal(a->count, 2);
    assert_int_equal(a->rest.n, 2);
    assert_true(a->unknown[0] == 1 && a->unknown[1] == 2 && a->stays[0] == 0 && a->stays[1] == 3);
    const int stays[] = {0, 3};
    const ns_large *l = &a->large;
    for (int i = 0; i < 2; i++) {
        assert_true(a->rest.b[i] == s->b[stays[i]]);
        for (int j = 0; j < 2; j++) {
            assert_true(at(&l->M, i, j) == s->M[stays[i] + stays[j] * n]);
            assert_true(at(&l->A, i, j) == s->A[stays[i] + stays[j] * n]);
            assert_true(at(&l->B, i, j) == s->B[stays[i] + j * n]);
            assert_true(at(&l->C, i, j) == s->C[i + stays[j] * m]);
            assert_true(at(&l->D, i, j) == s->D[i + j * m]);
            assert_true(at(&l->E, i, j) == s->E[stays[i] + j * n]);
            assert_true(at(&l->F, i, j) == s->F[i + j * m]);
        }
        assert_true(at(&l->gx, i, 0) == s->command[0].gx[stays[i]]);
        assert_true(at(&l->gz, i, 0) == s->command[0].gz[i]);
    }
    const double rest[] = {21, 22}, z[] = {2, 5}; /* x_1 = 3*2 - 4 = 2, x_2 = 2/2 - 5 + 1 = -3 */
    double x[4];
    ns_sparse_output_join(a, rest, z, x);
    assert_true(x[0] == 21 && x[1] == 2 && x[2] == -3 && x[3] == 22);
    /* at the same inputs they are known; each that changes counts: x_1 = 3*4 - 4 = 8, x_2 = 8/2 - 7 + 1 = -2
     */
    const double moved[] = {23, 24}, other[2][2] = {{4, 5}, {4, 7}};
    ns_sparse_output_join(a, moved, z, x);
    assert_true(x[0] == 23 && x[1] == 2 && x[2] == -3 && x[3] == 24);
    assert_int_equal(a->solves, 1);
    ns_sparse_output_join(a, moved, other[0], x);
    assert_true(x[1] == 8 && x[2] == 0);
    ns_sparse_output_join(a, moved, other[1], x);
    assert_true(x[1] == 8 && x[2] == -2);
    assert_int_equal(a->solves, 3);
    ns_sparse_output_free(a);
    ns_system_free(s);
}

/* x_1 and x_2 only show something, but their equations x_1 + x_2 = z, 2 x_1 + 2 x_2 = 0 are singular: they
 * stay, as others name them. */
static void test_singular_outputs_stay(void **state) {
    (void)state;
    ns_system *s;
    ns_output_only *a;
    assert_int_equal(ns_system_create(3, 1, 1, 0, &s), NS_OK);
    s->M[0] = 1, s->A[0] = -1, s->B[0] = 1, s->C[0] = 1;
    s->A[1 + 1 * 3] = s->A[1 + 2 * 3] = -1, s->A[2 + 1 * 3] = s->A[2 + 2 * 3] = -2;
    s->E[1] = 1;
    assert_int_equal(ns_sparse_output_create(s, &a), NS_OK);
    assert_int_equal(a->count, 0);
    assert_int_equal(a->rest.n, 3);
    for (int i = 0; i < 3; i++)
        assert_true(a->place[i] == i && a->stays[i] == i);
    const double rest[] = {21, 22, 23}, z[] = {2};
    double x[3];
    ns_sparse_output_join(a, rest, z, x);
    assert_memory_equal(x, rest, sizeof x);
    ns_sparse_output_free(a);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(sides_of_a_jump),
                                       cmocka_unit_test(test_what_stays),
                                       cmocka_unit_test(test_singular_outputs_stay),
                                       cmocka_unit_test(test_gates),
                                       cmocka_unit_test(test_corners_end_nothing),
                                       cmocka_unit_test(test_dc)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
