/* tests/property/test_agree.c - two schemes and two step lengths tell the same story.
 *
 * Random networks as in test_passive.c, one element a square wave behind 10 ohm, over 60 us: three periods
 * and some, with switches that open on the way.  Parts of them float, hang on inductors alone, or close in
 * loops of switches.  What capacitors and inductors hold at the end, in units of stored energy: theta = gamma
 * = 1/2 at h = 20 ns against h = 5 ns: second order, h^2/12 of what rings fastest (0.1 mH and 10 nF: w =
 * 1e6/s) and its share of the energy, over at most 60 us: (w h)^2/12 w T = 2e-3; against theta = 1 at h = 5
 * ns: first order, which takes w^2 h T/2 = 0.15 of such a ring. A diode that blocks where it must conduct is
 * off by all there is.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "passive.h"

enum { RUNS = 80, CHATTER = 1000, CHATTERING = RUNS / 20 };
static const double T = 60e-6;

typedef struct ended {
    double held[ELEMENTS];
    long events;
    int refused;
} ended;

static ended march(const element *e, double theta, double h) {
    run r = plain(INFINITY, theta);
    ended x = {.refused = 1};
    if (begin(&r, e, straight, h) && go(&r, T)) {
        for (int k = 0; k < ELEMENTS; k++)
            x.held[k] = held(&r, e, k);
        x.events = ns_march_counts(r.m)->events;
        x.refused = 0;
    }
    end(&r);
    return x;
}

/* The largest difference of what one element holds, against all energy at first and of 1 uF at the source's
 * 1 V. */
static double apart(const element *e, const ended *a, const ended *b) {
    double scale = 1e-6, most = 0;
    for (int k = 0; k < ELEMENTS; k++) {
        if (e[k].kind != CAP && e[k].kind != IND)
            continue;
        scale += e[k].value * e[k].ic * e[k].ic;
        most = fmax(most, e[k].value * pow(a->held[k] - b->held[k], 2));
    }
    return sqrt(most / scale);
}

static long most_of(long a, long b, long c) {
    const long ab = a > b ? a : b;
    return ab > c ? ab : c;
}

static void schemes_agree(void **state) {
    (void)state;
    double second = 0, first = 0;
    int chattering = 0;
    for (int k = 0; k < RUNS; k++) {
        element e[ELEMENTS];
        random_network(e, 5000 + (unsigned)k);
        e[2].kind = DRIVE;
        const ended a = march(e, 0.5, 20e-9), b = march(e, 0.5, 5e-9), c = march(e, 1, 5e-9);
        assert_false(a.refused || b.refused || c.refused); /* the 10 ohm leave nothing to contradict */
        const double ab = apart(e, &a, &b), bc = apart(e, &b, &c);
        const long count = most_of(a.events, b.events, c.events);
        chattering += count > CHATTER;
        if (ab > 5e-3 || bc > 0.2 || count > CHATTER)
            print_message("network %d: %.2g, %.2g; %ld, %ld, %ld events\n", k, ab, bc, a.events, b.events,
                          c.events);
        assert_true(ab <= 5e-3 && bc <= 0.2);
        second = fmax(second, ab);
        first = fmax(first, bc);
    }
    print_message(
        "%d networks: theta 1/2, 20 ns and 5 ns: %.2g apart; theta 1: %.2g; %d with over %d events\n", RUNS,
        second, first, chattering, CHATTER);
    assert_true(chattering <= CHATTERING);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(schemes_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
