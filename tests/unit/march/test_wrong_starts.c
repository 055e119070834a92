/* tests/unit/march/test_wrong_starts.c - each kind of wrong start, planted in each engine, is caught.
 *
 * The engine of a run is replaced by one that starts it with something changed, or changes what it shows of
 * the start.  The start has to be as if nothing had been changed.
 */
#include "retries.h"
#include "rig.h"

#include <stdio.h>
#include <string.h>

#include "march/run_internal.h"
#include "signals.h"

/* What is changed: a tenth of all charges and fluxes is lost before the start; a current of a diode; a
 * voltage, by 1 %; a number; y; the sign of the impulse, its size, by 1 %; the operating point, by a tenth;
 * what is started from in place of it; an unknown that is not held. */
typedef enum lie {
    LOST,
    LAMBDA,
    VOLTAGE,
    NOT_A_NUMBER,
    WRONG_Y,
    IMPULSE_SIGN,
    IMPULSE_SIZE,
    OPERATING_POINT,
    OTHER_START,
    NOT_HELD,
    LIES
} lie;

typedef struct liar {
    ns_engine engine;
    ns_engine *inner;
    const ns_system *s;
    lie what;
    int unknown;
} liar;

static liar *liar_of(ns_engine *e) {
    return (liar *)(void *)e;
}

static void free_liar(ns_engine *e) {
    liar_of(e)->inner->table->free(liar_of(e)->inner);
    free(e);
}

static ns_engine *inner(const ns_engine *e) {
    return ((const liar *)(const void *)e)->inner;
}

static const ns_counts *counts(ns_engine *e) {
    return inner(e)->table->counts(inner(e));
}

/* --- what is changed --- */

static int start_from(const liar *l, double t0, const double *w0, double times, const unsigned char *closed) {
    double w[64];
    for (int i = 0; i < l->s->n; i++)
        w[i] = times * w0[i];
    return l->inner->table->start(l->inner, t0, w, closed);
}

static int start(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    const liar *l = liar_of(e);
    return start_from(l, t0, w0, l->what == LOST ? 0.9 : 1, closed);
}

static int start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    const liar *l = liar_of(e);
    double w[64];
    const int status =
        l->inner->table->start_dc(l->inner, t0, l->what == NOT_HELD ? 0 : nhold, hold, hold_x, x);
    ns_system_charges(l->s, x, w);
    for (int i = 0; i < l->s->n && l->what == OPERATING_POINT; i++)
        x[i] *= 0.9;
    return status == NS_OK && (l->what == OPERATING_POINT || l->what == OTHER_START)
               ? start_from(l, t0, w, 0.9, NULL)
               : status;
}

static int read_point(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    const liar *l = liar_of(e);
    const int status = ns_engine_read(l->inner, t, x, lambda, y);
    if (x && l->what == VOLTAGE)
        x[l->unknown] *= 1.01;
    if (lambda && l->what == LAMBDA)
        lambda[0] -= 1;
    if (lambda && l->what == NOT_A_NUMBER)
        lambda[0] = NAN;
    if (y && l->what == WRONG_Y)
        y[0] += 0.1;
    return status;
}

static int impulse(ns_engine *e, double *x, double *lambda) {
    const liar *l = liar_of(e);
    const double times = l->what == IMPULSE_SIGN ? -1 : l->what == IMPULSE_SIZE ? 1.01 : 1;
    const int status = ns_engine_impulse(l->inner, x, lambda);
    for (int i = 0; x && i < l->s->n; i++)
        x[i] *= times;
    for (int j = 0; lambda && j < l->s->m; j++)
        lambda[j] *= times;
    return status;
}

static const ns_engine_table table = {.free = free_liar,
                                      .start = start,
                                      .start_dc = start_dc,
                                      .counts = counts,
                                      .read = read_point,
                                      .impulse = impulse,
                                      .at_work = inner};

/* --- a circuit --- */

/* 12 V through a closed switch into 1 ohm, 10 uH and, behind it, 5 ohm beside 1 uF at 10 V, which a diode
 * joins to 3 uF at 0 V: 7.5 uC flow at the start. */
static rig circuit(ns_method by, int *joined) {
    rig k = begin();
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    const ns_signal supply = dc(12), gate = dc(1);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = by, .reltol = 1e-9, .whole = 1};
    assert_int_equal(ns_circuit_diode(k.c, "ad1", 4, 5, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "vg", NS_VOLTAGE, 2, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "as1", 1, 3, 2, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r0", 3, 6, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l1", 6, 4, 10e-6, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", 4, 0, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 4, 0, 1e-6, 10, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", 5, 0, 3e-6, 0, NULL), NS_OK);
    make_by(&k, &o);
    *joined = ns_circuit_node_unknown(k.c, 4);
    return k;
}

static void plant(const rig *k, lie what, int unknown) {
    ns_run *r = (ns_run *)(void *)k->m->engine;
    liar *l = calloc(1, sizeof *l);
    assert_non_null(l);
    *l = (liar){{.table = &table}, r->at_work, k->s, what, unknown};
    r->at_work = &l->engine;
}

static int start_with(rig *k, lie what, int unknown) {
    const double held = 7;
    if (what < OPERATING_POINT) {
        start_at_rest(k);
        return NS_OK;
    }
    return ns_march_start_dc(k->m, 0, what == NOT_HELD, &unknown, &held, NULL);
}

static void planted(ns_method by, lie what) {
    int joined;
    rig honest = circuit(by, &joined), k = circuit(by, &joined);
    plant(&k, what, joined);
    assert_int_equal(start_with(&honest, what, joined), NS_OK);
    assert_int_equal(start_with(&k, what, joined), NS_OK);
    assert_int_equal(ns_march_counts(honest.m)->retries, 0);
    if (ns_march_counts(k.m)->retries != 1)
        fail_msg("engine %d, lie %d: %ld retries", by, what, ns_march_counts(k.m)->retries);
    assert_int_equal(ns_march_read(honest.m, NULL, honest.x, NULL, NULL), NS_OK);
    assert_int_equal(ns_march_read(k.m, NULL, k.x, NULL, NULL), NS_OK);
    for (int i = 0; i < k.s->n; i++)
        if (!(fabs(k.x[i] - honest.x[i]) <= 1e-6 * (1 + fabs(honest.x[i]))))
            fail_msg("engine %d, lie %d: x[%d] = %g, not %g", by, what, i, k.x[i], honest.x[i]);
    end(&honest);
    end(&k);
}

static void planted_starts_are_caught(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA};
    (void)state;
    for (int by = 0; by < 3; by++)
        for (int what = 0; what < LIES; what++)
            planted(methods[by], (lie)what);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planted_starts_are_caught),
    };
    allow_retries(ANY_RETRIES);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
