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
 * pass came to, at least.  A pulse that began earlier counts with all its charge: it may be the only one. */
typedef struct own_mean {
    ns_pulse_mean all, late; /* since the start or tstart; since the last mark */
    ns_pulse_mean before;    /* between that and the mark before it */
    ns_pulse_mean hidden;    /* before tstart */
    double blocks;           /* V: the largest across it while it is off */
} own_mean;

typedef struct own_pass {
    ns_analysis *a; /* its point is that of the pass */
    ns_march *march;
    own_mean *mean; /* of the taken, in their order: OWN_PATHS each */
    double start;   /* s: tstart, until it was passed */
    double mark;    /* s: the next one */
    int brief;
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
    return ns_bridge_own_is_follower(o) &&
           m->sign * (voltage_at(a, m->drain) - voltage_at(a, m->gate)) > -m->vth;
}

static void add_current(own_mean *mean, int is_on, double i, double from, double to) {
    ns_bridge_pulse_mean_add(&mean->all, is_on, i, from, to);
    ns_bridge_pulse_mean_add(&mean->late, is_on, i, from, to);
}

/* Of one that closes, what it carries then counts too. */
static void add_channel(const own_pass *p, const ns_own_taken *o, const ns_mode *mode, own_mean *mean,
                        double from, double to) {
    const ns_analysis *a = p->a;
    double i;
    if (ns_bridge_own_is_follower(o) &&
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

/* Pulses that end from now on count; at tstart also of the present one only what follows. */
static void begin_anew(ns_pulse_mean *mean, double t, int at_start) {
    if (at_start)
        ns_bridge_pulse_mean_end(mean, t);
    mean->weight = mean->sum = 0.0;
    mean->most = mean->pulse.most;
}

/* It has come to the time t. */
static void pass_marks(own_pass *p, double t) {
    const int at_start = p->start > 0.0 && t >= p->start;
    const ns_pulse_mean none = {0};
    if (t < p->mark && !at_start)
        return;
    for (int k = 0; k < OWN_PATHS * p->a->ex.nowns; k++) {
        own_mean *m = &p->mean[k];
        m->before = at_start ? none : m->late;
        begin_anew(&m->late, t, at_start);
        if (!at_start)
            continue;
        ns_bridge_pulse_mean_end(&m->all, t);
        m->hidden = m->all;
        begin_anew(&m->all, t, 1);
    }
    p->start = at_start ? 0.0 : p->start;
    while (p->mark <= t)
        p->mark *= 2.0;
}

/* The last trial, from one time to another, s. */
static int add_between(own_pass *p, double from, double end) {
    const int status = ns_march_sample(p->march, 0.5 * (from + end), p->a->x, p->a->lambda);
    if (status != NS_OK)
        return status;
    add_part(p, from, end);
    pass_marks(p, end);
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

/* How far it goes is the same for every run of this circuit. */
static int is_long_enough(const own_pass *p, int steps, double t, double stop) {
    const double factors = (double)ns_march_counts(p->march)->factors;
    const double share = p->brief ? BRIEF_SHARE : 1.0;
    const double work = ((double)steps + STEPS_OF_FACTORS * factors) * (double)(p->a->count + 1);
    const double least = ns_bridge_timepoints_slowest(p->a->system, stop);
    return t >= stop || (steps >= LEAST_STEPS && work >= share * (t < least ? MOST_WORK : CHEAP_WORK));
}

/* *t: how far it came, s. */
static void pass(own_pass *p, double stop, double *t) {
    double end;
    int status = ns_march_read(p->march, t, NULL, NULL, NULL);
    for (int k = 0; status == NS_OK && !is_long_enough(p, k, *t, stop) && !ns_bridge_interrupt_came(); k++) {
        status = ns_march_try(p->march, stop, NS_TO_STEP, &end);
        if (status == NS_OK && end > *t)
            status = add_step(p, *t, end);
        if (status == NS_OK)
            status = ns_march_accept(p->march);
        if (status == NS_OK)
            *t = end;
    }
}

/* 1, 1.5, 2, 3, 5 or 7 times a power of ten. */
static double round_current(double amperes) {
    static const double digit[] = {1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0};
    const double power = pow(10.0, floor(log10(amperes)));
    double best = power;
    for (size_t k = 0; k < sizeof digit / sizeof digit[0]; k++)
        if (fabs(log(digit[k] * power / amperes)) < fabs(log(best / amperes)))
            best = digit[k] * power;
    return best;
}

/* What counts of the k-th; where it carried no more than a leak since then, all, and before tstart. */
static ns_pulse_mean mean_of(const own_pass *p, int k, double t) {
    own_mean *m = &p->mean[k];
    ns_bridge_pulse_mean_end(&m->all, t);
    ns_bridge_pulse_mean_end(&m->late, t);
    const ns_pulse_mean late = {.weight = m->late.weight + m->before.weight,
                                .sum = m->late.sum + m->before.sum,
                                .most = fmax(m->late.most, m->before.most)};
    if (!(ns_bridge_pulse_mean_read(&late) < NS_LEAK))
        return late;
    return ns_bridge_pulse_mean_read(&m->all) > 0.0 ? m->all : m->hidden;
}

/* One that carried no more than a leak may do so because it did not begin yet, or because another one leaks;
 * in breakdown that says nothing. */
static void note_current(const own_pass *p, int k, ns_own_found *currents) {
    const ns_own_path path = (ns_own_path)(k % OWN_PATHS);
    const ns_pulse_mean mean = mean_of(p, k, currents->seconds);
    const double amperes = ns_bridge_pulse_mean_read(&mean);
    const int faint = path == OWN_FORWARDS && amperes < (1.0 - 1e-6) * NS_LEAK;
    if (amperes > 0.0 && !(path != OWN_FORWARDS && amperes < NS_LEAK) && !(p->brief && faint))
        currents->of[currents->count++] = (ns_own_current){.inst = p->a->ex.own[k / OWN_PATHS].inst,
                                                           .id = faint ? NS_OWN_CURRENT : amperes,
                                                           .most = mean.most,
                                                           .rush = p->mean[k].all.most,
                                                           .blocks = p->mean[k].blocks,
                                                           .faint = faint,
                                                           .path = path};
}

/* The smallest current of those that are in no group; NULL: there is none. */
static const ns_own_current *find_smallest(const ns_own_found *currents, const unsigned char *grouped) {
    const ns_own_current *smallest = NULL;
    for (int k = 0; k < currents->count; k++)
        if (!grouped[k] && (!smallest || currents->of[k].id < smallest->id))
            smallest = &currents->of[k];
    return smallest;
}

/* D of one model that carry nearly the same are taken alike, on whichever sides of a rounding their currents
 * are: phases of one converter share its current equally.  grouped: zeros. */
static void round_in_groups(ns_own_found *currents, unsigned char *grouped) {
    static const double nearly = 1.25;
    for (const ns_own_current *of; (of = find_smallest(currents, grouped)) != NULL;) {
        const ns_own_current first = *of;
        ns_log_mean mean = {0};
        double rush = 0.0, blocks = 0.0;
        for (int k = 0; k < currents->count; k++) {
            const ns_own_current *c = &currents->of[k];
            if (grouped[k] || c->inst->GENmodPtr != first.inst->GENmodPtr || c->faint != first.faint ||
                c->path != first.path || c->id > nearly * first.id)
                continue;
            grouped[k] = 2;
            mean.coulombs += 1.0;
            mean.sum += log(c->id);
            mean.most = fmax(mean.most, c->most);
            rush = fmax(rush, c->rush);
            blocks = fmax(blocks, c->blocks);
        }
        for (int k = 0; k < currents->count; k++) {
            ns_own_current *c = &currents->of[k];
            if (grouped[k] != 2)
                continue;
            grouped[k] = 1;
            c->id = c->faint ? c->id : round_current(ns_bridge_log_mean_read(&mean));
            c->most = round_current(mean.most);
            c->rush = round_current(rush);
            c->blocks = blocks;
        }
    }
}

int ns_bridge_own_find_currents(ns_analysis *a, ns_march *march, double start, double stop, int brief,
                                ns_own_found *currents) {
    const size_t count = OWN_PATHS * (size_t)a->ex.nowns + 1;
    own_pass p = {a, march, calloc(count, sizeof *p.mean), start, ldexp(stop, -FIRST_MARK), brief};
    unsigned char *grouped = calloc(count, 1);
    free(currents->of);
    currents->count = 0;
    currents->of = calloc(count, sizeof *currents->of);
    const int status = p.mean && grouped && currents->of ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        pass(&p, stop, &currents->seconds);
        currents->whole = currents->seconds >= stop;
        for (int k = 0; k < OWN_PATHS * a->ex.nowns; k++)
            note_current(&p, k, currents);
        round_in_groups(currents, grouped);
    }
    free(p.mean);
    free(grouped);
    return status;
}

enum { JUNCTIONS = 2 };

/* The nodes between which an instance has junctions; how many. */
static int find_junctions(const GENinstance *inst, int anode[JUNCTIONS], int cathode[JUNCTIONS]) {
    if (ns_bridge_own_kind(inst) != OWN_MOSFET) {
        ns_own_diode d;
        ns_bridge_own_read_diode(inst, &d);
        anode[0] = d.anode;
        cathode[0] = d.cathode;
        return 1;
    }
    ns_own_mosfet m;
    ns_bridge_own_read_mosfet(inst, &m);
    anode[0] = m.body.anode;
    cathode[0] = m.body.cathode;
    anode[1] = m.at_source.anode;
    cathode[1] = m.at_source.cathode;
    return anode[1] != cathode[1] ? JUNCTIONS : 1;
}

static int are_parallel(const GENinstance *inst, const GENinstance *other) {
    int anode[2][JUNCTIONS], cathode[2][JUNCTIONS], parallel = 0;
    const int count = find_junctions(inst, anode[0], cathode[0]),
              others = find_junctions(other, anode[1], cathode[1]);
    for (int i = 0; i < count; i++)
        for (int k = 0; k < others; k++)
            parallel |= anode[0][i] == anode[1][k] && cathode[0][i] == cathode[1][k];
    return parallel;
}

double ns_bridge_own_parallel_current(const ns_own_found *currents, const GENinstance *inst) {
    double most = 0.0;
    for (int k = 0; currents && k < currents->count; k++) {
        const ns_own_current *c = &currents->of[k];
        if (c->inst != inst && c->path == OWN_FORWARDS && !c->faint && c->id > most &&
            are_parallel(inst, c->inst))
            most = c->id;
    }
    return most;
}

void ns_bridge_own_forget_currents(ns_own_found *currents) {
    free(currents->of);
    free(currents->start);
    *currents = (ns_own_found){.otherwise = NS_OWN_CURRENT};
}
