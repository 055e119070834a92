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

#include "engine/sparse_march.h"
#include "lit_rectifiers.h"

/* Steps are good to 1e-11 of the largest charge; the exact ones are good to 1e-10 or so. */
static const double close_enough = 1e-8;

static double worst_of(lit_rectifier which, int by_hand) {
    const lit_run *run = lit_run_of(which);
    double *exact = calloc((size_t)run->samples * LIT_OUT, sizeof *exact);
    double w0[LIT_X] = {0}, x[LIT_X], out[LIT_OUT], reached, worst = 0;
    ns_circuit *c = NULL;
    ns_system *s = NULL;
    ns_sparse *m;
    assert_non_null(exact);
    lit_exact(which, exact);
    if (by_hand) {
        s = lit_hand(which, w0);
    } else {
        c = lit_netlist(which);
        assert_int_equal(ns_circuit_system(c, &s), NS_OK);
        assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    }
    const ns_sparse_options o = {run->every, 1e-11, 0};
    assert_int_equal(ns_sparse_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_sparse_start(m, 0, w0), NS_OK);
    for (int i = 1; i <= run->samples; i++) {
        const int status = ns_sparse_try(m, i * run->every, NS_TO_TIME, &reached);
        if (status != NS_OK)
            fail_msg("%s: %s at %g", run->name, ns_status_text(status), ns_sparse_fault(m)->t);
        assert_int_equal(ns_sparse_accept(m), NS_OK);
        assert_int_equal(ns_sparse_read(m, NULL, x, NULL, NULL), NS_OK);
        if (by_hand)
            lit_hand_out(which, x, out);
        else
            lit_netlist_out(which, c, x, out);
        for (int k = 0; k < run->out; k++)
            worst = fmax(worst, fabs(out[k] - exact[(i - 1) * LIT_OUT + k]) / run->scale[k]);
    }
    const ns_counts *n = ns_sparse_counts(m);
    print_message("%-20s %-8s error %.1e, %ld legs, %ld events, %ld factors\n", run->name,
                  by_hand ? "by hand" : "netlist", worst, n->steps, n->events, n->factors);
    ns_sparse_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    free(exact);
    return worst;
}

static void test_all(void **state) {
    (void)state;
    for (int which = 0; which < LIT_RECTIFIERS; which++)
        for (int by_hand = 0; by_hand < 2; by_hand++)
            assert_true(worst_of((lit_rectifier)which, by_hand) < close_enough);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
