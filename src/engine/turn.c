/* src/engine/turn.c - from one mode to the next, at an instant.
 *
 * A mode is right from here on if (J4) holds: no impulse that its pairs could not carry, and guards that are
 * positive, or zero and about to rise.  Modes that followed before are asked first, then the one in which
 * what broke has changed, then what (P1) says over a short step, then the impulse problem.
 */
#include "flight.h"
#include "slide.h"

#include "../linalg/lanes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What a charge or flux may move by without being called a jump, of the largest it ever was. */
static const double still = 1e-12;
/* D^8 beside D, of what is slow: far less. */
static const double slow = 1e-6;
/* An impulse of the wrong sign beside the largest. */
static const double impulse_tol = 1e-9;
/* One that adds less than this over the stage is none. */
static const double matters = 1e-6;

/* D^8 of f->next from f->series, as the last of eight implicit steps has it: by the impulses of that step,
 * each where its element is, so that charges and fluxes go from one place to another and nowhere else. */
static void impulses_of(ns_flight *f, const ns_stage *k, double *by) {
    const ns_theta *s = f->s;
    const int n = s->s->n, m = s->s->m, r = k->r;
    ns_matvec(n + m, r, k->xi, f->series + (NS_ORDER - 2) * r, f->to.x); /* and lambda; inputs do not jump */
    for (int i = 0; i < r; i++) {
        double sum = 0;
        for (int j = 0; j < n; j++)
            sum += s->A[i + j * n] * f->to.x[j];
        for (int j = 0; j < m; j++)
            sum += s->B[i + j * n] * f->to.lambda[j];
        by[i] = k->g * sum;
    }
}

/* 1 if D^8 moves any of f->next by more than rounding. */
static int moves_any(const ns_flight *f, const ns_stage *k) {
    const int r = k->r;
    for (int i = 0; i < r; i++) {
        const double *row = k->series + (NS_ORDER - 1) * r + i;
        double by = 0;
        for (int j = 0; j < k->q; j++)
            by += row[j * NS_ORDER * r] * f->next[j];
        if (fabs(by) > still * f->most[i])
            return 1;
        f->gone[i] = by;
    }
    return 0;
}

/* f->next = X after the jump that the mode asks for: what its constraints leave, 1 - D^8, and that again
 * while it leaves anything of what is fast, not instantaneous.  f->gone (r): the sum of what went.  1 if it
 * is one. */
static int jump(ns_flight *f, const ns_stage *k) {
    enum { AGAIN = 8 };
    const int r = k->r;
    int moves = 0, more = 1;
    memcpy(f->next, f->X, sizeof(double) * (size_t)k->q);
    if (!moves_any(f, k)) {
        for (int i = 0; i < r; i++)
            f->next[i] -= f->gone[i];
        return 0;
    }
    memset(f->gone, 0, sizeof(double) * (size_t)r);
    for (int round = 0; round < AGAIN && more; round++) {
        double *by = f->series + (NS_ORDER - 1) * r;
        ns_matvec(NS_ORDER * r, k->q, k->series, f->next, f->series);
        more = 0;
        for (int i = 0; i < r; i++)
            more |= fabs(by[i]) > still * f->most[i] && fabs(by[i]) > slow * fabs(f->series[i]);
        if (more)
            impulses_of(f, k, by);
        for (int i = 0; i < r; i++) {
            f->next[i] -= by[i];
            f->gone[i] += by[i];
        }
        moves |= more;
    }
    return moves;
}

/* f->next = X, as the mode is entered with it; 1 if it jumps. */
static int enter(ns_flight *f, const ns_flight_mode *k) {
    if (k->instant)
        return jump(f, k->level[0].stage);
    memcpy(f->next, f->X, sizeof(double) * (size_t)k->level[0].stage->q);
    return 0;
}

void ns_turn_settle(ns_flight *f) {
    double *X = f->X, until;
    if (!f->at->instant)
        return;
    (void)jump(f, ns_flight_level(f, &until)->stage);
    f->X = f->next;
    f->next = X;
}

/* The impulse of guard g over the stage: what it makes of the part that jumps. */
static double impulse_of(const ns_flight *f, const ns_stage *k, int g) {
    double sum = 0;
    for (int i = 0; i < k->r; i++)
        sum += k->coef[(size_t)g + (size_t)i * (size_t)(NS_ORDER * k->rows)] * f->gone[i];
    return sum;
}

static double row_of(const ns_stage *k, const double *rows, int g, const double *X) {
    double sum = 0;
    for (int j = 0; j < k->q; j++)
        sum += rows[j + g * k->q] * X[j];
    return sum;
}

/* The impulses of the pairs have the signs they may have. */
static int impulses_fit(ns_flight *f, const ns_stage *k) {
    double most = 0;
    for (int g = 0; g < k->pair_rows; g++) {
        f->rate[g] = impulse_of(f, k, g);
        most = ns_higher(most, fabs(f->rate[g]));
    }
    for (int g = 0; g < k->pair_rows; g++)
        if (f->rate[g] <
            -(impulse_tol * most + matters * fabs(row_of(k, k->value, g, f->next)) + ns_watch_noise(f, k, g)))
            return 0;
    return 1;
}

/* f->ahead: X after flying on for h 2^k in this level of a mode.  Errors: MEMORY, kept in f->status. */
static int fly_ahead(ns_flight *f, ns_level *level, int k, const double *X) {
    const ns_stage *stage = level->stage;
    ns_leg *leg;
    const int status = ns_leg_rung(f, level, k, &leg);
    if (status != NS_OK) {
        f->status = status;
        return status;
    }
    ns_leg_apply(stage, leg, X, f->ahead);
    return NS_OK;
}

/* What guard g is about to do: as its value, rate and the rate of that say; as it seems from what it comes to
 * soon, unless that is rounding that has grown, or another event was in between. */
typedef enum ns_omen { NS_STANDS, NS_SEEMS_TO_STAND, NS_UNTOLD, NS_SEEMS_TO_BREAK, NS_BREAKS } ns_omen;

static ns_omen breaks(ns_flight *f, ns_flight_mode *mode, int g, const double *X) {
    enum { SOON = 8 };
    const ns_stage *k = mode->level[0].stage;
    if (k->idle[g])
        return NS_STANDS;
    const double tol = ns_watch_noise(f, k, g), value = row_of(k, k->value, g, X);
    const double rate = row_of(k, k->rate, g, X);
    if (fabs(value) > tol + fabs(rate) * f->slack)
        return value < 0 ? NS_BREAKS : NS_STANDS;
    if (fabs(rate) * k->g > 8 * tol)
        return rate < 0 ? NS_BREAKS : NS_STANDS;
    const double bend = row_of(k, k->bend, g, X);
    if (fabs(bend) * k->g * k->g > 64 * tol)
        return bend < 0 ? NS_BREAKS : NS_STANDS;
    double start = 0;
    for (int i = 0; i < mode->levels; i++) {
        ns_level *level = ns_flight_reach(f, mode, i);
        const double until = i + 1 < mode->levels ? mode->level[i + 1].from : INFINITY;
        if (!level)
            break;
        k = level->stage;
        double h = k->h;
        for (int rung = 0; rung <= SOON && h <= until; rung++, h *= 2) {
            if (start > h || fly_ahead(f, level, rung, X) != NS_OK)
                continue;
            const double then = row_of(k, k->value, g, f->ahead);
            if (fabs(then) > 4 * ns_watch_noise(f, k, g))
                return then < 0 ? NS_SEEMS_TO_BREAK : NS_SEEMS_TO_STAND;
        }
        start = until;
    }
    return NS_UNTOLD;
}

/* Who says that a mode holds: nobody, (P1) over a short step, the impulse problem. */
typedef enum ns_word { NS_NOBODY, NS_STEP, NS_IMPULSES } ns_word;

typedef enum ns_holding { NS_NOT, NS_HOLDS, NS_JUMPS } ns_holding; /* JUMPS: at this instant, and no longer */

static uint64_t bit_of(int g) {
    return g < 64 ? (uint64_t)1 << g : 0;
}

/* Whether the mode holds from here on.  Where nothing can tell, it does if somebody says so, or said so when
 * it came to the same (untold). */
static ns_holding holds(ns_flight *f, ns_flight_mode *k, ns_word word, uint64_t untold) {
    const ns_stage *stage = k->level[0].stage;
    f->untold = 0;
    const int jumps = enter(f, k);
    if (jumps && word != NS_IMPULSES && !impulses_fit(f, stage))
        return NS_NOT;
    for (int g = 0; g < stage->pair_rows; g++) {
        const ns_omen is = breaks(f, k, g, f->next);
        const int sure = word == NS_NOBODY || (k == f->at && g == f->broken); /* that one did */
        const int told = word != NS_NOBODY || (untold & bit_of(g));
        f->untold |= is == NS_UNTOLD ? bit_of(g) : 0;
        if (is == NS_BREAKS || (is == NS_SEEMS_TO_BREAK && sure) || (is == NS_UNTOLD && !told))
            return jumps && word == NS_STEP ? NS_JUMPS : NS_NOT;
    }
    return NS_HOLDS;
}

static void remember(ns_flight_mode *from, ns_flight_mode *to, uint64_t untold) {
    int i = 0;
    while (i < NS_FOLLOWERS - 1 && from->follower[i].mode && from->follower[i].mode != to)
        i++;
    if (from->follower[i].mode == to)
        untold |= from->follower[i].untold;
    for (; i > 0; i--)
        from->follower[i] = from->follower[i - 1];
    from->follower[0] = (ns_follower){to, untold};
}

/* The mode is taken. */
static void take(ns_flight *f, ns_flight_mode *k) {
    double *X = f->X;
    if (f->at && f->at != k) {
        remember(f->at, k, f->untold);
        f->s->counts.events++;
    }
    f->X = f->next;
    f->next = X;
    f->at = k;
    k->used = ++f->clock;
    for (int i = 0; i < f->s->r; i++)
        f->most[i] = ns_higher(f->most[i], fabs(f->X[i]));
}

/* Commanded pairs in mode a are as they are in mode b. */
static int same_commands(const ns_flight *f, const ns_mode *a, const ns_mode *b) {
    for (int c = 0; c < f->m->s->nc; c++) {
        const int j = f->m->s->command[c].pair;
        if (a[j] != b[j])
            return 0;
    }
    return 1;
}

/* f->want: the present mode with the commands in m->flip changed. */
static void command(ns_flight *f) {
    memcpy(f->want, f->at->mode, (size_t)f->m->s->m);
    for (int c = 0; c < f->m->s->nc; c++) {
        ns_mode *at = &f->want[f->m->s->command[c].pair];
        if (f->m->flip[c])
            *at = f->goal[c] != NS_TOGGLES ? f->goal[c] : *at == NS_INSIDE ? NS_LOWER : NS_INSIDE;
    }
}

/* The mode in f->want, if it holds.  *on: it was there for a jump only, and the search goes on from behind
 * it. */
static int try_wanted(ns_flight *f, ns_word word, int *on) {
    ns_flight_mode *k;
    ns_twins_rest(f->s->twin, f->s->twins, f->want);
    const int status = ns_flight_find(f, f->want, &k);
    if (status != NS_OK)
        return status == NS_E_MEMORY ? status : NS_GUARD;
    const ns_holding is = holds(f, k, word, 0);
    if (is == NS_NOT)
        return NS_GUARD;
    take(f, k);
    *on = is == NS_JUMPS;
    return NS_OK;
}

static int try_followers(ns_flight *f) {
    for (int i = 0; i < NS_FOLLOWERS && f->at->follower[i].mode; i++) {
        ns_flight_mode *k = f->at->follower[i].mode;
        if (k != f->at && same_commands(f, k->mode, f->want) &&
            holds(f, k, NS_NOBODY, f->at->follower[i].untold) == NS_HOLDS) {
            take(f, k);
            return NS_OK;
        }
    }
    return NS_GUARD;
}

/* f->want: with what is about to break changed too. */
static int flip_broken(ns_flight *f) {
    const ns_stage *k = f->at->level[0].stage;
    int any = 0;
    for (int g = 0; g < k->pair_rows; g++)
        if (breaks(f, f->at, g, f->X) >= NS_SEEMS_TO_BREAK) {
            f->want[k->row[g].pair] = k->row[g].to;
            any = 1;
        }
    return any;
}

void ns_turn_inputs(ns_flight *f) {
    const int nz = f->m->s->nz;
    const double *v = f->X + f->s->r;
    ns_system_inputs(f->m->s, f->t, NS_RIGHT, f->z);
    for (int k = 0; k < nz; k++) {
        f->slope[k] = 0;
        for (int i = 0; i < f->exo->nv; i++)
            f->slope[k] += f->exo->Z[k + i * nz] * ns_exo_slope(f->exo, i, v);
    }
}

/* The guard whose impulse is of the wrong sign most; f->rate has them. */
static int worst_impulse(const ns_flight *f, const ns_stage *k) {
    int worst = 0;
    for (int g = 1; g < k->pair_rows; g++)
        if (f->rate[g] < f->rate[worst])
            worst = g;
    return worst;
}

/* f->want: with those pairs changed that break in it as soon as it is entered; 0: none is found. */
static int mend(ns_flight *f) {
    ns_flight_mode *k;
    int any = 0;
    if (ns_flight_find(f, f->want, &k) != NS_OK)
        return 0;
    const ns_stage *stage = k->level[0].stage;
    if (enter(f, k) && !impulses_fit(f, stage)) {
        const ns_guard_row *row = &stage->row[worst_impulse(f, stage)];
        f->want[row->pair] = row->to;
        return 1;
    }
    for (int g = 0; g < stage->pair_rows; g++)
        if (breaks(f, k, g, f->next) == NS_BREAKS) {
            f->want[stage->row[g].pair] = stage->row[g].to;
            any = 1;
        }
    return any && memcmp(f->want, k->mode, (size_t)f->m->s->m) != 0;
}

/* The mode in f->want, on somebody's word, or one that mends what breaks in it: (P1) may have one of several
 * that would all do for it. */
static int try_mended(ns_flight *f, ns_word word, int *on) {
    enum { MENDS = 4 };
    int status = try_wanted(f, word, on);
    for (int round = 0; round < MENDS && status == NS_GUARD && mend(f); round++)
        status = try_wanted(f, word, on);
    return status;
}

/* The modes that (P1) has over short steps. */
static int propose(ns_flight *f, int *on) {
    static const int rungs[] = {-NS_EVENT_RUNG, -10, -30};
    ns_theta *s = f->s;
    if (f->at)
        ns_flight_show(f, f->want);
    for (int i = 0; i < 3; i++) {
        const double h = ldexp(f->m->h, rungs[i]);
        memcpy(s->trial_in, f->X, sizeof(double) * (size_t)s->r);
        for (int k = 0; k < s->s->nz; k++) /* at the end of the step: a sine that is zero here is not there */
            s->trial_in[s->r + k] = f->z[k] + h * f->slope[k];
        s->trial_in[s->q - 1] = 1;
        memcpy(s->trial_mode, s->mode, (size_t)s->s->m);
        int status = ns_problem_solve(s, h, 1, 0);
        if (status == NS_E_SINGULAR && !f->at)
            return status;
        if (status == NS_OK) {
            memcpy(f->want, s->trial_mode, (size_t)s->s->m);
            status = try_mended(f, NS_STEP, on);
        }
        if (status == NS_OK || status == NS_E_MEMORY)
            return status;
    }
    return NS_GUARD;
}

/* The impulse problem proves its mode, and has the jump. */
static int prove(ns_flight *f) {
    ns_theta *s = f->s;
    const size_t bytes = sizeof(double) * (size_t)s->r;
    int jumps, on;
    memcpy(s->w, f->X, bytes);
    int status = ns_impulse_solve(s, f->z, f->slope, NULL, &f->to, &jumps);
    if (status != NS_OK)
        return status == NS_E_MEMORY ? status : NS_GUARD;
    for (int i = 0; jumps && i < s->r; i++)
        f->X[i] = ns_theta_jump_w(s, i, f->to.x, f->to.X, f->to.Lambda);
    memcpy(f->want, f->to.mode, (size_t)f->m->s->m);
    status = try_wanted(f, NS_IMPULSES, &on);
    if (status != NS_OK)
        memcpy(f->X, s->w, bytes);
    return status;
}

static int turn_once(ns_flight *f, int natural, int *on) {
    int status = NS_GUARD;
    *on = 0;
    command(f);
    if (!natural) /* nothing but inputs and commands may have changed */
        status = try_wanted(f, NS_NOBODY, on);
    if (status == NS_GUARD)
        status = try_followers(f);
    if (status == NS_GUARD && (flip_broken(f) || !natural))
        status = try_mended(f, NS_NOBODY, on);
    f->s->counts.settled += status == NS_OK;
    if (status != NS_GUARD)
        return status;
    command(f);
    ns_turn_inputs(f);
    status = propose(f, on);
    return status == NS_GUARD ? prove(f) : status;
}

int ns_turn_start(ns_flight *f) {
    int on = 0, status = NS_OK;
    f->at = NULL;
    f->slack = 0;
    f->broken = -1;
    ns_turn_inputs(f);
    for (int round = 0; round < 4; round++) {
        status = propose(f, &on);
        if (status != NS_OK || !on)
            break;
    }
    return status == NS_GUARD || on ? prove(f) : status;
}

/* How well the instant is known at which a guard broke: its rounding by its rate. */
static double slack(ns_flight *f, int natural) {
    const ns_stage *k = f->at->level[0].stage;
    const double least = 4 * DBL_EPSILON * fabs(f->t);
    if (!natural || f->broken < 0 || f->broken >= k->rows)
        return least;
    double until;
    k = ns_flight_level(f, &until)->stage;
    const double noise = ns_watch_noise(f, k, f->broken);
    const double by_rate = noise / fabs(row_of(k, k->rate, f->broken, f->X));
    const double by_bend = sqrt(2 * noise / fabs(row_of(k, k->bend, f->broken, f->X)));
    return least + fmin(k->g, fmin(by_rate, by_bend));
}

static void no_flips(ns_flight *f) {
    for (int c = 0; c < f->m->s->nc; c++) {
        f->m->flip[c] = 0;
        f->goal[c] = NS_TOGGLES;
    }
}

/* Which way the current of a closed switch goes. */
static ns_mode slide_of(const ns_flight *f, int pair) {
    const ns_stage *k = f->at->level[0].stage;
    const int n = f->m->s->n, all = n + f->m->s->m;
    double sum = 0;
    for (int j = 0; j < k->q; j++)
        sum += k->xi[(size_t)(n + pair) + (size_t)j * (size_t)all] * f->X[j];
    return sum >= 0 ? NS_SLIDES : NS_SLIDES_BACK;
}

/* Command c by the state changes; one that would at once change back, without a hysteresis, slides. */
static void flip(ns_flight *f, int c) {
    const ns_command *of = &f->m->s->command[c];
    f->m->flip[c] = 1;
    if (f->turns[c] < 2)
        f->turns[c]++;
    if (f->turns[c] == 2 && of->on == of->off && f->at->mode[of->pair] == NS_INSIDE)
        f->goal[c] = slide_of(f, of->pair);
}

/* Commands by the state that are beyond their thresholds, or about to be, into m->flip; how many. */
static int contradicted(ns_flight *f) {
    const ns_stage *k = f->at->level[0].stage;
    int count = 0;
    no_flips(f);
    for (int g = k->pair_rows; g < k->rows; g++)
        if (breaks(f, f->at, g, f->X) == NS_BREAKS) {
            flip(f, k->row[g].command);
            count++;
        }
    return count;
}

/* The guard that broke here, by what the flight came with, or (it went another way in between) by looking;
 * -1: none does. */
static void recall_guard(ns_flight *f) {
    const ns_stage *k = f->at->level[0].stage;
    if (f->broken_t == f->t && f->broken_at == f->at && f->broken >= 0 && f->broken < k->rows)
        return;
    f->broken = -1;
    for (int g = 0; g < k->rows && f->broken < 0; g++)
        if (breaks(f, f->at, g, f->X) >= NS_SEEMS_TO_BREAK)
            f->broken = g;
}

/* What broke was the guard of a command, or one that keeps a switch sliding: commands, then, change. */
static int flip_by_guard(ns_flight *f) {
    const ns_guard_row *row = &f->at->level[0].stage->row[f->broken];
    int c = row->command;
    if (c >= 0) {
        flip(f, c);
        return 1;
    }
    if (!ns_slides(f->at->mode[row->pair]))
        return 0;
    for (c = 0; f->m->s->command[c].pair != row->pair;)
        c++;
    f->m->flip[c] = 1;
    f->goal[c] = row->to;
    return 1;
}

/* A switch may make another one switch, and so may a jump; a set of them that finds no rest is for others. */
int ns_turn(ns_flight *f, int natural) {
    enum { JUMPS = 4 };
    ns_flight_mode *const was = f->at;
    const size_t q = (size_t)f->s->r + (size_t)f->exo->nv, nc = (size_t)f->m->s->nc;
    int status = NS_GUARD, on = 0;
    memcpy(f->left, f->X, sizeof(double) * q);
    f->slack = 4 * DBL_EPSILON * fabs(f->t);
    if (natural)
        recall_guard(f);
    else
        f->broken = -1;
    f->slack = slack(f, natural);
    for (size_t c = 0; c < nc; c++)
        f->goal[c] = NS_TOGGLES;
    memset(f->turns, 0, nc);
    if (f->broken >= 0 && flip_by_guard(f))
        natural = 0;
    for (int round = 0; round <= 2 * f->m->s->nc + JUMPS; round++) {
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
