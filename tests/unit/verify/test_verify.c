/* tests/unit/verify/test_verify.c - right answers of every engine pass; each kind of wrong one is found. */
#include "rig.h"

#include <string.h>

#include "signals.h"
#include "verify/verify_internal.h"

enum { MOST = 32 };
static const double volts = 12, period = 10e-6;

/* A buck converter: 12 V, a switch by a gate of 10 ns edges, a diode from ground, 100 uH, 22 uF, 5 ohm.  And
 * two capacitors of 1 uF at 10 V and 0 V that the same switch's gate joins through a diode, without
 * resistance. */
typedef struct bench {
    rig k;
    ns_verify *v;
    int as1, l1, c1, c2;
    ns_verify_finding f;
} bench;

static bench open_bench(ns_method method) {
    bench b = {.k = begin()};
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    const ns_signal supply = dc(volts), gate = pulse(0, 1, 2e-6, 10e-9, 10e-9, 4e-6, period);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = method, .reltol = 1e-9};
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 1e-11};
    ns_circuit *c = b.k.c;
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "vg", NS_VOLTAGE, 2, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "as1", 1, 3, 2, 0, &contact, &b.as1), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "ad1", 0, 3, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 3, 4, 100e-6, 1, &b.l1), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 4, 0, 22e-6, 5, &b.c1), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 4, 0, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", 5, 0, 1e-6, 10, &b.c2), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "as2", 5, 6, 2, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "ad2", 6, 7, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c3", 7, 0, 3e-6, 0, NULL), NS_OK);
    make_by(&b.k, &o);
    assert_true(b.k.s->n <= MOST && b.k.s->m <= MOST);
    assert_int_equal(ns_verify_create(b.k.s, &vo, &b.v), NS_OK);
    start_at_rest(&b.k);
    return b;
}

static void close_bench(bench *b) {
    ns_verify_free(b->v);
    end(&b->k);
}

/* --- what an engine shows --- */

typedef struct point {
    double t, x[MOST], lambda[MOST], y[MOST];
    ns_side side;
} point;

static void look(bench *b, point *p, ns_side side) {
    assert_int_equal(ns_march_read(b->k.m, &p->t, p->x, p->lambda, p->y), NS_OK);
    p->side = side;
}

static ns_verify_state state_of(const point *p) {
    return (ns_verify_state){p->t, p->side, p->x, p->lambda, p->y, 0};
}

/* What passes in a hurry is right. */
static int judged(bench *b, const point *p) {
    const ns_verify_state at = state_of(p);
    const int quickly = ns_verify_quick_point(b->v, &at), right = ns_verify_point(b->v, &at, &b->f);
    assert_true(right || !quickly);
    return right;
}

static void to_event(bench *b) {
    double reached;
    assert_int_equal(ns_march_try(b->k.m, 1, NS_TO_EVENT, &reached), NS_OK);
    assert_int_equal(ns_march_accept(b->k.m), NS_OK);
}

/* An event: both its sides, and what jumps. */
typedef struct event {
    point left, right;
    double X[MOST], Lambda[MOST];
} event;

/* The next one. */
static event next_event(bench *b) {
    event e;
    double reached;
    do {
        to_event(b);
    } while (!ns_march_at_event(b->k.m));
    look(b, &e.left, NS_LEFT);
    assert_int_equal(ns_march_try(b->k.m, 1, NS_TO_EVENT, &reached), NS_OK);
    assert_int_equal(ns_march_impulse(b->k.m, e.X, e.Lambda), NS_OK);
    look(b, &e.right, NS_RIGHT);
    assert_int_equal(ns_march_accept(b->k.m), NS_OK);
    return e;
}

static int event_judged(bench *b, const event *e) {
    const ns_verify_state left = state_of(&e->left), right = state_of(&e->right);
    ns_verify_finding f;
    ns_verify_quick_left(b->v, &left);
    const int quickly = ns_verify_quick_point(b->v, &right) && ns_verify_quick_stays(b->v);
    const int is_left = ns_verify_left_in_full(b->v, &f), is_right = ns_verify_point(b->v, &right, &f);
    const int is_event = ns_verify_event(b->v, e->X, e->Lambda, &b->f);
    assert_true((is_left && is_right && is_event) || !quickly);
    return is_event;
}

/* A way on from the accepted point, looked at between parts `from` and `to` of it. */
static void way(bench *b, double from, double to, double *t, double *xl) {
    const size_t n = (size_t)b->k.s->n, m = (size_t)b->k.s->m;
    double begin, end;
    assert_int_equal(ns_march_read(b->k.m, &begin, NULL, NULL, NULL), NS_OK);
    assert_int_equal(ns_march_try(b->k.m, 1, NS_TO_STEP, &end), NS_OK);
    assert_true(end > begin);
    ns_verify_flow_times(begin + from * (end - begin), begin + to * (end - begin), t);
    for (size_t i = 0; i < NS_VERIFY_NODES; i++)
        assert_int_equal(ns_march_sample(b->k.m, t[i], xl + i * (n + m), xl + i * (n + m) + n), NS_OK);
}

/* --- right answers --- */

static void right_answers(void **state) {
    (void)state;
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    for (size_t k = 0; k < 2; k++) {
        bench b = open_bench(methods[k]);
        for (int i = 0; i < 12; i++) {
            double t[NS_VERIFY_NODES], xl[NS_VERIFY_NODES * 2 * MOST];
            const event e = next_event(&b);
            assert_true(judged(&b, &e.left) && judged(&b, &e.right));
            assert_true(event_judged(&b, &e));
            way(&b, 0.2, 0.5, t, xl);
            assert_true(ns_verify_flow(b.v, t, xl, &b.f));
            if (i < 4) /* so much is learnt by then that a look in a hurry is enough */
                continue;
            const ns_verify_state left = state_of(&e.left), right = state_of(&e.right);
            ns_verify_quick_left(b.v, &left);
            assert_true(ns_verify_quick_point(b.v, &right) && ns_verify_quick_stays(b.v));
        }
        close_bench(&b);
    }
}

static void right_answers_of_the_scheme(void **state) {
    (void)state;
    bench b = open_bench(NS_THETA);
    for (int i = 1; i < 200; i++) {
        point p;
        go(&b.k, 1.03e-7 * i);
        look(&b, &p, NS_LEFT);
        assert_true(judged(&b, &p));
    }
    close_bench(&b);
}

/* --- wrong ones --- */

static void expect(bench *b, int right, ns_verify_cause cause) {
    assert_false(right);
    assert_string_equal(ns_verify_text(b->f.cause), ns_verify_text(cause));
    assert_true(b->f.error > ns_verify_wrong);
    assert_true(b->f.pair >= 0 || b->f.unknown >= 0);
}

/* An inductor's current flows, its diode blocks, and the voltage in its way is what it takes. */
static void a_diode_that_blocks_forward_voltage(void **state) {
    (void)state;
    bench b = open_bench(NS_EXACT);
    const event e = next_event(&b); /* the switch closes */
    event off = next_event(&b);     /* and opens */
    assert_true(judged(&b, &e.right) && judged(&b, &off.left) && judged(&b, &off.right));
    point *p = &off.right;
    const int at = ns_circuit_node_unknown(b.k.c, 3);
    p->x[at] = -1e6;
    for (int j = 0; j < b.k.s->m; j++)
        p->y[j] -= j == 1 ? 1e6 : 0;
    const ns_verify_state wrong = {p->t, p->side, p->x, p->lambda, NULL, 0};
    expect(&b, ns_verify_point(b.v, &wrong, &b.f), NS_VERIFY_LAW);
    close_bench(&b);
}

static void kirchhoffs_law(void **state) {
    (void)state;
    bench b = open_bench(NS_EXACT);
    point p;
    (void)next_event(&b);
    go(&b.k, 3e-6);
    look(&b, &p, NS_LEFT);
    assert_true(judged(&b, &p));
    p.x[ns_circuit_current_unknown(b.k.c, b.l1)] *= 1.01; /* more than the switch brings */
    expect(&b, judged(&b, &p), NS_VERIFY_ROW);
    close_bench(&b);
}

static void a_voltage_that_is_not_that_of_the_nodes(void **state) {
    (void)state;
    bench b = open_bench(NS_SPARSE);
    event e = next_event(&b);
    assert_true(judged(&b, &e.left));
    e.left.y[0] += 0.02 * volts;
    expect(&b, judged(&b, &e.left), NS_VERIFY_OUTPUT);
    close_bench(&b);
}

static void a_number_that_is_not_finite(void **state) {
    (void)state;
    bench b = open_bench(NS_EXACT);
    event e = next_event(&b);
    e.right.x[3] = NAN;
    expect(&b, judged(&b, &e.right), NS_VERIFY_NUMBER);
    assert_int_equal(b.f.unknown, 3);
    close_bench(&b);
}

/* Each law holds to the rounding of its terms: of 1e28 V that is more than all there was.  Right after an
 * event that is wrong; on a way numbers may grow so far. */
static void a_number_that_hides_all_others(void **state) {
    (void)state;
    bench b = open_bench(NS_EXACT);
    event e = next_event(&b);
    assert_true(event_judged(&b, &e));
    e.right.x[ns_circuit_node_unknown(b.k.c, 3)] = 1e28;
    expect(&b, event_judged(&b, &e), NS_VERIFY_NUMBER);
    assert_int_equal(b.f.unknown, ns_circuit_node_unknown(b.k.c, 3));
    close_bench(&b);
}

/* The left side of an event shown as the right side a little later: the gate is high, the switch is open. */
static void a_switch_against_its_control(void **state) {
    (void)state;
    bench b = open_bench(NS_EXACT);
    event e = next_event(&b);
    assert_true(judged(&b, &e.left) && judged(&b, &e.right));
    e.left.t += 9e-9;
    e.left.x[ns_circuit_node_unknown(b.k.c, 2)] = 1;
    expect(&b, judged(&b, &e.left), NS_VERIFY_COMMAND);
    close_bench(&b);
}

/* Nothing carries what is lost: 1 % of a capacitor's charge, all of an inductor's current. */
static void a_charge_that_is_lost(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        bench b = open_bench(NS_EXACT);
        (void)next_event(&b);
        event e = next_event(&b); /* the switch opens */
        assert_true(event_judged(&b, &e));
        if (k == 0)
            e.right.x[ns_circuit_node_unknown(b.k.c, 4)] *= 0.99;
        else
            e.right.x[ns_circuit_current_unknown(b.k.c, b.l1)] = 0;
        expect(&b, event_judged(&b, &e), NS_VERIFY_JUMP);
        close_bench(&b);
    }
}

/* The first event joins 1 uF at 10 V and 3 uF at 0 V: 7.5 uC go through the diode to 2.5 V. */
static void set_joined(const bench *b, event *e, double from, double to, double charge) {
    e->right.x[ns_circuit_node_unknown(b->k.c, 5)] = e->right.x[ns_circuit_node_unknown(b->k.c, 6)] = from;
    e->right.x[ns_circuit_node_unknown(b->k.c, 7)] = to;
    for (int j = 0; j < b->k.s->m; j++)
        e->Lambda[j] = fabs(e->Lambda[j]) > 1e-7 ? copysign(charge, e->Lambda[j]) : 0;
}

static void joined_capacitors(void **state) {
    (void)state;
    bench b = open_bench(NS_EXACT);
    const event e = next_event(&b);
    event other = e;
    assert_true(fabs(e.right.x[ns_circuit_node_unknown(b.k.c, 7)] - 2.5) < 1e-9);
    set_joined(&b, &other, 2.5, 2.5, 7.5e-6);
    assert_true(judged(&b, &e.left) && judged(&b, &e.right) && event_judged(&b, &other));
    /* too much of it: the diode blocks after it carried */
    set_joined(&b, &other, 1, 3, 9e-6);
    assert_false(event_judged(&b, &other));
    assert_int_equal(b.f.cause, NS_VERIFY_IMPULSE);
    /* so much that energy grows: 1 uF at 10 V are 50 uJ, 3 uF at 6.6 V 65 uJ */
    set_joined(&b, &other, -9.8, 6.6, 19.8e-6);
    assert_false(event_judged(&b, &other));
    assert_true(b.f.cause == NS_VERIFY_IMPULSE || b.f.cause == NS_VERIFY_ENERGY);
    close_bench(&b);
}

/* A switch joins 1 uF at 0 V to a source of 10 V, the first of the inputs: 50 uJ more are there after it, and
 * right. Of 10.5 V there would be 55 uJ. */
static void what_a_source_puts_in(void **state) {
    (void)state;
    bench b = {.k = begin()};
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_signal supply = pulse(10, 11, 5e-6, 1e-6, 1e-6, 1e-6, period),
                    gate = pulse(0, 1, 2e-6, 10e-9, 10e-9, 4e-6, period);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT, .reltol = 1e-9};
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 1e-11};
    assert_int_equal(ns_circuit_source(b.k.c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.k.c, "vg", NS_VOLTAGE, 2, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.k.c, "as1", 1, 3, 2, 0, &contact, &b.as1), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.k.c, "c1", 3, 0, 1e-6, 0, &b.c1), NS_OK);
    make_by(&b.k, &o);
    assert_int_equal(ns_verify_create(b.k.s, &vo, &b.v), NS_OK);
    start_at_rest(&b.k);
    event e = next_event(&b);
    assert_true(fabs(e.right.x[ns_circuit_node_unknown(b.k.c, 3)] - 10) < 1e-12);
    assert_true(judged(&b, &e.left) && judged(&b, &e.right) && event_judged(&b, &e));
    e.right.x[ns_circuit_node_unknown(b.k.c, 3)] = 10.5;
    assert_false(event_judged(&b, &e));
    b.f = ns_verify_nothing(0);
    ns_verify_energy_over(b.v, 0, &b.f); /* in no time it puts in nothing */
    assert_true(b.f.cause == NS_VERIFY_ENERGY && b.f.pair == -1);
    close_bench(&b);
}

/* The diode carries charge backwards. */
static void an_impulse_of_the_wrong_sign(void **state) {
    (void)state;
    bench b = open_bench(NS_EXACT);
    event e = next_event(&b);
    assert_true(judged(&b, &e.left) && judged(&b, &e.right) && event_judged(&b, &e));
    const event swapped = {.left = e.right, .right = e.left};
    event back = swapped;
    back.left.t = back.right.t = e.left.t;
    for (int i = 0; i < MOST; i++) {
        back.X[i] = i < b.k.s->n ? -e.X[i] : 0;
        back.Lambda[i] = i < b.k.s->m ? -e.Lambda[i] : 0;
    }
    expect(&b, event_judged(&b, &back), NS_VERIFY_IMPULSE);
    close_bench(&b);
}

/* Rates that are right, of charges that move by 1 % more; a way of another time. */
static void a_way_that_is_not_the_integral(void **state) {
    (void)state;
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    for (size_t k = 0; k < 2; k++) {
        bench b = open_bench(methods[k]);
        double t[NS_VERIFY_NODES], xl[NS_VERIFY_NODES * 2 * MOST], good[NS_VERIFY_NODES * 2 * MOST];
        const size_t all = (size_t)b.k.s->n + (size_t)b.k.s->m;
        const size_t out = (size_t)ns_circuit_node_unknown(b.k.c, 4);
        (void)next_event(&b);
        way(&b, 0.1, 0.3, t, good);
        assert_true(ns_verify_flow(b.v, t, good, &b.f));
        memcpy(xl, good, sizeof xl);
        for (size_t i = 0; i < NS_VERIFY_NODES; i++) /* 5 V grow by 1 % over the way */
            xl[i * all + out] *= 1 + 0.01 * (t[i] - t[0]) / (t[4] - t[0]);
        expect(&b, ns_verify_flow(b.v, t, xl, &b.f), NS_VERIFY_FLOW);
        close_bench(&b);
    }
}

/* A conductance of -1 mS by a controlled source across 1 uF: energy grows with no source, as it should. */
static void energy_of_a_controlled_source(void **state) {
    (void)state;
    rig k = begin();
    ns_verify *v;
    ns_verify_finding f;
    const ns_verify_options vo = {.reltol = 1e-9, .instant = 0};
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 1, 0, 1e-6, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(k.c, "g1", NS_CURRENT, 0, 1, 1, 0, 1e-3, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(k.c, &k.s), NS_OK);
    assert_int_equal(k.s->n, 1);
    assert_int_equal(ns_verify_create(k.s, &vo, &v), NS_OK);
    double t[NS_VERIFY_NODES], x[NS_VERIFY_NODES];
    ns_verify_flow_times(0, 1e-4, t);
    for (int i = 0; i < NS_VERIFY_NODES; i++)
        x[i] = exp(t[i] / 1e-3); /* RC = -1 ms */
    assert_true(ns_verify_flow(v, t, x, &f));
    x[NS_VERIFY_NODES - 1] *= 1.1;
    assert_false(ns_verify_flow(v, t, x, &f));
    assert_int_equal(f.cause, NS_VERIFY_FLOW);
    ns_verify_free(v);
    ns_verify_free(NULL);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(right_answers),
        cmocka_unit_test(right_answers_of_the_scheme),
        cmocka_unit_test(a_diode_that_blocks_forward_voltage),
        cmocka_unit_test(kirchhoffs_law),
        cmocka_unit_test(a_voltage_that_is_not_that_of_the_nodes),
        cmocka_unit_test(a_number_that_is_not_finite),
        cmocka_unit_test(a_number_that_hides_all_others),
        cmocka_unit_test(a_switch_against_its_control),
        cmocka_unit_test(a_charge_that_is_lost),
        cmocka_unit_test(joined_capacitors),
        cmocka_unit_test(what_a_source_puts_in),
        cmocka_unit_test(an_impulse_of_the_wrong_sign),
        cmocka_unit_test(a_way_that_is_not_the_integral),
        cmocka_unit_test(energy_of_a_controlled_source),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
