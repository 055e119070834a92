/* tests/unit/sparse/test_equivalent_mode.c - which pairs across switches share the factors of the closed
 * switch: those whose y and lambda are the switch's own but for signs, without a resistance. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/equivalent_mode.h"
#include "wrap_alloc.h"

/* x' = -x + lambda_0 + flow lambda_1, y_0 = x, pair 0 a switch; y_1 = volts x + ohm lambda_1, lambda_1 >= 0:
 * how many are equivalent; the first one. */
static int equivalents(double flow, double volts, double ohm, ns_equivalent *first) {
    ns_system *s;
    ns_form *f;
    ns_shared_branch *shared;
    ns_equivalents e;
    int count;
    assert_int_equal(ns_system_create(1, 2, 1, 1, &s), NS_OK);
    s->M[0] = s->B[0] = s->C[0] = 1;
    s->A[0] = -1;
    s->B[1] = flow;
    s->C[1] = volts;
    s->D[3] = ohm;
    s->l[0] = -INFINITY;
    s->u[0] = s->u[1] = INFINITY;
    s->command[0] = (ns_command){.pair = 0, .on = 0.5, .off = 0.5};
    s->command[0].gz = calloc(1, sizeof(double));
    assert_non_null(s->command[0].gz);
    s->command[0].gz[0] = 1;
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    assert_int_equal(ns_modes_shared_find(s, &shared, &count), NS_OK);
    assert_int_equal(count, 1);
    assert_int_equal(ns_sparse_equivalent_create(f, shared, count, &e), NS_OK);
    const int found = e.count;
    if (found > 0)
        *first = e.all[0];
    ns_sparse_equivalent_free(&e);
    free(shared);
    ns_sparse_form_free(f);
    ns_system_free(s);
    return found;
}

static void what_is_equivalent(void **state) {
    ns_equivalent e = {0};
    (void)state;
    assert_int_equal(equivalents(1, 1, 0, &e), 1);
    assert_true(e.pair == 1 && e.of == 0 && e.y == 1 && e.lambda == 1);
    assert_int_equal(equivalents(-1, -1, 0, &e), 1);
    assert_true(e.pair == 1 && e.of == 0 && e.y == -1 && e.lambda == -1);
    assert_int_equal(equivalents(-1, -1, 0.1, &e), 0);
}

/* Whichever of its arrays there is no memory for. */
static void no_memory(void **state) {
    ns_system *s;
    ns_form *f;
    ns_equivalents e;
    long k = 1;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    for (;; k++) {
        fail_alloc_at(k);
        const int status = ns_sparse_equivalent_create(f, NULL, 0, &e);
        const long tried = allocs_made();
        fail_alloc_off();
        ns_sparse_equivalent_free(&e);
        if (tried < k) {
            assert_int_equal(status, NS_OK);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
    }
    assert_int_equal(k, 5); /* four arrays */
    ns_sparse_form_free(f);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_equivalent), cmocka_unit_test(no_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
