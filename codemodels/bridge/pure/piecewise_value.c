/* bridge/pure/piecewise_value.c - values of piecewise linear expressions: made, freed, leaves. */
#include "piecewise_internal.h"

#include <math.h>
#include <stdlib.h>

ns_piecewise_value *ns_bridge_piecewise_fail(ns_piecewise *p, int status, const char *why) {
    if (p->status == NS_OK) {
        p->status = status;
        p->why = why;
    }
    return NULL;
}

ns_piecewise_value *ns_bridge_piecewise_make(ns_piecewise *p, int nconditions, int nterms) {
    ns_piecewise_value *v = calloc(1, sizeof *v);
    if (!v)
        return ns_bridge_piecewise_fail(p, NS_E_MEMORY, NULL);
    v->next = p->values;
    p->values = v;
    v->nconditions = nconditions;
    v->is_discrete = nconditions >= 0;
    v->nterms = nterms;
    v->term = calloc((size_t)nterms + 1, sizeof *v->term);
    v->table = calloc(v->is_discrete ? (size_t)1 << nconditions : 1, sizeof *v->table);
    return v->term && v->table ? v : ns_bridge_piecewise_fail(p, NS_E_MEMORY, NULL);
}

void ns_bridge_piecewise_free(ns_piecewise *p) {
    while (p->values) {
        ns_piecewise_value *next = p->values->next;
        free(p->values->term);
        free(p->values->table);
        free(p->values);
        p->values = next;
    }
    for (int k = 0; k < p->nconditions; k++)
        free(p->condition[k].term);
    free(p->condition);
    p->condition = NULL;
    p->nconditions = 0;
}

ns_piecewise_value *ns_bridge_piecewise_constant(ns_piecewise *p, double value) {
    ns_piecewise_value *v = ns_bridge_piecewise_make(p, 0, 0);
    if (v)
        v->table[0] = value;
    return v && !isfinite(value) ? ns_bridge_piecewise_fail(p, NS_E_NUMBER, "it is no finite number") : v;
}

ns_piecewise_value *ns_bridge_piecewise_term(ns_piecewise *p, ns_term term) {
    ns_piecewise_value *v = ns_bridge_piecewise_make(p, -1, 1);
    if (v)
        v->term[0] = term;
    return v;
}

int ns_bridge_piecewise_is_discrete(const ns_piecewise_value *v) {
    return v->is_discrete;
}

int ns_bridge_piecewise_is_constant(const ns_piecewise_value *v, double *value) {
    *value = v->table[0];
    return v->is_discrete && v->nconditions == 0;
}
