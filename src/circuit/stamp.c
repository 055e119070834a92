/* src/circuit/stamp.c - modified nodal analysis: elements -> (S1)-(S4).
 *
 * Rows of the nodes say that the currents leaving sum to zero: capacitors in M, the others with minus sign in
 * A, b, E, B.  Rows of the currents are the laws of their elements: L di/dt = v_p - v_n, or for sources
 * 0 = value - (v_p - v_n), and for a few resistors 0 = R i - (v_p - v_n) (tiny_resistor.c).
 *
 * A diode is its leak 1/roff beside a pair:
 *     i = lambda + v/roff,    y = (vf + ron lambda)/(1 - ron/roff) - v >= 0,
 * so v = vf + ron i where it conducts, and the line has a kink and no jump; breakdown is a second pair.
 */
#include "circuit_internal.h"

static int row_of(const stamp *to, int number) {
    return ns_circuit_node_unknown(to->c, number);
}

/* Where entry (i,j) lies. */
static double *entry_of(const ns_system *s, matrix which, int i, int j) {
    const size_t of_n = (size_t)i + (size_t)j * (size_t)s->n, of_m = (size_t)i + (size_t)j * (size_t)s->m;
    switch (which) {
    case IN_M:
        return &s->M[of_n];
    case IN_A:
        return &s->A[of_n];
    case IN_B:
        return &s->B[of_n];
    case IN_C:
        return &s->C[of_m];
    case IN_D:
        return &s->D[of_m];
    case IN_E:
        return &s->E[of_n];
    case IN_GX:
        return &s->command[j].gx[i];
    default:
        return &s->command[j].gz[i];
    }
}

void ns_circuit_stamp_add(const stamp *to, matrix which, int i, int j, double value) {
    if (i < 0 && j >= 0 && which == IN_A) {
        to->s->ground[j] += value;
    }
    if (i < 0 || j < 0) {
        return;
    }
    if (to->entries) {
        ns_linalg_entries_add(&to->entries[which], i, j, value);
    } else {
        *entry_of(to->s, which, i, j) += value;
    }
}

/* Rows p and n: `value` times column j of a matrix leaves p and enters n (it has the sign of A). */
static void stamp_leaving(const stamp *to, const element *e, matrix a, int j, double value) {
    ns_circuit_stamp_add(to, a, row_of(to, e->node[0]), j, -value);
    ns_circuit_stamp_add(to, a, row_of(to, e->node[1]), j, value);
}

static void stamp_conductance(const stamp *to, const element *e, double siemens) {
    stamp_leaving(to, e, IN_A, row_of(to, e->node[0]), siemens);
    stamp_leaving(to, e, IN_A, row_of(to, e->node[1]), -siemens);
}

/* v_p - v_n in a row; times gain. */
static void stamp_difference(const stamp *to, matrix a, int row, int p, int n, double gain) {
    ns_circuit_stamp_add(to, a, row, row_of(to, p), gain);
    ns_circuit_stamp_add(to, a, row, row_of(to, n), -gain);
}

/* An element with a current among x: the current in the rows of its nodes; returns its own row. */
static int stamp_branch(const stamp *to, const element *e) {
    int row = to->c->nused + e->current;
    stamp_leaving(to, e, IN_A, row, 1);
    return row;
}

/* A voltage source of any kind: 0 = value - (v_p - v_n), of which the right part is stamped here. */
static int stamp_voltage(const stamp *to, const element *e) {
    int row = stamp_branch(to, e);
    stamp_difference(to, IN_A, row, e->node[0], e->node[1], -1);
    return row;
}

/* Column j of matrix a, times gain, is put out as voltage or current; the same for a constant. */
static void stamp_output(const stamp *to, const element *e, int row, matrix a, int j, double gain) {
    if (row >= 0) {
        ns_circuit_stamp_add(to, a, row, j, gain);
    } else {
        stamp_leaving(to, e, a, j, gain);
    }
}

static void stamp_constant(const stamp *to, const element *e, int row, double value) {
    const int p = row_of(to, e->node[0]), n = row_of(to, e->node[1]);
    double *b = to->s->b;
    if (row >= 0) {
        b[row] += value;
        return;
    }
    if (p >= 0) {
        b[p] -= value;
    }
    if (n >= 0) {
        b[n] += value;
    }
}

static void stamp_source(const stamp *to, const element *e) {
    int row = e->output == NS_VOLTAGE ? stamp_voltage(to, e) : -1;
    if (e->input >= 0) {
        stamp_output(to, e, row, IN_E, e->input, 1);
    } else {
        stamp_constant(to, e, row, e->signal.u.dc);
    }
}

static void stamp_controlled(const stamp *to, const element *e) {
    const ns_circuit *c = to->c;
    int row = e->output == NS_VOLTAGE ? stamp_voltage(to, e) : -1;
    if (e->kind == VCONTROLLED) {
        stamp_output(to, e, row, IN_A, row_of(to, e->node[2]), e->value);
        stamp_output(to, e, row, IN_A, row_of(to, e->node[3]), -e->value);
    } else if (e->kind == ICONTROLLED) {
        stamp_output(to, e, row, IN_A, ns_circuit_current_unknown(c, e->by[0]), e->value);
    } else {
        stamp_constant(to, e, row, e->value);
    }
    for (int i = 0; i < e->nterms; i++) {
        const ns_term *t = &e->terms[i];
        const int pair = ns_circuit_term_pair(c, t);
        if (pair >= 0) {
            stamp_output(to, e, row, IN_B, pair, t->gain);
        } else {
            stamp_output(to, e, row, IN_A, ns_circuit_term_unknown(c, t), t->gain);
        }
    }
}

static void stamp_resistor(const stamp *to, const element *e) {
    if (e->current < 0) {
        stamp_conductance(to, e, 1 / e->value);
    } else {
        const int row = stamp_voltage(to, e);
        ns_circuit_stamp_add(to, IN_A, row, row, e->value);
    }
}

static void stamp_capacitor(const stamp *to, const element *e) {
    stamp_leaving(to, e, IN_M, row_of(to, e->node[0]), -e->value);
    stamp_leaving(to, e, IN_M, row_of(to, e->node[1]), e->value);
}

static void stamp_inductor(const stamp *to, const element *e) {
    int row = stamp_branch(to, e);
    stamp_difference(to, IN_A, row, e->node[0], e->node[1], 1);
}

/* A pair whose lambda flows from p to n if sign is 1, from n to p if -1; y = kink + D lambda - sign v. */
static void stamp_pair(const stamp *to, const element *e, int pair, double sign, double kink, double D) {
    stamp_leaving(to, e, IN_B, pair, sign);
    stamp_difference(to, IN_C, pair, e->node[0], e->node[1], -sign);
    ns_circuit_stamp_add(to, IN_D, pair, pair, D);
    to->s->e[pair] = kink;
}

static void stamp_diode(const stamp *to, const element *e) {
    const ns_diode *d = &e->diode;
    double on = ns_circuit_kink_factor(d->ron, d->roff), breakdown = ns_circuit_kink_factor(d->rz, d->roff);
    stamp_conductance(to, e, 1 / d->roff);
    stamp_pair(to, e, e->pair, 1, d->vf * on, d->ron * on);
    if (ns_circuit_pairs_of(e) == 2) {
        stamp_pair(to, e, e->pair + 1, -1, d->vz * breakdown, d->rz * breakdown);
    }
}

static void stamp_switch(const stamp *to, const element *e) {
    double on = ns_circuit_kink_factor(e->sw.ron, e->sw.roff);
    stamp_conductance(to, e, 1 / e->sw.roff);
    stamp_pair(to, e, e->pair, 1, 0, e->sw.ron * on);
}

int ns_circuit_term_unknown(const ns_circuit *c, const ns_term *t) {
    return t->is_current == 1   ? ns_circuit_current_unknown(c, t->of)
           : t->is_current == 0 ? ns_circuit_node_unknown(c, t->of)
                                : -1;
}

int ns_circuit_term_pair(const ns_circuit *c, const ns_term *t) {
    return t->is_current == 2 ? c->element[t->of].pair : -1;
}

/* y = lambda - u; of a box y alone is given. */
static void stamp_value(const stamp *to, const element *e) {
    const double sign = e->kind == BOX ? 1 : -1;
    if (e->kind == BOX) {
        to->s->l[e->pair] = e->low;
        to->s->u[e->pair] = e->high;
    } else {
        ns_circuit_stamp_add(to, IN_D, e->pair, e->pair, 1);
    }
    to->s->e[e->pair] = sign * e->value;
    for (int i = e->ncontrol; i < e->nterms; i++) {
        const ns_term *t = &e->terms[i];
        ns_circuit_stamp_add(to, IN_C, e->pair, ns_circuit_term_unknown(to->c, t), sign * t->gain);
        ns_circuit_stamp_add(to, IN_D, e->pair, ns_circuit_term_pair(to->c, t), sign * t->gain);
    }
}

void ns_circuit_stamp_element(const stamp *to, const element *e) {
    static void (*const by_kind[])(const stamp *to,
                                   const element *e) = {[RESISTOR] = stamp_resistor,
                                                        [CAPACITOR] = stamp_capacitor,
                                                        [INDUCTOR] = stamp_inductor,
                                                        [COUPLING] = NULL, /* ns_circuit_each_inductance() */
                                                        [SOURCE] = stamp_source,
                                                        [VCONTROLLED] = stamp_controlled,
                                                        [ICONTROLLED] = stamp_controlled,
                                                        [LINEAR] = stamp_controlled,
                                                        [DIODE] = stamp_diode,
                                                        [SWITCH] = stamp_switch,
                                                        [KINK] = stamp_value,
                                                        [CHOICE] = stamp_value,
                                                        [BOX] = stamp_value};
    if (by_kind[e->kind])
        by_kind[e->kind](to, e);
}
