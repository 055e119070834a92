/* tests/unit/circuit/test_refuse.c - bad input gets its status and its message and changes nothing; so does
 * every allocation that fails. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/circuit.h"
#include "wrap_alloc.h"

static const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
static const ns_switch fast = {0.5, 0, 0, INFINITY};

/* r1, l1, l2, v1 (a PWL), d1, s1: elements 0 to 5. */
static ns_circuit *make(void) {
    ns_circuit *c = NULL;
    const double t[] = {0, 1}, v[] = {0, 5};
    ns_signal s = {.kind = NS_PWL};
    s.u.pwl.n = 2;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_string_equal(ns_circuit_message(c), "");
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 0, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 1, 2, 1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", 2, 0, 1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 2, 3, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 3, 0, 1, 0, &fast, NULL), NS_OK);
    return c;
}

static int same_array(const double *a, const double *b, int count) {
    return count == 0 || memcmp(a, b, (size_t)count * sizeof *a) == 0;
}

static ns_system *system_of(ns_circuit *c) {
    ns_system *s = NULL;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    return s;
}

/* The circuit gives the system it gave before. */
static void assert_unchanged(ns_circuit *c, const ns_system *before) {
    ns_system *s = system_of(c);
    assert_true(s->n == before->n && s->m == before->m && s->nz == before->nz && s->nc == before->nc);
    assert_true(same_array(s->M, before->M, s->n * s->n) && same_array(s->A, before->A, s->n * s->n));
    assert_true(same_array(s->B, before->B, s->n * s->m) && same_array(s->C, before->C, s->n * s->m));
    assert_true(same_array(s->b, before->b, s->n) && same_array(s->e, before->e, s->m));
    assert_true(ns_circuit_node_ic_count(c) == 0);
    ns_system_free(s);
}

/* A call that must be refused, with the message it must give. */
#define REFUSED(status, text, call)                                                                          \
    do {                                                                                                     \
        int id = 99;                                                                                         \
        assert_int_equal((call), (status));                                                                  \
        assert_string_equal(ns_circuit_message(c), (text));                                                  \
        assert_int_equal(id, 99);                                                                            \
    } while (0)

static void names_and_nodes(void **state) {
    ns_circuit *c = make();
    ns_system *before = system_of(c);
    (void)state;
    REFUSED(NS_E_NULL, "element 6: its name is missing", ns_circuit_resistor(c, NULL, 1, 0, 1, &id));
    REFUSED(NS_E_NAME, "element 6: its name is empty", ns_circuit_resistor(c, "", 1, 0, 1, &id));
    REFUSED(NS_E_NAME, "d1: this name is given twice", ns_circuit_resistor(c, "d1", 1, 0, 1, &id));
    REFUSED(NS_E_SIZE, "r2: number of node = -7 must be at least 0",
            ns_circuit_resistor(c, "r2", 1, -7, 1, &id));
    REFUSED(NS_E_SIZE, "s2: number of node = -1 must be at least 0",
            ns_circuit_switch(c, "s2", 1, 0, 2, -1, &fast, &id));
    REFUSED(NS_E_SIZE, "x: number of node = -2 must be at least 0", ns_circuit_name_node(c, -2, "x"));
    REFUSED(NS_E_NULL, "node 3: its name is missing", ns_circuit_name_node(c, 3, NULL));
    REFUSED(NS_E_SIZE, "node 0: only nodes above 0 take an initial voltage", ns_circuit_node_ic(c, 0, 1));
    REFUSED(NS_E_NUMBER, "node 3: ic = nan must be a finite number", ns_circuit_node_ic(c, 3, NAN));
    assert_unchanged(c, before);
    ns_system_free(before);
    ns_circuit_free(c);
}

static void values(void **state) {
    ns_circuit *c = make();
    ns_system *before = system_of(c);
    (void)state;
    REFUSED(NS_E_NUMBER, "r2: resistance = nan must be a finite number",
            ns_circuit_resistor(c, "r2", 4, 0, NAN, &id));
    REFUSED(NS_E_RANGE, "r2: resistance = 1e-310 is too small to invert (0 is allowed)",
            ns_circuit_resistor(c, "r2", 4, 0, 1e-310, &id));
    REFUSED(NS_E_RANGE, "c1: capacitance = -1 must be at least 0",
            ns_circuit_capacitor(c, "c1", 4, 0, -1, NAN, &id));
    REFUSED(NS_E_NUMBER, "c1: ic = inf must be a finite number",
            ns_circuit_capacitor(c, "c1", 4, 0, 1, INFINITY, &id));
    REFUSED(NS_E_NUMBER, "l3: inductance = inf must be a finite number",
            ns_circuit_inductor(c, "l3", 4, 0, INFINITY, NAN, &id));
    REFUSED(NS_E_NUMBER, "g1: gain = nan must be a finite number",
            ns_circuit_vcontrolled(c, "g1", NS_CURRENT, 4, 0, 1, 0, NAN, &id));
    REFUSED(NS_E_NUMBER, "f1: gain = inf must be a finite number",
            ns_circuit_icontrolled(c, "f1", NS_CURRENT, 4, 0, 1, INFINITY, &id));
    REFUSED(NS_E_RANGE, "e1: kind of output = 7 is unknown",
            ns_circuit_vcontrolled(c, "e1", (ns_output)7, 4, 0, 1, 0, 1, &id));
    assert_unchanged(c, before);
    ns_system_free(before);
    ns_circuit_free(c);
}

static void references(void **state) {
    const ns_term bad_node = {0, -1, 1}, bad_current = {1, 0, 1}, nothing = {1, 6, 1}, bad_gain = {0, 1, NAN};
    ns_circuit *c = make();
    ns_system *before = system_of(c);
    (void)state;
    REFUSED(NS_E_SIZE, "k1: there is no element 6 to refer to", ns_circuit_coupling(c, "k1", 1, 6, 1, &id));
    REFUSED(NS_E_SIZE, "k1: r1 is not an inductor", ns_circuit_coupling(c, "k1", 0, 1, 1, &id));
    REFUSED(NS_E_SIZE, "k1: couples l1 with itself", ns_circuit_coupling(c, "k1", 1, 1, 1, &id));
    REFUSED(NS_E_RANGE, "k1: coupling = 1.01 must lie between -1 and 1",
            ns_circuit_coupling(c, "k1", 1, 2, 1.01, &id));
    REFUSED(NS_E_NUMBER, "k1: coupling = nan must be a finite number",
            ns_circuit_coupling(c, "k1", 1, 2, NAN, &id));
    REFUSED(NS_E_SIZE, "h1: the current of r1 is not an unknown that can control",
            ns_circuit_icontrolled(c, "h1", NS_VOLTAGE, 4, 0, 0, 1, &id));
    REFUSED(NS_E_SIZE, "h1: there is no element -1 to refer to",
            ns_circuit_icontrolled(c, "h1", NS_VOLTAGE, 4, 0, -1, 1, &id));
    REFUSED(NS_E_SIZE, "b1: number of node = -1 must be at least 0",
            ns_circuit_linear(c, "b1", NS_VOLTAGE, 4, 0, 0, 1, &bad_node, &id));
    REFUSED(NS_E_SIZE, "b1: the current of r1 is not an unknown that can control",
            ns_circuit_linear(c, "b1", NS_VOLTAGE, 4, 0, 0, 1, &bad_current, &id));
    REFUSED(NS_E_SIZE, "b1: there is no element 6 to refer to",
            ns_circuit_linear(c, "b1", NS_CURRENT, 4, 0, 0, 1, &nothing, &id));
    REFUSED(NS_E_NUMBER, "b1: gain = nan must be a finite number",
            ns_circuit_linear(c, "b1", NS_CURRENT, 4, 0, 0, 1, &bad_gain, &id));
    REFUSED(NS_E_NUMBER, "b1: constant = nan must be a finite number",
            ns_circuit_linear(c, "b1", NS_CURRENT, 4, 0, NAN, 0, NULL, &id));
    REFUSED(NS_E_NULL, "b1: its 1 terms are missing",
            ns_circuit_linear(c, "b1", NS_CURRENT, 4, 0, 0, 1, NULL, &id));
    REFUSED(NS_E_SIZE, "b1: its -1 terms are missing",
            ns_circuit_linear(c, "b1", NS_CURRENT, 4, 0, 0, -1, NULL, &id));
    assert_unchanged(c, before);
    ns_system_free(before);
    ns_circuit_free(c);
}

static void diode_parameters(void **state) {
    const struct {
        ns_diode d;
        int status;
        const char *text;
    } bad[] = {
        {{NAN, 0, 1, INFINITY, 0}, NS_E_NUMBER, "d2: vf = nan must be a finite number"},
        {{0, INFINITY, INFINITY, INFINITY, 0}, NS_E_NUMBER, "d2: ron = inf must be a finite number"},
        {{0, -1, 1, INFINITY, 0}, NS_E_RANGE, "d2: ron = -1 must be at least 0"},
        {{0, 0, NAN, INFINITY, 0}, NS_E_NUMBER, "d2: roff = nan must be a number"},
        {{0, 2, 1, INFINITY, 0}, NS_E_RANGE, "d2: roff = 1 must be larger than ron = 2"},
        {{0, 0, 0, INFINITY, 0}, NS_E_RANGE, "d2: roff = 0 must be larger than ron = 0"},
        {{0, 0, 1e-310, INFINITY, 0}, NS_E_RANGE, "d2: roff = 1e-310 is too small to invert"},
        {{0, 0, 1, NAN, 0}, NS_E_NUMBER, "d2: vz = nan must be a number"},
        {{0, 0, 1, -3, 0}, NS_E_RANGE, "d2: vz = -3 must be positive"},
        {{0.7, 0, 1, 0, 0}, NS_E_RANGE, "d2: vz = 0 must be positive"},
        {{0, 0, 1, 3, 2}, NS_E_RANGE, "d2: roff = 1 must be larger than rz = 2"},
        {{0, 0, 1, 3, -2}, NS_E_RANGE, "d2: rz = -2 must be at least 0"},
        {{-2, 0.5, 1, 3, 0}, NS_E_RANGE, "d2: vz = 3 must keep breakdown below conduction at vf = -2"},
        {{-4, 0, INFINITY, 3, 0}, NS_E_RANGE, "d2: vz = 3 must keep breakdown below conduction at vf = -4"},
    };
    ns_circuit *c = make();
    ns_system *before = system_of(c);
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        REFUSED(bad[i].status, bad[i].text, ns_circuit_diode(c, "d2", 4, 0, &bad[i].d, &id));
    }
    REFUSED(NS_E_NULL, "d2: its parameters are missing", ns_circuit_diode(c, "d2", 4, 0, NULL, &id));
    assert_unchanged(c, before);
    ns_system_free(before);
    /* kinks of breakdown at -3/(1-1/2) = -6 V and of conduction at -4 V: monotone */
    assert_int_equal(ns_circuit_diode(c, "d2", 4, 0, &(ns_diode){-4, 0, 1, 3, 0.5}, NULL), NS_OK);
    ns_circuit_free(c);
}

static void switch_parameters(void **state) {
    const struct {
        ns_switch s;
        int status;
        const char *text;
    } bad[] = {
        {{NAN, 0, 0, 1}, NS_E_NUMBER, "s2: vt = nan must be a finite number"},
        {{0, NAN, 0, 1}, NS_E_NUMBER, "s2: vh = nan must be a finite number"},
        {{0, -1, 0, 1}, NS_E_RANGE, "s2: vh = -1 must be at least 0"},
        {{0, 0, 3, 1}, NS_E_RANGE, "s2: roff = 1 must be larger than ron = 3"},
    };
    ns_circuit *c = make();
    ns_system *before = system_of(c);
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        REFUSED(bad[i].status, bad[i].text, ns_circuit_switch(c, "s2", 4, 0, 1, 0, &bad[i].s, &id));
    }
    REFUSED(NS_E_NULL, "s2: its parameters are missing", ns_circuit_switch(c, "s2", 4, 0, 1, 0, NULL, &id));
    assert_unchanged(c, before);
    ns_system_free(before);
    ns_circuit_free(c);
}

static void signals(void **state) {
    const double t[] = {0, 2, 1}, v[] = {0, 0, 0};
    ns_signal pulse = {.kind = NS_PULSE}, pwl = {.kind = NS_PWL};
    ns_circuit *c = make();
    ns_system *before = system_of(c);
    pulse.u.pulse.per = -1;
    pwl.u.pwl.n = 3;
    pwl.u.pwl.t = t;
    pwl.u.pwl.v = v;
    pwl.u.pwl.repeat = NAN;
    (void)state;
    REFUSED(NS_E_RANGE, "v2: per = -1 must be positive",
            ns_circuit_source(c, "v2", NS_VOLTAGE, 4, 0, &pulse, &id));
    REFUSED(NS_E_RANGE, "i2: time of a point = 1 lies before the point ahead of it = 2",
            ns_circuit_source(c, "i2", NS_CURRENT, 4, 0, &pwl, &id));
    pwl.u.pwl.n = 2;
    pwl.u.pwl.repeat = 1.5;
    REFUSED(NS_E_RANGE, "i2: r = 1.5 must be the time of a point before the last = 2",
            ns_circuit_source(c, "i2", NS_CURRENT, 4, 0, &pwl, &id));
    REFUSED(NS_E_NULL, "v2: its signal is missing", ns_circuit_source(c, "v2", NS_VOLTAGE, 4, 0, NULL, &id));
    assert_unchanged(c, before);
    ns_system_free(before);
    ns_circuit_free(c);
}

static void no_circuit(void **state) {
    ns_system *s;
    ns_signal dc = {.kind = NS_DC};
    (void)state;
    assert_int_equal(ns_circuit_create(NULL), NS_E_NULL);
    assert_string_equal(ns_circuit_message(NULL), "");
    assert_int_equal(ns_circuit_resistor(NULL, "r", 1, 0, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_capacitor(NULL, "c", 1, 0, 1, 0, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_inductor(NULL, "l", 1, 0, 1, 0, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_coupling(NULL, "k", 1, 0, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_source(NULL, "v", NS_VOLTAGE, 1, 0, &dc, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_vcontrolled(NULL, "e", NS_VOLTAGE, 1, 0, 1, 0, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_icontrolled(NULL, "h", NS_VOLTAGE, 1, 0, 1, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_linear(NULL, "b", NS_VOLTAGE, 1, 0, 1, 0, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_diode(NULL, "d", 1, 0, &ideal, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_switch(NULL, "s", 1, 0, 1, 0, &fast, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_name_node(NULL, 1, "x"), NS_E_NULL);
    assert_int_equal(ns_circuit_node_ic(NULL, 1, 1), NS_E_NULL);
    assert_int_equal(ns_circuit_system(NULL, &s), NS_E_NULL);
    assert_null(s);
    assert_int_equal(ns_circuit_node_unknown(NULL, 1), -1);
    assert_int_equal(ns_circuit_current_unknown(NULL, 1), -1);
    assert_int_equal(ns_circuit_node_ic_count(NULL), 0);
}

/* Conductances that overflow together only show in the whole circuit. */
static void overflow_in_the_sum(void **state) {
    ns_circuit *c = make();
    ns_system *s = NULL;
    (void)state;
    assert_int_equal(ns_circuit_system(c, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_resistor(c, "r2", 5, 0, 6e-309, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r3", 5, 0, 6e-309, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_E_NUMBER);
    assert_null(s);
    assert_string_equal(ns_circuit_message(c),
                        "node 5: a number is NaN, or infinite where it must be finite");
    ns_circuit_free(c);
}

static void long_names_are_cut(void **state) {
    ns_circuit *c = make();
    char name[3000];
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    (void)state;
    assert_int_equal(ns_circuit_resistor(c, name, 1, 0, NAN, NULL), NS_E_NUMBER);
    assert_non_null(strstr(ns_circuit_message(c), ": resistance = nan"));
    assert_int_equal(ns_circuit_resistor(c, name, 1, 0, 1, NULL), NS_OK);
    ns_circuit_free(c);
}

/* Additions of every kind that takes memory, on nodes not met before. */
static int add(ns_circuit *c, int what) {
    const double t[] = {0, 1}, v[] = {0, 5};
    const ns_term terms[] = {{0, 11, 1}, {0, 12, 1}, {0, 13, 1}};
    ns_signal s = {.kind = NS_PWL};
    ns_system *made = NULL;
    int status;
    s.u.pwl.n = 2;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    switch (what) {
    case 0:
        return ns_circuit_source(c, "i9", NS_CURRENT, 9, 10, &s, NULL);
    case 1:
        return ns_circuit_linear(c, "b9", NS_CURRENT, 9, 10, 0, 3, terms, NULL);
    case 2:
        return ns_circuit_name_node(c, 99, "somewhere");
    case 3:
        return ns_circuit_node_ic(c, 99, 1);
    default:
        status = ns_circuit_system(c, &made);
        assert_true(status == NS_OK || made == NULL);
        ns_system_free(made);
        return status;
    }
}

/* Lets allocation 1, 2, ... fail while `what` is added behind so many resistors or named nodes; returns how
 * many allocations there are.
 */
static long fail_each(int what, int fillers) {
    for (long k = 1;; k++) {
        ns_circuit *c = make();
        ns_system *before;
        int status;
        long made;
        for (int i = 0; i < fillers; i++) {
            char name[] = {(char)('A' + i / 8), (char)('a' + i % 8), '\0'};
            assert_int_equal(what < 2 ? ns_circuit_resistor(c, name, 100 + i, 0, 1, NULL)
                                      : ns_circuit_name_node(c, 100 + i, name),
                             NS_OK);
        }
        before = system_of(c);
        fail_alloc_at(k);
        status = add(c, what);
        made = allocs_made();
        fail_alloc_off();
        assert_int_equal(status, made < k ? NS_OK : NS_E_MEMORY);
        if (made >= k) {
            assert_non_null(strstr(ns_circuit_message(c), "out of memory"));
            assert_unchanged(c, before);
        }
        ns_system_free(before);
        ns_circuit_free(c);
        if (made < k) {
            return k - 1;
        }
    }
}

/* Some number of them fills the room exactly, so that it has to grow once more. */
static void every_allocation_failing(void **state) {
    const long least[] = {4, 3, 2, 1, 15};
    (void)state;
    for (int what = 0; what < 5; what++) {
        long most = 0;
        for (int fillers = 0; fillers < 24; fillers++) {
            long failures = fail_each(what, fillers);
            most = failures > most ? failures : most;
        }
        assert_true(most >= least[what]);
    }
}

static void creation_without_memory(void **state) {
    ns_circuit *c = (ns_circuit *)1;
    (void)state;
    fail_alloc_at(1);
    assert_int_equal(ns_circuit_create(&c), NS_E_MEMORY);
    fail_alloc_off();
    assert_null(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_nodes),
        cmocka_unit_test(values),
        cmocka_unit_test(references),
        cmocka_unit_test(diode_parameters),
        cmocka_unit_test(switch_parameters),
        cmocka_unit_test(signals),
        cmocka_unit_test(no_circuit),
        cmocka_unit_test(overflow_in_the_sum),
        cmocka_unit_test(long_names_are_cut),
        cmocka_unit_test(every_allocation_failing),
        cmocka_unit_test(creation_without_memory),
    };
    return cmocka_run_group_tests_name("circuit refuse", tests, NULL, NULL);
}
