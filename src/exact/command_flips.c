/* src/exact/command_flips.c - switches that the state commands: which of them change at an event. */
#include "events/ties.h"
#include "guards.h"
#include "mode_selection.h"

#include <math.h>

void ns_exact_flips_clear(ns_exact *f) {
    for (int c = 0; c < f->system->nc; c++) {
        f->point->flip[c] = 0;
        f->command_target[c] = NS_TARGET_TOGGLE;
    }
}

/* The sliding mode of a closed switch, by the direction of its current. */
static ns_mode sliding_mode_of(const ns_exact *f, int pair) {
    const ns_mode_kernel *k = f->state.mode->scale[0].kernel;
    const int n = f->system->n, all = n + f->system->m;
    double sum = 0;
    for (int j = 0; j < k->q; j++)
        sum += k->step_x_lambda[(size_t)(n + pair) + (size_t)j * (size_t)all] * f->X[j];
    return ns_events_sliding_mode(sum);
}

/* Flips command c, which depends on the state; without hysteresis, and about to flip back at once, it slides.
 */
static void flip_command(ns_exact *f, int c) {
    const ns_command *of = &f->system->command[c];
    f->point->flip[c] = 1;
    if (ns_events_slides(of, f->flips[c]) && f->state.mode->mode[of->pair] == NS_INSIDE)
        f->command_target[c] = sliding_mode_of(f, of->pair);
    f->flips[c] = 1;
}

int ns_exact_flip_contradicted(ns_exact *f) {
    const ns_mode_kernel *k = f->state.mode->scale[0].kernel;
    int count = 0;
    ns_exact_flips_clear(f);
    for (int g = k->pair_rows; g < k->rows; g++)
        if (ns_exact_guard_sign(f, f->state.mode, g, f->X) == NS_SIGN_BREAKS) {
            flip_command(f, k->row[g].command);
            count++;
        }
    return count;
}

int ns_exact_flip_of_guard(ns_exact *f) {
    const ns_guard_row *row = &f->state.mode->scale[0].kernel->row[f->event_guard];
    int c = row->command;
    if (c >= 0) {
        flip_command(f, c);
        return 1;
    }
    if (!ns_mode_slides(f->state.mode->mode[row->pair]))
        return 0;
    for (c = 0; f->system->command[c].pair != row->pair;)
        c++;
    f->point->flip[c] = 1;
    f->command_target[c] = row->to;
    return 1;
}

/* 1 if guard g is beyond zero by more than the event's instant is known: an input that jumps took it there.
 */
static int is_far_beyond(const ns_exact *f, const ns_mode_kernel *k, int g) {
    const double rate = ns_exact_guard_of(k, k->rate, g, f->X),
                 tol = ns_exact_guard_rounding_at(f, k, g, f->X, rate);
    return ns_exact_guard_of(k, k->value, g, f->X) < -(tol + fabs(rate) * f->state.command_time_error);
}

/* 1 if the threshold of guard g is met here, too.  Beside a fast time scale it may take a longer step to tell
 * the guard's rate from rounding: that counts only for a switch with hysteresis. */
static int is_met(ns_exact *f, const ns_mode_kernel *k, int g, ns_tie tie) {
    const ns_guard_sign sign = ns_exact_guard_sign(f, f->state.mode, g, f->X);
    return (sign == NS_SIGN_BREAKS || (sign == NS_SIGN_SEEMS_TO_BREAK && tie == NS_TIE_MET)) &&
           (f->event_guard >= 0 || !is_far_beyond(f, k, g));
}

/* Command c changes with the event, whose instant is that of guard g; *delay: later than that. */
static int flip_if_met(ns_exact *f, const ns_mode_kernel *k, int g, double *delay) {
    const int c = k->row[g].command;
    const ns_command *of = &f->system->command[c];
    const ns_tie tie = ns_events_tie(of, f->state.mode->mode[of->pair]);
    const double same = tie == NS_TIE_SAME ? ns_exact_guard_delay(f, k, g) : INFINITY;
    *delay = isinf(same) ? 0 : same;
    if (tie == NS_TIE_NONE || (isinf(same) && !is_met(f, k, g, tie)))
        return 0;
    if (isinf(same) && tie == NS_TIE_SAME)
        f->point->flip[c] = 1; /* it may go back, and does not slide then */
    else
        flip_command(f, c);
    return 1;
}

int ns_exact_flip_met(ns_exact *f) {
    const ns_mode_kernel *k = f->state.mode->scale[0].kernel;
    const double t = f->state.now.t, known_to = f->state.command_time_error;
    double last = 0, delay;
    int count = 0;
    if (f->event_guard < 0)
        f->state.command_time_error = fmax(known_to, ns_system_signal_time_error(t, t));
    for (int g = k->pair_rows; g < k->rows; g++)
        if (g != f->event_guard && flip_if_met(f, k, g, &delay)) {
            last = fmax(last, delay);
            count++;
        }
    f->state.command_time_error = known_to + last * ns_events_beyond_delay;
    return count;
}
