/* tests/bench/bench_islands.c - converters at one supply, each with a period of its own: taken apart, and all
 * in one.
 *
 * Diode bucks at 24 V with periods of 10, 11.3, 12.6, ... us that share no instant: states of their devices
 * multiply, so that all in one meets ever new ones.  Medians of turns, CPU time from elements to 2 ms. */
#include "timing.h"

#include <math.h>

#include "nonsmooth.h"

enum { TURNS = 9, MOST = 6, UNKNOWNS = 64 };
static const double end = 2e-3;

typedef struct outcome {
    double seconds, v; /* v: output of the first, V */
    long events, modes, islands;
} outcome;

static void add(ns_circuit *c, int k) {
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    const ns_switch contact = {0.5, 0, 0, INFINITY};
    const int x = 10 * k + 2, out = x + 1, gate = x + 2;
    const double period = (10 + 1.3 * k) * 1e-6;
    const ns_signal s = {
        .kind = NS_PULSE,
        .u.pulse = {.v2 = 1, .tr = 10e-9, .tf = 10e-9, .pw = (0.35 + 0.03 * k) * period, .per = period}};
    char name[8];
#define NAME(letter) (snprintf(name, sizeof name, letter "%d", k), name)
    must(ns_circuit_source(c, NAME("v"), NS_VOLTAGE, gate, 0, &s, NULL));
    must(ns_circuit_switch(c, NAME("s"), 1, x, gate, 0, &contact, NULL));
    must(ns_circuit_diode(c, NAME("d"), 0, x, &diode, NULL));
    must(ns_circuit_inductor(c, NAME("l"), x, out, 100e-6, 0, NULL));
    must(ns_circuit_capacitor(c, NAME("c"), out, 0, 22e-6, 0, NULL));
    must(ns_circuit_resistor(c, NAME("r"), out, 0, k % 2 ? 4 : 60, NULL));
}

static outcome run(int converters, int whole) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_AUTO, .whole = whole};
    const ns_signal supply = {.kind = NS_DC, .u.dc = 24};
    double w0[UNKNOWNS], x[UNKNOWNS], reached;
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    outcome out;
    const double since = now();
    must(ns_circuit_create(&c));
    must(ns_circuit_source(c, "vin", NS_VOLTAGE, 1, 0, &supply, NULL));
    for (int k = 0; k < converters; k++)
        add(c, k);
    must(ns_circuit_system(c, &s));
    must(ns_circuit_rest(c, w0));
    must(ns_march_create(s, &o, &m, NULL));
    must(ns_march_start(m, 0, w0));
    must(ns_march_try(m, end, NS_TO_TIME, &reached));
    must(ns_march_accept(m));
    must(ns_march_read(m, NULL, x, NULL, NULL));
    out.seconds = now() - since;
    out.v = x[ns_circuit_node_unknown(c, 3)];
    out.events = ns_march_counts(m)->events;
    out.modes = ns_march_counts(m)->modes;
    out.islands = ns_march_counts(m)->islands;
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    return out;
}

int main(void) {
    printf("diode bucks at one supply, periods without a common one, 2 ms, by auto\n");
    printf("%-10s %8s | %9s %7s %10s | %9s %7s | %6s %9s\n", "converters", "events", "apart, ms", "modes",
           "us/event", "whole, ms", "modes", "ratio", "apart - whole, V");
    for (int n = 1; n <= MOST; n++) {
        double seconds[2][TURNS];
        outcome got[2];
        for (int turn = 0; turn < TURNS; turn++)
            for (int whole = 0; whole < 2; whole++) {
                got[whole] = run(n, whole);
                seconds[whole][turn] = got[whole].seconds;
            }
        const double apart = median(TURNS, seconds[0]), whole = median(TURNS, seconds[1]);
        printf("%-10d %8ld | %9.3f %7ld %10.3f | %9.3f %7ld | %6.2f %9.1e\n", n, got[0].events, apart * 1e3,
               got[0].modes, apart * 1e6 / (double)got[0].events, whole * 1e3, got[1].modes, whole / apart,
               fabs(got[0].v - got[1].v));
    }
    return 0;
}
