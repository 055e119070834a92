/* tests/reference/test_lit_sliding.c - a buck converter regulated by its own ripple: a comparator of zero
 * width that really slides.
 *
 *   vin --[0 or 3 V]-- L --+-- v        u = 3 V while v < 1.8 V, 0 while v > 1.8 V, no oscillator
 *                          |
 *                   ESR, C |  R         L i' = u - v,   C vC' = i - v/R,   v = (vC + r i) R/(R + r)
 *
 * L = 4 uH, C = 10 uF, R = 10 ohm of the literature's sliding set; r = 0.1 ohm, the capacitor's, lets v
 * follow the switched voltage at once, so that v = 1.8 V attracts from both sides where
 *     0 < u_eq < 3 V,   u_eq = v - L (v - vC)/(r^2 C)
 * (v' = 0: i' = -vC'/r;  C vC' = (v - vC)/r).  There vC' = (v - vC)/(r C): all is at rest within some us.
 * The reference cuts matrix exponentials at the switchings (flow.h).
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "flow.h"
#include "lit_run.h"

static const double vin = 3, vref = 1.8, L = 4e-6, C = 10e-6, R = 10, r = 0.1;
enum { SAMPLES = 60, CURRENT = 0, VOLTAGE };
static const double every = 1e-6, size[2] = {0.5, 1.8};

static double v_of(double i, double vc) {
    return (vc + r * i) * R / (R + r);
}

/* y = v - vref, lambda = u in [0, vin]. */
static ns_system *converter(void) {
    const double k = R / (R + r);
    ns_system *s;
    assert_int_equal(ns_system_create(2, 1, 0, 0, &s), NS_OK);
    s->M[0] = L;
    s->M[3] = C;
    s->A[0] = -k * r;
    s->A[2] = -k;
    s->A[1] = 1 - k * r / R;
    s->A[3] = -k / R;
    s->B[0] = 1;
    s->C[0] = k * r;
    s->C[1] = k;
    s->e[0] = -vref;
    s->u[0] = vin;
    return s;
}

/* --- the reference: x = (i, vC, 1, t) --- */

enum { ON, OFF, SLIDE };

static int slides_at(const double *x) {
    const double u = vref - L * (vref - x[VOLTAGE]) / (r * r * C);
    return u > 0 && u < vin;
}

static int next_mode(int mode, const double *x) {
    const double over = v_of(x[CURRENT], x[VOLTAGE]) - vref;
    if (mode == SLIDE)
        return slides_at(x) ? SLIDE : x[VOLTAGE] < vref ? OFF : ON;
    if ((mode == ON) == (over < 0))
        return mode;
    return slides_at(x) ? SLIDE : over > 0 ? OFF : ON;
}

enum { MOST = 40 };
static struct visit {
    int mode;
    double from;
} visits[MOST]; /* of the reference, in their order */
static int count;

/* x[3] is time. */
static void land(int mode, double *x) {
    if (mode == SLIDE)
        x[CURRENT] = (vref * (R + r) / R - x[VOLTAGE]) / r;
    assert_true(count < MOST);
    visits[count++] = (struct visit){mode, x[3]};
}

/* X: the samples. */
static void exact(double *X) {
    const double k = R / (R + r);
    flow *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->n = 4;
    f->modes = 3;
    for (int mode = ON; mode <= SLIDE; mode++) {
        const double rows[16] = {-k * r / L,
                                 -k / L,
                                 mode == ON ? vin / L : 0,
                                 0,
                                 (1 - k * r / R) / C,
                                 -k / R / C,
                                 0,
                                 0,
                                 0,
                                 0,
                                 0,
                                 0,
                                 0,
                                 0,
                                 1};
        double *A = f->A[mode];
        memcpy(A, rows, sizeof rows);
        for (int j = 0; j < 4 && mode == SLIDE; j++)
            A[j] = -A[4 + j] / r;
    }
    f->dt = 10e-9;
    f->next = next_mode;
    f->land = land;
    flow_prepare(f);
    double x[FLOW_N] = {0, 0, 1, 0};
    int mode = ON;
    visits[0] = (struct visit){ON, 0};
    count = 1;
    for (int n = 0; n < SAMPLES; n++) {
        flow_run(f, lround(every / f->dt), &mode, x);
        memcpy(X + 2 * n, x, sizeof(double) * 2);
    }
    free(f);
}

/* --- steps of h --- */

typedef struct found {
    double arrival;              /* the end of the first of the steps that all slide */
    double before, after, law;   /* largest errors: of x, until and from 1 us after the arrival; of u */
    long changes, while_sliding; /* of the mode: before, after it */
} found;

static double worst_of(const double *x, const double *exactly) {
    return fmax(fabs(x[0] - exactly[0]) / size[0], fabs(x[1] - exactly[1]) / size[1]);
}

static found run(const ns_system *s, double h, const double *X, double arrival) {
    const ns_theta_options o = {1, 1, 0};
    static const double rest[2] = {0};
    found f = {0};
    ns_theta *t;
    ns_mode before = NS_UPPER;
    const long steps = lround(every / h);
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, rest, NULL), NS_OK);
    for (long k = 1; k <= SAMPLES * steps; k++) {
        double x[2], u;
        assert_int_equal(ns_theta_try(t, h, NULL, 0, NS_RESOLVE), NS_OK);
        assert_int_equal(ns_theta_accept(t), NS_OK);
        assert_int_equal(ns_theta_read(t, x, &u, NULL), NS_OK);
        const double now = (double)k * h;
        const ns_mode mode = ns_theta_mode(t)[0];
        const int settled = now > arrival + 1e-6;
        *(settled ? &f.while_sliding : &f.changes) += mode != before;
        if (mode != before && mode == NS_INSIDE)
            f.arrival = now;
        if (settled) {
            assert_true(fabs(v_of(x[0], x[1]) - vref) < 1e-12);
            f.law = fmax(f.law, fabs(u - vref + L * (vref - x[1]) / (r * r * C)));
        }
        if (k % steps == 0)
            *(settled ? &f.after : &f.before) =
                fmax(settled ? f.after : f.before, worst_of(x, X + 2 * (k / steps - 1)));
        before = mode;
    }
    ns_theta_free(t);
    return f;
}

static void it_slides_as_h_goes_to_0(void **state) {
    (void)state;
    enum { LENGTHS = 4 };
    static const char *const names[] = {"on", "off", "slides"};
    double X[2 * SAMPLES];
    ns_system *s = converter();
    exact(X);
    print_message("buck regulated by its ripple, zero width, exact:");
    for (int k = 0; k < count; k++)
        print_message(" %s from %.2f us%s", names[visits[k].mode], visits[k].from * 1e6,
                      k + 1 < count ? "," : "\n");
    const double arrival = visits[count - 1].from;
    assert_true(visits[count - 1].mode == SLIDE && count > 3);
    print_message("    h / ns   slides from / us   i, v off before   after      u_eq off / V   mode changes "
                  "before   while it slides\n");
    found f[LENGTHS];
    for (int k = 0; k < LENGTHS; k++) {
        const double h = 12.5e-9 / pow(4, k);
        f[k] = run(s, every / round(every / h), X, arrival);
        print_message("    %-6.3g   %-16.3f   %.2e          %.2e   %.2e       %-19ld   %ld\n", h * 1e9,
                      f[k].arrival * 1e6, f[k].before, f[k].after, f[k].law, f[k].changes,
                      f[k].while_sliding);
        assert_int_equal(f[k].while_sliding, 0);
        assert_true(f[k].changes <= 2 * count); /* a step may end at the threshold between two modes */
    }
    /* First order, each switching being caught somewhere in a step; over 64 in h, so to two tenths. */
    const double orders[] = {log2((arrival - f[0].arrival) / (arrival - f[LENGTHS - 1].arrival)) /
                                 (2 * (LENGTHS - 1)),
                             log2(f[0].before / f[LENGTHS - 1].before) / (2 * (LENGTHS - 1)),
                             log2(f[0].after / f[LENGTHS - 1].after) / (2 * (LENGTHS - 1))};
    print_message("    orders: arrival %.2f, before %.2f, after %.2f\n", orders[0], orders[1], orders[2]);
    for (int k = 0; k < 3; k++)
        assert_true(orders[k] > 0.8);
    ns_system_free(s);
}

/* The marcher meets each mode once. */
static void located(void **state) {
    (void)state;
    double X[2 * SAMPLES], Y[2 * SAMPLES], worst[2] = {0};
    static const double rest[2] = {0};
    ns_system *s = converter();
    exact(X);
    ns_counts counts;
    for (int k = 0; k < 2; k++) {
        const lit_plan plan = {0.5, 0.5, k ? 12.5e-9 : 50e-9, every, SAMPLES};
        assert_int_equal(lit_march(s, rest, &plan, Y, &counts), NS_OK);
        for (int i = 0; i < SAMPLES; i++)
            worst[k] = fmax(worst[k], worst_of(Y + 2 * i, X + 2 * i));
        print_message("located, theta = gamma = 1/2, h = %g ns: i, v off by %.2e, %ld events for %d modes\n",
                      plan.h * 1e9, worst[k], counts.events, count);
    }
    assert_true(worst[1] < worst[0] / 10); /* second order: 16 */
    assert_in_range(counts.events, count - 1, count + 1);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_slides_as_h_goes_to_0),
        cmocka_unit_test(located),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
