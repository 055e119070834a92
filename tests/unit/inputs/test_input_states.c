/* tests/unit/inputs/test_input_states.c - what inputs are between corners, for either engine, against
 * ns_signal_value(): waves (waves.h), states (input_states.h), expansions (input_stages.h). */
#include "dice_signals.h"
#include "inputs/input_stages.h"
#include "inputs/input_states.h"
#include "large_copy.h"
#include "schedules.h"
#include "wrap_alloc.h"

enum { INPUTS = 4, SYSTEMS = 300, STATES = 4 * INPUTS + 1 };
static const double end = 20;
/* Values are some V; slopes below 200 V/s at times off by some eps of 20; growing sines by as much of e^2. */
static const double tol = 1e-10;

static ns_signal any_signal(dice *d, double *room) {
    if (dice_chance(d, 0.1))
        return dc(dice_value(d));
    return dice_chance(d, 0.5) ? dice_line(d, room) : dice_curve(d);
}

static ns_system *a_system(dice *d) {
    ns_system *s = bare(INPUTS, 0);
    double room[DICE_SIGNAL_ROOM];
    for (int i = 0; i < INPUTS; i++) {
        input(s, i, any_signal(d, room));
        s->E[i] = 1;
    }
    return s;
}

/* --- waves --- */

static void waves_are_the_signal(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(81, k);
        const ns_signal s = dice_curve(&d);
        ns_wave_term term[NS_TERMS];
        ns_wave wave[NS_TERMS];
        double base, c, sn;
        const int terms = ns_inputs_wave_terms(&s, term, wave, &base);
        for (int i = 0; i < 20; i++) {
            const double t = end * dice_uniform(&d);
            double value = base;
            for (int j = 0; j < terms; j++) {
                ns_inputs_wave_at(&wave[j], fmax(t, wave[j].td), &c, &sn);
                value += t < term[j].from ? term[j].before : term[j].after + term[j].cc * c + term[j].cs * sn;
            }
            assert_near(value, ns_signal_value(&s, t, NS_RIGHT), tol);
        }
    }
}

/* 1 V and a sine of 2 V and 50 Hz: 3 V at most; D of a wave e^(st) by steps g is gs/(1-gs). */
static void errors_of_a_sine(void **state) {
    const double g = 1e-3, gs = 2 * acos(-1) * 50 * g;
    ns_system *s = bare(2, 0);
    ns_input_stages *in;
    (void)state;
    input(s, 0, sine(1, 2, 50, 0, 30));
    input(s, 1, dc(-7));
    s->E[0] = s->E[1] = 1;
    assert_int_equal(ns_inputs_stages_create(s, &in), NS_OK);
    ns_inputs_stages_at(in, 3e-3);
    assert_near(in->max_abs[0], 3, tol);
    assert_int_equal(in->ncurved, 1);
    for (int order = 1; order < 9; order++)
        assert_near(ns_inputs_stages_error(in, g, order), 2.0 / 3 * pow(gs / sqrt(1 + gs * gs), order + 1),
                    1e-12);
    ns_inputs_stages_free(in);
    ns_system_free(s);
}

/* What does not move has no wave. */
static void constants_have_no_waves(void **state) {
    const ns_signal still[] = {sine(3, 0, 50, 0, 90),
                               sine(2, 1, 0, 0, 90),
                               {.kind = NS_EXP, .u.exp = {3, 3, 1, 1, 2, 1}},
                               dc(3),
                               pulse(0, 1, 0, 1, 1, 1, 4)};
    (void)state;
    for (int k = 0; k < 5; k++) {
        ns_wave_term term[NS_TERMS];
        ns_wave wave[NS_TERMS];
        double base;
        assert_int_equal(ns_inputs_wave_terms(&still[k], term, wave, &base), 0);
        assert_near(base, k < 3 ? 3 : 0, 4 * eps);
    }
}

/* --- states --- */

static double output(const ns_input_states *e, int k, const double *v) {
    double z = 0;
    for (int i = 0; i < e->nv; i++)
        z += e->Z[k + i * e->s->nz] * v[i];
    return z;
}

static void states_at(const ns_input_states *e, const ns_time_events *s, double t, double *v) {
    double z[INPUTS], dz[INPUTS];
    ns_inputs_events_values(s, t, z, dz);
    ns_inputs_states_at(e, t, z, dz, v);
}

static void check_outputs(const ns_input_states *e, double t, const double *v) {
    for (int k = 0; k < INPUTS; k++)
        assert_near(output(e, k, v), ns_signal_value(&e->s->z[k], t, NS_LEFT), tol);
}

/* At a, and from there on to b; and (1 - g S) undoes what (1 - g S)^-1 does. */
static void check_states(const ns_input_states *e, const ns_time_events *s, double a, double b) {
    double v[STATES], u[STATES];
    const double g = 0.1;
    states_at(e, s, a, v);
    memcpy(u, v, sizeof v);
    ns_inputs_states_stage(e, g, u);
    for (int i = 0; i < e->nv; i++)
        assert_near(u[i] - g * ns_inputs_states_slope(e, i, u), v[i], tol * 10);
    ns_inputs_states_advance(e, b - a, v);
    check_outputs(e, b, v);
    states_at(e, s, b, v);
    check_outputs(e, b, v);
}

static void states_are_the_signals(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(82, k);
        ns_system *system = a_system(&d);
        ns_time_events *s = schedule(system);
        ns_input_states *e;
        assert_int_equal(ns_inputs_states_create(system, s, &e), NS_OK);
        assert_true(e->nv <= STATES && e->from <= 0);
        for (double t = 0; t < end;) {
            const double next = fmin(end, ns_inputs_events_next(s, end));
            check_states(e, s, t, t + (next - t) * dice_uniform(&d));
            if (next < end)
                ns_inputs_events_pass(s);
            t = next;
        }
        ns_inputs_states_free(e);
        done(s, system);
    }
}

static int kinds(const ns_input_states *e, ns_input_kind kind, int input) {
    int count = 0;
    for (int i = 0; i < e->nv; i++)
        count += e->state[i].kind == kind && e->state[i].input == input;
    return count;
}

/* Of three broken lines only those that rise somewhere have a slope: steps have none, the last piece counts.
 */
static void only_ramps_have_slopes(void **state) {
    static double times[] = {0, 1, 1, 2}, steps[] = {0, 0, 1, 1}, late[] = {0, 0, 0, 1};
    static const int slopes[] = {0, 1, 0};
    ns_system *system = bare(3, 0);
    ns_input_states *e;
    (void)state;
    input(system, 0, (ns_signal){.kind = NS_PWL, .u.pwl = {.n = 4, .t = times, .v = steps}});
    input(system, 1, (ns_signal){.kind = NS_PWL, .u.pwl = {.n = 4, .t = times, .v = late}});
    input(system, 2, dc(2));
    for (int i = 0; i < 3; i++)
        system->E[i] = 1;
    ns_time_events *s = schedule(system);
    assert_int_equal(ns_inputs_states_create(system, s, &e), NS_OK);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(kinds(e, NS_STATE_SLOPE, i), slopes[i]);
        assert_int_equal(kinds(e, NS_STATE_VALUE, i), i < 2);
    }
    ns_inputs_states_free(e);
    done(s, system);
}

/* Of a step, a sine, a constant and a ramp the first has a value of its own, the last a value and a slope.
 * What has a value alone can become a broken line that jumps, and none that rises, wherever it does. */
static void only_lines_have_states_of_their_own(void **state) {
    static double times[] = {0, 1, 2, 3}, jump[] = {0, 1, 1, 2}, rise[] = {0, 0, 0, 1}, step[] = {0, 0, 1, 1};
    static double lines[][4] = {{0, 1, 1, 1}, {0, 0, 0, 1}, {5, 5, 5, 5}};
    ns_system *system = bare(4, 0);
    ns_input_states *e;
    (void)state;
    input(system, 0, (ns_signal){.kind = NS_PWL, .u.pwl = {.n = 4, .t = jump, .v = step}});
    input(system, 1, sine(0, 1, 50, 0, 0));
    input(system, 2, dc(2));
    input(system, 3, (ns_signal){.kind = NS_PWL, .u.pwl = {.n = 4, .t = times, .v = rise}});
    for (int i = 0; i < 4; i++)
        system->E[i] = 1;
    ns_time_events *s = schedule(system);
    assert_int_equal(ns_inputs_states_create(system, s, &e), NS_OK);
    for (int i = 0; i < 4; i++)
        assert_int_equal(ns_inputs_states_has(e, i), i == 0 || i == 3);
    for (int i = 0; i < 4; i++) {
        assert_true(ns_inputs_states_can_be(e, i)); /* what it is */
        for (int k = 0; k < 3; k++) {
            input(system, i, (ns_signal){.kind = NS_PWL, .u.pwl = {.n = 4, .t = times, .v = lines[k]}});
            assert_int_equal(ns_inputs_states_can_be(e, i), i != 0 || k == 2);
        }
    }
    ns_inputs_states_free(e);
    done(s, system);
}

/* Nothing happens before td1, whatever td2 is: the second wave begins with the first. */
static void an_exponential_ends_before_it_begins(void **state) {
    ns_system *system = bare(1, 0);
    ns_input_states *e;
    double v[STATES];
    (void)state;
    input(system, 0, (ns_signal){.kind = NS_EXP, .u.exp = {1, 3, 2, 0.5, 1, 0.5}});
    system->E[0] = 1;
    ns_time_events *s = schedule(system);
    assert_int_equal(ns_inputs_states_create(system, s, &e), NS_OK);
    double z, dz;
    ns_inputs_events_values(s, 1.5, &z, &dz);
    ns_inputs_states_at(e, 1.5, &z, &dz, v);
    assert_near(output(e, 0, v), 1, 0);
    ns_inputs_states_free(e);
    done(s, system);
}

/* Mute is what an unknown or a pair follows and no event does: input 0 enters the events, 1 drives the last
 * row of x, 2 the last pair, 3 nothing. */
static void what_is_followed_is_output_only(void **state) {
    ns_system *system;
    ns_input_states *e;
    ns_time_events *s;
    (void)state;
    assert_int_equal(ns_system_create(3, 2, 4, 0, &system), NS_OK);
    for (int i = 0; i < 4; i++)
        input(system, i, pulse(0, 1, 0, 1, 1, 1, 5 + i));
    system->E[0 + 0 * 3] = system->E[2 + 1 * 3] = 1;
    system->F[1 + 2 * 2] = 1;
    const unsigned char active[] = {1, 0, 0, 0};
    assert_int_equal(ns_inputs_events_create(system, active, &s), NS_OK);
    assert_int_equal(ns_inputs_states_create(system, s, &e), NS_OK);
    assert_int_equal(e->output_only_inputs, 2);
    assert_int_equal(e->output_only_input[0], 1);
    assert_int_equal(e->output_only_input[1], 2);
    ns_inputs_states_free(e);
    done(s, system);
}

/* Three phases are one pair; what only a command of time sees has no state; one for outputs only is listed.
 */
static void states_are_shared(void **state) {
    ns_system *system = bare(6, 1);
    ns_input_states *e;
    (void)state;
    for (int i = 0; i < 3; i++)
        input(system, i, sine(0, 1, 50, 0, 120 * i));
    input(system, 3, pulse(0, 1, 0, 0, 0, 1, 2)); /* no ramps */
    input(system, 4, pulse(0, 1, 0, 1, 1, 1, 5));
    input(system, 5, sine(0, 1, 60, 0, 0));
    system->command[0].gz[5] = 1;
    for (int i = 0; i < 5; i++)
        system->E[i] = 1;
    const unsigned char active[] = {1, 1, 1, 1, 0, 0};
    ns_time_events *s;
    assert_int_equal(ns_inputs_events_create(system, active, &s), NS_OK);
    assert_int_equal(ns_inputs_states_create(system, s, &e), NS_OK);
    assert_int_equal(e->nv, 1 + 1 + 2);
    assert_int_equal(e->output_only_inputs, 1);
    assert_int_equal(e->output_only_input[0], 4);
    ns_inputs_states_free(e);
    for (long k = 1;; k++) {
        fail_alloc_at(k);
        const int status = ns_inputs_states_create(system, s, &e);
        const long made = allocs_made();
        fail_alloc_off();
        if (made < k) {
            ns_inputs_states_free(e);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
    }
    done(s, system);
}

/* --- expansions for steps of implicit Euler --- */

static double expanded(const ns_exp_sum *w, double t) {
    const double tau = t - w->from;
    double z = w->value + w->slope * tau;
    for (int e = 0; e < w->count; e++)
        z +=
            exp(w->s[e][0] * tau) * (w->c[e][0] * cos(w->s[e][1] * tau) - w->c[e][1] * sin(w->s[e][1] * tau));
    return z;
}

/* z of stage 0 is an Euler step from t to t + g: (1 - g d/dt)^-1 z, whose derivative is a difference here. */
static void check_stage(const ns_input_stages *in, double t) {
    const double g = 1e-3, h = 1e-5;
    double z[INPUTS];
    (void)ns_inputs_stages_stage(in, t, 0, 0, z);
    for (int k = 0; k < INPUTS; k++)
        assert_near(z[k], ns_signal_value(&in->s->z[k], t, NS_RIGHT), tol);
    (void)ns_inputs_stages_stage(in, t, g, 0, z);
    for (int k = 0; k < INPUTS; k++) {
        const ns_exp_sum *w = &in->sum[k];
        const double rate = (expanded(w, t + h) - expanded(w, t - h)) / (2 * h);
        assert_near(z[k], expanded(w, t) + g * rate, 1e-3); /* (2 pi 2 Hz g)^2 of 2 V */
    }
}

static void expansions_are_the_signals(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(83, k);
        ns_system *system = a_system(&d);
        ns_input_stages *in;
        assert_int_equal(ns_inputs_stages_create(system, &in), NS_OK);
        double t = 0;
        while (t < end) {
            ns_inputs_stages_at(in, t);
            check_stage(in, t);
            for (int i = 0; i < INPUTS; i++) {
                const double at = t + (fmin(end, in->corner) - t) * dice_uniform(&d);
                assert_near(expanded(&in->sum[i], at), ns_signal_value(&system->z[i], at, NS_LEFT), tol);
            }
            t = in->corner;
        }
        ns_inputs_stages_free(in);
        ns_system_free(system);
    }
}

/* --- commands of a large system --- */

/* Steps of 0.3 s that flip what changes in them, against the schedule of the same system with arrays. */
static void commands_of_large_systems(void **state) {
    enum { COMMANDS = 3 };
    (void)state;
    for (unsigned k = 0; k < 50; k++) {
        dice d = dice_make(84, k);
        ns_system *dense = bare(INPUTS, COMMANDS);
        double room[DICE_SIGNAL_ROOM];
        for (int i = 0; i < INPUTS; i++)
            input(dense, i, any_signal(&d, room));
        for (int c = 0; c < COMMANDS; c++) {
            thresholds(dense, c, 0.3, -0.2);
            for (int i = 0; i < INPUTS; i++)
                dense->command[c].gz[i] = dice_chance(&d, 0.5) ? 0 : dice_either(&d);
        }
        ns_system *large = large_copy(dense);
        ns_time_events *s = schedule(dense);
        ns_input_stages *in;
        ns_mode mode[COMMANDS] = {NS_LOWER, NS_LOWER, NS_LOWER};
        double sum = 0, total = 0;
        assert_int_equal(ns_inputs_stages_create(large, &in), NS_OK);
        for (int step = 0; step < 60; step++) {
            const double t = 0.3 * step;
            int flips = 0;
            ns_inputs_stages_find_command(in, t, 0.3, mode);
            const int count = ns_inputs_stages_flip_commands(in, t + (step ? 0.3 : 0), mode, &sum);
            while (step && ns_inputs_events_next(s, t + 0.3) <= t + 0.3) {
                const ns_time_event *what = ns_inputs_events_pass(s);
                flips += what->flips;
                total += what->flips * what->t;
            }
            assert_true(step == 0 || count == flips);
            for (int c = 0; c < COMMANDS; c++)
                assert_int_equal(mode[c] == NS_INSIDE, ns_inputs_events_closed(s)[c]);
        }
        assert_near(sum, total, 1e-9);
        ns_inputs_stages_free(in);
        ns_system_free(large);
        done(s, dense);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_of_a_sine),
        cmocka_unit_test(waves_are_the_signal),
        cmocka_unit_test(constants_have_no_waves),
        cmocka_unit_test(states_are_the_signals),
        cmocka_unit_test(an_exponential_ends_before_it_begins),
        cmocka_unit_test(only_ramps_have_slopes),
        cmocka_unit_test(what_is_followed_is_output_only),
        cmocka_unit_test(states_are_shared),
        cmocka_unit_test(expansions_are_the_signals),
        cmocka_unit_test(commands_of_large_systems),
        cmocka_unit_test(only_lines_have_states_of_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
