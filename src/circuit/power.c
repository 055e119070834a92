/* src/circuit/power.c - voltage, current and power of every element, and the energy stored. */
#include <math.h>

#include "branch.h"
#include "circuit_internal.h"

int ns_circuit_branch_unknowns(const ns_circuit *c) {
    return c->nused + c->ncurrents;
}

int ns_circuit_branch_pairs(const ns_circuit *c) {
    return c->npairs;
}

int ns_circuit_branch_count(const ns_circuit *c) {
    return c->nelements;
}

/* --- the branch of an element --- */

typedef struct visitor {
    ns_branch_visit *visit;
    void *to;
} visitor;

static void visit_unknown(const visitor *to, int unknown, double gain) {
    if (unknown >= 0) { /* ground has none */
        to->visit(to->to, unknown, gain);
    }
}

static void visit_controlled(const ns_circuit *c, const element *e, const visitor *to) {
    if (e->kind == VCONTROLLED) {
        visit_unknown(to, ns_circuit_node_unknown(c, e->node[2]), e->value);
        visit_unknown(to, ns_circuit_node_unknown(c, e->node[3]), -e->value);
    } else if (e->kind == ICONTROLLED) {
        visit_unknown(to, ns_circuit_current_unknown(c, e->by[0]), e->value);
    }
    for (int k = 0; k < e->nterms; k++) {
        const ns_term *t = &e->terms[k];
        const int pair = ns_circuit_term_pair(c, t);
        visit_unknown(to, pair >= 0 ? ns_circuit_branch_unknowns(c) + pair : ns_circuit_term_unknown(c, t),
                      t->gain);
    }
}

static void fill_source(const element *e, ns_branch *b) {
    if (e->input >= 0) {
        b->signal = &e->signal;
    } else {
        b->amperes = e->signal.u.dc;
    }
}

static void fill_device(const ns_circuit *c, const element *e, const visitor *to, ns_branch *b) {
    const int lambda = ns_circuit_branch_unknowns(c) + e->pair;
    b->siemens = 1 / (e->kind == DIODE ? e->diode.roff : e->sw.roff);
    to->visit(to->to, lambda, 1);
    if (ns_circuit_pairs_of(e) == 2) {
        to->visit(to->to, lambda + 1, -1);
    }
}

/* Of an element whose current is no unknown. */
static void fill_current(const ns_circuit *c, const element *e, const visitor *to, ns_branch *b) {
    switch (e->kind) {
    case RESISTOR:
        b->siemens = 1 / e->value;
        break;
    case CAPACITOR:
        b->farads = e->value;
        break;
    case SOURCE:
        fill_source(e, b);
        break;
    case VCONTROLLED:
    case ICONTROLLED:
        visit_controlled(c, e, to);
        break;
    case LINEAR:
        b->amperes = e->value;
        visit_controlled(c, e, to);
        break;
    case DIODE:
    case SWITCH:
        fill_device(c, e, to, b);
        break;
    case INDUCTOR: /* its current is an unknown */
    case COUPLING:
    case KINK: /* it has none */
    case CHOICE:
    case BOX:
        break;
    }
}

ns_branch ns_circuit_branch(const ns_circuit *c, int id, ns_branch_visit *visit, void *to) {
    const element *e = &c->element[id];
    const visitor all = {visit, to};
    ns_branch b = {-1, -1, 0, 0, 0, NULL};
    if (e->kind == COUPLING) {
        return b;
    }
    b.p = ns_circuit_node_unknown(c, e->node[0]);
    b.n = ns_circuit_node_unknown(c, e->node[1]);
    if (e->current >= 0) {
        visit(to, c->nused + e->current, 1);
    } else {
        fill_current(c, e, &all, &b);
    }
    return b;
}

/* An array of no numbers may be NULL. */
static const double *array(const double *numbers) {
    static const double none;
    return numbers ? numbers : &none;
}

/* --- at a point --- */

typedef struct term_sum {
    const double *x, *lambda;
    int unknowns;
    double sum;
} term_sum;

static void add_term(void *to, int index, double gain) {
    term_sum *s = to;
    s->sum += gain * (index < s->unknowns ? s->x[index] : s->lambda[index - s->unknowns]);
}

static double current_of(const ns_branch *b, const ns_solution *at, double terms) {
    double sum = terms + b->siemens * ns_branch_voltage(b, array(at->x)) + b->amperes;
    if (b->signal) {
        sum += ns_signal_value(b->signal, at->t, at->side);
    }
    if (b->farads != 0) {
        sum += at->rates ? b->farads * ns_branch_voltage(b, at->rates) : NAN;
    }
    return sum;
}

int ns_circuit_power(const ns_circuit *c, int id, const ns_solution *at, double *v, double *i, double *p) {
    if (!c || !at) {
        return NS_E_NULL;
    }
    if (id < 0 || id >= c->nelements) {
        return NS_E_SIZE;
    }
    if ((!at->x && ns_circuit_branch_unknowns(c) > 0) || (!at->lambda && c->npairs > 0)) {
        return NS_E_NULL;
    }
    term_sum terms = {array(at->x), array(at->lambda), ns_circuit_branch_unknowns(c), 0};
    const ns_branch b = ns_circuit_branch(c, id, add_term, &terms);
    const double across = ns_branch_voltage(&b, terms.x), through = current_of(&b, at, terms.sum);
    if (v) {
        *v = across;
    }
    if (i) {
        *i = through;
    }
    if (p) {
        *p = across * through;
    }
    return NS_OK;
}

/* --- stored --- */

typedef struct stored {
    const ns_circuit *c;
    const double *x;
    double *each, sum;
} stored;

static void add_stored(stored *to, int id, double joule) {
    to->sum += joule;
    if (to->each) {
        to->each[id] += joule;
    }
}

static void add_inductance(void *data, int row, int column, double henries) {
    stored *to = data;
    const double *i = to->x + to->c->nused;
    add_stored(to, row, henries * i[to->c->element[row].current] * i[to->c->element[column].current] / 2);
}

int ns_circuit_stored(const ns_circuit *c, const double *x, double *each, double *all) {
    if (!c || (!x && ns_circuit_branch_unknowns(c) > 0)) {
        return NS_E_NULL;
    }
    stored to = {c, array(x), each, 0};
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        if (each) {
            each[k] = 0;
        }
        if (e->kind == CAPACITOR) {
            const int p = ns_circuit_node_unknown(c, e->node[0]), n = ns_circuit_node_unknown(c, e->node[1]);
            const double v = (p < 0 ? 0 : to.x[p]) - (n < 0 ? 0 : to.x[n]);
            add_stored(&to, k, e->value * v * v / 2);
        }
    }
    ns_circuit_each_inductance(c, add_inductance, &to);
    if (all) {
        *all = to.sum;
    }
    return NS_OK;
}
