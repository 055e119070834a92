/* src/exact/mode_selection.c - from one mode to the next, at an instant.
 *
 * A mode is right from here on if (J4) holds: no impulse that its pairs could not carry, and guards that are
 * positive, or zero and about to rise.  Modes that followed before are asked first, then the one in which
 * what broke has changed, then what (P1) says over a short step, then the impulse problem.
 */
#include "mode_selection.h"
#include "sliding.h"

#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <string.h>

static void remember(ns_exact_mode *from, ns_exact_mode *to, uint64_t untold) {
    int i = 0;
    while (i < NS_SUCCESSORS - 1 && from->follower[i].mode && from->follower[i].mode != to)
        i++;
    if (from->follower[i].mode == to)
        untold |= from->follower[i].untold;
    for (; i > 0; i--)
        from->follower[i] = from->follower[i - 1];
    from->follower[0] = (ns_successor){to, untold};
}

/* Where it is counts among the largest. */
static void note_size(ns_exact *f) {
    for (int i = 0; i < f->s->r; i++)
        f->most[i] = ns_higher(f->most[i], fabs(f->X[i]));
}

/* The mode is taken. */
static void take(ns_exact *f, ns_exact_mode *k) {
    double *X = f->X;
    if (f->at && f->at != k) {
        remember(f->at, k, f->untold);
        f->s->counts.events++;
    }
    f->X = f->next;
    f->next = X;
    f->at = k;
    k->used = ++f->clock;
    note_size(f);
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

/* f->want: the present mode with the commands in point->flip changed. */
static void command(ns_exact *f) {
    memcpy(f->want, f->at->mode, (size_t)f->system->m);
    for (int c = 0; c < f->system->nc; c++) {
        ns_mode *at = &f->want[f->system->command[c].pair];
        if (f->point->flip[c])
            *at = f->goal[c] != NS_TARGET_TOGGLE ? f->goal[c] : ns_mode_toggled(*at);
    }
}

/* The mode in f->want, if it holds.  *on: it was there for a jump only, and the search goes on from behind
 * it. */
static int try_wanted(ns_exact *f, ns_evidence word, int *on) {
    ns_exact_mode *k;
    ns_modes_shared_rest(f->s->twin, f->s->twins, f->want);
    const int status = ns_exact_mode_find(f, f->want, &k);
    if (status != NS_OK)
        return status == NS_E_MEMORY ? status : NS_GUARD;
    const ns_mode_verdict is = ns_exact_mode_holds(f, k, word, 0);
    if (is == NS_VERDICT_NO)
        return NS_GUARD;
    take(f, k);
    *on = is == NS_VERDICT_JUMPS;
    return NS_OK;
}

static int try_followers(ns_exact *f) {
    for (int i = 0; i < NS_SUCCESSORS && f->at->follower[i].mode; i++) {
        ns_exact_mode *k = f->at->follower[i].mode;
        if (k != f->at && same_commands(f, k->mode, f->want) &&
            ns_exact_mode_holds(f, k, NS_EVIDENCE_NONE, f->at->follower[i].untold) == NS_VERDICT_HOLDS) {
            take(f, k);
            return NS_OK;
        }
    }
    return NS_GUARD;
}

/* f->want: with what is about to break changed too. */
static int flip_broken(ns_exact *f) {
    const ns_mode_kernel *k = f->at->level[0].stage;
    int any = 0;
    for (int g = 0; g < k->pair_rows; g++)
        if (ns_exact_guard_sign(f, f->at, g, f->X) >= NS_SIGN_SEEMS_TO_BREAK) {
            f->want[k->row[g].pair] = k->row[g].to;
            any = 1;
        }
    return any;
}

void ns_exact_select_inputs(ns_exact *f) {
    const int nz = f->system->nz;
    const double *v = f->X + f->s->r;
    ns_system_inputs(f->system, f->t, NS_RIGHT, f->z);
    for (int k = 0; k < nz; k++) {
        f->slope[k] = 0;
        for (int i = 0; i < f->exo->nv; i++)
            f->slope[k] += f->exo->Z[k + i * nz] * ns_inputs_states_slope(f->exo, i, v);
    }
}

/* f->want: with those pairs changed that break in it as soon as it is entered; 0: none is found. */
static int mend(ns_exact *f) {
    ns_exact_mode *k;
    int any = 0;
    if (ns_exact_mode_find(f, f->want, &k) != NS_OK)
        return 0;
    const ns_mode_kernel *stage = k->level[0].stage;
    if (ns_exact_enter(f, k) && !ns_exact_enter_fits(f, stage)) {
        const ns_guard_row *row = &stage->row[ns_exact_enter_worst(f, stage)];
        f->want[row->pair] = row->to;
        return 1;
    }
    for (int g = 0; g < stage->pair_rows; g++)
        if (ns_exact_guard_sign(f, k, g, f->next) == NS_SIGN_BREAKS) {
            f->want[stage->row[g].pair] = stage->row[g].to;
            any = 1;
        }
    return any && memcmp(f->want, k->mode, (size_t)f->system->m) != 0;
}

/* The mode in f->want, on somebody's word, or one that mends what breaks in it: (P1) may have one of several
 * that would all do for it. */
static int try_mended(ns_exact *f, ns_evidence word, int *on) {
    enum { MENDS = 4 };
    int status = try_wanted(f, word, on);
    for (int round = 0; round < MENDS && status == NS_GUARD && mend(f); round++)
        status = try_wanted(f, word, on);
    return status;
}

/* The modes that (P1) has over short steps. */
static int propose(ns_exact *f, int *on) {
    static const int rungs[] = {-NS_EVENT_EXPONENT, -10, -30};
    if (f->at)
        ns_theta_set_mode(f->s, f->want);
    for (int i = 0; i < 3; i++) {
        const double h = ldexp(f->h, rungs[i]);
        memcpy(f->want, ns_theta_mode(f->s), (size_t)f->system->m);
        /* inputs at the end of the step: a sine that is zero here is not there */
        int status = ns_theta_lcp_propose(f->s, h, 0, f->X, f->z, f->slope, f->want);
        if (status == NS_E_SINGULAR && !f->at)
            return status;
        if (status == NS_OK)
            status = try_mended(f, NS_EVIDENCE_STEP, on);
        if (status == NS_OK || status == NS_E_MEMORY)
            return status;
    }
    return NS_GUARD;
}

/* The impulse problem proves its mode, and has the jump. */
static int prove(ns_exact *f) {
    ns_theta *s = f->s;
    const size_t bytes = sizeof(double) * (size_t)s->r;
    int jumps, on;
    ns_theta_set_charges(s, f->X);
    int status = ns_reinit_impulse_solve(s, f->z, f->slope, NULL, &f->to, &jumps);
    if (status != NS_OK)
        return status == NS_E_MEMORY ? status : NS_GUARD;
    for (int i = 0; jumps && i < s->r; i++)
        f->X[i] = ns_theta_jump_w(s, i, f->to.x, f->to.X, f->to.Lambda);
    memcpy(f->want, f->to.mode, (size_t)f->system->m);
    status = try_wanted(f, NS_EVIDENCE_IMPULSES, &on);
    if (status != NS_OK)
        memcpy(f->X, s->past.w, bytes);
    return status;
}

static int turn_once(ns_exact *f, int natural, int *on) {
    *on = 0;
    command(f);
    int status = try_followers(f);
    if (status == NS_GUARD && !natural) /* nothing but inputs and commands may have changed */
        status = try_wanted(f, NS_EVIDENCE_NONE, on);
    if (status == NS_GUARD && (flip_broken(f) || !natural))
        status = try_mended(f, NS_EVIDENCE_NONE, on);
    f->s->counts.predicted += status == NS_OK;
    if (status != NS_GUARD)
        return status;
    command(f);
    ns_exact_select_inputs(f);
    status = propose(f, on);
    return status == NS_GUARD ? prove(f) : status;
}

int ns_exact_select_start(ns_exact *f) {
    int on = 0, status = NS_OK;
    f->at = NULL;
    f->slack = 0;
    f->broken = -1;
    ns_exact_select_inputs(f);
    for (int round = 0; round < 4; round++) {
        status = propose(f, &on);
        if (status != NS_OK || !on)
            break;
    }
    return status == NS_GUARD || on ? prove(f) : status;
}

/* How well the instant is known at which a guard broke: its rounding by its rate. */
static double slack(ns_exact *f, int natural) {
    const ns_mode_kernel *k = f->at->level[0].stage;
    const double least = 4 * DBL_EPSILON * fabs(f->t);
    if (!natural || f->broken < 0 || f->broken >= k->rows)
        return least;
    double until;
    k = ns_exact_mode_time_scale(f, &until)->stage;
    const double noise = ns_exact_guard_rounding(f, k, f->broken);
    const double by_rate = noise / fabs(ns_exact_guard_of(k, k->rate, f->broken, f->X));
    const double by_bend = sqrt(2 * noise / fabs(ns_exact_guard_of(k, k->bend, f->broken, f->X)));
    return least + fmin(k->g, fmin(by_rate, by_bend));
}

static void no_flips(ns_exact *f) {
    for (int c = 0; c < f->system->nc; c++) {
        f->point->flip[c] = 0;
        f->goal[c] = NS_TARGET_TOGGLE;
    }
}

/* Which way the current of a closed switch goes. */
static ns_mode slide_of(const ns_exact *f, int pair) {
    const ns_mode_kernel *k = f->at->level[0].stage;
    const int n = f->system->n, all = n + f->system->m;
    double sum = 0;
    for (int j = 0; j < k->q; j++)
        sum += k->xi[(size_t)(n + pair) + (size_t)j * (size_t)all] * f->X[j];
    return sum >= 0 ? NS_SLIDES_UP : NS_SLIDES_DOWN;
}

/* Command c by the state changes; one that would at once change back, without a hysteresis, slides. */
static void flip(ns_exact *f, int c) {
    const ns_command *of = &f->system->command[c];
    f->point->flip[c] = 1;
    if (f->turns[c] < 2)
        f->turns[c]++;
    if (f->turns[c] == 2 && of->on == of->off && f->at->mode[of->pair] == NS_INSIDE)
        f->goal[c] = slide_of(f, of->pair);
}

/* Commands by the state that are beyond their thresholds, or about to be, into point->flip; how many. */
static int contradicted(ns_exact *f) {
    const ns_mode_kernel *k = f->at->level[0].stage;
    int count = 0;
    no_flips(f);
    for (int g = k->pair_rows; g < k->rows; g++)
        if (ns_exact_guard_sign(f, f->at, g, f->X) == NS_SIGN_BREAKS) {
            flip(f, k->row[g].command);
            count++;
        }
    return count;
}

/* The guard that broke here, by what the exact came with, or (it went another way in between) by looking;
 * -1: none does. */
static void recall_guard(ns_exact *f) {
    const ns_mode_kernel *k = f->at->level[0].stage;
    if (f->broken_t == f->t && f->broken_at == f->at && f->broken >= 0 && f->broken < k->rows)
        return;
    f->broken = -1;
    for (int g = 0; g < k->rows && f->broken < 0; g++)
        if (ns_exact_guard_sign(f, f->at, g, f->X) >= NS_SIGN_SEEMS_TO_BREAK)
            f->broken = g;
}

/* What broke was the guard of a command, or one that keeps a switch sliding: commands, then, change. */
static int flip_by_guard(ns_exact *f) {
    const ns_guard_row *row = &f->at->level[0].stage->row[f->broken];
    int c = row->command;
    if (c >= 0) {
        flip(f, c);
        return 1;
    }
    if (!ns_mode_slides(f->at->mode[row->pair]))
        return 0;
    for (c = 0; f->system->command[c].pair != row->pair;)
        c++;
    f->point->flip[c] = 1;
    f->goal[c] = row->to;
    return 1;
}

int ns_exact_select_known(ns_exact *f, ns_exact_mode *to, int natural) {
    double until;
    f->slack = 4 * DBL_EPSILON * fabs(f->t);
    if (natural)
        f->slack += ns_exact_mode_time_scale(f, &until)->stage->g; /* it is less */
    else
        f->broken = -1;
    if (!ns_exact_mode_holds_clearly(f, to)) {
        f->slack = slack(f, natural);
        if (ns_exact_mode_holds(f, to, NS_EVIDENCE_NONE, 0) != NS_VERDICT_HOLDS)
            return 0;
    }
    take(f, to);
    return 1;
}

/* A switch may make another one switch, and so may a jump; a set of them that finds no rest is for others. */
int ns_exact_select_mode(ns_exact *f, int natural) {
    enum { JUMPS = 4 };
    ns_exact_mode *const was = f->at;
    const size_t q = (size_t)f->s->r + (size_t)f->exo->nv, nc = (size_t)f->system->nc;
    int status = NS_GUARD, on = 0;
    memcpy(f->left, f->X, sizeof(double) * q);
    note_size(f);
    f->slack = 4 * DBL_EPSILON * fabs(f->t);
    if (natural)
        recall_guard(f);
    else
        f->broken = -1;
    f->slack = slack(f, natural);
    for (size_t c = 0; c < nc; c++)
        f->goal[c] = NS_TARGET_TOGGLE;
    memset(f->turns, 0, nc);
    if (f->broken >= 0 && flip_by_guard(f))
        natural = 0;
    for (int round = 0; round <= 2 * f->system->nc + JUMPS; round++) {
        status = turn_once(f, natural || on, &on);
        if (status != NS_OK)
            break;
        if (on)
            no_flips(f);
        else if (!contradicted(f))
            break;
        status = NS_GUARD;
        natural = 0;
    }
    no_flips(f);
    if (f->status != NS_OK) {
        status = f->status;
        f->status = NS_OK;
    }
    if (status != NS_OK) {
        memcpy(f->X, f->left, sizeof(double) * q);
        f->at = was;
    }
    return status;
}
