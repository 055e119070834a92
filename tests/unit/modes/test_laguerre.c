/* tests/unit/modes/test_laguerre.c - the coefficients that steps and their dense output are made of. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "modes/laguerre.h"

/* The bounds of L_i hold, and promise nothing that is not there: the largest is within a thousandth. */
static void bounds_are_bounds(void **state) {
    (void)state;
    double most[NS_ORDER] = {0}, c[NS_ORDER];
    for (int k = 0; k <= 100000; k++) {
        ns_modes_laguerre(NS_POLE * k / 100000, NS_ORDER, c);
        for (int i = 0; i < NS_ORDER; i++)
            most[i] = fmax(most[i], fabs(c[i]));
    }
    for (int i = 0; i < NS_ORDER; i++)
        assert_true(most[i] <= ns_modes_laguerre_max[i] && most[i] > 0.999 * ns_modes_laguerre_max[i]);
}

/* Of w' = a w: D = z/(1 - z), z = g a, E = 1 + D.  (E2) is exp(tau a), (E1), times E, too, to the rounding
 * of some terms of size 1 for |h a| <= NS_REACH, growing or dying out. */
static void they_are_exponentials(void **state) {
    (void)state;
    static const double rates[] = {-NS_REACH, -NS_REACH / 3, NS_REACH};
    for (int k = 0; k < 3; k++)
        for (int part = 0; part <= 8; part++) {
            const double z = rates[k] / NS_POLE, D = z / (1 - z), s = NS_POLE * part / 8;
            double c[NS_ORDER], b[NS_ORDER + 1], one = 0, two = 0, power = 1;
            ns_modes_laguerre(s, NS_ORDER, c);
            ns_modes_laguerre_steps(s, b);
            for (int i = 0; i <= NS_ORDER; i++, power *= D) {
                one += i < NS_ORDER ? c[i] * power : 0;
                two += b[i] * power;
            }
            assert_true(fabs(two - exp(s * z)) < 1e-15);
            assert_true(fabs(one / (1 - z) - exp(s * z)) < 2e-15);
        }
}

/* What is infinitely fast is gone after a whole step: D = -1, and the sum of b_i (-1)^i is L_8 = 0. */
static void what_is_fast_is_gone(void **state) {
    (void)state;
    double b[NS_ORDER + 1], sum = 0;
    ns_modes_laguerre_steps(NS_POLE, b);
    for (int i = 0; i <= NS_ORDER; i++)
        sum += i % 2 ? -b[i] : b[i];
    assert_true(fabs(sum) < 1e-14);
}

/* Of a step far shorter than g: b_i = (-1)^(i+1) s (1 - (i-1) s/2 + ...), to a few roundings of that. */
static void short_steps_keep_their_digits(void **state) {
    (void)state;
    double b[NS_ORDER + 1];
    double s = 7e-9;
    for (int k = 0; k < 9; k++) { /* down to 1.7e-16 */
        s /= 7;
        ns_modes_laguerre_steps(s, b);
        for (int i = 1; i <= NS_ORDER; i++) {
            const double wanted = (i % 2 ? s : -s) * (1 - (i - 1) * s / 2);
            assert_true(fabs(b[i] - wanted) < 4e-15 * s);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_are_bounds),
        cmocka_unit_test(they_are_exponentials),
        cmocka_unit_test(what_is_fast_is_gone),
        cmocka_unit_test(short_steps_keep_their_digits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
