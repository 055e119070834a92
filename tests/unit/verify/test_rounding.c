/* tests/unit/verify/test_rounding.c - what no double tells from zero is not wrong. */
#include "small_system.h"

/* A diode of 0.44 nohm between two nodes at 237 V, with a current backwards.  237 V are known to 2.8e-14 V,
 * which are 65 uA through it, so 0.1 mA may be rounding; 1 A is 4.4e-10 V, which is none.  (Rectifiers at
 * ideal sources were refused: corners 320011000044 and 330601000049 of the stress set.) */
static void currents_that_are_rounding_of_voltages(void **state) {
    static const double amperes[] = {-1e-4, -1}, ohm = 4.4e-10;
    (void)state;
    for (int i = 0; i < 2; i++) {
        const double x[] = {237 - ohm * amperes[i], 237}, lambda = amperes[i];
        const ns_verify_state at = {0, NS_RIGHT, x, &lambda, NULL, 0};
        ns_system *s;
        ns_verify *v;
        ns_verify_finding f;
        assert_int_equal(ns_system_create(2, 1, 0, 0, &s), NS_OK);
        s->M[0] = s->M[3] = 1;
        s->C[0] = 1;
        s->C[1] = -1;
        s->D[0] = ohm;
        assert_int_equal(ns_verify_create(s, &options, &v), NS_OK);
        assert_int_equal(ns_verify_point(v, &at, &f), i == 0);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(currents_that_are_rounding_of_voltages)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
