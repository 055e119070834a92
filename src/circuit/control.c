/* src/circuit/control.c - the commands of switches, and which controls are functions of time alone.
 *
 * Nodes joined by voltage sources whose value is known at any time (independent ones, R = 0, and controlled
 * ones whose control is itself known) form groups; inside a group every difference of potentials is
 *     sum over inputs of volts[k] z_k + volts[nz].
 */
#include <stdlib.h>

#include "circuit/circuit_internal.h"

typedef struct potentials {
    const ns_circuit *c;
    int count;     /* used nodes, then ground */
    int nz;        /* inputs; volts has nz+1 entries a node */
    int *group;    /* count */
    double *volts; /* count*(nz+1), against the group's own zero */
    double *gap;   /* nz+1, workspace: v_p - v_n of a source */
} potentials;

static int place(const potentials *p, int number) {
    return number == 0 ? p->count - 1 : ns_circuit_node_unknown(p->c, number);
}

static double *volts_of(const potentials *p, int at) {
    return p->volts + (size_t)at * ((size_t)p->nz + 1);
}

/* gap += gain (v_p - v_n); 0 if they are of different groups. */
static int add_difference(const potentials *p, double gain, int at_p, int at_n) {
    for (int k = 0; k <= p->nz; k++) {
        p->gap[k] += gain * (volts_of(p, at_p)[k] - volts_of(p, at_n)[k]);
    }
    return p->group[at_p] == p->group[at_n];
}

/* The terms of a behavioural source: each node must be known against ground. */
static int add_terms(const potentials *p, const element *e) {
    int known = 1;
    for (int i = 0; i < e->nterms && known; i++) {
        known = !e->terms[i].is_current &&
                add_difference(p, e->terms[i].gain, place(p, e->terms[i].of), place(p, 0));
    }
    return known;
}

/* gap = v_p - v_n of an element; 0 if it does not fix that as a function of time. */
static int known_gap(const potentials *p, const element *e) {
    for (int k = 0; k <= p->nz; k++) {
        p->gap[k] = 0;
    }
    if (e->current < 0) {
        return 0;
    }
    switch (e->kind) {
    case RESISTOR:
        return 1;
    case SOURCE:
        p->gap[e->input >= 0 ? e->input : p->nz] = e->input >= 0 ? 1 : e->signal.u.dc;
        return 1;
    case VCONTROLLED:
        return add_difference(p, e->value, place(p, e->node[2]), place(p, e->node[3]));
    case LINEAR:
        p->gap[p->nz] = e->value;
        return add_terms(p, e);
    default:
        return 0;
    }
}

/* Shifts the group of node b so that v_a - v_b = gap, and makes it a's. */
static void join(potentials *p, int a, int b) {
    int from = p->group[b], to = p->group[a];
    for (int k = 0; k <= p->nz; k++) {
        double shift = volts_of(p, a)[k] - p->gap[k] - volts_of(p, b)[k];
        for (int i = 0; i < p->count; i++) {
            if (p->group[i] == from) {
                volts_of(p, i)[k] += shift;
            }
        }
    }
    for (int i = 0; i < p->count; i++) {
        if (p->group[i] == from) {
            p->group[i] = to;
        }
    }
}

/* One pass over the elements; returns how many groups it joined. */
static int join_known(potentials *p) {
    int joined = 0;
    for (int i = 0; i < p->c->nelements; i++) {
        const element *e = &p->c->element[i];
        if (known_gap(p, e)) {
            int a = place(p, e->node[0]), b = place(p, e->node[1]);
            if (p->group[a] != p->group[b]) {
                join(p, a, b);
                joined++;
            }
        }
    }
    return joined;
}

static int begin(potentials *p, const ns_circuit *c) {
    size_t count = (size_t)c->nused + 1, width = (size_t)c->ninputs + 1;
    *p = (potentials){c, c->nused + 1, c->ninputs, NULL, NULL, NULL};
    p->group = calloc(count, sizeof *p->group);
    p->volts = calloc(count * width, sizeof *p->volts);
    p->gap = calloc(width, sizeof *p->gap);
    if (!p->group || !p->volts || !p->gap) {
        return 0;
    }
    for (int i = 0; i < p->count; i++) {
        p->group[i] = i;
    }
    while (join_known(p) > 0) { /* at most count passes: each joins groups */
    }
    return 1;
}

static void end(potentials *p) {
    free(p->group);
    free(p->volts);
    free(p->gap);
}

/* g = the known difference. */
static int time_control(const potentials *p, ns_command *to) {
    int any = 0;
    for (int k = 0; k < p->nz; k++) {
        any |= p->gap[k] != 0;
    }
    to->g0 = p->gap[p->nz];
    if (!any) {
        return NS_OK;
    }
    to->gz = calloc((size_t)p->nz, sizeof(double));
    if (!to->gz) {
        return NS_E_MEMORY;
    }
    for (int k = 0; k < p->nz; k++) {
        to->gz[k] = p->gap[k];
    }
    return NS_OK;
}

/* g = v_cp - v_cn. */
static int node_control(const potentials *p, const element *e, int n, ns_command *to) {
    to->gx = calloc((size_t)n, sizeof(double));
    if (!to->gx) {
        return NS_E_MEMORY;
    }
    if (e->node[2] > 0) {
        to->gx[place(p, e->node[2])] += 1;
    }
    if (e->node[3] > 0) {
        to->gx[place(p, e->node[3])] -= 1;
    }
    return NS_OK;
}

static int stamp_command(const potentials *p, const element *e, ns_system *s) {
    ns_command *to = &s->command[e->command];
    to->pair = e->pair;
    to->on = e->sw.vt + e->sw.vh;
    to->off = e->sw.vt - e->sw.vh;
    for (int k = 0; k <= p->nz; k++) {
        p->gap[k] = 0;
    }
    if (add_difference(p, 1, place(p, e->node[2]), place(p, e->node[3]))) {
        return time_control(p, to);
    }
    return node_control(p, e, s->n, to);
}

int ns_stamp_commands(const ns_circuit *c, ns_system *s) {
    potentials p;
    int status = NS_OK;
    if (c->ncommands == 0) {
        return NS_OK;
    }
    if (!begin(&p, c)) {
        status = NS_E_MEMORY;
    }
    for (int i = 0; i < c->nelements && !status; i++) {
        if (c->element[i].kind == SWITCH) {
            status = stamp_command(&p, &c->element[i], s);
        }
    }
    end(&p);
    return status;
}
