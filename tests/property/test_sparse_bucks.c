/* tests/property/test_sparse_bucks.c - random buck converters of one to three phases by the sparse marcher
 * against exact.
 *
 * The supply jumps, freewheel diodes may have a drop, gates are timed: at each closing of a switch supply,
 * switch and diode are a loop of sources that contradict each other until the diode opens.  Beside it, a
 * rectifier and a switched filter at the same supply, or not.
 */
#include <stdio.h>

#include "dice.h"
#include "rig.h"
#include "runs.h"
#include "signals.h"

enum { RUNS = FEWER_IF_SANITIZED(2000), INSTANTS = 10, PHASES = 3 };
enum { SUPPLY = 1, OUT, PEAK, CHOPPED, FILTERED, GATE = 10, NODE = 20 };
static const double period = 16.8e-6, last = 200e-6;

typedef struct buck {
    double l[PHASES], c, r, delay, on; /* H, F, ohm, s, s */
    double leak, edges;                /* of diodes, ohm; of gates, s */
    int phases, beside;                /* 0 .. 2 parts */
} buck;

static buck draw(unsigned long long seed) {
    dice d = dice_make(17, seed);
    buck b;
    b.phases = 1 + dice_below(&d, PHASES);
    for (int i = 0; i < PHASES; i++)
        b.l[i] = dice_decades(&d, -5, -3);
    b.c = dice_decades(&d, -7, -4);
    b.r = dice_decades(&d, 0, 3);
    b.delay = 10e-6 * dice_uniform(&d);
    b.on = 10e-6 * (0.1 + 0.5 * dice_uniform(&d));
    b.leak = dice_below(&d, 2) ? INFINITY : 1e6;
    b.edges = dice_below(&d, 2) ? 10e-9 : 0;
    b.beside = dice_below(&d, 3);
    return b;
}

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};

static void add_rectifier(ns_circuit *c) {
    const ns_diode ideal = {.vf = 0, .ron = 0, .roff = INFINITY, .vz = INFINITY};
    ok(ns_circuit_diode(c, "d2", SUPPLY, PEAK, &ideal, NULL));
    ok(ns_circuit_capacitor(c, "c2", PEAK, 0, 650e-9, NAN, NULL));
    ok(ns_circuit_resistor(c, "r2", PEAK, 0, 813, NULL));
}

static void add_filter(ns_circuit *c) {
    ok(ns_circuit_switch(c, "s3", SUPPLY, CHOPPED, GATE, 0, &contact, NULL));
    ok(ns_circuit_resistor(c, "r3", CHOPPED, FILTERED, 2.4, NULL));
    ok(ns_circuit_capacitor(c, "c3", FILTERED, 0, 290e-9, NAN, NULL));
    ok(ns_circuit_resistor(c, "r4", FILTERED, 0, 26, NULL));
}

static void add_phase(ns_circuit *c, const buck *b, int i) {
    static const char *const name[PHASES][4] = {
        {"ga", "sa", "da", "la"}, {"gb", "sb", "db", "lb"}, {"gc", "sc", "dc", "lc"}};
    const ns_diode drop = {.vf = b->beside ? 0.5 : 0, .ron = 0, .roff = b->leak, .vz = INFINITY};
    const ns_signal gate = pulse(0, 1, b->delay + period * i / b->phases, b->edges, b->edges, b->on, period);
    ok(ns_circuit_source(c, name[i][0], NS_VOLTAGE, GATE + i, 0, &gate, NULL));
    ok(ns_circuit_switch(c, name[i][1], SUPPLY, NODE + i, GATE + i, 0, &contact, NULL));
    ok(ns_circuit_diode(c, name[i][2], 0, NODE + i, &drop, NULL));
    ok(ns_circuit_inductor(c, name[i][3], NODE + i, OUT, b->l[i], NAN, NULL));
}

static ns_circuit *build(const buck *b) {
    const ns_signal supply = pulse(10, 20, 3.2e-6, 0, 0, 4e-6, 20e-6);
    ns_circuit *c = NULL;
    ok(ns_circuit_create(&c));
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, SUPPLY, 0, &supply, NULL));
    for (int i = 0; i < b->phases && i < PHASES; i++)
        add_phase(c, b, i);
    ok(ns_circuit_capacitor(c, "c", OUT, 0, b->c, NAN, NULL));
    ok(ns_circuit_resistor(c, "r", OUT, 0, b->r, NULL));
    if (b->beside > 0)
        add_rectifier(c);
    if (b->beside > 1)
        add_filter(c);
    return c;
}

/* out (INSTANTS): the output, V. */
static void run(const buck *b, ns_method method, double *out) {
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .h = 1e-6, .method = method, .whole = 1, .reltol = 1e-10};
    rig at = {.c = build(b)};
    make_by(&at, &o);
    start_at_rest(&at);
    for (int k = 0; k < INSTANTS; k++) {
        go(&at, last * (k + 1) / INSTANTS);
        out[k] = at.x[ns_circuit_node_unknown(at.c, OUT)];
    }
    end(&at);
}

static void bucks(void **state) {
    double worst = 0;
    (void)state;
    for (unsigned long long seed = 1; seed <= RUNS; seed++) {
        const buck b = draw(seed);
        double exact[INSTANTS], got[INSTANTS];
        run(&b, NS_EXACT, exact);
        run(&b, NS_SPARSE, got);
        for (int k = 0; k < INSTANTS; k++) {
            const double off = fabs(got[k] - exact[k]);
            if (!(off < 1e-6))
                fail_msg("buck %llu at %g s: %.9g V by sparse, %.9g V by exact", seed,
                         last * (k + 1) / INSTANTS, got[k], exact[k]);
            worst = fmax(worst, off);
        }
    }
    printf("%d bucks, at most %.1e V off\n", RUNS, worst);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(bucks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
