/* bridge/own_current.c - the first pass: the current that each D of ngspice carries, and each M that follows
 * its gate.
 *
 * The voltage of its curve goes with the logarithm of the current, so that is a mean of the logarithm
 * (ns_pulse_mean).  In breakdown it is the same.  The pass takes every D for its curve at 1 mA, and its
 * points are few.
 */
#include "own_current.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "interrupt.h"
#include "own_follower.h"
#include "own_structs.h"
#include "pure/timepoints.h"

/* Steps; and, in steps times unknowns and devices, how far it goes beyond the slowest period of a source, and
 * how far to come to its end.  Matrices that are factored anew take as long as so many steps. */
enum { LEAST_STEPS = 200, CHEAP_WORK = 300000, MOST_WORK = 30000000, STEPS_OF_FACTORS = 30 };

/* In circuits of more unknowns and devices each pass counts. */
enum { BRIEF_SIZE = 64 };
#define BRIEF_SHARE 0.125 /* of the run, and of the work */

enum { FIRST_MARK = 30 }; /* so often a half of the run */

enum { PARTS = 4 }; /* equal ones of a step, each read in its middle */

int ns_bridge_own_diode_element(const ns_own_taken *o) {
    return o->kind == OWN_DIODE ? o->id : o->kind == OWN_MOSFET ? o->body : -1;
}

void ns_bridge_own_add_beyond(const ns_analysis *a, const ns_own_taken *o, const ns_mode *mode, double *i) {
    double more;
    if (o->beyond_id &&
        ns_circuit_device(a->ex.circuit, o->beyond_id, a->x, a->lambda, mode, &more, NULL, NULL) == NS_OK)
        *i += more;
}

double ns_bridge_own_slope_beyond(const ns_own_taken *o) {
    return o->diode.ron * o->beyond.ron / (o->diode.ron + o->beyond.ron);
}

int ns_bridge_own_wants_currents(const ns_analysis *a) {
    if (!isnan(a->ex.options.id) || a->ex.options.zero_diodes || ns_bridge_digital_is(&a->ex.digital))
        return 0; /* what digital parts do is known to ngspice's event queue alone */
    for (int k = 0; k < a->ex.nowns; k++)
        if (ns_bridge_own_diode_element(&a->ex.own[k]) >= 0)
            return 1;
    return 0;
}

double ns_bridge_own_brief_stop(const ns_analysis *a, double stop) {
    const double brief = fmax(BRIEF_SHARE * stop, 2.0 * ns_bridge_timepoints_slowest(a->system, stop));
    return a->count > BRIEF_SIZE ? stop : fmin(brief, stop);
}

int ns_bridge_own_pass_march(const ns_analysis *a, double stop, ns_march **march) {
    const ns_march_options o = {.theta = 1.0,
                                .gamma = 1.0,
                                .h = ns_bridge_timepoints_longest_step(a->system, stop),
                                .method = NS_AUTO};
    return ns_march_create(a->system, &o, march, NULL);
}

/* What a D carries in the long run counts: not an inrush, which would set the D of one bridge apart, nor what
 * flows before tstart, which is not shown.  So pulses are read anew at marks, each twice as late as the one
 * before, and those since the mark before the last one count: since the middle of the run, or of what the
 * pass came to, at least.  A pulse that began earlier counts with all its charge: it may be the only one.
 * Where the pass is to end after one and a half of the slowest period of a source, the marks are a half of
 * that and all of it: what counts is a period, as parts of one have the D of a bridge unequal. */
typedef struct own_window {
    ns_pulse_mean all, late; /* since its begin; since the last mark */
    ns_pulse_mean before;    /* between that and the mark before it */
} own_window;

typedef struct own_mean {
    own_window run, shown; /* since the start; since tstart, where that is later */
    double blocks;         /* V: the largest across it while it is off */
} own_mean;

typedef struct own_pass {
    ns_analysis *a; /* its point is that of the pass */
    ns_march *march;
    own_mean *mean; /* of the taken, in their order: OWN_PATHS each */
    double start;   /* s: tstart */
    double slowest; /* s: period of a source, or stop */
    double stop;    /* s */
    double mark;    /* s: the next one */
    double t;       /* s: how far it came */
    int brief;
    int is_dear; /* it is to end after little more than the slowest period */
} own_pass;

/* What a D carries; of an M, what both its junctions do: *on: 1 if one conducts, -1 if one breaks down. */
static int read_diode(const own_pass *p, const ns_own_taken *o, const ns_mode *mode, double *i, double *v,
                      int *on) {
    const ns_analysis *a = p->a;
    const int element = ns_bridge_own_diode_element(o);
    double bulk_i, bulk_v;
    int bulk_on;
    if (element < 0 || ns_circuit_device(a->ex.circuit, element, a->x, a->lambda, mode, i, v, on) != NS_OK)
        return 0;
    ns_bridge_own_add_beyond(a, o, mode, i);
    if (o->kind != OWN_MOSFET || o->bulk < 0 ||
        ns_circuit_device(a->ex.circuit, o->bulk, a->x, a->lambda, mode, &bulk_i, &bulk_v, &bulk_on) !=
            NS_OK ||
        bulk_on == 0)
        return 1;
    *i = bulk_on == *on ? *i + bulk_i : bulk_i;
    *on = bulk_on;
    return 1;
}

static double voltage_at(const ns_analysis *a, int eq) {
    return eq > 0 && a->unknown[eq] >= 0 ? a->x[a->unknown[eq]] : 0.0;
}

int ns_bridge_own_is_following(const ns_analysis *a, const ns_own_taken *o) {
    const ns_own_mosfet *m = &o->mosfet;
    return ns_bridge_own_saturates(o) &&
           m->sign * (voltage_at(a, m->drain) - voltage_at(a, m->gate)) > -m->vth;
}

static void add_to_window(own_window *w, int is_on, double i, double from, double to) {
    ns_bridge_pulse_mean_add(&w->all, is_on, i, from, to);
    ns_bridge_pulse_mean_add(&w->late, is_on, i, from, to);
}

static void add_current(own_mean *mean, int is_on, double i, double from, double to) {
    add_to_window(&mean->run, is_on, i, from, to);
    add_to_window(&mean->shown, is_on, i, from, to);
}

/* Of one that closes, what it carries then counts too. */
static void add_channel(const own_pass *p, const ns_own_taken *o, const ns_mode *mode, own_mean *mean,
                        double from, double to) {
    const ns_analysis *a = p->a;
    double i;
    if (ns_bridge_own_saturates(o) &&
        ns_circuit_device(a->ex.circuit, o->id, a->x, a->lambda, mode, &i, NULL, NULL) == NS_OK)
        add_current(mean,
                    i > NS_LEAK && (o->follows == FOLLOWS_AND_CLOSES || ns_bridge_own_is_following(a, o)), i,
                    from, to);
}

/* The march was sampled between two times, s. */
static void add_part(const own_pass *p, double from, double to) {
    const ns_analysis *a = p->a;
    const ns_mode *mode = ns_march_mode(p->march);
    for (int k = 0; k < a->ex.nowns; k++) {
        own_mean *mean = &p->mean[OWN_PATHS * k];
        double i, v;
        int on;
        add_channel(p, &a->ex.own[k], mode, &mean[OWN_CHANNEL], from, to);
        if (!read_diode(p, &a->ex.own[k], mode, &i, &v, &on))
            continue;
        add_current(&mean[OWN_FORWARDS], on > 0, i, from, to);
        add_current(&mean[OWN_BACKWARDS], on < 0, -i, from, to);
        for (int path = OWN_FORWARDS; path <= OWN_BACKWARDS; path++)
            mean[path].blocks = fmax(mean[path].blocks, on ? 0.0 : fabs(v));
    }
}

/* Pulses that end from now on count. */
static void begin_anew(ns_pulse_mean *mean) {
    mean->weight = mean->sum = 0.0;
    mean->most = mean->pulse.most;
}

static void pass_mark(own_window *w) {
    w->before = w->late;
    begin_anew(&w->late);
}

/* Also of the present pulse only what follows counts. */
static void begin_window(own_window *w, double t) {
    w->before = (ns_pulse_mean){0};
    ns_bridge_pulse_mean_end(&w->all, t);
    ns_bridge_pulse_mean_end(&w->late, t);
    begin_anew(&w->all);
    begin_anew(&w->late);
}

/* It came from one time to another, s. */
static void pass_marks(own_pass *p, double from, double t) {
    const int at_start = from < p->start && t >= p->start;
    for (int k = 0; k < OWN_PATHS * p->a->ex.nowns && (t >= p->mark || at_start); k++) {
        own_mean *m = &p->mean[k];
        if (t >= p->mark) {
            pass_mark(&m->run);
            pass_mark(&m->shown);
        }
        if (at_start)
            begin_window(&m->shown, t);
    }
    while (p->mark <= t)
        p->mark *= 2.0;
    p->t = t;
}

/* The last trial, from one time to another, s. */
static int add_between(own_pass *p, double from, double end) {
    const int status = ns_march_sample(p->march, 0.5 * (from + end), p->a->x, p->a->lambda);
    if (status != NS_OK)
        return status;
    add_part(p, from, end);
    pass_marks(p, from, end);
    return NS_OK;
}

/* The trial from the accepted time `from` to its end: what is fast is fast at its begin, and is read in parts
 * that double. */
static int add_step(own_pass *p, double from, double end) {
    const double part = (end - from) / PARTS, shortest = ns_march_shortest(p->march, from, NULL);
    double since = from;
    int status = NS_OK;
    for (double to = shortest; to < part && to > part * DBL_EPSILON && status == NS_OK; to *= 2.0) {
        status = add_between(p, since, from + to);
        since = from + to;
    }
    for (int k = 1; k <= PARTS && status == NS_OK; k++) {
        const double to = k < PARTS ? from + k * part : end;
        status = add_between(p, since, to);
        since = to;
    }
    return status;
}

/* s: the time that it goes to where much work is allowed. */
static double least_of(const own_pass *p) {
    return fmin(1.5 * p->slowest, p->stop);
}

/* How far it goes is the same for every run of this circuit. */
static int is_long_enough(own_pass *p, int steps, double t) {
    const double factors = (double)ns_march_counts(p->march)->factors;
    const double share = p->brief ? BRIEF_SHARE : 1.0;
    const double work = ((double)steps + STEPS_OF_FACTORS * factors) * (double)(p->a->count + 1);
    const double half = 0.5 * p->slowest;
    if (work >= share * CHEAP_WORK && t < 2.0 * half && !p->is_dear) {
        p->is_dear = 1;
        p->mark = t < half ? half : 2.0 * half;
    }
    return t >= p->stop ||
           (steps >= LEAST_STEPS && work >= share * (t < least_of(p) ? MOST_WORK : CHEAP_WORK));
}

/* *t: how far it came, s. */
static int pass(own_pass *p, double *t) {
    double end;
    int status = ns_march_read(p->march, t, NULL, NULL, NULL);
    for (int k = 0; status == NS_OK && !is_long_enough(p, k, *t) && !ns_bridge_interrupt_came(); k++) {
        status = ns_march_try(p->march, p->stop, NS_TO_STEP, &end);
        if (status == NS_OK && end > *t)
            status = add_step(p, *t, end);
        if (status == NS_OK)
            status = ns_march_accept(p->march);
        if (status == NS_OK)
            *t = end;
    }
    return status;
}

/* 1 if what it saw of what is shown is as long as it is to be: a part of a period has its D unequal. */
static int is_shown(const own_pass *p) {
    return p->t - p->start >= p->slowest || p->t >= p->stop;
}

/* What counts of a window; where it carried no more than a leak since the mark before the last one, all. */
static ns_pulse_mean mean_of_window(own_window *w, double t) {
    ns_bridge_pulse_mean_end(&w->all, t);
    ns_bridge_pulse_mean_end(&w->late, t);
    const ns_pulse_mean late = {.weight = w->late.weight + w->before.weight,
                                .sum = w->late.sum + w->before.sum,
                                .most = fmax(w->late.most, w->before.most)};
    return ns_bridge_pulse_mean_read(&late) < NS_LEAK ? w->all : late;
}

/* What counts of the k-th. */
static ns_pulse_mean mean_of(const own_pass *p, int k) {
    own_mean *m = &p->mean[k];
    const ns_pulse_mean run = mean_of_window(&m->run, p->t), shown = mean_of_window(&m->shown, p->t);
    return is_shown(p) && ns_bridge_pulse_mean_read(&shown) > 0.0 ? shown : run;
}

/* One that carried no more than a leak may do so because it did not begin yet, or because another one leaks;
 * in breakdown that says nothing. */
static void note_current(const own_pass *p, int k, ns_own_found *currents) {
    const ns_own_path path = (ns_own_path)(k % OWN_PATHS);
    const ns_pulse_mean mean = mean_of(p, k);
    const double amperes = ns_bridge_pulse_mean_read(&mean);
    const int faint = path == OWN_FORWARDS && amperes < (1.0 - 1e-6) * NS_LEAK;
    if (amperes > 0.0 && !(path != OWN_FORWARDS && amperes < NS_LEAK) && !(p->brief && faint))
        currents->of[currents->count++] =
            (ns_own_current){.inst = p->a->ex.own[k / OWN_PATHS].inst,
                             .id = faint ? NS_OWN_CURRENT : amperes,
                             .most = mean.most,
                             .rush = is_shown(p) ? p->mean[k].shown.all.most : p->mean[k].run.all.most,
                             .blocks = p->mean[k].blocks,
                             .faint = faint,
                             .path = path};
}

int ns_bridge_own_find_currents(ns_analysis *a, ns_march *march, double start, double stop, int brief,
                                ns_own_found *currents) {
    const size_t count = OWN_PATHS * (size_t)a->ex.nowns + 1;
    own_pass p = {.a = a,
                  .march = march,
                  .mean = calloc(count, sizeof *p.mean),
                  .start = start,
                  .slowest = ns_bridge_timepoints_slowest(a->system, stop),
                  .stop = stop,
                  .mark = ldexp(stop, -FIRST_MARK),
                  .brief = brief};
    unsigned char *grouped = calloc(count, 1);
    free(currents->of);
    currents->count = 0;
    currents->of = calloc(count, sizeof *currents->of);
    const int status = p.mean && grouped && currents->of ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        currents->fails = pass(&p, &currents->seconds) != NS_OK;
        currents->whole = currents->seconds >= stop;
        for (int k = 0; k < OWN_PATHS * a->ex.nowns; k++)
            note_current(&p, k, currents);
        ns_bridge_own_round_in_groups(currents, grouped);
    }
    free(p.mean);
    free(grouped);
    return status;
}

void ns_bridge_own_forget_currents(ns_own_found *currents) {
    free(currents->of);
    free(currents->start);
    *currents = (ns_own_found){.otherwise = NS_OWN_CURRENT};
}
