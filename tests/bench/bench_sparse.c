/* tests/bench/bench_sparse.c - the sparse engine on chains of cells, charge pumps and ladders: what a step,
 * an event and a circuit cost, as their size grows. */
#include "timing.h"

#include <malloc.h>
#include <math.h>
#include <string.h>

#include "facts.h"
#include "nonsmooth.h"
#include "sparse/sparse.h"

static const double freq = 1000;

static int named(const char *what, int k, char *name) {
    return snprintf(name, 24, "%s%d", what, k);
}

static void pulse(ns_circuit *c, int k, int node, double delay) {
    char name[24];
    ns_signal s = {.kind = NS_PULSE};
    s.u.pulse.v2 = 1;
    s.u.pulse.td = delay;
    s.u.pulse.tr = s.u.pulse.tf = 1e-7;
    s.u.pulse.pw = 0.5 / freq;
    s.u.pulse.per = 1 / freq;
    named("vg", k, name);
    must(ns_circuit_source(c, name, NS_VOLTAGE, node, 0, &s, NULL));
}

/* n/2 cells in series: a capacitor that one switch puts into the chain and another one bypasses; each cell
 * with a gate and a delay of its own; the chain from a source through an inductor and a resistor. */
static ns_circuit *chain(int n) {
    const int cells = n / 2;
    const ns_switch in = {0.5, 0, 1e-3, 1e9}, by = {-0.5, 0, 1e-3, 1e9};
    const ns_signal volts = {.kind = NS_DC, .u.dc = 10.0 * cells};
    char name[24];
    ns_circuit *c;
    must(ns_circuit_create(&c));
    must(ns_circuit_source(c, "vin", NS_VOLTAGE, 1, 0, &volts, NULL));
    must(ns_circuit_inductor(c, "l", 1, 2, 1e-4 * cells, NAN, NULL));
    must(ns_circuit_resistor(c, "r", 2, 3, 1.0 * cells, NULL));
    for (int k = 0; k < cells; k++) {
        const int top = 3 + 3 * k, bottom = k + 1 < cells ? top + 3 : 0, cap = top + 1, gate = top + 2;
        pulse(c, k, gate, k / (freq * cells));
        named("sin", k, name);
        must(ns_circuit_switch(c, name, top, cap, gate, 0, &in, NULL));
        named("sby", k, name);
        must(ns_circuit_switch(c, name, top, bottom, 0, gate, &by, NULL));
        named("c", k, name);
        must(ns_circuit_capacitor(c, name, cap, bottom, 1e-3, 20, NULL));
    }
    return c;
}

/* Cockcroft and Walton's pump: two columns of capacitors, diodes between them. */
static ns_circuit *pump(int stages) {
    const ns_diode diode = {0, 0, 1e12, INFINITY, 0};
    ns_signal sine = {.kind = NS_SIN};
    char name[24];
    ns_circuit *c;
    sine.u.sin.va = 10;
    sine.u.sin.freq = freq;
    must(ns_circuit_create(&c));
    must(ns_circuit_source(c, "vin", NS_VOLTAGE, 1, 0, &sine, NULL));
    must(ns_circuit_resistor(c, "r", 1, 2, 10, NULL));
    for (int k = 0; k < stages; k++) { /* column nodes: 2+2k (driven), 3+2k (output, 1 below it is ground) */
        const int a = 2 + 2 * k, b = k > 0 ? 1 + 2 * k : 0, a1 = a + 2, b1 = 3 + 2 * k;
        named("ca", k, name);
        must(ns_circuit_capacitor(c, name, a, a1, 1e-6, NAN, NULL));
        named("cb", k, name);
        must(ns_circuit_capacitor(c, name, b, b1, 1e-6, NAN, NULL));
        named("da", k, name);
        must(ns_circuit_diode(c, name, b, a1, &diode, NULL));
        named("db", k, name);
        must(ns_circuit_diode(c, name, a1, b1, &diode, NULL));
    }
    must(ns_circuit_resistor(c, "rl", 1 + 2 * stages, 0, 1e6, NULL));
    return c;
}

/* A line of resistors and capacitors, from each node a diode to a rail of its own. */
static ns_circuit *ladder(int n) {
    const ns_diode diode = {0, 1e-2, 1e9, INFINITY, 0};
    ns_signal sine = {.kind = NS_SIN};
    char name[24];
    ns_circuit *c;
    sine.u.sin.va = 10;
    sine.u.sin.freq = freq;
    must(ns_circuit_create(&c));
    must(ns_circuit_source(c, "vin", NS_VOLTAGE, 1, 0, &sine, NULL));
    for (int k = 0; k < n; k++) {
        named("r", k, name);
        must(ns_circuit_resistor(c, name, k + 1, k + 2, 10, NULL));
        named("c", k, name);
        must(ns_circuit_capacitor(c, name, k + 2, 0, 1e-6, NAN, NULL));
        named("d", k, name);
        must(ns_circuit_diode(c, name, k + 2, 0, &diode, NULL));
    }
    return c;
}

static double megabytes(void) {
    const struct mallinfo2 i = mallinfo2();
    return (double)(i.uordblks + i.hblkhd) / 1048576;
}

typedef struct cost {
    double step, bytes; /* s a leg */
} cost;

static cost run(const char *what, ns_circuit *c, int devices, double h, double reltol, double end) {
    ns_system *s;
    ns_engine *m;
    double reached;
    const ns_sparse_options o = {.h = h, .reltol = reltol};
    const double t0 = now(), before = megabytes();
    must(ns_circuit_system(c, &s));
    const double t1 = now();
    must(ns_sparse_create(s, &o, &m, NULL));
    double *w0 = room(sizeof(double) * (size_t)s->n);
    must(ns_circuit_rest(c, w0));
    const double t2 = now();
    must(m->table->start(m, 0, w0, NULL));
    const double t3 = now();
    const int status = m->table->try_to(m, end, NS_TO_TIME, &reached);
    const double t4 = now();
    const ns_counts *k = m->table->counts(m);
    printf("%-7s %6d devices %6d unknowns: %8.2f ms netlist, %8.2f ms set up, %8.2f ms start, %9.2f ms run, "
           "%6ld legs, %6ld events, %6ld pivots, %6ld factors, %4ld trials, %7.2f us/leg/device, %7.1f "
           "MiB%s%s\n",
           what, devices, s->n, 1e3 * (t1 - t0), 1e3 * (t2 - t1), 1e3 * (t3 - t2), 1e3 * (t4 - t3), k->steps,
           k->events, k->pivots, k->factors, k->trials, 1e6 * (t4 - t3) / (double)k->steps / devices,
           megabytes() - before, status ? ": " : "", status ? ns_status_text(status) : "");
    const cost costs = {(t4 - t3) / (double)k->steps, (megabytes() - before) * 1048576};
    m->table->free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    free(w0);
    return costs;
}

/* Steps of the scheme, theta = 1, by a marcher: some hundred from each call to the next, the median of those.
 */
static void steps(ns_circuit *c, int devices, double h, int count) {
    enum { CALLS = 40 };
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = NS_THETA, .capture = 1};
    double times[CALLS], reached;
    ns_system *s;
    ns_march *m;
    must(ns_circuit_system(c, &s));
    must(ns_march_create(s, &o, &m, NULL));
    double *w0 = room(sizeof(double) * (size_t)s->n);
    must(ns_circuit_rest(c, w0));
    must(ns_march_start(m, 0, w0));
    for (int i = 0; i < CALLS; i++) {
        const long before = ns_march_counts(m)->steps;
        const double start = now();
        must(ns_march_try(m, (i + 1) * h * count / CALLS, NS_TO_TIME, &reached));
        must(ns_march_accept(m));
        times[i] = (now() - start) / (double)(ns_march_counts(m)->steps - before);
    }
    const double step = median(CALLS, times);
    const ns_counts *k = ns_march_counts(m);
    char what[48];
    snprintf(what, sizeof what, "theta step at %d devices", devices);
    fact_put(what, step);
    printf(
        "theta   %6d devices %6d unknowns: %8.2f us a step, %ld steps, %ld events, %ld pivots, %ld factors\n",
        devices, s->n, 1e6 * step, k->steps, k->events, k->pivots, k->factors);
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    free(w0);
}

int main(int argc, char **argv) {
    const int most = argc > 1 ? atoi(argv[1]) : 10000;
    double sizes[8] = {0}, times[8] = {0}, bytes[8] = {0};
    int count = 0;
    for (int n = 16; n <= most && count < 8; n = n < 10000 && 4 * n > 10000 ? 10000 : 4 * n) {
        const cost costs = run("chain", chain(n), n, 1e-4, 1e-9, 20 / (freq * n) + 1e-6);
        sizes[count] = n;
        times[count] = costs.step;
        bytes[count++] = costs.bytes;
    }
    fact_put("chains time", growth(count, sizes, times));
    fact_put("chains memory", growth(count, sizes, bytes));
    fact_put("chains largest", count > 0 ? sizes[count - 1] : 0);
    const int pumps[] = {5, 20, 50};
    for (int i = 0; i < 3 && pumps[i] <= most; i++) {
        const int stages = pumps[i];
        for (int fine = 0; fine < 2; fine++)
            run(fine ? "pump-9" : "pump-7", pump(stages), 2 * stages, 1e-4, fine ? 1e-9 : 1e-7, 10e-3);
    }
    for (int n = 20; n <= most; n *= n == 20 ? 16 : 8)
        steps(ladder(n), n, 1e-6, n > 1000 ? 400 : 4000);
    return 0;
}
