/* tests/unit/exact/test_mode_kernel.c - the matrices of one mode against closed forms: steps, values at an
 * instant, guards and their rates. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "exact/mode_kernel.h"
#include "inputs/time_events_internal.h"
#include "net.h"
#include "wrap_alloc.h"

typedef struct bench {
    net k;
    ns_time_events *events;
    ns_input_states *inputs;
    ns_mode_kernel *kernel;
    double X[NET_MOST], at[NET_MOST], room[NET_MOST];
} bench;

/* The kernel of the mode in which all diodes are as said, of Euler steps g; X: the charges at rest, and
 * inputs. */
static void build(bench *b, double g, ns_mode of_diodes) {
    unsigned char all[NET_MOST];
    const double no_slopes[NET_MOST] = {0};
    ns_mode mode[NET_MOST];
    memset(all, 1, sizeof all);
    net_prepare(&b->k);
    for (int j = 0; j < b->k.s->m; j++)
        mode[j] = of_diodes;
    assert_int_equal(ns_inputs_events_create(b->k.s, all, &b->events), NS_OK);
    assert_int_equal(ns_inputs_states_create(b->k.s, b->events, &b->inputs), NS_OK);
    assert_int_equal(ns_exact_kernel_build(b->k.step, b->inputs, g, mode, &b->kernel), NS_OK);
    assert_int_equal(ns_exact_output_map(b->k.step, b->inputs, b->kernel), NS_OK);
    memcpy(b->X, b->k.step->past.w, sizeof(double) * (size_t)b->kernel->r);
    ns_inputs_states_at(b->inputs, 0, b->k.z, no_slopes, b->X + b->kernel->r);
}

static void drop(bench *b) {
    ns_exact_kernel_free(b->kernel);
    ns_inputs_states_free(b->inputs);
    ns_inputs_events_free(b->events);
    net_end(&b->k);
}

static void look(bench *b) {
    ns_exact_output_map_apply(b->k.step, b->inputs, b->kernel, b->X, b->at, b->room);
}

static void near(double got, double expected, double off) {
    if (!(fabs(got - expected) <= off * fabs(expected)))
        fail_msg("%.17g, expected %.17g: %g of it apart", got, expected, got / expected - 1);
}

/* 2 uF at 5 V, 1 kohm and a diode that blocks it: exp(-t/2 ms) and 5 V across the diode, whose rate is
 * -5 V/2 ms, and that of this 5 V/(2 ms)^2. */
static void a_capacitor_and_a_resistor(void **state) {
    (void)state;
    bench b = {.k = net_begin()};
    net_capacitor(&b.k, "c", 1, 0, 2e-6, 5);
    net_resistor(&b.k, "r", 1, 0, 1e3);
    net_diode(&b.k, "d", 0, 1);
    build(&b, 1e-5, NS_LOWER);
    const ns_mode_kernel *k = b.kernel;
    double P[2];
    assert_int_equal(k->r, 1);
    assert_int_equal(k->rows, 1);
    for (int i = 1; i <= 4; i++) {
        const double t = k->h * i / 4;
        ns_exact_kernel_step(k, t, P);
        near(P[0] * b.X[0], 1e-5 * exp(-t / 2e-3), 1e-14);
    }
    near(k->step[0], exp(-k->h / 2e-3), 1e-14);
    look(&b);
    near(net_voltage_of(&b.k, b.at, 1), 5, 1e-14);
    near(k->value[0] * b.X[0], 5, 1e-14);
    near(k->rate[0] * b.X[0], -5 / 2e-3, 1e-12);
    near(k->second_rate[0] * b.X[0], 5 / 4e-6, 1e-10);
    drop(&b);
}

/* 10/3 V and a chain of diodes that all conduct; each node between two has a capacitor to one of two nodes,
 * which hang on 10/3 V and on 0 V by 3 mohm.  Charges of the chain that do not add up are so many volts that
 * these cancel, but M x is w to their last bits. */
static void voltages_that_cancel(double g) {
    const double volts = 10. / 3;
    bench b = {.k = net_begin()};
    net_voltage(&b.k, "v", 1, 0, volts);
    net_voltage(&b.k, "va", 2, 0, volts);
    net_voltage(&b.k, "vb", 3, 0, 0);
    net_resistor(&b.k, "ra", 2, 4, 3e-3);
    net_resistor(&b.k, "rb", 3, 5, 3e-3);
    for (int i = 0; i < 8; i++) {
        const char d[] = {'d', (char)('0' + i), 0}, c[] = {'c', (char)('0' + i), 0};
        net_diode(&b.k, d, i ? 5 + i : 1, 6 + i);
        net_capacitor(&b.k, c, 6 + i, 4 + i % 2, (3 + sqrt(i)) * 1e-6, i % 2 ? volts : 0);
    }
    net_diode(&b.k, "d8", 13, 14);
    net_capacitor(&b.k, "c8", 14, 0, 70e-6, volts);
    net_resistor(&b.k, "r", 14, 0, 1e4);
    build(&b, g, NS_INSIDE);
    look(&b);
    double off = 0, most = 0;
    for (int i = 0; i < b.kernel->r; i++) {
        double rest = b.X[i];
        for (int j = 0; j < b.k.s->n; j++)
            rest -= b.k.step->M[i + j * b.k.s->n] * b.at[j];
        off = fmax(off, fabs(rest) / b.k.step->unit[i]);
        most = fmax(most, fabs(b.X[i]) / b.k.step->unit[i]);
    }
    if (!(off <= 4 * DBL_EPSILON * most))
        fail_msg("g %g: M x is %g of w away from it", g, off / most);
    drop(&b);
}

static void charges_are_those_of_the_voltages(void **state) {
    (void)state;
    for (int digits = 8; digits <= 16; digits++)
        voltages_that_cancel(pow(10, -digits));
}

/* Two of 1 uF joined by a resistor, in an Euler step of 10 us: of a charge of one, half goes to the other.
 * Through 1 kohm that is a flow of about 1e-2 of it; of 1 mohm each voltage alone makes a flow of 5e3 times
 * the charge, whose rounding would be as much larger: charges are not summed from these, though other two are
 * joined by 1 kohm. */
static void flows_that_cancel_are_not_summed(void **state) {
    static const double ohms[] = {1e3, 1e-3};
    (void)state;
    for (int i = 0; i < 2; i++) {
        bench b = {.k = net_begin()};
        net_capacitor(&b.k, "c1", 1, 0, 1e-6, 5);
        net_capacitor(&b.k, "c2", 2, 0, 1e-6, 0);
        net_capacitor(&b.k, "c3", 3, 0, 1e-6, 5);
        net_capacitor(&b.k, "c4", 4, 0, 1e-6, 0);
        net_resistor(&b.k, "r12", 1, 2, 1e3);
        net_resistor(&b.k, "r34", 3, 4, ohms[i]);
        build(&b, 1e-5, NS_LOWER);
        assert_int_equal(ns_exact_kernel_flows(b.k.step, b.inputs, b.kernel), NS_OK);
        assert_int_equal(b.kernel->flows, 4); /* those of the voltages */
        assert_int_equal(b.kernel->flow_powers != NULL, i == 0);
        drop(&b);
    }
}

/* Of two such circuits the rounding of the guards is the same, whichever comes first. */
static void rounding_of_each_charge(void **state) {
    (void)state;
    bench b = {.k = net_begin()};
    for (int i = 0; i < 2; i++) {
        net_capacitor(&b.k, i ? "c2" : "c1", 1 + i, 0, 2e-6, 5);
        net_resistor(&b.k, i ? "r2" : "r1", 1 + i, 0, 1e3);
        net_diode(&b.k, i ? "d2" : "d1", 0, 1 + i);
    }
    build(&b, 1e-5, NS_LOWER);
    const ns_mode_kernel *k = b.kernel;
    assert_true(k->r == 2 && k->rows == 2 && k->rounding[0] > 0);
    assert_true(k->rounding[0] == k->rounding[1 + k->rows]);
    assert_true(k->rounding[1] == k->rounding[k->rows]);
    drop(&b);
}

static void no_memory_for_flows(void **state) {
    long tried = 0;
    (void)state;
    bench b = {.k = net_begin()};
    net_capacitor(&b.k, "c", 1, 0, 2e-6, 5);
    net_resistor(&b.k, "r", 1, 0, 1e3);
    net_diode(&b.k, "d", 0, 1);
    build(&b, 1e-5, NS_LOWER);
    for (long k = 1;; k++) {
        fail_alloc_at(k);
        const int status = ns_exact_kernel_flows(b.k.step, b.inputs, b.kernel);
        tried = allocs_made();
        fail_alloc_off();
        if (tried < k) {
            assert_int_equal(status, NS_OK);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(b.kernel->flow_powers);
    }
    assert_true(tried > 0 && b.kernel->flow_powers);
    drop(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_capacitor_and_a_resistor), cmocka_unit_test(charges_are_those_of_the_voltages),
        cmocka_unit_test(flows_that_cancel_are_not_summed), cmocka_unit_test(rounding_of_each_charge),
        cmocka_unit_test(no_memory_for_flows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
