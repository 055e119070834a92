/* tests/unit/march/test_floating_charges.c - operating points of parts that capacitors alone tie to the rest,
 * by every method: they have no charge.  10 V, 1 nF to a part of a diode or a coil and a resistor, and 1 uF
 * from there to ground: the part is at 10 V 1/(1 + 1000), wherever its devices block or conduct nothing.
 * Sparse refused them.
 */
#include "rig.h"
#include "signals.h"

enum { SUPPLY = 1, ONE, OTHER, ELSEWHERE };

typedef enum joint { DIODE, LEAKY, REVERSED, COIL, RESISTOR } joint;
enum { JOINTS = RESISTOR + 1 };

/* From ONE to OTHER; where it is no device, one stands elsewhere, for there is none else. */
static void put_joint(ns_circuit *c, joint is) {
    const ns_diode diode = {.roff = is == LEAKY ? 1e9 : INFINITY, .vz = INFINITY};
    int status = NS_OK;
    if (is == COIL)
        status = ns_circuit_inductor(c, "l", ONE, OTHER, 1e-3, NAN, NULL);
    else if (is == RESISTOR)
        status = ns_circuit_resistor(c, "r2", ONE, OTHER, 50, NULL);
    else
        status = ns_circuit_diode(c, "d", is == REVERSED ? OTHER : ONE, is == REVERSED ? ONE : OTHER, &diode,
                                  NULL);
    assert_int_equal(status, NS_OK);
    if (is == COIL || is == RESISTOR) {
        assert_int_equal(ns_circuit_diode(c, "d", SUPPLY, ELSEWHERE, &diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, "r3", ELSEWHERE, 0, 1e3, NULL), NS_OK);
    }
}

static void by(ns_method method, joint is) {
    const ns_signal supply = dc(10);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    rig k = begin();
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, SUPPLY, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", SUPPLY, ONE, 1e-9, NAN, NULL), NS_OK);
    put_joint(k.c, is);
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", OTHER, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r", ONE, OTHER, 1e3, NULL), NS_OK);
    make_by(&k, &o);
    assert_int_equal(ns_march_start_dc(k.m, 0, 0, NULL, NULL, k.x), NS_OK);
    go(&k, 1e-4);
    for (int node = ONE; node <= OTHER; node++)
        assert_true(fabs(k.x[ns_circuit_node_unknown(k.c, node)] - 10.0 / 1001) < 1e-9);
    end(&k);
}

static void no_charge(void **state) {
    (void)state;
    static const ns_method all[] = {NS_AUTO, NS_EXACT, NS_SPARSE, NS_THETA};
    for (size_t m = 0; m < sizeof all / sizeof *all; m++)
        for (int is = 0; is < JOINTS; is++)
            by(all[m], (joint)is);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_charge)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
