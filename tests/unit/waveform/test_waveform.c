/* tests/unit/waveform/test_waveform.c - points such that straight lines are the waveform, against closed
 * forms and against a marcher that is asked for instants in between. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { MOST = 200000, LOOKED = 8 };

static const double pi = 3.14159265358979323846;

/* The points of a run: times, and signals of some unknowns. */
typedef struct run {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    ns_waveform *w;
    int unknown[LOOKED], signals, count;
    double *t, *v; /* MOST, MOST * LOOKED */
} run;

static run begin(void) {
    run r = {0};
    assert_int_equal(ns_circuit_create(&r.c), NS_OK);
    r.t = malloc(sizeof *r.t * MOST);
    r.v = malloc(sizeof *r.v * MOST * LOOKED);
    assert_true(r.t && r.v);
    return r;
}

static void end(run *r) {
    ns_waveform_free(r->w);
    ns_march_free(r->m);
    ns_system_free(r->s);
    ns_circuit_free(r->c);
    free(r->t);
    free(r->v);
}

static void keep(run *r, const ns_waveform_point *p) {
    assert_true(r->count < MOST);
    assert_true(r->count == 0 || p->t > r->t[r->count - 1]);
    for (int k = 0; k < r->signals; k++)
        r->v[r->count * LOOKED + k] = p->x[r->unknown[k]];
    r->t[r->count++] = p->t;
}

/* From rest. */
static void prepare(run *r, ns_method method, double h, double lines, double stop) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = method};
    const ns_waveform_options look = {
        .lines = lines, .closest = 4.6e-14 * stop, .noise = method == NS_SPARSE ? 1e-9 : 0};
    assert_int_equal(ns_circuit_system(r->c, &r->s), NS_OK);
    assert_int_equal(ns_march_create(r->s, &o, &r->m, NULL), NS_OK);
    assert_int_equal(ns_waveform_create(r->s, r->m, &look, &r->w), NS_OK);
}

static void start_at_rest(run *r, ns_march *m) {
    double *w0 = calloc((size_t)r->s->n + 1, sizeof *w0);
    assert_int_equal(ns_circuit_rest(r->c, w0), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    free(w0);
}

static void collect(run *r, double stop) {
    ns_waveform_point p;
    r->count = 0;
    start_at_rest(r, r->m);
    assert_int_equal(ns_waveform_start(r->w, &p), NS_OK);
    keep(r, &p);
    while (r->t[r->count - 1] < stop) {
        const int status = ns_waveform_next(r->w, stop, &p);
        assert_int_equal(status, NS_OK);
        keep(r, &p);
    }
    assert_true(r->t[r->count - 1] == stop);
}

static double line_at(const run *r, int k, double t) {
    int i = 1;
    while (i < r->count - 1 && r->t[i] < t)
        i++;
    const double part = (t - r->t[i - 1]) / (r->t[i] - r->t[i - 1]);
    return r->v[(i - 1) * LOOKED + k] + part * (r->v[i * LOOKED + k] - r->v[(i - 1) * LOOKED + k]);
}

static double average(const run *r, int k) {
    double sum = 0;
    for (int i = 1; i < r->count; i++)
        sum += 0.5 * (r->t[i] - r->t[i - 1]) * (r->v[i * LOOKED + k] + r->v[(i - 1) * LOOKED + k]);
    return sum / (r->t[r->count - 1] - r->t[0]);
}

static double largest(const run *r, int k) {
    double most = 0;
    for (int i = 0; i < r->count; i++)
        most = fmax(most, fabs(r->v[i * LOOKED + k]));
    return most;
}

/* An RC at a step of a source: v = 1 - e^(-t/T).  Lines between points on a curve of second derivative 1/T^2
 * e^(-t/T) are off by its square of their length / 8. */
static void a_charging_capacitor_is_within_its_lines(void **state) {
    (void)state;
    static const double lines[] = {1e-2, 1e-4, 1e-6};
    for (int method = NS_EXACT; method <= NS_SPARSE; method++)
        for (int i = 0; i < 3; i++) {
            run r = begin();
            int id;
            const ns_signal one = {.kind = NS_DC, .u.dc = 1};
            assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &one, &id), NS_OK);
            assert_int_equal(ns_circuit_resistor(r.c, "r", 1, 2, 1e3, &id), NS_OK);
            assert_int_equal(ns_circuit_capacitor(r.c, "c", 2, 0, 1e-9, 0, &id), NS_OK);
            prepare(&r, (ns_method)method, 1e-7, lines[i], 1e-3);
            r.unknown[r.signals++] = ns_circuit_node_unknown(r.c, 2);
            collect(&r, 1e-3);
            double worst = 0;
            for (int k = 0; k < 1600; k++) { /* to 0.8 ms, by 1 % each */
                const double t = 1e-10 * pow(1.01, k);
                worst = fmax(worst, fabs(line_at(&r, 0, t) - (1 - exp(-t / 1e-6))));
            }
            /* mean: 1 - T/1ms + ... */
            const double mean = fabs(average(&r, 0) - (1 - 1e-3));
            print_message("%d lines %g: %d points, off by %.2g, mean by %.2g\n", method, lines[i], r.count,
                          worst, mean);
            assert_true(worst <= 1.01 * lines[i]);
            assert_true(mean <= lines[i]);
            assert_true(r.count < 12 + 4 / sqrt(lines[i]));
            end(&r);
        }
}

/* 1 uF charged to 1 V rings with 1 mH: it turns twice in each period of 2 pi sqrt(L C) = 0.2 ms, and is what
 * asks for the points; a capacitor at rest asks for none. */
static void turns_of_a_ring_are_counted(void **state) {
    (void)state;
    for (int method = NS_EXACT; method <= NS_SPARSE; method++)
        for (int charged = 0; charged < 2; charged++) {
            run r = begin();
            int id;
            assert_int_equal(ns_circuit_capacitor(r.c, "c", 1, 0, 1e-6, charged, &id), NS_OK);
            assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 0, 1e-3, 0, &id), NS_OK);
            prepare(&r, (ns_method)method, 1e-6, 1e-4, 1e-2);
            r.unknown[r.signals++] = ns_circuit_node_unknown(r.c, 1);
            collect(&r, 1e-2);
            const ns_waveform_counts c = ns_waveform_read_counts(r.w);
            const double period = 2 * acos(-1) * sqrt(1e-6 * 1e-3);
            assert_int_equal(c.points, r.count);
            assert_int_equal(c.busiest >= 0, charged);
            assert_true(fabs(c.turns - charged * 2 / period) <= 2 / 1e-2 * charged); /* two, at the ends */
            end(&r);
        }
}

/* Volt-seconds: an inductor of 10 uH is cut off from 24 V by a switch with roff = 1 Mohm for 12 of 20 us: the
 * mean over each period at the switch is 24 V when the current begins and ends the same; the spike decays in
 * 10 ps. */
static void volt_seconds_of_a_spike_are_right(void **state) {
    (void)state;
    for (int method = NS_EXACT; method <= NS_SPARSE; method++) {
        run r = begin();
        int id;
        const ns_signal v = {.kind = NS_DC, .u.dc = 24};
        const ns_signal gate = {.kind = NS_PULSE, .u.pulse = {0, 10, 0, 1e-9, 1e-9, 8e-6, 20e-6, 0}};
        const ns_switch params = {.vt = 5, .ron = 5e-3, .roff = 1e6};
        assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &v, &id), NS_OK);
        assert_int_equal(ns_circuit_source(r.c, "g", NS_VOLTAGE, 3, 0, &gate, &id), NS_OK);
        assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 2, 10e-6, 0, &id), NS_OK);
        assert_int_equal(ns_circuit_switch(r.c, "s", 2, 0, 3, 0, &params, &id), NS_OK);
        prepare(&r, (ns_method)method, 2e-8, 0, 2e-3);
        r.unknown[r.signals++] = ns_circuit_node_unknown(r.c, 2);
        collect(&r, 2e-3);
        print_message("%d: %d points, mean %.9g V, largest %.6g V\n", method, r.count, average(&r, 0),
                      largest(&r, 0));
        assert_true(fabs(average(&r, 0) - 24) < 24e-4);
        /* A decay e^(-t/T) by trapezoids within 1e-4 of its integral takes 3 T / c of them at best, c = 2
         * sqrt(1e-4): 150. */
        assert_true(r.count < 100 * 220);
        end(&r);
    }
}

/* A triangle of current has its corners alone. */
static void straight_waveforms_have_corners_alone(void **state) {
    (void)state;
    run r = begin();
    int id;
    const ns_signal square = {.kind = NS_PULSE, .u.pulse = {-1, 1, 0, 0, 0, 5e-6, 10e-6, 0}};
    assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &square, &id), NS_OK);
    assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 0, 1e-6, 0, &id), NS_OK);
    prepare(&r, NS_EXACT, 1e-8, 0, 1e-2);
    r.unknown[r.signals++] = ns_circuit_current_unknown(r.c, id);
    collect(&r, 1e-2);
    print_message("%d points for 1000 periods\n", r.count);
    assert_true(r.count <= 4 * 1000 + 2); /* two sides of each jump of the source */
    assert_true(fabs(largest(&r, 0) - 5) < 1e-9);
    end(&r);
}

/* A triangle from 0 to 5 A and back has the mean square 25/3: trapezoids of squares at its corners give 25/2.
 * A ramp in n parts is off by 1/(2 n^2): 1e-3 takes 23. */
static void squares_are_right_on_request(void **state) {
    (void)state;
    for (int asked = 0; asked < 2; asked++) {
        run r = begin();
        int id;
        const ns_signal square = {.kind = NS_PULSE, .u.pulse = {-1, 1, 0, 0, 0, 5e-6, 10e-6, 0}};
        assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &square, &id), NS_OK);
        assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 0, 1e-6, 0, &id), NS_OK);
        prepare(&r, NS_EXACT, 1e-8, 0, 1e-3);
        ns_waveform_free(r.w);
        const ns_waveform_options look = {.squares = asked ? 1e-3 : 0, .closest = 1e-17};
        assert_int_equal(ns_waveform_create(r.s, r.m, &look, &r.w), NS_OK);
        r.unknown[r.signals++] = ns_circuit_current_unknown(r.c, id);
        collect(&r, 1e-3);
        double sum = 0;
        for (int i = 1; i < r.count; i++)
            sum += 0.5 * (r.t[i] - r.t[i - 1]) *
                   (r.v[i * LOOKED] * r.v[i * LOOKED] + r.v[(i - 1) * LOOKED] * r.v[(i - 1) * LOOKED]);
        const double off = sum / 1e-3 / (25.0 / 3) - 1;
        print_message("mean square off by %.3g, %d points for 100 periods\n", off, r.count);
        const long by_squares = ns_waveform_read_counts(r.w).by_squares; /* not the two corners of a period */
        assert_true(asked ? (double)by_squares > 0.9 * r.count && by_squares < r.count : by_squares == 0);
        if (asked)
            assert_true(fabs(off) < 1e-3 && r.count < 200 * (2 * 23 + 4));
        else
            assert_true(fabs(off - 0.5) < 1e-6);
        end(&r);
    }
}

/* An undamped LC circuit with 1 V: v = cos(t). */
static void a_ring_is_shown(void **state) {
    (void)state;
    run r = begin();
    int id;
    assert_int_equal(ns_circuit_capacitor(r.c, "c", 1, 0, 1, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 0, 1, 0, &id), NS_OK);
    prepare(&r, NS_EXACT, 1e-2, 0, 200 * pi);
    r.unknown[r.signals++] = ns_circuit_node_unknown(r.c, 1);
    collect(&r, 200 * pi);
    double worst = 0;
    for (int k = 0; k < 16980; k++) { /* to 200 pi */
        const double t = 0.037 * k;
        worst = fmax(worst, fabs(line_at(&r, 0, t) - cos(t)));
    }
    const ns_waveform_counts c = ns_waveform_read_counts(r.w);
    print_message("%d points for 100 periods, off by %.2g; %g turns in 2 pi; %ld samples\n", r.count, worst,
                  c.turns * 2 * pi, c.samples);
    assert_true(worst < 1.01e-4);
    assert_true(r.count < 100 * 320); /* 2 pi / sqrt(8e-4) = 222 of equal length */
    assert_true(fabs(c.turns * 2 * pi - 2) < 0.1);
    end(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_charging_capacitor_is_within_its_lines),
        cmocka_unit_test(turns_of_a_ring_are_counted),
        cmocka_unit_test(volt_seconds_of_a_spike_are_right),
        cmocka_unit_test(straight_waveforms_have_corners_alone),
        cmocka_unit_test(squares_are_right_on_request),
        cmocka_unit_test(a_ring_is_shown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
