/* tests/property/test_impulse.c - the impulse problem: jumps with closed forms, then random networks.
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
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { NODES = 7, MOST = 40, RUNS = 1500 };

typedef struct net {
    ns_circuit *c;
    ns_system *s;
    ns_theta *step;
    unsigned char closed[MOST];
    int switches;
    double w0[MOST], z[MOST];
    double x[MOST], lambda[MOST], y[MOST], X[MOST], Lambda[MOST], Y[MOST], w[MOST], h;
    ns_mode mode[MOST];
} net;

static const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
static const ns_switch toggle = {0.5, 0, 0, INFINITY};

static net begin(void) {
    net k = {0};
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    return k;
}

static void end(net *k) {
    ns_theta_free(k->step);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
}

static int capacitor(net *k, const char *name, int p, int n, double c, double v) {
    int id;
    assert_int_equal(ns_circuit_capacitor(k->c, name, p, n, c, v, &id), NS_OK);
    return id;
}

static int inductor(net *k, const char *name, int p, int n, double l, double i) {
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, name, p, n, l, i, &id), NS_OK);
    return id;
}

static int resistor(net *k, const char *name, int p, int n, double r) {
    int id;
    assert_int_equal(ns_circuit_resistor(k->c, name, p, n, r, &id), NS_OK);
    return id;
}

static int diode(net *k, const char *name, int p, int n) {
    int id;
    assert_int_equal(ns_circuit_diode(k->c, name, p, n, &ideal, &id), NS_OK);
    return id;
}

static int voltage(net *k, const char *name, int p, int n, double v) {
    int id;
    ns_signal s = {.kind = NS_PWL}; /* an input; one that stands still would be a constant of the system */
    const double at[2] = {1, 2}, volts[2] = {v, v + 1};
    s.u.pwl.n = 2;
    s.u.pwl.t = at;
    s.u.pwl.v = volts;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, p, n, &s, &id), NS_OK);
    return id;
}

/* Its gate is a node of its own that drives nothing else. */
static int contact(net *k, const char *name, int p, int n, int closed) {
    char gate[16];
    int id;
    snprintf(gate, sizeof gate, "g%s", name);
    voltage(k, gate, 100 + k->switches, 0, closed);
    assert_int_equal(ns_circuit_switch(k->c, name, p, n, 100 + k->switches, 0, &toggle, &id), NS_OK);
    k->closed[k->switches++] = (unsigned char)closed;
    return id;
}

static void prepare(net *k) {
    static const ns_theta_options o = {1, 1, 0};
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    assert_true(k->s->n <= MOST && k->s->m <= MOST && k->s->nz <= MOST);
    assert_int_equal(ns_theta_create(k->s, &o, &k->step, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(k->c, k->w0), NS_OK);
    assert_int_equal(ns_theta_start(k->step, k->w0, k->closed), NS_OK);
    ns_system_inputs(k->s, 0, NS_RIGHT, k->z);
}

static int jump(net *k, const double *slope) {
    const ns_impulse out = {.w = k->w,
                            .x = k->x,
                            .lambda = k->lambda,
                            .y = k->y,
                            .X = k->X,
                            .Lambda = k->Lambda,
                            .Y = k->Y,
                            .mode = k->mode,
                            .h = &k->h};
    return ns_theta_impulse(k->step, k->z, slope, &out);
}

static void jumps(net *k) {
    prepare(k);
    assert_int_equal(jump(k, NULL), NS_OK);
}

static double of_node(const net *k, const double *x, int node) {
    const int i = ns_circuit_node_unknown(k->c, node);
    return i < 0 ? 0 : x[i];
}

static double of_current(const net *k, const double *x, int id) {
    return x[ns_circuit_current_unknown(k->c, id)];
}

/* Current of a device in lambda, or its charge in Lambda. */
static double of_device(const net *k, const double *x, const double *lambda, int id) {
    double i;
    assert_int_equal(ns_circuit_device(k->c, id, x, lambda, k->mode, &i, NULL, NULL), NS_OK);
    return i;
}

/* Rounding of a handful of operations. */
static void near(double got, double expected, double scale) {
    if (!(fabs(got - expected) <= 1e-12 * scale))
        print_message("got %.17g, expected %.17g\n", got, expected);
    assert_true(fabs(got - expected) <= 1e-12 * scale);
}

/* 1 uF at 10 V and 3 uF at 2 V: 16 uC on 4 uF, 4 V; 6 uC have passed. */
static void capacitor_onto_capacitor(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) { /* a switch; a diode; one that blocks */
        net k = begin();
        capacitor(&k, "c1", 1, 0, 1e-6, 10);
        capacitor(&k, "c2", 2, 0, 3e-6, 2);
        const int id = kind == 0   ? contact(&k, "s", 1, 2, 1)
                       : kind == 1 ? diode(&k, "d", 1, 2)
                                   : diode(&k, "d", 2, 1);
        jumps(&k);
        near(of_node(&k, k.x, 1), kind < 2 ? 4 : 10, 10);
        near(of_node(&k, k.x, 2), kind < 2 ? 4 : 2, 10);
        near(of_device(&k, k.X, k.Lambda, id), kind < 2 ? 6e-6 : 0, 16e-6);
        near(of_device(&k, k.x, k.lambda, id), 0, 1);
        end(&k);
    }
}

/* 2 uF at 1 V pulled to 5 V by a source through a diode: 8 uC out of the source; then a rising source, 1
 * V/us, keeps driving 2 A. */
static void capacitor_onto_source(void **state) {
    (void)state;
    net k = begin();
    const int v = voltage(&k, "v", 1, 0, 5);
    const int d = diode(&k, "d", 1, 2);
    capacitor(&k, "c", 2, 0, 2e-6, 1);
    prepare(&k);
    const double slope[1] = {1e6};
    assert_int_equal(k.s->nz, 1);
    assert_int_equal(jump(&k, slope), NS_OK);
    near(of_node(&k, k.x, 2), 5, 5);
    near(of_device(&k, k.X, k.Lambda, d), 8e-6, 8e-6);
    near(of_current(&k, k.X, v), -8e-6, 8e-6);
    near(of_device(&k, k.x, k.lambda, d), 2, 2);
    near(of_current(&k, k.x, v), -2, 2);
    const double falling[1] = {-1e6}; /* and a falling one lets the diode block */
    assert_int_equal(jump(&k, falling), NS_OK);
    near(of_device(&k, k.X, k.Lambda, d), 8e-6, 8e-6);
    near(of_device(&k, k.x, k.lambda, d), 0, 2);
    end(&k);
}

/* 1 uF 10 V -> 1 uF 20 V -> 2 uF 0 V.  At first sight only the second diode conducts; but 20 V on 3 uF come
 * to 6.67 V, below 10 V: all three share 30 uC on 4 uF, 7.5 V; 2.5 uC and 15 uC pass.  With 4 V in place of
 * 10 V the first one blocks. */
static void chain_of_capacitors(void **state) {
    (void)state;
    for (int first = 0; first < 2; first++) {
        net k = begin();
        capacitor(&k, "c1", 1, 0, 1e-6, first ? 4 : 10);
        capacitor(&k, "c2", 2, 0, 1e-6, 20);
        capacitor(&k, "c3", 3, 0, 2e-6, 0);
        const int a = diode(&k, "d1", 1, 2), b = diode(&k, "d2", 2, 3);
        resistor(&k, "r", 1, 3, 1);
        jumps(&k);
        near(of_node(&k, k.x, 1), first ? 4 : 7.5, 20);
        near(of_node(&k, k.x, 2), first ? 20 / 3. : 7.5, 20);
        near(of_node(&k, k.x, 3), first ? 20 / 3. : 7.5, 20);
        near(of_device(&k, k.X, k.Lambda, a), first ? 0 : 2.5e-6, 15e-6);
        near(of_device(&k, k.X, k.Lambda, b), first ? 40e-6 / 3 : 15e-6, 15e-6);
        end(&k);
    }
}

/* 1 mH at 2 A into a node, 3 mH at 1 A out of it, the switch that carried the rest opens: 5 mWb on 4 mH. */
static void inductor_into_inductor(void **state) {
    (void)state;
    net k = begin();
    const int a = inductor(&k, "l1", 0, 1, 1e-3, 2), b = inductor(&k, "l2", 1, 0, 3e-3, 1);
    contact(&k, "s", 1, 0, 0);
    jumps(&k);
    near(of_current(&k, k.x, a), 1.25, 2);
    near(of_current(&k, k.x, b), 1.25, 2);
    near(of_node(&k, k.X, 1), 0.75e-3, 1e-3);
    near(of_node(&k, k.x, 1), 0, 1); /* nothing drives them on */
    end(&k);
}

/* An interrupted inductor finds a clamp: no jump, the diode takes the current.  With a resistor of 1 kohm in
 * its way there is none either, only 2 kV. */
static void inductor_into_clamp(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        net k = begin();
        const int l = inductor(&k, "l", 0, 1, 1e-3, 2);
        contact(&k, "s", 1, 0, 0);
        if (kind)
            resistor(&k, "r", 1, 0, 1e3);
        else
            diode(&k, "d", 1, 2);
        capacitor(&k, "c", 2, 0, 1e-6, 5);
        jumps(&k);
        near(of_current(&k, k.x, l), 2, 2);
        near(of_node(&k, k.x, 1), kind ? 2000 : 5, kind ? 2000 : 5);
        near(of_node(&k, k.x, 2), 5, 5);
        near(of_node(&k, k.X, 1), 0, 1e-3);
        near(k.lambda[k.s->m - 1], kind ? k.lambda[k.s->m - 1] : 2, 2);
        end(&k);
    }
}

/* 4 mH at 1 A interrupted; 1 mH with K = 0.5 (M = 1 mH) behind a diode takes M i1 = 1 mWb: 1 A.  With K = 1
 * (M = 2 mH) all of it, 2 A, and no flux is left over. */
static void transformer(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        net k = begin();
        const int a = inductor(&k, "l1", 1, 0, 4e-3, 1), b = inductor(&k, "l2", 0, 2, 1e-3, 0);
        assert_int_equal(ns_circuit_coupling(k.c, "k1", a, b, kind ? 1 : -0.5, NULL), NS_OK);
        contact(&k, "s", 1, 0, 0);
        diode(&k, "d", kind ? 2 : 3, kind ? 3 : 2);
        resistor(&k, "r", 3, 0, 50);
        jumps(&k);
        near(of_current(&k, k.x, a), 0, 1);
        near(of_current(&k, k.x, b), kind ? 2 : -0.5 * 4e-3 * 0.5 / 1e-3, 2);
        near(fabs(of_node(&k, k.x, 3)), kind ? 100 : 50, 100);
        end(&k);
    }
}

/* The bridge with filter of the literature: 1 uF at 10 V, 0.3 uF across the load: 10/1.3 V. */
static void bridge_with_filter(void **state) {
    (void)state;
    net k = begin();
    capacitor(&k, "c", 1, 2, 1e-6, 10);
    const int l = inductor(&k, "l", 1, 2, 1e-2, 0);
    resistor(&k, "r", 3, 4, 1e3);
    capacitor(&k, "cf", 3, 4, 0.3e-6, 0);
    diode(&k, "d1", 1, 3);
    diode(&k, "d2", 2, 3);
    diode(&k, "d3", 4, 2);
    diode(&k, "d4", 4, 1);
    resistor(&k, "earth", 4, 0, 1);
    jumps(&k);
    near(of_node(&k, k.x, 1) - of_node(&k, k.x, 2), 10 / 1.3, 10);
    near(of_node(&k, k.x, 3) - of_node(&k, k.x, 4), 10 / 1.3, 10);
    near(of_current(&k, k.x, l), 0, 1);
    end(&k);
}

/* Two closed switches in parallel: what passes is determined, how they share it is not; equal shares. */
static void parallel_switches_share(void **state) {
    (void)state;
    net k = begin();
    capacitor(&k, "c1", 1, 0, 1e-6, 10);
    capacitor(&k, "c2", 2, 0, 3e-6, 2);
    const int a = contact(&k, "s1", 1, 2, 1), b = contact(&k, "s2", 1, 2, 1);
    jumps(&k);
    near(of_node(&k, k.x, 1), 4, 10);
    near(of_device(&k, k.X, k.Lambda, a), 3e-6, 6e-6);
    near(of_device(&k, k.X, k.Lambda, b), 3e-6, 6e-6);
    end(&k);
}

/* What is consistent stays, to the last bits, and has no impulses at all. */
static void consistent_stays(void **state) {
    (void)state;
    net k = begin();
    capacitor(&k, "c1", 1, 0, 1e-6, 4);
    capacitor(&k, "c2", 2, 0, 3e-6, 4);
    contact(&k, "s1", 1, 2, 1);
    inductor(&k, "l", 1, 0, 1e-3, 0.5);
    jumps(&k);
    near(of_node(&k, k.x, 2), 4, 4);
    for (int i = 0; i < k.s->n; i++)
        assert_true(k.X[i] == 0);
    assert_true(k.Lambda[0] == 0);
    end(&k);
}

static void no_answer_is_told(void **state) {
    (void)state;
    net k = begin();
    voltage(&k, "v1", 1, 0, 5);
    voltage(&k, "v2", 2, 0, 3);
    diode(&k, "d", 1, 2);
    capacitor(&k, "c", 2, 0, 1e-6, 0);
    prepare(&k);
    k.x[0] = 77;
    assert_int_equal(jump(&k, NULL), NS_E_INFEASIBLE);
    assert_true(k.x[0] == 77);
    const ns_fault *f = ns_theta_fault(k.step);
    assert_int_equal(f->status, NS_E_INFEASIBLE);
    assert_int_equal(f->npairs, 1);
    assert_int_equal(f->pair[0], 0);
    end(&k);
}

static void bad_input_is_refused(void **state) {
    (void)state;
    net k = begin();
    voltage(&k, "v1", 1, 0, 5);
    capacitor(&k, "c", 1, 0, 1e-6, 0);
    prepare(&k);
    const ns_impulse out = {0};
    const double nan = NAN;
    assert_int_equal(ns_theta_impulse(NULL, k.z, NULL, &out), NS_E_NULL);
    assert_int_equal(ns_theta_impulse(k.step, NULL, NULL, &out), NS_E_NULL);
    assert_int_equal(ns_theta_impulse(k.step, k.z, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_theta_impulse(k.step, &nan, NULL, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(k.step, k.z, &nan, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(k.step, k.z, NULL, &out), NS_OK); /* nothing asked for, nothing given */
    end(&k);
}

/* --- random networks ------------------------------------------------------------------------------------ */

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
        e[i].id = e[i].kind == RES     ? resistor(k, name, p, n, e[i].value)
                  : e[i].kind == CAP   ? capacitor(k, name, p, n, e[i].value, e[i].ic)
                  : e[i].kind == IND   ? inductor(k, name, p, n, e[i].value, e[i].ic)
                  : e[i].kind == DIODE ? diode(k, name, p, n)
                                       : contact(k, name, p, n, e[i].closed);
    }
    if (coupling != 0)
        assert_int_equal(ns_circuit_coupling(k->c, "k", e[1].id, e[2].id, coupling, NULL), NS_OK);
}

static double across(const net *k, const element *e, const double *x) {
    return of_node(k, x, e->p) - of_node(k, x, e->n);
}

typedef struct sums {
    double charge, flux, energy; /* C, Wb, J: sums of sizes */
    double before, after, lost;  /* J */
    double psi[ELEMENTS];        /* Wb: by how much an inductor's flux changes */
} sums;

static sums add_up(const net *k, const element *e) {
    sums t = {0};
    double volts = 1e-3;
    for (int i = 1; i < NODES; i++)
        volts = fmax(volts, 1e-3 * fabs(of_node(k, k->x, i)));
    double i0[ELEMENTS] = {0}, i1[ELEMENTS] = {0};
    for (int j = 0; j < ELEMENTS; j++) {
        const double v = e[j].value;
        if (e[j].kind == CAP) {
            const double v1 = across(k, &e[j], k->x), v0 = e[j].ic;
            t.charge += v * (fabs(v0) + fabs(v1) + volts);
            t.energy += v * (v0 * v0 + v1 * v1) / 2;
            t.before += v * v0 * v0 / 2;
            t.after += v * v1 * v1 / 2;
            t.lost += v * (v1 - v0) * (v1 - v0) / 2;
        } else if (e[j].kind == IND) {
            i0[j] = e[j].ic;
            i1[j] = of_current(k, k->x, e[j].id);
        }
    }
    const double mutual = coupling * sqrt(e[1].value * e[2].value);
    for (int j = 0; j < ELEMENTS; j++) {
        const int other = j == 1 ? 2 : 1;
        const double m = j == 1 || j == 2 ? mutual : 0;
        if (e[j].kind != IND)
            continue;
        t.psi[j] = e[j].value * (i1[j] - i0[j]) + m * (i1[other] - i0[other]);
        t.flux += e[j].value * (fabs(i0[j]) + fabs(i1[j]));
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

/* By how much a device, an inductor or a resistor misses its law, relative. */
static double missed(const net *k, const element *e, const sums *t) {
    double worst = 0, most = 0, volts = 0;
    for (int i = 0; i < k->s->n; i++) {
        volts = fmax(volts, fabs(k->x[i]));
        most = fmax(most, fabs(k->X[i]));
    }
    for (int j = 0; j < ELEMENTS; j++) {
        const double u = across(k, &e[j], k->X);
        const double off = e[j].kind == IND                       ? u - t->psi[j]
                           : e[j].kind == CAP || e[j].kind == RES ? u
                           : e[j].kind == CONTACT && e[j].closed  ? u
                           : e[j].kind == DIODE                   ? fmax(u, 0)
                                                                  : 0;
        if (off != 0)
            worst = fmax(worst, fabs(off) / (t->flux + most));
        if (e[j].kind == DIODE && across(k, &e[j], k->X) >= -1e-12 * most)
            worst = fmax(worst, across(k, &e[j], k->x) / (volts + 1));
        if (e[j].kind == DIODE && t->charge > 0)
            worst = fmax(worst, -of_device(k, k->X, k->Lambda, e[j].id) / t->charge);
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
    static double T[MOST * MOST];
    const int n = k->s->n;
    int rank;
    double sum[MOST] = {0}, terms[MOST] = {0}, worst = 0, most = 0;
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
    double x[MOST], worst = 0;
    static double w[MOST];
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
    int refused, jumped, rough, linear, steps;
    double charge, energy, law, rows, growth;
} tally;

static void look(const net *k, const element *e, tally *t) {
    const sums s = add_up(k, e);
    const double charge = gained(k, e) / s.charge, energy = fabs(s.before - s.after - s.lost) / s.energy;
    t->charge = fmax(t->charge, charge);
    t->energy = fmax(t->energy, energy);
    t->growth = fmax(t->growth, (s.after - s.before) / s.energy);
    t->law = fmax(t->law, missed(k, e, &s));
    t->rows = fmax(t->rows, algebraic(k));
    t->jumped += s.lost > 1e-9 * s.energy;
    t->rough += charge > 1e-12 || energy > 1e-12;
}

/* Lengths at which what flows in a step is seen beside rounding and is small still. */
static void compare_with_steps(net *k, tally *t) {
    const double a = distance(k, 1024 * k->h), b = distance(k, 64 * k->h);
    if (!(a > 1e-9) || b < 0)
        return;
    t->steps++;
    t->linear += b < a / 12 && b > a / 20;
}

/* A capacitor of 1 nF that shares its charge with one of 1 mF keeps ten digits of its voltage: hence 1e-10,
 * which one network in a hundred may need beyond 1e-12. */
static void random_networks(void **state) {
    coupling = *(double *)*state;
    tally t = {0};
    for (int run = 0; run < RUNS; run++) {
        element e[ELEMENTS];
        seed = 5000 + (unsigned)run;
        random_network(e);
        net k = begin();
        build(&k, e);
        prepare(&k);
        const int status = jump(&k, NULL);
        t.refused += status != NS_OK;
        if (status == NS_OK) {
            look(&k, e, &t);
            compare_with_steps(&k, &t);
        }
        end(&k);
    }
    print_message(
        "K %g: %d networks, %d jumped, %d refused; charge %.1e, energy %.1e (growth %.1e), laws %.1e, "
        "rows %.1e, %d beyond 1e-12; %d of %d steps linear in h\n",
        coupling, RUNS, t.jumped, t.refused, t.charge, t.energy, t.growth, t.law, t.rows, t.rough, t.linear,
        t.steps);
    assert_true(t.jumped > RUNS / 2 && t.steps > RUNS / 4);
    assert_true(t.refused <= RUNS / 25);
    assert_true(t.rough <= RUNS / 100);
    assert_true(t.charge <= 1e-10 && t.energy <= 1e-10 && t.growth <= 1e-10);
    assert_true(t.law <= 1e-10 && t.rows <= 1e-10);
    assert_true(t.linear >= t.steps - t.steps / 10);
}

int main(void) {
    static double loose = 0, half = 0.5, tight = 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(capacitor_onto_capacitor),
        cmocka_unit_test(capacitor_onto_source),
        cmocka_unit_test(chain_of_capacitors),
        cmocka_unit_test(inductor_into_inductor),
        cmocka_unit_test(inductor_into_clamp),
        cmocka_unit_test(transformer),
        cmocka_unit_test(bridge_with_filter),
        cmocka_unit_test(parallel_switches_share),
        cmocka_unit_test(consistent_stays),
        cmocka_unit_test(no_answer_is_told),
        cmocka_unit_test(bad_input_is_refused),
        {"random networks, no coupling", random_networks, NULL, NULL, &loose},
        {"random networks, K = 0.5", random_networks, NULL, NULL, &half},
        {"random networks, K = 1", random_networks, NULL, NULL, &tight},
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
