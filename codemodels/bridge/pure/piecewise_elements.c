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
    const int status = ns_circuit_choice(p->circuit, name, &control, c->threshold, &a, &id);
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

/* How large the terms of a condition are: volts and amperes count as 1, times by their scale. */
static double size_of(const ns_piecewise *p, const ns_piecewise_value *a) {
    double size = fabs(a->table[0]);
    for (int k = 0; k < a->nterms; k++) {
        const int is_time = a->term[k].is_current == 0 && p->time_node > 0 && a->term[k].of == p->time_node;
        size += fabs(a->term[k].gain) * (is_time ? p->time_scale : 1.0);
    }
    return size;
}

static int is_condition(const ns_piecewise_condition *c, const ns_piecewise_value *a) {
    int same = c->constant == a->table[0] && c->nterms == a->nterms;
    for (int k = 0; k < a->nterms && same; k++)
        same = c->term[k].is_current == a->term[k].is_current && c->term[k].of == a->term[k].of &&
               c->term[k].gain == a->term[k].gain;
    return same;
}

/* The number of the condition a > 0, which may be there already; -1: p->status. */
int ns_bridge_piecewise_find_condition(ns_piecewise *p, const ns_piecewise_value *a) {
    static const double at_zero = 1e-13; /* of its terms: rounding */
    for (int k = 0; k < p->nconditions; k++)
        if (is_condition(&p->condition[k], a))
            return k;
    ns_piecewise_condition *more = realloc(p->condition, (size_t)(p->nconditions + 1) * sizeof *more);
    ns_term *terms = calloc((size_t)a->nterms + 1, sizeof *terms);
    p->condition = more ? more : p->condition;
    if (!more || !terms) {
        free(terms);
        ns_bridge_piecewise_fail(p, NS_E_MEMORY, NULL);
        return -1;
    }
    memcpy(terms, a->term, (size_t)a->nterms * sizeof *terms);
    p->condition[p->nconditions] =
        (ns_piecewise_condition){a->table[0], a->nterms, terms, at_zero * size_of(p, a)};
    return p->nconditions++;
}
