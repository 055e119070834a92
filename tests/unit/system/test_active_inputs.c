/* tests/unit/system/test_active_inputs.c - which inputs something depends on that happens. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth/system.h"
#include "system/active_inputs.h"
#include "wrap_alloc.h"

/* Two unknowns, one pair, one input, and a command of time of that pair if commanded. */
static ns_system *bare(int commanded) {
    ns_system *s;
    assert_int_equal(ns_system_create(2, 1, 1, commanded, &s), NS_OK);
    s->A[0] = s->A[3] = -1;
    for (int c = 0; c < commanded; c++) {
        s->command[c].gx = NULL;
        s->command[c].gz = calloc(1, sizeof(double));
        assert_non_null(s->command[c].gz);
    }
    return s;
}

static void expect(ns_system *s, int active) {
    unsigned char is = 7;
    assert_int_equal(ns_system_active_inputs(s, &is), NS_OK);
    assert_int_equal(is, active);
    ns_system_free(s);
}

static void by_states(void **state) {
    (void)state;
    ns_system *s = bare(0);
    s->E[0] = 1; /* x0 only follows */
    expect(s, 0);
    s = bare(0);
    s->E[0] = s->M[3] = 1; /* x1 is a state, and has nothing to do with x0, */
    expect(s, 0);
    s = bare(0);
    s->E[0] = s->M[3] = s->A[1] = 1; /* until x0 acts on it, */
    expect(s, 1);
    s = bare(0);
    s->E[0] = s->M[3] = s->A[2] = 1; /* or it on the row of x0 */
    expect(s, 1);
    s = bare(0);
    s->E[0] = s->M[2] = 1; /* a state in its own row */
    expect(s, 1);
}

static void by_pairs(void **state) {
    (void)state;
    ns_system *s = bare(0);
    s->F[0] = 1; /* the pair has a law */
    expect(s, 1);
    s = bare(1);
    s->F[0] = 1; /* it is a switch that time commands */
    expect(s, 0);
    s = bare(0);
    s->E[0] = s->B[0] = 1; /* lambda acts on x0, which no law sees */
    expect(s, 0);
    s = bare(0);
    s->E[0] = s->C[0] = 1; /* y sees x0 */
    expect(s, 1);
    s = bare(1);
    s->E[0] = s->C[0] = 1;
    expect(s, 0);
    s = bare(1);
    s->F[0] = s->D[0] = s->M[0] = s->B[0] = 1; /* the switch stands at a state */
    expect(s, 1);
    s = bare(1);
    s->F[0] = s->D[0] = s->M[0] = s->B[1] = 1; /* elsewhere */
    expect(s, 0);
}

static void by_commands(void **state) {
    (void)state;
    ns_system *s = bare(1);
    s->command[0].gz[0] = 1; /* of time only */
    expect(s, 0);
    s = bare(1);
    s->E[0] = 1;
    s->command[0].gx = calloc(2, sizeof(double));
    assert_non_null(s->command[0].gx);
    s->command[0].gx[0] = 1; /* a command looks at what follows the input */
    expect(s, 1);
    s = bare(1);
    s->E[0] = 1;
    s->command[0].gx = calloc(2, sizeof(double));
    assert_non_null(s->command[0].gx);
    s->command[0].gx[1] = 1; /* at something else, */
    expect(s, 0);
    s = bare(1);
    s->command[0].gx = calloc(2, sizeof(double));
    assert_non_null(s->command[0].gx);
    s->command[0].gx[1] = s->command[0].gz[0] = 1; /* and at the input itself */
    expect(s, 1);
}

/* x0 follows the input, x1 is a state of its own. */
static void by_looks(void **state) {
    (void)state;
    static const struct {
        unsigned char looked[3], followed;
    } cases[] = {{{0, 0, 0}, 0}, {{0, 1, 1}, 0}, {{1, 0, 0}, 1}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ns_system *s = bare(0);
        unsigned char is = 7;
        s->E[0] = s->M[3] = 1;
        assert_int_equal(ns_system_followed_inputs(s, cases[k].looked, &is), NS_OK);
        assert_int_equal(is, cases[k].followed);
        s->A[1] = 1; /* x0 acts on the state: it is followed, whatever is looked at */
        assert_int_equal(ns_system_followed_inputs(s, cases[k].looked, &is), NS_OK);
        assert_int_equal(is, 1);
        ns_system_free(s);
    }
    /* looked at: lambda of a switch commanded by time; its y contains the input (F): the input is followed */
    const unsigned char looked[3] = {0, 0, 1};
    ns_system *s = bare(1);
    unsigned char is = 7;
    s->F[0] = 1;
    assert_int_equal(ns_system_followed_inputs(s, looked, &is), NS_OK);
    assert_int_equal(is, 1);
    ns_system_free(s);
}

static void no_memory(void **state) {
    ns_system *s = bare(0);
    unsigned char is;
    (void)state;
    for (long k = 1; k <= 3; k++) {
        fail_alloc_at(k);
        assert_int_equal(ns_system_active_inputs(s, &is), NS_E_MEMORY);
        fail_alloc_off();
    }
    expect(s, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_states), cmocka_unit_test(by_pairs),  cmocka_unit_test(by_commands),
        cmocka_unit_test(by_looks),  cmocka_unit_test(no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
