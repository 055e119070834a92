/* tests/property/test_energy_networks.c - energy over jumps of random networks: none is lost but in elements.
 *
 * Networks of R, L, C, ideal diodes and switches that open and close (passive.h), with jumps of charges and
 * fluxes: what all elements take in after the start adds up to zero, what capacitors and inductors take is
 * the change of what they store, and no resistor, diode or switch gives energy, but for the diodes that
 * nonsmooth/energy.h names (two of these networks have one).  A start may join capacitors of different
 * voltages in a loop without any device: that loss is in no element.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "passive.h"
#include "retries.h"

enum { RUNS = 150, REFUSED = RUNS / 50, GIVING = 2 };

/* Of all energy given: what a network may be off by.  Floating parts are read by the leaks' limit, which is
 * good to 1e-12 of the terms (theta/regularise.c). */
static const double closes = 1e-9;

static double given(const element *e) {
    double sum = 0;
    for (int k = 0; k < ELEMENTS; k++)
        sum += e[k].kind == CAP || e[k].kind == IND ? e[k].value * e[k].ic * e[k].ic / 2 : 0;
    return sum;
}

typedef struct told {
    double sum, kept, least; /* of all elements; of C and L against what they store; the least of R, D, S */
    double of[ELEMENTS];
    long jumps;
} told;

static told look(const ns_energy *e, const run *r, const element *of) {
    told t = {.jumps = ns_march_counts(r->m)->jumps};
    for (int k = 0; k < ns_energy_count(e); k++) {
        double joule;
        assert_int_equal(ns_energy_read(e, k, NULL, NULL, &joule), NS_OK);
        t.sum += joule;
    }
    for (int k = 0; k < ELEMENTS; k++) {
        double joule;
        assert_int_equal(ns_energy_read(e, r->id[k], NULL, NULL, &joule), NS_OK);
        t.of[k] = joule;
        if (of[k].kind == CAP || of[k].kind == IND)
            t.kept += joule;
    }
    t.kept -= energy(r, of);
    return t;
}

/* 0: refused. */
static int follow(const element *e, ns_method method, told *t) {
    run r = plain(INFINITY, 1);
    ns_energy *a = NULL;
    r.method = method;
    int ok = begin(&r, e, straight, 1e-6);
    if (ok) {
        assert_int_equal(ns_energy_create(r.c, 0, NULL, &a), NS_OK);
        assert_int_equal(ns_energy_start(a, r.m), NS_OK);
        const told first = look(a, &r, e);
        const int status = ns_energy_march(a, r.m, 61e-6);
        ok = status == NS_OK;
        *t = look(a, &r, e);
        t->sum -= first.sum;
        t->kept -= first.kept;
        for (int k = 0; k < ELEMENTS; k++)
            if (e[k].kind == RES || e[k].kind == DIODE || e[k].kind == SWITCH)
                t->least = fmin(t->least, t->of[k] - first.of[k]);
    }
    ns_energy_free(a);
    end(&r);
    return ok;
}

static void balances_close(void **state) {
    const ns_method method = *(const ns_method *)*state;
    int refused = 0, bad = 0, giving = 0;
    long jumps = 0;
    double sum = 0, kept = 0;
    for (int k = 0; k < RUNS; k++) {
        element e[ELEMENTS];
        told t = {0};
        random_network(e, 70000 + (unsigned)k);
        const double all = given(e);
        if (!follow(e, method, &t)) {
            refused++;
            continue;
        }
        if (fabs(t.sum) > closes * all || fabs(t.kept) > closes * all) {
            print_message("network %d: sum %.1e, stored %.1e of %.1e J\n", k, t.sum / all, t.kept / all, all);
            bad++;
        }
        giving += t.least < -closes * all;
        jumps += t.jumps;
        sum = fmax(sum, fabs(t.sum) / all);
        kept = fmax(kept, fabs(t.kept) / all);
    }
    print_message("%d networks, %d refused: sum %.1e, stored %.1e of all energy; %d give some\n", RUNS,
                  refused, sum, kept, giving);
    assert_true(method != NS_SPARSE || jumps > RUNS / 2); /* the exact engine does not count them */
    assert_true(giving <= GIVING);
    assert_true(refused <= REFUSED);
    assert_int_equal(bad, 0);
}

int main(void) {
    static ns_method exact = NS_EXACT, sparse = NS_SPARSE;
    const struct CMUnitTest tests[] = {
        {"exact", balances_close, NULL, NULL, &exact},
        {"sparse", balances_close, NULL, NULL, &sparse},
    };
    allow_retries(6); /* measured: 2 */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
