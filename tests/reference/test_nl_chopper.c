/* tests/reference/test_nl_chopper.c - the chopper of the literature: a switch and a diode as resistances that
 * take 1 mohm, 1 kohm, or anything between exactly at their threshold.
 *
 * 20 V, switch to node 3 (closed where v5 > v4), diode 0 -> 3, 200 uH to node 4, 1 ohm; v5 a sawtooth that
 * falls from 7.5 V to -2.5 V in 20 us.  With x = i_L and the unknowns (v3, i_s, i_d, r_s, r_d; p_s, n_s, p_d,
 * n_d):
 *
 *     L x' = v3 - R x
 *     0 = 20 - v3 - r_s i_s,   0 = -v3 - r_d i_d,   0 = i_s + i_d - x                (products of unknowns)
 *     0 = (v5 - R x) - p_s + n_s,   0 = -v3 - p_d + n_d
 *     0 <= p _|_ r - 1 mohm >= 0,   0 <= n _|_ 1 kohm - r >= 0                       (for each of the two)
 *
 * five equalities and four pairs.  Between switchings it is a line:  L x' = v_th - (r_th + R) x, with v_th,
 * r_th those of the two resistances in parallel (1 mohm to 20 V, 1 kohm to 0; or the reverse), an
 * exponential.
 *
 * Where v5 = v4 a resistance between makes R x follow v5 as long as v5' lies between the slopes of v4 with
 * the switch open and closed, -R x/(L/R) and (20 V - R x)/(L/R).  The published sawtooth never slides: it
 * falls by 0.5 V/us, v4 by no more than 7.5 V/200 us = 0.04 V/us.  (It comes from P. Maffezzoni and others,
 * 2006, where switch and diode commutate at one instant and Newton's method on the discontinuous circuit
 * cycles.)  A step of h may end exactly at the threshold, though, and three of the 2000 of 0.1 us do.  A
 * sawtooth a hundred times slower, 0.005 V/us, slides.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double vin = 20, L = 200e-6, R = 1, low = 1e-3, high = 1e3;
static const double period = 20e-6, slow = 2e-3; /* of the sawtooth */
enum { V3, IS, ID, RS, RD, PS, NS, PD, ND, COUNT };

static int f(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = -R * p->x[0];
    return 0;
}

static int A(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    out[0] = -R;
    return 0;
}

static int g(const ns_point *p, void *data, double *out) {
    (void)data;
    out[0] = p->lambda[V3];
    return 0;
}

static int B(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    for (int j = 0; j < COUNT; j++)
        out[j] = j == V3;
    return 0;
}

static int h(const ns_point *p, void *data, double *out) {
    const double *v = p->lambda;
    (void)data;
    out[0] = vin - v[V3] - v[RS] * v[IS];
    out[1] = -v[V3] - v[RD] * v[ID];
    out[2] = v[IS] + v[ID] - p->x[0];
    out[3] = p->z[0] - R * p->x[0] - v[PS] + v[NS];
    out[4] = -v[V3] - v[PD] + v[ND];
    out[PS] = v[RS] - low;
    out[NS] = high - v[RS];
    out[PD] = v[RD] - low;
    out[ND] = high - v[RD];
    return 0;
}

static int C(const ns_point *p, void *data, double *out) {
    (void)p;
    (void)data;
    for (int i = 0; i < COUNT; i++)
        out[i] = i == 2 ? -1 : i == 3 ? -R : 0;
    return 0;
}

static int D(const ns_point *p, void *data, double *out) {
    const double *v = p->lambda;
    (void)data;
    for (int i = 0; i < COUNT * COUNT; i++)
        out[i] = 0;
    out[0 + V3 * COUNT] = out[1 + V3 * COUNT] = out[4 + V3 * COUNT] = -1;
    out[0 + RS * COUNT] = -v[IS];
    out[0 + IS * COUNT] = -v[RS];
    out[1 + RD * COUNT] = -v[ID];
    out[1 + ID * COUNT] = -v[RD];
    out[2 + IS * COUNT] = out[2 + ID * COUNT] = 1;
    out[3 + PS * COUNT] = out[4 + PD * COUNT] = -1;
    out[3 + NS * COUNT] = out[4 + ND * COUNT] = 1;
    out[PS + RS * COUNT] = out[PD + RD * COUNT] = 1;
    out[NS + RS * COUNT] = out[ND + RD * COUNT] = -1;
    return 0;
}

static double ramp(double t, double length) {
    return 7.5 - 10 * (t / length - floor(t / length));
}

/* at, volts: room for two. */
static ns_signal sawtooth(double length, double *at, double *volts) {
    ns_signal s = {.kind = NS_PWL};
    at[0] = 0;
    at[1] = length;
    volts[0] = 7.5;
    volts[1] = -2.5;
    s.u.pwl.n = 2;
    s.u.pwl.t = at;
    s.u.pwl.v = volts;
    s.u.pwl.repeat = 0;
    return s;
}

static const double l[COUNT] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY, -INFINITY, 0, 0, 0, 0};
static const double u[COUNT] = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY,
                                INFINITY, INFINITY, INFINITY, INFINITY};

static ns_model chopper(const ns_signal *z) {
    const ns_model model = {.n = 1,
                            .m = COUNT,
                            .nz = 1,
                            .M = &L,
                            .l = l,
                            .u = u,
                            .z = z,
                            .f = f,
                            .A = A,
                            .g = g,
                            .B = B,
                            .h = h,
                            .C = C,
                            .D = D};
    return model;
}

/* i after dt with the switch closed or open. */
static double flow(double i, int closed, double dt) {
    const double gs = closed ? 1 / low : 1 / high, gd = closed ? 1 / high : 1 / low;
    const double vth = vin * gs / (gs + gd), r = 1 / (gs + gd) + R, rest = vth / r;
    return rest + (i - rest) * exp(-dt * r / L);
}

/* i at t (a whole number of periods and something), from 0 A at 0. */
static double exact(double t) {
    double i = 0;
    for (int p = 0; p * period < t; p++) {
        const double start = p * period;
        double a = 0, b = period;
        for (int k = 0; k < 60; k++) { /* closed until v5 = v4 */
            const double mid = (a + b) / 2;
            *(7.5 - 10 * mid / period > R * flow(i, 1, mid) ? &a : &b) = mid;
        }
        const double end = fmin(period, t - start);
        i = end <= a ? flow(i, 1, end) : flow(flow(i, 1, a), 0, end - a);
    }
    return i;
}

/* --- Newton's steps --- */

typedef struct run {
    ns_signal z;
    ns_model model;
    double at[2], volts[2], t, x, v[COUNT];
    ns_newton *s;
} run;

static void run_start(run *r, double length) {
    static const double x0 = 0, closed[COUNT] = {20, 0.02, -0.02, 1e-3, 1e3, 7.5, 0, 0, 20};
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    r->z = sawtooth(length, r->at, r->volts);
    r->model = chopper(&r->z);
    assert_int_equal(ns_newton_create(&r->model, &o, &r->s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(r->s, 0, &x0, closed), NS_OK);
}

/* To t in one step (fewer only if Newton's loop needs it), and what always holds. */
static void run_step(run *r, double t, double h) {
    double *v = r->v;
    r->t = t;
    assert_int_equal(ns_newton_advance(r->s, t, h), NS_OK);
    assert_int_equal(ns_newton_read(r->s, NULL, &r->x, v, NULL, NULL), NS_OK);
    assert_true(v[RS] >= low * (1 - 1e-9) && v[RS] <= high * (1 + 1e-9));
    assert_true(v[RD] >= low * (1 - 1e-9) && v[RD] <= high * (1 + 1e-9));
    assert_true(fabs(vin - v[V3] - v[RS] * v[IS]) < 1e-9 * vin);
}

static int between(double r) {
    return r > low * (1 + 1e-6) && r < high * (1 - 1e-6);
}

static void jacobians(void **state) {
    (void)state;
    double at[2], volts[2];
    const ns_signal z = sawtooth(period, at, volts);
    const ns_model model = chopper(&z);
    ns_jacobian_error worst;
    const double x = 3, lambda[COUNT] = {5, 2, 1, 0.5, 7, 1, 2, 3, 4};
    assert_int_equal(ns_model_check_jacobians(&model, 1e-6, &x, lambda, &worst), NS_OK);
    assert_true(worst.error < 1e-6);
}

/* The largest error of i in 200 us; *iterations: of Newton, a step. */
static double error(double h, double *iterations) {
    run r;
    double worst = 0;
    run_start(&r, period);
    const int steps = (int)lround(200e-6 / h);
    for (int k = 1; k <= steps; k++) {
        run_step(&r, k * h, h);
        const double v5 = ramp(r.t, period);
        if (fabs(v5 - R * r.x) > 0.2 && v5 < 7) /* away from thresholds: low or high */
            assert_true(v5 > R * r.x ? r.v[RS] < 2 * low : r.v[RS] > high / 2);
        worst = fmax(worst, fabs(r.x - exact(r.t)));
    }
    const ns_newton_counts *c = ns_newton_counts_of(r.s);
    *iterations = (double)c->iterations / (double)c->steps;
    ns_newton_free(r.s);
    return worst;
}

/* Two instants a period, the jump of v5 and its way down through v4, are missed by up to h each: 20 V / 200
 * uH makes 0.01 A of 0.1 us, 0.02 A of both. */
static void as_the_lines_say(void **state) {
    (void)state;
    double n1 = 0, n2 = 0;
    const double a = error(0.1e-6, &n1), b = error(0.0125e-6, &n2);
    print_message("20 us sawtooth, against exponentials cut at the switchings, 0..200 us:\n"
                  "    h          i off by   Newton iterations a step\n"
                  "    100 ns     %.2e A   %.2f\n    12.5 ns    %.2e A   %.2f\n",
                  a, n1, b, n2);
    assert_true(a < 0.02);
    assert_true(b < a / 4);
}

/* What the Siconos platform's example of this circuit ships as its reference, 2000 implicit steps of 0.1 us:
 * i_L at the end of each period (its ten digits), and v3, i_s of the three steps that end at the threshold:
 * there r_s = (20 V - v3)/i_s. */
static void as_published(void **state) {
    (void)state;
    static const double published[10] = {1.166787738, 2.049913619, 2.706331326, 3.205062413, 3.572368154,
                                         3.848488068, 4.060935176, 4.215847801, 4.328902056, 4.417573617};
    static const struct {
        int step;
        double v3, is;
    } at_threshold[3] = {
        {682, 18.51751457, 3.418517515}, {1657, 1.762973226, 4.651762973}, {1855, 12.47761627, 4.762477616}};
    run r;
    int found = 0;
    double worst = 0;
    run_start(&r, period);
    print_message("20 us sawtooth, h = 100 ns, against the published run:\n"
                  "    t / us   what        published     ours\n");
    for (int k = 1; k <= 2000; k++) {
        run_step(&r, k * 1e-7, 1e-7);
        if (k % 200 == 0) {
            worst = fmax(worst, fabs(r.x - published[k / 200 - 1]));
            print_message("    %-6g   i_L / A     %.9f   %.9f\n", k * 0.1, published[k / 200 - 1], r.x);
        }
        if (!between(r.v[RS]))
            continue;
        assert_true(found < 3 && k == at_threshold[found].step);
        const double rs = (vin - at_threshold[found].v3) / at_threshold[found].is;
        print_message("    %-6g   r_s / ohm   %.7f     %.7f\n", k * 0.1, rs, r.v[RS]);
        assert_true(fabs(r.v[RS] - rs) < 1e-7 * rs); /* of its digits: 5e-9 / 1.5 */
        assert_true(fabs(R * r.x - ramp(r.t, period)) < 1e-9);
        found++;
    }
    print_message("    largest difference of i_L: %.1e A; steps at the threshold: %d\n", worst, found);
    assert_true(worst < 1e-8); /* its Newton stops at 1e-11 of residuals in volts and ohms */
    assert_int_equal(found, 3);
    ns_newton_free(r.s);
}

/* --- the slow sawtooth --- */

/* R x = v5 = v4 from the instant of arrival on; so x' = v5'/R and v3 = v5 - L/R 5000 V/s = v5 - 1 V, held up
 * by the switch alone until v3 < 0, then a little by the diode, until r_s is 1 kohm:
 *     v5/R = (20 V - v3)/1 kohm - v3/1 mohm. */
typedef struct slide {
    double from, to, sink; /* sink: v4 - v3 */
} slide;

static slide slide_exact(void) {
    slide s = {.sink = L / R * 10 / slow};
    double a = 0, b = slow;
    for (int k = 0; k < 60; k++) {
        const double mid = (a + b) / 2;
        *(ramp(mid, slow) > R * flow(0, 1, mid) ? &a : &b) = mid;
    }
    s.from = a;
    const double v5 = (s.sink * (1 / low + 1 / high) + vin / high) / (1 / R + 1 / low + 1 / high);
    s.to = (7.5 - v5) * slow / 10;
    return s;
}

static double slow_exact(const slide *s, double t) {
    if (t <= s->from)
        return flow(0, 1, t);
    return t <= s->to ? ramp(t, slow) / R : flow(ramp(s->to, slow) / R, 0, t - s->to);
}

typedef struct slid {
    double before, inside, after, law; /* largest errors of x; of r_s, relative, while it slides */
    long steps, others;                /* of the slide: at the threshold; not */
} slid;

static slid run_slow(double h) {
    const slide s = slide_exact();
    slid found = {0};
    run r;
    run_start(&r, slow);
    const int steps = (int)lround(slow / h);
    for (int k = 1; k < steps; k++) {
        run_step(&r, k * h, h);
        const double off = fabs(r.x - slow_exact(&s, r.t)), v3 = ramp(r.t, slow) - s.sink;
        if (r.t <= s.from)
            found.before = fmax(found.before, off);
        else if (r.t >= s.to)
            found.after = fmax(found.after, off);
        else if (r.t > s.from + 2 * h) { /* the step that arrives takes what is left */
            found.inside = fmax(found.inside, off);
            found.steps += between(r.v[RS]);
            found.others += !between(r.v[RS]);
            if (v3 > 0.01) {
                const double rs = (vin - v3) / (ramp(r.t, slow) / R + v3 / high);
                found.law = fmax(found.law, fabs(r.v[RS] / rs - 1));
            }
        }
    }
    ns_newton_free(r.s);
    return found;
}

/* Before and after: first order.  On the slide an implicit step is exact, v5 being straight. */
static void a_slow_sawtooth_slides(void **state) {
    (void)state;
    const slide s = slide_exact();
    slid found[3];
    print_message(
        "2 ms sawtooth: slides from %.3f us to %.3f us (exact)\n"
        "    h / us   i off before   while it slides   after      r_s off    steps that slide   that "
        "do not\n",
        s.from * 1e6, s.to * 1e6);
    for (int k = 0; k < 3; k++) {
        const double h = 2e-6 / (1 << 2 * k);
        const slid *f = &found[k];
        found[k] = run_slow(h);
        print_message("    %-6g   %.2e A     %.2e A        %.2e A %.1e    %-16ld   %ld\n", h * 1e6, f->before,
                      f->inside, f->after, f->law, f->steps, f->others);
        assert_true(f->inside < 1e-9 && f->law < 1e-6); /* v3 = L (x+ - x)/h: 1e-12 of 7 A, over h/L */
        assert_true(f->others == 0 && (double)f->steps > 1000e-6 / h);
    }
    assert_true(found[0].before / found[2].before > 14 && found[0].after / found[2].after > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jacobians),
        cmocka_unit_test(as_the_lines_say),
        cmocka_unit_test(as_published),
        cmocka_unit_test(a_slow_sawtooth_slides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
