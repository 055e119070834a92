/* src/energy/path.c - node voltages where a jump begins: sources as after it, charges as before it.
 *
 * From ground on along a tree: across a source of voltage what it gives, across a capacitor what it had.
 * Where the tree does not come, voltages are those before.  A capacitor that closes a loop of sources and
 * capacitors without any device follows a source that jumps with no loss: then the sources too are as before
 * the jump.
 */
#include "circuit/circuit_internal.h"
#include "energy_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a loop may be off by, of the largest voltage: rounding. */
static const double rounding = 1e-9;

/* --- the tree --- */

static int is_source(const element *e) {
    return e->kind == SOURCE && e->output == NS_VOLTAGE;
}

typedef struct tree {
    ns_energy *e;
    unsigned char *known; /* of node voltages */
} tree;

static int knows(const tree *t, int unknown) {
    return unknown < 0 || t->known[unknown];
}

static void add_step(tree *t, int id, int known, int found, double sign) {
    t->e->step[t->e->steps++] = (ns_path_step){id, known, found, sign};
    t->known[found] = 1;
}

/* From node to node; 1: some were found. */
static int spread(tree *t, int sources_only) {
    const ns_circuit *c = t->e->c;
    int any = 0;
    for (int k = 0; k < c->nelements; k++) {
        const element *e = &c->element[k];
        if (!is_source(e) && (sources_only || e->kind != CAPACITOR))
            continue;
        const int p = ns_circuit_node_unknown(c, e->node[0]), n = ns_circuit_node_unknown(c, e->node[1]);
        if (knows(t, p) == knows(t, n))
            continue;
        if (knows(t, p))
            add_step(t, k, p, n, -1);
        else
            add_step(t, k, n, p, 1);
        any = 1;
    }
    return any;
}

/* One more part, at its first node; 0: all are known. */
static int begin_part(tree *t) {
    for (int i = 0; i < t->e->c->nused; i++)
        if (!t->known[i]) {
            add_step(t, -1, -1, i, 0);
            return 1;
        }
    return 0;
}

int ns_energy_path_create(ns_energy *e) {
    const size_t nodes = (size_t)e->c->nused;
    tree t = {e, calloc(nodes + 1, 1)};
    e->step = calloc(nodes + 1, sizeof *e->step);
    e->begin = calloc((size_t)e->unknowns + 1, sizeof *e->begin);
    if (t.known && e->step && e->begin)
        for (int more = 1; more; more = begin_part(&t))
            while (spread(&t, 1) || spread(&t, 0))
                ;
    const int status = t.known && e->step && e->begin ? NS_OK : NS_E_MEMORY;
    free(t.known);
    return status;
}

/* --- voltages --- */

static double across(const ns_circuit *c, const element *e, const double *x) {
    const int p = ns_circuit_node_unknown(c, e->node[0]), n = ns_circuit_node_unknown(c, e->node[1]);
    return (p < 0 ? 0 : x[p]) - (n < 0 ? 0 : x[n]);
}

static double initial_of_node(const ns_circuit *c, int number) {
    int found;
    const int place = ns_circuit_find_node(c, number, &found);
    return found && !isnan(c->node[place].ic) ? c->node[place].ic : 0;
}

/* x0: NULL: by initial conditions. */
static double volts(const ns_circuit *c, const element *e, double t, const double *x0) {
    if (is_source(e))
        return ns_signal_value(&e->signal, t, NS_RIGHT);
    if (x0)
        return across(c, e, x0);
    return isnan(e->ic) ? initial_of_node(c, e->node[0]) - initial_of_node(c, e->node[1]) : e->ic;
}

static void follow_tree(const ns_energy *e, double t, const double *x0, double *x) {
    for (int k = 0; k < e->steps; k++) {
        const ns_path_step *s = &e->step[k];
        const double from = s->known < 0 ? 0 : x[s->known];
        if (s->id < 0)
            x[s->found] = x0 ? x0[s->found] : 0;
        else
            x[s->found] = from + s->sign * volts(e->c, &e->c->element[s->id], t, x0);
    }
}

/* 1 if all capacitors have the voltages that they had. */
static int keeps_charges(const ns_energy *e, const double *x0, const double *x) {
    double most = 0, off = 0;
    for (int i = 0; i < e->c->nused; i++)
        most = fmax(most, fmax(fabs(x0[i]), fabs(x[i])));
    for (int k = 0; k < e->c->nelements; k++)
        if (e->c->element[k].kind == CAPACITOR)
            off = fmax(off, fabs(across(e->c, &e->c->element[k], x0) - across(e->c, &e->c->element[k], x)));
    return off <= rounding * most;
}

void ns_energy_path_begin(ns_energy *e, double t, const double *x0, double *x) {
    memcpy(x, x0, sizeof *x * (size_t)e->unknowns);
    follow_tree(e, t, x0, x);
    if (!keeps_charges(e, x0, x))
        memcpy(x, x0, sizeof *x * (size_t)e->unknowns);
}

void ns_energy_path_initial(const ns_energy *e, double t, double *x) {
    memset(x, 0, sizeof *x * (size_t)e->unknowns);
    follow_tree(e, t, NULL, x);
    for (int k = 0; k < e->c->nelements; k++) {
        const element *l = &e->c->element[k];
        if (l->kind == INDUCTOR && !isnan(l->ic))
            x[ns_circuit_current_unknown(e->c, k)] = l->ic;
    }
}
