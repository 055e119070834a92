/* src/exact/mode_selection.c - from one mode to the next, at an instant.
 *
 * A mode is right from here on if (J4) holds: no impulse that its pairs could not carry, and guards that are
 * positive, or zero and about to rise.  Tried are modes that followed before, then the present one with what
 * broke flipped, also with all that breaks in that instant, then the answer of (P1) over a short step, then
 * the mode of the impulse problem, then again the present one with what broke flipped, unless another guard
 * is clearly below zero then.
 */
#include "mode_selection.h"
#include "sliding.h"

#include "guards.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void remember_successor(ns_exact_mode *from, ns_exact_mode *to, uint64_t undecided) {
    int i = 0;
    while (i < NS_SUCCESSORS - 1 && from->successor[i].mode && from->successor[i].mode != to)
        i++;
    if (from->successor[i].mode == to)
        undecided |= from->successor[i].undecided;
    for (; i > 0; i--)
        from->successor[i] = from->successor[i - 1];
    from->successor[0] = (ns_successor){to, undecided};
}

/* s: until the last guard of the state's mode that is below zero, and rises, has reached zero.  Guards that
 * take longer than `known_to` are left out. */
static double late_by(const ns_exact *f, const ns_mode_kernel *k, double known_to) {
    double late = 0;
    for (int g = 0; g < k->pair_rows; g++) {
        const double value = ns_exact_guard_of(k, k->value, g, f->X);
        if (k->always_zero[g] || value >= 0)
            continue;
        const double rate = ns_exact_guard_of(k, k->rate, g, f->X);
        if (value < -ns_exact_guard_rounding_at(f, k, g, f->X, 0) && -value <= rate * known_to)
            late = fmax(late, -value / rate);
    }
    return late;
}

/* The mode was taken though guards are below zero, as they reach zero within the error of the event's time.
 * X is moved on until they have, by Newton's method: a guard that settles rises ever more slowly, so no step
 * of it goes beyond zero. */
static int begin_at_zero(ns_exact *f) {
    enum { MOST = 8 };
    ns_time_scale *scale = &f->state.mode->scale[0];
    const double error = f->state.event_time_error;
    double late;
    int status = NS_OK;
    for (int i = 0; i < MOST && status == NS_OK && (late = late_by(f, scale->kernel, error)) > 0; i++) {
        status = ns_exact_step_advance(f, scale, late);
        ns_clock_advance(&f->state.now, f->state.now.t, late);
    }
    return status;
}

/* f->highest, by the values that guards had as mode k was judged.  Modes with their fast parts resolved do
 * not count: a voltage that lasts 1e-16 s may be 1e12 V. */
static void note_highest(ns_exact *f, const ns_exact_mode *k) {
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    for (int g = 0; g < kernel->pair_rows && !k->resolves; g++)
        if (kernel->row[g].to == NS_INSIDE)
            f->highest = ns_higher(f->highest, fabs(f->work.values[g]));
}

/* The mode, and X_next, become the state's. */
static void commit_mode(ns_exact *f, ns_exact_mode *k) {
    if (f->state.mode && f->state.mode != k)
        remember_successor(f->state.mode, k, f->undecided);
    f->jumped |= f->entered != NULL;
    if (f->entered && f->point->instant)
        ns_exact_enter_count(f);
    ns_exact_take_next(f);
    f->state.mode = k;
    f->event_pair = -1;
    k->last_used = ++f->cache.clock;
    if (f->late > 0 && f->late <= f->state.event_time_error) {
        const int status = begin_at_zero(f);
        f->failed = status != NS_OK ? status : f->failed;
    }
    ns_exact_note_size(f);
    note_highest(f, k);
}

/* Commanded pairs in mode a are as they are in mode b. */
static int same_commands(const ns_exact *f, const ns_mode *a, const ns_mode *b) {
    for (int c = 0; c < f->system->nc; c++) {
        const int j = f->system->command[c].pair;
        if (a[j] != b[j])
            return 0;
    }
    return 1;
}

/* f->wanted: the present mode with the commands in point->flip changed. */
static void want_commands(ns_exact *f) {
    memcpy(f->wanted, f->state.mode->mode, (size_t)f->system->m);
    for (int c = 0; c < f->system->nc; c++) {
        ns_mode *at = &f->wanted[f->system->command[c].pair];
        if (f->point->flip[c])
            *at = f->command_target[c] != NS_TARGET_TOGGLE ? f->command_target[c] : ns_mode_toggled(*at);
    }
}

/* 1 if each guard that is undecided after the jump is that of a pair which carried an impulse: so it was
 * closed in that instant, and what is left of it is zero. */
static int impulses_decide(const ns_exact *f) {
    int all = f->entered != NULL && f->overruled == 0 && f->entered->pair_rows <= 64;
    for (int g = 0; all && g < f->entered->pair_rows; g++)
        all = !(f->undecided & ns_exact_bit_of(g)) || ns_exact_enter_carries(f, f->entered, g);
    return all;
}

/* The mode in f->wanted, if it holds; by_impulses: if those of its jump decide what is undecided.  *goes_on:
 * 1: for its jump only, another mode follows at once. */
static int try_mode(ns_exact *f, ns_evidence evidence, int by_impulses, int *goes_on) {
    ns_exact_mode *k;
    ns_modes_shared_rest(f->s->shared, f->s->shared_count, f->wanted);
    const int status = ns_exact_mode_find(f, f->wanted, &k);
    if (status != NS_OK)
        return status == NS_E_MEMORY ? status : NS_GUARD;
    const ns_mode_verdict verdict = ns_exact_mode_holds(f, k, evidence, 0);
    if (verdict == NS_VERDICT_NO || (by_impulses && verdict == NS_VERDICT_HOLDS && !impulses_decide(f)))
        return NS_GUARD;
    commit_mode(f, k);
    *goes_on = verdict == NS_VERDICT_JUMPS;
    return NS_OK;
}

static int try_wanted(ns_exact *f, ns_evidence evidence, int *goes_on) {
    return try_mode(f, evidence, 0, goes_on);
}

static int try_successors(ns_exact *f) {
    for (int i = 0; i < NS_SUCCESSORS && f->state.mode->successor[i].mode; i++) {
        ns_exact_mode *k = f->state.mode->successor[i].mode;
        if (k != f->state.mode && same_commands(f, k->mode, f->wanted) &&
            ns_exact_mode_holds(f, k, NS_EVIDENCE_NONE, f->state.mode->successor[i].undecided) ==
                NS_VERDICT_HOLDS) {
            commit_mode(f, k);
            return NS_OK;
        }
    }
    return NS_GUARD;
}

/* f->wanted: with the pairs flipped whose guards are about to break, and that of guard `broken` (-1: none),
 * which did so in the step before; 0: none is.  Where ideal devices in a loop share a current, its shares
 * here may differ by 1e-10 from those of the step. */
static int flip_broken(ns_exact *f, int broken) {
    const ns_mode_kernel *k = f->state.mode->scale[0].kernel;
    int any = 0;
    for (int g = 0; g < k->pair_rows; g++)
        if (g == broken || ns_exact_guard_sign(f, f->state.mode, g, f->X) >= NS_SIGN_SEEMS_TO_BREAK) {
            f->wanted[k->row[g].pair] = k->row[g].to;
            any = 1;
        }
    return any;
}

/* Inputs and their slopes right after the event. */
static void read_inputs_after(ns_exact *f) {
    const int nz = f->system->nz;
    const double *v = f->X + f->s->r;
    ns_system_inputs(f->system, f->state.now.t, NS_RIGHT, f->work.z_after);
    for (int k = 0; k < nz; k++) {
        f->work.slope_after[k] = 0;
        for (int i = 0; i < f->inputs->nv; i++)
            f->work.slope_after[k] += f->inputs->Z[k + i * nz] * ns_inputs_states_slope(f->inputs, i, v);
    }
}

/* f->wanted: with the pairs flipped whose guards break as soon as it is entered; 0: none is found. */
static int flip_violated(ns_exact *f) {
    ns_exact_mode *k;
    int any = 0;
    if (ns_exact_mode_find(f, f->wanted, &k) != NS_OK)
        return 0;
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    if (ns_exact_enter(f, k) && !ns_exact_enter_fits(f, kernel)) {
        const ns_guard_row *row = &kernel->row[ns_exact_enter_worst(f, kernel)];
        f->wanted[row->pair] = row->to;
        return 1;
    }
    for (int g = 0; g < kernel->pair_rows; g++)
        if (ns_exact_guard_sign(f, k, g, f->X_next) == NS_SIGN_BREAKS) {
            f->wanted[kernel->row[g].pair] = kernel->row[g].to;
            any = 1;
        }
    return any && memcmp(f->wanted, k->mode, (size_t)f->system->m) != 0;
}

/* The instant is known to no more than what counts as one, but no longer than is short beside all that the
 * mode in f->wanted resolves. */
static void know_to_an_instant(ns_exact *f, double known_to) {
    ns_exact_mode *k;
    ns_modes_shared_rest(f->s->shared, f->s->shared_count, f->wanted);
    const double brief =
        ns_exact_mode_find(f, f->wanted, &k) == NS_OK ? k->scale[0].kernel->g / 1024 : known_to;
    f->state.event_time_error = fmax(known_to, fmin(ldexp(f->h, -NS_EVENT_EXPONENT), brief));
}

/* The mode in f->wanted, or with violated pairs flipped: (P1) over a short step may have several answers.
 * known_to: NULL, or the event is known to that, and what crosses zero within an instant does so together. */
static int try_with_violated_flipped(ns_exact *f, ns_evidence evidence, const double *known_to,
                                     int *goes_on) {
    enum { MAX_ROUNDS = 4 };
    int status = NS_GUARD, more = 1;
    for (int round = 0; round <= MAX_ROUNDS && status == NS_GUARD && more; round++) {
        if (known_to)
            know_to_an_instant(f, *known_to);
        status = try_wanted(f, evidence, goes_on);
        more = status == NS_GUARD && flip_violated(f);
    }
    return status;
}

/* Tries the answer of (P1) over a short step. */
static int solve_lcp_proposal(ns_exact *f, int *goes_on) {
    if (f->state.mode)
        ns_theta_set_mode(f->s, f->wanted);
    memcpy(f->wanted, ns_theta_mode(f->s), (size_t)f->system->m);
    /* inputs at the end of the step: a sine that is zero here is not there */
    const int status = ns_theta_lcp_propose(f->s, ldexp(f->h, -NS_EVENT_EXPONENT), 0, f->X, f->work.z_after,
                                            f->work.slope_after, f->wanted);
    if (status == NS_OK)
        return try_with_violated_flipped(f, NS_EVIDENCE_STEP, NULL, goes_on);
    return status == NS_E_MEMORY || (status == NS_E_SINGULAR && !f->state.mode) ? status : NS_GUARD;
}

/* Tries the mode of the impulse problem, and takes its jump. */
static int solve_impulse(ns_exact *f) {
    ns_theta *s = f->s;
    const size_t bytes = sizeof(double) * (size_t)s->r;
    int jumps, goes_on;
    ns_theta_set_charges(s, f->X);
    int status = ns_reinit_impulse_solve(s, f->work.z_after, f->work.slope_after, NULL, &f->impulse, &jumps);
    if (status != NS_OK)
        return status == NS_E_MEMORY ? status : NS_GUARD;
    for (int i = 0; jumps && i < s->r; i++)
        f->X[i] = ns_theta_jump_w(s, i, f->impulse.x, f->impulse.X, f->impulse.Lambda);
    memcpy(f->wanted, f->impulse.mode, (size_t)f->system->m);
    status = try_wanted(f, NS_EVIDENCE_IMPULSES, &goes_on);
    f->jumped |= status == NS_OK && jumps;
    if (status != NS_OK)
        memcpy(f->X, s->past.w, bytes);
    else if (jumps && f->point->instant) {
        ns_instant_add(f->point->instant, 0, f->system->n, 1, f->impulse.X);
        ns_instant_add(f->point->instant, f->system->n, f->system->m, 1, f->impulse.Lambda);
    }
    return status;
}

/* Tries the mode that guard `broken` of the present one leads to, though another guard seems to break soon
 * there, from a value that may be rounding: (P1) and the impulse problem, which tell no two guards apart that
 * close, led nowhere.  That other guard is the next event. */
static int trust_broken(ns_exact *f, int broken, int *goes_on) {
    const ns_guard_row *row = &f->state.mode->scale[0].kernel->row[broken];
    want_commands(f);
    f->wanted[row->pair] = row->to;
    return try_wanted(f, NS_EVIDENCE_STEP, goes_on);
}

/* No mode was found: what jumped on the way did not. */
static void forget_jumps(const ns_exact *f) {
    if (f->point->instant)
        ns_instant_clear(f->point->instant);
}

/* Guards that cross zero within an instant do so together, as those of two devices do that one current takes
 * along, in whichever order; or as that of a pair does whose leak ends with a command. */
static int try_together(ns_exact *f, int broken, int *goes_on) {
    const double known_to = f->state.event_time_error;
    int status = NS_GUARD;
    want_commands(f);
    know_to_an_instant(f, known_to);
    if (flip_broken(f, broken) || broken < 0)
        status = try_with_violated_flipped(f, NS_EVIDENCE_NONE, &known_to, goes_on);
    if (status != NS_OK)
        f->state.event_time_error = known_to;
    return status;
}

/* The present mode with the commands changed, where its pairs carry the impulses of a jump; for that only
 * where a guard breaks afterwards which one of them lifted. */
static int try_with_impulses(ns_exact *f, int *goes_on) {
    want_commands(f);
    return try_mode(f, NS_EVIDENCE_STEP, 1, goes_on);
}

int ns_exact_mode_after(ns_exact *f, int by_guard, int broken, int *goes_on) {
    *goes_on = 0;
    want_commands(f);
    int status = try_successors(f);
    if (status == NS_GUARD && !by_guard) /* inputs and commands changed, maybe nothing else */
        status = try_wanted(f, NS_EVIDENCE_NONE, goes_on);
    if (status == NS_GUARD && (flip_broken(f, broken) || !by_guard))
        status = try_with_violated_flipped(f, NS_EVIDENCE_NONE, NULL, goes_on);
    if (status == NS_GUARD && broken >= 0)
        status = try_together(f, broken, goes_on);
    if (status == NS_GUARD && !by_guard)
        status = try_with_impulses(f, goes_on);
    if (status == NS_GUARD && broken < 0)
        status = try_together(f, broken, goes_on);
    f->s->counts.predicted += status == NS_OK;
    if (status != NS_GUARD)
        return status;
    want_commands(f);
    read_inputs_after(f);
    status = solve_lcp_proposal(f, goes_on);
    status = status == NS_GUARD ? solve_impulse(f) : status;
    return status == NS_GUARD && broken >= 0 ? trust_broken(f, broken, goes_on) : status;
}

int ns_exact_select_start(ns_exact *f, int guess) {
    int goes_on = 0, status = NS_GUARD;
    f->state.mode = NULL;
    f->resolves = 0;
    f->highest = 0;
    ns_exact_event_known_to(f, 0);
    ns_exact_event_is_of(f, -1);
    read_inputs_after(f);
    if (guess) {
        memcpy(f->wanted, ns_theta_mode(f->s), (size_t)f->system->m);
        status = try_wanted(f, NS_EVIDENCE_NONE, &goes_on);
    }
    if (status != NS_GUARD && !goes_on)
        return status;
    for (int round = 0; round < 4; round++) {
        status = solve_lcp_proposal(f, &goes_on);
        if (status != NS_OK || !goes_on)
            break;
    }
    if (status == NS_GUARD || goes_on)
        status = solve_impulse(f);
    if (status != NS_OK)
        forget_jumps(f);
    return status;
}

double ns_exact_event_time_error(ns_exact *f) {
    const double least = ns_exact_rounding_of_time(f);
    if (f->event_guard < 0)
        return least;
    double until;
    const ns_mode_kernel *k = ns_exact_mode_time_scale(f, &until)->kernel;
    const double noise = ns_exact_guard_rounding(f, k, f->event_guard);
    const double by_rate = noise / fabs(ns_exact_guard_of(k, k->rate, f->event_guard, f->X));
    const double by_second_rate =
        sqrt(2 * noise / fabs(ns_exact_guard_of(k, k->second_rate, f->event_guard, f->X)));
    return least + fmin(k->g, fmin(by_rate, by_second_rate));
}

void ns_exact_event_is_of(ns_exact *f, int guard) {
    const ns_mode_kernel *k = f->state.mode ? f->state.mode->scale[0].kernel : NULL;
    f->event_guard = guard;
    f->event_pair = k && guard >= 0 && guard < k->pair_rows ? k->row[guard].pair : -1;
}

void ns_exact_event_known_to(ns_exact *f, double error) {
    f->state.event_time_error = error;
    f->state.command_time_error =
        fmin(error, fmax(ns_exact_rounding_of_time(f), ldexp(f->h, -NS_EVENT_EXPONENT)));
}

int ns_exact_select_known(ns_exact *f, ns_exact_mode *to, int guard) {
    double until, error = ns_exact_rounding_of_time(f);
    ns_exact_event_is_of(f, guard);
    if (guard >= 0)
        error += ns_exact_mode_time_scale(f, &until)->kernel->g; /* it is less */
    ns_exact_event_known_to(f, error);
    if (!ns_exact_mode_holds_clearly(f, to)) {
        ns_exact_event_known_to(f, ns_exact_event_time_error(f));
        if (ns_exact_mode_holds(f, to, NS_EVIDENCE_NONE, 0) != NS_VERDICT_HOLDS)
            return 0;
    }
    commit_mode(f, to);
    return 1;
}
