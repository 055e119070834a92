/* tests/unit/march/test_wrong_engines.c - each kind of wrong answer, planted in each engine, is caught.
 *
 * An engine of a run is replaced by one that asks it and changes once what it answers.  What follows has to
 * be as if nothing had been changed; where all engines are wrong, the run is refused.
 */
#include "retries.h"
#include "rig.h"

#include <stdio.h>
#include <string.h>

#include "march/run_internal.h"
#include "signals.h"

enum { UNKNOWNS = 16 };
static const double period = 10e-6;

/* What is changed: lambda of a diode; a node's voltage; a current; a charge that jumps; a number; points on a
 * way; the sign of an impulse, its size; y; a switch that is shown open while its gate is high. */
typedef enum lie {
    LAMBDA,
    VOLTAGE,
    CURRENT,
    LOST_CHARGE,
    LOST_FLUX,
    NOT_A_NUMBER,
    DRIFT,
    IMPULSE_SIGN,
    IMPULSE_SIZE,
    WRONG_Y,
    OPEN_SWITCH,
    LIES
} lie;

typedef struct liar {
    ns_engine engine;
    ns_engine *inner;
    const ns_watch *real;
    ns_watch watch;
    lie what;
    int unknown, told, rights; /* rights: right sides of events so far */
    int is_right;              /* of the scheme: the trial is one more */
    double from;               /* s: of a way */
    int n, m, gate;            /* gate: its voltage */
    double open[4 * UNKNOWNS]; /* x, lambda, y while the switch was open; */
    int knows_open;            /* 1: it was */
    int events,
        recurs_from; /* so far; every second right side from this one on is changed; 0: of the first few */
} liar;

static liar *liar_of(ns_engine *e) {
    return (liar *)(void *)e;
}

static const liar *liar_in(const ns_engine *e) {
    return (const liar *)(const void *)e;
}

/* --- the engine inside --- */

static void free_liar(ns_engine *e) {
    liar *l = liar_of(e);
    l->inner->table->free(l->inner);
    free(l);
}
/* The scheme shows its events to nobody: its right sides are ends of trials. */
static int try_to(ns_engine *e, double t, ns_until until, double *reached) {
    liar *l = liar_of(e);
    const int goes_on = ns_engine_method(l->inner) == NS_THETA && ns_engine_at_event(l->inner);
    const int status = l->inner->table->try_to(l->inner, t, until, reached);
    l->is_right = goes_on && status == NS_OK && !ns_engine_at_event(l->inner);
    l->rights += l->is_right;
    return status;
}
static void drop(ns_engine *e) {
    liar_of(e)->is_right = 0;
    ns_engine_drop(liar_of(e)->inner);
}
static int accept_trial(ns_engine *e) {
    liar_of(e)->is_right = 0;
    return ns_engine_accept(liar_of(e)->inner);
}
/* What was shown with the switch open, but for the gate's voltage. */
static void show_open(liar *l, double *x, double *lambda, double *y) {
    double *kept_lambda = l->open + l->n, *kept_y = kept_lambda + l->m;
    const double gate = x[l->gate];
    double *from[] = {x, lambda, y}, *to[] = {l->open, kept_lambda, kept_y};
    const int count[] = {l->n, l->m, l->m}, lies = gate > 0.9 && l->knows_open, learns = gate < 0.1;
    for (int k = 0; k < 3 && (lies || learns); k++)
        memcpy(lies ? from[k] : to[k], lies ? to[k] : from[k], sizeof(double) * (size_t)count[k]);
    x[l->gate] = gate;
    l->told += lies;
    l->knows_open |= learns;
}

/* All parts of the right side of an event are changed. */
static void change_point(liar *l, double *x, double *lambda) {
    l->told++;
    if (l->what == LAMBDA)
        lambda[1] = -1;
    else if (l->what == VOLTAGE || l->what == CURRENT)
        x[l->unknown] += l->what == VOLTAGE ? -2.6e6 : 2;
    else if (l->what == LOST_CHARGE || l->what == LOST_FLUX)
        x[l->unknown] = 0;
    else if (l->what == NOT_A_NUMBER)
        lambda[0] = NAN;
}

static int read_point(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    liar *l = liar_of(e);
    const int status = ns_engine_read(l->inner, t, x, lambda, y);
    if (x && lambda && l->is_right && l->what < DRIFT && l->rights >= 5 && l->told < 3)
        change_point(l, x, lambda);
    if (!x || !lambda || !y || l->told)
        return status;
    if (l->what == WRONG_Y && l->rights >= 4) {
        y[0] += (ns_engine_method(l->inner) == NS_THETA ? 0.1 : 0.02) * 12; /* of what the switch blocks */
        l->told++;
    } else if (l->what == OPEN_SWITCH && l->rights >= 4)
        show_open(l, x, lambda, y);
    return status;
}
/* Of the impulse. */
static double times_of(lie what) {
    return what == IMPULSE_SIGN ? -1 : what == IMPULSE_SIZE ? 1.01 : 1;
}

static int impulse(ns_engine *e, double *x, double *lambda) {
    liar *l = liar_of(e);
    const int status = ns_engine_impulse(l->inner, x, lambda);
    for (int i = 0; i < l->n && x; i++)
        x[i] *= times_of(l->what);
    for (int i = 0; i < l->m && lambda; i++)
        lambda[i] *= times_of(l->what);
    return status;
}
static const ns_mode *mode(ns_engine *e) {
    return ns_engine_mode(liar_of(e)->inner);
}
static int at_event(const ns_engine *e) {
    return ns_engine_at_event(liar_in(e)->inner);
}
static ns_method method(const ns_engine *e) {
    return ns_engine_method(liar_in(e)->inner);
}
static const ns_counts *counts(ns_engine *e) {
    return liar_of(e)->inner->table->counts(liar_of(e)->inner);
}
static const ns_fault *fault(const ns_engine *e) {
    return ns_engine_fault(liar_in(e)->inner);
}
static double shortest(ns_engine *e, double t, double *until) {
    return ns_engine_shortest(liar_of(e)->inner, t, until);
}

/* A voltage that grows by 1 % over 1 ns, of which nothing flows. */
static int sample(ns_engine *e, double t, double *x, double *lambda) {
    liar *l = liar_of(e);
    const int status = ns_engine_sample(l->inner, t, x, lambda);
    if (l->what == DRIFT && l->rights >= 4 && x) {
        if (!l->told++)
            l->from = t;
        x[l->unknown] *= 1 + 0.01 * (t - l->from) / 1e-9;
    }
    return status;
}

static ns_watch_part wants(void *data, ns_watch_side side, const ns_mode *m) {
    liar *l = data;
    l->events += side == NS_WATCH_RIGHT;
    return l->real->wants(l->real->data, side, m);
}

/* The first that jumps. */
static void change_impulse(liar *l) {
    const double times = times_of(l->what);
    const ns_watch *w = l->real;
    if (!*w->jumped || times == 1)
        return;
    l->told++;
    for (int i = 0; i < l->n; i++)
        w->X[i] *= times;
    for (int i = 0; i < l->m; i++)
        w->Lambda[i] *= times;
}

/* The right side of the fifth event, and a point is changed. */
static int sees(void *data, ns_watch_side side, double t) {
    liar *l = data;
    if (side == NS_WATCH_RIGHT)
        change_impulse(l);
    l->rights += side == NS_WATCH_RIGHT;
    const int is_wrong = l->recurs_from > 0
                             ? l->events >= l->recurs_from && l->events % 2 == l->recurs_from % 2
                             : l->rights >= 5 && l->told < 3;
    if (l->what < DRIFT && side == NS_WATCH_RIGHT && is_wrong)
        change_point(l, l->real->x, l->real->lambda);
    return l->real->sees(l->real->data, side, t);
}

static void watch(ns_engine *e, const ns_watch *w) {
    liar *l = liar_of(e);
    if (w) {
        l->real = w;
        l->watch = *w;
        l->watch.data = l;
        l->watch.wants = wants;
        l->watch.sees = sees;
    }
    ns_engine_watch(l->inner, w ? &l->watch : NULL);
}

static const ns_engine_table table = {.free = free_liar,
                                      .try_to = try_to,
                                      .drop = drop,
                                      .accept = accept_trial,
                                      .read = read_point,
                                      .impulse = impulse,
                                      .mode = mode,
                                      .at_event = at_event,
                                      .method = method,
                                      .counts = counts,
                                      .fault = fault,
                                      .sample = sample,
                                      .shortest = shortest,
                                      .watch = watch};

/* --- a buck converter --- */

static int l1;

static rig buck(ns_method by, double volts, double h) {
    rig k = begin();
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    const ns_signal supply = dc(volts), gate = pulse(0, 1, 2e-6, 10e-9, 10e-9, 4e-6, period);
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = by, .reltol = 1e-9, .whole = 1};
    assert_int_equal(ns_circuit_source(k.c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "vg", NS_VOLTAGE, 2, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "as1", 1, 3, 2, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "ad1", 0, 3, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l1", 3, 4, 100e-6, 1, &l1), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 4, 0, 22e-6, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", 4, 0, 5, NULL), NS_OK);
    /* joined by the first pulse */
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", 5, 0, 1e-6, 10, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "as2", 5, 6, 2, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "ad2", 6, 7, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c3", 7, 0, 3e-6, 0, NULL), NS_OK);
    make_by(&k, &o);
    assert_true(k.s->n <= UNKNOWNS);
    start_at_rest(&k);
    return k;
}

static ns_run *run_of(const rig *k) {
    return (ns_run *)(void *)k->m->engine;
}

static liar *plant(const rig *k, lie what) {
    ns_run *r = run_of(k);
    liar *l = calloc(1, sizeof *l);
    assert_non_null(l);
    l->engine.table = &table;
    l->inner = r->at_work;
    l->what = what;
    l->n = k->s->n;
    l->m = k->s->m;
    l->gate = ns_circuit_node_unknown(k->c, 2);
    l->unknown = what == VOLTAGE                        ? ns_circuit_node_unknown(k->c, 3)
                 : what == LOST_CHARGE || what == DRIFT ? ns_circuit_node_unknown(k->c, 4)
                                                        : ns_circuit_current_unknown(k->c, l1);
    r->at_work = &l->engine;
    watch(&l->engine, &r->check.watch);
    return l;
}

static int status_of(rig *k, double end) {
    double t = 0;
    while (t < end) {
        run_of(k)->check.credit = 1e9; /* everything is looked at */
        const int status = ns_march_try(k->m, end, t > end / 2 ? NS_TO_STEP : NS_TO_EVENT, &t);
        if (status != NS_OK)
            return status;
        assert_int_equal(ns_march_accept(k->m), NS_OK);
    }
    return ns_march_read(k->m, NULL, k->x, NULL, NULL);
}

/* After a lie another engine goes on for a while.  So the end may differ by what the engine errs by: the
 * scheme twice what half of h changes, the others 1e-6. */
static double error_of(ns_method by, rig *honest, int i) {
    rig finer = buck(by, 12, 0.5e-7);
    assert_int_equal(status_of(&finer, 10.3 * period), NS_OK);
    const double differs = fabs(finer.x[i] - honest->x[i]);
    end(&finer);
    return 1e-6 * (1 + fabs(honest->x[i])) + (by == NS_THETA ? 2 * differs : 0);
}

static void planted(ns_method by, lie what) {
    rig honest = buck(by, 12, 1e-7), k = buck(by, 12, 1e-7);
    assert_int_equal(status_of(&honest, 10.3 * period), NS_OK);
    assert_int_equal(ns_march_counts(honest.m)->retries, 0);
    assert_true(ns_march_counts(honest.m)->checks > 20);
    const liar *liar = plant(&k, what);
    const int status = status_of(&k, 10.3 * period);
    if (status != NS_OK)
        fail_msg("engine %d, lie %d: status %d", by, what, status);
    if (ns_march_counts(k.m)->retries != 1)
        fail_msg("engine %d, lie %d, told %d: %ld retries", by, what, liar->told,
                 ns_march_counts(k.m)->retries);
    for (int i = 0; i < k.s->n; i++)
        if (!(fabs(k.x[i] - honest.x[i]) <= error_of(by, &honest, i)))
            fail_msg("engine %d, lie %d: x[%d] = %g, not %g", by, what, i, k.x[i], honest.x[i]);
    end(&honest);
    end(&k);
}

static void planted_lies_are_caught(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA};
    (void)state;
    for (int by = 0; by < 3; by++)
        for (int what = 0; what < LIES; what++)
            planted(methods[by], (lie)what);
}

/* One of the two events that come back with every period is wrong from the fiftieth period on, when all modes
 * are known: that is seen before 20 more periods have passed, though from then on an engine so cheap earns
 * nothing. */
static void what_comes_back_is_looked_at(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    enum { RIGHT_PERIODS = 50, SEEN_WITHIN = 20 };
    (void)state;
    for (int by = 0; by < 2; by++)
        for (int what = 0; what < 2 * DRIFT; what++) {
            rig k = buck(methods[by], 12, 1e-7);
            liar *l = plant(&k, (lie)(what / 2));
            double t = 0;
            l->recurs_from = 2 * RIGHT_PERIODS + what % 2;
            while (t < (RIGHT_PERIODS - 5) * period) {
                assert_int_equal(ns_march_try(k.m, t + 5 * period, NS_TO_TIME, &t), NS_OK);
                assert_int_equal(ns_march_accept(k.m), NS_OK);
            }
            assert_int_equal(ns_march_counts(k.m)->retries, 0);
            run_of(&k)->check.credit = run_of(&k)->check.event_gain = run_of(&k)->check.trial_gain = 0;
            while (t < (RIGHT_PERIODS + SEEN_WITHIN) * period && ns_march_counts(k.m)->retries == 0) {
                assert_int_equal(ns_march_try(k.m, t + 5 * period, NS_TO_TIME, &t), NS_OK);
                assert_int_equal(ns_march_accept(k.m), NS_OK);
            }
            if (ns_march_counts(k.m)->retries == 0)
                fail_msg("engine %d, lie %d: not seen until %g s", methods[by], what, t);
            end(&k);
        }
}

/* An engine that was asked what it costs, and was to end after so much work, is at work for another reason:
 * it goes on without that bound. */
static void the_bound_of_a_question_ends_with_it(void **state) {
    (void)state;
    rig honest = buck(NS_EXACT, 12, 1e-7), k = buck(NS_EXACT, 12, 1e-7);
    assert_int_equal(status_of(&honest, 10.3 * period), NS_OK);
    run_of(&k)->at_work->most_work = 1;
    assert_int_equal(status_of(&k, 10.3 * period), NS_OK);
    for (int i = 0; i < k.s->n; i++)
        assert_true(fabs(k.x[i] - honest.x[i]) <= error_of(NS_EXACT, &honest, i));
    end(&honest);
    end(&k);
}

/* The supply has 12 V for the engines, 24 V for who judges them: no engine is right. */
static void where_no_engine_is_right_the_run_is_refused(void **state) {
    (void)state;
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    for (int by = 0; by < 2; by++) {
        rig k = buck(methods[by], 12, 1e-7), other = buck(methods[by], 24, 1e-7);
        const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
        char line[200];
        ns_verify **judge = &run_of(&k)->check.verify;
        ns_verify_free(*judge);
        assert_int_equal(ns_verify_create(other.s, &o, judge), NS_OK);
        assert_int_equal(status_of(&k, 10.3 * period), NS_E_RESIDUAL);
        ns_circuit_explain(k.c, ns_march_fault(k.m), line, sizeof line);
        print_message("%s\n", line);
        assert_non_null(strstr(line, "v1: at t = "));
        assert_non_null(strstr(line, "do not add up"));
        end(&other);
        end(&k);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planted_lies_are_caught),
        cmocka_unit_test(what_comes_back_is_looked_at),
        cmocka_unit_test(the_bound_of_a_question_ends_with_it),
        cmocka_unit_test(where_no_engine_is_right_the_run_is_refused),
    };
    allow_retries(ANY_RETRIES);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
