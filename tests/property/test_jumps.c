/* tests/property/test_jumps.c - what no jump may change, and what none may add, in random networks.
 *
 * Networks of R, L, C, ideal diodes and switches that open and close at instants of their own, started with
 * charge, event by event.  Where the state jumps the two sides have the same time, and
 *   - stored energy does not grow;
 *   - what capacitors hold on nodes that devices join stays: resistors and inductors carry no impulse of
 * charge;
 *   - no flux changes hands between inductors and anything but devices: with nodes joined by capacitors and
 *     resistors (no impulse of voltage) the current of an inductor across nothing stays, and of two side by
 *     side L1 di1 = L2 di2.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "passive.h"
#include "retries.h"

enum { RUNS = 400, FAILED = RUNS / 100 };

/* What the left side of an event holds is read off a step, of which charges know more than the voltages of
 * floating nodes and than a small current beside large ones. */
static const double until = 61e-6;

/* What charge, flux and energy may be off by: at starts, and as read at events.  The exact engine's unknowns
 * are read from its states in modes where parts float, by the leaks' limit, which is good to 1e-12
 * (theta/regularise.c) of each of the terms. */
typedef struct way {
    double roff;
    ns_method method;
    double conserved, read_off;
} way;

typedef struct side {
    double t, energy, held[ELEMENTS];
    double size[ELEMENTS]; /* of the voltages whose difference that is: floating nodes may be at a megavolt */
} side;

static double node_size(const run *r, const double *x, int node) {
    const int i = ns_circuit_node_unknown(r->c, r->node[node]);
    return i < 0 ? 0 : fabs(x[i]);
}

static side look(const run *r, const element *e) {
    side s = {.energy = energy(r, e)};
    double x[256];
    assert_int_equal(ns_march_read(r->m, &s.t, x, NULL, NULL), NS_OK);
    for (int k = 0; k < ELEMENTS; k++) {
        s.held[k] = held(r, e, k);
        s.size[k] = node_size(r, x, e[k].p) + node_size(r, x, e[k].n);
    }
    return s;
}

static int joins(kind k, int charges) {
    return charges ? k == DIODE || k == SWITCH : k == CAP || k == RES;
}

/* Which nodes are one: for charges those joined by devices, for fluxes by capacitors and resistors. */
static void join(const element *e, int charges, int *part) {
    for (int i = 0; i < NODES; i++)
        part[i] = i;
    for (int k = 0; k < ELEMENTS; k++)
        for (int i = 0, from = part[e[k].p]; joins(e[k].kind, charges) && i < NODES; i++)
            if (part[i] == from)
                part[i] = part[e[k].n];
}

typedef struct tally {
    double charge, flux, energy; /* the worst, relative to what is there */
} tally;

/* What has nearly gone is off by the rounding of what there was: of a thousandth of the voltage, or current,
 * that all energy given would make in that element. */
static const double little = 1e-3;
static double there_was(const element *e, double value) {
    double sum = 0;
    for (int k = 0; k < ELEMENTS; k++)
        sum += e[k].kind == CAP || e[k].kind == IND ? e[k].value * e[k].ic * e[k].ic : 0;
    return little * sqrt(sum * value);
}

typedef struct tallies {
    tally start, event;
    int starts, events; /* that jumped */
} tallies;

static void check_charges(const element *e, const side *a, const side *b, tally *t) {
    int part[NODES];
    join(e, 1, part);
    for (int of = 0; of < NODES; of++) {
        double moved = 0, size = 0;
        for (int k = 0; k < ELEMENTS; k++) {
            if (e[k].kind != CAP)
                continue;
            const int sign = (part[e[k].p] == of) - (part[e[k].n] == of);
            moved += sign * e[k].value * (b->held[k] - a->held[k]);
            size += fmax(e[k].value * fmax(a->size[k], b->size[k]), there_was(e, e[k].value));
        }
        t->charge = fmax(t->charge, size > 0 ? fabs(moved) / size : 0);
    }
}

static void check_fluxes(const element *e, const side *a, const side *b, tally *t) {
    int part[NODES];
    double size = 0;
    join(e, 0, part);
    for (int k = 0; k < ELEMENTS; k++)
        if (e[k].kind == IND)
            size += fmax(e[k].value * fmax(fabs(a->held[k]), fabs(b->held[k])), there_was(e, e[k].value));
    for (int k = 0; k < ELEMENTS && size > 0; k++) {
        if (e[k].kind != IND)
            continue;
        const double flux = e[k].value * (b->held[k] - a->held[k]);
        const int p = part[e[k].p], n = part[e[k].n];
        if (p == n)
            t->flux = fmax(t->flux, fabs(flux) / size);
        for (int l = 0; l < k && p != n; l++) {
            const int lp = part[e[l].p], ln = part[e[l].n],
                      same = (lp == p && ln == n) - (lp == n && ln == p);
            if (e[l].kind == IND && same != 0)
                t->flux = fmax(t->flux, fabs(flux - same * e[l].value * (b->held[l] - a->held[l])) / size);
        }
    }
}

static void check(const element *e, const side *a, const side *b, tally *t) {
    check_charges(e, a, b, t);
    check_fluxes(e, a, b, t);
    const double all = there_was(e, 1), size = fmax(a->energy, all * all / 2);
    t->energy = fmax(t->energy, size > 0 ? (b->energy - a->energy) / size : 0);
}

static side given(const element *e) {
    side a = {0};
    for (int k = 0; k < ELEMENTS; k++) {
        a.held[k] = e[k].ic;
        a.size[k] = fabs(e[k].ic);
        a.energy += e[k].kind == CAP || e[k].kind == IND ? e[k].value * e[k].ic * e[k].ic / 2 : 0;
    }
    return a;
}

static int follow(run *r, const element *e, tallies *t) {
    side a = given(e), start = look(r, e);
    if (start.t == 0) {
        check(e, &a, &start, &t->start);
        t->starts++;
    }
    a = start;
    for (int k = 0; k < 2000 && a.t < until; k++) {
        double reached;
        const int status = ns_march_try(r->m, until + 1e-6, NS_TO_EVENT, &reached);
        if (status != NS_OK)
            return 0;
        assert_int_equal(ns_march_accept(r->m), NS_OK);
        const side b = look(r, e);
        assert_true(b.t == reached && b.t >= a.t);
        if (b.t == a.t) {
            check(e, &a, &b, &t->event);
            t->events++;
        }
        a = b;
    }
    assert_true(a.t >= until);
    return 1;
}

static void jumps_conserve(void **state) {
    const way *w = *state;
    int failed = 0;
    long jumps = 0, refused = 0;
    tallies t = {0};
    for (int k = 0; k < RUNS; k++) {
        element e[ELEMENTS];
        random_network(e, 7000 + (unsigned)k);
        for (int i = 0; i < ELEMENTS; i++)
            e[i].instant *= draw(2) ? 1 : -1;
        run r = plain(w->roff, k & 1 ? 1 : 0.5);
        r.method = w->method;
        failed += !(begin(&r, e, straight, 1e-6) && follow(&r, e, &t));
        jumps += ns_march_counts(r.m)->jumps;
        refused += ns_march_counts(r.m)->jumps_by_steps;
        end(&r);
    }
    print_message("roff %g: %d networks (%d failed), %ld jumps, %ld more by short steps\n", w->roff, RUNS,
                  failed, jumps, refused);
    print_message("%d starts: charge %.1e, flux %.1e off, energy grew by %.1e\n", t.starts, t.start.charge,
                  t.start.flux, t.start.energy);
    print_message("%d events: charge %.1e, flux %.1e off, energy grew by %.1e\n", t.events, t.event.charge,
                  t.event.flux, t.event.energy);
    assert_true(failed <= FAILED && t.starts > RUNS / 4 && t.events > RUNS / 4 && refused <= jumps / 100);
    assert_true(t.start.charge <= w->conserved && t.start.flux <= w->conserved &&
                t.start.energy <= w->conserved);
    assert_true(t.event.charge <= w->read_off && t.event.flux <= w->read_off &&
                t.event.energy <= w->read_off);
}

int main(void) {
    static way none = {INFINITY, NS_THETA, 1e-12, 1e-11}, low = {1e6, NS_THETA, 1e-12, 1e-11},
               exact = {INFINITY, NS_AUTO, 1e-10, 1e-10};
    const struct CMUnitTest tests[] = {
        {"jumps conserve, theta, roff none", jumps_conserve, NULL, NULL, &none},
        {"jumps conserve, theta, roff 1e6", jumps_conserve, NULL, NULL, &low},
        {"jumps conserve, exact, roff none", jumps_conserve, NULL, NULL, &exact},
    };
    allow_retries(6); /* measured: 2 */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
