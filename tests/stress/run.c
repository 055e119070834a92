/* tests/stress/run.c - a run in a child process; values at instants that no source has a corner at. */
#define _DEFAULT_SOURCE
#include "run.h"

#include "effort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const rlim_t MEMORY = (rlim_t)3 << 30;
static const int TRIALS = 20000000;
static const double LEAK = 1e-7;  /* V, A, and A for each V: below it all is rounding */
static const double BRIEF = 1e-4; /* of a step of .tran */

double run_time(const plan *p, int k) {
    const double golden = 0.6180339887498949 * (k + 1);
    return p->stop * (k + 0.2 + 0.6 * (golden - floor(golden))) / RUN_TIMES;
}

double run_band_time(const plan *p, int at) {
    return run_time(p, at / RUN_BAND) + (at % RUN_BAND - 1) * RUN_ASIDE * fmin(p->step, p->stop / RUN_TIMES);
}

run_result *run_room(void) {
    void *r = mmap(NULL, sizeof(run_result), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (r == MAP_FAILED)
        abort();
    return r;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* One run. */
typedef struct way {
    const plan *p;
    plan_built built;
    ns_system *system;
    ns_march *march;
    double *x, *lambda;
    double largest_v, largest_i, wrong_v, wrong_i, wrong_vt, wrong_it; /* of the circuit; (S4) */
    int part_v, part_i;
    int voltages; /* of the unknowns the first ones */
    run_result *r;
} way;

/* --- (S4) at a point --- */

static void keep_larger(double *most, double v, double *at, double t, int *whose, int part) {
    if (v > *most) {
        *most = v;
        *at = t;
        *whose = part;
    }
}

/* How far a device is from the branch of its law that it says to be on, and past that branch's end. */
static void note_device(way *w, int at, double t, double i, double v, int on) {
    const plan_part *e = &w->p->part[at];
    const int diode = e->kind == 'd';
    const double roff = diode ? e->diode.roff : e->contact.roff, ron = diode ? e->diode.ron : e->contact.ron;
    const double vf = diode ? e->diode.vf : 0, end_i = isinf(roff) ? 0 : vf / (roff - ron);
    double bad_v = 0, bad_i = 0;
    if (on == 0) {
        bad_i = fabs(i - (isinf(roff) ? 0 : v / roff));
        bad_v = diode ? fmax(0, v - vf - ron * end_i) : 0;
    } else if (on == 1 && diode) { /* a switch that slides has any voltage */
        bad_v = fabs(v - vf - ron * i);
        bad_i = fmax(0, end_i - i);
    }
    w->largest_i = fmax(w->largest_i, fabs(i));
    keep_larger(&w->wrong_v, bad_v, &w->wrong_vt, t, &w->part_v, at);
    keep_larger(&w->wrong_i, bad_i, &w->wrong_it, t, &w->part_i, at);
}

/* At the point in x, lambda. */
static void note_devices(way *w, double t) {
    double i, v;
    int on;
    const ns_mode *mode = ns_march_mode(w->march);
    for (int k = 0; k < w->system->n; k++) {
        double *most = k < w->voltages ? &w->largest_v : &w->largest_i;
        *most = fmax(*most, fabs(w->x[k]));
    }
    for (int at = 0; at < w->p->parts; at++)
        if (strchr("ds", w->p->part[at].kind) &&
            ns_circuit_device(w->built.circuit, w->built.id[at], w->x, w->lambda, mode, &i, &v, &on) == NS_OK)
            note_device(w, at, t, i, v, on);
}

/* Currents of inductors and voltages of capacitors count however short they last: they cannot jump. */
static void sum_up_signs(way *w) {
    for (int i = 0; i < w->p->probes; i++) {
        double *most = w->p->probe[i].part >= 0 ? &w->largest_i : &w->largest_v;
        *most = fmax(*most, w->r->most[i]);
    }
    const double largest_v = fmax(w->largest_v, LEAK * w->largest_i),
                 largest_i = fmax(w->largest_i, LEAK * w->largest_v);
    const double v = w->wrong_v / fmax(largest_v, LEAK), i = w->wrong_i / fmax(largest_i, LEAK);
    w->r->wrong_sign = fmax(v, i);
    w->r->wrong_t = v > i ? w->wrong_vt : w->wrong_it;
    w->r->wrong_part = v > i ? w->part_v : w->part_i;
}

/* --- values --- */

static double voltage(const way *w, int node) {
    return node == 0 ? 0 : w->x[ns_circuit_node_unknown(w->built.circuit, w->built.node[node])];
}

static double value_of(const way *w, const plan_probe *q) {
    return q->part >= 0 ? w->x[ns_circuit_current_unknown(w->built.circuit, w->built.id[q->part])]
                        : voltage(w, q->node[0]) - voltage(w, q->node[1]);
}

static void note_largest(way *w) {
    for (int i = 0; i < w->p->probes; i++)
        w->r->most[i] = fmax(w->r->most[i], fabs(value_of(w, &w->p->probe[i])));
}

static void note_values(way *w, int at) {
    double *value = w->r->value + at * w->p->probes;
    for (int i = 0; i < w->p->probes; i++)
        value[i] = value_of(w, &w->p->probe[i]);
    note_largest(w);
}

/* From trial to trial as a waveform does, values on the way. */
static int go_by_steps(way *w) {
    double t = 0, reached;
    int at = 0, status = NS_OK;
    for (int k = 0; k < TRIALS && at < RUN_TIMES * RUN_BAND; k++) {
        status = ns_march_try(w->march, w->p->stop + w->p->step, NS_TO_STEP, &reached);
        if (status != NS_OK)
            return status;
        for (; at < RUN_TIMES * RUN_BAND && run_band_time(w->p, at) <= reached && reached > t; at++) {
            status = ns_march_sample(w->march, fmax(t, run_band_time(w->p, at)), w->x, w->lambda);
            if (status != NS_OK)
                return status;
            note_values(w, at);
            note_devices(w, run_band_time(w->p, at));
        }
        /* points that last for no time, as the right side of an event, are passed over */
        if (ns_march_read(w->march, NULL, w->x, w->lambda, NULL) == NS_OK) {
            note_largest(w);
            if (reached - t > BRIEF * w->p->step)
                note_devices(w, reached);
        }
        ns_march_accept(w->march);
        w->r->t = t = reached;
    }
    return at < RUN_TIMES * RUN_BAND ? NS_E_LIMIT : NS_OK;
}

static int go_on_grid(way *w) {
    for (int at = 0; at < RUN_TIMES * RUN_BAND; at++) {
        while (w->r->t < run_band_time(w->p, at)) {
            int status = ns_march_try(w->march, run_band_time(w->p, at), NS_TO_TIME, &w->r->t);
            if (status == NS_OK)
                status = ns_march_accept(w->march);
            if (status != NS_OK)
                return status;
        }
        const int status = ns_march_read(w->march, NULL, w->x, w->lambda, NULL);
        if (status != NS_OK)
            return status;
        note_values(w, at);
    }
    return NS_OK;
}

/* As ngspice's code models choose it. */
static double default_h(const plan *p) {
    double shortest = INFINITY;
    for (int i = 0; i < p->parts; i++) {
        const ns_signal *s = &p->part[i].signal;
        if (strchr("vi", p->part[i].kind) && s->kind == NS_PULSE)
            shortest = fmin(shortest, s->u.pulse.per);
        else if (strchr("vi", p->part[i].kind) && s->kind == NS_SIN && s->u.sin.freq > 0)
            shortest = fmin(shortest, 1 / s->u.sin.freq);
    }
    return fmin(shortest / 1024, p->stop / 65536);
}

static int start(way *w) {
    const ns_circuit *c = w->built.circuit;
    if (w->p->uic) {
        const int status = ns_circuit_rest(c, w->x);
        return status != NS_OK ? status : ns_march_start(w->march, 0, w->x);
    }
    return ns_march_start_dc(w->march, 0, 0, NULL, NULL, NULL);
}

static int go(way *w, const run_setting *s, ns_fault *fault) {
    const ns_march_options o = {.theta = s->theta > 0 ? s->theta : 1,
                                .gamma = s->gamma > 0 ? s->gamma : 1,
                                .h = (s->h > 0 ? s->h * w->p->step : default_h(w->p)) *
                                     (s->longer > 0 ? s->longer : 1),
                                .method = s->method,
                                .reltol = s->reltol};
    int status = plan_build(w->p, s->shuffle, s->vary, &w->built);
    if (status == NS_OK)
        status = ns_circuit_system(w->built.circuit, &w->system);
    if (status != NS_OK)
        return status;
    w->x = calloc((size_t)w->system->n + (size_t)w->system->m + 2, sizeof(double));
    if (!w->x)
        return NS_E_MEMORY;
    w->lambda = w->x + w->system->n + 1;
    for (int i = 1; i < w->p->nodes; i++)
        w->voltages += ns_circuit_node_unknown(w->built.circuit, i) >= 0;
    status = ns_march_create(w->system, &o, &w->march, fault);
    if (status == NS_OK)
        status = start(w);
    if (status == NS_OK)
        status = s->on_grid ? go_on_grid(w) : go_by_steps(w);
    return status;
}

static void explain(way *w, const ns_fault *fault, int status) {
    run_result *r = w->r;
    if (!w->system)
        snprintf(r->line, RUN_LINE, "circuit: %s", ns_circuit_message(w->built.circuit));
    else
        ns_circuit_explain(w->built.circuit, fault, r->line, RUN_LINE);
    if (r->line[0] == 0)
        snprintf(r->line, RUN_LINE, "%s", ns_status_text(status));
}

void run_here(const plan *p, const run_setting *s, run_result *r) {
    way w = {.p = p, .r = r};
    ns_fault fault = {0};
    memset(r, 0, sizeof *r);
    const double began = now(), effort = effort_so_far();
    r->status = go(&w, s, &fault);
    r->seconds = now() - began;
    r->effort = effort_so_far() - effort;
    if (w.march) {
        r->counts = *ns_march_counts(w.march);
        r->engine = (int)ns_march_engine(w.march);
    }
    if (r->status != NS_OK)
        explain(&w, w.march ? ns_march_fault(w.march) : &fault, r->status);
    sum_up_signs(&w);
    ns_march_free(w.march);
    ns_system_free(w.system);
    ns_circuit_free(w.built.circuit);
    free(w.x);
    r->end = r->status == NS_OK ? RUN_DONE : RUN_REFUSED;
}

static void be_child(const plan *p, const run_setting *s, run_result *r) {
    const struct rlimit memory = {MEMORY, MEMORY}, core = {0, 0};
    const struct itimerval limit = {{0, 0}, {(time_t)s->limit, (suseconds_t)(1e6 * fmod(s->limit, 1))}};
    setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CORE, &core);
    setitimer(ITIMER_PROF, &limit, NULL);
    const double began = now();
    int runs = 0;
    do {
        run_here(p, s, r);
        runs++;
    } while (r->end == RUN_DONE && now() - began < s->at_least);
    if (runs > 1)
        r->seconds = (now() - began) / runs;
    _exit(0);
}

void run(const plan *p, const run_setting *s, run_result *r) {
    int status = 0;
    memset(r, 0, sizeof *r);
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0)
        be_child(p, s, r);
    if (child < 0 || waitpid(child, &status, 0) < 0)
        abort();
    if (WIFEXITED(status) && r->end != RUN_NOT)
        return;
    r->end = WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF ? RUN_SLOW : RUN_CRASHED;
    if (r->end == RUN_SLOW)
        snprintf(r->line, RUN_LINE, "still running after %g s", s->limit);
    else
        snprintf(r->line, RUN_LINE, "ended by signal %d, exit status %d",
                 WIFSIGNALED(status) ? WTERMSIG(status) : 0, WEXITSTATUS(status));
    if (r->end == RUN_SLOW)
        r->seconds = s->limit;
}
