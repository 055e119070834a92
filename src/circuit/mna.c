/* src/circuit/mna.c - modified nodal analysis: elements -> (S1)-(S4).
 *
 * Rows of the nodes say that the currents leaving sum to zero: capacitors in M, the others with minus sign in
 * A, b, E, B.  Rows of the currents are the laws of their elements: L di/dt = v_p - v_n, or for sources
 * 0 = value - (v_p - v_n).  A diode is its leak 1/roff beside a pair:
 *     i = lambda + v/roff,    y = (vf + ron lambda)/(1 - ron/roff) - v >= 0,
 * so v = vf + ron i where it conducts, and the line has a kink and no jump; breakdown is a second pair.
 */
#include <math.h>
#include <stdlib.h>

#include "circuit/circuit_internal.h"

typedef struct stamp {
    const ns_circuit *c;
    ns_system *s;
} stamp;

static int row_of(const stamp *to, int number) {
    return ns_circuit_node_unknown(to->c, number);
}

/* a(i,j) += value, for an array with p rows; ground (-1) has neither row nor column. */
static void add(double *a, int p, int i, int j, double value) {
    if (i >= 0 && j >= 0) {
        a[(size_t)i + (size_t)j * (size_t)p] += value;
    }
}

/* Rows p and n: `value` times column j of an array leaves p and enters n (array has the sign of A). */
static void leaves(const stamp *to, const element *e, double *a, int j, double value) {
    add(a, to->s->n, row_of(to, e->node[0]), j, -value);
    add(a, to->s->n, row_of(to, e->node[1]), j, value);
}

static void conductance(const stamp *to, const element *e, double siemens) {
    leaves(to, e, to->s->A, row_of(to, e->node[0]), siemens);
    leaves(to, e, to->s->A, row_of(to, e->node[1]), -siemens);
}

/* v_p - v_n in a row; times gain. */
static void difference(const stamp *to, double *a, int p_rows, int row, int p, int n, double gain) {
    add(a, p_rows, row, row_of(to, p), gain);
    add(a, p_rows, row, row_of(to, n), -gain);
}

/* An element with a current among x: the current in the rows of its nodes; returns its own row. */
static int branch(const stamp *to, const element *e) {
    int row = to->c->nused + e->current;
    leaves(to, e, to->s->A, row, 1);
    return row;
}

/* A voltage source of any kind: 0 = value - (v_p - v_n), of which the right part is stamped here. */
static int voltage(const stamp *to, const element *e) {
    int row = branch(to, e);
    difference(to, to->s->A, to->s->n, row, e->node[0], e->node[1], -1);
    return row;
}

/* Column j of array a, times gain, is put out as voltage or current. */
static void put_out(const stamp *to, const element *e, int row, double *a, int j, double gain) {
    if (row >= 0) {
        add(a, to->s->n, row, j, gain);
    } else {
        leaves(to, e, a, j, gain);
    }
}

static void stamp_source(const stamp *to, const element *e) {
    int row = e->output == NS_VOLTAGE ? voltage(to, e) : -1;
    if (e->input >= 0) {
        put_out(to, e, row, to->s->E, e->input, 1);
    } else {
        put_out(to, e, row, to->s->b, 0, e->signal.u.dc);
    }
}

static void stamp_controlled(const stamp *to, const element *e) {
    const ns_circuit *c = to->c;
    int row = e->output == NS_VOLTAGE ? voltage(to, e) : -1;
    if (e->kind == VCONTROLLED) {
        put_out(to, e, row, to->s->A, row_of(to, e->node[2]), e->value);
        put_out(to, e, row, to->s->A, row_of(to, e->node[3]), -e->value);
    } else if (e->kind == ICONTROLLED) {
        put_out(to, e, row, to->s->A, ns_circuit_current_unknown(c, e->by[0]), e->value);
    } else {
        put_out(to, e, row, to->s->b, 0, e->value);
    }
    for (int i = 0; i < e->nterms; i++) {
        int of = e->terms[i].of;
        int column = e->terms[i].is_current ? ns_circuit_current_unknown(c, of) : row_of(to, of);
        put_out(to, e, row, to->s->A, column, e->terms[i].gain);
    }
}

static void stamp_capacitor(const stamp *to, const element *e) {
    leaves(to, e, to->s->M, row_of(to, e->node[0]), -e->value);
    leaves(to, e, to->s->M, row_of(to, e->node[1]), e->value);
}

static void stamp_inductor(const stamp *to, const element *e) {
    int row = branch(to, e);
    difference(to, to->s->A, to->s->n, row, e->node[0], e->node[1], 1);
}

static void stamp_inductance(void *data, int row, int column, double henries) {
    const stamp *to = data;
    add(to->s->M, to->s->n, ns_circuit_current_unknown(to->c, row), ns_circuit_current_unknown(to->c, column),
        henries);
}

/* A pair whose lambda flows from p to n if sign is 1, from n to p if -1; y = kink + D lambda - sign v. */
static void stamp_pair(const stamp *to, const element *e, int pair, double sign, double kink, double D) {
    ns_system *s = to->s;
    leaves(to, e, s->B, pair, sign);
    difference(to, s->C, s->m, pair, e->node[0], e->node[1], -sign);
    add(s->D, s->m, pair, pair, D);
    s->e[pair] = kink;
}

static void stamp_diode(const stamp *to, const element *e) {
    const ns_diode *d = &e->diode;
    double on = ns_kink_factor(d->ron, d->roff), breakdown = ns_kink_factor(d->rz, d->roff);
    conductance(to, e, 1 / d->roff);
    stamp_pair(to, e, e->pair, 1, d->vf * on, d->ron * on);
    if (!isinf(d->vz)) {
        stamp_pair(to, e, e->pair + 1, -1, d->vz * breakdown, d->rz * breakdown);
    }
}

static void stamp_switch(const stamp *to, const element *e) {
    double on = ns_kink_factor(e->sw.ron, e->sw.roff);
    conductance(to, e, 1 / e->sw.roff);
    stamp_pair(to, e, e->pair, 1, 0, e->sw.ron * on);
}

static void stamp_element(const stamp *to, const element *e) {
    switch (e->kind) {
    case RESISTOR:
        if (e->value != 0) {
            conductance(to, e, 1 / e->value);
        } else {
            voltage(to, e);
        }
        break;
    case CAPACITOR:
        stamp_capacitor(to, e);
        break;
    case INDUCTOR:
        stamp_inductor(to, e);
        break;
    case COUPLING: /* ns_each_inductance() */
        break;
    case SOURCE:
        stamp_source(to, e);
        break;
    case VCONTROLLED:
    case ICONTROLLED:
    case LINEAR:
        stamp_controlled(to, e);
        break;
    case DIODE:
        stamp_diode(to, e);
        break;
    case SWITCH:
        stamp_switch(to, e);
        break;
    }
}

static int fill(const ns_circuit *c, ns_system *s) {
    stamp to = {c, s};
    for (int i = 0; i < c->nelements; i++) {
        const element *e = &c->element[i];
        int status = NS_OK;
        stamp_element(&to, e);
        if (e->input >= 0 && (status = ns_system_set_input(s, e->input, &e->signal))) {
            return status;
        }
    }
    ns_each_inductance(c, stamp_inductance, &to);
    int status = ns_stamp_gauge(c, s);
    return status != NS_OK ? status : ns_stamp_commands(c, s);
}

int ns_circuit_system(ns_circuit *c, ns_system **out) {
    ns_system *s = NULL;
    int status;
    ns_fault fault = {0};
    if (!out) {
        return NS_E_NULL;
    }
    *out = NULL;
    if (!c) {
        return NS_E_NULL;
    }
    if ((status = ns_check_inductances(c))) {
        return status;
    }
    if ((status = ns_system_create(c->nused + c->ncurrents, c->npairs, c->ninputs, c->ncommands, &s)) ||
        (status = fill(c, s)) || (status = ns_system_check(s, &fault))) {
        char where[160] = "";
        if (fault.status) {
            (void)ns_circuit_explain(c, &fault, where, sizeof where);
        }
        ns_system_free(s);
        return ns_complain(c, status, "%s", *where ? where : ns_status_text(status));
    }
    *out = s;
    return NS_OK;
}
