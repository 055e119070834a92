/* tests/property/test_passive.c - what holds for every circuit without sources, and for every way to write
 * it.
 *
 * Random networks of R, L, C, ideal diodes and time-driven ideal switches (often floating, often with several
 * devices in parallel or in series, zero and infinite resistances among them), started with charge:
 *   - stored energy  sum C v^2/2 + sum L i^2/2  never grows, jumps included (theta = 1);
 *   - the order of elements and the numbers of nodes change nothing.
 * Every such network has a solution, but some leave a great deal open: loops of closed switches without
 * resistance around inductors that were just interrupted.  At most one network in a hundred may be refused
 * for that (the number is printed); none may be answered wrongly.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { NODES = 6, ELEMENTS = 11, RUNS = 600, STEPS = 60, REFUSED = RUNS / 100 };

typedef enum kind { RES, CAP, IND, DIODE, SWITCH } kind;

typedef struct element {
    kind kind;
    int p, n;
    double value, ic, instant; /* ohm, F or H; V or A; s */
} element;

static unsigned long seed;
static unsigned draw(unsigned below) { /* Knuth's MMIX generator, high bits */
    seed = seed * 6364136223846793005ul + 1442695040888963407ul;
    return (unsigned)(seed >> 33) % below;
}

static void random_network(element *e) {
    for (int k = 0; k < ELEMENTS; k++) {
        const unsigned r = draw(10);
        e[k].kind = k == 0   ? CAP
                    : k == 1 ? IND
                    : r < 2  ? RES
                    : r < 4  ? CAP
                    : r < 5  ? IND
                    : r < 8  ? DIODE
                             : SWITCH;
        e[k].p = (int)draw(NODES);
        do
            e[k].n = (int)draw(NODES);
        while (e[k].n == e[k].p);
        const double size = pow(10, (double)draw(5) - 2); /* 0.01 .. 100 */
        e[k].value = e[k].kind == RES ? 100 * size : e[k].kind == CAP ? 1e-6 * size : 1e-3 * size;
        e[k].ic = e[k].kind == CAP   ? (double)draw(20) - 10
                  : e[k].kind == IND ? ((double)draw(20) - 10) / 10
                                     : 0;
        e[k].instant = 1e-6 * (1 + draw(STEPS));
    }
}

typedef struct run {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    int id[ELEMENTS];
    int node[NODES]; /* numbers given to the nodes */
    double roff;
} run;

static int add(run *r, const element *e, int k) {
    char name[16];
    const int p = r->node[e->p], n = r->node[e->n];
    const ns_diode d = {0, 0, r->roff, INFINITY, 0};
    const ns_switch sw = {0.5, 0, 0, r->roff};
    snprintf(name, sizeof name, "e%d", k);
    switch (e->kind) {
    case RES:
        return ns_circuit_resistor(r->c, name, p, n, e->value, &r->id[k]);
    case CAP:
        return ns_circuit_capacitor(r->c, name, p, n, e->value, e->ic, &r->id[k]);
    case IND:
        return ns_circuit_inductor(r->c, name, p, n, e->value, e->ic, &r->id[k]);
    case DIODE:
        return ns_circuit_diode(r->c, name, p, n, &d, &r->id[k]);
    default: {
        /* closed first, then open, at its own instant; the gate drives nothing else */
        const double t[2] = {e->instant, e->instant}, v[2] = {1, 0};
        ns_signal s = {.kind = NS_PWL};
        s.u.pwl.n = 2;
        s.u.pwl.t = t;
        s.u.pwl.v = v;
        s.u.pwl.repeat = NAN;
        const int gate = 100 + k;
        const int status = ns_circuit_switch(r->c, name, p, n, gate, 0, &sw, &r->id[k]);
        snprintf(name, sizeof name, "v%d", k);
        return status != NS_OK ? status : ns_circuit_source(r->c, name, NS_VOLTAGE, gate, 0, &s, NULL);
    }
    }
}

/* 0 if the network is refused, with a reason that may be. */
static int accepted(const run *r, int status) {
    char line[256];
    if (status == NS_OK)
        return 1;
    ns_circuit_explain(r->c, ns_march_fault(r->m), line, sizeof line);
    print_message("refused: %s\n", line);
    assert_true(status == NS_E_SINGULAR || status == NS_E_INFEASIBLE || status == NS_E_RESIDUAL);
    return 0;
}

/* Returns 0 if the network is refused. */
static int begin(run *r, const element *e, const int *order, double h) {
    double w0[256];
    assert_int_equal(ns_circuit_create(&r->c), NS_OK);
    for (int k = 0; k < ELEMENTS; k++)
        assert_int_equal(add(r, &e[order[k]], order[k]), NS_OK);
    assert_int_equal(ns_circuit_system(r->c, &r->s), NS_OK);
    assert_true(r->s->n <= 256);
    const ns_march_options o = {1, 1, h, 0};
    assert_int_equal(ns_march_create(r->s, &o, &r->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(r->c, w0), NS_OK);
    return accepted(r, ns_march_start(r->m, 0, w0));
}

static void end(run *r) {
    ns_march_free(r->m);
    ns_system_free(r->s);
    ns_circuit_free(r->c);
}

static int go(run *r, double t) {
    double reached;
    if (!accepted(r, ns_march_try(r->m, t, NS_TO_TIME, &reached)))
        return 0;
    assert_int_equal(ns_march_accept(r->m), NS_OK);
    return 1;
}

static double node_v(const run *r, const double *x, int node) {
    const int i = ns_circuit_node_unknown(r->c, r->node[node]);
    return i < 0 ? 0 : x[i];
}

static double energy(const run *r, const element *e) {
    double x[256], sum = 0;
    assert_int_equal(ns_march_read(r->m, NULL, x, NULL, NULL), NS_OK);
    for (int k = 0; k < ELEMENTS; k++) {
        const double v = node_v(r, x, e[k].p) - node_v(r, x, e[k].n);
        if (e[k].kind == CAP)
            sum += e[k].value * v * v / 2;
        if (e[k].kind == IND) {
            const double i = x[ns_circuit_current_unknown(r->c, r->id[k])];
            sum += e[k].value * i * i / 2;
        }
    }
    return sum;
}

static const int straight[ELEMENTS] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

static run plain(double roff) {
    run r = {.roff = roff};
    for (int k = 0; k < NODES; k++)
        r.node[k] = k;
    return r;
}

/* How far answers may be off, relative to all energy: what the limit of leaks leaves over where a network
 * leaves something open (leak.c); everywhere else growth is below 1e-13 (printed). */
static const double energy_tol = 1e-8;

/* The largest growth, relative to the first; -1 if refused. */
static double growth(const element *e, double roff) {
    run r = plain(roff);
    double worst = 0;
    int ok = begin(&r, e, straight, 1e-6);
    const double first = ok ? energy(&r, e) : 0;
    double before = first;
    for (int step = 1; step <= STEPS && ok; step++) {
        ok = go(&r, step * 1e-6 + 3e-7);
        const double now = ok ? energy(&r, e) : 0;
        if (now > before)
            worst = fmax(worst, (now - before) / first);
        before = now;
    }
    end(&r);
    return ok ? worst : -1;
}

static void stored_energy_never_grows(void **state) {
    const double roff = *(double *)*state;
    int refused = 0, grown = 0;
    for (int k = 0; k < RUNS; k++) {
        element e[ELEMENTS];
        seed = 77 + (unsigned)k;
        random_network(e);
        const double by = growth(e, roff);
        refused += by < 0;
        grown += by > 1e-13;
        if (by > energy_tol)
            print_message("network %d: energy grew by %g\n", k, by);
        assert_true(by <= energy_tol);
    }
    print_message("roff %g: %d networks, %d refused, %d with growth above 1e-13\n", roff, RUNS, refused,
                  grown);
    assert_true(refused <= REFUSED);
    assert_true(grown <= REFUSED);
}

static void shuffle(int *order) {
    for (int i = 0; i < ELEMENTS; i++)
        order[i] = i;
    for (int i = ELEMENTS - 1; i > 0; i--) {
        const int j = (int)draw((unsigned)i + 1), keep = order[i];
        order[i] = order[j];
        order[j] = keep;
    }
}

/* Parts that settle in a thousandth of h (10 uH at 10 kohm) settle in one step whatever it is: what is lost
 * of their energy at an event on the way differs, at h/2 alike. */
static const double stiff = 1e-3;

/* Energies (node voltages of floating parts are not determined) of the network as it is, of the same with
 * elements shuffled and nodes renumbered, and of itself at h/2.  Where an event falls, and whether rounding
 * sees one where a guard is zero, changes which steps are taken; so two ways of writing may differ by what
 * the scheme errs at this h, which h/2 tells.  Returns points compared, -1 if refused. */
static int compare(const element *e, double roff, int k) {
    run a = plain(roff), b = plain(roff), fine = plain(roff);
    int order[ELEMENTS], points = 0;
    double error = 0;
    shuffle(order);
    for (int i = 1; i < NODES; i++)
        b.node[i] = 2 * NODES - 2 * i + 1;
    int ok = begin(&a, e, straight, 1e-6);
    ok = begin(&b, e, order, 1e-6) && ok;
    ok = begin(&fine, e, straight, 0.5e-6) && ok;
    const double scale = ok ? energy(&a, e) : 0;
    for (int step = 1; step <= STEPS && ok; step += 3) {
        const double t = step * 1e-6 + 3e-7;
        if (!(ok = go(&a, t) && go(&b, t) && go(&fine, t)))
            break;
        error = fmax(error, fabs(energy(&a, e) - energy(&fine, e)));
        const double off = fabs(energy(&a, e) - energy(&b, e));
        if (!(off <= 2 * error + stiff * scale))
            print_message("network %d, step %d: off by %g J, the scheme by %g J\n", k, step, off, error);
        assert_true(off <= 2 * error + stiff * scale); /* h errs by twice what h and h/2 differ by */
        points++;
    }
    end(&a);
    end(&b);
    end(&fine);
    return ok ? points : -1;
}

static void order_and_names_change_nothing(void **state) {
    const double roff = *(double *)*state;
    int refused = 0, points = 0;
    for (int k = 0; k < RUNS / 3; k++) {
        element e[ELEMENTS];
        seed = 10000 + (unsigned)k;
        random_network(e);
        const int compared = compare(e, roff, k);
        refused += compared < 0;
        points += compared < 0 ? 0 : compared;
    }
    print_message("roff %g: %d points compared, %d networks refused\n", roff, points, refused);
    assert_true(refused <= REFUSED);
}

int main(void) {
    static double leaky = 1e12, none = INFINITY, low = 1e6;
    static void *states[3] = {&leaky, &none, &low};
    const struct CMUnitTest tests[] = {
        {"stored energy never grows, roff 1e12", stored_energy_never_grows, NULL, NULL, states[0]},
        {"stored energy never grows, roff none", stored_energy_never_grows, NULL, NULL, states[1]},
        {"stored energy never grows, roff 1e6", stored_energy_never_grows, NULL, NULL, states[2]},
        {"order and names change nothing, roff 1e12", order_and_names_change_nothing, NULL, NULL, states[0]},
        {"order and names change nothing, roff none", order_and_names_change_nothing, NULL, NULL, states[1]},
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
