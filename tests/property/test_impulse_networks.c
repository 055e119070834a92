/* tests/property/test_impulse_networks.c - the impulse problem of random networks.
 *
 * What holds for every jump of a network of R, L, C, K, sources, ideal diodes and switches:
 *   - no charge leaves a set of nodes that nothing but R, L and capacitors joins to others;
 *   - around every loop fluxes add up to zero: an inductor's flux changes by the difference of the impulses
 * of its nodes' voltages, and nothing else but a blocking device bears such a difference;
 *   - (Carnot) impulses of currents satisfy KCL, voltages at t+ KVL, so by Tellegen's theorem
 *         sum C (v+ - v-) v+ = sum over sources of charge times voltage   (0 without sources)
 *     and the energy lost is that of the differences,  sum C (v+ - v-)^2/2;  of inductors likewise, with
 *     currents at t+ and impulses of voltages;
 *   - x+ obeys every algebraic equation and every law of a device;
 *   - steps with theta = gamma = 1 of length h tend to it, linearly in h.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "net.h"

enum { NODES = 7, RUNS = 1000 };

typedef enum kind { RES, CAP, IND, DIODE, CONTACT } kind;

typedef struct element {
    kind kind;
    int p, n, id, closed;
    double value, ic;
} element;

enum { ELEMENTS = 12 };

static unsigned long seed;
static unsigned draw(unsigned below) { /* Knuth's MMIX generator, high bits */
    seed = seed * 6364136223846793005ul + 1442695040888963407ul;
    return (unsigned)(seed >> 33) % below;
}

static void random_network(element *e) {
    static const kind often[12] = {RES, RES, CAP, CAP, CAP, IND, IND, DIODE, DIODE, DIODE, CONTACT, CONTACT};
    for (int k = 0; k < ELEMENTS; k++) {
        e[k].kind = k == 0 ? CAP : k < 3 ? IND : often[draw(12)];
        e[k].p = (int)draw(NODES);
        do
            e[k].n = (int)draw(NODES);
        while (e[k].n == e[k].p);
        const double size = pow(10, (double)draw(7) - 3); /* 0.001 .. 1000 */
        e[k].value = e[k].kind == RES ? 100 * size : e[k].kind == CAP ? 1e-6 * size : 1e-3 * size;
        e[k].ic = e[k].kind == CAP   ? (double)draw(20) - 10
                  : e[k].kind == IND ? ((double)draw(20) - 10) / 10
                                     : 0;
        e[k].closed = (int)draw(2);
    }
}

static double coupling; /* of the first two inductors */

static void build(net *k, element *e) {
    for (int i = 0; i < ELEMENTS; i++) {
        char name[16];
        snprintf(name, sizeof name, "e%d", i);
        const int p = e[i].p, n = e[i].n;
        e[i].id = e[i].kind == RES     ? net_resistor(k, name, p, n, e[i].value)
                  : e[i].kind == CAP   ? net_capacitor(k, name, p, n, e[i].value, e[i].ic)
                  : e[i].kind == IND   ? net_inductor(k, name, p, n, e[i].value, e[i].ic)
                  : e[i].kind == DIODE ? net_diode(k, name, p, n)
                                       : net_contact(k, name, p, n, e[i].closed);
    }
    if (coupling != 0)
        assert_int_equal(ns_circuit_coupling(k->c, "k", e[1].id, e[2].id, coupling, NULL), NS_OK);
}

static double across(const net *k, const element *e, const double *x) {
    return net_voltage_of(k, x, e->p) - net_voltage_of(k, x, e->n);
}

typedef struct sums {
    double charge, flux, energy; /* C, Wb, J: sizes of what is summed up */
    double before, after, lost;  /* J */
    double psi[ELEMENTS];        /* Wb: by how much an inductor's flux changes */
} sums;

/* Of an element's nodes: x holds their voltages, and rounding of those is what a capacitor's voltage has. */
static double high(const net *k, const element *e, const double *x) {
    return fabs(net_voltage_of(k, x, e->p)) + fabs(net_voltage_of(k, x, e->n));
}

static sums add_up(const net *k, const element *e) {
    sums t = {0};
    double i0[ELEMENTS] = {0}, i1[ELEMENTS] = {0};
    for (int j = 0; j < ELEMENTS; j++) {
        const double v = e[j].value;
        if (e[j].kind == CAP) {
            const double v1 = across(k, &e[j], k->x), v0 = e[j].ic, volts = fabs(v0) + high(k, &e[j], k->x);
            t.charge += v * volts;
            t.energy += v * (fabs(v0) + fabs(v1)) * volts;
            t.before += v * v0 * v0 / 2;
            t.after += v * v1 * v1 / 2;
            t.lost += v * (v1 - v0) * (v1 - v0) / 2;
        } else if (e[j].kind == IND) {
            i0[j] = e[j].ic;
            i1[j] = net_current_of(k, k->x, e[j].id);
        }
        t.flux += high(k, &e[j], k->X);
    }
    const double mutual = coupling * sqrt(e[1].value * e[2].value);
    for (int j = 0; j < ELEMENTS; j++) {
        const int other = j == 1 ? 2 : 1;
        const double m = j == 1 || j == 2 ? mutual : 0;
        if (e[j].kind != IND)
            continue;
        t.flux += e[j].value * (fabs(i0[j]) + fabs(i1[j]));
        t.psi[j] = e[j].value * (i1[j] - i0[j]) + m * (i1[other] - i0[other]);
        t.energy += e[j].value * (i0[j] * i0[j] + i1[j] * i1[j]) / 2;
        t.before += i0[j] * (e[j].value * i0[j] + m * i0[other]) / 2;
        t.after += i1[j] * (e[j].value * i1[j] + m * i1[other]) / 2;
        t.lost += (i1[j] - i0[j]) * t.psi[j] / 2;
    }
    return t;
}

/* The largest charge that an isolated set of nodes gains: sets are what diodes and closed switches join
 * (and windings without stray flux, which pass charge on). */
static double gained(const net *k, const element *e) {
    int set[NODES];
    double worst = 0;
    for (int i = 0; i < NODES; i++)
        set[i] = i;
    for (int round = 0; round < NODES; round++)
        for (int j = 0; j < ELEMENTS; j++)
            if (e[j].kind == DIODE || (e[j].kind == CONTACT && e[j].closed) ||
                (coupling == 1 && (j == 1 || j == 2))) {
                const int low = set[e[j].p] < set[e[j].n] ? set[e[j].p] : set[e[j].n];
                set[e[j].p] = set[e[j].n] = low;
            }
    for (int i = 1; i < NODES; i++) { /* that of ground may gain: set 0 */
        double q = 0;
        for (int j = 0; j < ELEMENTS; j++)
            if (e[j].kind == CAP)
                q += e[j].value * (across(k, &e[j], k->x) - e[j].ic) *
                     ((set[e[j].p] == i) - (set[e[j].n] == i));
        worst = fmax(worst, fabs(q));
    }
    return worst;
}

/* By how much an impulse of voltage misses what its element bears, relative to all flux there is. */
static double strayed(const net *k, const element *e, const sums *t) {
    double worst = 0;
    for (int j = 0; j < ELEMENTS; j++) {
        const double u = across(k, &e[j], k->X);
        const double off = e[j].kind == IND                       ? u - t->psi[j]
                           : e[j].kind == CAP || e[j].kind == RES ? u
                           : e[j].kind == CONTACT && e[j].closed  ? u
                           : e[j].kind == DIODE                   ? fmax(u, 0)
                                                                  : 0;
        if (off != 0)
            worst = fmax(worst, fabs(off) / t->flux);
    }
    return worst;
}

/* By how much a diode misses its law: forward voltage after the jump, charge that goes back. */
static double missed(const net *k, const element *e, const sums *t) {
    double worst = 0, most = 0;
    for (int j = 0; j < ELEMENTS; j++)
        most = fmax(most, high(k, &e[j], k->x) + (e[j].kind == CAP ? fabs(e[j].ic) : 0));
    for (int j = 0; j < ELEMENTS; j++) {
        if (e[j].kind != DIODE)
            continue;
        const double volts = across(k, &e[j], k->x), back = -net_device_of(k, k->X, k->Lambda, e[j].id);
        if (volts > 0 && across(k, &e[j], k->X) >= -1e-12 * t->flux)
            worst = fmax(worst, volts / (most + 10)); /* V: networks are drawn with 10 V and 1 A */
        if (back > 0)
            worst = fmax(worst, back / t->charge);
    }
    return worst;
}

/* Row i of A x + b + E z + B lambda; *size: the sizes of its terms. */
static double row_of(const net *k, int i, double *size) {
    const ns_system *s = k->s;
    double sum = s->b[i];
    *size = fabs(sum);
    for (int j = 0; j < s->n + s->m + s->nz; j++) {
        const int l = j - s->n, in = l - s->m;
        const double v = l < 0    ? s->A[i + j * s->n] * k->x[j]
                         : in < 0 ? s->B[i + l * s->n] * k->lambda[l]
                                  : s->E[i + in * s->n] * k->z[in];
        sum += v;
        *size += fabs(v);
    }
    return sum;
}

/* Algebraic rows of (S1) at x+, relative to their terms, or to a thousandth of the largest there are. */
static double algebraic(const net *k) {
    static double T[NET_MOST * NET_MOST];
    const int n = k->s->n;
    int rank;
    double sum[NET_MOST] = {0}, terms[NET_MOST] = {0}, worst = 0, most = 0;
    assert_int_equal(ns_system_split(k->s, T, &rank), NS_OK);
    for (int i = rank; i < n; i++) {
        for (int p = 0; p < n; p++) {
            double size;
            const double row = row_of(k, p, &size);
            sum[i] += T[i + p * n] * row;
            terms[i] += fabs(T[i + p * n]) * size;
        }
        most = fmax(most, terms[i]);
    }
    for (int i = rank; i < n; i++)
        worst = fmax(worst, fabs(sum[i]) /
                                (terms[i] + 1e-3 * most + 1e-6)); /* A or V: the networks have 0.1 and 1 */
    return worst;
}

/* How far a step of length h ends from w+, relative; -1 if it is refused. */
static double distance(net *k, double h) {
    double x[NET_MOST], worst = 0;
    static double w[NET_MOST];
    assert_int_equal(ns_theta_start(k->step, k->w0, k->closed), NS_OK);
    if (ns_theta_try(k->step, h, k->z, 1, NS_RESOLVE) != NS_OK)
        return -1;
    assert_int_equal(ns_theta_accept(k->step), NS_OK);
    assert_int_equal(ns_theta_read(k->step, x, NULL, NULL), NS_OK);
    for (int i = 0; i < k->s->n; i++) {
        double size = 0;
        w[i] = 0;
        for (int j = 0; j < k->s->n; j++) {
            w[i] += k->s->M[i + j * k->s->n] * x[j];
            size += fabs(k->s->M[i + j * k->s->n] * k->x[j]);
        }
        if (size > 0)
            worst = fmax(worst, fabs(w[i] - k->w[i]) / (size + fabs(k->w0[i])));
    }
    return worst;
}

typedef struct tally {
    int refused, jumped, linear, steps;
    double charge, flux, energy, law, rows, growth;
} tally;

static void look(const net *k, const element *e, tally *t) {
    const sums s = add_up(k, e);
    t->charge = fmax(t->charge, gained(k, e) / s.charge);
    t->flux = fmax(t->flux, strayed(k, e, &s));
    t->energy = fmax(t->energy, fabs(s.before - s.after - s.lost) / s.energy);
    t->growth = fmax(t->growth, (s.after - s.before) / s.energy);
    t->law = fmax(t->law, missed(k, e, &s));
    t->rows = fmax(t->rows, algebraic(k));
    t->jumped += s.lost > 1e-9 * s.energy;
}

/* Lengths at which what flows in a step is seen beside rounding and is small still. */
static void compare_with_steps(net *k, tally *t) {
    const double a = distance(k, 1024 * k->h), b = distance(k, 64 * k->h);
    if (!(a > 1e-9) || b < 0)
        return;
    t->steps++;
    t->linear += b < a / 12 && b > a / 20;
}

/* Values over six decades.  Everything is relative to the sizes of what is summed up: charge to C (|v-| +
 * that of both nodes), energy to that times the voltage, flux to all of it. */
static void random_networks(void **state) {
    coupling = *(double *)*state;
    tally t = {0};
    for (int run = 0; run < RUNS; run++) {
        element e[ELEMENTS];
        seed = 5000 + (unsigned)run;
        random_network(e);
        net k = net_begin();
        build(&k, e);
        net_prepare(&k);
        const int status = net_jump(&k, NULL);
        t.refused += status != NS_OK;
        if (status == NS_OK) {
            look(&k, e, &t);
            compare_with_steps(&k, &t);
        }
        net_end(&k);
    }
    print_message(
        "K %g: %d networks, %d jumped, %d refused; charge %.1e, flux %.1e, energy %.1e (growth %.1e), "
        "laws %.1e, rows %.1e; %d of %d steps linear in h\n",
        coupling, RUNS, t.jumped, t.refused, t.charge, t.flux, t.energy, t.growth, t.law, t.rows, t.linear,
        t.steps);
    assert_true(t.jumped > RUNS / 2 && t.steps > RUNS / 4);
    assert_int_equal(t.refused, 0);
    assert_true(t.charge <= 1e-12 && t.flux <= 1e-12 && t.energy <= 1e-12 && t.growth <= 1e-12);
    assert_true(t.law <= 1e-12 && t.rows <= 1e-12);
    assert_true(t.linear >= t.steps - t.steps / 10);
}

int main(void) {
    static double loose = 0, half = 0.5, tight = 1;
    const struct CMUnitTest tests[] = {
        {"random networks, no coupling", random_networks, NULL, NULL, &loose},
        {"random networks, K = 0.5", random_networks, NULL, NULL, &half},
        {"random networks, K = 1", random_networks, NULL, NULL, &tight},
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
