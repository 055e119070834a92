/* tests/reference/test_sparse_rectifiers.c - the diode circuits of the literature by the sparse engine,
 * against their exact waveforms. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "lit_rectifiers.h"
#include "sparse/sparse_internal.h"

/* Steps are good to 1e-11 of the largest charge; the exact ones are good to 1e-10 or so. */
static const double close_enough = 1e-8;

/* Steps of h at most; *steps gets their number. */
static double worst_of(lit_rectifier which, int by_hand, double h, double reltol, long *steps) {
    const lit_run *run = lit_run_of(which);
    double *exact = calloc((size_t)run->samples * LIT_OUT, sizeof *exact);
    double w0[LIT_X] = {0}, x[LIT_X], out[LIT_OUT], reached, worst = 0;
    ns_circuit *c = NULL;
    ns_system *s = NULL;
    ns_engine *m;
    assert_non_null(exact);
    lit_exact(which, exact);
    if (by_hand) {
        s = lit_hand(which, w0);
    } else {
        c = lit_netlist(which);
        assert_int_equal(ns_circuit_system(c, &s), NS_OK);
        assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    }
    const ns_sparse_options o = {.h = h, .reltol = reltol};
    assert_int_equal(ns_sparse_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(m->table->start(m, 0, w0, NULL), NS_OK);
    for (int i = 1; i <= run->samples; i++) {
        const int status = m->table->try_to(m, i * run->every, NS_TO_TIME, &reached);
        if (status != NS_OK)
            fail_msg("%s: %s at %g", run->name, ns_status_text(status), ns_engine_fault(m)->t);
        assert_int_equal(ns_engine_accept(m), NS_OK);
        assert_int_equal(ns_engine_read(m, NULL, x, NULL, NULL), NS_OK);
        if (by_hand)
            lit_hand_out(which, x, out);
        else
            lit_netlist_out(which, c, x, out);
        for (int k = 0; k < run->out; k++)
            worst = fmax(worst, fabs(out[k] - exact[(i - 1) * LIT_OUT + k]) / run->scale[k]);
    }
    const ns_counts *n = m->table->counts(m);
    print_message("%-20s %-8s error %.1e, %ld steps, %ld events, %ld factors\n", run->name,
                  by_hand ? "by hand" : "netlist", worst, n->steps, n->events, n->factors);
    *steps = n->steps;
    m->table->free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    free(exact);
    return worst;
}

static void test_all(void **state) {
    (void)state;
    long steps;
    for (int which = 0; which < LIT_RECTIFIERS; which++)
        for (int by_hand = 0; by_hand < 2; by_hand++) {
            const double h = lit_run_of((lit_rectifier)which)->every;
            assert_true(worst_of((lit_rectifier)which, by_hand, h, 1e-11, &steps) < close_enough);
        }
}

/* The error is what was asked for: ten times reltol, for there are many steps; below 1e-10 that of the exact
 * waveforms is seen. */
static void test_reltol(void **state) {
    (void)state;
    static const lit_rectifier circuits[] = {LIT_RLCD, LIT_BRIDGE, LIT_RESONANT};
    for (int k = 0; k < 3; k++) {
        const double h = 50 * lit_run_of(circuits[k])->every;
        long rough = 0, steps = 0;
        for (int digits = 4; digits <= 11; digits++) {
            const double reltol = pow(10, -digits), error = worst_of(circuits[k], 0, h, reltol, &steps);
            assert_true(error < 10 * reltol + 1e-10);
            if (digits == 4)
                rough = steps;
        }
        assert_true(steps > 2 * rough);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all),
        cmocka_unit_test(test_reltol),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
