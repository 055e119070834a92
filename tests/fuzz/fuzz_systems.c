/* tests/fuzz/fuzz_systems.c - any bytes as a small system or circuit, stepped and marched for a while.
 *
 * Whatever it is may be refused, at any stage; but what is accepted holds finite numbers only, and a failure
 * has its explanation.  Bytes that are missing are 0.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/circuit.h"
#include "nonsmooth/march.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { SIZE_MAX_N = 4, ELEMENTS = 12, NODES = 5, STEPS = 6 };

static void demand(int holds, const char *what, double value) {
    if (!holds) {
        fprintf(stderr, "fuzz_systems: %s (%.17g)\n", what, value);
        abort();
    }
}

static void demand_finite(const char *what, int n, const double *v) {
    for (int i = 0; i < n; i++)
        demand(isfinite(v[i]), what, v[i]);
}

/* --- bytes as numbers --- */

typedef struct bytes {
    const uint8_t *at, *end;
    double h; /* longest step: periods are not much below it, for every corner of an input is stepped on */
} bytes;

static int next(bytes *b) {
    return b->at < b->end ? *b->at++ : 0;
}

static int below(bytes *b, int n) {
    return next(b) % n;
}

/* Half of the bytes: eighths of -8 .. 8; the others: +-10^k or +-2 10^k, k = -15 .. 16. */
static double number(bytes *b) {
    const int c = next(b);
    if (c < 128)
        return (c < 64 ? c : c - 128) / 8.0;
    const int power = (c & 63) / 2 - 15;
    return (c & 64 ? -1 : 1) * (c & 1 ? 2 : 1) * pow(10, power);
}

static double positive(bytes *b) {
    return fabs(number(b));
}

/* NaN and infinities too: what must be refused is met as well. */
static double any_number(bytes *b) {
    const int c = next(b);
    return c == 250 ? NAN : c == 251 ? INFINITY : c == 252 ? -INFINITY : number(b);
}

/* 0 (a jump) or some h. */
static double duration(bytes *b) {
    return b->h * (next(b) & 63) / 8;
}

static double period(bytes *b) {
    return b->h / 8 + duration(b);
}

static void signal_of(bytes *b, ns_signal *s, double *points) {
    memset(s, 0, sizeof *s);
    s->kind = (ns_signal_kind)below(b, NS_PWL + 1);
    switch (s->kind) {
    case NS_DC:
        s->u.dc = number(b);
        break;
    case NS_PULSE:
        s->u.pulse.v1 = number(b);
        s->u.pulse.v2 = number(b);
        s->u.pulse.td = duration(b);
        s->u.pulse.tr = duration(b);
        s->u.pulse.tf = duration(b);
        s->u.pulse.pw = duration(b);
        s->u.pulse.per = below(b, 2) ? INFINITY : period(b);
        s->u.pulse.cycles = below(b, 4);
        break;
    case NS_SIN:
        s->u.sin.vo = number(b);
        s->u.sin.va = number(b);
        s->u.sin.freq = 1 / period(b);
        s->u.sin.td = duration(b);
        s->u.sin.theta = number(b);
        s->u.sin.phase = number(b);
        break;
    case NS_EXP:
        s->u.exp.v1 = number(b);
        s->u.exp.v2 = number(b);
        s->u.exp.td1 = duration(b);
        s->u.exp.tau1 = period(b);
        s->u.exp.td2 = duration(b);
        s->u.exp.tau2 = period(b);
        break;
    case NS_PWL:
        s->u.pwl.n = 1 + below(b, 4);
        for (int k = 0; k < s->u.pwl.n; k++) {
            points[k] = (k ? points[k - 1] : 0) + duration(b);
            points[4 + k] = number(b);
        }
        s->u.pwl.t = points;
        s->u.pwl.v = points + 4;
        s->u.pwl.repeat = below(b, 2) ? points[below(b, s->u.pwl.n)] : (double)NAN;
        s->u.pwl.td = duration(b);
        break;
    }
}

/* --- a system --- */

static void fill(bytes *b, size_t n, double *v) {
    for (size_t i = 0; i < n; i++)
        v[i] = number(b);
}

static void bounds(bytes *b, ns_system *s) {
    for (int i = 0; i < s->m; i++) {
        const int law = below(b, 5);
        s->l[i] = law == 0 || law == 2 ? 0 : law == 1 ? -INFINITY : any_number(b);
        s->u[i] = law <= 1 ? INFINITY : law == 2 ? s->l[i] : law == 3 ? s->l[i] + positive(b) : any_number(b);
    }
}

static void command(bytes *b, const ns_system *s, ns_command *c) {
    c->pair = below(b, s->m);
    c->off = number(b);
    c->on = c->off + (below(b, 2) ? positive(b) : 0);
    c->g0 = number(b);
    const int of = below(b, 4);
    if (s->n > 0 && (of & 1) && (c->gx = calloc((size_t)s->n, sizeof *c->gx)) != NULL)
        fill(b, (size_t)s->n, c->gx);
    if (s->nz > 0 && (of & 2) && (c->gz = calloc((size_t)s->nz, sizeof *c->gz)) != NULL)
        fill(b, (size_t)s->nz, c->gz);
}

static ns_system *system_of(bytes *b) {
    const int n = below(b, SIZE_MAX_N + 1), m = below(b, SIZE_MAX_N + 1), nz = below(b, 3);
    const int nc = m > 0 ? below(b, 3) : 0;
    const size_t N = (size_t)n, P = (size_t)m, Z = (size_t)nz;
    ns_system *s = NULL;
    ns_signal signal;
    double points[8];
    demand(ns_system_create(n, m, nz, nc, &s) == NS_OK, "no system", n);
    fill(b, N * N, s->M);
    fill(b, N * N, s->A);
    fill(b, N * P, s->B);
    fill(b, P * N, s->C);
    fill(b, P * P, s->D);
    bounds(b, s);
    for (int i = 0; i < nz; i++) {
        signal_of(b, &signal, points);
        ns_system_set_input(s, i, &signal);
    }
    for (int k = 0; k < nc; k++)
        command(b, s, &s->command[k]);
    fill(b, N, s->b);
    fill(b, P, s->e);
    fill(b, N * Z, s->E);
    fill(b, P * Z, s->F);
    return s;
}

/* --- what is done with it --- */

/* The larger systems that circuits make have the same bound. */
enum { X_MAX = 64 };

static void check_theta(ns_theta *t, const ns_system *s) {
    double x[X_MAX], lambda[X_MAX], y[X_MAX];
    const int status = ns_theta_read(t, x, lambda, y);
    if (status == NS_E_OVERFLOW)
        return;
    demand(status == NS_OK, "an accepted step is not read", status);
    demand_finite("x of a step", s->n, x);
    demand_finite("lambda of a step", s->m, lambda);
    demand_finite("y of a step", s->m, y);
}

static double weight(bytes *b) {
    static const double some[] = {1, 0.5, 0.75, 0.001};
    return some[below(b, 4)];
}

static void step(bytes *b, const ns_system *s) {
    const ns_theta_options o = {weight(b), weight(b), (size_t)1 << 16};
    double w0[X_MAX] = {0}, z[X_MAX];
    unsigned char closed[X_MAX] = {0};
    ns_theta *t = NULL;
    ns_fault fault;
    double time = 0;
    if (ns_theta_create(s, &o, &t, &fault) != NS_OK)
        return;
    fill(b, (size_t)s->n, w0);
    int status = ns_theta_start(t, w0, closed);
    for (int k = 0; k < STEPS && status >= 0; k++) {
        const double h = b->h * pow(2, -below(b, 12));
        const int how = next(b);
        ns_system_inputs(s, time + h, NS_LEFT, z);
        for (int c = 0; c < s->nc; c++)
            closed[c] = (unsigned char)(how >> (4 + c % 4) & 1);
        status = ns_theta_command(t, closed);
        status = status ? status : ns_theta_try(t, h, z, how & 1, how & 2 ? NS_HOLD : NS_RESOLVE);
        if (status == NS_OK && ns_theta_accept(t) == NS_OK) {
            check_theta(t, s);
            time += h;
        }
    }
    ns_theta_free(t);
}

static void check_march(ns_march *m, const ns_system *s, double after) {
    double t = NAN, x[X_MAX], lambda[X_MAX], y[X_MAX];
    const int status = ns_march_read(m, &t, x, lambda, y);
    demand(isfinite(t) && t >= after, "the time of a trial", t);
    if (status == NS_E_OVERFLOW)
        return;
    demand(status == NS_OK, "a trial is not read", status);
    demand_finite("x of a march", s->n, x);
    demand_finite("lambda of a march", s->m, lambda);
    demand_finite("y of a march", s->m, y);
}

/* Whether m stands at a point that was checked. */
static int start(bytes *b, ns_march *m, const ns_system *s) {
    double w0[X_MAX] = {0};
    fill(b, (size_t)s->n, w0);
    int status = below(b, 2) ? ns_march_start(m, 0, w0) : ns_march_start_dc(m, 0, 0, NULL, NULL, NULL);
    if (status == NS_OK)
        check_march(m, s, 0);
    return status == NS_OK;
}

/* The fault of a march that failed is in *fault. */
static int march(bytes *b, const ns_system *s, ns_fault *fault) {
    const double h = b->h;
    const ns_march_options o = {.theta = weight(b), .gamma = weight(b), .h = h, .map_bytes = (size_t)1 << 16};
    ns_march *m = NULL;
    double t = 0;
    int status = ns_march_create(s, &o, &m, fault);
    if (status != NS_OK)
        return status;
    if (!start(b, m, s))
        status = NS_E_STATE;
    for (int k = 0; k < STEPS && status == NS_OK; k++) {
        const int how = next(b);
        double reached = NAN;
        status = ns_march_try(m, t + h * (1 + (how & 3)), how & 4 ? NS_TO_EVENT : NS_TO_TIME, &reached);
        if (status == NS_OK) {
            /* the right side of a jump has the time of its left side */
            demand(reached > t || (reached == t && !ns_march_at_event(m)), "a trial that did not advance",
                   reached);
            check_march(m, s, t);
            if (how & 8) /* else tried again, with other times */
                demand(ns_march_accept(m) == NS_OK, "a trial is not accepted", t);
            t = how & 8 ? reached : t;
        }
    }
    *fault = *ns_march_fault(m);
    ns_march_free(m);
    return status;
}

/* --- a circuit --- */

static void diode_of(bytes *b, ns_diode *d) {
    d->vf = positive(b);
    d->ron = below(b, 2) ? positive(b) : 0;
    d->roff = below(b, 2) ? INFINITY : d->ron + positive(b);
    d->vz = below(b, 2) ? INFINITY : positive(b);
    d->rz = below(b, 2) ? positive(b) : 0;
}

static void switch_of(bytes *b, ns_switch *s) {
    s->vt = number(b);
    s->vh = below(b, 2) ? positive(b) : 0;
    s->ron = below(b, 2) ? positive(b) : 0;
    s->roff = below(b, 2) ? INFINITY : s->ron + positive(b);
}

static int element_of(bytes *b, ns_circuit *c, const char *name, int id) {
    const int kind = below(b, 14), p = below(b, NODES), n = below(b, NODES);
    const ns_output out = kind & 1 ? NS_VOLTAGE : NS_CURRENT;
    double points[8];
    ns_signal signal;
    ns_diode diode;
    ns_switch sw;
    switch (kind) {
    case 0:
        return ns_circuit_resistor(c, name, p, n, number(b), NULL);
    case 1:
        return ns_circuit_capacitor(c, name, p, n, number(b), below(b, 2) ? number(b) : (double)NAN, NULL);
    case 2:
        return ns_circuit_inductor(c, name, p, n, number(b), below(b, 2) ? number(b) : (double)NAN, NULL);
    case 3:
        return ns_circuit_coupling(c, name, below(b, id + 1), below(b, id + 1), number(b), NULL);
    case 4:
    case 5:
        signal_of(b, &signal, points);
        return ns_circuit_source(c, name, out, p, n, &signal, NULL);
    case 6:
    case 7: {
        const int cp = below(b, NODES), cn = below(b, NODES);
        return ns_circuit_vcontrolled(c, name, out, p, n, cp, cn, number(b), NULL);
    }
    case 8:
        return ns_circuit_icontrolled(c, name, NS_CURRENT, p, n, below(b, id + 1), number(b), NULL);
    case 9: {
        const ns_term term[2] = {{0, below(b, NODES), number(b)}, {1, below(b, id + 1), number(b)}};
        return ns_circuit_linear(c, name, out, p, n, number(b), below(b, 3), term, NULL);
    }
    case 10:
    case 11:
        diode_of(b, &diode);
        return ns_circuit_diode(c, name, p, n, &diode, NULL);
    case 12: {
        const int cp = below(b, NODES), cn = below(b, NODES);
        switch_of(b, &sw);
        return ns_circuit_switch(c, name, p, n, cp, cn, &sw, NULL);
    }
    default:
        return ns_circuit_node_ic(c, p, number(b));
    }
}

static void march_circuit(bytes *b) {
    char name[8], line[256];
    ns_circuit *c = NULL;
    ns_system *s = NULL;
    ns_fault fault = {.status = NS_OK};
    demand(ns_circuit_create(&c) == NS_OK, "no circuit", 0);
    for (int id = 0, count = below(b, ELEMENTS) + 1; id < count; id++) {
        snprintf(name, sizeof name, "e%d", id);
        if (element_of(b, c, name, id) != NS_OK)
            demand(ns_circuit_message(c)[0] != '\0', "a refusal without a message", id);
    }
    if (ns_circuit_system(c, &s) == NS_OK) {
        demand(s->n <= X_MAX && s->m <= X_MAX && s->nz <= X_MAX && s->nc <= X_MAX, "room", s->n);
        if (march(b, s, &fault) != NS_OK)
            demand(ns_circuit_explain(c, &fault, line, sizeof line) >= 0, "no explanation", fault.status);
    }
    ns_system_free(s);
    ns_circuit_free(c);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    bytes b = {data, data + size, 1};
    ns_fault fault;
    b.h = pow(2, below(&b, 24) - 20);
    if (next(&b) & 1) {
        march_circuit(&b);
        return 0;
    }
    ns_system *s = system_of(&b);
    if (ns_system_check(s, &fault) == NS_OK) {
        step(&b, s);
        march(&b, s, &fault);
    }
    ns_system_free(s);
    return 0;
}
