/* bridge/pure/piecewise_elements.c - kinks, choices, hidden nodes and conditions of piecewise linear
 * expressions.
 */
#include "piecewise_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void name_element(ns_piecewise *p, char *name, size_t size) {
    snprintf(name, size, "%.140s (%d)", p->name, ++p->elements);
}

static ns_piecewise_value *value_of_element(ns_piecewise *p, int status, int id) {
    return status == NS_OK ? ns_bridge_piecewise_term(p, (ns_term){2, id, 1.0})
                           : ns_bridge_piecewise_fail(p, status, NULL);
}

static ns_affine affine_of(const ns_piecewise_value *v) {
    return (ns_affine){v->table[0], v->nterms, v->term};
}

ns_piecewise_value *ns_bridge_piecewise_add_kink(ns_piecewise *p, const ns_piecewise_value *u) {
    const ns_affine a = affine_of(u);
    char name[PIECEWISE_NAME];
    int id = -1;
    name_element(p, name, sizeof name);
    const int status = ns_circuit_kink(p->circuit, name, &a, &id);
    return value_of_element(p, status, id);
}

ns_piecewise_value *ns_bridge_piecewise_add_choice(ns_piecewise *p, int condition,
                                                   const ns_piecewise_value *u) {
    const ns_piecewise_condition *c = &p->condition[condition];
    const ns_affine control = {c->constant, c->nterms, c->term}, a = affine_of(u);
    char name[PIECEWISE_NAME];
    int id = -1;
    name_element(p, name, sizeof name);
    int status = ns_circuit_choice(p->circuit, name, &control, c->threshold, &a, &id);
    p->group = p->group ? p->group : id + 1; /* of no other expression */
    status = status ? status : ns_circuit_choice_at_rest(p->circuit, id, c->is_negated, p->group);
    return value_of_element(p, status, id);
}

/* A node whose voltage is a, and that as a value: conditions are of voltages and currents alone. */
ns_piecewise_value *ns_bridge_piecewise_at_a_node(ns_piecewise *p, const ns_piecewise_value *a) {
    const int node = (*p->next_node)++;
    char name[PIECEWISE_NAME];
    name_element(p, name, sizeof name);
    int status =
        ns_circuit_linear(p->circuit, name, NS_VOLTAGE, node, 0, a->table[0], a->nterms, a->term, NULL);
    status = status ? status : ns_circuit_name_node(p->circuit, node, name);
    return status ? ns_bridge_piecewise_fail(p, status, NULL)
                  : ns_bridge_piecewise_term(p, (ns_term){0, node, 1.0});
}

double ns_bridge_piecewise_size(const ns_piecewise *p, const ns_piecewise_value *a) {
    double size = fabs(a->table[0]);
    for (int k = 0; k < a->nterms; k++) {
        const int is_time = a->term[k].is_current == 0 && p->time_node > 0 && a->term[k].of == p->time_node;
        size += fabs(a->term[k].gain) * (is_time ? p->time_scale : 1.0);
    }
    return size;
}

static int is_condition(const ns_piecewise_condition *c, const ns_piecewise_condition *a) {
    int same = c->constant == a->constant && c->nterms == a->nterms && c->threshold == a->threshold &&
               c->is_negated == a->is_negated;
    for (int k = 0; k < a->nterms && same; k++)
        same = c->term[k].is_current == a->term[k].is_current && c->term[k].of == a->term[k].of &&
               c->term[k].gain == a->term[k].gain;
    return same;
}

/* The number of the condition that is `sign` times this one, which may be there already; -1: p->status. */
static int keep_condition(ns_piecewise *p, ns_piecewise_condition of, double sign) {
    ns_term *terms = calloc((size_t)of.nterms + 1, sizeof *terms);
    for (int k = 0; terms && k < of.nterms; k++)
        terms[k] = (ns_term){of.term[k].is_current, of.term[k].of, sign * of.term[k].gain};
    const ns_piecewise_condition c = {sign * of.constant, of.nterms, terms, sign * of.threshold,
                                      of.is_negated != (sign < 0.0)};
    int at = 0;
    while (terms && at < p->nconditions && !is_condition(&p->condition[at], &c))
        at++;
    if (terms && at < p->nconditions) {
        free(terms);
        return at;
    }
    ns_piecewise_condition *more = realloc(p->condition, (size_t)(p->nconditions + 1) * sizeof *more);
    p->condition = more ? more : p->condition;
    if (!more || !terms) {
        free(terms);
        ns_bridge_piecewise_fail(p, NS_E_MEMORY, NULL);
        return -1;
    }
    p->condition[p->nconditions] = c;
    return p->nconditions++;
}

/* The number of the condition a > 0, which may be there already; -1: p->status. */
int ns_bridge_piecewise_find_condition(ns_piecewise *p, const ns_piecewise_value *a) {
    static const double at_zero = 1e-13; /* of its terms: rounding */
    return keep_condition(p,
                          (ns_piecewise_condition){a->table[0], a->nterms, a->term,
                                                   at_zero * ns_bridge_piecewise_size(p, a), 0},
                          1.0);
}

int ns_bridge_piecewise_negated(ns_piecewise *p, int condition) {
    return keep_condition(p, p->condition[condition], -1.0);
}
