/* tests/property/test_islands_random.c - two or three random networks at one supply, a square wave behind a
 * resistor for each: islands on their own ways against all in one, by exact.
 *
 * Networks that are refused (impossible starts, sources shorted) are so both ways.  What capacitors and
 * inductors hold is compared: voltages of nodes that float between open devices are not determined.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "passive.h"
#include "runs.h"

enum { PARTS = 3, ALL = PARTS * ELEMENTS, STEPS = 40, RUNS = FEWER_IF_SANITIZED(200), SUPPLY = 90 };

typedef struct scene {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    int id[ALL];
} scene;

static element drawn[ALL];
static int parts;

static int node_of(int part, int node) {
    return node == 0 ? 0 : 10 * (part + 1) + node;
}

static int add(scene *z, int k) {
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    const ns_switch gate = {0.5, 0, 0, INFINITY};
    const element *e = &drawn[k];
    const int part = k / ELEMENTS, p = node_of(part, e->p), n = node_of(part, e->n), g = 100 + k;
    char name[16], gate_name[16];
    snprintf(name, sizeof name, "e%d", k);
    snprintf(gate_name, sizeof gate_name, "g%d", k);
    if (e->kind == RES)
        return ns_circuit_resistor(z->c, name, p, n, e->value, &z->id[k]);
    if (e->kind == CAP)
        return ns_circuit_capacitor(z->c, name, p, n, e->value, e->ic, &z->id[k]);
    if (e->kind == IND)
        return ns_circuit_inductor(z->c, name, p, n, e->value, e->ic, &z->id[k]);
    if (e->kind == DIODE)
        return ns_circuit_diode(z->c, name, p, n, &diode, &z->id[k]);
    const double on = e->instant < 0 ? 1 : 0;
    const ns_signal s = {
        .kind = NS_PULSE,
        .u.pulse = {.v1 = 1 - on, .v2 = on, .td = fabs(e->instant), .pw = 1, .per = INFINITY}};
    const int status = ns_circuit_source(z->c, gate_name, NS_VOLTAGE, g, 0, &s, NULL);
    return status ? status : ns_circuit_switch(z->c, name, p, n, g, 0, &gate, &z->id[k]);
}

static int begin_scene(scene *z, double h, int whole) {
    const ns_signal square = {.kind = NS_PULSE, .u.pulse = {.v2 = 5, .pw = 9e-6, .per = 17e-6}};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = NS_EXACT, .whole = whole};
    double w0[ALL * 4] = {0};
    *z = (scene){0};
    assert_int_equal(ns_circuit_create(&z->c), NS_OK);
    assert_int_equal(ns_circuit_source(z->c, "in", NS_VOLTAGE, SUPPLY, 0, &square, NULL), NS_OK);
    for (int k = 0; k < parts * ELEMENTS; k++)
        assert_int_equal(add(z, k), NS_OK);
    for (int part = 0; part < parts; part++) {
        char name[8];
        snprintf(name, sizeof name, "r%d", part);
        const int to =
            node_of(part, drawn[part * ELEMENTS].p ? drawn[part * ELEMENTS].p : drawn[part * ELEMENTS].n);
        assert_int_equal(ns_circuit_resistor(z->c, name, SUPPLY, to, 10, NULL), NS_OK);
    }
    int status = ns_circuit_system(z->c, &z->s);
    if (status == NS_OK)
        status = ns_circuit_rest(z->c, w0);
    status = status ? status : ns_march_create(z->s, &o, &z->m, NULL);
    return status ? status : ns_march_start(z->m, 0, w0);
}

static void end_scene(scene *z) {
    ns_march_free(z->m);
    ns_system_free(z->s);
    ns_circuit_free(z->c);
}

/* What element k holds, as the square root of its energy. */
static double stored(const scene *z, int k) {
    double x[ALL * 4];
    const element *e = &drawn[k];
    const int part = k / ELEMENTS;
    assert_int_equal(ns_march_read(z->m, NULL, x, NULL, NULL), NS_OK);
    if (e->kind == IND)
        return sqrt(e->value) * x[ns_circuit_current_unknown(z->c, z->id[k])];
    if (e->kind != CAP)
        return 0;
    const int p = ns_circuit_node_unknown(z->c, node_of(part, e->p)),
              n = ns_circuit_node_unknown(z->c, node_of(part, e->n));
    return sqrt(e->value) * ((p < 0 ? 0 : x[p]) - (n < 0 ? 0 : x[n]));
}

static double difference(const scene *a, const scene *b) {
    double most = 0, size = 0;
    for (int k = 0; k < parts * ELEMENTS; k++) {
        most = fmax(most, fabs(stored(a, k) - stored(b, k)));
        size = fmax(size, fabs(stored(b, k)));
    }
    return most / (size + 1e-6);
}

static int on_to(scene *z, double t) {
    double reached;
    const int status = ns_march_try(z->m, t, NS_TO_TIME, &reached);
    return status == NS_OK ? ns_march_accept(z->m) : status;
}

/* What it is off by itself, at a tenth of h: starts that short what is charged in several ways at once. */
static double off_by_itself(const scene *whole, double t) {
    scene finer;
    int status = begin_scene(&finer, 1e-7, 1);
    status = status ? status : on_to(&finer, t);
    const double off = status == NS_OK ? difference(whole, &finer) : INFINITY;
    end_scene(&finer);
    return off;
}

enum outcome { REFUSED, UNKNOWN, RIGHT, OUTCOMES };

static int compare(unsigned long seed) {
    scene a, b;
    int end = RIGHT;
    parts = 2 + (int)(seed % 2);
    for (int part = 0; part < parts; part++)
        random_network(&drawn[part * ELEMENTS], 10 * seed + (unsigned long)part);
    int first = begin_scene(&a, 1e-6, 0), second = begin_scene(&b, 1e-6, 1);
    if (first == NS_OK)
        assert_true(ns_march_counts(a.m)->islands >= 2);
    for (int step = 1; step <= STEPS && end == RIGHT && first == NS_OK && second == NS_OK; step++) {
        const double t = 2e-6 * step;
        first = on_to(&a, t);
        second = on_to(&b, t);
        const double off = first == NS_OK && second == NS_OK ? difference(&a, &b) : 0;
        if (off > 1e-8) {
            printf("network %lu: %g apart at %g s\n", seed, off, t);
            assert_true(off_by_itself(&b, t) > 0.1 * off);
            end = UNKNOWN;
        }
    }
    assert_int_equal(first, second);
    end_scene(&a);
    end_scene(&b);
    return first == NS_OK ? end : REFUSED;
}

static void networks(void **state) {
    int count[OUTCOMES] = {0};
    (void)state;
    for (unsigned long seed = 1; seed <= RUNS; seed++)
        count[compare(seed)]++;
    printf("%d as all in one, %d not known, %d refused\n", count[RIGHT], count[UNKNOWN], count[REFUSED]);
    assert_true(count[RIGHT] >= RUNS * 9 / 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(networks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
